"""Example 6: read a dataset back: its columns, an episode played again, and its path in a picture.

The dataset is made first, as in example 2; give the folder of one that exists to look at that.
The same in C++: 06_read_dataset.cc. Run: python examples/06_read_dataset.py [folder] [dataset]
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

COLOURS = [
    [40, 90, 200],
    [40, 160, 220],
    [250, 200, 40],
    [240, 120, 30],
    [220, 40, 40],
    [90, 0, 90],
]


def make_dataset(folder: Path) -> Path:
    """One pick, seen from beside the robot."""
    shutil.rmtree(folder, ignore_errors=True)
    run = rc.RunConfig(run="example", output=str(folder))
    run.robot = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    run.start = rc.tasks.StartConfig(base_distance=[0.35, 0.5], base_height_offset=-0.25)
    run.cameras.resolution = [320, 240]
    run.cameras.streams.append(rc.render.CameraConfig(name="exo", camera="exo_camera"))
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return folder


def play(episode: rc.data.Episode) -> float:
    """Lets the recorded controls act on the recorded start; how far the arm is off at the end."""
    scene = rc.Scene.build(rc.data.recorded_scene(episode))
    scene.set_state(episode["initial_state"])
    ticks = episode.rows("control") // len(episode)  # per row
    steps = round(episode["control/time"][1] / scene.timestep())  # of the engine, per tick
    for ctrl in episode["control/ctrl"][:-ticks]:  # the last row is the state before its action
        scene.data.ctrl[:] = ctrl
        scene.step_n(steps)
    joints = scene.robot("rc7").arm.joint_pos
    return float(np.max(np.abs(joints - episode["robots/rc7/arm/qpos"][-1])))


def draw_path(episode: rc.data.Episode, camera: str) -> np.ndarray:
    """The first frame of a camera with the way of the TCP in it, coloured by the expert's phase."""
    picture = episode.frame(camera, 0)
    intrinsics = episode[f"cameras/{camera}/intrinsics"]
    extrinsics = episode[f"cameras/{camera}/extrinsics"][0]
    for tcp, phase in zip(episode["robots/rc7/tcp_pose"], episode["phase"], strict=True):
        in_camera = (extrinsics @ [*tcp[:3], 1])[:3]
        u, v, _ = np.rint(intrinsics @ in_camera / in_camera[2]).astype(int)
        picture[max(v - 1, 0) : v + 2, max(u - 1, 0) : u + 2] = COLOURS[phase]
    return picture


def main(folder: Path, dataset: Path | None) -> None:
    """Reads a dataset and draws into `folder`."""
    episodes = rc.Dataset(dataset or make_dataset(folder / "dataset"))
    for episode in episodes:
        print(f"{episode.id}: {episode.end_reason}")
        qpos, names = episode["robots/rc7/arm/qpos"], episode.column("phase").values
        units = episode.column("robots/rc7/arm/qpos").units
        print(f"  qpos: {qpos.shape[0]} rows of {qpos.shape[1]} joints, {units}")
        rows = np.bincount(episode["phase"], minlength=len(names))
        print("  rows: " + ", ".join(f"{n} {name}" for n, name in zip(rows, names, strict=True)))
        print(f"  lifted {100 * episode['reward'][-1]:.1f} cm")
        assert len(episode.frames("exo")) == len(episode)  # frame i belongs to row i

        # Played again by hand, and by the check that compares every row and tick.
        assert play(episode) < 1e-9
        result = rc.data.verify_replay(episode)
        print(f"  replayed: {'the same' if result.ok else result}")
        assert result.ok
    rc.render.write_png(folder / "picture.png", draw_path(episodes[0], "exo"))


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out, Path(sys.argv[2]) if len(sys.argv) > 2 else None)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
