"""What a call from Python costs beside the same in C++, us: `./run build --python`, then

    python_overhead.py [SCENE...]

The program's `solve --repeat` is the C++ side. Both alternate, and the smallest of each counts: other work on the machine
only adds.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"
ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "build/release/python"))

import manycontact as mc  # noqa: E402

ROUNDS, CALLS = 10, 200


def program_times(scene):
    """Returns medians of solve and of derivatives."""
    with tempfile.TemporaryDirectory() as folder:
        out = folder + "/out.json"
        program = str(ROOT / "build/release/bin/manycontact")
        run = [program, "solve", scene, "--derivatives", "--repeat", str(CALLS), "--json", out]
        subprocess.run(run, check=True, capture_output=True)
        times = json.loads(pathlib.Path(out).read_text())["report"]["time_us"]
    return times["solve"], times["derivatives"]


def shortest(call):
    """Returns medians of single calls, minus the clock's own time."""
    best = clock = float("inf")
    for _ in range(CALLS):
        start = time.perf_counter_ns()
        call()
        end = time.perf_counter_ns()
        best, clock = min(best, end - start), min(clock, time.perf_counter_ns() - end)
    return (best - clock) / 1e3


def measure(path):
    file = mc.load_scene(path)
    scene, q, v, u = file.scene, file.q, file.v, file.u
    data = mc.SceneData(scene)
    mc.solve(scene, q, v, u, data)
    blocks = mc.differentiate(scene, data).islands[0]
    calls = {
        "solve": lambda: mc.solve(scene, q, v, u, data),
        "differentiate": lambda: mc.differentiate(scene, data),
        "one block": lambda: blocks.da_dq,
        "data.a": lambda: data.a,
    }
    python = {name: float("inf") for name in calls}
    cpp = [float("inf")] * 2
    for _ in range(ROUNDS):
        cpp = [min(a, b) for a, b in zip(cpp, program_times(path))]
        for name, call in calls.items():
            python[name] = min(python[name], shortest(call))
    print(f"{pathlib.Path(path).stem}, nv = {scene.nv}")
    for name, theirs in zip(("solve", "differentiate"), cpp):
        ours = python[name]
        print(f"  {name:14} Python {ours:8.2f}   C++ {theirs:8.2f}   overhead {ours - theirs:6.2f}")
    for name in ("one block", "data.a"):
        print(f"  {name:14} Python {python[name]:8.2f}")


for scene in sys.argv[1:] or [str(ROOT / "models/humanoid_standing.xml")]:
    measure(scene)
