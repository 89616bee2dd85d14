"""Dynamics, frames and totals of robots without contacts, contact Jacobians and inverse kinematics agree with an
independent reference, Pinocchio's figures if present, differences and the laws of mechanics."""

import importlib.util
import json

import manycontact as mc
import numpy as np
import pytest
from conftest import GOLDEN, MODELS

SHARED = GOLDEN.parent
H = 1e-6
AXES = ("local", "world", "local_world_aligned")


def state(bodies, seed=3):
    """Returns q, v, a and one more vector of nv numbers."""
    rng = np.random.default_rng(seed)
    q = mc.random_configuration(bodies, seed)
    nv = mc.crba(bodies, q).shape[0]
    return q, *(rng.uniform(-1, 1, nv) for _ in range(3))


def close(x, y, tolerance=1e-11):
    x, y = np.asarray(x), np.asarray(y)
    assert x.shape == y.shape
    assert np.abs(x - y).max() <= tolerance * max(1.0, np.abs(y).max()), np.abs(x - y).max()


def scene_of(*urdfs):
    scene = mc.Scene()
    for k, (urdf, floating) in enumerate(urdfs):
        model = mc.load_urdf(str(MODELS / urdf), floating_base=floating, armature=0.1)
        mc.add_robot(scene, f"r{k}", model, mc.SE3(p=[k, 2 * k, 0.3]))
    return scene


@pytest.fixture
def scene():
    return scene_of(("humanoid.urdf", True), ("arm.urdf", False), ("quadruped.urdf", True))


# ---- an independent reference --------------------------------------------------------------------------------------

LOCKED = {"humanoid.urdf": {"left_knee": 0.4, "waist_yaw": -0.3}, "quadruped.urdf": {}, "arm.urdf": {}}


@pytest.mark.parametrize("urdf, floating", [("humanoid.urdf", True), ("quadruped.urdf", True), ("arm.urdf", False)])
def test_the_reference(urdf, floating):
    path = SHARED / "reports" / "ref.py"
    if not path.exists():
        pytest.skip(f"{path} is not here")
    spec = importlib.util.spec_from_file_location("ref", path)
    ref = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(ref)
    locked = LOCKED[urdf]
    theirs = ref.Robot(str(MODELS / urdf), base="floating" if floating else "fixed", locked=locked)
    model = mc.load_urdf(str(MODELS / urdf), floating_base=floating, locked=locked)
    q, v, a, _ = state(model)
    M, h = theirs.M_h(q, v)[:2]
    close(mc.crba(model, q), M, 1e-12)
    close(mc.nonlinear_effects(model, q, v), h, 1e-12)
    close(mc.rnea(model, q, v, a), M @ a + h, 1e-12)
    close(mc.aba(model, q, v, M @ a + h), a, 1e-9)

    data = mc.RigidBodyData(model)
    mc.forward_kinematics(model, q, data, v)
    links = theirs.kin(q, v)
    assert set(links) <= set(mc.frame_names(model))
    for name, (R, p, Jw, Jp, w, velocity, alpha, acceleration) in links.items():
        place = mc.frame_placement(model, data, name)
        close(place.R, R, 1e-12)
        close(place.p, p, 1e-12)
        close(mc.frame_jacobian(model, data, name, "local_world_aligned"), np.vstack([Jp, Jw]), 1e-12)
        close(mc.frame_velocity(model, data, name, "local_world_aligned"), np.concatenate([velocity, w]), 1e-12)
        close(mc.frame_bias_acceleration(model, data, name, "local_world_aligned"), np.concatenate([acceleration, alpha]), 1e-11)
        spin = mc.frame_velocity(model, data, name)
        close(spin, np.concatenate([R.T @ velocity, R.T @ w]), 1e-12)
        if name in locked:
            assert name not in mc.joint_names(model)


# ---- Pinocchio's figures -------------------------------------------------------------------------------------------


def torques(scene, u):
    tau, names = np.zeros(scene.nv), mc.velocity_names(scene)
    for name, x in zip(mc.torque_names(scene), u):
        tau[names.index(name)] = x
    return tau


