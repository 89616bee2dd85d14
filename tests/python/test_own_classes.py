"""User-defined classes: methods that Crocoddyl calls are called here, or the class is refused."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS


@pytest.fixture(scope="module")
def state():
    return mc.StateMultibody(mc.load_urdf(str(MODELS / "arm.urdf")))


def dynamics(state, costs, actuation=None, storage=None):
    actuation = actuation or mc.ActuationModelFull(state)
    model = mc.DifferentialActionModelContactFwdDynamics(
        state, actuation, mc.ContactModelMultiple(state, actuation.nu), costs
    )
    if storage is not None:
        model.storage = storage
    return model


def stack(state, cost, weight=1.0):
    costs = mc.CostModelSum(state, state.nv)
    costs.addCost("own", cost, weight)
    return costs


# ---- costs ---------------------------------------------------------------------------------------------------------


def spring_cost(Base, *arguments):
    """The cost is 2 x'x + 3 u'u, in a class of its own."""

    class Spring(Base):
        def calc(self, data, x, u=None):
            u = np.zeros(self.nu) if u is None else u
            data.cost = 2 * x @ x + 3 * u @ u

        def calcDiff(self, data, x, u=None):
            data.Lx = 4 * x
            data.Lxx[:, :] = 4 * np.eye(len(x))
            if u is not None:
                data.Lu[:] = 6 * u
                data.Luu = 6 * np.eye(len(u))

    return Spring(*arguments)


def bases(state):
    quad = mc.ActivationModelQuad(state.ndx)
    residual = mc.ResidualModelState(state, state.nv)
    return [
        (mc.CostModelAbstract, state),
        (mc.CostModelAbstract, state, state.nv),
        (mc.CostModelAbstract, state, quad),
        (mc.CostModelAbstract, state, quad, state.nv),
        (mc.CostModelAbstract, state, residual),
        (mc.CostModelAbstract, state, quad, residual),
        (mc.CostModelResidual, state, residual),
    ]


@pytest.mark.parametrize("number", range(7))
@pytest.mark.parametrize("storage", ["BOTH", "DENSE", "SPARSE"])
def test_costs(state, number, storage):
    """A user's cost and one of the library's are summed: the derivatives are the weighted sum of both."""
    rng = np.random.default_rng(number)
    costs = stack(state, spring_cost(*bases(state)[number]), 0.5)
    costs.addCost("u", mc.CostModelResidual(state, mc.ResidualModelControl(state, state.nv)), 2.0)
    model = dynamics(state, costs, storage=getattr(mc.MatrixStorage, storage))
    data = model.createData()
    x, u = rng.uniform(-1, 1, state.nx), rng.uniform(-1, 1, state.nv)
    model.calc(data, x, u)
    assert data.cost == pytest.approx(0.5 * (2 * x @ x + 3 * u @ u) + u @ u)
    model.calcDiff(data, x, u)
    np.testing.assert_allclose(data.Lx, 2 * x)
    np.testing.assert_allclose(data.Lu, 3 * u + 2 * u)
    whole = storage != "SPARSE"
    np.testing.assert_allclose(data.Lxx if whole else data.Lxx_sparse.toarray(), 2 * np.eye(state.ndx))
    np.testing.assert_allclose(data.Luu if whole else data.Luu_sparse.toarray(), 5 * np.eye(state.nv))
    np.testing.assert_allclose(data.costs["own"].Lx, 4 * x)
    model.calc(data, x)
    assert data.cost == pytest.approx(x @ x)
    model.calcDiff(data, x)
    np.testing.assert_allclose(data.Lx, 2 * x)


def test_costs_with_data_of_their_own(state):
    class Data(mc.CostDataAbstract):
        def __init__(self, model, shared):
            super().__init__(model, shared)
            self.calls = 0

    class Own(mc.CostModelAbstract):
        def __init__(self):
            mc.CostModelAbstract.__init__(self, state, mc.ActivationModelQuad(3), nu=state.nv)

        def createData(self, shared):
            return Data(self, shared)

        def calc(self, data, x, u=None):
            data.calls += 1
            data.residual.r[:] = data.shared.frame_placement(1).p
            self.activation.calc(data.activation, data.residual.r)
            data.cost = data.activation.a_value

        def calcDiff(self, data, x, u=None):
            J = np.zeros((3, state.ndx))
            J[:, : state.nv] = data.shared.frame_jacobian(1, mc.LOCAL_WORLD_ALIGNED)[:3]
            self.activation.calcDiff(data.activation, data.residual.r)
            data.residual.Rx[:] = J
            data.Lx[:] = J.T @ data.activation.Ar
            data.Lxx[:] = J.T @ J

    costs = stack(state, Own())
    reference = stack(state, mc.CostModelResidual(state, mc.ResidualModelFrameTranslation(state, 1, np.zeros(3))))
    x, u, found = state.rand(), np.ones(state.nv), []
    for each in costs, reference:
        model = dynamics(state, each)
        data = model.createData()
        model.calc(data, x, u)
        model.calcDiff(data, x, u)
        found.append(data)
    assert found[0].costs["own"].calls == 1
    assert found[0].cost == pytest.approx(found[1].cost)
    np.testing.assert_allclose(found[0].Lx, found[1].Lx, atol=1e-12)
    np.testing.assert_allclose(found[0].Lxx, found[1].Lxx, atol=1e-12)
    with pytest.raises(ValueError, match="while calc"):
        found[0].costs["own"].shared


def test_costs_call_their_base(state):
    class Twice(mc.CostModelResidual):
        def calc(self, data, x, u=None):
            super().calc(data, x, u)
            data.cost *= 2

        def calcDiff(self, data, x, u=None):
            super().calcDiff(data, x, u)
            for name in ("Lx", "Lu", "Lxx", "Lxu", "Luu"):
                setattr(data, name, 2 * getattr(data, name))

    x, u = state.rand(), np.ones(state.nv)
    found = []
    for Model, weight in (Twice, 1.0), (mc.CostModelResidual, 2.0):
        model = dynamics(state, stack(state, Model(state, mc.ResidualModelState(state, state.nv)), weight))
        data = model.createData()
        model.calc(data, x, u)
        model.calcDiff(data, x, u)
        found.append((data.cost, data.Lx, data.Lxx, data.Luu))
    for own, of_library in zip(*found):
        np.testing.assert_allclose(own, of_library)


def test_costs_without_derivatives_say_so(state):
    class Own(mc.CostModelAbstract):
        def calc(self, data, x, u=None):
            data.cost = 1

    model = dynamics(state, stack(state, Own(state)))
    data = model.createData()
    model.calc(data, state.zero(), np.zeros(state.nv))
    with pytest.raises(ValueError, match="define calcDiff"):
        model.calcDiff(data, state.zero(), np.zeros(state.nv))


def test_costs_in_a_solver(state):
    """The optimum of a user's cost is that of the same cost from a residual, in several threads too."""

    def solved(cost):
        node = mc.IntegratedActionModelEuler(dynamics(state, stack(state, cost)), 0.01)
        problem = mc.ShootingProblem(np.full(state.nx, 0.1), [node] * 5, node)
        problem.nthreads = 2
        solver = mc.SolverFDDP(problem)
        assert solver.solve()
        return np.concatenate(solver.us)

    class Pull(mc.CostModelAbstract):
        def calc(self, data, x, u=None):
            u = np.zeros(state.nv) if u is None else u
            data.cost = 0.5 * (x @ x + u @ u)

        def calcDiff(self, data, x, u=None):
            data.Lx, data.Lxx = x, np.eye(state.ndx)
            if u is not None:
                data.Lu, data.Luu = u, np.eye(state.nv)

    class Both(mc.ResidualModelAbstract):
        def calc(self, data, x, u):
            data.r = np.concatenate([x, u])

        def calcDiff(self, data, x, u):
            n, m = state.ndx, state.nv
            data.Rx, data.Ru = np.eye(n + m, n), np.eye(n + m)[:, n:]

    class Residual(mc.CostModelResidual):
        """Terminal nodes include the state, as Pull's do."""

        def calc(self, data, x, u=None):
            super().calc(data, x, np.zeros(state.nv) if u is None else u)

        def calcDiff(self, data, x, u=None):
            super().calcDiff(data, x, np.zeros(state.nv) if u is None else u)

    on = mc.Dependence(q=True, v=True, u=True)
    other = Residual(state, Both(state, state.ndx + state.nv, state.nv, on))
    np.testing.assert_allclose(solved(Pull(state)), solved(other), rtol=1e-6, atol=1e-9)


