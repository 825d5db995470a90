"""Environments of stable-baselines3, where it is installed; robocell does not need it."""

from __future__ import annotations

import numpy as np
import pytest

import robocell as rc
from robocell.gym import FlatVectorGymEnv, pick_cube_config
from robocell.sb3 import VecEnv


def test_it_is_the_vector_environment():
    env = VecEnv(pick_cube_config(), 2, max_episode_steps=2)
    vector = FlatVectorGymEnv(pick_cube_config(), 2, 2, "SameStep")
    env.seed(5)
    seen, (other, _) = env.reset(), vector.reset(seed=[5, 6])
    assert np.array_equal(seen, other)
    assert env.reset_infos[0]["instruction"] == "pick up the cube"
    vector.action_space.seed(0)
    for step in range(4):
        actions = vector.action_space.sample()
        seen, rewards, ended, infos = env.step(actions)
        other, other_rewards, _, truncated, other_infos = vector.step(actions)
        assert np.array_equal(seen, other)
        assert np.array_equal(rewards, other_rewards)
        assert list(ended) == [step % 2 == 1] * 2
        for i, info in enumerate(infos):
            assert info["is_success"] is np.False_
            assert info["TimeLimit.truncated"] == truncated[i]
            assert ("terminal_observation" in info) == ended[i]
            if ended[i]:
                assert np.array_equal(info["terminal_observation"], other_infos["final_obs"][i])
    env.close()
    vector.close()


def test_a_library_learns_in_it():
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecMonitor

    env = VecMonitor(VecEnv(pick_cube_config(), 2, max_episode_steps=4))
    model = PPO("MlpPolicy", env, n_steps=8, batch_size=16, n_epochs=1, seed=0, device="cpu")
    model.learn(16)
    assert len(model.ep_info_buffer) == 4
    env.close()


def test_copies_have_nothing_of_their_own():
    env = VecEnv(pick_cube_config(), 2)
    assert env.get_attr("num_envs") == [2, 2]
    assert env.env_is_wrapped(object, indices=[0]) == [False]
    with pytest.raises(rc.ArgumentError, match="no attributes of their own, speed"):
        env.set_attr("speed", 1)
    with pytest.raises(rc.ArgumentError, match="no methods of their own, such as jump"):
        env.env_method("jump")
    env.close()
