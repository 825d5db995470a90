"""What {robot}, {arm}, {gripper} and a|b mean in mapping files and presets; numbers of grippers.

Exports and policies read their files with the same words, so what one trains on is what the other
is sent: the same robots in the same order, with grippers of the same polarity.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from robocell._core import Episode, NotFoundError, SpecError
from robocell._suggestions import did_you_mean, fitting, is_pattern
from robocell._yaml import Place

OPENING = "opening"  # the component of every gripper column
RELATIVE = "_relative"  # the end of the name of a column of differences
OF_THE_TCP = ("tcp_pose", "tcp_displacement")  # actions that are of no group
ROBOT, ARM, GRIPPER = "{robot}", "{arm}", "{gripper}"
OF_COLUMNS = (ROBOT, ARM, GRIPPER)


@dataclass(frozen=True)
class Groups:
    """The move groups of one robot that have actions."""

    arms: tuple[str, ...] = ()
    grippers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Gripper:
    """The numbers that stand for an open and a closed gripper.

    Attributes:
        open: For opening 1.
        closed: For opening 0.
        snap: What a policy says between the two becomes the nearer one.
    """

    open: float = 1.0
    closed: float = 0.0
    snap: bool = False

    def of(self, opening: NDArray[Any], is_difference: bool = False) -> NDArray[Any]:
        """Returns the numbers of openings from 0 (closed) to 1 (open), or of their differences."""
        if self == AS_RECORDED:
            return opening
        return (self.open - self.closed) * opening + (0 if is_difference else self.closed)

    def opening(self, numbers: NDArray[Any], is_difference: bool = False) -> NDArray[Any]:
        """Returns the openings for numbers, or their differences: `of` backwards."""
        if is_difference:
            return numbers / (self.open - self.closed)
        opening: NDArray[Any] = (numbers - self.closed) / (self.open - self.closed)
        return np.where(opening > 0.5, 1.0, 0.0) if self.snap else opening


AS_RECORDED = Gripper()


class _Entry(Protocol):
    @property
    def column(self) -> str: ...


E = TypeVar("E", bound=_Entry)


def is_opening(column: str, names: Sequence[str]) -> bool:
    """Returns True for a column of openings of grippers, or of their differences."""
    return column.rpartition("/")[2] == OPENING or list(names) == [OPENING]


def is_opening_of(episode: Episode, name: str) -> bool:
    """Returns True for a column of an episode with openings of grippers, or their differences.

    An action of one number whose component has no name counts too, if its group is called
    "gripper", or if the robot has a column `opening` and the group no joints: so people record it.
    """
    column = episode.column(name)
    parts = name.split("/")
    if is_opening(name, column.names) or column.names or math.prod(column.shape[1:]) != 1:
        return is_opening(name, column.names)
    if len(parts) != 4 or parts[0] != "robots" or parts[2] != "action":
        return False
    robot, group = parts[1], parts[3].removesuffix(RELATIVE)
    columns = set(episode.columns)
    has_joints = f"robots/{robot}/{group}/qpos" in columns
    return group == "gripper" or (f"robots/{robot}/{OPENING}" in columns and not has_joints)


def is_difference(column: str) -> bool:
    """Returns True for a column of differences."""
    return column.endswith(RELATIVE)


def groups_of(columns: Iterable[str], openings: Collection[str]) -> dict[str, Groups]:
    """Returns the robots with their groups, in the order of the columns that command them.

    Args:
        columns: Columns of actions; others are passed over.
        openings: Those that are openings of grippers.
    """
    found: dict[str, Groups] = {}
    for name in columns:
        parts = name.split("/")
        if len(parts) != 4 or parts[0] != "robots" or parts[2] != "action":
            continue
        robot, group = parts[1], parts[3]
        if group in OF_THE_TCP or is_difference(group):
            continue
        known = found.get(robot, Groups())
        if name in openings:
            found[robot] = replace(known, grippers=(*known.grippers, group))
        else:
            found[robot] = replace(known, arms=(*known.arms, group))
    return found


def require_placeholders(text: str, place: Place, allowed: Sequence[str]) -> None:
    """Raises SpecError for a text with a placeholder that is not among `allowed`."""
    used = re.findall(r"\{[^{}]*\}", text)
    there = f"There are: {', '.join(allowed)}" if allowed else "There are none here"
    for each in used:
        if each not in allowed:
            near = did_you_mean(each, allowed)
            raise SpecError(f"{place}: no placeholder '{each}' in '{text}'.{near} {there}")
    if text.count("{") + text.count("}") != 2 * len(used):
        raise SpecError(f"{place}: '{text}' has a brace without its other one. {there}")


def require_column(column: str, place: Place, more: Sequence[str] = ()) -> None:
    """Raises SpecError for a column whose placeholders stand for nothing.

    Args:
        column: The name, as written in a file.
        place: Begins error messages.
        more: Placeholders of the feature's name, which its columns may have too.
    """
    require_placeholders(column, place, [*OF_COLUMNS, *(each for each in more if each != ARM)])
    groups = [each for each in (ARM, GRIPPER) if each in column and each not in more]
    if groups and ROBOT not in column:
        raise SpecError(
            f"{place}: '{column}' has {groups[0]} without {ROBOT}. Write 'robots/{ROBOT}/...', or "
            "the name of the group"
        )
    if len(groups) > 1:
        raise SpecError(
            f"{place}: '{column}' has {ARM} and {GRIPPER}, which are different groups. Write a "
            "column for each"
        )


def expanded(entries: Iterable[E], groups: Mapping[str, Groups]) -> Iterator[tuple[E, str]]:
    """Yields each entry with the names that its column stands for.

    Entries with {robot} that follow each other are repeated together: arm, gripper, arm, ...
    """
    for of_robots, run in itertools.groupby(entries, lambda entry: "{robot}" in entry.column):
        each = list(run)
        for robot in groups if of_robots else [""]:
            own = groups.get(robot, Groups())
            for entry in each:
                for name in _repeated(entry.column.replace("{robot}", robot), own):
                    yield entry, name


def _repeated(name: str, groups: Groups) -> list[str]:
    for placeholder, each in (("{arm}", groups.arms), ("{gripper}", groups.grippers)):
        if placeholder in name:
            return [name.replace(placeholder, group) for group in each]
    return [name]


def first_of(entry: str, known: Sequence[str]) -> list[str]:
    """Returns what the first alternative of "a|b*?" that fits names, or nothing."""
    for name in entry.rstrip("?").split("|"):
        if not is_pattern(name):
            found = [name] if name in known else []
        else:
            try:
                found = fitting("", [name], known)
            except NotFoundError:
                found = []
        if found:
            return found
    return []


def camera_of(entry: str, cameras: Sequence[str], taken: Collection[str]) -> str | None:
    """Returns the camera that an entry names: the first that fits and is not taken, or None.

    An entry that is a name alone may name a camera that is taken.
    """
    is_name = "|" not in entry and not is_pattern(entry)
    free = [camera for camera in cameras if is_name or camera not in taken]
    return next(iter(first_of(entry, free)), None)
