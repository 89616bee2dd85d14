"""Checks the prose of pages, public headers, messages and docstrings.

    lint.py [--update]      ends with 1 where something is wrong; --update lowers the counts of prose_debts.txt

* Sentences of more than 35 words, private words (below), sentences that begin with "Of" or "What". In headers also files that
  are not installed and constants that do not exist.
* Files, header files, functions, options of the program that are named and do not exist.
* Blocks without a language, commands outside a block, blocks that are not run without a reason.
* Measured numbers (us, ms, s, MB, times) in sections without a command; pages that index.md does not list.
* Members of the status enumerations that statuses.md does not explain, commands without a row in program.md, kinds of findings
  without one in scene_file.md, times and sizes of memory that are not those of bench/results, charts of another day or machine.
* Names in a row "none" that exist here, numbers of claims.md that are not those of the tests.

Comments of headers, messages and docstrings are checked for sentences and words only, and comments of sources for their first
word, against prose_debts.txt, whose counts may only decrease.
"""

import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import pages  # noqa: E402

TOP = pages.TOP
DEBTS = TOP / "tests" / "doc" / "prose_debts.txt"
LONGEST = 35

# Words to avoid: pattern, and the standard term.
WORDS = {
    r"floors?": "layer, module (or: ground)",
    r"lanes?|side by side": "SIMD batch",
    r"rooms?": "workspace, folder",
    r"oracles?": "dense reference solver",
    r"holds?|held|holding": "constrain, fix, contain, be true",
    r"beside|besides": "compared with, relative to, near, in addition to",
    r"stands? (?:in|for|behind|there|before|at|above|below|apart|by)|stood": "is, is fixed to",
    r"says?|said": "state, report, print, specify",
    r"tells?|told": "report, print, list, distinguish",
    r"turning": "rotation, angular",
    r"levers?": "moment arm",
    r"push(?:es)?": "external wrench",
    r"postures?": "configuration",
    r"answers?|answered": "solution, result; solve",
    r"worth": "status and accuracy",
    r"by hand": "standalone, without an action model",
    r"twins?": "counterpart",
    r"drifts?": "bias acceleration, or: constraint violation",
    r"no body has": "violating the triangle inequality",
    r"at hand": "current",
    r"anew": "again, from scratch",
    r"goes on|go on": "continue, fall back to",
    r"creeps?|crawls?": "converge slowly",
    r"alike": "identical, similar",
    r"outer forces": "external forces",
    r"passed limits": "exceeded limits",
    r"one's own": "your own",
    r"likewise": "the fact itself",
}
PRIVATE = {re.compile(rf"(?<![\w'-])(?:{pattern})(?![\w'-])", re.I): instead for pattern, instead in WORDS.items()}
MEASURED = re.compile(r"(?<![\w.])\d[\d.,]*\s*(us|ms|MB|GB|kB|times as (?:long|fast)|times faster|minutes)\b")
COMMAND = re.compile(r"```sh|`(?:\./run|manycontact|build/|python3|ctest|cmake|pip)|\]\([^)]*(?:bench|performance|published)[^)]*\)|gtest_filter|\.ninja_log")
LANGUAGES = {"sh", "python", "cpp", "cmake", "xml", "text", "py", "json"}
EVIDENCE = ("README.md", "performance.md", "methods.md", "problems.md", "published.md", "mathematics.md", "task_file.md", "program.md")


# ---- text --------------------------------------------------------------------------------------------------------------


def paragraphs(text):
    """[(line, text)] of a page's prose: paragraphs, items of lists, cells of tables."""
    found, current, start, fenced = [], [], 0, False
    for number, line in enumerate([*text.split("\n"), ""], 1):
        bare = line.strip()
        if bare.startswith("```"):
            fenced = not fenced
            bare = ""
        elif fenced:
            continue
        item = re.match(r"([*-]|\d+\.) ", bare)
        table = bare.startswith("|")
        aside = bare.startswith(("#", "<!--", "![")) or (line.startswith("    ") and not current and not item)
        if not bare or item or table or aside:
            if current:
                found.append((start, " ".join(current)))
            current = []
        if table:
            found += [(number, cell) for cell in re.split(r"(?<!\\)\|", bare) if cell.strip(" -:")]
        elif bare and not aside:
            start = start if current else number
            current.append(bare[item.end() :] if item else bare)
    return found


