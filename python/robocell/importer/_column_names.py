"""Names of columns and cameras for what another dataset has: by rule, or by a file of the user.

columns:
  observation.state: {robots/arm/arm/qpos: [0, 7], robots/arm/opening: [7, 8]}  # parts
  action: robots/arm/action/arm  # another name
  observation.velocity: null     # left out
cameras:
  observation.images.top: exo
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, NotFoundError, SpecError
from robocell._suggestions import did_you_mean
from robocell._yaml import Place, read_yaml
from robocell.importer._entries import is_text
from robocell.importer._recording import Column, Origin, Recording

Part = tuple[str, int | None, int | None]  # a column, and its first and last component
FIELDS = ("columns", "cameras")
TIME = "time"  # a column of every episode, made from the rate
SLASH = re.compile("/")
LONGEST_NAME = 200  # bytes, so that a file can have it with a suffix
RENAMED = "A mapping file gives another name: --mapping FILE"


@dataclass(frozen=True)
class Names:
    """The names of a file of the user.

    Attributes:
        place: The file, which begins error messages; None without one.
        columns: Parts of each column; without parts it is left out.
        cameras: Camera of each name; None leaves it out.
    """

    place: Place | None = None
    columns: dict[str, tuple[Part, ...]] = field(default_factory=dict)
    cameras: dict[str, str | None] = field(default_factory=dict)

    @classmethod
    def load(cls, file: Path) -> Names:
        """Reads a file.

        Raises:
            SpecError: It is not such a table.
            IoError: It cannot be read.
        """
        content, place = read_yaml(file, "mapping", "robocell.importer", "export")
        if not isinstance(content, dict):
            raise SpecError(f"{place} is a table with the fields {', '.join(FIELDS)}")
        for name in content:
            if name not in FIELDS:
                raise SpecError(
                    f"{place.near(str(name))}: no field '{name}'."
                    f"{did_you_mean(str(name), FIELDS)} Its fields: {', '.join(FIELDS)}"
                )
        columns, cameras = (content.get(name) or {} for name in FIELDS)
        for name, table in zip(FIELDS, (columns, cameras), strict=True):
            if not isinstance(table, dict):
                raise SpecError(f"{place.at(name)} is a table of names, got {table!r}")
            for key in table:
                if not isinstance(key, str):
                    raise SpecError(f"{place.at(name)} is a table of names, not of {key!r}")
        for name, camera in cameras.items():
            if not isinstance(camera, str | None):
                raise SpecError(f"{place.at('cameras', name)} is a name or null, got {camera!r}")
            if camera is not None and not is_file_name(camera):
                raise SpecError(
                    f"{place.at('cameras', name)} is {camera!r}, which no file can have"
                )
        return cls(
            place,
            {name: _parts(place.at("columns", name), entry) for name, entry in columns.items()},
            cameras,
        )

    def require_known(self, recording: Recording) -> None:
        """Raises NotFoundError for a name that the first recording does not have."""
        if self.place is None:
            return
        for what, own, known in (
            ("column", self.columns, recording.columns),
            ("camera", self.cameras, recording.images),
        ):
            for name in own:
                if name not in known:
                    raise NotFoundError(
                        f"{self.place.near(f'{what}s', name)}: the dataset has no {what} '{name}'."
                        f"{did_you_mean(name, known)} It has: {', '.join(known) or 'none'}"
                    )

    def columns_of(self, recording: Recording, origin: Origin) -> dict[str, Column]:
        """Reads the columns that an episode will have.

        Raises:
            ArgumentError: Two columns have the same name, a name cannot be one of an episode, or a
                part is outside of its column.
        """
        found: dict[str, Column] = {}
        for name, read in recording.columns.items():
            targets = self._targets(name, origin)
            if not targets:
                continue
            column = read()
            for target, first, last in targets:
                if target in found:
                    raise _same("columns", target, name)
                _require_path(target, name)
                found[target] = column
                if first is not None:
                    assert self.place is not None, "only a file has parts"
                    place = self.place.near("columns", name, target)
                    found[target] = _part(column, name, first, last, f"{place}: '{target}'")
        return _apart(found)

    def _targets(self, name: str, origin: Origin) -> tuple[Part, ...]:
        if name in self.columns:
            return self.columns[name]
        own = origin.column_name(name)
        return () if own in (None, TIME) else ((own, None, None),)

    def cameras_of(self, images: Iterable[str]) -> dict[str, str]:
        """Returns the camera of each name of images."""
        found: dict[str, str] = {}
        for name in images:
            camera = self.cameras.get(name, _camera(name))
            if camera is None:
                continue
            if camera in found.values():
                raise _same("cameras", camera, name)
            if not is_file_name(camera):
                raise ArgumentError(f"camera {name!a} cannot be the name of a video. {RENAMED}")
            found[name] = camera
        return found


def _camera(name: str) -> str:
    """Returns "top" for observation.images.top, obs/top_image and observations/images/top."""
    short = name.replace(".", "/")
    for start in ("observation/images/", "observations/images/", "obs/"):
        short = short.removeprefix(start)
    short = short.removesuffix("_image")
    return short.replace("/", "_") or name


def is_file_name(name: str) -> bool:
    """Whether a name can be that of a file, as the names of episodes' cameras are."""
    return (
        is_text(name)
        and name not in ("", ".", "..")
        and "/" not in name
        and all(character >= " " and character != "\x7f" for character in name)
        and len(name.encode()) <= LONGEST_NAME
    )


