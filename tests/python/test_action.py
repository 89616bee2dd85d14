"""The action model in Python, and models, residuals and activations derived there."""

import gc

import manycontact as mc
import numpy as np
import pytest


class Standing:
    """The README's third program: a humanoid on both soles."""

    def __init__(self, file, extra=None):
        self.state = mc.StateMultibody(file.scene)
        actuation = mc.ActuationModelFloatingBase(self.state)
        nu = self.nu = actuation.nu
        self.x = np.concatenate([file.q, np.zeros(self.state.nv)])
        contacts = mc.ContactModelMultiple(self.state, nu)
        constraints = mc.ConstraintModelManager(self.state, nu)
        cone = mc.WrenchCone(np.eye(3), 0.7, [0.2, 0.08])
        for side in ("left", "right"):
            sole = self.state.pinocchio.getFrameId(side + "_sole")
            pref = file.scene.contact(side).B.placement
            frame = mc.ReferenceFrame.LOCAL_WORLD_ALIGNED
            contacts.addContact(side, mc.ContactModel6D(self.state, sole, pref, frame, nu, [0, 50]))
            wrench = mc.ResidualModelContactWrenchCone(self.state, sole, cone, nu)
            constraints.addConstraint(side, mc.ConstraintModelResidual(self.state, wrench, cone.lb, cone.ub))
        costs = self.costs = mc.CostModelSum(self.state, nu)
        costs.addCost("state", self.cost(mc.ResidualModelState(self.state, self.x, nu)), 1)
        costs.addCost("control", self.cost(mc.ResidualModelControl(self.state, nu)), 1e-3)
        costs.addCost("com", self.cost(mc.ResidualModelCoMPosition(self.state, [0, 0, 0.7], nu)), 100)
        if extra:
            extra(self)
        self.model = mc.DifferentialActionModelContactFwdDynamics(
            self.state, actuation, contacts, costs, constraints
        )

    def cost(self, residual, activation=None):
        if activation is None:
            return mc.CostModelResidual(self.state, residual)
        return mc.CostModelResidual(self.state, activation, residual)


def test_stands_still(humanoid):
    standing = Standing(humanoid[0])
    model = standing.model
    data = model.createData()
    u = model.quasiStatic(data, standing.x)
    model.calc(data, standing.x, u)
    model.calcDiff(data, standing.x, u)
    assert np.linalg.norm(data.xout) < 1e-6
    assert (data.g >= model.g_lb - 1e-9).all() and (data.g <= model.g_ub + 1e-9).all()
    assert "nc=12" in str(model) and data.report.status == mc.Status.OK
    assert sum(c.weight * data.costs[n].cost for n, c in model.costs.costs.items()) == pytest.approx(data.cost)
    assert set(data.contacts) == {"left", "right"} and data.contacts["left"].f.shape == (6,)
    assert (data.Fx_sparse.toarray() == data.Fx).all()
    held = data.Lxx
    assert not held.flags.owndata
    with pytest.raises(ValueError):
        data.g[:] = 0  # a copy, since the library resizes it
    expected = held.copy()
    del model, data, standing
    gc.collect()
    assert (held == expected).all()


class Quad(mc.ActivationModelAbstract):
    def calc(self, data, r):
        data.a_value = 0.5 * r @ r

    def calcDiff(self, data, r):
        data.Ar[:] = r
        data.Arr[:] = 1


class Translation(mc.ResidualModelAbstract):
    def __init__(self, state, frame, reference, nu):
        super().__init__(state, 3, nu, mc.Dependence(q=True))
        self.frame, self.reference = frame, np.array(reference)
        self.kept = None

    def calc(self, data, x, u):
        data.r = data.shared.frame_placement(self.frame).p - self.reference
        self.kept = data.shared

    def calcDiff(self, data, x, u):
        J = data.shared.frame_jacobian(self.frame, mc.ReferenceFrame.LOCAL_WORLD_ALIGNED)[:3]
        data.Rx = np.hstack([J, np.zeros_like(J)])


