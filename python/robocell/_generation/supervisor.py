"""Supervisor: keeps worker processes busy with the items of a plan until all are decided.

    supervisor = Supervisor(items, command, workers=4, logs=dataset / ".logs", on_disk=on_disk)
    outcome = supervisor.run()

A new worker retries an item that a worker could not finish because it died, raised or took too
long. After three tries, the item is listed with the command that makes it alone. The disk decides
which items are made (`on_disk`), so a worker that dies between commit and result loses and doubles
nothing. A wrong spec is not retried. If none of the first items works, the run ends (`canaries`).
Workers on other machines wait for a free core there; see `Limits.losses` for lost machines.

`request_stop` may be called from any thread or signal handler. The content of items and of the disk
belongs to `robocell._cli.generate`.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import time
from collections import Counter, deque
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell._generation.canaries import Canaries
from robocell._generation.disk import with_trouble
from robocell._generation.items import Item, ItemRecord
from robocell._generation.observer import CANNOT_GO_ON, Observer, Unfailing
from robocell._generation.own_process import own_environment
from robocell._generation.protocol import Failure, FailureKind, ProtocolError
from robocell._generation.totals import Again, Death, Totals, Unmade
from robocell._generation.worker_process import Worker, WorkerProcess

TICK_S = 0.2
STARTS_WITHOUT_SUCCESS = 3
PATIENCE_S = 60.0  # before a warning that no machine has a free core
TURN_VARIABLE = "ROBOCELL_EGL_TURN"  # workers take the graphics cards in turn

StartWorker = Callable[[int, Path], Worker]  # by its number and its log


@dataclass(frozen=True)
class Limits:
    """Retries and time limits of a supervisor.

    Attributes:
        tries: Attempts per item that workers do not finish.
        losses: Attempts per item that end because a machine is lost; it may be the item's fault.
        item_timeout_s: Time limit for one item, and for starting a worker.
        stop_grace_s: Time for workers to end after a stop request; then they are killed.
    """

    tries: int = 3
    losses: int = 10
    item_timeout_s: float = 1800.0
    stop_grace_s: float = 10.0


@dataclass(frozen=True)
class Fatal:
    """Reason that ended a run.

    Attributes:
        kind: Kind of the error.
        message: The error.
        summary: The same for a reader who has seen the errors of the items; "" if it is news.
    """

    kind: FailureKind
    message: str
    summary: str = ""


@dataclass(frozen=True)
class Outcome:
    """The end of a run.

    Attributes:
        totals: Counts of the run.
        interrupted: True if a stop request left items.
        fatal: Reason that ended the run, or None.
        results: Results of the decided items, in the order of the decisions.
    """

    totals: Totals
    interrupted: bool
    fatal: Fatal | None
    results: Sequence[ItemRecord] = ()


class Supervisor:
    """Makes the items with worker processes. One `run` per object.

    Args:
        items: Items to make.
        command: Starts a worker that speaks `robocell._generation.protocol`.
        workers: Number of parallel workers.
        logs: Folder for the workers' standard error, one file each.
        on_disk: Returns an item's result if its episode is on the disk, else None.
        flush: Flushes existing episodes to the disk; raises OSError on failure.
        observer: Receives events; its OSErrors do not end the run.
        already: Number of items that existed before, for the totals.
        reproduce: Returns the command that makes one item alone.
        clean_up: Called with an item's id and the process that died while making it.
        disk_trouble: Returns why the disk is not writable, or None; called after an input/output
            error.
        limits: Retries and time limits.
        tried_once: Items without retries.
        environment: Additional environment variables for workers.
        start_worker: Starts a worker elsewhere; None starts `command` on this machine.
    """

    def __init__(
        self,
        items: Sequence[Item],
        command: Sequence[str],
        *,
        workers: int,
        logs: Path,
        on_disk: Callable[[str], ItemRecord | None],
        flush: Callable[[], object] = lambda: None,
        observer: Observer | None = None,
        already: int = 0,
        reproduce: Callable[[Item], str] = lambda item: "",
        clean_up: Callable[[str, int], object] = lambda item_id, pid: None,
        disk_trouble: Callable[[], str | None] = lambda: None,
        limits: Limits | None = None,
        tried_once: Collection[str] = (),
        environment: Mapping[str, str] | None = None,
        start_worker: StartWorker | None = None,
    ) -> None:
        self._canaries = Canaries(items, any_made=already > 0)
        self._pending = deque(self._canaries.first(items))
        self._command = list(command)
        self._count = min(workers, len(items))
        self._logs = logs
        self._on_disk = on_disk
        self._flush = flush
        self._observer = Unfailing(observer or Observer())
        self._reproduce = reproduce
        self._clean_up = clean_up
        self._disk_trouble = disk_trouble
        self._limits = limits or Limits()
        self._tried_once = frozenset(tried_once)
        self._environment = {**own_environment(), **(environment or {})}
        self._start_worker = start_worker or self._start_process
        self._totals = Totals(planned=len(items) + already, already=already, workers=self._count)
        self._workers: dict[int, Worker] = {}
        self._tries: Counter[str] = Counter()
        self._losses: Counter[str] = Counter()
        self._lost_starts = 0
        self._warned_of_waiting = False
        self._printed_logs: set[str] = set()
        self._results: list[ItemRecord] = []
        self._bad_starts = 0
        self._fatal: Fatal | None = None
        self._stop_reason: str | None = None
        self._stop_deadline: float | None = None
        self._selector = selectors.DefaultSelector()
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._waker, False)

    def run(self) -> Outcome:
        """Returns when every item is decided, or after a stop request or a fatal error."""
        self._observer.started(self._totals)
        self._selector.register(self._woken, selectors.EVENT_READ)
        try:
            self._start_missing()
            while self._workers:
                self._listen()
                self._find_ended()
                self._enforce_limits()
                self._start_missing()
                self._observer.tick(self._totals)
        finally:
            self._close()
        self._totals.ended = time.monotonic()
        self._observer.finished(self._totals)
        interrupted = self._stop_reason is not None and bool(self._pending)
        interrupted = interrupted and self._fatal is None
        return Outcome(self._totals, interrupted, self._fatal, self._results)

    def request_stop(self, reason: str = "stop requested") -> None:
        """Ends the run soon: present items are stopped. The second call kills the workers."""
        if self._stop_reason is None:
            self._stop_reason = reason
        else:
            self._stop_deadline = 0.0
        with contextlib.suppress(OSError):  # full, or closed
            os.write(self._waker, b"!")

    @property
    def _stopping(self) -> bool:
        return self._stop_reason is not None

    # Workers come and go.

    def _start_missing(self) -> None:
        """Starts workers for pending items that no starting worker will take."""
        free = sum(worker.item is None for worker in self._workers.values())
        while not self._stopping and free < len(self._pending) and len(self._workers) < self._count:
            number = next(n for n in range(self._count) if n not in self._workers)
            try:
                self._logs.mkdir(parents=True, exist_ok=True)  # somebody may have tidied up
                log = self._logs / f"worker-{number}.log"
                worker = self._start_worker(number, log)
            except OSError as error:
                self._give_up_run("io", f"worker {number} cannot be started: {error}")
                return
            self._workers[number] = worker
            self._selector.register(worker, selectors.EVENT_READ, worker)
            free += 1

    def _start_process(self, number: int, log: Path) -> Worker:
        environment = {**self._environment, TURN_VARIABLE: str(number)}
        return WorkerProcess(number, self._command, log, environment)

    def _listen(self) -> None:
        for key, _ in self._selector.select(TICK_S):
            if key.data is None:
                os.read(self._woken, 4096)
                continue
            self._hear(key.data)

    def _find_ended(self) -> None:
        """Buries workers that ended while a child of theirs keeps their pipe open."""
        for worker in list(self._workers.values()):
            if worker.ended:
                self._hear(worker)

    def _hear(self, worker: Worker) -> None:
        try:
            messages = worker.messages()
            if messages is None:
                self._bury(worker)
                return
            for message in messages:
                self._obey(worker, message)
        except ProtocolError as error:
            worker.kill(str(error))

    def _bury(self, worker: Worker) -> None:
        """Handles the end of a worker: decides or retries its item."""
        self._selector.unregister(worker)
        del self._workers[worker.number]
        was_dismissed = worker.waiting and worker.leaving  # `bury` lets all of them leave
        how = worker.bury()
        end = f"worker {worker.number} (pid {worker.pid}) {how}"
        if was_dismissed:  # it never was anywhere
            return
        if worker.item is not None or not (worker.ready or self._stopping):
            self._count_death(worker, how)
        if not worker.ready and not self._stopping:
            self._count_bad_start(worker, end)
        if worker.item is not None:
            self._clean_up(worker.item.id, worker.pid)
            self._drop_item(worker, end)

    def _count_death(self, worker: Worker, how: str) -> None:
        item = worker.item.id if worker.item else None
        after = round(time.monotonic() - self._totals.started, 3)
        self._totals.deaths.append(Death(worker.number, worker.pid, item, how, after))

    def _count_bad_start(self, worker: Worker, end: str) -> None:
        if worker.lost:
            self._lost_starts += 1
            bad = self._lost_starts >= self._limits.losses * self._count
        else:
            self._bad_starts += 1
            bad = self._bad_starts >= STARTS_WITHOUT_SUCCESS
        if bad:
            tail = worker.log_tail()
            quoted = f" It said:\n{tail}" if tail else ""
            others = self._bad_starts + self._lost_starts - 1
            text = f"{end} before it could take an item, as did {others} before it."
            self._give_up_run("other", f"{text}{quoted}\nIts log: {worker.log}")

    def _close(self) -> None:
        """Ends all workers, however the run ends."""
        deadline = time.monotonic() + self._limits.stop_grace_s
        for worker in self._workers.values():
            worker.stop()
        while self._workers:
            for number, worker in list(self._workers.items()):
                if time.monotonic() >= deadline:
                    worker.kill("the run is over")
                elif worker.messages() is not None:
                    continue
                worker.bury()
                del self._workers[number]
            time.sleep(0.01)
        self._selector.close()
        os.close(self._woken)
        os.close(self._waker)
        self._waker = -1  # a late stop request must not write into somebody else's file

    # Messages of workers.

    def _obey(self, worker: Worker, message: dict[str, Any]) -> None:
        match message:
            case {"ready": True}:
                worker.ready = True
                self._bad_starts = self._lost_starts = 0
                self._hand_next(worker)
            case {"done": values}:
                self._take_result(worker, ItemRecord.from_json(values))
            case {"failed": values}:
                self._take_failure(worker, Failure.from_json(values))
            case {"refused": values}:
                worker.ready = True  # no death to wonder about
                worker.finish()
                failure = Failure.from_json(values)
                self._give_up_run(failure.kind, failure.message)
            case _:
                raise ProtocolError(f"unknown message: {message}")

    def _hand_next(self, worker: Worker) -> None:
        worker.item = None
        if self._stopping or not self._pending:
            worker.finish()
        else:
            worker.hand(self._pending.popleft())

    def _take_result(self, worker: Worker, result: ItemRecord) -> None:
        item = worker.item
        if item is None or result.id != item.id:
            raise ProtocolError(f"a result of {result.id}, which it was not given")
        self._totals.add(result)
        if result.stopped:
            self._drop_item(worker, f"worker {worker.number} was stopped by another process")
            return
        if not (result.success or result.complete):
            self._give_up(item, result.why_unmade())
        self._decided(result)
        self._hand_next(worker)

    def _decided(self, result: ItemRecord) -> None:
        self._results.append(result)
        self._observer.episode(result, self._totals)

    def _take_failure(self, worker: Worker, failure: Failure) -> None:
        worker.finish()
        item = worker.item
        if failure.kind == "io" and (trouble := self._disk_trouble()):
            self._give_up_run("io", with_trouble(failure.message, trouble))
        elif failure.kind == "io" and item and self._tries[item.id] + 1 >= self._limits.tries:
            self._give_up_run("io", failure.message)
        self._drop_item(worker, failure.message, failure.kind, failure.trace)

    # Items that a worker did not finish.

    def _drop_item(
        self,
        worker: Worker,
        reason: str,
        kind: FailureKind = "other",
        trace: str | None = None,
    ) -> None:
        """Takes the item from a worker that did not finish it.

        `trace` replaces the worker's log in the message.
        """
        item, worker.item = worker.item, None
        if item is None:
            return
        result = self._on_disk(item.id)
        if result and self._is_safe(item, reason, kind):  # it died between commit and result
            self._totals.add(result)
            self._decided(result)
        elif self._stopping:
            self._pending.appendleft(item)
        elif kind == "spec":
            self._lose(item, reason, kind)  # what the user wrote stays as it is
        else:
            once = kind == "other" and item.id in self._tried_once
            log = worker.log_tail() if trace is None else trace
            most = 1 if once else self._limits.tries
            if worker.lost:
                self._try_again(item, reason, log, self._limits.losses, self._losses)
            else:
                self._try_again(item, reason, log, most, self._tries)

    def _is_safe(self, item: Item, reason: str, kind: FailureKind) -> bool:
        """Returns True if an existing episode is flushed to the disk.

        After a failed write, it may exist without being flushed. The run ends if flushing fails.
        """
        if kind != "io":
            return True
        try:
            self._flush()
        except OSError as error:
            self._give_up_run("io", f"{reason}\n{error}")
            return False
        self._observer.warning(f"{item.id} is there, and was brought to the disk again: {reason}")
        return True

    def _try_again(self, item: Item, reason: str, log: str, most: int, tries: Counter[str]) -> None:
        tries[item.id] += 1
        if tries[item.id] < most:
            self._totals.again.append(Again(item.id, reason))
            self._pending.appendleft(item)
            self._observer.retry(item.id, reason, self._totals)
            return
        self._lose(item, reason, "other", log)

    def _lose(self, item: Item, reason: str, kind: FailureKind, log: str = "") -> None:
        """Gives up an item after an error; this may end the run.

        Identical ends of workers' logs are printed once, with the first item.
        """
        is_new = log and log not in self._printed_logs and log not in reason
        self._printed_logs.add(log)
        self._canaries.lost(self._give_up(item, f"{reason}\n{log}" if is_new else reason), kind)
        if verdict := self._canaries.verdict():
            self._give_up_run(verdict.kind, verdict.message, verdict.summary)

    def _give_up(self, item: Item, reason: str) -> Unmade:
        unmade = Unmade(item.id, reason, self._reproduce(item))
        self._totals.unmade.append(unmade)
        self._observer.unmade(unmade, self._totals)
        return unmade

    def _give_up_run(self, kind: FailureKind, message: str, summary: str = "") -> None:
        if self._fatal is None:
            self._fatal = Fatal(kind, message, summary)
            self._stop_reason = self._stop_reason or CANNOT_GO_ON

    # Time.

    def _enforce_limits(self) -> None:
        now = time.monotonic()
        if self._stopping:
            self._enforce_stop(now)
            return
        self._dismiss_waiting(now)
        for worker in self._workers.values():
            waited = now - worker.since
            if worker.waiting:
                continue
            if worker.leaving:
                if waited > self._limits.stop_grace_s:
                    worker.kill("did not end")
            elif (worker.item or not worker.ready) and waited > self._limits.item_timeout_s:
                what = worker.item.id if worker.item else "its start"
                worker.kill_hanging(f"{what} took more than {self._limits.item_timeout_s:g} s")

    def _dismiss_waiting(self, now: float) -> None:
        """Ends workers without a machine when nothing is left for them; warns if all wait long."""
        workers = self._workers.values()
        waiting = [worker for worker in workers if worker.waiting]
        if not self._pending and not any(worker.item for worker in workers):
            for worker in waiting:
                worker.finish()
        elif len(waiting) < len(workers):
            self._warned_of_waiting = False
        elif waiting and now - max(worker.since for worker in waiting) > PATIENCE_S:
            if not self._warned_of_waiting:
                self._observer.warning("no machine has a free core; waiting for one")
            self._warned_of_waiting = True

    def _enforce_stop(self, now: float) -> None:
        if self._stop_deadline is None:
            self._stop_deadline = now + self._limits.stop_grace_s
            self._observer.stopping(self._stop_reason or "", self._totals)
            for worker in self._workers.values():
                worker.stop()
        elif now > self._stop_deadline:
            for worker in self._workers.values():
                worker.kill("did not stop")
