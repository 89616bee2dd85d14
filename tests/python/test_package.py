"""pip installs the package from the source tree, without a network and into a fresh environment."""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import xml.etree.ElementTree
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
    """Returns the interpreter of a virtual environment with the system's numpy, without this test's paths."""
    if not (BUILD / "CMakeCache.txt").exists() or not all(map(importlib.util.find_spec, ("pip", "ensurepip"))):
        pytest.skip("no build folder, or no pip and venv")
    folder = tmp_path_factory.mktemp("venv")
    run(sys.executable, "-m", "venv", "--system-site-packages", str(folder))
    return folder / "bin" / "python"


def pip(python, *arguments):
    common = ["--no-index", "--quiet", "--disable-pip-version-check", "--config-settings", f"build-dir={BUILD}"]
    return run(str(python), "-m", "pip", arguments[0], *common, *arguments[1:], str(ROOT))


def test_the_wheel_holds_what_it_should(environment, tmp_path):
    pip(environment, "wheel", "--no-deps", "--wheel-dir", str(tmp_path))
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        assert archive.testzip() is None
        names = set(archive.namelist())
        info = f"manycontact-{mc.__version__}.dist-info/"
        module = pathlib.Path(mc._manycontact.__file__).name
        expected = {"__init__.py", "_classes.py", "descriptions.py", "files.py", "mcap.py", "notebook.py", "torch.py", "__init__.pyi", "py.typed", module}
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


BACKEND = "import sys; sys.path[0:0] = [sys.argv[1]]; import cmake_wheel; "


def test_metadata_need_no_build(tmp_path):
    """pip learns name, version and requirements at once."""
    ask = BACKEND + "print(cmake_wheel.prepare_metadata_for_build_wheel(sys.argv[2]))"
    name = run(sys.executable, "-B", "-c", ask, str(ROOT / "src/python/packaging"), str(tmp_path)).strip()
    assert name == f"manycontact-{mc.__version__}.dist-info"
    metadata = (tmp_path / name / "METADATA").read_text()
    assert "\nName: manycontact\n" in metadata and "\nRequires-Dist: numpy\n" in metadata
    assert {p.name for p in (tmp_path / name).iterdir()} == {"METADATA", "WHEEL", "LICENSE", "LICENCES.txt"}


@pytest.mark.parametrize("numpy", [True, False])
def test_stubs_are_left_out_without_numpy(tmp_path, numpy):
    """An interpreter without numpy cannot import the module, from which stubs are written."""
    if not numpy:
        (tmp_path / "numpy.py").write_text("raise ImportError")
    off = [f"-DMANYCONTACT_{part}=OFF" for part in ("TESTS", "CHART", "BENCH")]
    configure = ["cmake", "-S", str(ROOT), "-B", str(tmp_path / "build"), "-DMANYCONTACT_PYTHON=ON", *off]
    done = subprocess.run(configure, env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True, text=True, check=True)
    assert ("no type stubs" in done.stdout) != numpy


# ---- the source archive ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """Returns the top folder of the unpacked source archive of cmake_wheel.py."""
    folder = tmp_path_factory.mktemp("archive")
    backend = BACKEND + "print(cmake_wheel.build_sdist(sys.argv[2]))"
    name = run(sys.executable, "-B", "-c", backend, str(ROOT / "src/python/packaging"), str(folder)).strip()
    assert name == f"manycontact-{mc.__version__}.tar.gz"
    with tarfile.open(folder / name) as archive:
        archive.extractall(folder)
    return folder / name.removesuffix(".tar.gz")


def test_version_is_the_same_everywhere(unpacked):
    """Versions agree in CMake, Python, colcon, pip, CITATION.cff, the changelog and the README."""
    version = re.search(r"project\(manycontact\s+VERSION\s+([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert mc.__version__ == version
    assert xml.etree.ElementTree.parse(unpacked / "package.xml").findtext("version") == version
    assert f"\nVersion: {version}\n" in (unpacked / "PKG-INFO").read_text()
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n## [{version}]" in (ROOT / "CHANGELOG.md").read_text()
    assert f"Version {version}" in (ROOT / "README.md").read_text()


def test_the_archive_configures_and_packs_itself(unpacked, tmp_path):
    """CMake finds all that it needs in the archive; an archive of it is the same, without git."""
    off = [f"-DMANYCONTACT_{part}=OFF" for part in ("TESTS", "CHART", "BENCH")]
    run("cmake", "-S", str(unpacked), "-B", str(tmp_path / "build"), "-DCMAKE_BUILD_TYPE=Release", *off)
    backend = BACKEND + "print(cmake_wheel.build_sdist(sys.argv[2]))"
    name = run(sys.executable, "-B", "-c", backend, str(unpacked / "src/python/packaging"), str(tmp_path)).strip()
    with tarfile.open(tmp_path / name) as again, tarfile.open(unpacked.parent / name) as first:
        assert set(again.getnames()) == set(first.getnames())


def test_colcon_configures_the_package(unpacked, tmp_path):
    if not shutil.which("colcon"):
        pytest.skip("no colcon")
    off = [f"-DMANYCONTACT_{part}=OFF" for part in ("TESTS", "CHART", "BENCH")]
    choose = ["--base-paths", str(unpacked), "--packages-select", "manycontact"]
    done = run("colcon", "build", *choose, "--cmake-target", "help", "--cmake-args", *off, cwd=tmp_path)  # configures, compiles nothing
    assert "Finished <<< manycontact" in done
    assert (tmp_path / "build/manycontact/CMakeCache.txt").exists()
