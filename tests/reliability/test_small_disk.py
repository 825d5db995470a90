"""A disk that is really full, a folder that turns read-only: the run ends, the episodes stay."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import figures
import pytest
from disks import bound_by_permissions, small_disk
from storm import EPISODES, Storm, marks

import robocell

SMALL_KB, LARGE = 1024, "64m"  # room for two episodes, and for all


@pytest.mark.proof  # each kind of call finds the disk full in test_failing_disk.py
def test_a_full_disk_ends_the_run_and_the_next_run_resumes(tmp_path: Path, calm: Storm):
    with small_disk(tmp_path / "disk", SMALL_KB) as disk:
        storm = Storm(disk.folder)
        command = storm.start(1, disk.environment)
        events, said = command.communicate(timeout=240)
        assert command.returncode == 3, said
        assert "Traceback" not in said
        # The message of the encoder may have several lines.
        needed = rf"(?s)'{storm.dataset}.*\d+ bytes are needed, \d+ are free there"
        assert re.search(needed, said), said
        storm.take(events)
        storm.require_nothing_lost()
        result = robocell.data.verify(storm.dataset)
        assert 0 < len(result.good) < EPISODES, "it was full before the end, not from the start"
        assert result.leftovers == [], "the half episode is gone"
        before = marks(storm)
        disk.grow(LARGE)
        storm.finish()
        assert before.items() <= marks(storm).items(), "what was there was not written again"
        assert storm.contents() == calm.contents()
        figures.note("full_disk", how="tmpfs" if disk.holder else "shim", kilobytes=SMALL_KB)


@contextmanager
def read_only(folder: Path) -> Iterator[None]:
    before = folder.stat().st_mode
    folder.chmod(0o555)
    try:
        yield
    finally:
        folder.chmod(before)


def wait_for(folder: Path, pattern: str, count: int) -> None:
    end = time.monotonic() + 120
    while len(list(folder.glob(pattern))) < count:
        assert time.monotonic() < end, f"{pattern} does not come"
        time.sleep(0.005)


@pytest.mark.proof
def test_a_folder_turned_read_only_ends_the_run_and_the_next_run_resumes(
    tmp_path: Path, calm: Storm
):
    storm = Storm(tmp_path)
    command = storm.start(1, wrap=bound_by_permissions)
    wait_for(storm.dataset, "s*", 2)
    wait_for(storm.dataset, ".s*.partial", 1)
    with read_only(storm.dataset):
        events, said = command.communicate(timeout=240)
        before = marks(storm)
    assert command.returncode == 3, said
    assert "Traceback" not in said
    assert re.search(rf"'{storm.dataset}[^']*': Permission denied. Choose another place", said), (
        said
    )
    storm.take(events)
    storm.require_nothing_lost()
    assert len(storm.acknowledged) >= 2
    storm.finish()
    assert before.items() <= marks(storm).items(), "what was there was not written again"
    assert storm.contents() == calm.contents()
