"""A hand without an arm: its base moves to a target and carries a cube."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import robocell as rc

TIMESTEP = 0.002
HAND = """<mujoco model="hand">
  <worldbody>
    <body name="palm">
      <geom type="box" size="0.03 0.06 0.02" mass="0.5"/>
      <site name="tcp" pos="0 0 -0.1" euler="180 0 0"/>
      <body name="left" pos="0 0.04 -0.06">
        <joint name="left_slide" type="slide" axis="0 -1 0" range="0 0.04" damping="5"/>
        <geom name="left_pad" type="box" size="0.012 0.005 0.05" mass="0.05" friction="1.5"/>
      </body>
      <body name="right" pos="0 -0.04 -0.06">
        <joint name="right_slide" type="slide" axis="0 1 0" range="0 0.04" damping="5"/>
        <geom name="right_pad" type="box" size="0.012 0.005 0.05" mass="0.05" friction="1.5"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="left" joint="left_slide" kp="800" ctrlrange="0 0.04" forcerange="-20 20"/>
    <position name="right" joint="right_slide" kp="800" ctrlrange="0 0.04" forcerange="-20 20"/>
  </actuator>
</mujoco>"""

ROBOT = """name: hand
model: hand.xml
base: {kind: driven, max_linear_speed: 0.4}
move_groups:
  gripper: {kind: gripper, joints: [left_slide, right_slide], actuators: [left, right],
            fingers: [left_pad, right_pad], leaf: {site: tcp}, ctrl: {open: 0, closed: 0.04}}
"""


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    (tmp_path / "hand.xml").write_text(HAND)
    path = tmp_path / "hand.yaml"
    path.write_text(ROBOT)
    return path


@pytest.fixture
def hand(robot_file: Path) -> rc.Robot:
    config = rc.RobotConfig.load(str(robot_file))
    cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, mass=0.1)
    cube.pos, cube.rgba = [0, 0, 0.02], [1, 0.5, 0, 1]
    cube.friction = [0.8, 0.02, 0.001]
    spec = rc.SceneSpec(name="carry", timestep=TIMESTEP, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="hand", config=config, pos=[0, 0, 0.115]))
    spec.objects.append(cube)
    return rc.Scene.build(spec).robot("hand")


def run(robot: rc.Robot, seconds: float) -> None:
    for _ in range(round(seconds / TIMESTEP)):
        robot.update()
        robot.step()


def test_a_driven_base_carries_the_grasped_object(hand: rc.Robot):
    base = hand.base
    assert base.is_driven
    assert (base.max_linear_speed, base.max_angular_speed) == (0.4, 2)
    hand.gripper.close()
    run(hand, 1)
    assert hand.gripper.is_grasping("cube")
    held = base.pose.inverse() * hand.scene.body_pose("cube")
    away = rc.Pose(translation=[0.3, 0, 0.2], rpy=[0, 0, 1]) * base.pose
    base.target = away
    run(hand, 2)
    assert base.pose.is_close(away, 1e-3, 1e-3)
    now = base.pose.inverse() * hand.scene.body_pose("cube")
    assert now.is_close(held, 0.05, 3e-3)
    hand.apply({"base": rc.control.GroupCommand.base_pose(rc.Pose(translation=[0, 0, 0.3]))})
    assert base.target == rc.Pose(translation=[0, 0, 0.3])
    base.max_linear_speed = 1
    assert (base.max_linear_speed, base.max_angular_speed) == (1, 2)
    with pytest.raises(rc.ArgumentError, match="the largest speeds cannot be 1 m/s and 0 rad/s"):
        base.max_angular_speed = 0


def test_other_bases_have_no_target():
    spec = rc.SceneSpec(name="s", timestep=TIMESTEP, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    base = rc.Scene.build(spec).robot("rc7").base
    assert not base.is_driven
    with pytest.raises(rc.ArgumentError, match="only a driven base moves to a target"):
        base.target = rc.Pose()


def test_speeds_belong_to_a_driven_base(robot_file: Path):
    robot_file.write_text(ROBOT.replace("driven", "mocap"))
    with pytest.raises(rc.SpecError) as caught:
        rc.RobotConfig.load(str(robot_file))
    assert "base.max_linear_speed: belongs to a driven base; this one's kind is mocap" in str(
        caught.value
    )
    assert "hand.yaml:3:" in str(caught.value)


def test_a_gripper_rejects_relative_steps(robot_file: Path, hand: rc.Robot):
    message = (
        "a gripper cannot have the controller 'relative_joint_position'. It can have: "
        "joint_position, which takes its opening"
    )
    with pytest.raises(rc.ArgumentError) as caught:
        hand.set_controller("gripper", "relative_joint_position")
    assert str(caught.value).endswith(f"group 'gripper': {message}")
    robot_file.write_text(ROBOT + "control: {gripper: relative_joint_position}\n")
    with pytest.raises(rc.SpecError) as caught_in_file:
        rc.RobotConfig.load(str(robot_file))
    assert re.search(rf"hand\.yaml:7:\d+: control\.gripper: {message}", str(caught_in_file.value))


def test_the_root_frame_of_a_gripper_is_its_leaf_frame(hand: rc.Robot):
    gripper = hand.gripper
    assert gripper.root_frame_to_world == gripper.leaf_frame_to_world
    tcp = hand.scene.site_pose("tcp")
    np.testing.assert_allclose(gripper.root_frame_to_world.matrix, tcp.matrix, atol=1e-12)
