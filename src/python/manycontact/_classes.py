"""What all classes of the package have in common: lists that are copies cannot be changed, every object says what
it is, and what a class derived in Python defines is called or refused.
"""

import difflib
import functools
import re
from typing import Any

import numpy


def _refuse(self, *_, **__):
    raise TypeError(
        "this is a copy, and changing the copy would not change the original: assign the attribute, or change a list "
        "or dict made of the copy"
    )


class ReadOnlyList(list):
    """A list that is a copy: equal to any list with the same items; changing it raises."""

    __slots__ = ()
    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refuse
    append = clear = extend = insert = pop = remove = reverse = sort = _refuse

    def __reduce__(self):
        return list, (list(self),)


class ReadOnlyDict(dict):
    """A dict that is a copy: equal to any dict with the same items; changing it raises."""

    __slots__ = ()
    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __missing__(self, key):
        near = difflib.get_close_matches(str(key), map(str, self), 1)
        known = f"did you mean {near[0]!r}?" if near else f"expected one of {', '.join(map(repr, list(self)[:8]))}"
        raise KeyError(f"there is no key {key!r}, {known}")

    def __reduce__(self):
        return dict, (dict(self),)


class CopiedArray(numpy.ndarray):
    """An array that is a copy: writing into it raises, although its memory is writeable as scipy's Rotation requires.
    What is computed from it are arrays as usual."""

    __setitem__ = fill = itemset = put = partition = sort = _refuse

    def __array_wrap__(self, x, *_):
        return x.view(numpy.ndarray)[()]

    def copy(self, order="C"):
        return numpy.array(self, order=order)

    def __repr__(self):
        return repr(numpy.asarray(self))

    def __reduce__(self):
        return numpy.asarray(self).__reduce__()


def _frozen(x):
    if type(x) is list:
        return ReadOnlyList(map(_frozen, x) if x and type(x[0]) is list else x)
    if type(x) is dict:
        return ReadOnlyDict(x)
    return frozenset(x) if type(x) is set else x


def _freeze_rotations(cls):
    for name in ("R", "rotation"):
        member = vars(cls)[name]

        def getter(self, get=member.fget):
            return get(self).view(CopiedArray)

        setattr(cls, name, property(functools.wraps(member.fget)(getter), None, None, member.__doc__))


def _result(function):
    """The type that pybind11's docstring says a function returns; "" where it says none."""
    match = re.match(r"\w*\(.*\) -> (.*)", function.__doc__ or "")
    return match[1] if match else ""


def _freeze_lists(cls):
    for name, member in list(vars(cls).items()):
        if not isinstance(member, property) or not re.match(r"(List|Dict|Set)\[", _result(member.fget)):
            continue

        def getter(self, get=member.fget):
            return _frozen(get(self))

        setattr(cls, name, property(functools.wraps(member.fget)(getter), member.fset, None, member.__doc__))


# ---- assignments ---------------------------------------------------------------------------------------------------


def _expected(setter):
    """The type that a property takes, in the words of Python."""
    match = re.match(r"\w*\(.*, \w+: (.*)\) -> None", (setter.__doc__ or "").strip())
    words = re.sub(r"\bmanycontact(\.|::)", "", match[1] if match else "another type")
    return words.replace("numpy.ndarray", "an array of numbers")


def _name_assignments(cls):
    """An assignment of a wrong type names the attribute, what is expected and what was given."""
    for name, member in list(vars(cls).items()):
        if not isinstance(member, property) or member.fset is None:
            continue

        def setter(self, value, _set=member.fset, _name=name):
            try:
                _set(self, value)
            except TypeError as error:
                if not str(error).startswith("(): incompatible"):
                    raise
                given = f"{value!r:.60} ({type(value).__name__})"
                raise TypeError(f"{type(self).__name__}.{_name}: {_expected(_set)} is expected, not {given}") from None

        setattr(cls, name, property(member.fget, functools.wraps(member.fset)(setter), None, member.__doc__))


# ---- what an object is ---------------------------------------------------------------------------------------------


def _properties(cls):
    for base in reversed(cls.__mro__):
        yield from ((name, x) for name, x in vars(base).items() if isinstance(x, property))


_TOLD = ("int", "float", "bool", "str", "Optional[float]", "SE3", "numpy.ndarray")
_MOST = 7  # numbers of an array


def _describe(self):
    """<Class: name=value, ...> of numbers, words, members, placements and short arrays; or what C++ prints."""
    name = type(self).__name__
    if type(self).__str__ is not object.__str__:
        return f"<{name}: {self}>"
    told = []
    for key, member in dict(_properties(type(self))).items():
        result = _result(member.fget).replace("manycontact.", "")
        if result not in _TOLD and result not in _enumerations:
            continue
        try:
            value = member.fget(self)
        except (TypeError, ValueError, RuntimeError):  # there is none now
            continue
        if result == "numpy.ndarray":
            if value.size > _MOST or value.ndim != 1:
                continue
            value = value.tolist()
        told.append(f"{key}={value if result in _enumerations else repr(value)}")
    return f"<{name}: {', '.join(told)}>" if told else f"<{name}>"


