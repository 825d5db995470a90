"""Draws the pictures of docs/tutorials/arm_in_houses.md with its files and commands."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import DOCS, save, sheet, spread
from PIL import Image

import robocell as rc

PAGE = DOCS / "tutorials" / "arm_in_houses.md"
WIDTH = 320  # of an image


def robocell(folder: Path, *arguments: str) -> None:
    """Runs a command in a folder."""
    subprocess.run([sys.executable, "-m", "robocell", *arguments], cwd=folder, check=True)


def main() -> None:
    """Draws them."""
    text = PAGE.read_text()
    run = re.search(r'title="house_picks.yaml"\n(.*?)^```', text, re.DOTALL | re.MULTILINE)
    assert run is not None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "examples").symlink_to(DOCS.parent / "examples")
        model, picture = "examples/desk6/desk6.xml", "desk6.png"
        robocell(folder, "init", model, "-o", "desk6.yaml", "--picture", picture)
        save(Image.open(folder / picture), "tutorials/arm_in_houses_robot.png", 480)
        (folder / "house_picks.yaml").write_text(run[1])
        robocell(folder, "generate", "house_picks.yaml")
        dataset = rc.Dataset(folder / "out" / "house_picks")
        rows = [spread(each.frames(camera), 3) for each in dataset for camera in ("side", "wrist")]
    save(sheet(rows), "tutorials/arm_in_houses_episodes.png", 3 * WIDTH)


if __name__ == "__main__":
    main()
