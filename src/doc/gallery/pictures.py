#!/usr/bin/env python3
"""Draws the pictures of the gallery: the pages of `manycontact view` in chromium, without their panel.

    pictures.py [NAME ...]     needs manycontact and chromium on the PATH, and the Python package pillow
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


def draw(name):
    scene, view = PICTURES[name]
    with tempfile.TemporaryDirectory() as folder:
        page, picture = pathlib.Path(folder) / "page.html", pathlib.Path(folder) / "page.png"
        subprocess.run(["manycontact", "view", MODELS / scene, "--out", page], check=True)
        subprocess.run([
            "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--hide-scrollbars", f"--window-size={PANEL + WIDTH},{HEIGHT}", "--virtual-time-budget=2500",
            f"--user-data-dir={folder}/profile", f"--screenshot={picture}", f"file://{page}#{view}",
        ], check=True)  # fmt: skip
        cropped = Image.open(picture).convert("RGB").crop((PANEL, 0, PANEL + WIDTH, HEIGHT))
    cropped.quantize(128, dither=Image.Dither.NONE).save(FOLDER / f"{name}.png", optimize=True)


for chosen in sys.argv[1:] or PICTURES:
    draw(chosen)
