"""Reads the YAML files of mappings and presets, and checks every entry.

A problem is reported with the file, the entry, and what is allowed there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from robocell._core import NotFoundError, SpecError
from robocell._preset_fields import (
    EXTENDS,
    columns_of,
    read_extended,
    read_fields,
    require_known,
)
from robocell._suggestions import did_you_mean
from robocell._yaml import Place
from robocell.export._features import PARTS, Term

TABLES = Path(__file__).with_name("tables")
PRESETS = Path(__file__).with_name("presets")
FIELDS = ("features", "actions", "action_feature", "images", "image_size", "gripper", "task")
PRESET_FIELDS = (EXTENDS, *FIELDS)


def read_table(file: Path) -> tuple[dict[str, Any], Place]:
    """Returns the content of a user's YAML file that holds a table, and its place."""
    return read_fields(file, "mapping", FIELDS, "robocell.export", "export")


def built_in_table(name: str) -> tuple[dict[str, Any], Place]:
    """Returns the content of a format's own table, and its place."""
    shown: dict[str, Any] = {"name": name, "has_lines": False}
    return read_fields(TABLES / name, "mapping", FIELDS, "robocell.export", "export", **shown)


def read_preset(name: str) -> tuple[dict[str, Any], Place]:
    """Returns the content of a preset with the fields of the one that it extends, and its place.

    Raises NotFoundError if there is neither a built-in preset of this name nor a file.
    """

    def read(one: Path, **shown: Any) -> tuple[dict[str, Any], Place]:
        return read_fields(one, "preset", PRESET_FIELDS, "robocell.export", "export", **shown)

    content, place, _ = read_extended(name, PRESETS, read)
    require_known(content, place, PRESET_FIELDS)
    return content, place


def merge_table(
    table: dict[str, Any], own: dict[str, Any], place: Place, *, replaces: bool
) -> set[str]:
    """Puts the fields of a file into a table, and returns the features that the file names.

    Args:
        table: The table.
        own: Content of the file.
        place: Begins error messages.
        replaces: Whether the file's features take the place of all, or of those of their names.
    """
    require_known(own, place, FIELDS)
    for name, content in own.items():
        if name in ("features", "actions"):
            if not isinstance(content, dict):
                raise SpecError(f"{place.at(name)} is a table of lists of columns, got {content!r}")
            if replaces and name == "features":
                table[name] = {}
            table[name] |= content
            continue
        if name == "images" and not (
            content is None
            or (
                isinstance(content, dict)
                and all(isinstance(each, str) for pair in content.items() for each in pair)
            )
        ):
            raise SpecError(
                f"{place.at(name)} is a table of cameras, 'observation.images.x: wrist'"
            )
        table[name] = content
    return set(own.get("features", {}))


def require_names(names: Iterable[object], place: Place) -> None:
    """Raises SpecError for names of features that cannot be parts of a path."""
    for name in names:
        parts = str(name).split("/")
        if not all(part and part.strip(".") and part.isprintable() for part in parts):
            raise SpecError(
                f"{place.near(str(name))}: '{name}' cannot be the name of a feature: names are "
                "words, with / between them"
            )


def require_apart(names: Sequence[str], place: Place) -> None:
    """Raises SpecError unless every name can be that of an array, also beside the others."""
    taken: set[str] = set()
    for name in names:
        if name in taken:
            raise SpecError(f"{place}: there are two features '{name}'")
        taken.add(name)
    for name in names:
        parts = name.split("/")
        for end in range(1, len(parts)):
            if (above := "/".join(parts[:end])) in taken:
                raise SpecError(f"{place}: feature '{name}' cannot be inside feature '{above}'")


def template_of(images: dict[str, str]) -> str:
    """Returns the name of an image feature for any camera, or ""."""
    return next((name for name in images if "{camera}" in name), "")


def terms_of(table: dict[str, Any], name: str, place: Place) -> list[Term]:
    """Returns the columns of an entry. `place`: that of the table."""
    entries = columns_of(table[name], place.at(name), PARTS, may_be_empty=True)
    return [Term(each.column, each.form, each.times) for each in entries]


def chosen_action(name: str, choices: dict[str, list[Term]], place: Place | str) -> list[Term]:
    """Returns the columns of ready-made actions."""
    if name in choices:
        return choices[name]
    raise NotFoundError(
        f"{place}: no actions '{name}'.{did_you_mean(name, choices)} There are: "
        f"{', '.join(choices)}, or a list of columns"
    )


def listed_actions(actions: str, choices: dict[str, list[Term]]) -> list[str]:
    """Returns the columns of `--actions a,b`."""
    if "/" not in actions:
        chosen_action(actions, choices, "--actions")
    return [name.strip() for name in actions.split(",") if name.strip()]
