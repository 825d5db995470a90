"""Episodes from environments."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self, runtime_checkable

from robocell._core import ArgumentError, Env, EnvBatch, RunEnv, _EnvRecorder
from robocell.data._metadata import metadata_text


@runtime_checkable
class Recordable(Protocol):
    """An environment around an `rc.Env` or `EnvBatch`, which `EnvRecorder` records.

    Those of `robocell.gym` and `from_dataset` are; one of your own needs this property and no base
    class. Wrappers of Gymnasium are looked through by their `unwrapped`.
    """

    @property
    def recordable(self) -> Env | EnvBatch:
        """What the environment steps."""


class EnvRecorder:
    """Records what an environment does as episodes of a dataset.

    An episode begins with the first step after a reset (or `set_state`, `restore`). The next reset,
    `save`, or the end of the block saves it. It contains the cell's features, observations
    (`observation/...`), actions (`action/...`), rewards, end flags and camera frames. `robocell
    replay` and `replay_actions` reproduce it exactly.

    Args:
        env: An `rc.Env`, or with `copy` an `EnvBatch`; or any `Recordable` around one, such as the
            environments of `robocell.gym` and `from_dataset`, in wrappers of Gymnasium too.
        dataset: Folder of the dataset; created if missing.
        prefix: Prefix of the ids: "episode-000000". Recorders of one folder need different ones.
            Default: "episode", or "copy3" for copy 3.
        images: False records no frames.
        metadata: Your own JSON-compatible metadata, stored in every episode as `metadata["user"]`.
        copy: Index of the copy of a batch or vector, from 0.

    Raises:
        ArgumentError: The folder is not a dataset, belongs to a run, or has episodes of another
            environment; `env` cannot be recorded; `metadata` is not JSON-compatible.
        IoError: The disk fails, also in `env.step` and `env.reset`: the episode is then lost, and
            recording continues with the next reset. Another recorder uses the prefix.

    An exception that leaves the block drops the unsaved episode. A crash
    leaves a hidden folder, which no reader sees and `robocell verify --repair` sets aside.

    Examples:
        >>> action, _ = env.action_range
        >>> with rc.data.EnvRecorder(env, "out/teleop") as recorder:
        ...     start = env.reset(seed=1)
        ...     seen = env.step(action)  # one row
        ...     recorder.discard()  # or save(success=True)
        ...     start = env.reset()
        ...     seen = env.step(action)  # the next episode, saved at the end of the block
        >>> recorder.dataset, recorder.episodes
        (PosixPath('out/teleop'), ['episode-000000'])
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
        text = metadata_text(metadata)
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
        """Saves the present episode. Returns its id, or None if it has no step.

        Recording continues with the next reset.

        Args:
            success: Success to record, instead of the task's.
            reason: Reason of the end; "success", "diverged" or "stopped" unless given.
        """
        return self._recorder.save(success, reason)

    def discard(self) -> None:
        """Drops the present episode; recording continues with the next reset."""
        self._recorder.discard()

    def close(self) -> None:
        """Saves the present episode and records no more; may be repeated."""
        self._recorder.close()

    @property
    def closed(self) -> bool:
        """True after close()."""
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
    """Returns the C++ object behind an environment or its wrappers."""
    unwrapped = getattr(env, "unwrapped", env)
    core = unwrapped.recordable if isinstance(unwrapped, Recordable) else unwrapped
    if isinstance(core, Env | EnvBatch):
        return core
    if isinstance(core, RunEnv):
        raise ArgumentError(cell_of_a_run(type(env).__name__))
    raise ArgumentError(
        f"{type(env).__name__} cannot be recorded: EnvRecorder takes an rc.Env, an environment of "
        "robocell.gym, one that from_dataset made of recorded episodes, or with `copy` an EnvBatch "
        "or a vector of robocell.gym. One of your own needs `recordable`, the rc.Env that it steps "
        "(robocell.data.Recordable)"
    )


def cell_of_a_run(name: str) -> str:
    """Returns the message about the cell of a run."""
    return (
        f"{name} is the cell of a run, which EnvRecorder does not record: `robocell evaluate "
        "RUN_OR_DATASET --policy module:Class --output FOLDER` records what a policy does in it, "
        "and `robocell generate RUN.yaml` what its expert does"
    )
