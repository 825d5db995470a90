"""Arms without position servos, from their model to a dataset of picks."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

import robocell as rc
import robocell.compat.mj_kdl_wrapper as mjk
from command_line import RC7, refused, robocell_command, write_run
from test_kdl_chain import PyKDL, needs_pykdl

MOTOR = '<motor name="m{0}" joint="j{0}" ctrlrange="-90 90"/>'
VELOCITY = '<velocity name="m{0}" joint="j{0}" kv="20"/>'
INTEGRATING = '<intvelocity name="m{0}" joint="j{0}" kp="100" actrange="-3 3"/>'
HALF = ('<position name="m1" joint="j1" kp="100"/>', '<motor name="m2" joint="j2"/>')


def model(folder: Path, *actuators: str) -> Path:
    """An arm of two joints; one actuator for each, or one text for both."""
    acting = [text.format(i + 1) for i, text in enumerate(actuators * (2 // len(actuators)))]
    path = folder / "arm.xml"
    path.write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="base"><geom size=".05" mass="1"/>'
        '<body name="l1" pos="0 0 .1"><joint name="j1" axis="0 0 1" range="-3 3" damping=".4" '
        'armature=".05"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="2"/>'
        '<body name="l2" pos=".3 0 0"><joint name="j2" axis="0 1 0" range="-2 2" damping=".4" '
        'armature=".05"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1"/>'
        '<site name="tcp" pos=".3 0 0"/></body></body></body></worldbody>'
        '<contact><exclude body1="base" body2="l1"/></contact>'
        f"<actuator>{''.join(acting)}</actuator></mujoco>"
    )
    return path


def bare(path: Path, modes: list[str] | None = None) -> rc.Robot:
    spec = rc.SceneSpec(name="arms", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(rc.RobotSpec(name="a", path=str(path), pos=[0, 0, 1], control_modes=modes))
    return rc.Robot.from_scene(rc.Scene.build(spec), "base", "l2")


def hold_by_torques(robot: rc.Robot) -> float:
    """How far the TCP gets in a second of gravity torques, m."""
    start = np.array(robot.tcp_in_world.translation)
    for _ in range(500):
        robot.update()
        robot.jnt_trq_cmd = robot.gravity_torques()
        robot.step()
    return float(np.linalg.norm(robot.tcp_in_world.translation - start))


@pytest.mark.parametrize("modes", [None, ["torque"], ["position", "velocity", "torque"]])
def test_an_arm_of_motors_is_driven_by_torques(tmp_path: Path, modes: list[str] | None):
    robot = bare(model(tmp_path, MOTOR), modes)
    robot.ctrl_mode = "torque"
    assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE
    assert hold_by_torques(robot) < 1e-3


def test_an_arm_of_velocity_servos_is_driven_by_velocities(tmp_path: Path):
    robot = bare(model(tmp_path, VELOCITY))
    assert robot.ctrl_mode == rc.control.CtrlMode.VELOCITY
    robot.jnt_vel_cmd = [0.2, -0.1]
    for _ in range(500):
        robot.update()
        robot.step()
    np.testing.assert_allclose(robot.jnt_vel_msr, [0.2, -0.1], atol=2e-3)


def read_mode(robot: rc.Robot) -> None:
    assert robot.ctrl_mode is None


def position_mode(robot: rc.Robot) -> None:
    robot.ctrl_mode = "position"


def torque_mode(robot: rc.Robot) -> None:
    robot.ctrl_mode = "torque"


def command(robot: rc.Robot) -> None:
    robot.jnt_pos_cmd = [0.5, 0]


NONE = "it has no actuators: no position servo on its joints, no velocity servo and no motor"


@pytest.mark.parametrize(
    ("actuators", "told"),
    [
        ([""], NONE),
        ([INTEGRATING], "j1 ('m1' on it is a servo that integrates its control)"),
        (HALF, "1 of its joints has no position servo: j2 ('m2' on it is a motor)"),
    ],
    ids=["none", "integrating", "half"],
)
@pytest.mark.parametrize("use", [read_mode, position_mode, torque_mode, command])
def test_an_undriven_arm_is_reported_at_once(
    tmp_path: Path, actuators: list[str], told: str, use: Callable[[rc.Robot], None]
):
    robot = bare(model(tmp_path, *actuators))
    with pytest.raises(rc.Error, match=re.escape(told)):
        use(robot)
    robot.update()
    assert robot.step()


@pytest.mark.parametrize("use", [position_mode, command])
def test_rejects_position_commands_for_motors(tmp_path: Path, use: Callable[[rc.Robot], None]):
    robot = bare(model(tmp_path, MOTOR))
    with pytest.raises(rc.ArgumentError, match="'m1' is a motor, no position servo"):
        use(robot)
    assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE


@pytest.mark.parametrize("actuators", ["", ", actuators: [m1, m2]"])
def test_check_rejects_integrating_servos(tmp_path: Path, actuators: str):
    model(tmp_path, INTEGRATING)
    robot = tmp_path / "robot.yaml"
    robot.write_text(
        "name: integrating\nmodel: arm.xml\nmove_groups:\n"
        f"  arm: {{kind: arm, joints: [j1, j2], leaf: {{site: tcp}}{actuators}}}\n"
        "control: {arm: joint_torque}\n"
    )
    told = refused("check", robot)
    assert "m1' on it is a servo that" in told or "m1' is a servo that integrates" in told
    assert "motors" in told


def motor_robot(folder: Path, control: str) -> Path:
    """The built-in robot with motors in the place of its servos, which its file does not list."""
    text = (RC7.parent / "rc7.xml").read_text()
    text, count = re.subn(r'<position name="servo(\d)" (joint="\w+") class="\w+"/>', MOTORS, text)
    assert count == 7
    (folder / "motors.xml").write_text(text)
    config = yaml.safe_load(RC7.read_text())
    config.update(name="motors", model="motors.xml", control={"arm": control})
    del config["move_groups"]["arm"]["actuators"]
    path = folder / "motors.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


MOTORS = r'<motor name="m\1" \2 ctrlrange="-120 120"/>'


@pytest.mark.proof
def test_a_soft_arm_of_motors_picks_and_its_episodes_replay(tmp_path: Path):
    robot = motor_robot(tmp_path, "joint_impedance")
    checked = robocell_command("check", robot)
    assert checked.returncode == 0, checked.stderr
    assert checked.stdout.splitlines()[-1] == "no problems found"
    run = write_run(tmp_path, robot=str(robot), max_attempts=3, cameras={"streams": []})
    estimated = robocell_command("generate", run, "--dry-run")
    assert estimated.returncode == 0, estimated.stderr
    made = robocell_command("generate", run, "--workers", 1, "--progress", "jsonl")
    assert made.returncode == 0, made.stdout + made.stderr
    assert json.loads(made.stdout.splitlines()[-1])["totals"]["made"] == 2
    replayed = robocell_command("replay", tmp_path / "out")
    assert replayed.returncode == 0, replayed.stdout + replayed.stderr


@needs_pykdl
def test_the_guides_chain_and_torque_loop_work_with_motors(tmp_path: Path):
    robot_spec = mjk.RobotSpec()
    robot_spec.path = str(model(tmp_path, MOTOR))
    spec = mjk.SceneSpec()
    spec.timestep, spec.add_floor, spec.add_skybox = 0.002, True, True
    spec.robots = [robot_spec]
    robot = mjk.Robot.from_scene(mjk.Scene.build(spec), "base", "l2")
    chain = robot.kdl_chain()
    assert (chain.getNrOfJoints(), robot.n_joints) == (2, 2)
    robot.ctrl_mode = mjk.CtrlMode.TORQUE
    q, gravity = PyKDL.JntArray(2), PyKDL.JntArray(2)
    dynamics = PyKDL.ChainDynParam(chain, PyKDL.Vector(0, 0, -9.81))
    start = np.array(robot.tcp_in_world.translation)
    for _ in range(500):
        robot.update()
        for i, value in enumerate(robot.jnt_pos_msr):
            q[i] = value
        dynamics.JntToGravity(q, gravity)
        robot.jnt_trq_cmd = list(gravity)
        assert robot.step()
    assert np.linalg.norm(robot.tcp_in_world.translation - start) < 1e-3


@pytest.mark.parametrize(
    "servo",
    [
        '<position name="hold" site="tcp" refsite="at" kp="400" gear="0 0 1 0 0 0"/>',
        '<general name="damp" site="tcp" refsite="at" gear="0 1 0 0 0 0" biastype="affine" '
        'gainprm="0" biasprm="0 0 -60"/>',
    ],
)
def test_servos_at_sites_are_switched_with_those_of_the_joints(tmp_path: Path, servo: str):
    path = model(tmp_path, '<position name="p{0}" joint="j{0}" kp="200" kv="20"/>')
    text = path.read_text().replace('<body name="base">', '<body name="base"><site name="at"/>')
    path.write_text(text.replace("</actuator>", f"{servo}</actuator>"))
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(path=str(path), control_modes=["position", "torque"]))
    robot = rc.Robot.from_scene(rc.Scene.build(spec), "base", "l2")
    robot.ctrl_mode = rc.control.CtrlMode.TORQUE
    # Stock MuJoCo with motors alone is the oracle.
    alone = re.sub(r"<actuator>.*</actuator>", f"<actuator>{MOTOR * 2}</actuator>", text)
    for joint in (1, 2):
        alone = alone.replace(MOTOR, MOTOR.format(joint), 1)
    stock = mujoco.MjModel.from_xml_string(alone)
    for field in ("timestep", "integrator", "cone", "impratio", "iterations"):
        setattr(stock.opt, field, getattr(robot.scene.model.opt, field))
    data = mujoco.MjData(stock)
    data.ctrl[:] = [3, -8]
    robot.jnt_trq_cmd = [3, -8]
    for _ in range(100):
        robot.update()
        robot.step()
        mujoco.mj_step(stock, data)
    robot.update()
    assert np.abs(data.qpos).max() > 0.05
    assert np.allclose(robot.jnt_pos_msr, data.qpos, atol=1e-9)
