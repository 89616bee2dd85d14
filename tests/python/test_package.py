"""pip installs the package from the source tree, without a network and into a fresh environment."""

import importlib.util
import os
import pathlib
import subprocess
import sys
import zipfile

import manycontact as mc
import pytest
from conftest import MODELS, ROOT

BUILD = pathlib.Path(mc.__file__).parents[2]


def run(*command, **keywords):
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PIP"))}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, **keywords)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Of a virtual environment, which sees the system's numpy: its interpreter, without this test's paths."""
    if not (BUILD / "CMakeCache.txt").exists() or not all(map(importlib.util.find_spec, ("pip", "ensurepip"))):
        pytest.skip("no build folder, or no pip and venv")
    folder = tmp_path_factory.mktemp("venv")
    run(sys.executable, "-m", "venv", "--system-site-packages", str(folder))
    return folder / "bin" / "python"


def pip(python, *arguments):
    common = ["--no-index", "--quiet", "--disable-pip-version-check", "--config-settings", f"build-dir={BUILD}"]
    return run(str(python), "-m", "pip", arguments[0], *common, *arguments[1:], str(ROOT / "src/python"))


def test_the_wheel_holds_what_it_should(environment, tmp_path):
    pip(environment, "wheel", "--no-deps", "--wheel-dir", str(tmp_path))
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        assert archive.testzip() is None
        names = set(archive.namelist())
        info = f"manycontact-{mc.__version__}.dist-info/"
        module = pathlib.Path(mc._manycontact.__file__).name
        expected = {"__init__.py", "_classes.py", "notebook.py", "torch.py", "__init__.pyi", "py.typed", module}
        assert names == {"manycontact/" + n for n in expected} | {
            info + n for n in ("METADATA", "WHEEL", "RECORD", "LICENSE", "LICENCES.txt")
        }
        assert archive.read(info + "LICENSE") == (ROOT / "LICENSE").read_bytes()
        metadata = archive.read(info + "METADATA").decode()
        assert "License: BSD-3-Clause" in metadata and "Requires-Dist: numpy" in metadata
        assert "GPL" in archive.read(info + "LICENCES.txt").decode()


def test_import_after_pip_install(environment, tmp_path):
    program = f"""
import manycontact as mc, pathlib, sys
assert pathlib.Path(mc.__file__).is_relative_to(sys.prefix), mc.__file__
file = mc.load_scene({str(MODELS / "humanoid_standing.xml")!r})
print(mc.__version__, mc.solve(file.scene, file.q, file.v, file.u, mc.SceneData(file.scene)).status)
"""
    pip(environment, "install")
    assert run(str(environment), "-c", program, cwd=tmp_path).split() == [mc.__version__, "ok"]
    shown = run(str(environment), "-m", "pip", "show", "--files", "manycontact", cwd=tmp_path)
    assert "py.typed" in shown and "LICENSE" in shown
    run(str(environment), "-m", "pip", "uninstall", "--yes", "--quiet", "manycontact", cwd=tmp_path)
    pip(environment, "install", "--editable")
    where = "import manycontact as mc; print(mc.__file__)"
    assert run(str(environment), "-c", where, cwd=tmp_path).strip() == mc.__file__
    run(str(environment), "-m", "pip", "uninstall", "--yes", "--quiet", "manycontact", cwd=tmp_path)
