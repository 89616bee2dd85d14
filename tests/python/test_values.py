"""Assignments take effect or raise; strings name members; copies, pickles and reprs work."""

import copy
import functools
import inspect
import pickle
import re

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

H = 1e-3


@pytest.fixture
def file():
    return mc.load_scene(str(MODELS / "humanoid_standing.xml"))


# ---- assignments change their object, or raise ---------------------------------------------------------------------


def is_(x):
    """Returns a comparable value: the bytes of an array."""
    return x.tobytes() if isinstance(x, np.ndarray) else repr(x)


def attribute(path, value):
    """Returns (what, write, read) of one attribute of the objects in a World."""
    *way, last = path.split(".")

    def get(x, name):
        return x[int(name)] if name.isdigit() else getattr(x, name)

    def owner(world):
        return functools.reduce(get, way, world)

    def write(world):
        setattr(owner(world), last, value(world) if callable(value) else value)

    return pytest.param(write, lambda world: get(owner(world), last), id=path)


def element(path, index=0):
    """Returns the same of an element of an array, a list or a dict."""
    _, read = attribute(path, None).values

    def write(world):
        x = read(world)
        if isinstance(x, dict):
            x["left"] = 7
        else:
            x[index] = not x[index] if getattr(x, "dtype", None) == bool else x[index] + 0.25

    return pytest.param(write, read, id=path + f"[{index}]")


class World:
    """Contains one object of most classes, each solved, so that assignments have a target."""

    def __init__(self):
        self.file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
        self.scene = scene = self.file.scene
        self.data = mc.SceneData(scene)
        self.report = mc.solve(scene, self.file.q, self.file.v, self.file.u, self.data)
        self.batch = mc.BatchData(scene, 1)
        self.sim = mc.SimulationData(scene, self.file.q, self.file.v, "rk4", H)
        self.trajectory = mc.simulate(scene, self.file.u, self.sim, 3)
        self.model = scene.robots[0].model
        self.state = state = mc.StateMultibody(scene)
        actuation = mc.ActuationModelFloatingBase(state)
        nu = actuation.nu
        self.com = mc.ResidualModelCoMPosition(state, [0, 0, 1], nu)
        self.posture = mc.ResidualModelState(state, nu)
        self.place = mc.ResidualModelFramePlacement(state, 1, mc.SE3(), nu)
        self.cone = mc.ResidualModelContactFrictionCone(state, 1, mc.FrictionCone(mu=0.5), nu)
        self.weighted = mc.ActivationModelWeightedQuad(np.ones(3))
        self.barrier = mc.ActivationModelQuadraticBarrier(mc.ActivationBounds([-1.0], [1.0]))
        self.contact_model = mc.ContactModel3D(state, 1, [0, 0, 0], "local", nu, [1, 2])
        costs, contacts = mc.CostModelSum(state, nu), mc.ContactModelMultiple(state, nu)
        costs.addCost("com", mc.CostModelResidual(state, self.com), 1)
        self.costs = costs
        self.action = mc.DifferentialActionModelContactFwdDynamics(state, actuation, contacts, costs)
        self.action_data = self.action.createData()
        x, u = np.concatenate([self.file.q, self.file.v]), np.zeros(nu)
        self.action.calc(self.action_data, x, u)
        self.action.calcDiff(self.action_data, x, u)
        node = mc.IntegratedActionModelEuler(self.action, 0.01)
        self.problem = mc.ShootingProblem(x, [node, node], node)
        self.solver = mc.SolverFDDP(self.problem)
        self.solver.setCandidate([x] * 3, [u] * 2)
        self.task = mc.read_task(str(MODELS / "tasks" / "humanoid_reaches.xml"))
        self.task.iterations = 1
        self.task_problem = mc.make_problem(self.task)
        self.solution = mc.optimize(self.task, self.task_problem)


def up(path):
    """Returns the object's own value plus one."""
    return lambda world: attribute(path, None).values[1](world) + 1


