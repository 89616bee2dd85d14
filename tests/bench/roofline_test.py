"""manycontact_roofline: every row is there, and operations grow with the robots.

    roofline_test.py BIN     the folder of the programs
"""

import pathlib
import subprocess
import sys

PROGRAM = pathlib.Path(sys.argv[1]) / "manycontact_roofline"
ROWS = ("1 robot, solve", "1 robot, vjp", "1 robot, derivatives", "256 robots, solve", "256 robots, vjp", "256 robots, derivatives",
        "ring of 1,024, solve", "ring of 1,024, vjp")


def check(holds, what):
    if not holds:
        sys.exit(f"roofline_test.py: {what}")


def main():
    done = subprocess.run([str(PROGRAM), "--quick"], text=True, capture_output=True)
    check(done.returncode == 0, done.stderr)
    rows = {cells[1].strip(): cells[2:-1] for cells in (line.split("|") for line in done.stdout.splitlines()) if len(cells) > 3}
    check(all(name in rows for name in ROWS), done.stdout)
    operations = {name: float(rows[name][1]) for name in ROWS}
    check(all(float(rows[name][0]) > 0 and operations[name] > 0 for name in ROWS), done.stdout)
    # between the operations of the dense factor of K alone, (38 + 12)^3 / 3, and none
    check(0.01 < operations["1 robot, solve"] < 0.2, done.stdout)
    for of in ("solve", "vjp", "derivatives"):  # a batch may refine less
        check(128 < operations[f"256 robots, {of}"] / operations[f"1 robot, {of}"] < 260, done.stdout)
    check(operations["1 robot, derivatives"] > operations["1 robot, solve"] > operations["1 robot, vjp"], done.stdout)


if __name__ == "__main__":
    if not PROGRAM.exists():
        print("skipped: manycontact_roofline was not built")
        sys.exit(77)
    main()
