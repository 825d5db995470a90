"""The dataset that tests of exports share, and how they compare results."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import robocell
from command_line import robocell_command, write_run
from made_once import made_once
from robocell.export import FORMATS

# Rerun's package is half a gigabyte: test_export_rerun.py has it, in an environment of its own.
INSTALLED = [name for name in FORMATS if name != "rerun"]


def three_episodes(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    """Three episodes of about 45 rows, with two cameras."""

    def make(folder: Path) -> None:
        streams = [
            {"name": "wrist", "camera": "wrist_camera", "depth": True},
            {"name": "exo", "camera": "exo_camera"},
        ]
        cameras = {
            "resolution": [64, 48],
            "renderer": {"backend": "soft"},
            "streams": streams,
        }
        rates = {"policy_ms": 132, "control_ms": 2, "sim_ms": 2, "max_steps": 500}
        run = write_run(folder, cameras=cameras, rates=rates, episodes_per_scene=3)
        result = robocell_command("generate", run, "--workers", 1)
        assert result.returncode == 0, result.stderr

    return robocell.Dataset(made_once(tmp_path_factory, "export_lerobot", make) / "out")


def psnr(one: NDArray[Any], other: NDArray[Any]) -> float:
    """How near two images are, in dB."""
    error = np.mean((one.astype(float) - other.astype(float)) ** 2)
    return float("inf") if error == 0 else 10 * np.log10(255**2 / error)


def hashes(root: Path) -> dict[str, str]:
    """The hash of every file in a folder."""
    return {
        str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(root.rglob("*"))
        if path.is_file()
    }
