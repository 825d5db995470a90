"""Chunks of actions: how many of each are taken, and how those of several calls are averaged.

    chunks = Chunks(horizon=8)
    if chunks.need_call():
        chunks.add(policy's actions)
    action = chunks.next()

With `ensemble`, a chunk stays in use to its end while newer ones are added: the action of a moment
is the weighted mean of all predictions for it (temporal ensembling, Zhao et al. 2023, ACT).

With `delay`, the answer to an observation arrives that many steps later. The next call begins early
enough, so that actions of the last chunk fill the time; without any the robot waits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError

Actions = Mapping[str, NDArray[np.float64]]

# Weight of the i-th oldest prediction is exp(-DECAY * i), as in ACT: the oldest counts most.
DECAY = 0.01


@dataclass
class _Chunk:
    begin: int  # step of its first action
    actions: Sequence[Actions]

    @property
    def end(self) -> int:
        return self.begin + len(self.actions)


class Chunks:
    """Actions that a policy has planned in one rollout.

    Args:
        horizon: Actions between two calls of the policy. Default: whole chunks, and one with
            `ensemble`. A shorter chunk is used up earlier.
        ensemble: Average the predictions of all chunks for the same moment.
        delay: Steps from an observation to the first action that can follow from it. The actions of
            a chunk for the steps before are skipped; a chunk without others begins with its last.
    """

    def __init__(self, horizon: int | None = None, ensemble: bool = False, delay: int = 0) -> None:
        if horizon is not None and horizon < 1:
            raise ArgumentError(f"horizon must be at least 1, got {horizon}")
        if delay < 0:
            raise ArgumentError(f"delay must be at least 0, got {delay}")
        self._first_delay = delay
        self._horizon = 1 if ensemble and horizon is None else horizon
        self._ensemble = ensemble
        self.clear()

    def clear(self) -> None:
        """Forgets all actions, at the beginning of a rollout."""
        self._step = 0
        self._delay = self._first_delay
        self._chunks: list[_Chunk] = []

    @property
    def step(self) -> int:
        """Number of actions that were taken."""
        return self._step

    def need_call(self) -> bool:
        """Returns True if the policy must be called before the next action."""
        if not self._chunks:
            return True
        newest = self._chunks[-1]
        if newest.begin > self._step:
            return False  # its answer is on the way
        used = self._step + self._delay - newest.begin
        return used >= len(newest.actions) or (self._horizon is not None and used >= self._horizon)

    def add(self, actions: Sequence[Actions], delay: int | None = None) -> None:
        """Adds the chunk for the observation of the present step.

        `delay` is the one of this call, if calls have their own; the next call begins as early as
        the same delay needs.
        """
        if delay is not None:
            self._delay = delay
        kept = self._ensemble or self._delay > 0
        in_use = [chunk for chunk in self._chunks if kept and chunk.end > self._step]
        skipped = min(self._delay, len(actions) - 1)
        self._chunks = [*in_use, _Chunk(self._step + self._delay, actions[skipped:])]

    def next(self) -> dict[str, NDArray[np.float64]]:
        """Returns the action of the present step, and goes on; {} if there is none to take yet."""
        planned = [
            chunk.actions[self._step - chunk.begin]
            for chunk in self._chunks
            if chunk.begin <= self._step < chunk.end
        ]
        self._step += 1
        if not planned:
            return {}
        newest = planned[-1]
        if len(planned) == 1 or not self._ensemble:
            return dict(newest)
        return {
            name: _mean(name, [each[name] for each in planned if name in each]) for name in newest
        }


def _mean(name: str, predictions: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Returns the weighted mean of predictions, the oldest first."""
    values = np.array(predictions)
    weights = np.exp(-DECAY * np.arange(len(values)))
    if not name.endswith("/tcp_pose"):
        mean: NDArray[np.float64] = weights @ values / weights.sum()
        return mean
    # q and -q are the same rotation; those on the side of the newest are averaged.
    quaternions = values[:, 3:]
    values[:, 3:] *= np.where(quaternions @ quaternions[-1] < 0, -1.0, 1.0)[:, None]
    mean = weights @ values / weights.sum()
    length = float(np.linalg.norm(mean[3:]))
    mean[3:] = mean[3:] / length if length > 1e-6 else values[-1, 3:]
    return mean
