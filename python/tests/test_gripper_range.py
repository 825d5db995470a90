"""`robocell gripper-range`: the range of finger distances, said or measured."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import robocell
from command_line import (
    RC7,
    REPOSITORY,
    robocell_command,
)
from menagerie import require_menagerie


def test_the_range_of_grippers_is_printed_in_this_form():
    result = robocell_command("gripper-range", RC7)
    assert result.returncode == 0, result.stderr
    first, second = result.stdout.splitlines()
    assert first == "Gripper finger ranges:"
    config = robocell.RobotConfig.load(RC7)
    assert second.startswith("    Gripper 'gripper': ")
    closed, opened = map(float, second.rpartition(": ")[2].split(" - "))
    if config.move_groups["gripper"].distance:
        distance = config.move_groups["gripper"].distance
        assert (closed, opened) == (distance.closed, distance.open)
    assert 0 <= closed < opened < 0.2


@pytest.mark.parametrize("measured", [False, True])
def test_the_range_of_a_linkage_gripper_is_said_or_measured(tmp_path: Path, measured: bool):
    require_menagerie("ufactory_xarm7")
    text = (REPOSITORY / "examples" / "xarm7.yaml").read_text()
    said = ", distance: {closed: 0.004, open: 0.089}"
    assert text.count(said) == 1
    path = tmp_path / "xarm7.yaml"
    path.write_text(text.replace(said, "") if measured else text)
    result = robocell_command("gripper-range", path)
    assert result.returncode == 0, result.stderr
    first, second = result.stdout.splitlines()
    assert first == "Gripper finger ranges:"
    assert re.fullmatch(r"    Gripper 'gripper': 0\.00[234] - 0\.089", second), second
