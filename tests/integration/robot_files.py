"""The robot files that robocell ships. No test in itself."""

from __future__ import annotations

from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]


def is_robot(file: Path) -> bool:
    """Whether a YAML file describes a robot, not a run or a scene."""
    content = yaml.safe_load(file.read_text())
    return isinstance(content, dict) and "model" in content


def kinds(file: Path) -> set[str]:
    """Of the groups of a robot."""
    groups = yaml.safe_load(file.read_text())["move_groups"]
    return {group["kind"] for group in groups.values()}


def arms(file: Path) -> bool:
    """Whether it stands alone: grippers without an arm are parts of other robots."""
    return "arm" in kinds(file)


ROBOT_FILES = [
    file
    for folder in ("models", "examples")
    for file in sorted((ROOT / folder).rglob("*.yaml"))
    if is_robot(file) and arms(file)
]
# Those that can grasp.
GRASPING_FILES = [file for file in ROBOT_FILES if "gripper" in kinds(file)]
