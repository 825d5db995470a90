"""`robocell pack`: packs a dataset into a few large files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import _core
from robocell._cli.common import counting, require_folder
from robocell._suggestions import counted


def pack(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.")],
    shard_mb: Annotated[
        float,
        typer.Option("--shard-mb", metavar="MB", min=0.001, help="Size of a file, about."),
    ] = 1024.0,
) -> None:
    """Pack a dataset into a few large files, for object stores and copies.

    `robocell unpack` makes the same dataset again, byte by byte. OUT is
    complete or absent. After a kill, the same command continues.

    Exit codes:
    0  packed
    2  wrong command; no episodes
    3  a file is damaged, or cannot be read or written
    """
    from robocell.data.pack import pack as packed

    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    with counting() as count:
        result = packed(dataset, out, shard_bytes=int(shard_mb * 1e6), on_episodes=count)
    print(
        f"{counted(result.episodes, 'episode')}, {counted(result.files, 'file')} in "
        f"{counted(result.shards, 'shard')}: {out}"
    )
