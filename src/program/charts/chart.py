"""Draws the charts of `manycontact chart`, error over time, and writes about them.

    chart.py DIR [FIRST]

DIR/chart.json has the measured numbers; FIRST is the index of the first chart to draw and to describe, by default 0.
"""

import json
import math
import os
import sys
import textwrap

import drawing
from drawing import number, plain, plt, printable, scientific

LEAST, MOST = 1e-17, 1e9  # smaller and larger errors are drawn at these values
BAND = 0.13  # share of a panel's height for the band of failures
ERRORS = ("error_acceleration", "error_forces", "error_derivatives")
PANELS = ("Accelerations", "Contact forces", "Derivatives")
# Okabe and Ito's colours, then Tol's; auto is black.
COLOURS = ("#CC79A7", "#E69F00", "#0072B2", "#009E73", "#D55E00", "#56B4E9", "#882255", "#999933", "#44AA99", "#AA4499")
MARKERS = "o^sDvp"  # one per order; the circle is for methods without an order


# ---- rows ----------------------------------------------------------------------------------------------------------------


def answered(row):
    return row["status"] not in ("failed", "skipped")


def time_of(row, panel):
    """Returns the time that a panel shows: of a solve (0, 1), or of solve and derivatives (2); None: not measured."""
    solve, derivatives = row["time_us"], row["time_derivatives_us"]
    if panel < 2 or solve is None:
        return solve
    return None if derivatives is None else solve + derivatives


def drawn(row, panel):
    """Whether a row has a solution with time and error. The marks of other rows are in the band of failures."""
    return answered(row) and time_of(row, panel) is not None and row[ERRORS[panel]] is not None


def point(row, panel):
    return time_of(row, panel), row[ERRORS[panel]]


def front(rows, panel):
    """Returns the rows that no other row dominates in time and error, sorted by time."""
    found = []
    for row in sorted((r for r in rows if drawn(r, panel)), key=lambda r: point(r, panel)):
        last = point(found[-1], panel) if found else None
        if not found or row[ERRORS[panel]] < last[1] or point(row, panel) == last:
            found.append(row)
    return found


def name_of(row):
    return row["method"] + (f" {row['order']}" if row["order"] else "")


def accurate(chart, row):
    error = row["error_acceleration"]
    return answered(row) and row["time_us"] is not None and error is not None and error <= chart["allowed"]


def winner(chart, panel):
    """Returns the fastest of the accurate rows with the scene's own damping, other than auto."""
    rows = [r for r in chart["rows"] if not r["guessed"] and r["method"] != "auto" and accurate(chart, r) and time_of(r, panel) is not None]
    return min(rows, key=lambda r: time_of(r, panel), default=None)


def auto_of(chart):
    return next((r for r in chart["rows"] if r["method"] == "auto" and not r["guessed"]), None)


# ---- sentences -----------------------------------------------------------------------------------------------------------


def who_wins(chart):
    best, with_derivatives = winner(chart, 0), winner(chart, 2)
    if not best:
        return f"No method is as accurate as allowed ({scientific(chart['allowed'])})."
    text = f"The fastest accurate method is {name_of(best)}: {number(best['time_us'])} us, "
    text += f"error of accelerations {scientific(best['error_acceleration'])}"
    if with_derivatives:
        text += f"; with derivatives {name_of(with_derivatives)}: {number(time_of(with_derivatives, 2))} us"
    for row in chart["rows"]:
        if row["method"] == "dense-schur" and not row["guessed"] and answered(row) and row["time_us"] is not None:
            text += f"; dense-schur, the baseline, takes {number(row['time_us'] / best['time_us'], 2)} times as long"
    return text + "."


def where_auto_lies(chart):
    mine, best, with_derivatives = auto_of(chart), winner(chart, 0), winner(chart, 2)
    if not mine or not answered(mine) or not best:
        return "The method auto has no solution that can be compared."
    text = f"auto ({mine['answered_by']}) takes {number(mine['time_us'])} us, "
    text += f"{number(mine['time_us'] / best['time_us'])} times the time of the fastest accurate method"
    text += f", and is {'' if mine['front'] else 'not '}on the front"
    if with_derivatives and mine["time_derivatives_us"] is not None:
        text += f"; with derivatives auto takes {number(time_of(mine, 2) / time_of(with_derivatives, 2))} times the time "
        text += "of the fastest"
    return text + "."


