"""Numbers of a policy's vectors: those of columns of the cell in other units and forms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Pose, SpecError
from robocell._placeholders import Gripper, is_difference
from robocell._yaml import Place

FORMS = ("position", "rotation_vector")

Array = NDArray[Any]


@dataclass(frozen=True)
class Part:
    """Components of a vector that come from one column, or are one.

    Attributes:
        column: Name of the column, with {robot}, {arm} or {gripper}.
        times: The policy's numbers are the column's multiplied by this.
        clip: Range of the policy's numbers in actions.
        form: "position" or "rotation_vector" of a pose or a displacement; "" for all of it.
    """

    column: str
    times: float = 1.0
    clip: tuple[float, float] | None = None
    form: str = ""


@dataclass(frozen=True)
class Sized:
    """A part for one column of a cell.

    Attributes:
        part: The part.
        column: The column.
        size: Its number of components.
        gripper: Polarity, if the column is an opening.
    """

    part: Part
    column: str
    size: int
    gripper: Gripper | None = None

    @property
    def width(self) -> int:
        """Number of components in the policy's vector."""
        return 3 if self.part.form else self.size

    def to_policy(self, values: Array) -> Array:
        """Returns the policy's numbers for the column, (n,) or (k, n)."""
        if self.part.form == "position":
            values = values[..., :3]
        elif self.part.form and self.size == 7:
            rows = [Pose(quaternion=row[3:]).rotvec for row in np.atleast_2d(values)]
            values = np.reshape(rows, (*values.shape[:-1], 3))
        elif self.part.form:
            values = values[..., 3:]
        if self.gripper is not None:
            values = self.gripper.of(values, is_difference(self.column))
        return values * self.part.times

    def from_policy(self, numbers: Array) -> Array:
        """Returns the column's components for the policy's numbers, (n,) or (k, n)."""
        if self.part.clip is not None:
            numbers = np.clip(numbers, *self.part.clip)
        values = numbers / self.part.times
        if self.gripper is None:
            return values
        return self.gripper.opening(values, is_difference(self.column))


def split(vector: Array, parts: Sequence[Sized]) -> dict[str, Array]:
    """Returns the columns of a policy's vector, (n,) or (k, n)."""
    columns: dict[str, Array] = {}
    halves: dict[str, dict[str, Array]] = {}
    sizes = {each.column: each.size for each in parts}
    start = 0
    for each in parts:
        values = each.from_policy(np.asarray(vector[..., start : start + each.width], np.float64))
        start += each.width
        if each.part.form:
            halves.setdefault(each.column, {})[each.part.form] = values
            columns.setdefault(each.column, values)  # keeps the order
        else:
            columns[each.column] = values
    for column, forms in halves.items():
        columns[column] = _joined(forms, sizes[column])
    return columns


def _joined(forms: Mapping[str, Array], size: int) -> Array:
    """Returns a pose (7) or a displacement (6) of its position and its rotation vector."""
    position, rotation = (forms[form] for form in FORMS)
    if size == 7:
        rows = [Pose(rotvec=row).quaternion for row in np.atleast_2d(rotation)]
        rotation = np.reshape(rows, (*rotation.shape[:-1], 4))
    return np.concatenate([position, rotation], axis=-1)


def require_complete(parts: Sequence[Sized], place: Place) -> None:
    """Raises SpecError for forms that the columns do not have, and for half of a pose."""
    forms: dict[str, list[str]] = {}
    for each in parts:
        if each.part.form and each.size not in (6, 7):
            raise SpecError(
                f"{place}: '{each.column}' has {each.size} numbers, and `as` is for poses and "
                "displacements"
            )
        forms.setdefault(each.column, []).append(each.part.form)
    for column, found in forms.items():
        if sorted(found) not in ([""], sorted(FORMS)):
            raise SpecError(
                f"{place}: '{column}' stands there once, or once as position and once as "
                f"rotation_vector; it stands there {len(found)} times"
            )
