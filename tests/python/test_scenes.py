"""Scenes are read from files and text, and built in code; bad ones are refused."""

import copy
import pickle

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS


def test_built_in_code():
    """The README's second program: a humanoid lets a crate go."""

    def load(urdf):
        return mc.load_urdf(str(MODELS / urdf), floating_base=True)

    scene = mc.Scene("crate")
    mc.add_robot(scene, "humanoid", load("humanoid.urdf"), mc.SE3(p=[0, 0, 0.7884]))
    mc.add_robot(scene, "crate", load("box.urdf"), mc.SE3(p=[0.31, 0.2, 0.75]))
    for side in ("left", "right"):
        mc.add_contact(scene, mc.Contact(name=side, A=mc.attach(scene, "humanoid", side + "_sole")))
    hand = mc.add_contact(
        scene,
        mc.Contact(
            name="hand",
            reference_frame=mc.ReferenceFrame.LOCAL_WORLD_ALIGNED,
            A=mc.attach(scene, "crate", "face_top"),
            B=mc.attach(scene, "humanoid", "left_hand"),
        ),
    )
    q, v = mc.neutral(scene), np.zeros(scene.nv)
    for side in ("left", "right"):
        q[mc.q_index(scene, "humanoid", side + "_hip_pitch")] = -0.4
        q[mc.q_index(scene, "humanoid", side + "_knee")] = 0.8
        q[mc.q_index(scene, "humanoid", side + "_ankle_pitch")] = -0.4
    q[mc.q_index(scene, "humanoid", "left_elbow")] = -1.57
    mc.resolve_references(scene, q)
    data = mc.SceneData(scene)
    u = mc.quasi_static(scene, q, data)
    assert mc.solve(scene, q, v, u, data).status == mc.Status.OK
    assert mc.contact_force(scene, data, "hand")[2] == pytest.approx(62.784, abs=1e-9)
    assert np.linalg.norm(data.a) < 1e-9

    data.active[hand] = False
    assert mc.solve(scene, q, v, u, data).status == mc.Status.OK
    z = mc.v_index(scene, "crate", "root") + 2
    assert data.a[z] == pytest.approx(-9.81, abs=1e-12)

    through_time = mc.SimulationData(scene, q, v, "rk4", 1e-3)
    through_time.dynamics.active[hand] = False
    trajectory = mc.simulate(scene, u, through_time, 100, every=30)
    assert trajectory.status == mc.StepStatus.OK
    assert trajectory.t == pytest.approx([0, 0.03, 0.06, 0.09, 0.1])
    height = mc.q_index(scene, "crate", "root") + 2
    assert q[height] - trajectory.q[-1, height] == pytest.approx(0.5 * 9.81 * 0.1**2, abs=1e-9)


def test_text_and_file_are_one():
    path = MODELS / "humanoid_standing.xml"
    file, text = mc.load_scene(str(path)), mc.load_scene_text(path.read_text(), str(path))
    assert (file.q == text.q).all() and (file.u == text.u).all()
    with pytest.raises(mc.InputError, match=r"^somewhere/scene\.xml:1: ") as error:
        mc.load_scene_text("<scene><robot/></scene>", "somewhere/scene.xml")
    assert error.value.line == 1 and error.value.file == "somewhere/scene.xml"
    assert isinstance(error.value, ValueError)


def test_placements():
    M = mc.SE3.from_quaternion([0, 0, np.sin(0.3), np.cos(0.3)], [1, 2, 3])
    identity = M * M.inverse()
    assert np.allclose(identity.R, np.eye(3), atol=1e-15) and np.allclose(identity.p, 0, atol=1e-15)
    twist = np.arange(6.0)
    assert np.allclose(M.action() @ twist, M.act(twist), atol=1e-14)
    with pytest.raises(ValueError, match="read-only"):
        M.p[0] = 7


def test_rotations_are_taken_by_scipy():
    spatial = pytest.importorskip("scipy.spatial.transform")
    M = mc.SE3.from_quaternion([0, 0, np.sin(0.3), np.cos(0.3)])
    for R in M.R, M.rotation:
        turned = spatial.Rotation.from_matrix(R)  # scipy 1.10 accepts no read-only array
        np.testing.assert_allclose(turned.as_rotvec(), [0, 0, 0.6], atol=1e-15)
        with pytest.raises(TypeError, match="a copy"):
            R[0, 0] = 7
        own = R.copy()
        own[0, 0], (R @ R)[0, 0], (R[0] + 1)[0] = 7, 7, 7
        assert type(R.sum()) is np.float64 and pickle.loads(pickle.dumps(R))[0, 0] == R[0, 0] == pytest.approx(np.cos(0.6))


