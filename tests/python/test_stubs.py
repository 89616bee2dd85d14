"""The type stubs have the module's names, and usual programs pass mypy with them."""

import ast
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys

import manycontact as mc
import pytest
from conftest import ROOT

PACKAGE = pathlib.Path(mc.__file__).parent


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
        own = public(cls.__members__) if hasattr(cls, "__members__") else public(vars(cls))
        special = {"__init__", "__call__", "__len__", "__getitem__", "__iter__", "__contains__", "__mul__", "__eq__"}
        if not hasattr(cls, "__members__"):
            own |= {n for n in special & set(vars(cls)) if "->" in (vars(cls)[n].__doc__ or "")}
        assert own <= members, name


def test_everything_is_documented():
    """Every function declares its arguments and results; its types are Python's."""
    for name, member in vars(mc).items():
        if name.startswith("_") or not inspect.isbuiltin(member):
            continue
        assert "->" in member.__doc__, name
        assert "::" not in member.__doc__, name


def parameters(doc):
    """Returns names in the signature of a function with one overload."""
    signature = doc.partition(") -> ")[0].partition("(")[2]
    return re.findall(r"(?:^|, )(\w+): ", re.sub(r"\[[^\]]*\]", "", signature))


def test_functions_are_documented_in_numpydoc_layout():
    seen = 0
    for name, member in vars(mc).items():
        if name.startswith("_") or not inspect.isbuiltin(member):
            continue
        doc = member.__doc__
        if parameters(doc) and "Overloaded" not in doc:
            seen += 1
            section = doc.partition("Parameters\n")[2].partition("\nReturns\n")[0].partition("\nRaises\n")[0]
            assert re.findall(r"(?m)^ *(\w+)(?: : .*)$", section) == parameters(doc), name
        assert ("Returns\n" in doc) == ("-> None" not in doc), name
        summary = doc.partition("\n\n")[2].partition("\n")[0] if "Overloaded" not in doc else "."
        assert summary.endswith((".", ":")) or "without contacts" in summary, f"{name}: {summary}"
    assert seen > 90


def test_every_property_has_a_text():
    seen = 0
    for name, cls in vars(mc).items():
        if name.startswith("_") or not inspect.isclass(cls) or not cls.__module__.startswith("manycontact"):
            continue
        for key, member in vars(cls).items():
            if isinstance(member, property) and not key.startswith("_"):
                seen += 1
                assert (member.__doc__ or "").strip(), f"{name}.{key}"
    assert seen > 400


def test_help_of_solve():
    text = mc.solve.__doc__
    for part in ("(nq)", "(nv)", "(nu)", "N m", "Report", "ValueError"):
        assert part in text


# ---- mypy ----------------------------------------------------------------------------------------------------------


def mypy(module, *arguments):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    environment = dict(os.environ, MYPYPATH=str(PACKAGE.parent), PYTHONPATH=str(PACKAGE.parent))
    run = [sys.executable, "-m", module, *arguments]
    return subprocess.run(run, capture_output=True, text=True, env=environment)


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    """Returns check(text): mypy's messages on a program, with one cache for all."""
    folder = tmp_path_factory.mktemp("mypy")
    (folder / "mypy.ini").write_text("[mypy]\n[mypy-scipy.*,matplotlib.*]\nignore_missing_imports = True\n")

    def run(text):
        (folder / "program.py").write_text(text)
        options = ["--strict", "--allow-untyped-calls", "--no-error-summary", f"--cache-dir={folder / 'cache'}"]
        return mypy("mypy", *options, f"--config-file={folder / 'mypy.ini'}", str(folder / "program.py"))

    return run


def test_stubs_are_the_modules():
    """stubtest: no name of the module is missing in the stubs, and vice versa. (For pybind11's classes it knows
    neither metaclass nor signatures.)"""
    lines = mypy("mypy.stubtest", "manycontact", "--concise").stdout.splitlines()
    assert any(line.startswith("manycontact.SceneData ") for line in lines), lines  # stubtest has run
    missing = [line for line in lines if "is not present" in line or "is missing" in line or "does not exist" in line]
    alias = re.compile(r"manycontact\.(_.*|\w+\.(__\w+__|_pybind11\w+)) ")
    assert not [line for line in missing if not alias.match(line)]


