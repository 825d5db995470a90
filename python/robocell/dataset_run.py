"""The run that a dataset was made by, from the dataset alone."""

from __future__ import annotations

import json
import os
import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    Dataset,
    IoError,
    RunConfig,
    SpecError,
    changed_code,
    feature_names,
    json_damage,
    recorded_scene,
)

# The remedy in the message about an unregistered kind, and the one for the run of a dataset.
OWN_KIND = re.compile(r"of your own is registered before: .*")
OWN_FEATURE = re.compile(r"no feature '")
BY_NAME = (
    "of your own is in a module, and a dataset imports none by itself: name it with --import "
    "my_tasks.py on the command line, or with imports=['my_tasks.py'] in Python"
)


def plan_numbers(ids: Sequence[str]) -> list[tuple[int, int]]:
    """Returns scene and episode of each id, such as (3, 1) of 's0003_e0001'."""
    found = (re.match(r"s(\d+)_e(\d+)", name) for name in ids)
    return [(int(match[1]), int(match[2])) for match in found if match]


def houses_of_dataset(dataset: Dataset) -> list[int]:
    """Returns `scenes.houses` of the run that made a dataset; empty for all of its scenes.

    The report has them as the last command was given them. Without one, and for scenes of earlier
    commands, the episodes say which there are.
    """
    seen = list(dict.fromkeys(scene for scene, _ in plan_numbers(dataset.ids)))
    recorded = _recorded_houses(Path(dataset.folder))
    if recorded is None:
        return seen
    return recorded and [*recorded, *(scene for scene in seen if scene not in recorded)]


def _recorded_houses(folder: Path) -> list[int] | None:
    """Returns what the report says, of several that whose command ended last; None if none does."""
    from robocell.generate.report import DamagedReportError, RunReport, load, report_paths

    reports: list[RunReport] = []
    for path in report_paths(folder):
        try:
            reports.append(load(path))
        except (OSError, DamagedReportError):
            continue
    known = [report for report in reports if report.houses is not None and report.commands]
    return max(known, key=lambda report: report.commands[-1].finished).houses if known else None


def manifest_of_dataset(source: str | Path) -> dict[str, Any] | None:
    """Returns the content of dataset.json, checked against its hash; None when there is none.

    IoError when it is damaged or cannot be read.
    """
    folder = Path(source)
    path = folder / "dataset.json"
    if not os.path.lexists(path):
        return None
    if not path.is_file():
        raise IoError(f"'{path}' is not a file")
    try:
        text = path.read_bytes().decode()
        damage = json_damage(text)
        manifest = None if damage else json.loads(text)
    except OSError as error:
        raise IoError(f"cannot read '{path}': {error.strerror}") from error
    except ValueError as error:
        damage = str(error)
    if damage or not isinstance(manifest, dict):
        remedy = shlex.join(["robocell", "verify", "--repair", str(folder)])
        raise IoError(
            f"'{path}' is damaged: {damage or 'it is no JSON object'}. `{remedy}` sets it aside, "
            "`robocell generate` with the run's file writes it again"
        )
    return manifest


def run_metadata(dataset: Dataset) -> dict[str, Any]:
    """Returns what a run noted in its first episode: its seed and its own text, `identity`.

    ArgumentError for a dataset without an episode, and for one that no run made.
    """
    folder = dataset.folder
    if not len(dataset):
        raise ArgumentError(f"'{folder}' has no episode, so nothing says what its cell is")
    metadata: Any = dataset[0].metadata
    if "identity" not in metadata:
        what = "an environment" if "environment" in metadata else "something else"
        raise ArgumentError(
            f"'{folder}' was recorded from {what}, not made by a run, so there is no run to go on "
            "with; robocell.envs.from_dataset makes the environment of a recorded one"
        )
    return metadata


def run_of_dataset(source: str | Path) -> RunConfig:
    """The cell of a dataset: robot, task, scenes, rates and cameras, with the models that it keeps.

    Nothing is imported: a task of a user's own has to be registered before. SpecError when its code
    is not what the dataset was made with.
    """
    folder = Path(source)
    dataset = Dataset(folder)
    metadata = run_metadata(dataset)
    first = dataset[0]
    run = _run_of_text(str(metadata["identity"]), str(folder))
    config = recorded_scene(first).robots[0].config
    if config is None:
        raise ArgumentError(f"'{folder}': the scene of '{first.id}' has no robot configuration")
    run.robot = config
    known = feature_names()
    if unknown := [name for name in run.features if name not in known]:
        names = ", ".join(f"'{name}'" for name in unknown)
        raise SpecError(
            f"the run that made '{folder}': features: no registered feature {names}. "
            f"A feature {BY_NAME}"
        )
    if changed := changed_code(str(folder), run):
        raise SpecError(
            f"'{folder}' was made with other code: {', '.join(changed)} changed since then, so "
            "that the task may be another one. Bring the code back, or make the dataset anew"
        )
    run.scenes.houses = houses_of_dataset(dataset)
    # Scenes that are files: as the dataset keeps them, which need not be here any more.
    files = list(run.scenes.files) if run.scenes.source == "files" else []
    missing = set(range(len(files)))
    for index in range(len(dataset)):
        if not missing:
            break
        episode = dataset[index]
        scene = int(episode.metadata["scene"])  # type: ignore[index]
        if scene in missing and (base := recorded_scene(episode).base):
            files[scene] = base
            missing.discard(scene)
    if files:
        run.scenes.files = files
    return run


def _run_of_text(text: str, dataset: str) -> RunConfig:
    """The run in the metadata of an episode, whose lines and columns nobody can look up."""
    try:
        return RunConfig.from_yaml(text, dataset, overrides=['output="unset"'])
    except SpecError as error:
        said = OWN_KIND.sub(BY_NAME, _without_places(error, dataset))
        raise SpecError(f"the run that made '{dataset}': {said}") from error


def unregistered_kinds(error: Exception, source: str) -> str:
    """Returns what an error says of kinds and features that nobody registered; "" without any.

    `source` names the text that was read, in which nobody can look up a line.
    """
    said = _without_places(error, source)
    if OWN_FEATURE.match(said):
        return f"{said} A feature {BY_NAME}"
    lines = [OWN_KIND.subn(BY_NAME, line) for line in said.splitlines()]
    return "; ".join(line.strip() for line, count in lines if count)


def _without_places(error: Exception, source: str) -> str:
    """Returns the text of an error without lines and columns of `source`."""
    said = re.sub(rf"{re.escape(source)}:\d+:\d+: ", "", str(error))
    return re.sub(rf"^{re.escape(source)} is not valid(: |, )", "", said)
