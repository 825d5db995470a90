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


def arms_recover_poses(robot: rc.Robot) -> None:
    targets = reachable_poses(robot, IK_TARGETS, np.random.default_rng(5))
    answers = solve_each(robot, targets, IK_TOLERANCE)
    assert np.all(answers.solved(IK_TOLERANCE)), np.flatnonzero(~answers.solved(IK_TOLERANCE))


def at_home(config: rc.RobotConfig) -> rc.Robot:
    spec = rc.SceneSpec(name="alone", timestep=TIMESTEP_S, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="robot", config=config))
    scene = rc.Scene.build(spec)
    scene.reset()
    return rc.Robot.of(scene, "robot")


def stays_at_home(robot: rc.Robot, arms: list[str], grippers: list[str], tolerance: float) -> None:
    homes = {name: np.array(robot.group(name).joint_pos) for name in arms}
    for _ in range(round(1 / TIMESTEP_S)):
        robot.update()
        result = robot.scene.step()
        assert result, result.message
    for name, home in homes.items():
        now = robot.group(name).joint_pos
        np.testing.assert_allclose(now, home, atol=tolerance)
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
    config = rc.RobotConfig.load(file)
    robot = at_home(config)
    stays_at_home(robot, arms, grippers, config.arrival_tolerance)
    if arms:
        arms_recover_poses(robot)


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
