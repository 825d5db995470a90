"""Columns of all episodes of a dataset as one matrix: for learning without images."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset


def rows(dataset: Dataset | str | os.PathLike[str], names: Sequence[str]) -> NDArray[np.float64]:
    """All rows of all episodes, (rows, numbers): the columns one after another, episodes in order.

    The numbers of a row are those that `robocell.envs.from_dataset(..., flat=True)` observes and
    takes for the same names.

    Raises:
        NotFoundError: An episode has no such column; the text has the nearest.
        ArgumentError: No episodes, no names, or a column of another table.
    """
    opened = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
    if isinstance(names, str) or not names:
        raise ArgumentError(f"rows: `names` is a list of columns, got {names!r}")
    if not len(opened):
        raise ArgumentError(f"dataset '{opened.folder}' has no episodes")
    parts = []
    for episode in opened:
        for name in names:
            table = episode.column(name).table
            if table != "steps":
                what = f"of the table '{table}'" if table else "a constant"
                raise ArgumentError(f"column '{name}' is {what}; rows are of the table 'steps'")
        columns = [np.asarray(episode[name], np.float64) for name in names]
        parts.append(np.concatenate([c.reshape(len(c), -1) for c in columns], axis=1))
    return np.concatenate(parts)
