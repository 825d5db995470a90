"""Real arms below robots: drivers, what guards them, and what is the same as in a simulation."""

from __future__ import annotations

import contextlib
import math
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robocell as rc
from rcs_cells import fr3, minimal  # noqa: F401  (a fixture)
from robocell import hardware
from robocell._hardware.lerobot_arm import LeRobotArm, limits_of
from robocell.compat.rcs.envs.scenes import SimEnvCreator
from robocell.gym import pick_cube_config

RC7 = Path(__file__).resolve().parents[2] / "models" / "robots" / "rc7" / "rc7.yaml"
SIDES = ("left", "right")
FAST = hardware.SafetyOptions(slow_start=0, watchdog=5)  # computers that test are busy


def a_robot() -> rc.Robot:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="rc7", config=rc.RobotConfig.load(RC7)))
    return rc.Scene.build(spec).robot("rc7")


def arm_of(robot: rc.Robot, **options: Any) -> hardware.SimulatedArm:
    return hardware.SimulatedArm(robot, real_time=False, **options)


def test_the_same_program_moves_a_simulated_and_a_real_arm():
    arrived = {}
    for mode in ("sim", "real"):
        robot = a_robot()
        goal = robot.jnt_pos_msr + 0.1
        with hardware.connect(robot, mode, arm_of(a_robot()), safety=FAST) as arm:
            for _ in range(600):
                robot.jnt_pos_cmd[:] = goal
                robot.update()
                assert robot.step().ok
            assert (arm.ok, arm.state, arm.reason) == (True, "running", "")
            assert arm.move_to(goal)
            arm.stop("enough")
            assert not arm.ok
        arrived[mode] = robot.arm.joint_pos
    np.testing.assert_allclose(arrived["sim"], arrived["real"], atol=0.01)


def with_torques() -> rc.Robot:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    modes = [rc.control.CtrlMode.POSITION, rc.control.CtrlMode.TORQUE]
    config = rc.RobotConfig.load(RC7)
    spec.robots.append(rc.RobotSpec(name="rc7", config=config, control_modes=modes))
    return rc.Scene.build(spec).robot("rc7")


@pytest.mark.parametrize("mode", ["sim", "simulated arm", "udp"])
def test_the_same_controller_of_torques_floats_a_simulated_and_a_real_arm(mode: str):
    """Gravity is compensated, and a push by a torque moves the arm a little."""
    robot, arm = with_torques(), hardware.SimulatedArm(with_torques(), real_time=mode == "udp")
    server = hardware.UdpArmServer(arm, watchdog=5)
    serves = hardware.serving(server) if mode == "udp" else contextlib.nullcontext()
    port = f"udp:{server.address}" if mode == "udp" else arm
    with (
        serves,
        hardware.connect(robot, "sim" if mode == "sim" else "real", port, safety=FAST) as link,
    ):
        start = robot.jnt_pos_msr.copy()
        robot.ctrl_mode = rc.control.CtrlMode.TORQUE
        for i in range(200):
            robot.update()
            robot.jnt_trq_cmd = robot.gravity_torques()
            robot.jnt_trq_cmd[0] += 1.0 if i < 50 else 0.0
            robot.update()
            assert robot.step().ok, link.reason
        moved = robot.jnt_pos_msr - start
        assert link.ok, link.reason
    assert moved[0] > 0.001
    assert np.abs(moved[1:]).max() < 0.05


def test_an_arm_without_torques_refuses_them():
    robot = with_torques()
    with hardware.connect(robot, "real", Bench(robot), safety=FAST) as link:
        robot.ctrl_mode = rc.control.CtrlMode.TORQUE
        robot.update()
        assert robot.step().stopped
        assert "bench takes no torques; command joint positions" in link.reason


def test_a_simulation_moves_the_arm_that_is_named(tmp_path: Path):
    arms = "".join(
        f"<body name='{side}' pos='{x} 0 0'><joint name='{side}' damping='1' range='-2 2'/>"
        f"<geom size='0.05'/><site name='{side}' pos='0 0 0.1'/></body>"
        for side, x in (("left", -0.3), ("right", 0.3))
    )
    servos = "".join(f"<position name='{side}' joint='{side}' kp='10'/>" for side in SIDES)
    model = tmp_path / "two.xml"
    model.write_text(
        f"<mujoco><compiler angle='radian'/><worldbody><body name='base'>{arms}</body>"
        f"</worldbody><actuator>{servos}</actuator></mujoco>"
    )
    groups = {
        side: {"kind": "arm", "joints": [side], "actuators": [side], "leaf": {"site": side}}
        for side in SIDES
    }
    config = rc.RobotConfig(
        name="two", model=str(model), root_body="base", home={}, move_groups=groups
    )
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="two", config=config))
    robot = rc.Scene.build(spec).robot("two")
    with hardware.connect(robot, "sim", group="right") as arm:
        assert arm.move_to([0.3])
    assert robot.group("left").joint_pos == pytest.approx([0], abs=1e-6)
    assert robot.group("right").joint_pos == pytest.approx([0.3], abs=0.01)


