"""Draws docs/two_arms.png: one episode of each example for two arms, from start to end."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from figures import DOCS
from make_skills_figure import strip
from PIL import Image

KINDS = ("handover", "carry")


def main() -> None:
    """Generates the episodes and draws them."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Image.fromarray(np.concatenate([strip(kind, Path(folder)) for kind in KINDS]))
    small = picture.resize((picture.width * 3 // 5, picture.height * 3 // 5))
    small.quantize(160).save(DOCS / "two_arms.png", optimize=True)


if __name__ == "__main__":
    main()
