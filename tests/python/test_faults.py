"""Load and misuse: callbacks that do forbidden things, forks, Ctrl-C, objects without contents."""

import _thread
import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import weakref

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS
from test_control import Wheel


def problem(nodes=20, model=mc.ActionModelUnicycle):
    return mc.ShootingProblem([-1.0, -1.0, 1.0], [model()] * nodes, model())


SOLVERS = [mc.SolverDDP, mc.SolverFDDP, mc.SolverBoxDDP, mc.SolverBoxFDDP, mc.SolverAugmentedLagrangian]


# ---- callbacks ------------------------------------------------------------------------------------------------------


class Counting(mc.CallbackAbstract):
    def __init__(self):
        super().__init__()
        self.calls = 0

    def __call__(self, solver):
        self.calls += 1


@pytest.mark.parametrize("Solver", SOLVERS)
def test_callbacks_that_set_callbacks(Solver):
    """The new callbacks are called from the next iteration on, and stay when the solve has ended."""
    later = Counting()

    class Once(mc.CallbackAbstract):
        calls = 0

        def __call__(self, solver):
            Once.calls += 1
            solver.setCallbacks([mc.CallbackLogger() for _ in range(50)] + [later])
            assert len(solver.getCallbacks()) == 51

    solver = Solver(problem())
    solver.setCallbacks([Once(), Once(), Once()])
    gc.collect()
    solver.solve()
    assert Once.calls == 3 and later.calls > 0
    assert len(solver.getCallbacks()) == 51 and solver.getCallbacks()[-1] is later
    seen = later.calls
    solver.solve(maxiter=1)
    assert later.calls == seen + 1
    with pytest.raises((ValueError, TypeError)):
        solver.setCallbacks([None])


@pytest.mark.parametrize("Solver", SOLVERS)
def test_solvers_held_by_their_callbacks_are_freed(Solver):
    class Knowing(mc.CallbackAbstract):
        def __init__(self, solver):
            super().__init__()
            self.known = solver

        def __call__(self, solver):
            assert solver is self.known

    class Tracked(Solver):
        """A class in Python shows when its object is destroyed."""

    solver = Solver(problem())
    solver.setCallbacks([Knowing(solver), Knowing([solver]), mc.CallbackLogger()])
    solver.getCallbacks()
    gone = [weakref.ref(c) for c in solver.getCallbacks()[:2]]
    del solver
    gc.collect()
    assert all(r() is None for r in gone)

    solver = Tracked(problem())
    callback = Knowing(solver)
    solver.setCallbacks([callback, callback])
    gone = [weakref.ref(solver), weakref.ref(callback)]
    solver.solve(maxiter=2)
    del solver
    gc.collect()
    assert gone[0]() is not None and callback.known.getCallbacks()[0] is callback  # still referenced from here
    del callback
    gc.collect()
    assert all(r() is None for r in gone)


def test_callbacks_in_use_are_not_collected():
    """Reference cycles that are reachable from outside stay, and work."""
    node = Wheel()
    solver = mc.SolverFDDP(mc.ShootingProblem([-1.0, -1.0, 1.0], [node] * 20, node))

    class Knowing(mc.CallbackAbstract):
        calls = 0

        def __call__(self, s):
            assert s is self.solver and self.more == [1, 2]
            Knowing.calls += 1

    callback = Knowing()
    callback.solver, callback.more = solver, [1, 2]
    solver.setCallbacks([callback])
    del callback
    for _ in range(3):
        gc.collect()
        solver.solve(maxiter=3)
    assert Knowing.calls > 3
    kept = solver.getCallbacks()
    del solver
    gc.collect()
    assert kept[0].solver.getCallbacks()[0] is kept[0]


def test_solving_within_a_callback():
    """With the same solver it is refused, with another one it works, even with the same callback object."""
    inner = mc.SolverFDDP(problem())

    class Nested(mc.CallbackAbstract):
        depth = 0
        refusals = []

        def __call__(self, solver):
            if self.depth == 0:
                self.depth = 1
                try:
                    solver.solve()
                except ValueError as e:
                    self.refusals.append(str(e))
                inner.setCallbacks([self])
                assert inner.solve()
                self.depth = 0

    outer = mc.SolverFDDP(problem())
    outer.setCallbacks([Nested()])
    assert outer.solve()
    assert len(Nested.refusals) == outer.iter + 1 and "this solver is in use" in Nested.refusals[0]

    class Uncaught(mc.CallbackAbstract):
        def __call__(self, solver):
            solver.solve()

    outer.setCallbacks([Uncaught()])
    with pytest.raises(ValueError, match="this solver is in use"):
        outer.solve()
    outer.setCallbacks([])
    assert outer.solve()


