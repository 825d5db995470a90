"""The vector environment against Gymnasium's own, of as many single environments."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import TimeLimit

import robocell as rc
from robocell import _window
from robocell.gym import GymEnv, VectorGymEnv, pick_cube_config

COPIES, LIMIT, STEPS = 3, 4, 11


def only_one_may_use(step: Callable[[], Any], message: str) -> None:
    """Two threads step until one of them raises because the other one steps."""
    told: list[str] = []
    deadline = time.monotonic() + 20

    def run() -> None:
        while not told and time.monotonic() < deadline:
            try:
                step()
            except rc.Error as error:
                told.append(str(error))

    threads = [threading.Thread(target=run) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(told) == {message}


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
def test_matches_a_gymnasium_vector_of_single_environments(mode: AutoresetMode):
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


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_images_are_those_of_single_environments(mode: AutoresetMode):
    def images() -> rc.EnvConfig:
        return pick_cube_config(
            variations={"cube": {"colour": 0.3}},
            cameras={
                "resolution": [32, 24],
                "streams": [{"name": "eye", "camera": "exo_camera", "segmentation": True}],
            },
        )

    ours = VectorGymEnv(images(), 2, 2, mode, threads=2)
    theirs = SyncVectorEnv([lambda: TimeLimit(GymEnv(images()), 2)] * 2, autoreset_mode=mode)
    assert ours.observation_space == theirs.observation_space
    first = ours.reset(seed=5)[0]
    assert same(first, theirs.reset(seed=5)[0])
    assert ours.observation_space.contains(first)
    assert first["frames"]["eye"]["rgb"]["data"].shape == (2, 24, 32, 3)
    ours.action_space.seed(1)
    for _ in range(3):
        action = ours.action_space.sample()
        mine, other = ours.step(action), theirs.step(action)
        assert same(mine[:4], other[:4])
        if "final_obs" in mine[4]:
            assert all(map(same, mine[4]["final_obs"], other[4]["final_obs"]))
    theirs.close()
    ours.close()


@pytest.mark.parametrize("flat", [False, True])
def test_pictures_are_those_of_single_environments(flat: bool):
    config = {"variations": {"cube": {"colour": 0.3}}, "flat": flat, "render_mode": "rgb_array"}
    ours = gym.make_vec("robocell/PickCube-v0", num_envs=2, **config)
    theirs = gym.make_vec("robocell/PickCube-v0", num_envs=2, vectorization_mode="sync", **config)
    assert (ours.render_mode, ours.metadata["render_fps"]) == ("rgb_array", 20)
    for env in (ours, theirs):
        env.reset(seed=5)
    ours.action_space.seed(1)
    for env in (ours, theirs):
        env.step(ours.action_space.sample())
        ours.action_space.seed(1)
    mine, other = ours.render(), theirs.render()
    assert mine[0].shape == (360, 480, 3)
    assert same(mine, other)
    assert not np.array_equal(*mine)
    for env in (ours, theirs):
        env.close()


def test_copies_have_no_windows(monkeypatch):
    with pytest.raises(rc.ArgumentError, match="must be None or 'rgb_array', got 'human': its cop"):
        VectorGymEnv(pick_cube_config(), 2, render_mode="human")
    monkeypatch.setattr(_window, "_warned", set())
    with pytest.warns(UserWarning, match="no window: copies in a vector have none"):
        vector = VectorGymEnv(pick_cube_config(headless=False), 1)
    assert vector.render() is None
    vector.close()


def test_make_vec_builds_it_by_its_registered_name():
    vector = gym.make_vec("robocell/PickCube-v0", num_envs=2, threads=1)
    vector.action_space.seed(0)
    observation, _ = vector.reset(seed=[7, 7])
    assert observation["objects"]["cube"]["tquat"].shape == (2, 7)
    assert np.array_equal(*observation["robot"]["joints"])
    *_, info = vector.step(vector.action_space.sample())
    assert info["is_success"].tolist() == [False, False]
    assert info["_is_success"].all()
    assert set(info["reason"]) <= {"timeout", "arrived", "settled", "ik_failed"}
    left = info["robots"]["robot"]
    assert left["joint_error"].shape == (2,)
    assert (left["joint_error"] < 0.2).all()
    assert left["ik_success"].dtype == bool
    assert left["_joint_error"].all()
    assert info["_robots"].all()
    assert info["instruction"].tolist() == ["pick up the cube"] * 2
    vector.close()
    vector.close()
    with pytest.raises(rc.ClosedError, match="batch of environment 'pick_cube' is closed"):
        vector.reset()


def test_infos_cover_the_copies_that_stepped():
    """Three copies of which the middle one was reset later, so that it ends later."""
    for mode in (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP):
        vector = VectorGymEnv(pick_cube_config(), 3, 2, mode)
        _, info = vector.reset(seed=0)
        assert info["instruction"].tolist() == ["pick up the cube"] * 3
        action = vector.action_space.sample()
        vector.step(action)
        late = np.array([False, True, False])
        _, info = vector.reset(options={"reset_mask": late})
        assert info["instruction"].tolist() == [None, "pick up the cube", None]
        *_, truncated, info = vector.step(action)
        assert np.array_equal(truncated, ~late)
        if mode == AutoresetMode.NEXT_STEP:
            assert info["_reason"].all()
            *_, info = vector.step(action)
        else:
            assert np.array_equal(info["final_info"]["_time"], ~late)
            assert np.allclose(info["final_info"]["time"], [0.1, 0, 0.1])
        assert np.array_equal(info["_reason"], late)
        assert [reason is not None for reason in info["reason"]] == late.tolist()
        assert np.array_equal(info["time"] > 0, late)
        assert not info["is_success"].any()
        assert info["_instruction"].all()
        vector.close()


def test_unseeded_starts_are_random():
    cubes = []
    for _ in range(2):
        vector = VectorGymEnv(pick_cube_config(), 2)
        cubes += list(vector.reset()[0]["objects"]["cube"]["tquat"])
        cubes += list(vector.reset(seed=[3, None])[0]["objects"]["cube"]["tquat"][1:])
        vector.close()
        env = GymEnv(pick_cube_config())
        cubes.append(env.reset()[0]["objects"]["cube"]["tquat"])
        env.close()
    assert len({cube.tobytes() for cube in cubes}) == len(cubes)


def test_seeds_and_masks_apply_to_their_copies():
    vector = VectorGymEnv(pick_cube_config(), 2)
    first, _ = vector.reset(seed=np.int64(5))
    assert same(first, vector.reset(seed=[5, np.uint8(6)])[0])
    for reset, problem in [
        ({"seed": -1}, "seed must be 0 or more, got -1"),
        ({"seed": [1, -2]}, "seed must be 0 or more, got -2"),
        ({"seed": [1]}, "reset of 2 copies: seeds for 1 were given"),
        (
            {"options": {"pose": 1}},
            "reset takes the options 'reset_mask' and 'keyframe' here, got pose",
        ),
        ({"options": {"reset_mask": [0, 1]}}, "must be 2 bools, one for each copy; got int64 of"),
        ({"options": {"reset_mask": np.ones(3, bool)}}, r"got bool of shape \(3,\)"),
    ]:
        with pytest.raises(rc.ArgumentError, match=problem):
            vector.reset(**reset)
    vector.close()


def test_rejects_the_actions_that_a_single_environment_rejects():
    vector = VectorGymEnv(pick_cube_config(), 2)
    vector.reset(seed=0)
    good = vector.action_space.sample()["robot"]
    vector.step({"robot": good | {"gripper": [0, 1]}})
    place = "environment 'pick_cube': action"
    for action, problem in [
        ({"robo": good}, f"{place}: no 'robo', 'robot' is missing; it takes robot"),
        ({"robot": 1}, rf"{place}\.robot must be a dict, got int; it takes tquat, gripper$"),
        (np.zeros((2, 8)), rf"{place} must be a dict, got ndarray; it takes robot. With flat=True"),
        ({"robot": {"tquat": good["tquat"]}}, rf"{place}\.robot: 'gripper' is missing; it takes"),
        ({"robot": good | {"joints": 1}}, rf"{place}\.robot: no 'joints'; it takes tquat, gripper"),
        ({"robot": good | {"tquat": np.ones((7, 2))}}, r"it is of shape \(7, 2\)"),
        (
            {"robot": good | {"tquat": np.ones(14)}},
            r"a row of 7 numbers for each copy \(2\)",
        ),
        ({"robot": good | {"tquat": "far"}}, "it is no array: could not convert"),
    ]:
        with pytest.raises(rc.ArgumentError, match=problem):
            vector.step(action)
    vector.close()


def test_rejects_an_unknown_autoreset_mode():
    known = "must be 'NextStep', 'SameStep', 'Disabled', or an AutoresetMode of Gymnasium's"
    with pytest.raises(rc.ArgumentError, match=f"{known}, got 'same_step'"):
        gym.make_vec("robocell/PickCube-v0", num_envs=2, autoreset_mode="same_step")
    vector = gym.make_vec("robocell/PickCube-v0", num_envs=2, autoreset_mode="SameStep")
    assert vector.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    vector.close()


def test_rejects_use_by_two_threads():
    vector = VectorGymEnv(pick_cube_config(), 2, threads=1)
    vector.reset(seed=0)
    only_one_may_use(
        lambda: vector.step(vector.action_space.sample()),
        "batch of environment 'pick_cube' is being stepped by another thread: one call at a time",
    )
    vector.close()
    env = GymEnv(pick_cube_config())
    env.reset(seed=0)
    only_one_may_use(
        lambda: env.step(env.action_space.sample()),
        "environment 'pick_cube' is being stepped by another thread: one call at a time",
    )
    env.close()


def test_errors_name_the_copy_with_a_wrong_action():
    vector = VectorGymEnv(pick_cube_config(), 2)
    vector.reset(seed=0)
    action = vector.action_space.sample()
    action["robot"]["tquat"][1, 2] = np.nan
    with pytest.raises(rc.ArgumentError, match=r"'pick_cube\[1\]' / robot 'robot': number 2 of"):
        vector.step(action)
    with pytest.raises(rc.ArgumentError, match="options of reset must be a dict or None, got list"):
        vector.reset(options=[1])
    with pytest.raises(rc.ArgumentError, match="0 copies; at least 1"):
        VectorGymEnv(pick_cube_config(), 0)
    with pytest.raises(
        rc.ArgumentError,
        match=r"'pick_cube': 1000000000 copies need [\d.e+]+ GB of memory or more, [\d.]+ MB each; "
        r"this machine has [\d.]+ GB",
    ):
        VectorGymEnv(pick_cube_config(), 10**9)
    with pytest.raises(rc.ArgumentError, match="threads is -1; 0 for one for each core, or more"):
        VectorGymEnv(pick_cube_config(), 2, threads=-1)
    for limit in (0, -3):
        with pytest.raises(rc.ArgumentError, match=f"max_episode_steps is {limit}; at least 1"):
            VectorGymEnv(pick_cube_config(), 2, limit)
    vector.close()


def test_commands_and_rows_by_name_are_those_of_single_environments():
    streams = [{"name": "eye", "camera": "exo_camera", "depth": True, "segmentation": True}]
    config = pick_cube_config(cameras={"resolution": [16, 12], "streams": streams})
    vector = VectorGymEnv(config, num_envs=COPIES)
    vector.reset(seed=3)
    singles = [rc.Env(config) for _ in range(COPIES)]
    for i, env in enumerate(singles):
        env.reset(seed=3 + i)
    for step in range(3):
        targets = vector.row()["robots/robot/arm/target"]
        actions = {"robots/robot/action/arm": targets + 0.02 * np.cos(step + np.arange(7))}
        if step != 1:  # groups without a command keep their target
            actions["robots/robot/action/gripper"] = np.linspace(0, 1, COPIES)
        _, rewards, *_ = vector.step(actions)
        for i, env in enumerate(singles):
            reward = env.step({name: rows[i] for name, rows in actions.items()})[1]
            assert reward == rewards[i]
        rows = [env.row() for env in singles]
        seen = vector.row()
        assert list(seen) == list(rows[0])
        for name, value in seen.items():
            expected = np.stack([row[name] for row in rows])
            assert (value.dtype, value.shape) == (expected.dtype, expected.shape), name
            assert np.array_equal(value, expected), name
    vector.close()


def test_wrong_commands_by_name_move_no_copy():
    vector = VectorGymEnv(pick_cube_config(), num_envs=2)
    vector.reset(seed=0)
    before = vector.row()
    target = before["robots/robot/arm/target"]
    for actions, error, text in (
        ({"robots/robot/action/amr": target}, rc.NotFoundError, "Did you mean 'robots/robot/act"),
        ({"robots/robot/action/arm": target[0]}, rc.ArgumentError, "actions.robots/robot/action/a"),
        (
            {"robots/robot/action/arm": target[:1]},
            rc.ArgumentError,
            "must be a 2x7 matrix, got 1 r",
        ),
        ({"robots/robot/action/arm": target[:, :6]}, rc.ArgumentError, "7"),
        ({"robots/robot/action/arm": target * np.nan}, rc.ArgumentError, "not finite"),
        ({"robots/robot/action/gripper": [0.5]}, rc.ArgumentError, "must be a 2x1 matrix, got 1 r"),
    ):
        with pytest.raises(error) as caught:
            vector.step(actions)
        assert text in str(caught.value)
    after = vector.row()
    assert all(np.array_equal(after[name], before[name]) for name in before)
    with pytest.raises(rc.ArgumentError, match="choices for 1 were given"):
        vector.core.step({}, [True])
    vector.close()


def test_an_action_has_one_form():
    vector = VectorGymEnv(pick_cube_config(), num_envs=2)
    vector.reset(seed=0)
    before = vector.row()
    target = before["robots/robot/arm/target"]
    both = vector.action_space.sample() | {"robots/robot/action/arm": target}
    text = (
        "one form, and this one has two: 'robots/robot/action/arm' is the name of a column, "
        "'robot' is not"
    )
    with pytest.raises(rc.ArgumentError, match=text):
        vector.step(both)
    after = vector.row()
    assert all(np.array_equal(after[name], before[name]) for name in before)
    vector.close()
