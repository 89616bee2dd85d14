"""The functions of src/doc/python.md are all those that exist, with the arguments that it names in their order."""

import inspect
import re

import manycontact as mc
from conftest import ROOT

PAGE = (ROOT / "src" / "doc" / "python.md").read_text()


def listed(page):
    """Returns the (name, arguments) of the rows of the page's tables."""
    rows = re.findall(r"(?m)^\| `(\w+)\(([^)]*)\)`", page)
    return [(name, re.findall(r"\w+", arguments)) for name, arguments in rows]


def functions():
    """Returns the names of all functions of the package."""
    return {name for name, x in vars(mc).items() if name[0] != "_" and (inspect.isbuiltin(x) or inspect.isfunction(x))}


def signatures(name):
    """Returns the names of the arguments of each overload."""
    if inspect.isfunction(getattr(mc, name, None)):
        return [list(inspect.signature(getattr(mc, name)).parameters)]
    found = re.findall(r"(?m)^(?:\d+\. )?\w+\((.*)\) -> ", getattr(mc, name).__doc__)
    return [re.findall(r"(?:^|, )(\w+): ", re.sub(r"\[[^\]]*\]", "", text)) for text in found]


def misfits(page):
    """Returns rows whose arguments are not, in this order, those of a function."""
    return [
        name for name, named in listed(page) if not any([a for a in all_ if a in named] == named for all_ in signatures(name))
    ]


def test_every_function_has_a_row():
    assert functions() - {name for name, _ in listed(PAGE)} == set()
    assert len(functions()) > 110


def test_every_row_is_a_function_with_these_arguments():
    assert misfits(PAGE) == []


def test_faults_are_found():
    assert misfits(PAGE.replace("`solve(scene, q, v, u, data)`", "`solve(scene, v, q, u, data)`")) == ["solve"]
    assert misfits(PAGE.replace("`crba(bodies, q, [data])`", "`crba(bodies, q, [inertia])`")) == ["crba"]
    assert functions() - {name for name, _ in listed(PAGE.replace("`unique_forces(", "`unique("))} == {"unique_forces"}


def declarations():
    """Returns, by name, the names of the parameters of each function that the installed headers declare."""
    found = {}
    for header in sorted((ROOT / "include").rglob("*.hpp")):
        text = re.sub(r"//.*", "", header.read_text())
        for name, parameters in re.findall(r"(?m)^[\w\[][\w:<>&*,\[\] ]*[ &*>](\w+)\(((?:[^()]|\(\))*)\)(?: const)?;", text):
            plain = re.sub(r"=[^,]*", "", re.sub(r"<[^<>]*>", "", re.sub(r"<[^<>]*>", "", parameters)))
            found.setdefault(name, []).append([p.split()[-1].strip("&*") for p in plain.split(",") if p.split()])
    return found


def out_of_order(python, cpp):
    """Returns functions whose arguments have another order in Python than in every declaration of C++."""

    def agrees(ours, declared):
        shared = max(len(set(ours) & set(theirs)) for theirs in declared)
        nearest = [theirs for theirs in declared if len(set(ours) & set(theirs)) == shared]
        return any([a for a in ours if a in theirs] == [a for a in theirs if a in ours] for theirs in nearest)

    return [name for name, lists in python.items() if name in cpp and not all(agrees(ours, cpp[name]) for ours in lists)]


def required(name):
    """Returns the names of the arguments of each overload that have no default value: the others come last in Python."""
    if inspect.isfunction(getattr(mc, name, None)):
        return [[k for k, p in inspect.signature(getattr(mc, name)).parameters.items() if p.default is p.empty]]
    found = re.findall(r"(?m)^(?:\d+\. )?\w+\((.*)\) -> ", getattr(mc, name).__doc__)
    return [re.findall(r"(?:^|, )(\w+): [^,=]*(?=,|$)", re.sub(r"\[[^\]]*\]", "", text)) for text in found]


def test_arguments_have_the_order_of_cpp():
    python, cpp = {name: required(name) for name in functions()}, declarations()
    assert python["forward_kinematics"] == [["bodies", "q", "data"]]
    assert out_of_order(python, cpp) == []
    assert len(python.keys() & cpp.keys()) > 80
    assert out_of_order({"solve": [["scene", "v", "q", "u", "data"]]}, cpp) == ["solve"]
