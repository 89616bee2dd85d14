"""The programs of src/python/examples give their documented results."""

import importlib.util
import os
import re
import subprocess
import sys

import manycontact as mc
import pytest
from conftest import MODELS, ROOT

EXAMPLES = ROOT / "src" / "python" / "examples"


def run(name, *arguments, needs=()):
    for module in needs:
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed")
    path = str(os.path.dirname(os.path.dirname(mc.__file__)))
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), *map(str, arguments)],
        capture_output=True, text=True, env=dict(os.environ, PYTHONPATH=path),
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def numbers(pattern, text):
    return [float(x) for x in re.search(pattern, text).groups()]


def test_all_are_run():
    run_here = {"standing.py"}  # in CMake's test python/example
    run_here |= set(re.findall(r'run\("(\w+\.py)"', open(__file__).read()))
    assert run_here == {path.name for path in EXAMPLES.glob("*.py")}


def test_whole_body_controller():
    out = run("whole_body_controller.py", MODELS / "humanoid_standing.xml")
    assert numbers(r"within ([\d.]+) mm", out)[0] < 5


def test_push_withstood():
    lines = run("push_withstood.py", MODELS / "humanoid_pushed.xml").splitlines()
    assert len(lines) == 9
    for line in lines[1:]:
        borne, too_much = numbers(r"deg +([\d.]+) N +([\d.]+) N", line)
        assert 5 < borne <= too_much < 500 and too_much - borne <= 0.11 and "tips" in line


def test_herd_trots():
    out = run("herd_trots.py", MODELS / "tasks" / "herd_trots.xml")
    simulated, planned = numbers(r"forward by ([\d.]+) m, the plan's ([\d.]+) m", out)
    assert abs(simulated - planned) < 0.01 and planned > 0.05


def test_batch_through_torch():
    assert "10000 states" in run("batch_through_torch.py", MODELS / "arm_pushes_box.xml", needs=["torch"])


def test_with_jax():
    run("with_jax.py", MODELS / "arm.urdf", needs=["jax"])


def test_beside_pinocchio():
    out = run("beside_pinocchio.py", MODELS / "humanoid.urdf", "left_sole", "right_sole")
    solve, derivatives = numbers(r"manycontact \S+: solve (\S+) us, derivatives (\S+) us", out)
    assert solve > 0 and derivatives > 0
    if importlib.util.find_spec("pinocchio") is None:
        assert "Pinocchio is missing" in out
    else:
        assert all(float(x) < 1e-9 for x in re.findall(r"differs by (\S+)", out)) and out.count("differs by") == 5
