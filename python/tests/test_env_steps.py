"""How steps of rc.Env end, and what limits, grippers and resets do, from Python."""

from __future__ import annotations

import time

import numpy as np
import pytest

import robocell as rc

RC7 = rc.models.robot_file("rc7")


def make(**fields) -> rc.Env:
    chosen = {"robots": {"robot": RC7}, "control_mode": "cartesian_tquat"}
    env = rc.Env(rc.EnvConfig(**(chosen | fields)))
    env.reset(seed=1)
    return env


def move(env: rc.Env, position, rotation=(0, 0, 0, 1), gripper: float = 1):
    observation, *_, info = env.step(
        {"robot": {"tquat": [*position, *rotation], "gripper": gripper}}
    )
    return observation["robot"], info


def test_a_step_ends_on_arrival_or_when_its_time_is_up():
    assert move(make(), [0, 0, 0.02])[1]["reason"] == "arrived"
    _, info = move(make(sim={"max_convergence_time": 0.01}), [0, 0, 0.05])
    assert (info["reason"], info["time"]) == ("timeout", pytest.approx(0.01))


def test_a_step_ends_where_a_robot_runs_into_something():
    wall = {
        "shape": "box",
        "size": [0.1, 0.02, 0.5],
        "mass": 1,
        "fixed": True,
        "offset": rc.Pose(translation=[0.15, -0.2, 0.5]),
    }
    env = make(world_frame_objects={"wall": wall}, sim={"on_collision": "stop"})
    reasons = []
    while len(reasons) < 30 and reasons[-1:] != ["collision"]:
        _, info = move(env, [0, -0.05, 0])
        reasons.append(info["reason"])
    assert reasons[-1] == "collision"
    assert info["collisions"][0]["robot"] == "robot"
    assert info["collisions"][0]["other_body"] == "wall"


def test_a_pose_without_solution_is_told():
    env = make(relative_to="none")
    _, upper = env.action_range
    corner = upper["robot"]["tquat"][:3]
    _, info = move(env, corner)
    assert info["reason"] == "ik_failed"
    assert not info["robots"]["robot"]["ik_success"]


@pytest.mark.parametrize(
    "sim", [{"async_control": True, "frequency": 20}, {}], ids=["rate", "goal"]
)
def test_paced_steps_take_the_time_that_they_simulate(sim):
    env = make(sim={"realtime": True} | sim)
    begin = time.perf_counter()
    _, info = move(env, [0, 0, 0.01])
    assert time.perf_counter() - begin >= 0.98 * info["time"] > 0


def test_a_step_is_limited_from_where_the_arm_was_sent():
    env = make(relative_to="none", max_relative_movement=(0.01, 0.1))
    begin = env.reset(seed=1)[0]["robot"]["tquat"]
    above, turn = begin[:3] + np.array([0, 0, 0.06]), begin[3:]
    heights = [move(env, above, turn)[0]["tquat"][2] - begin[2] for _ in range(8)]
    assert np.allclose(heights, [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.06, 0.06], atol=0.006)


def test_a_gripper_is_open_from_a_half_on_or_anything_between():
    env = make()
    told = [move(env, [0, 0, 0], gripper=g)[0]["gripper"][0] for g in (0.49, 0.5, 0, 1)]
    assert told == [0, 1, 0, 1]
    env = make(wrappers={"binary_gripper": False})
    assert move(env, [0, 0, 0], gripper=0.4)[0]["gripper"][0] == pytest.approx(0.4, abs=0.05)


def test_arms_go_home_at_a_reset_or_stay_where_they_are():
    for home in (True, False):
        env = make(wrappers={"home_on_reset": home})
        start = env.reset(seed=1)[0]["robot"]["joints"]
        left, _ = move(env, [0, 0, 0.05])
        after = env.reset(seed=1)[0]["robot"]["joints"]
        assert np.allclose(after, start if home else left["joints"], atol=1e-9)
