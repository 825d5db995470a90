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
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from robocell import models
from robocell._core import (
    ArgumentError,
    Env,
    EnvConfig,
    OrbitCamera,
    Pose,
    Renderer,
    RobotConfig,
)
from robocell._gym_flat import FlatVectorGymEnv
from robocell._gym_vector import VectorGymEnv
from robocell._spaces import frame_space, space_of
from robocell._window import Window, side_view

Observation = dict[str, Any]
Action = Mapping[str, Any]

PICK_CUBE_STEPS = 200
PICK_PLACE_STEPS = 400
RENDER_SIZE = (480, 360)  # width, height in pixels


class GymEnv(gymnasium.Env[Observation, Action]):
    """An environment of a configuration, with spaces; ``unwrapped.core`` is the ``rc.Env`` itself.

    Spaces are dictionaries by robot, as in ``rc.Env``: ranges of joints and positions come from the
    robots. ``render_mode`` is None, "rgb_array" (``render`` gives pictures) or "human": a window
    that follows every step, as with ``headless: false`` in the configuration. Without a display
    that is a warning, once, and no window. Pictures show the robots from the side and in front, or
    what ``render_camera`` (a camera of the scene, "" for the whole model, or an OrbitCamera and its
    like) sees.
    """

    metadata = {  # noqa: RUF012  (as in Gymnasium)
        "render_modes": ["human", "rgb_array"],
        "render_fps": 30,
    }

    def __init__(
        self,
        config: EnvConfig,
        render_mode: str | None = None,
        render_camera: Any = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ArgumentError(
                f"render_mode must be None, 'human' or 'rgb_array', got {render_mode!r}"
            )
        self.core = Env(config)
        self.render_mode = render_mode
        self.action_space = space_of(*self.core.action_range)
        lower, upper = self.core.observation_range
        seen = {key: space_of(lower[key], upper[key]) for key in lower}
        if config.cameras.streams:
            seen["frames"] = frame_space(config)
        self.observation_space = spaces.Dict(seen)
        if config.sim.async_control:
            self.metadata = {**self.metadata, "render_fps": round(config.sim.frequency)}
        view = side_view(self.core)
        self._camera = OrbitCamera(**view) if render_camera is None else render_camera
        self._size = render_size
        self._renderer: Renderer | None = None
        self._seeded = False
        self._window: Window | None = None
        if render_mode == "human" or not config.headless:
            self._window = Window.open(self.core.scene, view)

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
        self._show()
        return observation, info

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One step; ``info["reason"]`` says why it ended."""
        result = self.core.step(action)
        self._show()
        return result

    def _show(self) -> None:
        if self._window:
            self._window.show()

    def render(self) -> Any:
        """The picture (H, W, 3) uint8 of the present state; None in another mode."""
        if self.render_mode != "rgb_array":
            return None
        if self._renderer is None:
            self._renderer = Renderer(self.core.scene)
        width, height = self._size
        return self._renderer.render(self._camera, width=width, height=height)["rgb"]

    def close(self) -> None:
        """Ends its use; may be repeated."""
        self._renderer = None
        if self._window:
            self._window.close()
            self._window = None
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
    flat: bool = False,
    **fields: Any,
) -> VectorGymEnv:
    """What ``gym.make_vec("robocell/PickCube-v0", num_envs=64)`` makes.

    With ``flat=True`` observations and actions are vectors: ``FlatVectorGymEnv``.
    """
    kind = FlatVectorGymEnv if flat else VectorGymEnv
    config = pick_cube_config(robot, **fields)
    return kind(config, num_envs, max_episode_steps, autoreset_mode, threads)


def pick_place_config(
    robot: RobotConfig | str | os.PathLike[str] = "rc7", **fields: Any
) -> EnvConfig:
    """A robot that is to put a cube on a mat; arguments as of ``pick_cube_config``."""
    mat = {
        "shape": "box",
        "size": [0.06, 0.06, 0.004],
        "mass": 0.5,
        "rgba": [0.2, 0.3, 0.8, 1],
        "offset": Pose(translation=[0.4, 0.25, 0.004]),
    }
    cube = {
        "mjcf_path": "green_cube",
        "offset": Pose(translation=[0.45, -0.05, 0.02]),
        "fixed": False,
    }
    chosen: dict[str, Any] = {
        "name": "pick_place",
        "root_frame_objects": {"cube": cube, "mat": mat},
        "task": {
            "kind": "pick_place",
            "object": "cube",
            "spread": [0.08, 0.1],
            "goal_object": "mat",
            "goal": [0, 0, 0.024],
            "goal_spread": [0.05, 0.05],
        },
    }
    return pick_cube_config(robot, **(chosen | fields))


def pick_place(
    robot: RobotConfig | str | os.PathLike[str] = "rc7",
    render_mode: str | None = None,
    **fields: Any,
) -> GymEnv:
    """The environment ``robocell/PickPlace-v0``; arguments as of ``pick_place_config``."""
    return GymEnv(pick_place_config(robot, **fields), render_mode=render_mode)


def pick_place_vector(
    num_envs: int = 1,
    robot: RobotConfig | str | os.PathLike[str] = "rc7",
    max_episode_steps: int | None = PICK_PLACE_STEPS,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    threads: int = 0,
    flat: bool = False,
    **fields: Any,
) -> VectorGymEnv:
    """What ``gym.make_vec("robocell/PickPlace-v0", num_envs=64)`` makes; else as above."""
    kind = FlatVectorGymEnv if flat else VectorGymEnv
    config = pick_place_config(robot, **fields)
    return kind(config, num_envs, max_episode_steps, autoreset_mode, threads)


gymnasium.register(
    id="robocell/PickPlace-v0",
    entry_point="robocell.gym:pick_place",
    vector_entry_point="robocell.gym:pick_place_vector",
    max_episode_steps=PICK_PLACE_STEPS,
)
gymnasium.register(
    id="robocell/PickCube-v0",
    entry_point="robocell.gym:pick_cube",
    vector_entry_point="robocell.gym:pick_cube_vector",
    max_episode_steps=PICK_CUBE_STEPS,
)
