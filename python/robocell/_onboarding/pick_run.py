"""A run file for a robot that was just brought in: a few picks beside a table."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from robocell import Error, RunConfig, _core
from robocell._onboarding.robot_guess import RobotGuess
from robocell._onboarding.yaml_text import flow, quoted
from robocell.diagnose import check_run
from robocell.tasks import default_object_kinds, object_kinds

# Heights of the base are tried in steps; one this near to the usual one is that, m.
SAME_HEIGHT = 0.08
# The usual distances count if at least this share of them is in reach; else the inner part of those
# that are.
LEAST_SHARE = 0.5
INNER = (0.35, 0.75)
CANNOT_HOLD = r"cannot hold '([^']+)' \((.+?)\): such starts"


def can_pick(guess: RobotGuess) -> bool:
    """Returns True if the robot can do pick tasks: it has an arm, a gripper, a placeable base."""
    return bool(guess.of_kind("arm")) and bool(guess.of_kind("gripper"))


@dataclass(frozen=True)
class Held:
    """Which kinds of objects fit a gripper.

    Attributes:
        kinds: The kinds for the run; none if all of the usual ones fit, or none of the catalogue.
        why_none: Why no kind of the catalogue fits; "" otherwise.
    """

    kinds: tuple[str, ...] = ()
    why_none: str = ""


def objects_held(guess: RobotGuess, robot_file: Path, run_file: Path) -> Held:
    """Returns the kinds of objects that fit the gripper: the usual ones, else any of the catalogue.

    Args:
        guess: The robot.
        robot_file: Its file.
        run_file: The run file that `run_text` made for all kinds, which is written anew to try
            others.
    """
    usual = default_object_kinds()
    refused = _refused(run_file)
    if not refused:
        return Held()
    if held := [kind for kind in usual if kind not in refused]:
        return Held(tuple(held))
    none = Held(why_none=next(iter(refused.values())))
    others = [kind for kind in object_kinds() if kind not in usual]
    if not others:
        return none
    _core.atomic_write(run_file, run_text(guess, robot_file, others).encode())
    refused = _refused(run_file)
    held = [kind for kind in others if refused is not None and kind not in refused]
    return Held(tuple(held)) if held else none


def _refused(run_file: Path) -> dict[str, str] | None:
    """Returns the kinds of a run that the gripper cannot hold, with the reason.

    None if the run cannot be checked.
    """
    config = RunConfig.load(run_file)
    config.cameras.streams = []
    try:
        doubts = check_run(config, on_this_machine=False)
    except Error:
        return None  # the commands that run it explain it
    return {kind: why for doubt in doubts for kind, why in re.findall(CANNOT_HOLD, doubt.text)}


@dataclass(frozen=True)
class Stand:
    """Where the base stands from the object that is picked, m."""

    near: float
    far: float
    height_offset: float


def usual_stand(guess: RobotGuess) -> Stand:
    """Returns where arms of this reach stand, with the base on the floor."""
    height = guess.base.value.get("size", [0, 0, 0])[2]
    return Stand(round(0.3 * guess.reach, 2), round(0.55 * guess.reach, 2), -height)


def stand_in_reach(guess: RobotGuess, run_file: Path) -> Stand:
    """Returns the part of the usual stand from which grasps from above are in reach.

    Args:
        guess: The robot.
        run_file: The run file that `run_text` made for the usual stand.
    """
    usual = usual_stand(guess)
    try:
        found = _core.stand_in_reach(RunConfig.load(run_file))
    except Error:
        return usual  # the commands that run it explain it
    if found is None:
        return usual
    height, nearest, farthest = found
    if abs(height - usual.height_offset) <= SAME_HEIGHT:
        height = usual.height_offset
    near, far = max(usual.near, nearest), min(usual.far, farthest)
    if far - near < LEAST_SHARE * (usual.far - usual.near):
        near, far = (nearest + share * (farthest - nearest) for share in INNER)
    return Stand(round(near, 2), round(far, 2), round(height, 3))


def run_text(
    guess: RobotGuess,
    robot_file: Path,
    objects: list[str] | None = None,
    stand: Stand | None = None,
) -> str:
    """Returns the run file, beside the robot file; with some kinds of `objects`, else all."""
    name = robot_file.stem
    at = stand or usual_stand(guess)
    streams = [{"name": name, "camera": camera} for name, camera in guess.streams]
    task = {"kind": "pick", **({"objects": objects} if objects else {})}
    cameras = {"resolution": [320, 240], "streams": streams}
    return "\n".join(
        [
            f"# Picks with '{guess.name}' beside a table: robocell generate {name}_pick.yaml",
            f"run: {quoted(name + '_pick')}",
            f"robot: {quoted(robot_file.name)}",
            f"task: {flow(task)}",
            f"start: {{base_distance: [{at.near:g}, {at.far:g}], "
            f"base_height_offset: {at.height_offset + 0.0:g}}}",
            "scenes: {source: tabletop}",
            "episodes: 10",
            f"cameras: {flow(cameras)}",
            "seed: 0",
            f"output: {quoted('out/' + name + '_pick')}",
            "",
        ]
    )
