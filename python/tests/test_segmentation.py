"""Segmentation streams of a run: lossless body ids, with the table of what they show."""

from __future__ import annotations

import json
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
        {"name": "wrist", "camera": "wrist_camera", "segmentation": True},
        {"name": "exo", "camera": "exo_camera", "depth": True, "segmentation": True},
        {"name": "plain", "camera": "exo_camera"},
    ],
}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes."""

    def make(folder: Path) -> None:
        result = robocell_command("generate", write_run(folder, cameras=CAMERAS))
        assert result.returncode == 0, result.stderr

    return made_once(tmp_path_factory, "segmentation", make) / "out"


@pytest.mark.proof
def test_segmentation_is_the_renderers_in_every_row(dataset: Path):
    episode = robocell.Dataset(dataset)[0]
    recorded = episode.frames("exo", kind="segmentation")
    assert (recorded.dtype, recorded.shape) == (np.uint16, (len(episode), SIZE[1], SIZE[0]))
    scene = robocell.Scene.build(robocell.data.recorded_scene(episode))
    scene.set_state(episode["initial_state"])
    renderer = robocell.render.Renderer(scene)
    ctrl = episode["control/ctrl"]
    ticks = len(ctrl) // len(episode)
    for row in range(len(episode)):
        image = renderer.render("robot_0/exo_camera", *SIZE, rgb=False, segmentation=True)
        bodies = image["segmentation"]
        expected = np.where(bodies < 0, robocell.data.NO_SEGMENT, bodies)
        np.testing.assert_array_equal(recorded[row], expected, str(row))
        for tick in range(row * ticks, (row + 1) * ticks):
            scene.data.ctrl[:] = ctrl[tick]
            scene.step()
    assert (recorded[0] != recorded[-1]).any()


def test_labels_name_every_body_and_its_owner(dataset: Path):
    episode = robocell.Dataset(dataset)[0]
    scene = robocell.Scene.build(robocell.data.recorded_scene(episode))
    labels = episode.segment_labels
    assert [label.name for label in labels] == [
        scene.model.body(i).name for i in range(scene.model.nbody)
    ]
    assert (labels[0].name, labels[0].owner) == ("world", "")
    target = "objects/" + episode.metadata["target_object"]
    owners = {label.owner for label in labels}
    assert target in owners
    # Owners are the names of columns.
    for owner in owners - {""}:
        assert any(column.startswith(owner + "/") for column in episode.columns), owner
    seen = np.unique(episode.frames("exo", kind="segmentation"))
    names = {labels[i].owner for i in seen if i != robocell.data.NO_SEGMENT}
    assert target in names
    assert any(name.startswith("robots/") for name in names)
    described = json.loads((episode.folder / "episode.json").read_text())
    assert described["segmentation"]["none"] == robocell.data.NO_SEGMENT
    assert described["segmentation"]["labels"][0] == {"name": "world", "owner": ""}


def test_segmentation_is_counted_and_verified_and_missing_segmentation_is_named(dataset: Path):
    assert robocell.data.verify(dataset, decode_videos=True).ok
    episode = robocell.Dataset(dataset)[0]
    assert episode.segmentation_cameras == ["wrist", "exo"]
    assert episode.depth_cameras == ["exo"]
    with h5py.File(episode.folder / "steps.h5") as steps:
        assert steps["cameras/wrist"].attrs["segmentation"] == "wrist.segmentation.mov"
        assert "segmentation" not in steps["cameras/plain"].attrs
    rows = sum(len(each) for each in robocell.Dataset(dataset))
    assert f"{rows} rows, {6 * rows} frames" in robocell_command("report", dataset).stdout
    text = "camera 'plain' has no segmentation. Cameras with segmentation: wrist, exo"
    with pytest.raises(robocell.NotFoundError, match=text):
        episode.frames("plain", kind="segmentation")
    with pytest.raises(robocell.NotFoundError, match="Did you mean 'segmentation'"):
        episode.frames("wrist", kind="segmentatio")


@pytest.mark.proof  # as depth in test_depth.py
def test_the_same_run_gives_the_same_bytes(dataset: Path, tmp_path: Path):
    result = robocell_command("generate", write_run(tmp_path, cameras=CAMERAS))
    assert result.returncode == 0, result.stderr
    for first, second in zip(
        robocell.Dataset(dataset), robocell.Dataset(tmp_path / "out"), strict=True
    ):
        for file in ("steps.h5", "wrist.segmentation.mov", "exo.segmentation.mov"):
            assert (first.folder / file).read_bytes() == (second.folder / file).read_bytes(), file


def test_an_episode_with_segmentation_is_replayed(dataset: Path):
    for episode in robocell.Dataset(dataset):
        assert robocell.data.verify_replay(episode).ok
