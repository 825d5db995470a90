"""Draws docs/place.png: three episodes of examples/pick_and_place.yaml, each from start to end."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from figures import DOCS
from PIL import Image

import robocell as rc

RUN = DOCS.parent / "examples" / "pick_and_place.yaml"
EPISODES = 3
PHASES = ("open", "lift", "transfer", "release", "done")  # whose last frame is shown


def strip(episode: rc.data.Episode) -> np.ndarray:
    """Pictures of one episode beside each other."""
    names, phases = episode.column("phase").values, np.asarray(episode["phase"])
    rows = [int(np.flatnonzero(phases == names.index(name))[-1]) for name in PHASES]
    return np.concatenate([episode.frame("exo", row) for row in rows], axis=1)


def main() -> None:
    """Generates the episodes and draws them."""
    run = rc.RunConfig.load(RUN)
    with tempfile.TemporaryDirectory() as folder:
        run.output = str(Path(folder) / "dataset")
        run.episodes = EPISODES
        rc.generate.prepare_dataset(run)
        runner = rc.generate.Runner(run)
        for item in rc.generate.make_plan(run):
            runner.run(item)
        strips = [strip(episode) for episode in rc.Dataset(run.output)]
    Image.fromarray(np.concatenate(strips)).save(DOCS / "place.png", optimize=True)


if __name__ == "__main__":
    main()
