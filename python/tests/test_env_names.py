"""Rows and actions of environments by the names of columns: what is refused, and how."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import robocell as rc

ROBOT = "robots/robot"
ARM = f"{ROBOT}/action/arm"
CONFIG = rc.EnvConfig(robots={"robot": rc.models.robot_file("rc7")})


@pytest.fixture(scope="module")
def env() -> Iterator[rc.Env]:
    made = rc.Env(CONFIG)
    made.reset(seed=0)
    yield made
    made.close()


@pytest.fixture(scope="module")
def batch() -> Iterator[rc.envs.EnvBatch]:
    made = rc.envs.EnvBatch(CONFIG, count=2)
    made.reset(seeds=[0, 1])
    yield made
    made.close()


def test_a_name_that_a_row_lacks_has_the_nearest(env: rc.Env, batch: rc.envs.EnvBatch):
    for row in (env.row(), batch.row()):
        with pytest.raises(KeyError, match=f"the row has no '{ROBOT}/arm/qps'. Did you mean"):
            row[f"{ROBOT}/arm/qps"]
        assert f"{ROBOT}/arm/qps" not in row
        assert row.get(f"{ROBOT}/arm/qps") is None
        copy = pickle.loads(pickle.dumps(row))
        assert type(copy) is dict
        assert list(copy) == list(row)


@pytest.mark.parametrize(
    "wrong",
    [
        np.zeros(7, complex),
        np.zeros(7, np.complex64),
        [0j] * 7,
        np.zeros((1, 7)),
        [[0.0] * 7],
    ],
)
def test_an_action_is_a_row_of_real_numbers(env: rc.Env, batch: rc.envs.EnvBatch, wrong: Any):
    before = env.get_state(), batch.row()
    with pytest.raises(TypeError, match=rf"{ARM}\[0\] must be a number, got "):
        env.step({ARM: wrong})
    with pytest.raises(TypeError, match=r"robot.joints\[0\] must be a number, got "):
        env.step({"robot": {"joints": wrong, "gripper": 1}})
    with pytest.raises(TypeError, match="must be a number, got "):
        batch.step({ARM: [wrong, wrong]})
    assert np.array_equal(env.get_state().numbers, before[0].numbers)
    after = batch.row()
    assert all(np.array_equal(after[name], before[1][name]) for name in after)


@pytest.mark.parametrize("opening", [1, 1.0, np.float32(1), np.array(1), [1], np.ones(1)])
def test_a_single_number_needs_no_list(env: rc.Env, opening: Any):
    env.step({f"{ROBOT}/action/gripper": opening})


def test_an_action_has_one_form(env: rc.Env, batch: rc.envs.EnvBatch):
    text = f"an action has one form, and this one has two: '{ARM}' is the name of a column, 'robot'"
    arm = env.row()[f"{ROBOT}/arm/target"]
    with pytest.raises(rc.ArgumentError, match=text):
        env.step({ARM: arm, "robot": {"joints": arm, "gripper": 1}})
    with pytest.raises(rc.ArgumentError, match=text):
        batch.step({ARM: [arm, arm], "robot": {"joints": [arm, arm], "gripper": [1, 1]}})
    text = r"actions are \(count, n\) numbers, .*VectorGymEnv takes 'robot'"
    with pytest.raises(rc.ArgumentError, match=text):
        batch.step({"robot": {"joints": [arm, arm], "gripper": [1, 1]}})
    with pytest.raises(rc.NotFoundError, match=f"Did you mean '{ARM}'"):
        batch.step({"robot/robot/action/arm": [arm, arm]})
