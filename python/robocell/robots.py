"""Robots: their files, attachments of parts, the live robot and its move groups.

    config = robocell.RobotConfig.load(robocell.models.robot_file("rc7"))
    config.edits.append(robocell.robots.Edit(add_site="wrist", body="hand", pos=[0, 0, 0]))
    robocell.robots.robots_of(scene)  # all configured robots

docs/robots.md and docs/spec.md describe them.
"""

from robocell._core import (
    AttachKind,
    AttachmentSpec,
    AttachTarget,
    BaseConfig,
    BaseGroup,
    BaseKind,
    Edit,
    ForceTorqueSensorSpec,
    GripperCtrl,
    GripperDistance,
    GripperGroup,
    GripperJointRange,
    MoveGroup,
    MoveGroupConfig,
    MoveGroupKind,
    Robot,
    RobotConfig,
    RobotSpec,
    TaskSpaceConfig,
    TaskSpaceKind,
    ToolFrameSpec,
    expand_names,
    robots_of,
)

__all__ = [
    "AttachKind",
    "AttachTarget",
    "AttachmentSpec",
    "BaseConfig",
    "BaseGroup",
    "BaseKind",
    "Edit",
    "ForceTorqueSensorSpec",
    "GripperCtrl",
    "GripperDistance",
    "GripperGroup",
    "GripperJointRange",
    "MoveGroup",
    "MoveGroupConfig",
    "MoveGroupKind",
    "Robot",
    "RobotConfig",
    "RobotSpec",
    "TaskSpaceConfig",
    "TaskSpaceKind",
    "ToolFrameSpec",
    "expand_names",
    "robots_of",
]
