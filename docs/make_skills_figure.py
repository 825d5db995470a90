"""Draws docs/skills.png: one episode of each example in examples/tasks, from start to end."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from figures import DOCS
from PIL import Image

import robocell as rc

EXAMPLES = DOCS.parent / "examples" / "tasks"
KINDS = (
    *("stack", "place_next_to", "open", "close", "press", "push"),
    *("insert", "sort", "wipe", "pour", "relations"),
)
SHARES = (0.0, 0.3, 0.55, 0.8, 1.0)  # of the episode, at which a frame is shown


def strip(kind: str, folder: Path) -> np.ndarray:
    """Pictures of one episode beside each other."""
    run = rc.RunConfig.load(EXAMPLES / f"{kind}.yaml")
    run.output = str(folder / kind)
    run.episodes = 1
    run.cameras.streams = [stream for stream in run.cameras.streams if stream.name == "exo"]
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    episode = rc.Dataset(run.output)[0]
    rows = [round(share * (len(episode["phase"]) - 1)) for share in SHARES]
    return np.concatenate([episode.frame("exo", row) for row in rows], axis=1)


def main() -> None:
    """Generates the episodes and draws them."""
    with tempfile.TemporaryDirectory() as folder:
        strips = [strip(kind, Path(folder)) for kind in KINDS]
    picture = Image.fromarray(np.concatenate(strips))
    small = picture.resize((picture.width * 3 // 5, picture.height * 3 // 5))
    small.quantize(160).save(DOCS / "skills.png", optimize=True)


if __name__ == "__main__":
    main()
