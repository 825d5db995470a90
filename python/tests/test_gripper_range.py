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


def test_prints_the_range_of_grippers():
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
def test_the_range_of_a_linkage_gripper_is_configured_or_measured(tmp_path: Path, measured: bool):
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


HAND = """<mujoco model="hand"><compiler angle="radian"/><worldbody><body name="palm">
<geom type="box" size="0.04 0.06 0.02" mass="0.4"/>
<body name="left" pos="0 0.04 0.05"><joint name="left" type="slide" axis="0 1 0"
range="-0.04 0.01" damping="5"/><geom type="box" size="0.012 0.006 0.04" mass="0.05"/></body>
<body name="right" pos="0 -0.04 0.05"><joint name="right" type="slide" axis="0 -1 0"
range="-0.04 0.01" damping="5"/><geom type="box" size="0.012 0.006 0.04" mass="0.05"/></body>
</body></worldbody><equality><joint joint1="left" joint2="right"/></equality>
<actuator><position name="grip" joint="left" kp="800" kv="10" ctrlrange="-0.04 0.01"/></actuator>
</mujoco>"""


@pytest.mark.proof
def test_a_hand_without_an_arm_is_measured_and_checked(tmp_path: Path):
    (tmp_path / "hand.xml").write_text(HAND)
    path = tmp_path / "hand.yaml"
    path.write_text(
        "name: hand\nmodel: hand.xml\nmove_groups:\n  gripper: {kind: gripper, "
        "joints: [left, right], actuators: grip, fingers: [{body: left}, {body: right}]}\n"
    )
    result = robocell_command("gripper-range", path)
    assert result.returncode == 0, result.stderr
    assert "Gripper 'gripper': 0.000 - 0.088" in result.stdout
    result = robocell_command("check", path, "--picture", tmp_path / "hand.png")
    assert result.returncode == 0, result.stderr
    assert "no problems found" in result.stdout
    assert "no expert can use this robot" in result.stdout
    assert "reach:" not in result.stdout
    refused = robocell_command("reach", path, "--plane", "z=0.4")
    assert refused.returncode == 2
    assert "robot 'hand' has no arm group" in refused.stderr