def test_pinocchios_accelerations():
    files = sorted((SHARED / "public").glob("*.xml"))
    if not files:
        pytest.skip("no public robots here")
    for path in files:
        file = mc.load_scene(str(path))
        expected = np.array(json.loads(path.with_suffix(".json").read_text())["acceleration"])
        tau = torques(file.scene, file.u)
        a = mc.aba(file.scene, file.q, file.v, tau)
        assert np.abs(a - expected).max() <= 1e-9 * np.abs(expected).max(), path.stem
        close(mc.rnea(file.scene, file.q, file.v, a), tau, 1e-9 * max(1, np.abs(a).max()))


def test_pinocchios_derivatives():
    path = GOLDEN / "talos_free.xml"
    if not path.exists():
        pytest.skip(f"{path} is not here")
    file, golden = mc.load_scene(str(path)), json.loads(path.with_suffix(".json").read_text())
    da_dq, da_dv, da_dtau = mc.aba_derivatives(file.scene, file.q, file.v, torques(file.scene, file.u))
    actuated = [mc.velocity_names(file.scene).index(name) for name in mc.torque_names(file.scene)]
    close(da_dq, golden["da_dq"], 1e-9)
    close(da_dv, golden["da_dv"], 1e-9)
    close(da_dtau[:, actuated], golden["da_du"], 1e-9)


# ---- laws ----------------------------------------------------------------------------------------------------------


def test_joint_space(scene):
    q, v, a, tau = state(scene)
    data = mc.RigidBodyData(scene)
    fext = np.random.default_rng(1).uniform(-1, 1, (mc.RigidBodies(scene, "r0").njoints + 7 + 13, 6))
    assert len(mc.joint_names(scene)) == len(fext)
    M = mc.crba(scene, q, data)
    close(mc.aba(scene, q, v, mc.rnea(scene, q, v, a, data, fext), data, fext), a, 1e-9)
    assert np.array_equal(mc.rnea(scene, q, v, a, data), mc.rnea(scene, q, v, a))
    assert np.array_equal(M, M.T)
    g = mc.gravity_torques(scene, q)
    close(mc.coriolis_matrix(scene, q, v) @ v + g, mc.nonlinear_effects(scene, q, v))
    zero = np.zeros(scene.nv)
    close(np.column_stack([mc.rnea(scene, q, zero, e, data) - g for e in np.eye(scene.nv)]), M)
    x = np.eye(scene.nv)[:, :5]
    close(M @ mc.inverse_inertia_times(scene, q, x), x, 1e-10)
    close(M @ mc.inverse_inertia_times(scene, q, tau, data), tau, 1e-10)
    assert mc.inverse_inertia_times(scene, q, tau).shape == (scene.nv,)


def test_derivatives(scene):
    q, v, a, tau = state(scene)

    def differences(f):
        dq = [(f(mc.integrate(scene, q, H * e), v) - f(mc.integrate(scene, q, -H * e), v)) / (2 * H) for e in np.eye(scene.nv)]
        dv = [(f(q, v + H * e) - f(q, v - H * e)) / (2 * H) for e in np.eye(scene.nv)]
        return np.column_stack(dq), np.column_stack(dv)

    dq, dv, da = mc.rnea_derivatives(scene, q, v, a)
    by_q, by_v = differences(lambda q, v: mc.rnea(scene, q, v, a))
    close(dq, by_q, 1e-7)
    close(dv, by_v, 1e-7)
    close(da, mc.crba(scene, q))
    dq, dv, dtau = mc.aba_derivatives(scene, q, v, tau)
    by_q, by_v = differences(lambda q, v: mc.aba(scene, q, v, tau))
    close(dq, by_q, 1e-5)
    close(dv, by_v, 1e-5)
    close(dtau, mc.inverse_inertia_times(scene, q, np.eye(scene.nv)))

    step = 0.3 * v
    q1 = mc.integrate(scene, q, step)
    by_q, by_step = mc.integrate_derivatives(scene, q, step)
    for k in (0, 4, scene.nv - 1):
        e = H * np.eye(scene.nv)[k]
        moved = mc.difference(scene, q1, mc.integrate(scene, mc.integrate(scene, q, e), step)) / H
        close(by_q[:, k], moved, 1e-5)
        close(by_step[:, k], mc.difference(scene, q1, mc.integrate(scene, q, step + e)) / H, 1e-5)
    by_q0, by_q1 = mc.difference_derivatives(scene, q, q1)
    close(by_q1 @ by_step, np.eye(scene.nv))  # one is the inverse of the other
    close(by_q0, -by_q1 @ by_q)
    close(mc.difference(scene, q, mc.interpolate(scene, q, q1, 0.5)), step / 2)


