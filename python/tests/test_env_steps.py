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


WALL = {
    "shape": "box",
    "size": [0.1, 0.02, 0.5],
    "mass": 1,
    "fixed": True,
    "offset": rc.Pose(translation=[0.15, -0.2, 0.5]),
}


PUSHED_ON = {"max_target_lead": (1, 3)}


def test_a_step_ends_at_a_collision():
    # The gripper, which may touch objects, meets the wall first: the arm is pushed on.
    env = make(world_frame_objects={"wall": WALL}, sim={"on_collision": "stop"}, **PUSHED_ON)
    reasons = []
    while len(reasons) < 30 and reasons[-1:] != ["collision"]:
        _, info = move(env, [0, -0.05, 0])
        reasons.append(info["reason"])
    assert reasons[-1] == "collision"
    assert info["collisions"][0]["robot"] == "robot"
    assert info["collisions"][0]["other_body"] == "wall"


def test_collisions_are_reported_or_looked_at_ahead():
    env = make(world_frame_objects={"wall": WALL}, sim={"on_collision": "report"}, **PUSHED_ON)
    reasons = [move(env, [0, -0.05, 0])[1]["reason"] for _ in range(12)]
    assert "collision" not in reasons
    assert env.step({"robot": {"tquat": [0, -0.05, 0, 0, 0, 0, 1], "gripper": 1}})[4]["collisions"]

    env = make(world_frame_objects={"wall": WALL}, sim={"on_collision": "guard"}, **PUSHED_ON)
    arm = env.scene.robot("robot")
    _, info = move(env, [0, 0, 0])
    while info["reason"] != "collision":
        sent = np.array(arm.jnt_pos_cmd)
        _, info = move(env, [0, -0.05, 0])
        assert info["time"] < 60
    hit = info["collisions"][0]
    assert hit["other_body"] == "wall"
    assert np.array_equal(arm.jnt_pos_cmd, sent), "it was not carried out"
    touching = [{contact.body1, contact.body2} for contact in env.scene.contacts()]
    assert {hit["body"], "wall"} not in touching, "of the arm, grippers may touch objects"
    away = [move(env, [0, 0.05, 0])[1]["reason"] for _ in range(6)]
    assert "collision" not in away
    assert away[-1] == "arrived"


def test_an_unreachable_pose_is_reported_and_the_next_action_works():
    env = make(relative_to="none")
    begin = env.reset(seed=1)[0]["robot"]["tquat"]
    _, upper = env.action_range
    corner = upper["robot"]["tquat"][:3]
    for _ in range(2):
        seen, info = move(env, corner)
        assert info["reason"] == "ik_failed"
        assert not info["robots"]["robot"]["ik_success"]
        assert np.allclose(seen["tquat"][:3], begin[:3], atol=5e-3), "it stays"
    _, info = move(env, np.add(begin[:3], [0, 0, 0.02]), begin[3:])
    assert info["reason"] == "arrived"
    assert info["robots"]["robot"]["ik_success"]


def test_infos_contain_the_remaining_errors_and_speeds():
    env = make()
    _, info = move(env, [0, 0, 0.02])
    left = info["robots"]["robot"]
    assert info["reason"] == "arrived"
    assert left["joint_error"] <= 0.002
    assert left["joint_speed"] <= 0.02
    assert left["position_error"] < 2e-3
    assert left["linear_speed"] < 0.02
    assert left["position_shortfall"] == left["rotation_shortfall"] == 0
    _, info = move(make(sim={"max_convergence_time": 0.01}), [0, 0, 0.05])
    assert info["robots"]["robot"]["position_error"] == pytest.approx(0.05, abs=0.01)


def test_a_blocked_arm_retreats_at_once():
    env = make(world_frame_objects={"wall": WALL}, sim={"on_collision": "report"})
    for _ in range(30):
        seen, info = move(env, [0, -0.03, 0])
    assert info["robots"]["robot"]["position_error"] < 0.06, "one action and the lead"
    assert info["robots"]["robot"]["position_taken_back"] == pytest.approx(0.03, abs=2e-3)
    blocked = seen["tquat"][1]
    for _ in range(2):
        seen, _ = move(env, [0, 0.03, 0])
    assert seen["tquat"][1] > blocked + 5e-3
    with pytest.raises(rc.SpecError, match="max_target_lead"):
        make(max_target_lead=(0.02,))


def test_the_slowest_ramp_arrives():
    env = make()
    begin = env.reset(seed=1)[0]["robot"]["tquat"]
    for _ in range(150):
        seen, _ = move(env, [0, 0, 2e-4])
    assert seen["tquat"][2] - begin[2] == pytest.approx(0.03, abs=3e-3)


