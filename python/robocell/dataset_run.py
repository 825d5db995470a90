"""The run that a dataset, a run file or `module:name` stands for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, Dataset, RunConfig, recorded_scene
from robocell.generate.run_source import RunSource, import_module


def run_of(source: str | Path, imports: Sequence[str] = ()) -> RunConfig:
    """The run of a run file, of `module:name`, or of a dataset.

    A dataset gives its cell: robot, task, scenes, rates and cameras. Modules are imported only when
    `imports` names them, never because the dataset does.
    """
    folder = Path(source)
    if not (folder / "dataset.json").is_file():
        return RunSource(str(source), tuple(imports)).load()
    for module in imports:
        import_module(module, Path.cwd())
    dataset = Dataset(folder)
    if not len(dataset):
        raise ArgumentError(f"'{folder}' has no episode, so nothing says what its cell is")
    first = dataset[0]
    metadata: Any = first.metadata
    run = RunConfig.from_yaml(str(metadata["identity"]), str(folder), overrides=['output="unset"'])
    # With the models that the dataset keeps.
    config = recorded_scene(first).robots[0].config
    if config is None:
        raise ArgumentError(f"'{folder}': the scene of '{first.id}' has no robot configuration")
    run.robot = config
    # Scenes that are files: as the dataset keeps them, which need not be here any more.
    files = list(run.scenes.files)
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
