"""Events of a supervisor for whoever watches it. Functions do nothing unless overridden."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable

from robocell.generate.items import ItemResult
from robocell.generate.totals import Totals, Unmade


class Observer:
    """Called from the supervisor's loop; must return quickly."""

    def started(self, totals: Totals) -> None:
        """Before the first worker."""

    def episode(self, result: ItemResult, totals: Totals) -> None:
        """An item was made, or its attempts are used up; `totals` includes it."""

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """An item will be made again by a fresh worker."""

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """An item was given up."""

    def warning(self, text: str) -> None:
        """Something to know."""

    def stopping(self, reason: str, totals: Totals) -> None:
        """No new items; the present ones are ended quickly."""

    def tick(self, totals: Totals) -> None:
        """Several times a second."""

    def finished(self, totals: Totals) -> None:
        """After the last worker has ended."""


class Unfailing(Observer):
    """Passes everything on until that fails: the run matters more than who watches it.

    A closed pipe, a terminal that is gone, a log on a full disk: OSError, and the SystemExit that
    rich makes of it. That is told on standard error, and nothing is passed on any more. Other
    exceptions are defects and stay.
    """

    def __init__(self, observer: Observer) -> None:
        self._observer = observer

    def started(self, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.started(totals))

    def episode(self, result: ItemResult, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.episode(result, totals))

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.retry(item_id, reason, totals))

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.unmade(unmade, totals))

    def warning(self, text: str) -> None:
        """Passed on."""
        self._pass(lambda to: to.warning(text))

    def stopping(self, reason: str, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.stopping(reason, totals))

    def tick(self, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.tick(totals))

    def finished(self, totals: Totals) -> None:
        """Passed on."""
        self._pass(lambda to: to.finished(totals))

    def _pass(self, call: Callable[[Observer], None]) -> None:
        try:
            call(self._observer)
        except (OSError, SystemExit) as error:
            self._observer = Observer()
            with contextlib.suppress(OSError):
                print(f"progress cannot be shown any more ({error}); going on", file=sys.stderr)