ASSIGNED = [  # these must change it
    *(attribute(p, up(p)) for p in ("file.q", "file.v", "file.u", "sim.v")),
    attribute("sim.q", lambda world: mc.integrate(world.scene, world.sim.q, np.full(world.scene.nv, 0.1))),
    *(element(p) for p in ("file.q", "file.v", "file.u")),
    attribute("scene.gravity", [0, 0, -1.62]),
    element("scene.gravity", 2),
    attribute("scene.damping", 1e-3),
    attribute("scene.tolerance", 1e-5),
    attribute("scene.name", "moon"),
    attribute("scene.contacts.0.alpha", 9.0),
    attribute("scene.contacts.1.beta", 9.0),
    attribute("scene.contacts.0.mu", 0.1),
    attribute("scene.contacts.0.normal", [0, 1, 1]),
    attribute("scene.contacts.0.active", False),
    attribute("scene.contacts.0.type", "3d"),
    attribute("scene.contacts.0.reference_frame", "world"),
    attribute("scene.contacts.0.A", lambda world: mc.attach(world.scene, "humanoid", "right_sole")),
    attribute("scene.contacts.0.B", lambda world: mc.Attachment(placement=mc.SE3(p=[1, 2, 3]))),
    attribute("scene.contacts.0.B.placement", mc.SE3(p=[1, 2, 3])),
    attribute("scene.contacts.0.A.placement", mc.SE3(p=[1, 2, 3])),
    attribute("scene.robots.0.base", mc.SE3(p=[1, 2, 3])),
    attribute("data.options", mc.Options("dense")),
    attribute("data.options.method", "dense"),
    attribute("data.options.order", "camd"),
    attribute("data.options.threads", 2),
    attribute("batch.options.simd_level", "off"),
    attribute("sim.dynamics.options.method", mc.Method.DENSE),
    attribute("sim.velocity_limit", 5.0),
    attribute("action.options.method", "dense"),
    attribute("data.active", [False, True]),
    attribute("batch.active", [False, True]),
    *(element(p) for p in ("data.active", "batch.active", "sim.dynamics.active")),
    *(attribute(p, up(p)) for p in ("state.lb", "com.reference", "posture.reference", "weighted.weights")),
    attribute("place.reference", mc.SE3(p=[1, 2, 3])),
    attribute("cone.reference.mu", 0.1),
    attribute("barrier.bounds", mc.ActivationBounds([-2.0], [2.0])),
    attribute("contact_model.gains", [3, 4]),
    attribute("contact_model.type", "world"),
    attribute("action.armature", up("action.armature")),
    attribute("action_data.Lx", up("action_data.Lx")),
    element("action_data.Fx", (0, 0)),
    attribute("problem.x0", up("problem.x0")),
    attribute("solver.th_stop", 1e-3),
    attribute("task.tolerance", 1e-3),
    attribute("task.solver", "sparse"),
]
REFUSED = [  # these cannot, and raise
    attribute("sim.h", 1.0),
    attribute("scene.contacts.0.name", "other"),
    attribute("scene.contacts.0.B.placement.p", [1, 2, 3]),
    attribute("scene.robots.0.name", "other"),
    attribute("model.armature", up("model.armature")),
    attribute("model.joints.1.upper", [0.0]),
    attribute("report.nv", 1),
    element("sim.q", 2),
    element("sim.v"),
    *(element("data." + name) for name in ("a", "f", "v", "tau", "f_offset")),
    *(element(p) for p in ("model.armature", "model.joints.1.upper", "model.joints.1.axis", "state.lb", "state.ub")),
    *(element(p) for p in ("scene.contacts.0.axis", "scene.contacts.0.box", "scene.contacts.0.B.placement.p")),
    *(element(p) for p in ("com.reference", "posture.reference", "weighted.weights", "barrier.bounds.lb")),
    *(element(p) for p in ("place.reference.p", "cone.reference.lb", "contact_model.gains", "contact_model.reference")),
    *(element(p) for p in ("scene.contact_index", "scene.robot_index", "costs.costs")),
    *(element("trajectory." + p) for p in ("t", "q", "v")),
    element("action_data.Fx_sparse.data"),
    element("action.u_ub"),
    *(element(p) for p in ("solver.xs", "solver.us", "solver.xs.0", "solver.alphas", "problem.x0")),
    *(element(p) for p in ("task_problem.xs", "task_problem.xs.0", "task_problem.blocks", "solution.xs.0")),
    element("task.scene.scene.contact_index"),
]


