"""The text of a robot file, with the reason for every guess as a comment above it."""

from __future__ import annotations

import os
from pathlib import Path

from robocell import __version__, menagerie
from robocell._onboarding.robot_guess import Field, RobotGuess
from robocell._onboarding.yaml_text import Raw, comment, flow, quoted


def robot_text(guess: RobotGuess, file: Path) -> str:
    """Returns the robot file, as it is written to `file`: the model is named from there."""
    model = _model_name(guess, file)
    lines = comment(
        f"Written by `robocell init {_shown(guess.original, file)}` (robocell {__version__}). The "
        "comment above a line says why it is so, and how sure that is."
    )
    lines += [f"name: {quoted(guess.name)}"]
    if guess.prepared:
        lines += comment(f"Made from {_shown(guess.original, file)}: {'; '.join(guess.prepared)}")
    lines += [f"model: {quoted(model)}"]
    for note in guess.notes:
        lines += comment(f"NOTE: {note}")
    lines += _section("root_body", guess.root_body)
    lines += _section("base", guess.base)
    if guess.reset_root_pose:
        lines += comment(
            "the model's file puts the robot elsewhere; here it stands on its box or on the floor"
        )
        lines += ["reset_root_pose: true"]
    lines += _list("edits", guess.edits)
    lines += _groups(guess)
    if not guess.of_kind("gripper"):
        lines += _mounting(guess.tool_places)
    if guess.home:
        lines += comment(f"rad and m: {guess.home_comment}")
        lines += [f"home: {flow(guess.home)}"]
        noise = {
            group.name: guess.home_noise[group.name]
            for group in guess.groups
            if group.name in guess.home_noise and group.kind in ("arm", "gripper")
        }
        if noise:
            lines += comment("starts vary by this much, rad and m")
            lines += [f"home_noise: {flow(noise)}"]
    if any(value != "joint_position" for value in guess.control.values()):
        lines += comment("by the kind of the arm's actuators [sure]")
        lines += [f"control: {flow(guess.control)}"]
    if guess.camera_note:
        lines += comment(guess.camera_note)
    lines += _list("cameras", guess.cameras)
    if guess.gravcomp:
        lines += _section("gravcomp", guess.gravcomp)
    return "\n".join(lines) + "\n"


def _section(name: str, field: Field) -> list[str]:
    return [*comment(field.comment), f"{name}: {flow(field.value)}"]


def _list(name: str, fields: list[Field]) -> list[str]:
    if not fields:
        return []
    lines = [f"{name}:"]
    for field in fields:
        if field.comment:
            lines += comment(field.comment, "  ")
        lines.append(f"  - {flow(field.value)}")
    return lines


def _mounting(places: list[dict[str, str]]) -> list[str]:
    """Returns comments with the lines that mount a hand at each place."""
    if not places:
        return []
    hands = [{"mjcf_path": Raw("HAND.xml"), "attach_to": place} for place in places]
    prefixes = ["hand_"] if len(hands) == 1 else [f"hand{i}_" for i in range(1, len(hands) + 1)]
    return [
        *comment(
            "No hand was found. To mount one, write these lines with its model, and a group of "
            "`kind: gripper` with its joints, actuators and fingers:"
        ),
        "# attachments:",
        *(
            f"#   - {flow({**hand, 'prefix': prefix})}"
            for hand, prefix in zip(hands, prefixes, strict=True)
        ),
    ]


def _groups(guess: RobotGuess) -> list[str]:
    if not guess.groups:
        return []
    lines = ["move_groups:"]
    for group in guess.groups:
        lines += comment(group.comment, "  ")
        lines.append(f"  {group.name}: {flow(group.fields)}")
    return lines


def _model_name(guess: RobotGuess, file: Path) -> str:
    """Returns the `menagerie:` name, or the path relative to the robot file if the model is near.

    Else it is the whole path.
    """
    return _short(guess.source.path, file) or str(guess.source.path)


def _shown(path: Path, file: Path) -> str:
    return _short(path, file) or path.name


def _short(path: Path, file: Path) -> str:
    """Returns the `menagerie:` name or a relative path; "" for a file that is far away."""
    for robot, folder in menagerie.folders().items():
        if path.is_relative_to(folder):
            return f"menagerie:{robot}/{path.relative_to(folder)}"
    relative = os.path.relpath(path, file.absolute().parent)
    return relative if relative.count("..") <= 2 else ""
