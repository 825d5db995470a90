"""The environment behind a dataset that `robocell.data.EnvRecorder` made, for `from_dataset`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robocell._core import (
    ArgumentError,
    CameraSystemConfig,
    Dataset,
    Env,
    EnvState,
    Feature,
    _recorded_features,
)
from robocell.data import env_of_episode


def is_recorded(dataset: Dataset) -> bool:
    """Returns True if an environment recorded the episodes."""
    metadata: Any = dataset[0].metadata if len(dataset) else {}
    return "environment" in metadata


OWN = "action/"  # begins the names of an environment's own actions
CELL = "robots/"  # begins those of its cell


class RecordedEnv:
    """An environment whose rows and actions have the names of its episodes' columns.

    A start depends on its seed only. Without `home_on_reset`, where arms stay in place, each start
    has them where the first start of seed 0 has them.

    Raises ArgumentError for an environment of the caller's without `home_on_reset`: nobody knows
    where its arms are.
    """

    def __init__(self, dataset: Dataset, images: bool, env: Env | None = None) -> None:
        if env is not None and not env.config.wrappers.home_on_reset:
            raise ArgumentError(
                f"environment '{env.config.name}' has `wrappers: {{home_on_reset: false}}`: its "
                "starts depend on the episodes before, and here start i is that of seed i. Make it "
                "with home_on_reset: true"
            )
        self.env: Env = env_of_episode(dataset[0], images) if env is None else env
        self._arms_stay = not self.env.config.wrappers.home_on_reset
        self._first: EnvState | None = None  # of the first start, if arms stay
        self._cell = _recorded_features(self.env)
        self._observation: dict[str, Any] = {}
        self.object_kinds: list[str] = []

    @property
    def cameras(self) -> CameraSystemConfig:
        """Image streams of the environment."""
        return self.env.config.cameras

    @property
    def observed(self) -> list[Feature]:
        """Features of the rows."""
        return [*self._cell.observed, *self.env.observed]

    @property
    def commanded(self) -> list[Feature]:
        """Features of the actions: the environment's own, and those of its cell."""
        return [*self.env.commanded, *self._cell.commanded]

    @property
    def instruction(self) -> str:
        """The instruction."""
        return self.env.instruction

    def reset(self, index: int) -> None:
        """Resets to the start of seed `index`."""
        if self._arms_stay:
            self._place_arms()
        self._observation, _ = self.env.reset(index)

    def _place_arms(self) -> None:
        if self._first is None:
            self.env.reset(0)
            self._first = self.env.get_state()
        self.env.set_state(self._first)

    def begin_at(self, state: EnvState) -> None:
        """Begins an episode in a state, such as the start of a recorded one."""
        self._observation = self.env.set_state(state)

    def row(self) -> dict[str, Any]:
        """Returns the row that would be recorded now."""
        row: dict[str, Any] = dict(self.env.row())
        for path, _, _ in self.env.observation_parts:
            row["/".join(("observation", *path))] = _at(self._observation, path)
        return row

    def act(self, actions: Mapping[str, Any]) -> tuple[float, bool, bool, dict[str, Any]]:
        """(reward, terminated, truncated, info) of actions by their names."""
        for name in actions:
            if not name.startswith((OWN, CELL)):
                raise ArgumentError(
                    f"action '{name}' is none of this environment; it takes "
                    f"{', '.join(f.name for f in self.commanded)}"
                )
        own = [name for name in actions if name.startswith(OWN)]
        if own and len(own) < len(actions):
            (other, *_) = (name for name in actions if name not in own)
            raise ArgumentError(
                f"actions '{own[0]}' and '{other}' are of two kinds: those of the environment "
                "(action/...) and those of its cell (robots/...); give actions of one kind"
            )
        action: dict[str, Any] = {} if own else dict(actions)
        for name in own:
            robot, _, command = name.removeprefix(OWN).rpartition("/")
            action.setdefault(robot, {})[command] = actions[name]
        self._observation, reward, terminated, truncated, info = self.env.step(action)
        info.setdefault("is_success", False)
        return reward, terminated, truncated, info


def _at(tree: Any, path: tuple[str, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree
