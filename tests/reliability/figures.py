"""What the reliability tests did, in numbers, for docs/reliability.md.

Tests note what they did; `make soak` sets ROBOCELL_FIGURES to the file that gathers it, a JSON
object per line, from which scripts/soak_figures.py writes the table. Without it nothing is kept.
"""

from __future__ import annotations

import json
import os
from pathlib import Path


def note(what: str, **numbers: object) -> None:
    """Adds one figure."""
    if file := os.environ.get("ROBOCELL_FIGURES"):
        with Path(file).open("a") as lines:
            lines.write(json.dumps({"what": what, **numbers}) + "\n")
