"""mc.view: the page of `manycontact view` in a notebook's cell."""

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS


@pytest.fixture
def box(program, monkeypatch):
    monkeypatch.setenv("MANYCONTACT_BINARY", program)
    file = mc.load_scene(str(MODELS / "arm_pushes_box.xml"))
    try:
        mc.view(file)
    except RuntimeError as error:
        pytest.skip(str(error))  # built without three.js
    return file


def test_a_scene_and_a_motion(box, tmp_path):
    still = mc.view(box)
    simulation = mc.SimulationData(box.scene, box.q, box.v, "semi-implicit-euler", 1e-3)
    motion = mc.simulate(box.scene, box.u, simulation, 100, every=10)
    moving = mc.view(box, motion, rate=100, height=300)
    assert len(moving.html) > len(still.html)
    cell = moving._repr_html_()
    assert cell.startswith("<iframe srcdoc=") and 'height="300"' in cell and cell.count("<") == 2
    moving.save(tmp_path / "motion.html")
    assert (tmp_path / "motion.html").read_text(encoding="utf-8") == moving.html


def test_what_does_not_fit(box):
    class Motion:
        t, q, v = np.zeros(2), np.zeros((2, 3)), np.zeros((2, 3))

    with pytest.raises(ValueError, match=r"view: t, q, v have the shapes \(2,\), \(2, 3\)"):
        mc.view(box, Motion)
    with pytest.raises(mc.InputError, match="cannot be opened|does not exist"):
        mc.view(mc.load_scene_text("<scene/>", "none.xml"))