def test_an_environment_on_an_arm_records_episodes_of_the_same_schema(tmp_path: Path):
    action = {"robot": {"tquat": [0, 0.01, -0.01, 0, 0, 0, 1], "gripper": 1}}
    episodes = {}
    for name in ("simulated", "real"):
        env = rc.Env(pick_cube_config(relative_to="last_step"))
        link = None
        if name == "real":
            behind = rc.Env(pick_cube_config()).scene.robots[0]
            link = hardware.ArmLink(env.scene.robots[0], arm_of(behind), safety=FAST)
        with rc.data.EnvRecorder(env, tmp_path / name):
            env.reset(seed=1)
            for _ in range(3):
                env.step(action)
        episodes[name] = rc.Dataset(tmp_path / name)[0]
        if link is not None:
            assert link.ok, link.reason
            qpos = env.row()["robots/robot/arm/qpos"]
            np.testing.assert_array_equal(qpos, link.measured.pos)
    simulated, real = episodes["simulated"], episodes["real"]
    assert simulated.columns == real.columns
    assert len(simulated["reward"]) == len(real["reward"]) == 3
    for name in simulated.columns:
        assert simulated[name].shape == real[name].shape
        assert simulated[name].dtype == real[name].dtype
    assert not rc.data.verify(tmp_path / "real").problems


@pytest.mark.proof
def test_an_rcs_environment_on_an_arm_has_the_same_frames(fr3):  # noqa: F811
    env, behind, simulated = (SimEnvCreator()(minimal(fr3, headless=True)) for _ in range(3))
    robot = env.core.scene.robots[0]
    ahead = {"robot": {"tquat": [0.01, 0, 0, 0, 0, 0, 1]}}
    arm = arm_of(behind.core.scene.robots[0])
    with hardware.ArmLink(robot, arm, safety=FAST) as link:
        start = env.reset(seed=0)[0]["robot"]["tquat"]
        np.testing.assert_allclose(start, simulated.reset(seed=0)[0]["robot"]["tquat"], atol=0.01)
        for _ in range(20):
            seen = env.step(ahead)[0]["robot"]["tquat"]
            same = simulated.step(ahead)[0]["robot"]["tquat"]
        assert link.ok, link.reason
        pose = robot.fk_frame(link.measured.pos)
        np.testing.assert_allclose(seen[:3], pose.translation, atol=1e-6)
    assert seen[0] - start[0] > 0.05
    np.testing.assert_allclose(seen, same, atol=0.03)


def test_a_stopped_arm_ends_the_episode_with_the_reason():
    env = rc.Env(pick_cube_config())
    behind = rc.Env(pick_cube_config()).scene.robots[0]
    with hardware.ArmLink(env.scene.robots[0], arm_of(behind), safety=FAST) as link:
        env.reset(seed=1)
        link.stop("the button")
        step = env.step({"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}})
        truncated, info = step[3], step[4]
        assert truncated
        assert info["end_reason" if "end_reason" in info else "reason"] == "stopped"
        assert "the button" in link.reason


class Bench(hardware.ArmPort):
    """An arm without a body, in Python."""

    def __init__(self, robot: rc.Robot) -> None:
        super().__init__()
        self.name, self.limits = "bench", limits_of(robot)
        self.joint_names = [name.removeprefix(robot.prefix) for name in robot.joint_names]
        self.pos = np.array(robot.jnt_pos_msr)
        self.clock, self.held = 0.0, 0
        self.error: Exception | None = None

    def now(self) -> float:
        return self.clock

    def wait_until(self, time: float) -> None:
        self.clock = max(self.clock, time)

    def read(self) -> hardware.ArmMeasurement | None:
        return hardware.ArmMeasurement(time=self.clock, pos=self.pos)

    def send(self, command: hardware.ArmCommand) -> None:
        if self.error:
            raise self.error
        self.pos = command.pos

    def hold(self) -> None:
        self.held += 1


def test_a_driver_in_python_moves_and_its_errors_stop_the_arm():
    robot = a_robot()
    bench = Bench(robot)
    with hardware.connect(robot, "real", bench, safety=FAST) as arm:
        assert arm.move_to(robot.jnt_pos_msr + 0.05)
        bench.error = OSError("the cable is torn")
        result = robot.scene.step_n(20)
        assert result.stopped
        assert "the cable is torn" in result.message
        assert "test_hardware.py" in result.message
    assert bench.held == 1


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"read": lambda: 7}, "read() must return"),
        ({"joint_names": ["elbow"]}, "bench has the joints elbow"),
        ({"limits": hardware.ArmLimits()}, "`lower` of its limits has 0 values"),
        ({"read": lambda: None}, "nothing good was measured within 0.05 s"),
    ],
)
def test_a_driver_that_is_wrong_is_refused_with_the_reason(wrong: dict[str, Any], words: str):
    robot = a_robot()
    bench = Bench(robot)
    for name, value in wrong.items():
        setattr(bench, name, value)
    with pytest.raises((rc.Error, TypeError)) as raised:
        hardware.ArmLink(robot, bench, timeout=0.05)
    assert words in str(raised.value)


