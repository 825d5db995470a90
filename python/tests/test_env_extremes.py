"""Actions far outside of their ranges are clipped as documented, and give finite numbers."""

from __future__ import annotations

from contextlib import closing
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import robocell as rc
import robocell.gym
from robocell.envs import EnvBatch, EnvConfig

HUGE = 1.7e308


def config(mode: str, relative_to: str) -> EnvConfig:
    return EnvConfig(
        robots={"robot": rc.RobotConfig.load(rc.models.robot_file("rc7"))},
        control_mode=mode,
        relative_to=relative_to,
        sim={"max_convergence_time": 0.1},
    )


def require_finite(env: rc.Env, observation: dict[str, Any], reward: float) -> None:
    for numbers in (env.scene.data.qpos, env.scene.data.qvel, env.scene.data.ctrl):
        assert np.isfinite(numbers).all()
    for part in observation["robot"].values():
        assert np.isfinite(part).all()
    assert np.isfinite(reward)


@pytest.mark.parametrize("relative_to", ["last_step", "configured_origin", "none"])
@pytest.mark.parametrize(
    ("mode", "command", "size"),
    [("joints", "joints", 7), ("cartesian_trpy", "xyzrpy", 6), ("cartesian_tquat", "tquat", 7)],
)
def test_absurd_numbers_are_clipped(mode: str, command: str, size: int, relative_to: str):
    with closing(rc.Env(config(mode, relative_to))) as env:
        whole = [HUGE * sign for sign in (1, -1)]
        actions = [np.full(size, value) for value in whole]
        for i in range(size):
            one = np.zeros(size)
            one[-1] = 1
            one[i] = HUGE
            actions.append(one)
        for action in actions:
            env.reset(seed=1)
            for _ in range(2):
                own = {command: action, "gripper": -HUGE}
                observation, reward, *_ = env.step({"robot": own})
                require_finite(env, observation, reward)
                limits = np.array(env.scene.model.jnt_range[:7])
                assert (env.scene.data.ctrl[:7] >= limits[:, 0] - 1e-9).all()
                assert (env.scene.data.ctrl[:7] <= limits[:, 1] + 1e-9).all()


def test_absurd_numbers_are_clipped_in_batches_and_flat_vectors():
    with closing(EnvBatch(config("cartesian_trpy", "last_step"), 2)) as batch:
        batch.reset([1, 2])
        observation, reward, *_ = batch.step(np.full((2, 7), HUGE))
        assert np.isfinite(observation).all()
        assert np.isfinite(reward).all()
    flat = robocell.gym.FlatGymEnv(config("joints", "none"))
    assert isinstance(flat.action_space, gym.spaces.Box)
    flat.reset(seed=1)
    for value in (3e38, -3e38):
        numbers, *_ = flat.step(np.full(flat.action_space.shape, value, np.float32))
        assert np.isfinite(numbers).all()
    flat.close()


def test_rejects_a_zero_quaternion_as_an_absolute_rotation():
    zero = np.array([0.4, 0, 0.3, 0, 0, 0, 0])
    with closing(rc.Env(config("cartesian_tquat", "none"))) as env:
        env.reset(seed=1)
        with pytest.raises(rc.ArgumentError, match="'robot': the quaternion of its tquat is zero"):
            env.step({"robot": {"tquat": zero, "gripper": 1.0}})
    with closing(EnvBatch(config("cartesian_tquat", "none"), 2)) as batch:
        batch.reset([1, 2])
        with pytest.raises(rc.ArgumentError, match="the quaternion of its tquat is zero"):
            batch.step(np.stack([np.append(zero, 1), np.append(zero, 1)]))
    flat = robocell.gym.FlatGymEnv(config("cartesian_tquat", "none"))
    flat.reset(seed=1)
    with pytest.raises(rc.ArgumentError, match="the quaternion of its tquat is zero"):
        flat.step(np.zeros(flat.action_space.shape, np.float32))
    flat.close()
    with closing(
        rc.Env(config("cartesian_tquat", "last_step"))
    ) as env:  # a step that turns nothing
        env.reset(seed=1)
        _, _, terminated, _, _ = env.step({"robot": {"tquat": np.zeros(7), "gripper": 1.0}})
        assert not terminated
