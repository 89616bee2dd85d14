"""Solve, derivatives, products and batches agree with the program bit for bit and with each other; ownership is tested."""

import gc
import json
import subprocess
import threading

import manycontact as mc
import numpy as np
import pytest
from conftest import GOLDEN, MODELS, ROOT

SCENES = [MODELS / (name + ".xml") for name in ("humanoid_standing", "feet_on_corners", "two_humanoids_carry_beam")]
SCENES += sorted(GOLDEN.glob("*.xml"))


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_the_programs_numbers(scene, program, tmp_path):
    out = tmp_path / "out.json"
    run = [program, "solve", str(scene), "--derivatives", "--quasi-static", "--json", str(out)]
    assert subprocess.run(run, capture_output=True).returncode in (0, 1)
    theirs = json.loads(out.read_text())
    file = mc.load_scene(str(scene))
    data = mc.SceneData(file.scene)
    report = mc.solve(file.scene, file.q, file.v, file.u, data)
    ours = {"acceleration": data.a, "forces": data.f}
    mc.differentiate(file.scene, data)
    dense = mc.dense_derivatives(file.scene, data)
    for name in ("da_dq", "da_dv", "da_du", "dforces_dq", "dforces_dv", "dforces_du"):
        ours[name] = getattr(dense, name)
    ours["quasi_static_u"] = mc.quasi_static(file.scene, file.q)
    for name, values in ours.items():
        assert np.array_equal(np.array(theirs[name]).reshape(values.shape), values), name
    assert str(report.status) == theirs["report"]["status"]
    assert report.rank == theirs["report"]["rank"]
    assert mc.velocity_names(file.scene) == theirs["velocity_names"]
    assert mc.force_names(file.scene, data) == theirs["force_names"]


def test_report(humanoid):
    file, data = humanoid
    report = mc.solve(file.scene, file.q, file.v, file.u, data)
    for of in (report, report.islands[0]):  # values without an estimate are not 0
        assert all(np.isnan(x) for x in (of.condition, of.error_acceleration, of.error_forces))
    assert report.islands[0].nv == 38 and report.rank == 12
    assert report.times.solve > 0 and report.times.setup >= 0
    assert report.remedy == "" and report.islands[0].remedy == ""
    assert report == mc.solve(file.scene, file.q, file.v, file.u, data)  # times are not compared
    assert report.residual_dynamics < 1e-12
    assert mc.estimate_condition(file.scene, data).condition > 1
    assert 0 < mc.estimate_errors(file.scene, data).error_acceleration
    quality = mc.system_quality(file.scene, data)
    assert len(quality) == len(report.islands) and quality == mc.system_quality(file.scene, data)
    assert (quality[0].positive, quality[0].negative, quality[0].zero) == (38, 12, 0)
    assert 0 < quality[0].normwise_backward_error <= quality[0].componentwise_backward_error
    assert quality[0].normwise_backward_error < 1e-12
    assert quality[0].growth >= 1 and 1 < quality[0].scaled_condition and 1 < quality[0].condition
    mc.differentiate(file.scene, data)
    bounds = mc.estimate_derivative_errors(file.scene, data)
    assert len(bounds) == len(data.report.islands)
    assert 0 < bounds[0].da_dq < 1e-6 and 0 < bounds[0].dforces_du < 1e-6
    assert np.isnan(report.condition)  # a copy
    mc.differentiate(file.scene, data, mc.DerivativeRequest(u=False))
    bounds = mc.estimate_derivative_errors(file.scene, data)
    assert 0 < bounds[0].da_dq < 1e-6 and np.isnan(bounds[0].da_du) and np.isnan(bounds[0].da_dw)


