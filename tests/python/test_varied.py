"""Robots with other masses, lengths and friction without files; thrusters, squashing and other parts of action models."""

import os

import numpy as np
import pytest

import manycontact as mc

MODELS = os.path.join(os.path.dirname(__file__), "..", "..", "models", "")


def test_bodies_are_scaled():
    model = mc.load_urdf(MODELS + "quadruped.urdf", floating_base=True)
    heavy = model.varied(mass=1.5)
    assert np.isclose(heavy.mass(), 1.5 * model.mass())
    scene, twice = mc.Scene(), mc.Scene()
    mc.add_robot(scene, "r", model)
    mc.add_robot(twice, "r", model.varied(mass=2, length=3))
    q = mc.random_configuration(model, 1)
    inertia = mc.crba(scene, q)
    larger = mc.crba(twice, q)
    turning = np.r_[3:6, 6 : model.nv]
    assert np.allclose(larger[np.ix_(turning, turning)], 2 * 9 * inertia[np.ix_(turning, turning)])
    assert np.allclose(larger[:3, :3], 2 * inertia[:3, :3])
    rubbed = model.varied(friction=0.2, armature=0.01)  # one number applies to the joints: a floating base has none
    assert np.allclose(rubbed.armature, np.r_[np.zeros(6), np.full(12, 0.01)])
    mc.add_robot(scene, "s", rubbed)
    v = np.ones(scene.nv)
    data = mc.SceneData(scene)
    mc.solve(scene, mc.neutral(scene), v, np.zeros(scene.nu), data)
    assert np.allclose(data.tau[18:], np.r_[np.zeros(6), np.full(12, -0.2)])
    for bad in ({"mass": 0}, {"length": -1}, {"mass": [1, 2]}, {"friction": -1}):
        with pytest.raises(ValueError):
            model.varied(**bad)


def test_a_loaded_robot_is_replaced():
    file = mc.load_scene(MODELS + "quadruped_loop.xml")
    robot = file.scene.robots[0]
    frame = robot.model.frames[file.scene.contacts[0].A.frame] if hasattr(file.scene.contacts[0], "A") else None
    data = mc.SceneData(file.scene)
    before = mc.solve(file.scene, file.q, file.v, file.u, data) and data.a.copy()
    robot.model = robot.model.varied(mass=1.2, friction=0.1)
    assert np.isclose(file.scene.robots[0].model.mass(), robot.model.mass())
    new = mc.SceneData(file.scene)
    mc.solve(file.scene, file.q, file.v, file.u, new)
    assert np.isfinite(new.a).all() and not np.allclose(new.a, before, rtol=1e-9, atol=0)
    with pytest.raises(ValueError):
        robot.model = mc.load_urdf(MODELS + "box.urdf", floating_base=True)
    assert frame is None or frame.name


def test_box_qp_and_linear_model():
    solver = mc.BoxQP(2)
    solution = solver.solve(np.diag([1.0, 2.0]), np.array([-3.0, 1.0]), -np.ones(2), np.ones(2), np.zeros(2))
    assert np.allclose(solution.x, [1, -0.5]) and solution.clamped_idx == [0] and solver.is_sound
    model = mc.DifferentialActionModelLQR(2, 2)
    data = model.createData()
    twin = mc.DifferentialActionModelNumDiff(model)
    other = twin.createData()
    x, u = model.state.rand(), np.array([0.3, -0.2])
    for m, d in ((model, data), (twin, other)):
        m.calc(d, x, u)
        m.calcDiff(d, x, u)
    assert np.allclose(data.Fx, other.Fx, atol=1e-6) and np.allclose(data.Lx, other.Lx, atol=1e-5)


def test_thrusters_and_squashing():
    scene = mc.Scene()
    mc.add_robot(scene, "b", mc.load_urdf(MODELS + "box.urdf", floating_base=True))
    state = mc.StateMultibody(scene)
    thrusters = [mc.Thruster(mc.SE3(p=[x, 0, 0]), 0.01, kind) for x, kind in
                 ((0.1, mc.ThrusterType.CW), (-0.1, mc.ThrusterType.CCW))]
    actuation = mc.ActuationModelFloatingBaseThrusters(state, thrusters)
    data = actuation.createData()
    actuation.calc(data, state.zero(), np.array([1.0, 2.0]))
    assert np.allclose(data.tau, [0, 0, 3, 0, 0.1, -0.01])
    squashed = mc.ActuationSquashingModel(actuation, mc.SquashingModelSmoothSat(np.zeros(2), np.ones(2), 2), 2)
    twin = mc.ActuationModelNumDiff(squashed)
    datas = squashed.createData(), twin.createData()
    for model, d in zip((squashed, twin), datas):
        model.calc(d, state.zero(), np.array([0.2, 3.0]))
        model.calcDiff(d, state.zero(), np.array([0.2, 3.0]))
    assert np.allclose(datas[0].dtau_du, datas[1].dtau_du, atol=1e-6)
