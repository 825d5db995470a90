"""Environments as Gymnasium's.

import robocell as rc
from robocell.gym import GymEnv

env = GymEnv(rc.EnvConfig.load("duo.yaml"), render_mode="rgb_array")
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from robocell import models
from robocell._core import (
    ArgumentError,
    CameraConfig,
    Env,
    EnvBatch,
    EnvConfig,
    Pose,
    Renderer,
    RobotConfig,
)

Observation = dict[str, Any]
Action = Mapping[str, Any]

FAR = 1e6  # nothing is farther, in pixels, metres or seconds
PICK_CUBE_STEPS = 200
RENDER_SIZE = (480, 360)  # width, height in pixels


def _space(lower: Any, upper: Any) -> spaces.Space[Any]:
    """Dictionaries of ranges as a space of the same shape."""
    if isinstance(lower, dict):
        return spaces.Dict({key: _space(lower[key], upper[key]) for key in lower})
    return spaces.Box(lower, upper, dtype=np.float64)


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
        self.action_space = _space(*self.core.action_range)
        lower, upper = self.core.observation_range
        seen = {key: _space(lower[key], upper[key]) for key in lower}
        if config.cameras.streams:
            frames = {s.name: _frame_space(config, s) for s in config.cameras.streams}
            seen["frames"] = spaces.Dict(frames)
        self.observation_space = spaces.Dict(seen)
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


class VectorGymEnv(VectorEnv[Observation, Action, Any]):
    """Copies of one environment on one model, on C++ threads: one call of Python for a step of all.

    Observations, rewards and ends are those of as many ``GymEnv``; all three autoreset modes of
    Gymnasium are there. Infos have ``reason``, ``time`` and, with a task, ``is_success``; with
    SAME_STEP also ``final_obs`` and ``final_info`` of the episodes that ended. There are no images.
    """

    def __init__(
        self,
        config: EnvConfig,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
    ) -> None:
        self.core = EnvBatch(config, num_envs, threads, max_episode_steps)
        single = Env(config)
        self.single_action_space = _space(*single.action_range)
        self.single_observation_space = _space(*single.observation_range)
        single.close()
        self.num_envs = num_envs
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {"autoreset_mode": self.autoreset_mode}
        self._has_task = config.task is not None
        self._action_parts = self.core.action_parts
        self._observation_parts = self.core.observation_parts
        self._ended = np.zeros(num_envs, dtype=bool)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """All copies to starts; ``options={"reset_mask": (num_envs,) bool}`` only some."""
        seeds: Sequence[int | None] = ()
        if isinstance(seed, int):
            seeds = [seed + i for i in range(self.num_envs)]
        elif seed is not None:
            seeds = list(seed)
        which = np.ones(self.num_envs, dtype=bool)
        if options and "reset_mask" in options:
            which = np.asarray(options["reset_mask"], dtype=bool)
        observations = self.core.reset(seeds, which.tolist())
        self._ended[which] = False
        return self._dicts(observations), {}

    def step(
        self, actions: Action
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """One step of every copy; those that ended begin anew as the autoreset mode says."""
        again = self._ended.tolist() if self.autoreset_mode == AutoresetMode.NEXT_STEP else []
        if self.autoreset_mode == AutoresetMode.DISABLED and self._ended.any():
            raise ArgumentError(
                f"episodes of {np.flatnonzero(self._ended).tolist()} have ended: reset them with "
                "options={'reset_mask': ...} before the next step"
            )
        flat, rewards, terminated, truncated, times, reasons = self.core.step(
            self._flat(actions), again
        )
        ends = terminated.astype(bool), truncated.astype(bool)
        infos = self._infos(times, reasons, ends[0], np.ones(self.num_envs, dtype=bool))
        self._ended = ends[0] | ends[1]
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            infos["final_obs"] = self._objects(flat, self._ended)
            infos["final_info"] = self._infos(times, reasons, ends[0], self._ended)
            infos["_final_obs"] = infos["_final_info"] = self._ended.copy()
            flat = self.core.reset((), self._ended.tolist())
        return self._dicts(flat), rewards, *ends, infos

    def _flat(self, actions: Action) -> NDArray[np.float64]:
        rows = []
        for path, _, size in self._action_parts:
            part: Any = actions
            for key in path:
                part = part[key]
            rows.append(np.asarray(part, dtype=np.float64).reshape(self.num_envs, size))
        return np.concatenate(rows, axis=1)

    def _dicts(self, flat: NDArray[np.float64]) -> Observation:
        out: Observation = {}
        for path, begin, size in self._observation_parts:
            at = out
            for key in path[:-1]:
                at = at.setdefault(key, {})
            at[path[-1]] = flat[..., begin : begin + size].copy()
        return out

    def _objects(self, flat: NDArray[np.float64], which: NDArray[np.bool_]) -> NDArray[Any]:
        out = np.full(self.num_envs, None, dtype=object)
        for i in np.flatnonzero(which):
            out[i] = self._dicts(flat[i])
        return out

    def _infos(
        self,
        times: NDArray[np.float64],
        reasons: list[str],
        success: NDArray[np.bool_],
        which: NDArray[np.bool_],
    ) -> dict[str, Any]:
        infos: dict[str, Any] = {"time": times, "reason": np.array(reasons, dtype=object)}
        if self._has_task:
            infos["is_success"] = success
        return infos | {f"_{key}": which.copy() for key in infos}


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
    **fields: Any,
) -> VectorGymEnv:
    """What ``gym.make_vec("robocell/PickCube-v0", num_envs=64)`` makes."""
    config = pick_cube_config(robot, **fields)
    return VectorGymEnv(config, num_envs, max_episode_steps, autoreset_mode)


gymnasium.register(
    id="robocell/PickCube-v0",
    entry_point="robocell.gym:pick_cube",
    vector_entry_point="robocell.gym:pick_cube_vector",
    max_episode_steps=PICK_CUBE_STEPS,
)