def test_redistributed_forces():
    """J^T f stays the same, at the least weighted distance, compared with the null space of J^T."""
    file = mc.load_scene_text(
        """<scene><robot name="b" urdf="box.urdf" base="floating"/>
        <contact name="lower" type="3d" frame="b/crate" offset="-0.2 0 -0.2"/>
        <contact name="upper" type="3d" frame="b/crate" offset="-0.2 0 0.2"/></scene>""",
        str(ROOT / "models" / "door.xml"),
    )
    data = mc.SceneData(file.scene)
    report = mc.solve(file.scene, file.q, file.v, file.u, data)
    assert str(report.status) == "redundant" and "redistribute_forces" in report.remedy
    J = mc.contact_jacobian(file.scene, file.q)
    N = mc.force_null_space(file.scene, file.q, data).toarray()
    assert N.shape == (6, 1)
    np.testing.assert_allclose(J.T @ N, 0, atol=1e-12)
    reference, weights = np.array([0, 0, 100, 0, 0, 0.0]), np.array([1, 1, 4, 1, 1, 1.0])
    f = mc.redistribute_forces(file.scene, file.q, data, reference, weights)
    np.testing.assert_allclose(J.T @ f, J.T @ data.f, atol=1e-9)
    np.testing.assert_allclose(N.T @ (weights * (f - reference)), 0, atol=1e-9)
    np.testing.assert_allclose(mc.redistribute_forces(file.scene, file.q, data), data.f, atol=1e-9)
    for wrong in ({"reference": [1.0]}, {"weights": [1.0] * 5}, {"weights": [0.0] * 6}, {"reference": [np.nan] * 6}):
        with pytest.raises(ValueError):
            mc.redistribute_forces(file.scene, file.q, data, **wrong)


def test_arrays_on_derivatives_keep_their_numbers(humanoid):
    file, data = humanoid
    scene = file.scene
    mc.solve(scene, file.q, file.v, file.u, data)
    blocks = mc.differentiate(scene, data).islands[0]
    held = blocks.da_dq
    assert not held.flags.owndata and not held.flags.writeable
    other = blocks.da_dq
    assert other.__array_interface__["data"] == held.__array_interface__["data"]  # no copy
    expected = held.copy()

    q = file.q.copy()
    q[8] += 0.1
    mc.solve(scene, q, file.v, file.u, data)
    with pytest.raises(ValueError, match="differentiate first"):
        blocks.da_dv
    mc.differentiate(scene, data)
    assert (held == expected).all() and (blocks.da_dq != expected).any()

    mc.differentiate(scene, data, mc.DerivativeRequest(v=False))  # another layout of the memory
    data.active[0] = False
    mc.solve(scene, file.q, file.v, file.u, data)
    mc.differentiate(scene, data)
    mc.release_derivatives(data)
    assert (held == expected).all()
    mc.solve(scene, file.q, file.v, file.u, data)
    last = mc.differentiate(scene, data).islands[0].da_du
    expected = last.copy()
    del file, scene, data, blocks
    gc.collect()
    np.zeros(100000)
    assert (last == expected).all()


def test_active_takes_flags(humanoid):
    file, data = humanoid
    batch = mc.BatchData(file.scene)
    for holder in (data, batch):
        for flags in ([True, False], (np.bool_(1), False), [1, 0], np.array([True, False]), np.array([1, 0], "uint8")):
            holder.active = [False, True]
            holder.active = flags
            assert list(holder.active) == [True, False]
        for wrong, error, says in [
            (True, TypeError, "a sequence of bools"),
            ("10", TypeError, "a sequence of bools"),
            (None, TypeError, "a sequence of bools"),
            ({True, False}, TypeError, "a sequence of bools"),
            ([1.0, 0.0], TypeError, "a sequence of bools"),
            ([True, None], TypeError, "a sequence of bools"),
            (["left", "right"], TypeError, "a sequence of bools"),
            ([], ValueError, "2 flags are expected"),
            ([True], ValueError, "2 flags are expected"),
            ([True] * 3, ValueError, "2 flags are expected"),
            ([[True], [False]], ValueError, "2 flags are expected"),
            ([0, 2], ValueError, r"active\[1\] is 2, a bool"),
            ([-1, 0], ValueError, r"active\[0\] is -1, a bool"),
        ]:
            with pytest.raises(error, match=says):
                holder.active = wrong
            assert list(holder.active) == [True, False]
    data.active |= [False, True]
    data.active[0] = False
    assert list(data.active) == [False, True]
    assert mc.solve(file.scene, file.q, file.v, file.u, data).nc == 6


