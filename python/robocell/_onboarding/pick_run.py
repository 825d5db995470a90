"""A run file for a robot that was just brought in: a few picks beside a table."""

from __future__ import annotations

import re
from pathlib import Path

from robocell import Error, RunConfig
from robocell._onboarding.robot_guess import RobotGuess
from robocell._onboarding.yaml_text import flow, quoted
from robocell.diagnose import check_run
from robocell.tasks import default_object_kinds

CANNOT_HOLD = r"cannot hold '([^']+)'"


def can_pick(guess: RobotGuess) -> bool:
    """Returns True if the robot can do pick tasks: it has an arm, a gripper, a placeable base."""
    return bool(guess.of_kind("arm")) and bool(guess.of_kind("gripper"))


def is_suction(guess: RobotGuess) -> bool:
    """Returns True if the gripper is a suction cup, to which many objects do not stick."""
    return any("fingers" not in group.fields for group in guess.of_kind("gripper"))


def objects_held(run_file: Path) -> list[str]:
    """Returns the kinds of objects that fit the gripper; none if all of them do.

    Args:
        run_file: The run file that `run_text` made for all kinds.
    """
    config = RunConfig.load(run_file)
    config.cameras.streams = []
    try:
        doubts = check_run(config, on_this_machine=False)
    except Error:
        return []  # the commands that run it explain it
    refused = {kind for doubt in doubts for kind in re.findall(CANNOT_HOLD, doubt.text)}
    held = [kind for kind in default_object_kinds() if kind not in refused]
    return held if refused else []


def run_text(guess: RobotGuess, robot_file: Path, objects: list[str] | None = None) -> str:
    """Returns the run file, beside the robot file; with some kinds of `objects`, else all."""
    name = robot_file.stem
    near, far = round(0.3 * guess.reach, 2), round(0.55 * guess.reach, 2)
    height = guess.base.value.get("size", [0, 0, 0])[2]
    streams = [{"name": name, "camera": camera} for name, camera in guess.streams]
    task = {"kind": "pick", **({"objects": objects} if objects else {})}
    cameras = {"resolution": [320, 240], "streams": streams}
    return "\n".join(
        [
            f"# Picks with '{guess.name}' beside a table: robocell generate {name}_pick.yaml",
            f"run: {quoted(name + '_pick')}",
            f"robot: {quoted(robot_file.name)}",
            f"task: {flow(task)}",
            f"start: {{base_distance: [{near:g}, {far:g}], base_height_offset: {-height:g}}}",
            "scenes: {source: tabletop}",
            "episodes: 10",
            f"cameras: {flow(cameras)}",
            "seed: 0",
            f"output: {quoted('out/' + name + '_pick')}",
            "",
        ]
    )