# ---- residuals -----------------------------------------------------------------------------------------------------


def test_residuals_with_data_of_their_own(state):
    class Data(mc.ResidualDataAbstract):
        def __init__(self, model, shared):
            super().__init__(model, shared)
            self.gain = 3.0

    class Own(mc.ResidualModelAbstract):
        def createData(self, shared):
            return Data(self, shared)

        def calc(self, data, x, u):
            data.r = data.gain * x

        def calcDiff(self, data, x, u):
            data.Rx = data.gain * np.eye(state.ndx)

    on = mc.Dependence(q=True, v=True)
    model = dynamics(state, stack(state, mc.CostModelResidual(state, Own(state, state.ndx, state.nv, on))))
    data, x = model.createData(), state.rand()
    model.calc(data, x, np.zeros(state.nv))
    model.calcDiff(data, x, np.zeros(state.nv))
    assert data.cost == pytest.approx(4.5 * x @ x)
    np.testing.assert_allclose(data.Lx, 9 * x)


# ---- actuations ----------------------------------------------------------------------------------------------------


def half(Base, *arguments):
    """tau = u / 2 - v / 4."""

    class Half(Base):
        def calc(self, data, x, u):
            data.tau = 0.5 * u - 0.25 * x[-self.nu :]

        def calcDiff(self, data, x, u):
            n = self.nu
            data.dtau_dx = np.hstack([np.zeros((n, n)), -0.25 * np.eye(n)])
            data.dtau_du = 0.5 * np.eye(n)

        def commands(self, data, x, tau):
            data.u = 2 * tau

        def torqueTransform(self, data, x, u):
            data.Mtau = 2 * np.eye(self.nu)

    return Half(*arguments)


