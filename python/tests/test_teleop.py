"""Teleoperation: the arm follows within its limits, episodes are ordinary, devices fail safely."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import robocell as rc
from command_line import RC7, write_run
from robocell._cli import load
from robocell._cli.robot_scene import load_robot
from robocell._teleop.device import COMMANDS
from robocell._teleop.follower import ArmFollower
from robocell._teleop.recorded import RecordedDevice
from robocell._teleop.web_device import WebDevice, checked_command, checked_input
from robocell.teleop import (
    Device,
    DeviceLostError,
    FollowOptions,
    Motion,
    OperatorOptions,
    make_device,
    record,
)

FAST = OperatorOptions(countdown_s=0, asks=False, real_time=False)


class Says(Device):
    """Says what it was given, then ends the episode."""

    def __init__(self, motions: Sequence[Motion | None], end: str = "success") -> None:
        self.motions, self.end, self.closed = list(motions), end, False
        self.recording = False

    def read(self, seconds: float) -> Motion | None:
        if not self.recording:
            self.recording = True
            return Motion(commands=("record",))
        if self.motions:
            return self.motions.pop(0)
        self.recording = False
        return Motion(clutch=False, commands=(self.end,))

    def close(self) -> None:
        self.closed = True


def arm(tmp_path: Path | None = None) -> rc.Robot:
    return load_robot(RC7).robot


def moved_by(robot: rc.Robot, follower: ArmFollower) -> rc.Pose:
    """The commanded TCP in the base frame."""
    return robot.fk_frame(follower.command)


@pytest.mark.parametrize("frame", ["base", "tool", "world", "camera:exo_camera"])
def test_the_tcp_moves_along_the_axes_of_the_frame(frame: str):
    robot = arm()
    scene = robot.scene
    follower = ArmFollower(robot, FollowOptions(frame=frame, scale=2.0))
    before = moved_by(robot, follower)
    follower.follow(Motion(translation=(0.004, 0.001, -0.002)), 0.1)
    after = moved_by(robot, follower)
    base = robot.base_in_world.rotation
    in_world = {
        "base": base,
        "tool": base @ before.rotation,
        "world": np.eye(3),
    }
    if frame in in_world:
        axes = in_world[frame]
    else:  # x where the camera looks, y left, z up in its image
        camera = scene.camera_pose("exo_camera").rotation
        axes = np.stack([-camera[:, 2], -camera[:, 0], camera[:, 1]], axis=1)
    expected = base.T @ axes @ np.array([0.008, 0.002, -0.004])
    np.testing.assert_allclose(after.translation - before.translation, expected, atol=2e-5)
    turned = before.rotation.T @ after.rotation
    assert np.arccos(np.clip((np.trace(turned) - 1) / 2, -1, 1)) < 1e-3


@pytest.mark.parametrize("lead", [0.15, 10.0])
def test_speeds_limits_and_lead_hold_for_any_motion(lead: float):
    rng = np.random.default_rng(1)
    robot = arm()
    options = FollowOptions(max_speed=0.3, max_lead=lead, stops_at_collisions=False)
    for _ in range(20):
        lower, upper = np.asarray(robot.joint_limits).T
        robot.set_joint_pos(rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3)))
        follower = ArmFollower(robot, options)
        for _ in range(10):
            before, q = moved_by(robot, follower), follower.command
            numbers = rng.normal(scale=10.0, size=6)
            follower.follow(Motion(tuple(numbers[:3]), tuple(numbers[3:])), 0.05)
            after = moved_by(robot, follower)
            distance = np.linalg.norm(after.translation - before.translation)
            assert lead < 1 or distance < 0.3 * 0.05 * 1.02
            assert np.all(np.abs(follower.command - q) <= 1.5 * 0.05 + 1e-9)
            assert np.all(follower.command >= lower - 1e-9)
            assert np.all(follower.command <= upper + 1e-9)
            measured = np.asarray(robot.arm.joint_pos)
            assert np.all(np.abs(follower.command - measured) <= lead + 1e-9)


def arm_on_floor(plates: int = 0) -> rc.Robot:
    """With thin plates that stand around the arm."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(str(RC7))
    spec.robots.append(rc.RobotSpec(name="arm", config=config, control_modes=config.used_modes()))
    for i in range(plates):
        angle = 2 * np.pi * (i + 0.5) / plates
        plate = {"name": f"plate{i}", "shape": "box", "size": [0.1, 0.002, 0.4], "fixed": True}
        plate |= {"rgba": [1] * 4, "mass": 1, "friction": [1, 0.005, 0.0001]}
        plate["pos"] = [0.55 * np.cos(angle), 0.55 * np.sin(angle), 0.5]
        plate["quat"] = [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]
        spec.objects.append(rc.SceneObject(**plate))
    return rc.Scene.build(spec).robot("arm")


