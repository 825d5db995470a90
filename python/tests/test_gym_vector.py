"""The vector environment against Gymnasium's own, of as many single environments."""

from __future__ import annotations

from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import TimeLimit

import robocell as rc
from robocell.gym import GymEnv, VectorGymEnv, pick_cube_config

COPIES, LIMIT, STEPS = 3, 4, 11


def single() -> gym.Env[Any, Any]:
    return TimeLimit(GymEnv(pick_cube_config()), LIMIT)


def leaves(value: Any) -> list[np.ndarray]:
    if isinstance(value, dict):
        return [leaf for key in sorted(value) for leaf in leaves(value[key])]
    if isinstance(value, tuple):
        return [leaf for item in value for leaf in leaves(item)]
    return [np.asarray(value)]


def same(a: Any, b: Any) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(leaves(a), leaves(b), strict=True))


@pytest.mark.parametrize("mode", AutoresetMode, ids=lambda mode: mode.name)
def test_it_is_gymnasiums_vector_of_single_environments(mode: AutoresetMode):
    ours = VectorGymEnv(pick_cube_config(), COPIES, LIMIT, mode, threads=2)
    theirs = SyncVectorEnv([partial(single)] * COPIES, autoreset_mode=mode)
    assert ours.action_space == theirs.action_space
    assert ours.observation_space == theirs.observation_space
    assert ours.metadata["autoreset_mode"] == mode
    assert same(ours.reset(seed=5)[0], theirs.reset(seed=5)[0])
    ours.action_space.seed(1)
    for _ in range(STEPS):
        action = ours.action_space.sample()
        mine, other = ours.step(action), theirs.step(action)
        assert same(mine[:4], other[:4])
        assert ours.observation_space.contains(mine[0])
        ended = mine[2] | mine[3]
        if mode == AutoresetMode.SAME_STEP and ended.any():
            assert np.array_equal(mine[4]["_final_obs"], ended)
            assert all(map(same, mine[4]["final_obs"][ended], other[4]["final_obs"][ended]))
        if mode == AutoresetMode.DISABLED and ended.any():
            with pytest.raises(rc.ArgumentError, match=r"episodes of \[0, 1, 2\] have ended"):
                ours.step(action)
            fresh = [env.reset(options={"reset_mask": ended})[0] for env in (ours, theirs)]
            assert same(*fresh)
    theirs.close()
    ours.close()


def test_it_is_made_by_its_registered_name():
    vector = gym.make_vec("robocell/PickCube-v0", num_envs=2)
    observation, _ = vector.reset(seed=[7, 7])
    assert observation["objects"]["cube"]["tquat"].shape == (2, 7)
    assert np.array_equal(*observation["robot"]["joints"])
    *_, info = vector.step(vector.action_space.sample())
    assert info["is_success"].tolist() == [False, False]
    assert info["_is_success"].all()
    assert set(info["reason"]) <= {"timeout", "arrived", "ik_failed"}
    vector.close()


def test_what_is_wrong_is_told_by_the_copy():
    vector = VectorGymEnv(pick_cube_config(), 2)
    vector.reset(seed=0)
    action = vector.action_space.sample()
    action["robot"]["tquat"][1, 2] = np.nan
    with pytest.raises(rc.ArgumentError, match=r"'pick_cube\[1\]' / robot 'robot': number 2 of"):
        vector.step(action)
    with pytest.raises(rc.ArgumentError, match="0 copies; at least 1"):
        VectorGymEnv(pick_cube_config(), 0)
    vector.close()