def _require_path(target: str, name: str) -> None:
    """Raises ArgumentError for a column whose name an episode cannot have."""
    first, *_ = parts = target.split("/")
    if not all(map(is_file_name, parts)) or first == "cameras":
        raise ArgumentError(
            f"column {name!a} would be {target!a}, which no column of an episode can be. {RENAMED}"
        )


def _same(what: str, target: str, name: str) -> ArgumentError:
    return ArgumentError(f"two {what} would be '{target}', one of them '{name}'. {RENAMED}")


def _parts(place: Place, entry: Any) -> tuple[Part, ...]:
    if entry is None:
        return ()
    if entry == TIME or (isinstance(entry, dict) and TIME in entry):
        raise SpecError(f"{place}: '{TIME}' is made from the rate; choose another")
    if isinstance(entry, str):
        return ((entry, None, None),)
    if isinstance(entry, dict) and all(
        isinstance(column, str)
        and isinstance(bounds, list)
        and len(bounds) == 2
        and all(isinstance(each, int) and not isinstance(each, bool) for each in bounds)
        and 0 <= bounds[0] < bounds[1]
        for column, bounds in entry.items()
    ):
        return tuple((column, first, last) for column, (first, last) in entry.items())
    raise SpecError(
        f"{place} is a column, null, or parts such as {{robots/arm/arm/qpos: "
        f"[0, 7]}}; got {entry!r}"
    )


def _part(column: Column, name: str, first: int, last: int | None, place: str) -> Column:
    size = column.values.shape[1] if column.values.ndim == 2 else 1
    if last is None or last > size:
        raise ArgumentError(
            f"{place}: '{name}' has {size} numbers; the part [{first}, {last}] ends outside"
        )
    values = column.values[:, first:last] if column.values.ndim == 2 else column.values
    names = column.names[first:last] if len(column.names) == size else ()
    return Column(values, names)


def _apart(columns: Mapping[str, Column]) -> dict[str, Column]:
    """Returns the columns; one whose name begins the names of others becomes `<name>/value`."""
    groups = {name[: slash.start()] for name in (*columns, TIME) for slash in SLASH.finditer(name)}
    found: dict[str, Column] = {}
    for name, column in columns.items():
        target = f"{name}/value" if name in groups else name
        if target in found or (target != name and target in columns):
            raise _same("columns", target, name)
        if target.startswith(f"{TIME}/"):
            raise ArgumentError(f"column '{name}' would be inside of '{TIME}'. {RENAMED}")
        found[target] = column
    return found
