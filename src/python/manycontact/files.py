"""Files that Python reads and writes: robots from text, configurations of an SRDF, scenes that were built in code."""

import os
import pathlib
import tempfile
import xml.etree.ElementTree as xml
from typing import Any, Dict, List, Mapping, NamedTuple

import numpy

from . import (
    SE3, InputError, JointType, Model, Options, Scene, SceneData, SceneFile, aba, crba, load_scene_text, load_urdf,
    neutral, random_configuration, random_velocity, solve, torque_names,
)  # fmt: skip


def load_urdf_text(text: str, **options: Any) -> Model:
    """Load a robot from the text of a URDF.

    text: the XML. options: those of load_urdf, by their names. Raises InputError as load_urdf does.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "robot.urdf"
        path.write_text(text, encoding="utf-8")
        return load_urdf(str(path), **options)


def srdf_configurations(path: str) -> Dict[str, Dict[str, List[float]]]:
    """Read the named configurations (group_state) of an SRDF file: {name: {joint: [numbers]}}.

    States of one name in several groups are joined. To use one, assign its numbers:
    q[k : k + len(numbers)] = numbers, with k = q_index(scene, robot, joint). A floating base has x y z and its
    quaternion x y z w, as here. Raises InputError if the file cannot be read.
    """
    try:
        root = xml.parse(path).getroot()
        found: Dict[str, Dict[str, List[float]]] = {}
        for state in root.iter("group_state"):
            values = found.setdefault(state.attrib["name"], {})
            for joint in state.iter("joint"):
                values[joint.attrib["name"]] = [float(x) for x in joint.attrib["value"].split()]
    except (OSError, xml.ParseError, KeyError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as an SRDF: {error}")
    return found


class JointLimits(NamedTuple):
    """Limits of all velocity coordinates (nv); infinite where there is none."""

    lower: numpy.ndarray
    upper: numpy.ndarray
    velocity: numpy.ndarray
    effort: numpy.ndarray


def joint_limits(bodies: Any) -> JointLimits:
    """Return the limits of the joints' files as vectors (nv): positions, velocities, torques.

    bodies: a Scene, whose robots follow each other, or a Model. Floating bases have none. Limits of torques are those
    of all coordinates: the rows of u are v_index of its joints.
    """
    models = [robot.model for robot in bodies.robots] if isinstance(bodies, Scene) else [bodies]
    joints = [joint for model in models for joint in model.joints]
    names = ("lower", "upper", "velocity_limit", "effort_limit")
    return JointLimits(*(numpy.concatenate([getattr(joint, name) for joint in joints] or [[]]) for name in names))


def _numbers(values: Any) -> str:
    return " ".join(repr(float(x)) for x in numpy.ravel(values))


def _text(member: Any) -> str:
    """The name of an enumeration's member as files have it."""
    return str(member).rpartition(".")[2].lower().replace("contact_", "").replace("-", "_")


def _place(element: xml.Element, at: SE3, position: str, quaternion: str) -> None:
    element.set(position, _numbers(at.p))
    element.set(quaternion, _numbers(at.quaternion))


def _frame(scene: Scene, attachment: Any) -> Any:
    """A link of an attachment's body, as files name it, and the placement of the attachment on it."""
    robot = scene.robots[attachment.robot]
    frames = [frame for frame in robot.model.frames if frame.joint == attachment.joint]
    named = [frame for frame in frames if frame.name == attachment.frame] or frames
    return f"{robot.name}/{named[0].name}", named[0].placement.inverse() * attachment.placement


