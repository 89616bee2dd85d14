"""The machines of models/machines: files as machines.py writes them, closed loops, rows and ranks of models/README.md."""

import importlib.util
import re

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS, ROOT

FOLDER = MODELS / "machines"
ROWS = re.findall(r"(?m)^\| `machines/(\w+)\.xml` \| (\d+) \| (\d+) \| (\d+) \|", (MODELS / "README.md").read_text())


def test_files_are_those_of_the_program():
    spec = importlib.util.spec_from_file_location("machines", FOLDER / "machines.py")
    machines = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(machines)
    written = machines.files()
    assert {x.name for x in FOLDER.iterdir() if x.suffix in (".urdf", ".xml")} == set(written)
    for name, content in written.items():
        number = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")  # other machines may round the last digit otherwise
        stored = (FOLDER / name).read_text()
        assert number.sub("0", stored) == number.sub("0", content)
        assert np.allclose([float(x) for x in number.findall(stored)], [float(x) for x in number.findall(content)], rtol=1e-5)


@pytest.mark.parametrize("name, nv, rows, rank", ROWS)
def test_at_rest(name, nv, rows, rank):
    file = mc.load_scene(str(FOLDER / f"{name}.xml"))
    data = mc.SceneData(file.scene)
    report = mc.solve(file.scene, file.q, file.v, file.u, data)
    assert (file.scene.nv, report.nc, report.rank) == (int(nv), int(rows), int(rank))
    assert not mc.placement_errors(file.scene, file.q) and abs(data.a).max() < 1e-8
    assert not mc.violations(file.scene, file.q, data) and "rest" not in {x.kind for x in file.findings}


@pytest.mark.parametrize("name, motions", [("delta", 3), ("digit_like", 16), ("kangaroo_like", 6)])
def test_degrees_of_freedom(name, motions):
    """Also away from the symmetric configuration of the file."""
    file = mc.load_scene(str(FOLDER / f"{name}.xml"))
    scene = file.scene
    assert len(ROWS) == len(list(FOLDER.glob("*.xml")))
    v = 0.05 * np.random.default_rng(1).standard_normal(scene.nv)
    state = mc.make_consistent(scene, mc.integrate(scene, file.q, v), v)
    assert state.consistent and abs(mc.difference(scene, file.q, state.q)).max() > 1e-3
    J = mc.contact_jacobian(scene, state.q)
    assert scene.nv - np.linalg.matrix_rank(J if isinstance(J, np.ndarray) else J.toarray()) == motions


def test_pictures_of_the_gallery():
    page = (ROOT / "src" / "doc" / "gallery.md").read_text()
    pictures = re.findall(r"\]\(gallery/(\w+\.png)\)", page)
    assert sorted(pictures) == sorted(x.name for x in (ROOT / "src" / "doc" / "gallery").glob("*.png"))
    assert all((ROOT / "src" / "doc" / "gallery" / x).stat().st_size < 120_000 for x in pictures)
