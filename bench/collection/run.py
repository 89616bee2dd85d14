#!/usr/bin/env python3
"""Judges solvers of K x = b on the systems of the collection, and writes a page of results.

    run.py --solver NAME... [--systems DIR...] [--out PAGE.md] [--bin DIR]

A solver is

* one of manycontact_collection (`--list` names them): dsysv, dsysv_rook, dsysvx, mumps, mumps_refined, cholmod, ldl, sparse-ldl;
* NAME:DELTA, one of these on K with the damping DELTA; sparse-ldl:DELTA:STEPS, our factor of that, and so many steps of
  refinement on the residual of K as it is;
* manycontact, or manycontact:METHOD, manycontact:PRECISION: `manycontact solve` on the scene of the system;
* peer:PROGRAM:TASK[:DIALS]: manycontact_bench_PROGRAM, where it was built (`./run bench --peers`), on that scene: accelerations alone;
* any program: it is called with K.mtx b.mtx x.txt, writes x into x.txt, a number a line, and prints the time of one solve [us];
* all: everything that is there.

Without --systems: matrices/ beside this file, and build/collection where make.py --large was run.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]
sys.path.append(str(TOP / "src/program/charts"))  # its chart.py comes after that of this folder
import drawing  # noqa: E402

SHOWN = ("humanoid", "two_humanoids")  # before others of their kind
KINDS = ("small", "hostile", "large")
OURS = ("manycontact", "manycontact:dense")
PRECISIONS = ("single", "double", "extended")
DENSE = 2500  # number of unknowns above which dense methods are not run
AT_REST = 1e-4  # accelerations below this part of those without contacts are zero


def read_matrix(path):
    """Returns (rows, columns, values, shape) of a coordinate file; of an array file a vector of long doubles."""
    with open(path) as file:
        kind = file.readline().split()
        while (line := file.readline()).startswith("%"):
            pass
        sizes = [int(n) for n in line.split()]
        words = file.read().split()
    if kind[2] == "array":  # 17 digits identify a double but do not equal it
        return np.array([np.longdouble(w) if len(w) > 30 else np.longdouble(float(w)) for w in words])
    table = np.array(words, dtype=float).reshape(sizes[2], 3)
    return table[:, 0].astype(int) - 1, table[:, 1].astype(int) - 1, table[:, 2].astype(np.longdouble), sizes[0]


class System:
    """A system of the collection: K, b, and x if it is known; products are in extended precision."""

    def __init__(self, folder, name, kind="small", what=""):
        self.folder, self.name, self.kind, self.what = folder, name, kind, what
        self.K, self.b = folder / "island_0.mtx", folder / "island_0_b.mtx"
        self.i, self.j, self.values, self.n = read_matrix(self.K)
        self.rhs = read_matrix(self.b)
        truth = folder / "island_0_x.mtx"
        self.x = read_matrix(truth) if truth.exists() else None
        truth = folder / "island_0_scene_x.mtx"  # K and b not rounded
        self.x_of_scene = read_matrix(truth) if truth.exists() else self.x
        sizes = [line for line in self.K.read_text().splitlines()[:5] if line.startswith("% nv")][0]
        self.nv, self.nc, self.rank = (int(word.split()[-1]) for word in sizes[2:].split(","))

    def product(self, x, values=None):
        values = self.values if values is None else values
        out = np.zeros(self.n, dtype=np.longdouble)
        np.add.at(out, self.i, values * x[self.j])
        off = self.i != self.j
        np.add.at(out, self.j[off], values[off] * x[self.i[off]])
        return out

    def forces_on_joints(self, x):
        """Returns J^T f, which is unique even if f is not."""
        rows = (self.i >= self.nv) & (self.j < self.nv)
        out = np.zeros(self.nv, dtype=np.longdouble)
        np.add.at(out, self.j[rows], self.values[rows] * x[self.i[rows]])
        return out

    def free(self):
        """Returns the accelerations without contacts, M^-1 (tau - h), as a scale."""
        M = np.zeros((self.nv, self.nv))
        inside = (self.i < self.nv) & (self.j < self.nv)
        M[self.i[inside], self.j[inside]] = M[self.j[inside], self.i[inside]] = self.values[inside].astype(float)
        return np.linalg.solve(M, self.rhs[: self.nv].astype(float))


def largest(x):
    return float(np.abs(x).max()) if len(x) else 0.0


def relative(difference, scale):
    return largest(difference) / scale if scale > 0 else largest(difference)


def errors(system, x, of_scene=False):
    """Forward errors of a and f, normwise and componentwise backward error; of a alone where x has no forces. of_scene: of a solver that
    is given the scene, not K and b as they are rounded to doubles."""
    forward = forward_errors(system, x, system.x_of_scene if of_scene else system.x)
    if len(x) == system.nv:
        return (*forward, None, None)
    r = system.rhs - system.product(x)
    terms = system.product(np.abs(x), np.abs(system.values)) + np.abs(system.rhs)
    rows = system.product(np.ones(system.n, dtype=np.longdouble), np.abs(system.values))
    norm = float(rows.max()) * largest(x) + largest(system.rhs)
    normwise = largest(r) / norm
    componentwise = float((np.abs(r) / np.where(terms > 0, terms, 1)).max())
    return (*forward, normwise, componentwise)


def forward_errors(system, x, truth):
    if truth is None:
        return None, None
    nv = system.nv
    scale = largest(truth[:nv])
    if system.nv <= 1000 and scale < AT_REST * largest(free := system.free()):
        scale = largest(free)
    accelerations = relative(x[:nv] - truth[:nv], scale)
    if len(x) == nv:
        return accelerations, None
    if system.rank < system.nc:
        forces = relative(system.forces_on_joints(x - truth), largest(system.forces_on_joints(truth)))
    else:
        forces = relative(x[nv:] - truth[nv:], largest(truth[nv:]))
    return accelerations, forces


def by_manycontact(program, method, system, _):
    """Returns x and the time of one solve of the scene: kinematics, K, its factor, refinement. `method` may be a precision."""
    if method.startswith("dense") and system.n > DENSE:
        raise RuntimeError(f"larger than {DENSE} unknowns")
    command = [program, "solve", "scene.xml", "--json", "-", "--repeat", str(20 if system.n > 500 else 200)] + (["--precision" if method in PRECISIONS else "--method", method] if method else [])
    done = subprocess.run(command, cwd=system.folder, text=True, capture_output=True, timeout=600)
    if not done.stdout:
        raise RuntimeError(done.stderr.strip() or "no answer")
    answer = json.loads(done.stdout)
    report = answer["report"]
    if report["status"] == "failed":
        raise RuntimeError("failed")
    if method in PRECISIONS and report["precision"] != method:
        raise RuntimeError(f"refused in {method}, solved in {report['precision']}")
    by_name = dict(zip(answer["velocity_names"], answer["acceleration"]))
    by_name.update((name, -f) for name, f in zip(answer["force_names"], answer["forces"]))
    names = (system.folder / "island_0_names.txt").read_text().splitlines()
    return np.array([by_name[name] for name in names]).astype(np.longdouble), report["time_us"]["solve"]


def peer_program(bin, name):
    """Returns manycontact_bench_NAME, that of `./run bench --native` if there is one."""
    program = f"manycontact_bench_{name}"
    native = bin.parents[1] / "bench/bin" / program
    return native if native.exists() else bin / program


def by_peer(bin, word, system, folder):
    """Returns another program's accelerations on the scene, and the time of one call of it."""
    _, program, task = word.split(":", 2)
    out = pathlib.Path(folder) / "a.txt"
    command = [peer_program(bin, program), "--scene", "scene.xml", "--task", task, "--out", out]
    done = subprocess.run(command, cwd=system.folder, text=True, capture_output=True, timeout=600)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().split("\n")[-1] or f"ended with {done.returncode}")
    ours = subprocess.run([bin / "manycontact", "solve", "scene.xml", "--json", "-"], cwd=system.folder, text=True, capture_output=True)
    by_name = dict(zip(json.loads(ours.stdout)["velocity_names"], map(float, out.read_text().split())))
    names = (system.folder / "island_0_names.txt").read_text().splitlines()[: system.nv]
    return np.array([by_name[name] for name in names]).astype(np.longdouble), float(done.stdout.split()[-1])


