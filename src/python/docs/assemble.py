"""assemble.py TOPIC.txt HEADER: the docstrings of a topic, in the layout of numpydoc, as constants of C++.

An entry begins with `==== name`. `Parameters:`, `Returns:` and `Raises:` begin its sections. A line of words with @
names descriptions of shared.txt, which stand in its place.
"""

import pathlib
import re
import sys


def shared(path):
    """The descriptions by their keys."""
    blocks = re.findall(r"^\[(\w+)\]\n((?:.+\n)+)", path.read_text(), re.M)
    return {"@" + key: text.rstrip("\n") for key, text in blocks}


def docstring(text, known):
    text = re.sub(r"^(Parameters|Returns|Raises):$", lambda m: m[1] + "\n" + "-" * len(m[1]), text, flags=re.M)
    return re.sub(r"^@.*$", lambda m: "\n".join(known[key] for key in m[0].split()), text, flags=re.M)


def header(topic, known):
    _, *entries = re.split(r"^==== (\w+)\n", topic, flags=re.M)
    docs = (
        f'inline constexpr const char* {name} =\n    R"({docstring(text.strip(), known)})";\n'
        for name, text in zip(entries[::2], entries[1::2])
    )
    return "#pragma once\nnamespace manycontact::python::doc {\n\n" + "\n".join(docs) + "\n}  // namespace manycontact::python::doc\n"


if __name__ == "__main__":
    topic, out = map(pathlib.Path, sys.argv[1:])
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(header(topic.read_text(), shared(topic.with_name("shared.txt"))))
