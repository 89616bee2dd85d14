#!/usr/bin/env python3
"""Writes the robots and scenes of this folder.

    machines.py [FOLDER]

A robot is described at q = 0, where all loops are closed: points are those of the root's frame, and the axes of links are
the root's, except those of rods and actuators, whose z axis is along the rod. Inertias are those of uniform solids, which
are also drawn. A rod is connected by a universal joint at its start and by a 3d contact of the scene, a ball joint, at its
end; it has no rotation about itself.
"""

import math
import pathlib
import sys

import numpy as np


def text(numbers):
    return " ".join(f"{x + 0.0:.6g}" for x in np.round(numbers, 9))


def along(direction):
    """rpy of a frame whose z axis has this direction, without a rotation about it."""
    x, y, z = np.asarray(direction) / np.linalg.norm(direction)
    return [-math.asin(y), math.atan2(x, z), 0]


def box(mass, size):
    x, y, z = np.square(size)
    return f'<box size="{text(size)}"/>', np.array([y + z, x + z, x + y]) * mass / 12


def cylinder(mass, radius, length):
    side = mass * (3 * radius**2 + length**2) / 12
    return f'<cylinder radius="{radius:.6g}" length="{length:.6g}"/>', [side, side, mass * radius**2 / 2]


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SIDES = (("left", 1), ("right", -1))
SOLE = (0.22, 0.1, 0.02)


class Robot:
    """The lines of a URDF, its passive joints, and the ends of its rods with the links that they are connected to."""

    def __init__(self, name, comment, root):
        self.lines = ['<?xml version="1.0"?>', "<!--", *(f"  {x}" for x in comment), "-->", f'<robot name="{name}">']
        self.places, self.passive, self.ends = {}, [], []  # places: where joints are, in the axes of their links
        self.link(root)

    def link(self, name, mass=0, shape=None, at=(0, 0, 0), rpy=(0, 0, 0)):
        """A link, with the solid `shape` = (geometry, moments) at a point of its frame."""
        if not shape:
            self.lines.append(f'  <link name="{name}"/>')
            return
        ixx, iyy, izz = shape[1]
        moments = f'ixx="{ixx:.6g}" ixy="0" ixz="0" iyy="{iyy:.6g}" iyz="0" izz="{izz:.6g}"'
        origin = f'<origin xyz="{text(at)}" rpy="{text(rpy)}"/>'
        self.lines += [
            f'  <link name="{name}">',
            f'    <inertial> {origin} <mass value="{mass:.6g}"/> <inertia {moments}/> </inertial>',
            f"    <visual> {origin} <geometry> {shape[0]} </geometry> </visual>",
            "  </link>",
        ]

    def joint(self, name, kind, parent, child, xyz=(0, 0, 0), rpy=(0, 0, 0), axis=None, limits=None):
        parts = f'<parent link="{parent}"/> <child link="{child}"/> <origin xyz="{text(xyz)}" rpy="{text(rpy)}"/>'
        parts += f' <axis xyz="{text(axis)}"/>' if axis else ""
        parts += ' <limit lower="{:.6g}" upper="{:.6g}" effort="{:.6g}" velocity="{:.6g}"/>'.format(*limits) if limits else ""
        self.lines.append(f'  <joint name="{name}" type="{kind}"> {parts} </joint>')

    def body(self, name, parent, point, axis, mass, radius=None, to=None, size=None, middle=(0, 0, 0), passive=False):
        """A link that rotates about `axis` at a point: a cylinder from there to a point, a box, or nothing."""
        self.joint(name, "continuous", parent, f"{name}_link", np.subtract(point, self.places.get(parent, 0)), axis=axis)
        self.places[f"{name}_link"] = np.asarray(point, float)
        if passive:
            self.passive.append(name)
        if to is not None:
            d = np.subtract(to, point)
            self.link(f"{name}_link", mass, cylinder(mass, radius, np.linalg.norm(d)), d / 2, along(d))
        elif size is not None:
            self.link(f"{name}_link", mass, box(mass, size), middle)
        else:
            self.link(f"{name}_link")
        return f"{name}_link"

    def rod(self, name, parent, start, end, to, masses, radius=0.012):
        """A rod between points of two links; with two masses a linear actuator of a tube and a sliding rod."""
        d = np.subtract(end, start)
        length, first = np.linalg.norm(d), masses[0]
        at = np.subtract(start, self.places.get(parent, 0))
        self.joint(f"{name}_u1", "continuous", parent, f"{name}_cross", at, along(d), X)
        self.link(f"{name}_cross")
        self.joint(f"{name}_u2", "continuous", f"{name}_cross", f"{name}_rod", axis=Y)
        self.passive += [f"{name}_u1", f"{name}_u2"]
        if len(masses) == 1:
            self.link(f"{name}_rod", first, cylinder(first, radius, length), (0, 0, length / 2))
            self.joint(f"{name}_fixed", "fixed", f"{name}_rod", f"{name}_end", (0, 0, length))
        else:
            tube, limits = 0.6 * length, (-0.3 * length, 0.3 * length, 5000, 1)
            self.link(f"{name}_rod", first, cylinder(first, 1.8 * radius, tube), (0, 0, tube / 2))
            self.joint(name, "prismatic", f"{name}_rod", f"{name}_slider", (0, 0, tube), axis=Z, limits=limits)
            self.link(f"{name}_slider", masses[1], cylinder(masses[1], radius, length), (0, 0, 0.4 * length - length / 2))
            self.joint(f"{name}_fixed", "fixed", f"{name}_slider", f"{name}_end", (0, 0, 0.4 * length))
        self.link(f"{name}_end")
        self.ends.append((name, to))

    def urdf(self):
        return "\n".join([*self.lines, "</robot>", ""])


