"""A run file for a robot that was just brought in: a few picks beside a table."""

from __future__ import annotations

from pathlib import Path

from robocell._onboarding.robot_guess import RobotGuess
from robocell._onboarding.yaml_text import flow, quoted


def can_pick(guess: RobotGuess) -> bool:
    """Returns True if the robot can do pick tasks: it has an arm, a gripper, a placeable base."""
    return bool(guess.of_kind("arm")) and bool(guess.of_kind("gripper"))


def run_text(guess: RobotGuess, robot_file: Path) -> str:
    """Returns the run file, beside the robot file."""
    name = robot_file.stem
    near, far = round(0.3 * guess.reach, 2), round(0.55 * guess.reach, 2)
    height = guess.base.value.get("size", [0, 0, 0])[2]
    streams = [{"name": name, "camera": camera} for name, camera in guess.streams]
    cameras = {"resolution": [320, 240], "streams": streams}
    return "\n".join(
        [
            f"# Picks with '{guess.name}' beside a table: robocell generate {name}_pick.yaml",
            f"run: {quoted(name + '_pick')}",
            f"robot: {quoted(robot_file.name)}",
            "task: {kind: pick}",
            f"start: {{base_distance: [{near:g}, {far:g}], base_height_offset: {-height:g}}}",
            "scenes: {source: tabletop}",
            "episodes: 10",
            f"cameras: {flow(cameras)}",
            "seed: 0",
            f"output: {quoted('out/' + name + '_pick')}",
            "",
        ]
    )