@pytest.fixture
def world():
    return World()


@pytest.mark.parametrize("write, read", ASSIGNED)
def test_assignment_changes(world, write, read):
    before = is_(read(world))
    write(world)
    assert is_(read(world)) != before


@pytest.mark.parametrize("write, read", REFUSED)
def test_assignment_raises(world, write, read):
    before = is_(read(world))
    with pytest.raises((ValueError, AttributeError, TypeError)):
        write(world)
    assert is_(read(world)) == before


def test_no_property_pretends(world):
    """Writing into any array, list or dict of a property raises, or the property returns it changed."""
    seen = 0
    for owner in list(vars(world).values()) + [world.scene.contacts[0], world.model.joints[1], world.solution.gains[0]]:
        for name, member in inspect.getmembers(type(owner), lambda x: isinstance(x, property)):
            try:
                x = getattr(owner, name)
            except (ValueError, RuntimeError):
                continue
            if not isinstance(x, (np.ndarray, list, dict, set, frozenset)) or len(x) == 0:
                continue
            seen += 1
            before = is_(np.array(x)) if isinstance(x, np.ndarray) else repr(x)
            try:
                if isinstance(x, np.ndarray):
                    x.flat[0] = not x.flat[0] if x.dtype == bool else x.flat[0] + 0.25
                elif isinstance(x, list):
                    x[0] = None
                elif isinstance(x, dict):
                    x["a new key"] = None
                else:
                    x.add("a new member")
            except (ValueError, TypeError, AttributeError):
                continue
            now = getattr(owner, name)
            now = is_(np.array(now)) if isinstance(now, np.ndarray) else repr(now)
            assert now != before, f"{type(owner).__name__}.{name}"
    assert seen > 60


def test_changed_contacts_count(file):
    """Solutions after an assignment are those of a scene that had the value from the start."""
    scene, data = file.scene, mc.SceneData(file.scene)
    mc.solve(scene, file.q, file.v, file.u, data)
    before = data.a
    file.v[6] = 0.5
    scene.gravity[2] = -1.62
    scene.contacts["left"].B.placement = mc.SE3(p=scene.contacts["left"].B.placement.p + [0, 0, 0.01])
    scene.contacts["left"].alpha, scene.contacts[0].beta = 100, 20
    mc.solve(scene, file.q, file.v, file.u, data)
    assert (data.a != before).any()
    fresh = mc.SceneData(copy.copy(scene))
    mc.solve(copy.copy(scene), file.q, file.v, file.u, fresh)
    assert (fresh.a == data.a).all()

    scene.contacts[0].type = "3d"
    with pytest.raises(ValueError, match="make new data"):
        mc.solve(scene, file.q, file.v, file.u, data)
    assert mc.solve(scene, file.q, file.v, file.u, mc.SceneData(scene)).nc == 9


def test_contacts_are_judged(file):
    contact = file.scene.contacts["right"]
    for name, bad, says in [
        ("alpha", np.nan, "gains"),
        ("mu", -1.0, "mu"),
        ("axis", [0, 0, 0], "zero axis"),
        ("normal", [0, 0, 0], "zero normal"),
        ("A", mc.Attachment(), "in the world"),
        ("A", mc.Attachment(robot=7, joint=0), "names robot"),
        ("type", "7d", "unknown type of contact '7d'"),
        ("box", [-1, 0], "box"),
    ]:
        before = repr([contact.alpha, contact.mu, contact.axis, contact.A.frame, contact.type, contact.box])
        with pytest.raises(ValueError, match=says):
            setattr(contact, name, bad)
        assert before == repr([contact.alpha, contact.mu, contact.axis, contact.A.frame, contact.type, contact.box])
    contact.axis = [0, 0, 2]
    assert contact.axis[2] == 1


