"""Environments of stable-baselines3; where it is not installed, on what it asks of them."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import robocell as rc
import sb3_stand_in
from robocell.gym import FlatVectorGymEnv, pick_cube_config


@pytest.fixture
def vec_env() -> Iterator[Any]:
    """robocell.sb3.VecEnv."""
    sb3_stand_in.stand_in()
    from robocell.sb3 import VecEnv

    yield VecEnv
    sb3_stand_in.leave()


def test_matches_the_vector_environment(vec_env):
    env = vec_env(pick_cube_config(), 2, max_episode_steps=2)
    vector = FlatVectorGymEnv(pick_cube_config(), 2, 2, "SameStep")
    env.seed(5)
    seen, (other, _) = env.reset(), vector.reset(seed=[5, 6])
    assert np.array_equal(seen, other)
    assert env.reset_infos[0]["instruction"] == "pick up the cube"
    assert env.observation_space.contains(seen[0])
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


def test_a_seed_applies_to_one_reset_and_options_are_validated(vec_env):
    env = vec_env(pick_cube_config(), 2)
    env.seed(5)
    first, second = env.reset(), env.reset()
    assert not np.array_equal(first, second)
    env.seed(5)
    assert np.array_equal(env.reset(), first)
    env.set_options({"pose": 1})
    with pytest.raises(rc.ArgumentError, match="reset takes the option 'keyframe' here, got pose"):
        env.reset()
    env.set_options([{"keyframe": "home"}, {}])
    with pytest.raises(rc.ArgumentError, match="all copies take the same options, got"):
        env.reset()
    env.seed(5)
    env.set_options({"keyframe": "home"})
    assert np.array_equal(env.reset(), first)
    env.set_options({"keyframe": "hom"})
    with pytest.raises(rc.NotFoundError, match="no keyframe 'hom'"):
        env.reset()
    env.close()


def test_pictures_are_those_of_the_vector(vec_env):
    env = vec_env(pick_cube_config(), 2, render_mode="rgb_array")
    env.seed(5)
    env.reset()
    images = env.get_images()
    assert env.render_mode == "rgb_array"
    assert [image.shape for image in images] == [(360, 480, 3)] * 2
    assert not np.array_equal(*images)
    env.close()
    without = vec_env(pick_cube_config(), 1)
    assert (without.render_mode, without.get_images()) == (None, [])
    without.close()


def test_copies_have_no_separate_attributes(vec_env):
    env = vec_env(pick_cube_config(), 2)
    assert env.get_attr("num_envs") == [2, 2]
    assert env.env_is_wrapped(object, indices=[0]) == [False]
    with pytest.raises(rc.ArgumentError, match="no separate attributes, speed"):
        env.set_attr("speed", 1)
    with pytest.raises(rc.ArgumentError, match="no separate methods, such as jump"):
        env.env_method("jump")
    env.close()


def test_without_the_package_the_error_has_the_install_command(monkeypatch):
    monkeypatch.delitem(sys.modules, "robocell.sb3", raising=False)
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install gymnasium stable-base") as told:
        importlib.import_module("robocell.sb3")
    assert told.value.name == "stable_baselines3.common"
