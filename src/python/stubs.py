"""Writes __init__.pyi of the package in a folder: types and docstrings as the module itself has them.

    stubs.py build/release/python/manycontact

mypy's stubgen (1.0) drops docstrings and the types of arrays' properties, and writes `Fu: By calcDiff`.
"""

import ast
import pathlib
import re
import sys
import types

HEADER = '''"""Written from the module by src/python/stubs.py."""

from typing import (
    AbstractSet, Any, Callable, Dict, Generic, Iterable, Iterator, List, Mapping, Optional, Sequence, Set, Tuple,
    TypeVar, Union, overload,
)

import numpy
from numpy.typing import ArrayLike, NDArray

from .descriptions import description_path as description_path, load_description as load_description
from .files import joint_limits as joint_limits, load_urdf_text as load_urdf_text
from .files import srdf_configurations as srdf_configurations, write_scene as write_scene
from .mcap import write_mcap as write_mcap
from .notebook import view as view

__version__: str

_Got = TypeVar("_Got", covariant=True)
_Given = TypeVar("_Given", contravariant=True)

class _Attribute(Generic[_Got, _Given]):
    """A property that takes more types than it gives: any sequence of numbers for an array, a name for a member."""
    def __get__(self, obj: Any, owner: Any = ...) -> _Got: ...
    def __set__(self, obj: Any, value: _Given) -> None: ...
'''

ARRAY = "NDArray[numpy.float64]"
NUMBERS = {"bool": "numpy.bool_", "numpy.int8": "numpy.int8"}


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


def type_of(text, use="returned"):
    """pybind11's type as Python's. use: "given" to a function, "returned" by one, or that of a "property"."""
    text = re.sub(r"\bmanycontact(?:::|\.)(?:_manycontact\.)?", "", text.strip())
    array = "ArrayLike" if use == "given" else ARRAY
    text = re.sub(r"\bnumpy\.ndarray\[(bool|numpy\.int8)\]", lambda m: f"NDArray[{NUMBERS[m[1]]}]", text)
    text = re.sub(r"\bnumpy\.ndarray\[[^\]]*\]|\bnumpy\.ndarray\b", array, text)
    text = re.sub(r"\barray\b|\bnumpy\.array\b", "NDArray[Any]", text)
    text = re.sub(r"\b(handle|object|iterator)\b", "Any", text)
    text = re.sub(r"\bfunction\b", "Callable[..., Any]", text)
    text = re.sub(r"\b(tuple|dict|list|slice)\b", lambda m: {"dict": "Dict[Any, Any]"}.get(m[1], m[1]), text)
    if use != "returned":
        readable = {"List": "Sequence", "Dict": "Mapping", "Set": "AbstractSet"}
        text = re.sub(r"\b(List|Dict|Set)\[", lambda m: readable[m[1]] + "[", text)
    if use == "given":
        text = re.sub(r"\w+", lambda m: f"Union[{m[0]}, str]" if m[0] in ENUMERATIONS else m[0], text)
    try:
        ast.parse(text, mode="eval")
    except SyntaxError:
        raise SystemExit(f"stubs.py: a type that Python cannot name: {text}")
    return text


ENUMERATIONS = set()


def parameters_of(text, method):
    out = []
    for k, parameter in enumerate(parts_at(text, ",") if text.strip() else []):
        name_and_type, *default = parts_at(parameter.strip(), " = ")
        name, *annotation = parts_at(name_and_type, ": ")
        if method and k == 0:
            out.append("self")
        elif annotation:
            given = type_of(annotation[0], "given")
            if default == ["None"] and not given.startswith(("Optional[", "Any")):
                given = f"Optional[{given}]"
            out.append(f"{name}: {given}" + (" = ..." if default else ""))
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
        elif line.startswith(f"{getattr(function, '__name__', '')}("):
            raise SystemExit(f"stubs.py: a signature that cannot be read: {line}")


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
    result = type_of(match[1], "property") if match else "Any"
    text = (member.__doc__ or text).strip()
    taken = re.match(r"\w*\((?:.*), \w+: (.*)\) -> None", (member.fset.__doc__ or "").strip()) if member.fset else None
    given = type_of(taken[1], "given") if taken else "Any"
    if given in ("Any", ARRAY) and result.startswith("NDArray"):
        given = "ArrayLike"
    if member.fset and given != result:
        yield f"    {name}: _Attribute[{result}, {given}]"
        if text:
            yield "    " + docstring(text, "    ").strip().rpartition("\n")[0].strip()
        return
    yield "    @property"
    yield f"    def {name}(self) -> {result}:{docstring(text, '        ')}"
    if member.fset:
        yield f"    @{name}.setter"
        yield f"    def {name}(self, value: {given}) -> None: ..."


HIDDEN = {"__module__", "__doc__", "__dict__", "__weakref__", "__new__", "__members__", "__entries", "__getstate__",
          "__setstate__", "__init_subclass__", "__hash__"}  # fmt: skip


def enumeration_lines(cls):
    yield from (f"    {name}: {cls.__name__}" for name in cls.__members__)
    yield "    __members__: Mapping[str, " + cls.__name__ + "]"
    yield "    def __init__(self, value: int) -> None: ..."
    yield "    def __int__(self) -> int: ..."
    yield "    def __index__(self) -> int: ..."
    yield "    def __hash__(self) -> int: ..."
    yield "    @property\n    def name(self) -> str: ..."
    yield "    @property\n    def value(self) -> int: ..."


def class_lines(cls):
    bases = [b.__name__ for b in cls.__bases__ if b.__name__ not in ("object", "pybind11_object")]
    yield f"class {cls.__name__}" + (f"({', '.join(bases)})" if bases else "") + ":"
    if cls.__doc__:
        yield f'    """{cls.__doc__.strip()}"""'.replace("\n", "\n    ")
    members = {} if hasattr(cls, "__members__") else vars(cls)
    if hasattr(cls, "__members__"):
        yield from enumeration_lines(cls)
    for name, member in members.items():
        if name in HIDDEN:
            continue
        if isinstance(member, property):
            yield from property_lines(name, member)
        elif isinstance(member, staticmethod):
            yield from function_lines(name, member.__func__, "    ", static=True)
        elif name == "__eq__":
            yield "    def __eq__(self, other: object) -> bool: ..."
        elif name == "__iter__":
            results = [r for _, r, _ in signatures_of(getattr(cls, "__getitem__", None))]
            item = next((r for r in results if not r.startswith("List")), "float")
            yield f"    def __iter__(self) -> Iterator[{type_of(item)}]: ..."
        elif callable(member) and member.__doc__:
            yield from function_lines(name, member, "    ", method=True)
    yield "    ..."


def stubs(module):
    ENUMERATIONS.update(name for name, x in vars(module).items() if hasattr(x, "__members__"))
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
