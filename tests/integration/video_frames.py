"""Frames of recorded videos, decoded by ffmpeg itself, and how alike two images are."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]


def _decoded(video: Path, *output: str) -> bytes:
    """What ffmpeg writes of a decoded video; a frame of the file is a frame of the output."""
    command = [os.environ.get("ROBOCELL_FFMPEG", "ffmpeg"), "-v", "error", "-i", str(video)]
    result = subprocess.run(
        [*command, "-fps_mode", "passthrough", *output, "-"], capture_output=True, check=True
    )
    assert result.stderr == b""
    return result.stdout


def decode(video: Path, width: int, height: int) -> NDArray[np.uint8]:
    """All frames, (frames, height, width, 3) RGB. What is not a whole number of frames fails."""
    raw = _decoded(video, "-f", "rawvideo", "-pix_fmt", "rgb24")
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width, 3)


def count_frames(video: Path) -> int:
    """How many frames a video decodes to."""
    lines = _decoded(video, "-f", "framecrc").splitlines()
    return sum(not line.startswith(b"#") for line in lines)


def psnr(a: Image, b: Image) -> float:
    """Peak signal to noise ratio of two 8-bit images, dB."""
    error = np.mean((a.astype(np.float64) - b) ** 2)
    return float(np.inf if error == 0 else 10 * np.log10(255**2 / error))
