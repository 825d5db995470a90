"""One worker process as the supervisor sees it: start, hand over, listen, stop, kill."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from robocell.generate.items import Item
from robocell.generate.protocol import LineReader, encode

# After its pipe has closed a process has this long to end.
END_GRACE_S = 5.0
LOG_LINES_SHOWN = 12


class WorkerProcess:
    """A child process in a process group of its own, so that Ctrl-C in the terminal passes it by.

    Attributes:
        number: For people; the log is `worker-<number>.log`.
        item: What it is making now, or None.
        ready: It has loaded the run.
        leaving: It was told that there is no more work.
        since: When the latest of this began, `time.monotonic()`.
    """

    def __init__(
        self, number: int, command: Sequence[str], log: Path, environment: Mapping[str, str]
    ) -> None:
        self.number = number
        self.log = log
        self.item: Item | None = None
        self.ready = False
        self.leaving = False
        self.since = time.monotonic()
        self._killed_for = ""
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
        """The process."""
        return self._process.pid

    @property
    def ended(self) -> bool:
        """Whether the process is gone, even if its pipe is still open."""
        return self._process.poll() is not None

    def fileno(self) -> int:
        """The pipe of its replies, for selectors."""
        return self._stdout.fileno()

    def hand(self, item: Item) -> None:
        """Gives it an item. A worker that has just died is found out by its closed pipe."""
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
        """Ends it by force, with what is in its process group.

        Encoders have groups of their own: they end by themselves when the pipe that they read from
        closes with the worker.
        """
        if self.ended:
            return  # its number may be another process's by now
        self._killed_for = self._killed_for or reason
        for send in (os.killpg, os.kill):
            try:
                send(self.pid, signal.SIGKILL)
            except (ProcessLookupError, PermissionError):
                continue

    def messages(self) -> Iterator[dict[str, Any]] | None:
        """What it has said since the last call; None when it has ended and has said all."""
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
        return f"was killed: {self._killed_for}" if self._killed_for else describe_exit(code)

    def log_tail(self) -> str:
        """The last lines that this process wrote to its log."""
        try:
            with self.log.open("rb") as file:
                file.seek(max(self._log_start, os.path.getsize(self.log) - 16384))
                text = file.read().decode(errors="replace")
        except OSError:
            return ""
        return "\n".join(text.splitlines()[-LOG_LINES_SHOWN:])

    def _send(self, message: Mapping[str, Any]) -> None:
        try:
            if not self._stdin.closed:
                self._stdin.write(encode(message))
        except BrokenPipeError:
            pass


def describe_exit(code: int) -> str:
    """'was killed by SIGKILL (out of memory?)' or 'ended with exit code 1'."""
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"was killed by {name}" + (" (out of memory?)" if code == -signal.SIGKILL else "")
