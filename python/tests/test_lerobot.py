"""Environments with the conventions of LeRobot."""

from __future__ import annotations

import importlib.util
import warnings
from pathlib import Path

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import robocell as rc
from robocell.gym import GymEnv, pick_cube_config
from robocell.lerobot import LeRobotEnv

ENV_PY = Path(__file__).parents[2] / "examples" / "lerobot" / "env.py"


def test_passes_the_gymnasium_checker():
    env = LeRobotEnv(pick_cube_config(), max_episode_steps=5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env, skip_render_check=True)
    env.close()


def test_matches_the_gymnasium_environment():
    flat, whole = LeRobotEnv(pick_cube_config(), max_episode_steps=3), GymEnv(pick_cube_config())
    (first, info), (other, _) = flat.reset(seed=3), whole.reset(seed=3)
    assert (flat.task, flat.task_description) == ("pick_cube", "pick up the cube")
    assert flat._max_episode_steps == 3
    assert set(first) == {"agent_pos", "environment_state"}
    robot = other["robot"]
    expected = np.concatenate([robot[key] for key in sorted(robot)])
    assert np.allclose(first["agent_pos"], expected, atol=1e-6)
    assert np.allclose(first["environment_state"], other["objects"]["cube"]["tquat"], atol=1e-6)
    low, high = (
        np.array([*r["robot"]["gripper"], *r["robot"]["tquat"]]) for r in whole.core.action_range
    )
    action = {"robot": {"gripper": [1], "tquat": [0.01, 0, -0.02, 0, 0, 0.1, 1]}}
    numbers = np.array([1, 0.01, 0, -0.02, 0, 0, 0.1, 1])
    scaled = 2 * (numbers - low) / (high - low) - 1
    for i in range(3):
        seen, reward, terminated, truncated, info = flat.step(scaled.astype(np.float32))
        other, expected_reward, *_ = whole.step(action)
        assert flat.observation_space.contains(seen)
        expected = np.concatenate([other["robot"][key] for key in sorted(other["robot"])])
        assert np.allclose(seen["agent_pos"], expected, atol=1e-4)
        assert abs(reward - expected_reward) < 1e-4
        assert (terminated, truncated, info["is_success"]) == (False, i == 2, False)


def test_the_hub_environment_creates_vectors():
    spec = importlib.util.spec_from_file_location("hub_env", ENV_PY)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    vector = module.make_env(n_envs=2)["robocell"][0]
    observation, info = vector.reset(seed=[1, 2])
    assert observation["pixels"]["wrist"].shape == (2, 96, 96, 3)
    assert observation["pixels"]["exo"].dtype == np.uint8
    assert observation["agent_pos"].dtype == np.float32
    assert info["is_success"].tolist() == [False, False]
    assert vector.get_attr("task_description") == ("pick up the cube",) * 2
    assert vector.get_attr("_max_episode_steps") == (200, 200)
    observation, *_, info = vector.step(vector.action_space.sample())
    assert vector.observation_space.contains(observation)
    assert info["is_success"].shape == (2,)
    vector.close()


def test_actions_have_their_numbers_and_episodes_a_length():
    env = LeRobotEnv(pick_cube_config())
    env.reset(seed=0)
    for action, problem in [
        (np.zeros(1), r"it is of shape \(1,\)"),
        (np.zeros((8, 1)), r"it is of shape \(8, 1\)"),
        (0.0, r"it is of shape \(\)"),
        ("far", "it is no array: could not convert"),
    ]:
        with pytest.raises(
            rc.ArgumentError, match="'pick_cube': action must be 8 numbers, " + problem
        ):
            env.step(action)
    with pytest.raises(rc.ArgumentError, match="/ robot 'robot': number 0 of its tquat is nan"):
        env.step(np.full(8, np.nan))
    env.step(np.full(8, 1e300))  # what is beyond is cut
    env.close()
    for limit in (0, -3):
        with pytest.raises(rc.ArgumentError, match=f"max_episode_steps is {limit}; at least 1"):
            LeRobotEnv(pick_cube_config(), max_episode_steps=limit)
