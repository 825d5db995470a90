"""Cameras that each start of a run places, and what they see of objects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from test_places import first_start, pick
from test_task import Idle

SIZES = {"side": (624, 352), "wrist": (640, 368), "narrow": (34, 90)}


def run_with_cameras() -> rc.RunConfig:
    run = pick()
    run.start.cameras = {
        "side": {
            "around": ["target", "gripper"],
            "distance": [0.6, 0.9],
            "height": [0.2, 0.5],
            "azimuth": [-80, 80],
            "sees": {"target": {"pixels": 60, "share": 0.3}, "gripper": {"pixels": 40}},
        },
        "wrist": {"camera": "wrist_camera", "rotation_noise": 2, "fovy_noise": 3},
        "narrow": {
            "mount": "base_link",
            "pos": [0.1, 0.5, 0.5],
            "look_at": [0.4, 0, 0],
            "fovy": 70,
        },
    }
    run.cameras.streams = [
        {"name": name, "camera": name, "width": width, "height": height}
        for name, (width, height) in SIZES.items()
    ]
    run.cameras.renderer = {"backend": "soft"}
    return run


def camera_matrix(fovy: float, width: int, height: int) -> np.ndarray:
    focal = 0.5 * height / np.tan(np.radians(fovy) / 2)
    return np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])


def test_episodes_record_the_cameras_of_their_starts(tmp_path: Path):
    run = run_with_cameras()
    run.output, run.keep = str(tmp_path / "out"), rc.generate.Keep.FIRST
    run.episodes, run.rates.max_steps = 2, 3
    run.task = rc.tasks.PickTaskConfig(objects=["mug"])
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run, expert=lambda run, start: Idle())
    for item in rc.generate.make_plan(run):
        runner.run(item)
    episodes = list(rc.data.Dataset(run.output))[:2]
    lenses = set()
    for episode in episodes:
        scene = rc.Scene.build(rc.data.recorded_scene(episode))
        for name, (width, height) in SIZES.items():
            assert episode.frame(name, 0).shape == (height, width, 3)
            fovy = float(scene.model.camera(name).fovy[0])
            lens = episode[f"cameras/{name}/intrinsics"]
            np.testing.assert_allclose(lens, camera_matrix(fovy, width, height))
            if name == "wrist":
                lenses.add(fovy)
        # What is fixed stays where it is, what is on the hand moves with it.
        to_side = episode["cameras/side/extrinsics"]
        assert np.ptp(to_side, axis=0).max() == 0
        expected = scene.model.camera("side").pos
        np.testing.assert_allclose(-to_side[0][:3, :3].T @ to_side[0][:3, 3], expected, atol=1e-9)
    assert len(lenses) == len(episodes) == 2


def test_an_object_of_a_start_is_where_its_camera_shows_it():
    run = run_with_cameras()
    scene = first_start(run).scene
    width, height = SIZES["side"]
    view = rc.scenes.object_view(scene, "target", "side", width=width, height=height, points=6)
    assert view.pixels >= 60
    assert view.share >= 0.3
    images = rc.render.Renderer(scene, backend="soft").render(
        "side", width, height, segmentation=True
    )
    ids = images["segmentation"]
    names = [scene.model.body(body).name for body in range(scene.model.nbody)]
    mask = np.isin(ids, [b for b, name in enumerate(names) if name.startswith("target")])
    assert view.pixels == mask.sum()
    rows, columns = np.nonzero(mask)
    assert view.box == (columns.min(), rows.min(), columns.max(), rows.max())
    assert mask[view.points[:, 1], view.points[:, 0]].all()
    np.testing.assert_array_equal(rc.scenes.points_in_mask(mask, 6), view.points)
    with pytest.raises(TypeError, match="points_in_mask: `mask` must be a bool array"):
        rc.scenes.points_in_mask(ids * 0.5)


def test_wrong_cameras_are_reported_before_the_first_start(tmp_path: Path):
    run = run_with_cameras()
    run.output = str(tmp_path / "out")
    run.start.cameras["narrow"].mount = "bse_link"
    with pytest.raises(rc.SpecError, match=r"start.cameras: camera 'narrow', mount: .*base_link"):
        rc.diagnose.check_run(run, scripted_expert=False)
    run.start.cameras["narrow"].mount = "base_link"
    run.start.cameras["side"].around = ["traget"]
    with pytest.raises(rc.SpecError, match=r"camera 'side', around: .*'traget'.*target"):
        rc.diagnose.check_run(run, scripted_expert=False)


def test_instructions_can_tell_the_object_from_all_others():
    run = pick()
    run.task = rc.tasks.PickTaskConfig(objects=["mug", "apple"], refer=True)
    start = first_start(run)
    start.task.begin(start.scene)
    words = rc.scenes.referrals(start.scene, "target")
    assert start.task.instruction() == f"pick up {words[0]}"
    with pytest.raises(rc.NotFoundError, match="targt"):
        rc.scenes.referrals(start.scene, "targt")
