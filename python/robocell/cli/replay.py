"""`robocell replay --check`: do the recorded controls give the recorded episode?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell.cli.common import ExitCode, fail, require_folder


def replay(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    episode: Annotated[
        str | None, typer.Argument(metavar="EPISODE", help="Its id; all of them unless given.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Name the first step that comes out otherwise.")
    ] = False,
    tolerance: Annotated[
        float, typer.Option(min=0, help="Differences up to this count as none: m, rad, m/s, s.")
    ] = 1e-9,
) -> None:
    """Simulate episodes again from their start and their recorded controls, and compare.

    Exit codes: 0 all the same, 1 some differ, 2 wrong command or an episode that cannot be
    replayed, 3 a file cannot be read.
    """
    if not check:
        fail(f"say what for: robocell replay --check {dataset}")
    require_folder(dataset, "dataset")
    episodes = robocell.Dataset(dataset)
    ids = [episode] if episode is not None else episodes.ids
    if not ids:
        fail(f"'{dataset}' has no episodes")
    differing = 0
    for name in ids:
        report = robocell.check_replay(episodes[name], tolerance)
        print(report, flush=True)
        differing += not report.ok
    if differing:
        print(f"{differing} of {len(ids)} episodes differ")
        raise typer.Exit(ExitCode.INCOMPLETE)
