"""Hands with many joints from Python: named poses in robot files, scenes and environments."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import hand_models
import robocell as rc
from command_line import robocell_command


@pytest.fixture(scope="module")
def hand_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robot file of an arm with such a hand, as `init` writes it."""
    folder = tmp_path_factory.mktemp("hand")
    (folder / "dex.xml").write_text(hand_models.arm_with_many_fingered_hand())
    done = robocell_command("init", folder / "dex.xml", "-o", folder / "dex.yaml")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "dex.yaml"


def robot_of(config: rc.RobotConfig) -> rc.Robot:
    spec = rc.SceneSpec(name="hand", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="dex", config=config))
    scene = rc.Scene.build(spec)
    scene.reset()
    return rc.Robot.of(scene, "dex")


def simulate(robot: rc.Robot, seconds: float) -> None:
    for _ in range(round(seconds / 0.002)):
        robot.update()
        assert robot.scene.step()


def test_init_writes_the_poses_with_their_reasons(hand_file: Path):
    group = rc.RobotConfig.load(hand_file).move_groups["gripper"]
    assert list(group.poses) == ["open", "closed", "pinch"]
    assert set(group.poses["open"]) == set(group.actuators)
    text = " ".join(hand_file.read_text().replace("#", " ").split())
    assert "its thumb 'th__3', the fingertip that stands apart, closes against" in text
    assert robocell_command("check", hand_file).stdout.endswith("no problems found\n")


def test_a_hand_moves_to_its_poses(hand_file: Path):
    config = rc.RobotConfig.load(hand_file)
    robot = robot_of(config)
    hand = robot.gripper
    assert hand.pose_names == ["open", "closed", "pinch"]
    assert hand.closing_pose == "closed"
    hand.move_to_pose("pinch")
    simulate(robot, 1)
    assert hand.closing_pose == "pinch"
    assert hand.inter_finger_dist < 0.003
    actuators = [str(name) for name in config.move_groups["gripper"].actuators]
    pinch = [config.move_groups["gripper"].poses["pinch"][name] for name in actuators]
    np.testing.assert_allclose(hand.ctrl, pinch, atol=1e-12)
    hand.move_to_pose("open")
    simulate(robot, 1)
    assert hand.is_open
    robot.scene.reset()
    assert hand.closing_pose == "closed"
    with pytest.raises(rc.NotFoundError, match="Did you mean 'pinch'"):
        hand.move_to_pose("pinsh")
    with pytest.raises(rc.ArgumentError, match="cannot close towards its pose 'open'"):
        hand.closing_pose = "open"


def test_poses_are_edited_in_place_and_saved(hand_file: Path, tmp_path: Path):
    config = rc.RobotConfig.load(hand_file)
    group = config.move_groups["gripper"]
    group.poses["open"]["m_f0_1"] = -0.2
    group.poses["wave"] = {"m_f1_1": -0.3}
    group.closing_pose = "pinch"
    (tmp_path / "saved.yaml").write_text(config.to_yaml())
    again = rc.RobotConfig.load(tmp_path / "saved.yaml").move_groups["gripper"]
    assert again.poses["open"]["m_f0_1"] == -0.2
    assert dict(again.poses["wave"]) == {"m_f1_1": -0.3}
    assert again.closing_pose == "pinch"


def test_environments_close_towards_the_configured_pose(hand_file: Path):
    config = rc.RobotConfig.load(hand_file)
    config.move_groups["gripper"].closing_pose = "pinch"
    env = rc.Env(rc.EnvConfig(robots={"dex": config}, control_mode="joints"))
    env.reset(seed=1)
    hand = env.scene.robot("dex").gripper
    env.step({"dex": {"joints": [0] * 6, "gripper": 0}})
    assert hand.closing_pose == "pinch"
    actuators = [str(name) for name in config.move_groups["gripper"].actuators]
    poses = config.move_groups["gripper"].poses
    np.testing.assert_allclose(hand.ctrl, [poses["pinch"][name] for name in actuators], atol=1e-9)


def test_a_task_space_is_a_field_of_an_arm(hand_file: Path):
    config = rc.RobotConfig.load(hand_file)
    config.move_groups["arm"].task_space = {"kind": "axis", "axis": [0, 0, 1], "cone": 0.2}
    space = config.move_groups["arm"].task_space
    assert space is not None
    assert space.kind == rc.robots.TaskSpaceKind.AXIS
    robot = robot_of(config)
    target = robot.fk_frame() * rc.Pose(translation=[0, 0, 0.02], rpy=[0.05, 0, 1.5])
    assert robot.apply({"arm": rc.control.GroupCommand.leaf_pose(target)})
    reached = robot.fk_frame(robot.controller("arm").target)
    np.testing.assert_allclose(reached.translation, target.translation, atol=2e-5)
    cosine = reached.rotation[:, 2] @ target.rotation[:, 2]
    assert np.arccos(np.clip(cosine, -1, 1)) <= 0.2 + 1e-4
