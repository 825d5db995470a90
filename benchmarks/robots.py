"""The robots that benchmarks run on: the built-in one, and what is found of the Menagerie."""

from __future__ import annotations

from pathlib import Path

import robocell
from robocell._cli.robot_scene import load_robot

ROOT = Path(__file__).resolve().parents[1]


def robot_files() -> list[Path]:
    """Robot files that can be built here; says which cannot."""
    files = [ROOT / "models/robots/rc7/rc7.yaml", ROOT / "examples/xarm7.yaml"]
    return [file for file in files if is_available(file)]


def arm_files() -> list[Path]:
    """Those, and the other arms of the examples."""
    others = ["panda", "fr3_2f85", "gen3_2f85"]
    files = [ROOT / "examples" / f"{name}.yaml" for name in others]
    return robot_files() + [file for file in files if is_available(file)]


def is_available(file: Path) -> bool:
    """Whether the robot's model is found."""
    try:
        load_robot(file)
    except robocell.Error as error:
        print(f"left out: {file.name}: {error}")
        return False
    return True
