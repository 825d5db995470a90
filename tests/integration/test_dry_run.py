"""What `--dry-run` expects is what comes: the same figures, counted on the disk afterwards."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from commands import LONGEST_S, generate, robocell_command
from conftest import BLIND, DEMO, DEMO_EPISODES, EXAMPLE
from generated_run import GeneratedRun
from memory import resident_bytes, resident_bytes_from_now

from command_line import environment_with, new_process
from robocell._generation.procfs import MemoryWatch

WITHIN = 0.2


def expect_what_came(run: Path, dataset: Path, scratch: Path, *options: object) -> dict[str, Any]:
    """Compares the estimate with a dataset of the same run, and returns it."""
    words = ("generate", run, "--output", scratch, "--dry-run", "--progress", "jsonl")
    result = new_process(  # a fork would count the memory of what it was forked from
        *words, *options, environment=environment_with({}), timeout_s=LONGEST_S
    )
    assert result.returncode == 0, result.stderr
    assert not scratch.exists(), "a dry run writes nothing"
    expected: dict[str, Any] = json.loads(result.stdout)
    counted = json.loads(robocell_command("report", "--json", dataset).stdout)["on_disk"]
    assert expected["episodes"] == len(counted)
    for what in ("rows", "frames", "bytes"):
        came = sum(episode[what] for episode in counted)
        assert expected[what] == pytest.approx(came, rel=WITHIN), what
    assert (expected["seen"] > 0) == (expected["frames"] > 0), "only cameras need a second try"
    return expected


@pytest.mark.proof  # a small run without a second camera is in test_estimate.py
@pytest.mark.parametrize(
    ("run", "made", "options"),
    [
        (DEMO, "rc7_run", ("--episodes", DEMO_EPISODES)),
        (EXAMPLE, "xarm7_blind_run", BLIND),
    ],
    ids=["rc7", "xarm7 without cameras"],
)
def test_a_dataset_matches_its_estimate(
    run: Path,
    made: str,
    options: Sequence[object],
    tmp_path: Path,
    request: pytest.FixtureRequest,
):
    came: GeneratedRun = request.getfixturevalue(made)
    words = ("--workers", 2, *options)
    expected = expect_what_came(run, came.dataset, tmp_path / "none", *words)
    assert expected["memory_bytes"] == pytest.approx(came.peak_bytes, rel=WITHIN)


@pytest.mark.soak
@pytest.mark.parametrize("run", [DEMO, EXAMPLE], ids=["rc7", "xarm7"])
@pytest.mark.parametrize("workers", [1, 2])
def test_time_and_memory_match_their_estimates(run: Path, workers: int, tmp_path: Path):
    # On a machine that does nothing else meanwhile.
    words = ("--workers", workers)
    with MemoryWatch(resident_bytes_from_now()) as watch:
        began = time.monotonic()
        generate(run, tmp_path / "out", *words, as_a_person=True)
        took = time.monotonic() - began
    expected = expect_what_came(run, tmp_path / "out", tmp_path / "none", *words)
    assert expected["memory_bytes"] == pytest.approx(watch.bytes, rel=WITHIN)
    assert expected["seconds"] == pytest.approx(took, rel=WITHIN)


def test_memory_of_earlier_processes_is_not_counted():
    hold = [sys.executable, "-c", "print(flush=True); input()"]
    with contextlib.ExitStack() as stack:

        def start() -> int:
            process = stack.enter_context(
                subprocess.Popen(hold, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            )
            assert process.stdin
            assert process.stdout
            stack.callback(process.stdin.close)
            process.stdout.readline()
            return process.pid

        start()
        count = resident_bytes_from_now()
        assert count() == 0
        started = start()
        assert count() == pytest.approx(resident_bytes(started), rel=0.1)
