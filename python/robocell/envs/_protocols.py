"""What environments offer to `from_dataset` and to `robocell evaluate`."""

from __future__ import annotations

from typing import Any, Protocol

from robocell._core import CameraSystemConfig, Env, EnvState, Feature


class CellEnv(Protocol):
    """A cell behind reset and act, with the names of a dataset's columns.

    It is what a `DatasetEnv` steps: its `core`. `RunEnv` with the run's cameras is one; one of your
    own needs these members and no base class.
    """

    @property
    def observed(self) -> list[Feature]:
        """Features of the rows."""

    @property
    def commanded(self) -> list[Feature]:
        """Features of the actions."""

    @property
    def cameras(self) -> CameraSystemConfig:
        """Image streams."""

    @property
    def instruction(self) -> str:
        """The task of the present episode in words."""

    @property
    def object_kinds(self) -> list[str]:
        """Kinds of the objects of the present episode; [] if it has none."""

    def reset(self, index: int, /) -> None:
        """Resets to start `index`, which is always the same state."""

    def row(self) -> dict[str, Any]:
        """Returns the row that a dataset would record now: columns and images."""

    def act(self, actions: dict[str, Any], /) -> tuple[float, bool, bool, dict[str, Any]]:
        """Makes one step: (reward, terminated, truncated, info), with `is_success` in `info`."""


class RecordedCellEnv(CellEnv, Protocol):
    """The `CellEnv` of a dataset that an environment recorded: policies are evaluated in it."""

    env: Env

    def begin_at(self, state: EnvState, /) -> None:
        """Begins an episode in a state, such as the start of a recorded one."""
