"""Episodes from environments."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from robocell._core import ArgumentError, Env, EnvBatch, _EnvRecorder


class EnvRecorder:
    """Records what an environment does as episodes of a dataset.

    An episode begins with the first step after a reset (or `set_state`, `restore`) and is saved by
    the next one, by `save`, or at the end of the block. It has the cell's features, what the
    environment showed (`observation/...`) and was asked (`action/...`), rewards, ends, and the
    frames of its streams. `robocell replay` and `replay_actions` do it again, to the bit.

        with EnvRecorder(env, "out/teleop") as recorder:
            env.reset(seed=1)
            env.step(action)  # one row
            recorder.discard()  # or save(success=True)
            env.reset()  # the next episode
        print(recorder.episodes)

    Args:
        env: An `rc.Env`, an environment of Gymnasium's that robocell made, or with `copy` an
            `EnvBatch` or a vector.
        dataset: Its folder, which is made.
        prefix: What ids begin with: "episode-000000". Several recorders of a folder have one each.
            Default: "episode", and "copy3" of copy 3.
        images: Whether frames of streams are recorded.
        metadata: Of your own, kept with every episode as `metadata["user"]`: what JSON can say.
        copy: Which copy of a batch or vector, from 0.

    Raises:
        ArgumentError: The folder is no dataset, is that of a run, or has episodes of another
            environment; `env` cannot be recorded; JSON cannot say `metadata`.
        IoError: The disk fails, also out of `env.step` and `env.reset`: then the episode is gone
            and recording goes on with the next reset. Another recorder has the prefix.

    An exception that leaves the block drops the episode that was not saved. A crash
    leaves a hidden folder, which no reader sees and `robocell verify --repair` sets aside.
    """

    def __init__(
        self,
        env: Any,
        dataset: str | Path,
        *,
        prefix: str | None = None,
        images: bool = True,
        metadata: Mapping[str, Any] | None = None,
        copy: int | None = None,
    ) -> None:
        core = _core_of(env)
        try:
            text = json.dumps(dict(metadata or {}), allow_nan=False)
        except (TypeError, ValueError) as error:
            raise ArgumentError(
                f"metadata cannot be kept with episodes, as JSON: {error}; it takes texts, finite "
                "numbers, booleans, None, and lists and dictionaries of those"
            ) from error
        folder = Path(dataset)
        if isinstance(core, Env):
            if copy is not None:
                raise ArgumentError("copy is for batches and vectors; this is one environment")
            self._recorder = _EnvRecorder(core, folder, prefix or "episode", images, text)
        else:
            if copy is None:
                raise ArgumentError(
                    f"copy says which of the copies is recorded, 0 to {core.count - 1}; make a "
                    "recorder for each"
                )
            self._recorder = _EnvRecorder(core, copy, folder, prefix or f"copy{copy}", images, text)

    def save(self, success: bool | None = None, reason: str = "") -> str | None:
        """Saves the present episode and gives its id; None when it has no step.

        What follows is recorded from the next reset on.

        Args:
            success: What to record as success, in the place of what the task said.
            reason: Why it ended; "success", "diverged" or "stopped" unless given.
        """
        return self._recorder.save(success, reason)

    def discard(self) -> None:
        """Drops the present episode; what follows is recorded from the next reset on."""
        self._recorder.discard()

    def close(self) -> None:
        """Saves the present episode and records no more; may be repeated."""
        self._recorder.close()

    @property
    def closed(self) -> bool:
        """Whether it records no more."""
        return self._recorder.closed

    @property
    def episodes(self) -> list[str]:
        """Ids of the episodes that were saved."""
        return self._recorder.episodes

    @property
    def rows(self) -> int:
        """Steps of the present episode."""
        return self._recorder.rows

    @property
    def dataset(self) -> Path:
        """The dataset's folder."""
        return self._recorder.dataset

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            self.discard()
        self.close()


def _core_of(env: Any) -> Env | EnvBatch:
    """The C++ object behind an environment, whatever wraps it."""
    for candidate in (env, getattr(getattr(env, "unwrapped", env), "core", None)):
        if isinstance(candidate, Env | EnvBatch):
            return candidate
    raise ArgumentError(
        f"{type(env).__name__} cannot be recorded: EnvRecorder takes an rc.Env, an environment of "
        "robocell.gym, or with `copy` an EnvBatch or a vector of robocell.gym; runs record "
        "themselves (`robocell generate`, `robocell evaluate`)"
    )
