"""The figures of a soak: what was noted is summed, what did not run is said."""

from __future__ import annotations

from pathlib import Path

import pytest

import soak_figures

NOTES = [
    {"what": "kills", "worker": 3, "inside": 2},
    {"what": "calls", "program": "a", "do": "fail", "times": 30},
    {"what": "calls", "program": "b", "do": "full", "times": 12},
    {"what": "calls", "program": "a", "do": "kill_after", "times": 7},
    {"what": "full_disk", "how": "tmpfs", "kilobytes": 1024},
    {"what": "damage", "file": "steps.h5", "how": "flip_bit", "times": 100},
    {
        "what": "things",
        "kind": "scenes",
        "times": 1000,
        "files": 0,
        "children": 0,
        "heap_each": -3,
    },
    {
        "what": "houses",
        "houses": 100,
        "kept": 99,
        "objects": 4000,
        "slots": 2800,
        "openings": 2700,
        "penetration": 0.00013,
        "moved": 0.002,
        "opened": 1.0,
    },
]


LOGS = {"yaml": "#1 INITED\nDone 12345 runs in 61 second(s)\n"}
DAYS = {"": "2026-01-02", "fuzzed: yaml": "2026-01-03"}


def test_figures_are_summed_and_gaps_are_named():
    text = soak_figures.table(soak_figures.figures(NOTES, LOGS), DAYS, "")
    assert (
        "| kills survived, nothing acknowledged lost | 5 (inside 2, worker 3) | 2026-01-02 |"
        in text
    )
    assert "each reported | 42 | 2026-01-02 |" in text
    assert "| deaths at a call, nothing lost | 7 |" in text
    assert "finished after they grew | 1024 kB (tmpfs) |" in text
    assert "| bits flipped, each found | 100 (steps.h5) |" in text
    assert "| files cut short, each found | not run |  |" in text
    assert "| 1000: 0 descriptors, 0 processes, 0 bytes each stay |" in text
    assert "| resets | not run |  |" in text
    assert "| 99 of 100: 4000 objects, 2800 surfaces and containers, 2700 doors" in text
    assert "the deepest overlap 0.13 mm, the farthest move 2.00 mm | 2026-01-02 |" in text
    assert "| fuzzed: yaml | 12 345 inputs in 61 s | 2026-01-03 |" in text
    assert "| fuzzed: names | not run |  |" in text


def test_parts_that_did_not_run_keep_their_figures_and_dates():
    first = soak_figures.table(soak_figures.figures(NOTES, LOGS), DAYS, "")
    later = {"": "2026-02-01", "fuzzed: names": "2026-02-02"}
    logs = {"names": "Done 7 runs in 9 second(s)\n"}
    notes = [{"what": "kills", "worker": 4}]
    text = soak_figures.table(soak_figures.figures(notes, logs), later, first)
    assert "| kills survived, nothing acknowledged lost | 4 (worker 4) | 2026-02-01 |" in text
    assert "each reported | 42 | 2026-01-02 |" in text
    assert "| fuzzed: yaml | 12 345 inputs in 61 s | 2026-01-03 |" in text
    assert "| fuzzed: names | 7 inputs in 9 s | 2026-02-02 |" in text
    assert "| resets | not run |  |" in text


def test_replaces_only_the_text_between_the_marks(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{soak_figures.BEGIN}\nold\n{soak_figures.END}\nafter\n")
    soak_figures.write(page, "new")
    assert page.read_text() == (f"before\n{soak_figures.BEGIN}\nnew\n{soak_figures.END}\nafter\n")
    page.write_text("no marks")
    with pytest.raises(SystemExit, match="marks"):
        soak_figures.write(page, "new")
