"""The fuzzer runs for a short time, in a process of its own."""

import os
import pathlib
import subprocess
import sys

import manycontact as mc


def test_no_call_crashes(tmp_path):
    here = pathlib.Path(__file__).parent
    log = tmp_path / "last"
    package = str(pathlib.Path(mc.__file__).parents[1])
    environment = dict(os.environ, PYTHONPATH=package, FUZZ_LOG=str(log))
    run = subprocess.run(
        [sys.executable, str(here / "fuzz.py"), "1", "500"], capture_output=True, text=True, env=environment
    )
    assert run.returncode == 0, f"{log.read_text()}\n{run.stderr[-2000:]}"


def test_no_assignment_crashes(tmp_path):
    here = pathlib.Path(__file__).parent
    log = tmp_path / "last"
    environment = dict(os.environ, PYTHONPATH=str(pathlib.Path(mc.__file__).parents[1]), FUZZ_LOG=str(log))
    run = subprocess.run([sys.executable, str(here / "assign.py")], capture_output=True, text=True, env=environment)
    assert run.returncode == 0, f"{log.read_text() if log.exists() else ''}\n{run.stderr[-2000:]}"
    assert run.stdout.endswith(" assignments\n")
