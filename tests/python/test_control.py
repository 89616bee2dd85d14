"""Optimal control in Python: solvers, callbacks, user-defined nodes in several threads, tasks."""

import gc
import json
import subprocess

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS
from test_action import Pendulum, one_joint  # noqa: F401


class Wheel(mc.ActionModelAbstract):
    """ActionModelUnicycle again, in Python."""

    def __init__(self):
        super().__init__(mc.StateVector(3), 2, 5)
        self.dt, self.weights = 0.1, (10, 1)

    def calc(self, data, x, u=None):
        wx, wu = self.weights
        data.r[:3], data.r[3:] = wx * x, 0
        data.xnext[:] = x
        if u is not None:
            data.r[3:] = wu * u
            data.xnext[:] += self.dt * np.array([np.cos(x[2]) * u[0], np.sin(x[2]) * u[0], u[1]])
        data.cost = 0.5 * data.r @ data.r

    def calcDiff(self, data, x, u=None):
        wx, wu = self.weights
        data.Lx[:], data.Lxx[:] = wx**2 * x, wx**2 * np.eye(3)
        if u is not None:
            data.Lu[:], data.Luu[:] = wu**2 * u, wu**2 * np.eye(2)
            c, s = np.cos(x[2]), np.sin(x[2])
            data.Fx[:] = np.eye(3)
            data.Fx[0, 2], data.Fx[1, 2] = -self.dt * s * u[0], self.dt * c * u[0]
            data.Fu[:] = self.dt * np.array([[c, 0], [s, 0], [0, 1]])


def solved(node, terminal, threads=1):
    problem = mc.ShootingProblem([-1.0, -1.0, 1.0], [node] * 20, terminal)
    problem.nthreads = threads
    solver = mc.SolverFDDP(problem)
    logger = mc.CallbackLogger()
    solver.setCallbacks([logger])
    assert solver.solve() and solver.reason == mc.StopReason.CONVERGED
    return solver, logger


def test_node_of_ones_own_takes_the_librarys_steps():
    ours, log = solved(Wheel(), Wheel(), threads=2)
    gc.collect()
    theirs, their_log = solved(mc.ActionModelUnicycle(), mc.ActionModelUnicycle())
    assert ours.iter == theirs.iter and np.allclose(log.costs, their_log.costs, rtol=1e-10)
    assert np.allclose(ours.xs, theirs.xs, atol=1e-8) and np.allclose(ours.us, theirs.us, atol=1e-8)
    assert isinstance(ours.problem.runningModels[0], Wheel)  # kept alive without a reference here
    assert len(ours.K) == 20 and ours.K[0].shape == (2, 3)


def test_numbers_do_not_depend_on_threads():
    runs = [solved(mc.ActionModelUnicycle(), mc.ActionModelUnicycle(), threads) for threads in (1, 2)]
    assert np.array_equal(runs[0][0].xs, runs[1][0].xs)


def test_data_of_ones_own():
    class Data(mc.ActionDataAbstract):
        def __init__(self, model):
            super().__init__(model)
            self.calls = 0

    class Counting(Wheel):
        def createData(self):
            return Data(self)

        def calc(self, data, x, u=None):
            data.calls += 1
            super().calc(data, x, u)

    node = Counting()
    problem = mc.ShootingProblem(np.zeros(3), [node] * 3, node)
    gc.collect()
    problem.calc([np.zeros(3)] * 4, [np.zeros(2)] * 3)
    assert [d.calls for d in problem.runningDatas] == [1, 1, 1]


def test_callback_interrupts(one_joint):  # noqa: F811
    seen = []

    class Stop(mc.CallbackAbstract):
        def __call__(self, solver):
            seen.append((solver.iter, solver.cost, len(solver.xs)))
            if len(seen) == 2:
                solver.interrupt()

    node = mc.IntegratedActionModelEuler(Pendulum(one_joint), 0.05)
    terminal = mc.IntegratedActionModelEuler(Pendulum(one_joint), 0)
    problem = mc.ShootingProblem([2.0, 0.0], [node] * 30, terminal)
    solver = mc.SolverFDDP(problem)
    solver.th_stop = 1e-30
    solver.setCallbacks([Stop()])
    gc.collect()
    assert not solver.solve([], [], 50)
    assert solver.reason == mc.StopReason.INTERRUPTED and len(seen) == 2 and seen[0][2] == 31
    assert str(solver.reason) == "interrupted" or "interrupt" in str(solver.reason)
    assert len(solver.getCallbacks()) == 1

    class Raise(mc.CallbackAbstract):
        def __call__(self, solver):
            raise ZeroDivisionError("in a callback")

    solver.setCallbacks([Raise()])
    with pytest.raises(ZeroDivisionError):
        solver.solve()


