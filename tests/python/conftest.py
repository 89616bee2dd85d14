"""Places of the package, the models and the program, from ctest's environment or this build's defaults."""

import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, os.environ.get("MANYCONTACT_PYTHON_DIR", str(ROOT / "build/release/python")))

import manycontact as mc  # noqa: E402

MODELS = ROOT / "models"
GOLDEN = ROOT.parent / "shared" / "golden"


@pytest.fixture
def humanoid():
    """Returns one humanoid on both soles, and data."""
    file = mc.load_scene(str(MODELS / "humanoid_standing.xml"))
    return file, mc.SceneData(file.scene)


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("MANYCONTACT_BINARY", str(ROOT / "build/release/bin/manycontact"))
    if not os.path.exists(path):
        pytest.skip("the program is not built")
    return path
