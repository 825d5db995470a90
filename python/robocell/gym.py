"""Environments as Gymnasium's.

import robocell as rc
from robocell.gym import GymEnv

env = GymEnv(rc.EnvConfig.load("duo.yaml"), render_mode="rgb_array")
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from robocell import models
from robocell._core import (
    ArgumentError,
    CameraConfig,
    Env,
    EnvConfig,
    Pose,
    Renderer,
    RobotConfig,
)
from robocell._gym_vector import VectorGymEnv
from robocell._spaces import space_of

Observation = dict[str, Any]
Action = Mapping[str, Any]

FAR = 1e6  # nothing is farther, in pixels, metres or seconds
PICK_CUBE_STEPS = 200
RENDER_SIZE = (480, 360)  # width, height in pixels


def _image(shape: tuple[int, ...], low: int, high: int, dtype: type) -> spaces.Space[Any]:
    return spaces.Dict(
        {
            "data": spaces.Box(low, high, shape, dtype),
            "intrinsics": spaces.Box(-FAR, FAR, (3, 3), np.float64),
            "extrinsics": spaces.Box(-FAR, FAR, (4, 4), np.float64),
        }
    )


def _frame_space(config: EnvConfig, stream: CameraConfig) -> spaces.Space[Any]:
    """What a stream's part of an observation is; ``intrinsics`` are in pixels."""
    wide, high = config.cameras.resolution
    size = (stream.height or int(high), stream.width or int(wide))
    frame: dict[str, spaces.Space[Any]] = {"time": spaces.Box(0, FAR, (1,), np.float64)}
    if stream.rgb:
        frame["rgb"] = _image((*size, 3), 0, 255, np.uint8)
    if stream.depth or config.wrappers.include_depth:
        frame["depth"] = _image((*size, 1), 0, 65535, np.uint16)
    if stream.segmentation:
        frame["segmentation"] = _image((*size, 1), -1, 2**31 - 1, np.int32)
    return spaces.Dict(frame)


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
        self.action_space = space_of(*self.core.action_range)
        lower, upper = self.core.observation_range
        seen = {key: space_of(lower[key], upper[key]) for key in lower}
        if config.cameras.streams:
            frames = {s.name: _frame_space(config, s) for s in config.cameras.streams}
            seen["frames"] = spaces.Dict(frames)
        self.observation_space = spaces.Dict(seen)
        if config.sim.async_control:
            self.metadata = {**self.metadata, "render_fps": round(config.sim.frequency)}
        self._camera = render_camera
        self._size = render_size
        self._renderer: Renderer | None = None
        self._seeded = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """To a start: that of the seed, or the next one of the last seed; by chance at first."""
        super().reset(seed=seed)
        if options:
            raise ArgumentError(f"reset takes no options here, got {', '.join(options)}")
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**63))
        observation, info = self.core.reset(seed)
        self._seeded = True
        return observation, info

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


def pick_cube_config(
    robot: RobotConfig | str | os.PathLike[str] = "rc7", **fields: Any
) -> EnvConfig:
    """A robot that is to pick up a cube from the floor in front of it.

    Args:
        robot: a built-in robot's name, a robot file, or a configuration.
        fields: of EnvConfig, in the place of those chosen here.
    """
    if isinstance(robot, str) and robot in models.robots():
        robot = models.robot_file(robot)
    chosen: dict[str, Any] = {
        "name": "pick_cube",
        "robots": {"robot": robot},
        "add_floor": True,
        "root_frame_objects": {
            "cube": {
                "mjcf_path": "green_cube",
                "offset": Pose(translation=[0.45, 0, 0.02]),
                "fixed": False,
            }
        },
        "task": {"object": "cube", "spread": [0.08, 0.15]},
        "control_mode": "cartesian_tquat",
        "max_relative_movement": (0.05, 0.3),
        "sim": {"async_control": True, "frequency": 20, "on_collision": "report"},
    }
    return EnvConfig(**(chosen | fields))


def pick_cube(
    robot: RobotConfig | str | os.PathLike[str] = "rc7",
    render_mode: str | None = None,
    **fields: Any,
) -> GymEnv:
    """The environment ``robocell/PickCube-v0``; arguments as of ``pick_cube_config``."""
    return GymEnv(pick_cube_config(robot, **fields), render_mode=render_mode)


def pick_cube_vector(
    num_envs: int = 1,
    robot: RobotConfig | str | os.PathLike[str] = "rc7",
    max_episode_steps: int | None = PICK_CUBE_STEPS,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    threads: int = 0,
    **fields: Any,
) -> VectorGymEnv:
    """What ``gym.make_vec("robocell/PickCube-v0", num_envs=64)`` makes."""
    config = pick_cube_config(robot, **fields)
    return VectorGymEnv(config, num_envs, max_episode_steps, autoreset_mode, threads)


gymnasium.register(
    id="robocell/PickCube-v0",
    entry_point="robocell.gym:pick_cube",
    vector_entry_point="robocell.gym:pick_cube_vector",
    max_episode_steps=PICK_CUBE_STEPS,
)
