"""Environments for LeRobot; stable-baselines3 accepts them too (``MultiInputPolicy``).

from robocell.gym import pick_cube_config
from robocell.lerobot import LeRobotEnv

env = LeRobotEnv(pick_cube_config(), max_episode_steps=200)
observation, info = env.reset(seed=0)
observation["agent_pos"]  # and environment_state with a task, pixels with image streams

``ExportedEnv("out/picks")`` is the cell of a dataset with the features of its LeRobot export.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._extras import needed_by

with needed_by("robocell.lerobot", "envs"):
    import gymnasium
    from gymnasium import spaces
    from gymnasium.spaces.utils import flatten, flatten_space, unflatten

from robocell._core import ArgumentError, EnvConfig
from robocell._gym_flat import scaled, shares_of
from robocell._lerobot_exported import ExportedEnv
from robocell.gym import GymEnv

__all__ = ["ExportedEnv", "LeRobotEnv"]

Observation = dict[str, Any]


class LeRobotEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """A ``GymEnv`` with flat vectors and the names of LeRobot.

    An action is one vector between -1 and 1, scaled to the ranges of ``GymEnv``, in the order of
    the keys of its dictionaries; values beyond are clipped. Observations are float32 except
    ``pixels``:

    - ``agent_pos``: the state of the robots, and the chosen ``features`` that are not privileged;
    - ``environment_state``: the task's objects and signals, and privileged features;
    - ``pixels``: the colour image of each image stream, (H, W, 3) uint8.

    ``task`` is the name of the environment, ``task_description`` the instruction. An episode is
    truncated after ``max_episode_steps``. Every info contains ``is_success``.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 30}  # noqa: RUF012  (as in Gymnasium)

    def __init__(
        self,
        config: EnvConfig,
        max_episode_steps: int = 200,
        render_mode: str | None = "rgb_array",
    ) -> None:
        if max_episode_steps < 1:
            raise ArgumentError(
                f"environment '{config.name}': max_episode_steps is {max_episode_steps}; at least 1"
            )
        self.env = GymEnv(config, render_mode=render_mode)
        self.metadata = self.env.metadata
        self.render_mode = render_mode
        self.task = config.name
        self.task_description = self.env.core.instruction or config.name
        self._max_episode_steps = max_episode_steps
        self._steps = 0
        whole = self.env.observation_space
        assert isinstance(whole, spaces.Dict)
        of_robots: dict[str, spaces.Space[Any]] = {
            arm: whole[arm]  # "torso/left" for an arm of a robot with several
            for robot in config.robots
            for arm in whole.spaces
            if arm == robot or arm.startswith(f"{robot}/")
        }
        of_task: dict[str, spaces.Space[Any]] = {
            key: whole[key] for key in ("objects", "task") if key in whole.spaces
        }
        for role, group in (("observation", of_robots), ("privileged", of_task)):
            if chosen := self._features_of(role, whole):
                group["features"] = spaces.Dict(chosen)
        self._groups = {"agent_pos": spaces.Dict(of_robots)}
        if of_task:
            self._groups["environment_state"] = spaces.Dict(of_task)
        streams = config.cameras.streams if config.cameras.draw else []
        self._pixels = [stream.name for stream in streams if stream.rgb]
        self.observation_space = spaces.Dict(self._spaces(whole))
        box = flatten_space(self.env.action_space)
        assert isinstance(box, spaces.Box)
        self._low, self._high = box.low, box.high
        self.action_space = spaces.Box(-1, 1, box.shape, np.float32)

    def _features_of(self, role: str, whole: spaces.Dict) -> dict[str, spaces.Space[Any]]:
        """Returns the spaces of the chosen features of a role."""
        start = "observation/features/"
        names = [
            feature.name.removeprefix(start)
            for feature in self.env.core.observed
            if feature.role == role and feature.name.startswith(start)
        ]
        features: Any = whole.spaces.get("features")
        return {name: features[name] for name in names}

    def _spaces(self, whole: spaces.Dict) -> dict[str, spaces.Space[Any]]:
        found: dict[str, spaces.Space[Any]] = {}
        for name, group in self._groups.items():
            box = flatten_space(group)
            assert isinstance(box, spaces.Box)
            # Rounding must not move numbers out of the space.
            low = np.nextafter(box.low.astype(np.float32), np.float32(-np.inf))
            high = np.nextafter(box.high.astype(np.float32), np.float32(np.inf))
            found[name] = spaces.Box(low, high, dtype=np.float32)
        if self._pixels:
            frames: Any = whole["frames"]
            found["pixels"] = spaces.Dict(
                {name: frames[name]["rgb"]["data"] for name in self._pixels}
            )
        return found

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Resets to a start, as ``GymEnv``."""
        super().reset(seed=seed)
        self._steps = 0
        observation, info = self.env.reset(seed=seed, options=options)
        return self._observation(observation), {"is_success": False} | info

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Makes one step."""
        shares = shares_of(self.task, action, len(self._low))
        numbers = scaled(shares, self._low, self._high)
        own: Any = unflatten(self.env.action_space, numbers)
        observation, reward, terminated, truncated, info = self.env.step(own)
        self._steps += 1
        truncated = truncated or self._steps >= self._max_episode_steps
        info = {"is_success": False} | info
        return self._observation(observation), reward, terminated, truncated, info

    def render(self) -> Any:
        """Returns a picture (H, W, 3) uint8 of the whole cell."""
        return self.env.render()

    def close(self) -> None:
        """Closes the environment; may be repeated."""
        self.env.close()

    def _observation(self, seen: Observation) -> Observation:
        out: Observation = {
            name: np.asarray(flatten(group, {key: seen[key] for key in group.spaces})).astype(
                np.float32
            )
            for name, group in self._groups.items()
        }
        if self._pixels:
            out["pixels"] = {name: seen["frames"][name]["rgb"]["data"] for name in self._pixels}
        return out