def plain(text):
    """Prose without code, links and pictures."""
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "`", text)
    return re.sub(r"https?://\S+", "", text)


def sentences(text):
    return [s for s in re.split(r"(?<=[.!?])[*_]*\s+(?=[A-Z`*\"(])", plain(text)) if s.strip()]


def words(sentence):
    return len(re.findall(r"[\w`][\w`'/^.-]*", sentence))


def prose_faults(line, text):
    for sentence in sentences(text):
        if (count := words(sentence)) > LONGEST:
            yield line, "long", f"a sentence of {count} words: {sentence[:70]}..."
        if re.match(r"(Of|What)\b", sentence) and not sentence.rstrip().endswith(("?", ":")):
            yield line, "fragment", f"begins with Of or What: {sentence[:70]}"
        for pattern, instead in PRIVATE.items():
            for hit in pattern.findall(sentence):
                yield line, "word", f"'{hit}', better: {instead}: {sentence[:90]}"


# ---- names -------------------------------------------------------------------------------------------------------------


def tracked():
    git = ["git", "-C", TOP, "ls-files", "-co", "--exclude-standard"]
    listed = subprocess.run(git, capture_output=True, text=True).stdout if shutil.which("git") else ""
    files = [TOP / f for f in listed.split("\n") if f] or [f for f in TOP.rglob("*") if "build" not in f.parts]
    return [f for f in files if f.is_file()]


class Names:
    def __init__(self):
        self.files = {str(f.relative_to(TOP)) for f in tracked()}
        self.installed = {"include/" + x.strip("* \n") for x in open(TOP / "tests" / "installed_headers.txt")}
        code = [f for f in tracked() if f.suffix in (".hpp", ".cpp", ".py", ".cmake", ".xsd", ".in", ".sh", ".urdf", ".xml") or f.name in ("run", "CMakeLists.txt")]
        code = [f for f in code if f.parent != pathlib.Path(__file__).resolve().parent]
        self.words = set()
        headers = "".join(re.sub(r"//.*", "", f.read_text()) for f in (TOP / "include").rglob("*.hpp"))
        self.constants = set(re.findall(r"\bk[A-Z]\w+", headers))
        self.public = set(re.findall(r"\w+", headers))
        self.options = set()
        for file in code:
            text = file.read_text(errors="replace")
            self.words |= set(re.findall(r"\w+", text))
            self.options |= set(re.findall(r"--[a-z][a-z_-]*", text))

    def file_exists(self, page, name, user):
        written = re.findall(r"`([\w./-]+)`:\s*$|--(?:\w+) ([\w./-]+)|[>] ([\w./]+)|\"([\w./-]+)\"", page.read_text(), re.M)
        if name in {x for group in written for x in group} or "*" in name or name.isupper():
            return True
        if name.endswith(".hpp"):
            return any(f"{root}{name}" in self.files for root in ("include/", "include/manycontact/", *(() if user else (*(f"src/{folder}/private/{name}" for folder in ("core", "tools", "optimal_control") for name in ("", "manycontact/")), "", "src/", "src/core/", "src/tools/", "src/optimal_control/", "sparse/private/", "sparse/"))))\
                or name in ("manycontact/version.hpp", "manycontact/action/tpl.hpp") or (not user and any(f.endswith("/" + name) for f in self.files))
        roots = ("", "src/", "src/core/", "src/tools/", "src/optimal_control/", "models/", str(page.parent.relative_to(TOP)) + "/")
        return any(root + name in self.files for root in roots) or (not user and any(f.endswith("/" + name) for f in self.files))


