"""robocell for LeRobot: `make_env` as its EnvHub asks for it.

`lerobot-eval --env.type=...` with this folder as the hub repository, or in a program:

    import env
    vector = env.make_env(n_envs=4)["robocell"][0]
"""

from __future__ import annotations

from functools import partial

import gymnasium as gym

import robocell as rc
from robocell.gym import PICK_CUBE_STEPS, pick_cube_config
from robocell.lerobot import LeRobotEnv

SIZE = [96, 96]  # pixels


def config() -> rc.EnvConfig:
    """The built-in robot, a cube, and what its two cameras see."""
    streams = [{"name": name, "camera": f"{name}_camera"} for name in ("wrist", "exo")]
    return pick_cube_config(cameras={"resolution": SIZE, "streams": streams})


def make_env(
    n_envs: int = 1, use_async_envs: bool = False
) -> dict[str, dict[int, gym.vector.VectorEnv]]:
    """{suite: {task: vector}}: one suite with one task."""
    make = partial(LeRobotEnv, config(), PICK_CUBE_STEPS)
    vector = gym.vector.AsyncVectorEnv if use_async_envs else gym.vector.SyncVectorEnv
    return {"robocell": {0: vector([make] * n_envs)}}
