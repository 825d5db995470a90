"""`robocell split`: makes several datasets of one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import _core
from robocell._cli.common import COPY_OPTION, counting, fail, print_derived, require_folder
from robocell._suggestions import counted
from robocell.data.derive import split as parts_of


def split(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make; it holds the parts.")],
    parts: Annotated[
        str, typer.Option(metavar="SHARES", help="Name and share of each part; their sum is 1.")
    ] = "train=0.9,valid=0.1",
    seed: Annotated[int, typer.Option(help="Another number gives another choice.")] = 0,
    by: Annotated[
        str | None,
        typer.Option(
            metavar="FIELD",
            help="Episodes that share this field stay together: scene, task, or another field of "
            "`robocell filter`.",
        ),
    ] = None,
    copy: Annotated[bool, COPY_OPTION] = False,
) -> None:
    """Make several datasets of one, with no episode in two of them.

    The parts are OUT/train, OUT/valid and so on. OUT is complete or absent.
    After a kill, the same command continues.

    Exit codes:
    0  made
    2  wrong command; a part would be empty
    3  a file cannot be read or written
    """
    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    with counting() as count:
        results = parts_of(
            dataset, _shares(parts), out, seed=seed, by=by, copy=copy, on_episodes=count
        )
    for result in results.values():
        print(f"{counted(result.episodes, 'episode')}: {result.folder}")
    print_derived(next(iter(results.values())))


def _shares(text: str) -> dict[str, float]:
    shares: dict[str, float] = {}
    for entry in text.split(","):
        name, _, share = entry.partition("=")
        name = name.strip()
        try:
            number = float(share)
        except ValueError:
            fail(f"--parts: '{entry.strip()}' is no part. Write name=share: train=0.9,valid=0.1")
        if name in shares:
            fail(f"--parts: '{name}' is given twice")
        shares[name] = number
    return shares
