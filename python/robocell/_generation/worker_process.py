"""One worker process as the supervisor sees it: start, send items, read messages, stop, kill."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from robocell._generation.items import Item
from robocell._generation.protocol import LineReader, encode
from robocell._generation.stacks import FATAL, ask, place_in, without_stacks

# After its pipe has closed a process has this long to end.
END_GRACE_S = 5.0
LOG_LINES_SHOWN = 12
LOG_BYTES_READ = 65536


class Worker(Protocol):
    """A worker as the supervisor sees it: `WorkerProcess`, or one on another machine.

    Attributes:
        number: Number in messages.
        log: File of what it writes to standard error.
        item: The item that it is making, or None.
        ready: True if it has loaded the run.
        leaving: True if the supervisor asked it to exit.
        waiting: True until a machine has a free core for it.
        lost: True if it ended because its machine was lost.
        since: Start of the latest of these states, `time.monotonic()`.
    """

    number: int
    log: Path
    item: Item | None
    ready: bool
    leaving: bool
    waiting: bool
    lost: bool
    since: float

    @property
    def pid(self) -> int:
        """Id of the process."""

    @property
    def ended(self) -> bool:
        """True if the process has ended."""

    def fileno(self) -> int:
        """Returns what selectors wait for."""

    def hand(self, item: Item) -> None:
        """Gives it an item."""

    def stop(self) -> None:
        """Asks it to end its item quickly and exit."""

    def finish(self) -> None:
        """Ends its work."""

    def kill(self, reason: str) -> None:
        """Kills it."""

    def kill_hanging(self, reason: str) -> None:
        """Kills it after it has written its stacks to its log."""

    def messages(self) -> Iterator[dict[str, Any]] | None:
        """Returns new messages since the last call; None after the last one."""

    def bury(self) -> str:
        """Waits for its end; how it ended, as a sentence's end."""

    def log_tail(self) -> str:
        """Returns the last lines of its log."""


class WorkerProcess:
    """A child process in a separate process group, which Ctrl-C in the terminal does not reach.

    Attributes:
        number: Number in messages; the log is `worker-<number>.log`.
        item: The item that it is making, or None.
        ready: True if it has loaded the run.
        leaving: True if the supervisor asked it to exit.
        waiting, lost: False: it is on this machine.
        since: Start of the latest of these states, `time.monotonic()`.
    """

    def __init__(
        self, number: int, command: Sequence[str], log: Path, environment: Mapping[str, str]
    ) -> None:
        self.number = number
        self.log = log
        self.item: Item | None = None
        self.ready = False
        self.leaving = False
        self.waiting = False
        self.lost = False
        self.since = time.monotonic()
        self._killed_for = ""
        self._hangs = False
        self._reader = LineReader()
        with log.open("ab") as file:
            self._log_start = file.tell()
            self._process = subprocess.Popen(
                command,
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                bufsize=0,
                process_group=0,
            )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._stdin = self._process.stdin
        self._stdout = self._process.stdout
        os.set_blocking(self._stdout.fileno(), False)

    @property
    def pid(self) -> int:
        """Id of the process."""
        return self._process.pid

    @property
    def ended(self) -> bool:
        """True if the process has ended, even if its pipe is still open."""
        return self._process.poll() is not None

    def fileno(self) -> int:
        """Returns the pipe of its replies, for selectors."""
        return self._stdout.fileno()

    def hand(self, item: Item) -> None:
        """Gives it an item. A closed pipe reveals a worker that has just died."""
        self.item = item
        self.since = time.monotonic()
        self._send({"do": item.to_json()})

    def stop(self) -> None:
        """Asks it to end its item quickly and exit."""
        self._send({"stop": True})

    def finish(self) -> None:
        """Ends the work of the process, which then exits."""
        if not self.leaving:
            self.leaving = True
            self.since = time.monotonic()
            self._stdin.close()

    def kill(self, reason: str) -> None:
        """Kills the processes of its group.

        Encoders have separate groups: they end when the pipe from the worker closes.
        """
        if self.ended:
            return  # its number may be another process's by now
        self._killed_for = self._killed_for or reason
        for send in (os.killpg, os.kill):
            try:
                send(self.pid, signal.SIGKILL)
            except (ProcessLookupError, PermissionError):
                continue

    def kill_hanging(self, reason: str) -> None:
        """Kills it after it has written its stacks to its log; `bury` names the place."""
        if not self.ended:
            self._killed_for = self._killed_for or reason
            self._hangs = True
            ask(self.pid, self.log)
            self.kill(reason)

    def messages(self) -> Iterator[dict[str, Any]] | None:
        """Returns new messages since the last call; None after the last one."""
        ended = self.ended  # before reading: what it said last is in the pipe by then
        try:
            data = os.read(self.fileno(), 1 << 16)
        except BlockingIOError:  # after its end, a process that it forked holds the pipe open
            return None if ended else iter(())
        return self._reader.feed(data) if data else None

    def bury(self) -> str:
        """Waits for its end and frees the pipes; how it ended, as a sentence's end."""
        self.finish()
        try:
            code = self._process.wait(END_GRACE_S)
        except subprocess.TimeoutExpired:
            self.kill("did not end")
            code = self._process.wait()
        self._stdout.close()
        how = f"was killed: {self._killed_for}" if self._killed_for else describe_exit(code)
        has_stacks = self._hangs or (not self._killed_for and -code in FATAL)
        return how + (place_in(self._log_end()) if has_stacks else "")

    def log_tail(self) -> str:
        """Returns the last lines that this process wrote to its log, without stacks."""
        return "\n".join(without_stacks(self._log_end()).splitlines()[-LOG_LINES_SHOWN:])

    def _log_end(self) -> str:
        """Returns the end of what this process wrote to its log."""
        try:
            with self.log.open("rb") as file:
                file.seek(max(self._log_start, os.path.getsize(self.log) - LOG_BYTES_READ))
                return file.read().decode(errors="replace")
        except OSError:
            return ""

    def _send(self, message: Mapping[str, Any]) -> None:
        try:
            if not self._stdin.closed:
                self._stdin.write(encode(message))
        except BrokenPipeError:
            pass


def describe_exit(code: int) -> str:
    """Returns 'was killed by SIGKILL (out of memory?)' or 'ended with exit code 1'."""
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"was killed by {name}" + (" (out of memory?)" if code == -signal.SIGKILL else "")
