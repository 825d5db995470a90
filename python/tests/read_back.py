"""A small dataset with every kind of image, and what h5py and ffmpeg say is in it."""

from __future__ import annotations

import functools
import os
import stat
import subprocess
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import robocell
from command_line import robocell_command, write_run
from made_once import made_once

SIZE = (64, 48)
CAMERAS = {
    "resolution": list(SIZE),
    "renderer": {"backend": "soft"},  # OpenGL starts anew in each process
    "streams": [
        {"name": "wrist", "camera": "wrist_camera", "depth": True, "segmentation": True},
        {"name": "exo", "camera": "exo_camera"},
    ],
}
# Robocell's own conversion to RGB, without shortcuts; ffmpeg's default is near, see the tests.
EXACT = ("-vf", "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact")


def read_back_dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes of about 45 rows each."""

    def make(folder: Path) -> None:
        rates = {"policy_ms": 132, "control_ms": 2, "sim_ms": 2, "max_steps": 500}
        run = write_run(folder, cameras=CAMERAS, rates=rates, episodes_per_scene=3)
        result = robocell_command("generate", run, "--workers", 1)
        assert result.returncode == 0, result.stderr

    return made_once(tmp_path_factory, "read_back", make) / "out"


@functools.cache
def decoded(video: Path, *options: str) -> NDArray[Any]:
    """All frames of a video, decoded by ffmpeg alone."""
    is_gray = video.suffix == ".mov"
    command = ["ffmpeg", "-v", "error", "-i", str(video), "-fps_mode", "passthrough", *options]
    command += ["-f", "rawvideo", "-pix_fmt", "gray16le" if is_gray else "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    if is_gray:
        return np.frombuffer(raw, np.uint16).reshape(-1, SIZE[1], SIZE[0])
    return np.frombuffer(raw, np.uint8).reshape(-1, SIZE[1], SIZE[0], 3)


def frames_by_ffmpeg(episode: robocell.data.Episode, stream: str) -> NDArray[Any]:
    """All frames of a stream of an episode."""
    gray = episode.folder / f"{stream}.mov"
    return decoded(gray) if gray.exists() else decoded(episode.folder / f"{stream}.mp4", *EXACT)


def column_by_h5py(episode: robocell.data.Episode, name: str) -> NDArray[Any]:
    """A whole column."""
    with h5py.File(episode.folder / "steps.h5") as steps:
        return np.asarray(steps[name][()])


class CountedFfmpeg:
    """Stands in front of ffmpeg and counts how often it is started, in this process and others."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._log = folder / "starts"
        program = folder / "counted_ffmpeg"
        program.write_text(f'#!/bin/sh\necho >> "{self._log}"\nexec ffmpeg "$@"\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("ROBOCELL_FFMPEG", str(program))

    @property
    def starts(self) -> int:
        return self._log.stat().st_size if self._log.exists() else 0


def children() -> list[int]:
    """The processes that this one started and that are there."""
    tasks = Path("/proc/self/task").glob("*/children")
    return [int(number) for task in tasks for number in task.read_text().split()]


def open_files() -> int:
    return len(os.listdir("/proc/self/fd"))
