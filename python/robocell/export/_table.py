"""Reads the YAML files of mappings and presets, and checks every entry.

A problem is reported with the file, the entry, and what is allowed there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from robocell._core import IoError, NotFoundError, SpecError
from robocell._extras import needed_by
from robocell._placeholders import AS_RECORDED, Gripper
from robocell._suggestions import did_you_mean
from robocell.export._features import PARTS, Term

TABLES = Path(__file__).with_name("tables")
PRESETS = Path(__file__).with_name("presets")
FIELDS = ("features", "actions", "action_feature", "images", "image_size", "gripper", "task")
ENTRY = ("column", "as", "times")


def preset_file(name: str) -> Path:
    """Returns the file of a preset: a built-in one, or one of the user.

    Raises:
        NotFoundError: There is none; the message has the built-in ones.
    """
    known = sorted(file.stem for file in PRESETS.glob("*.yaml"))
    if name in known:
        return PRESETS / f"{name}.yaml"
    if name.endswith((".yaml", ".yml")):
        return Path(name)
    raise NotFoundError(
        f"no preset '{name}'.{did_you_mean(name, known)} Presets: {', '.join(known)}, or a file "
        "that ends with .yaml"
    )


def read_table(file: Path) -> dict[str, Any]:
    """Returns the content of a YAML file that holds a table."""
    with needed_by("robocell.export", "export"):
        import yaml
    try:
        content = yaml.safe_load(file.read_text())
    except OSError as error:
        raise IoError(f"cannot read mapping '{file}': {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise SpecError(f"mapping '{file}' is no YAML: {error}") from error
    if not isinstance(content, dict):
        raise SpecError(f"mapping '{file}' is a table with the fields {', '.join(FIELDS)}")
    return content


def merge_table(table: dict[str, Any], own: dict[str, Any], place: str, *, replaces: bool) -> None:
    """Puts the fields of a file into a table.

    Args:
        table: The table.
        own: Content of the file.
        place: Begins error messages.
        replaces: Whether the file's features take the place of all, or of those of their names.
    """
    for name, content in own.items():
        if name not in FIELDS:
            raise SpecError(
                f"{place}: no field '{name}'.{did_you_mean(str(name), FIELDS)} Its fields: "
                f"{', '.join(FIELDS)}"
            )
        if name in ("features", "actions"):
            if not isinstance(content, dict):
                raise SpecError(f"{place}: {name} is a table of lists of columns, got {content!r}")
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
            raise SpecError(f"{place}: images is a table of cameras, 'observation.images.x: wrist'")
        table[name] = content


def require_names(names: Iterable[object], place: str) -> None:
    """Raises SpecError for names of features that cannot be parts of a path."""
    for name in names:
        parts = str(name).split("/")
        if not all(part and part.strip(".") and part.isprintable() for part in parts):
            raise SpecError(
                f"{place}: '{name}' cannot be the name of a feature: names are words, with / "
                "between them"
            )


def require_apart(names: Sequence[str], place: str) -> None:
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


def terms_of(table: dict[str, Any], name: str, place: str) -> list[Term]:
    """Returns the columns of an entry."""
    columns = table[name]
    if not isinstance(columns, list):
        raise SpecError(f"{place}: {name} is a list of columns, got {columns!r}")
    return [_term(entry, name, place) for entry in columns]


def _term(entry: object, name: str, place: str) -> Term:
    """Returns an entry of a list of columns: a name, or a table with its part and factor."""
    if isinstance(entry, str):
        return Term(entry)
    if not isinstance(entry, dict) or not isinstance(entry.get("column"), str):
        raise SpecError(f"{place}: {name} is a list of columns, got {entry!r}")
    for key in entry:
        if key not in ENTRY:
            raise SpecError(
                f"{place}: {name}: no field '{key}'.{did_you_mean(str(key), ENTRY)} A column has: "
                f"{', '.join(ENTRY)}"
            )
    part, times = entry.get("as", ""), entry.get("times", 1)
    if part not in ("", *PARTS):
        raise SpecError(
            f"{place}: {name}: no part '{part}'.{did_you_mean(str(part), PARTS)} Parts: "
            f"{', '.join(PARTS)}"
        )
    if not _is_number(times) or times == 0:
        raise SpecError(f"{place}: {name}: times is a number other than 0, got {times!r}")
    return Term(entry["column"], part, float(times))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9


def size_of(size: object, place: str) -> tuple[int, int] | None:
    """Returns the width and height of images."""
    if size is None:
        return None
    if (
        isinstance(size, list)
        and len(size) == 2
        and all(isinstance(each, int) and 2 <= each <= 8192 and each % 2 == 0 for each in size)
    ):
        return (size[0], size[1])
    raise SpecError(
        f"{place}: image_size is width and height, even numbers such as [320, 180]; got {size!r}"
    )


def gripper_of(numbers: object, place: str) -> Gripper:
    """Returns the numbers of open and closed grippers."""
    if numbers is None:
        return AS_RECORDED
    if (
        isinstance(numbers, dict)
        and numbers.keys() == {"open", "closed"}
        and all(_is_number(each) for each in numbers.values())
        and numbers["open"] != numbers["closed"]
    ):
        return Gripper(float(numbers["open"]), float(numbers["closed"]))
    raise SpecError(
        f"{place}: gripper has two different numbers, {{open: 1, closed: 0}}; got {numbers!r}"
    )


def chosen_action(name: str, choices: dict[str, list[Term]], place: str) -> list[Term]:
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
