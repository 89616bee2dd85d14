"""Every nested attribute of every class: what is assigned through it is there when it is read again, or it raises."""

import assign
import fuzz
import manycontact as mc
import numpy as np
import test_values
from assign import settable

CLASSES = [x for x in vars(mc._manycontact).values() if isinstance(x, type) and not issubclass(x, Exception)]
CLASSES = [cls for cls in CLASSES if not hasattr(cls, "__members__")]


def attributes(x):
    """The names of an object's attributes that can be read now."""
    for cls in type(x).__mro__:
        for name, member in vars(cls).items():
            if isinstance(member, property) and not name.startswith("_"):
                yield name


def read(root, path):
    for step in path:
        root = getattr(root, step) if isinstance(step, str) else root[step[0]]
    return root


def parts(x):
    """The steps from x to what is in it: names of attributes, [index] of elements."""
    if type(x) in CLASSES or isinstance(x, tuple(CLASSES)):
        yield from attributes(x)
        if hasattr(type(x), "__getitem__") and len(x) > 0:
            yield [0]
    elif isinstance(x, dict):
        yield from ([key] for key in list(x)[:1])
    elif isinstance(x, (list, tuple)) and len(x) > 0:
        yield [0]


def another(x):
    """Another value of the same type; None where there is none to try."""
    if isinstance(x, bool):
        return not x
    if hasattr(type(x), "__members__"):
        return next(member for member in type(x).__members__.values() if member != x)
    if isinstance(x, (int, float)):
        return x + 1 if np.isfinite(x) else 1.0
    if isinstance(x, str):
        return x + "_"
    if isinstance(x, mc.SE3):
        return mc.SE3(p=[0.1, 0.2, 0.3]) * x
    if isinstance(x, np.ndarray) and x.shape == (3,) and abs(np.linalg.norm(x) - 1) < 1e-12:
        return np.roll(x, 1)  # directions are normalised
    if isinstance(x, np.ndarray) and x.size > 0:
        other = np.array(x)
        step = {"b": True, "i": 1, "u": 1}.get(other.dtype.kind, 0.25)
        other.flat[0] = not other.flat[0] if other.dtype == bool else np.nan_to_num(other.flat[0]) + step
        return other
    return None


def same(a, b):
    return np.array_equal(a, b, equal_nan=a.dtype.kind == "f") if isinstance(a, np.ndarray) else a == b


def writes(x):
    """(what, write) of an object: its attributes, its elements. write(x) returns a test of the object read again."""
    for name in settable(type(x)) if type(x) in CLASSES else ():

        def assign_attribute(x, name=name):
            value = another(getattr(x, name))
            if value is None:
                raise TypeError("nothing to try")
            setattr(x, name, value)
            return lambda now: same(getattr(now, name), value)

        yield name, assign_attribute
    if isinstance(x, np.ndarray) and x.size > 0:

        def assign_element(x):
            value = another(x)
            x[...] = value
            return lambda now: same(now, value)

        yield "[...]", assign_element
    if isinstance(x, (list, dict)):

        def change_list(x):
            size = len(x)
            x.update(added=1) if isinstance(x, dict) else x.append(1)
            return lambda now: len(now) == size + 1

        yield "add", change_list
    if hasattr(x, "indptr"):  # scipy.sparse

        def change_entry(x):
            x.data[...] = x.data + 0.25
            value = x.data.copy()
            return lambda now: same(now.data, value)

        yield "data", change_entry


def silent(roots):
    """The nested attributes through which an assignment neither takes effect nor raises, and the classes met."""
    found, seen, met = [], set(), set()
    queue = [(root, []) for root in roots]
    while queue:
        root, path = queue.pop(0)
        try:
            owner = read(root, path)
        except fuzz.REFUSALS:
            continue
        met.add(type(owner))
        for step in parts(owner):
            try:
                value = read(owner, [step])
            except (*fuzz.REFUSALS, TypeError):
                continue
            key = (type(root), *map(str, path), str(step)) if isinstance(owner, (list, dict, tuple)) else (type(owner), str(step))
            if key + (type(value),) in seen:
                continue
            seen.add(key + (type(value),))
            for what, write in writes(value):
                try:
                    took = write(read(root, [*path, step]))
                    if not took(read(root, [*path, step])):
                        found.append(f"{type(root).__name__} {[*path, step]} {what}")
                except (*fuzz.REFUSALS, AttributeError):
                    pass
            if len(path) < 8:
                queue.append((root, [*path, step]))
    return found, met


def objects():
    scene = mc.load_scene(str(fuzz.ROOT / "models/humanoid_pushed.xml")).scene
    mc.add_spring(scene, mc.Spring(name="s", A=mc.attach(scene, scene.robots[0].name, scene.robots[0].model.frames[0].name),
                                   stiffness=1.0))
    return [scene] + fuzz.objects()[0] + assign.more_objects() + test_values.values()


def test_assignments_through_attributes_take_effect_or_raise():
    found, met = silent(objects())
    assert not found, found
    missing = {cls.__name__ for cls in CLASSES if settable(cls) and not any(issubclass(m, cls) for m in met)}
    assert not missing, missing


def test_the_walk_finds_copies():
    """A class whose attribute is a copy of another object."""

    class Copies(list):
        def __init__(self):
            self.options = mc.Options()

        def __getitem__(self, k):
            return mc.Options() if k == 0 else list.__getitem__(self, k)

        def __len__(self):
            return 1

    assert any("[[0]]" in text for text in silent([Copies()])[0])


def test_parts_of_laws_springs_pushes_and_thrusters():
    scene = objects()[0]
    scene.springs[0].A.placement = mc.SE3(p=[1, 2, 3])
    scene.wrenches[0].at.placement = mc.SE3(p=[4, 5, 6])
    assert scene.springs[0].A.placement.p[0] == 1 and scene.wrenches[0].at.placement.p[2] == 6
    file = mc.load_scene(str(fuzz.ROOT / "models/humanoid_standing.xml"))
    sim = mc.SimulationData(file.scene, file.q, file.v, "rk4", 1e-3)
    sim.pd = mc.PdLaws(*[np.zeros(file.scene.nv)] * 4)
    sim.pd.kp = np.full(file.scene.nv, 3.0)
    assert (sim.pd.kp == 3).all()
    state = mc.StateMultibody(file.scene)
    actuation = mc.ActuationModelFloatingBaseThrusters(state, [mc.Thruster(mc.SE3(), 0.02, "ccw")] * 2)
    before = actuation.Wthrust
    actuation.thrusters[1].ctorque = 0.5
    actuation.thrusters[1].type = "cw"
    assert actuation.thrusters[1].ctorque == 0.5 and actuation.thrusters[1].type == mc.ThrusterType.CW
    assert actuation.thrusters[0].ctorque == 0.02 and not np.array_equal(before, actuation.Wthrust)
