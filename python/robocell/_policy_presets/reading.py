"""Reads the YAML files of presets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import SpecError
from robocell._placeholders import require_column, require_placeholders
from robocell._policy_presets.parts import FORMS, Part
from robocell._preset_fields import (
    EXTENDS,
    columns_of,
    gripper_of,
    image_size_of,
    read_extended,
    read_fields,
    require_known,
    shipped_in,
)
from robocell._yaml import Place

FOLDER = Path(__file__).parent
FIELDS = (
    EXTENDS,
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


def shipped_presets() -> list[str]:
    """Returns the names of the presets that come with robocell."""
    return shipped_in(FOLDER)


def read_preset(name: str | Path) -> dict[str, Any]:
    """Returns the fields of `Preset`."""
    content, place, files = read_extended(str(name), FOLDER, _content)
    require_known(content, place, FIELDS)
    observation = _table(content, "observation", place)
    images = _table(content, "images", place)
    for key, camera in images.items():
        if not isinstance(camera, str) or not camera:
            raise SpecError(f"{place.at('images', key)} is an image stream, got {camera!r}")
        require_placeholders(camera, place.at("images", key), ())
    return {
        "name": str(name),
        "place": place,
        "files": tuple(files),
        "observation": {
            key: _parts(value, place.at("observation", key)) for key, value in observation.items()
        },
        "images": images,
        "image_size": image_size_of(content.get("image_size"), place),
        "channels_first": _flag(content, "channels_first", place),
        "prompt": _typed(content, "prompt", str, place) or "",
        "actions": _parts(content.get("actions"), place.at("actions"), clips=True),
        "action_space": _typed(content, "action_space", str, place) or "",
        "gripper": gripper_of(content.get("gripper"), place, snaps=True),
        "horizon": _above_zero(content, "horizon", int, place),
        "rate": _above_zero(content, "rate", (int, float), place),
    }


def _content(file: Path, **shown: Any) -> tuple[dict[str, Any], Place]:
    return read_fields(file, "preset", FIELDS, "robocell.policy_server", "policy", **shown)


def _table(content: Mapping[str, Any], name: str, place: Place) -> dict[str, Any]:
    table = content.get(name) or {}
    if not isinstance(table, dict) or not all(isinstance(key, str) and key for key in table):
        raise SpecError(f"{place.at(name)} is a table of names, got {table!r}")
    return table


def _typed(content: Mapping[str, Any], name: str, kind: Any, place: Place) -> Any:
    value = content.get(name)
    if value is not None and (not isinstance(value, kind) or isinstance(value, bool)):
        wanted = "a text" if kind is str else "a whole number" if kind is int else "a number"
        raise SpecError(f"{place.at(name)} is {wanted}, got {value!r}")
    return value


def _above_zero(content: Mapping[str, Any], name: str, kind: Any, place: Place) -> Any:
    value = _typed(content, name, kind, place)
    if value is not None and not 0 < value < np.inf:
        raise SpecError(f"{place.at(name)} is a number above 0, got {value!r}")
    return value


def _flag(content: Mapping[str, Any], name: str, place: Place) -> bool:
    value = content.get(name, False)
    if not isinstance(value, bool):
        raise SpecError(f"{place.at(name)} is true or false, got {value!r}")
    return value


def _parts(listed: object, place: Place, *, clips: bool = False) -> tuple[Part, ...]:
    entries = columns_of(listed, place, FORMS, clips=clips)
    for index, each in enumerate(entries):
        require_column(each.column, place.at(index))
    return tuple(Part(each.column, each.times, each.clip, each.form) for each in entries)
