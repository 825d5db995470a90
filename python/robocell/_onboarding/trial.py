"""Loads a guessed robot file as every command does, tries the robot out, and fixes what it can.

Edits from findings of `robocell check` are added to the file, with the finding as the reason. A
gripper that robocell cannot load or measure becomes a generic group, and so does an arm whose
joints act together in a way that robocell cannot use; the reason is noted.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from robocell import Error, Robot, RobotConfig, RobotSpec, Scene, SceneSpec
from robocell._onboarding.robot_file import robot_text
from robocell._onboarding.robot_guess import Field, RobotGuess
from robocell._onboarding.yaml_text import Raw
from robocell.diagnose import Severity, check_robot
from robocell.robots import GripperGroup

ROUNDS = 8  # each mends one thing, or several that are independent
TIMESTEP_S = 0.002
# Edits of a note about joints whose model leaves out the inertia of the motors.
ARMATURES = r"edits: \[((?:(?:, )?\{joint: '[^']*', armature: [-+.e\d]+\})+)\]"


# Edits that a finding ends with, each of one number of a joint or its actuator.
NUMBERS = r"\(edits: \[((?:(?:, )?\{(?:joint|actuator): '[^']*', \w+: [-+.e\d]+\})+)\]\)"

# Parts that move end at least this high above the box of the base, m.
CLEAR_M = 0.01
TOUCHES_BOX = r"'mocap_base' and '|' and 'mocap_base' touch at home"


@dataclass(frozen=True)
class Trial:
    """Result of a trial.

    Attributes:
        text: The robot file.
        problem: Reason why it does not load; "" if it does.
    """

    text: str
    problem: str = ""


def tried(guess: RobotGuess, file: Path) -> Trial:
    """Loads and fixes the robot file of a guess; `file` is its later path.

    Nothing stays behind: the text is loaded from a file of another name beside it.
    """
    problem = ""
    for _ in range(ROUNDS):
        text = robot_text(guess, file)
        with _beside(file, text) as candidate:
            try:
                robot = _load(candidate)
                _measure(robot)
                problem = ""
            except Error as error:
                problem = str(error).replace(str(candidate), str(file))
                problem = problem.replace(candidate.name, file.name)
                if not _demote(guess, problem):
                    return Trial(text, problem)
                continue
            if not _take_edits(guess, robot):
                return Trial(text)
    return Trial(robot_text(guess, file), problem)


@contextmanager
def _beside(file: Path, text: str) -> Iterator[Path]:
    candidate = file.with_name(f".{file.stem}.init.yaml")
    candidate.write_text(text)
    try:
        yield candidate
    finally:
        candidate.unlink(missing_ok=True)


def _load(file: Path) -> Robot:
    config = RobotConfig.load(file)
    spec = SceneSpec(name=config.name, timestep=TIMESTEP_S, add_floor=True, add_skybox=False)
    spec.robots.append(
        RobotSpec(name=config.name, config=config, control_modes=config.used_modes())
    )
    scene = Scene.build(spec)
    scene.reset()
    return Robot.of(scene, config.name)


def _measure(robot: Robot) -> None:
    for name in robot.group_names:
        group = robot.group(name)
        if isinstance(group, GripperGroup):
            group.inter_finger_dist_range  # noqa: B018 - measures, and raises when it cannot


def _demote(guess: RobotGuess, problem: str) -> bool:
    """Turns an unusable group into one that robocell can use. Returns False for other problems."""
    for group in guess.groups:
        named = re.search(rf"move_groups\.{re.escape(group.name)}\b", problem)
        named = named or re.search(rf"group '{re.escape(group.name)}'", problem)
        if named and group.kind == "arm" and group.other_fields:
            group.fields, group.other_fields, group.kind = group.other_fields, None, "generic"
            guess.control.pop(group.name, None)
            reason = _first_sentence(problem)
            group.comment = f"no arm, as robocell cannot use it as one: {reason}"
            guess.notes.append(f"'{group.name}' cannot be commanded as an arm: {reason}")
            return True
        if named and group.kind == "gripper" and group.other_fields:
            group.fields, group.other_fields = group.other_fields, None
            group.comment += (
                "; its fingers overlap before their actuator is at the end of its range, so `ctrl` "
                "closes them no farther"
            )
            return True
        if named and group.kind == "gripper":
            group.kind = "generic"
            kept = ("joints", "actuators")
            fields = {key: value for key, value in group.fields.items() if key in kept}
            group.fields = {"kind": "generic", **fields}
            reason = _first_sentence(problem)
            group.comment = f"no gripper, as robocell cannot use it as one: {reason}"
            guess.notes.append(f"'{group.name}' is not a gripper: {reason}")
            return True
    return False


def _first_sentence(problem: str) -> str:
    line = problem.strip().splitlines()[0 if "problems:" not in problem else 1]
    return re.sub(r"^\s*\S+\.yaml:\d+:\d+: ", "", line).strip()


def _lift(guess: RobotGuess, robot: Robot) -> bool:
    """Raises a robot whose moving parts reach into the box below it. Returns False if it cannot."""
    scene = robot.scene
    scene.reset()
    model, data = scene.model, scene.data
    box = model.body("mocap_base").id
    depths = [
        -float(contact.dist)
        for contact in data.contact
        if box in (model.geom_bodyid[geom] for geom in contact.geom if geom >= 0)
    ]
    root = int(guess.source.model.body(guess.root_body.value).rootid[0])
    if not depths or max(depths) <= 0 or guess.reset_root_pose:
        return False
    name, lift = guess.source.body_name(root), max(depths) + CLEAR_M
    for field in guess.edits:
        value = field.value
        if isinstance(value, dict) and value.get("body") == name and set(value) == {"body", "pos"}:
            value["pos"][2] = round(value["pos"][2] + lift, 4)
            return True
    height = float(guess.source.model.body_pos[root][2])
    edit = {"body": name, "pos": [0, 0, round(height + lift, 4)]}
    guess.edits.append(Field(edit, "parts that move reach below the base; here they clear its box"))
    return True


def _edits_in(text: str) -> list[str]:
    """Returns the edits of numbers that a finding proposes."""
    found = re.search(NUMBERS, text)
    return re.findall(r"\{[^}]*\}", found[1]) if found else []


def _take_edits(guess: RobotGuess, robot: Robot) -> bool:
    """Adds the edits that findings name; False when there is none that is new."""
    known = {str(field.value) for field in guess.edits}
    warnings = [each for each in check_robot(robot) if each.severity is Severity.WARNING]
    touches_box = any(re.search(TOUCHES_BOX, warning.text) for warning in warnings)
    if touches_box and _lift(guess, robot):
        return True
    named = [
        (edit, finding.text)
        for finding in warnings
        for edit in ([finding.edit] if finding.edit else _edits_in(finding.text))
    ]
    # Warnings of the model itself name theirs in the text.
    for warning in robot.scene.warnings:
        if found := re.search(r"`edits: \[(.+?)\]`", warning):
            named.append((found[1], re.sub(r"^\S+:\d+(:\d+)?: ", "", warning)))
    for note in robot.scene.notes:
        change, *armatures = re.split(ARMATURES, note)[:2]
        for edit in re.findall(r"\{[^}]*\}", "".join(armatures)):
            named.append((edit, re.sub(r"^\S+:\d+(:\d+)?: ", "", change).strip()))
    before = ""
    added = False
    for edit, text in named:
        if edit in known:
            continue
        why = "" if text == before else f"`robocell check`: {text}"  # one for several edits
        guess.edits.append(Field(Raw(edit), why))
        known.add(edit)
        before, added = text, True
    return added
