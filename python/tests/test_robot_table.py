"""The tables of `robocell check`: joints, frames, keyframes of a robot."""

from __future__ import annotations

from pathlib import Path

import robocell
from command_line import (
    RC7,
    robocell_command,
)
from test_robot_checks import SUCTION, write_suction


def test_check_lists_keyframes(tmp_path: Path):
    robot = write_suction(tmp_path)
    key = '<keyframe><key name="home" qpos="0.5"/><key name="up" qpos="0"/></keyframe></mujoco>'
    (tmp_path / "bob.xml").write_text(SUCTION.replace("</mujoco>", key))
    assert "keyframes: home, up\n" in robocell_command("check", robot).stdout


def test_check_shows_the_built_in_robot_without_findings(tmp_path: Path):
    picture = tmp_path / "rc7.png"
    result = robocell_command("check", RC7, "--picture", picture)
    assert result.returncode == 0, result.stderr
    for text in ("move groups: arm, gripper", "reach: ", "tcp", "wrist_camera"):
        assert text in result.stdout
    ctrl = robocell.RobotConfig.load(RC7).move_groups["gripper"].ctrl
    assert ctrl is not None
    assert (
        f"    Gripper 'gripper': ctrl {ctrl.closed:g} closed, {ctrl.open:g} open\n" in result.stdout
    )
    assert "no problems found" in result.stdout, result.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")