def test_a_driver_that_cannot_hold_is_refused_before_it_moves():
    class Careless(hardware.ArmPort):
        name, joint_names = "careless", ["elbow"]
        limits = hardware.ArmLimits()

        def read(self) -> None:
            return None

        def send(self, command: hardware.ArmCommand) -> None:
            pass

    robot = a_robot()
    for use in (lambda port: hardware.ArmLink(robot, port), hardware.UdpArmServer):
        with pytest.raises((rc.Error, TypeError, AttributeError), match=r"Careless.*hold"):
            use(Careless())


def test_the_dead_mans_switch_is_pressed_by_another_thread():
    robot = a_robot()
    safety = hardware.SafetyOptions(slow_start=0, dead_man=0.1)
    with hardware.ArmLink(robot, Bench(robot), safety=safety) as link:
        robot.scene.step_n(100)
        assert (link.state, link.reason) == ("holding", "the dead man's switch is released")
        presser = threading.Thread(target=link.renew)
        presser.start()
        presser.join()
        robot.scene.step_n(4)
        assert link.state == "running"


PROGRAM = """
import sys
from pathlib import Path
import robocell as rc
spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
spec.robots.append(rc.RobotSpec(name="rc7", config=rc.RobotConfig.load(Path(sys.argv[1]))))
robot = rc.Scene.build(spec).robot("rc7")
with rc.hardware.connect(robot, "real", "udp:" + sys.argv[2]) as arm:
    print("driving", flush=True)
    while arm.ok:
        robot.jnt_pos_cmd[0] += 0.002
        robot.update()
        robot.step()
"""


def test_a_program_that_is_killed_leaves_the_arm_holding():
    arm = hardware.SimulatedArm(a_robot())
    server = hardware.UdpArmServer(arm)
    with hardware.serving(server):
        command = [sys.executable, "-c", textwrap.dedent(PROGRAM), str(RC7), server.address]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
            assert program.stdout is not None
            assert program.stdout.readline() == "driving\n"
            time.sleep(0.3)
            program.send_signal(signal.SIGKILL)
        end = time.monotonic() + 10
        while server.is_driven and time.monotonic() < end:
            time.sleep(0.02)
        assert not server.is_driven
        time.sleep(0.3)
    time.sleep(0.01)
    measured = arm.read()
    assert measured is not None
    np.testing.assert_allclose(measured.vel, 0, atol=0.02)


class FakeFollower:
    """A LeRobot Robot: degrees, a gripper from 0 to 100, an image."""

    def __init__(self) -> None:
        self.config = SimpleNamespace(disable_torque_on_disconnect=True)
        self.at = {f"motor{i}.pos": 0.0 for i in range(7)} | {"gripper.pos": 100.0}
        self.connected, self.torn = False, False

    def connect(self) -> None:
        self.connected = True

    def get_observation(self) -> dict[str, Any]:
        if self.torn:
            raise OSError("no status packet")
        return self.at | {"front": np.zeros((4, 4, 3), np.uint8)}

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        self.at.update(action)
        return action

    def disconnect(self) -> None:
        self.connected = False


@pytest.fixture
def follower(monkeypatch: pytest.MonkeyPatch) -> FakeFollower:
    """The class `fake_lerobot:Follower`, and the one that it makes."""
    made = FakeFollower()
    made.at.update({f"motor{i}.pos": math.degrees(q) for i, q in enumerate(a_robot().jnt_pos_msr)})

    class Follower:
        def __new__(cls) -> Any:
            return made

    module: Any = ModuleType("fake_lerobot")
    module.Follower = Follower
    monkeypatch.setitem(sys.modules, "fake_lerobot", module)
    return made