def test_the_arm_stops_before_what_stands_still_and_may_leave_it():
    robot = arm_on_floor()
    follower = ArmFollower(robot, FollowOptions(max_lead=10))
    free = rc.kinematics.CollisionFilter(robot)
    down, blocked = Motion(translation=(0, 0, -0.01)), False
    for _ in range(200):
        follower.follow(down, 0.1)
        blocked = blocked or follower.blocked == "collision"
        assert free(follower.command[None])[0]
    assert blocked
    stuck = moved_by(robot, follower)
    follower.follow(Motion(translation=(0, 0, 0.01)), 0.1)
    assert moved_by(robot, follower).translation[2] > stuck.translation[2] + 0.009
    robot.set_joint_pos(follower.command)
    pressing = ArmFollower(robot, FollowOptions(stops_at_collisions=False, max_lead=10))
    for _ in range(20):
        pressing.follow(down, 0.1)
    assert not free(pressing.command[None])[0], "the test would not see a collision otherwise"


def simulate(robot: rc.Robot, follower: ArmFollower, motion: Motion, actions: int) -> set[str]:
    """Follows under physics; returns why the motions were cut short."""
    reasons = set()
    for _ in range(actions):
        robot.apply(follower.follow(motion, 0.066))
        reasons.add(follower.blocked)
        for _ in range(33):
            robot.update()
            robot.scene.step()
    return reasons


def lowest_contact(robot: rc.Robot) -> float:
    """The deepest contact with the floor, m; 0 without one."""
    data = robot.scene.data
    return min([float(each.dist) for each in data.contact[: data.ncon]], default=0.0)


def test_physics_keeps_a_blocked_arm_off_the_floor_with_the_usual_lead():
    robot = arm_on_floor()
    follower = ArmFollower(robot, FollowOptions())
    free = rc.kinematics.CollisionFilter(robot)
    for direction in (0.0, 0.006):  # straight down, and then along the floor
        motion = Motion(translation=(direction, direction, -0.015))
        assert "collision" in simulate(robot, follower, motion, 45)
        assert free(follower.command[None])[0]
        assert lowest_contact(robot) > -0.001
    before = robot.fk_frame().translation[2]
    simulate(robot, follower, Motion(translation=(0, 0, 0.015)), 5)
    assert robot.fk_frame().translation[2] > before + 0.03


def test_an_arm_that_touches_goes_no_deeper():
    """It begins in the floor: down is not made, along and up are."""
    robot = arm_on_floor()
    pressing = ArmFollower(robot, FollowOptions(stops_at_collisions=False, max_lead=10))
    free, down = rc.kinematics.CollisionFilter(robot), Motion(translation=(0, 0, -0.01))
    for _ in range(200):
        pressing.follow(down, 0.1)
        if not free(pressing.command[None])[0]:
            break
    robot.set_joint_pos(pressing.command)
    start = robot.fk_frame().translation
    follower = ArmFollower(robot, FollowOptions())
    for _ in range(10):
        follower.follow(down, 0.066)
        assert follower.blocked == "collision"
    assert moved_by(robot, follower).translation[2] > start[2] - 1e-6
    for motion in (Motion(joints={"joint4": 9.0}), Motion(joints={"joint4": -9.0})):
        ArmFollower(robot, FollowOptions()).follow(motion, 0.066)  # no error on any way
    for _ in range(10):
        follower.follow(Motion(translation=(0, 0, 0.01)), 0.066)
        robot.set_joint_pos(follower.command)
    assert free(follower.command[None])[0]
    assert moved_by(robot, follower).translation[2] > start[2] + 0.05


