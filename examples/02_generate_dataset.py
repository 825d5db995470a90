"""Example 2: generate a small pick dataset with the built-in robot, read it back, check it.

The same in C++: 02_generate_dataset.cc. On all cores and with progress: robocell generate demo.yaml
Run: python examples/02_generate_dataset.py [folder]
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc


def strip(episode: rc.data.Episode, camera: str) -> np.ndarray:
    """Five frames of a video side by side."""
    frames = episode.frames(camera)
    return np.hstack([frames[i * (len(frames) - 1) // 4] for i in range(5)])


def main(folder: Path) -> None:
    """Generates into `folder`/dataset; `folder`/picture.png shows the first episode."""
    shutil.rmtree(folder / "dataset", ignore_errors=True)
    run = rc.RunConfig(run="example", episodes_per_scene=2, output=str(folder / "dataset"))
    run.robot = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    run.task = rc.tasks.PickTaskConfig(objects=["box", "mug"])
    run.start = rc.tasks.StartConfig(base_distance=[0.35, 0.5], base_height_offset=-0.25)
    run.cameras.resolution = [160, 120]
    run.cameras.streams.append(rc.render.CameraConfig(name="wrist", camera="wrist_camera"))

    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        result = runner.run(item)
        outcome = "success" if result.success else "no success"
        print(f"{item.id}: {outcome}, attempts: {result.attempts}, rows: {result.rows}")

    for episode in rc.Dataset(run.output):
        frames = episode.frames("wrist")
        print(f"{episode.id}: lifted {episode['reward'][-1]:.3f} m, {len(frames)} frames")
        assert frames.shape == (len(episode), 120, 160, 3)
    rc.render.write_png(folder / "picture.png", strip(next(iter(rc.Dataset(run.output))), "wrist"))
    found = rc.data.verify(run.output)
    print(f"{len(found.good)} episodes, every byte as it was written: {found.ok}")
    assert found.ok
    assert len(found.good) == 2


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
