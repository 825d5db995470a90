"""What {robot}, {arm}, {gripper} and a|b mean in mapping files and presets; numbers of grippers.

Exports and policies read their files with the same words, so what one trains on is what the other
is sent: the same robots in the same order, with grippers of the same polarity.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from robocell._core import NotFoundError, SpecError
from robocell._suggestions import did_you_mean, fitting, is_pattern
from robocell._yaml import Place

OPENING = "opening"  # the component of every gripper column
GRIPPER_GROUP = "gripper"  # the usual name of a gripper's group
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


@dataclass(frozen=True)
class Column:
    """The size, names of components and unit of a column, by which openings are recognised."""

    size: int
    names: tuple[str, ...] = ()
    units: str = ""


@dataclass(frozen=True)
class Openings:
    """The columns of openings.

    Attributes:
        columns: Openings, commands of openings, and their differences.
        unclear: Robot -> its commands of which one may be the gripper's, where nothing says which.
    """

    columns: frozenset[str]
    unclear: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def openings_of(columns: Mapping[str, Column]) -> Openings:
    """Finds the openings of grippers among the columns of an episode.

    robocell names the components of its openings. In a recording without such names, a command is
    one of an opening if it is a single number without a unit, and

    - its group is called "gripper", or
    - its robot has a measured opening, `robots/<robot>/opening`, and no other command can be it.
    """
    found = {name for name, column in columns.items() if is_opening(name, column.names)}
    unclear: dict[str, tuple[str, ...]] = {}
    for robot, groups in _commanded(columns).items():
        command = f"robots/{robot}/action/{{}}".format
        if any(command(group) in found for group in groups):
            continue
        free = [group for group in groups if _may_be_opening(columns[command(group)])]
        own = [group for group in free if group == GRIPPER_GROUP]
        if not own and f"robots/{robot}/opening" in columns:
            # A single joint has its own position beside the command.
            own = [group for group in free if not _is_joint(columns, robot, group)]
            if len(own) != 1:
                unclear |= {robot: tuple(map(command, free))} if free else {}
                continue
        for group in own:
            names = (
                command(group),
                f"{command(group)}{RELATIVE}",
                f"robots/{robot}/{group}/target",
            )
            found |= {name for name in names if name in columns}
    return Openings(frozenset(found), unclear)


def _commanded(columns: Iterable[str]) -> dict[str, list[str]]:
    """Returns the groups that each robot has commands of."""
    groups: dict[str, list[str]] = {}
    for name in columns:
        parts = name.split("/")
        is_command = len(parts) == 4 and parts[0] == "robots" and parts[2] == "action"
        if is_command and parts[3] not in OF_THE_TCP and not is_difference(parts[3]):
            groups.setdefault(parts[1], []).append(parts[3])
    return groups


def _may_be_opening(column: Column) -> bool:
    return column.size == 1 and column.units in ("", "1")


def _is_joint(columns: Mapping[str, Column], robot: str, group: str) -> bool:
    qpos = columns.get(f"robots/{robot}/{group}/qpos")
    return qpos is not None and qpos.size == 1


def is_difference(column: str) -> bool:
    """Returns True for a column of differences."""
    return column.endswith(RELATIVE)


def groups_of(columns: Iterable[str], openings: Collection[str]) -> dict[str, Groups]:
    """Returns the robots with their groups, in the order of the columns that command them.

    Args:
        columns: Columns of actions; others are passed over.
        openings: Those that are openings of grippers.
    """
    return {
        robot: Groups(
            arms=tuple(g for g in groups if f"robots/{robot}/action/{g}" not in openings),
            grippers=tuple(g for g in groups if f"robots/{robot}/action/{g}" in openings),
        )
        for robot, groups in _commanded(columns).items()
    }


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
