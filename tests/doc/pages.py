"""Runs what the pages show and compares it with what they say that it prints.

    pages.py run PAGE --build BUILD [--programs FOLDER] [--python P]     ends with 1 where a block fails or prints otherwise
    pages.py update PAGE ...                                             writes into the page what was printed
    pages.py extract FOLDER                                              the C++ programs of all pages, for a build

A page's blocks are run from top to bottom in a folder of its own, from which models, src, tests and build/release are
reached by links, with the programs and the Python package of BUILD on the paths.

* `sh` and `python` blocks run; a `text` block that follows is what they print. A line "..." in it stands for any lines.
  Numbers agree to 2e-5 of their size or 1e-9, since machines round otherwise.
* A block of any other language whose preceding sentence ends with "`NAME`:" is written to that file. C++ programs are
  compiled before, by NAME.
* A comment in the line before a block marks it: <!-- not run: WHY --> ; <!-- needs: MODULE --> , skipped where Python has
  no such module; <!-- numbers vary -->, of a `text` block with times.
"""

import argparse
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")


class Block:
    """One fenced block: its language, text, the sentence before it, the comments that mark it."""

    def __init__(self, language, lines, first, before, marks):
        self.language, self.text, self.first, self.marks = language, "".join(x + "\n" for x in lines), first, marks
        name = re.search(r"`([^`\s]+)`:\s*$", before)
        self.name = name[1] if name else None

    def mark(self, key):
        found = [m for m in self.marks if m.startswith(key)]
        return found[0] if found else None


def pages():
    """Every page for users and contributors, from the top."""
    found = [TOP / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "models/README.md", "sparse/README.md", "src/optimal_control/lq/README.md")]
    return [p for p in found if p.exists()] + sorted((TOP / "src" / "doc").rglob("*.md"))


def blocks_of(text):
    blocks, before, marks, inside = [], "", [], None
    for number, line in enumerate(text.split("\n")):
        fence = re.match(r"( *)```(.*)", line)
        if inside is not None:
            if fence and not fence[2]:
                blocks.append(Block(inside[0], inside[1], inside[2], before, marks))
                inside, marks, before = None, [], ""
            else:
                inside[1].append(line[inside[3] :])
        elif fence:
            inside = (fence[2].strip(), [], number, len(fence[1]))
        elif comment := re.fullmatch(r"\s*<!-- (.*) -->\s*", line):
            marks.append(comment[1])
        elif line.strip():
            before = line
            marks = []
    return blocks


def alike(shown, printed, vary):
    """Compares one line of a page with a printed one."""
    if " ".join(NUMBER.sub("0", shown).split()) != " ".join(NUMBER.sub("0", printed).split()):
        return False
    for a, b in zip(NUMBER.findall(shown), NUMBER.findall(printed)):
        x, y = float(a), float(b)
        if not vary and abs(x - y) > max(1e-9, 2e-5 * max(abs(x), abs(y))):
            return False
    return True


def difference(shown, printed, vary):
    """Returns None if a text block shows the printed text, otherwise the difference."""
    lines, at, free = [x.rstrip() for x in printed.rstrip("\n").split("\n")], 0, False
    for line in shown.rstrip("\n").split("\n"):
        if line.strip() == "...":
            free = True
            continue
        last = len(lines) if free else at + 1
        found = next((k for k in range(at, min(last, len(lines))) if alike(line, lines[k], vary)), None)
        if found is None:
            return f"not printed: {line!r}" + ("" if free or at >= len(lines) else f", but {lines[at]!r}")
        at, free = found + 1, False
    if not free and at < len(lines):
        return f"also printed: {lines[at]!r}"
    return None


