"""A dataset that worker processes fill: its lock, its identity, what is left of it to make.

A run and an evaluation are both such jobs.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from robocell import Error
from robocell._durable import flush_path
from robocell._generation.disk import disk_trouble
from robocell._generation.items import Item, ItemRecord
from robocell._generation.observer import Observer, Unfailing
from robocell._generation.report import utc_now
from robocell._generation.run_source import RunSource
from robocell._generation.signals import stop_on_signals
from robocell._generation.supervisor import Limits, Outcome, StartWorker, Supervisor
from robocell.data import DatasetLock, remove_leftovers


@dataclass(frozen=True)
class Result:
    """How a job ended; `on_disk` is the number of its episodes on the disk."""

    outcome: Outcome
    on_disk: int

    @property
    def end(self) -> str:
        """The end in one word, such as 'complete'."""
        if self.outcome.fatal:
            return "failed"
        if self.outcome.interrupted:
            return "interrupted"
        return "complete" if self.on_disk >= self.outcome.totals.planned else "incomplete"


class SupervisedJob(ABC):
    """Items whose episodes worker processes make, in a dataset that one command at a time fills.

    Attributes:
        source: What the command was given.
        dataset: Folder of the episodes.
        items: The items.
        shard: (i, N): these are every N-th item of a plan, beginning with the i-th.
        shares_folder: True if others write beside it: other shards, other recorders.
    """

    source: RunSource
    dataset: Path
    items: Sequence[Item]
    shard: tuple[int, int] = (0, 1)
    shares_folder: bool = True

    @property
    @abstractmethod
    def workers(self) -> int:
        """Number of processes."""

    @abstractmethod
    def prepare(self, observer: Observer, limits: Limits) -> Mapping[str, str]:
        """Checks the job and makes its folder. Returns environment variables of the workers."""

    @abstractmethod
    def claim(self) -> None:
        """Writes into the locked folder what the episodes belong to, or compares it.

        It is there before the first episode. Raises SpecError for a folder of something else.
        """

    @abstractmethod
    def made(self) -> Set[str]:
        """Returns the items on the disk."""

    @abstractmethod
    def result_of(self, item_id: str) -> ItemRecord | None:
        """Returns the result of an item on the disk; None for one that is not made."""

    @abstractmethod
    def worker_command(self) -> list[str]:
        """Returns the command that starts a worker."""

    @abstractmethod
    def reproduce(self, item: Item) -> str:
        """Returns the command that makes an item alone, in a folder beside the dataset."""

    def flush(self) -> None:
        """Flushes the folders that hold the episodes. Raises OSError on failure."""
        flush_path(self.dataset)

    @contextmanager
    def elsewhere(self) -> Iterator[StartWorker | None]:
        """Context manager: starts workers on other machines; None starts them here.

        The dataset is locked and claimed.
        """
        yield None

    def logs(self) -> Path:
        """Returns the folder of the workers' logs."""
        return self.dataset / ".logs"

    def tried_once(self, made: Set[str], observer: Observer) -> Set[str]:
        """Returns items without retries."""
        return set()

    def finish(self, outcome: Outcome, started: str, observer: Observer) -> Result:
        """Returns the result, after the last worker; the dataset is still locked."""
        return Result(outcome, len(self.made()))

    def do(self, observer: Observer, limits: Limits | None = None) -> Result:
        """Makes the missing episodes. Raises SpecError before anything is written.

        Raises IoError or OSError if the dataset is not writable or in use. Ctrl-C and SIGTERM stop
        it; see `Supervisor`.
        """
        limits = limits or Limits()
        observer = Unfailing(observer)
        environment = self.prepare(observer, limits)
        with DatasetLock(self.dataset, *self.shard):
            self.claim()
            # Single files are not locked: another shard may be writing them.
            remove_leftovers(self.dataset, folders_only=self.shares_folder)
            made = self.made()
            started = utc_now()
            with self.elsewhere() as start_worker:
                supervisor = Supervisor(
                    [item for item in self.items if item.id not in made],
                    self.worker_command(),
                    workers=self.workers,
                    logs=self.logs(),
                    on_disk=self.result_of,
                    flush=self.flush,
                    observer=observer,
                    already=len(made),
                    reproduce=self.reproduce,
                    clean_up=lambda item_id, pid: self.clean_up(item_id, pid, observer),
                    disk_trouble=lambda: disk_trouble(self.dataset),
                    limits=limits,
                    tried_once=self.tried_once(made, observer),
                    environment=environment,
                    start_worker=start_worker,
                )
                # A signal that comes after the last worker must not take the report.
                with stop_on_signals(supervisor.request_stop):
                    return self.finish(supervisor.run(), started, observer)

    def clean_up(self, item_id: str, pid: int, observer: Observer) -> None:
        """Removes the remains of a worker that died, and reports those that it cannot remove."""
        try:
            remove_leftovers(self.dataset, item_id, pid)
        except (Error, OSError) as error:
            observer.warning(
                f"what a worker (pid {pid}) left of {item_id} could not be removed: {error}"
            )

    def reproduce_evaluation(
        self, item: Item, seed: int | None, max_steps: int | None, cameras: bool
    ) -> str:
        """Returns the command for the rollouts up to an item: a start follows from its number.

        `seed` None is that of the recorded starts, `max_steps` None that of the cell.
        """
        number = 1 + [each.id for each in self.items].index(item.id)
        alone = self.dataset.with_name(f"{self.dataset.name}_alone")
        return self.source.evaluation_command(number, seed, max_steps, cameras, alone)
