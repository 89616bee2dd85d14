"""A build backend (PEP 517, PEP 660) of the standard library alone: CMake builds the package, zipfile writes the wheel.

    pip wheel --no-deps . --config-settings build-dir=build/release      # build-dir: else build/wheel
    pip wheel --no-deps . --config-settings portable=ON                  # for every processor, not this one alone
    cmake_wheel.py FOLDER [build-dir=build/release]                      # the wheel and the source archive, without pip
"""

import base64
import hashlib
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

PYTHON = pathlib.Path(__file__).resolve().parents[1]
TOP = PYTHON.parents[1]
LICENCES = """manycontact: BSD-3-Clause, see LICENSE.

The compiled module is linked with shared libraries of the system that built it, which this wheel does not hold; among
them SuiteSparse's LDL and CHOLMOD. LDL and CHOLMOD's simplicial part, which it calls, are LGPL-2.1-or-later; other
parts of CHOLMOD are GPL-2.0-or-later.
"""


def _version():
    return re.search(r"project\(manycontact\s+VERSION\s+([\d.]+)", (TOP / "CMakeLists.txt").read_text())[1]


def _built(settings):
    """The package's folder, built."""
    folder = pathlib.Path((settings or {}).get("build-dir") or "build/wheel")
    folder = folder if folder.is_absolute() else TOP / folder
    # pip hides the interpreter's own packages from what it runs; the stubs are written with numpy at hand.
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONNOUSERSITE")}
    pythons = (sys.executable, getattr(sys, "_base_executable", sys.executable))
    tests = (subprocess.run([p, "-c", "import numpy"], capture_output=True, env=environment) for p in pythons)
    python = next((p for p, test in zip(pythons, tests) if test.returncode == 0), pythons[1])
    options = [f"-DMANYCONTACT_{name}=OFF" for name in ("TESTS", "CHART", "BENCH")]
    options.append(f"-DMANYCONTACT_PORTABLE={(settings or {}).get('portable', 'OFF')}")
    if not shutil.which("cmake"):
        raise SystemExit("cmake was not found; install the packages that README.md lists, or run ./run build once")
    if not (folder / "CMakeCache.txt").exists():
        options += ["-DCMAKE_BUILD_TYPE=Release", "-DMANYCONTACT_PYTHON=ON", f"-DPython3_EXECUTABLE={python}"]
        subprocess.run(["cmake", "-S", TOP, "-B", folder, *options], check=True, env=environment)
    build = ["cmake", "--build", folder, "-j", str(os.cpu_count()), "--target", "manycontact_python"]
    subprocess.run(build, check=True, env=environment)
    return folder / "python"


def _metadata():
    return "\n".join([
        "Metadata-Version: 2.1",
        "Name: manycontact",
        f"Version: {_version()}",
        "Summary: Forward dynamics of many robots in contact, its derivatives, and optimal control",
        "License: BSD-3-Clause",
        "License-File: LICENSE",
        "License-File: LICENCES.txt",
        f"Requires-Python: =={sys.version_info.major}.{sys.version_info.minor}.*",
        "Requires-Dist: numpy",
        'Requires-Dist: scipy; extra == "sparse"',
        "Provides-Extra: sparse",
        "Description-Content-Type: text/markdown",
        "",
        (TOP / "README.md").read_text(),
    ])  # fmt: skip


def _tag():
    cpython = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{cpython}-{cpython}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _info():
    """The files of the wheel's dist-info folder but RECORD."""
    wheel = f"Wheel-Version: 1.0\nGenerator: cmake_wheel\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
    return {
        "METADATA": _metadata().encode(),
        "WHEEL": wheel.encode(),
        "LICENSE": (TOP / "LICENSE").read_bytes(),
        "LICENCES.txt": LICENCES.encode(),
    }


def _write(folder, files):
    """The wheel of {name: contents}; returns its name."""
    info = f"manycontact-{_version()}.dist-info/"
    files = {**files, **{info + name: contents for name, contents in _info().items()}}
    record = [
        f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(x).digest()).rstrip(b'=').decode()},{len(x)}"
        for name, x in files.items()
    ]
    files[info + "RECORD"] = "\n".join([*record, info + "RECORD,,", ""]).encode()
    name = f"manycontact-{_version()}-{_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as out:
        for path, contents in files.items():
            entry = zipfile.ZipInfo(path)  # of 1980, so that the same files make the same wheel
            entry.external_attr, entry.compress_type = 0o644 << 16, zipfile.ZIP_DEFLATED
            out.writestr(entry, contents)
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Without it, pip would build the package to learn its name."""
    folder = pathlib.Path(metadata_directory) / f"manycontact-{_version()}.dist-info"
    folder.mkdir()
    for name, contents in _info().items():
        (folder / name).write_bytes(contents)
    return folder.name


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    package = _built(config_settings) / "manycontact"
    files = sorted(p for p in package.iterdir() if p.suffix in (".py", ".pyi", ".so", ".typed"))
    return _write(wheel_directory, {f"manycontact/{p.name}": p.read_bytes() for p in files})


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """The build folder on the interpreter's path: what is built there next is what is imported."""
    return _write(wheel_directory, {"manycontact.pth": f"{_built(config_settings)}\n".encode()})


def _sources():
    """Paths of the source tree: those that git knows, or in an unpacked archive all but builds."""
    listed = shutil.which("git") and subprocess.run(["git", "-C", TOP, "ls-files", "-z"], capture_output=True)
    if listed and listed.returncode == 0:
        return [p for p in listed.stdout.decode().split("\0") if p and (TOP / p).is_file()]
    files = (p.relative_to(TOP) for p in TOP.rglob("*") if p.is_file() or p.is_symlink())
    return sorted(str(p) for p in files if p.parts[0] != "build" and "__pycache__" not in p.parts)


def build_sdist(sdist_directory, config_settings=None):
    """The source archive: for pip (PKG-INFO), for colcon (package.xml) and for CMake."""
    name = f"manycontact-{_version()}"
    package = (TOP / "src/package/package.xml.in").read_text().replace("@VERSION@", _version())
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as out:
        for path in _sources():
            if path not in ("PKG-INFO", "package.xml"):
                out.add(TOP / path, f"{name}/{path}", recursive=False)
        for path, text in (("PKG-INFO", _metadata()), ("package.xml", package)):
            entry = tarfile.TarInfo(f"{name}/{path}")
            entry.size = len(text.encode())
            out.addfile(entry, io.BytesIO(text.encode()))
    return f"{name}.tar.gz"


if __name__ == "__main__":
    for build in (build_sdist, build_wheel):
        print(build(sys.argv[1], dict(word.split("=", 1) for word in sys.argv[2:])))
