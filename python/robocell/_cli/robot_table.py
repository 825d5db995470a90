"""Tables of a robot file and its compiled model."""

from __future__ import annotations

import math

import numpy as np
from rich.table import Table

from robocell import Pose, Robot, RobotConfig
from robocell._cli.gripper_range import range_lines
from robocell._cli.robot_scene import RobotScene
from robocell.robots import BaseGroup, BaseKind, GripperGroup

# By the engine's number (mjtJoint). The package mujoco is imported by scenes only.
JOINT_KINDS = ("free", "ball", "slide, m", "hinge, rad")

CAMERA_TO_OPENCV = Pose(rpy=[math.pi, 0, 0])


def joints_table(loaded: RobotScene) -> Table:
    """Returns a table of every joint of every group: kind, limits, home."""
    table = _table("joints")
    for column in ("group", "joint", "kind", "lower", "upper", "home"):
        table.add_column(
            column, justify="right" if column in ("lower", "upper", "home") else "left"
        )
    model, robot = loaded.scene.model, loaded.robot
    for name in robot.group_names:
        group = robot.group(name)
        values = zip(group.joint_names, np.array(group.joint_pos_limits), strict=False)
        for joint, (lower, upper) in values:
            entry = model.joint(joint)
            home = loaded.scene.data.qpos[int(entry.qposadr[0])]
            kind = JOINT_KINDS[int(entry.type[0])]
            table.add_row(name, joint, kind, _number(lower), _number(upper), _number(home))
    return table


def actuators_table(loaded: RobotScene) -> Table:
    """Returns a table of every actuator of every group: control range and controller."""
    table = _table("actuators")
    for column in ("group", "actuator", "lowest", "highest", "controller"):
        table.add_column(column, justify="right" if column.endswith("est") else "left")
    for name in loaded.robot.group_names:
        group = loaded.robot.group(name)
        ranges = zip(group.actuator_names, np.array(group.ctrl_limits), strict=True)
        controller = loaded.robot.controller(name).kind if loaded.robot.is_driven(name) else "none"
        for actuator, (lowest, highest) in ranges:
            table.add_row(name, actuator, _number(lowest), _number(highest), controller)
    return table


def frames(loaded: RobotScene) -> dict[str, Pose]:
    """Returns the frames at home, in the world: base, leaf of each group, cameras.

    Cameras have OpenCV's axes: x right, y down, looking along z.
    """
    robot, scene = loaded.robot, loaded.scene
    found = {"base": robot.base_in_world}
    for name in robot.group_names:
        group = robot.group(name)
        if group.kind == "arm":
            found["tcp" if "tcp" not in found else f"tcp of {name}"] = group.leaf_frame_to_world
    for camera in scene.camera_names():
        found[camera] = scene.camera_pose(camera) * CAMERA_TO_OPENCV
    return found


def frames_table(loaded: RobotScene) -> Table:
    """Returns a table of the frames in the robot base frame."""
    table = _table("frames at home, in the robot base frame; cameras look along z")
    for column in ("frame", "x, y, z in m", "roll, pitch, yaw in degrees"):
        table.add_column(column)
    X_BW = loaded.robot.base_in_world.inverse()
    for name, X_WF in frames(loaded).items():
        X_BF = X_BW * X_WF
        table.add_row(name, _numbers(X_BF.translation), _numbers(np.degrees(X_BF.rpy), 1))
    return table


def summary_lines(loaded: RobotScene) -> list[str]:
    """Returns name, model, base, groups, reach, keyframes and gripper ranges."""
    config, robot = loaded.config, loaded.robot
    kinds = {name: robot.group(name).kind for name in robot.group_names}
    groups = (name if name == kind else f"{name} ({kind})" for name, kind in kinds.items())
    lines = [
        f"robot '{robot.name}' from {config.model}",
        f"base: {base_text(config, robot.base)}",
        f"move groups: {', '.join(groups)}",
    ]
    if loaded.has_arm:
        lines.append(f"reach: {robot.reach:.3f} m from the base to the TCP")
    lines.append(f"keyframes: {', '.join(loaded.scene.keyframes())}")
    ranges = range_lines(robot)
    return [*lines, "Gripper finger ranges:", *ranges, *ctrl_lines(robot)] if ranges else lines


def ctrl_lines(robot: Robot) -> list[str]:
    """Returns a line for each gripper: "    Gripper 'gripper': ctrl 255 closed, 0 open".

    A gripper with several actuators has the value of each, with its name.
    """
    lines = []
    for name in robot.group_names:
        group = robot.group(name)
        if isinstance(group, GripperGroup):
            ends = zip(*(group.raw_ctrls(opening) for opening in (0, 1)), strict=True)
            texts = [f"ctrl {closed:g} closed, {opened:g} open" for closed, opened in ends]
            if len(texts) > 1:
                named = zip(group.actuator_names, texts, strict=True)
                texts = [f"{actuator} {text}" for actuator, text in named]
            lines.append(f"    Gripper '{name}': {'; '.join(texts)}")
    return lines


def base_text(config: RobotConfig, base: BaseGroup) -> str:
    """Returns 'mocap, on a box of 0.25 x 0.25 x 0.25 m'."""
    kind = config.base.kind.name.lower()
    if config.base.kind == BaseKind.FIXED and base.is_mobile:
        kind = "free, by the free joint of its model's root"
    if config.base.size is None:
        return kind
    return f"{kind}, on a box of {' x '.join(f'{length:g}' for length in config.base.size)} m"


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left", box=None, pad_edge=False, title_style="bold")


def _number(value: float) -> str:
    """Formats a limit in short form; '-' without a limit."""
    return f"{value:.4g}" if math.isfinite(value) else "-"


def _numbers(values: np.ndarray, digits: int = 3) -> str:
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in values)