def test_no_command_touches_wherever_the_arm_is_pushed():
    """With the usual lead the command follows the arm, not through the floor or itself."""
    rng = np.random.default_rng(4)
    robot = arm_on_floor(plates=5)
    free = rc.kinematics.CollisionFilter(robot)
    lower, upper = np.asarray(robot.joint_limits).T
    starts = rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3), (300, len(lower)))
    pushed = np.clip(starts + rng.uniform(-0.4, 0.4, starts.shape), lower, upper)
    led = pushed + np.clip(starts - pushed, -0.15, 0.15)
    both_free = free(starts) & free(pushed)
    touching = both_free & ~free(led)
    assert touching.any(), "the test would not see a collision otherwise"
    for k in [*np.flatnonzero(touching), *np.flatnonzero(both_free)[:10]]:
        robot.set_joint_pos(starts[k])
        follower = ArmFollower(robot, FollowOptions())
        robot.set_joint_pos(pushed[k])
        for _ in range(4):
            follower.follow(Motion(tuple(rng.normal(scale=0.001, size=3))), 0.066)
            assert free(follower.command[None])[0]
            assert np.all(np.abs(follower.command - pushed[k]) <= 0.15 + 1e-9)


def test_a_leader_does_not_jump_over_what_is_between_two_postures():
    rng = np.random.default_rng(5)
    robot = arm_on_floor(plates=5)
    free = rc.kinematics.CollisionFilter(robot)
    lower, upper = np.asarray(robot.joint_limits).T
    fast = {"max_speed": 1e3, "max_angular_speed": 1e3, "max_joint_speed": 1e3, "max_lead": 10.0}
    jumps = 0
    for _ in range(40):
        q, goal = rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3), (2, len(lower)))
        if not free(np.array([q, goal])).all():
            continue
        robot.set_joint_pos(q)
        follower = ArmFollower(robot, FollowOptions(**fast))
        follower.follow(Motion(joints={str(i): float(each) for i, each in enumerate(goal)}), 0.1)
        jumps += not free(np.linspace(q, goal, 200)).all()
        assert free(np.linspace(q, follower.command, 200)).all()
        assert follower.blocked == "collision" or np.allclose(follower.command, goal)
    assert jumps, "the test would not see a collision otherwise"


def test_a_leader_moves_the_tcp_no_faster_than_it_may():
    rng = np.random.default_rng(6)
    robot = arm()
    lower, upper = np.asarray(robot.joint_limits).T
    for _ in range(20):
        robot.set_joint_pos(rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3)))
        options = FollowOptions(max_angular_speed=0.8, max_lead=10, stops_at_collisions=False)
        follower = ArmFollower(robot, options)
        goal = rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3))
        joints = {str(i): float(each) for i, each in enumerate(goal)}
        before, q = moved_by(robot, follower), follower.command
        follower.follow(Motion(joints=joints), 0.066)
        after = moved_by(robot, follower)
        assert np.linalg.norm(after.translation - before.translation) < 0.25 * 0.066 * 1.001
        cosine = (np.trace(before.rotation.T @ after.rotation) - 1) / 2
        assert np.arccos(np.clip(cosine, -1, 1)) < 0.8 * 0.066 * 1.001
        assert np.any(follower.command != q)


