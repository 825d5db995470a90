"""The docstring of each public name of the Python package, read from sources and stubs.

Public are the names that the reference shows (python_reference.py) and their members. Nothing is
imported: the docstrings of the extension are in the stubs that the build writes.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from python_reference import STUBS, TOPICS, public_names, source

Definition = ast.ClassDef | ast.FunctionDef


def docstrings() -> dict[str, str]:
    """Returns {name: docstring}, such as 'Scene.step'; '' for a name without a docstring."""
    found: dict[str, str] = {}
    wanted = {name for topic in TOPICS for name in public_names(source(topic))}
    for file in [*STUBS.glob("_core.pyi"), *STUBS.glob("_core/*.pyi")]:
        collect(definitions(file), "", found)
    for topic in TOPICS:
        for name, node in definitions_of_topic(topic):
            if name in wanted:
                collect([node], "", found)
    return found


def definitions(file: Path) -> list[Definition]:
    """Classes and functions of a module that have no underscore."""
    body = ast.parse(file.read_text()).body
    return [n for n in body if isinstance(n, Definition) and not n.name.startswith("_")]


def definitions_of_topic(topic: str) -> Iterator[tuple[str, Definition]]:
    """The same of a topic's module and of those that it is put together from."""
    file = source(topic)
    files = [file] if file.name != "__init__.py" else sorted(file.parent.glob("*.py"))
    private = [*file.parent.glob(f"_{topic}*.py"), *file.parent.glob("_gym_*.py")]
    for each in [*files, *(private if topic == "gym" else [])]:
        yield from ((node.name, node) for node in definitions(each))


def collect(nodes: list[Definition], prefix: str, found: dict[str, str]) -> None:
    """Adds the docstrings of definitions and their members; one of several overloads is enough."""
    for node in nodes:
        name = prefix + node.name
        found[name] = found.get(name) or ast.get_docstring(node) or ""
        if isinstance(node, ast.ClassDef):
            members = [n for n in node.body if isinstance(n, Definition)]
            collect([n for n in members if not n.name.startswith("_")], f"{name}.", found)
