"""The built-in arm picks kinds of the catalogue whose object.yaml says that it can."""

from __future__ import annotations

from pathlib import Path

import pytest

import robocell as rc

KINDS = [
    kind
    for kind in rc.tasks.object_kinds()
    if "top" in rc.tasks.object_info(kind)["grasps"] and kind not in rc.tasks.default_object_kinds()
]
FEW = ["block_arch", "can", "screwdriver"]


def picked(kind: str, starts: int, folder: Path) -> tuple[int, dict[str, int]]:
    """How many of so many starts succeed at the first attempt, and why the others do not."""
    run = rc.RunConfig.load("examples/demo.yaml")
    run.task.objects = [kind]
    run.cameras.streams.clear()
    run.output, run.episodes, run.max_attempts = str(folder), starts, 1
    run.keep = rc.generate.Keep.ALL
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    done, failures = 0, dict[str, int]()
    for item in rc.generate.make_plan(run):
        result = runner.run(item)
        done += result.success
        for reason, count in result.failures.items():
            failures[reason] = failures.get(reason, 0) + count
    return done, failures


@pytest.mark.parametrize("kind", FEW)
def test_five_starts_of_a_kind_are_picked(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(Path(__file__).resolve().parents[2])
    done, failures = picked(kind, 5, tmp_path / "out")
    assert done >= 4, failures


@pytest.mark.soak
@pytest.mark.parametrize("kind", KINDS)
def test_twenty_starts_of_each_kind_are_picked(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(Path(__file__).resolve().parents[2])
    done, failures = picked(kind, 20, tmp_path / "out")
    assert done >= 16, failures
