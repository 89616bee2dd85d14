#!/usr/bin/env python3
"""Draws the pictures of the gallery: the pages of `manycontact view` in chromium, without their panel.

    pictures.py [NAME ...]     needs manycontact and chromium on the PATH, and the Python packages manycontact, pillow
                               and, for real robots, robot_descriptions, which downloads them
"""

import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

FOLDER = pathlib.Path(__file__).resolve().parent
MODELS = FOLDER.parents[2] / "models"
PANEL, WIDTH, HEIGHT = 180, 440, 400  # pixels

# A picture's name: its scene, and the view of the page.
PICTURES = {
    "digit_like": ("machines/digit_like.xml", "azimuth=-0.9"),
    "kangaroo_like": ("machines/kangaroo_like.xml", "azimuth=-2.2"),
    "delta": ("machines/delta.xml", "azimuth=-0.9"),
    "bricard": ("published/bricard.xml", "azimuth=-0.6&elevation=0.35"),
    "tower": ("machines/tower.xml", "azimuth=-0.9"),
    "ring": ("ring_of_humanoids.xml", "azimuth=-0.9&elevation=0.35"),
    "carry": ("two_humanoids_carry_beam.xml", "azimuth=-1.1"),
}

# Real robots: a description's name, the joints that are not zero, the contacts, and the view of the page. The first
# contact's frame is at the given height.
LEGS = {f"{leg}_{joint}_joint": q for leg in ("FL", "FR", "RL", "RR") for joint, q in (("thigh", 0.8), ("calf", -1.6))}
ARMS = {"hip_pitch": -0.3, "knee": 0.6, "ankle_pitch": -0.3, "shoulder_pitch": -0.4, "elbow": 0.6}
SOLE = 'type="6d" offset="0.04 0 -0.035" mu="0.7"'
REAL = {
    "go2": (LEGS, {f"{leg}_foot": 'type="3d" mu="0.7"' for leg in ("FL", "FR", "RL", "RR")}, 0.022, "azimuth=-0.7"),
    "g1": ({f"{side}_{joint}_joint": q for side in ("left", "right") for joint, q in ARMS.items()},
           {"left_ankle_roll_link": SOLE, "right_ankle_roll_link": SOLE}, 0.035, "azimuth=-0.9"),
}  # fmt: skip


def scene_of(name, folder):
    import manycontact

    joints, contacts, height, view = REAL[name]
    lines = [f'<scene name="{name}"><robot name="robot" urdf="{manycontact.description_path(name)}" base="floating" u="gravity">']
    lines += [f'<joint name="{joint}" q="{q}"/>' for joint, q in joints.items()]
    lines += ["</robot>", f'<pose frame="robot/{next(iter(contacts))}" z="{height}"/>']
    lines += [f'<contact name="{frame}" frame="robot/{frame}" {rest}/>' for frame, rest in contacts.items()]
    path = pathlib.Path(folder) / f"{name}.xml"
    path.write_text("\n".join([*lines, "</scene>\n"]))
    return path, view


def draw(name):
    with tempfile.TemporaryDirectory() as folder:
        scene, view = scene_of(name, folder) if name in REAL else (MODELS / PICTURES[name][0], PICTURES[name][1])
        page, picture = pathlib.Path(folder) / "page.html", pathlib.Path(folder) / "page.png"
        subprocess.run(["manycontact", "view", scene, "--out", page], check=True)
        subprocess.run([
            "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--hide-scrollbars", f"--window-size={PANEL + WIDTH},{HEIGHT}", "--virtual-time-budget=2500",
            f"--user-data-dir={folder}/profile", f"--screenshot={picture}", f"file://{page}#{view}",
        ], check=True)  # fmt: skip
        cropped = Image.open(picture).convert("RGB").crop((PANEL, 0, PANEL + WIDTH, HEIGHT))
    cropped.quantize(128, dither=Image.Dither.NONE).save(FOLDER / f"{name}.png", optimize=True)


for chosen in sys.argv[1:] or [*REAL, *PICTURES]:
    draw(chosen)
