"""An evaluation in the environment of a recorded dataset: its starts, its workers, its rollouts.

It offers what `evaluate` needs of a `Job`: `items`, `dataset`, `rate` and `do`.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, Dataset, SpecError
from robocell._env_rollouts import (
    EnvRollouts,
    EnvStarts,
    command,
    longest_episode,
    rollout_of,
)
from robocell._generation.disk import disk_trouble, flush, require_writable
from robocell._generation.items import Item, ItemRecord
from robocell._generation.job import Result
from robocell._generation.observer import Observer, Unfailing
from robocell._generation.run_source import RunSource
from robocell._generation.signals import stop_on_signals
from robocell._generation.supervisor import Limits, Supervisor
from robocell._policy_calls import error_of
from robocell.policy import EXPERT, POLICY_ERROR, REPLAY

MODELS = "models"  # a folder of every dataset; makes the output one before its first episode


class EnvJob:
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
        self.cell = f"{rollouts.config.to_yaml()}\nmax_steps: {self._starts.max_steps}\n"
        self._identity = rollouts.identity
        rollouts.env.close()

    def failure_of(self, item_id: str) -> str:
        """Returns the error of a policy that raised before its first action; "" without one."""
        return error_of(self.dataset, item_id)

    def do(self, observer: Observer, limits: Limits | None = None) -> Result:
        """Makes the missing rollouts. Raises IoError if the folder is not writable."""
        require_writable(self.dataset)
        self._require_same_evaluation()
        (self.dataset / MODELS).mkdir(parents=True, exist_ok=True)
        made = {item.id for item in self.items if self._on_disk(item.id)}
        supervisor = Supervisor(
            [item for item in self.items if item.id not in made],
            command(self.source, self._starts),
            workers=self._workers,
            logs=self.dataset / ".logs",
            on_disk=self._on_disk,
            flush=lambda: flush(self.dataset),
            observer=Unfailing(observer),
            already=len(made),
            reproduce=self._reproduce,
            disk_trouble=lambda: disk_trouble(self.dataset),
            limits=limits or Limits(),
        )
        with stop_on_signals(supervisor.request_stop):
            outcome = supervisor.run()
        return Result(outcome, sum(self._on_disk(item.id) is not None for item in self.items))

    def _on_disk(self, item_id: str) -> ItemRecord | None:
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

    def _require_same_evaluation(self) -> None:
        """Raises SpecError if the folder has rollouts of another evaluation."""
        if not self.dataset.is_dir():
            return
        for item in self.items:
            if (episode := rollout_of(self.dataset, item)) is None:
                continue
            metadata: Any = episode.metadata
            earlier = dict(metadata.get("user", {}).get("evaluation", {}))
            differing = [
                name for name, value in self._identity.items() if earlier.get(name) != value
            ]
            if differing:
                raise SpecError(
                    f"'{self.dataset}' has another evaluation: {' and '.join(differing)} differ; "
                    "choose another --output, or remove the folder"
                )
            return

    def _reproduce(self, item: Item) -> str:
        """Returns the command for all rollouts up to this one."""
        imports = [part for module in self.source.imports for part in ("--import", module)]
        options: Sequence[str] = [
            *("--policy", self.source.policy, *self.source.acting.arguments()),
            *("-n", str(item.index + 1)),
            *([] if self._starts.seed is None else ["--seed", str(self._starts.seed)]),
            *("--output", str(self.dataset.with_name(f"{self.dataset.name}_alone"))),
        ]
        return shlex.join(["robocell", "evaluate", self.source.run, *imports, *options])
