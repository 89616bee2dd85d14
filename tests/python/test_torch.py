"""manycontact.torch has the values of solve, and gradients that pass gradcheck, for every kind of joint."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

torch = pytest.importorskip("torch")
import manycontact.torch as mt  # noqa: E402

PLANAR = """<robot name="cart"><link name="world"/>
  <link name="cart"><inertial><mass value="2"/><origin xyz="0.1 0 0.05"/>
    <inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0.01" ixz="0" iyz="0"/></inertial></link>
  <link name="pole"><inertial><mass value="1"/><origin xyz="0 0 0.3"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="drive" type="planar"><parent link="world"/><child link="cart"/><axis xyz="0 0.6 0.8"/></joint>
  <joint name="tilt" type="continuous"><parent link="cart"/><child link="pole"/><axis xyz="0 1 0"/></joint></robot>"""


@pytest.fixture
def mixed(tmp_path):
    """A box, an arm that wrenches it, a cart in a plane; all pushed."""
    (tmp_path / "cart.urdf").write_text(PLANAR)
    scene = tmp_path / "scene.xml"
    scene.write_text(f"""<scene>
      <robot name="a" urdf="{MODELS}/arm.urdf"/>
      <robot name="b" urdf="{MODELS}/box.urdf" base="floating" xyz="0.5 0 0.5"/>
      <robot name="c" urdf="cart.urdf"/>
      <contact name="tool" type="3d" frame="a/tool" to="b/face_back" gains="50 10"/>
      <contact name="tip" type="1d" frame="c/pole" gains="50 10"/>
      <push frame="b/crate" force="1 2 3" torque="0.1 0 0"/> <push frame="c/pole" force="0 1 0" reference_frame="world"/>
    </scene>""")
    return mc.load_scene(str(scene))


def states(file, n, seed=1):
    rng = np.random.default_rng(seed)
    scene = file.scene
    Q = np.array([mc.integrate(scene, file.q, 0.3 * rng.standard_normal(scene.nv)) for _ in range(n)])
    return [torch.tensor(x) for x in (Q, rng.standard_normal((n, scene.nv)), rng.standard_normal((n, scene.nu)))]


def test_values_are_those_of_solve(mixed):
    dynamics = mt.Dynamics(mixed.scene)
    q, v, u = states(mixed, 4)
    a, f = dynamics(q, v, u)
    assert list(dynamics.status) == [0] * 4 and a.dtype == torch.float64
    data = mc.SceneData(mixed.scene)
    mc.solve(mixed.scene, q[2].numpy(), v[2].numpy(), u[2].numpy(), data)
    np.testing.assert_allclose(a[2].numpy(), data.a, rtol=1e-12)
    one, _ = dynamics(q[2].float(), v[2].float(), u[2].float())
    assert one.shape == (mixed.scene.nv,) and one.dtype == torch.float32


def test_gradients(mixed):
    dynamics = mt.Dynamics(mixed.scene, threads=2)
    q, v, u = states(mixed, 2)
    wrenches = torch.tensor(np.random.default_rng(2).standard_normal((2, 6)))
    q = q * (1 + 0.1 * torch.rand(1))  # quaternions not of unit length, too
    inputs = [x.requires_grad_() for x in (q, v, u, wrenches)]
    assert torch.autograd.gradcheck(dynamics, inputs, eps=3e-5, atol=1e-4, rtol=1e-5)


def test_contacts_and_wrenches_of_the_call_count_in_its_gradient(mixed):
    dynamics = mt.Dynamics(mixed.scene)
    q, v, u = states(mixed, 2)
    u.requires_grad_()
    dynamics.active = [True, False]
    a, f = dynamics(q, v, u)
    assert f.shape == (2, 3)
    dynamics.active = [False, False]  # between the call and its gradient
    free, _ = dynamics(q, v, u)
    (held,) = torch.autograd.grad(a.sum(), u)
    (loose,) = torch.autograd.grad(free.sum(), u)
    assert (held - loose).abs().max() > 1e-3
    dynamics.active = [True, False]
    (again,) = torch.autograd.grad(dynamics(q, v, u)[0].sum(), u)
    assert torch.equal(held, again)


def test_a_state_that_fails_is_nan_alone(mixed):
    dynamics = mt.Dynamics(mixed.scene)
    q, v, u = states(mixed, 3)
    v[1, 0] = np.nan
    u.requires_grad_()
    a, _ = dynamics(q, v, u)
    (gradient,) = torch.autograd.grad(a[[0, 2]].sum(), u)
    assert dynamics.status[1] == 4 and a[1].isnan().any() and a[[0, 2]].isfinite().all()
    assert gradient[[0, 2]].isfinite().all()
