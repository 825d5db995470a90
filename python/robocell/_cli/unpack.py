"""`robocell unpack`: makes the dataset again that `robocell pack` packed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell._cli.common import require_folder
from robocell._suggestions import counted


def unpack(
    packed: Annotated[Path, typer.Argument(metavar="PACKED", help="Folder of a packed dataset.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.")],
    skip_damaged: Annotated[
        bool, typer.Option("--skip-damaged", help="Leave out damaged episodes, models and files.")
    ] = False,
) -> None:
    """Make the dataset again that `robocell pack` packed, byte by byte.

    OUT is complete or absent. After a kill, the same command continues.

    Exit codes:
    0  made
    2  wrong command; no packed dataset
    3  a file is damaged, or cannot be read or written
    """
    from robocell.data.pack import unpack as unpacked

    require_folder(packed, "packed dataset")
    result = unpacked(packed, out, skip_damaged=skip_damaged)
    for name in result.skipped:
        print(f"damaged, left out: {name}")
    print(f"{counted(result.episodes, 'episode')}, {counted(result.files, 'file')}: {out}")
