"""`robocell import`: makes a dataset of episodes from one of another format."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell._cli.common import (
    ExitCode,
    counting,
    fail,
    fail_missing,
    print_warning,
    require_mapping,
)
from robocell._suggestions import counted
from robocell.importer import FORMATS, import_dataset


def import_(
    source: Annotated[
        Path, typer.Argument(metavar="SOURCE", help="Folder or file of the other dataset.")
    ],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.")],
    format: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help=f"One of: {', '.join(FORMATS)}. Default: what SOURCE looks like."
        ),
    ] = None,
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="YAML file: columns and cameras for the names of SOURCE. docs/import.md has it.",
        ),
    ] = None,
    task: Annotated[
        str | None,
        typer.Option(metavar="TEXT", help="Instruction of episodes that have none."),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Rows per second. Default: what SOURCE says."),
    ] = None,
    assume_success: Annotated[
        bool,
        typer.Option("--assume-success", help="Count episodes as successes that do not say."),
    ] = False,
    fill_missing_chunks: Annotated[
        bool,
        typer.Option(
            "--fill-missing-chunks",
            help="Read chunks that a zarr array lacks as its fill value.",
        ),
    ] = False,
) -> None:
    """Make a dataset of episodes from one of another format.

    OUT is complete or absent. After a kill, the same command continues.

    Exit codes:
    0  imported
    2  wrong command or mapping; SOURCE is no such dataset
    3  a file cannot be read or written
    """
    if not os.path.lexists(source):
        fail_missing(source, "file or folder", lambda _: True)
    require_mapping(mapping)
    try:
        with counting() as count:
            result = import_dataset(
                source,
                out,
                format,
                mapping=mapping,
                task=task,
                rate=rate,
                assume_success=assume_success,
                fill_missing_chunks=fill_missing_chunks,
                on_episodes=count,
            )
    except robocell.IoError as error:
        fail(str(error), ExitCode.OUTPUT)
    except ModuleNotFoundError as error:
        fail(str(error))
    print(
        f"{result.title}: {counted(result.episodes, 'episode')}, {counted(result.rows, 'row')} at "
        f"{result.rate:.6g} Hz, {counted(result.cameras, 'camera')}, "
        f"{result.successes} succeeded: {result.folder}"
    )
    if result.silent and not assume_success:
        print(
            f"without a result: {counted(result.silent, 'episode')}, counted as failures. "
            "--assume-success counts them as successes"
        )
    if result.gaps:
        print_warning(f"the numbers of the episodes have gaps: {result.gaps}")
    if result.resumed:
        print(f"{counted(result.resumed, 'episode')} already written by an interrupted import")
