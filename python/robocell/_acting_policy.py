"""Calls a policy in rollouts: checks what it returns, keeps its chunks and the time of its calls.

Runs reach it through `PolicyExpert`, recorded environments directly.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robocell._action_chunks import Chunks
from robocell._core import ArgumentError, NotFoundError
from robocell._policy_calls import present
from robocell._policy_latency import CallDelays
from robocell._row import Row
from robocell._suggestions import counted, did_you_mean

if TYPE_CHECKING:
    from robocell.policy import Action, Context, Observation, Policy

FLOAT64 = np.dtype(np.float64)


class ActingPolicy:
    """Lets a policy act in one rollout after another: calls it and checks what it returns.

    Errors of the policy, and errors about its return values, are raised.

    Args:
        policy: The policy.
        chunks: Decides how many actions of a chunk are taken before the policy is called again.
        delays: Latencies of calls, if each has its own.
    """

    def __init__(
        self, policy: Policy, chunks: Chunks | None = None, delays: CallDelays | None = None
    ) -> None:
        self.policy = policy
        self._delays = delays if delays is not None and delays.are_of_calls else None
        self._chunks = chunks or Chunks()
        self._sizes: dict[str, int] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}

    def begin(self, context: Context) -> None:
        """Begins a rollout: resets the policy."""
        actions = [feature for feature in context.features if feature.role == "action"]
        self._sizes = {feature.name: (feature.shape or (1,))[0] for feature in actions}
        self._shapes = {name: (size,) for name, size in self._sizes.items()}
        self._chunks.clear()
        present.begin()
        if self._delays is not None:
            self._delays.begin(present.rollout)
        self.policy.reset(context)

    def name_in(self, row: Observation, has_streams: bool, draws: bool) -> Observation:
        """Lets messages about names that a row lacks say whose observation it is."""
        if isinstance(row, Row):
            row.title = f"{type(self.policy).__name__}.act(): the observation"
            if not has_streams:
                row.without_images = (
                    " The rollouts draw no images: the cell has no `cameras.streams`."
                )
            elif not draws:
                row.without_images = (
                    " The rollouts draw no images: leave out --no-cameras for those of a stream."
                )
        return row

    def next(self, row: Observation) -> dict[str, NDArray[np.float64]]:
        """Returns the next action of the policy's chunk, or of a new chunk."""
        if self._chunks.need_call():
            began = time.perf_counter()
            action = self.policy.act(row)
            elapsed_ms = 1e3 * (time.perf_counter() - began)
            actions = self._actions(action)
            timing = getattr(self.policy, "timing", {})
            present.add(self._chunks.step, len(actions), elapsed_ms, timing)
            if self._delays is None:
                self._chunks.add(actions)
            else:
                delay = self._delays.of_last(present)
                present.note_delay(delay)
                self._chunks.add(actions, delay)
        return dict(self._chunks.next())

    def _single(self, action: Action) -> dict[str, NDArray[np.float64]] | None:
        """Returns a copy of a valid single action of plain arrays; None for all others."""
        copies: dict[str, NDArray[np.float64]] = {}
        for name, values in action.items():
            if type(values) is not np.ndarray or values.dtype is not FLOAT64:
                return None
            if values.shape != self._shapes.get(name) or not math.isfinite(sum(values.tolist())):
                return None  # also for finite numbers whose sum is not
            copies[name] = values.copy()
        return copies or None

    def _actions(self, action: Action) -> list[dict[str, NDArray[np.float64]]]:
        """Splits a chunk into single actions."""
        if type(action) is dict and (single := self._single(action)) is not None:
            return [single]
        who = f"{type(self.policy).__name__}.act()"
        if not isinstance(action, Mapping) or not action:
            raise TypeError(
                f"{who} must return a dict of columns 'robots/.../action/...' to numbers, "
                f"got {action!r}"
            )
        if odd := [name for name in action if not isinstance(name, str)]:
            raise TypeError(f"{who}: the names of actions are texts, got {odd[0]!r}")
        arrays = {name: _real(who, name, values) for name, values in action.items()}
        lengths: dict[str, int] = {}
        for name, array in arrays.items():
            size = self._size(name)
            if array.shape == () and size == 1:
                array = arrays[name] = array.reshape(1)
            if array.ndim not in (1, 2) or array.shape[-1] != size or not array.size:
                raise ArgumentError(
                    f"{who}: '{name}' has {counted(size, 'number')}, or (k, {size}) for a chunk; "
                    f"got the shape {array.shape}"
                )
            if not np.isfinite(array).all():
                bad = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
                raise ArgumentError(
                    f"{who}: '{name}' is not finite: entry [{', '.join(map(str, bad))}] is "
                    f"{array[bad]}"
                )
            lengths[name] = array.shape[0] if array.ndim == 2 else 0
        if set(lengths.values()) == {0, 1}:  # a chunk of one beside single actions is one, too
            arrays = {name: np.reshape(array, -1) for name, array in arrays.items()}
            lengths = dict.fromkeys(lengths, 0)
        if len(set(lengths.values())) > 1:
            found = ", ".join(f"'{name}' {length or 1}" for name, length in lengths.items())
            raise ArgumentError(f"{who}: columns of one chunk differ in length: {found}")
        length = next(iter(lengths.values()))
        if length == 0:
            return [arrays]
        return [{name: array[i] for name, array in arrays.items()} for i in range(length)]

    def _size(self, name: str) -> int:
        if name not in self._sizes:
            raise NotFoundError(
                f"{type(self.policy).__name__}.act(): no action '{name}'."
                f"{did_you_mean(name, self._sizes)} The actions of this cell: "
                f"{', '.join(self._sizes)}"
            )
        return self._sizes[name]


def _real(who: str, name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns real numbers.

    NumPy would convert texts and times to numbers, and drop masks and the imaginary part of complex
    numbers.
    """
    if type(values) is np.ndarray and values.dtype.kind in "biuf":
        return values.astype(np.float64)
    array = np.asanyarray(values)
    kind = ""
    if np.iscomplexobj(array):
        kind = f"complex ones: {array.dtype}"
    elif array.dtype.kind not in "biufO":
        kind = f"{_KINDS.get(array.dtype.kind, 'other values')}: {array.dtype}"
    elif array.dtype.kind == "O" and (odd := [v for v in array.flat if isinstance(v, str | bytes)]):
        kind = f"texts: {odd[0]!r}"
    elif np.ma.is_masked(array):
        kind = "a masked array: fill its masked entries"
    if kind:
        raise TypeError(f"{who}: '{name}' must be real numbers, got {kind}")
    return np.array(array, dtype=np.float64)  # a copy: policies may write to theirs again


_KINDS = {"U": "texts", "S": "texts", "M": "times", "m": "times", "V": "records"}