def programs():
    pages = ["README.md", *(f"src/doc/howto/{name}.md" for name in ("python", "derivatives", "simulate", "inverse_kinematics"))]
    for page in pages:
        yield page, re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.S)[0]
    yield "standing.py", (ROOT / "src/python/examples/standing.py").read_text()


GOOD = """
import manycontact as mc
import numpy as np

file = mc.load_scene("scene.xml")
scene = file.scene
scene.gravity = [0, 0, -1.62]
scene.contacts["left"].alpha, scene.contacts[0].mu, scene.contacts[1].type = 100, None, "3d"
scene.contacts[0].B.placement = mc.SE3(p=[0, 0, 1])
names = [c.name.upper() for c in scene.contacts] + [r.model.joints["knee"].name for r in scene.robots]
A = mc.attach(scene, "r", "f")
contact = mc.Contact(name="left", type="3d", reference_frame="world", A=A, axis=[0, 0, 1], mu=0.5)
data = mc.SceneData(scene, mc.Options("sparse-ldl", order="camd", threads=2))
data.options.method, data.active = mc.Method.DENSE, [True, False]
status: mc.Status = mc.solve(scene, list(file.q), file.v, np.zeros(scene.nu), data).islands[0].status
total: float = float(data.a.sum() + data.f @ data.f)
sim = mc.SimulationData(scene, file.q, file.v, "rk4", 1e-3)
sim.q, sim.v = file.q, np.zeros(3)
task = mc.load_task("task.xml")
problem = mc.make_problem(task)
solver = mc.SolverFDDP(problem.problem)
solver.solve(solver.xs, solver.us, 10)
problem.xs = solver.xs
one = mc.RigidBodies(scene, "r")
bodies = mc.RigidBodyData(one)
tau = mc.rnea(one, file.q, file.v, [0.0] * one.nv, bodies, fext=None)
J = mc.frame_jacobian(one, bodies, "f", "world") @ tau + mc.frame_bias_acceleration(one, bodies, A, mc.ReferenceFrame.WORLD)
goals = [mc.pose_goal(scene, "r/f", position=(None, None, 0.0)), mc.joint_goal(scene, "r/knee", 0.4)]
left: float = mc.place(scene, file.q, goals).left[0].position
cost: float = mc.optimize(task, problem, each=lambda i: i.cost < 3).cost

class Mine(mc.CallbackAbstract):
    def __call__(self, solver: mc.SolverAbstract) -> None:
        print(solver.iter)

solver.setCallbacks([Mine(), mc.CallbackVerbose("_2")])
"""


@pytest.mark.parametrize("name, text", [*programs(), ("typical", GOOD)], ids=lambda x: x if len(x) < 40 else "")
def test_programs_pass_mypy(check, name, text):
    run = check(text)
    assert run.returncode == 0, run.stdout + run.stderr


MISTAKES = {
    "scene.contacts[0].alfa = 3": "has no attribute",
    "scene.gravty = [0, 0, 1]": "has no attribute",
    "scene.contacts[0].type = 3": "Incompatible types",
    "scene.contacts[0].B.placement.p = [1, 2, 3]": "read-only",
    "solver.xs[0] = 3": "Unsupported target",
    "scene.contact_index['left'] = 3": "Unsupported target",
    "problem.blocks.append([1])": "has no attribute",
    "sim.h = 3": "read-only",
    "mc.solve(scene, file.q, data)": "Missing positional argument",
    "mc.optimise(task)": "has no attribute",
    "mc.Method.kSparseLdl": "has no attribute",
    "data.options = 'dense'": "Incompatible types",
}


def test_mistakes_do_not_pass_mypy(check):
    told = check(GOOD + "\n".join(MISTAKES) + "\n").stdout.splitlines()
    for k, (line, says) in enumerate(MISTAKES.items(), GOOD.count("\n") + 1):
        assert any(f"program.py:{k}: error: " in x and says in x for x in told), (line, told)