def scene(name, comment, robots, contacts):
    return "\n".join(["<!--", *(f"  {x}" for x in comment), "-->", f'<scene name="{name}">', *robots, *contacts, "</scene>", ""])


def robot_lines(name, robot, attributes, more=()):
    passive = [f'    <joint name="{x}" actuated="false"/>' for x in robot.passive if not any(f'"{x}"' in line for line in more)]
    return [f'  <robot name="{name}" urdf="{name}.urdf" {attributes}>', *(f"    {x}" for x in more), *passive, "  </robot>"]


def ball_joints(name, robot):
    return [f'  <contact name="{rod}" type="3d" frame="{name}/{rod}_end" to="{name}/{to}"/>' for rod, to in robot.ends]


def soles(name):
    line = '  <contact name="{0}_foot" type="6d" frame="{1}/{0}_sole" mu="0.7" box="{2}"/>'
    return [line.format(side, name, text(SOLE[:2])) for side, _ in SIDES]


def delta():
    robot = Robot("delta", [
        "A delta robot: three motors on a plate, three upper arms, six rods, a platform. 15 joints and a floating platform;",
        "six ball joints of the scene leave the three translations of the platform. Own dimensions. Written by machines.py.",
    ], "world")  # fmt: skip
    robot.joint("mount", "fixed", "world", "plate")
    robot.link("plate", 4, cylinder(4, 0.14, 0.02), (0, 0, 0.02))
    for k in range(3):
        arm = f"arm_{k + 1}"
        turned = [0, 0, math.radians(90 + 120 * k)]
        robot.joint(f"{arm}_mount", "fixed", "plate", f"{arm}_base", rpy=turned)
        robot.link(f"{arm}_base")
        upper = robot.body(f"motor_{k + 1}", f"{arm}_base", (0.1, 0, 0), Y, 0.4, 0.018, to=(0.28, 0, -0.09))
        for side, y in (("a", 0.04), ("b", -0.04)):
            robot.rod(f"rod_{k + 1}{side}", upper, (0.28, y, -0.09), (0.06, y, -0.45), "platform", [0.1], 0.006)
    robot.joint("free", "floating", "world", "platform", (0, 0, -0.45))
    robot.link("platform", 0.5, cylinder(0.5, 0.07, 0.015), (0, 0, 0))
    comment = [
        "A delta robot at rest: each rod has a universal joint above and a ball joint below, a contact. 21 velocities,",
        "18 independent rows, three motors.",
    ]
    return {
        "delta.urdf": robot.urdf(),
        "delta.xml": scene("delta", comment, robot_lines("delta", robot, 'u="gravity"'), ball_joints("delta", robot)),
    }


# Rest of the springs of the shins at which they carry the weight at q = 0: the torque that static equilibrium asks of an
# actuated shin, -127.168040551188 N m, over the stiffness.
SHIN_STIFFNESS, SHIN_REST = 3000, -127.168040551188 / 3000


