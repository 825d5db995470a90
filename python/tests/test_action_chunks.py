"""Which action of which chunk is taken, by a plain restatement of horizon and ensembling."""

from __future__ import annotations

import math

import numpy as np
import pytest

import robocell as rc
from robocell._action_chunks import DECAY, Chunks

POSE = "robots/a/action/tcp_pose"


def taken(chunks: Chunks, length: int, steps: int) -> tuple[list[float], list[int]]:
    """Values of actions and steps of calls; action i of call c is 100 c + i, and -1 none."""
    values, calls = [], []
    for step in range(steps):
        if chunks.need_call():
            call = len(calls)
            calls.append(step)
            chunks.add([{"x": np.array([100.0 * call + i])} for i in range(length)])
        values.append(float(chunks.next().get("x", [-1.0])[0]))
    return values, calls


def test_whole_chunks_are_taken_without_a_horizon():
    assert taken(Chunks(), 3, 7) == ([0, 1, 2, 100, 101, 102, 200], [0, 3, 6])


def test_a_horizon_leaves_the_rest_of_a_chunk():
    assert taken(Chunks(2), 5, 6) == ([0, 1, 100, 101, 200, 201], [0, 2, 4])
    assert taken(Chunks(9), 2, 4) == ([0, 1, 100, 101], [0, 2]), "a chunk is shorter"
    assert taken(Chunks(1), 1, 3) == ([0, 100, 200], [0, 1, 2])


@pytest.mark.parametrize(
    ("horizon", "delay", "length", "values", "calls"),
    [
        (None, 2, 5, [-1, -1, 2, 3, 4, 102, 103, 104, 202], [0, 3, 6]),
        (2, 1, 9, [-1, 1, 2, 101, 102, 201, 202], [0, 2, 4, 6]),
        (1, 1, 5, [-1, 1, 101, 201], [0, 1, 2, 3]),
        (None, 2, 1, [-1, -1, 0, -1, 100, -1], [0, 2, 4]),
        (None, 3, 3, [-1, -1, -1, 2, -1, -1, 102], [0, 3, 6]),
    ],
)
def test_late_answers_skip_the_actions_whose_time_is_over(
    horizon: int | None, delay: int, length: int, values: list[int], calls: list[int]
):
    assert taken(Chunks(horizon, delay=delay), length, len(values)) == (values, calls)


def test_calls_with_their_own_latencies_come_as_late_as_the_last_one_was():
    chunks = Chunks()
    values, calls = [], []
    for step in range(12):
        if chunks.need_call():
            calls.append(step)
            actions = [{"x": np.array([100.0 * len(calls) + i])} for i in range(5)]
            chunks.add(actions, [1, 3, 0][len(calls) - 1])
        values.append(float(chunks.next().get("x", [-1.0])[0]))
    # The first answer is one step late, so the second call begins one step before the chunk ends.
    # Its answer is three late; the third call begins with it, as its two actions are fewer.
    assert calls == [0, 4, 7]
    assert values == [-1, 101, 102, 103, 104, -1, -1, 300, 301, 302, 303, 304]


def test_a_late_ensemble_is_the_mean_of_the_answers_that_have_arrived():
    values, calls = taken(Chunks(ensemble=True, delay=1), 3, 4)
    assert calls == [0, 1, 2, 3]
    weights = np.exp([0, -DECAY])
    assert values[:2] == [-1, 1]
    assert values[2] == pytest.approx(np.average([2, 101], weights=weights))


@pytest.mark.parametrize(("horizon", "length"), [(None, 4), (2, 5), (3, 3), (5, 2), (1, 1)])
def test_an_ensemble_is_the_weighted_mean_of_all_predictions(horizon: int | None, length: int):
    values, calls = taken(Chunks(horizon, ensemble=True), length, 12)
    every = min(horizon or 1, length)
    assert calls == list(range(0, 12, every))
    for step, value in enumerate(values):
        made = [c for c, at in enumerate(calls) if at <= step < at + length]
        weights = [math.exp(-DECAY * i) for i in range(len(made))]  # the oldest first
        predicted = [100 * c + step - calls[c] for c in made]
        assert value == pytest.approx(np.average(predicted, weights=weights))


def test_rotations_are_averaged_as_rotations():
    def pose(angle: float, sign: float) -> np.ndarray:
        rotation = sign * np.array([0, 0, math.sin(angle / 2), math.cos(angle / 2)])
        return np.array([angle, 0, 0, *rotation])

    chunks = Chunks(ensemble=True)
    chunks.add([{POSE: pose(0.0, 1)}, {POSE: pose(0.2, 1)}])
    chunks.next()
    chunks.add([{POSE: pose(0.4, -1)}])
    mean = chunks.next()[POSE]
    assert mean[0] == pytest.approx(0.3, abs=1e-3)
    assert np.linalg.norm(mean[3:]) == pytest.approx(1)
    assert rc.Pose(quaternion=mean[3:]).rotvec[2] == pytest.approx(0.3, abs=1e-3)


def test_opposite_rotations_have_no_mean_and_the_newest_counts():
    chunks = Chunks(ensemble=True)
    chunks.add([{POSE: np.array([0, 0, 0, 0, 0, 0, 1.0])}] * 2)
    chunks.next()
    chunks.add([{POSE: np.array([0, 0, 0, 0, 0, 1.0, 0])}])
    assert np.linalg.norm(chunks.next()[POSE][3:]) == pytest.approx(1)


def test_a_column_that_only_some_chunks_have_is_averaged_over_those():
    chunks = Chunks(ensemble=True)
    chunks.add([{"x": np.zeros(1)}] * 2)
    chunks.next()
    chunks.add([{"y": np.ones(1)}])
    assert chunks.next() == {"y": np.ones(1)}


def test_a_new_rollout_forgets_the_chunks():
    chunks = Chunks(5)
    chunks.add([{"x": np.zeros(1)}] * 5)
    chunks.next()
    chunks.clear()
    assert chunks.need_call()
    assert chunks.step == 0


def test_a_horizon_below_one_is_rejected():
    with pytest.raises(rc.ArgumentError, match="horizon must be at least 1, got 0"):
        Chunks(0)
