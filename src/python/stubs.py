"""Writes __init__.pyi of the package in a folder: types and docstrings as the module itself has them.

    stubs.py build/release/python/manycontact
"""

import ast
import pathlib
import re
import sys
import types

HEADER = '''"""Written from the module by src/python/stubs.py."""

from typing import Any, Callable, Dict, Iterator, List, Optional, Set, Tuple, Union, overload

import numpy

__version__: str
'''


def parts_at(text, separator):
    """`text` split at separators that stand in no brackets or quotes."""
    parts, depth, quote, start = [], 0, None, 0
    for i, c in enumerate(text):
        if quote:
            quote = None if c == quote else quote
        elif c in "'\"":
            quote = c
        elif c in "([{<":
            depth += 1
        elif c in ")]}" or (c == ">" and text[i - 1] != "-"):
            depth -= 1
        elif depth == 0 and text.startswith(separator, i):
            parts.append(text[start:i])
            start = i + len(separator)
    return parts + [text[start:]]


def type_of(text):
    text = re.sub(r"\bmanycontact(?:::|\.)(?:_manycontact\.)?", "", text.strip())
    text = re.sub(r"\bnumpy\.ndarray\[[^\]]*\]|\bnumpy\.ndarray\b", "numpy.ndarray", text)
    text = re.sub(r"\b(handle|object|function|iterator|array)\b", "Any", text.replace("numpy.array", "array"))
    try:
        ast.parse(text, mode="eval")
    except SyntaxError:
        raise SystemExit(f"stubs.py: a type that Python cannot name: {text}")
    return text


def parameters_of(text, method):
    out = []
    for k, parameter in enumerate(parts_at(text, ",") if text.strip() else []):
        name_and_type, *default = parts_at(parameter.strip(), " = ")
        name, *annotation = parts_at(name_and_type, ": ")
        if method and k == 0:
            out.append("self")
        elif annotation:
            out.append(f"{name}: {type_of(annotation[0])}" + (" = ..." if default else ""))
        else:
            out.append(name)
    return ", ".join(out)


def signatures_of(function):
    """The (parameters, result, docstring) of each overload, by pybind11's docstring."""
    text = function.__doc__ or ""
    blocks = re.split(r"^\d+\. ", text, flags=re.M)[1:] if "Overloaded function." in text else [text]
    for block in blocks:
        line, _, doc = block.partition("\n")
        match = re.fullmatch(r"\w*\((.*)\) -> (.*)", line.strip())
        if match:
            yield match[1], match[2], doc.strip()


def docstring(text, indent):
    if not text:
        return " ..."
    quoted = text.replace("\\", "\\\\").replace('"""', '\\"""').replace("\n", "\n" + indent)
    if quoted.endswith('"'):
        quoted += " "
    return f'\n{indent}"""{quoted}"""\n{indent}...'


def function_lines(name, function, indent="", method=False, static=False):
    signatures = list(signatures_of(function))
    for parameters, result, doc in signatures:
        if len(signatures) > 1:
            yield f"{indent}@overload"
        if static:
            yield f"{indent}@staticmethod"
        listed = parameters_of(parameters, method)
        yield f"{indent}def {name}({listed}) -> {type_of(result)}:{docstring(doc, indent + '    ')}"


def property_lines(name, member):
    doc = member.fget.__doc__ or ""
    line, _, text = doc.partition("\n")
    match = re.fullmatch(r"\w*\(.*\) -> (.*)", line.strip())
    result = type_of(match[1]) if match else "Any"
    yield "    @property"
    yield f"    def {name}(self) -> {result}:{docstring((member.__doc__ or text).strip(), '        ')}"
    if member.fset:
        yield f"    @{name}.setter"
        yield f"    def {name}(self, value: Any) -> None: ..."


HIDDEN = {"__module__", "__doc__", "__dict__", "__weakref__", "__new__", "__members__", "__entries"}


def class_lines(cls):
    bases = [b.__name__ for b in cls.__bases__ if b.__name__ not in ("object", "pybind11_object")]
    yield f"class {cls.__name__}" + (f"({', '.join(bases)})" if bases else "") + ":"
    if cls.__doc__:
        yield f'    """{cls.__doc__.strip()}"""'.replace("\n", "\n    ")
    is_enum = hasattr(cls, "__members__")
    for name in cls.__members__ if is_enum else ():
        yield f"    {name}: {cls.__name__}"
    for name, member in vars(cls).items():
        if name in HIDDEN or (is_enum and (name in cls.__members__ or name.startswith("__"))):
            continue
        if isinstance(member, property):
            yield from property_lines(name, member)
        elif isinstance(member, staticmethod):
            yield from function_lines(name, member.__func__, "    ", static=True)
        elif callable(member) and member.__doc__:
            yield from function_lines(name, member, "    ", method=True)
    if is_enum:
        yield "    def __init__(self, value: int) -> None: ..."
        yield "    def __int__(self) -> int: ..."
        yield "    @property\n    def name(self) -> str: ..."
        yield "    @property\n    def value(self) -> int: ..."
    yield "    ..."


def stubs(module):
    lines = [HEADER]
    for name, member in vars(module).items():
        if name.startswith("_") or isinstance(member, types.ModuleType):
            continue
        if isinstance(member, type) and member.__name__ != name:
            lines.append(f"{name} = {member.__name__}")
        elif isinstance(member, type) and issubclass(member, Exception):
            lines.append(f"class {name}(ValueError):\n    file: str\n    line: int\n    message: str")
        elif isinstance(member, type):
            lines.extend(class_lines(member))
        elif callable(member) and member.__name__ != name:
            lines.append(f"{name} = {member.__name__}")
        elif callable(member):
            lines.extend(function_lines(name, member))
        else:
            lines.append(f"{name}: {type(member).__name__}")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    package = pathlib.Path(sys.argv[1])
    sys.path.insert(0, str(package.parent))
    import manycontact

    text = stubs(manycontact._manycontact)
    ast.parse(text)
    (package / "__init__.pyi").write_text(text)
