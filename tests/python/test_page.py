"""The functions of src/doc/python.md exist, with the arguments that it names."""

import re

import manycontact as mc
from conftest import ROOT

PAGE = (ROOT / "src" / "doc" / "python.md").read_text()


def test_functions_have_the_arguments_named():
    calls = re.findall(r"`(\w+)\(([\w, ]+)\)`", "\n".join(x for x in PAGE.splitlines() if x.startswith("| `")))
    assert len(calls) > 60
    for name, arguments in calls:
        doc = getattr(mc, name).__doc__
        if name == "view":
            doc = str(mc.view.__annotations__)
        for argument in arguments.split(", "):
            assert re.search(rf"\b{argument}\b['\"]?:", doc), f"{name}: {argument}"
