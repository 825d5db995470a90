"""RESULTS.md: a section for each benchmark, with the circumstances it was measured in."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

HEADER = """# Results

Written by `benchmarks/run.py --record`; method: [README](README.md). A benchmark that is run by
itself replaces its own section only: numbers compare within a section.
"""
SECTION = re.compile(r"^## `(\w+)`\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)


def sections(text: str) -> dict[str, str]:
    """What a recorded text says of each benchmark, by its name."""
    return {name: body.strip() for name, body in SECTION.findall(text)}


def record(
    path: Path,
    measured: Mapping[str, str],
    order: Iterable[str],
    summary: Callable[[Mapping[str, str]], str] | None = None,
) -> None:
    """Puts sections in the place of those that the file has; the others stay.

    Args:
        path: of RESULTS.md, which need not be there.
        measured: text of each benchmark that was run, by its name.
        order: of the sections; what is in the file and not here is left out.
        summary: what is said above all of them, from the sections.
    """
    known = {**sections(path.read_text() if path.exists() else ""), **measured}
    kept = {name: known[name].strip() for name in order if name in known}
    parts = [f"## `{name}`\n\n{body}\n" for name, body in kept.items()]
    path.write_text("\n".join([HEADER, *([summary(kept)] if summary else []), *parts]))
