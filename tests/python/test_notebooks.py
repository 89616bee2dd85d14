"""The notebooks of src/python/examples: their cells run in order, without jupyter, and are stored without output."""

import json

import manycontact  # noqa: F401
import pytest
from conftest import ROOT

FOLDER = ROOT / "src" / "python" / "examples"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[x.stem for x in NOTEBOOKS])
def test_cells_run(path, monkeypatch):
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(FOLDER)
    variables = {"__name__": "__main__"}
    for k, cell in enumerate(json.loads(path.read_text())["cells"]):
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"{path.name}, cell {k + 1}", "exec"), variables)
    assert plt.get_fignums()
    plt.close("all")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[x.stem for x in NOTEBOOKS])
def test_form(path):
    book = json.loads(path.read_text())
    assert (book["nbformat"], book["nbformat_minor"], book["metadata"]["kernelspec"]["name"]) == (4, 5, "python3")
    assert len({cell["id"] for cell in book["cells"]}) == len(book["cells"])
    assert book["cells"][0]["cell_type"] == "markdown" and book["cells"][0]["source"][0].startswith("# ")
    assert all(cell["outputs"] == [] for cell in book["cells"] if cell["cell_type"] == "code")


def test_they_are_listed():
    page = (ROOT / "src" / "doc" / "python.md").read_text()
    assert len(NOTEBOOKS) == 3 and all(f"](../python/examples/{path.name})" in page for path in NOTEBOOKS)