def test_box(one_joint):  # noqa: F811
    node = mc.IntegratedActionModelEuler(Pendulum(one_joint), 0.05)
    node.u_lb, node.u_ub = [-0.5], [0.5]
    terminal = mc.IntegratedActionModelEuler(Pendulum(one_joint), 0)
    solver = mc.SolverBoxFDDP(mc.ShootingProblem([1.0, 0.0], [node] * 30, terminal))
    assert solver.solve(maxiter=200)
    assert np.max(np.abs(solver.us)) <= 0.5 + 1e-12
    residual = mc.kkt_residual(solver.problem, solver.xs, solver.us, solver.Vx, True)
    assert np.isfinite(residual)
    with pytest.raises(ValueError, match="threads"):
        solver.problem.nthreads = 1000000
    with pytest.raises(ValueError, match="nan"):
        node.u_lb = [np.nan]
    with pytest.raises(ValueError, match="sizes|expected|numbers"):
        solver.setCandidate([np.zeros(3)] * 31, solver.us)


def test_task_as_the_program_solves_it(program, tmp_path):
    path = str(MODELS / "tasks" / "humanoid_reaches.xml")
    out = tmp_path / "out.json"
    csv = tmp_path / "out.csv"
    subprocess.run([program, "optimize", path, "--out", str(csv), "--json", str(out)], capture_output=True)
    theirs = json.loads(out.read_text())
    task = mc.load_task(path)
    seen = []
    solution = mc.optimize(task, each=seen.append)
    assert solution.converged == theirs["converged"] and solution.cost == theirs["cost"]
    assert np.array_equal(solution.xs, theirs["xs"]) and np.array_equal(solution.us, theirs["us"])
    assert [i.cost for i in seen] == [i["cost"] for i in theirs["iterations"]]
    assert [i.cost for i in solution.iterations] == [i.cost for i in seen]

    problem = mc.make_problem(task)
    problem.xs, problem.us = solution.xs, solution.us
    again = mc.optimize(task, problem, solver="fddp")
    assert len(again.iterations) <= 2
    stopped = mc.optimize(task, each=lambda iteration: False)
    assert len(stopped.iterations) == 1 and not stopped.converged
    with pytest.raises(ValueError, match="another task"):
        mc.simulate(mc.load_task(str(MODELS / "tasks" / "quadruped_trots.xml")), solution)
    with pytest.raises(mc.InputError, match=r"^nowhere\.xml:1: "):
        mc.load_task("nowhere.xml")
    with pytest.raises(ValueError, match="unknown solver"):
        mc.optimize(task, solver="ipopt")


def test_solution_in_simulation_by_its_gains(program, tmp_path):
    path = str(MODELS / "tasks" / "quadruped_trots.xml")
    out = tmp_path / "out.json"
    subprocess.run(
        [program, "optimize", path, "--out", str(tmp_path / "out.csv"), "--json", str(out), "--simulate", "1e-3"],
        capture_output=True,
    )
    report = json.loads(out.read_text())["report"]
    task = mc.load_task(path)
    solution = mc.optimize(task)
    assert solution.direction == report["direction"] == "Riccati" and solution.blocks == report["blocks"] == [12]
    assert solution.times.total > solution.times.direction > 0
    (gains,) = solution.gains
    assert gains.dx == list(range(36)) and gains.u == list(range(12)) and len(gains.K) == task.nodes == 56
    assert gains.K[0].shape == (12, 36) and gains.K[24].shape == (0, 36)
    motion = mc.simulate(task, solution, "rk4", 10)
    theirs = report["simulation"]
    assert motion.stopped == mc.StepStatus.OK and theirs["completed"]
    assert motion.distance == theirs["distance"] and motion.energy_lost == theirs["energy_lost"] > 0
    assert len(motion.xs) == 57 and np.all(np.isfinite(motion.xs))
    u = solution.us[5] - gains.K[5] @ np.full(36, 0.01)  # feedback of a state that deviates
    assert np.max(np.abs(u - solution.us[5])) > 0.1
    with pytest.raises(ValueError, match="substeps is below 1"):
        mc.simulate(task, solution, substeps=0)
    with pytest.raises(ValueError, match="unknown integrator"):
        mc.simulate(task, solution, "euler")