def test_matrices_agree(humanoid):
    file, data = humanoid
    scene = file.scene
    rng = np.random.default_rng(1)
    v, u = rng.standard_normal(scene.nv), rng.standard_normal(scene.nu)
    mc.solve(scene, file.q, v, u, data)
    blocks = mc.differentiate(scene, data).islands[0]
    dense, sparse = mc.dense_derivatives(scene, data), mc.sparse_derivatives(scene, data)
    whole = np.block(
        [[dense.da_dq, dense.da_dv, dense.da_du], [dense.dforces_dq, dense.dforces_dv, dense.dforces_du]]
    )
    assert (sparse.toarray() == whole).all() and (blocks.da_dq == dense.da_dq).all()

    tolerance = dict(rtol=0, atol=1e-9 * abs(whole).max())
    dx = [rng.standard_normal(n) for n in (scene.nv, scene.nv, scene.nu)]
    assert np.allclose(np.concatenate(mc.jvp(scene, data, *dx)), whole @ np.concatenate(dx), **tolerance)
    wa, wf = rng.standard_normal(scene.nv), rng.standard_normal(data.f.size)
    products = np.concatenate(mc.vjp(scene, data, wa, wf))
    assert np.allclose(products, np.concatenate([wa, wf]) @ whole, **tolerance)
    with pytest.raises(ValueError, match="jvp"):
        mc.jvp(scene, data, dx[0][1:], dx[1], dx[2])

    K = mc.kkt_matrix(scene, data)
    assert K.shape == (50, 50) and abs(K - K.T).max() == 0
    x = np.concatenate([data.a, -data.f])
    gravity = np.zeros(scene.nv)
    free = mc.SceneData(scene)
    free.active[:] = False
    mc.solve(scene, file.q, v, u, free)
    M = K.toarray()[: scene.nv, : scene.nv]
    gravity = M @ free.a  # tau - h
    assert np.allclose((K @ x)[: scene.nv], gravity, rtol=0, atol=1e-9 * abs(gravity).max())


def test_islands_of_a_scene():
    file = mc.load_scene(str(MODELS / "herd.xml"))
    data = mc.SceneData(file.scene)
    report = mc.solve(file.scene, file.q, file.v, file.u, data)
    islands = mc.differentiate(file.scene, data).islands
    assert len(islands) == len(report.islands) == mc.island_count(data)
    dense = mc.dense_derivatives(file.scene, data)
    for i, blocks in enumerate(islands):
        island = mc.solved_island(data, i)
        first = file.scene.robots[island.robots[0]].idx_v
        assert (blocks.da_dq == dense.da_dq[first : first + blocks.nv, first : first + blocks.nv]).all()
    with pytest.raises(IndexError):
        islands[len(islands)]
    assert mc.kkt_matrix(file.scene, data, 1).shape[0] == islands[1].nv + islands[1].nc
    size = file.scene.nv + data.f.size
    assert mc.kkt_matrix(file.scene, data).shape == (size, size)


