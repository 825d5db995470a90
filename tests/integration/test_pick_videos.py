"""Frame i of a video is the picture of row i, and the wrist camera sees what is to be grasped."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from generated_run import GeneratedRun
from recorded_scene import ROBOT_PREFIX, RecordedScene
from video_frames import count_frames, decode, psnr

CAMERAS = {"wrist": f"{ROBOT_PREFIX}wrist_camera", "exo": f"{ROBOT_PREFIX}exo_camera"}


@pytest.fixture(scope="module")
def scenes(
    any_run: GeneratedRun, tmp_path_factory: pytest.TempPathFactory
) -> dict[Path, RecordedScene]:
    """The scenes of all episodes, rebuilt."""
    scratch = tmp_path_factory.mktemp("scenes")
    return {episode: RecordedScene(episode, scratch) for episode in any_run.episodes()}


def size(scene: RecordedScene, camera: str) -> tuple[int, int]:
    """Width and height of a camera's video."""
    stream = scene.steps[f"cameras/{camera}"].attrs
    return int(stream["width"]), int(stream["height"])


def moving_rows(scene: RecordedScene) -> Iterator[int]:
    """In each of three phases the row around which the TCP moves most."""
    names = list(scene.steps["phase"].attrs["values"])
    phases = scene.steps["phase"][:]
    travel = np.linalg.norm(
        np.diff(next(iter(scene.steps["robots"].values()))["tcp_pose"][:, :3], axis=0), axis=1
    )
    slowest_side = np.minimum(travel[:-1], travel[1:])  # of rows 1 ... T-2
    for phase in ("pregrasp", "grasp", "lift"):
        rows = np.flatnonzero(phases[1:-1] == names.index(phase)) + 1
        yield int(rows[np.argmax(slowest_side[rows - 1])])


def test_videos_hold_exactly_one_frame_per_row(scenes: dict[Path, RecordedScene]):
    for episode, scene in scenes.items():
        for camera in CAMERAS:
            frames = count_frames(episode / f"{camera}.mp4")
            assert frames == len(scene.steps["time"]), f"{episode.name}/{camera}"


@pytest.mark.parametrize("camera", CAMERAS)
def test_a_frame_shows_its_row_and_no_other(scenes: dict[Path, RecordedScene], camera: str):
    for episode in list(scenes)[::5]:
        scene = scenes[episode]
        frames, renderer = decode(episode / f"{camera}.mp4", *size(scene, camera)), scene.renderer()
        for row in moving_rows(scene):
            scene.go_to(row)
            image = renderer.render(CAMERAS[camera], *size(scene, camera))["rgb"]
            before, same, after = (psnr(image, frames[row + k]) for k in (-1, 0, 1))
            place = f"{episode.name}/{camera} row {row}: {before:.1f} {same:.1f} {after:.1f} dB"
            assert same >= 30, place
            assert same > before, place
            assert same > after, place


def test_the_recorded_camera_matrices_are_those_of_the_rows(scenes: dict[Path, RecordedScene]):
    scene = next(iter(scenes.values()))
    renderer = scene.renderer()
    for row in moving_rows(scene):
        scene.go_to(row)
        for name, camera in CAMERAS.items():
            recorded = scene.steps[f"cameras/{name}"]
            image = renderer.render(camera, *size(scene, name))
            np.testing.assert_allclose(recorded["extrinsics"][row], image["extrinsics"], atol=1e-12)
            np.testing.assert_allclose(recorded["intrinsics"][:], image["intrinsics"], atol=1e-12)
            # The oracle: the engine's own camera, which looks along -z with y up.
            of_engine = scene.scene.data.camera(camera)
            to_camera = np.diag([1, -1, -1]) @ of_engine.xmat.reshape(3, 3).T
            np.testing.assert_allclose(recorded["extrinsics"][row][:3, :3], to_camera, atol=1e-12)
            centre = recorded["extrinsics"][row] @ [*of_engine.xpos, 1]
            np.testing.assert_allclose(centre, [0, 0, 0, 1], atol=1e-12)


def test_the_wrist_camera_sees_the_object_before_the_grasp(scenes: dict[Path, RecordedScene]):
    seen = {}
    for episode, scene in scenes.items():
        names = list(scene.steps["phase"].attrs["values"])
        last = int(np.flatnonzero(scene.steps["phase"][:] == names.index("pregrasp"))[-1])
        scene.go_to(last)
        image = scene.renderer().render(
            CAMERAS["wrist"], *size(scene, "wrist"), rgb=False, segmentation=True
        )["segmentation"]
        seen[episode.name] = int(np.isin(image, list(scene.bodies_of("target"))).sum())
    assert min(seen.values()) >= 50, seen
