"""Environments with vectors, beside those with dictionaries."""

from __future__ import annotations

import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

import robocell as rc
from robocell.gym import FlatGymEnv, FlatVectorGymEnv, VectorGymEnv, pick_cube_config

COPIES, LIMIT = 3, 2


def rows(observation: dict) -> np.ndarray:
    robot, cube = observation["robot"], observation["objects"]["cube"]
    parts = [robot[key] for key in ("tquat", "xyzrpy", "joints", "gripper")]
    return np.concatenate([*parts, cube["tquat"]], axis=-1)


def test_matches_the_environment_with_dictionaries():
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


def test_final_observations_are_vectors():
    vector = FlatVectorGymEnv(pick_cube_config(), 2, 1, "SameStep")
    vector.reset(seed=0)
    action = np.ones((2, 8)) * [1, 0, 0, 0, 0, 0, 0, 1]
    seen, _, _, truncated, infos = vector.step(action)
    assert truncated.all()
    for i in range(2):
        assert infos["final_obs"][i].shape == vector.single_observation_space.shape
        assert not np.array_equal(infos["final_obs"][i], seen[i])
    vector.close()


def test_clips_actions_and_records_statistics():
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


def test_rejects_images_and_actions_of_a_wrong_shape():
    config = pick_cube_config()
    config.cameras.streams = [rc.render.CameraConfig(name="eye", camera="robotrobot_exo_camera")]
    with pytest.raises(rc.ArgumentError, match=r"flat observations have no images; .* \(eye\)"):
        FlatVectorGymEnv(config, 2)
    vector = FlatVectorGymEnv(pick_cube_config(), 2)
    vector.reset()
    with pytest.raises(rc.ArgumentError, match=r"a row of 8 numbers .* it is of shape \(8,\)"):
        vector.step(np.zeros(8))
    with pytest.raises(rc.ArgumentError, match="it is no array: could not convert"):
        vector.step("far")
    vector.close()


def test_a_single_flat_environment_matches_a_copy_of_the_vector():
    """Also of a task with signals, whose dictionaries come in another order than the numbers."""
    for name in ("robocell/PickCube-v0", "robocell/PickPlace-v0"):
        one = gym.make(name, flat=True)
        vector = gym.make_vec(name, num_envs=2, flat=True)
        assert one.action_space == vector.single_action_space
        assert one.observation_space == vector.single_observation_space
        (seen, info), (rows, _) = one.reset(seed=4), vector.reset(seed=[3, 4])
        assert info["instruction"].startswith("pick up the cube")
        vector.action_space.seed(0)
        for _ in range(3):
            assert np.array_equal(seen, rows[1])
            assert one.observation_space.contains(seen)
            actions = vector.action_space.sample()
            seen, reward, *_ = one.step(actions[1])
            rows, rewards, *_ = vector.step(actions)
            assert reward == rewards[1]
        one.close()
        vector.close()


def test_passes_the_gymnasium_checker_without_warnings():
    env = FlatGymEnv(pick_cube_config())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env, skip_render_check=True)
    env.close()


def test_works_in_gymnasium_vectors():
    modes = {}
    for mode in ("sync", "async", None):
        vector = gym.make_vec(
            "robocell/PickCube-v0", num_envs=2, flat=True, vectorization_mode=mode
        )
        seen, _ = vector.reset(seed=[1, 2])
        rewards = vector.step(np.zeros((2, 8), dtype=np.float32))[1]
        modes[mode] = (seen, rewards)
        vector.close()
    for seen, rewards in modes.values():
        assert np.array_equal(seen, modes[None][0])
        assert np.array_equal(rewards, modes[None][1])


def test_a_single_environment_rejects_wrong_actions_and_images():
    env = FlatGymEnv(pick_cube_config())
    env.reset(seed=0)
    with pytest.raises(rc.ArgumentError, match=r"'pick_cube': action must be 8 numbers, .*\(7,\)"):
        env.step(np.zeros(7))
    with pytest.raises(rc.ArgumentError, match="must be 8 numbers, it is no array: could not"):
        env.step("far")
    config = pick_cube_config()
    config.cameras.streams = [rc.render.CameraConfig(name="eye", camera="exo_camera")]
    with pytest.raises(rc.ArgumentError, match=r"flat observations have no images; .* \(eye\)"):
        FlatGymEnv(config)
    env.close()


def test_works_with_gymnasium_box_wrappers():
    env = gym.make("robocell/PickCube-v0", flat=True)
    ends = np.full((2, 8), np.float32([[-2], [2]]))
    wrapped = gym.wrappers.ClipAction(gym.wrappers.RescaleAction(env, *ends))
    plain = gym.make("robocell/PickCube-v0", flat=True)
    wrapped.reset(seed=0)
    plain.reset(seed=0)
    action = np.array([1, 0, -1, 0, 0, 0, 1, 1], dtype=np.float32)
    assert np.array_equal(wrapped.step(3 * action)[0], plain.step(action)[0])
    plain.close()
    wrapped.close()
    env = gym.make("robocell/PickCube-v0")  # dictionaries they do not take
    with pytest.raises(TypeError, match="requires a Box action space"):
        gym.wrappers.RescaleAction(env, -1.0, 1.0)
    env.close()