FILE = re.compile(r"^[\w./-]*\w\.(?:hpp|cpp|md|urdf|py|xsd|cmake|sh|xml|png|txt)$")
FOREIGN = {"src/doc/coming_from.md", "src/doc/problems.md", "src/doc/published.md", "src/doc/howto/real_robots.md", "src/doc/howto/xacro.md"}


def name_faults(page, text, names):
    where = str(page.relative_to(TOP))
    user = not re.search(r"contributing/|CONTRIBUTING|SECURITY|sparse/|lq/", where)
    for line, prose in paragraphs(text):
        for code in re.findall(r"`([^`]+)`", prose):
            if FILE.match(code) and not code.startswith(("http", "my_", "build/")) and not re.match(r"[A-Z_]+\.", code):
                if where not in FOREIGN and not names.file_exists(page, code, user):
                    yield line, f"`{code}` is no file" + (" that is installed" if code.endswith(".hpp") else "")
            call = re.fullmatch(r"(?:\w+\.)*(\w+)\(.*\)", code) or re.fullmatch(r"(?:\w+::|\w+\.)*(\w*[a-z]_\w+|[A-Z][a-z]+[A-Z]\w+)", code)
            if call and where not in FOREIGN and call[1] not in names.words and call[1] not in text.replace(f"`{code}`", ""):
                yield line, f"`{code}`: nothing is called {call[1]}"
            if code.startswith(("manycontact ", "--")):
                for option in re.findall(r"--[a-z][a-z_-]*", code):
                    if option not in names.options:
                        yield line, f"`{code}`: there is no {option}"


# ---- pages -------------------------------------------------------------------------------------------------------------


def block_faults(text):
    blocks = pages.blocks_of(text)
    for block in blocks:
        if block.language not in LANGUAGES:
            yield block.first + 1, f"a block of '{block.language}', expected one of {', '.join(sorted(LANGUAGES))}"
        for mark in block.marks:
            if not re.match(r"(not run: \w|needs: \w|numbers vary$)", mark):
                yield block.first, f"<!-- {mark} -->, expected not run: WHY, needs: MODULE or numbers vary"
        if block.language == "cpp" and not block.name:
            yield block.first + 1, "a C++ program without a name, which nothing compiles: end the sentence before it with `NAME.cpp`:"
    fenced = False
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip().startswith("```"):
            fenced = not fenced
        elif not fenced and re.match(r"    (\./run|build/|manycontact |cmake |pip |python3? |mpirun |chromium )", line):
            yield number, f"a command outside a block of sh, which nothing runs: {line.strip()[:60]}"


def number_faults(text):
    for section in re.split(r"(?m)^(?=## )", text):
        if hit := MEASURED.search(plain(re.sub(r"(?s)```.*?```", "", section))):
            if not COMMAND.search(section):
                at = text[: text.index(section)].count("\n") + 1
                yield at, f"'{hit[0]}' in a section that shows no command that measures it"


def anchors(text):
    """Returns the anchors of a page's headings, as GitHub names them."""
    headings = re.findall(r"(?m)^#+ (.*)$", re.sub(r"(?s)```.*?```", "", text))
    return {re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings}


def anchor_faults(page, text):
    for target, anchor in re.findall(r"\]\(([\w./-]*)#([\w-]+)\)", text):
        other = (page.parent / target).resolve() if target else page
        if other.exists() and anchor not in anchors(other.read_text()):
            yield text[: text.index(f"#{anchor})")].count("\n") + 1, f"{other.name} has no heading for #{anchor}"


def enumerators(name):
    """Returns the members of `enum class NAME` in the installed headers."""
    for header in (TOP / "include").rglob("*.hpp"):
        if found := re.search(rf"enum class {name} {{(.*?)}};", header.read_text(), re.S):
            return re.findall(r"\bk[A-Z]\w+", re.sub(r"//.*", "", found[1]))
    return []