def test_lists_of_a_scene(file):
    scene = file.scene
    assert len(scene.contacts) == 2 and [c.name for c in scene.contacts] == ["left", "right"]
    assert scene.contacts[-1] == scene.contacts["right"] and scene.contacts[0] != scene.contacts[1]
    assert [c.name for c in scene.contacts[::-1]] == ["right", "left"]
    assert "left" in scene.contacts and "lft" not in scene.contacts
    with pytest.raises(IndexError):
        scene.contacts[2]
    with pytest.raises(ValueError, match="'left', 'right'"):
        scene.contacts["lft"]
    with pytest.raises(ValueError, match="humanoid"):
        scene.robots["humanod"]
    kept = scene.contacts[0]
    for k in range(100):  # the scene's memory of them moves
        side = mc.Contact(name=f"more{k}", A=mc.attach(scene, "humanoid", "left_hand"), type="1d")
        mc.add_contact(scene, side)
    kept.alpha = 4
    assert scene.contacts["left"].alpha == 4
    joints = scene.robots[0].model.joints
    assert joints["left_knee"].name == "left_knee" == joints[[j.name for j in joints].index("left_knee")].name
    del scene, file
    assert kept.name == "left"


def test_contact_has_all_its_fields():
    A, B = mc.Attachment(robot=0, joint=2, frame="f"), mc.Attachment(placement=mc.SE3(p=[1, 2, 3]))
    values = dict(name="c", type="6d", reference_frame="world", A=A, B=B, axis=[0, 1, 0], alpha=1.0, beta=2.0)
    values.update(active=False, mu=0.5, normal=[1, 0, 0], box=[0.1, 0.2])
    contact = mc.Contact(**values)
    names = [n for n, x in vars(mc.Contact).items() if isinstance(x, property) and x.fset]
    assert set(names) == set(values)
    assert contact.type == mc.ContactType.CONTACT_6D and contact.reference_frame == mc.ReferenceFrame.WORLD
    assert contact.A == A and contact.B.placement == B.placement and not contact.active
    assert (contact.alpha, contact.beta, contact.mu) == (1, 2, 0.5)
    assert list(contact.axis) == [0, 1, 0] and list(contact.normal) == [1, 0, 0] and list(contact.box) == [0.1, 0.2]


def test_simulation_goes_on_from_what_was_assigned(file):
    for integrator in ("rk4", "semi-implicit-euler"):
        ours = mc.SimulationData(file.scene, file.q, file.v, integrator, H)
        mc.simulate(file.scene, file.u, ours, 5)
        q, v = mc.integrate(file.scene, file.q, np.full(file.scene.nv, 1e-3)), np.full(file.scene.nv, 0.1)
        ours.q, ours.v = q, v
        fresh = mc.SimulationData(file.scene, q, v, integrator, H)
        for sim in (ours, fresh):
            assert mc.step(file.scene, file.u, sim) == mc.StepStatus.OK
        assert (ours.q == fresh.q).all() and (ours.v == fresh.v).all()
        for bad in (q[1:], q * np.nan, 1.0):
            with pytest.raises((ValueError, TypeError)):
                ours.q = bad


# ---- members and their names ---------------------------------------------------------------------------------------


def enumerations():
    return [x for x in vars(mc).values() if isinstance(x, type) and hasattr(x, "__members__")]


@pytest.mark.parametrize("enumeration", enumerations(), ids=lambda x: x.__name__)
def test_members_have_pythons_names(enumeration):
    own = {"Jcomponent": r"[a-z]+", "RKType": r"[a-z]+", "VerboseLevel": r"_\d"}  # Crocoddyl's
    for name, member in enumeration.__members__.items():
        assert re.fullmatch(own.get(enumeration.__name__, r"[A-Z][A-Z0-9_]*"), name)
        assert pickle.loads(pickle.dumps(member)) == copy.copy(member) == member


