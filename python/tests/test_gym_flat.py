"""The vector environment with vectors, beside the one with dictionaries."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

import robocell as rc
from robocell.gym import FlatVectorGymEnv, VectorGymEnv, pick_cube_config

COPIES, LIMIT = 3, 2


def rows(observation: dict) -> np.ndarray:
    robot, cube = observation["robot"], observation["objects"]["cube"]
    parts = [robot[key] for key in ("tquat", "xyzrpy", "joints", "gripper")]
    return np.concatenate([*parts, cube["tquat"]], axis=-1)


def test_it_is_the_same_environment_in_other_clothes():
    arguments = (pick_cube_config(), COPIES, LIMIT, AutoresetMode.SAME_STEP)
    flat, dressed = FlatVectorGymEnv(*arguments), VectorGymEnv(*arguments)
    seen, _ = flat.reset(seed=4)
    other, _ = dressed.reset(seed=4)
    robot = dressed.single_action_space["robot"]
    low, high = (
        np.concatenate([getattr(robot[k], e) for k in ("tquat", "gripper")])
        for e in ("low", "high")
    )
    flat.action_space.seed(0)
    for step in range(3):
        assert flat.observation_space.contains(seen)
        assert np.array_equal(seen, rows(other).astype(np.float32))
        action = flat.action_space.sample()
        numbers = low + (action.astype(float) + 1) / 2 * (high - low)
        seen, *ends, info = flat.step(action)
        other, *other_ends, other_info = dressed.step(
            {"robot": {"tquat": numbers[:, :7], "gripper": numbers[:, 7:]}}
        )
        assert all(map(np.array_equal, ends, other_ends))
        assert ("final_obs" in info) == (step == 1)
    assert list(info["is_success"]) == list(other_info["is_success"])
    flat.close()
    dressed.close()


def test_final_observations_are_vectors_too():
    vector = FlatVectorGymEnv(pick_cube_config(), 2, 1, "SameStep")
    vector.reset(seed=0)
    action = np.ones((2, 8)) * [1, 0, 0, 0, 0, 0, 0, 1]
    seen, _, _, truncated, infos = vector.step(action)
    assert truncated.all()
    for i in range(2):
        assert infos["final_obs"][i].shape == vector.single_observation_space.shape
        assert not np.array_equal(infos["final_obs"][i], seen[i])
    vector.close()


def test_what_learning_code_does_with_it():
    made = gym.make_vec("robocell/PickCube-v0", num_envs=2, flat=True, max_episode_steps=2)
    vector = RecordEpisodeStatistics(made)
    assert isinstance(vector.single_action_space, gym.spaces.Box)
    assert vector.single_observation_space.dtype == np.float32
    vector.reset(seed=1)
    beyond = np.full((2, 8), 7.0, dtype=np.float32)
    for _ in range(2):
        *_, truncated, infos = vector.step(beyond)
    assert truncated.all()
    assert list(infos["episode"]["l"]) == [2, 2]
    vector.close()
    gym.make_vec("robocell/PickPlace-v0", num_envs=1, flat=True).close()


def test_what_is_no_vector_is_refused():
    config = pick_cube_config()
    config.cameras.streams = [rc.CameraConfig(name="eye", camera="robotrobot_exo_camera")]
    with pytest.raises(rc.ArgumentError, match=r"flat observations have no images; .* \(eye\)"):
        FlatVectorGymEnv(config, 2)
    vector = FlatVectorGymEnv(pick_cube_config(), 2)
    vector.reset()
    with pytest.raises(rc.ArgumentError, match=r"a row of 8 numbers .* it is of shape \(8,\)"):
        vector.step(np.zeros(8))
    vector.close()
