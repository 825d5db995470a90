"""stable-baselines3 learns, where it is installed; robocell does not need it."""

from __future__ import annotations

import gymnasium as gym
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecMonitor

from robocell.gym import pick_cube_config
from robocell.sb3 import VecEnv

SMALL = {"n_steps": 8, "batch_size": 16, "n_epochs": 1, "seed": 0, "device": "cpu"}


def test_in_copies_on_threads():
    env = VecMonitor(VecEnv(pick_cube_config(), 2, max_episode_steps=4))
    model = PPO("MlpPolicy", env, **SMALL)
    model.learn(16)
    assert len(model.ep_info_buffer) == 4
    env.close()


def test_in_environments_created_by_sb3():
    check_env(gym.make("robocell/PickCube-v0", flat=True).unwrapped)
    options = {"flat": True, "max_episode_steps": 4}
    env = make_vec_env("robocell/PickCube-v0", n_envs=2, seed=0, env_kwargs=options)
    model = PPO("MlpPolicy", env, **SMALL)
    model.learn(16)
    assert len(model.ep_info_buffer) == 4
    env.close()
