"""Controllers, commands of a robot, the clock of a control loop, and smooth motions.

    robot.ctrl_mode = robocell.control.CtrlMode.POSITION
    robot.apply({"gripper": robocell.control.GroupCommand.opening(1)})
    part = robocell.control.minimum_jerk(0.5, duration=2).position  # of the way, at 0.5 s

docs/control.md describes them.
"""

from robocell._core import (
    CartesianImpedanceController,
    CartesianPoseController,
    ControlKind,
    Controller,
    CoordinateState,
    CtrlMode,
    DifferentialIkController,
    GroupCommand,
    JointImpedanceController,
    Rates,
    StepOutcome,
    Stepper,
    joint_move_duration,
    minimum_jerk,
    minimum_jerk_duration,
    pose_move_duration,
)

__all__ = [
    "CartesianImpedanceController",
    "CartesianPoseController",
    "ControlKind",
    "Controller",
    "CoordinateState",
    "CtrlMode",
    "DifferentialIkController",
    "GroupCommand",
    "JointImpedanceController",
    "Rates",
    "StepOutcome",
    "Stepper",
    "joint_move_duration",
    "minimum_jerk",
    "minimum_jerk_duration",
    "pose_move_duration",
]
