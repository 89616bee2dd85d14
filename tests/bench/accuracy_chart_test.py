"""bench/collection/chart.py: dials move the error as they must, and the chart names its lines. The charts of the README and of the
stability page can be drawn from the numbers that are kept.

    accuracy_chart_test.py BIN     the folder of the programs
"""

import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "bench/collection"))
PEER = """#!{python}
import json, subprocess, sys
words = dict(zip(sys.argv[1::2], sys.argv[2::2]))
command = ["{bin}/manycontact", "solve", words["--scene"], "--precision", "extended", "--json", "-"]
a = json.loads(subprocess.run(command, capture_output=True).stdout)["acceleration"]
open(words["--out"], "w").write("\\n".join(repr(x * (1 + float(words["--task"].split(":")[1]))) for x in a))
print(12.5)
"""
BIN = pathlib.Path(sys.argv[1])


def check(holds, what):
    if not holds:
        sys.exit(f"accuracy_chart_test.py: {what}")


def check_kept():
    import overview

    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        scripts = TOP / "bench/collection"
        kept = shutil.copy(TOP / "bench/charts/overview.csv", out)
        for command in ([sys.executable, scripts / "overview.py", "--draw", "--out", out], [sys.executable, scripts / "stability.py", "--out", out]):
            done = subprocess.run(command, text=True, capture_output=True)
            check(done.returncode == 0, done.stderr)
        for name in ("overview", "factorizations", "error_over_condition", "error_over_bound"):
            check((out / f"{name}.png").read_bytes().startswith(b"\x89PNG"), f"no picture {name}")
        rows = list(csv.DictReader(open(kept)))
        for scene in ("humanoid", "ring_8", "corners"):
            check(float(re.search(r"([\d.]+) times as fast", overview.finding(rows, scene))[1]) > 1, f"the title of {scene} is not true")
        extended = [float(r["error"]) for r in rows if (r["line"], r["dial"]) == ("manycontact", "extended")]
        check(len(extended) == 4 and max(extended) < 4 * 2.0**-52, f"the README's chart, extended: {extended}")


def check_peer():
    """A program that writes accelerations in the scene's order is compared with the scene's solution."""
    import run

    with tempfile.TemporaryDirectory() as folder:
        bin, system = pathlib.Path(folder) / "bin", pathlib.Path(folder) / "system"
        bin.mkdir(), system.mkdir()
        for program in ("manycontact", "manycontact-chart"):
            (bin / program).symlink_to(BIN.resolve() / program)
        peer = bin / "manycontact_bench_peer"
        peer.write_text(PEER.format(python=sys.executable, bin=BIN.resolve()))
        peer.chmod(0o755)
        text = (TOP / "models/arm_pushes_box.xml").read_text().replace('urdf="', f'urdf="{TOP}/models/')
        (system / "scene.xml").write_text(text)
        subprocess.run([bin / "manycontact", "export", "scene.xml", "--out", ".", "--truth"], cwd=system, check=True, capture_output=True)
        for wrong in ("0", "1e-3"):
            name = f"peer:peer:task:{wrong}"
            result = run.judge(run.System(system, "arm"), run.solvers([name], bin)[name][1], folder, run.given_the_scene(name))
            check(not isinstance(result, str), result)
            (a, f, *_), time = result
            right = a < 4 * 2.0**-52 if wrong == "0" else 1e-4 < a < 1e-2
            check(right and f is None and time == 12.5, f"a peer that is wrong by {wrong}: {result}")


def main():
    check_kept()
    check_peer()
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        command = [sys.executable, str(TOP / "bench/collection/chart.py"), str(TOP / "models/arm_pushes_box.xml"), "--out", folder]
        done = subprocess.run([*command, "--bin", str(BIN)], text=True, capture_output=True)
        check(done.returncode == 0, done.stderr)
        rows = list(csv.DictReader(open(out / "accuracy.csv")))
        errors = {(r["line"], r["dial"]): float(r["error"]) for r in rows}
        by_precision = {dial: error for (line, dial), error in errors.items() if line == "manycontact, whole solve, by precision"}
        check(by_precision["double"] < 1e-12, errors)
        check(by_precision["extended"] < 4 * 2.0**-52, f"extended lacks the last digits of the scene: {by_precision}")
        check("single" not in by_precision, "an arm and a box that touch are not solved in single")
        damped = [error for (line, _), error in errors.items() if line.startswith("manycontact, damping")]
        check(len(damped) == 5 and damped == sorted(damped), f"more damping, less error: {damped}")
        check(10 < damped[-1] / damped[-2] < 1000, f"a hundredfold damping, another error: {damped}")
        check(all(float(r["time_us"]) > 0 for r in rows), "a time is missing")
        if (BIN / "manycontact_collection").exists():
            refined = [errors["the same, K damped by 1e-5 in the factor", str(k)] for k in range(3)]
            check(refined[2] < 1e-3 * refined[1] < 1e-6 * refined[0], f"refinement gains too little: {refined}")
            check(errors["LAPACK's dsysv of K", ""] < 1e-10, errors)
        svg = (out / "accuracy_arm_pushes_box.svg").read_text()
        for text in ("manycontact, whole solve, by precision", "13 velocities, 6 contact rows", "lower is more accurate"):
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
