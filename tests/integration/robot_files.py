"""The robot files that robocell ships. No test in itself."""

from __future__ import annotations

from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]


def is_robot(file: Path) -> bool:
    """Whether a YAML file describes a robot, not a run or a scene."""
    content = yaml.safe_load(file.read_text())
    return isinstance(content, dict) and "model" in content


ROBOT_FILES = [
    file
    for pattern in ("models/robots/*/*.yaml", "examples/*.yaml", "examples/*/*.yaml")
    for file in sorted(ROOT.glob(pattern))
    if is_robot(file)
]