class Run:
    """A page's blocks run in this folder."""

    def __init__(self, page, build, programs, python):
        self.page, self.build, self.programs, self.python = page, build, programs, python
        self.folder = build / "pages" / "_".join(page.relative_to(TOP).with_suffix("").parts)
        shutil.rmtree(self.folder, ignore_errors=True)
        (self.folder / "build").mkdir(parents=True)
        for name in ("src", "tests", "include", "bench"):
            (self.folder / name).symlink_to(TOP / name)
        shutil.copytree(TOP / "models", self.folder / "models")
        (self.folder / "build" / "release").symlink_to(build)
        tools = self.folder / "tools"  # python3 is that of the package's build
        tools.mkdir()
        (tools / "python3").symlink_to(python)
        self.environment = dict(
            os.environ,
            PATH=f"{tools}:{build / 'bin'}:{os.environ['PATH']}",
            PYTHONPATH=os.pathsep.join([str(build / "python"), *filter(None, [os.environ.get("PYTHONPATH")])]),
            PYTHONDONTWRITEBYTECODE="1",
            OPENBLAS_NUM_THREADS="1",
            MPLBACKEND="Agg",
            HOME=str(self.folder),
        )

    def run(self, block):
        """Returns what the block prints; raises if it fails."""
        if block.language == "python":
            name = block.name or "page.py"
            (self.folder / name).write_text(block.text)
            command = [self.python, name]
        else:
            command = ["bash", "-ec", block.text]
        done = subprocess.run(
            command, cwd=self.folder, env=self.environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600
        )
        if done.returncode:
            raise RuntimeError(f"ended with {done.returncode}\n{done.stdout}")
        return done.stdout

    def write(self, block):
        """A file that the page shows."""
        target = self.folder / block.name
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.parent.resolve().is_relative_to(self.folder.resolve()):
            raise ValueError(f"{self.page}: {block.name} would be written outside the folder of the page")
        target.write_text(block.text)
        program = self.programs / pathlib.Path(block.name).stem if self.programs and block.language == "cpp" else None
        if program and program.exists():
            (self.folder / program.name).symlink_to(program)


def runs(block):
    return block.language in ("sh", "python") and not block.mark("not run: ")


def skipped(block):
    needs = block.mark("needs: ")
    return needs and importlib.util.find_spec(needs.removeprefix("needs: ")) is None


def run_page(run, update):
    text = run.page.read_text()
    blocks, wrong, lines = blocks_of(text), [], text.split("\n")
    changes = []
    for k, block in enumerate(blocks):
        where = f"{run.page.relative_to(TOP)}:{block.first + 1}"
        if skipped(block):
            print(f"{where}: skipped, Python has no {block.mark('needs: ')[7:]}")
            continue
        if block.name and block.language not in ("sh", "python"):
            run.write(block)
        if not runs(block):
            continue
        try:
            printed = run.run(block)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            wrong.append(f"{where}: {error}")
            continue
        after = blocks[k + 1] if k + 1 < len(blocks) and blocks[k + 1].language == "text" else None
        if not after:
            continue
        difference_found = difference(after.text, printed, after.mark("numbers vary"))
        if difference_found and update and "\n...\n" not in "\n" + after.text:
            changes.append((after.first + 1, after.text.count("\n"), printed.rstrip("\n").split("\n")))
        elif difference_found:
            wrong.append(f"{where}: {difference_found}; all of it:\n{printed}")
    for first, count, new in reversed(changes):
        lines[first : first + count] = new
    if changes:
        run.page.write_text("\n".join(lines))
    return wrong


def programs():
    """{name: text} of the C++ programs of all pages."""
    found = {}
    for page in pages():
        for block in blocks_of(page.read_text()):
            if block.language == "cpp" and block.name:
                name = pathlib.Path(block.name).stem
                if found.setdefault(name, block.text) != block.text:
                    sys.exit(f"two programs are called {name}.cpp, one of them in {page}")
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("action", choices=["run", "update", "extract"])
    parser.add_argument("path", type=pathlib.Path, nargs="+")
    parser.add_argument("--build", type=pathlib.Path, default=TOP / "build" / "release")
    parser.add_argument("--programs", type=pathlib.Path)
    parser.add_argument("--python", default="/usr/bin/python3")
    given = parser.parse_args()
    if given.action == "extract":
        folder = given.path[0]
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in programs().items():
            target = folder / f"{name}.cpp"
            if not target.exists() or target.read_text() != text:
                target.write_text(text)
        return
    wrong = []
    for page in given.path:
        run = Run(page.resolve(), given.build.resolve(), given.programs and given.programs.resolve(), given.python)
        wrong += run_page(run, given.action == "update")
    for line in wrong:
        print(line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