def test_batches(humanoid):
    file, data = humanoid
    scene = file.scene
    rng = np.random.default_rng(2)
    n = 5
    Q = np.array([mc.integrate(scene, file.q, 0.01 * rng.standard_normal(scene.nv)) for _ in range(n)])
    V, U = rng.standard_normal((n, scene.nv)), rng.standard_normal((n, scene.nu))
    V[3, 0] = np.nan
    batch = mc.BatchData(scene, threads=2)
    A, F, D, status = mc.differentiate_batch(scene, Q, V, U, batch)
    A2, F2, status2 = mc.solve_batch(scene, Q, V, U, batch)
    WQ, WV, WU, _ = mc.vjp_batch(scene, Q, V, U, np.ones_like(A), np.ones_like(F), batch)
    assert list(status) == [0, 0, 0, 4, 0] and np.isnan(A[3]).all() and (status2 == status).all()
    for k in (0, 1, 2, 4):
        fresh = mc.SceneData(scene)
        mc.solve(scene, Q[k], V[k], U[k], fresh)
        assert (A[k] == fresh.a).all() and (F[k] == fresh.f).all() and (A2[k] == fresh.a).all()
        mc.differentiate(scene, fresh)
        assert (D[k] == mc.sparse_derivatives(scene, fresh).toarray()).all()
        wq, wv, wu = mc.vjp(scene, fresh, np.ones(scene.nv), np.ones(F.shape[1]))
        assert np.array_equal(wq, WQ[k]) and np.array_equal(wv, WV[k]) and np.array_equal(wu, WU[k])
    with pytest.raises(ValueError, match="solve_batch"):
        mc.solve_batch(scene, Q[:2], V, U, batch)


def use_in_threads(solved, make, shared, times):
    """Threads with data of their own run concurrently; with the same data they are refused, not wrong."""
    expected, failures, refused = solved(shared).copy(), [], []

    def work():
        own = make()
        for _ in range(times):
            if not (solved(own) == expected).all():
                failures.append("numbers")
            try:
                solved(shared)
            except ValueError as e:
                refused.append(str(e))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert not failures
    assert all("another thread" in text for text in refused)


def test_data_of_one_thread_at_a_time():
    file = mc.load_scene(str(MODELS / "ring_of_humanoids.xml"))

    def solved(data):
        mc.solve(file.scene, file.q, file.v, file.u, data)
        return data.a

    use_in_threads(solved, lambda: mc.SceneData(file.scene), mc.SceneData(file.scene), 10)


def test_batches_in_threads():
    file = mc.load_scene(str(MODELS / "ring_of_humanoids.xml"))
    Q, V, U = (np.tile(x, (40, 1)) for x in (file.q, file.v, file.u))

    def solved(batch):
        return mc.solve_batch(file.scene, Q, V, U, batch)[0]

    use_in_threads(solved, lambda: mc.BatchData(file.scene, threads=2), mc.BatchData(file.scene, threads=1), 5)


def test_simulation(humanoid):
    file, _ = humanoid
    scene = file.scene
    sim = mc.SimulationData(scene, file.q, file.v, mc.Integrator.SEMI_IMPLICIT_EULER, 1e-3)
    start = mc.invariants(scene, sim.dynamics.active, sim.q, sim.v)
    for _ in range(3):
        assert mc.step(scene, file.u, sim) == mc.StepStatus.OK
    assert sim.steps == 3 and sim.time == pytest.approx(3e-3)
    twin = mc.SimulationData(scene, file.q, file.v, "semi-implicit-euler", 1e-3)
    trajectory = mc.simulate(scene, np.tile(file.u, (3, 1)), twin, 3)
    assert (trajectory.q[-1] == sim.q).all() and trajectory.q.shape == (4, scene.nq)
    assert mc.invariants(scene, sim.dynamics.active, sim.q, sim.v).energy == pytest.approx(start.energy)
    alpha, beta = mc.recommended_gains("semi-implicit-euler", 1e-3)
    assert (alpha, beta) == (1 / (4 * 1e-3**2), 3 / (4 * 1e-3))
    with pytest.raises(ValueError, match="shape"):
        mc.simulate(scene, file.u[1:], sim, 3)
    with pytest.raises(ValueError, match="unknown integrator"):
        mc.SimulationData(scene, file.q, file.v, "euler", 1e-3)


def test_frames(humanoid):
    file, data = humanoid
    mc.update_kinematics(file.scene, file.q, file.v, data)
    robot = file.scene.robots[0].name
    foot = mc.frame_placement(file.scene, data, robot, "left_sole")
    assert np.allclose(foot.p, file.scene.contact("left").B.placement.p, atol=1e-12)
