"""What may be wrong with a robot although its file is valid: found by trying it in simulation.

Each check returns texts that name the thing, the numbers and the next step. The scene is used up:
it is left in some state.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robocell.cli.robot_scene import TIMESTEP_S, RobotScene

HOLD_S = 1.0


def compiler_warnings(loaded: RobotScene) -> list[str]:
    """What was found while the scene was compiled."""
    return list(loaded.scene.warnings)


def contacts_at_home(loaded: RobotScene) -> list[str]:
    """Parts that touch each other, or the floor, before anything has moved."""
    loaded.scene.reset()
    pairs = sorted({tuple(sorted((c.body1, c.body2))) for c in loaded.scene.contacts()})
    return [
        f"'{a}' and '{b}' touch at home: exclude the pair in the model or choose another `home`"
        for a, b in pairs
    ]


def hold(loaded: RobotScene) -> list[str]:
    """Does the arm stay at home when its controller holds it there?"""
    scene, robot = loaded.scene, loaded.robot
    if not robot.is_driven(robot.arm.name):
        return []  # told as an error
    scene.reset()
    before = np.array(robot.arm.joint_pos)
    for _ in range(round(HOLD_S / TIMESTEP_S)):
        robot.update()
        result = scene.step()
        if not result:
            return [f"the simulation diverges while the arm holds still: {result.message}"]
    drift = np.abs(np.array(robot.arm.joint_pos) - before)
    worst = int(np.argmax(drift))
    if drift[worst] <= loaded.config.arrival_tolerance:
        return []
    return [
        f"joint '{robot.joint_names[worst]}' drifts by {drift[worst]:.3g} in {HOLD_S:g} s while it "
        f"should hold home (arrival_tolerance is {loaded.config.arrival_tolerance:g}): set "
        "`gravcomp: true` or a higher `stiffness`"
    ]


def idle_actuators(loaded: RobotScene) -> list[str]:
    """Actuators that belong to no group: nothing will ever command them."""
    model, robot = loaded.scene.model, loaded.robot
    every = [model.actuator(i).name for i in range(model.nu)]
    used = {name for group in robot.group_names for name in robot.group(group).actuator_names}
    idle = [name or f"#{i}" for i, name in enumerate(every) if name not in used]
    if not idle:
        return []
    return [f"no move group has the actuators {', '.join(idle)}: nothing will command them"]


CHECKS: tuple[Callable[[RobotScene], list[str]], ...] = (
    compiler_warnings,
    contacts_at_home,
    hold,
    idle_actuators,
)