def _describe_list(self):
    first = ", ".join(map(repr, self[:4])) + (", ..." if len(self) > 4 else "")
    return f"<{type(self).__name__} of {len(self)}: [{first}]>"


def _describe_report(self, told):
    """What C++ prints, and the reasons of islands that another method or none has solved."""
    reasons = {str(island.reason): None for island in self.islands if island.reason.value and self.remedy}
    return told(self) if not reasons else f"{told(self)[:-1]}, reason: {', '.join(reasons)}>"


_enumerations = {}


# ---- classes derived in Python -------------------------------------------------------------------------------------

_MODEL = {"calc", "calcDiff", "createData"}
_FORCES = {"updateForce", "updateForceDiff", "setZeroForce", "setZeroForceDiff"}
_NODE = _MODEL | {"checkData", "quasiStatic"}
_STEPS = {"computeDirection", "tryStep", "stoppingCriteria", "expectedImprovement", "resizeData"}
_DDP = _STEPS | {"calcDiff", "backwardPass", "forwardPass", "allocateData"}
_DDP |= {"increaseRegularization", "decreaseRegularization"}

# What C++ has for each family of classes, by the name of its base: a class derived in Python that defines one of these
# expects C++ to call it.
_EXPECTED = {
    "ActivationModelAbstract": _MODEL,
    "ResidualModelAbstract": _MODEL,
    "CostModelAbstract": _MODEL,
    "CostModelSum": _MODEL,
    "ConstraintModelResidual": _MODEL,
    "ConstraintModelManager": _MODEL,
    "ActuationModelAbstract": _MODEL | {"commands", "torqueTransform"},
    "ContactModelAbstract": _MODEL | _FORCES,
    "ContactModelMultiple": _MODEL | _FORCES | {"updateAcceleration", "updateAccelerationDiff"},
    "ImpulseModelAbstract": _MODEL | _FORCES,
    "ImpulseModelMultiple": _MODEL | _FORCES | {"updateVelocity", "updateVelocityDiff"},
    "StateAbstract": {"zero", "rand", "diff", "integrate", "Jdiff", "Jintegrate", "JintegrateTransport"},
    "DifferentialActionModelAbstract": _NODE,
    "ActionModelAbstract": _NODE,
    "ControlParametrizationModelAbstract": _MODEL
    | {"params", "convertBounds", "multiplyByJacobian", "multiplyJacobianTransposeBy"},
    "ShootingProblem": {"calc", "calcDiff", "rollout", "quasiStatic"},
    "SolverAbstract": _DDP | {"computeActionValueFunction", "computeValueFunction", "computeGains", "computePolicy"},
    "CallbackAbstract": {"__call__"},
}

# What C++ calls of it, of classes derived from this one alone, and from this one or any class of C++'s below it.
_CALLED_ALONE = {
    "ActivationModelAbstract": _MODEL,
    "ResidualModelAbstract": _MODEL,
    "DifferentialActionModelAbstract": _NODE,
    "ActionModelAbstract": _NODE,
    "CallbackAbstract": {"__call__"},
}
_CALLED = {
    "CostModelAbstract": _MODEL,
    "ActuationModelAbstract": _MODEL | {"commands", "torqueTransform"},
    "SolverDDP": _DDP,
}


def _called(base):
    """What C++ calls of a class derived from `base`, one of C++'s."""
    out = set(_CALLED_ALONE.get(base.__name__, ()))
    for b in base.__mro__:
        out |= _CALLED.get(b.__name__, set())
    return out


def _refuse_methods_of(family, expected):
    """A class derived from one of C++'s cannot define what C++ would not call."""

    def check(cls, **_):
        base = next(b for b in cls.__mro__ if b.__module__ == family.__module__)
        own = {n for b in cls.__mro__ if b.__module__ != family.__module__ for n in expected & set(vars(b))}
        own = sorted(own - _called(base))
        if not own:
            return
        others = [name for name in (family.__name__, *_CALLED) if own[0] in _CALLED_ALONE.get(name, _CALLED.get(name, ()))]
        known = [name for name in others if issubclass(getattr(_module, name), family)]
        raise TypeError(
            f"{cls.__name__} defines {', '.join(own)}, which C++ would not call for classes derived from "
            f"{base.__name__}: "
            + (f"derive from {known[0]}" if known else "remove the method")
        )

    family.__init_subclass__ = classmethod(check)


_module: Any = None


def complete(module):
    """All of it, for every class of the extension module."""
    classes = {x for x in vars(module).values() if isinstance(x, type) and not issubclass(x, Exception)}
    _enumerations.update({c.__name__: c for c in classes if hasattr(c, "__members__")})
    for cls in classes - set(_enumerations.values()):
        _freeze_lists(cls)
        if cls.__repr__ is object.__repr__:
            cls.__repr__ = _describe_list if cls.__name__.endswith("List") else _describe
        _name_assignments(cls)
    _freeze_rotations(module.SE3)
    module.Report.__repr__ = functools.partialmethod(_describe_report, module.Report.__repr__)
    global _module
    _module = module
    for name, expected in _EXPECTED.items():
        _refuse_methods_of(getattr(module, name), expected)