def test_callbacks_without_a_call():
    class Empty(mc.CallbackAbstract):
        pass

    class Super(mc.CallbackAbstract):
        def __call__(self, solver):
            super().__call__(solver)

    solver = mc.SolverFDDP(problem())
    for callback in (Empty(), Super(), mc.CallbackAbstract()):
        solver.setCallbacks([callback])
        with pytest.raises(ValueError, match="does not define __call__"):
            solver.solve()


@pytest.mark.parametrize("error", [KeyError("a key"), RuntimeError("a reason"), ValueError("a value"), StopIteration()])
def test_exceptions_of_callbacks_are_told_as_what_they_are(error):
    class Raising(mc.CallbackAbstract):
        def __call__(self, solver):
            raise error

    solver = mc.SolverFDDP(problem())
    solver.setCallbacks([Raising()])
    with pytest.raises(type(error)) as raised:
        solver.solve()
    assert raised.value is error and len(solver.getCallbacks()) == 1


# ---- forks ----------------------------------------------------------------------------------------------------------


def batch_of(file, n=100):
    Q, V, U = (np.tile(x, (n, 1)) for x in (file.q, file.v, file.u))
    return mc.solve_batch(file.scene, Q, V, U, mc.BatchData(file.scene, 2))[0]


def _in_a_child(name):
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    if name == "batch":
        return batch_of(file).tobytes()
    if name == "solve":
        data = mc.SceneData(file.scene, mc.Options(threads=2))
        mc.solve(file.scene, file.q, file.v, file.u, data)
        return data.a.tobytes()
    shooting = problem(model=mc.ActionModelUnicycle)
    shooting.nthreads = 2
    solver = mc.SolverFDDP(shooting)
    return solver.solve()


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize("name", ["batch", "solve", "problem"])
def test_children_after_threads(name, method):
    """Parallel regions run in the parent, in its children, and in the parent again."""
    before = _in_a_child(name)
    pool = multiprocessing.get_context(method).Pool(2)
    try:
        assert pool.map_async(_in_a_child, [name] * 4).get(timeout=60) == [before] * 4
    finally:
        pool.terminate()
    assert _in_a_child(name) == before


def test_a_childs_child():
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    expected = batch_of(file)
    pid = os.fork()
    if pid == 0:
        signal.alarm(60)
        good = (batch_of(file) == expected).all()
        inner = os.fork()
        if inner == 0:
            signal.alarm(60)
            os._exit(0 if (batch_of(file) == expected).all() else 1)
        os._exit(0 if good and os.waitpid(inner, 0)[1] == 0 else 1)
    assert os.waitpid(pid, 0)[1] == 0


# ---- Ctrl-C ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["solve_batch", "differentiate_batch", "vjp_batch"])
def test_batches_hear_ctrl_c(name):
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    scene, batch = file.scene, mc.BatchData(file.scene, 1)
    n = 60000
    states = [np.broadcast_to(x, (n, x.size)) for x in (file.q, file.v, file.u)]
    if name == "vjp_batch":
        states += [np.zeros((n, scene.nv)), np.zeros((n, 12))]
    if name == "differentiate_batch":
        states = [x[:5000] for x in states]

    def run(count):
        return getattr(mc, name)(scene, *(np.ascontiguousarray(x[:count]) for x in states), batch)

    start = time.perf_counter()
    run(200)
    whole = (time.perf_counter() - start) * len(states[0]) / 200
    timer = threading.Timer(0.03, _thread.interrupt_main)
    timer.start()
    start = time.perf_counter()
    try:
        with pytest.raises(KeyboardInterrupt):
            run(len(states[0]))
        assert time.perf_counter() - start < max(0.8 * whole, 0.5)
    finally:
        timer.cancel()
    A = run(3)[0]
    assert np.isfinite(A).all()