def test_a_leader_is_followed_no_faster_than_joints_may_move():
    robot = arm()
    unlimited = {"max_speed": 10.0, "max_angular_speed": 10.0, "max_lead": 10.0}
    follower = ArmFollower(robot, FollowOptions(max_joint_speed=1.0, **unlimited))
    start = follower.command
    follower.follow(Motion(joints={"joint1": 0.5, "1": start[1] - 0.05}, opening=0.25), 0.1)
    np.testing.assert_allclose((follower.command - start)[:3], [0.1, -0.05, 0], atol=1e-9)
    with pytest.raises(rc.NotFoundError, match=r"joint77.*Did you mean 'joint7'"):
        follower.follow(Motion(joints={"joint77": 0.5}), 0.1)


def test_an_open_clutch_and_silence_hold_the_arm():
    robot = arm()
    follower = ArmFollower(robot, FollowOptions())
    start = follower.command
    opened = []
    for clutch in (False, True):
        robot.apply(follower.follow(Motion(opening=0.123, clutch=clutch), 0.1))
        robot.update()
        opened.append(np.array(robot.scene.data.ctrl))
    assert not np.array_equal(*opened), "the clutch holds the gripper, too"
    follower.follow(Motion(translation=(1, 1, 1), clutch=False), 0.1)
    follower.hold()
    np.testing.assert_array_equal(follower.command, start)


@pytest.mark.parametrize(
    "fields",
    [
        {"translation": [1, 2]},
        {"rotation": [float("nan"), 0, 0]},
        {"opening": float("inf")},
        {"commands": ["jump"]},
        {"frame": "moon"},
        {"speed": 1},
        {"joints": {"a": float("nan")}},
        {"translation": 3},
        {"joints": []},
        {"joints": {"a": "b"}},
        {"clutch": "no"},
        {"commands": 3},
    ],
)
def test_motions_with_wrong_parts_are_refused(fields: dict[str, Any]):
    with pytest.raises(rc.ArgumentError):
        Motion.of_json(fields)
    with pytest.raises(rc.ArgumentError, match="map of fields"):
        Motion.of_json(3)  # type: ignore[arg-type]


def test_a_motion_survives_its_file():
    motion = Motion((1, 2, 3), (0, 0, 0.1), 0.5, {"j": 1.0}, False, ("resync",), "tool")
    assert Motion.of_json(json.loads(json.dumps(motion.as_json()))) == motion
    assert Motion().as_json() == {}


def config_of(folder: Path, **changes: Any) -> rc.RunConfig:
    changes.setdefault("cameras", {"streams": []})
    run = rc.RunConfig.load(str(write_run(folder, **changes)))
    run.rates.max_steps = 40
    return run


def test_episodes_are_ordinary_and_a_session_replays_exactly(tmp_path: Path):
    """They verify, replay, and the recorded session makes the same episode again."""
    rng = np.random.default_rng(2)
    motions = [
        None if i % 7 == 3 else Motion(tuple(rng.normal(scale=0.01, size=3)), opening=float(i % 2))
        for i in range(12)
    ]
    device = Says(motions)
    made = record(config_of(tmp_path, episodes_per_scene=1), device, FAST)
    assert [(each.id, each.success, each.rows) for each in made] == [("s0000_e0000", False, 13)]
    assert device.closed
    out = tmp_path / "out"
    assert rc.data.verify(out).ok
    episode = rc.Dataset(out)["s0000_e0000"]
    assert rc.data.verify_replay(episode).first is None
    session = out / "device_sessions" / "s0000_e0000.json"
    again = RecordedDevice(session)
    run = config_of(tmp_path, episodes_per_scene=1, output=str(tmp_path / "again"))
    record(run, again, again.options())
    same = rc.Dataset(tmp_path / "again")["s0000_e0000"]
    for name in episode.columns:
        np.testing.assert_array_equal(episode[name], same[name], err_msg=name)
    assert np.ptp(episode["robots/rc7/action/arm"], axis=0).max() > 0.001


