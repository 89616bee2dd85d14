"""Writes the page of `manycontact export`.

    export.py DIR

DIR/export.json lists the systems; DIR/README.md explains the files.
"""

import json
import math
import os
import sys

import drawing
from drawing import count, number, printable, scientific

FILES = """| file | contents |
|---|---|
| `island_N.mtx` | K, symmetric, the lower triangle in coordinates |
| `island_N_b.mtx` | b, one column |
| `island_N_x.mtx` | with `--truth`: x, in 34 digits |
| `island_N_scene_x.mtx` | with `--truth`: x of the scene, whose K and b are not rounded to double precision, in 34 digits |
| `island_N_db.mtx` | with `--derivatives`: the right-hand sides of the derivatives, columns [q, v, u], in coordinates |
| `island_N_dx.mtx` | with both: their solutions, in 34 digits |
| `island_N_names.txt` | the name of each row of K: a velocity coordinate, or a constraint row |

    K x = b,   K = [ M  J^T; J  -delta I ],   x = [ a; -f ],   b = [ tau - h; -a0 ]

M is the joint-space inertia, J the Jacobian of the active contacts, delta the damping, a the accelerations, f the contact
forces, tau the torques, h the bias torques, and a0 the acceleration of the constraints at zero joint accelerations. Units
are SI: kg m^2, kg m and kg in M; N m and N in tau, h and f; rad/s^2 and m/s^2 in a and a0. Every contact of the scene has
its own rows, also where rows depend on each other.

* **x** solves the system of the files: their numbers, exactly as written, are the problem. `digits` are the correct decimal
  digits of the worst entry of a, relative to the largest acceleration, and of f, relative to the largest force.
* **Where `rank` is below `nc`**, K is singular up to its rounding errors, and the system of the files has no meaningful
  forces. There x is the solution of the scene itself: the accelerations, and the forces of least norm. K x = b holds up to
  the rounding errors of K and b, if the status is `redundant`; if it is `inconsistent`, x minimises the violation.
* **db** is K dx, where dx = [da; -df] are the derivatives computed in double precision. Entries below the rounding errors of
  that product are zero. dx in the file solves K dx = db for the numbers as written.

| system | nv | nc | rank of J | non-zeros of K | status | condition (1-norm) | x: digits | dx: columns | dx: digits |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|
"""


def digits(known):
    return "unknown" if known is None else number(known)


def row(i):
    of_scene = "of the scene, " if i["x_is_of_the_scene"] and i["digits"] is not None else ""
    cells = (i["name"], i["nv"], i["nc"], i["rank"], i["nonzeros"], i["status"], scientific(math.inf if i["condition"] is None else i["condition"]), of_scene + digits(i["digits"]),
             i["derivative_columns"], digits(i["derivative_digits"]))
    return "| " + " | ".join(map(str, cells)) + " |\n"


def main(folder):
    with open(os.path.join(folder, "export.json")) as file:
        written = json.load(file)
    islands = written["islands"]
    text = f"# {printable(written['scene'])}\n\nWritten by manycontact {written['version']}, `{written['command']}`, from {printable(written['file'])}.\n"
    text += f"{count(written['robots'], 'robot')}, {count(len(islands), 'island')}. Robots that contacts couple are one island, with one system.\n\n"
    drawing.write(os.path.join(folder, "README.md"), text + FILES + "".join(map(row, islands)))


if __name__ == "__main__":
    main(*sys.argv[1:])
