"""The expert of a task as a served policy.

An expert knows the simulation, and a client sends only what it sees. So the server makes the
expert's rollout from the same start in a cell of its own, and returns the actions that it recorded:
in a deterministic simulation they lead to the same result. The client names the start.
"""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset, RunConfig, Runner, make_plan, prepare_dataset
from robocell._dataset_run import plan_numbers
from robocell.generate import Keep
from robocell.policy import EXPERT
from robocell.policy_server._remote_policy import ROLLOUT, RUN_SEED

LONGEST_CHUNK = 2000  # actions of a reply
MOST_EPISODES = 100_000  # of a scene: the plan up to the client's rollout is made


class PlannedRollouts:
    """Makes the expert's rollouts of a run, one at a time.

    Args:
        source: Run file or dataset.
        imports: Modules to import first.
    """

    def __init__(self, source: str | Path, imports: Sequence[str] = ()) -> None:
        from robocell._generation.run_source import RunSource

        overrides = ['output="nowhere"', "cameras.draw=false"]
        self._run: RunConfig = RunSource(str(source), tuple(imports), EXPERT).load(overrides)
        self._lock = threading.Lock()

    def make(self, rollout: str, seed: int) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
        """Returns the times and the actions of the expert's rollout from a start.

        Raises:
            ArgumentError: There is no such start.
        """
        last = max((episode for _, episode in plan_numbers([rollout])), default=0)
        if last >= MOST_EPISODES:
            raise ArgumentError(
                f"rollout '{rollout}' is beyond {MOST_EPISODES} episodes of a scene"
            )
        with self._lock, tempfile.TemporaryDirectory(prefix="robocell-expert-") as folder:
            run = self._run
            run.seed, run.keep, run.output = seed, Keep.FIRST, str(Path(folder) / "rollout")
            run.episodes_per_scene = 1 + last
            item = next((item for item in make_plan(run) if item.id == rollout), None)
            if item is None:
                raise ArgumentError(f"the run of this server has no rollout '{rollout}'")
            prepare_dataset(run)
            result = Runner(run).run(item)
            if not result.committed:
                raise ArgumentError(f"the expert has no rollout from the start of '{rollout}'")
            episode = Dataset(Path(run.output))[rollout]
            actions = [each.name for each in episode.features if each.role == "action"]
            names = [name for name in actions if f"{name}_relative" in actions]
            columns = {name: np.array(episode[name], np.float64) for name in names}
            return np.array(episode["time"]), {
                name: values.reshape(len(values), -1) for name, values in columns.items()
            }


class ExpertSession:
    """One client of the expert."""

    def __init__(self, rollouts: PlannedRollouts) -> None:
        self._rollouts = rollouts
        self._times: NDArray[Any] = np.zeros(0)
        self._actions: dict[str, NDArray[Any]] = {}

    def reset(self, info: Mapping[str, Any]) -> None:
        """Makes the expert's rollout from the start that the client names."""
        rollout, seed = info.get(ROLLOUT), info.get(RUN_SEED)
        if not isinstance(rollout, str) or type(seed) is not int or not 0 <= seed < 2**63:
            raise ArgumentError(
                "an expert must know the start of a rollout, which only `robocell evaluate` names"
            )
        self._times, self._actions = self._rollouts.make(rollout, seed)

    def infer(self, observation: dict[str, Any]) -> dict[str, Any]:
        """Returns the expert's actions from the time of the observation on."""
        if not self._actions:
            self.reset({})
        try:
            time = float(np.asarray(observation.get("time"), np.float64).reshape(()))
        except (TypeError, ValueError) as error:
            raise ArgumentError("the observation has no 'time'") from error
        last = len(self._times) - 1
        row = min(int(np.searchsorted(self._times, time - 1e-6)), last)
        chunk = {name: values[row : row + LONGEST_CHUNK] for name, values in self._actions.items()}
        return {
            "actions": np.concatenate(list(chunk.values()), axis=1),
            "action_columns": [[name, values.shape[1]] for name, values in chunk.items()],
        }
