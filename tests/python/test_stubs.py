"""The type stubs have what the module has."""

import ast
import inspect
import pathlib

import manycontact as mc


def public(names):
    return {name for name in names if not name.startswith("_")}


def test_stubs_match_the_module():
    tree = ast.parse((pathlib.Path(mc.__file__).parent / "__init__.pyi").read_text())
    stubs = {}
    for node in tree.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            stubs[node.name] = node
        elif isinstance(node, ast.Assign):
            stubs[node.targets[0].id] = node
        elif isinstance(node, ast.AnnAssign):
            stubs[node.target.id] = node
    assert public(vars(mc._manycontact)) == public(stubs)

    for name, node in stubs.items():
        if not isinstance(node, ast.ClassDef) or not hasattr(mc, name):
            continue
        members = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
        members |= {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
        cls = getattr(mc, name)
        own = public(vars(cls)) - ({"name", "value"} if hasattr(cls, "__members__") else set())
        assert own <= members, name


def test_everything_is_documented():
    """Every function says what it takes and gives; its types are Python's."""
    for name, member in vars(mc).items():
        if name.startswith("_") or not inspect.isbuiltin(member):
            continue
        assert "->" in member.__doc__, name
        assert "::" not in member.__doc__, name


def test_help_of_solve():
    text = mc.solve.__doc__
    for part in ("(nq)", "(nv)", "(nu)", "N m", "Report", "ValueError"):
        assert part in text