def test_a_lerobot_arm_is_moved_by_name(follower: FakeFollower):
    robot = a_robot()
    goal = robot.jnt_pos_msr + 0.02
    with hardware.connect(robot, "real", "lerobot:fake_lerobot:Follower", safety=FAST) as arm:
        robot.gripper.opening = 0.5
        assert arm.move_to(goal, timeout=20)
        assert isinstance(arm, hardware.ArmLink)
        assert arm.measured.opening is not None
    assert not follower.connected
    assert not follower.config.disable_torque_on_disconnect, "it holds"
    motors = [math.radians(follower.at[f"motor{i}.pos"]) for i in range(7)]
    np.testing.assert_allclose(motors, goal, atol=0.03)
    assert follower.at["gripper.pos"] == pytest.approx(50, abs=1)


def test_a_lerobot_arm_that_is_unplugged_stops(follower: FakeFollower):
    robot = a_robot()
    with hardware.connect(robot, "real", "lerobot:fake_lerobot:Follower", safety=FAST) as arm:
        follower.torn = True
        assert robot.scene.step_n(2000).stopped
        assert "no status packet" in arm.reason


def test_a_lerobot_arm_that_does_not_answer_is_left_disconnected(follower: FakeFollower):
    follower.torn = True
    with pytest.raises(rc.IoError, match="no status packet"):
        hardware.make_arm("lerobot:fake_lerobot:Follower", a_robot())
    assert not follower.connected


def test_a_file_maps_the_motors_of_a_lerobot_arm(follower: FakeFollower, tmp_path: Path):
    robot = a_robot()
    file = tmp_path / "arm.yaml"
    names = [name.removeprefix(robot.prefix) for name in robot.joint_names]
    lines = [
        f"  motor{i}.pos: {{joint: {name}, scale: {math.radians(1)}, offset: 0}}"
        for i, name in enumerate(names)
    ]
    text = "class: fake_lerobot:Follower\njoints:\n" + "\n".join(lines) + "\n"
    file.write_text(text + "gripper: {from: gripper.pos, closed: 0, open: 100}\n")
    arm = LeRobotArm.of_file(file, robot)
    try:
        measured = arm.read()
        while measured is None:
            measured = arm.read()
        np.testing.assert_allclose(measured.pos, robot.jnt_pos_msr, atol=1e-6)
        assert measured.opening == 1
    finally:
        arm.close()
    for wrong, words in (
        (
            text.replace("motor0.pos", "motr0.pos"),
            "no motor 'motr0.pos'. Did you mean 'motor0.pos'",
        ),
        (text.replace(lines[6] + "\n", ""), f"no motor is joint '{names[6]}'"),
        (text.replace("joints:", "joint:"), "no field 'joint'"),
        (text.replace(f"scale: {math.radians(1)}", "scale: 0"), "0 moves no motor"),
        (text.replace(f"scale: {math.radians(1)}", "scale: wide"), "a joint is {joint: NAME"),
        (text.replace(names[1], names[0]), f"are both joint '{names[0]}'"),
        (text + "gripper: {from: gripper.pos, closed: 0, open: 0}\n", "are the same"),
    ):
        file.write_text(wrong)
        with pytest.raises(rc.Error, match=re.escape(words)):
            LeRobotArm.of_file(file, robot)
    assert not follower.connected


def test_unknown_arms_and_modes_show_those_that_there_are():
    robot = a_robot()
    with pytest.raises(rc.ArgumentError, match=r"(?s)no arm 'upd'.*udp:HOST:PORT"):
        hardware.make_arm("upd", robot)
    with (
        pytest.raises(rc.ArgumentError, match="sim and real"),
        hardware.connect(robot, "reel"),
    ):
        pass
    with pytest.raises(rc.ArgumentError, match="needs an arm"), hardware.connect(robot, "real"):
        pass
    for name, options in (
        ("udp:127.0.0.1:9", {"config": "arm.yaml"}),
        ("file:arm.yaml", {"config": "more.yaml"}),
        (arm_of(a_robot()), {"secret": "sesame"}),
    ):
        with (
            pytest.raises(rc.ArgumentError, match=r"leave out config|'secret' is an option"),
            hardware.connect(robot, "real", name, **options),
        ):
            pass
    with pytest.raises(rc.ArgumentError, match="remote=true"):
        hardware.UdpArmServer(arm_of(a_robot()), "0.0.0.0:0")
