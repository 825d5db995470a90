"""`robocell benchmark`: freezes starts in a file, for evaluations that others repeat."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell._cli.common import counting, require_run_source
from robocell._suggestions import counted


def benchmark(
    source: Annotated[
        str,
        typer.Argument(metavar="DATASET|RUN.yaml", help="A dataset, for its cell, or a run file."),
    ],
    out: Annotated[Path, typer.Argument(metavar="OUT.json", help="File to write.")],
    episodes: Annotated[int, typer.Option("--episodes", "-n", min=1, help="Starts.")] = 100,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Seed of the starts. Default: that of `robocell evaluate`."),
    ] = None,
    schema: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="NAME",
            help="robocell-benchmark, or molmospaces: a list of MolmoSpaces' episodes.",
        ),
    ] = "robocell-benchmark",
    imports: Annotated[
        list[str] | None,
        typer.Option("--import", metavar="MODULE", help="A module that registers tasks."),
    ] = None,
) -> None:
    """Freeze starts in a file: instructions, joints, poses, task.

    `robocell evaluate OUT.json --policy POLICY` evaluates policies from them,
    and refuses a cell that gives other starts.

    Exit codes:
    0  written
    2  wrong command or spec; OUT.json exists
    3  a file cannot be read or written
    """
    from robocell.benchmark import SEED, create

    require_run_source(source)
    with counting() as count:
        made = create(
            source,
            out,
            episodes=episodes,
            seed=SEED if seed is None else seed,
            imports=imports or [],
            schema=schema,
            on_start=count,
        )
    print(f"{counted(len(made.starts), 'start')} of {made.source}: {out}")
