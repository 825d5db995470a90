"""Scripted experts succeed with several robots: the long form of the table, and its text."""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

import pytest

import robocell as rc
import success_table


@pytest.mark.soak
@pytest.mark.parametrize(
    ("kind", "robot"),
    [
        pair
        for pair in product(success_table.KINDS, success_table.ROBOTS)
        if success_table.is_measured(*pair)
    ],
)
def test_an_expert_succeeds_from_most_starts(kind: str, robot: str):
    starts = 10 if kind == "pour" else 50  # 20 grains take the engine seconds
    cell = success_table.measure(robot, kind, starts=starts)
    if kind in success_table.TWO_ARM_KINDS and robot not in success_table.TWO_ARMED:
        assert "is for two" in cell.why_not
        return
    assert not cell.why_not + cell.error, cell
    assert cell.successes >= success_table.LEAST.get(kind, 0.9) * cell.starts, cell


@pytest.mark.parametrize(
    ("robot", "kind"), [("rc7", "press"), ("desk6", "push"), ("desk5", "pick")]
)
def test_an_expert_succeeds_from_one_start(robot: str, kind: str):
    cell = success_table.measure(robot, kind, starts=1)
    assert cell.successes == 1, cell


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
        "| `open` | rc7 | 17/20 | 64–95 % |  | 2 it slipped, 1 timeout |"
    )
    cell = success_table.Cell(20, successes=20, seconds=0.25)
    assert cell.row("open", "rc7") == "| `open` | rc7 | 20/20 | 84–100 % | 14400 |  |"
    cell = success_table.Cell(20, successes=20, seconds=90)
    assert cell.row("pour", "rc7") == "| `pour` | rc7 | 20/20 | 84–100 % | 40 |  |"
    cell = success_table.Cell(20, why_not="it has no gripper")
    assert cell.row("open", "arm") == "| `open` | arm | – | | | it has no gripper |"


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


def test_names_are_checked_before_anything_is_measured(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    words = "success_table --kinds opne,stack --robots rc7,nobody.yaml --objects microwve,mug"
    monkeypatch.setattr("sys.argv", words.split())
    with pytest.raises(SystemExit) as left:
        success_table.main()
    assert left.value.code == 2
    printed = capsys.readouterr()
    for text in ("no task 'opne'", "Did you mean 'open'?", "nobody.yaml", "xarm7", "microwve"):
        assert text in printed.err, text
    assert "'stack': " in printed.err  # it has no field `objects`
    assert "'mug'" not in printed.err
    assert "|" not in printed.out  # no row


def test_an_error_of_a_pair_is_its_row_and_the_others_are_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    def roll_out(robot: str, kind: str, starts: int, *_: object) -> success_table.Cell:
        if kind == "open":
            raise rc.ArgumentError("no free place for\nthe cupboard")
        return success_table.Cell(starts, successes=1)

    page = tmp_path / "page.md"
    page.write_text(f"{success_table.BEGIN}\n{success_table.END}\n")
    monkeypatch.setattr(success_table, "roll_out", roll_out)
    monkeypatch.setattr(success_table, "ProcessPoolExecutor", ThreadPoolExecutor)
    words = f"success_table --kinds open,close --robots rc7 --starts 1 --page {page}"
    monkeypatch.setattr("sys.argv", words.split())
    with pytest.raises(SystemExit, match="1 of 2 pairs ended with an error"):
        success_table.main()
    text = page.read_text()
    assert "| `open` | rc7 | error | | | ArgumentError: no free place for the cupboard |" in text
    assert "| `close` | rc7 | 1/1 |" in text
    capsys.readouterr()
