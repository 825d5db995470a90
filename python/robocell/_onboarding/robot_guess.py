"""A robot file before it is written: values with comments on their reasons."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robocell._onboarding.source_model import SourceModel


@dataclass
class Field:
    """A value of the robot file with the comment above it."""

    value: Any
    comment: str = ""


@dataclass
class Group:
    """A move group; `other_fields` are tried when robocell cannot use it with its fields."""

    name: str
    fields: dict[str, Any]
    comment: str
    kind: str
    other_fields: dict[str, Any] | None = None


@dataclass
class RobotGuess:
    """A robot file before it is written.

    Attributes:
        source: The model that the file names: the given one, or one made from it.
        prepared: Why that model had to be made; empty for the given one.
        tool_places: Where a hand could be mounted: the TCP of each arm that has none.
        notes: What could not be guessed or cannot be used yet, with the next step.
    """

    name: str
    source: SourceModel
    original: Path
    prepared: list[str]
    root_body: Field
    base: Field
    reset_root_pose: bool = False
    edits: list[Field] = field(default_factory=list)
    groups: list[Group] = field(default_factory=list)
    home: dict[str, list[float]] = field(default_factory=dict)
    home_comment: str = ""
    home_noise: dict[str, list[float]] = field(default_factory=dict)
    control: dict[str, str] = field(default_factory=dict)
    cameras: list[Field] = field(default_factory=list)
    camera_note: str = ""
    streams: list[tuple[str, str]] = field(default_factory=list)
    gravcomp: Field | None = None
    reach: float = 0.0
    tool_places: list[dict[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def of_kind(self, kind: str) -> list[Group]:
        """Returns the groups of a kind."""
        return [group for group in self.groups if group.kind == kind]

    def free_name(self, name: str) -> str:
        """Returns the name, with a number if a group has it already."""
        taken = {group.name for group in self.groups}
        free, number = name, 2
        while free in taken:
            free, number = f"{name}{number}", number + 1
        return free
