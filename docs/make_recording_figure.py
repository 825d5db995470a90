"""Draws docs/recording.png: one motion filmed by three recorders, read back from their files.

A row for each camera: free, tracking the hand, the robot's own. Half-way a cabinet is added, which
compiles the scene anew; the recorders follow.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from figures import Frame, save, sheet, spread
from make_cell_picture import cell

import robocell as rc

WIDTH, HEIGHT = 188, 140
FPS = 25
FRAMES = 60
SHOWN = 5  # of each video
CABINET = rc.SceneObject(name="cabinet", mjcf_path="cabinet", pos=[0.15, 0.75, 0], fixed=True)


def film(scene: rc.Scene, videos: list[rc.render.VideoRecorder]) -> None:
    """The arm swings from one side to the other; one frame in 40 ms."""
    robot = rc.Robot.of(scene, "rc7")
    for i in range(FRAMES):
        robot.jnt_pos_cmd[0] = -0.6 + 1.2 * i / (FRAMES - 1)
        robot.update()
        scene.step_n(round(1 / FPS / scene.timestep()))
        if i == FRAMES // 2:
            scene.add_object(CABINET)
        for video in videos:
            video.record_frame()


def frames_of(video: Path) -> Frame:
    """What is in the file, (frames, height, width, 3)."""
    command = ["ffmpeg", "-v", "error", "-i", video, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, HEIGHT, WIDTH, 3)


def main() -> None:
    """Draws it."""
    scene = cell()
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{name}.mp4" for name in ("free", "tracking", "wrist")]
        videos = [rc.render.VideoRecorder(scene, file, WIDTH, HEIGHT, FPS) for file in files]
        videos[0].set_free_camera(1.9, 143, -16, (-0.1, 0.1, 0.55))
        videos[1].set_tracking_camera("hand", 0.9, 143, -20)
        videos[2].use_camera("wrist_camera")
        film(scene, videos)
        for video in videos:
            video.finish()
        save(sheet([spread(frames_of(file), SHOWN) for file in files]), "recording.png")


if __name__ == "__main__":
    main()
