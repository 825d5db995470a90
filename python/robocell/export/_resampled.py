"""Episodes at another rate: each row shows the nearest earlier row of the recording.

States and commands are held until the recording has newer ones. What belongs to the time between
two rows is put together: rewards are added, relative actions lead from one held target to the next,
and an end that falls between two rows belongs to the first of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from robocell._core import ArgumentError, EnvConfig, Episode, RelativeTo
from robocell._placeholders import is_difference
from robocell.export._rates import TIME, rate_of

MOST_HZ = 1000
STEPS = "steps"  # the table of rows
REWARD = "reward"
ENDS = ("terminated", "truncated", "success")
ENV_ACTION = "action/"  # begins the columns of an environment's own actions
LATE_S = 1e-6  # a row at the very time of a new row is there already


def rate_from(given: float | str | Fraction) -> Fraction:
    """Returns rows per second, from a number or a text such as "15", "12.5" or "100/7".

    Raises ArgumentError for anything else, and for rates that no episode can have.
    """
    try:
        rate = Fraction(given).limit_denominator(10_000)
    except (ValueError, TypeError, ZeroDivisionError, OverflowError):
        rate = Fraction(0)
    if not 0 < rate <= MOST_HZ:
        raise ArgumentError(
            f"rate is {given!r}: expected rows per second, above 0 and at most {MOST_HZ}, such as "
            "15, 12.5 or 100/7"
        )
    return rate


def rows_at(episode: Episode, rate: Fraction, cameras: Sequence[str]) -> NDArray[np.int64] | None:
    """Returns the recorded row that each row at a rate shows; None if the rates are the same.

    Rows that are not evenly spaced are found by the column `time`.
    """
    count = len(episode)
    try:
        recorded = rate_of(episode, cameras)
    except ArgumentError:
        if TIME not in episode or count < 1:
            raise
        time = np.asarray(episode[TIME], np.float64)
        length = int(np.floor((time[-1] - time[0] + LATE_S) * float(rate))) + 1
        due = time[0] + np.arange(length) / float(rate) + LATE_S
        return np.searchsorted(time, due, side="right") - 1
    if recorded == rate:
        return None
    ratio = recorded / rate
    length = -(-count * ratio.denominator // ratio.numerator)
    return np.arange(length) * ratio.numerator // ratio.denominator


class ResampledEpisode:
    """An episode with the rows of another rate; otherwise it is the episode.

    Args:
        episode: The recorded episode.
        rows: The recorded row that each row shows, in ascending order.
        rate: Rows per second.
    """

    def __init__(self, episode: Episode, rows: NDArray[np.int64], rate: Fraction) -> None:
        self._episode, self._rows, self._rate = episode, rows, rate
        if not len(rows):
            raise ArgumentError(f"episode '{episode.folder}' has no row at {float(rate):g} Hz")

    def __len__(self) -> int:
        return len(self._rows)

    def __contains__(self, name: str) -> bool:
        return name in self._episode

    def __getattr__(self, name: str) -> Any:
        return getattr(self._episode, name)

    def __getitem__(self, name: str) -> NDArray[Any]:
        values = self._episode[name]
        if self._episode.column(name).table != STEPS:
            return values  # of the controller, or a constant
        if name == TIME:
            return np.asarray(values[0] + np.arange(len(self)) / float(self._rate))
        if name == REWARD:
            return self._between(np.add, values)
        if name in ENDS:
            return self._between(np.logical_or, values)
        if is_difference(name):
            return self._composed(values)
        if name.startswith(ENV_ACTION):
            self._require_absolute(name)
        return np.asarray(values[self._rows])

    def _between(self, combine: np.ufunc, values: NDArray[Any]) -> NDArray[Any]:
        """Combines the recorded rows from each row to the next; without any it is zero."""
        ends = [*self._rows[1:], len(values)]
        found = np.zeros((len(self), *values.shape[1:]), values.dtype)
        for row, (begin, end) in enumerate(zip(self._rows, ends, strict=True)):
            if begin < end:
                found[row] = combine.reduce(values[begin:end], axis=0)
        return found

    def _composed(self, differences: NDArray[Any]) -> NDArray[Any]:
        """Returns differences from the target of the row before, which may be rows earlier."""
        targets = np.cumsum(differences, axis=0)[self._rows]
        return np.diff(targets, axis=0, prepend=np.zeros_like(targets[:1]))

    def _require_absolute(self, column: str) -> None:
        metadata: Any = self._episode.metadata
        environment = metadata.get("environment") if isinstance(metadata, dict) else None
        config = environment.get("config") if isinstance(environment, dict) else None
        if not isinstance(config, str):
            return
        default = EnvConfig().relative_to.name.lower()
        relative_to = (yaml.safe_load(config) or {}).get("relative_to", default)
        if relative_to != RelativeTo.NONE.name.lower():
            raise ArgumentError(
                f"episode '{self._episode.folder}': the environment's action '{column}' is "
                f"relative to {relative_to}, so it belongs to the rate at which it was recorded. "
                "Leave --rate out, or choose actions of the robots: --actions joints"
            )
