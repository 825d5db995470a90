"""Single frames of an episode from Python, in their order and in any, beside ffmpeg alone."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from table import Row

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

import robocell as rc  # noqa: E402

SIZES = ((320, 240), (640, 480))
REPETITIONS = 5
RANDOM_FRAMES = 20
EXACT = "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact"


def rows(folder: Path) -> list[Row]:
    """For each size: all frames in their order, and some in any."""
    return [row for size in SIZES for row in rows_of_size(folder / "read_frames", size)]


def rows_of_size(folder: Path, size: tuple[int, int]) -> list[Row]:
    """Of one pick, filmed at one size with depth."""
    episode = made_episode(folder, size)
    found = []
    for stream in episode.streams:
        video = next(episode.folder.glob(f"{stream}.m*"))
        for order, seconds in (("in their order", one_by_one), ("in any order", shuffled)):
            sides = seconds(episode, stream, video)
            name = f"a frame of '{stream}', {size[0]}x{size[1]}, {order}"
            note = f"peer: ffmpeg alone, {PEERS[order]}; the frames are the same to the bit"
            found.append(Row(name, "ms", sides[0], sides[1], note=note))
    return found


PEERS = {
    "in their order": "one process for all frames",
    "in any order": "a process for each, sought by time",
}
Sides = tuple[list[float], list[float]]


def one_by_one(episode: rc.data.Episode, stream: str, video: Path) -> Sides:
    """Milliseconds a frame."""

    def ours() -> Iterator[bytes]:
        return (episode.frame(stream, i).tobytes() for i in range(len(episode)))

    def peer() -> Iterator[bytes]:
        raw = decoded(video)
        size = len(raw) // len(episode)
        return (raw[at : at + size] for at in range(0, len(raw), size))

    return in_turns(ours, peer, len(episode))


def shuffled(episode: rc.data.Episode, stream: str, video: Path) -> Sides:
    """The same of frames in any order, others in each repetition."""
    period = float(episode["time"][1] - episode["time"][0])
    orders = np.random.default_rng(0)
    order = np.zeros(0, int)

    def ours() -> Iterator[bytes]:
        nonlocal order
        order = orders.permutation(len(episode))[:RANDOM_FRAMES]
        return (episode.frame(stream, int(i)).tobytes() for i in order)

    def peer() -> Iterator[bytes]:
        return (decoded(video, max((i - 0.5) * period, 0)) for i in order)

    return in_turns(ours, peer, RANDOM_FRAMES)


def in_turns(ours: Callable[[], Any], peer: Callable[[], Any], frames: int) -> Sides:
    """Both sides one after the other; they must see the same."""
    times: Sides = ([], [])
    for _ in range(REPETITIONS):
        rc.data.release_idle_files()
        seen = []
        for side, values in zip((ours, peer), times, strict=True):
            begin = time.perf_counter()
            seen.append(list(side()))
            values.append(1e3 * (time.perf_counter() - begin) / frames)
        if seen[0] != seen[1] or len(seen[0]) != frames:
            raise RuntimeError("robocell and ffmpeg decoded other frames")
    return times


def decoded(video: Path, from_s: float | None = None) -> bytes:
    """All frames, or the first one from a time on."""
    is_gray = video.suffix == ".mov"
    command = ["ffmpeg", "-v", "error", "-threads", "1"]
    command += [] if from_s is None else ["-ss", f"{from_s:.6f}"]
    command += ["-i", str(video), "-fps_mode", "passthrough"]
    command += [] if is_gray else ["-vf", EXACT]
    command += [] if from_s is None else ["-frames:v", "1"]
    command += ["-f", "rawvideo", "-pix_fmt", "gray16le" if is_gray else "rgb24", "-"]
    return subprocess.run(command, capture_output=True, check=True).stdout


def made_episode(folder: Path, size: tuple[int, int]) -> rc.data.Episode:
    """One pick of the built-in robot, seen from beside it."""
    shutil.rmtree(folder, ignore_errors=True)
    run = rc.RunConfig(run="read_frames", output=str(folder))
    run.robot = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    run.start = rc.tasks.StartConfig(base_distance=[0.35, 0.5], base_height_offset=-0.25)
    run.cameras.resolution = list(size)
    run.cameras.streams.append(rc.render.CameraConfig(name="exo", camera="exo_camera", depth=True))
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return rc.Dataset(folder)[0]