def page_faults(page, names):
    text = page.read_text()
    where = page.relative_to(TOP)
    found = [(line, message) for at, prose in paragraphs(text) for line, _, message in prose_faults(at, prose)]
    found += name_faults(page, text, names)
    found += block_faults(text)
    found += anchor_faults(page, text)
    found += none_faults(text, names.public)
    if page.name in EVIDENCE or "howto" in where.parts:
        found += number_faults(text)
    return [f"{where}:{line}: {message}" for line, message in found]


def set_faults():
    """Returns the faults of the pages as a whole."""
    index = (TOP / "src" / "doc" / "index.md").read_text()
    for page in pages.pages():
        name = page.relative_to(TOP)
        link = os.path.relpath(page, TOP / "src" / "doc")
        if str(name) not in ("src/doc/index.md", "README.md") and f"]({link})" not in index:
            yield f"src/doc/index.md: no link to {name}"
    statuses = (TOP / "src" / "doc" / "statuses.md").read_text()
    for enum in ("Reason", "StepStatus", "StopReason"):
        members = enumerators(enum)
        if not members:
            yield f"no enumeration {enum} in include"
        for member in members:
            if f"`{member}`" not in statuses and not (enum == "StopReason" and member == "kNone"):
                yield f"src/doc/statuses.md: {enum}::{member} is not explained"
    sources = "".join(f.read_text() for d in ("io", "analysis") for f in (TOP / "src/tools" / d).glob("*.cpp"))
    kinds = set(re.findall(r'\btell\((?:\*?\w+, )?"([a-z_]+)"|', sources)) | set(re.findall(r'\{"([a-z_]+)", (?:scene\.)?name\b', sources))
    kinds.discard("")
    if len(kinds) < 8:
        yield f"only the kinds {kinds} of findings are found in the sources: has the way they are written changed?"
    scene_file = (TOP / "src" / "doc" / "scene_file.md").read_text()
    rows = " ".join(re.findall(r"(?m)^\| (.*?) \|", scene_file.partition("### How a URDF is read")[2].partition("\n## ")[0]))
    for kind in kinds:
        if f"`{kind}`" not in rows:
            yield f"src/doc/scene_file.md: no row on findings of kind {kind}"
    program = (TOP / "src" / "doc" / "program.md").read_text()
    for command in (f.name for top in ("src/program", "src/optimal_control/program") for f in (TOP / top).iterdir() if f.name != "command" and (f / f"{f.name}.cpp").exists()):
        if f"\n| `{command} " not in program:
            yield f"src/doc/program.md: no chapter on {command}"


def none_faults(text, public):
    """Returns names of another library whose row says that there is none here, and which exist."""
    for number, line in enumerate(text.split("\n"), 1):
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 2 and re.match(r"none\b", cells[1]):
            for name in re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", cells[0]))):
                if name in public:
                    yield number, f"the row states that there is no {name}, which is in include"


