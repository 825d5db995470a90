"""The features of a training dataset: which columns of an episode each is made of, and its numbers.

`Term` is one column, or a part of it; `Feature` is terms side by side, with the name, unit and
frame of every component. All episodes of an export must have the same features.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Episode
from robocell._placeholders import AS_RECORDED, OPENING, Gripper, is_difference
from robocell._suggestions import shortened

DONE = "done"  # a column that is not stored: terminated or truncated
# Parts of a column that an entry can ask for.
PARTS = ("position", "quaternion", "rotation_vector", "wxyz", "velocity")
WXYZ = [0, 1, 2, 6, 3, 4, 5]  # of a pose x y z, qx qy qz qw


@dataclass(frozen=True)
class Term:
    """A column of an episode, as a feature uses it.

    Attributes:
        column: Name or pattern of the column.
        part: One of `PARTS`, or "" for the whole column. "position" and "rotation_vector" are those
            of a pose or a displacement, "quaternion" is that of a pose, "wxyz" is a pose whose
            quaternion begins with w, "velocity" is the change since the row before, per second.
        times: Factor of the numbers.
    """

    column: str
    part: str = ""
    times: float = 1.0


@dataclass(frozen=True)
class Feature:
    """One feature, made of columns of an episode side by side.

    Attributes:
        name: Name in the training dataset.
        terms: Columns of the episode.
        dtype: "float32", "int64" or "bool".
        names: One name for each component.
        units: One unit for each component; "" for none.
        frames: The frame of each component's column; "" for none.
        sources: The column of each component.
        gripper: The numbers of open and closed grippers.
        openings: The columns that are openings of grippers.
    """

    name: str
    terms: tuple[Term, ...]
    dtype: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    frames: tuple[str, ...]
    sources: tuple[str, ...]
    gripper: Gripper = AS_RECORDED
    values: tuple[str, ...] = field(default=(), compare=False)
    openings: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """The number of components."""
        return len(self.names)

    def read(self, episode: Episode) -> NDArray[Any]:
        """Returns the feature in all rows of an episode, (rows, size).

        Raises:
            ArgumentError: A number is NaN, infinite or beyond the type.
        """
        whole = np.concatenate([self._read(episode, term) for term in self.terms], axis=1)
        if self.dtype != "float32":
            return whole.astype(self.dtype)
        with np.errstate(over="ignore"):
            numbers = whole.astype(np.float32)
        bad = np.argwhere(~np.isfinite(numbers))
        if len(bad):
            row, component = bad[0]
            raise ArgumentError(
                f"episode '{episode.folder}': column '{self.sources[component]}' is "
                f"{whole[row, component]} in row {row}, which '{self.name}' cannot hold. Leave the "
                "column out with --mapping, or the episode with --episodes"
            )
        return numbers

    def _read(self, episode: Episode, term: Term) -> NDArray[Any]:
        column = _column(episode, term.column)
        values = column.reshape(len(column), -1)
        if self.values:
            values = self._numbered(episode, term.column, values)
        if term.column in self.openings:
            values = self.gripper.of(values, is_difference(term.column))
        if term.part:
            values = _part(episode, term, values)
        return values if term.times == 1 else values * term.times

    def _numbered(self, episode: Episode, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """Returns the numbers of named values in all episodes, for those of one episode."""
        own = tuple(episode.column(name).values)
        if values.size and not (values.min() >= 0 and values.max() < len(own)):
            names = f"it names 0 to {len(own) - 1}" if own else "it names none"
            raise ArgumentError(
                f"episode '{episode.folder}': column '{name}' has values without a name: {names}, "
                f"and has {values.min()} to {values.max()}. Leave the column out with --mapping, "
                "or the episode with --episodes"
            )
        if own == self.values[: len(own)]:
            return values
        return np.array([self.values.index(each) for each in own])[values]


@dataclass(frozen=True)
class Resolved:
    """A mapping applied to one episode."""

    features: tuple[Feature, ...]
    images: dict[str, str]
    task: str
    robots: tuple[str, ...]

    def with_values_of(self, other: Resolved) -> Resolved:
        """Returns it with the named values of another episode too, after its own."""
        theirs = {feature.name: feature.values for feature in other.features}
        features = tuple(
            replace(each, values=tuple(dict.fromkeys((*each.values, *theirs[each.name]))))
            for each in self.features
        )
        return replace(self, features=features)

    def require_same(self, other: Resolved, episode: Episode, first: Episode) -> None:
        """Raises ArgumentError unless another episode has the same features."""
        place = f"episode '{episode.folder}' cannot be in one dataset with '{first.folder}'"
        remedy = "Export them apart: --episodes, or give them the same columns: --mapping"
        own = {feature.name: feature for feature in self.features}
        others = {feature.name: feature for feature in other.features}
        for name in own.keys() ^ others.keys():
            has = "has no" if name in own else "also has"
            raise ArgumentError(f"{place}: it {has} '{name}'. {remedy}")
        for name, feature in own.items():
            there = others[name]
            if feature.size != there.size:
                raise ArgumentError(
                    f"{place}: its '{name}' has {there.size} numbers instead of {feature.size}. "
                    f"{remedy}"
                )
            for what in ("names", "units", "frames", "dtype"):
                ours, theirs = getattr(feature, what), getattr(there, what)
                if ours != theirs:
                    raise ArgumentError(
                        f"{place}: the {what} of its '{name}' are {_text(theirs)} instead of "
                        f"{_text(ours)}. {remedy}"
                    )
            read, read_there = (
                sorted({term.column for term in each.terms}) for each in (feature, there)
            )
            if read != read_there:
                raise ArgumentError(
                    f"{place}: its '{name}' is made of {_text(read_there)} instead of "
                    f"{_text(read)}. "
                    f"{remedy}"
                )
        if self.images != other.images:
            raise ArgumentError(
                f"{place}: its cameras are {_text(other.images.values())} instead of "
                f"{_text(self.images.values())}. Choose those that all have: --cameras"
            )


def feature_of(
    episode: Episode,
    name: str,
    terms: list[Term],
    robots: list[str],
    gripper: Gripper,
    openings: Collection[str],
) -> Feature:
    """Describes a feature by the columns of an episode, of which `openings` are of grippers.

    Raises:
        ArgumentError: A column cannot be part of a feature.
    """
    names: list[str] = []
    units: list[str] = []
    frames: list[str] = []
    sources: list[str] = []
    kinds = []
    values: tuple[str, ...] = ()
    for term in terms:
        if term.column == DONE:
            own, own_units, frame, kind = [DONE], [""], "", "bool"
        else:
            column = episode.column(term.column)
            size = int(np.prod(column.row_shape))
            of_column = [OPENING] if term.column in openings else list(column.names)
            own = _component_names(term.column, of_column, size, robots)
            split = [unit.strip() for unit in column.units.split(",")] if column.units else [""]
            own_units = split if len(split) == size else _spread(split, size)
            frame, kind = column.frame, column.dtype
            values = tuple(column.values) if len(terms) == 1 else ()
        if term.part:
            _require_part(episode, name, term, len(own))
            own, own_units = _part_names(term.part, own, own_units)
        if term.times != 1:
            own_units = [f"{1 / term.times:g} {unit}".strip() for unit in own_units]
        if term.part or term.times != 1:
            kind = "float32"
        names += own
        units += own_units
        frames += [frame] * len(own)
        sources += [term.column] * len(own)
        kinds.append(kind)
    if any(np.dtype(kind).kind not in "fiub" for kind in kinds):
        raise ArgumentError(
            f"episode '{episode.folder}': '{name}' would hold a column of texts; features are "
            f"numbers: {', '.join(term.column for term in terms)}"
        )
    if len(set(names)) != len(names):
        names = [f"{source}.{each}" for source, each in zip(sources, names, strict=True)]
    dtype = "float32"
    if all(np.dtype(kind).kind == "b" for kind in kinds):
        dtype = "bool"
    elif all(np.dtype(kind).kind in "iub" for kind in kinds):
        dtype = "int64"
    return Feature(
        name, tuple(terms), dtype, tuple(names), tuple(units), tuple(frames), tuple(sources),
        gripper, values, tuple(sorted({*sources} & {*openings})),
    )  # fmt: skip


def rotation_vectors(quaternions: NDArray[Any]) -> NDArray[Any]:
    """Returns axis times angle of quaternions x, y, z, w: (rows, 3), angles from 0 to pi."""
    q = np.asarray(quaternions, np.float64)
    q = np.where(q[:, 3:] < 0, -q, q)
    length = np.linalg.norm(q[:, :3], axis=1, keepdims=True)
    angle = 2 * np.arctan2(length, q[:, 3:])
    # Close to zero, the angle is twice the length.
    per_length = np.divide(angle, length, out=np.full_like(length, 2), where=length > 1e-12)
    return np.asarray(q[:, :3] * per_length)


def _part(episode: Episode, term: Term, values: NDArray[Any]) -> NDArray[Any]:
    if term.part == "position":
        return values[:, :3]
    if term.part == "quaternion":
        return values[:, 3:]
    if term.part == "wxyz":
        return values[:, WXYZ]
    if term.part == "rotation_vector":
        return rotation_vectors(values[:, 3:]) if values.shape[1] == 7 else values[:, 3:]
    rates = np.zeros(values.shape)
    rates[1:] = np.diff(values, axis=0) / np.diff(episode["time"])[:, None]
    return rates


def _require_part(episode: Episode, feature: str, term: Term, size: int) -> None:
    place = f"episode '{episode.folder}': '{feature}': column '{term.column}'"
    if term.part == "velocity":
        if "time" not in episode:
            raise ArgumentError(f"{place}: a velocity needs the column 'time' beside it")
        return
    sizes = {7: "a pose", 6: "a displacement"}
    if size not in sizes or (term.part in ("quaternion", "wxyz") and size != 7):
        raise ArgumentError(
            f"{place} has {size} numbers and no {term.part}; poses have 7, displacements 6"
        )


def _part_names(part: str, names: list[str], units: list[str]) -> tuple[list[str], list[str]]:
    if part == "position":
        return names[:3], units[:3]
    if part == "quaternion":
        return names[3:], units[3:]
    if part == "wxyz":
        return [names[i] for i in WXYZ], [units[i] for i in WXYZ]
    if part == "rotation_vector":
        prefix = names[0].rpartition(".")[0]  # the robot, where there are several
        axes = [f"r{axis}" for axis in "xyz"]
        return [f"{prefix}.{axis}" if prefix else axis for axis in axes], ["rad"] * 3
    return names, [f"{unit or '1'}/s" for unit in units]


def _column(episode: Episode, name: str) -> NDArray[Any]:
    if name != DONE:
        return episode[name]
    ends = [episode[each] for each in ("terminated", "truncated") if each in episode]
    done: NDArray[Any] = np.logical_or.reduce(ends) if ends else np.zeros(len(episode), bool)
    if len(done):
        done[-1] = True
    return done


def _component_names(column: str, names: list[str], size: int, robots: list[str]) -> list[str]:
    """Returns names without the prefix of the robot in the scene; with several robots, with it."""
    last = column.rpartition("/")[2]
    if len(names) != size:
        names = [last] if size == 1 else [f"{last}_{i}" for i in range(size)]
    short = [name.rpartition("/")[2] for name in names]
    parts = column.split("/")
    if len(robots) > 1 and parts[0] == "robots":
        return [f"{parts[1]}.{name}" for name in short]
    return short


def _spread(units: list[str], size: int) -> list[str]:
    """Returns a unit for each component: "m, 1" of a pose is three metres and a quaternion."""
    if len(units) == 1:
        return units * size
    if len(units) == 2 and size in (6, 7):
        return [units[0]] * 3 + [units[1]] * (size - 3)
    return [", ".join(units)] * size


def _text(values: Iterable[str] | str) -> str:
    return values if isinstance(values, str) else shortened(list(values)) or "none"