def test_parts_of_a_task(tmp_path):
    scene = (MODELS / "tasks" / "quadruped_scene.xml").read_text().replace("../", str(MODELS) + "/")
    scene = scene.replace('name="quadruped" urdf', 'name="quadruped" copies="2" spacing="1.5" arrange="line" urdf')
    (tmp_path / "quadruped_scene.xml").write_text(scene)
    (tmp_path / "task.xml").write_text((MODELS / "tasks" / "quadruped_trots.xml").read_text())
    task = mc.load_task(str(tmp_path / "task.xml"))
    problem = mc.make_problem(task, "sparse")
    assert problem.parts == problem.blocks == [[0], [1]]
    solution = mc.optimize(task, problem, solver="sparse")
    assert solution.converged and solution.blocks == [12, 12] and len(solution.gains) == 2
    assert solution.gains[1].u == list(range(12, 24)) and solution.gains[1].dx[0] == 18
    assert mc.simulate(task, solution).stopped == mc.StepStatus.OK


def test_the_symplectic_node_is_the_step_and_has_its_derivatives(one_joint):  # noqa: F811
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    scene, h = file.scene, 1e-2
    state = mc.StateMultibody(scene)
    actuation = mc.ActuationModelFloatingBase(state)
    nu = actuation.nu
    contacts = mc.contacts_of_scene(state, scene, nu)
    dynamics = mc.DifferentialActionModelContactFwdDynamics(state, actuation, contacts, mc.CostModelSum(state, nu))
    node = mc.IntegratedActionModelSymplectic(dynamics, h)
    data = node.createData()
    rng = np.random.default_rng(3)
    q = mc.integrate(scene, file.q, 0.05 * rng.standard_normal(scene.nv))
    x, u = np.concatenate([q, 0.3 * rng.standard_normal(scene.nv)]), 10 * rng.standard_normal(nu)

    def step(x, u):
        sim = mc.SimulationData(scene, x[: scene.nq], x[scene.nq :], "semi-implicit-euler", h)
        assert mc.step(scene, u, sim) == mc.StepStatus.OK
        return np.concatenate([sim.q, sim.v])

    def difference(of):
        e, at = 1e-4, [step(*of(s)) for s in (-2e-4, -1e-4, 1e-4, 2e-4)]
        far, near = state.diff(at[0], at[3]), state.diff(at[1], at[2])
        return (8 * near - far) / (12 * e)

    node.calc(data, x, u)
    node.calcDiff(data, x, u)
    assert np.abs(data.xnext - step(x, u)).max() < 1e-11 * (1 + np.abs(data.xnext).max())
    dx, du = rng.standard_normal(state.ndx), rng.standard_normal(nu)
    for mine, truth in [
        (data.Fx @ dx, difference(lambda s: (state.integrate(x, s * dx), u))),
        (data.Fu @ du, difference(lambda s: (x, u + s * du))),
    ]:
        assert np.abs(mine - truth).max() < 1e-7 * np.abs(truth).max()
    with pytest.raises(ValueError, match="IntegratedActionModelEuler"):
        mc.IntegratedActionModelSymplectic(Pendulum(one_joint), h)


def test_axes_of_cones():
    scene = mc.load_scene(str(MODELS / "humanoid_standing.xml")).scene
    state = mc.StateMultibody(scene)
    sole = scene.contacts[0].A.frame.split("/")[-1]
    cone = mc.ResidualModelContactFrictionCone(state, state.pinocchio.getFrameId(sole), mc.FrictionCone(np.eye(3), 0.7))
    assert cone.axes == mc.ConeAxes.CONTACT
    cone.axes = "world"
    assert cone.axes == mc.ConeAxes.WORLD
    with pytest.raises(ValueError, match="'foot'"):
        cone.axes = "feet"


def test_circular_append_with_data():
    model = mc.ActionModelUnicycle()
    problem = mc.ShootingProblem(np.zeros(3), [mc.ActionModelUnicycle() for _ in range(3)], mc.ActionModelUnicycle())
    data = model.createData()
    problem.circularAppend(model, data)
    assert problem.runningModels[-1] is model and problem.runningDatas[-1] is data
    with pytest.raises(TypeError):
        problem.circularAppend(model, None)
