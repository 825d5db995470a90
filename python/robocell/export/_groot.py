"""The files that GR00T reads beside a LeRobot dataset of version 2.1.

`meta/modality.json` names the ranges of state and action. `meta/relative_stats.json` has the
statistics of relative actions: a chunk of actions minus the state before its first.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robocell._groot_names import short_name
from robocell.export._features import Feature
from robocell.export._lerobot_rows import numbers_of
from robocell.export._source import Source
from robocell.export._statistics import Statistics, Vectors

STATE, ACTION = "observation.state", "action"  # GR00T reads these two
HORIZON = 16  # actions of a chunk in GR00T's configurations
RELATIVE = ("min", "max", "mean", "std", "q01", "q99")  # the statistics that GR00T reads
KEPT_NUMBERS = 1 << 20  # of chunks in memory, for quantiles

Ranges = dict[str, dict[str, int]]


def modality(source: Source) -> dict[str, Any]:
    """Returns the content of meta/modality.json.

    The ranges of state and action follow each other and cover the whole vectors.
    """
    several = len(source.resolved.robots) > 1
    return {
        "state": _ranges(_feature(source, STATE), several),
        "action": _ranges(_feature(source, ACTION), several),
        "video": {
            camera.feature.removeprefix("observation.images."): {"original_key": camera.feature}
            for camera in source.cameras
        },
        "annotation": {"human.task_description": {"original_key": "task_index"}},
    }


class RelativeActions:
    """Statistics of actions relative to the state at the beginning of their chunk.

    Chunks begin at every row that has `horizon` actions left. An action has such statistics if the
    state has a range with its name, size, units and frames: joint and gripper targets do,
    displacements do not.

    Attributes:
        horizon: Number of actions of a chunk.
    """

    def __init__(self, source: Source, horizon: int) -> None:
        self.horizon = horizon
        self._pairs = _pairs(source)
        self._chunks: dict[str, Vectors] = {}
        for name, (_, action) in self._pairs.items():
            size = horizon * (action.stop - action.start)
            self._chunks[name] = Vectors(size, kept=max(1 << 10, KEPT_NUMBERS // size))

    def add(self, table: Any) -> None:
        """Adds the rows of an episode, an Arrow table."""
        if not self._pairs or len(table) < self.horizon:
            return
        states = numbers_of(table.column(STATE))
        actions = numbers_of(table.column(ACTION))
        for name, (state, action) in self._pairs.items():
            windows = np.lib.stride_tricks.sliding_window_view(
                actions[:, action], self.horizon, axis=0
            )
            chunks = windows.transpose(0, 2, 1) - states[: len(windows), None, state]
            self._chunks[name].add(chunks.reshape(len(chunks), -1))

    def result(self) -> dict[str, Statistics]:
        """Returns statistics of shape (horizon, size) by name, of names that have a chunk."""
        found = {}
        for name, chunks in self._chunks.items():
            if chunks.count:
                whole = chunks.result()
                found[name] = {
                    key: np.reshape(whole[key], (self.horizon, -1)).tolist() for key in RELATIVE
                }
        return found


def _pairs(source: Source) -> dict[str, tuple[slice, slice]]:
    """Returns the range of the state and of the action of each name that both have."""
    state, action = _feature(source, STATE), _feature(source, ACTION)
    if state is None or action is None:
        return {}
    several = len(source.resolved.robots) > 1
    of_state, of_action = _ranges(state, several), _ranges(action, several)
    pairs = {}
    for name in of_state.keys() & of_action.keys():
        own, other = _slice(of_state[name]), _slice(of_action[name])
        if all(
            getattr(state, what)[own] == getattr(action, what)[other]
            for what in ("units", "frames")
        ):
            pairs[name] = own, other
    return dict(sorted(pairs.items()))


def _slice(bounds: dict[str, int]) -> slice:
    return slice(bounds["start"], bounds["end"])


def _feature(source: Source, name: str) -> Feature | None:
    return next((each for each in source.resolved.features if each.name == name), None)


def _ranges(feature: Feature | None, several_robots: bool) -> Ranges:
    """Returns the range of each column in a feature, under a short name."""
    ranges: Ranges = {}
    if feature is None:
        return ranges
    for index, source in enumerate(feature.sources):
        name = short_name(source, several_robots)
        if name in ranges and feature.sources[index - 1] != source:
            name = source.replace("/", "_")  # two columns with the same short name
        if name in ranges:
            ranges[name]["end"] = index + 1
        else:
            ranges[name] = {"start": index, "end": index + 1}
    return ranges