@pytest.mark.parametrize("base", ["ActuationModelAbstract", "ActuationModelFull", "ActuationModelFloatingBase"])
def test_actuations(state, base):
    Base = getattr(mc, base)
    actuation = half(Base, *([state, state.nv] if Base is mc.ActuationModelAbstract else [state]))
    model = dynamics(state, mc.CostModelSum(state, state.nv), actuation)
    full = dynamics(state, mc.CostModelSum(state, state.nv))
    x, u = state.rand(), np.arange(1.0, state.nv + 1)
    v = x[-state.nv :]
    data, reference = model.createData(), full.createData()
    model.calc(data, x, u)
    model.calcDiff(data, x, u)
    full.calc(reference, x, 0.5 * u - 0.25 * v)
    full.calcDiff(reference, x, 0.5 * u - 0.25 * v)
    np.testing.assert_allclose(data.xout, reference.xout, rtol=1e-12)
    np.testing.assert_allclose(data.Fu, 0.5 * reference.Fu, rtol=1e-12)
    damped = reference.Fx + np.hstack([np.zeros((state.nv, state.nv)), -0.25 * reference.Fu])
    np.testing.assert_allclose(data.Fx, damped, rtol=1e-10, atol=1e-10)
    at_rest = np.concatenate([x[: -state.nv], np.zeros(state.nv)])
    held = model.quasiStatic(data, at_rest)
    np.testing.assert_allclose(held, 2 * full.quasiStatic(reference, at_rest), rtol=1e-9)
    own = actuation.createData()
    actuation.commands(own, x, u)
    np.testing.assert_allclose(own.u, 2 * u)
    actuation.torqueTransform(own, x, u)
    np.testing.assert_allclose(own.Mtau, 2 * np.eye(state.nv))


def test_actuations_that_define_nothing(state):
    class Named(mc.ActuationModelFull):
        """Has a name."""

    costs = mc.CostModelSum(state, state.nv)
    x, u = state.rand(), np.ones(state.nv)
    found = []
    for actuation in Named(state), mc.ActuationModelFull(state):
        model = dynamics(state, costs, actuation)
        data = model.createData()
        model.calc(data, x, u)
        model.calcDiff(data, x, u)
        found.append((data.xout, data.Fx, data.Fu))
    for own, of_library in zip(*found):
        np.testing.assert_allclose(own, of_library, rtol=1e-12, atol=1e-14)


# ---- nodes ---------------------------------------------------------------------------------------------------------


def test_quasi_static_of_nodes(state):
    class Own(mc.ActionModelAbstract):
        def calc(self, data, x, u=None):
            data.xnext, data.cost = x, 0

        def calcDiff(self, data, x, u=None):
            pass

        def quasiStatic(self, data, x, maxiter, tol):
            return np.full(2, 7.0)

    class Strict(Own):
        def checkData(self, data):
            return False

    node = Own(mc.StateVector(4), 2)
    problem = mc.ShootingProblem(np.zeros(4), [node], node)
    np.testing.assert_array_equal(problem.quasiStatic([np.zeros(4)])[0], [7, 7])
    with pytest.raises(ValueError, match="action data belong to another model"):
        mc.ShootingProblem(np.zeros(4), [Strict(mc.StateVector(4), 2)], node)


