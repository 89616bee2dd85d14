"""The runner of bench/collection judges right and wrong solvers, and the stored systems are complete."""

import importlib.util
import pathlib
import stat
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
RUN = TOP / "bench" / "collection" / "run.py"
MATRICES = RUN.parent / "matrices"

SOLVER = """#!{python}
import sys
import numpy as np

def lines(path):
    return [line for line in open(path) if not line.startswith("%")]

head, *entries = lines(sys.argv[1])
n = int(head.split()[0])
K = np.zeros((n, n))
for line in entries:
    i, j, value = line.split()
    K[int(i) - 1, int(j) - 1] = K[int(j) - 1, int(i) - 1] = float(value)
b = np.array([float(line) for line in lines(sys.argv[2])[1:]])
x = np.linalg.solve(K, b)
{spoil}
np.savetxt(sys.argv[3], x)
print(12.5)
"""


def solver(folder, name, spoil=""):
    path = pathlib.Path(folder) / name
    path.write_text(SOLVER.format(python=sys.executable, spoil=spoil))
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def rows(page, system):
    """Returns {solver: cells} of a system's table."""
    part = page.split(f"\n### {system}\n")[1].split("\n### ")[0]
    cells = [[c.strip() for c in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| ")]
    return {row[0]: row[1:] for row in cells if row[0] != "solver"}


def run(*words):
    return subprocess.run([sys.executable, str(RUN), *words], text=True, capture_output=True)


def check(holds, what):
    if not holds:
        sys.exit(f"collection_test.py: {what}")


def check_solvers():
    with tempfile.TemporaryDirectory() as folder:
        good = solver(folder, "good")
        wrong = solver(folder, "wrong", "x[0] *= 1 + 1e-3")
        short = solver(folder, "short", "x = x[1:]")
        broken = solver(folder, "broken", "sys.exit('no pivot | left')")
        nothing = solver(folder, "nothing", "x[0] = np.nan")
        chosen = [str(MATRICES / name) for name in ("humanoid", "points_10um", "corners")]
        done = run("--solver", good, wrong, short, broken, nothing, "--systems", *chosen)
        check(done.returncode == 0, done.stderr)
        table = rows(done.stdout, "humanoid")
        a, f, normwise, componentwise = (float(x) for x in table["good"][:4])
        check(a < 1e-9 and f < 1e-9 and normwise < 1e-15 and componentwise < 1e-9, f"a right solution is judged wrong: {table['good']}")
        check(table["good"][4] == "12.5", "the time is not what the program printed")
        check(float(table["wrong"][0]) > 1e-7 and float(table["wrong"][3]) > 1e-7, f"a wrong solution is judged right: {table['wrong']}")
        check("numbers, expected" in table["short"][0], table["short"])
        check(table["broken"][0] == "no pivot / left", table["broken"])
        check(table["nothing"][0] == "not a number", table["nothing"])
        worse = float(rows(done.stdout, "points_10um")["good"][0])
        check(1e-15 < worse < 1e-4, f"points_10um: {worse}, expected an error that its condition of 1e11 explains")


def check_usage():
    done = run("--solver", "nobody")
    check(done.returncode != 0 and len(done.stderr.splitlines()) == 1 and "no solver 'nobody'" in done.stderr, done.stderr)
    done = run("--solver", sys.executable, "--systems", str(TOP / "models"))
    check(done.returncode != 0 and "no systems in" in done.stderr, done.stderr)


def check_kept():
    """Every system's x solves its K x = b to far more digits than doubles have, if K is regular."""
    spec = importlib.util.spec_from_file_location("run", RUN)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    systems = module.find_systems([MATRICES])
    check(len(systems) >= 10, f"{len(systems)} systems")
    for system in systems:
        *_, normwise, _ = module.errors(system, system.x)
        check(normwise < (1e-15 if system.rank < system.nc else 1e-18), f"{system.name}: x has a backward error of {normwise}")
    sizes = sum(p.stat().st_size for p in MATRICES.rglob("*"))
    check(sizes < 1e6, f"{sizes} bytes are kept, expected small systems alone")


if __name__ == "__main__":
    try:
        import numpy  # noqa: F401
    except ImportError:
        print("skipped: Python has no numpy")
        sys.exit(77)
    check_solvers()
    check_usage()
    check_kept()
