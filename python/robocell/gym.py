"""Gymnasium environments and vector environments of robocell cells.

import gymnasium as gym
import robocell.gym

env = gym.make("robocell/Env-v0", config="duo.yaml", render_mode="rgb_array")
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
vector = gym.make_vec("robocell/PickCube-v0", num_envs=64, flat=True)
"""

from __future__ import annotations

import copy
import os
from typing import Any

from robocell._extras import needed_by

with needed_by("robocell.gym", "envs", "Without it: robocell.Env"):
    import gymnasium
    from gymnasium.vector import AutoresetMode

from robocell import models
from robocell._cells import is_name, load_cell
from robocell._core import ArgumentError, ControlMode, EnvConfig, Pose, RobotConfig
from robocell._gym_env import GymEnv
from robocell._gym_flat import FlatGymEnv, FlatVectorGymEnv
from robocell._gym_vector import VectorGymEnv

__all__ = [
    "PICK_CUBE_STEPS",
    "PICK_PLACE_STEPS",
    "FlatGymEnv",
    "FlatVectorGymEnv",
    "GymEnv",
    "VectorGymEnv",
    "environment",
    "environment_vector",
    "pick_cube",
    "pick_cube_config",
    "pick_cube_vector",
    "pick_place",
    "pick_place_config",
    "pick_place_vector",
]

PICK_CUBE_STEPS = 200
PICK_PLACE_STEPS = 400
# Fields of EnvConfig: a cell's robots, and what they carry.
CARRIED = ("robots", "grippers", "gripper_offsets", "robot_frame_objects", "camera_adds")

File = str | os.PathLike[str]


def _single(config: EnvConfig, render_mode: str | None, flat: bool) -> GymEnv:
    return (FlatGymEnv if flat else GymEnv)(config, render_mode)


def _configured(config: EnvConfig | File | None, fields: dict[str, Any]) -> EnvConfig:
    """Returns a copy of a configuration, a file or a ready-made cell, with fields replaced."""
    if config is None:  # Gymnasium calls without, and would name this module's function
        raise ArgumentError(
            "robocell/Env-v0 needs a config: an EnvConfig, its file, or the name of a ready-made "
            f"cell ({', '.join(models.cells())}), as in gym.make('robocell/Env-v0', config='rc7')"
        )
    own = copy.deepcopy(config) if isinstance(config, EnvConfig) else load_cell(config)
    for name, value in fields.items():
        setattr(own, name, value)
    return own


def environment(
    config: EnvConfig | File | None = None,
    render_mode: str | None = None,
    flat: bool = False,
    **fields: Any,
) -> GymEnv:
    """Makes the environment ``robocell/Env-v0`` of any configuration.

    Args:
        config: the configuration, its file, or the name of a ready-made cell
            (``models.cells()``); required.
        render_mode: as in ``GymEnv``.
        flat: whether observations and actions are vectors (``FlatGymEnv``).
        fields: fields of EnvConfig that replace those of the configuration.
    """
    return _single(_configured(config, fields), render_mode, flat)


def environment_vector(
    config: EnvConfig | File | None = None,
    num_envs: int = 1,
    max_episode_steps: int | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    threads: int = 0,
    flat: bool = False,
    render_mode: str | None = None,
    **fields: Any,
) -> VectorGymEnv:
    """Makes ``gym.make_vec("robocell/Env-v0", num_envs=64, config="duo.yaml")``."""
    own = _configured(config, fields)
    kind = FlatVectorGymEnv if flat else VectorGymEnv
    return kind(own, num_envs, max_episode_steps, autoreset_mode, threads, render_mode)


def pick_cube_config(robot: RobotConfig | File = "rc7", **fields: Any) -> EnvConfig:
    """Returns the configuration of a robot that picks up a cube from the floor in front of it.

    Actions are poses, ``cartesian_tquat``. With ``control_mode="joints"`` steps have the limit of
    EnvConfig for joints.

    Args:
        robot: the name of a built-in robot, the name of a ready-made cell (``models.cells()``),
            whose robots and their equipment are used, a robot file, or a configuration.
        fields: fields of EnvConfig that replace those chosen here.

    Examples:
        >>> rc.Env(rc.gym.pick_cube_config()).instruction
        'pick up the cube'
    """
    chosen: dict[str, Any] = {
        "name": "pick_cube",
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
        "sim": {"async_control": True, "frequency": 20, "on_collision": "report"},
    }
    if fields.get("control_mode") not in ("joints", ControlMode.JOINTS):
        chosen["max_relative_movement"] = (0.05, 0.3)
    return EnvConfig(**(_robots_of(robot) | chosen | fields))


