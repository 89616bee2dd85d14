#!/usr/bin/env python3
"""Makes the collection: a folder per system, with its scene and the Matrix Market files that `manycontact export` writes.

    make.py [--out DIR] [--large] [--only NAME...] [--program P]

Small and hostile systems are written into DIR, by default matrices/ beside this file, where they are kept. --large makes the
large ones instead, by default in build/collection; they take up to 100 MB and some minutes.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]

LEGS = """<joint name="left_hip_pitch" q="-0.4" v="0.3"/> <joint name="left_knee" q="0.8" v="-0.5"/>
    <joint name="left_ankle_pitch" q="-0.4"/> <joint name="right_hip_pitch" q="-0.4"/>
    <joint name="right_knee" q="0.8" v="0.2"/> <joint name="right_ankle_pitch" q="-0.4"/>
    <joint name="left_elbow" q="-0.5" v="1"/> <joint name="right_elbow" q="-0.7"/>"""
FEET = """<contact name="{0}_left" type="6d" frame="{0}/left_sole"/> <contact name="{0}_right" type="6d" frame="{0}/right_sole"/>"""
CORNERS = ("0.12 0.045 0", "0.12 -0.045 0", "-0.12 -0.045 0", "-0.12 0.045 0")


def humanoid(name="h", more=""):
    return f'<robot name="{name}" urdf="humanoid.urdf" base="floating" xyz="0 0 0.7884" {more}>{LEGS}</robot>\n  '


def points(side, offsets):
    return "\n  ".join(
        f'<contact name="{side}_{k}" type="3d" frame="h/{side}_sole" offset="{offset}"/>' for k, offset in enumerate(offsets)
    )


def near(distance):
    """Returns three points of each sole that fix it, so close together that their rows are nearly dependent."""
    row = '<contact name="{0}_{1}" type="{2}" frame="h/{0}_sole" offset="{3}"/>'
    held = (("3d", "0 0 0"), ("2d", f"0 {distance} 0"), ('1d" axis="0 0 1', f"{distance} 0 0"))
    return humanoid() + "\n  ".join(row.format(s, k, *rows) for s in ("left", "right") for k, rows in enumerate(held))


def ring(copies):
    source = (TOP / "models" / "ring_of_humanoids.xml").read_text()
    inside = source[source.index("<robot") : source.index("</scene>")].rstrip()
    return inside.replace('copies="16"', f'copies="{copies}"').replace('u="gravity" ', "")


def wall(boxes):
    """Returns boxes in a square, each attached to its neighbours at four points: rows depend on each other around loops."""
    body, links = [], []
    for k in range(boxes * boxes):
        x, z = k % boxes, k // boxes
        body.append(f'<robot name="b{k}" urdf="box.urdf" base="floating" xyz="{0.4 * x} 0 {0.4 * z + 0.2}"/>')
        if x > 0:
            links += [
                f'<contact name="x{k}_{c}" type="3d" frame="b{k}/crate" offset="-0.2 {y} {h}" to="b{k - 1}/crate" to_offset="0.2 {y} {h}"/>'
                for c, (y, h) in enumerate(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
            ]
        below = f' to="b{k - boxes}/top_' if z > 0 else ""
        links += [
            f'<contact name="z{k}_{c}" type="3d" frame="b{k}/bottom_{c}"' + (f'{below}{c}"' if below else "") + "/>" for c in range(1, 5)
        ]
    return "\n  ".join(body + links)


def link(name, mass, length):
    inertia = mass * length**2 / 12
    return (
        f'<link name="{name}"><inertial><origin xyz="{length / 2} 0 0"/><mass value="{mass}"/>'
        f'<inertia ixx="{inertia / 10}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/></inertial></link>\n'
    )


def chain_urdf(links, mass=lambda k: 1.0):
    text = '<robot name="chain">\n' + link("l0", mass(0), 0.1)
    for k in range(1, links):
        axis = ("0 1 0", "0 0 1", "1 0 0")[k % 3]
        text += link(f"l{k}", mass(k), 0.1)
        text += f'<joint name="j{k}" type="continuous"><parent link="l{k - 1}"/><child link="l{k}"/><origin xyz="0.1 0 0"/>'
        text += f'<axis xyz="{axis}"/></joint>\n'
    return text + "</robot>\n"


def chain(links, contacts):
    joints = " ".join(f'<joint name="j{k}" q="{0.3 * (-1) ** k}" v="{0.1 * (k % 5)}"/>' for k in range(1, links))
    return f'<robot name="c" urdf="chain.urdf" base="floating">{joints}</robot>\n  {contacts}'


def every(step, links, kind):
    return "\n  ".join(f'<contact name="k{k}" type="{kind}" frame="c/l{k}"/>' for k in range(step - 1, links, step))


# name: (kind, what it is, scene, attributes of the scene, files that it needs)
SYSTEMS = {
    "humanoid": ("small", "a humanoid moves on both feet", humanoid() + FEET.format("h"), "", {}),
    "two_humanoids": (
        "small",
        "two humanoids, one hand of each joined",
        humanoid("a", 'u="gravity"') + humanoid("b").replace('xyz="0 0 ', 'xyz="0 -0.6 ') + FEET.format("a") + FEET.format("b")
        + '\n  <contact name="hold" type="6d" frame="a/right_hand" to="b/left_hand"/>',
        "",
        {},
    ),
    "damped": ("small", "corners of both feet, damping 1e-6", humanoid() + "\n  ".join(points(s, CORNERS) for s in ("left", "right")), 'damping="1e-6"', {}),
    "points_1mm": ("hostile", "contact points 1 mm apart", near("1e-3"), "", {}),
    "points_10um": ("hostile", "contact points 0.01 mm apart", near("1e-5"), "", {}),
    "points_100nm": ("hostile", "contact points 0.1 um apart", near("1e-7"), "", {}),
    "corners": (
        "hostile",
        "corners of both feet: 24 rows of rank 12, K is singular",
        humanoid() + "\n  ".join(points(s, CORNERS) for s in ("left", "right")),
        'consistent="true"',
        {},
    ),
    "damped_1e-10": (
        "hostile",
        "corners of both feet, damping 1e-10",
        humanoid() + "\n  ".join(points(s, CORNERS) for s in ("left", "right")),
        'damping="1e-10"',
        {},
    ),
    "chain_60": ("hostile", "60 links in a row, both ends held: M is dense", chain(60, every(30, 60, "6d")), "", {"chain.urdf": chain_urdf(60)}),
    "light_links": (
        "hostile",
        "a chain of links of 1 kg and of 1e-7 kg in turn",
        chain(12, every(6, 12, "3d")),
        "",
        {"chain.urdf": chain_urdf(12, lambda k: 1.0 if k % 2 else 1e-7)},
    ),
    "heavy_load": (
        "hostile",
        "a link of 1e6 kg at the end of a light chain",
        chain(8, every(4, 8, "3d")),
        "",
        {"chain.urdf": chain_urdf(8, lambda k: 1e6 if k == 7 else 0.1)},
    ),
    "ring_16": ("large", "16 humanoids in a ring, hand in hand", ring(16), "", {}),
    "ring_64": ("large", "64 humanoids in a ring", ring(64), "", {}),
    "ring_256": ("large", "256 humanoids in a ring", ring(256), "", {}),
    "chain_1000": ("large", "1000 links in a row, every tenth held", chain(1000, every(10, 1000, "3d")), "", {"chain.urdf": chain_urdf(1000)}),
    "wall_100": ("large", "100 boxes in a square, each on its neighbours: K is singular", wall(10), "", {}),
}


def write_scene(folder, name, inside, attributes, files):
    """Writes scene.xml in the folder, with relative paths to robots of models/."""
    folder.mkdir(parents=True, exist_ok=True)
    models = os.path.relpath(TOP / "models", folder)
    for model in ("humanoid.urdf", "box.urdf"):
        inside = inside.replace(f'urdf="{model}"', f'urdf="{models}/{model}"')
    for file, text in files.items():
        (folder / file).write_text(text)
    scene = folder / "scene.xml"
    scene.write_text(f'<scene name="{name}" {attributes}>\n  {inside}\n</scene>\n'.replace('" >', '">'))
    return scene


def make(program, out, name):
    kind, what, inside, attributes, files = SYSTEMS[name]
    folder = out / name
    scene = write_scene(folder, name, inside, attributes, files)
    done = subprocess.run([program, "export", "scene.xml", "--out", ".", "--truth"], cwd=folder, text=True, capture_output=True)
    if done.returncode:
        sys.exit(f"make.py: {name}: {done.stderr.strip()}")
    (folder / "system.json").write_text(json.dumps({"name": name, "kind": kind, "what": what}) + "\n")
    print(done.stdout.strip())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--only", nargs="+", choices=sorted(SYSTEMS), metavar="NAME")
    parser.add_argument("--program", default=str(TOP / "build/release/bin/manycontact"))
    words = parser.parse_args()
    out = words.out or (TOP / "build/collection" if words.large else HERE / "matrices")
    names = words.only or [n for n, system in SYSTEMS.items() if (system[0] == "large") == words.large]
    for name in names:
        make(os.path.abspath(words.program), out.resolve(), name)


if __name__ == "__main__":
    main()
