"""The dataset of an undisturbed run, which every disturbed one is held against."""

from __future__ import annotations

import fcntl
import os

import pytest
from storm import Storm


@pytest.fixture(scope="session")
def calm(tmp_path_factory: pytest.TempPathFactory) -> Storm:
    """Made by two workers, by the first process that asks. Nobody may change it."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:  # one dataset for all of pytest's processes
        shared = shared.parent
    with (shared / "calm.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        calm, done = Storm(shared / "calm"), shared / "calm.done"
        if not done.exists():
            calm.folder.mkdir(exist_ok=True)
            calm.finish()
            done.touch()
    return calm