def test_failure_discard_and_quit(tmp_path: Path):
    """A marked failure is kept as one, a discarded episode leaves nothing, quitting ends it."""
    script = [
        *("record", "", "discard"),
        *("record", "", "failure", "discard"),
        *("record", "", "failure", "keep"),
        *("record", "", "quit"),
    ]

    class Presses(Device):
        def read(self, seconds: float) -> Motion:
            name = script.pop(0) if script else "quit"
            return Motion(commands=(name,) if name else ())

    options = OperatorOptions(countdown_s=0, asks=True, real_time=False)
    made = record(config_of(tmp_path), Presses(), options)
    assert [(each.id, each.success) for each in made] == [("s0000_e0000", False)]
    assert made[0].reason == "marked as a failure"
    dataset = rc.Dataset(tmp_path / "out")
    assert dataset.ids == ["s0000_e0000"]
    assert dataset[0].end_reason == "marked as a failure"
    made = record(config_of(tmp_path), Says([Motion()]), FAST)
    assert [each.id for each in made] == ["s0000_e0001"], "the session goes on"


def test_a_session_repeats_its_own_episode_in_full(tmp_path: Path):
    """Not the first one that is missing, and not cut by the run's own number of actions."""
    motions = [Motion((0, 0, 0.001 * i)) for i in range(5)]
    run = config_of(tmp_path, episodes_per_scene=2)
    record(run, Says([*motions, Motion(commands=("failure",)), *motions]), FAST)
    assert run.expert != "teleop", "the run of the caller stays as it was"
    session = tmp_path / "out" / "device_sessions" / "s0000_e0001.json"
    again = RecordedDevice(session)
    short = config_of(tmp_path, episodes_per_scene=2, output=str(tmp_path / "again"))
    short.rates.max_steps = 3
    made = record(short, again, again.options())
    assert [each.id for each in made] == ["s0000_e0001"]
    same, first = (rc.Dataset(tmp_path / name)["s0000_e0001"] for name in ("again", "out"))
    for name in first.columns:
        np.testing.assert_array_equal(first[name], same[name], err_msg=name)
    again = RecordedDevice(session)
    with pytest.raises(rc.ArgumentError, match=r"'s0000_e0001' is in .*another output"):
        record(short, again, again.options())
    other = config_of(tmp_path, episodes_per_scene=1, output=str(tmp_path / "other"))
    with pytest.raises(rc.ArgumentError, match=r"'s0000_e0001', which .* it has s0000_e0000\."):
        record(other, again, again.options())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"motions": [3]}, r"motions\[0\].*3 is no Motion"),
        ({"motions": [None, {"joints": []}]}, r"motions\[1\].*joints"),
        ({"follow": {"speed": 3}}, "follow.*speed"),
        ({"follow": {"scale": "x"}}, "follow.*scale is 'x', not a float"),
        ({"robot": None}, "robot.* is None, not a str"),
        ({"ends_at_success": 1}, "ends_at_success"),
        ({"max_steps": True}, "max_steps"),
        ({"episode": 3}, "episode"),
    ],
)
def test_a_session_with_wrong_fields_names_them(
    change: dict[str, Any], message: str, tmp_path: Path
):
    content = {"format": 1, "episode": "s0000_e0000", "robot": "", "follow": {}, "motions": [{}]}
    content |= {"ends_at_success": True}
    file = tmp_path / "session.json"
    file.write_text(json.dumps(content))
    RecordedDevice(file)
    file.write_text(json.dumps(content | change))
    with pytest.raises(rc.ArgumentError, match=rf"session\.json.*{message}"):
        RecordedDevice(file)


def test_quit_keeps_an_episode_that_has_ended(tmp_path: Path):
    script = ["record", "", "failure", "quit"]

    class Presses(Device):
        def read(self, seconds: float) -> Motion:
            name = script.pop(0) if script else ""
            return Motion(commands=(name,) if name else ())

    options = OperatorOptions(countdown_s=0, asks=True, real_time=False)
    made = record(config_of(tmp_path), Presses(), options)
    assert [each.id for each in made] == ["s0000_e0000"]


