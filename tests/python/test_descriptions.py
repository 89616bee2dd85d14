"""Robots of robot_descriptions by name, with a package of that name that needs no network."""

import importlib
import os
import subprocess
import sys

import manycontact as mc
import pytest
from conftest import MODELS


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package like robot_descriptions: a robot, one of MuJoCo alone, one without a URDF, one without a network."""
    folder = tmp_path / "robot_descriptions"
    folder.mkdir()
    (folder / "__init__.py").touch()
    robot = f"REPOSITORY_PATH = {str(MODELS.parent)!r}\nPACKAGE_PATH = {str(MODELS)!r}\n"
    for name in ("dog", "dogs"):
        (folder / f"{name}_description.py").write_text(robot + f"URDF_PATH = {str(MODELS / 'quadruped.urdf')!r}\n")
    (folder / "cat_mj_description.py").write_text("MJCF_PATH = 'cat.xml'\n")
    (folder / "cow_description.py").write_text("XACRO_PATH = 'cow.xacro'\n")
    (folder / "far_description.py").write_text("raise OSError('git: no route to host')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/before")
    importlib.invalidate_caches()
    yield folder
    for name in [x for x in sys.modules if x.partition(".")[0] == "robot_descriptions"]:
        del sys.modules[name]


@pytest.mark.parametrize("name", ["dog", "dog_description"])
def test_a_robot_by_name(package, name):
    robot = mc.load_description(name, floating_base=True)
    assert (robot.nv, robot.mass()) == (18, pytest.approx(30))
    assert mc.load_description(name).nv == 12
    assert mc.description_path(name) == str(MODELS / "quadruped.urdf")


def test_folders_of_meshes_are_added_once(package):
    for _ in range(2):
        mc.description_path("dog")
    assert os.environ["ROS_PACKAGE_PATH"] == f"/before:{MODELS.parent}:{MODELS}:{MODELS.parent.parent}"


def test_near_names(package):
    with pytest.raises(mc.InputError, match="'dok': did you mean (dog or dogs|dogs or dog)"):
        mc.load_description("dok")
    with pytest.raises(mc.InputError, match="'elephant': it has 4 robots, for instance cow, dog, dogs, far"):
        mc.load_description("elephant")


def test_other_formats_and_downloads(package):
    with pytest.raises(mc.InputError, match="no URDF of 'cat'"):
        mc.load_description("cat")
    with pytest.raises(mc.InputError, match="no URDF of 'cow', only a xacro file, cow.xacro: expand the file"):
        mc.load_description("cow")
    with pytest.raises(RuntimeError, match="'far' could not be loaded.*OSError: git: no route to host"):
        mc.load_description("far")


def test_the_missing_package_is_named(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match="pip install robot_descriptions"):
        mc.load_description("go2")


def test_meshes_of_a_robot_are_found(package, tmp_path, program):
    """As on the page gallery.md; the meshes are in no folder above the URDF."""
    meshes = tmp_path / "packages" / "cube_meshes"
    meshes.mkdir(parents=True)
    (meshes / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    urdf = tmp_path / "cube" / "cube.urdf"
    urdf.parent.mkdir()
    urdf.write_text(
        '<robot name="cube"><link name="cube"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
        'iyz="0"/></inertial><visual><geometry><mesh filename="package://cube_meshes/m.obj"/></geometry></visual></link></robot>'
    )
    (package / "cube_description.py").write_text(f"PACKAGE_PATH = {str(meshes)!r}\nURDF_PATH = {str(urdf)!r}\n")
    scene = mc.Scene()
    mc.add_robot(scene, "robot", mc.load_description("cube", floating_base=True))
    path = tmp_path / "cube.xml"
    file = mc.write_scene(str(path), scene, {"robot": mc.description_path("cube")})
    assert "cube" in mc.view(file).html
    view = [program, "view", str(path), "--out", str(tmp_path / "cube.html")]
    found = subprocess.run(view, capture_output=True, text=True)
    missing = subprocess.run(view, capture_output=True, text=True, env={**os.environ, "ROS_PACKAGE_PATH": ""})
    assert "m.obj (not found)" in missing.stdout + missing.stderr and "not found" not in found.stdout + found.stderr