def test_views_are_of_files(humanoid):
    with pytest.raises(TypeError, match="a SceneFile of load_scene is expected, not Scene"):
        mc.view(humanoid[0].scene)


def test_what_changes_under_data_in_use(humanoid):
    file, data = humanoid
    scene = copy.copy(file.scene)
    moved = mc.SE3(p=scene.contact("left").B.placement.p + [0, 0, 0.01])
    mc.solve(scene, file.q, file.v, file.u, data)
    before = data.a
    scene.change_contact("left", placement=moved, gains=(100, 20))
    mc.solve(scene, file.q, file.v, file.u, data)
    assert (data.a != before).any()
    assert scene.contact("left").alpha == 100
    mc.add_robot(scene, "box", mc.load_urdf(str(MODELS / "box.urdf"), floating_base=True))
    with pytest.raises(ValueError, match="make new data"):
        mc.solve(scene, file.q, file.v, file.u, data)


@pytest.mark.parametrize(
    "bad, text",
    [
        (lambda f, d: mc.solve(f.scene, f.q[:3], f.v, f.u, d), "solve: q has 3 numbers, expected 39"),
        (lambda f, d: mc.solve(f.scene, f.q[:, None], f.v, f.u, d), r"not an array of shape \(39, 1\)"),
        (lambda f, d: mc.solve(f.scene, f.q, f.v, f.u * np.nan, d), r"u\[0\] is nan, a finite number is expected"),
        (lambda f, d: mc.solve(f.scene, f.q, f.v - np.inf, f.u, d), r"v\[0\] is -inf"),
        (lambda f, d: mc.differentiate(f.scene, d), "differentiate: there is no solution, call solve first"),
        (lambda f, d: mc.contact_force(f.scene, d, "lft"), "'left', 'right'"),
        (lambda f, d: mc.SE3(np.ones((3, 3))), "not a rotation"),
        (lambda f, d: mc.SE3(np.ones((3, 4))), r"shape \(3, 3\) is expected, not of \(3, 4\)"),
        (lambda f, d: mc.SE3.from_quaternion([1, 1, 0, 0]), "length 1.41"),
        (lambda f, d: mc.Options("sparse"), "unknown method 'sparse'"),
        (lambda f, d: mc.q_index(f.scene, "humanoid", "left_kne"), "left_knee"),
        (lambda f, d: mc.load_scene("nowhere.xml"), "^nowhere.xml:1: "),
        (lambda f, d: setattr(f.scene, "damping", -1), "damping"),
        (lambda f, d: setattr(f.scene, "gravity", [0, 0, np.nan]), "number 2 is nan"),
        (lambda f, d: mc.neutral(None), "incompatible"),
        (lambda f, d: mc.solve(f.scene, "abc", f.v, f.u, d), "incompatible"),
        (lambda f, d: mc.solve(f.scene, f.q * 1j, f.v, f.u, d), "incompatible"),
    ],
)
def test_refused(humanoid, bad, text):
    with pytest.raises((ValueError, TypeError), match=text):
        bad(*humanoid)


def test_any_array_of_numbers_will_do(humanoid):
    file, data = humanoid
    mc.solve(file.scene, file.q, file.v, file.u, data)
    expected = data.a
    strided = np.repeat(file.q, 2)[::2]
    assert not strided.flags.c_contiguous
    mc.solve(file.scene, strided, list(file.v), file.u.astype(">f8"), data)
    assert (data.a == expected).all()


def test_findings(tmp_path):
    """Questionable input in a URDF is accepted, and listed with file and line."""
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(
        """<robot name="r"><link name="a"/>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="5"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-Inf" upper="Inf" effort="2"/></joint>
</robot>"""
    )
    file = mc.load_scene_text('<scene><robot name="x" urdf="arm.urdf"/></scene>', str(tmp_path / "scene.xml"))
    assert [(f.kind, f.name, f.line) for f in file.findings] == [("inertia", "x/b", 2), ("limits", "x/j", 3)]
    assert file.findings[1].file == str(urdf)
    assert file.findings[1].text == "<limit> has no velocity, lower -Inf, upper Inf, where the joint is taken as unlimited"
    assert "arm.urdf:2: inertia: x/b: " in repr(file.findings[0])
    assert [f.name for f in mc.urdf_findings(str(urdf))] == ["b", "j"]
    assert np.isinf(mc.load_urdf(str(urdf)).joints[0].upper[0])
    with pytest.raises(mc.InputError, match=r"arm.urdf:2: .*violate the triangle inequality"):
        mc.load_urdf(str(urdf), refuse_inertia=True)
