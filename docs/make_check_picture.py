"""Draws docs/check_rc7.png: what `robocell check --picture` makes of the built-in robot."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from robocell import models

OUT = Path(__file__).parent / "check_rc7.png"
SIZE = (640, 480)  # width, height in pixels
COLOURS = 128


def main() -> None:
    """Runs the command and writes its picture smaller."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "rc7.png"
        command = [sys.executable, "-m", "robocell", "check", str(models.robot_file("rc7"))]
        subprocess.run([*command, "--picture", str(picture)], check=True, capture_output=True)
        image = Image.open(picture).convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    image.quantize(COLOURS).save(OUT, optimize=True)
    print(OUT)


if __name__ == "__main__":
    main()
