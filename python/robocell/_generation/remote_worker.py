"""A worker process on another machine as the supervisor sees it.

It has the functions of `WorkerProcess`. A `Link` calls the methods of the `RemoteHost` over there;
Ray has one (`ray_engine`), tests another.
"""

from __future__ import annotations

import os
import shutil
import threading
import time
import uuid
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from robocell._generation import pieces
from robocell._generation.items import Item
from robocell._generation.protocol import Failure
from robocell._generation.remote_host import MANIFEST, RemoteJob
from robocell._generation.run_source import RunSource

LISTEN_S = 20.0  # of one call that waits for messages
BURIAL_S = 20.0  # a machine that does not answer within that time is taken for lost
FETCHERS = 4
FETCH_TRIES = 2


class Link(Protocol):
    """Calls the methods of one `RemoteHost`, which a cluster places on a machine with a free core.

    The first call is answered when there is such a machine.
    """

    def call(self, method: str, *arguments: Any) -> Future[Any]:
        """Calls a method. The future raises if the machine is lost."""

    def loss(self, error: BaseException) -> str:
        """Returns how the machine was lost, as in 'its node has died'; "" for other errors."""

    def close(self) -> None:
        """Ends the host, or its wait for a machine."""


class RemoteWorker:
    """One worker process on another machine.

    Attributes:
        number: Number in messages; the log is `worker-<number>.log`.
        pid: Its process there; 0 until it has started.
        item: The item that it is making, or None.
        ready: True if it has loaded the run.
        leaving: True if the supervisor asked it to exit.
        waiting: True until a machine has a free core for it.
        lost: True if its machine was lost.
        since: Start of the latest of these states, `time.monotonic()`.
    """

    def __init__(self, number: int, log: Path, link: Link, remote: RemoteWorkers) -> None:
        self.number = number
        self.log = log
        self.pid = 0
        self.item: Item | None = None
        self.ready = False
        self.leaving = False
        self.waiting = True
        self.lost = False
        self.since = time.monotonic()
        self._link = link
        self._remote = remote
        self._node = ""
        self._fetches = False
        self._killed_for = ""
        self._how = ""  # it ended, when there is nobody to ask
        self._tail = ""
        self._deadline: float | None = None
        self._lock = threading.Lock()
        self._heard: deque[dict[str, Any]] = deque()
        self._over = False
        self._buried = False
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        turn = {remote.turn_variable: str(number)}
        link.call("start", remote.job, number, turn).add_done_callback(self._on_started)

    @property
    def ended(self) -> bool:
        """True if nothing more will be heard of it."""
        return self._over or (self._deadline is not None and time.monotonic() > self._deadline)

    def fileno(self) -> int:
        """Returns what selectors wait for."""
        return self._bell

    def hand(self, item: Item) -> None:
        """Gives it an item."""
        self.item = item
        self.since = time.monotonic()
        self._link.call("hand", item.to_json())

    def stop(self) -> None:
        """Asks it to end its item quickly and exit."""
        if not self._leave_unstarted():
            self._link.call("stop")

    def finish(self) -> None:
        """Ends the work of the process, which then exits."""
        if not self.leaving:
            self.leaving = True
            self.since = time.monotonic()
            if not (self._leave_unstarted() or self._over):
                self._link.call("finish")

    def kill(self, reason: str) -> None:
        """Kills it, and waits no longer for a machine that does not answer."""
        self._kill(reason, hangs=False)

    def kill_hanging(self, reason: str) -> None:
        """Kills it after it has written its stacks to its log; `bury` names the place."""
        self._kill(reason, hangs=True)

    def _kill(self, reason: str, *, hangs: bool) -> None:
        if self._leave_unstarted() or self.ended or self._deadline is not None:
            return
        self._killed_for = self._killed_for or reason
        self._deadline = time.monotonic() + BURIAL_S
        self._link.call("kill", reason, hangs)

    def messages(self) -> Iterator[dict[str, Any]] | None:
        """Returns new messages since the last call; None after the last one."""
        with suppress(BlockingIOError):
            os.eventfd_read(self._bell)
        with self._lock:
            heard = list(self._heard)
            self._heard.clear()
        return None if not heard and self.ended else iter(heard)

    def bury(self) -> str:
        """Waits for its end; how it ended, as a sentence's end."""
        self.finish()
        if not (self._how or self._over):  # its machine did not answer to the kill
            self._how = f"was killed: {self._killed_for}"
        if not self._how:
            try:
                self._how, log, self._tail = self._link.call("bury").result(BURIAL_S)
                with self.log.open("a") as file:
                    file.write(log)
            except Exception as error:  # whatever a link raises
                self._how = self._describe(error)
        with self._lock:
            self._buried = True
            os.close(self._bell)
        self._link.close()
        return self._how + (f", on '{self._node}'" if self._node else "")

    def log_tail(self) -> str:
        """Returns the last lines that this process wrote to its log, without stacks."""
        return self._tail

    def _leave_unstarted(self) -> bool:
        """Returns True, and ends, if there is no machine for it yet."""
        if not self.waiting:
            return False
        self._end("was not needed any more")
        self._link.close()
        return True

    # In the threads of the link and of the fetchers.

    def _on_started(self, future: Future[Any]) -> None:
        try:
            started = future.result()
        except BaseException as error:
            self._end(self._describe(error))
            return
        if self._over:  # nobody waits for it any more
            return
        self.since = time.monotonic()
        self.waiting = False
        if "refused" in started:
            self._push(started)
            self._end("could not start")
            return
        self.pid, self._node = started["pid"], started["node"]
        self._fetches = started["fetches"]
        self._listen()

    def _listen(self) -> None:
        self._link.call("listen", LISTEN_S).add_done_callback(self._on_heard)

    def _on_heard(self, future: Future[Any]) -> None:
        try:
            messages, ended = future.result()
        except BaseException as error:
            self._end(self._describe(error))
            return
        if self._fetches and any("done" in message for message in messages):
            self._remote.fetchers.submit(self._take, messages, ended)
        else:
            self._take(messages, ended)

    def _take(self, messages: list[dict[str, Any]], ended: bool) -> None:
        for message in messages:
            self._push(self._fetched(message) if self._fetches else message)
        if ended:
            self._end()
        elif not self._over:
            self._listen()

    def _fetched(self, message: dict[str, Any]) -> dict[str, Any]:
        """Brings the episodes of a result here; returns the message, or a failure instead."""
        done = message.get("done")
        if done is None or done["stopped"]:
            return message
        try:
            for attempt in range(FETCH_TRIES):
                try:
                    self._fetch(done["id"])
                    return message
                except pieces.DamagedPieceError:
                    if attempt == FETCH_TRIES - 1:
                        raise
        except OSError as error:
            return {"failed": Failure("io", f"cannot store {done['id']}: {error}").to_json()}
        except Exception as error:  # whatever a link raises
            text = f"cannot fetch {done['id']} from '{self._node}': {error}"
            return {"failed": Failure("other", self._link.loss(error) or text).to_json()}
        raise AssertionError

    def _fetch(self, item_id: str) -> None:
        def read(folder: pieces.Folder, offset: int, size: int) -> bytes:
            data: bytes = self._link.call("read", folder, offset, size).result()
            return data

        folders: list[pieces.Folder] = self._link.call("listing", item_id).result()
        for folder in folders:
            pieces.receive(folder, read, self._remote.dataset, self._remote.staging)
        episodes = [folder.name for folder in folders if "/" not in folder.name]
        self._link.call("forget", episodes)

    def _describe(self, error: BaseException) -> str:
        loss = self._link.loss(error)
        self.lost = bool(loss)
        if self._killed_for:
            return f"was killed: {self._killed_for}"
        return f"was lost: {loss}" if loss else f"failed: {error}"

    def _push(self, message: dict[str, Any]) -> None:
        with self._lock:
            self._heard.append(message)
            self._ring()

    def _end(self, how: str = "") -> None:
        with self._lock:
            if not self._over:
                self._how = self._how or how
                self._over = True
                self._ring()

    def _ring(self) -> None:
        if not self._buried:
            os.eventfd_write(self._bell, 1)


