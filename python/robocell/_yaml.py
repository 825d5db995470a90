"""Reads YAML files of users.

A key that is there twice is an error: PyYAML takes the last one without a word.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from robocell._core import IoError, SpecError
from robocell._extras import needed_by


def read_yaml(file: Path, what: str, module: str, extra: str) -> Any:
    """Returns the content of a file.

    Args:
        file: The file.
        what: What it is, for messages: "preset".
        module: The module that reads it.
        extra: The extra of robocell that installs PyYAML for that module.

    Raises:
        SpecError: It is no YAML, or a table has a key twice.
        IoError: It cannot be read.
    """
    with needed_by(module, extra):
        import yaml
    try:
        return yaml.load(file.read_text(encoding="utf-8"), Loader=_loader())
    except _TwiceError as error:
        raise SpecError(f"{what} '{file}': {error}") from error
    except OSError as error:
        raise IoError(f"cannot read {what} '{file}': {error.strerror}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise SpecError(f"{what} '{file}' is no YAML: {error}") from error


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
