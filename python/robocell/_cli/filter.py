"""`robocell filter`: makes a dataset of the episodes that a condition holds for."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell import _core
from robocell._cli.common import COPY_OPTION, counting, print_derived, require_folder
from robocell._suggestions import counted
from robocell.data.derive import fitting, keep


def filter(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    out: Annotated[
        Path | None,
        typer.Argument(metavar="OUT", help="Folder to make. Without it, ids are printed."),
    ] = None,
    *,
    where: Annotated[
        str,
        typer.Option(metavar="CONDITION", help="Such as 'success and length < 200'."),
    ],
    copy: Annotated[bool, COPY_OPTION] = False,
) -> None:
    """Make a dataset of the episodes that a condition holds for.

    A condition compares fields with numbers, texts in quotes, true and false:
    == != < <= > >= contains, joined by and, or, not and parentheses. Fields
    are success, length, task, end_reason, robots, scene, seed and others; an
    unknown one is answered with all. OUT is complete or absent.

    Exit codes:
    0  made
    2  wrong command or condition; it holds for no episode
    3  a file cannot be read or written
    """
    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    if out is None:
        for id in fitting(robocell.Dataset(dataset), where):
            print(id)
        return
    with counting() as count:
        result = keep(dataset, where, out, copy=copy, on_episodes=count)
    print(f"{result.episodes} of {counted(result.of, 'episode')}: {out}")
    print_derived(result)
