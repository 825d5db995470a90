"""Reads the YAML files of presets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import IoError, NotFoundError, SpecError
from robocell._extras import needed_by
from robocell._placeholders import Gripper
from robocell._policy_presets.parts import FORMS, Part
from robocell._suggestions import did_you_mean

FOLDER = Path(__file__).parent
FIELDS = (
    "extends",
    "observation",
    "images",
    "image_size",
    "channels_first",
    "prompt",
    "actions",
    "action_space",
    "gripper",
    "horizon",
    "rate",
)
SEEN_FIELDS = ("column", "times", "as")
ACTION_FIELDS = (*SEEN_FIELDS, "clip")
GRIPPER_FIELDS = ("open", "closed", "snap")
LARGEST_SIDE = 4096


def shipped_presets() -> list[str]:
    """Returns the names of the presets that come with robocell."""
    return sorted(file.stem for file in FOLDER.glob("*.yaml"))


def read_preset(name: str | Path) -> dict[str, Any]:
    """Returns the fields of `Preset`."""
    place = f"preset '{name}'"
    content, files = _extended(_file_of(name), place)
    _require_known(content, place, FIELDS)
    observation = _table(content, "observation", place)
    images = _table(content, "images", place)
    for key, camera in images.items():
        if not isinstance(camera, str) or not camera:
            raise SpecError(f"{place}: images.{key} is an image stream, got {camera!r}")
    return {
        "name": str(name),
        "files": tuple(files),
        "observation": {
            key: _parts(value, f"{place}: observation.{key}", SEEN_FIELDS)
            for key, value in observation.items()
        },
        "images": images,
        "image_size": _size(content.get("image_size"), place),
        "channels_first": _flag(content, "channels_first", place),
        "prompt": _typed(content, "prompt", str, place) or "",
        "actions": _parts(content.get("actions"), f"{place}: actions", ACTION_FIELDS),
        "action_space": _typed(content, "action_space", str, place) or "",
        "gripper": _gripper(content.get("gripper"), f"{place}: gripper"),
        "horizon": _above_zero(content, "horizon", int, place),
        "rate": _above_zero(content, "rate", (int, float), place),
    }


def _extended(file: Path, place: str) -> tuple[dict[str, Any], list[Path]]:
    """Returns the fields of a file and of those that it extends, and all files."""
    content = _content(file)
    base = content.pop("extends", None)
    if base is None:
        return content, [file]
    if base not in shipped_presets() or file == FOLDER / f"{base}.yaml":
        raise SpecError(
            f"{place}: extends is a preset of robocell, {', '.join(shipped_presets())}; got "
            f"{base!r}"
        )
    inherited, files = _extended(FOLDER / f"{base}.yaml", place)
    return inherited | content, [file, *files]


def _file_of(name: str | Path) -> Path:
    if Path(name).suffix in (".yaml", ".yml"):
        return Path(name).absolute()
    known = shipped_presets()
    if str(name) not in known:
        raise NotFoundError(
            f"no preset '{name}'.{did_you_mean(str(name), known)} Presets: {', '.join(known)}, or "
            "a file: --preset mine.yaml"
        )
    return FOLDER / f"{name}.yaml"


def _content(file: Path) -> dict[str, Any]:
    with needed_by("robocell._policy_presets", "policy"):
        import yaml
    try:
        content = yaml.safe_load(file.read_text())
    except OSError as error:
        raise IoError(f"cannot read preset '{file}': {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise SpecError(f"preset '{file}' is no YAML: {error}") from error
    if not isinstance(content, dict):
        raise SpecError(f"preset '{file}' is a table with the fields {', '.join(FIELDS)}")
    return content


def _require_known(entry: Mapping[Any, Any], place: str, fields: tuple[str, ...]) -> None:
    for name in entry:
        if name not in fields:
            raise SpecError(
                f"{place}: no field '{name}'.{did_you_mean(str(name), fields)} Its fields: "
                f"{', '.join(fields)}"
            )


def _table(content: Mapping[str, Any], name: str, place: str) -> dict[str, Any]:
    table = content.get(name) or {}
    if not isinstance(table, dict) or not all(isinstance(key, str) and key for key in table):
        raise SpecError(f"{place}: {name} is a table of names, got {table!r}")
    return table


def _typed(content: Mapping[str, Any], name: str, kind: Any, place: str) -> Any:
    value = content.get(name)
    if value is not None and (not isinstance(value, kind) or isinstance(value, bool)):
        wanted = "a text" if kind is str else "a whole number" if kind is int else "a number"
        raise SpecError(f"{place}: {name} is {wanted}, got {value!r}")
    return value


def _above_zero(content: Mapping[str, Any], name: str, kind: Any, place: str) -> Any:
    value = _typed(content, name, kind, place)
    if value is not None and not 0 < value < np.inf:
        raise SpecError(f"{place}: {name} is a number above 0, got {value!r}")
    return value


def _flag(content: Mapping[str, Any], name: str, place: str) -> bool:
    value = content.get(name, False)
    if not isinstance(value, bool):
        raise SpecError(f"{place}: {name} is true or false, got {value!r}")
    return value


def _size(size: object, place: str) -> tuple[int, int] | None:
    if size is None:
        return None
    if (
        not isinstance(size, list)
        or len(size) != 2
        or not all(type(side) is int and 0 < side <= LARGEST_SIDE for side in size)
    ):
        raise SpecError(
            f"{place}: image_size is width and height, up to {LARGEST_SIDE} each; got {size!r}"
        )
    return size[0], size[1]


def _gripper(given: object, place: str) -> Gripper:
    if given is None:
        return Gripper()
    if not isinstance(given, dict) or not {"open", "closed"} <= given.keys():
        raise SpecError(f"{place} is {{open: 1, closed: 0}}, got {given!r}")
    _require_known(given, place, GRIPPER_FIELDS)
    numbers = [_number(given[name], f"{place}.{name}") for name in ("open", "closed")]
    if numbers[0] == numbers[1]:
        raise SpecError(f"{place}: open and closed are two numbers, got {numbers[0]:g} for both")
    return Gripper(numbers[0], numbers[1], _flag(given, "snap", place))


def _parts(listed: object, place: str, fields: tuple[str, ...]) -> tuple[Part, ...]:
    if not isinstance(listed, list) or not listed:
        raise SpecError(f"{place} is a list of columns, got {listed!r}")
    return tuple(_part(each, f"{place}[{i}]", fields) for i, each in enumerate(listed))


def _part(given: object, place: str, fields: tuple[str, ...]) -> Part:
    entry = {"column": given} if isinstance(given, str) else given
    if not isinstance(entry, dict) or not isinstance(entry.get("column"), str):
        raise SpecError(f"{place}: expected a column, or {{column: ...}}, got {given!r}")
    _require_known(entry, place, fields)
    times = _number(entry.get("times", 1.0), f"{place}: times")
    if times == 0:
        raise SpecError(f"{place}: times is not 0")
    form = entry.get("as", "")
    if form and form not in FORMS:
        raise SpecError(f"{place}: no form '{form}'. There are: {', '.join(FORMS)}")
    clip = entry.get("clip")
    if clip is not None and not (
        isinstance(clip, list)
        and len(clip) == 2
        and _number(clip[0], f"{place}: clip") < _number(clip[1], f"{place}: clip")
    ):
        raise SpecError(f"{place}: clip is [lower, upper], got {clip!r}")
    return Part(entry["column"], times, None if clip is None else (clip[0], clip[1]), form)


def _number(value: object, place: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not np.isfinite(value):
        raise SpecError(f"{place} is a number, got {value!r}")
    return float(value)
