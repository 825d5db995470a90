"""Columns of all episodes of a dataset as one array: for learning without images."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset


def rows(
    dataset: Dataset | str | os.PathLike[str],
    names: Sequence[str],
    horizon: int | None = None,
) -> NDArray[np.float64]:
    """All rows of all episodes: the columns `names` one after another, episodes in their order.

    The numbers of a row are those that `robocell.envs.from_dataset(..., flat=True)` observes and
    takes for the same names.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        names: Columns of the table `steps`.
        horizon: Each row with those that follow it, so many in all, as chunks of actions are
            learned; the last row of an episode stands in for what it has not.

    Returns:
        (rows, numbers), or (rows, horizon, numbers).

    Raises:
        NotFoundError: An episode has no such column; the text has the nearest.
        ArgumentError: No episodes, no names, a column of another table, or a horizon below 1.
    """
    opened = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
    if isinstance(names, str) or not names:
        raise ArgumentError(f"rows: `names` is a list of columns, got {names!r}")
    if horizon is not None and horizon < 1:
        raise ArgumentError(f"rows: `horizon` is at least 1, got {horizon}")
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
        part = np.concatenate([column.reshape(len(column), -1) for column in columns], axis=1)
        if horizon is not None:
            ahead = np.arange(len(part))[:, None] + np.arange(horizon)
            part = part[ahead.clip(max=len(part) - 1)]
        parts.append(part)
    return np.concatenate(parts)