def digit():
    robot = Robot("digit_like", [
        "A biped with the kinematics of Digit's legs: a spring in each shin, a rod from the thigh to the heel of the tarsus,",
        "and two motors per foot whose cranks move it by rods. Own dimensions and masses. z up, x forward, y left; the soles",
        "are 0.99 m below the pelvis at q = 0, where all loops are closed. Written by machines.py.",
    ], "pelvis")  # fmt: skip
    robot.joint("torso_fixed", "fixed", "pelvis", "torso")
    robot.link("torso", 20, box(20, (0.2, 0.28, 0.45)), (0, 0, 0.27))
    for side, s in SIDES:

        def at(x, y, z):
            return (x, s * y, z)

        roll = robot.body(f"{side}_hip_roll", "pelvis", at(0, 0.09, 0), X, 1.5, size=(0.1, 0.08, 0.08))
        yaw = robot.body(f"{side}_hip_yaw", roll, at(0, 0.12, -0.04), Z, 1.5, size=(0.09, 0.09, 0.1), middle=(0, 0, -0.04))
        thigh = robot.body(f"{side}_hip_pitch", yaw, at(0, 0.12, -0.1), Y, 4, 0.05, to=at(0.2, 0.12, -0.35))
        knee = robot.body(f"{side}_knee", thigh, at(0.2, 0.12, -0.35), Y, 1, 0.04, to=at(0.16, 0.12, -0.4))
        shin = robot.body(f"{side}_shin", knee, at(0.16, 0.12, -0.4), Y, 0.8, 0.025, to=at(-0.1, 0.12, -0.62), passive=True)
        tarsus = robot.body(f"{side}_tarsus", shin, at(-0.1, 0.12, -0.62), Y, 1.5, 0.025, to=at(0.02, 0.12, -0.95), passive=True)
        robot.rod(f"{side}_heel_rod", thigh, at(-0.04, 0.1, -0.14), at(-0.17, 0.1, -0.58), tarsus, [0.2], 0.008)
        pitch = robot.body(f"{side}_toe_pitch", tarsus, at(0.02, 0.12, -0.95), Y, 0, passive=True)
        ankle = at(0.02, 0.12, -0.95)
        foot = robot.body(f"{side}_toe_roll", pitch, ankle, X, 0.6, size=SOLE, middle=(0.03, 0, -0.03), passive=True)
        for name, y in (("a", 0.17), ("b", 0.07)):
            crank = robot.body(f"{side}_toe_{name}", tarsus, at(-0.06, y, -0.74), Y, 0.1, 0.01, to=at(-0.115, y, -0.75))
            heel = at(-0.06, 0.12 + (y - 0.12) * 0.8, -0.97)
            robot.rod(f"{side}_toe_rod_{name}", crank, at(-0.115, y, -0.75), heel, foot, [0.1], 0.006)
        robot.joint(f"{side}_sole_fixed", "fixed", foot, f"{side}_sole", (0.03, 0, -0.04))
        robot.link(f"{side}_sole")
        arm = robot.body(f"{side}_shoulder_roll", "torso", at(0, 0.16, 0.4), X, 1, size=(0.08, 0.06, 0.08), middle=at(0, 0.02, 0))
        arm = robot.body(f"{side}_shoulder_pitch", arm, at(0, 0.2, 0.4), Y, 1, size=(0.07, 0.06, 0.07))
        arm = robot.body(f"{side}_shoulder_yaw", arm, at(0, 0.21, 0.4), Z, 1.5, 0.03, to=at(-0.08, 0.24, 0.12))
        robot.body(f"{side}_elbow", arm, at(-0.08, 0.24, 0.12), Y, 1, 0.025, to=at(0.18, 0.22, 0.02))
    spring = f'actuated="false" stiffness="{SHIN_STIFFNESS}" rest="{SHIN_REST!r}" damping="5"'
    springs = [f'<joint name="{side}_shin" {spring}/>' for side, _ in SIDES]
    comment = [
        "A biped with legs like Digit's stands: six loops are closed by rods, and the weight bends the springs of the shins.",
        "46 velocities, 30 independent rows. The rest of the springs is such that they carry the weight at q = 0.",
    ]
    lines = robot_lines("digit_like", robot, 'base="floating" xyz="0 0 0.99" u="gravity"', springs)
    return {
        "digit_like.urdf": robot.urdf(),
        "digit_like.xml": scene("digit_like", comment, lines, ball_joints("digit_like", robot) + soles("digit_like")),
    }


