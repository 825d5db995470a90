"""Writes the figures of the last `make soak` into docs/reliability.md.

    .venv/bin/python scripts/soak_figures.py [build/soak/figures.jsonl]

Between the page's two marks stands nothing but what this script found: what the tests of
tests/reliability noted, and the logs of the fuzz targets, each with its day. A part that did not
run this time keeps the figures of its last run; one that never did has none, and the table says so.
"""

from __future__ import annotations

import json
import os
import platform
import re
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reliability.md"
BEGIN, END = "<!-- figures: begin -->", "<!-- figures: end -->"
FUZZ_DONE = re.compile(r"^Done (\d+) runs in (\d+) second", re.MULTILINE)
TARGETS = ("yaml", "names", "dataset", "video")
NOT_RUN = "not run"
ROW = re.compile(r"^\| (.+?) \| (.+ \|)$", re.MULTILINE)

Notes = Sequence[Mapping[str, Any]]


def of(notes: Notes, what: str) -> list[Mapping[str, Any]]:
    """The notes of one kind."""
    return [note for note in notes if note["what"] == what]


def kills(notes: Notes) -> str:
    """Of workers and supervisors, at random and at chosen instants."""
    ways = Counter[str]()
    for note in of(notes, "kills"):
        ways.update({way: count for way, count in note.items() if way != "what"})
    if not ways:
        return NOT_RUN
    parts = ", ".join(f"{way} {count}" for way, count in sorted(ways.items()))
    return f"{ways.total()} ({parts})"


def calls(notes: Notes, do: Sequence[str]) -> str:
    """Of writes, flushes, renames."""
    count = sum(note["times"] for note in of(notes, "calls") if note["do"] in do)
    return str(count) if count else NOT_RUN


def power_cuts(notes: Notes) -> str:
    """Simulated: folders that were built, checked, and finished by the command."""
    found = {note["command"]: note["times"] for note in of(notes, "power cuts")}
    return f"{sum(found.values())} (of {len(found)} commands and formats)" if found else NOT_RUN


def full_disks(notes: Notes) -> str:
    """Real ones, or those of the shim where none may be mounted."""
    found = [f"{note['kilobytes']} kB ({note['how']})" for note in of(notes, "full_disk")]
    return ", ".join(found) if found else NOT_RUN


def damage(notes: Notes, how: str) -> str:
    """Of files of a dataset."""
    found = [note for note in of(notes, "damage") if note["how"] == how]
    files = ", ".join(sorted({note["file"] for note in found}))
    return f"{sum(note['times'] for note in found)} ({files})" if found else NOT_RUN


def things(notes: Notes, kind: str) -> str:
    """That were made and let go."""
    found = [note for note in of(notes, "things") if note["kind"] == kind]
    if not found:
        return NOT_RUN
    last = found[-1]
    return (
        f"{last['times']}: {last['files']} descriptors, {last['children']} processes, "
        f"{max(last['heap_each'], 0)} bytes each stay"
    )


def houses(notes: Notes) -> str:
    """That were generated, and what was measured in them."""
    found = of(notes, "houses")
    if not found:
        return NOT_RUN
    last = found[-1]
    return (
        f"{last['kept']} of {last['houses']}: {last['objects']} objects, {last['slots']} surfaces "
        f"and containers, {last['openings']} doors and drawers; the deepest overlap "
        f"{1000 * last['penetration']:.2f} mm, the farthest move {1000 * last['moved']:.2f} mm"
    )


def fuzzed(logs: Mapping[str, str], target: str) -> str:
    """Of one fuzz target."""
    done = FUZZ_DONE.search(logs.get(target, ""))
    return f"{int(done[1]):,} inputs in {done[2]} s".replace(",", " ") if done else NOT_RUN


def figures(notes: Notes, logs: Mapping[str, str]) -> dict[str, str]:
    """All figures, by what they are of."""
    return {
        "kills survived, nothing acknowledged lost": kills(notes),
        "calls that failed (write, flush, rename ...), each reported": calls(
            notes, ("fail", "full")
        ),
        "deaths at a call, nothing lost": calls(notes, ("kill_before", "kill_after")),
        "power cuts simulated, nothing acknowledged lost": power_cuts(notes),
        "disks that filled up in a run, finished after they grew": full_disks(notes),
        "bits flipped, each found": damage(notes, "flip_bit"),
        "files cut short, each found": damage(notes, "cut"),
        **{
            f"{label}": things(notes, kind)
            for kind, label in {
                "scenes": "scenes built and let go",
                "resets": "resets",
                "contexts": "renderers with a GL context",
                "children": "encoder processes",
                "errors": "errors raised",
            }.items()
        },
        "generated houses that keep all promises for 10 s": houses(notes),
        **{f"fuzzed: {target}": fuzzed(logs, target) for target in TARGETS},
    }


def days(notes: Path, logs: Mapping[str, Path]) -> dict[str, str]:
    """When each fuzz target ran, and under "" when all else did."""
    files = {"": notes, **{f"fuzzed: {target}": log for target, log in logs.items()}}
    return {
        what: datetime.fromtimestamp(file.stat().st_mtime, UTC).date().isoformat()
        for what, file in files.items()
        if file.exists()
    }


def table(found: Mapping[str, str], when: Mapping[str, str], before: str) -> str:
    """The figures as Markdown; what did not run as in `before`, the table of the last time."""
    kept = dict(ROW.findall(before))
    rows = []
    for what, figure in found.items():
        if figure == NOT_RUN:
            rows.append(f"| {what} | {kept.get(what, f'{NOT_RUN} |  |')}")
        else:
            rows.append(f"| {what} | {figure} | {when.get(what, when.get('', ''))} |")
    return "\n".join(["| what | how often | when |", "|---|---|---|", *rows])


def between(page: Path) -> str:
    """What stands between the marks."""
    _, _, rest = page.read_text().partition(BEGIN)
    return rest.partition(END)[0].strip()


def write(page: Path, text: str) -> None:
    """Replaces what stands between the marks."""
    before, _, rest = page.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    if not after:
        sys.exit(f"{page}: the marks {BEGIN} and {END} are missing")
    page.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}")


def main() -> None:
    """The command."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/soak/figures.jsonl"
    lines = file.read_text().splitlines() if file.exists() else []
    notes = [json.loads(line) for line in lines]
    folder = file.resolve().parents[1] / "fuzz"
    logs = {name: (folder / f"{name}.log") for name in TARGETS}
    texts = {name: log.read_text(errors="replace") for name, log in logs.items() if log.exists()}
    cores = len(os.sched_getaffinity(0))
    head = f"On {cores} cores of {platform.machine()}:\n"
    text = table(figures(notes, texts), days(file, logs), between(PAGE))
    write(PAGE, f"{head}\n{text}")


if __name__ == "__main__":
    main()