class RemoteWorkers:
    """The remote workers of one command: what they share.

    Args:
        source: The run.
        overrides: Replaced fields.
        dataset: The dataset, which exists and is locked.
        logs: Folder of the workers' logs, on the same disk.
        turn_variable: Environment variable with the number of a worker.
        fetch: Fetch episodes even from machines that share the folder.
    """

    def __init__(
        self,
        source: RunSource,
        overrides: tuple[str, ...],
        dataset: Path,
        logs: Path,
        *,
        turn_variable: str,
        fetch: bool = False,
    ) -> None:
        self.dataset = dataset.absolute()
        self.turn_variable = turn_variable
        self.staging = logs.absolute() / "fetched"
        shutil.rmtree(self.staging, ignore_errors=True)  # of a command that was killed
        self.staging.mkdir(parents=True)
        token = self.staging / uuid.uuid4().hex
        token.touch()
        self.job = RemoteJob(
            source.absolute(),
            overrides,
            str(Path.cwd()),
            str(self.dataset),
            str(token.relative_to(self.dataset)),
            (dataset / MANIFEST).read_text(),
            fetch,
        )
        self.fetchers = ThreadPoolExecutor(FETCHERS, "fetcher")

    def close(self) -> None:
        """Ends the fetchers and removes what is unfinished."""
        self.fetchers.shutdown(cancel_futures=True)
        shutil.rmtree(self.staging, ignore_errors=True)
