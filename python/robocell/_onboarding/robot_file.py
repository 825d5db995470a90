"""The text of a robot file, with the reason for every guess as a comment above it."""

from __future__ import annotations

import os
from pathlib import Path

from robocell import __version__
from robocell._onboarding.robot_guess import Field, RobotGuess
from robocell._onboarding.yaml_text import comment, flow, quoted


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
        lines += comment("the model's file puts the robot elsewhere; here it stands on its box")
        lines += ["reset_root_pose: true"]
    lines += _list("edits", guess.edits)
    lines += _groups(guess)
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


def _groups(guess: RobotGuess) -> list[str]:
    if not guess.groups:
        return []
    lines = ["move_groups:"]
    for group in guess.groups:
        lines += comment(group.comment, "  ")
        lines.append(f"  {group.name}: {flow(group.fields)}")
    return lines


def _model_name(guess: RobotGuess, file: Path) -> str:
    """Returns the path relative to the robot file if the model is near; else the whole path."""
    path = guess.source.path
    folder = file.absolute().parent
    relative = os.path.relpath(path, folder)
    return relative if relative.count("..") <= 2 else str(path)


def _shown(path: Path, file: Path) -> str:
    relative = os.path.relpath(path, file.absolute().parent)
    return relative if relative.count("..") <= 2 else path.name