@pytest.mark.parametrize("method", ["start", "begin", "reset_origin", "read"])
def test_a_device_with_a_fault_ends_the_session_without_an_episode(method: str, tmp_path: Path):
    class Faulty(Says):
        def reset_origin(self) -> None:
            pass

    def fault(*_: float) -> int:
        if method == "read":
            return 3
        raise ZeroDivisionError("no scale")

    device = Faulty([Motion(commands=("reset_origin",)), Motion()])
    setattr(device, method, fault)
    with pytest.raises(DeviceLostError, match=rf"Faulty\.{method}\(\).*(no scale|3, not a Motion)"):
        record(config_of(tmp_path), device, FAST)
    assert device.closed
    assert method != "start" or not (tmp_path / "out").exists(), "no folder without a device"


@pytest.mark.parametrize("error", [DeviceLostError("unplugged"), KeyError("left")])
def test_a_lost_device_ends_the_session_without_an_episode(error: Exception, tmp_path: Path):
    class Breaks(Says):
        def read(self, seconds: float) -> Motion | None:
            if len(self.motions) == 1:
                raise error
            return super().read(seconds)

    device = Breaks([Motion(), Motion(), Motion()])
    with pytest.raises(DeviceLostError, match=r"unplugged|left"):
        record(config_of(tmp_path), device, FAST)
    assert device.closed
    assert rc.Dataset(tmp_path / "out").ids == []


@pytest.mark.parametrize(
    ("options", "motion", "message"),
    [
        (OperatorOptions(robot="left"), Motion(), "left"),
        (OperatorOptions(follow=FollowOptions(frame="camera:top")), Motion(), "wrist_camera"),
        (OperatorOptions(), Motion(joints={"elbow": 1.0}), "elbow"),
    ],
)
def test_wrong_names_end_a_session_without_an_episode(
    options: OperatorOptions, motion: Motion, message: str, tmp_path: Path
):
    fast = replace(options, countdown_s=0, asks=False, real_time=False)
    with pytest.raises(rc.NotFoundError, match=message):
        record(config_of(tmp_path), Says([motion] * 3), fast)
    assert rc.Dataset(tmp_path / "out").ids == []


class Picks(Device):
    """Picks the target as a person would who sees the scene: a screen, too."""

    def __init__(self) -> None:
        self.scene: rc.Scene | None = None
        self.status: Mapping[str, Any] = {}
        self.closed_for = 0

    def show(self, scene: rc.Scene, status: Mapping[str, Any], row: Mapping[str, Any]) -> None:
        self.scene, self.status = scene, status

    def read(self, seconds: float) -> Motion | None:
        if self.scene is None or self.status["phase"] == "waiting":
            self.closed_for = 0
            return Motion(commands=("record",))
        robot = self.scene.robots[0]
        tcp = robot.tcp_in_world
        target = next(n for n in self.scene.object_names if not n.startswith("table"))
        away = self.scene.body_pose(target).translation - tcp.translation
        if self.closed_for > 4:
            return Motion(translation=(0, 0, 0.02), opening=0, frame="world")
        if np.linalg.norm(away) < 0.012 or self.closed_for:
            self.closed_for += 1
            return Motion(opening=0, frame="world")
        if np.linalg.norm(away[:2]) > 0.01:
            away[2] = max(away[2] + 0.12, -0.02)
        return Motion(translation=tuple(away), opening=1, frame="world")


def test_a_pick_through_a_device_succeeds(tmp_path: Path):
    device = Picks()
    run = config_of(tmp_path, episodes_per_scene=1)
    run.rates.max_steps = 300
    run.rates.policy_ms = 66
    made = record(run, device, FAST, screen=device)
    assert [each.success for each in made] == [True], made


