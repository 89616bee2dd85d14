#!/usr/bin/env python3
"""Draws accuracy against time: solvers with their dials (damping, refinement) on the K of a scene, and ours on the scene.

    chart.py [SCENE...] [--out DIR] [--bin DIR]

Without SCENE: all scenes of models/. DIR, by default bench/charts/accuracy, gets accuracy_SCENE.svg, accuracy.csv and a README.md.
Python needs numpy and matplotlib. Solvers of others need manycontact_collection.
"""

import argparse
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker as ticker  # noqa: E402

import run  # noqa: E402

TOP = run.TOP
DAMPINGS = ("1e-12", "1e-10", "1e-8", "1e-6", "1e-4")
STEPS = (0, 1, 2, 3)
ROUNDS = 3
EXACT = 1e-17  # errors are drawn from here on
SOLVE = "manycontact, whole solve, by precision"
# line: (colour, marker, whether it is the whole solve of the scene, label)
OURS, DIAL, THEIRS = "black", "#0072B2", ("#D55E00", "#CC79A7", "#009E73", "#E69F00", "#56B4E9")


def lines():
    """{label: (colour, filled, [(name of a point, solver, damping of the scene)])}"""
    out = {
        SOLVE: (OURS, True, [(p, f"manycontact:{p}", None) for p in run.PRECISIONS]),
        "manycontact, damping of 1e-12 to 1e-4": (OURS, False, [(d, "manycontact", d) for d in DAMPINGS]),
        "manycontact dense, whole solve": ("#777777", True, [("", "manycontact:dense", None)]),
        "our LDL of K, 0 to 3 steps of refinement": (DIAL, True, [(f"{s}", f"sparse-ldl:0:{s}", None) for s in STEPS]),
    }
    for damping, colour in (("1e-8", DIAL), ("1e-5", "#7FB8DE")):
        points = [(f"{s}", f"sparse-ldl:{damping}:{s}", None) for s in STEPS]
        out[f"the same, K damped by {damping} in the factor"] = (colour, False, points)
    for colour, name in zip(THEIRS, ("dsysv", "dsysv_rook", "dsysvx", "mumps")):
        out["MUMPS of K" if name == "mumps" else f"LAPACK's {name} of K"] = (colour, True, [("", name, None)])
    out["CHOLMOD of K, damping of 1e-12 to 1e-4"] = (THEIRS[4], False, [(d, f"cholmod:{d}", None) for d in DAMPINGS])
    return out


def damped_scene(scene, damping, folder):
    """Returns the scene with another damping, its robots' files with absolute paths."""
    text = scene.read_text()
    text = re.sub(r'urdf="([^"]+)"', lambda m: f'urdf="{(scene.parent / m[1]).resolve()}"', text)
    if damping is not None:
        text = re.sub(r' damping="[^"]*"', "", text)
        text = text.replace("<scene", f'<scene damping="{damping}"', 1)
    path = pathlib.Path(folder) / "scene.xml"
    path.write_text(text)


def export(program, scene, folder):
    """Returns the system of the scene's first island, and the number of its islands."""
    damped_scene(scene, None, folder)
    done = subprocess.run([program, "export", "scene.xml", "--out", ".", "--truth"], cwd=folder, text=True, capture_output=True)
    if done.returncode:
        sys.exit(f"chart.py: {scene}: {done.stderr.strip()}")
    return run.System(pathlib.Path(folder), scene.stem), len(list(pathlib.Path(folder).glob("island_*_b.mtx")))


def measure(scene, bin, lines):
    """Rows (line, point, time, error of a, error of f) of a scene, a title, and notes of what has no answer. Every point is measured in each of
    ROUNDS rounds, and its time is the least, so that other work of the machine does not decide."""
    program, times, error, silent = str(bin / "manycontact"), {}, {}, []
    with tempfile.TemporaryDirectory() as folder:
        system, islands = export(program, scene, folder)
        if system.x is None:
            return None
        solvers = run.solvers([s for _, _, points in lines.values() for _, s, _ in points if available(s, bin)], bin)
        points = [(label, *point) for label, (_, _, of) in lines.items() for point in of if point[1] in solvers]
        for _ in range(ROUNDS):
            for label, point, solver, damping in points:
                if (label, point) in silent:
                    continue
                damped_scene(scene, damping, folder)
                result = run.judge(system, solvers[solver][1], folder, run.given_the_scene(solver))
                if isinstance(result, str):
                    silent.append((label, point))
                    print(f"  {scene.stem}, {label} {point}: {result}")
                    continue
                (a, f, _, _), time = result
                times.setdefault((label, point), []).append(time * (1 if run.given_the_scene(solver) else islands))
                error[label, point] = (a, f)
    title = f"{scene.stem}: {system.nv * islands} velocities, {system.nc * islands} contact rows of rank {system.rank * islands}"
    return [(*key, min(of), *error[key]) for key, of in times.items()], title


