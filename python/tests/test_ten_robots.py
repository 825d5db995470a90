"""Ten kinds of robots work as `robocell init` writes them, without an edit.

One of them is a part of `make test`; `make check-proofs` has them all, with picks.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import robocell as rc
from command_line import robocell_command
from robocell._cli.ik_answers import reachable_poses, solve_each
from robocell._cli.robot_scene import RobotScene, load_robot
from robot_models import TEN

QUICK = "delta"
IK_TARGETS, IK_TOLERANCE = 40, 1e-5
TIMESTEP_S = 0.002
EPISODES, LEAST = 3, 2
# Fingers of the three-finger hand turn as they close: its grasps are planned for pads that do not.
PICKING = [n for n, (_, arms, hands) in TEN.items() if arms and hands and n != "three_fingers"]


def each(names: list[str]) -> list[Any]:
    """Parameters: all but the quick one are proofs."""
    return [pytest.param(name, marks=() if name == QUICK else pytest.mark.proof) for name in names]


def written(folder: Path, name: str) -> Path:
    """The robot file that `init` writes."""
    model = folder / f"{name}.xml"
    model.write_text(TEN[name][0]())
    done = robocell_command("init", model, "-o", folder / "robot.yaml")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "robot.yaml"


def groups_of_kind(file: Path, kind: str) -> list[str]:
    groups = yaml.safe_load(file.read_text())["move_groups"]
    return [name for name, group in groups.items() if group["kind"] == kind]


def arms_recover_poses(loaded: RobotScene) -> None:
    targets = reachable_poses(loaded.robot, IK_TARGETS, np.random.default_rng(5))
    answers = solve_each(loaded.robot, targets, IK_TOLERANCE)
    assert np.all(answers.solved(IK_TOLERANCE)), np.flatnonzero(~answers.solved(IK_TOLERANCE))


def stays_at_home(loaded: RobotScene, arms: list[str], grippers: list[str]) -> None:
    scene, robot = loaded.scene, loaded.robot
    homes = {name: np.array(robot.group(name).joint_pos) for name in arms}
    for _ in range(round(1 / TIMESTEP_S)):
        robot.update()
        result = scene.step()
        assert result, result.message
    for name, home in homes.items():
        now = robot.group(name).joint_pos
        np.testing.assert_allclose(now, home, atol=loaded.config.arrival_tolerance)
    for name in grippers:
        gripper = robot.group(name)
        assert isinstance(gripper, rc.robots.GripperGroup)
        assert gripper.is_open


@pytest.mark.parametrize("name", each(list(TEN)))
def test_a_robot_loads_rests_and_reaches(tmp_path: Path, name: str):
    _, arms, grippers = TEN[name]
    file = written(tmp_path, name)
    assert groups_of_kind(file, "arm") == arms
    assert groups_of_kind(file, "gripper") == grippers
    checked = robocell_command("check", file)
    assert checked.stdout.splitlines()[-1] == "no problems found", checked.stdout
    loaded = load_robot(file)
    loaded.scene.reset()
    stays_at_home(loaded, arms, grippers)
    if arms:
        arms_recover_poses(loaded)


@pytest.mark.proof
@pytest.mark.parametrize("name", PICKING)
def test_a_robot_picks(tmp_path: Path, name: str):
    written(tmp_path, name)
    done = robocell_command(
        "generate",
        tmp_path / "robot_pick.yaml",
        "--episodes",
        EPISODES,
        "--workers",
        "1",
        "--set",
        "cameras.streams=[]",
        cwd=tmp_path,
    )
    made = re.search(r"episodes +(\d+) of", done.stdout)
    assert made, done.stdout + done.stderr
    assert int(made[1]) >= LEAST, done.stdout
