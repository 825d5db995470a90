"""What may be wrong with a robot although its file is valid: found by trying it in simulation.

Each check returns texts that name the thing, the numbers and the next step. The scene is used up:
it is left in some state.
"""

from __future__ import annotations

from collections.abc import Callable

from robocell import try_robot
from robocell.cli.robot_scene import RobotScene


def compiler_warnings(loaded: RobotScene) -> list[str]:
    """What was found while the scene was compiled."""
    return list(loaded.scene.warnings)


def trial(loaded: RobotScene) -> list[str]:
    """What touches at home, and whether the arm holds home and follows a small step."""
    return try_robot(loaded.robot)


def idle_actuators(loaded: RobotScene) -> list[str]:
    """Actuators that belong to no group: nothing will ever command them."""
    model, robot = loaded.scene.model, loaded.robot
    every = [model.actuator(i).name for i in range(model.nu)]
    groups = [robot.group(name) for name in robot.group_names]
    used = {name for group in groups for name in group.actuator_names}
    # The motors and velocity servos that were added for the controllers of its file.
    for mode in loaded.config.used_modes():
        used |= {f"{joint}_{mode.name.lower()}" for g in groups for joint in g.joint_names}
    idle = [name or f"#{i}" for i, name in enumerate(every) if name not in used]
    if not idle:
        return []
    return [f"no move group has the actuators {', '.join(idle)}: nothing will command them"]


CHECKS: tuple[Callable[[RobotScene], list[str]], ...] = (
    compiler_warnings,
    trial,
    idle_actuators,
)
