"""Scripted experts succeed with several robots: the long form of the table, and its text."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

import success_table


@pytest.mark.soak
@pytest.mark.parametrize("kind", success_table.KINDS)
@pytest.mark.parametrize("robot", success_table.ROBOTS)
def test_an_expert_succeeds_from_most_starts(robot: str, kind: str):
    cell = success_table.measure(robot, kind, starts=20)
    assert not cell.why_not, cell
    assert cell.successes >= success_table.LEAST.get(kind, 0.9) * cell.starts, cell


@pytest.mark.proof
def test_the_expert_pours():
    cell = success_table.measure("rc7", "pour", starts=1)
    assert cell.successes == 1, cell


def test_a_kind_has_the_steps_of_its_example():
    assert success_table.max_steps("sort") == 1200
    assert success_table.max_steps("pick") == success_table.MAX_STEPS


def test_the_interval_is_wilsons():
    low, high = success_table.interval(18, 20)  # R: binom::binom.wilson(18, 20)
    assert low == pytest.approx(0.6989664, abs=1e-4)
    assert high == pytest.approx(0.9721335, abs=1e-4)
    assert success_table.interval(20, 20)[1] == 1
    assert success_table.interval(0, 20)[0] == 0


def test_a_row_has_failures_by_reason_or_why_it_does_not_apply():
    cell = success_table.Cell(20, successes=17, failures=Counter({"timeout": 1, "it slipped": 2}))
    assert cell.row("open", "rc7") == (
        "| `open` | rc7 | 17/20 | 64–95 % | 2 it slipped, 1 timeout |"
    )
    cell = success_table.Cell(20, why_not="it has no gripper")
    assert cell.row("open", "arm") == "| `open` | arm | – | | it has no gripper |"


def test_a_robot_without_a_gripper_gets_its_reason(tmp_path: Path):
    robot = tmp_path / "arm.yaml"
    robot.write_text(
        "name: arm\nmodel: rc7\nroot_body: base_link\nbase: {kind: mocap, size: [0.2, 0.2, 0.2]}\n"
        "move_groups:\n  arm: {kind: arm, joints: joint1..joint7, actuators: servo1..servo7,"
        " leaf: {site: tcp}}\n"
    )
    cell = success_table.measure(str(robot), "open", starts=1)
    assert "gripper" in cell.why_not


def test_a_page_keeps_what_is_around_its_table(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{success_table.BEGIN}\nold\n{success_table.END}\nafter\n")
    success_table.write_page(page, "new")
    expected = f"before\n{success_table.BEGIN}\nnew\n{success_table.END}\nafter\n"
    assert page.read_text() == expected
    page.write_text("no marks\n")
    with pytest.raises(SystemExit, match="no lines"):
        success_table.write_page(page, "new")