def kangaroo():
    robot = Robot("kangaroo_like", [
        "Legs that are moved like Kangaroo's: five linear actuators per leg close loops about hip, knee and ankle, and a motor",
        "turns the leg. Own dimensions and masses. z up, x forward, y left; the soles are 0.8 m below the pelvis at q = 0, where",
        "all loops are closed. Written by machines.py.",
    ], "pelvis")  # fmt: skip
    robot.joint("body_fixed", "fixed", "pelvis", "body")
    robot.link("body", 12, box(12, (0.2, 0.26, 0.16)), (0, 0, 0.2))
    for side, s in SIDES:

        def at(x, y, z):
            return (x, s * y, z)

        yaw = robot.body(f"{side}_hip_yaw", "pelvis", at(0, 0.11, 0.1), Z, 1, size=(0.12, 0.12, 0.04))
        roll = robot.body(f"{side}_hip_roll", yaw, at(0, 0.11, 0), X, 0, passive=True)
        thigh = robot.body(f"{side}_hip_pitch", roll, at(0, 0.11, 0), Y, 4, 0.035, to=at(0.09, 0.11, -0.36), passive=True)
        for name, y in (("a", 0.06), ("b", -0.06)):
            robot.rod(f"{side}_hip_{name}", yaw, at(-0.1, 0.11 + y, 0.09), at(0, 0.11 + 0.8 * y, -0.2), thigh, [0.7, 0.3])
        shin = robot.body(f"{side}_knee", thigh, at(0.09, 0.11, -0.36), Y, 2, 0.025, to=at(0, 0.11, -0.74), passive=True)
        robot.rod(f"{side}_knee_rod", thigh, at(-0.04, 0.11, -0.02), at(0.02, 0.11, -0.39), shin, [0.8, 0.3])
        pitch = robot.body(f"{side}_ankle_pitch", shin, at(0, 0.11, -0.74), Y, 0, passive=True)
        ankle = at(0, 0.11, -0.74)
        foot = robot.body(f"{side}_ankle_roll", pitch, ankle, X, 1, size=SOLE, middle=(0.03, 0, -0.05), passive=True)
        for name, y in (("a", 0.05), ("b", -0.05)):
            heel = at(-0.07, 0.11 + 0.8 * y, -0.76)
            robot.rod(f"{side}_ankle_{name}", shin, at(-0.01, 0.11 + y, -0.45), heel, foot, [0.5, 0.2], 0.01)
        robot.joint(f"{side}_sole_fixed", "fixed", foot, f"{side}_sole", (0.03, 0, -0.06))
        robot.link(f"{side}_sole")
    comment = [
        "Two legs that are moved like Kangaroo's stand: ten loops of linear actuators. 48 velocities, 42 independent rows; the",
        "pelvis keeps six degrees of freedom, twelve motors move them.",
    ]
    lines = robot_lines("kangaroo_like", robot, 'base="floating" xyz="0 0 0.8" u="gravity"')
    return {
        "kangaroo_like.urdf": robot.urdf(),
        "kangaroo_like.xml": scene("kangaroo_like", comment, lines, ball_joints("kangaroo_like", robot) + soles("kangaroo_like")),
    }


def tower(boxes=8):
    robots = [f'  <robot name="box{k}" urdf="../box.urdf" base="floating" xyz="0 0 {0.2 + 0.4 * k:.1f}"/>' for k in range(boxes)]
    contacts = []
    for k in range(boxes):
        to = f' to="box{k - 1}/crate"' if k else ""
        for corner in range(1, 5):
            contacts.append(f'  <contact name="{k}_{corner}" type="3d" frame="box{k}/bottom_{corner}"{to} mu="0.5"/>')
    comment = [
        "Eight boxes on each other, each on its four corners. Of the 96 rows 48 are redundant: accelerations are exact, and the",
        "forces are those of least norm.",
    ]
    return {"tower.xml": scene("tower", comment, robots, contacts)}


def files():
    return {**delta(), **digit(), **kangaroo(), **tower()}


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent
    for name, content in files().items():
        (folder / name).write_text(content)