def test_a_configured_origin_stays_until_it_is_set_again():
    env = make(relative_to="configured_origin")
    begin = env.reset(seed=1)[0]["robot"]["tquat"]
    heights = [move(env, [0, 0, 0.03])[0]["tquat"][2] - begin[2] for _ in range(2)]
    env.set_origin_to_current("robot")
    heights.append(move(env, [0, 0, 0.03])[0]["tquat"][2] - begin[2])
    assert np.allclose(heights, [0.03, 0.03, 0.06], atol=5e-3)
    with pytest.raises(rc.NotFoundError, match=r"no robot 'robto'\. Its robots: robot\. Did"):
        env.set_origin_to_current("robto")


def sent_pose(env: rc.Env, name: str = "robot") -> rc.Pose:
    """Where the arm was sent, in the shared frame, by its forward kinematics."""
    robot = env.scene.robot(name)
    world = robot.base_in_world * robot.kinematics.fk(robot.jnt_pos_cmd)
    return env.scene.shared_base_frame_to_world.inverse() * world


def test_configured_origin_steps_are_limited_from_the_last_target():
    env = make(relative_to="configured_origin", max_relative_movement=(0.02, 0.1))
    origin = sent_pose(env)
    ways = np.array([[0.05, 0, 0], [0, 0.03, -0.04]])
    for way in ways:
        env.reset(seed=1)
        gone = []
        for _ in range(4):
            assert move(env, way)[1]["robots"]["robot"]["ik_success"]
            gone.append(sent_pose(env).translation - origin.translation)
        expected = np.outer([0.02, 0.04, 0.05, 0.05], way / 0.05)
        assert np.allclose(gone, expected, atol=1e-4)
    env.reset(seed=1)
    turn = rc.Pose(rpy=[0, 0, 0.25])
    turned = []
    for _ in range(4):
        move(env, [0, 0, 0], turn.quaternion)
        change = sent_pose(env).rotation @ origin.rotation.T
        turned.append(np.arctan2(change[1, 0], change[0, 0]))
        assert np.allclose(change[2], [0, 0, 1], atol=1e-4), "about the z of the shared frame"
    assert np.allclose(turned, [0.1, 0.2, 0.25, 0.25], atol=1e-4)


def test_configured_origin_joints_are_limited_from_their_last_target():
    env = make(control_mode="joints", relative_to="configured_origin", max_relative_movement=0.1)
    begin = np.array(env.scene.robot("robot").jnt_pos_cmd)
    way = np.array([0.25, -0.25, 0.05, 0, 0, 0, -0.15])
    for most in (0.1, 0.2, 0.25, 0.25):
        env.step({"robot": {"joints": way, "gripper": 1}})
        command = np.array(env.scene.robot("robot").jnt_pos_cmd)
        assert np.allclose(command - begin, np.clip(way, -most, most), atol=1e-12)


@pytest.mark.parametrize("mode", ["cartesian_tquat", "cartesian_trpy"])
def test_about_a_configured_origin_arms_turn_about_the_tcp_with_the_axes_of_the_shared_frame(mode):
    env = make(
        robots={"left": RC7, "right": RC7},
        control_mode=mode,
        relative_to="configured_origin",
        root_frame_to_world=rc.Pose(translation=[1, -2, 0.5], rpy=[0.2, -0.1, 2]),
        shared_base_frame_to_root_frame=rc.Pose(translation=[0, 0, 0.34], rpy=[0, 0.1, 0.3]),
        robot_to_shared_base_frame={
            "left": rc.Pose(translation=[0.02, 0.25, 0], rpy=[-0.4, 0.1, 0.2]),
            "right": rc.Pose(translation=[0, -0.25, 0.01], rpy=[0.5, 0, -0.3]),
        },
    )
    names = ("left", "right")
    origins = {name: sent_pose(env, name) for name in names}
    # One after the other, none on top of the last: each is from the origin.
    for way, rpy in (
        ([0, 0, 0], [0.1, -0.2, 0.3]),
        ([0.02, -0.03, 0.01], [-0.2, 0.1, 0.2]),
        ([0, 0, 0], [0, 0, 0]),
    ):
        turn = rc.Pose(rpy=rpy)
        own = {
            "cartesian_tquat": {"tquat": [*way, *turn.quaternion], "gripper": 1},
            "cartesian_trpy": {"xyzrpy": [*way, *rpy], "gripper": 1},
        }[mode]
        *_, info = env.step(dict.fromkeys(names, own))
        for name in names:
            assert info["robots"][name]["ik_success"]
            sent = sent_pose(env, name)
            assert np.allclose(sent.translation, origins[name].translation + way, atol=1e-4)
            assert np.allclose(sent.rotation, turn.rotation @ origins[name].rotation, atol=1e-4)


