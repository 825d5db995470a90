"""Draws docs/example_*.png: what the examples make, as they stand in examples/.

Of an example that makes a dataset, frames of its episodes' videos are shown; the others give their
picture.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import DOCS, save, sheet, spread
from PIL import Image

import robocell as rc

EXAMPLES = DOCS.parent / "examples"
READING = "06_read_dataset"  # makes one only to have something to read
FRAMES = 5  # of a video
WIDTH = 960  # px


def draw(example: Path) -> None:
    """Runs an example and keeps its picture."""
    name = f"example_{example.stem[:2]}.png"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        soft = {**os.environ, "ROBOCELL_RENDERER": "soft"}  # the same pictures on every machine
        subprocess.run([sys.executable, example, out], check=True, capture_output=True, env=soft)
        made = list(out.glob("*/dataset.json"))
        if not made or example.stem == READING:
            save(Image.open(out / "picture.png"), name)
            return
        dataset = rc.Dataset(made[0].parent)
        rows = [spread(episode.frames(episode.cameras[0]), FRAMES) for episode in dataset]
        save(sheet(rows), name, WIDTH)


def main() -> None:
    """All of them."""
    for example in sorted(EXAMPLES.glob("[0-9]*.py")):
        draw(example)


if __name__ == "__main__":
    main()
