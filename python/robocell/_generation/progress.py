"""Progress of a run: a bar, plain lines, or JSON lines.

Bar and lines go to standard error, so that standard output holds results only; JSON lines go to
standard output. Events and their keys: docs/generate.md.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any, Literal, TextIO

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn
from rich.text import Text

from robocell._generation.items import ItemRecord, counts_text
from robocell._generation.observer import CANNOT_GO_ON, Observer
from robocell._generation.streams import leave, unforgiving
from robocell._generation.totals import Totals, Unmade, duration, percent
from robocell._suggestions import counted

ProgressStyle = Literal["auto", "bar", "plain", "jsonl"]

REASONS_SHOWN = 3
SAME = "the same error again"
PLAIN_INTERVAL_S = 5.0


def make_progress(style: ProgressStyle) -> Observer:
    """Kinds of progress output; `auto` is a bar on a terminal, else plain lines."""
    if style == "jsonl":
        return JsonLines(unforgiving(sys.stdout))  # so that a closed pipe is an error
    if style == "bar" or (style == "auto" and sys.stderr.isatty()):
        return Bar(Console(stderr=True))
    return PlainLines(sys.stderr)


def status(totals: Totals) -> str:
    """Returns '120/h, 3 min 20 s left, success 95 %, refused: too far 3, failed: dropped 1'."""
    parts = [
        f"{totals.per_hour:.0f}/h",
        f"{duration(totals.eta_s)} left",
        f"success {percent(totals.success_rate)}",
    ]
    if totals.refusals:
        parts.append(f"refused: {counts_text(totals.refusals, REASONS_SHOWN)}")
    if totals.failures:
        parts.append(f"failed: {counts_text(totals.failures, REASONS_SHOWN)}")
    return ", ".join(parts)


def beginning(totals: Totals) -> str:
    """Describes the plan of a run."""
    before = f" ({totals.already} on the disk)" if totals.already else ""
    return f"{counted(totals.planned, 'episode')}{before}, {counted(totals.workers, 'worker')}"


def unmade_text(unmade: Unmade, reason: str) -> str:
    """Explains why an item was given up and how to retry it."""
    remedy = f"\n  try it alone: {unmade.reproduce}" if unmade.reproduce else ""
    return f"{unmade.id} could not be made: {reason}{remedy}"


def print_line(text: str, file: TextIO) -> None:
    """Prints the line at once. Raises OSError if its reader is gone or the disk is full."""
    try:
        print(text, file=file, flush=True)
    except OSError:
        leave(file)  # what is buffered must not fail at exit
        raise


class Lines(Observer):
    """Messages common to bar and plain lines. A reason is printed once for each item."""

    def __init__(self) -> None:
        self._reasons: dict[str, str] = {}  # printed last, by item

    def say(self, text: str, style: str = "") -> None:
        """Shows a line; `style` is one of rich's."""
        raise NotImplementedError

    def started(self, totals: Totals) -> None:
        """Prints the plan."""
        self.say(beginning(totals))

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """Prints the retried item and the reason."""
        self.say(f"{item_id} is made again: {self._news(item_id, reason)}", "yellow")

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Prints the item that is given up, and the reason."""
        self.say(unmade_text(unmade, self._news(unmade.id, unmade.reason)), "red")

    def warning(self, text: str) -> None:
        """Prints the warning."""
        self.say(f"warning: {text}", "yellow")

    def stopping(self, reason: str, totals: Totals) -> None:
        """Prints that the run will end."""
        again = "" if reason == CANNOT_GO_ON else "; interrupt again to kill"
        self.say(f"stopping ({reason}); finished episodes are kept{again}", "yellow")

    def _news(self, item_id: str, reason: str) -> str:
        """Returns a reason, or what is new in it for those who have read the item's last one."""
        before = self._reasons.get(item_id)
        if before and (reason == before or reason.startswith(f"{before}\n")):
            return f"{SAME}{reason[len(before) :]}"
        self._reasons[item_id] = reason
        return reason


class PlainLines(Lines):
    """A line every few seconds, for logs."""

    def __init__(self, file: TextIO, interval_s: float = PLAIN_INTERVAL_S) -> None:
        super().__init__()
        self._file = file
        self._interval_s = interval_s
        self._next = 0.0

    def say(self, text: str, style: str = "") -> None:
        """Prints the line."""
        print_line(text, self._file)

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        """Prints the state unless it was printed just now, or the final one is about to be."""
        over = totals.done + len(totals.unmade) >= totals.planned
        if time.monotonic() >= self._next and not over:
            self._print(totals)

    def finished(self, totals: Totals) -> None:
        """Prints the final state."""
        self._print(totals)

    def _print(self, totals: Totals) -> None:
        self._next = time.monotonic() + self._interval_s
        self.say(f"{totals.done}/{totals.planned} episodes, {status(totals)}")


class Bar(Lines):
    """A bar with rate, time left, success rate and reasons."""

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._progress = Progress(
            SpinnerColumn(),
            BarColumn(bar_width=30),
            MofNCompleteColumn(),
            TextColumn("{task.fields[status]}", markup=False),
            console=console,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._task = self._progress.add_task("", total=None, status="starting")

    def say(self, text: str, style: str = "") -> None:
        """Prints the line above the bar."""
        self._progress.console.print(Text(text, style=style), soft_wrap=True)

    def started(self, totals: Totals) -> None:
        """Shows the bar."""
        super().started(totals)
        self._progress.update(self._task, total=totals.planned, completed=totals.done)
        self._progress.start()

    def tick(self, totals: Totals) -> None:
        """Updates the bar."""
        shown = "starting" if not totals.attempts else status(totals)
        self._progress.update(self._task, completed=totals.done, status=shown)

    def finished(self, totals: Totals) -> None:
        """Leaves the bar as it is."""
        self.tick(totals)
        self._progress.stop()


class JsonLines(Observer):
    """Prints one JSON object per event, with the key `event`."""

    def __init__(self, file: TextIO) -> None:
        self._file = file

    def started(self, totals: Totals) -> None:
        """Prints the event `started`."""
        self._write("started", totals=totals.to_json(), workers=totals.workers)

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        """Prints the event `episode`."""
        self._write("episode", result=result.to_json(), totals=totals.to_json())

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """Prints the event `retry`."""
        self._write("retry", id=item_id, reason=reason)

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Prints the event `unmade`."""
        self._write("unmade", id=unmade.id, reason=unmade.reason, reproduce=unmade.reproduce)

    def warning(self, text: str) -> None:
        """Prints the event `warning`."""
        self._write("warning", text=text)

    def stopping(self, reason: str, totals: Totals) -> None:
        """Prints the event `stopping`."""
        self._write("stopping", reason=reason)

    def finished(self, totals: Totals) -> None:
        """Prints the event `finished`."""
        self._write("finished", totals=totals.to_json())

    def _write(self, event: str, **values: Any) -> None:
        print_line(json.dumps({"event": event, **values}), self._file)
