"""lint.py and pages.py find each kind of fault, in a page that has it."""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import lint  # noqa: E402
import pages  # noqa: E402

PAGE = lint.TOP / "src" / "doc" / "performance.md"  # the assumed page of a text


def faults(text):
    names = faults.names = getattr(faults, "names", None) or lint.Names()
    found = [message for at, prose in lint.paragraphs(text) for _, _, message in lint.prose_faults(at, prose)]
    for source in (lint.name_faults(PAGE, text, names), lint.block_faults(text), lint.number_faults(text), lint.anchor_faults(PAGE, text)):
        found += [message for _, message in source]
    return found


FAULTS = {
    "The robot " + "and " * 40 + "ends.": "a sentence of 43 words",
    "* An item " + "and " * 40 + "ends.": "a sentence of",
    "| cell | A cell " + "and " * 40 + "ends. |": "a sentence of",
    "It is solved. Of several robots, one.": "begins with Of",
    "What moves is found.": "begins with Of or What",
    "The rows hold the same.": "'hold'",
    "A factor beside\nthe other.": "'beside'",
    "Robots in SIMD lanes.": "'lanes'",
    "See `manycontact/dynamics/nothing.hpp`.": "is no file that is installed",
    "See `manycontact/kkt/shape.hpp`.": "is no file that is installed",  # private
    "See `tests/doc/nothing.py`.": "is no file",
    "Call `solve_nothing(scene)`.": "nothing is called solve_nothing",
    "Call `manycontact solve SCENE --nothing`.": "there is no --nothing",
    "```\nx\n```": "a block of ''",
    "<!-- not run -->\n```sh\ntrue\n```": "expected not run: WHY",
    "```cpp\nint main() {}\n```": "a C++ program without a name",
    "    ./run build": "a command outside a block of sh",
    "## Fast\n\nIt takes 3 us.": "no command that measures it",
    "See [times](#nothing).": "no heading for #nothing",
}
FINE = """# A page

The robot is at rest. What is an island? It holds: no. `hold` and `beside` are code.

```sh
true
```

It takes 3 us (`./run bench`). See `manycontact/dynamics/solve.hpp`, `solve_batch(scene, Q, V, U, batch)`, [times](#times).
""".replace("It holds: no. ", "")


def check_texts():
    """lint.texts_of joins adjacent literals into one text with separate paragraphs; it skips comments and names of elements."""
    source = 'f("The rows hold"\n  " the same.");  // "the rows hold two"\ng("One push of the scene.\\n\\nOf two robots, one.");\n'
    found = list(lint.texts_of(source))
    return [] if found == ["The rows hold the same.", "One push of the scene.", "Of two robots, one."] else [f"texts: {found}"]


def check_output():
    """pages.difference compares numbers to their digits, excerpts, rounding."""
    same = [("a 1.5\nb", "a 1.5\nb\n"), ("...\nb", "a\nb\n"), ("a\n...", "a\nb\nc\n"), ("x 1e-17", "x -3e-15\n"), ("t 1.500001", "t 1.500002\n")]
    other = [("a 1.5", "a 1.6\n"), ("t 1.50", "t 1.502\n"), ("a", "a\nb\n"), ("a\nb", "a\n"), ("...\nb", "a\n"), ("a 1", "b 1\n"), ("x 1e-3", "x 2e-3\n"), ("a 294.30", "a 294.31\n")]
    wrong = [f"same: {x}" for x in same if pages.difference(*x, False)] + [f"other: {x}" for x in other if not pages.difference(*x, False)]
    if pages.difference("t 12 us", "t 17 us\n", True):
        wrong.append("numbers that vary")
    return wrong


def check_names():
    """lint.none_faults finds names that exist, in tables of two columns alone."""
    text = "| Crocoddyl | here |\n|---|---|\n| `SolverKKT`, `SolverIpopt` | none |\n| `solve` | the same |\n| derivatives | `vjp` | none |\n"
    found = [message for _, message in lint.none_faults(text, {"SolverKKT", "solve"})]
    return [] if len(found) == 1 and "no SolverKKT," in found[0] else [f"rows 'none': {found}"]


def check_thresholds():
    """lint.threshold_faults finds a changed threshold in a page or test, and a number of claims.md that is compared with none."""
    wrong = []
    for file, old, new, expected in (
        ("src/doc/claims.md", "at most 500 times", "at most 100 times", "100, but the test has 500"),
        ("tests/attack/attack_test.cpp", "EXPECT_LE(most, 10000)", "EXPECT_LE(most, 2500)", "10000, but the test has 2500"),
        ("src/doc/claims.md", "| redundant rows cost time |", "| redundant rows cost 3 times |", "3 in 'redundant rows cost 3 times'"),
    ):
        read = lambda name: (lint.TOP / name).read_text().replace(*((old, new) if name == file else ("", "")))  # noqa: B023, E731
        if not any(expected in fault for fault in lint.threshold_faults(read)):
            wrong.append(f"thresholds: {new} is not found")
    return wrong


def check_times():
    """lint.time_faults finds a time, a version and a date that are not those of results.csv, chart_faults a time that differs by more than 25 %."""
    text, results = (lint.TOP / "README.md").read_text(), lint.results()
    version = next(r["version"] for r in results if r["program"] == "Pinocchio")
    date = results[0]["date"].split()[0]
    solve = next(line for line in text.splitlines() if line.startswith("| manycontact solve |"))
    changes = (("", ""), (solve, re.sub(r"\d+", "77", solve, count=1)), (f"Pinocchio {version}", "Pinocchio"), (date, "yesterday"))
    found = [len(set(lint.time_faults("README.md", text.replace(*change), results))) for change in changes]
    us = float(next(r["us"] for r in results if r["name"] == "sweep/ring/8/solve"))
    found += [len(list(lint.chart_faults([("chart.csv", "ring_8", "solve", us * factor)], results))) for factor in (1.1, 1.3)]
    return [] if found == [0, 1, 1, 1, 0, 1] else [f"times: {found}"]


def check_memory():
    """lint.memory_faults finds a size that differs by more than 10 %."""
    page = lint.PERFORMANCE.read_text()
    results = lint.results()
    changed = re.sub(r"\| manycontact \| \d+ \|", "| manycontact | 99 |", page)
    found = [list(lint.memory_faults(text, results)) for text in (page, changed)]
    return [] if found[0] == [] and len(found[1]) == 1 else [f"memory: {found}"]


def check_comments():
    """lint.fragments finds a comment, not a line of one, that begins with a preposition or possessive."""
    source = "int n;  // of rows\n\n// Its size.\nint m;\n// The size\n// of a row.\nint k;  // After a step it is 0.\nint b;\n// by_q: the rows\n"
    found = [line for line, _ in lint.fragments(source)]
    return [] if found == [1, 3] else [f"comments: {found}"]


missed = [f"not found in {text!r}: {expected}, but {faults(text)}" for text, expected in FAULTS.items() if not any(expected in f for f in faults(text))]
missed += [f"found in a good page: {f}" for f in faults(FINE)] + check_output() + check_texts()
missed += check_names() + check_thresholds() + check_times() + check_memory() + check_comments()
print("\n".join(missed) or f"{len(FAULTS)} kinds of faults are found")
sys.exit(1 if missed else 0)
