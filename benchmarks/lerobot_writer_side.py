"""LeRobot's own writer, of row P14: seconds for each image of an episode, in LeRobot's environment.

lerobot_writer_side.py FRAMES ROWS CAMERAS WIDTH HEIGHT REPETITIONS MODE OUT: writes an episode of
raw RGB frames, camera by camera in each row, with a state and an action of seven numbers. MODE is
"default" (PNG files, encoded as AV1 when the episode is saved) or "streaming" (H.264, encoded
meanwhile). From `create` to after `finalize`. JSON: one value for each repetition, and how many
frames are missing in its videos: streaming drops those that it cannot encode in time.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import av
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

MODES: dict[str, dict[str, Any]] = {
    "default": {},
    "streaming": {"streaming_encoding": True, "vcodec": "h264"},
}


def write(frames: Any, numbers: Any, mode: str, out: Path) -> None:
    """Writes an episode; the frames of each row, camera by camera."""
    rows, cameras, height, width, _ = frames.shape
    names = [f"observation.images.camera_{camera}" for camera in range(cameras)]
    vector = {"dtype": "float32", "shape": numbers.shape[1:], "names": None}
    video = {
        "dtype": "video",
        "shape": (height, width, 3),
        "names": ["height", "width", "channels"],
    }
    features = {"observation.state": vector, "action": vector, **dict.fromkeys(names, video)}
    dataset = LeRobotDataset.create("local/peer", 15, features, root=out, **MODES[mode])
    for row in range(rows):
        images = dict(zip(names, frames[row], strict=True))
        values = {"observation.state": numbers[row], "action": numbers[row], "task": "swing"}
        dataset.add_frame({**values, **images})
    dataset.save_episode()
    dataset.finalize()


def written_frames(out: Path) -> int:
    """Frames in all videos of a dataset."""
    total = 0
    for file in out.glob("videos/**/*.mp4"):
        with av.open(str(file)) as video:
            total += sum(1 for packet in video.demux(video=0) if packet.size)
    return total


def main() -> None:
    """The process."""
    file, mode, out = sys.argv[1], sys.argv[7], Path(sys.argv[8])
    rows, cameras, width, height, repetitions = map(int, sys.argv[2:7])
    frames = np.fromfile(file, np.uint8).reshape(rows, cameras, height, width, 3)
    numbers = np.random.default_rng(0).uniform(-1, 1, (rows, 7)).astype(np.float32)
    seconds, missing = [], 0
    for _ in range(repetitions):
        shutil.rmtree(out, ignore_errors=True)
        began = time.perf_counter()
        write(frames, numbers, mode, out)
        seconds.append((time.perf_counter() - began) / (rows * cameras))
        missing += rows * cameras - written_frames(out)
    print(json.dumps({"seconds": seconds, "missing": missing}))


if __name__ == "__main__":
    main()
