"""Teleoperation of cells, of several arms, and of real arms."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import init_models
import robocell as rc
from command_line import RC7, REPOSITORY, write_run
from robocell import hardware
from robocell._cli import load
from robocell._teleop.arms import DrivenArms, arm_named, arms_of
from robocell._teleop.devices import by_arm
from robocell._teleop.recorded import RecordedDevice
from robocell.gym import pick_cube_config
from robocell.teleop import (
    ArmStoppedError,
    Device,
    DeviceForEach,
    DeviceLostError,
    FollowOptions,
    Motion,
    OperatorOptions,
    RealArms,
    cell_of,
    record,
    record_cell,
)

FAST = OperatorOptions(countdown_s=0, asks=False, real_time=False)
UP, AWAY = Motion(translation=(0, 0, 0.004)), Motion(translation=(0.004, 0, 0))
SAFETY = hardware.SafetyOptions(slow_start=0, watchdog=5)


class Says(Device):
    """Says what it was given, then ends the episode."""

    def __init__(self, motions: Sequence[Motion | None], end: str = "success") -> None:
        self.motions, self.end, self.is_recording = list(motions), end, False

    def read(self, seconds: float) -> Motion | None:
        if not self.is_recording:
            self.is_recording = True
            return Motion(commands=("record",))
        if self.motions:
            return self.motions.pop(0)
        self.is_recording = False
        return Motion(clutch=False, commands=(self.end,))


def two_arms() -> rc.EnvConfig:
    pose = {name: rc.Pose(translation=[0, y, 0]) for name, y in (("left", 0.4), ("right", -0.4))}
    config = rc.EnvConfig(
        robots={"left": RC7, "right": RC7}, robot_to_shared_base_frame=pose, add_floor=True
    )
    config.sim.frequency = 15
    return config


def moved(episode: rc.data.Episode, robot: str) -> Any:
    """How far the commanded TCP has moved, m."""
    way = episode[f"robots/{robot}/action/tcp_pose"][:, :3]
    return way[-1] - way[0]


def duo() -> rc.Scene:
    spec = rc.SceneSpec(name="duo", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(REPOSITORY / "examples" / "duo" / "duo.yaml")
    spec.robots.append(rc.RobotSpec(name="duo", config=config))
    return rc.Scene.build(spec)


def test_a_device_moves_the_arm_that_is_chosen_and_the_others_hold():
    scene = duo()
    arms = DrivenArms(arms_of(scene), "", FollowOptions())
    assert arms.names == ["duo/left", "duo/right"]

    def tcps() -> Any:
        q = arms.columns()
        return {
            side: robot.fk_frame(q.get(f"robots/duo/action/{side}", robot.arm.joint_pos))
            for side, robot in ((each, scene.robot(f"duo/{each}")) for each in ("left", "right"))
        }

    before = tcps()
    arms.follow(Motion(translation=(0, 0, 0.005), opening=0.0), 0.1)
    assert tcps()["left"].translation[2] > before["left"].translation[2] + 0.004
    arms.choose_next()
    middle = tcps()
    arms.follow(Motion(translation=(0, 0, 0.005), opening=0.0), 0.1)
    after = tcps()
    np.testing.assert_array_equal(after["left"].translation, middle["left"].translation)
    assert after["right"].translation[2] > before["right"].translation[2] + 0.004
    openings = arms.columns()
    assert openings["robots/duo/action/left_hand"] == [0]
    assert openings["robots/duo/action/right_hand"][0] > 0.9, (
        "the opening that was said to the other arm is not repeated"
    )
    arms.follow(Motion(opening=0.5), 0.1)
    assert arms.columns()["robots/duo/action/right_hand"] == [0.5]
    assert set(arms.commands()["duo"]) == {"left", "right", "left_hand", "right_hand"}
    arms.choose_next()
    assert arms.name == "duo/left"


@pytest.mark.parametrize(("name", "chosen"), [("right", 1), ("duo/right", 1), ("duo", 0), ("", 0)])
def test_arms_have_the_names_of_environments(name: str, chosen: int):
    assert DrivenArms(arms_of(duo()), name, FollowOptions()).chosen == chosen


def test_the_name_of_an_arm_or_a_robot_goes_before_that_of_a_group():
    spec = rc.SceneSpec(name="rows", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(REPOSITORY / "examples" / "duo" / "duo.yaml")
    for i, name in enumerate(("back", "right")):
        robot = rc.RobotSpec(name=name, prefix=f"{name}_", config=config, pos=[0, 2.0 * i, 0])
        spec.robots.append(robot)
    arms = arms_of(rc.Scene.build(spec))
    assert [arm.name for arm in arms] == ["back/left", "back/right", "right/left", "right/right"]
    assert arm_named(arms, "right") == 2
    assert arm_named(arms, "back/right") == 1
    with pytest.raises(rc.NotFoundError, match=r"several arms are called 'left': back/left, right"):
        arm_named(arms, "left")


def test_an_unknown_arm_shows_those_that_there_are():
    with pytest.raises(rc.NotFoundError, match=r"rigt.*Did you mean.*The scene has: duo/left"):
        DrivenArms(arms_of(duo()), "duo/rigt", FollowOptions())


def test_both_arms_of_a_cell_are_recorded_and_the_session_replays_exactly(tmp_path: Path):
    next_arm = Motion(commands=("next_arm",))
    device = Says([UP, UP, UP, next_arm, Motion((0, 0, 0.004), opening=0.2), UP, None, UP])
    made = record_cell(two_arms(), tmp_path / "out", device, FAST)
    assert [(each.success, each.rows) for each in made] == [(True, 9)]
    assert rc.data.verify(tmp_path / "out").ok
    [episode] = rc.Dataset(tmp_path / "out")
    assert rc.data.verify_replay(episode).first is None
    assert moved(episode, "left")[2] > 0.007
    assert moved(episode, "right")[2] > 0.011
    assert episode["robots/right/action/gripper"][-1] == pytest.approx(0.2)
    assert episode["robots/left/action/gripper"][-1] > 0.9
    session = tmp_path / "out" / "device_sessions" / f"{episode.id}.json"
    again = RecordedDevice(session)
    record_cell(two_arms(), tmp_path / "again", again, again.options())
    [same] = rc.Dataset(tmp_path / "again")
    for name in episode.columns:
        np.testing.assert_array_equal(episode[name], same[name], err_msg=name)


def test_a_device_for_each_arm_moves_both_at_once(tmp_path: Path):
    """A silent device holds its own arm alone."""
    script = {"left": Says([UP, UP, None, None]), "right": Says([AWAY, AWAY, AWAY, AWAY])}
    record_cell(two_arms(), tmp_path / "out", DeviceForEach(script), FAST)
    [episode] = rc.Dataset(tmp_path / "out")
    assert moved(episode, "left")[2] == pytest.approx(0.004, abs=1e-3)  # after the first row
    assert moved(episode, "right")[0] == pytest.approx(0.012, abs=1e-3)
    motions = json.loads((tmp_path / f"out/device_sessions/{episode.id}.json").read_text())
    assert [sorted(each["arms"]) for each in motions["motions"][:4]] == [
        ["left", "right"],
        ["left", "right"],
        ["right"],
        ["right"],
    ]


def test_a_device_of_an_unknown_arm_is_an_error_before_anything_moves(tmp_path: Path):
    devices = {"lft": Says([UP]), "right": Says([UP])}
    with pytest.raises(rc.NotFoundError, match=r"no arm 'lft'.*mean 'left'"):
        record_cell(two_arms(), tmp_path / "out", DeviceForEach(devices), FAST)
    assert not any(device.is_recording for device in devices.values())


def test_motions_of_several_arms_survive_their_file():
    motion = Motion(commands=("success",), arms={"left": UP, "duo/right": Motion(opening=0.5)})
    assert Motion.of_json(json.loads(json.dumps(motion.as_json()))) == motion
    for wrong in ({"arms": 3}, {"arms": {"left": {"arms": {"a": {}}}}}, {"arms": {"left": 3}}):
        with pytest.raises(rc.ArgumentError):
            Motion.of_json(wrong)


def test_one_of_several_devices_that_is_lost_ends_the_session(tmp_path: Path):
    class Unplugged(Says):
        def read(self, seconds: float) -> Motion | None:
            if len(self.motions) < 2:
                raise DeviceLostError("unplugged")
            return super().read(seconds)

    closed = []
    devices = {"left": Says([UP] * 9), "right": Unplugged([UP] * 3)}
    for name, device in devices.items():
        device.close = lambda name=name: closed.append(name)  # type: ignore[method-assign]
    with pytest.raises(DeviceLostError, match="unplugged"):
        record_cell(two_arms(), tmp_path / "out", DeviceForEach(devices), FAST)
    assert list((tmp_path / "out").glob("*/episode.json")) == []
    assert closed == ["left", "right"]


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (["web"], {"": "web"}),
        (["left=web", "duo/right=gamepad:/dev/input/event3"], None),
        (["udp:127.0.0.1:7071"], {"": "udp:127.0.0.1:7071"}),
        (["my:Device"], {"": "my:Device"}),
    ],
)
def test_devices_are_given_by_arm(given: list[str], found: dict[str, str] | None):
    expected = found or {"left": "web", "duo/right": "gamepad:/dev/input/event3"}
    assert by_arm(given, "--device") == expected


@pytest.mark.parametrize("given", [["web", "gamepad"], ["left=web", "left=web"], ["left=a", "b"]])
def test_two_devices_need_the_names_of_their_arms(given: list[str]):
    with pytest.raises(rc.ArgumentError, match="name the arm of each"):
        by_arm(given, "--device")


def test_a_cell_with_a_task_is_judged_and_one_without_by_the_person(tmp_path: Path):
    for end, expected in (("success", (True, "")), ("failure", (False, "marked as a failure"))):
        made = record_cell(cell_of(RC7), tmp_path / end, Says([UP, UP], end), FAST)
        assert [(each.success, each.reason) for each in made] == [expected]
        [episode] = rc.Dataset(tmp_path / end)
        assert episode.success == expected[0]
    cell = pick_cube_config()
    [made] = record_cell(cell, tmp_path / "task", Says([UP, UP]), FAST)
    assert (made.success, made.reason) == (False, "not done")


def test_a_discarded_episode_of_a_cell_leaves_nothing_and_a_session_goes_on(tmp_path: Path):
    script = [*("record", "", "discard"), *("record", "", "success"), *("record", "", "quit")]

    class Presses(Device):
        def read(self, seconds: float) -> Motion:
            name = script.pop(0) if script else "quit"
            return Motion(commands=(name,) if name else ())

    made = record_cell(cell_of(RC7), tmp_path / "out", Presses(), FAST, episodes=None)
    assert [each.id for each in made] == ["episode-000000"]
    made = record_cell(cell_of(RC7), tmp_path / "out", Says([UP]), FAST, episodes=2)
    assert [each.id for each in made] == ["episode-000001"]
    assert record_cell(cell_of(RC7), tmp_path / "out", Says([UP]), FAST, episodes=2) == []


def bench() -> rc.Robot:
    """An arm in a scene of its own, away from home."""
    spec = rc.SceneSpec(name="bench", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="rc7", config=rc.RobotConfig.load(RC7)))
    robot = rc.Scene.build(spec).robot("rc7")
    robot.set_joint_pos(robot.arm.joint_pos + 0.1)
    return robot


def simulated(robot: rc.Robot) -> hardware.SimulatedArm:
    return hardware.SimulatedArm(robot, real_time=False)


def test_a_real_arm_follows_and_its_episode_is_ordinary(tmp_path: Path):
    robot = bench()
    start, home = robot.tcp_in_world.translation, robot.arm.joint_pos
    real = RealArms({"": simulated(robot)}, safety=SAFETY)
    record_cell(cell_of(RC7), tmp_path / "real", Says([UP] * 12), FAST, real_arms=real)
    record_cell(cell_of(RC7), tmp_path / "sim", Says([UP] * 12), FAST)
    [episode], [other] = (rc.Dataset(tmp_path / name) for name in ("real", "sim"))
    assert robot.tcp_in_world.translation[2] > start[2] + 0.03
    assert rc.data.verify(tmp_path / "real").ok
    assert episode.columns == other.columns
    way = episode["robots/robot/arm/qpos"]
    np.testing.assert_allclose(way[0], home, atol=0.01)


def test_episodes_of_a_run_are_recorded_with_a_real_arm(tmp_path: Path):
    run = rc.RunConfig.load(write_run(tmp_path, cameras={"streams": []}, episodes_per_scene=2))
    run.rates.policy_ms = 66
    arm = simulated(bench())
    device = Says([UP] * 5 + [Motion(commands=("success",)), *[UP] * 5])
    made = record(run, device, FAST, real_arms=RealArms({"": arm}, safety=SAFETY))
    assert [each.id for each in made] == ["s0000_e0000", "s0000_e0001"]
    assert rc.data.verify(tmp_path / "out").ok
    first, second = rc.Dataset(tmp_path / "out")
    place = "robots/rc7/arm/qpos"
    np.testing.assert_allclose(second[place][0], first[place][-1], atol=0.05)


def test_a_real_gripper_keeps_its_opening_until_the_person_says_another(tmp_path: Path):
    robot = bench()
    robot.gripper.close()
    for _ in range(500):
        robot.update()
        robot.step()
    closed = robot.gripper.opening
    assert closed < 0.1
    real = RealArms({"": simulated(robot)}, safety=SAFETY)
    record_cell(cell_of(RC7), tmp_path / "out", Says([UP] * 12), FAST, real_arms=real)
    assert robot.gripper.opening == pytest.approx(closed, abs=0.02)
    [episode] = rc.Dataset(tmp_path / "out")
    np.testing.assert_allclose(episode["robots/robot/action/gripper"], closed, atol=0.02)


def test_a_gripper_that_is_a_robot_of_its_own_obeys_and_stays_a_simulation(tmp_path: Path):
    drives = f"<actuator>{init_models.servos(init_models.SIX_GAINS)}</actuator>"
    text = init_models.model("six", init_models.six_axis(), drives)
    (tmp_path / "six.xml").write_text(text)
    (tmp_path / "six.yaml").write_text(
        "name: six\nmodel: six.xml\nattachment_site: flange\n"
        "move_groups: {arm: {kind: arm, joints: [j1, j2, j3, j4, j5, j6]}}\n"
        "home: {arm: [0, 0.5, 1, 0, 1, 0]}\n"
    )
    hand = REPOSITORY / "models" / "equipment" / "parallel_hand" / "parallel_hand.yaml"
    cell = rc.EnvConfig(
        robots={"left": tmp_path / "six.yaml"}, grippers={"left": hand}, add_floor=True
    )
    cell.sim.frequency = 15
    says = Says([Motion(opening=0.3), UP, UP])
    record_cell(cell, tmp_path / "out", says, FAST)
    [episode] = rc.Dataset(tmp_path / "out")
    assert episode["robots/gripperleft/action/gripper"][-1] == pytest.approx(0.3)
    assert moved(episode, "left")[2] > 0.003
    robot = rc.Env(cell).scene.robot("left")
    real = RealArms({"": simulated(robot)}, safety=SAFETY)
    with pytest.warns(UserWarning, match="is the robot 'gripperleft'.*stays a simulation"):
        record_cell(cell, tmp_path / "real", Says([UP]), FAST, real_arms=real)


class Switch:
    """Stands for a link: counts how often its dead man's switch is pressed."""

    def __init__(self) -> None:
        self.renewed = 0

    def renew(self) -> None:
        self.renewed += 1


