"""Environments as Gymnasium's.

import robocell as rc
from robocell.gym import GymEnv

env = GymEnv(rc.EnvConfig.load("duo.yaml"), render_mode="rgb_array")
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from robocell._core import ArgumentError, Env, EnvConfig, Renderer

Observation = dict[str, Any]
Action = Mapping[str, Any]

RENDER_SIZE = (480, 360)  # width, height in pixels


def _space(lower: Any, upper: Any) -> spaces.Space[Any]:
    """Dictionaries of ranges as a space of the same shape."""
    if isinstance(lower, dict):
        return spaces.Dict({key: _space(lower[key], upper[key]) for key in lower})
    return spaces.Box(lower, upper, dtype=np.float64)


class GymEnv(gymnasium.Env[Observation, Action]):
    """An environment of a configuration, with spaces; ``unwrapped.core`` is the ``rc.Env`` itself.

    Spaces are dictionaries by robot, as in ``rc.Env``: ranges of joints and positions come from the
    robots. ``render_mode`` is None or "rgb_array"; pictures show the whole cell, or what
    ``render_camera`` (a camera of the scene, or an OrbitCamera and its like) sees.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 30}  # noqa: RUF012  (as in Gymnasium)

    def __init__(
        self,
        config: EnvConfig,
        render_mode: str | None = None,
        render_camera: Any = "",
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ArgumentError(
                f"render_mode must be None or 'rgb_array', got {render_mode!r}: there is no window"
            )
        self.core = Env(config)
        self.render_mode = render_mode
        self.action_space = _space(*self.core.action_range)
        self.observation_space = _space(*self.core.observation_range)
        if config.sim.async_control:
            self.metadata = {**self.metadata, "render_fps": round(config.sim.frequency)}
        self._camera = render_camera
        self._size = render_size
        self._renderer: Renderer | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """To a start: that of the seed, or the next one of the last seed."""
        super().reset(seed=seed)
        if options:
            raise ArgumentError(f"reset takes no options here, got {', '.join(options)}")
        return self.core.reset(seed)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One step; ``info["reason"]`` says why it ended."""
        return self.core.step(action)

    def render(self) -> Any:
        """The picture (H, W, 3) uint8 of the present state; None without a render mode."""
        if self.render_mode is None:
            return None
        if self._renderer is None:
            self._renderer = Renderer(self.core.scene)
        width, height = self._size
        return self._renderer.render(self._camera, width=width, height=height)["rgb"]

    def close(self) -> None:
        """Ends its use; may be repeated."""
        self._renderer = None
        self.core.close()