def test_names_of_members_wherever_one_is_taken(file):
    scene = file.scene
    for name in (mc.Method.SPARSE_LDL, "sparse-ldl", "sparse_ldl", "SPARSE_LDL"):
        assert mc.Options(name).method == mc.Method.SPARSE_LDL
    assert str(mc.Method.SPARSE_LDL) == "sparse-ldl"
    options = mc.Options("dense", order="camd", simd_level="off", threads=2)
    assert (options.order, options.simd_level, options.threads) == (mc.Order.CAMD, mc.SimdLevel.OFF, 2)
    options.order = None
    assert options.order is None
    options.precision = "extended"
    assert options == mc.Options("dense", simd_level="off", threads=2, precision=mc.Precision.EXTENDED)
    data = mc.SceneData(scene, mc.Options(precision="extended"))
    report = mc.solve(scene, file.q, file.v, file.u, data)
    assert {island.precision for island in report.islands} == {mc.Precision.EXTENDED}
    sim = mc.SimulationData(scene, file.q, file.v, "rk4", H)
    assert sim.integrator == mc.Integrator.RK4 and mc.failure(scene, sim, "ok") == ""
    state = mc.StateMultibody(scene)
    x = np.concatenate([file.q, file.v])
    assert len(state.Jdiff(x, x, "both")) == 2 and len(state.Jdiff(x, x, "first")) == 1
    model = mc.ContactModel3D(state, 1, [0, 0, 0], "local_world_aligned", 32)
    assert model.type == mc.LOCAL_WORLD_ALIGNED
    assert mc.CallbackVerbose("_1").level == mc.CallbackVerbose("1").level == mc.VerboseLevel._1
    assert [str(level) for level in mc.VerboseLevel.__members__.values()] == list("01234")
    for name, kind in ("cw", mc.ThrusterType.CW), ("ccw", mc.ThrusterType.CCW):
        thruster = mc.Thruster(mc.SE3(), 0.02, name)
        assert thruster.type == kind
        thruster.type = name
        assert thruster.type == kind
    with pytest.raises(ValueError, match="rktype three or four is expected"):
        mc.ControlParametrizationModelPolyTwoRK(2, "two")
    assert mc.recommended_gains("rk4", H) == mc.recommended_gains(mc.Integrator.RK4, H)
    for call, says in [
        (lambda: mc.Options("sparse"), "unknown method 'sparse', expected one of 'dense', "),
        (lambda: setattr(options, "simd_level", "avx3"), "expected one of 'auto', 'off', 'baseline', 'avx2', 'avx512'"),
        (lambda: mc.Options(precision="half"), "expected one of 'single', 'double', 'extended'"),
        (lambda: setattr(model, "type", "locl"), "'local', 'world', 'local-world-aligned'"),
        (lambda: mc.SimulationData(scene, file.q, file.v, "euler", H), "'semi-implicit-euler', 'rk4'"),
        (lambda: mc.optimize(mc.load_task(str(MODELS / "tasks/humanoid_reaches.xml")), solver="ipopt"), "'fddp', "),
    ]:
        with pytest.raises(ValueError, match=says):
            call()
    with pytest.raises(TypeError):
        mc.Options(3)


def test_gains_of_a_contact_with_any_axis(file):
    scene = file.scene
    for k in range(200):
        axis = np.random.default_rng(k).normal(size=3)
        mc.add_contact(scene, mc.Contact(name=f"c{k}", type="1d", reference_frame="world", axis=axis,
                                         A=mc.attach(scene, "humanoid", "left_sole"), active=False))
    mc.resolve_references(scene, file.q)
    data = mc.SceneData(scene)
    mc.solve(scene, file.q, file.v, file.u, data)
    before = [contact.axis for contact in scene.contacts]
    for contact in scene.contacts:
        contact.alpha, contact.beta = 9, 6
    assert all((contact.axis == axis).all() for contact, axis in zip(scene.contacts, before))
    mc.solve(scene, file.q, file.v, file.u, data)


