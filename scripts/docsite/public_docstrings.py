"""The docstring of each public name of the Python package, read from sources and stubs.

Public are the names that the reference shows (python_reference.py), their members, and the values
of enums. Nothing is imported: the docstrings of the extension are in the stubs that the build
writes.
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


def returned_types() -> dict[str, str]:
    """Returns what each public method or property of the extension's classes returns."""
    found: dict[str, str] = {}
    known = docstrings()
    for file in STUBS.glob("_core.pyi"):
        for owner in definitions(file):
            for node in owner.body if isinstance(owner, ast.ClassDef) else []:
                name = f"{owner.name}.{getattr(node, 'name', '')}"
                if isinstance(node, ast.FunctionDef) and node.returns and name in known:
                    returned = ast.unparse(node.returns)
                    found[name] = found.get(name, "") + ("" if returned == "None" else returned)
    return found


def definitions(file: Path) -> list[Definition]:
    """Returns the classes and functions of a module whose names have no underscore."""
    body = ast.parse(file.read_text()).body
    return [n for n in body if isinstance(n, Definition) and not n.name.startswith("_")]


def definitions_of_topic(topic: str) -> Iterator[tuple[str, Definition]]:
    """Yields the definitions of a topic's module and of its parts, by name."""
    file = source(topic)
    files = [file] if file.name != "__init__.py" else sorted(file.parent.glob("*.py"))
    private = [*file.parent.glob(f"_{topic}*.py"), *file.parent.glob("_gym_*.py")]
    for each in [*files, *(private if topic == "gym" else [])]:
        yield from ((node.name, node) for node in definitions(each))


def enum_values(node: ast.ClassDef) -> Iterator[tuple[str, str]]:
    """Yields the values of an enum, each with the string below it, its docstring, or ''."""
    if not any(ast.unparse(base).endswith("Enum") for base in node.bases):
        return
    for this, following in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(this, ast.Assign) and isinstance(this.targets[0], ast.Name):
            text = following.value if isinstance(following, ast.Expr) else None
            yield this.targets[0].id, str(text.value) if isinstance(text, ast.Constant) else ""


def collect(nodes: list[Definition], prefix: str, found: dict[str, str]) -> None:
    """Adds the docstrings of definitions and their members; one of several overloads is enough."""
    for node in nodes:
        name = prefix + node.name
        found[name] = found.get(name) or ast.get_docstring(node) or ""
        if isinstance(node, ast.ClassDef):
            found |= {f"{name}.{value}": text for value, text in enum_values(node)}
            members = [n for n in node.body if isinstance(n, Definition)]
            collect([n for n in members if not n.name.startswith("_")], f"{name}.", found)
