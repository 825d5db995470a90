"""Events of a supervisor, for observers. Functions do nothing unless overridden."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable

from robocell._generation.items import ItemRecord
from robocell._generation.totals import Totals, Unmade

CANNOT_GO_ON = "it cannot go on"  # the reason of a stop that nobody asked for


class Observer:
    """Called from the supervisor's loop; must return quickly."""

    def started(self, totals: Totals) -> None:
        """Called before the first worker starts."""

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        """Called when an item was made or used up its attempts; `totals` includes it."""

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """Called when a new worker will retry an item."""

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Called when an item is given up."""

    def warning(self, text: str) -> None:
        """Called with a warning."""

    def stopping(self, reason: str, totals: Totals) -> None:
        """Called when the run stops: no new items start, and present ones end soon."""

    def tick(self, totals: Totals) -> None:
        """Called several times a second."""

    def finished(self, totals: Totals) -> None:
        """Called after the last worker has ended."""


class Unfailing(Observer):
    """Forwards events until the observer fails: the run matters more than its observers.

    An observer fails with OSError, or the SystemExit that rich makes of it (a closed pipe, a lost
    terminal, a log on a full disk). This is reported once on standard error, and forwarding stops.
    Other exceptions are defects and propagate.
    """

    def __init__(self, observer: Observer) -> None:
        self._observer = observer

    def started(self, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.started(totals))

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.episode(result, totals))

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.retry(item_id, reason, totals))

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.unmade(unmade, totals))

    def warning(self, text: str) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.warning(text))

    def stopping(self, reason: str, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.stopping(reason, totals))

    def tick(self, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.tick(totals))

    def finished(self, totals: Totals) -> None:
        """Forwards the event."""
        self._pass(lambda to: to.finished(totals))

    def _pass(self, call: Callable[[Observer], None]) -> None:
        try:
            call(self._observer)
        except (OSError, SystemExit) as error:
            self._observer = Observer()
            with contextlib.suppress(OSError):
                text = f"progress cannot be shown any more ({error}); the run continues"
                print(text, file=sys.stderr)
