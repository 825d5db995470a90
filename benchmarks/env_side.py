"""One side of env_step.py, in a process of its own: seconds of a step and of a reset as JSON.

env_side.py SIDE [ROBOT.yaml]. Sides: robocell, vector1, vector2 (copies on one and two threads),
mujoco (the engine's Python package with a controller in numpy), robosuite, gymnasium_robotics,
envpool (copies on two threads).
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

SUBSTEPS = 33
TIMESTEP = 0.002
STEPS, RESETS = 60, 60
COPIES = 32
Result = dict[str, float]


def each(call: Callable[[int], Any], count: int) -> float:
    """Seconds of one call."""
    begin = time.perf_counter()
    for i in range(count):
        call(i)
    return (time.perf_counter() - begin) / count


def config(file: str) -> Any:
    """As in env_step_bench.cc."""
    import robocell as rc

    return rc.EnvConfig(
        robots={"robot": file},
        add_floor=True,
        sim={"async_control": True, "frequency": 1 / (SUBSTEPS * TIMESTEP)},
    )


def robocell(file: str) -> Result:
    """The environment of Gymnasium."""
    from robocell.gym import GymEnv

    env = GymEnv(config(file))
    env.reset(seed=1)
    size = env.action_space.sample()["robot"]["joints"].shape
    actions = [
        {"robot": {"joints": np.full(size, sign * 0.03), "gripper": np.array([1.0])}}
        for sign in (1, -1)
    ]
    each(lambda i: env.step(actions[i % 2]), 10)
    step = each(lambda i: env.step(actions[i % 2]), STEPS)
    return {"step": step, "reset": each(lambda i: env.reset(seed=i), RESETS)}


def vector(file: str, threads: int) -> Result:
    """Copies on threads: seconds of a step of one of them."""
    from robocell.gym import VectorGymEnv

    env = VectorGymEnv(config(file), COPIES, threads=threads)
    env.reset(seed=1)
    size = env.single_action_space.sample()["robot"]["joints"].shape
    actions = [
        {
            "robot": {
                "joints": np.full((COPIES, *size), sign * 0.03),
                "gripper": np.ones((COPIES, 1)),
            }
        }
        for sign in (1, -1)
    ]
    each(lambda i: env.step(actions[i % 2]), 4)
    step = each(lambda i: env.step(actions[i % 2]), STEPS // 2) / COPIES
    return {"step": step, "engine": step / SUBSTEPS}


def mujoco(file: str) -> Result:
    """What one writes first: the engine's package, and controls from numpy before each step."""
    import mujoco as mj

    import robocell as rc

    scene = rc.Scene.build(rc.envs.env_scene_spec(config(file)))
    scene.reset()
    model, data = scene.model, scene.data
    home = data.ctrl.copy()

    def step(i: int) -> Any:
        goal = home + (0.03 if i % 2 == 0 else -0.03)
        for k in range(SUBSTEPS):
            data.ctrl[:] = np.clip(home + (goal - home) * ((k + 1) / SUBSTEPS), -10, 300)
            mj.mj_step(model, data)
        return {"joints": data.qpos[:7].copy(), "tcp": data.site_xpos[-1].copy()}

    each(step, 10)
    return {"step": each(step, STEPS), "reset": each(lambda _: mj.mj_forward(model, data), RESETS)}


def robosuite(_: str) -> Result:
    """Lift with the Panda, at the same number of steps of the engine."""
    import robosuite as suite

    env = suite.make(
        env_name="Lift",
        robots="Panda",
        has_renderer=False,
        has_offscreen_renderer=False,
        use_camera_obs=False,
        control_freq=1 / (SUBSTEPS * TIMESTEP),
        horizon=10**9,
        ignore_done=True,
    )
    env.reset()
    low, high = env.action_spec
    actions = np.random.default_rng(0).uniform(low, high, (STEPS, len(low))) * 0.3
    each(lambda i: env.step(actions[i % STEPS]), 10)
    step = each(lambda i: env.step(actions[i]), STEPS)
    hard = each(lambda _: env.reset(), 5)
    env.hard_reset = False
    return {"step": step, "hard": hard, "reset": each(lambda _: env.reset(), RESETS)}


def gymnasium_robotics(_: str) -> Result:
    """FetchPickAndPlace, 20 steps of the engine in each of its own."""
    import gymnasium as gym
    import gymnasium_robotics as fetch

    gym.register_envs(fetch)
    env = gym.make("FetchPickAndPlace-v4", max_episode_steps=10**9)
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (STEPS, 4)).astype(np.float32)
    step = each(lambda i: env.step(actions[i]), STEPS)
    return {"step": step, "reset": each(lambda _: env.reset(), RESETS)}


def envpool(_: str) -> Result:
    """Copies of FetchPickAndPlace on two threads, 20 steps of the engine in each step."""
    import envpool as pool

    env = pool.make_gymnasium("FetchPickAndPlace-v4", num_envs=COPIES, num_threads=2)
    env.reset()
    actions = np.random.default_rng(0).uniform(-1, 1, (STEPS, COPIES, 4))
    each(lambda i: env.step(actions[i]), 4)
    return {"engine": each(lambda i: env.step(actions[i]), STEPS // 2) / COPIES / 20}


SIDES: dict[str, Callable[[str], Result]] = {
    "robocell": robocell,
    "vector1": lambda file: vector(file, 1),
    "vector2": lambda file: vector(file, 2),
    "mujoco": mujoco,
    "robosuite": robosuite,
    "gymnasium_robotics": gymnasium_robotics,
    "envpool": envpool,
}

if __name__ == "__main__":
    side = SIDES[sys.argv[1]]
    result = side(sys.argv[2] if len(sys.argv) > 2 else "")
    sys.stderr.flush()
    print("\n" + json.dumps(result))