@pytest.mark.parametrize("axes", AXES)
def test_frames_move(scene, axes):
    q, v, a, _ = state(scene)
    data = mc.RigidBodyData(scene)
    frame = mc.attach(scene, "r0", "left_hand", mc.SE3(p=[0.1, 0.2, 0.3]))

    def velocity(t):
        mc.forward_kinematics(scene, mc.integrate(scene, q, t * v + t * t / 2 * a), data, v + t * a)
        return mc.frame_velocity(scene, data, frame, axes)

    rate = (velocity(H) - velocity(-H)) / (2 * H)
    mc.forward_kinematics(scene, q, data, v, a)
    J = mc.frame_jacobian(scene, data, frame, axes)
    close(J @ v, mc.frame_velocity(scene, data, frame, axes))
    close(J @ a + mc.frame_bias_acceleration(scene, data, frame, axes), rate, 1e-7)
    classical = mc.frame_classical_acceleration(scene, data, frame, axes)
    spatial = mc.frame_acceleration(scene, data, frame, axes)
    close(classical if axes == "local_world_aligned" else spatial, rate, 1e-7)


def test_the_whole(scene):
    q, v, a, _ = state(scene)
    data = mc.RigidBodyData(scene)

    def at(t):
        mc.forward_kinematics(scene, mc.integrate(scene, q, t * v + t * t / 2 * a), data, v + t * a, a)
        return mc.center_of_mass(scene, data), mc.centroidal_momentum(scene, data)

    (c1, h1), (c0, h0) = at(H), at(-H)
    c, h = at(0)
    close(mc.center_of_mass_velocity(scene, data), (c1 - c0) / (2 * H), 1e-7)
    close(mc.center_of_mass_jacobian(scene, data) @ v, mc.center_of_mass_velocity(scene, data))
    close(mc.centroidal_momentum_matrix(scene, data) @ v, h)
    close(mc.centroidal_momentum_rate(scene, data), (h1 - h0) / (2 * H), 1e-6)
    close(h[:3], mc.total_mass(scene) * mc.center_of_mass_velocity(scene, data))
    close(mc.centroidal_momentum_rate(scene, data)[:3], mc.total_mass(scene) * mc.center_of_mass_acceleration(scene, data))
    close(mc.kinetic_energy(scene, data), v @ mc.crba(scene, q) @ v / 2)
    mc.forward_kinematics(scene, q, data)
    close(mc.potential_energy(scene, data), 9.81 * mc.total_mass(scene) * c[2])


def test_one_robot(scene):
    q, v, a, _ = state(scene)
    robot = scene.robots["r2"]
    one = mc.RigidBodies(scene, "r2")
    own = slice(robot.idx_v, robot.idx_v + robot.model.nv)
    own_q = q[robot.idx_q : robot.idx_q + robot.model.nq]
    assert (one.nq, one.nv) == (robot.model.nq, robot.model.nv)
    tau = mc.rnea(scene, q, v, a)[own]
    assert np.array_equal(mc.rnea(one, own_q, v[own], a[own]), tau)
    assert np.array_equal(mc.rnea(robot.model, own_q, v[own], a[own]), tau)
    scene.gravity = [0, 0, -1.62]
    moon = mc.RigidBodies(robot.model, gravity=[0, 0, -1.62])
    assert np.array_equal(mc.gravity_torques(one, own_q), mc.gravity_torques(moon, own_q))
    assert mc.find_frame(one, "LF_foot").robot == 2
    assert mc.find_frame(scene, "r2/LF_foot").frame == "LF_foot"
    assert mc.find_joint(scene, mc.joint_names(scene)[-1]) == (2, 12)
    assert (np.abs(mc.random_velocity(one, 1)) > 0).all()