# ---- copy, pickle, repr --------------------------------------------------------------------------------------------


def values():
    world = World()
    task, solution = world.task, world.solution
    gains = mc.Gains(1, 2)
    out = [world.file, world.scene, world.scene.contacts[0], world.scene.contacts[0].B, world.scene.robots[0]]
    out += [world.model, world.model.joints[1], world.model.frames[0], mc.SE3(p=[1, 2, 3]), world.data.options]
    out += [world.report, world.report.islands[0], mc.solved_island(world.data, 0), gains, world.trajectory]
    out += [mc.invariants(world.scene, world.data.active, world.file.q, world.file.v), mc.DerivativeRequest(v=False)]
    out += [mc.Dependence(q=True), task, solution, solution.iterations[0], solution.times, solution.gains[0]]
    out += [mc.simulate(task, solution, substeps=1), mc.Contact(name="c", A=mc.Attachment(robot=0, joint=1), mu=0.5)]
    return out


@pytest.mark.parametrize("x", values(), ids=lambda x: type(x).__name__)
def test_values_are_copied_and_pickled(x):
    for twin in (copy.copy(x), copy.deepcopy(x), pickle.loads(pickle.dumps(x))):
        assert twin is not x and type(twin) is type(x) and twin == x
        for name, member in inspect.getmembers(type(x), lambda m: isinstance(m, property)):
            ours, theirs = getattr(x, name), getattr(twin, name)
            if isinstance(ours, np.ndarray):
                assert np.array_equal(ours, theirs), name
            elif not hasattr(type(ours), "__getitem__"):
                assert repr(ours) == repr(theirs), name


@pytest.mark.parametrize(
    "x",
    [
        mc.FrictionCone(mu=0.3, nf=6, min_nforce=1, max_nforce=5),
        mc.WrenchCone(np.eye(3), 0.4, [0.1, 0.2], inner_appr=False),
        mc.CoPSupport(np.eye(3), [0.1, 0.2]),
        mc.ActivationBounds([-1.0, -np.inf], [1.0, 2.0], 0.5),
    ],
    ids=lambda x: type(x).__name__,
)
def test_cones_are_copied_and_pickled(x):
    for twin in (copy.copy(x), copy.deepcopy(x), pickle.loads(pickle.dumps(x))):
        assert twin is not x and type(twin) is type(x)
        for name, member in inspect.getmembers(type(x), lambda m: isinstance(m, property)):
            assert np.array_equal(getattr(x, name), getattr(twin, name)), name


def test_a_copy_is_ones_own(file):
    twin = copy.copy(file.scene.contacts[0])
    twin.alpha = 77
    assert file.scene.contacts[0].alpha != 77
    scene = copy.deepcopy(file.scene)
    scene.contacts[0].alpha, scene.gravity[2] = 77, 0
    assert file.scene.contacts[0].alpha != 77 and file.scene.gravity[2] == -9.81
    options = mc.SceneData(scene, twin_options := mc.Options("dense")).options
    options.method = "auto"
    assert twin_options.method == mc.Method.DENSE


def test_a_pickled_scene_solves_alike(file):
    scene, q, v, u = pickle.loads(pickle.dumps((file.scene, file.q, file.v, file.u)))
    theirs, ours = mc.SceneData(file.scene), mc.SceneData(scene)
    mc.solve(file.scene, file.q, file.v, file.u, theirs)
    mc.solve(scene, q, v, u, ours)
    assert (ours.a == theirs.a).all() and (ours.f == theirs.f).all()
    herd = mc.load_scene(str(MODELS / "herd.xml"))
    pickled = pickle.dumps(herd)
    assert len(pickled) < 0.3 * len(herd.scene.robots) * len(pickle.dumps(herd.scene.robots[0].model))  # it is one
    again = pickle.loads(pickled)
    assert again.scene.robots[0].model is again.scene.robots[1].model and again == herd
    with pytest.raises((ValueError, TypeError)):
        mc.Scene.__new__(mc.Scene).__setstate__(())


