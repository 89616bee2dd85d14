"""Scenes and motions in a notebook: the page that `manycontact view` writes, shown in a cell."""

import csv
import html
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Any, Optional

import numpy

from . import InputError, SceneFile, configuration_names, velocity_names


def _program() -> str:
    beside = pathlib.Path(__file__).resolve().parents[2] / "bin" / "manycontact"
    found = os.environ.get("MANYCONTACT_BINARY") or shutil.which("manycontact") or (str(beside) if beside.exists() else "")
    if not found:
        raise RuntimeError(
            "view: the program manycontact, which writes the pages, was not found: put the program on the PATH"
        )
    return found


class View:
    """A page that needs no network: shown by a notebook, or saved and opened in a browser."""

    def __init__(self, page: str, height: int):
        self.html = page
        self.height = height

    def save(self, path: str) -> None:
        """Writes the page."""
        pathlib.Path(path).write_text(self.html, encoding="utf-8")

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self.height}" '
            'style="border: 0" allowfullscreen></iframe>'
        )


def view(scene: SceneFile, trajectory: Optional[Any] = None, rate: float = 50, height: int = 480) -> View:
    """The scene of a file in three dimensions; with a trajectory, through time.

    scene: of load_scene; robots, contacts and their meshes are those of its file. trajectory: what simulate returns, or
    anything with t (n) [s], q (n, nq) and v (n, nv); default: the state and the torques of the file, with the forces
    there. rate: frames per second at most. Needs the program manycontact. Raises ValueError with what it says.
    """
    if not isinstance(scene, SceneFile):
        raise TypeError(
            f"view: a SceneFile of load_scene is expected, not {type(scene).__name__}: pages show the meshes of files, "
            "which a scene that is built in code does not know"
        )
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.html"
        command = [_program(), "view", scene.path, "--out", str(page), "--rate", str(rate)]
        if trajectory is not None:
            t, q, v = (numpy.asarray(getattr(trajectory, name), float) for name in "tqv")
            if t.ndim != 1 or q.shape != (len(t), scene.scene.nq) or v.shape != (len(t), scene.scene.nv):
                raise ValueError(
                    f"view: t, q, v have the shapes {t.shape}, {q.shape}, {v.shape}, expected (n,), "
                    f"(n, {scene.scene.nq}), (n, {scene.scene.nv})"
                )
            table = pathlib.Path(folder) / "motion.csv"
            with table.open("w", newline="") as out:
                rows = csv.writer(out)
                names = ["q:" + name for name in configuration_names(scene.scene)]
                names += ["v:" + name for name in velocity_names(scene.scene)]
                rows.writerow(["t", *names])
                rows.writerows(numpy.column_stack([t, q, v]).tolist())
            command += ["--trajectory", str(table)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise (InputError if done.returncode == 2 else RuntimeError)("view: " + done.stderr.strip())
        return View(page.read_text(encoding="utf-8"), height)
