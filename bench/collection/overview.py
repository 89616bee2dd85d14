#!/usr/bin/env python3
"""Draws the README's chart, error of accelerations against time: a small multiple for each of four systems of the collection.

    overview.py [--out PICTURE.png] [--bin DIR] [--csv FILE] [--draw]

The numbers go to FILE, by default overview.csv beside the picture; --draw draws what is there. Peers take part where `./run bench --peers`
has built their programs. Python needs numpy and matplotlib.
"""

import argparse
import csv
import datetime
import pathlib
import sys
import tempfile

import chart
import make
import matplotlib.pyplot as plt
import numpy as np
import run
from matplotlib import ticker
from matplotlib.transforms import Bbox

# scene: (explanation for the reader, contents)
PANELS = {
    "humanoid": ("One humanoid on both feet\n38 velocities, 12 constraint rows", make.SYSTEMS["humanoid"][2]),
    "ring_8": ("8 humanoids hand in hand in a ring\n304 velocities, 144 constraint rows", make.ring(8)),
    "corners": ("One humanoid on the 8 corners of its feet\n24 rows, 12 of them redundant: K is singular", make.SYSTEMS["corners"][2]),
    "points_100nm": ("One humanoid on points 0.1 µm apart\ncondition of K: 2e15", make.SYSTEMS["points_100nm"][2]),
}
BLACK, BLUE, ORANGE, GREEN, PURPLE, PINK, BROWN = "black", "#0072B2", "#D55E00", "#009E73", "#882255", "#CC6699", "#8C6D31"
CONSISTENT = 'consistent="true"'  # peers damp velocities that the contacts do not allow
MUS = ("0", "1e-12", "1e-10", "1e-8", "1e-6", "1e-4")
# line: (colour, marker, [(label of the point, solver, damping of the scene)]); open markers: only solves with the given K
LINES = {
    "manycontact": (BLACK, "*", [(p, f"manycontact:{p}", None) for p in run.PRECISIONS]),
    "manycontact, damped": (BLACK, ".", [(d, "manycontact", d) for d in chart.DAMPINGS]),
    "our LDL of K damped by 1e-5, refined": (BLUE, "o", [(f"{s}", f"sparse-ldl:1e-5:{s}", None) for s in chart.STEPS]),
    "LAPACK": (ORANGE, "o", [(name, name, None) for name in ("dsysv", "dsysv_rook", "dsysvx")]),
    "MUMPS": (GREEN, "o", [("MUMPS", "mumps", None)]),
    "Pinocchio constraintDynamics": (PURPLE, "s", [(m, f"peer:pinocchio:constraintDynamics:{m}:1", None) for m in MUS]),
    "Pinocchio constrainedABA": (PINK, "D", [(f"{n}", f"peer:pinocchio:constrainedABA:1e-4:{n}", None) for n in (1, 3, 5, 10)]),
    "MuJoCo": (BROWN, "^", [(d, f"peer:mujoco:mj_forward:1e-8:{d}", None) for d in ("0.9", "0.99", "0.999", "0.9999")]),
}


def measure(bin):
    table = []
    for name, (_, inside) in PANELS.items():
        with tempfile.TemporaryDirectory() as folder:
            scene = make.write_scene(pathlib.Path(folder).resolve(), name, inside, CONSISTENT, {})
            found, _ = chart.measure(scene, bin, LINES)
        table += [(name, *row[:4]) for row in found]
        print(f"{name}: {len(found)} points")
    return table



def points_of(table, name, line):
    """[(dial, time, error)] of a line, in the order of its dials."""
    found = {row[2]: (float(row[3]), max(float(row[4]), chart.EXACT)) for row in table if row[0] == name and row[1] == line}
    return [(dial, *found[dial]) for dial, *_ in LINES[line][2] if dial in found]


class Labels:
    """Places labels next to their points, each where it covers markers, other labels and the outside least."""

    PLACES = [(dx, dy) for reach in (10, 16, 26, 40) for dx, dy in ((reach, 0), (-reach, 0), (0, reach), (0, -reach), (reach, reach), (reach, -reach),
                                                                (-reach, reach), (-reach, -reach))]

    def __init__(self, axes):
        self.axes, self.boxes, self.renderer = axes, [], axes.figure.canvas.get_renderer()
        self.inside = axes.get_window_extent(self.renderer)

    def marker(self, time, error, size):
        x, y = self.axes.transData.transform((time, error))
        half = size * self.axes.figure.dpi / 144
        self.boxes.append(Bbox([[x - half, y - half], [x + half, y + half]]))

    def line(self, points):
        corners = self.axes.transData.transform(points)
        for (x, y), (u, v) in zip(corners, corners[1:]):
            steps = max(2, int(np.hypot(u - x, v - y) / 6))
            self.boxes += [Bbox.from_bounds(x + t * (u - x) - 1, y + t * (v - y) - 1, 2, 2) for t in np.linspace(0, 1, steps)]

    def covered(self, box):
        overlaps = (Bbox.intersection(box, other) for other in self.boxes)
        outside = box.width * box.height - sum(b.width * b.height for b in [Bbox.intersection(box, self.inside)] if b)
        return 3 * outside + sum(b.width * b.height for b in overlaps if b)

    def add(self, text, point, **more):
        best = None
        for dx, dy in self.PLACES:
            side = "left" if dx > 0 else "right" if dx < 0 else "center"
            drawn = self.axes.annotate(text, point, textcoords="offset points", xytext=(dx, dy), fontsize=8, ha=side, va="center", **more)
            covered = self.covered(box := drawn.get_window_extent(self.renderer))
            if best is None or covered < best[0] - 1:
                if best:
                    best[1].remove()
                best = (covered, drawn, box, np.hypot(dx, dy))
            else:
                drawn.remove()
            if covered == 0:
                break
        self.boxes.append(best[2])
        if best[3] > 15:  # a line leads to it
            nearest = np.clip(self.axes.transData.transform(point), best[2].min, best[2].max)
            ends = self.axes.transData.inverted().transform([nearest])
            self.axes.annotate("", point, ends[0], arrowprops={"arrowstyle": "-", "color": more["color"], "lw": 0.6, "alpha": 0.6, "shrinkA": 8},
                               zorder=1)


