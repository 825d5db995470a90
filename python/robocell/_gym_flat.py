"""Environments with vectors instead of dictionaries."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from robocell._core import ArgumentError, EnvConfig
from robocell._gym_env import GymEnv
from robocell._gym_vector import VectorGymEnv
from robocell._suggestions import counted
from robocell._window import RENDER_SIZE


def _require_no_streams(config: EnvConfig) -> None:
    if config.cameras.draw and config.cameras.streams:
        names = ", ".join(stream.name for stream in config.cameras.streams)
        raise ArgumentError(
            f"environment '{config.name}': flat observations have no images; leave the "
            f"streams out of cameras ({names}), or use the environment that is not flat"
        )


def _observation_box(lower: NDArray[Any], upper: NDArray[Any]) -> spaces.Box:
    """Returns a float32 box that rounding cannot leave."""
    low, high = lower.astype(np.float32), upper.astype(np.float32)
    return spaces.Box(
        np.nextafter(low, np.float32(-np.inf)), np.nextafter(high, np.float32(np.inf))
    )


def shares_of(name: str, action: Any, size: int, copies: int | None = None) -> NDArray[np.float64]:
    """Checks an action: ``size`` numbers, or a row of them for each copy."""
    shape = (size,) if copies is None else (copies, size)
    try:
        shares = np.asarray(action, dtype=np.float64)
    except (TypeError, ValueError) as error:
        shares, problem = np.empty(0), f"no array: {error}"
    else:
        problem = f"of shape {shares.shape}"
    if shares.shape != shape:
        wanted = f"be {counted(size, 'number')}"
        if copies is not None:
            wanted = f"have a row of {counted(size, 'number')} for each copy ({copies})"
        raise ArgumentError(f"environment '{name}': action must {wanted}, it is {problem}")
    return shares


def scaled(shares: NDArray[Any], low: NDArray[Any], high: NDArray[Any]) -> NDArray[np.float64]:
    """Scales -1 to the lower end of each range and 1 to the upper; values beyond are clipped."""
    numbers: NDArray[np.float64] = low + (shares.clip(-1, 1) + 1) / 2 * (high - low)
    return numbers


class FlatGymEnv(GymEnv):
    """A ``GymEnv`` for learning code that needs boxes; ``gym.make(..., flat=True)`` makes it.

    Observations are (m,) float32: the values of the dictionaries, one part after another
    (``observation_parts`` of ``core``), in metres and radians. Actions are (n,) between -1 and 1,
    scaled to the ranges of the dictionaries; values beyond are clipped. Both are the same as in a
    copy of ``FlatVectorGymEnv``. There are no images. Arguments are those of ``GymEnv``.
    """

    def __init__(
        self,
        config: EnvConfig,
        render_mode: str | None = None,
        render_camera: Any = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        _require_no_streams(config)
        super().__init__(config, render_mode, render_camera, render_size)
        self._name = config.name
        self._seen_parts = [path for path, _, _ in self.core.observation_parts]
        self._action_parts = self.core.action_parts
        acted = [path for path, _, _ in self._action_parts]
        self._low, self._high = (_joined(ends, acted) for ends in self.core.action_range)
        ranges = (_joined(ends, self._seen_parts) for ends in self.core.observation_range)
        self.observation_space = _observation_box(*ranges)
        self.action_space = spaces.Box(-1, 1, self._low.shape, np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Resets to a start, as ``GymEnv``."""
        observation, info = super().reset(seed=seed, options=options)
        return self._flat(observation), info

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Makes one step; ``info["reason"]`` is the reason for its end."""
        seen, reward, terminated, truncated, info = super().step(self._commands(action))
        return self._flat(seen), reward, terminated, truncated, info

    def _flat(self, observation: Any) -> NDArray[np.float32]:
        return _joined(observation, self._seen_parts).astype(np.float32)

    def _commands(self, action: Any) -> dict[str, dict[str, NDArray[np.float64]]]:
        shares = shares_of(self._name, action, len(self._low))
        numbers = scaled(shares, self._low, self._high)
        out: dict[str, dict[str, NDArray[np.float64]]] = {}
        for (robot, command), begin, size in self._action_parts:
            out.setdefault(robot, {})[command] = numbers[begin : begin + size]
        return out


def _joined(tree: Any, paths: list[tuple[str, ...]]) -> NDArray[np.float64]:
    """Joins the arrays at the paths, one after another."""
    parts = []
    for path in paths:
        part = tree
        for key in path:
            part = part[key]
        parts.append(np.ravel(part))
    return np.concatenate(parts)


class FlatVectorGymEnv(VectorGymEnv):
    """A ``VectorGymEnv`` for learning code that needs boxes, such as CleanRL's.

    Observations are (num_envs, m) float32 and actions (num_envs, n); each row, and each final
    observation, is as in ``FlatGymEnv``. There are no images. Arguments are those of
    ``VectorGymEnv``.
    """

    def __init__(
        self,
        config: EnvConfig,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
        render_mode: str | None = None,
        render_camera: Any = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        _require_no_streams(config)
        super().__init__(
            config,
            num_envs,
            max_episode_steps,
            autoreset_mode,
            threads,
            render_mode,
            render_camera,
            render_size,
        )
        self._low, self._high = self.core.action_range
        self.single_observation_space = _observation_box(*self.core.observation_range)
        self.single_action_space = spaces.Box(-1, 1, self._low.shape, np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _flat(self, actions: Any) -> NDArray[np.float64]:
        shares = shares_of(self._name, actions, len(self._low), self.num_envs)
        return scaled(shares, self._low, self._high)

    def _observation(self, flat: NDArray[np.float64]) -> NDArray[np.float32]:
        return flat.astype(np.float32)
