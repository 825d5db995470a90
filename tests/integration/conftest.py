"""The dataset that the tests of the main job share: made once, by the command that users type."""

from __future__ import annotations

import fcntl
import json
import os
from pathlib import Path

import pytest
from commands import ROOT, generate
from generated_run import GeneratedRun
from memory import all_resident_bytes

import robocell
from menagerie import require_menagerie
from robocell.generate.procfs import MemoryWatch

EXAMPLE = ROOT / "examples" / "xarm7_pick.yaml"
DEMO = ROOT / "examples" / "demo.yaml"
DEMO_EPISODES = 5


@pytest.fixture(scope="session")
def xarm7_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """Twenty picks with the Menagerie's xArm7, two cameras of 624x352, made by two workers."""
    require_menagerie("ufactory_xarm7")
    return generated_once(tmp_path_factory, "xarm7_pick", EXAMPLE)


@pytest.fixture(scope="session")
def rc7_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """Picks with the built-in robot, whose file names its model relative to itself."""
    return generated_once(tmp_path_factory, "demo", DEMO, "--episodes", DEMO_EPISODES)


@pytest.fixture(scope="session", params=["xarm7_run", "rc7_run"])
def any_run(request: pytest.FixtureRequest) -> GeneratedRun:
    """Each of the two."""
    run: GeneratedRun = request.getfixturevalue(request.param)
    return run


def generated_once(
    tmp_path_factory: pytest.TempPathFactory, name: str, run_file: Path, *options: object
) -> GeneratedRun:
    """The dataset of a run, made by the first process that asks."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:  # one dataset for all of pytest's processes
        shared = shared.parent
    folder, counts = shared / name, shared / f"{name}.json"
    with (shared / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not counts.exists():
            with MemoryWatch(all_resident_bytes) as watch:
                events = generate(run_file, folder, "--workers", 2, *options)
            made = {"totals": events[-1]["totals"], "peak_bytes": watch.bytes}
            counts.write_text(json.dumps(made))
    made = json.loads(counts.read_text())
    return GeneratedRun(robocell.RunConfig.load(run_file), folder, **made)
