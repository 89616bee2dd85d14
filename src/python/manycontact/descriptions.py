"""Robots of the package robot_descriptions, by name."""

import difflib
import importlib
import importlib.util
import os
import pkgutil
from typing import Any, List

from . import InputError, Model, load_urdf

_ENDING = "_description"


def _names(package: Any) -> List[str]:
    """Names of the package's robots that have a URDF: those that end with _mj_description are files of MuJoCo."""
    modules = [module.name for module in pkgutil.iter_modules(package.__path__)]
    return [x[: -len(_ENDING)] for x in modules if x.endswith(_ENDING) and not x.endswith("_mj" + _ENDING)]


def _find_meshes(description: Any) -> None:
    """Adds the folders of a description to ROS_PACKAGE_PATH, where view searches package:// meshes."""
    folders = [x for x in os.environ.get("ROS_PACKAGE_PATH", "").split(":") if x]
    for name in ("PACKAGE_PATH", "REPOSITORY_PATH"):
        if hasattr(description, name):
            folder = str(getattr(description, name))
            folders += [os.path.dirname(folder), folder]
    os.environ["ROS_PACKAGE_PATH"] = ":".join(dict.fromkeys(folders))


def description_path(name: str) -> str:
    """Return the path of the URDF of a robot of the package robot_descriptions, which downloads it at the first use.

    name: the robot, for instance "go2", "g1" or "talos"; also with "_description". The folders of its meshes are added
    to ROS_PACKAGE_PATH of this process, so that view finds them. Raises ModuleNotFoundError if robot_descriptions is
    not installed, InputError if it has no such robot or no URDF of it, RuntimeError if the download fails.
    """
    if importlib.util.find_spec("robot_descriptions") is None:
        raise ModuleNotFoundError(
            "load_description: the package robot_descriptions is missing: pip install robot_descriptions",
            name="robot_descriptions",
        )
    known = _names(importlib.import_module("robot_descriptions"))
    short = name[: -len(_ENDING)] if name.endswith(_ENDING) else name
    if short not in known:
        near = difflib.get_close_matches(short.lower(), known, n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else f"it has {len(known)} robots, for instance {', '.join(known[:5])}"
        raise InputError(f"load_description: robot_descriptions has no URDF of '{name}': {hint}")
    try:
        description = importlib.import_module(f"robot_descriptions.{short}{_ENDING}")
    except Exception as error:  # git and the network have errors of their own
        raise RuntimeError(
            f"load_description: '{short}' could not be loaded by robot_descriptions, which downloads a robot at the first "
            f"use: {type(error).__name__}: {error}"
        ) from error
    if not hasattr(description, "URDF_PATH"):
        other = "only a file of another format"
        if hasattr(description, "XACRO_PATH"):
            other = f"only a xacro file, {description.XACRO_PATH}: expand the file with xacro"
        raise InputError(f"load_description: robot_descriptions has no URDF of '{short}', {other}")
    _find_meshes(description)
    return str(description.URDF_PATH)


def load_description(name: str, **options: Any) -> Model:
    """Load a robot of the package robot_descriptions by its name.

    name: the robot, for instance "go2", "g1" or "talos". options: those of load_urdf, by their names; robots with legs
    need floating_base=True. Errors are those of description_path and load_urdf.
    """
    return load_urdf(description_path(name), **options)
