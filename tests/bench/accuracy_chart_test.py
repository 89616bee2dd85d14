"""bench/collection/chart.py: dials move the error as they must, and the chart names its lines.

    accuracy_chart_test.py BIN     the folder of the programs
"""

import csv
import pathlib
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv[1])


def check(holds, what):
    if not holds:
        sys.exit(f"accuracy_chart_test.py: {what}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        command = [sys.executable, str(TOP / "bench/collection/chart.py"), str(TOP / "models/arm_pushes_box.xml"), "--out", folder]
        done = subprocess.run([*command, "--bin", str(BIN), "--results", "none"], text=True, capture_output=True)
        check(done.returncode == 0, done.stderr)
        rows = list(csv.DictReader(open(out / "accuracy.csv")))
        errors = {(r["line"], r["dial"]): float(r["error"]) for r in rows}
        check(errors["manycontact, whole solve", ""] < 1e-12, errors)
        damped = [error for (line, _), error in errors.items() if line.startswith("manycontact, damping")]
        check(len(damped) == 5 and damped == sorted(damped), f"more damping, less error: {damped}")
        check(10 < damped[-1] / damped[-2] < 1000, f"a hundredfold damping, another error: {damped}")
        check(all(float(r["time_us"]) > 0 for r in rows), "a time is missing")
        if (BIN / "manycontact_collection").exists():
            refined = [errors["the same, K damped by 1e-5 in the factor", str(k)] for k in range(3)]
            check(refined[2] < 1e-3 * refined[1] < 1e-6 * refined[0], f"refinement gains too little: {refined}")
            check(errors["LAPACK's dsysv of K", ""] < 1e-10, errors)
        svg = (out / "accuracy_arm_pushes_box.svg").read_text()
        for text in ("manycontact, whole solve", "13 velocities, 6 contact rows", "lower is more accurate"):
            check(text in svg, f"the chart lacks {text!r}")
        check("accuracy_arm_pushes_box.svg" in (out / "README.md").read_text(), "the page lacks the chart")


if __name__ == "__main__":
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        print("skipped: Python has no matplotlib")
        sys.exit(77)
    if not (BIN / "manycontact-chart").exists():
        print("skipped: manycontact-chart was not built")
        sys.exit(77)
    main()
