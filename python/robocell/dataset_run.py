"""The run that a dataset was made by, from the dataset alone."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    Dataset,
    RunConfig,
    SpecError,
    changed_code,
    recorded_scene,
)


def run_of_dataset(source: str | Path) -> RunConfig:
    """The cell of a dataset: robot, task, scenes, rates and cameras, with the models that it keeps.

    Nothing is imported: a task of a user's own has to be registered before. SpecError when its code
    is not what the dataset was made with.
    """
    folder = Path(source)
    dataset = Dataset(folder)
    if not len(dataset):
        raise ArgumentError(f"'{folder}' has no episode, so nothing says what its cell is")
    first = dataset[0]
    metadata: Any = first.metadata
    if "identity" not in metadata:
        what = "an environment" if "environment" in metadata else "something else"
        raise ArgumentError(
            f"'{folder}' was recorded from {what}, not made by a run, so there is no run to go on "
            "with; robocell.envs.from_dataset makes the environment of a recorded one"
        )
    run = _run_of_text(str(metadata["identity"]), str(folder))
    config = recorded_scene(first).robots[0].config
    if config is None:
        raise ArgumentError(f"'{folder}': the scene of '{first.id}' has no robot configuration")
    run.robot = config
    if changed := changed_code(str(folder), run):
        raise SpecError(
            f"'{folder}' was made with other code: {', '.join(changed)} changed since then, so "
            "that the task may be another one. Bring the code back, or make the dataset anew"
        )
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
        said = re.sub(rf"{re.escape(dataset)}:\d+:\d+: ", "", str(error))
        said = re.sub(rf"^{re.escape(dataset)} is not valid(: |, )", "", said)
        raise SpecError(f"the run that made '{dataset}': {said}") from error
