"""What may be wrong with a robot although its file is valid: found by trying it in simulation.

Each check returns texts that name the thing, the numbers and the next step. The scene is used up:
it is left in some state.
"""

from __future__ import annotations

from collections.abc import Callable

from robocell import MoveGroupKind, try_robot
from robocell.cli.robot_scene import RobotScene


def compiler_warnings(loaded: RobotScene) -> list[str]:
    """What was found while the scene was compiled."""
    return list(loaded.scene.warnings)


def trial(loaded: RobotScene) -> list[str]:
    """What touches at home, whether the arm holds home and follows a step, and idle actuators."""
    return try_robot(loaded.robot, beside_warnings=True)


def gripper_elsewhere(loaded: RobotScene) -> list[str]:
    """The first arm and the first gripper are used together; does the one carry the other?"""
    grippers = _names(loaded, MoveGroupKind.GRIPPER)
    if not grippers or not loaded.robot.group(grippers[0]).joint_names:
        return []
    model, arm = loaded.scene.model, loaded.robot.arm
    wrist = model.joint(arm.joint_names[-1]).bodyid[0]
    body = model.joint(loaded.robot.group(grippers[0]).joint_names[0]).bodyid[0]
    while body not in (wrist, 0):
        body = model.body_parentid[body]
    if body == wrist:
        return []
    return [
        f"move_groups: the first arm, '{arm.name}', does not carry the first gripper, "
        f"'{grippers[0]}', and these are used together by environments and pick tasks. Put the "
        "gripper of the first arm before other grippers"
    ]


def several_of_a_kind(loaded: RobotScene) -> list[str]:
    """Good to know: which arm and gripper are meant where one of each is used."""
    notes = []
    for kind, what in ((MoveGroupKind.ARM, "arm"), (MoveGroupKind.GRIPPER, "gripper")):
        first, *others = _names(loaded, kind) or [""]
        if others:
            known = ", ".join([first, *others])
            notes.append(
                f"move_groups has {len(others) + 1} of kind {what}: {known}. Environments and pick "
                f"tasks use the first, '{first}', and hold the others still; robot.group(name) has "
                "each of them"
            )
    return notes


def _names(loaded: RobotScene, kind: MoveGroupKind) -> list[str]:
    """Groups of a kind, in the order of the file."""
    return [name for name, group in loaded.config.move_groups.items() if group.kind == kind]


CHECKS: tuple[Callable[[RobotScene], list[str]], ...] = (
    compiler_warnings,
    gripper_elsewhere,
    trial,
)