def _robots_of(robot: RobotConfig | File) -> dict[str, Any]:
    """Returns fields of EnvConfig: one robot, or that of a ready-made cell with its equipment."""
    if not isinstance(robot, str) or not is_name(robot):
        return {"robots": {"robot": robot}}
    if robot in models.robots():
        return {"robots": {"robot": models.robot_file(robot)}}
    cell = load_cell(robot)
    if len(cell.robots) > 1:
        raise ArgumentError(
            f"robot: the cell '{robot}' has {len(cell.robots)} robots ({', '.join(cell.robots)}), "
            "one is wanted here; gym.make('robocell/Env-v0', config=...) takes cells"
        )
    return {field: dict(getattr(cell, field)) for field in CARRIED}


def pick_cube(
    robot: RobotConfig | File = "rc7",
    render_mode: str | None = None,
    flat: bool = False,
    **fields: Any,
) -> GymEnv:
    """Makes the environment ``robocell/PickCube-v0``; the other arguments as ``pick_cube_config``.

    With ``flat=True`` observations and actions are vectors (``FlatGymEnv``).

    Examples:
        >>> gym_env = rc.gym.pick_cube()
        >>> observation, info = gym_env.reset(seed=0)
        >>> action = gym_env.action_space.sample()
        >>> observation, reward, terminated, truncated, info = gym_env.step(action)
    """
    return _single(pick_cube_config(robot, **fields), render_mode, flat)


def pick_cube_vector(
    num_envs: int = 1,
    robot: RobotConfig | File = "rc7",
    max_episode_steps: int | None = PICK_CUBE_STEPS,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    threads: int = 0,
    flat: bool = False,
    render_mode: str | None = None,
    **fields: Any,
) -> VectorGymEnv:
    """Makes ``gym.make_vec("robocell/PickCube-v0", num_envs=64)``.

    With ``flat=True`` observations and actions are vectors (``FlatVectorGymEnv``).

    Examples:
        >>> vector = rc.gym.pick_cube_vector(4)
        >>> observations, infos = vector.reset(seed=0)
        >>> vector.num_envs
        4
    """
    config = pick_cube_config(robot, **fields)
    kind = FlatVectorGymEnv if flat else VectorGymEnv
    return kind(config, num_envs, max_episode_steps, autoreset_mode, threads, render_mode)


def pick_place_config(robot: RobotConfig | File = "rc7", **fields: Any) -> EnvConfig:
    """Returns a configuration like ``pick_cube_config``, for a robot that puts a cube on a mat."""
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
            "kind": "pick_and_place",
            "object": "cube",
            "spread": [0.08, 0.1],
            "goal_object": "mat",
            "goal": [0, 0, 0.024],
            "goal_spread": [0.05, 0.05],
        },
    }
    return pick_cube_config(robot, **(chosen | fields))


def pick_place(
    robot: RobotConfig | File = "rc7",
    render_mode: str | None = None,
    flat: bool = False,
    **fields: Any,
) -> GymEnv:
    """Makes the environment ``robocell/PickPlace-v0``; arguments as ``pick_cube``."""
    return _single(pick_place_config(robot, **fields), render_mode, flat)


def pick_place_vector(
    num_envs: int = 1,
    robot: RobotConfig | File = "rc7",
    max_episode_steps: int | None = PICK_PLACE_STEPS,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    threads: int = 0,
    flat: bool = False,
    render_mode: str | None = None,
    **fields: Any,
) -> VectorGymEnv:
    """Makes ``gym.make_vec("robocell/PickPlace-v0", num_envs=64)``; as ``pick_cube_vector``."""
    config = pick_place_config(robot, **fields)
    kind = FlatVectorGymEnv if flat else VectorGymEnv
    return kind(config, num_envs, max_episode_steps, autoreset_mode, threads, render_mode)


gymnasium.register(
    id="robocell/Env-v0",
    entry_point="robocell.gym:environment",
    vector_entry_point="robocell.gym:environment_vector",
)
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
