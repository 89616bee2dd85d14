#!/usr/bin/env python3
"""Draws error of accelerations against time on systems of the collection: whole solves, the README's chart, and factorizations of K.

    overview.py [--out DIR] [--bin DIR] [--draw]

DIR, by default bench/charts, gets overview.csv, overview.png and factorizations.png; --draw draws the overview.csv that is there. Peers take
part where `./run bench --peers` has built their programs, with --native those of that build. Python needs numpy and matplotlib.
"""

import argparse
import csv
import pathlib
import tempfile

import chart
import make
import matplotlib.pyplot as plt
import run
from matplotlib import ticker

SCENES = {
    "humanoid": ("One humanoid on both feet", make.SYSTEMS["humanoid"][2]),
    "ring_8": ("8 humanoids hand in hand", make.ring(8)),
    "corners": ("One humanoid on 8 points, redundant", make.SYSTEMS["corners"][2]),
    "points_100nm": ("One humanoid on points 0.1 µm apart", make.SYSTEMS["points_100nm"][2]),
}
CONSISTENT = 'consistent="true"'  # peers damp velocities that the contacts do not allow
ITERATIONS = (1, 3, 5, 10, 20)
BLACK, BLUE, ORANGE, GREEN, PURPLE, PINK, BROWN = "black", "#0072B2", "#D55E00", "#009E73", "#882255", "#CC6699", "#8C6D31"
# line: (colour, marker, [(dial, solver, damping of the scene)], what the last dial is)
SOLVES = {
    "manycontact": (BLACK, "*", [(p, f"manycontact:{p}", None) for p in run.PRECISIONS], ""),
    "Pinocchio constraintDynamics": (PURPLE, "s", [(f"{n}", f"peer:pinocchio:constraintDynamics:1e-6:{n}", None) for n in ITERATIONS], "iterations"),
    "Pinocchio constrainedABA": (PINK, "D", [(f"{n}", f"peer:pinocchio:constrainedABA:1e-6:{n}", None) for n in ITERATIONS], "iterations"),
    "Crocoddyl calc": (GREEN, "v", [("calc", "peer:crocoddyl:calc", None)], ""),
    "MuJoCo mj_forward, soft": (BROWN, "^", [(d, f"peer:mujoco:mj_forward:1e-8:{d}", None) for d in ("0.9", "0.9999")], "impedance"),
}
FACTORS = {
    "our LDL of K damped by 1e-5, refined": (BLUE, "o", [(f"{s}", f"sparse-ldl:1e-5:{s}", None) for s in chart.STEPS], "steps"),
    "LAPACK dsysv": (ORANGE, "s", [("", "dsysv", None)], ""),
    "LAPACK dsysv_rook": (ORANGE, "D", [("", "dsysv_rook", None)], ""),
    "LAPACK dsysvx": (ORANGE, "^", [("", "dsysvx", None)], ""),
    "MUMPS": (GREEN, "v", [("", "mumps", None)], ""),
}


def measure(bin):
    """Rows (scene, line, dial, time, error, machine, build of the peers)."""
    table, build = [], "-march=native" if run.peer_program(bin, "pinocchio").parent != bin else "portable"
    for name, (_, inside) in SCENES.items():
        with tempfile.TemporaryDirectory() as folder:
            scene = make.write_scene(pathlib.Path(folder).resolve(), name, inside, CONSISTENT, {})
            found, _ = chart.measure(scene, bin, {line: of[:3] for line, of in (SOLVES | FACTORS).items()})
        table += [(name, *row[:4], run.drawing.machine(), build) for row in found]
        print(f"{name}: {len(found)} points")
    return table


def points_of(table, scene, line):
    """[(dial, time, error)] of a line, in the order of its dials."""
    found = {row["dial"]: (float(row["time_us"]), max(float(row["error"]), chart.EXACT)) for row in table if (row["scene"], row["line"]) == (scene, line)}
    return [(dial, *found[dial]) for dial, *_ in (SOLVES | FACTORS)[line][2] if dial in found]


def finding(table, scene):
    """What a panel shows: how much longer the fastest other program takes, of those that are right to 1e-9."""
    ours = dict((dial, time) for dial, time, _ in points_of(table, scene, "manycontact"))["double"]
    time, peer = min((time, line) for line in SOLVES if line != "manycontact" for _, time, error in points_of(table, scene, line) if error < 1e-9)
    return f"{SCENES[scene][0]}:\n{time / ours:.2g} times as fast as {peer.split()[0]}"


def draw(table, lines, titles, note, path):
    figure, panels = plt.subplots(1, len(titles), figsize=(4.7 * len(titles), 5.6), sharey=True, dpi=110)
    for axes, (scene, title) in zip(panels, titles.items()):
        axes.set_xscale("log")
        axes.set_yscale("log")
        for line, (colour, marker, _, label) in lines.items():
            points = points_of(table, scene, line)
            _, times, errors = zip(*points or [("", float("nan"), float("nan"))])
            axes.plot(times, errors, "-", color=colour, linewidth=1, alpha=0.5)
            axes.plot(times, errors, marker, color=colour, markersize=15 if marker == "*" else 6, linestyle="none", label=line)
            for dial, time, error in points if marker == "*" else points[:: len(points) - 1] if label else ():
                last = marker != "*" and dial == points[-1][0]
                axes.annotate(f"{dial} {label}" if last else dial, (time, error), textcoords="offset points", xytext=(0, -14) if last else (9, -3),
                              ha="center" if last else "left", fontsize=8, color=colour)
        if missing := [line for line in lines if not points_of(table, scene, line)]:
            axes.text(0.98, 0.8, "no result:\n" + "\n".join(missing), transform=axes.transAxes, fontsize=8, ha="right", va="top")
        low, high = axes.get_xlim()
        axes.set_xlim(low, high * (high / low) ** 0.25)  # for the labels
        axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if high / low < 100 else (1,)))
        axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x / 1000:g} ms" if x >= 1000 else f"{x:g} µs"))
        axes.xaxis.set_minor_formatter(ticker.NullFormatter())
        axes.set_title(title, fontsize=11, loc="left", fontweight="bold")
        axes.set_xlabel("← faster      time of one call")
        axes.grid(True, which="major", alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("relative error of the accelerations\n← more accurate")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", bbox_to_anchor=(0.5, 0.04), ncol=len(lines), fontsize=9, frameon=False)
    figure.text(0.01, 0.015, f"{note} Errors are differences from quadruple precision. {table[0]['machine']}.", fontsize=8.5)
    figure.tight_layout(rect=(0, 0.09, 1, 1))
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=run.TOP / "bench/charts")
    parser.add_argument("--bin", type=pathlib.Path, default=run.TOP / "build/release/bin")
    parser.add_argument("--draw", action="store_true")
    words = parser.parse_args()
    if not words.draw:
        with open(words.out / "overview.csv", "w", newline="") as out:
            rows = measure(words.bin.resolve())
            csv.writer(out, lineterminator="\n").writerows([("scene", "line", "dial", "time_us", "error", "machine", "peers"), *rows])
    table = list(csv.DictReader(open(words.out / "overview.csv")))
    titles = {scene: finding(table, scene) for scene in ("humanoid", "ring_8", "corners")}
    draw(table, SOLVES, titles, f"Whole solves, from positions and velocities to accelerations; one core; peers: {table[0]['peers']}.", words.out / "overview.png")
    draw(table, FACTORS, {name: what for name, (what, _) in SCENES.items()}, "K is given, and factored and solved; one core.", words.out / "factorizations.png")


if __name__ == "__main__":
    main()