# What the pages quote: the page, its number in the text, the file of the tests, its number in the code.
THRESHOLDS = (
    ("src/doc/claims.md", r"at the median at most (\d[\d.e+-]*) times the error", "tests/attack/attack_test.cpp", r"EXPECT_LE\(median, (\d[\d.e+-]*)\)"),
    ("src/doc/claims.md", r"and (\d[\d.e+-]*) % of them at most", "tests/attack/attack_test.cpp", r"(\d+) % below"),
    ("src/doc/claims.md", r"% of them at most (\d[\d.e+-]*) times", "tests/attack/attack_test.cpp", r"EXPECT_LE\(most, (\d[\d.e+-]*)\)"),
    ("src/doc/claims.md", r"right to (\d[\d.e+-]*) eps", "tests/stability/extended_test.cpp", r"EXPECT_LE\(error, (\d[\d.e+-]*) \* kEps\)"),
    ("src/doc/claims.md", r"up to a condition of (\d[\d.e+-]*)", "tests/stability/judge.hpp", r"kTrueCondition = (\d[\d.e+-]*);"),
    ("src/doc/claims.md", r"good status in (\d[\d.e+-]*) difficult cases", "tests/stability/README.md", r"(?m)^(\d+) cases, by the columns"),
    ("src/doc/claims.md", r"constraints are met to (\d[\d.e+-]*)", "tests/task/constraints_test.cpp", r"EXPECT_LE\(s\.constraint_violation, (\d[\d.e+-]*)\)"),
    ("src/doc/methods.md", r"are below (\d[\d.e+-]*) eps, relative", "tests/stability/extended_test.cpp", r"EXPECT_LE\(error, (\d[\d.e+-]*) \* kEps\)"),
    ("src/doc/mathematics.md", r"max\((\d[\d.e+-]*), 100 eps", "src/program/chart/rows.cpp", r"allowed = std::max\((\d[\d.e+-]*), 100 \*"),
)


def threshold_faults(read=lambda name: (TOP / name).read_text()):
    """Returns thresholds of pages that differ from those of the tests, and numbers of claims.md that are compared with none."""
    compared = set()
    for page, quoted, file, code in THRESHOLDS:
        shown, tested = re.search(quoted, read(page)), re.search(code, read(file))
        if not shown or not tested:
            yield f"{page if not shown else file}: nothing matches {quoted if not shown else code}: correct THRESHOLDS"
            continue
        compared.add((page, shown[1]))
        if float(shown[1]) != float(tested[1]):
            yield f"{page}: {shown[1]}, but the test has {tested[1]} ({file})"
    for row in re.findall(r"(?m)^\| (.*?) \|", read("src/doc/claims.md")):
        for number in re.findall(r"(?<![\w`/.])\d[\d.e-]*\b", row):
            if ("src/doc/claims.md", number) not in compared:
                yield f"src/doc/claims.md: {number} in '{row}' is compared with no constant of a test (THRESHOLDS)"


PERFORMANCE = TOP / "src" / "doc" / "performance.md"


def results():
    """The rows of the last ./run bench."""
    return list(csv.DictReader(open(TOP / "bench" / "results" / "results.csv")))


# Rows of the tables of times: program and task. "native" in a label, or a second number in a cell, is of the program's native build.
TIMED = {
    "manycontact solve": ("manycontact", "solve"),
    "manycontact `vjp`, after a solve": ("manycontact", "vjp"),
    "manycontact derivatives, after a solve": ("manycontact", "derivatives"),
    "Pinocchio `constraintDynamics`, one iteration": ("Pinocchio", "constraintDynamics"),
    "Pinocchio `constraintDynamics`, three iterations": ("Pinocchio", "constraintDynamics iterated"),
    "Pinocchio `constrainedABA`": ("Pinocchio", "constrainedABA"),
    "Pinocchio derivatives": ("Pinocchio", "derivatives"),
    "Crocoddyl `calc`": ("Crocoddyl", "calc"),
    "Crocoddyl `calcDiff`": ("Crocoddyl", "derivatives"),
    "MuJoCo `mj_forward`, soft contacts": ("MuJoCo", "mj_forward"),
    "Simbody `realize`": ("Simbody", "realize"),
    "DART `step`": ("DART", "step"),
}
# Times in the text: the page, the number, its program and name in results.csv, and by how much it is divided.
QUOTED = (
    ("README.md", r"20 nodes takes ([\d.]+) ms here", "manycontact", "sweep/one/1/FDDP", 1000),
    ("README.md", r"here, ([\d.]+) ms with Crocoddyl", "Crocoddyl", "sweep/one/1/FDDP", 1000),
    ("README.md", r"and ([\d.]+) ms with its native build", "Crocoddyl native", "sweep/one/1/FDDP", 1000),
)


