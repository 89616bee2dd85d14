"""Random calls of everything the package has, with arguments of the right types and wild values: the answer is a result
or a Python exception, never a crash.

    fuzz.py [SEED [CALLS]]        under PYTHONPATH=build/release/python; a crash ends it, the last call is in FUZZ_LOG
"""

import collections
import os
import pathlib
import random
import sys

import manycontact as mc
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "src/python"))  # after the built package
import stubs  # noqa: E402

REFUSALS = (ValueError, TypeError, IndexError, KeyError, MemoryError, OverflowError)


def objects():
    """Returns one or more objects of most classes, which belong together where possible."""
    file = mc.load_scene(str(ROOT / "models/humanoid_standing.xml"))
    scene = file.scene
    data = mc.SceneData(scene)
    mc.solve(scene, file.q, file.v, file.u, data)
    mc.differentiate(scene, data)
    state = mc.StateMultibody(scene)
    actuation = mc.ActuationModelFloatingBase(state)
    nu, x = actuation.nu, np.concatenate([file.q, file.v])
    costs, contacts = mc.CostModelSum(state, nu), mc.ContactModelMultiple(state, nu)
    constraints = mc.ConstraintModelManager(state, nu)
    residual = mc.ResidualModelState(state, nu)
    costs.addCost("state", mc.CostModelResidual(state, residual), 1)
    model = mc.DifferentialActionModelContactFwdDynamics(state, actuation, contacts, costs, constraints)
    node, wheel = mc.IntegratedActionModelEuler(model, 0.01), mc.ActionModelUnicycle()
    problem = mc.ShootingProblem(x, [node, node], node)
    task = mc.load_task(str(ROOT / "models/tasks/humanoid_reaches.xml"))
    task.iterations = 2
    quad = mc.ActivationModelQuad(76)
    pool = [file, scene, data, state, actuation, costs, contacts, constraints, residual, model, node, problem, task]
    pool += [mc.SolverFDDP(problem), mc.SolverBoxFDDP(problem), mc.SolverSparse(problem)]
    pool += [mc.SolverAugmentedLagrangian(problem)]
    pool += [mc.make_problem(task), mc.ImpulseModelMultiple(state), mc.CostModelSum(state, 0), quad, quad.createData()]
    pool += [mc.ContactModel3D(state, 1, [0, 0, 0], mc.LOCAL, nu), mc.ImpulseModel3D(state, 1), wheel]
    pool += [m.createData() for m in (model, node, actuation, wheel)]
    pool += [mc.FrictionCone(), mc.WrenchCone(np.eye(3), 0.7, [0.1, 0.1]), mc.CoPSupport(np.eye(3), [0.1, 0.1])]
    pool += [mc.SE3(), scene.contacts[0], mc.Attachment(), scene.robots[0].model, mc.Options(), mc.BatchData(scene, 1)]
    pool += [mc.SimulationData(scene, file.q, file.v, "rk4", 1e-3), mc.Gains(1, 1), mc.optimize(task)]
    pool += [mc.Dependence(q=True), mc.DerivativeRequest(), mc.ActivationBounds([0.0], [1.0]), mc.StateVector(3)]
    pool += [mc.CostModelResidual(state, residual), mc.ConstraintModelResidual(state, residual), mc.CallbackLogger()]
    pool += [mc.DifferentialActionModelNumDiff(model), mc.ActionModelNumDiff(node), mc.ActionModelLQR(3, 2)]
    arrays = [file.q, file.v, file.u, x, np.zeros(0), np.zeros(10**6), np.full(3, np.nan), np.eye(3)]
    arrays += [np.ones(n) for n in (1, 2, 3, 6, 76)]
    return pool, arrays


class Fuzzer:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.pool, self.arrays = objects()
        self.values = {
            "int": [0, 1, 2, 3, 12, 32, 38, -1, 10**6, 2**62],
            "float": [0.0, 1.0, -1.0, 0.01, 1e300, float("nan")],
            "bool": [True, False],
            "str": ["", "a", "left", "humanoid", "left_sole", "x" * 1000],
            stubs.ARRAY: self.arrays,
        }
        self.targets = list(targets())

    def of(self, cls):
        return [x for x in self.pool if isinstance(x, cls)]

    def value(self, annotation):
        """Returns an object of that type, or sometimes None."""
        if self.random.random() < 0.08:
            return None
        if annotation in self.values:
            return self.random.choice(self.values[annotation])
        outer, _, inner = annotation.partition("[")
        if outer in ("List", "Set"):
            return [self.value(inner[:-1]) for _ in range(self.random.randrange(4))]
        if outer == "Optional":
            return self.value(inner[:-1])
        if outer == "Union":
            return self.value(self.random.choice(stubs.parts_at(inner[:-1], ",")).strip())
        cls = getattr(mc, annotation, None)
        known = []
        if isinstance(cls, type):
            known = list(cls.__members__.values()) if hasattr(cls, "__members__") else self.of(cls)
        return self.random.choice(known or [None, 1, "a", self.arrays[0]])

    def call(self, log):
        owner, name, member = self.random.choice(self.targets)
        known = self.of(owner) if owner else []
        if isinstance(member, property):
            if not known:
                return
            log(owner.__name__, name)
            x = self.random.choice(known)
            got = getattr(x, name)
            if member.fset and self.random.random() < 0.5:
                kind = stubs.ARRAY if isinstance(got, np.ndarray) else type(got).__name__
                setattr(x, name, self.value(kind))
            return
        parameters, _, _ = self.random.choice(list(stubs.signatures_of(member)))
        positional, named = [], {}
        for parameter in stubs.parts_at(parameters, ",") if parameters.strip() else []:
            name_and_type, *default = stubs.parts_at(parameter.strip(), " = ")
            parameter_name, *annotation = stubs.parts_at(name_and_type, ": ")
            if parameter_name == "self" and name != "__init__":
                if not known:
                    return
                positional.append(self.random.choice(known))
            elif parameter_name != "self" and annotation and not (default and self.random.random() < 0.5):
                named[parameter_name] = self.value(stubs.type_of(annotation[0]))
        named.update({k: 3 for k in ("steps", "substeps", "maxiter") if k in named})
        log(owner.__name__ if owner else "", name, {k: str(v)[:60] for k, v in named.items()})
        (owner if name == "__init__" else member)(*positional, **named)


def targets():
    """Returns (class or None, name, function or property) of everything public."""
    for name, x in vars(mc._manycontact).items():
        if name.startswith("_") or hasattr(x, "__members__"):
            continue
        if isinstance(x, type) and not issubclass(x, Exception):
            for member_name, member in vars(x).items():
                function = member.__func__ if isinstance(member, staticmethod) else member
                public = member_name == "__init__" or not member_name.startswith("_")
                if public and (isinstance(member, property) or "->" in (getattr(function, "__doc__", None) or "")):
                    yield x, member_name, function
        elif callable(x) and not isinstance(x, type):
            yield None, name, x


def run(seed, calls):
    fuzzer, outcomes = Fuzzer(seed), collections.Counter()
    with open(os.environ.get("FUZZ_LOG", os.devnull), "w") as file:

        def log(*what):
            file.seek(0)
            file.truncate()
            print(*what, file=file, flush=True)

        for _ in range(calls):
            try:
                fuzzer.call(log)
                outcomes["answered"] += 1
            except REFUSALS:
                outcomes["refused"] += 1
    return outcomes


if __name__ == "__main__":
    seed, calls = (int(x) for x in (sys.argv[1:] + ["0", "1000"][len(sys.argv) - 1 :])[:2])
    print(dict(run(seed, calls)))