def test_what_is_no_data_is_not_pickled(file):
    simulation = mc.SimulationData(file.scene, file.q, file.v, "rk4", H)
    for x in (mc.SceneData(file.scene), simulation, mc.BatchData(file.scene)):
        for refused in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError):
                refused(x)


def test_every_class_says_what_it_is():
    for name, cls in vars(mc).items():
        if isinstance(cls, type) and not issubclass(cls, Exception):
            assert cls.__repr__ is not object.__repr__, name


def test_reprs(world):
    assert repr(world.scene.contacts[0]).startswith("<Contact: ") and "alpha=" in repr(world.scene.contacts[0])
    assert "type=6d" in repr(world.scene.contacts[0])
    assert repr(world.scene.contacts).startswith("<ContactList of 2: [<Contact")
    assert repr(mc.Gains(1, 2)) == "Gains(1.0, 2.0)" and repr(mc.Options("dense")) == "Options('dense')"
    assert "converged=" in repr(world.solution) and "status=ok" in repr(world.trajectory)
    assert "cost=" in repr(world.solver) and "ContactModel3D" in repr(world.contact_model)
    for x in list(vars(world).values()) + values():
        assert " object at 0x" not in repr(x) and len(repr(x)) < 5000, type(x)


# ---- user-defined classes ------------------------------------------------------------------------------------------


def test_methods_that_would_not_be_called_are_refused():
    for base, method in [
        (mc.CallbackVerbose, "__call__"),
        (mc.ActivationModelQuad, "calc"),
        (mc.IntegratedActionModelEuler, "calcDiff"),
        (mc.DifferentialActionModelContactFwdDynamics, "createData"),
        (mc.ResidualModelState, "calc"),
    ]:
        with pytest.raises(TypeError, match=f"{method}, which C\\+\\+ would not call"):
            type("Mine", (base,), {method: lambda self, *_: None})
        type("Named", (base,), {"name": "an attribute is fine"})
    with pytest.raises(TypeError, match="would not call"):

        class Mixin:
            def calc(self, data, r):
                pass

        class Mine(Mixin, mc.ActivationModelQuad):
            pass


@pytest.mark.parametrize(
    "change, told",
    [
        (lambda f, d: setattr(f.scene, "gravity", -9.81), "Scene.gravity: an array of numbers is expected, not -9.81"),
        (lambda f, d: setattr(f.scene, "damping", "a"), "Scene.damping: float is expected, not 'a'"),
        (lambda f, d: setattr(f.scene.contacts[0], "type", 3.5), "Contact.type: ContactType is expected, not 3.5"),
        (lambda f, d: setattr(d.options, "threads", None), "Options.threads: int is expected, not None"),
    ],
)
def test_assignments_of_a_wrong_type_name_the_attribute(humanoid, change, told):
    with pytest.raises(TypeError, match=re.escape(told)):
        change(*humanoid)


def test_a_report_has_its_reason(humanoid):
    file, data = humanoid
    assert "reason" not in repr(mc.solve(file.scene, file.q, file.v, file.u, data))
    link = '<link name="{}"><inertial><mass value="0"/></inertial></link>'
    joint = '<joint name="j" type="prismatic"><parent link="a"/><child link="b"/><limit/></joint>'
    scene = mc.Scene()
    mc.add_robot(scene, "r", mc.load_urdf_text(f'<robot name="r">{link.format("a")}{joint}{link.format("b")}</robot>'))
    assert "singular" in repr(mc.solve(scene, [0], [0], [0], mc.SceneData(scene)))


def test_an_unknown_name_has_a_suggestion(file):
    for name, told in (("lefft", "did you mean 'left'"), ("xyz", "expected one of '(left|right)'")):
        with pytest.raises(KeyError, match=told):
            file.scene.contact_index[name]
    assert file.scene.contact_index.get("xyz") is None
