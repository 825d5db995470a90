"""Draws docs/augment.png: the parts of a source episode, and the paths of the hand that follow.

Left: the height of the hand over a source episode that stacks two cubes, and the opening of the
gripper; the parts that are moved to new starts are shaded. Right: the paths of the hand from above,
seen from the lower cube, in the source and in episodes made from it: the parts at the cubes are the
same, what lies between is planned.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from figures import DOCS, save
from matplotlib import pyplot
from PIL import Image

import robocell as rc

RUN = DOCS.parent / "examples" / "tasks" / "stack.yaml"
MADE = 6
COLOURS = {"reference": "tab:orange", "held": "tab:green"}


def made(output: Path, *overrides: str) -> rc.Dataset:
    """Makes the episodes of the run."""
    run = rc.RunConfig.load(
        RUN, [f"output={output}", "task.cubes=2", "cameras.streams=[]", *overrides]
    )
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return rc.Dataset(output)


def draw_parts(axes: pyplot.Axes, source: rc.data.Episode, parts: list[dict[str, Any]]) -> None:
    """Draws height and opening, and the parts."""
    time = np.asarray(source["time"])
    height = np.asarray(source["robots/rc7/tcp_pose"])[:, 2]
    axes.plot(time, height - height.min(), color="tab:blue", label="height of the hand, m")
    opening = np.asarray(source["robots/rc7/opening"])
    axes.plot(time, 0.1 * opening, color="0.5", label="opening of the gripper / 10")
    for part in parts:
        first, end = part["rows"]
        held = part["held"]
        axes.axvspan(
            time[first], time[end - 1], color=COLOURS["held" if held else "reference"], alpha=0.25
        )
        text = f"at {part['reference']}" + (f",\nwith {held}" if held else "")
        axes.annotate(
            text, ((time[first] + time[end - 1]) / 2, 0.98), ha="center", va="top",
            xycoords=("data", "axes fraction"),
        )  # fmt: skip
    axes.set(xlabel="time in s", title="the parts of a source episode")
    axes.set_ylim(0, 1.25 * (height - height.min()).max())
    axes.legend(loc="lower right", fontsize=8)


def path_from(episode: rc.data.Episode, below: str) -> np.ndarray:
    """The path of the hand in the frame of the lower cube at the start, (rows, 3)."""
    pose = np.asarray(episode[f"objects/{below}/pose"])[0]
    cube = rc.Pose(translation=pose[:3], quaternion=pose[3:])
    hand = np.asarray(episode["robots/rc7/tcp_pose"])[:, :3]
    return (hand - cube.translation) @ cube.rotation


def main() -> None:
    """Makes the episodes and draws them."""
    with tempfile.TemporaryDirectory() as folder:
        source = made(Path(folder) / "source", "episodes=1")[0]
        augment = f"augment.dataset={folder}/source"
        many = made(Path(folder) / "made", augment, f"episodes={MADE}", "seed=1")
        results: Any = many[0].results
        parts = results["augmented"]["segments"]
        below = parts[-1]["reference"]
        mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
        figure, (left, right) = pyplot.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
        draw_parts(left, source, parts)
        for episode in many:
            path = path_from(episode, below)
            label = "made from it" if episode.id == many[0].id else None
            right.plot(path[:, 0], path[:, 2], color="tab:blue", linewidth=0.8, label=label)
        path = path_from(source, below)
        right.plot(path[:, 0], path[:, 2], color="black", linewidth=2, label="the source")
        right.plot(0, 0, "s", color="tab:orange", markersize=8)
        right.annotate("lower cube", (0, 0), (0.02, 0.01))
        right.set(aspect="equal", xlabel="x in m, seen from the lower cube", ylabel="z in m",
                  title="paths of the hand")  # fmt: skip
        right.legend(loc="upper right", fontsize=8)
        figure.savefig(DOCS / "augment.png", dpi=200)
    save(Image.open(DOCS / "augment.png"), "augment.png", 960)


if __name__ == "__main__":
    main()
