"""Depth streams of a run: lossless, as the renderer gives them, the same bytes every time."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

import robocell
from command_line import robocell_command, write_run
from made_once import made_once

SIZE = (64, 48)
CAMERAS = {
    "resolution": list(SIZE),
    "streams": [
        {"name": "wrist", "camera": "wrist_camera", "depth": True},
        {"name": "exo", "camera": "exo_camera"},
    ],
}
HALF_MM = 0.5e-3 + 1e-6  # and the rounding of a float


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes."""

    def make(folder: Path) -> None:
        result = robocell_command("generate", write_run(folder, cameras=CAMERAS))
        assert result.returncode == 0, result.stderr

    return made_once(tmp_path_factory, "depth", make) / "out"


def test_depth_is_the_renderers_in_every_row(dataset: Path):
    episode = robocell.Dataset(dataset)[0]
    depth = episode.frames("wrist", kind="depth")
    assert depth.dtype == np.uint16
    assert depth.shape == (len(episode), SIZE[1], SIZE[0])
    scene = robocell.Scene.build(robocell.data.recorded_scene(episode))
    scene.set_state(episode["initial_state"])
    renderer = robocell.render.Renderer(scene)
    ctrl = episode["control/ctrl"]
    ticks = round(episode.metadata["rates"]["policy_ms"] / episode.metadata["rates"]["control_ms"])
    for row in range(len(episode)):
        image = renderer.render("robot_0/wrist_camera", *SIZE, rgb=False, depth=True)["depth"]
        assert np.abs(depth[row] / 1000 - image).max() <= HALF_MM, row
        for tick in range(row * ticks, (row + 1) * ticks):
            scene.data.ctrl[:] = ctrl[tick]
            scene.step()
    assert depth.min() < depth.max()
    assert (depth[0] != depth[-1]).any()


def test_any_decoder_reads_the_same_depth_and_the_file_describes_it(dataset: Path):
    episode = robocell.Dataset(dataset)[0]
    with h5py.File(episode.folder / "steps.h5") as steps:
        attributes = steps["cameras/wrist"].attrs
        file, units = attributes["depth"], attributes["depth_units"]
        assert "depth" not in steps["cameras/exo"].attrs
    assert (file, units) == ("wrist.depth.mov", "mm")
    ffmpeg = os.environ.get("ROBOCELL_FFMPEG", "ffmpeg")
    command = [ffmpeg, "-v", "error", "-i", str(episode.folder / file), "-f", "rawvideo"]
    raw = subprocess.run([*command, "-pix_fmt", "gray16le", "-"], capture_output=True, check=True)
    pixels = np.frombuffer(raw.stdout, "<u2").reshape(-1, SIZE[1], SIZE[0])
    np.testing.assert_array_equal(pixels, episode.frames("wrist", kind="depth"))


def test_depth_is_counted_and_verified_and_missing_depth_is_named(dataset: Path):
    assert robocell.data.verify(dataset, decode_videos=True).ok
    episode = robocell.Dataset(dataset)[0]
    assert (episode.cameras, episode.depth_cameras) == (["wrist", "exo"], ["wrist"])
    rows = sum(len(each) for each in robocell.Dataset(dataset))
    assert f"{rows} rows, {3 * rows} frames" in robocell_command("report", dataset).stdout
    text = "camera 'exo' has no depth. Cameras with depth: wrist"
    with pytest.raises(robocell.NotFoundError, match=text):
        episode.frames("exo", kind="depth")
    with pytest.raises(robocell.NotFoundError, match="Did you mean 'depth'"):
        episode.frames("wrist", kind="dept")