def time_faults(page, text, results):
    """Returns times of a page's table and text that are not those of results.csv, rounded, and a missing date, processor or version."""
    times = {(row["program"], row["name"]): float(row["us"]) for row in results}
    versions = {row["program"]: row["version"] for row in results}

    def wrong(shown, program, name, divisor):
        us = times.get((program, name), float("inf")) / divisor
        if abs(us - float(shown)) > 0.5001 * 10.0 ** -len(shown.partition(".")[2]):
            yield f"{page}: {shown} is not the time of {program} {name} in results.csv, {us:.4g}"

    heads, _, *rows = (re.split(r" *\| *", line)[1:-1] for line in re.search(r"(?m)(^\| us per robot.*\n)(^\|.*\n)+", text)[0].splitlines())
    for label, *cells in rows:
        label, native, _ = label.partition(", native")
        if label not in TIMED:
            yield f"{page}: no program and task is known of the row {label} (TIMED)"
            continue
        program, task = TIMED[label]
        for head, cell in zip(heads[1:], cells):
            size = 1 if "one by one" in cell else int(re.search(r"\d+", head)[0])
            scene = re.search(r"ring|points|$", head)[0] or "separate"
            for shown, build in zip(re.findall(r"[\d.]+", cell), (" native",) if native else ("", " native")):
                yield from wrong(shown, program + build, f"sweep/{scene}/{size}/{task}", 1 if scene == "points" else size)
        if f"{program} {versions.get(program)}" not in " ".join(text.split()):
            yield f"{page}: the version of {program} is missing"
    for where, pattern, *of in QUOTED:
        if where == page and (found := re.search(pattern, text)):
            yield from wrong(found[1], *of)
        elif where == page:
            yield f"{page}: nothing matches {pattern}: correct QUOTED"
    for known in (results[0]["processor"], results[0]["date"].split()[0]):
        if known not in text:
            yield f"{page}: the table's {known} is missing"


# Scenes of the charts and of the table of rooflines that ./run bench times too.
CHARTED = {
    "humanoid_standing": "separate/1",
    "ring_of_humanoids": "ring/16",
    "humanoid": "separate/1",
    "ring_8": "ring/8",
    "corners": "points/8",
    "1 robot": "separate/1",
    "256 robots": "separate/256",
    "ring of 1,024": "ring/1024",
}


def chart_faults(charts, results):
    """Returns times (where, scene, task, us) that differ by more than 25 % from those of results.csv."""
    times = {row["name"]: float(row["us"]) for row in results if row["program"] == "manycontact"}
    for where, scene, task, us in charts:
        expected = times[f"sweep/{CHARTED[scene]}/{task}"]
        if not 0.8 <= float(us) / expected <= 1.25:
            yield f"{where}: {task} takes {us} us for {scene}, {expected:.4g} in results.csv"


def pile_faults(page, measured):
    """Returns times of the table of piles that are not those of npm_piles.json, to three digits, and a missing date or version."""
    results = {(row["program"], row["scene"]): row for row in measured["results"]}
    section = page.partition("## Piles in game")[2].partition("\n## ")[0]
    columns = [(program, "step_us") for program in ("@dimforge/rapier3d-compat", "jolt-physics", "@mujoco/mujoco", "manycontact")]
    columns.append(("manycontact", "solve_us"))
    for scene, *cells in re.findall(r"(?m)^\| (\w+ \d+) " + r"\| ([\d.]+) " * len(columns) + r"\|$", section):
        for cell, (program, key) in zip(cells, columns):
            us = results[program, scene][key]
            if abs(float(cell) / us - 1) > 0.0051:
                yield f"src/doc/performance.md: {cell} is not the time of {program}, {scene} in npm_piles.json, {us}"
    for known in (measured["date"], measured["node"][1:], *(row["version"] for row in results.values())):
        if known not in section:
            yield f"src/doc/performance.md: {known} of npm_piles.json is missing"