def test_one_page_drives_and_silence_stops_it(monkeypatch: pytest.MonkeyPatch):
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    device = WebDevice()
    go = checked_input({"op": "input", "linear": [1, 0, 0], "drag": [0, 0.01, 0], "clutch": True})
    device.apply(1, {"op": "input", **go})
    device.apply(2, {"op": "input", **go, "linear": np.array([-1.0, 0, 0])})
    motion = device.read(0.1)
    assert motion is not None
    np.testing.assert_allclose(motion.translation, [0.02, 0.01, 0])
    assert device.driver == 1
    now[0] += 1
    assert device.read(0.1) is None
    device.apply(2, {"op": "input", **go})
    assert device.driver == 2
    device.apply(2, {"op": "gone"})
    assert device.read(0.1) is None
    device.apply(1, {"op": "command", **checked_command({"op": "command", "name": "quit"})})
    motion = device.read(0.1)
    assert motion is not None
    assert motion.commands == ("quit",)
    assert not motion.clutch


def web_input(**fields: Any) -> dict[str, Any]:
    return {"op": "input", **checked_input({"op": "input", "clutch": True, **fields})}


def test_a_key_that_is_let_go_before_the_read_counts(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(time, "monotonic", lambda: 100.0)
    device = WebDevice()
    device.apply(1, web_input(linear=[1, 0, 0]))
    device.apply(1, web_input())
    motions = [device.read(0.1) for _ in range(2)]
    for motion, expected in zip(motions, (0.01, 0.0), strict=True):
        assert motion is not None
        np.testing.assert_allclose(motion.translation, [expected, 0, 0], atol=1e-12)
    device.apply(1, web_input(linear=[1, 0, 0]))
    device.apply(1, web_input(linear=[1, 0, 0], clutch=False))
    device.apply(1, web_input())
    assert device.read(0.1) is not None


def test_a_page_drives_the_gripper_only_by_what_it_changes(monkeypatch: pytest.MonkeyPatch):
    """What an idle page remembers opens no gripper when it begins to drive."""
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    device = WebDevice()

    def said(page: int, **fields: Any) -> float | None:
        device.apply(page, web_input(**fields))
        motion = device.read(0.1)
        assert motion is not None
        return motion.opening if motion.clutch else None

    assert said(1, opening=None) is None
    assert said(1, opening=0) == 0
    device.apply(2, web_input(opening=1))  # watches
    assert said(1, opening=0) == 0
    now[0] += 1
    assert said(2, opening=1) is None, "page 2 takes over with an old opening"
    assert said(2, opening=0) == 0
    now[0] += 1
    assert said(2, opening=1) == 1, "changed while the network was slow"
    said(2, opening=0, clutch=False)
    assert said(2, opening=0) is None


def test_names_of_devices_are_explained(tmp_path: Path):
    with pytest.raises(rc.ArgumentError, match="Did you mean 'gamepad'"):
        make_device("gamepd")
    with pytest.raises(rc.IoError):
        make_device(f"replay:{tmp_path}/none.json")
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(rc.ArgumentError, match="no session"):
        make_device(f"replay:{tmp_path}/bad.json")
    assert set(COMMANDS) >= {"record", "success", "failure", "resync", "reset_origin"}


def test_the_operator_waits_in_real_time(tmp_path: Path):
    run = config_of(tmp_path, episodes_per_scene=1)
    run.rates.policy_ms = 40
    began = time.monotonic()
    options = OperatorOptions(countdown_s=0.05, asks=False)
    record(run, Says([Motion()] * 10), options)  # some of them during the countdown
    assert time.monotonic() - began > 0.05 + 5 * 0.04


@pytest.mark.parametrize("option", ["--max-seconds", "--countdown"])
@pytest.mark.parametrize("value", ["nan", "inf", "1e300"])
def test_a_time_without_an_end_is_refused(option: str, value: str, tmp_path: Path):
    run = str(write_run(tmp_path, cameras={"streams": []}))
    words = ["teleop", run, option, value]
    result = CliRunner().invoke(load(words), words)
    assert result.exit_code == 2
    assert option in result.output
