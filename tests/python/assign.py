"""Assigns every wrong kind of thing to every property of every class of the package, then looks at it again: the answer
is a Python exception or a value that it took, never a crash.

    assign.py        under PYTHONPATH=build/release/python; the assignment at hand is in FUZZ_LOG
"""

import os

import fuzz
import manycontact as mc
import numpy as np

WRONG = [
    None, {}, {"wind": [0, 20, 0, 0, 0, 0]}, "abc", "", b"abc", -1, 0, 10**30, 1.5, float("nan"), float("inf"), 1j, [], [[]],
    [[1, 2], [3]], ["a"], [None], object(), int, lambda: 0, np.zeros(0), np.zeros((0, 6)), np.zeros(7), np.zeros((3, 7)),
    np.zeros((1, 6), complex), np.array(["a"]), np.array([None]), np.full((1, 6), np.nan), set(), (), range(3), slice(1),
]  # fmt: skip


def more_objects():
    """Returns objects of the classes that fuzz.objects() lacks."""
    root = str(fuzz.ROOT / "models")
    pushed = mc.load_scene(root + "/humanoid_pushed.xml")
    scene, data = pushed.scene, mc.SceneData(pushed.scene)
    mc.solve(scene, pushed.q, pushed.v, pushed.u, data)
    state = mc.StateMultibody(scene)
    nu, SE3 = mc.ActuationModelFull(state).nu, mc.SE3()
    frames = [
        mc.ResidualModelFramePlacement(state, 1, SE3, nu), mc.ResidualModelFrameTranslation(state, 1, np.zeros(3), nu),
        mc.ResidualModelFrameRotation(state, 1, np.eye(3), nu),
        mc.ResidualModelFrameVelocity(state, 1, np.zeros(6), mc.LOCAL, nu),
        mc.ResidualModelContactForce(state, 1, np.zeros(6), 6, nu),
        mc.ResidualModelContactFrictionCone(state, 1, mc.FrictionCone(), nu),
        mc.ResidualModelContactWrenchCone(state, 1, mc.WrenchCone(np.eye(3), 0.7, [0.1, 0.1]), nu),
        mc.ResidualModelContactCoPPosition(state, 1, mc.CoPSupport(np.eye(3), [0.1, 0.1]), nu),
    ]  # fmt: skip
    others = [
        mc.ResidualModelControl(state, nu), mc.ResidualModelJointEffort(state, mc.ActuationModelFull(state)),
        mc.ResidualModelJointAcceleration(state, nu), mc.ResidualModelCoMPosition(state, np.zeros(3), nu),
        mc.ResidualModelCentroidalMomentum(state, np.zeros(6), nu),
    ]  # fmt: skip
    contacts = [
        mc.ContactModel1D(state, 1, 0.0, nu), mc.ContactModel2D(state, 1, np.zeros(2), nu),
        mc.ContactModel6D(state, 1, SE3, mc.LOCAL, nu),
    ]  # fmt: skip
    bounds = mc.ActivationBounds([0.0], [1.0])
    activations = [mc.ActivationModelWeightedQuad(np.ones(2)), mc.ActivationModelQuadraticBarrier(bounds)]
    costs = mc.CostModelSum(state, nu)
    costs.addCost("u", mc.CostModelResidual(state, others[0]), 1)
    node = mc.DifferentialActionModelContactFwdDynamics(
        state, mc.ActuationModelFull(state), mc.ContactModelMultiple(state, nu), costs
    )
    made = node.createData()
    impact = mc.ActionModelImpulseFwdDynamics(state, mc.ImpulseModelMultiple(state), mc.CostModelSum(state, 0))
    batch = mc.BatchData(scene, 1)
    spring = mc.Spring(name="s", A=mc.Attachment(), stiffness=1.0)
    goal = mc.pose_goal(mc.load_scene(root + "/humanoid_standing.xml").scene, "humanoid/left_sole", SE3)
    mc.differentiate(scene, data)
    thruster = mc.Thruster(SE3, 0.1, mc.ThrusterType.CW, 0.0, 10.0)
    squashing = mc.SquashingModelSmoothSat(np.zeros(2), np.ones(2), 2)
    laws = mc.PdLaws(np.ones(2), np.ones(2), np.zeros(2), np.zeros(2))
    flying = mc.StateMultibody(mc.load_scene(root + "/humanoid_standing.xml").scene)
    parts = [
        thruster, mc.ActuationModelFloatingBaseThrusters(flying, [thruster]), squashing, laws, mc.BoxQP(2),
        mc.StateNumDiff(state), mc.ActivationModelNumDiff(mc.ActivationModelQuad(2)),
        mc.ActuationModelNumDiff(mc.ActuationModelFull(state)), mc.ResidualModelNumDiff(others[0]),
        mc.ControlParametrizationModelNumDiff(mc.ControlParametrizationModelPolyZero(2)),
        mc.CostModelNumDiff(mc.CostModelResidual(state, others[0])), mc.ContactModelNumDiff(contacts[2]),
        mc.ConstraintModelNumDiff(mc.ConstraintModelResidual(state, others[0])),
        mc.SimulationBatch(scene, [pushed.q], [pushed.v], "semi-implicit-euler", 1e-3),
    ]  # fmt: skip
    items = parts + [scene.robots[0], mc.dense_derivatives(scene, data), costs.costs["u"], made.costs["u"], mc.system_quality(scene, data)[0], scene.wrenches[0], spring, goal, batch, data, mc.CallbackVerbose()]
    return items + frames + others + contacts + activations + [node, made, impact, *residual_data(state)]


def residual_data(state):
    """Returns data of a residual, which exist while its calc runs."""
    kept = []

    class Kept(mc.ResidualModelAbstract):
        def calc(self, data, x, u):
            kept.append(data)

        def calcDiff(self, data, x, u):
            pass

    costs = mc.CostModelSum(state)
    costs.addCost("own", mc.CostModelResidual(state, Kept(state, 2, state.nv, mc.Dependence(q=True))), 1)
    model = mc.DifferentialActionModelFreeFwdDynamics(state, mc.ActuationModelFull(state), costs)
    model.calc(model.createData(), state.zero(), np.zeros(state.nv))
    return kept[:1]


def settable(cls):
    return [name for name, x in vars(cls).items() if isinstance(x, property) and x.fset and not name.startswith("_")]


def run():
    pool = fuzz.objects()[0] + more_objects()
    classes = [x for x in vars(mc._manycontact).values() if isinstance(x, type) and not issubclass(x, Exception)]
    classes = [cls for cls in classes if settable(cls)]
    missing = sorted({cls.__name__ for cls in classes if not any(isinstance(x, cls) for x in pool)})
    assert not missing, f"no object of {missing}"
    count = 0
    with open(os.environ.get("FUZZ_LOG", os.devnull), "w") as log:
        for cls in classes:
            for name in settable(cls):
                for x in [x for x in pool if isinstance(x, cls)][:3]:
                    for wrong in WRONG:
                        log.seek(0)
                        log.truncate()
                        print(cls.__name__, name, repr(wrong)[:60], file=log, flush=True)
                        try:
                            setattr(x, name, wrong)
                        except fuzz.REFUSALS:
                            pass
                        try:
                            repr(getattr(x, name))
                        except fuzz.REFUSALS:
                            pass
                        count += 1
    return count


if __name__ == "__main__":
    print(run(), "assignments")