def measured_faults():
    found, known = [], results()
    for page in ("README.md", "src/doc/performance.md"):
        found += time_faults(page, (TOP / page).read_text(), known)
    folder = TOP / "bench" / "charts"
    rooflines = PERFORMANCE.read_text().partition("## Rooflines")[2].partition("\n## ")[0]
    charts = [("performance.md", *row) for row in re.findall(r"(?m)^\| ([^|]*), (\w+) \| ([\d.e+]+) \|", rooflines)]
    for file, ours in (("chart.csv", ("auto", "none", "none")), ("overview.csv", ("manycontact", "double"))):
        for scene, *row in csv.reader(open(folder / file)):
            if tuple(row[: len(ours)]) == ours and scene in CHARTED:
                charts.append((file, scene, "solve", row[4] if file == "chart.csv" else row[2]))
    found += chart_faults(charts, known)
    found += pile_faults(PERFORMANCE.read_text(), json.loads((TOP / "bench/results/npm_piles.json").read_text()))
    machine = f"{known[0]['processor']}, {known[0]['date'].split()[0]}"
    for file in ("README.md", "overview.csv"):
        if machine not in (folder / file).read_text():
            found.append(f"bench/charts/{file} is not of {machine}, as bench/results")
    return [*found, *memory_faults(PERFORMANCE.read_text(), known)]


def memory_faults(page, results):
    """Returns numbers of the table of memory of performance.md that differ by more than 10 % from those of results.csv."""
    table = page.partition("| kB per robot |")[2].partition("\n\n")[0]
    sizes = {(row["program"], row["name"]): float(row["bytes"]) for row in results if row["bytes"]}
    heads = [head.strip() for head in table.partition("\n")[0].split("|")[:-1]]
    for program, call in (("manycontact", "solve"), ("MuJoCo", "mj_forward"), ("Pinocchio", "constraintDynamics")):
        found = re.search(rf"(?m)^\| {program} \|(.*)\|$", table)
        if not found:
            yield f"src/doc/performance.md: no row of the memory of {program}"
            continue
        for head, cell in zip(heads, found[1].split("|")):
            count = int(head.split()[-1])
            bytes_ = sizes.get((program, f"sweep/{'ring' if head.startswith('ring') else 'separate'}/{count}/{call}"))
            if cell.strip() and not (bytes_ and abs(float(cell) * 1000 * count / bytes_ - 1) < 0.1):
                yield f"src/doc/performance.md: {cell.strip()} kB of {program} for {head} is not that of results.csv"


# ---- headers -----------------------------------------------------------------------------------------------------------


def header_debts(header, names):
    """Returns {kind: count} of faults in a header's comments."""
    counts, comment = {}, []
    comments = "\n".join(re.findall(r"(?m)(?<![:\"])//(.*)$", header.read_text()))
    files = {f for f in re.findall(r"[\w/]+\.(?:hpp|cpp|md)\b", comments)}
    wrong = [f for f in files if not any(r + f in names.files for r in ("include/", "include/manycontact/", f"{header.parent.relative_to(TOP)}/"))]
    counts["file"] = len(wrong)
    counts["constant"] = len({k for k in re.findall(r"\bk[A-Z]\w+", comments) if k not in names.constants})
    for line in [*header.read_text().split("\n"), ""]:
        found = re.search(r"(?<![:\"])//[/<!]*\s?(.*)", line)
        text = found[1] if found else None
        own = found and not line[: found.start()].strip()
        if text is None or (comment and not own) or not text.strip() or text.startswith(("    ", "- ")):
            for _, kind, _ in prose_faults(0, " ".join(comment)):
                counts[kind] = counts.get(kind, 0) + 1
            comment = []
        if text and text.strip() and not text.startswith("    "):
            comment.append(text.strip())
    return counts


# Names of elements and files, which messages and docstrings are about.
NAMED = {"push", "pushes", "drift"}


