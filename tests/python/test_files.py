"""Robots from text, limits as vectors, configurations of an SRDF, scenes of code as files."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS


def test_urdf_of_text():
    text = (MODELS / "quadruped.urdf").read_text()
    robot = mc.load_urdf_text(text, floating_base=True)
    assert (robot.nq, robot.nv, robot.mass()) == (19, 18, pytest.approx(30))
    with pytest.raises(mc.InputError, match="robot.urdf"):
        mc.load_urdf_text("<robot>")


def test_limits(humanoid):
    file, _ = humanoid
    limits = mc.joint_limits(file.scene)
    knee = mc.v_index(file.scene, "humanoid", "left_knee")
    joint = file.scene.robots[0].model.joints[mc.find_joint(file.scene, "left_knee")[1]]
    assert [x.shape for x in limits] == [(38,)] * 4
    assert np.isinf(limits.lower[:6]).all() and np.isinf(limits.effort[:6]).all()
    assert limits.upper[knee] == joint.upper[0] and limits.effort[knee] == joint.effort_limit[0]
    assert (mc.joint_limits(file.scene.robots[0].model).lower == limits.lower).all()


def test_srdf(tmp_path):
    path = tmp_path / "robot.srdf"
    path.write_text(
        '<robot name="r"><group_state name="half" group="a"><joint name="root" value="0 0 1 0 0 0 1"/></group_state>'
        '<group_state name="half" group="b"><joint name="knee" value="0.8"/></group_state></robot>'
    )
    assert mc.srdf_configurations(str(path)) == {"half": {"root": [0, 0, 1, 0, 0, 0, 1], "knee": [0.8]}}
    path.write_text("<robot>")
    with pytest.raises(mc.InputError, match="SRDF"):
        mc.srdf_configurations(str(path))


@pytest.mark.parametrize("name", ["two_humanoids_carry_beam", "arm_pushes_box", "quadruped_loop", "feet_on_corners"])
def test_written_scene_is_the_same(tmp_path, name):
    file = mc.load_scene(str(MODELS / f"{name}.xml"))
    urdfs = {"humanoid": "humanoid", "a": "humanoid", "b": "humanoid", "box": "box", "beam": "beam", "arm": "arm"}
    urdfs = {r.name: str(MODELS / (urdfs.get(r.name, "quadruped") + ".urdf")) for r in file.scene.robots}
    written = mc.write_scene(str(tmp_path / "scene.xml"), file.scene, urdfs, file.q, file.v, file.u)
    found = []
    for scene in file, mc.load_scene(written.path):
        data = mc.SceneData(scene.scene)
        mc.solve(scene.scene, scene.q, scene.v, scene.u, data)
        found.append((data.a, data.f))
    assert np.allclose(found[0][0], found[1][0], atol=1e-9) and np.allclose(found[0][1], found[1][1], atol=1e-9)


def test_what_a_file_would_not_have_is_refused(tmp_path):
    scene, urdf = mc.Scene(), str(MODELS / "humanoid.urdf")
    mc.add_robot(scene, "h", mc.load_urdf(urdf, floating_base=True, locked={"left_knee": 0.3}))
    path = tmp_path / "scene.xml"
    with pytest.raises(ValueError, match="locked"):
        mc.write_scene(str(path), scene, {"h": urdf})
    other = mc.Scene()
    mc.add_robot(other, "h", mc.load_urdf(urdf, floating_base=True).varied(mass=2))
    with pytest.raises(ValueError, match="varied"):
        mc.write_scene(str(path), other, {"h": urdf})
    with pytest.raises(ValueError, match="no path"):
        mc.write_scene(str(path), other, {})
    assert not path.exists()


def test_a_scene_of_code_is_viewed(tmp_path, program):
    scene = mc.Scene()
    mc.add_robot(scene, "dog", mc.load_urdf(str(MODELS / "quadruped.urdf"), floating_base=True, armature=0.01))
    mc.add_contact(scene, mc.Contact(name="LF", type="3d", A=mc.attach(scene, "dog", "LF_foot"), mu=0.7))
    q = mc.neutral(scene)
    mc.resolve_references(scene, q)
    written = mc.write_scene(str(tmp_path / "dog.xml"), scene, {"dog": str(MODELS / "quadruped.urdf")}, q)
    assert "LF" in mc.view(written).html