def test_residual_and_activation_of_ones_own(humanoid):
    """The numbers are the library's, without references here to the Python objects."""
    file, _ = humanoid

    def numbers(own):
        def extra(s):
            hand = s.state.pinocchio.getFrameId("left_hand")
            residual = (Translation if own else mc.ResidualModelFrameTranslation)(s.state, hand, [0.4, 0.2, 1], s.nu)
            s.costs.addCost("hand", s.cost(residual, Quad(3) if own else mc.ActivationModelQuad(3)), 10)

        standing = Standing(file, extra)
        gc.collect()
        model, data = standing.model, standing.model.createData()
        u = np.ones(standing.nu)
        model.calc(data, standing.x, u)
        model.calcDiff(data, standing.x, u)
        return data.cost, data.Lx.copy(), data.Lxx.copy(), standing

    ours, theirs = numbers(True), numbers(False)
    assert ours[0] == pytest.approx(theirs[0], rel=1e-14)
    for mine, other in zip(ours[1:3], theirs[1:3]):
        assert np.allclose(mine, other, rtol=0, atol=1e-12 * abs(other).max())
    residual = ours[3].costs.costs["hand"].cost.residual
    assert isinstance(residual, Translation)
    with pytest.raises(ValueError, match="available only while"):
        residual.kept.frame_placement(0)


class Pendulum(mc.DifferentialActionModelAbstract):
    """A point on a rod: a = -g sin(q) + u."""

    def __init__(self, state):
        super().__init__(state, 1, 1)

    def calc(self, data, x, u=None):
        data.cost = 0.5 * x @ x
        if u is not None:
            data.xout[:] = -9.81 * np.sin(x[0]) + u
            data.cost += 0.5e-2 * u @ u

    def calcDiff(self, data, x, u=None):
        data.Lx[:], data.Lxx[:] = x, np.eye(2)
        if u is not None:
            data.Fx[:] = [[-9.81 * np.cos(x[0]), 0]]
            data.Fu[:] = 1
            data.Lu[:], data.Luu[:] = 1e-2 * u, 1e-2


def pendulum():
    scene = mc.Scene()
    text = """<robot name="p"><link name="a"/><link name="b"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint></robot>"""
    return scene, text


@pytest.fixture
def one_joint(tmp_path):
    scene, text = pendulum()
    (tmp_path / "p.urdf").write_text(text)
    return mc.StateMultibody(mc.load_urdf(str(tmp_path / "p.urdf")))


def test_differential_model_of_ones_own(one_joint):
    model = Pendulum(one_joint)
    numeric = mc.DifferentialActionModelNumDiff(model)
    x, u = np.array([0.3, -0.2]), np.array([0.7])
    data, twin = model.createData(), numeric.createData()
    for m, d in ((model, data), (numeric, twin)):
        m.calc(d, x, u)
        m.calcDiff(d, x, u)
    assert np.allclose(data.Fx, twin.Fx, atol=1e-6) and np.allclose(data.Lx, twin.Lx, atol=1e-6)
    data.g = np.zeros(0)
    with pytest.raises(ValueError, match="broadcast"):
        data.Fx = np.zeros((3, 3))


def test_errors_of_python_come_back(one_joint):
    class Broken(Pendulum):
        def calc(self, data, x, u=None):
            raise KeyError("in Python")

    node = mc.IntegratedActionModelEuler(Broken(one_joint), 0.01)
    problem = mc.ShootingProblem(np.zeros(2), [node] * 8, node)
    problem.nthreads = 2
    with pytest.raises(KeyError, match="in Python"):
        problem.calc([np.zeros(2)] * 9, [np.zeros(1)] * 8)


class Incomplete(mc.ActivationModelAbstract):
    pass


def test_misuse(humanoid, one_joint):
    with pytest.raises(RuntimeError, match="pure virtual"):
        model = Incomplete(2)
        model.calc(model.createData(), np.zeros(2))
    standing = Standing(humanoid[0])
    with pytest.raises(ValueError, match="calc"):
        standing.model.calc(standing.model.createData(), standing.x[1:], np.zeros(standing.nu))
    with pytest.raises(ValueError):  # data of another model
        standing.model.calc(Pendulum(one_joint).createData(), standing.x, np.zeros(standing.nu))
    with pytest.raises(ValueError):  # not a logic_error's RuntimeError
        standing.model.calcDiff(standing.model.createData(), standing.x, np.zeros(standing.nu))
    with pytest.raises(ValueError, match="left"):
        standing.costs.addCost("left", None, 1) if False else standing.model.contacts.removeContact("lefd")
    with pytest.raises((TypeError, ValueError)):
        mc.CostModelResidual(standing.state, None)
