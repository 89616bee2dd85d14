"""Steps: PD laws, the work of forces, and many simulations at once."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

H = 1e-3


@pytest.fixture
def standing():
    return mc.load_scene(str(MODELS / "humanoid_standing.xml"))


def test_pd_laws_and_work(standing):
    scene = standing.scene
    nv = scene.nv
    simulation = mc.SimulationData(scene, standing.q, standing.v, "semi-implicit-euler", H)
    joints = np.arange(nv) >= 6
    q_ref = np.concatenate([np.zeros(6), np.asarray(standing.q)[7:] + 0.1])
    simulation.pd = mc.PdLaws(100.0 * joints, 10.0 * joints, q_ref, np.zeros(nv))
    v_before = np.array(simulation.v)
    assert mc.step(scene, standing.u, simulation) == mc.StepStatus.OK
    v, q = np.array(simulation.v), np.array(simulation.q)
    right = joints * (100 * (q_ref - np.concatenate([np.zeros(6), q[7:]])) - 10 * v)
    assert simulation.pd_torque == pytest.approx(right, abs=1e-8)
    assert simulation.work.pd == pytest.approx(H * right @ (v_before + v) / 2, abs=1e-9)
    assert simulation.work.dampers == simulation.work.friction == simulation.work.springs == 0
    assert simulation.solves >= simulation.steps == 1
    with pytest.raises(ValueError, match="pd"):
        simulation.pd = mc.PdLaws(np.ones(2), np.ones(2), np.ones(2), np.ones(2))
        mc.step(scene, standing.u, simulation)


def test_each_of_a_batch_is_stepped(standing):
    scene, states = standing.scene, 11
    rng = np.random.default_rng(1)
    q = np.tile(standing.q, (states, 1))
    v = np.tile(standing.v, (states, 1))
    u = np.asarray(standing.u) + rng.normal(size=(states, scene.nu))
    batch = mc.SimulationBatch(scene, q, v, "semi-implicit-euler", H)
    assert (mc.step_batch(scene, u, batch, 10) == 0).all()
    for k in range(states):
        alone = mc.SimulationData(scene, q[k], v[k], "semi-implicit-euler", H)
        for _ in range(10):
            assert mc.step(scene, u[k], alone) == mc.StepStatus.OK
        assert batch.q[k] == pytest.approx(alone.q, abs=1e-11)
        assert batch.v[k] == pytest.approx(alone.v, abs=1e-8)
    mc.set_state(scene, 3, q[0], v[0], batch)
    assert (batch.q[3] == q[0]).all()
    batch.velocity_limit = 1e-9
    stopped = batch.q
    assert (mc.step_batch(scene, u, batch) == int(mc.StepStatus.TOO_FAST)).all()
    assert (batch.q == stopped).all()


def test_a_batch_has_pd_laws_and_refuses_what_does_not_fit(standing):
    scene, states = standing.scene, 3
    q, v, u = (np.tile(x, (states, 1)) for x in (standing.q, standing.v, standing.u))
    batch = mc.SimulationBatch(scene, q, v, "semi-implicit-euler", H, threads=1)
    batch.kp = batch.kd = np.r_[np.zeros(6), np.ones(scene.nv - 6)]
    with pytest.raises(ValueError, match="q_ref"):
        mc.step_batch(scene, u, batch)
    batch.q_ref = batch.v_ref = np.zeros((states, scene.nv))
    assert (mc.step_batch(scene, u, batch) == 0).all()
    for bad in (u[:2], u[0], np.full_like(u, np.nan)):
        with pytest.raises(ValueError):
            mc.step_batch(scene, bad, batch)
    with pytest.raises(ValueError, match="number of the state"):
        mc.set_state(scene, 3, q[0], v[0], batch)
    with pytest.raises(ValueError):
        mc.SimulationBatch(scene, q[:2], v, "rk4", H)


def test_contacts_close_where_their_frames_are():
    """With here=True a foot that moved closes where it is now, and feet that remain closed keep their places."""
    file = mc.load_scene(str(MODELS / "tasks/quadruped_scene.xml"))
    scene = file.scene
    for contact in scene.contacts:
        contact.alpha, contact.beta = mc.recommended_gains("semi-implicit-euler", 1e-3)
    motion = mc.SimulationData(scene, file.q, file.v, "semi-implicit-euler", 1e-3)
    mc.switch_contacts(scene, [contact.name != "LF" for contact in scene.contacts], motion)
    for _ in range(100):
        assert mc.step(scene, 1.1 * file.u, motion) == mc.StepStatus.OK
    places = [contact.B.placement for contact in scene.contacts]
    assert max(error.position for error in mc.placement_errors(scene, motion.q)) > 0.01
    mc.switch_contacts(scene, [True] * 4, motion, here=True)
    moved = [contact.name for contact, place in zip(scene.contacts, places) if contact.B.placement != place]
    assert moved == ["LF"]
    assert all(error.position < 1e-4 for error in mc.placement_errors(scene, motion.q))
    speed = abs(motion.v).max()
    assert mc.step(scene, file.u, motion) == mc.StepStatus.OK
    assert abs(motion.v).max() < 1.1 * speed  # pulled back to the old place: 80 m/s, and 14 kN
    assert abs(mc.contact_force(scene, motion, "LF")).max() < 100
