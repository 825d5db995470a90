"""`robocell merge`: makes one dataset of several."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import _core
from robocell._cli.common import COPY_OPTION, counting, print_derived, require_folder
from robocell._suggestions import counted
from robocell.data.derive import merge as merged


def merge(
    datasets: Annotated[
        list[Path], typer.Argument(metavar="DATASET...", help="Folders of the datasets.")
    ],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.")],
    copy: Annotated[bool, COPY_OPTION] = False,
) -> None:
    """Make one dataset of several.

    Episodes keep their ids, except those that an earlier dataset also has:
    they are renamed. dataset.json says where each comes from. OUT is complete
    or absent. After a kill, the same command continues.

    Exit codes:
    0  made
    2  wrong command; no episodes
    3  a file cannot be read or written
    """
    for dataset in datasets:
        require_folder(dataset, "dataset")
        _core.require_dataset(dataset)
    with counting() as count:
        result = merged(datasets, out, copy=copy, on_episodes=count)
    print(f"{counted(result.episodes, 'episode')} of {counted(len(datasets), 'dataset')}: {out}")
    if twice := result.of - result.episodes:
        print(f"{counted(twice, 'episode')} left out: an earlier dataset has the same recording")
    if result.renamed:
        print(f"{counted(result.renamed, 'episode')} renamed: dataset.json has their former ids")
    print_derived(result)
