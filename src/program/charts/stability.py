"""Draws the charts of `manycontact stability`: drift of the contacts over step sizes, energy errors over steps.

    stability.py DIR

DIR has drift.csv, energy.csv, and stability.json with the other data of the charts.
"""

import csv
import json
import math
import os
import sys

import drawing
from drawing import number, plain, plt

# The axis of constraint violations. Above it a row of marks per gains shows the runs that lost the contacts.
TOP, BOTTOM = 1, 1e-16
COLOURS = ("#555555", "#1f77b4", "#2ca02c", "#d62728", "#000000", "#9467bd")
TITLES = {"rk4": "RK4", "semi-implicit-euler": "semi-implicit Euler"}


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def legend(gains, row):
    if gains == "recommended":
        return "recommended for the step"
    return "no gains" if gains == "none" else f"α = {float(row['alpha']):g}/s², β = {float(row['beta']):g}/s"


def mark_height(choice):
    return TOP * 10 ** (0.4 * (choice + 1))


def draw_curve(axes, rows, colour, mark, **style):
    """Draws a curve through the runs that kept the contacts, and marks the runs that lost the contacts."""
    drift = [float(r["largest_violation_position"]) if not r["stopped"] else TOP for r in rows]
    steps = [float(r["step_s"]) for r in rows]
    axes.plot(steps, [max(d, BOTTOM) if d < TOP else math.nan for d in drift], "o-", markersize=3, color=colour, **style)
    axes.plot([h for h, d in zip(steps, drift) if not d < TOP], [mark for d in drift if not d < TOP], "x", color=colour, markeredgewidth=2)


def draw_drift(scene, time, rows, base):
    integrators, choices = (list(dict.fromkeys(r[of] for r in rows)) for of in ("integrator", "gains"))
    least = min((d for d in (float(r["largest_violation_position"]) for r in rows) if d < TOP), default=TOP)
    lowest, highest = 10.0 ** math.floor(math.log10(max(least, BOTTOM))), mark_height(len(choices))
    figure, panels = plt.subplots(1, 2, figsize=(11, 6.4), sharey=True)
    for axes, integrator in zip(panels, integrators):
        drawing.frame(axes)
        axes.axhline(TOP, color="black", linewidth=1)
        for c, gains in enumerate(choices):
            runs = [r for r in rows if r["integrator"] == integrator and r["gains"] == gains]
            draw_curve(axes, runs, COLOURS[c], mark_height(c), linewidth=3 if gains == "recommended" else 2, label=legend(gains, runs[0]))
            limit = float(runs[0]["largest_stable_step_s"])
            if gains != "recommended" and 5e-4 <= limit <= 0.1:
                axes.axvline(limit, linestyle=":", color=COLOURS[c])
        axes.plot([], [], linestyle=":", color=drawing.GREY, label="predicted limit of gains")
        axes.set_xlim(2e-4, 0.13)
        axes.set_ylim(lowest, highest)
        axes.set_yticks([10.0**k for k in range(round(math.log10(lowest)), 1)])
        axes.text(2.2e-4, mark_height(len(choices) // 2), "beyond 1\nor stopped", va="center")
        axes.set_title(TITLES[integrator])
        axes.set_xlabel("step (s)")
    panels[0].set_ylabel("largest position drift (m, rad)")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncol=3, frameon=False)
    figure.suptitle(plain(f"{scene}: drift of the contacts in {number(time)} s, without torques"))
    figure.subplots_adjust(0.08, 0.24, 0.98, 0.87, 0.06)
    drawing.save(figure, base)


def draw_energy(scene, runs, rows, base):
    figure, axes = plt.subplots(figsize=(9, 6))
    drawing.frame(axes)
    for run in runs:
        bare = run["gains"] == "none"
        points = [(float(r["step"]), float(r["largest_energy_error_J"])) for r in rows if (r["integrator"], r["gains"]) == (run["integrator"], run["gains"])]
        label = TITLES[run["integrator"]] + (", no gains" if bare else ", recommended gains")
        label += f" (stopped after {run['steps']} steps)" if run["stopped"] else ""
        axes.plot(*zip(*([p for p in points if p[1] > 0] or [(math.nan, math.nan)])), linewidth=2, linestyle="--" if bare else "-",
                  color="#1f77b4" if run["integrator"] == "rk4" else "#d62728", label=label)
    kinetic = max([r["largest_kinetic_energy_J"] for r in runs if not r["stopped"]], default=0)
    axes.set_xlim(1, max(2, *(r["steps"] for r in runs)))
    axes.set_xlabel("steps")
    axes.set_ylabel("largest |E − E(0)| so far (J)")
    axes.set_title(plain(f"{scene}: energy error without torques, step {number(runs[0]['step_s'])} s; largest kinetic energy {number(kinetic)} J"), fontsize=10)
    figure.legend(loc="lower center", ncol=2, frameon=False)
    figure.subplots_adjust(0.1, 0.2, 0.97, 0.93)
    drawing.save(figure, base)


def main(folder):
    def there(name):
        return os.path.join(folder, name)

    with open(there("stability.json")) as file:
        written = json.load(file)
    draw_drift(written["scene"], written["drift_time_s"], read(there("drift.csv")), there("drift"))
    energy = read(there("energy.csv"))
    if any(float(r["largest_energy_error_J"]) > 0 for r in energy):
        draw_energy(written["scene"], written["energy_runs"], energy, there("energy"))


if __name__ == "__main__":
    main(*sys.argv[1:])
