"""`robocell gripper-range`: how far a robot's grippers open and close."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import Robot
from robocell._cli.common import fail
from robocell._cli.robot_scene import load_robot
from robocell.robots import GripperGroup


def gripper_range(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
) -> None:
    """Print the distance between each gripper's fingers, closed and open, in metres."""
    robot = load_robot(robot_file, needs_arm=False).robot
    lines = range_lines(robot)
    if not lines:
        kinds = ", ".join(f"{name} ({robot.group(name).kind})" for name in robot.group_names)
        fail(
            f"robot '{robot.name}' has no gripper. Its move groups: {kinds}. "
            f"A gripper is a group with `kind: gripper` in {robot_file}"
        )
    print("Gripper finger ranges:")
    print("\n".join(lines))


def range_lines(robot: Robot) -> list[str]:
    """Returns a line for each gripper: "    Gripper 'gripper': 0.004 - 0.089"."""
    lines = []
    for name in robot.group_names:
        group = robot.group(name)
        if isinstance(group, GripperGroup):
            closed, opened = group.inter_finger_dist_range
            lines.append(f"    Gripper '{name}': {closed:.3f} - {opened:.3f}")
    return lines
