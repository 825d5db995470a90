"""Numbers that are none and wrong counts are refused by name, whichever way they come in."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import robocell as rc

NAN = float("nan")
HOME = [0.0] * 7
SPOILT = [*HOME[:4], NAN, *HOME[5:]]  # the fifth of seven
ARM = r"robot 'a' / group 'arm'"
GRIPPER = r"robot 'a' / group 'gripper'"

Command = Callable[[rc.Scene, rc.Robot], object]


@pytest.fixture(scope="module")
def scene() -> rc.Scene:
    """The built-in robot on a floor; refused commands leave it as it was."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    return rc.Scene.build(spec)


def advance(
    scene: rc.Scene, robot: rc.Robot, **groups: rc.control.GroupCommand
) -> rc.control.StepOutcome:
    """One policy tick."""
    return rc.control.Stepper(scene, [robot], 2, 1).advance({"a": groups})


def set_attribute(value: object, name: str, wanted: object) -> None:
    """An assignment, for lambdas."""
    setattr(value, name, wanted)


WRONG: dict[str, tuple[Command, str]] = {
    "apply, too few": (
        lambda s, r: r.apply({"arm": rc.control.GroupCommand.joints([1, 2])}),
        f"{ARM}: expected 7 joint values, got 2",
    ),
    "apply, NaN": (
        lambda s, r: r.apply({"arm": rc.control.GroupCommand.joints(SPOILT)}),
        f"{ARM}: the target of 'joint5' is nan; targets must be finite",
    ),
    "apply, relative": (
        lambda s, r: r.apply({"arm": rc.control.GroupCommand.relative_joints(np.full(7, np.inf))}),
        f"{ARM}: the target of 'joint1' is inf",
    ),
    "apply, opening": (
        lambda s, r: r.apply({"gripper": rc.control.GroupCommand.opening(NAN)}),
        f"{GRIPPER}: the target of 'opening' is nan",
    ),
    "apply, joints for a gripper": (
        lambda s, r: r.apply({"gripper": rc.control.GroupCommand.joints([0.0])}),
        f"{GRIPPER} is a gripper: command it with an opening",
    ),
    "stepper, too many": (
        lambda s, r: advance(s, r, arm=rc.control.GroupCommand.joints([0.0] * 9)),
        f"{ARM}: expected 7 joint values, got 9",
    ),
    "stepper, NaN": (
        lambda s, r: advance(s, r, arm=rc.control.GroupCommand.joints(SPOILT)),
        f"{ARM}: the target of 'joint5' is nan",
    ),
    "port, too few": (
        lambda s, r: set_attribute(r, "jnt_pos_cmd", [0.0] * 6),
        f"{ARM}: expected 7 joint values, got 6",
    ),
    "port, NaN": (
        lambda s, r: set_attribute(r, "jnt_pos_cmd", SPOILT),
        f"{ARM}: the target of 'joint5' is nan",
    ),
    "teleport": (
        lambda s, r: r.set_joint_pos(SPOILT),
        f"{ARM}: joint 'joint5' cannot be set to nan",
    ),
    "group, positions": (
        lambda s, r: set_attribute(r.arm, "joint_pos", SPOILT),
        f"{ARM}: joint 'joint5' cannot be set to nan",
    ),
    "group, velocities": (
        lambda s, r: set_attribute(r.arm, "joint_vel", [1.0]),
        f"{ARM}: expected 7 joint velocity values, got 1",
    ),
    "group, controls": (
        lambda s, r: set_attribute(r.arm, "ctrl", SPOILT),
        f"{ARM}: actuator 'servo5' cannot be set to nan",
    ),
    "port, matrix": (
        lambda s, r: set_attribute(r, "jnt_pos_cmd", np.zeros((1, 7))),
        r"jnt_pos_cmd must be a row of numbers, got an array of shape \(1, 7\)",
    ),
    "gripper": (
        lambda s, r: set_attribute(r.gripper, "opening", NAN),
        f"{GRIPPER}: opening cannot be nan; it goes from 0 \\(closed\\) to 1 \\(open\\)",
    ),
    "scene, control": (
        lambda s, r: s.set_actuator_ctrl("servo5", NAN),
        "control of actuator 'servo5' must be a finite number, got nan",
    ),
    "scene, state": (
        lambda s, r: s.set_state([s.time(), NAN, *s.state()[2:]]),
        "number 1 of the state is nan: the position of joint 'joint1'; all of a state is finite",
    ),
    "scene, wrench": (
        lambda s, r: s.set_body_wrench("link3", [0, NAN, 0], [0, 0, 0]),
        "force on body 'link3' must be a finite number, got nan",
    ),
}


@pytest.mark.parametrize("how", WRONG)
def test_rejects_an_invalid_command_by_name_without_a_change(scene: rc.Scene, how: str):
    command, message = WRONG[how]
    robot = scene.robot("a")
    controls, target, state = robot.arm.ctrl, robot.jnt_pos_cmd.copy(), scene.state()
    with pytest.raises(rc.ArgumentError, match=message):
        command(scene, robot)
    np.testing.assert_array_equal(robot.arm.ctrl, controls)
    np.testing.assert_array_equal(robot.jnt_pos_cmd, target)
    np.testing.assert_array_equal(scene.state(), state)
    robot.update()
    assert scene.step_n(2)


def test_rejects_nan_in_a_port_at_use(scene: rc.Scene):
    robot = scene.robot("a")
    good = robot.jnt_pos_cmd.copy()
    robot.jnt_pos_cmd[4] = NAN
    controls = robot.arm.ctrl
    with pytest.raises(
        rc.ArgumentError, match=f"{ARM}: the target of 'joint5' is nan; targets must be finite"
    ):
        robot.update()
    np.testing.assert_array_equal(robot.arm.ctrl, controls)
    robot.jnt_pos_cmd = good
    robot.update()
    assert scene.step_n(2)


def test_rejects_strings_as_numbers(scene: rc.Scene):
    with pytest.raises((rc.ArgumentError, TypeError), match="joints"):
        rc.control.GroupCommand.joints(["left"])
    with pytest.raises(rc.NotFoundError, match=r"no group 'am'.*Did you mean 'arm'"):
        advance(scene, scene.robot("a"), am=rc.control.GroupCommand.joints(HOME))
