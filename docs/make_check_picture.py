"""Draws docs/check_*.png: what `robocell check --picture` makes of a robot.

Most are robots of the Menagerie: without it (docs/assets.md) their pictures stay as they are.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from figures import DOCS, save
from PIL import Image

from robocell import models

EXAMPLES = DOCS.parent / "examples"
ROBOTS = {
    "rc7": Path(models.robot_file("rc7")),
    **{name: EXAMPLES / f"{name}.yaml" for name in ("fr3_2f85", "gen3_2f85", "panda", "xarm7")},
}
WIDTH = 640  # px


def draw(name: str, robot_file: Path) -> None:
    """Runs the command and writes its picture smaller."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "robot.png"
        command = [sys.executable, "-m", "robocell", "check", str(robot_file)]
        done = subprocess.run(
            [*command, "--picture", str(picture)], check=False, capture_output=True, text=True
        )
        if done.returncode:
            print(f"{name}: no picture: {done.stderr.strip()}")
            return
        save(Image.open(picture), f"check_{name}.png", WIDTH)


def main() -> None:
    """All of them."""
    for name, robot_file in ROBOTS.items():
        draw(name, robot_file)


if __name__ == "__main__":
    main()
