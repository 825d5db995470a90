"""`robocell verify`: compares every byte of a dataset with its hash."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell._cli.common import ExitCode, require_folder
from robocell._dataset_run import runs_of_mixture
from robocell.data.pack import is_packed


def verify(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    decode_videos: Annotated[
        bool, typer.Option("--decode-videos", help="Also decode every frame (slow).")
    ] = False,
    repair: Annotated[
        bool, typer.Option("--repair", help="Move damaged files into DATASET/.quarantine.")
    ] = False,
) -> None:
    """Check every file of a dataset and list the damaged ones.

    Exit codes:
    0  intact; with --repair: repaired
    1  damaged; with --repair: damage remains
    2  wrong command, or not a dataset
    3  the only problems: files that this machine or version cannot read
    """
    require_folder(dataset, "dataset")
    if repair:
        # The episodes of a mixture are links to those of its runs: damage is in both.
        repaired = [_repair(each, decode_videos) for each in (dataset, *runs_of_mixture(dataset))]
        if not all(repaired):
            raise typer.Exit(ExitCode.INCOMPLETE)
        return
    result = robocell.data.verify(dataset, decode_videos=decode_videos)
    print(str(result).rstrip())
    if not (result.ok or result.only_unreadable):
        print(_remedy(dataset))
    if not result.ok:
        raise typer.Exit(ExitCode.OUTPUT if result.only_unreadable else ExitCode.INCOMPLETE)


def _repair(dataset: Path, decode_videos: bool) -> bool:
    """Sets damaged files of a dataset aside; returns False if damage remains."""
    repaired = robocell.data.repair(dataset, decode_videos=decode_videos)
    print(str(repaired.found).rstrip())
    for moved in repaired.moved:
        print(f"moved aside: {dataset / '.quarantine' / moved}")
    for problem in repaired.remaining:
        print(f"not repaired: {problem}")
    return not repaired.remaining


def _remedy(dataset: Path) -> str:
    """Returns what to do about damage."""
    if is_packed(dataset):
        keep = shlex.join(["robocell", "unpack", "--skip-damaged", str(dataset)])
        return (
            f"Copy the damaged files again from where they came. To keep what is intact: {keep} OUT"
        )
    remedy = shlex.join(["robocell", "verify", "--repair", str(dataset)])
    return (
        f"To set damaged files aside: {remedy}; the command that made the dataset then makes "
        "their episodes again"
    )