def test_what_does_not_fit(scene):
    q, v, a, _ = state(scene)
    data = mc.RigidBodyData(scene)
    model = scene.robots["r1"].model
    for call, says in [
        (lambda: mc.rnea(scene, q, v[1:], a), "v has"),
        (lambda: mc.rnea(model, q[:7], v[:7], a[:7], data), "the data belong to other robots"),
        (lambda: mc.rnea(scene, q, v, a, fext=np.zeros((2, 6))), "fext has 2 forces"),
        (lambda: mc.rnea(scene, q, v, a, fext=np.zeros((2, 5))), "shape"),
        (lambda: mc.frame_velocity(scene, data, "r0/lft_hand"), "left_hand"),
        (lambda: mc.joint_wrench(scene, data, "r0/left_knee"), "call rnea"),
        (lambda: mc.inverse_inertia_times(scene, q, np.zeros((2, 2))), "(nv, n)"),
        (lambda: mc.RigidBodies(scene, "r9"), "no robot 'r9'"),
        (lambda: mc.forward_kinematics(scene, q, data, a=a), "not v"),
        (lambda: mc.rnea(scene, q, v, np.full(scene.nv, np.nan)), "nan"),
    ]:
        with pytest.raises(ValueError, match=None) as error:
            call()
        assert says in str(error.value)
    with pytest.raises(TypeError):
        mc.rnea(None, q, v, a)


# ---- contacts ------------------------------------------------------------------------------------------------------


def test_contacts_and_what_joints_carry(humanoid):
    file, data = humanoid
    scene = file.scene
    v = mc.random_velocity(scene, 2) / 10
    mc.solve(scene, file.q, v, file.u, data)
    J, a0 = mc.contact_jacobian(scene, file.q), mc.contact_bias_acceleration(scene, file.q, v)
    assert J.shape == (12, scene.nv)
    close(J @ data.a, -a0, 1e-8)
    tau = torques(scene, file.u)
    M, h = mc.crba(scene, file.q), mc.nonlinear_effects(scene, file.q, v)
    close(M @ data.a + h - J.T @ data.f, tau, 1e-9)
    assert mc.contact_jacobian(scene, file.q, [True, False]).shape == (6, scene.nv)

    fext = mc.contact_forces_on_bodies(scene, file.q, data.f, data.f_offset)
    bodies = mc.RigidBodyData(scene)
    close(mc.rnea(scene, file.q, v, data.a, bodies, fext), tau, 1e-9)
    name = mc.joint_names(scene)[0]
    close(mc.joint_wrench(scene, bodies, name), np.zeros(6), 1e-8)  # nothing constrains the floating base
    knee = next(n for n in mc.joint_names(scene) if n.endswith("left_knee"))
    k = mc.velocity_names(scene).index(knee if "/" in knee else scene.robots[0].name + "/" + knee)
    model = scene.robots[0].model
    axis = model.joints["left_knee"].axis
    carried = mc.joint_wrench(scene, bodies, knee)
    close(axis @ carried[3:], tau[k] - model.armature[k] * data.a[k], 1e-9)
    assert np.linalg.norm(carried[:3]) > 50  # the body's weight


def test_violations_and_limits(humanoid):
    file, data = humanoid
    scene = file.scene
    scene.contacts["left"].mu = scene.contacts["right"].mu = 0.5
    u = file.u.copy()
    mc.solve(scene, file.q, file.v, u, data)
    assert mc.violations(scene, file.q, data) == []
    scene.gravity = [8, 0, -9.81]
    mc.solve(scene, file.q, file.v, mc.quasi_static(scene, file.q), data)
    found = mc.violations(scene, file.q, data)
    assert found and all(x.by > 0 and x.contact in (0, 1) for x in found)
    assert mc.ViolationKind.SLIPS in {x.kind for x in found}
    assert mc.limits_passed(scene, file.q, file.v, u) == []
    file.v[:] = 100
    passed = mc.limits_passed(scene, file.q, file.v, u)
    assert passed and passed[0].quantity == mc.LimitKind.VELOCITY and abs(passed[0].value) == 100


def test_switch_contacts(humanoid):
    file, _ = humanoid
    scene = file.scene
    scene.contacts["right"].active = False
    v = np.full(scene.nv, 0.1)
    simulation = mc.SimulationData(scene, file.q, v, "semi-implicit-euler", 1e-3)
    jump = mc.switch_contacts(scene, [True, True], simulation)
    assert jump.energy_lost > 0 and jump.impulse.shape == (12,)
    close(mc.contact_jacobian(scene, file.q, [True, True]) @ simulation.v, np.zeros(12), 1e-9)
    assert list(simulation.dynamics.active) == [True, True]
    with pytest.raises(ValueError):
        mc.switch_contacts(scene, [True], simulation)


