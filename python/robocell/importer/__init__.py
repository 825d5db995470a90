"""Imports datasets of other formats as episodes.

    robocell.importer.import_dataset("lerobot/pusht", "out/pusht")

Reports, filters, loaders and exports then work on them. docs/import.md describes formats and names.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robocell import __version__
from robocell._core import ArgumentError, IoError, self_hashed_json
from robocell.importer._foreign_files import ADVICE
from robocell.importer._origins import FORMATS, find, open_origin

if TYPE_CHECKING:
    from robocell._staging import Staging
    from robocell.importer._column_names import Names
    from robocell.importer._episodes import Content
    from robocell.importer._recording import Column, Origin

__all__ = ["FORMATS", "Imported", "import_dataset"]

FLAGS = ("terminated", "success")


@dataclass(frozen=True)
class Imported:
    """The result of an import.

    Attributes:
        folder: Where it is.
        title: The format that it was.
        episodes: Number of episodes.
        rows: Number of rows.
        cameras: Number of cameras.
        rate: Rows per second.
        successes: Number of episodes that count as successes.
        silent: Number of episodes that do not say whether they succeeded.
        resumed: Number of episodes that an earlier, killed import had written.
        gaps: Which numbers the episodes of the source skip; "" for none.
    """

    folder: Path
    title: str
    episodes: int
    rows: int
    cameras: int
    rate: float
    successes: int
    silent: int
    resumed: int
    gaps: str = ""


def import_dataset(
    source: str | os.PathLike[str],
    out: str | os.PathLike[str],
    format: str | None = None,
    *,
    mapping: str | os.PathLike[str] | None = None,
    task: str | None = None,
    rate: float | None = None,
    assume_success: bool = False,
    fill_missing_chunks: bool = False,
    on_episodes: Callable[[int, int], None] | None = None,
) -> Imported:
    """Imports a dataset of another format as a dataset of episodes.

    Memory does not grow with the dataset. An import that was killed continues where it was when it
    is asked for again.

    Args:
        source: A folder, or the file of a robomimic dataset or replay buffer.
        out: The folder to make; it must not exist.
        format: One of `FORMATS`; default: what `source` looks like.
        mapping: YAML file with columns and cameras for the names of the dataset.
        task: The instruction of episodes that have none.
        rate: Rows per second; needed if the dataset does not say.
        assume_success: Count episodes as successes that do not say.
        fill_missing_chunks: Read chunks that a zarr array lacks as its fill value. Some writers
            leave such chunks out; by default a missing chunk is an error.
        on_episodes: Is called with the number of episodes that are written, and of all.

    Returns:
        What was imported.

    Raises:
        NotFoundError: There is no such format, or the mapping has a name that the dataset lacks.
        ArgumentError: `source` is no such dataset, its rate is unknown, or `out` exists.
        SpecError: The mapping is not one.
        IoError: Reading or writing failed, or `source` is damaged.
        ModuleNotFoundError: A package that the format needs is missing.
    """
    from robocell._staging import staging
    from robocell.importer._column_names import Names
    from robocell.importer._entries import is_text, rate_of

    own_rate = None if rate is None else rate_of(rate, "rate")
    if task is not None and not is_text(task):
        raise ArgumentError(f"task is {task!a}, which is no text of UTF-8")
    place, kind = find(Path(source), format)
    origin = open_origin(place, kind, fill_missing_chunks)
    if not len(origin):
        raise ArgumentError(f"'{source}' has no episodes to import")
    hertz = own_rate or origin.rate
    if hertz is None:
        raise ArgumentError(
            f"'{source}' does not say how many rows there are per second. Say it: --rate HZ"
        )
    names = Names.load(Path(mapping)) if mapping is not None else Names()
    names.require_known(origin.read(0))
    given = Path(out)
    target = given.parent.resolve() / given.name
    if target.is_relative_to(place.resolve()):
        raise ArgumentError(f"'{given}' is inside '{source}'. Choose a folder beside it")
    request = {
        "robocell": __version__,
        "import": os.fsencode(place.resolve()).decode(errors="replace"),
        "fingerprint": origin.fingerprint,
        "format": kind,
        "episodes": len(origin),
        "names": {"columns": names.columns, "cameras": names.cameras},
        "task": task,
        "rate": str(hertz),
        "assume_success": assume_success,
        "fill_missing_chunks": fill_missing_chunks,
    }
    try:
        with staging(target, request) as where:
            totals = _write(origin, where, names, hertz, request, on_episodes)
            where.commit()
    except IoError:
        raise
    except OSError as error:
        raise IoError(
            f"cannot import to '{given}': {error.strerror or error}. What is written stays in "
            f"'{target.parent / f'.{target.name}.partial'}'; the same import continues there"
        ) from error
    return Imported(given, origin.title, len(origin), rate=float(hertz), gaps=origin.gaps, **totals)


def _write(
    origin: Origin,
    where: Staging,
    names: Names,
    rate: Fraction,
    request: dict[str, Any],
    on_episodes: Callable[[int, int], None] | None,
) -> dict[str, int]:
    """Writes the episodes that are missing, and dataset.json; returns the totals."""
    import shutil

    from robocell.data import remove_leftovers
    from robocell.importer._episodes import write_episode

    remove_leftovers(where.folder, folders_only=True)  # of a killed import
    totals = {"rows": 0, "cameras": 0, "successes": 0, "silent": 0, "resumed": 0}
    for index in range(len(origin)):
        id = f"episode-{index:06d}"
        kept = where.state(id)
        if kept is None or not (where.folder / id).is_dir():
            shutil.rmtree(where.folder / id, ignore_errors=True)  # it was to be kept next
            content = _content(origin, index, id, names, rate, request)
            scratch = where.scratch("videos")
            shutil.rmtree(scratch, ignore_errors=True)
            write_episode(content, where.folder, scratch)
            kept = {
                "rows": content.rows,
                "cameras": len(content.cameras),
                "successes": int(content.success),
                "silent": int("success" not in content.columns),
            }
            where.keep(id, kept)
        else:
            totals["resumed"] += 1
        totals["rows"] += kept["rows"]
        totals["cameras"] = max(totals["cameras"], kept["cameras"])
        totals["successes"] += kept["successes"]
        totals["silent"] += kept["silent"]
        if on_episodes is not None:
            on_episodes(index + 1, len(origin))
    manifest = {
        "format": "robocell-dataset",
        "imported": {key: request[key] for key in ("robocell", "import", "format", "rate")},
        "json_sha256": "0" * 64,
    }
    where.path("dataset.json").write_text(self_hashed_json(json.dumps(manifest, indent=2) + "\n"))
    return totals


def _content(
    origin: Origin, index: int, id: str, names: Names, rate: Fraction, request: dict[str, Any]
) -> Content:
    """Returns what the episode of a recording has."""
    from robocell.importer._episodes import Content

    recording = origin.read(index)
    if recording.rows < 1:
        raise IoError(f"recording {index} of '{request['import']}' has no rows: {ADVICE}")
    columns = names.columns_of(recording, origin)
    for name in FLAGS:
        if name in columns:
            columns[name] = _flags(columns[name], f"{id}: column '{name}'")
    says = "success" in columns
    success = bool(columns["success"].values[-1]) if says else bool(request["assume_success"])
    terminated = "terminated" in columns and bool(columns["terminated"].values[-1])
    cameras = names.cameras_of(recording.images)
    metadata = {
        "instruction": recording.task or request["task"] or "",
        "robots": origin.robots,
        "rates": {"policy_hz": [rate.numerator, rate.denominator]},
        "imported": {"from": request["import"], "format": origin.title, **recording.metadata},
    }
    return Content(
        id=id,
        rows=recording.rows,
        rate=rate,
        columns=columns,
        cameras={camera: recording.images[name] for name, camera in cameras.items()},
        success=success,
        terminated=terminated,
        end_reason="success" if says and success else "imported",
        metadata=metadata,
    )


def _flags(column: Column, what: str) -> Column:
    """Returns a column of truth values.

    Raises:
        IoError: It has others than 0 and 1, or several in a row.
    """
    import numpy as np

    from robocell.importer._recording import Column

    values = column.values.reshape(len(column.values), -1)
    if values.shape[1] != 1 or not np.isin(values, (0, 1)).all():
        raise IoError(
            f"{what} has other values than one 0 or 1 in each row: {ADVICE}. A mapping file gives "
            "another name: --mapping FILE"
        )
    return Column(values[:, 0].astype(bool))
