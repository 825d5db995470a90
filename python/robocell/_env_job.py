"""An evaluation in the environment of a recorded dataset: its starts, its workers, its rollouts.

It offers what `evaluate` needs of a `Job`: `items`, `dataset`, `rate` and `do`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, Dataset, SpecError, atomic_write
from robocell._durable import make_folders
from robocell._env_rollouts import (
    MODELS,
    EnvRollouts,
    EnvStarts,
    command,
    longest_episode,
    rollout_of,
)
from robocell._generation.disk import require_writable
from robocell._generation.items import Item, ItemRecord
from robocell._generation.observer import Observer
from robocell._generation.run_source import RunSource
from robocell._generation.supervised_job import SupervisedJob
from robocell._generation.supervisor import Limits
from robocell._policy_calls import error_of
from robocell.policy import EXPERT, POLICY_ERROR, REPLAY

IDENTITY = "evaluation_identity.json"  # what the rollouts of a folder belong to
CODE, CELL = "code", "cell"  # messages describe these parts without their values


class EnvJob(SupervisedJob):
    """The rollouts of a policy in the environment of a recorded dataset.

    Args:
        source: The dataset, its modules and the policy.
        output: Folder of the rollouts.
        episodes: Number of starts; None for all recorded ones, with `replay`.
        seed: Seed of the starts. `replay` begins from the recorded ones.
        max_steps: Actions of a rollout; None for the length of the longest recorded episode.
        workers: Number of processes.
        cameras: Whether images are rendered.

    Raises ArgumentError for the expert, and as `EnvRollouts`; SpecError for a folder with another
    evaluation.
    """

    def __init__(
        self,
        source: RunSource,
        output: Path,
        *,
        episodes: int | None,
        seed: int,
        max_steps: int | None,
        workers: int,
        cameras: bool,
    ) -> None:
        if source.policy == EXPERT:
            raise ArgumentError(
                f"policy '{EXPERT}': '{source.run}' was recorded from an environment, which has no "
                "expert: experts act in runs. Evaluate a run of the same task: `robocell evaluate "
                f"RUN.yaml --policy {EXPERT}`; `replay` repeats the recorded actions here"
            )
        self.source, self.dataset, self._workers = source, output, workers
        folder = Path(source.run)
        recorded = len(Dataset(folder)) if source.policy == REPLAY else None
        if recorded is not None:
            episodes = min(recorded, episodes or recorded)
        self._starts = EnvStarts(
            folder.absolute(),
            output.absolute(),
            None if recorded is not None else seed,
            longest_episode(folder) if max_steps is None else max_steps,
            cameras,
        )
        self.items = [self._starts.item(number) for number in range(episodes or 100)]
        rollouts = EnvRollouts(source, self._starts)
        sim = rollouts.config.sim
        self.rate = float(sim.frequency) if sim.async_control else None
        self.cell = rollouts.cell_fields
        self._identity: dict[str, Any] = json.loads(json.dumps(rollouts.identity))
        rollouts.env.close()

    def failure_of(self, item_id: str) -> str:
        """Returns the error of a policy that raised before its first action; "" without one."""
        return error_of(self.dataset, item_id)

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self._workers

    def prepare(self, observer: Observer, limits: Limits) -> Mapping[str, str]:
        """Makes the folder. Raises IoError if it is not writable."""
        require_writable(self.dataset)
        if (self.dataset / "dataset.json").exists():
            raise SpecError(f"'{self.dataset}' belongs to a run; choose another --output")
        # Makes it a dataset before its first episode.
        make_folders(self.dataset / MODELS)
        return {}

    def claim(self) -> None:
        """Writes the identity of the evaluation, or compares it with that of the folder."""
        path = self.dataset / IDENTITY
        if path.exists():
            self._require_same(path)
            return
        if any(self.result_of(item.id) for item in self.items):
            raise SpecError(
                f"'{self.dataset}' has rollouts, and no {IDENTITY} says which evaluation they are "
                "of; choose another --output, or remove the folder"
            )
        atomic_write(path, (json.dumps(self._identity, indent=1) + "\n").encode())

    def made(self) -> set[str]:
        """Returns the items whose rollouts are on the disk."""
        return {item.id for item in self.items if self.result_of(item.id)}

    def worker_command(self) -> list[str]:
        """Returns the command that starts a worker."""
        return command(self.source, self._starts)

    def reproduce(self, item: Item) -> str:
        """Returns the command for all rollouts up to this one."""
        starts = self._starts
        return self.reproduce_evaluation(item, starts.seed, starts.max_steps, starts.cameras)

    def result_of(self, item_id: str) -> ItemRecord | None:
        """Returns the result of a rollout that was made."""
        episode = rollout_of(self.dataset, Item(item_id, 0))
        reason = "" if episode else self.failure_of(item_id)
        if episode is None and not reason:
            return None
        success = bool(episode.success) if episode else False
        why = f"{POLICY_ERROR}{reason}" if reason else str(episode.end_reason if episode else "")
        return ItemRecord(
            item_id,
            success=success,
            complete=True,
            attempts=1,
            accepted=1,
            failures={} if success else {why: 1},
            rows=len(episode) if episode else 0,
        )

    def _require_same(self, path: Path) -> None:
        """Raises SpecError unless the folder has the same evaluation."""
        try:
            earlier = json.loads(path.read_text())
        except (OSError, ValueError) as error:
            raise SpecError(
                f"cannot read '{path}': {error}; choose another --output, or remove the folder"
            ) from error
        if not isinstance(earlier, dict):
            earlier = {}
        if differing := _differences(earlier, self._identity):
            raise SpecError(
                f"'{self.dataset}' has another evaluation: {', '.join(differing)}; choose another "
                "--output, or remove the folder"
            )


def _differences(earlier: Mapping[str, Any], present: Mapping[str, Any]) -> list[str]:
    """Returns the fields that differ, and of the code the files that changed."""
    found = [
        f"{name}: {earlier.get(name)} and now {present.get(name)}"
        for name in dict.fromkeys((*earlier, *present))
        if name not in (CODE, CELL) and earlier.get(name) != present.get(name)
    ]
    if earlier.get(CELL) != present[CELL]:
        found.append("the environment of the dataset changed")
    then, now = dict(earlier.get(CODE) or {}), present[CODE]
    changed = [file for file in sorted({*then, *now}) if then.get(file) != now.get(file)]
    return found + [f"code file {file} changed since then" for file in changed]
