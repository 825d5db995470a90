"""Draws docs/dataset.png: an episode of examples/demo.yaml with depth, row by row.

Above: frames of its videos, each at its row. Below: columns over the rows, on the same axis.
"""

from __future__ import annotations

import tempfile

import matplotlib as mpl
import numpy as np
from figures import DOCS, save
from matplotlib import pyplot
from PIL import Image

import robocell as rc

RUN = DOCS.parent / "examples" / "demo.yaml"
SHOWN = 6  # frames of a video
COLOURS = ["#dfe8f5", "#bcd7ee", "#fbe7b0", "#f8c99b", "#f1aca5", "#d9c2e0"]  # of the phases


def make(folder: str) -> rc.data.Episode:
    """The first episode, with depth from beside the robot."""
    run = rc.RunConfig.load(RUN, [f"output={folder}/demo", "episodes_per_scene=1"])
    run.cameras.streams[1].depth = True
    rc.generate.prepare_dataset(run)
    rc.generate.Runner(run).run(rc.generate.make_plan(run)[0])
    return rc.Dataset(run.output)[0]


def main() -> None:
    """Draws it."""
    mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    with tempfile.TemporaryDirectory() as folder:
        episode = make(folder)
        rows = np.linspace(0, len(episode) - 1, SHOWN).round().astype(int)
        streams = [
            ("wrist.mp4", episode.frames("wrist")),
            ("exo.mp4", episode.frames("exo")),
            ("exo.depth.mov", episode.frames("exo", kind="depth")),
        ]
        columns = {
            "reward, m": episode["reward"],
            "opening": episode["robots/rc7/opening"],
            "arm/qpos, rad": episode["robots/rc7/arm/qpos"],
        }
        phase, names = episode["phase"], episode.column("phase").values
    figure = pyplot.figure(figsize=(9.6, 8.2), layout="constrained")
    grid = figure.add_gridspec(6, SHOWN, height_ratios=[1, 1, 1, 0.55, 0.55, 0.8])
    for i, (name, frames) in enumerate(streams):
        for j, row in enumerate(rows):
            axes = figure.add_subplot(grid[i, j])
            axes.imshow(frames[row], cmap="gray_r", vmax=None if frames.ndim == 4 else 2000)
            axes.set(xticks=[], yticks=[], title=f"row {row}" if i == 0 else "")
            axes.spines[:].set_visible(False)
            if j == 0:
                axes.set_ylabel(name)
    for i, (name, values) in enumerate(columns.items()):
        axes = figure.add_subplot(grid[3 + i, :])
        for number, text in enumerate(names):
            where = np.flatnonzero(phase == number)
            if len(where):
                axes.axvspan(where[0] - 0.5, where[-1] + 0.5, color=COLOURS[number], lw=0)
                if i == 0:
                    middle = where.mean()
                    axes.text(middle, 1.04, text, transform=axes.get_xaxis_transform(), ha="center")
        axes.plot(values, lw=1.2)
        if name == "opening":
            axes.set_ylim(-0.05, 1.05)
        axes.set(xlim=(-0.5, len(phase) - 0.5), ylabel=name, xticks=rows)
    axes.set_xlabel("row of steps.h5, and frame of each video; coloured by the column `phase`")
    figure.savefig(DOCS / "dataset.png", dpi=200)
    save(Image.open(DOCS / "dataset.png"), "dataset.png", 960)


if __name__ == "__main__":
    main()
