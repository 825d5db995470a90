"""Presets: how a policy of other code names what it sees and does, and in which units.

    preset = Preset.load("droid")
    bound = preset.bind(features, ["wrist", "exo"])  # the cell's features and image streams
    message = bound.message(row, "pick up the cube")  # what the policy is sent
    bound.columns(actions)  # {"robots/fr3/action/arm_relative": (10, 7), ...}

A preset is a YAML file: names of observations and images, the size of images, the representation of
actions, the polarity of grippers. docs/presets.md describes its fields.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Feature, NotFoundError
from robocell._placeholders import Gripper, camera_of, expanded, groups_of, is_opening
from robocell._policy_presets.images import resize_with_pad
from robocell._policy_presets.parts import Part, Sized, require_complete, split
from robocell._policy_presets.reading import read_preset, shipped_presets
from robocell._suggestions import counted, did_you_mean, shortened
from robocell._yaml import Place

__all__ = ["Bound", "Preset", "shipped_presets"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Preset:
    """How a policy names observations and actions.

    Attributes:
        name: Name of a shipped preset, or the path of a file.
        files: The files that it was read from.
        observation: Parts of each vector that the policy sees.
        images: Image stream of each image that it sees, as alternatives and patterns.
        image_size: Width and height of images, with bars that keep the ratio of the sides; None for
            those of the streams.
        channels_first: Images are (3, height, width) instead of (height, width, 3).
        prompt: Name of the instruction; "" for none.
        actions: Parts of a row of actions, in order.
        action_space: What RoboArena's servers call these actions; "" for nothing.
        gripper: Numbers of open and closed grippers.
        horizon: Actions of a chunk that are taken before the next call; None for all.
        rate: Actions per second that the policy was trained at; None if unknown.
        place: Its file; it begins error messages.
    """

    name: str
    files: tuple[Path, ...]
    observation: Mapping[str, tuple[Part, ...]]
    images: Mapping[str, str]
    image_size: tuple[int, int] | None
    channels_first: bool
    prompt: str
    actions: tuple[Part, ...]
    action_space: str
    gripper: Gripper
    horizon: int | None
    rate: float | None
    place: Place = field(repr=False, compare=False)

    @classmethod
    def load(cls, name: str | Path) -> Preset:
        """Reads a preset by its name, or from a file that ends in .yaml or .yml.

        Raises:
            NotFoundError: There is no preset of this name.
            SpecError: The file is not a preset; the message names the field.
            IoError: The file cannot be read.
        """
        return cls(**read_preset(name))

    def bind(self, features: Sequence[Feature], cameras: Sequence[str]) -> Bound:
        """Applies the preset to a cell.

        Args:
            features: Features that the cell observes and commands.
            cameras: Its image streams.

        Raises:
            NotFoundError: The cell has no such column or camera.
            SpecError: The preset does not fit its columns.
        """
        cell = _Cell(features)
        seen = replace(self.gripper, snap=False)
        return Bound(
            self,
            {
                name: cell.expand(parts, seen, self.place.at("observation", name))
                for name, parts in self.observation.items()
            },
            self._cameras(cameras),
            cell.expand(self.actions, self.gripper, self.place.at("actions")),
            self.image_size,
        )

    def _cameras(self, cameras: Sequence[str]) -> dict[str, str]:
        """Returns the stream of each image: the first that fits and that no line before took."""
        found: dict[str, str] = {}
        for name, entry in self.images.items():
            camera = camera_of(entry, cameras, found.values())
            if camera is not None:
                found[name] = camera
            elif not entry.endswith("?"):
                there = ", ".join(cameras) or "none; without --no-cameras they are drawn"
                place = self.place.at("images", name)
                raise NotFoundError(
                    f"{place}: the cell has no image stream '{entry}' that no line before takes."
                    f"{did_you_mean(entry, cameras)} Its streams: {there}. A "
                    f"file with `extends: {self.name}` may name another one"
                )
        return found


@dataclass
class Bound:
    """A preset for the columns and cameras of one cell.

    Attributes:
        preset: The preset.
        observation: Parts of each vector.
        cameras: Image stream of each image.
        actions: Parts of an action.
        image_size: Width and height of images; None for those of the streams.
    """

    preset: Preset
    observation: dict[str, tuple[Sized, ...]]
    cameras: dict[str, str]
    actions: tuple[Sized, ...]
    image_size: tuple[int, int] | None

    @property
    def width(self) -> int:
        """Number of components of an action."""
        return sum(each.width for each in self.actions)

    def message(self, row: Mapping[str, Array], instruction: str) -> dict[str, Any]:
        """Returns the observation that the policy expects of a row of the cell."""
        message: dict[str, Any] = {}
        for name, parts in self.observation.items():
            vector = [
                each.to_policy(np.asarray(row[each.column], np.float64).reshape(-1))
                for each in parts
            ]
            _put(message, name, np.concatenate(vector).astype(np.float32))
        for name, camera in self.cameras.items():
            pixels = np.asarray(row[camera])
            if self.image_size is not None:
                width, height = self.image_size
                pixels = resize_with_pad(pixels, height, width)
            if self.preset.channels_first:
                pixels = np.ascontiguousarray(pixels.transpose(2, 0, 1))
            _put(message, name, pixels)
        if self.preset.prompt:
            _put(message, self.preset.prompt, instruction)
        return message

    def columns(self, actions: Array) -> dict[str, Array]:
        """Returns columns of the cell for an action (n,) or a chunk (k, n) of the policy.

        Raises:
            ArgumentError: The actions have another width.
        """
        if actions.ndim not in (1, 2) or actions.shape[-1] != self.width:
            parts = ", ".join(f"{each.column} ({each.width})" for each in self.actions)
            raise ArgumentError(
                f"{self.preset.place}: an action has {counted(self.width, 'number')}: {parts}; the "
                f"policy returned the shape {actions.shape}"
            )
        return split(actions, self.actions)

    def row(self, message: Mapping[str, Any]) -> tuple[dict[str, Array], str]:
        """Returns the row of the cell in an observation, and its instruction: `message` backwards.

        Raises:
            ArgumentError: A vector or an image has another shape, or is missing.
        """
        row: dict[str, Array] = {}
        for name, parts in self.observation.items():
            width = sum(each.width for each in parts)
            given = _get(message, name, self.preset.place)
            try:
                vector = np.asarray(given, np.float64).reshape(-1)
            except (TypeError, ValueError) as error:
                raise ArgumentError(
                    f"{self.preset.place}: observation '{name}' is no array of numbers"
                ) from error
            if vector.shape != (width,) or not np.isfinite(vector).all():
                what = f"{vector.size}" if vector.size != width else "some that are not finite"
                raise ArgumentError(
                    f"{self.preset.place}: observation '{name}' has {counted(width, 'number')}, "
                    f"got {what}"
                )
            row |= split(vector, parts)
        for name, camera in self.cameras.items():
            pixels = np.asarray(_get(message, name, self.preset.place))
            if self.preset.channels_first and pixels.ndim == 3:
                pixels = pixels.transpose(1, 2, 0)
            if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8:
                raise ArgumentError(
                    f"{self.preset.place}: image '{name}' is an array (height, width, 3) of uint8, "
                    f"got {pixels.shape} of {pixels.dtype}"
                )
            row[camera] = pixels
        prompt = message.get(self.preset.prompt, "") if self.preset.prompt else ""
        return row, prompt if isinstance(prompt, str) else ""

    def reply(self, columns: Mapping[str, Array]) -> Array:
        """Returns the policy's actions for columns (k, n) of the cell: `columns` backwards.

        Raises:
            ArgumentError: A column is missing or has another size, or one is not part of the
                preset.
        """
        wanted = {each.column: each.size for each in self.actions}
        if columns.keys() != wanted.keys():
            raise ArgumentError(
                f"{self.preset.place}: its actions are {', '.join(wanted)}; the policy returned "
                f"{shortened(sorted(columns)) or 'none'}"
            )
        for name, values in columns.items():
            if values.ndim != 2 or values.shape[1] != wanted[name]:
                raise ArgumentError(
                    f"'{name}' has {counted(wanted[name], 'number')}; the policy returned the "
                    f"shape {values.shape}"
                )
        vectors = [each.to_policy(columns[each.column]) for each in self.actions]
        return np.concatenate(vectors, axis=1).astype(np.float32)


class _Cell:
    """Robots, groups and columns of a cell, from its features."""

    def __init__(self, features: Iterable[Feature]) -> None:
        self._sizes: dict[str, int] = {}
        self._openings: set[str] = set()
        commands: list[str] = []
        for feature in features:
            self._sizes[feature.name] = math.prod(feature.shape)
            if is_opening(feature.name, feature.names):
                self._openings.add(feature.name)
            if feature.role == "action":
                commands.append(feature.name)
        self._groups = groups_of(commands, self._openings)

    def expand(self, parts: Sequence[Part], gripper: Gripper, place: Place) -> tuple[Sized, ...]:
        """Returns a part for each column that its pattern stands for."""
        found = tuple(
            self._sized(part, column, gripper, place)
            for part, column in expanded(parts, self._groups)
        )
        if not found:
            raise NotFoundError(f"{place}: the cell has no robot with such a group")
        require_complete(found, place)
        return found

    def _sized(self, part: Part, column: str, gripper: Gripper, place: Place) -> Sized:
        if column not in self._sizes:
            raise NotFoundError(
                f"{place}: the cell has no column '{column}'.{did_you_mean(column, self._sizes)} "
                f"Its columns: {shortened(list(self._sizes))}"
            )
        is_opening = column in self._openings
        return Sized(part, column, self._sizes[column], gripper if is_opening else None)


def _put(message: dict[str, Any], name: str, value: object) -> None:
    """Sets "images>top" in the map `images` of the message."""
    *maps, last = name.split(">")
    for key in maps:
        message = message.setdefault(key, {})
    message[last] = value


def _get(message: Mapping[str, Any], name: str, place: Place) -> Any:
    value: Any = message
    for key in name.split(">"):
        if not isinstance(value, Mapping) or key not in value:
            known = [str(each) for each in message]
            raise ArgumentError(
                f"{place}: the observation has no '{name}'.{did_you_mean(name, known)} It has: "
                f"{shortened(known) or 'nothing'}"
            )
        value = value[key]
    return value
