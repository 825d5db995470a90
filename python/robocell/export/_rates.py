"""The rate of an episode's rows, and whether their times are those of such a rate.

Most formats store a rate instead of times, so rows have to be evenly spaced. Environments with
`sim: {async_control: false}` end their steps on arrival, and record rows that are not.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np

from robocell._core import ArgumentError, Episode

TIME = "time"
DEFAULT_STEP_S = 0.002  # of the engine, where the metadata do not say it
ROUNDING_S = 1e-6  # of times and rates


def rate_of(episode: Episode, cameras: Iterable[str]) -> Fraction:
    """Returns the rows per second of an episode: of a camera, of the run, or of the column `time`.

    Args:
        episode: The episode.
        cameras: Its cameras, first those that are exported.

    Raises:
        ArgumentError: The rate is unknown, or the rows are not evenly spaced.
    """
    rate = _nominal(episode, cameras)
    if rate is None:
        raise ArgumentError(
            f"episode '{episode.folder}': its rate is unknown. Episodes have cameras, rates in "
            "their metadata, or a column 'time'"
        )
    _require_even(episode, rate)
    return rate


def mean_rate(episodes: Iterable[Episode]) -> Fraction:
    """Returns the rows per second on average, from the times; 0 without two rows."""
    intervals, seconds = 0, 0.0
    for episode in episodes:
        if TIME in episode and len(episode) > 1:
            time = episode[TIME]
            intervals += len(time) - 1
            seconds += float(time[-1] - time[0])
    return Fraction(intervals / seconds).limit_denominator(100_000) if seconds > 0 else Fraction(0)


def _nominal(episode: Episode, cameras: Iterable[str]) -> Fraction | None:
    described: Any = episode.json
    for camera in cameras:
        return Fraction(*described["cameras"][camera]["fps"])
    hertz = _rates(episode).get("policy_hz")
    if isinstance(hertz, list) and len(hertz) == 2:
        return Fraction(*hertz)
    if TIME in episode and len(episode) > 1:
        time = episode[TIME]
        period = Fraction(float(time[-1] - time[0]) / (len(time) - 1)).limit_denominator(100_000)
        if period > 0:
            return 1 / period
    return None


def _require_even(episode: Episode, rate: Fraction) -> None:
    """Raises ArgumentError unless rows are within half a step of the engine of even times."""
    if TIME not in episode or len(episode) < 2:
        return
    time = np.asarray(episode[TIME], np.float64)
    late = time - np.arange(len(time)) / float(rate)
    if late.max() - late.min() <= _engine_step(episode) + ROUNDING_S:
        return
    periods = np.diff(time)
    raise ArgumentError(
        f"episode '{episode.folder}': its rows are not evenly spaced: from {periods.min():.6g} to "
        f"{periods.max():.6g} s apart, where {1 / float(rate):.6g} s were expected. This format "
        "stores a rate instead of times. Resample with --rate HZ, record environments with "
        "`sim: {async_control: true}`, leave the episode out with --episodes, or export a log of "
        "the true times: --format mcap"
    )


def _engine_step(episode: Episode) -> float:
    milliseconds = _rates(episode).get("sim_ms")
    if isinstance(milliseconds, int | float) and milliseconds > 0:
        return float(milliseconds) / 1e3
    return DEFAULT_STEP_S


def _rates(episode: Episode) -> dict[str, Any]:
    metadata: Any = episode.metadata
    rates = metadata.get("rates") if isinstance(metadata, dict) else None
    return rates if isinstance(rates, dict) else {}
