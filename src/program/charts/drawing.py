"""Shared functions of the scripts in this folder: numbers as the program prints them, the machine, atomic writing of files, matplotlib.

A script ends with the status CANNOT_WRITE where a file cannot be written, and prints its name and the reason. The program reports them.
"""

import datetime
import errno
import io
import logging
import os
import platform
import stat
import sys
import tempfile

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it tells of its caches
try:
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams.update({"svg.hashsalt": "manycontact", "svg.fonttype": "none", "axes.unicode_minus": False, "font.size": 10})
except ImportError:
    plt = None  # pages are written all the same

CANNOT_WRITE = 3
GRID, GREY = "#dddddd", "#555555"


def number(x, digits=3):
    """Returns x with so many significant digits; a large number without an exponent."""
    whole = 10**digits - 0.5 <= abs(x) < 1e7
    return "%.*f" % (0, x) if whole else "%.*g" % (digits, x or 0)


def scientific(x):
    return "%.1e" % x if x and abs(x) < float("inf") else number(x)


def count(n, noun):
    return f"{n} " + (noun if n == 1 else noun[:-1] + "ies" if noun.endswith("y") else noun + "s")


def join(names, most=12):
    shown = len(names) if len(names) <= most + 1 else most
    return ", ".join(names[:shown]) + (f" and {len(names) - shown} more" if shown < len(names) else "")


def machine():
    """Returns the processor and today's date."""
    processor = platform.processor()
    if os.path.exists("/proc/cpuinfo"):
        with open("/proc/cpuinfo") as file:
            processor = next((line.partition(":")[2].strip() for line in file if line.startswith("model name")), processor)
    return f"{processor}, {datetime.date.today()}"


def printable(text):
    """Returns the text with blanks for control characters."""
    return "".join(" " if ord(c) < 0x20 or ord(c) == 0x7F else c for c in text)


def publish(target, data):
    """Writes a file under another name and renames it when it is complete; devices and pipes are written directly."""
    there = os.path.exists(target)
    if there and not os.path.isfile(target):
        with open(target, "wb") as file:
            file.write(data)
        return
    if there and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    mask = os.umask(0)
    os.umask(mask)
    mode = stat.S_IMODE(os.stat(target).st_mode) & 0o777 if there else 0o666 & ~mask
    handle, temporary = tempfile.mkstemp(prefix="manycontact-", suffix=".part", dir=os.path.dirname(target))
    try:
        with open(handle, "wb") as file:
            os.fchmod(handle, mode)
            file.write(data)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise


def write(path, data):
    try:
        publish(os.path.realpath(path), data if isinstance(data, bytes) else data.encode())
    except OSError as error:
        print(f"{path}\ncannot be written: {error.strerror}, expected a file that may be created")
        sys.exit(CANNOT_WRITE)


def save(figure, base):
    """Writes base.svg and base.png."""
    for kind, metadata in (("svg", {"Date": None}), ("png", None)):
        picture = io.BytesIO()
        figure.savefig(picture, format=kind, metadata=metadata, dpi=100)
        write(f"{base}.{kind}", picture.getvalue())
    plt.close(figure)


def plain(text):
    """Escapes dollar signs for matplotlib, which reads text between dollars as mathematics."""
    return printable(text).replace("$", r"\$")


def frame(axes, x="log", y="log"):
    axes.set_xscale(x)
    axes.set_yscale(y)
    axes.grid(True, color=GRID)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
