"""What `--dry-run` expects is what comes: the same figures, counted on the disk afterwards."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import ROOT, generate, robocell_command
from conftest import EXAMPLE
from generated_run import GeneratedRun

WITHIN = 0.2


def expect_what_came(run: Path, dataset: Path, scratch: Path) -> None:
    """Compares the estimate with a dataset of the same run."""
    words = ("generate", run, "--output", scratch, "--dry-run", "--progress", "jsonl")
    result = robocell_command(*words)
    assert result.returncode == 0, result.stderr
    assert not scratch.exists(), "a dry run writes nothing"
    expected = json.loads(result.stdout)
    counted = json.loads(robocell_command("report", "--json", dataset).stdout)["on_disk"]
    assert expected["episodes"] == len(counted) == 20
    for what in ("rows", "frames", "bytes"):
        came = sum(episode[what] for episode in counted)
        assert expected[what] == pytest.approx(came, rel=WITHIN), what


def test_the_demo_comes_as_expected(tmp_path: Path):
    demo = ROOT / "examples" / "demo.yaml"
    generate(demo, tmp_path / "out")
    expect_what_came(demo, tmp_path / "out", tmp_path / "none")


def test_a_real_arm_with_larger_images_comes_as_expected(xarm7_run: GeneratedRun, tmp_path: Path):
    expect_what_came(EXAMPLE, xarm7_run.dataset, tmp_path / "none")
