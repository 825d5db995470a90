"""Reads YAML files of users, and says where an entry stands.

    content, place = read_yaml(file, "mapping", "robocell.export", "export")
    f"{place.at('features', 'state', 0)} is a column"
    # mapping 'own.yaml:3:12': features.state[0] is a column

A key that is there twice is an error: PyYAML takes the last one without a word.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from robocell._core import IoError, SpecError
from robocell._extras import needed_by

Key = str | int


@dataclass(frozen=True)
class _Source:
    """A file.

    Attributes:
        what: What it is: "mapping".
        name: Its name in messages.
        node: Its content with positions.
        has_lines: Whether messages say lines of it: those of files that users write.
    """

    what: str
    name: str
    node: Any
    has_lines: bool


@dataclass(frozen=True)
class Place:
    """An entry of a file, or of files that replace entries of each other; it begins messages.

    Attributes:
        sources: The files. The first that has the entry is named.
        path: Keys of tables and indices of lists that lead to the entry.
        shown: The part of the path that the text has.
    """

    sources: tuple[_Source, ...]
    path: tuple[Key, ...] = ()
    shown: tuple[Key, ...] = ()

    def at(self, *path: Key) -> Place:
        """Returns the place of an entry: "mapping 'own.yaml:3:5': features.state"."""
        return replace(self, path=(*self.path, *path), shown=(*self.shown, *path))

    def near(self, *path: Key) -> Place:
        """Returns this place with the line of an entry, which the message itself names."""
        return replace(self, path=(*self.path, *path))

    def over(self, other: Place) -> Place:
        """Returns the place of a file that replaces entries of others."""
        return replace(self, sources=(*self.sources, *other.sources))

    def __str__(self) -> str:
        found = [_found(source.node, self.path) for source in self.sources]
        depth = max(found)[0]
        source, (_, line, column) = next(
            each for each in zip(self.sources, found, strict=True) if each[1][0] == depth
        )
        where = f":{line}:{column}" if depth and source.has_lines else ""
        path = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in self.shown)
        text = f"{source.what} '{source.name}{where}'"
        return f"{text}: {path.removeprefix('.')}" if path else text


def place_without_file(what: str, name: str) -> Place:
    """Returns the place of entries that no file has: "preset 'zmq://localhost:5555'"."""
    return Place((_Source(what, name, None, has_lines=False),))


def read_yaml(
    file: Path,
    what: str,
    module: str,
    extra: str,
    *,
    name: str | None = None,
    has_lines: bool = True,
) -> tuple[Any, Place]:
    """Returns the content of a file, and its place.

    Args:
        file: The file.
        what: What it is, for messages: "preset".
        module: The module that reads it.
        extra: The extra of robocell that installs PyYAML for that module.
        name: Its name in messages; default: its path.
        has_lines: Whether messages say lines of it.

    Raises:
        SpecError: It is no YAML, or a table has a key twice.
        IoError: It cannot be read.
    """
    with needed_by(module, extra):
        import yaml
    shown = str(file) if name is None else name
    try:
        loader = _loader()(file.read_text(encoding="utf-8"))
        try:
            node = loader.get_single_node()
            content = None if node is None else loader.construct_document(node)
        finally:
            loader.dispose()
    except _TwiceError as error:
        raise SpecError(f"{what} '{shown}': {error}") from error
    except OSError as error:
        raise IoError(f"cannot read {what} '{shown}': {error.strerror}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise SpecError(f"{what} '{shown}' is no YAML: {error}") from error
    return content, Place((_Source(what, shown, node, has_lines),))


def _found(node: Any, path: tuple[Key, ...]) -> tuple[int, int, int]:
    """Returns how far a path leads into a file, and line and column of the entry."""
    depth, mark = 0, None
    for key in path:
        step = _step(node, key)
        if step is None:
            break
        mark, node = step
        depth += 1
    return (depth, 0, 0) if mark is None else (depth, mark.line + 1, mark.column + 1)


def _step(node: Any, key: Key) -> tuple[Any, Any] | None:
    """Returns the mark and the node of an entry of a table or list."""
    inside = getattr(node, "value", None)
    if not isinstance(inside, list):
        return None
    if getattr(node, "id", "") == "sequence":
        if not isinstance(key, int) or not 0 <= key < len(inside):
            return None
        return inside[key].start_mark, inside[key]
    for each, value in inside:
        if each.value == str(key):
            return each.start_mark, value
    return None


class _TwiceError(Exception):
    """A table has a key twice."""


@functools.cache
def _loader() -> Any:
    import yaml

    class Loader(yaml.SafeLoader):
        """The safe loader, which rejects tables with a key twice."""

        def compose_mapping_node(self, anchor: Any) -> Any:
            """Returns a table, before `<<` adds entries to it."""
            node = super().compose_mapping_node(anchor)
            lines: dict[tuple[str, str], int] = {}
            for key, _ in node.value:
                if not isinstance(key, yaml.ScalarNode):
                    continue
                name, line = (key.tag, key.value), key.start_mark.line + 1
                if name in lines:
                    raise _TwiceError(_text(key.value, lines[name], line))
                lines[name] = line
            return node

    return Loader


def _text(key: str, first: int, second: int) -> str:
    where = f"in line {first}" if first == second else f"in lines {first} and {second}"
    return f"'{key}' is there twice, {where}. Keep one"