def by_program(command, system, folder):
    out = pathlib.Path(folder) / "x.txt"
    done = subprocess.run(command + [str(system.K), str(system.b), str(out)], text=True, capture_output=True, timeout=600)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().split("\n")[-1] or f"ended with {done.returncode}")
    x = np.array([np.longdouble(w) for w in out.read_text().split()])
    if len(x) != system.n:
        raise RuntimeError(f"{len(x)} numbers, expected {system.n}")
    return x, float(done.stdout.split()[-1])


def versions(bin):
    """Returns {name: version} of manycontact_collection, empty if it was not built."""
    program = bin / "manycontact_collection"
    if not program.exists():
        return {}
    lines = subprocess.run([program, "--list"], text=True, capture_output=True, check=True).stdout.splitlines()
    return dict(line.split(" ", 1) for line in lines)


def solvers(words, bin):
    """Returns {name: (version, call)}; exits if there is no such solver."""
    theirs, ours = versions(bin), bin / "manycontact"
    known = {name: (version, lambda s, t, name=name: by_program([str(bin / "manycontact_collection"), name], s, t)) for name, version in theirs.items()}
    if ours.exists():
        version = subprocess.run([ours, "--version"], text=True, capture_output=True).stdout.strip()
        for name in set(OURS) | {w for w in words if w.startswith("manycontact:")}:
            method = name.partition(":")[2]
            known[name] = (version, lambda s, t, method=method: by_manycontact(str(ours), method, s, t))
    for word in words:
        name, dials = word.split(":")[0], word.split(":")[1:]
        if name == "peer" and dials and peer_program(bin, dials[0]).exists():
            known[word] = ("", lambda s, t, word=word: by_peer(bin, word, s, t))
        if dials and name in theirs:
            known[word] = (theirs[name], lambda s, t, word=word: by_program([str(bin / "manycontact_collection"), word], s, t))
    out = {}
    for word in words:
        if word == "all":
            out.update({name: known[name] for name in [*(n for n in OURS if n in known), *theirs]})
        elif word in known:
            out[word] = known[word]
        elif pathlib.Path(word).is_file():
            out[pathlib.Path(word).name] = ("", lambda s, t, word=word: by_program([str(pathlib.Path(word).resolve())], s, t))
        else:
            sys.exit(f"run.py: no solver '{word}', expected a program, all, or one of {', '.join(known) or 'none: build manycontact_collection'}")
    return out