def test_each_arm_has_the_dead_mans_switch_of_its_own_device():
    arms = DrivenArms(arms_of(duo()), "", FollowOptions())
    real = RealArms({"left": "udp:127.0.0.1:1", "right": "udp:127.0.0.1:2"})
    links = {name: Switch() for name in arms.names}
    real._links = links  # type: ignore[assignment]
    let_go = Motion(clutch=False)
    for motion, pressed in (
        (UP, (1, 1)),
        (None, (0, 0)),
        (let_go, (0, 0)),
        (Motion(arms={"left": UP}), (1, 0)),
        (Motion(arms={"duo/left": let_go, "right": UP}), (0, 1)),
    ):
        before = [link.renewed for link in links.values()]
        real.renew(arms.held_by(motion))
        after = [link.renewed for link in links.values()]
        assert tuple(np.subtract(after, before)) == pressed, motion


@pytest.mark.parametrize("made", [True, False])
@pytest.mark.parametrize("target", ["cell", "run"])
def test_a_driver_that_cannot_begin_ends_the_session_without_an_episode(
    target: str, made: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Whatever its class or its first measurement raises."""
    (tmp_path / "my_arm.py").write_text(
        "class Broken:\n    def __init__(self, robot):\n        raise RuntimeError('no bus')\n"
    )
    monkeypatch.chdir(tmp_path)
    arm = Breaks("raises")
    arm.left = 1
    real = RealArms({"": arm if made else "my_arm:Broken"}, safety=SAFETY)
    run = rc.RunConfig.load(write_run(tmp_path, cameras={"streams": []}))
    device = Says([UP] * 5)

    def session() -> None:
        if target == "cell":
            record_cell(cell_of(RC7), tmp_path / "out", device, FAST, real_arms=real)
        else:
            record(run, device, FAST, real_arms=real)

    with pytest.raises(ArmStoppedError, match=r"real arm '.*': .*(unplugged|no bus)"):
        session()
    assert list((tmp_path / "out").glob("*/episode.json")) == []


def test_an_episode_of_a_cell_that_diverges_is_dropped_and_says_so(tmp_path: Path):
    class Kicks:
        """A screen that breaks the simulation once."""

        def __init__(self) -> None:
            self.seen: list[Mapping[str, Any]] = []
            self.kicked = False

        def show(self, scene: rc.Scene, status: Mapping[str, Any], row: Mapping[str, Any]) -> None:
            self.seen.append(dict(status))
            if status["phase"] == "recording" and status["rows"] == 2 and not self.kicked:
                self.kicked = True
                scene.data.qvel[0] = 1e12

    screen = Kicks()
    slow = replace(FAST, real_time=True)  # so that each action is shown
    cell = cell_of(RC7)
    cell.sim.frequency = 15
    made = record_cell(cell, tmp_path / "out", Says([UP] * 4), slow, screen)
    assert [each.success for each in made] == [True]
    said = [each.get("dropped", "") for each in screen.seen if each["phase"] == "waiting"]
    assert any(said), screen.seen
    assert screen.seen[-1].get("dropped", "") == ""


class Breaks(hardware.ArmPort):
    """An arm that stands where it was commanded, and breaks after some reads."""

    def __init__(self, kind: str) -> None:
        super().__init__()
        robot = bench()
        self.kind, self.left, self.held, self.clock = kind, 40, 0, 0.0
        self.name, self.pos = "bench", robot.arm.joint_pos
        self.joint_names = list(robot.joint_names)
        lower, upper = np.asarray(robot.joint_limits).T
        self.limits = hardware.ArmLimits(
            lower=lower, upper=upper, velocity=[1] * 7, acceleration=[4] * 7, force=[80] * 7
        )

    def read(self) -> hardware.ArmMeasurement | None:
        self.left -= 1
        if self.left > 0:
            return hardware.ArmMeasurement(time=self.clock, pos=self.pos)
        if self.kind == "raises":
            raise OSError("unplugged")
        if self.kind == "nonsense":
            return hardware.ArmMeasurement(time=self.clock, pos=self.pos * np.nan)
        return None

    def send(self, command: hardware.ArmCommand) -> None:
        self.pos = command.pos

    def hold(self) -> None:
        self.held += 1

    def now(self) -> float:
        return self.clock

    def wait_until(self, time: float) -> None:
        self.clock = max(self.clock, time)


@pytest.mark.parametrize(
    ("target", "kind"),
    [
        ("cell", "raises"),
        ("cell", "silent"),
        ("cell", "nonsense"),
        ("run", "raises"),
        pytest.param("run", "silent", marks=pytest.mark.proof),
        pytest.param("run", "nonsense", marks=pytest.mark.proof),
    ],
)
def test_a_real_arm_that_breaks_ends_the_session_without_an_episode(
    kind: str, target: str, tmp_path: Path
):
    arm = Breaks(kind)
    safety = hardware.SafetyOptions(slow_start=0, watchdog=0.1)
    real = RealArms({"": arm}, safety=safety)
    device = Says([UP] * 30)
    words = "unplugged" if kind == "raises" else "no good measurement"
    run = rc.RunConfig.load(write_run(tmp_path, cameras={"streams": []}))

    def session() -> None:
        if target == "cell":
            record_cell(cell_of(RC7), tmp_path / "out", device, FAST, real_arms=real)
        else:
            record(run, device, FAST, real_arms=real)

    with pytest.raises(ArmStoppedError, match=words):
        session()
    assert arm.held > 0
    assert list((tmp_path / "out").glob("*/episode.json")) == []


def test_a_dry_run_moves_no_real_arm(tmp_path: Path):
    robot = bench()
    before = robot.arm.joint_pos
    real = RealArms({"": simulated(robot)}, safety=hardware.SafetyOptions(dry_run=True, watchdog=5))
    record_cell(cell_of(RC7), tmp_path / "out", Says([UP] * 6), FAST, real_arms=real)
    np.testing.assert_allclose(robot.arm.joint_pos, before, atol=0.01)


def invoke(*words: object) -> Any:
    given = ["teleop", *map(str, words)]
    return CliRunner().invoke(load(given), given)


def ups(folder: Path) -> None:
    """Writes a module with a device that records some motions."""
    (folder / "my_device.py").write_text(
        "from robocell.teleop import Device, Motion\n"
        "class Ups(Device):\n"
        "    count = 0\n"
        "    def read(self, seconds):\n"
        "        self.count += 1\n"
        "        names = {1: ('record',), 6: ('success',)}.get(self.count, ())\n"
        "        return Motion(translation=(0, 0, 0.002), commands=names)\n"
    )


@pytest.mark.proof  # in real time
def test_the_command_records_with_an_arm_behind_a_network(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    ups(tmp_path)
    monkeypatch.chdir(tmp_path)
    robot = bench()
    start = robot.arm.joint_pos
    server = hardware.UdpArmServer(hardware.SimulatedArm(robot, watchdog=20), watchdog=20)
    options = ["--device", "my_device:Ups", "--countdown", 0, "--keep-all", "--mode", "real"]
    options += ["-n", 1]
    options += ["--arm", f"udp:{server.address}", "--arm-watchdog", 20, "--output", "out"]
    with hardware.serving(server):
        result = invoke(RC7, *options)
    assert result.exit_code == 0, result.output
    [episode] = rc.Dataset(tmp_path / "out")
    np.testing.assert_allclose(episode["robots/robot/arm/qpos"][0], start, atol=0.02)
    assert np.abs(robot.arm.joint_pos - start).max() > 1e-4
    with pytest.raises(rc.IoError, match="no arm answers"):
        raise invoke(RC7, *options, "--output", "other").exception


def test_the_command_takes_robots_and_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    ups(tmp_path)
    monkeypatch.chdir(tmp_path)
    for target in (RC7, REPOSITORY / "examples" / "envs" / "rc7.yaml"):
        options = ("--device", "my_device:Ups", "--countdown", 0, "--keep-all", "-n", 1)
        result = invoke(target, *options, "--output", tmp_path / target.parent.name)
        assert result.exit_code == 0, result.output
        assert "success" in result.output
        assert len(rc.Dataset(tmp_path / target.parent.name)) == 1


def test_a_session_is_replayed_for_all_its_arms(tmp_path: Path):
    record_cell(two_arms(), tmp_path / "out", Says([UP]), FAST)
    [session] = (tmp_path / "out" / "device_sessions").iterdir()
    result = invoke(RC7, "--device", f"robot=replay:{session}")
    assert result.exit_code == 2
    assert "a session moves all its arms; give replay:FILE alone" in result.output


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--mode", "rel"], "--mode is rel"),
        (["--mode", "real"], "needs an arm"),
        (["--arm", "udp:127.0.0.1:1"], "add --mode real"),
        (["--device", "a=web", "--device", "b=web"], "one arm at a time"),
        (["--import", "tasks"], "--import is of a run"),
        (["--arm-speed", "0.2"], "add --mode real"),
        (["--device", "keyboard", "--mode", "real", "--dead-man", "1"], "cannot be let go of"),
    ],
)
def test_options_that_do_not_fit_are_explained(words: list[str], message: str):
    result = invoke(RC7, *words)
    assert result.exit_code != 0
    assert message in f"{result.output}{result.exception}"
