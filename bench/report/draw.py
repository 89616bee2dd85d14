"""Draws the figures of `./run bench`: panels in a row, a key below each, and below all how programs differ.

    draw.py DIR FIGURES.json
"""

import json
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/program/charts"))
import drawing  # noqa: E402
from drawing import plain, plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

# Okabe and Ito's colours; ours is black.
COLOURS = {"MuJoCo": "#E69F00", "Simbody": "#009E73", "DART": "#CC79A7", "Pinocchio": "#0072B2", "Crocoddyl": "#D55E00"}
MARKERS, DASHES = "os^Dv", ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)))


def draw(figure, differences, base):
    panels = figure["panels"]
    width = 9 if len(panels) == 1 else 6.4 * len(panels)
    drawn, all_axes = plt.subplots(1, len(panels), figsize=(width, 6.8), squeeze=False)
    drawn.suptitle(plain(figure["title"]), x=0.02, ha="left", fontsize=12)
    for axes, panel in zip(all_axes[0], panels):
        drawing.frame(axes)
        for line in panel["lines"]:
            axes.plot(*zip(*line["points"]), color=COLOURS.get(line["program"], "black"), linewidth=2.5 if line["program"] == "manycontact" else 1.5,
                      linestyle=DASHES[line["task"] % len(DASHES)], marker=MARKERS[line["task"] % len(MARKERS)], markersize=5, label=plain(line["label"]))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            axis.set_minor_formatter(NullFormatter())
        axes.set_title(plain(panel["title"]))
        axes.set_xlabel(plain(panel["x"]))
        axes.set_ylabel(plain(panel["y"]))
        axes.legend(loc="upper left", bbox_to_anchor=(0, -0.15), ncol=2, frameon=False, fontsize=8)
    drawn.subplots_adjust(0.14 / len(panels), 0.38, 1 - 0.04 / len(panels), 0.88, 0.2)
    for k, text in enumerate(differences):
        drawn.text(0.02, 0.12 - 0.023 * k, plain(text), color=drawing.GREY, fontsize=8)
    drawing.save(drawn, base)


def main(folder, figures):
    with open(figures) as file:
        written = json.load(file)
    for figure in written["figures"]:
        draw(figure, written["differences"], os.path.join(folder, figure["file"]))


if __name__ == "__main__":
    main(*sys.argv[1:])
