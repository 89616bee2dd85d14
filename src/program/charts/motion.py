"""Draws the charts of `manycontact optimize`: convergence, torques against limits, contact forces against cones.

    motion.py DIR

DIR/charts.json has the numbers; null is a number that there is not.
"""

import json
import math
import os
import sys

import drawing
from drawing import count, plain, plt

MOST_CURVES = 8
COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#ff7f0e", "#9467bd", "#8c564b", "#17becf", "#7f7f7f")


def numbers(values):
    return [math.nan if y is None else y for y in values]


def largest(values):
    return max((abs(y) for y in values if y is not None), default=0)


def draw_panel(axes, curves, step, ylabel):
    """Draws curves (name, values at nodes) over time."""
    drawing.frame(axes, "linear", "linear")
    for colour, (name, values) in zip(COLOURS, curves):
        axes.plot([k * step for k in range(len(values))], numbers(values), linewidth=2, color=colour, label=plain(name))
    axes.set_xlabel("time (s)")
    axes.set_ylabel(ylabel)


def put_legend(axes, columns):
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=columns, frameon=False, fontsize=8)


def draw_convergence(motion, base):
    iterations = motion["iterations"]
    figure, axes = plt.subplots(figsize=(9, 5.6), constrained_layout=True)
    drawing.frame(axes, "linear", "linear")
    second = axes.twinx()
    second.set_yscale("log")
    second.spines["top"].set_visible(False)
    k = range(len(iterations))
    style = {"linewidth": 2, "markersize": 4}
    axes.plot(k, numbers(i["cost"] for i in iterations), "o-", color=COLOURS[0], label="cost", **style)
    axes.plot([], [], "o-", color=COLOURS[1], label="stopping value", **style)
    axes.plot([], [], "o-", color=COLOURS[2], label="gaps (before the iteration)", **style)
    axes.plot([], [], ":", color=drawing.GREY, label="tolerance")
    second.plot(k, [y if y > 0 else math.nan for y in numbers(i["stop"] for i in iterations)], "o-", color=COLOURS[1], **style)
    second.plot(k, [y if y > 1e-16 else math.nan for y in numbers(i["gaps"] for i in iterations)], "o-", color=COLOURS[2], **style)
    second.axhline(motion["tolerance"], linestyle=":", color=drawing.GREY)
    axes.set_xlim(-0.5, len(iterations) - 0.5)
    axes.set_xlabel("iteration")
    axes.set_ylabel("cost")
    second.set_ylabel("stopping value, gaps")
    axes.set_title(plain(f"{motion['task']}: {motion['reason']} after {count(len(iterations), 'iteration')}"))
    put_legend(axes, 4)
    drawing.save(figure, base)


def draw_torques(motion, base):
    """Draws the largest torques, in units of their limits if any has a limit."""
    torques = motion["torques"]
    limited = any(t["limit"] is not None for t in torques)
    curves = [(t["name"], [100 * u / t["limit"] if limited else u for u in t["values"]]) for t in torques if not limited or (t["limit"] or 0) > 0]
    if not curves:
        return
    figure, axes = plt.subplots(figsize=(9, 5.6), constrained_layout=True)
    draw_panel(axes, sorted(curves, key=lambda c: -largest(c[1]))[:MOST_CURVES], motion["step_s"], "of the limit (%)" if limited else "Nm or N")
    if limited:
        axes.axhline(100, linestyle=":", color="black", label="limits")
        axes.axhline(-100, linestyle=":", color="black")
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -115), max(high, 115))
    axes.set_title(plain(f"{motion['task']}: largest torques"))
    put_legend(axes, 3)
    drawing.save(figure, base)


def with_cones(contacts):
    """Returns the contacts with a friction coefficient, or all contacts if none has a coefficient."""
    return [c for c in contacts if c.get("mu") is not None] or contacts


def draw_forces(motion, base):
    """Draws per contact the normal force, and the ratio of tangential to normal force up to twice the smallest cone."""
    pressing = sorted((c for c in motion["contacts"] if largest(c["normal"]) > 0), key=lambda c: -largest(c["normal"]))
    contacts = pressing[:MOST_CURVES]
    if not contacts:
        return
    figure, (normal, ratio) = plt.subplots(1, 2, figsize=(12, 5.6), constrained_layout=True)
    draw_panel(normal, [(c["name"], c["normal"]) for c in contacts], motion["step_s"], "normal force (N)")
    normal.axhline(0, color="black", linewidth=1)
    ratios = [
        (c["name"], [t / n if n and n > 0 else None for n, t in zip(c["normal"], c["tangential"])])
        for c in with_cones(pressing)[:MOST_CURVES]
    ]
    draw_panel(ratio, ratios, motion["step_s"], "tangential / normal")
    if motion["smallest_mu"] is not None:
        ratio.axhline(motion["smallest_mu"], linestyle=":", color="black", label="smallest cone")
        ratio.set_ylim(0, 2 * motion["smallest_mu"])
    shown = f", the largest {len(contacts)} of {len(pressing)}" if len(contacts) < len(pressing) else ""
    figure.suptitle(plain(f"{motion['task']}: contact forces{shown}"))
    put_legend(normal, 2)
    put_legend(ratio, 2)
    drawing.save(figure, base)


def main(folder):
    with open(os.path.join(folder, "charts.json")) as file:
        motion = json.load(file)
    if motion["iterations"]:
        draw_convergence(motion, os.path.join(folder, "convergence"))
    draw_torques(motion, os.path.join(folder, "torques"))
    draw_forces(motion, os.path.join(folder, "forces"))


if __name__ == "__main__":
    main(*sys.argv[1:])