def test_chunks_change_no_numbers():
    """With more states than one chunk every function gives the results of single states, failed ones too."""
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    scene, batch = file.scene, mc.BatchData(file.scene, 2)
    rng = np.random.default_rng(3)
    n = 600
    Q, V, U = np.tile(file.q, (n, 1)), rng.standard_normal((n, scene.nv)), rng.standard_normal((n, scene.nu))
    V[[5, 300, 599], 0] = np.nan
    A, F, status = mc.solve_batch(scene, Q, V, U, batch)
    WQ, WV, WU, of_products = mc.vjp_batch(scene, Q, V, U, np.ones_like(A), np.ones_like(F), batch)
    assert set(np.flatnonzero(status == 4)) == {5, 300, 599} and (of_products == status).all()
    data = mc.SceneData(scene)
    for k in (0, 255, 256, 257, 511, 512, 598):
        mc.solve(scene, Q[k], V[k], U[k], data)
        assert (A[k] == data.a).all() and (F[k] == data.f).all()
        wq, wv, wu = mc.vjp(scene, data, np.ones(scene.nv), np.ones(F.shape[1]))
        assert np.array_equal(wq, WQ[k]) and np.array_equal(wv, WV[k]) and np.array_equal(wu, WU[k])
    assert mc.solve_batch(scene, Q[:0], V[:0], U[:0], batch)[0].shape == (0, scene.nv)
    for bad in ((Q, V[1:], U), (Q, V, U[:, 1:]), (Q, V, np.vstack([U, U])), (Q[:300], V, U), (Q[:0], V, U)):
        with pytest.raises(ValueError, match="solve_batch: "):
            mc.solve_batch(scene, *bad, batch)


# ---- objects without contents ---------------------------------------------------------------------------------------


def classes():
    return [x for x in vars(mc).values() if isinstance(x, type) and not issubclass(x, Exception)]


def test_objects_that_hold_nothing(tmp_path):
    """The test runs in a process of its own: a crash would end it."""
    text = f"""
import sys; sys.path.insert(0, {os.path.dirname(os.path.dirname(mc.__file__))!r})
import manycontact as mc, pickle, copy
for name, cls in vars(mc).items():
    if not isinstance(cls, type) or issubclass(cls, Exception): continue
    x = cls.__new__(cls)
    uses = [(n, lambda n=n: getattr(x, n)) for n, m in vars(cls).items() if isinstance(m, property) and n[0] != "_"]
    uses += [("repr", lambda: repr(x)), ("str", lambda: str(x))] if hasattr(cls, "__members__") else []
    uses += [(f.__name__, lambda f=f: f(x)) for f in (copy.copy, pickle.dumps, len, list, int)]
    for use, call in uses:
        try: call()
        except (TypeError, AttributeError): continue
        except Exception as e: raise SystemExit(f"{{name}}: {{use}}: {{e!r}}")
        if use not in ("copy", "dumps"): raise SystemExit(f"{{name}}: {{use}} answers")
scene = mc.Scene.__new__(mc.Scene)
contact = mc.Contact.__new__(mc.Contact)
for call in (lambda: mc.neutral(scene), lambda: mc.SceneData(scene), lambda: mc.add_contact(mc.Scene(), contact)):
    try: call()
    except TypeError: continue
    raise SystemExit("an empty scene was taken")
class Mine(mc.ActivationModelAbstract):
    def __init__(self): pass
try: Mine()
except TypeError: print("done")
"""
    run = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert run.returncode == 0 and run.stdout.strip() == "done", run.stderr[-2000:] + f" {run.returncode}"


# ---- constants ------------------------------------------------------------------------------------------------------


def test_large_scenes_are_looked_at_item_by_item():
    """Neither a loop over contacts nor the force of each copies all: the time is linear in their number."""
    model = mc.load_urdf(str(MODELS / "box.urdf"), floating_base=True)

    def seconds(n):
        scene = mc.Scene("many")
        mc.add_robot(scene, "box", model)
        for k in range(n):
            A = mc.attach(scene, "box", model.frames[0].name)
            contact = mc.Contact(name=f"c{k}", A=A, type="1d", active=k < 3)
            mc.add_contact(scene, contact)
        data = mc.SceneData(scene)
        mc.solve(scene, mc.neutral(scene), np.zeros(scene.nv), np.zeros(scene.nu), data)
        best = np.inf
        for _ in range(3):
            start = time.perf_counter()
            for k in range(len(scene.contacts)):
                scene.contacts[k].alpha = 1
            for k in range(n):
                mc.contact_force(scene, data, k % 3)
            best = min(best, time.perf_counter() - start)
        return best

    few, many = seconds(500), seconds(4000)
    assert many < 8 * 4 * few