def test_joint_steps_are_limited_from_the_last_target_and_by_the_robot():
    env = make(
        control_mode="joints",
        relative_to="none",
        max_relative_movement=0.1,
        max_target_lead=10,  # something may be in the way
    )
    begin = env.reset(seed=1)[0]["robot"]["joints"]
    for step in range(1, 4):
        env.step({"robot": {"joints": begin + 1, "gripper": 1}})
        command = np.array(env.scene.robot("robot").jnt_pos_cmd)
        assert np.allclose(command, begin + 0.1 * step, atol=1e-9)
    lower, upper = (ends["robot"]["joints"] for ends in env.action_range)
    for _ in range(120):
        env.step({"robot": {"joints": upper + 1, "gripper": 1}})
        command = np.array(env.scene.robot("robot").jnt_pos_cmd)
        assert np.all((lower <= command) & (command <= upper))
    assert np.allclose(command, upper)


def test_a_diverged_simulation_truncates_and_requires_a_reset():
    env = make()
    last = env.reset(seed=1)[0]["robot"]["joints"]
    env.scene.data.qvel[0] = 1e12
    action = {"robot": {"tquat": [0, 0, 0.01, 0, 0, 0, 1], "gripper": 1}}
    seen, _, terminated, truncated, info = env.step(action)
    assert (terminated, truncated, info["reason"]) == (False, True, "diverged")
    assert "diverged at t=" in info["message"]
    assert np.array_equal(seen["robot"]["joints"], last), "what was before it"
    with pytest.raises(rc.Error, match="has diverged; call reset to go on"):
        env.step(action)
    env.reset(seed=1)
    assert env.step(action)[4]["reason"] == "arrived"


@pytest.mark.parametrize(
    "sim", [{"async_control": True, "frequency": 20}, {}], ids=["rate", "goal"]
)
def test_paced_steps_take_their_simulated_time(sim):
    env = make(sim={"realtime": True} | sim)
    begin = time.perf_counter()
    env.reset(seed=1)
    before = time.perf_counter()
    late, simulated = [], 0.0
    for _ in range(5):
        _, info = move(env, [0, 0, 0.01])
        now = time.perf_counter()
        assert now - begin >= info["time"]
        assert info["time"] - simulated > 0.04
        late.append((now - before) - (info["time"] - simulated))
        before, simulated = now, info["time"]
    assert min(late) < 0.02, "a busy machine is late at times, and not with every step"


def test_the_time_of_a_policy_passes_before_a_paced_step_not_in_it():
    env = make(sim={"realtime": True, "async_control": True, "frequency": 20})
    env.reset(seed=1)
    move(env, [0, 0, 0.01])
    took = []
    for _ in range(3):  # a busy machine is late at times
        time.sleep(0.3)
        began = time.perf_counter()
        move(env, [0, 0, 0.01])
        took.append(time.perf_counter() - began)
    assert min(took) < 0.05, "not the 0.3 s and its own time, and less than it simulates"


def test_a_step_is_limited_from_the_last_target():
    env = make(relative_to="none", max_relative_movement=(0.01, 0.1))
    begin = env.reset(seed=1)[0]["robot"]["tquat"]
    above, turn = begin[:3] + np.array([0, 0, 0.06]), begin[3:]
    heights = [move(env, above, turn)[0]["tquat"][2] - begin[2] for _ in range(8)]
    assert np.allclose(heights, [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.06, 0.06], atol=0.006)


def test_a_gripper_action_is_binary_or_continuous():
    env = make()
    told = [move(env, [0, 0, 0], gripper=g)[0]["gripper"][0] for g in (0.49, 0.5, 0, 1)]
    assert told == [0, 1, 0, 1]
    env = make(wrappers={"binary_gripper": False})
    assert move(env, [0, 0, 0], gripper=0.4)[0]["gripper"][0] == pytest.approx(0.4, abs=0.05)


def test_a_reset_moves_arms_home_or_keeps_them():
    for home in (True, False):
        env = make(wrappers={"home_on_reset": home})
        start = env.reset(seed=1)[0]["robot"]["joints"]
        left, _ = move(env, [0, 0, 0.05])
        after = env.reset(seed=1)[0]["robot"]["joints"]
        assert np.allclose(after, start if home else left["joints"], atol=1e-9)


def test_an_action_has_one_form():
    env = make(control_mode="joints")
    arm = env.row()["robots/robot/arm/qpos"]
    both = {"robots/robot/action/arm": arm, "robot": {"joints": arm, "gripper": 1}}
    with pytest.raises(rc.ArgumentError, match="'robots/robot/action/arm' and 'robot' are of two"):
        env.step(both)
    env.step({"robots/robot/action/arm": arm})
