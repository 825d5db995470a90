"""The dataset that the tests of the main job share: made once, by the command that users type."""

from __future__ import annotations

import fcntl
import json
import os

import pytest
from commands import ROOT, generate
from generated_run import GeneratedRun

import robocell
from menagerie import require_menagerie

EXAMPLE = ROOT / "examples" / "xarm7_pick.yaml"


@pytest.fixture(scope="session")
def xarm7_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """Twenty picks with the Menagerie's xArm7, two cameras of 624x352, made by two workers."""
    require_menagerie("ufactory_xarm7")
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:  # one dataset for all of pytest's processes
        shared = shared.parent
    folder, counts = shared / "xarm7_pick", shared / "xarm7_pick.json"
    with (shared / "xarm7_pick.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not counts.exists():
            events = generate(EXAMPLE, folder, "--workers", 2)
            counts.write_text(json.dumps(events[-1]["totals"]))
    return GeneratedRun(robocell.RunConfig.load(EXAMPLE), folder, json.loads(counts.read_text()))