def texts_of(source):
    """Messages and docstrings: adjacent string literals of at least three words, or that continue others, by paragraphs."""
    code = re.sub(r'(?m)(?<![:"])//.*$', "", source)
    for run in re.findall(r'((?:"(?:[^"\\\n]|\\.)*"\s*)+)', code):
        text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', run)).replace("\\n", "\n")
        yield from (" ".join(part.split()) for part in re.split(r"\n\s*\n|\n *-+\n|\n(?=\w+(?:, \w+)* : )|:\n", text) if len(part.split()) > 2 or text[:1] == " ")


def text_debts(source):
    counts = {}
    for text in texts_of(source.read_text()):
        for _, kind, fault in prose_faults(0, text):
            if not (kind == "word" and fault.split("'")[1].lower() in NAMED):
                counts[kind] = counts.get(kind, 0) + 1
    return counts


# A comment's first word makes it a fragment if it is a preposition or a possessive. "After a step the data are ..." is a sentence.
FRAGMENT = re.compile(
    r"(?:[Oo]f|[Bb]y|[Pp]er|[Ii]ts|[Tt]heir|[Ww]hose|[Tt]han|[Aa]s|[Aa]bout|[Bb]ehind|[Bb]etween|[Ll]ike|[Aa]long|"
    r"in|on|at|for|from|with|without|over|under|into|until|after|before)\b(?![_(])"
)


def fragments(source):
    """[(line, comment)] of comments that begin with a preposition or a possessive."""
    found, continued = [], False
    for number, line in enumerate(source.split("\n"), 1):
        comment = re.search(r"(?<![:\"])//[/<!]*\s?(.*)", line)
        own = comment and not line[: comment.start()].strip()
        if comment and not (continued and own) and FRAGMENT.match(comment[1]):
            found.append((number, comment[1]))
        continued = bool(comment)
    return found


def header_faults(update, names):
    known = {}
    for line in DEBTS.read_text().split("\n") if DEBTS.exists() else []:
        if line and not line.startswith("#"):
            name, *counts = line.split()
            known[name] = {k: int(v) for k, v in (c.split("=") for c in counts)}
    now = {str(h.relative_to(TOP)): header_debts(h, names) for h in sorted((TOP / "include").rglob("*.hpp"))}
    sources = [f for f in tracked() if f.suffix in (".cpp", ".hpp") and f.relative_to(TOP).parts[0] in ("src", "sparse")]
    for file in sorted(sources):
        counts = text_debts(file)
        if begin := fragments(file.read_text()):
            counts["begins"] = len(begin)
        now[str(file.relative_to(TOP))] = counts
    if update:
        lowered = {n: {k: min(v, known.get(n, {}).get(k, 0)) if known else v for k, v in c.items()} for n, c in now.items()}
        lines = [" ".join([n, *(f"{k}={v}" for k, v in sorted(c.items()) if v)]) for n, c in lowered.items() if any(c.values())]
        DEBTS.write_text("# Faults of prose in public headers, messages and docstrings, by lint.py --update. Counts may only decrease.\n" + "\n".join(lines) + "\n")
        known = lowered
    for name, counts in now.items():
        for kind, count in counts.items():
            if count > known.get(name, {}).get(kind, 0):
                yield f"{name}: {count} faults of kind {kind}, {known.get(name, {}).get(kind, 0)} allowed by prose_debts.txt"
                if kind == "begins":
                    yield from (f"{name}:{line}: // {comment}" for line, comment in fragments((TOP / name).read_text()))


def main():
    update = "--update" in sys.argv
    names = Names()
    found = [fault for page in pages.pages() for fault in page_faults(page, names)]
    found += [*set_faults(), *threshold_faults(), *measured_faults(), *header_faults(update, names)]
    only = [a for a in sys.argv[1:] if not a.startswith("--")]
    found = [f for f in found if not only or any(o in f for o in only)]
    for fault in found:
        print(fault)
    print(f"{len(found)} faults in {len(pages.pages())} pages, public headers, messages and docstrings")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
