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
    """What touches at home, whether the arm holds home and follows a step, and idle actuators."""
    return try_robot(loaded.robot, beside_warnings=True)


CHECKS: tuple[Callable[[RobotScene], list[str]], ...] = (compiler_warnings, trial)
