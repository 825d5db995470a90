"""What a supervisor tells whoever watches it. Every function does nothing unless overridden."""

from __future__ import annotations

from robocell.generate.items import Report
from robocell.generate.totals import Totals, Unmade


class Observer:
    """Called from the supervisor's loop; must return quickly."""

    def started(self, totals: Totals) -> None:
        """Before the first worker."""

    def episode(self, report: Report, totals: Totals) -> None:
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
