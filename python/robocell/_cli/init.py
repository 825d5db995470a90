"""`robocell init`: from a model file to a robot file, every guess with its reason."""

from __future__ import annotations

import difflib
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from robocell._cli.common import (
    PACKAGE_OPTION,
    ExitCode,
    declare_packages,
    fail,
    print_warning,
    require_png,
)

if TYPE_CHECKING:
    from robocell._onboarding import Guess, RobotGuess

MENAGERIE = "menagerie:"
MODELS = ("*.xml", "*.urdf")
# Files that are called after what they are, not after the robot in them.
GENERIC_NAMES = {"robot", "scene", "model", "main", "arm", "index"}


def init(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="The robot's MJCF or URDF, or a scene that contains the robot: a path, or "
            "menagerie:ROBOT/FILE.xml.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The robot file. Default: the model's name."),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Draw the robot with its frames into this PNG.")
    ] = None,
    interactive: Annotated[
        bool, typer.Option("--interactive", help="Ask where there is more than one answer.")
    ] = False,
    package: Annotated[list[str] | None, PACKAGE_OPTION] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite existing files.")] = False,
) -> None:
    """Write a robot file for a model and check it.

    Guesses base, arms, hands, TCP, home, cameras and control from the model. The file states the
    reason and the confidence of each guess. A modified copy of an MJCF without servos or of two
    arms is written beside the robot file, as NAME_model.xml. Exit code 1 if the result does not
    load.
    """
    # With MuJoCo and numpy, which take longer to load than all that the other commands need.
    from robocell import _core
    from robocell._onboarding import (
        can_pick,
        detect,
        model_text,
        objects_held,
        run_text,
        stand_in_reach,
        tried,
    )

    if picture:
        require_png(picture)
    declare_packages(package)
    model = _model_file(model)
    file = output or Path(f"{_name_of(model)}.yaml")
    files = {
        "robot": file,
        "model": file.with_name(f"{file.stem}_model.xml"),
        "run": file.with_name(f"{file.stem}_pick.yaml"),
    }
    _require_new(files["robot"], force)
    guess = detect(model, files["model"], _robot_name(file), _ask if interactive else _keep)
    if guess.prepared:
        _require_new(files["model"], force)
        text = model_text(guess.source, guess.prepared, guess.original)
        _core.atomic_write(files["model"], text.encode())
        print(f"wrote {files['model']}: {'; '.join(guess.prepared)}")
    trial = tried(guess, file)
    _core.atomic_write(file, trial.text.encode())
    print(f"wrote {file}: {_summary(guess)}")
    for note in guess.notes:
        print_warning(f"{file}: {note}")
    if trial.problem:
        fail(_what_to_do(file, trial.problem), ExitCode.INCOMPLETE)
    picks = can_pick(guess)
    if picks and (force or not files["run"].exists()):
        _core.atomic_write(files["run"], run_text(guess, file).encode())
        stand = stand_in_reach(guess, files["run"])
        held = objects_held(guess, file, files["run"])
        text = run_text(guess, file, list(held.kinds), stand)
        _core.atomic_write(files["run"], text.encode())
        print(f"wrote {files['run']}: a run file, to try it")
        if held.why_none:
            print_warning(
                f"{files['run']}: no object of the catalogue fits the gripper: {held.why_none}. "
                "Add one of yours with `robocell add-object`, and name it in task.objects"
            )
    elif not picks:
        print(_no_run_file(guess, file))
    print()
    _report(file, picture)
    print(_next_steps(file, files["run"] if picks else None))


def _keep(what: str, guess: Guess[Any]) -> Guess[Any]:
    del what
    return guess


def _ask(what: str, guess: Guess[Any]) -> Guess[Any]:
    """Lets a person choose where a guess is not sure; Enter takes the guess."""
    from robocell._onboarding import Confidence, Guess

    if not guess.alternatives or guess.confidence is Confidence.HIGH:
        return guess
    options = [guess.value, *guess.alternatives]
    print(f"{what}? {guess.reason}")
    for number, option in enumerate(options, 1):
        print(f"  {number}  {option}")
    answer = 0
    while not 1 <= answer <= len(options):
        answer = typer.prompt("number", default=1, type=int)
    if answer == 1:
        return Guess(guess.value, guess.reason, Confidence.HIGH)
    return Guess(options[answer - 1], "chosen", Confidence.HIGH)