# ---- inverse kinematics --------------------------------------------------------------------------------------------


def test_place():
    scene = mc.Scene()
    mc.add_robot(scene, "h", mc.load_urdf(str(MODELS / "humanoid.urdf"), floating_base=True), mc.SE3(p=[0, 0, 0.8]))
    wall = mc.SE3.from_quaternion([0, 0, 0, 1], [0.3, 0.2, 1.0])
    mc.add_contact(scene, mc.Contact(name="wall", type="3d", A=mc.attach(scene, "h", "left_hand"), B=mc.Attachment(placement=wall)))
    level = (0, 0, None)
    goals = [
        mc.pose_goal(scene, "left_sole", position=(None, None, 0), rpy=level),
        mc.pose_goal(scene, "h/right_sole", position=(None, None, 0), rpy=level),
        mc.contact_goal(scene, "wall"),
        mc.center_of_mass_goal(scene, (None, None, 0.65)),
        mc.joint_goal(scene, "h/waist_yaw", 0.2, weight=2),
    ]
    found = mc.place(scene, mc.neutral(scene), goals)
    assert found.met() and found.iterations <= 30
    data = mc.RigidBodyData(scene)
    mc.forward_kinematics(scene, found.q, data)
    close(mc.frame_placement(scene, data, "left_sole").p[2], 0, 1e-9)
    close(mc.frame_placement(scene, data, "left_hand").p, wall.p, 1e-9)
    close(mc.center_of_mass(scene, data)[2], 0.65, 1e-9)
    assert mc.placement_errors(scene, found.q) == []
    assert mc.limits_passed(scene, found.q, np.zeros(scene.nv), np.zeros(scene.nu)) == []

    far = mc.place(scene, mc.neutral(scene), goals[:2] + [mc.pose_goal(scene, "left_hand", mc.SE3(p=[0, 0, 9]))])
    assert not far.met() and far.left[2].position > 1 and far.left[0].position < far.left[2].position
    assert mc.limits_passed(scene, far.q, np.zeros(scene.nv), np.zeros(scene.nu)) == []
    for call, says in [
        (lambda: mc.pose_goal(scene, "left_sole", mc.SE3(), position=(0, 0, 0)), "either placement, or position"),
        (lambda: mc.pose_goal(scene, "left_sole", position=(0, 0)), "three entries"),
        (lambda: mc.place(scene, mc.neutral(scene), [mc.joint_goal(scene, "root", 0)]), "several coordinates"),
    ]:
        with pytest.raises(ValueError) as error:
            call()
        assert says in str(error.value)


def test_place_starts_again():
    file = mc.load_scene_text('<scene><robot name="a" urdf="arm.urdf"/></scene>', str(MODELS / "scene.xml"))
    scene, data = file.scene, mc.RigidBodyData(file.scene)
    met = [0, 0]
    for seed in range(10):
        mc.forward_kinematics(scene, mc.random_configuration(scene, seed), data)
        goals = [mc.pose_goal(scene, "a/tool", mc.frame_placement(scene, data, "a/tool"))]
        start = mc.random_configuration(scene, seed + 100)
        found = [mc.place(scene, start, goals, restarts=n, seed=3) for n in (0, 30)]
        met = [m + f.met() for m, f in zip(met, found)]
    assert met[0] < 10 and met[1] == 10


def test_poses_of_scene_files():
    text = """<scene><robot name="h" urdf="humanoid.urdf" base="floating"/>
      <pose frame="h/left_sole" xyz="0 0.1 0" rpy="0 0 0"/>
      <pose frame="h/pelvis" z="0.65"/></scene>"""
    file = mc.load_scene_text(text, str(MODELS / "scene.xml"))
    data = mc.RigidBodyData(file.scene)
    mc.forward_kinematics(file.scene, file.q, data)
    close(mc.frame_placement(file.scene, data, "left_sole").p, [0, 0.1, 0], 1e-9)
    close(mc.frame_placement(file.scene, data, "pelvis").p[2], 0.65, 1e-9)
    assert [f.kind for f in file.findings] == ["pose"]
    with pytest.raises(mc.InputError) as error:
        mc.load_scene_text(text.replace('z="0.65"', 'z="3"'), str(MODELS / "scene.xml"))
    assert error.value.line in (2, 3)  # the one with the largest error
