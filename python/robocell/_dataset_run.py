"""The run that a dataset was made by, from the dataset alone."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    Dataset,
    Error,
    IoError,
    RunConfig,
    SpecError,
    expert_kinds,
    first_episode_of_run,
    json_damage,
    plan_numbers,
)
from robocell._core import run_of_dataset as _run_of_dataset
from robocell._own_code import loaded_sources, modules_of_one_run, set_modules_of_run

__all__ = [
    "is_recorded_folder",
    "manifest_of_dataset",
    "plan_numbers",
    "recorded_attempts",
    "require_cell",
    "run_of_dataset",
    "runs_of_mixture",
    "seed_of_dataset",
]

PARTS = ".parts"  # folder of the runs of a mixture, in its dataset


def runs_of_mixture(dataset: Path) -> list[Path]:
    """Returns the datasets of the runs of a mixture; [] for other datasets."""
    return sorted(path.parent for path in (dataset / PARTS).glob("*/dataset.json"))


def manifest_of_dataset(source: str | Path) -> dict[str, Any] | None:
    """Returns the content of dataset.json, checked against its hash; None without a file.

    Raises IoError if it is damaged or cannot be read.
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
        what = f"'{path}' is damaged: {damage or 'it is no JSON object'}"
        if (folder / "packed.json").exists():
            raise IoError(f"{what}. Copy it again from where the packed dataset came")
        remedy = shlex.join(["robocell", "verify", "--repair", str(folder)])
        raise IoError(
            f"{what}. `{remedy}` sets it aside, `robocell generate` with the run's file writes it "
            "again"
        )
    return manifest


def is_recorded_folder(source: str | Path) -> bool:
    """Returns True for a dataset whose episodes an environment recorded."""
    folder = Path(source)
    if not folder.is_dir() or (folder / "dataset.json").exists():
        return False
    try:
        dataset = Dataset(folder)
        metadata: Any = dataset[0].metadata if len(dataset) else {}
    except (Error, OSError):
        return False
    return "environment" in metadata


def require_cell(source: str | Path) -> None:
    """Raises ArgumentError for a dataset that neither a run nor an environment made.

    Nothing says in which cell an imported one, or one of `EpisodeWriter`, was made.
    """
    folder = Path(source)
    if not folder.is_dir():
        return
    try:
        dataset = Dataset(folder)
        metadata: Any = dataset[0].metadata if len(dataset) else {}
    except (Error, OSError):
        return  # told by what reads it next
    origin = metadata.get("imported") if isinstance(metadata, dict) else None
    if isinstance(origin, dict):
        raise ArgumentError(
            f"'{folder}' was imported from {origin.get('format', 'another format')}, so it has no "
            "cell to act in: train on it, export it, or merge it with others like it"
        )
    if len(dataset) and not {"identity", "environment"} & set(metadata or {}):
        raise ArgumentError(
            f"'{folder}' was written row by row, so it has no cell to act in. In a cell of your "
            "own, env.row() returns the columns by their names, env.step takes the names of "
            "actions, and robocell.data.rows reads both from the dataset"
        )


def seed_of_dataset(source: str | Path) -> int:
    """Returns the seed of the run that made a dataset; no kind has to be registered for it.

    Raises ArgumentError for a dataset without episodes, and for one that no run made.
    """
    require_cell(source)
    metadata: Any = first_episode_of_run(Dataset(Path(source))).metadata
    return int(metadata["seed"])


def recorded_attempts(source: str | Path) -> dict[tuple[int, int], int]:
    """Returns (scene, episode of the scene) -> number of the attempt in the dataset.

    With `keep: all`, where an episode has several, it is the last one: the success, if any.
    """
    attempts: dict[tuple[int, int], int] = {}
    for episode in Dataset(Path(source)):
        metadata: Any = episode.metadata
        numbers = int(metadata["scene"]), int(metadata["episode"])
        attempts[numbers] = max(int(metadata["attempt"]), attempts.get(numbers, 0))
    return attempts


@contextlib.contextmanager
def naming_what_to_evaluate() -> Iterator[None]:
    """Context manager: errors about a dataset that no run made add what can be evaluated."""
    try:
        yield
    except ArgumentError as error:
        raise ArgumentError(
            f"{error}. Evaluate a run, or a dataset that a run or an environment made"
        ) from error


@contextlib.contextmanager
def naming_where_to_augment() -> Iterator[None]:
    """Context manager: errors about a dataset that no run made add where its episodes can go."""
    try:
        yield
    except ArgumentError as error:
        raise ArgumentError(
            f"{error}. To move its episodes to the starts of a run, name the run file: "
            "`robocell augment DATASET --run RUN.yaml`"
        ) from error


def run_of_dataset(source: str | Path, modules: Sequence[str] = ()) -> RunConfig:
    """Returns the cell of a dataset: robot, task, scenes, rates, cameras, and its stored models.

    Nothing is imported: register your own task first. `modules` are the names of the modules that
    were imported for it: all of them are its code, because they may change classes of others.
    Raises SpecError if the code differs from the code that made the dataset.
    """
    with modules_of_one_run():
        set_modules_of_run(modules)
        require_cell(source)
        run = _run_of_dataset(Dataset(Path(source)))
    _require_imported(Path(source), run)
    return run


def _require_imported(folder: Path, run: RunConfig) -> None:
    """Raises SpecError if a module that was part of the dataset's code is not loaded now.

    It may have changed classes of other modules. Without the expert nothing is compared: its files
    cannot be told from others, and an environment or another policy does not need them.
    """
    manifest = manifest_of_dataset(folder)
    if manifest is None or (run.expert or run.task.kind) not in expert_kinds():
        return
    modules = re.compile(r"code/(.*\.py)(?: \(\d+\))?")  # files with equal names are numbered
    recorded = {
        hash: found[1]
        for name, hash in manifest.get("files", {}).items()
        if (found := modules.fullmatch(name))
    }
    if not recorded:
        return
    names = set(recorded.values())
    sources = [file for file in loaded_sources() if file.name in names and file.is_file()]
    present = {hashlib.sha256(file.read_bytes()).hexdigest() for file in sources}
    missing = sorted({name for hash, name in recorded.items() if hash not in present})
    if missing:
        raise SpecError(
            f"the code that made '{folder}' had {' and '.join(map(repr, missing))} too, which "
            f"{'is' if len(missing) == 1 else 'are'} not imported here: name it with --import, or "
            "in `imports`"
        )