def available(solver, bin):
    if solver.startswith("peer:"):
        return run.peer_program(bin, solver.split(":")[1]).exists()
    return solver.startswith("manycontact") or solver.split(":")[0] in run.versions(bin)


def draw(found, title, path):
    figure, axes = plt.subplots(figsize=(9.5, 6.2))
    for label, (colour, filled, _) in lines().items():
        points = [(time, max(a, f, EXACT), point) for l, point, time, a, f in found if l == label]
        if not points:
            continue
        times, errors, names = zip(*points)
        size = 11 if label == SOLVE else 7
        axes.plot(times, errors, "-", color=colour, linewidth=1, alpha=0.6, zorder=2)
        axes.plot(times, errors, "*" if size == 11 else "o", color=colour, markerfacecolor=colour if filled else "white",
                  markersize=size * (1.4 if size == 11 else 1), linestyle="none", label=label, zorder=3)
        for time, error, name in points:
            if name and len(points) > 1:
                axes.annotate(name, (time, error), textcoords="offset points", xytext=(5, 4), fontsize=7, color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:g}"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.set_xlabel("time of one solve [us]: farther left is faster")
    axes.set_ylabel("largest relative error of a and f: lower is more accurate")
    axes.set_title(title, fontsize=11)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, frameon=False)
    figure.text(0.01, 0.01, "Errors against quadruple precision. manycontact: kinematics, K, factor and refinement; "
                f"of K: factor and solution of the same K alone. {run.drawing.machine()}.", fontsize=7)
    save(figure, path)


def save(figure, path):
    figure.savefig(path, bbox_inches="tight", **({"metadata": {"Date": None}} if path.suffix == ".svg" else {}))
    plt.close(figure)


PAGE = """# Accuracy against time, with dials

Written by `bench/collection/chart.py`, which `./run chart` calls; the numbers are in [accuracy.csv](accuracy.csv).
Each point is one solver: left is faster, low is more accurate. The error is the largest of accelerations and forces, relative to
the largest of each, against the solution of the scene as given in quadruple precision. Where K is singular, J^T f is compared.

* **manycontact, whole solve**: kinematics, K, its factor, refinement and residuals, in single, double and extended precision where
  the scene can be solved in that (`Options::precision`). **damping**: in double, with a damping of the scene.
* **our LDL of K**: the sparse factor of manycontact on the numbers of K, and steps of refinement on the residual of K. **damped**: the
  factor is that of a damped K; steps of refinement lead to the solution of K itself.
* **LAPACK, MUMPS, CHOLMOD**: factor and solution of the same K. CHOLMOD does not pivot, and needs a damping.

Times are the least of three medians in interleaved rounds. Where a scene has several islands, the times of solvers of K are those of
one island times their number.
"""


def write_page(titles, out):
    text = f"{PAGE}\nThe times are of {run.drawing.machine()}.\n"
    for name, title in titles.items():
        text += f"\n## {name}\n\n![{title}](accuracy_{name}.svg)\n"
    (out / "README.md").write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, metavar="SCENE")
    parser.add_argument("--out", type=pathlib.Path, default=TOP / "bench/charts/accuracy")
    parser.add_argument("--bin", type=pathlib.Path, default=TOP / "build/release/bin")
    words = parser.parse_args()
    words.out.mkdir(parents=True, exist_ok=True)
    matplotlib.rcParams.update({"svg.hashsalt": "manycontact", "svg.fonttype": "none"})
    table, titles = [], {}
    for scene in words.scenes or sorted((TOP / "models").glob("*.xml")):
        measured = measure(scene.resolve(), words.bin.resolve(), lines())
        if measured is None:
            print(f"{scene.stem}: no truth is known, no chart")
            continue
        found, title = measured
        draw(found, title, words.out / f"accuracy_{scene.stem}.svg")
        titles[scene.stem] = title
        table += [(scene.stem, *row[:3], max(row[3:])) for row in found]
        print(f"{scene.stem}: {len(found)} points")
    if table:
        with open(words.out / "accuracy.csv", "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("scene", "line", "dial", "time_us", "error"), *table])
    write_page(titles, words.out)


if __name__ == "__main__":
    main()
