"""A Python pipeline without robocell, of row P12: milliseconds of each image of an episode.

serial_pipeline.py DATASET: repeats the episodes of a dataset as a script with mujoco would make
them, one stage after the other: steps of the engine with the recorded controls, an image of each
camera with `mujoco.Renderer` as it is, and a process of ffmpeg for each video. Only the scenes and
the controls come from robocell, before the clock runs. JSON: one value for each episode.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import IO, Any

import mujoco as mj
import numpy as np

import robocell as rc

WIDTH, HEIGHT = 640, 480


def encoder(file: Path) -> subprocess.Popen[bytes]:
    """Takes frames at its input; the options of `VideoWriter` that decide the work."""
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{WIDTH}x{HEIGHT}", "-framerate", "500/33"]
    x264 = ["-c:v", "libx264", "-preset", "superfast", "-crf", "18", "-g", "30", "-bf", "0"]
    x264 += ["-coder", "vlc", "-x264-params", "subme=0"]  # the preset `rendered`
    words = ["ffmpeg", "-v", "error", "-y", *raw, "-i", "pipe:0", *x264, "-pix_fmt", "yuv420p"]
    return subprocess.Popen([*words, str(file)], stdin=subprocess.PIPE)


def cameras(episode: Any, model: mj.MjModel) -> list[str]:
    """The model's cameras that the episode's streams show."""
    names = [model.camera(i).name for i in range(model.ncam)]
    return [next(n for n in names if n.endswith(stream + "_camera")) for stream in episode.cameras]


def milliseconds(episode: Any, folder: Path) -> float:
    """Makes an episode again; what an image of it took."""
    scene = rc.Scene.build(rc.data.recorded_scene(episode))
    scene.set_state(episode["initial_state"])
    model, data = scene.model, scene.data
    controls, rows = episode["control/ctrl"], len(episode)
    ticks = len(controls) // rows
    sim_steps = round(episode.metadata["rates"]["control_ms"] / episode.metadata["rates"]["sim_ms"])
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    names = cameras(episode, model)
    begin = time.perf_counter()
    renderer = mj.Renderer(model, HEIGHT, WIDTH)
    videos = [encoder(folder / f"{number}.mp4") for number in range(len(names))]
    for row in range(rows):
        mj.mj_forward(model, data)
        for name, video in zip(names, videos, strict=True):
            renderer.update_scene(data, name)
            pixels: np.ndarray = renderer.render()
            to: IO[bytes] | None = video.stdin
            assert to is not None
            to.write(pixels.data)
        for control in controls[row * ticks : (row + 1) * ticks]:
            data.ctrl[:] = control
            for _ in range(sim_steps):
                mj.mj_step(model, data)
    for video in videos:
        video.communicate()
        if video.returncode:
            raise RuntimeError("ffmpeg failed")
    taken = 1e3 * (time.perf_counter() - begin) / (rows * len(names))
    renderer.close()
    return taken


def main() -> None:
    """The process."""
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps([milliseconds(e, Path(folder)) for e in rc.Dataset(sys.argv[1])]))


if __name__ == "__main__":
    main()