# ---- solvers -------------------------------------------------------------------------------------------------------

SOLVERS = ["SolverDDP", "SolverFDDP", "SolverBoxDDP", "SolverBoxFDDP", "SolverSparse"]
METHODS = [
    ("computeDirection", (True,)), ("tryStep", (1.0,)), ("stoppingCriteria", ()), ("expectedImprovement", ()),
    ("calcDiff", ()), ("backwardPass", ()), ("forwardPass", (1.0,)), ("resizeData", ()), ("allocateData", ()),
    ("increaseRegularization", ()), ("decreaseRegularization", ()),
]  # fmt: skip


def wheels():
    return mc.ShootingProblem([-1.0, -1.0, 1.0], [mc.ActionModelUnicycle()] * 10, mc.ActionModelUnicycle())


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("method", [m for m, _ in METHODS if m != "increaseRegularization"])
def test_solvers(solver, method):
    """solve() calls the class's methods; if these call their base, iterates are the library's."""
    Base, calls = getattr(mc, solver), []

    def own(self, *arguments):
        calls.append(arguments)
        return getattr(Base, method)(self, *arguments)

    own.__code__ = own.__code__.replace(co_name=method)  # pybind11 recognises a call of the base by this name
    mine = type("Mine", (Base,), {method: own})(wheels())
    library = Base(wheels())
    assert mine.solve([], [], 20) == library.solve([], [], 20)
    assert calls
    assert mine.cost == library.cost and mine.iter == library.iter
    np.testing.assert_array_equal(np.concatenate(mine.us), np.concatenate(library.us))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("method", [m for m, _ in METHODS if m != "increaseRegularization"])
def test_what_a_solver_of_ones_own_raises(solver, method):
    def own(self, *_):
        raise RuntimeError("called")

    mine = type("Mine", (getattr(mc, solver),), {method: own})(wheels())
    with pytest.raises(RuntimeError, match="called"):
        mine.solve([], [], 5)


def test_what_methods_return_is_taken():
    class Content(mc.SolverFDDP):
        def stoppingCriteria(self):
            return 0.0

    solver = Content(wheels())
    assert solver.solve([], [], 20) and solver.stop == 0.0 and solver.iter < 5


# ---- classes without overridable methods ---------------------------------------------------------------------------

REFUSED = [
    ("ContactModel3D", "calc"), ("ContactModel6D", "updateForce"), ("ContactModelOfScene", "calcDiff"),
    ("ImpulseModel3D", "calc"), ("ConstraintModelResidual", "calcDiff"), ("CostModelSum", "calc"),
    ("ContactModelMultiple", "calcDiff"), ("ImpulseModelMultiple", "calc"), ("ConstraintModelManager", "calc"),
    ("StateMultibody", "integrate"), ("StateVector", "diff"), ("ShootingProblem", "calc"), ("ShootingProblem", "rollout"),
    ("ControlParametrizationModelPolyZero", "calc"), ("IntegratedActionModelRK", "quasiStatic"),
    ("DifferentialActionModelFreeFwdDynamics", "calc"), ("ActionModelImpulseFwdDynamics", "calcDiff"),
    ("SolverAugmentedLagrangian", "computeDirection"), ("SolverFDDP", "computeGains"), ("SolverDDP", "computePolicy"),
    ("CallbackLogger", "__call__"), ("ResidualModelControl", "createData"), ("ActivationModelQuad", "calcDiff"),
]  # fmt: skip


@pytest.mark.parametrize("base, method", REFUSED)
def test_refused(base, method):
    with pytest.raises(TypeError, match=f"Mine defines {method}, which C\\+\\+ would not call"):
        type("Mine", (getattr(mc, base),), {method: lambda self, *_: None})
    type("Named", (getattr(mc, base),), {"__doc__": "Nothing that C++ would call."})


def test_every_method_that_cpp_calls_is_known():
    """A class whose objects C++ receives belongs to a family that defines the methods C++ calls."""
    from manycontact import _classes

    expected = {name for name in dir(mc) if name.endswith(("ModelAbstract", "ModelSum", "ModelMultiple", "ModelManager"))}
    expected -= {"SquashingModelAbstract"}  # it has no trampoline: C++ creates its objects
    expected |= {"SolverAbstract", "ShootingProblem", "StateAbstract", "CallbackAbstract"}
    of_families = {
        name
        for name in expected
        if any(issubclass(getattr(mc, name), getattr(mc, family)) for family in _classes._EXPECTED)
    }
    assert expected == of_families
