"""ExternalWrenches and springs: scenes built and loaded, wrenches that change, derivatives with respect to them."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

SCENE = """
<scene>
  <robot name="h" urdf="humanoid.urdf" base="floating" xyz="0 0 1">
    <joint name="left_knee" stiffness="20" rest="0.1" damping="0.5"/>
  </robot>
  <robot name="b" urdf="box.urdf" base="floating" xyz="1 0 1"/>
  <contact name="sole" type="6d" frame="h/left_sole"/>
  <push name="wind" frame="h/chest" offset="0 0 0.1" force="10 0 0" torque="0 1 0" reference_frame="world"/>
  <spring name="rope" frame="h/right_hand" to="b/crate" stiffness="50" length="0.2" damping="1"/>
</scene>
"""


@pytest.fixture
def pushed():
    file = mc.load_scene_text(SCENE, str(MODELS / "pushed.xml"))
    return file, mc.SceneData(file.scene)


def test_what_the_file_says(pushed):
    file, data = pushed
    scene = file.scene
    assert len(scene.wrenches) == 1 and len(scene.springs) == 1
    push, spring = scene.wrenches["wind"], scene.springs["rope"]
    assert push.reference_frame == mc.WORLD and np.array_equal(push.wrench, [10, 0, 0, 0, 1, 0])
    assert (spring.stiffness, spring.length, spring.damping) == (50, 0.2, 1)
    assert np.array_equal(data.wrenches, [[10, 0, 0, 0, 1, 0]])
    assert mc.wrench_names(scene) == [f"wind[{k}]" for k in range(6)]
    with pytest.raises(ValueError, match="there is no external wrench 'x', expected 'wind'"):
        scene.wrenches["x"]


def test_wrenches_change_between_solves(pushed):
    file, data = pushed
    scene = file.scene
    mc.solve(scene, file.q, file.v, file.u, data)
    assert len(data.report.islands) == 1  # the rope couples the two
    a = data.a
    request = mc.DerivativeRequest(wrenches=True)
    blocks = mc.differentiate(scene, data, request).islands[0]
    assert blocks.wrenches == [0] and blocks.da_dw.shape == (scene.nv, 6)
    dense = mc.dense_derivatives(scene, data)
    da_dw, df_dw = np.array(dense.da_dw), np.array(dense.dforces_dw)
    f = data.f
    step = np.array([3.0, -2, 1, 0.5, 1, -1])
    data.wrenches[0] += step  # the effect is exactly linear
    mc.solve(scene, file.q, file.v, file.u, data)
    assert np.allclose(data.a - a, da_dw @ step, atol=1e-9)
    assert np.allclose(data.f - f, df_dw @ step, atol=1e-8)
    data.wrenches = np.zeros((1, 6))
    mc.solve(scene, file.q, file.v, file.u, data)
    assert np.allclose(data.a - a, -da_dw @ scene.wrenches[0].wrench, atol=1e-9)
    for wrong in (np.zeros((2, 6)), np.zeros(6), [[np.nan] * 6]):
        with pytest.raises(ValueError):
            data.wrenches = wrong


def test_products(pushed):
    file, data = pushed
    scene = file.scene
    mc.solve(scene, file.q, file.v, file.u, data)
    mc.differentiate(scene, data, mc.DerivativeRequest(wrenches=True))
    J = mc.sparse_derivatives(scene, data)
    rng = np.random.default_rng(1)
    x, y = rng.normal(size=J.shape[1]), rng.normal(size=J.shape[0])
    nv, nu = scene.nv, scene.nu
    da, df = mc.jvp(scene, data, x[:nv], x[nv : 2 * nv], x[2 * nv : 2 * nv + nu], x[-6:])
    assert np.allclose(np.concatenate([da, df]), J @ x, rtol=1e-9, atol=1e-8)
    back = mc.vjp_with_wrenches(scene, data, y[:nv], y[nv:])
    assert np.allclose(np.concatenate(back), J.T @ y, rtol=1e-9, atol=1e-8)
    assert all(np.array_equal(a, b) for a, b in zip(mc.vjp(scene, data, y[:nv], y[nv:]), back))


def test_built_in_code():
    scene = mc.Scene("built")
    mc.add_robot(scene, "box", mc.load_urdf(str(MODELS / "box.urdf"), floating_base=True))
    at = mc.attach(scene, "box", "crate")
    mc.add_external_wrench(scene, mc.ExternalWrench(name="lift", at=at, wrench=[0, 0, 5, 0, 0, 0]))
    mc.add_spring(scene, mc.Spring(name="up", A=at, B=mc.Attachment(placement=mc.SE3()), stiffness=7))
    q = mc.neutral(scene)
    data = mc.SceneData(scene)
    mc.solve(scene, q, np.zeros(6), np.zeros(0), data)
    rise = data.a[2] + 9.81
    scene.springs[0].stiffness = 0
    scene.wrenches[0].reference_frame = mc.WORLD
    mc.solve(scene, q, np.zeros(6), np.zeros(0), data)
    assert rise > 0 and data.a[2] > -9.81
    with pytest.raises(ValueError, match="wrench 'lift' exists already"):
        mc.add_external_wrench(scene, mc.ExternalWrench(name="lift", at=at))
    with pytest.raises(ValueError, match="stiffness that is not 0 or more"):
        scene.springs[0].stiffness = -1
    with pytest.raises(ValueError, match="cannot be changed"):
        scene.wrenches[0].name = "other"
    with pytest.raises(ValueError, match="several coordinates"):
        mc.add_joint_spring(scene, "box", "root", 1)


def test_simulation_and_batches(pushed):
    file, data = pushed
    scene = file.scene
    sim = mc.SimulationData(scene, file.q, file.v, "semi-implicit-euler", 1e-3)
    sim.dynamics.wrenches[0] = 0
    for _ in range(3):
        assert mc.step(scene, file.u, sim) == mc.StepStatus.OK
    batch = mc.BatchData(scene)
    batch.wrenches[0] *= 2
    A, F, status = mc.solve_batch(scene, file.q[None], file.v[None], file.u[None], batch)
    data.wrenches[0] *= 2
    mc.solve(scene, file.q, file.v, file.u, data)
    assert np.array_equal(A[0], data.a) and np.array_equal(F[0], data.f)
    WQ, WV, WU, WW, _ = mc.vjp_batch_with_wrenches(scene, file.q[None], file.v[None], file.u[None], A, F, batch)
    for many, one in zip((WQ, WV, WU, WW), mc.vjp_with_wrenches(scene, data, data.a, data.f)):
        assert np.array_equal(many[0], one)
