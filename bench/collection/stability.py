#!/usr/bin/env python3
"""Draws the charts of the stability page from tests/stability/errors.csv, which `MANYCONTACT_WRITE_PAGE=1 test_stability` writes:

    stability.py [--csv FILE] [--out DIR]

error_over_condition.png: the error of every case against the condition of K, a small multiple for each precision;
error_over_bound.png: the true error of every case in double over the bound that the report states. Python needs numpy and matplotlib.
"""

import argparse
import csv
import pathlib

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

TOP = pathlib.Path(__file__).resolve().parents[2]
LEAST_ERROR, LEAST_RATIO = 1e-18, 1e-10  # smaller values are drawn here
# precision: (colour, unit roundoff of its errors, whether they grow with the condition)
PRECISIONS = {
    "single": ("#D55E00", 2.0**-24, True),
    "double": ("#0072B2", 2.0**-53, True),
    "extended": ("black", 2.0**-53, False),
}


def read(path):
    rows = list(csv.DictReader(open(path)))
    return [{**r, **{k: float(r[k]) for k in ("condition", "error_a", "error_f", "error_over_bound")}} for r in rows]


def frame(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)


def draw_errors(rows, path):
    figure, panels = plt.subplots(2, 2, figsize=(11, 8), sharex=True, sharey=True, dpi=100)
    for axes, (precision, (colour, unit, grows)) in zip(panels.flat, PRECISIONS.items()):
        frame(axes)
        asked = [r for r in rows if r["asked"] == precision]
        for other in (True, False):
            of = [r for r in asked if (r["solved"] != precision) == other]
            errors = [max(r["error_a"], r["error_f"], LEAST_ERROR) for r in of]
            axes.plot([r["condition"] for r in of], errors, "o" if not other else "x", markersize=3 if not other else 4, linestyle="none",
                      color="#999999" if other else colour, alpha=0.6, zorder=2 if other else 3)
        solved = sum(r["solved"] == precision for r in asked)
        others = f", {len(asked) - solved} refused and solved in double" if solved < len(asked) else ""
        axes.set_title(f"{precision}: {solved} cases{others}", fontsize=10, loc="left")
        x = np.array([1, 1e20])
        axes.plot(x, unit * x if grows else unit + 0 * x, "--", color=colour, linewidth=1)
        at = 0.03 / unit if grows else 1e14
        axes.annotate(f"{unit:.0e} × condition" if grows else f"{unit:.0e}, rounding of a double", (at, unit * at if grows else unit),
                      textcoords="offset points", xytext=(4, -3) if grows else (0, 8), fontsize=8, color=colour)
        axes.set_xlim(1, 1e20)
        axes.set_ylim(LEAST_ERROR / 2, 1)
    for axes in panels[:, 0]:
        axes.set_ylabel("relative error of a and f, the larger")
    for axes in panels[1]:
        axes.set_xlabel("condition of K")
    figure.suptitle("Errors of the stability cases over their condition. Grey ×: refused in that precision and solved in double",
                    x=0.02, ha="left", fontsize=11)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def draw_bounds(rows, path):
    asked = [r for r in rows if r["asked"] == "double"]
    ratios = np.array([r["error_over_bound"] for r in asked])
    figure, axes = plt.subplots(figsize=(8, 5), dpi=100)
    frame(axes)
    axes.plot([r["condition"] for r in asked], np.maximum(ratios, LEAST_RATIO), "o", markersize=3, color="#0072B2", alpha=0.5)
    axes.axhline(1, color="black", linewidth=1)
    axes.annotate("1: an error above its bound would be here or higher", (1e20, 1), textcoords="offset points", xytext=(-4, 5), fontsize=8, ha="right")
    some = ratios[ratios > 0]
    for share, name in ((0.5, "half"), (0.05, "95 %")):
        level = float(np.quantile(some, share))
        axes.axhline(level, color="#999999", linewidth=1, linestyle="--")
        axes.annotate(f"{name} of the bounds are less than {1 / level:,.0f} times the error", (1e20, level), textcoords="offset points",
                      xytext=(-4, 7), fontsize=8, ha="right", bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0, "pad": 1})
    axes.set_xlim(1, 1e20)
    axes.set_ylim(LEAST_RATIO / 2, 10)
    axes.set_xlabel("condition of K")
    axes.set_ylabel("true error over its bound, the larger of a and f")
    axes.set_title(f"How tight the bounds are: {len(asked)} stability cases in double", fontsize=11, loc="left")
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=pathlib.Path, default=TOP / "tests/stability/errors.csv")
    parser.add_argument("--out", type=pathlib.Path, default=TOP / "tests/stability")
    words = parser.parse_args()
    rows = read(words.csv)
    draw_errors(rows, words.out / "error_over_condition.png")
    draw_bounds(rows, words.out / "error_over_bound.png")


if __name__ == "__main__":
    main()
