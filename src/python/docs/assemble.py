"""assemble.py DOCS OUT: writes texts.cpp, the table of docstrings and parameters, of the .txt files below DOCS, and
aggregate.hpp, the structured bindings of structures with any number of members, into OUT.

An entry begins with `==== name(parameters)` for a function, `==== Name` for a class, or several classes with the same
members, and `==== Name(what)` for an enumeration, whose members errors call `what`. A member of a class begins with
`.name: text` or `.name(parameters): text`; further lines of its text are indented. Overloads follow each other.

In functions' texts `Parameters:`, `Returns:` and `Raises:` begin the sections of numpydoc. A line of words with @ names
descriptions of shared.txt, which stand in its place.
"""

import pathlib
import re
import sys
import textwrap

MOST_MEMBERS = 27


def shared(path):
    """Returns the descriptions of shared.txt by key."""
    blocks = re.findall(r"^\[(\w+)\]\n((?:.+\n)+)", path.read_text(), re.M)
    return {"@" + key: text.rstrip("\n") for key, text in blocks}


def docstring(text, known):
    text = re.sub(r"^(Parameters|Returns|Raises):$", lambda m: m[1] + "\n" + "-" * len(m[1]), text, flags=re.M)
    return re.sub(r"^@.*$", lambda m: "\n".join(known[key] for key in m[0].split()), text, flags=re.M).strip()


def parameters_at(text):
    """Returns the parameters in brackets at the start of `text`, and the text after the brackets."""
    if not text.startswith("("):
        return [], text
    parameters, start, depth, quote = [], 1, 0, ""
    for i, c in enumerate(text):
        if quote or c in "'\"":
            quote = "" if c == quote else quote or c
        elif c in "([{":
            depth += 1
        elif c in ")]}" or (c == "," and depth == 1):
            depth -= c in ")]}"
            if depth <= 1 and (c == "," or depth == 0):
                parameters.append(" ".join(text[start:i].split()))
                start = i + 1
            if depth == 0:
                return [p for p in parameters if p], text[i + 1 :]
    raise SystemExit(f"assemble.py: a bracket that does not close: {text[:60]}")


def entries(text, known):
    """Yields (key, parameters, docstring) of a file's classes, their members, and functions."""
    for entry in re.split(r"^==== ", text, flags=re.M)[1:]:
        names, rest = re.match(r"([\w, ]+)(.*)", entry, re.S).groups()
        parameters, rest = parameters_at(rest)
        whole, *members = re.split(r"^\.(?=\w+)", rest, flags=re.M)
        for name in names.split(", "):
            if "," not in names:
                yield name, parameters, docstring(whole, known)
            for member in members:
                key, rest = re.match(r"(\w+)(.*)", member, re.S).groups()
                given, rest = parameters_at(rest)
                first, _, more = rest.removeprefix(":").partition("\n")
                yield f"{name}.{key}", given, f"{first.strip()}\n{textwrap.dedent(more)}".strip()


def table(docs):
    known = shared(docs / "shared.txt")
    files = sorted(path for path in docs.rglob("*.txt") if path.name != "shared.txt")
    rows = [row for path in files for row in entries(path.read_text(), known)]
    rows.sort(key=lambda row: row[0])
    return "".join(
        [
            '#include "texts.hpp"\n\nnamespace manycontact::python {\n\nnamespace {\n\nconst Text all[] = {\n',
            *(f'    {{"{key}", R"({chr(10).join(given)})", R"({doc})"}},\n' for key, given, doc in rows),
            "};\n\n}  // namespace\n\nstd::span<const Text> texts() { return all; }\n\n",
            "}  // namespace manycontact::python\n",
        ]
    )


def aggregate():
    """Returns aggregate.hpp. C++ counts a structure's members as the most empty braces that initialise the structure."""
    lines = ["#pragma once\n#include <tuple>\n\nnamespace manycontact::python {\n\n"]
    lines.append("template <class A, class T>\nauto tied(T& x) {\n")

    def is_made_of(n):
        return f"requires {{ A{{{', '.join(['{}'] * n)}}}; }}"

    known = "it has more members than assemble.py knows"
    lines.append(f'  static_assert(!{is_made_of(MOST_MEMBERS + 1)}, "{known}");\n  ')
    for n in range(MOST_MEMBERS, 0, -1):
        names = ", ".join(f"m{k}" for k in range(n))
        lines.append(f"if constexpr ({is_made_of(n)}) {{\n    auto& [{names}] = x;\n")
        lines.append(f"    return std::tie({names});\n  }} else ")
    return "".join(lines) + "{\n    return std::tie();\n  }\n}\n\n}  // namespace manycontact::python\n"


if __name__ == "__main__":
    docs, out = map(pathlib.Path, sys.argv[1:])
    out.mkdir(parents=True, exist_ok=True)
    (out / "texts.cpp").write_text(table(docs))
    (out / "aggregate.hpp").write_text(aggregate())
