"""Reads columns of all episodes of a dataset as one array, for learning without images."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset, Episode
from robocell._suggestions import fitting, is_pattern


def rows(
    dataset: Dataset | str | os.PathLike[str],
    names: Sequence[str],
    horizon: int | None = None,
) -> NDArray[np.float64]:
    """Returns all rows of all episodes: the columns `names` side by side, episodes in order.

    A row equals the observations and actions of `robocell.envs.from_dataset(..., flat=True)` for
    these names.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        names: Columns of the table `steps`. "*" stands for any part of a name: "*sensors/*" is
            every sensor that all episodes have, in the order of the first.
        horizon: Number of rows per item, each row with its successors, for learning chunks of
            actions; the last row of an episode replaces rows beyond it.

    Returns:
        (rows, numbers), or (rows, horizon, numbers).

    Raises:
        NotFoundError: An episode has no such column; the message has the nearest.
        ArgumentError: There are no episodes or names, a column is of another table, or the horizon
            is below 1.

    Examples:
        >>> table = rc.data.rows(dataset, ["robots/rc7/arm/qpos"])
        >>> table.shape[1]
        7
    """
    opened = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
    if isinstance(names, str) or not names:
        raise ArgumentError(f"rows: `names` is a list of columns, got {names!r}")
    if horizon is not None and horizon < 1:
        raise ArgumentError(f"rows: `horizon` is at least 1, got {horizon}")
    if not len(opened):
        raise ArgumentError(f"dataset '{opened.folder}' has no episodes")
    if any(is_pattern(name) for name in names):
        names = fitting(f"dataset '{opened.folder}'", names, _shared_columns(opened))
    parts = []
    for episode in opened:
        for name in names:
            _require_no_image(episode, name)
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


def _require_no_image(episode: Episode, name: str) -> None:
    """Raises ArgumentError for an image stream, which has frames instead of numbers in rows."""
    if name in episode.streams and name not in episode.columns:
        raise ArgumentError(
            f"rows: '{name}' is an image stream, not a column: robocell.data.Steps gives its "
            f"images with the rows, episode.frame({name!r}, i) a single one"
        )


def _shared_columns(dataset: Dataset) -> list[str]:
    """Returns the columns of the table `steps` that all episodes have."""
    first = dataset[0]
    shared = [name for name in first.columns if first.column(name).table == "steps"]
    for episode in dataset:
        here = set(episode.columns)
        shared = [name for name in shared if name in here]
    return shared
