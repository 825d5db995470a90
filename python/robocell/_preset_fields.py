"""Reads the words that presets of policies and mapping files of exports share.

    gripper: {open: 0, closed: 1}
    image_size: [320, 180]
    {column: "robots/{robot}/tcp_pose", as: position, times: 20}

docs/presets.md describes them. A problem is reported with the place, and what is allowed there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell._core import NotFoundError, SpecError
from robocell._placeholders import AS_RECORDED, Gripper
from robocell._suggestions import did_you_mean
from robocell._yaml import Place, read_yaml

LARGEST_SIDE = 8192
SNAP = "snap"
EXTENDS = "extends"


@dataclass(frozen=True)
class ColumnEntry:
    """An entry of a list of columns.

    Attributes:
        column: Name or pattern of the column.
        form: Part of a pose or displacement (`as`); "" for all of it.
        times: Factor of the numbers.
        clip: Range of the numbers; None for any.
    """

    column: str
    form: str = ""
    times: float = 1.0
    clip: tuple[float, float] | None = None


def file_of_preset(name: str | Path, folder: Path) -> Path:
    """Returns the file of a preset: a shipped one of the folder, or one of the user.

    Raises NotFoundError if there is none; the message has the shipped ones.
    """
    known = shipped_in(folder)
    if str(name) in known:
        return folder / f"{name}.yaml"
    if Path(name).suffix in (".yaml", ".yml"):
        return Path(name)
    raise NotFoundError(
        f"no preset '{name}'.{did_you_mean(str(name), known)} Presets: {', '.join(known)}, or a "
        "file: --preset mine.yaml"
    )


def shipped_in(folder: Path) -> list[str]:
    """Returns the names of the presets that come with robocell."""
    return sorted(file.stem for file in folder.glob("*.yaml"))


def read_fields(
    file: Path, what: str, fields: Sequence[str], module: str, extra: str, **shown: Any
) -> tuple[dict[str, Any], Place]:
    """Returns the content of a YAML file that is a table, and its place. Arguments: `read_yaml`."""
    content, place = read_yaml(file, what, module, extra, **shown)
    if not isinstance(content, dict):
        raise SpecError(f"{place} is a table with the fields {', '.join(fields)}")
    return content, place


def read_extended(
    name: str, folder: Path, read: Callable[..., tuple[dict[str, Any], Place]]
) -> tuple[dict[str, Any], Place, list[Path]]:
    """Returns the fields of a preset and of those that it extends, their place, and all files.

    Args:
        name: The preset.
        folder: Where the shipped presets of its kind are, which it may extend.
        read: Reads a file; the arguments are those of `read_fields`.
    """
    file = file_of_preset(name, folder).absolute()
    content, place = read(file, name=name, has_lines=file.parent != folder)
    base = content.pop(EXTENDS, None)
    if base is None:
        return content, place, [file]
    known = shipped_in(folder)
    if base not in known or file == folder / f"{base}.yaml":
        raise SpecError(
            f"{place.at(EXTENDS)} is a preset of robocell, {', '.join(known)}; got {base!r}"
        )
    inherited, place_of_base, files = read_extended(base, folder, read)
    return inherited | content, place.over(place_of_base), [file, *files]


def require_known(entry: Iterable[object], place: Place, fields: Sequence[str]) -> None:
    """Raises SpecError for a field that is not among these."""
    for name in entry:
        if name not in fields:
            raise SpecError(
                f"{place.near(str(name))}: no field '{name}'."
                f"{did_you_mean(str(name), fields)} Its fields: "
                f"{', '.join(fields)}"
            )


def image_size_of(size: object, place: Place, *, even: bool = False) -> tuple[int, int] | None:
    """Returns width and height of images; None where a file has none. Videos have even sides."""
    if size is None:
        return None
    step = 2 if even else 1
    if (
        isinstance(size, list)
        and len(size) == 2
        and all(type(side) is int and step <= side <= LARGEST_SIDE for side in size)
        and all(side % step == 0 for side in size)
    ):
        return size[0], size[1]
    numbers = "even numbers" if even else "whole numbers"
    raise SpecError(
        f"{place.at('image_size')} is width and height, {numbers} up to {LARGEST_SIDE} such as "
        f"[320, 180]; got {size!r}"
    )


def gripper_of(given: object, place: Place, *, snaps: bool = False) -> Gripper:
    """Returns the numbers of open and closed grippers. `snaps` allows the field `snap`."""
    if given is None:
        return AS_RECORDED
    place = place.at("gripper")
    if not isinstance(given, dict) or not {"open", "closed"} <= given.keys():
        raise SpecError(f"{place} is {{open: 1, closed: 0}}, got {given!r}")
    require_known(given, place, ("open", "closed", *([SNAP] if snaps else [])))
    numbers = [number_of(given[name], place.at(name)) for name in ("open", "closed")]
    if numbers[0] == numbers[1]:
        raise SpecError(f"{place}: open and closed are two numbers, got {numbers[0]:g} for both")
    snap = given.get(SNAP, False)
    if not isinstance(snap, bool):
        raise SpecError(f"{place.at(SNAP)} is true or false, got {snap!r}")
    return Gripper(numbers[0], numbers[1], snap)


def columns_of(
    listed: object,
    place: Place,
    forms: Sequence[str],
    *,
    clips: bool = False,
    may_be_empty: bool = False,
) -> list[ColumnEntry]:
    """Returns a list of columns. `forms` are the values of `as`; `clips` allows `clip`."""
    if not isinstance(listed, list) or not (listed or may_be_empty):
        raise SpecError(f"{place} is a list of columns, got {listed!r}")
    fields = ("column", "times", "as", *(["clip"] if clips else []))
    return [_entry(each, place.at(i), fields, forms) for i, each in enumerate(listed)]


def _entry(given: object, place: Place, fields: Sequence[str], forms: Sequence[str]) -> ColumnEntry:
    entry: Mapping[Any, Any] | object = {"column": given} if isinstance(given, str) else given
    if not isinstance(entry, Mapping) or not isinstance(entry.get("column"), str):
        raise SpecError(f"{place}: expected a column, or {{column: ...}}, got {given!r}")
    require_known(entry, place, fields)
    times = number_of(entry.get("times", 1.0), place.at("times"))
    if times == 0:
        raise SpecError(f"{place.at('times')} is not 0")
    form = entry.get("as", "")
    if form and form not in forms:
        raise SpecError(
            f"{place.near('as')}: no form '{form}'.{did_you_mean(str(form), forms)} There are: "
            f"{', '.join(forms)}"
        )
    return ColumnEntry(entry["column"], str(form), times, _clip(entry.get("clip"), place))


def _clip(clip: object, place: Place) -> tuple[float, float] | None:
    if clip is None:
        return None
    if isinstance(clip, list) and len(clip) == 2:
        lower, upper = (number_of(each, place.at("clip")) for each in clip)
        if lower < upper:
            return lower, upper
    raise SpecError(f"{place.at('clip')} is [lower, upper], got {clip!r}")


def number_of(value: object, place: Place) -> float:
    """Returns a finite number. Raises SpecError for anything else."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise SpecError(f"{place} is a number, got {value!r}")
    return float(value)