def _no_run_file(guess: RobotGuess, file: Path) -> str:
    """Returns why there is no run file, and the next step."""
    missing = [kind for kind in ("arm", "gripper") if not guess.of_kind(kind)]
    text = f"no run file: it picks, and the robot has no {' and no '.join(missing)}"
    if missing == ["gripper"] and guess.tool_places:
        text += f". Comments in {file} show how to mount a hand"
    return text


def _model_file(model: Path) -> Path:
    """Returns the file of a path or `menagerie:` name; ends the command without one."""
    if str(model).startswith(MENAGERIE):
        from robocell import _core

        return Path(_core.menagerie_model_path(str(model).removeprefix(MENAGERIE)))
    if model.is_dir():
        files = sorted(str(file) for kind in MODELS for file in model.glob(kind))
        fail(f"'{model}' is a folder; give one of its models: {', '.join(files) or 'it has none'}")
    if not model.is_file():
        near = sorted(str(file) for kind in MODELS for file in model.parent.glob(kind))
        there = f" Models there: {', '.join(near[:8])}" if near else ""
        fail(f"no model '{model}'.{there}{_menagerie_advice(model)}")
    if model.suffix in (".yaml", ".yml"):
        fail(
            f"'{model}' is YAML. Give the MJCF or URDF; `robocell check {model}` checks robot files"
        )
    return model


def _menagerie_advice(model: Path) -> str:
    """Returns the Menagerie's robot that a path without a file may mean."""
    from robocell import menagerie

    near = difflib.get_close_matches(model.parts[0] if model.parts else "", menagerie.folders(), 1)
    if near:
        named = Path(near[0], *model.parts[1:])
        return f" Did you mean '{MENAGERIE}{named}'?"
    return f" Robots of the MuJoCo Menagerie are named {MENAGERIE}ROBOT; `robocell fetch` gets them"


def _require_new(file: Path, force: bool) -> None:
    if file.is_dir():
        fail(f"'{file}' is a folder; name the robot file: -o {file / 'robot.yaml'}")
    if not file.parent.is_dir():
        fail(f"cannot write '{file}': there is no folder '{file.parent}'", ExitCode.OUTPUT)
    if file.exists() and not force:
        fail(f"'{file}' exists. Replace it with --force, or give another name with -o")


def _name_of(model: Path) -> str:
    stem = model.resolve().stem
    return model.resolve().parent.name if stem.lower() in GENERIC_NAMES else stem


def _robot_name(file: Path) -> str:
    return re.sub(r"[^A-Za-z0-9_-]", "_", file.stem) or "robot"


def _summary(guess: RobotGuess) -> str:
    """Returns 'an arm of 7 joints, a gripper'."""
    kinds = [group.kind for group in guess.groups]
    parts = [
        f"{kinds.count(kind)} {kind}{'s' if kinds.count(kind) > 1 else ''}"
        for kind in ("arm", "gripper", "generic")
        if kind in kinds
    ]
    return ", ".join(parts) or "no groups"


def _what_to_do(file: Path, problem: str) -> str:
    return (
        f"{file} does not load yet: {problem}\nChange it there, then run: robocell check {file}. "
        "The fields are described in docs/robots.md"
    )


def _report(file: Path, picture: Path | None) -> None:
    from robocell._cli.robot_report import print_report
    from robocell._cli.robot_scene import load_robot

    print_report(load_robot(file, needs_arm=False), picture, print_warning)


def _next_steps(file: Path, run: Path | None) -> str:
    steps = [f"robocell check {file}", f"robocell ik-test {file}"]
    if run:
        steps.append(f"robocell generate {run}")
    lines = "\n".join(f"  {step}" for step in steps)
    return f"\nRead the comments in {file}; where one says 'unsure', check it. Next:\n{lines}"