def _scene_element(scene: Scene, urdfs: Mapping[str, str], q: Any, v: Any, u: Any, folder: pathlib.Path) -> xml.Element:
    top = xml.Element("scene", name=scene.name or "scene", gravity=_numbers(scene.gravity))
    top.set("damping", _numbers(scene.damping))
    top.set("tolerance", _numbers(scene.tolerance))
    top.set("moment_length", _numbers(scene.moment_length))
    actuated = set(torque_names(scene))
    for robot in scene.robots:
        model = robot.model
        floating = bool(model.joints) and model.joints[0].type == JointType.FLOATING and model.joints[0].name == "root"
        element = xml.SubElement(top, "robot", name=robot.name, base="floating" if floating else "fixed")
        if robot.name not in urdfs:
            raise ValueError(f"write_scene: urdfs has no path for robot '{robot.name}'")
        element.set("urdf", os.path.relpath(urdfs[robot.name], folder))
        if not floating:
            R = numpy.array(robot.base.R)
            pitch = numpy.arctan2(-R[2, 0], numpy.hypot(R[2, 1], R[2, 2]))
            element.set("xyz", _numbers(robot.base.p))
            element.set("rpy", _numbers([numpy.arctan2(R[2, 1], R[2, 2]), pitch, numpy.arctan2(R[1, 0], R[0, 0])]))
        for joint in model.joints:
            if floating and joint.idx_v == 0:
                continue
            inertia = model.armature[joint.idx_v : joint.idx_v + joint.nv]
            passive = not actuated & {f"{robot.name}/{joint.name}", f"{robot.name}/{joint.name}[0]"}
            if passive or numpy.any(inertia):
                child = xml.SubElement(element, "joint", name=joint.name, armature=_numbers(inertia))
                child.set("actuated", "false" if passive else "true")
        for tag, values, first, size in (
            ("q", q, robot.idx_q, model.nq), ("v", v, robot.idx_v, model.nv), ("u", u, robot.idx_u, model.nu),
        ):  # fmt: skip
            if size:
                xml.SubElement(element, tag).text = _numbers(values[first : first + size])
    for contact in scene.contacts:
        frame, offset = _frame(scene, contact.A)
        element = xml.SubElement(top, "contact", name=contact.name, type=_text(contact.type), frame=frame)
        _place(element, offset, "offset", "offset_quat_xyzw")
        if contact.B.robot < 0:
            _place(element, contact.B.placement, "xyz", "quat_xyzw")
        else:
            to, placement = _frame(scene, contact.B)
            element.set("to", to)
            _place(element, placement, "to_offset", "to_offset_quat_xyzw")
        element.set("reference_frame", _text(contact.reference_frame))
        element.set("gains", _numbers([contact.alpha, contact.beta]))
        element.set("active", str(bool(contact.active)).lower())
        if _text(contact.type) in ("1d", "5d"):
            element.set("axis", _numbers(contact.axis))
        if contact.mu is not None:
            element.set("mu", _numbers(contact.mu))
            if contact.normal is not None:
                element.set("normal", _numbers(contact.normal))
            if numpy.any(contact.box):
                element.set("box", _numbers(contact.box))
    for push in scene.wrenches:
        frame, offset = _frame(scene, push.at)
        element = xml.SubElement(top, "push", name=push.name, frame=frame, offset=_numbers(offset.p))
        element.set("reference_frame", _text(push.reference_frame))
        element.set("force", _numbers(push.wrench[:3]))
        element.set("torque", _numbers(push.wrench[3:]))
    for spring in scene.springs:
        frame, offset = _frame(scene, spring.A)
        element = xml.SubElement(top, "spring", name=spring.name, frame=frame, offset=_numbers(offset.p))
        if spring.B.robot < 0:
            element.set("xyz", _numbers(spring.B.placement.p))
        else:
            to, placement = _frame(scene, spring.B)
            element.set("to", to)
            element.set("to_offset", _numbers(placement.p))
        for name in ("stiffness", "length", "damping"):
            element.set(name, _numbers(getattr(spring, name)))
    return top


def _check_equal(scene: Scene, written: SceneFile, q: Any) -> None:
    """Raises ValueError unless both scenes have the same accelerations, with contacts at q."""
    other = written.scene
    if (scene.nq, scene.nv, scene.nu) != (other.nq, other.nv, other.nu):
        raise ValueError("write_scene: a robot has other joints than its URDF, for instance locked joints")

    def differ(a: Any, b: Any) -> bool:
        return not numpy.allclose(a, b, rtol=1e-9, atol=1e-9 * max(1.0, numpy.max(numpy.abs(a), initial=0)))

    for seed in range(2):
        state = random_configuration(scene, seed), random_velocity(scene, seed)
        tau = numpy.ones(scene.nv)
        inertias = crba(scene, state[0]), crba(other, state[0])
        if differ(*inertias) or differ(aba(scene, *state, tau), aba(other, *state, tau)):
            raise ValueError(
                "write_scene: a robot differs from its URDF by another root, varied masses, springs in joints or joint "
                "friction, which the file would not contain"
            )
    data = SceneData(scene, Options()), SceneData(other, Options())
    for x, of in zip(data, (scene, other)):
        solve(of, q, numpy.zeros(scene.nv), numpy.zeros(scene.nu), x)
    if differ(data[0].a, data[1].a) or differ(data[0].f, data[1].f):
        raise ValueError("write_scene: contacts, springs or external wrenches differ when the file is read again")


def write_scene(
    path: str,
    scene: Scene,
    urdfs: Mapping[str, str],
    q: Any = None,
    v: Any = None,
    u: Any = None,
) -> SceneFile:
    """Write a scene that was built in code as a scene file, and return it as load_scene does.

    urdfs: {robot: path of its URDF}. q: configuration (nq), default neutral; v, u: velocity (nv) and torques (nu),
    default zero. The file is read again and compared with the scene. Raises ValueError if it would be another scene,
    for instance because joints are locked or masses varied; the file is then not written.
    """
    q = neutral(scene) if q is None else numpy.asarray(q, float)
    v = numpy.zeros(scene.nv) if v is None else numpy.asarray(v, float)
    u = numpy.zeros(scene.nu) if u is None else numpy.asarray(u, float)
    if (len(q), len(v), len(u)) != (scene.nq, scene.nv, scene.nu):
        given, expected = (len(q), len(v), len(u)), (scene.nq, scene.nv, scene.nu)
        raise ValueError(f"write_scene: q, v, u have {given} numbers, expected {expected}")
    file = pathlib.Path(path)
    top = _scene_element(scene, urdfs, q, v, u, file.parent)
    xml.indent(top)
    text = xml.tostring(top, encoding="unicode") + "\n"
    try:
        written = load_scene_text(text, str(file))
    except InputError as error:
        raise ValueError(f"write_scene: a robot differs from its URDF, for instance by locked joints: {error}")
    _check_equal(scene, written, q)
    file.write_text(text, encoding="utf-8")
    return load_scene_text(text, str(file))