def judge(system, call, folder, of_scene=False):
    """Returns (errors, time), or the reason why there are none."""
    try:
        x, time = call(system, folder)
    except (RuntimeError, subprocess.TimeoutExpired, OSError) as error:
        return str(error)
    if not np.isfinite(x.astype(float)).all():
        return "not a number"
    return errors(system, x, of_scene), time


def given_the_scene(solver):
    return solver.startswith(("manycontact", "peer"))


def scientific(x):
    return "" if x is None else "0" if x == 0 else f"{x:.0e}"


def digits(x, n=3):
    return f"{x:.0f}" if x >= 10 ** (n - 1) else f"{x:.{n}g}"


def page(results, chosen):
    used = sorted({version for version, _ in chosen.values() if version})
    lines = [
        "# Solvers on the collection",
        "",
        f"Written by `bench/collection/run.py`; {', '.join(used)}; {drawing.machine()},",
        f"one-minute load {os.getloadavg()[0]:.1f} at the end: above 1 the times are those of a machine that does other work, too.",
        "",
        "The errors are those of the accelerations a, relative to the largest, and of the forces f, relative to the largest,",
        "against x in quadruple precision. Where a all but vanishes, its error is relative to the accelerations without contacts.",
        "Where K is singular, f is not unique, and J^T f is judged instead. Backward errors: normwise is",
        "`max |r| / (|K| max |x| + max |b|)` with the largest row sum of K, componentwise `max_i |r_i| / (|K| |x| + |b|)_i`.",
        "Times are medians of the numeric phase, without the analysis of the pattern. Those of manycontact are of a whole `solve`",
        "of the scene: kinematics, bias, assembly of K, factorization, refinement and residuals.",
    ]
    for kind in KINDS:
        of_kind = [s for s in results if s.kind == kind]
        if of_kind:
            lines += ["", f"## {kind.capitalize()}"]
        for system in of_kind:
            lines += ["", f"### {system.name}", "", f"{system.what}; {system.nv} velocities, {system.nc} rows of rank {system.rank}."]
            lines += ["", "| solver | error of a | error of f | normwise | componentwise | time [us] |", "|---|--:|--:|--:|--:|--:|"]
            for name, result in results[system].items():
                if isinstance(result, str):
                    lines.append(f"| {name} | {result.replace('|', '/')} | | | | |")
                else:
                    lines.append(f"| {name} | " + " | ".join(map(scientific, result[0])) + f" | {digits(result[1])} |")
    return "\n".join(lines) + "\n"


def find_systems(folders):
    found = {p.parent for folder in folders for p in folder.rglob("system.json")}
    if not found:
        sys.exit(f"run.py: no systems in {', '.join(map(str, folders))}, expected what make.py writes")
    systems = [System(folder, **json.loads((folder / "system.json").read_text())) for folder in sorted(found)]
    first = {name: k for k, name in enumerate(SHOWN)}
    return sorted(systems, key=lambda s: (KINDS.index(s.kind), first.get(s.name, len(first)), s.n, s.name))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--solver", nargs="+", required=True, metavar="NAME")
    parser.add_argument("--systems", nargs="+", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--out", type=pathlib.Path, help="the page; standard output where it is missing")
    parser.add_argument("--bin", type=pathlib.Path, default=TOP / "build/release/bin", help="where our programs are")
    words = parser.parse_args()
    chosen = solvers(words.solver, words.bin.resolve())
    folders = words.systems or [HERE / "matrices"] + [f for f in [TOP / "build/collection"] if f.exists()]
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for system in find_systems(folders):
            results[system] = {name: judge(system, call, folder, given_the_scene(name)) for name, (_, call) in chosen.items()}
            print(f"run.py: {system.name}", file=sys.stderr)
    text = page(results, chosen)
    if words.out:
        words.out.write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
