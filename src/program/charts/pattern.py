"""Draws the picture of `manycontact inspect`: the pattern of K in the scene's order, and of its factor L in the order of elimination.

    pattern.py < FILE.json

The SVG goes to standard output. Cells, of which there are at most MOST a side, have the colour of most of their entries.
"""

import json
import sys

from drawing import count, number, printable

MOST = 400
INERTIA, CONTACT, FILL, DAMPING = range(4)
FILLS = "#2864b4", "#e08214", "#a3a8ae", "#2a9d5c"
SIDE, TOP, LEFT, GAP, STRIP, BOTTOM = 460, 96, 150, 130, 7, 92
RIGHT = LEFT + SIDE + GAP  # left edge of L
WIDTH, HEIGHT = RIGHT + SIDE + 40, TOP + SIDE + BOTTOM
LABEL, LONGEST = 12, 20  # height of a name in the picture, and the most characters of a name


def escaped(text):
    return printable(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def six(x):
    return number(x, 6)


class Grid:
    """A square pattern of n rows, drawn as a grid of cells."""

    def __init__(self, n):
        self.n, self.cells = n, min(n, MOST)
        self.counts = [[0] * (len(FILLS) * self.cells) for _ in range(self.cells)]

    def add(self, row, col, colour):
        self.counts[row * self.cells // self.n][col * self.cells // self.n * len(FILLS) + colour] += 1

    def colours(self, row):
        """Returns the colour of each cell of a row; None: empty."""
        of = len(FILLS)
        parts = (row[k : k + of] for k in range(0, len(row), of))
        return [part.index(max(part)) if any(part) else None for part in parts]

    def draw(self, left):
        paths = [""] * len(FILLS)
        for y, counts in enumerate(self.counts):
            row, x = self.colours(counts), 0
            while x < self.cells:
                colour, first = row[x], x
                while x < self.cells and row[x] == colour:
                    x += 1
                if colour is not None:
                    paths[colour] += f"M{first} {y}h{x - first}v1H{first}z"
        out = f'<g transform="translate({six(left)} {six(TOP)}) scale({six(SIDE / self.cells)})" shape-rendering="crispEdges">\n'
        return out + "".join(f'<path fill="{fill}" d="{path}"/>\n' for fill, path in zip(FILLS, paths)) + "</g>\n"


def columns(matrix):
    """Yields the row and the column of every entry."""
    for col, (begin, end) in enumerate(zip(matrix["begin"], matrix["begin"][1:])):
        for row in matrix["rows"][begin:end]:
            yield row, col


def fill_K(island, pattern, damping, grid):
    """Adds both triangles of K; contact rows have a diagonal only with damping. Returns the number of entries."""
    nonzeros, perm, nv, at = 0, pattern["perm"], pattern["nv"], island["rows"]
    for row, col in columns(pattern["K"]):
        i, j = perm[row], perm[col]
        both = i >= nv and j >= nv
        if both and not damping:
            continue
        colour = DAMPING if both else CONTACT if i >= nv or j >= nv else INERTIA
        grid.add(at[i], at[j], colour)
        if i != j:
            grid.add(at[j], at[i], colour)
        nonzeros += 1 if i == j else 2
    return nonzeros


def fill_L(pattern, damping, offset, grid):
    """Adds an island's L in its elimination order, from row `offset` on. Entries not in K are fill. Returns the number of entries."""
    perm, nv = pattern["perm"], pattern["nv"]
    in_K = set(columns(pattern["K"]))
    for k, i in enumerate(perm):
        grid.add(offset + k, offset + k, INERTIA if i < nv else DAMPING if damping else FILL)
    for row, col in columns(pattern["L"]):
        mixed = (perm[row] >= nv) != (perm[col] >= nv)
        grid.add(offset + row, offset + col, FILL if (col, row) not in in_K else CONTACT if mixed else INERTIA)
    return len(pattern["L"]["rows"]) + len(perm)


def shortened(texts):
    """Leaves out the middles of long names, but not so much that two different names become equal."""
    for widest in range(LONGEST, max(map(len, texts), default=0)):
        back = (widest - 2) // 2
        out = [text if len(text) <= widest else text[: widest - 2 - back] + ".." + text[len(text) - back :] for text in texts]
        if len(set(out)) == len(set(texts)):
            return out
    return texts


def text(x, y, words, anchor, size=12):
    return f'<text x="{six(x)}" y="{six(y)}" text-anchor="{anchor}" font-size="{size}">{escaped(words)}</text>\n'


def line(x1, y1, x2, y2):
    return f'<path d="M{six(x1)} {six(y1)}L{six(x2)} {six(y2)}" stroke="#b8bec6" stroke-width="0.6" fill="none"/>\n'


def box(x, y, width, height, fill):
    return f'<rect x="{six(x)}" y="{six(y)}" width="{six(width)}" height="{six(height)}" fill="{fill}" stroke="#4a5560" stroke-width="0.8"/>\n'


def blocks_of(scene):
    """Yields name, first row and size of the blocks of K: robots (copies combined if names would overlap), then contacts."""
    for robot in scene["robots"]:
        names, nv, first = robot["names"], robot["nv"], robot["first"]
        if SIDE * nv / max(1, scene["nv"]) >= LABEL or len(names) == 1:
            yield from ((name, first + k * nv, nv) for k, name in enumerate(names))
        else:
            yield robot["name"], first, len(names) * nv
    yield from scene["contacts"]


def draw_blocks(scene, n):
    """Returns the names left of the panel, if there is enough space, and lines between the blocks."""
    blocks, out, below = list(blocks_of(scene)), "", -1
    for name, (_, first, size) in zip(shortened([name for name, _, _ in blocks]), blocks):
        top, height = TOP + SIDE * first / n, SIDE * size / n
        middle = top + height / 2
        if first > 0 and height >= 4:
            across = LEFT + SIDE * first / n
            out += line(LEFT, top, LEFT + SIDE, top) + line(across, TOP, across, TOP + SIDE)
        if middle - LABEL / 2 >= below:
            below = middle + LABEL / 2
            out += text(LEFT - STRIP - 6, middle + 4, name, "end", 11)
    return out


def draw_strip(left, contact):
    """Returns a strip next to a panel that shows which rows are velocities and which are contact rows."""
    out, i, n = "", 0, len(contact)
    while i < n:
        first = i
        while i < n and contact[i] == contact[first]:
            i += 1
        height = SIDE * (i - first) / n
        if height >= 0.2:
            fill = FILLS[CONTACT if contact[first] else INERTIA]
            out += f'<rect x="{six(left - STRIP - 2)}" y="{six(TOP + SIDE * first / n)}" width="{STRIP}" height="{six(height)}" fill="{fill}"/>\n'
    return out


def draw_axes(left, n, title, size, column):
    right, middle = left + SIDE, left + SIDE / 2
    out = text(middle, TOP - 38, title, "middle", 14) + text(middle, TOP - 22, size, "middle", 12)
    out += text(left, TOP - 5, "1", "start", 10) + text(right, TOP - 5, str(n), "end", 10)
    out += text(right + 4, TOP + SIDE, str(n), "start", 10) + text(middle, TOP + SIDE + 16, column, "middle", 11)
    return out + f'<text transform="translate({six(right + 14)} {six(TOP + SIDE / 2)}) rotate(90)" text-anchor="middle" font-size="11">row</text>\n'


def draw_legend(scene, cells, n):
    entries = [(INERTIA, "inertia M: robots' velocities"), (CONTACT, "contact rows J"), (FILL, "fill: in L, not in K")]
    entries += [(DAMPING, "damping -delta")] if scene["damping"] else []
    out, left, y = "", LEFT, TOP + SIDE + 44
    for colour, words in entries:
        out += box(left, y - 10, 12, 12, FILLS[colour]) + text(left + 18, y, words, "start", 12)
        left += 32 + 6.6 * len(words)
    if cells < n:
        y += 22
        out += text(LEFT, y, f"a cell represents {number(n / cells)} rows and columns, in the colour of most of its entries; empty where all are zero", "start", 11)
    return out


def panels(scene):
    n, damping, islands = scene["nv"] + scene["nc"], scene["damping"], scene["islands"]
    K, L, entries_of_K, entries_of_L, rows_of_L = Grid(n), Grid(n), 0, 0, []
    for island in islands:
        pattern = scene["patterns"][island["pattern"]]
        entries_of_K += fill_K(island, pattern, damping, K)
        entries_of_L += fill_L(pattern, damping, len(rows_of_L), L)
        rows_of_L += [i >= pattern["nv"] for i in pattern["perm"]]
    orders = {island["order"] for island in islands}
    order = f"{orders.pop()} order" if len(orders) == 1 else "each island in the order chosen for it"
    rows_of_K = [False] * scene["nv"] + [True] * scene["nc"]
    out = box(LEFT, TOP, SIDE, SIDE, "#ffffff") + box(RIGHT, TOP, SIDE, SIDE, "#ffffff") + draw_blocks(scene, n)
    out += K.draw(LEFT) + L.draw(RIGHT) + draw_strip(LEFT, rows_of_K) + draw_strip(RIGHT, rows_of_L)
    out += draw_axes(LEFT, n, "K = [M J'; J -delta I]", f"n = {n}, {count(entries_of_K, 'non-zero')} in both triangles", "column: robots, then contacts")
    out += draw_axes(RIGHT, n, f"L of P K P' = L D L', {order}", f"n = {n}, {count(entries_of_L, 'non-zero')}", "column, as eliminated")
    return out + draw_legend(scene, K.cells, n)


def main():
    scene = json.load(sys.stdin.buffer)
    sizes = f"{count(scene['nv'], 'velocity')}, {count(scene['rows'], 'contact row')}, {count(len(scene['islands']), 'island')}"
    out = f'<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}"'
    out += ' font-family="DejaVu Sans, Helvetica, Arial, sans-serif" fill="#1f2730">\n<rect width="100%" height="100%" fill="#ffffff"/>\n'
    out += text(WIDTH / 2, 30, f"Scene {scene['name']}: {sizes}", "middle", 17)
    sys.stdout.buffer.write((out + (panels(scene) if scene["nv"] + scene["nc"] else "") + "</svg>\n").encode())


if __name__ == "__main__":
    main()
