"""The environment of a dataset with the observations and actions of its LeRobot export."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._extras import needed_by

with needed_by("robocell.lerobot", "envs"):
    import gymnasium
    from gymnasium import spaces

from robocell._core import ArgumentError, Dataset
from robocell._placeholders import Gripper, is_difference

Observation = dict[str, Any]
STATE, ACTION, IMAGES = "observation.state", "action", "observation.images."


class ExportedEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """The cell of a dataset, as policies see it that LeRobot trained on the dataset's export.

    `agent_pos` is the export's `observation.state`, `pixels` has its `observation.images.<camera>`
    as (H, W, 3) uint8, and `step` takes its `action`. Every info has `is_success`.

    Args:
        dataset: The dataset, or its folder.
        preset: The preset of the export.
        mapping: The mapping file of the export.
        actions: The actions of the export, such as "tcp_displacement".
        cameras: The cameras of the export; default: all, an empty list for none.
        max_episode_steps: Steps after which an episode is truncated.
        imports: Modules to import first, which register the task or features.

    `reset(seed=i)` goes to start i of the dataset's run, as `robocell.envs.from_dataset` does. The
    first starts are those of the dataset's episodes: evaluate with larger seeds.

    Raises:
        ArgumentError: The export has no state or action of its own, takes parts of columns, or
            resizes images.

    Examples:
        >>> env = robocell.lerobot.ExportedEnv("experiment_output/demo")  # doctest: +SKIP
        >>> env.reset(seed=1000)[0]["agent_pos"].shape  # doctest: +SKIP
        (8,)
    """

    def __init__(
        self,
        dataset: Dataset | str | os.PathLike[str],
        *,
        preset: str | None = None,
        mapping: str | os.PathLike[str] | None = None,
        actions: str | None = None,
        cameras: Sequence[str] | None = None,
        max_episode_steps: int = 500,
        imports: Sequence[str] = (),
    ) -> None:
        from robocell.envs import from_dataset
        from robocell.export._mapping import Mapping

        if max_episode_steps < 1:
            raise ArgumentError(f"max_episode_steps is {max_episode_steps}; at least 1")
        opened = dataset if isinstance(dataset, Dataset) else Dataset(Path(dataset))
        if not len(opened):
            raise ArgumentError(
                f"dataset '{opened.folder}' has no episode, so its cell is unknown. Name a dataset "
                "with some"
            )
        table = Mapping.load(Path(mapping) if mapping is not None else None, actions, preset=preset)
        if cameras is not None:
            table = table.only_cameras(cameras)
        first = opened[0]
        resolved = table.resolve(first)
        features = {feature.name: feature for feature in resolved.features}
        for name in (STATE, ACTION):
            if name not in features:
                raise ArgumentError(
                    f"{table.place} has no '{name}', which LeRobot's environments need. Its "
                    f"features: {', '.join(features)}"
                )
        if table.image_size is not None and resolved.images:
            raise ArgumentError(
                f"{table.place} brings images to {table.image_size}; environments show them as "
                "they are. Export without image_size, or give the dataset cameras of this size"
            )
        self._state = _columns(features[STATE], first)
        self._action = _columns(features[ACTION], first)
        self._images = {
            name.removeprefix(IMAGES): camera for name, camera in resolved.images.items()
        }
        self.env = from_dataset(
            opened,
            [*dict.fromkeys((*(each.name for each in self._state), *self._images.values()))],
            [each.name for each in self._action],
            cameras=bool(self._images),
            imports=imports,
        )
        self._max_episode_steps = max_episode_steps
        self._steps = 0
        self._seen: Observation = {}
        self.task = opened.folder.resolve().name
        self.task_description = resolved.task
        self.render_mode = "rgb_array"
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": _fps(first)}
        own: Any = self.env.observation_space
        self.observation_space = spaces.Dict({"agent_pos": _box(self._state)})
        if self._images:
            shown = {name: own[camera] for name, camera in self._images.items()}
            self.observation_space = spaces.Dict(
                {"agent_pos": _box(self._state), "pixels": spaces.Dict(shown)}
            )
        self.action_space: Any = _box(self._action)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Resets to start number `seed`, or to the one after the last."""
        super().reset(seed=seed)
        self._steps = 0
        row, info = self.env.reset(seed=seed)
        self.task_description = info["instruction"] or self.task_description
        return self._observation(row), {"is_success": False} | info

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Makes one step, a row of the dataset."""
        numbers = np.asarray(action, np.float64)
        if numbers.shape != self.action_space.shape:
            raise ArgumentError(
                f"an action has {self.action_space.shape[0]} numbers, got the shape {numbers.shape}"
            )
        parts, at = {}, 0
        for column in self._action:
            parts[column.name] = column.recorded(numbers[at : at + column.size])
            at += column.size
        row, reward, terminated, truncated, info = self.env.step(parts)
        self._steps += 1
        truncated = truncated or self._steps >= self._max_episode_steps
        info = {"is_success": False} | info
        return self._observation(row), float(reward), terminated, truncated, info

    def render(self) -> Any:
        """Returns the last image of the first camera; black without cameras."""
        for image in self._seen.get("pixels", {}).values():
            return image
        return np.zeros((64, 64, 3), np.uint8)

    def close(self) -> None:
        """Closes the environment; may be repeated."""
        self.env.close()

    def _observation(self, row: Observation) -> Observation:
        state = [column.exported(np.ravel(row[column.name])) for column in self._state]
        self._seen = {"agent_pos": np.concatenate(state).astype(np.float32)}
        if self._images:
            self._seen["pixels"] = {name: row[camera] for name, camera in self._images.items()}
        return self._seen


class _Column:
    """A column as a feature has it: its numbers times a factor, openings of its gripper."""

    def __init__(self, name: str, size: int, times: float, gripper: Gripper | None) -> None:
        self.name, self.size = name, size
        self._times, self._gripper = times, gripper

    def exported(self, numbers: NDArray[Any]) -> NDArray[Any]:
        """Returns the numbers of the export."""
        if self._gripper is not None:
            numbers = self._gripper.of(numbers, is_difference(self.name))
        return numbers * self._times

    def recorded(self, numbers: NDArray[Any]) -> NDArray[Any]:
        """Returns the numbers of the episodes: `exported` backwards."""
        numbers = numbers / self._times
        if self._gripper is not None:
            numbers = self._gripper.opening(numbers, is_difference(self.name))
        return numbers


def _columns(feature: Any, episode: Any) -> list[_Column]:
    columns = []
    for term in feature.terms:
        if term.part:
            raise ArgumentError(
                f"'{feature.name}' takes the part '{term.part}' of '{term.column}'; environments "
                "have whole columns. Export with a mapping of whole columns"
            )
        described = episode.column(term.column)
        size = int(np.prod(described.row_shape))
        is_gripper = term.column in feature.openings
        columns.append(
            _Column(term.column, size, term.times, feature.gripper if is_gripper else None)
        )
    return columns


def _box(columns: Sequence[_Column]) -> spaces.Box:
    return spaces.Box(-np.inf, np.inf, (sum(column.size for column in columns),), np.float32)


def _fps(episode: Any) -> int:
    """Returns the whole number of rows per second that is nearest, as the export counts."""
    metadata: Any = episode.metadata if isinstance(episode.metadata, dict) else {}
    over, under = (metadata.get("rates") or {}).get("policy_hz") or (10, 1)
    return max(1, round(over / under))