def draw_panel(axes, table, name):
    for line, (colour, marker, _) in LINES.items():
        if not (points := points_of(table, name, line)):
            continue
        _, times, errors = zip(*points)
        if line != "LAPACK":
            axes.plot(times, errors, "-", color=colour, linewidth=1.2, alpha=0.45, zorder=2)
        axes.plot(times, errors, marker, color=colour, markersize=15 if marker == "*" else 6, linestyle="none",
                  markerfacecolor=colour if line in OF_SCENE else "white", zorder=4 if marker == "*" else 3)
    axes.set_title(PANELS[name][0], fontsize=10, loc="left")
    axes.grid(True, which="major", alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)


def label_panel(axes, table, name):
    labels, texts = Labels(axes), []
    for line, (colour, marker, _) in LINES.items():
        points = points_of(table, name, line)
        if len(points) > 1 and line != "LAPACK":
            labels.line([point[1:] for point in points])
        for k, (dial, time, error) in enumerate(points):
            labels.marker(time, error, 15 if marker == "*" else 6)
            if line not in ENDS or k in (0, len(points) - 1):
                texts.append((ENDS.get(line, "{}").format(dial).replace(" 1 iterations", " 1 iteration"), (time, error), colour, "bold" if marker == "*" else "normal"))
    for text, point, colour, weight in texts:
        labels.add(text, point, color=colour, fontweight=weight)


OF_SCENE = ("manycontact", "manycontact, damped", "Pinocchio constraintDynamics", "Pinocchio constrainedABA", "MuJoCo")
# These lines name their first and last point.
ENDS = {
    "manycontact, damped": "damping {}",
    "our LDL of K damped by 1e-5, refined": "{} refinements",
    "Pinocchio constraintDynamics": "mu {}",
    "Pinocchio constrainedABA": "ABA, {} iterations",
    "MuJoCo": "impedance {}",
}


def legend(figure, table):
    entries = [("*", BLACK, BLACK, "manycontact, by precision"), (".", BLACK, BLACK, "manycontact, damped"),
               ("o", BLUE, "white", "our LDL of a damped K, refined"), ("o", ORANGE, "white", "LAPACK"), ("o", GREEN, "white", "MUMPS")]
    peers = [line for line in LINES if line.startswith(("Pinocchio", "MuJoCo")) and any(row[1] == line for row in table)]
    entries += [(LINES[line][1], LINES[line][0], LINES[line][0], line) for line in peers]
    handles = [plt.Line2D([], [], linestyle="none", marker=m, color=c, markerfacecolor=f, markersize=12 if m == "*" else 6, label=t)
               for m, c, f, t in entries]
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(0.02, 0.965), ncol=(len(handles) + 1) // 2 if peers else len(handles), fontsize=9, frameon=False, handletextpad=0.2)


def draw(table, path):
    figure, panels = plt.subplots(2, 2, figsize=(11.5, 8.4), sharey=True, dpi=110)
    panels[0][0].set_yscale("log")
    panels[0][0].set_ylim(1e-17, 30)
    for axes, name in zip(panels.flat, PANELS):
        axes.set_xscale("log")
        draw_panel(axes, table, name)
        low, high = axes.get_xlim()
        axes.set_xlim(low / 1.1, high * (high / low) ** 0.18)
        axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if high / low < 100 else (1,)))
        axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x / 1000:g} ms" if x >= 1000 else f"{x:g} µs"))
        axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    for axes in panels[:, 0]:
        axes.set_ylabel("relative error of the accelerations\n← more accurate")
    for axes in panels[1]:
        axes.set_xlabel("← faster      time of one solve")
    figure.suptitle("Accuracy against time: lower left is better", x=0.03, y=0.99, ha="left", fontsize=13, fontweight="bold")
    legend(figure, table)
    figure.text(0.03, 0.008, "Filled marks: the whole solve from positions and velocities. Open marks: K is given, and only factored and solved. "
                "Errors are differences from quadruple precision. "
                f"{run.processor()}, {datetime.date.today()}.", fontsize=8.5)
    figure.tight_layout(rect=(0, 0.025, 1, 0.94))
    figure.canvas.draw()
    for axes, name in zip(panels.flat, PANELS):
        label_panel(axes, table, name)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=run.TOP / "bench/charts/overview.png")
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, default=run.TOP / "build/release/bin")
    parser.add_argument("--draw", action="store_true")
    words = parser.parse_args()
    file = words.csv or words.out.with_suffix(".csv")
    if not words.draw:
        with open(file, "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([("scene", "line", "dial", "time_us", "error"), *measure(words.bin.resolve())])
    draw(list(csv.reader(open(file)))[1:], words.out)


if __name__ == "__main__":
    main()
