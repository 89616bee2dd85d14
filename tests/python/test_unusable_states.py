"""Invalid configurations are refused in every argument q: quaternions that are not of unit length, numbers that are
not finite. solve and steps return a status instead."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

FILE = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
SCENE, Q, V, U = FILE.scene, np.array(FILE.q), np.array(FILE.v), np.array(FILE.u)
DATA = mc.SceneData(SCENE)
mc.solve(SCENE, Q, V, U, DATA)
STATE = mc.StateMultibody(SCENE)
X = np.concatenate([Q, V])
A = np.ones(SCENE.nv)
GOALS = [mc.pose_goal(SCENE, "humanoid/left_sole", mc.SE3())]

# All functions with a q, as f(q).
CALLS = {
    "integrate": lambda q: mc.integrate(SCENE, q, V),
    "difference": lambda q: mc.difference(SCENE, q, Q),
    "difference to": lambda q: mc.difference(SCENE, Q, q),
    "interpolate": lambda q: mc.interpolate(SCENE, q, Q, 0.5),
    "integrate_derivatives": lambda q: mc.integrate_derivatives(SCENE, q, V),
    "difference_derivatives": lambda q: mc.difference_derivatives(SCENE, q, Q),
    "rnea": lambda q: mc.rnea(SCENE, q, V, A),
    "nonlinear_effects": lambda q: mc.nonlinear_effects(SCENE, q, V),
    "gravity_torques": lambda q: mc.gravity_torques(SCENE, q),
    "aba": lambda q: mc.aba(SCENE, q, V, A),
    "crba": lambda q: mc.crba(SCENE, q),
    "inverse_inertia_times": lambda q: mc.inverse_inertia_times(SCENE, q, A),
    "coriolis_matrix": lambda q: mc.coriolis_matrix(SCENE, q, V),
    "rnea_derivatives": lambda q: mc.rnea_derivatives(SCENE, q, V, A),
    "aba_derivatives": lambda q: mc.aba_derivatives(SCENE, q, V, A),
    "forward_kinematics": lambda q: mc.forward_kinematics(SCENE, q, mc.RigidBodyData(SCENE)),
    "contact_jacobian": lambda q: mc.contact_jacobian(SCENE, q),
    "contact_bias_acceleration": lambda q: mc.contact_bias_acceleration(SCENE, q, V),
    "contact_forces_on_bodies": lambda q: mc.contact_forces_on_bodies(SCENE, q, DATA.f, DATA.f_offset),
    "resolve_references": lambda q: mc.resolve_references(SCENE, q),
    "place": lambda q: mc.place(SCENE, q, GOALS),
    "make_consistent": lambda q: mc.make_consistent(SCENE, q, V),
    "quasi_static": lambda q: mc.quasi_static(SCENE, q),
    "update_kinematics": lambda q: mc.update_kinematics(SCENE, q, V, mc.SceneData(SCENE)),
    "invariants": lambda q: mc.invariants(SCENE, [True] * len(SCENE.contacts), q, V),
    "placement_errors": lambda q: mc.placement_errors(SCENE, q),
    "velocity_errors": lambda q: mc.velocity_errors(SCENE, q, V),
    "violations": lambda q: mc.violations(SCENE, q, DATA),
    "limits_passed": lambda q: mc.limits_passed(SCENE, q, V, U),
    "forces_on_bodies": lambda q: mc.forces_on_bodies(SCENE, q, V, DATA),
    "force_null_space": lambda q: mc.force_null_space(SCENE, q, DATA),
    "redistribute_forces": lambda q: mc.redistribute_forces(SCENE, q, DATA),
    "unique_forces": lambda q: mc.unique_forces(SCENE, q, DATA),
    "rank_changes": lambda q: mc.rank_changes(SCENE, q, DATA),
    "near_dependent": lambda q: mc.near_dependent(SCENE, q, DATA),
    "state.integrate": lambda q: STATE.integrate(np.concatenate([q, V]), np.zeros(STATE.ndx)),
    "state.diff": lambda q: STATE.diff(np.concatenate([q, V]), X),
    "state.diff to": lambda q: STATE.diff(X, np.concatenate([q, V])),
}
# These return a status for any q.
BY_STATUS = {"solve", "solve_tau", "SimulationData", "set_state"}


def unusable():
    base = slice(3, 7)
    for name, quaternion in [
        ("zeros", np.zeros(4)),
        ("twice", 2 * Q[base]),
        ("nearly", (1 + 2e-6) * Q[base]),
        ("tiny", 1e-200 * Q[base]),
        ("nan", np.full(4, np.nan)),
    ]:
        q = Q.copy()
        q[base] = quaternion
        yield pytest.param(q, id=name)
    for wrong in np.nan, np.inf, -np.inf:
        q = Q.copy()
        q[-1] = wrong
        yield pytest.param(q, id=f"joint {wrong}")
    yield pytest.param(np.zeros(SCENE.nq), id="all zeros")


@pytest.mark.parametrize("q", unusable())
@pytest.mark.parametrize("name", CALLS)
def test_refused(name, q):
    places = [np.array(c.B.placement.p) for c in SCENE.contacts]
    with pytest.raises(ValueError, match="unit quaternion|finite number"):
        CALLS[name](q)
    for contact, place in zip(SCENE.contacts, places):
        np.testing.assert_array_equal(contact.B.placement.p, place)


@pytest.mark.parametrize("name", CALLS)
def test_accepted(name):
    """The quaternion has seven digits, as in files."""
    q = Q.copy()
    q[3:7] *= 1 + 4e-7
    CALLS[name](q)


def test_every_function_is_asked():
    import re

    asked = {name.split()[0] for name in CALLS} | BY_STATUS
    for name, function in vars(mc._manycontact).items():
        if re.search(r"\bq[01]?: numpy", getattr(function, "__doc__", None) or "") and not isinstance(function, type):
            assert name in asked, name


@pytest.mark.parametrize("q", unusable())
def test_statuses(q):
    data = mc.SceneData(SCENE)
    if not np.isfinite(q).all():
        with pytest.raises(ValueError, match="a finite number is expected"):
            mc.solve(SCENE, q, V, U, data)
    else:
        assert mc.solve(SCENE, q, V, U, data).status == mc.Status.FAILED


def test_trajectories_of_views(program, monkeypatch):
    monkeypatch.setenv("MANYCONTACT_BINARY", program)

    class Motion:
        t, q, v = np.arange(2.0), np.array([Q, np.zeros(SCENE.nq)]), np.array([V, V])

    with pytest.raises(mc.InputError, match=r"motion.csv:3: .*a unit quaternion x y z w is expected"):
        mc.view(FILE, Motion())