def median(values):
    return sorted(values)[len(values) // 2]


def what_damping_costs(chart):
    """Returns, for each guessed damping, the median over methods of the errors with it."""
    rows = [r for r in chart["rows"] if r["guessed"] and answered(r)]
    parts = []
    for damping in sorted({r["regularisation"] for r in rows}, key=float):
        a, _, d = ([r[e] for r in rows if r["regularisation"] == damping and r[e] is not None] for e in ERRORS)
        if a:
            parts.append(f"{damping} gives {scientific(median(a))}" + (f" (derivatives {scientific(median(d))})" if d else ""))
    return "A guessed damping costs accuracy, median error of accelerations: " + drawing.join(parts) + "." if parts else ""


def what_fails(chart):
    found = {"Failed": [], "Skipped as too slow or too large, wholly or for derivatives": [], "Less accurate than allowed": []}
    failed, skipped, inaccurate = found.values()
    fallbacks = {}
    for row in chart["rows"]:
        name = name_of(row) + (f" with damping {row['regularisation']}" if row["guessed"] else "")
        if row["status"] == "failed":
            failed.append(name)
        elif row["time_derivatives_us"] is None:
            skipped.append(name)
        if row["guessed"] or not answered(row):
            continue
        if row["error_acceleration"] is not None and not accurate(chart, row):
            inaccurate.append(name)
        if row["fallback"]:
            fallbacks.setdefault(f"A fallback was used, since {row['fallback']}", []).append(name)
    found.update(sorted(fallbacks.items()))
    return " ".join(f"{what}: {drawing.join(names, 6)}." for what, names in found.items() if names) or "No method fails."


def describe(chart):
    sentences = (who_wins(chart), where_auto_lies(chart), what_damping_costs(chart), what_fails(chart), *chart["notes"])
    return [s for s in sentences if s]


# ---- the page ------------------------------------------------------------------------------------------------------------

PAGE = """# Accuracy against speed

Written by `manycontact chart`; the numbers are in [chart.csv](chart.csv). A point is one method, order and
damping. Points to the right are slower than the fastest one. Points further up have a larger error, relative
to a solution of the scene in quadruple precision. A point is on the front if no other point is at least as
fast and as accurate, and better in one of the two; `chart.csv` marks the front of solve time and accelerations.
The times are of {}.

| Scene | fastest accurate | us | auto | us | auto / fastest | auto on the front |
|---|---|--:|---|--:|--:|---|
"""


def page(charts):
    text = PAGE.format(drawing.machine())
    for chart in charts:
        best, mine = winner(chart, 0), auto_of(chart)
        both = best and mine and mine["time_us"] is not None
        text += f"| {printable(chart['scene'])} | {name_of(best) if best else ''} | {number(best['time_us']) if best else ''} | "
        text += f"{mine['answered_by'] if mine else ''} | {number(mine['time_us']) if both else ''} | "
        text += f"{number(mine['time_us'] / best['time_us']) if both else ''} | {'yes' if mine and mine['front'] else 'no'} |\n"
    for chart in charts:
        scene = printable(chart["scene"])
        text += f"\n## {scene}\n\n{chart['title']}.\n\n" + "".join(s + "\n" for s in describe(chart))
        if plt:
            text += f"\n![{scene}]({chart['picture']}.svg)\n"
    return text


# ---- the picture ---------------------------------------------------------------------------------------------------------


def look(row, methods, orders):
    """Returns the mark of a row: its colour is the method, its shape the order, and it is open for a guessed damping."""
    if row["method"] == "auto":
        return {"marker": "o", "markersize": 13, "markeredgewidth": 1 if row["guessed"] else 2.5, "color": "black", "fillstyle": "none"}
    marker = MARKERS[(orders.index(row["order"]) + 1 if row["order"] else 0) % len(MARKERS)]
    colour = COLOURS[methods.index(row["method"]) % len(COLOURS)]
    return {"marker": marker, "markersize": 5.5 if row["guessed"] else 6.5, "markeredgewidth": 1.3, "color": colour,
            "fillstyle": "none" if row["guessed"] else "full"}


def clamped(error):
    return min(max(error, LEAST), MOST)


class Frame:
    """The ranges of a panel, as powers of ten; the band of failures is above `top`."""

    def __init__(self, rows, panel):
        times = [time_of(r, panel) for r in rows if answered(r) and time_of(r, panel) is not None]
        self.fastest = min(times, default=0)
        slower = [math.log10(time_of(r, panel) / self.fastest) for r in rows if self.fastest and time_of(r, panel) is not None]
        errors = [math.log10(clamped(r[ERRORS[panel]])) for r in rows if drawn(r, panel)] or [-16, -10]
        self.band = any(not drawn(r, panel) for r in rows)
        self.bottom = math.floor(min(errors) - 0.3)
        self.top = self.end = max(math.ceil(max(errors) + 0.3), self.bottom + 3)
        if self.band:
            self.end = self.top + BAND / (1 - BAND) * (self.top - self.bottom)
        self.left = min([-0.15, *(s - 0.1 for s in slower)])
        right = max([0.3, *slower])
        self.right = right + 0.24 * (right - self.left)  # space for the names of the dampings

    def in_band(self, fraction):
        return 10 ** (self.top + (self.end - self.top) * (0.15 + 0.7 * fraction))


def set_ticks(axes, f):
    fine = f.right - f.left < 2.2
    x = [10**k * m for k in range(-3, 9) for m in ((1, 2, 5) if fine else (1,)) if f.left <= k + math.log10(m) <= f.right]
    axes.set_xticks(x, [number(at, 2) for at in x])
    y = range(f.bottom, f.top + 1, 2 if f.top - f.bottom > 8 else 1)
    axes.set_yticks([10.0**k for k in y], [f"1e{k}" for k in y])
    axes.minorticks_off()


def write_levels(axes, rows, panel, f):
    """Writes the dampings at the right, at the height of their errors; dampings with close errors share a line."""
    errors = {}
    for row in rows:
        if drawn(row, panel):
            errors.setdefault(row["regularisation"] if row["guessed"] else "as given", []).append(math.log10(clamped(row[ERRORS[panel]])))
    groups = []
    for level, name in sorted((median(e), name) for name, e in errors.items()):
        if not groups or level - groups[-1][-1][0] >= 0.045 * (f.end - f.bottom):
            groups.append([])
        groups[-1].append((level, name))
    for group in groups:
        height = 10 ** (sum(level for level, _ in group) / len(group))
        axes.annotate(", ".join(name for _, name in group), (0.985, height), xycoords=("axes fraction", "data"), textcoords="offset points",
                      xytext=(0, 3), ha="right", color=drawing.GREY, fontsize=8)


def draw_panel(axes, chart, panel, methods, orders):
    rows, f = chart["rows"], Frame(chart["rows"], panel)
    drawing.frame(axes)
    axes.set_xlim(10**f.left, 10**f.right)
    axes.set_ylim(10.0**f.bottom, 10**f.end)
    set_ticks(axes, f)
    axes.set_title(PANELS[panel], loc="left", fontsize=11)
    axes.set_xlabel(("time of solve and derivatives" if panel == 2 else "time of one solve") + " / fastest"
                    + (f"  (1 = {number(f.fastest)} us)" if f.fastest else ""))
    allowed = chart["allowed"] * (10 if panel == 2 else 1)
    if f.bottom < math.log10(allowed) < f.top:
        axes.axhline(allowed, linestyle="--", linewidth=1.2, color="#777777")
    if f.band:
        axes.axhspan(10.0**f.top, 10**f.end, color="#f3e9e9", zorder=0)
        axes.text(0.985, 1.02, "failed, skipped or unknown", transform=axes.transAxes, ha="right", color="#993333", fontsize=8)
    write_levels(axes, rows, panel, f)
    best = [(time / f.fastest, clamped(error)) for time, error in (point(r, panel) for r in front(rows, panel))]
    if best:
        line = [(best[0][0], 10.0**f.top), *best, (10**f.right, best[-1][1])]
        axes.plot(*zip(*line), drawstyle="steps-post", color="#bbbbbb", linewidth=2)
    untimed = 0
    for k, row in enumerate(rows):
        if time_of(row, panel) is not None and f.fastest:
            x = time_of(row, panel) / f.fastest
        else:  # in the band, from the right edge on
            untimed += 1
            x = 10 ** (f.right - 0.02 * untimed * (f.right - f.left))
        y = clamped(row[ERRORS[panel]]) if drawn(row, panel) else f.in_band(k % 7 / 6)
        layer = 3 + 2 * (row["method"] == "auto") + (not row["guessed"])
        axes.plot(x, y, linestyle="none", zorder=layer, **look(row, methods, orders))


def draw_legend(figure, methods, orders):
    axes = figure.add_axes([0.02, 0.01, 0.97, 0.205], xlim=(0, 1), ylim=(0, 4))
    axes.axis("off")

    def entry(x, y, text, **style):
        axes.plot([x - 0.006, x + 0.006] if "linestyle" in style else x, [y, y] if "linestyle" in style else y, **{"linestyle": "none", **style})
        axes.text(x + 0.014, y, text, va="center")

    for y, text in ((3.4, "method"), (2.4, "order"), (1.4, "damping"), (0.4, "lines")):
        axes.text(0, y, text, va="center", color=drawing.GREY)
    apart = min(0.14, 0.88 / (len(methods) + 1))
    for k, method in enumerate([*methods, "auto"]):
        entry(0.12 + apart * k, 3.4, method, **look({"method": method, "order": None, "guessed": False}, methods, orders))
    for k, order in enumerate(["none to choose", *orders]):
        entry(0.12 + 0.14 * k, 2.4, order, marker=MARKERS[k % len(MARKERS)], markersize=8, color="#666666")
    grey = {"marker": "o", "markersize": 8, "color": "#666666"}
    entry(0.12, 1.4, "as given in the scene", **grey)
    entry(0.30, 1.4, "guessed, its value at the right; the error is against the scene as given", fillstyle="none", markeredgewidth=1.5, **grey)
    entry(0.12, 0.4, "Pareto front of the panel", linestyle="-", linewidth=2, color="#bbbbbb")
    entry(0.30, 0.4, "largest error allowed: max(1e-12, 100 eps cond K), derivatives ten times that", linestyle="--", linewidth=1.2, color="#777777")


def draw(chart, base):
    methods = [m for m in dict.fromkeys(r["method"] for r in chart["rows"]) if m != "auto"]
    orders = [o for o in dict.fromkeys(r["order"] for r in chart["rows"]) if o]
    figure = plt.figure(figsize=(15.6, 7))
    figure.text(0.02, 0.955, plain(chart["scene"]), fontsize=13)
    figure.text(0.02, 0.92, plain(f"{chart['title']}; condition of K {scientific(chart['condition'])}"), color=drawing.GREY)
    figure.text(0.99, 0.92, plain(drawing.machine()), color=drawing.GREY, ha="right")
    for panel in range(len(PANELS)):
        draw_panel(figure.add_axes([0.052 + 0.322 * panel, 0.325, 0.272, 0.54]), chart, panel, methods, orders)
    figure.axes[0].set_ylabel("relative error, maximum norm")
    draw_legend(figure, methods, orders)
    drawing.save(figure, base)


def main(folder, first=0):
    with open(os.path.join(folder, "chart.json")) as file:
        written = json.load(file)
    charts = written["charts"]
    for chart in charts:
        chart.update({name: math.inf for name in ("condition", "allowed") if chart[name] is None})
    for chart in charts[int(first):] if plt else ():
        draw(chart, os.path.join(folder, chart["picture"]))
    if written["scenes"] > 1:
        drawing.write(os.path.join(folder, "README.md"), page(charts))
    for chart in charts[int(first):]:
        print(printable(f"{chart['scene']}: {chart['title']}"))
        for sentence in describe(chart):
            print(textwrap.fill(printable(sentence), 100, initial_indent="  ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False))


if __name__ == "__main__":
    main(*sys.argv[1:])
