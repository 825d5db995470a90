"""What may be wrong with a robot although its file is valid: found by trying it in simulation.

Each check returns texts that name the thing, the numbers and the next step. The scene is used up:
it is left in some state.
"""

from __future__ import annotations

from collections.abc import Callable

from robocell.cli.robot_scene import RobotScene
from robocell.diagnose import try_robot
from robocell.robots import MoveGroupKind


def compiler_warnings(loaded: RobotScene) -> list[str]:
    """What was found while the scene was compiled."""
    return list(loaded.scene.warnings)


def trial(loaded: RobotScene) -> list[str]:
    """What touches at home, whether the arm holds home and follows a step, and idle actuators."""
    return try_robot(loaded.robot, beside_warnings=True)


def gripper_elsewhere(loaded: RobotScene) -> list[str]:
    """Environments and pick tasks use the first arm; does it carry a gripper?"""
    arms = _names(loaded, MoveGroupKind.ARM)
    grippers = _names(loaded, MoveGroupKind.GRIPPER)
    if not arms or not grippers or loaded.robot.gripper_of(arms[0]):
        return []
    carried = {arm: loaded.robot.gripper_of(arm) for arm in arms[1:]}
    holders = [arm for arm, gripper in carried.items() if gripper]
    return [
        f"move_groups: the first arm, '{arms[0]}', which environments and pick tasks use, carries "
        f"no gripper: '{carried[holders[0]]}' is on '{holders[0]}'. Put the arm with the gripper "
        "before other arms"
    ]


def several_of_a_kind(loaded: RobotScene) -> list[str]:
    """Good to know: which arm and gripper are meant where one of each is used."""
    arms = _names(loaded, MoveGroupKind.ARM)
    grippers = _names(loaded, MoveGroupKind.GRIPPER)
    if not arms:
        return []
    gripper = loaded.robot.gripper_of(arms[0])
    return [
        f"move_groups has {len(names)} of kind {kind}: {', '.join(names)}. Environments and pick "
        f"tasks use {which}, '{used}', and hold the others still; robot.group(name) has each of "
        "them"
        for kind, names, which, used in (
            ("arm", arms, "the first", arms[0]),
            ("gripper", grippers, "that of the first arm", gripper),
        )
        if len(names) > 1 and used
    ]


def _names(loaded: RobotScene, kind: MoveGroupKind) -> list[str]:
    """Groups of a kind, in the order of the file."""
    return [name for name, group in loaded.config.move_groups.items() if group.kind == kind]


CHECKS: tuple[Callable[[RobotScene], list[str]], ...] = (
    compiler_warnings,
    gripper_elsewhere,
    trial,
)
