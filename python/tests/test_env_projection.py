"""Bodies are in an environment's frames where the frames' own cameras project them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import robocell as rc

RADIUS = 0.025
# Two clouds of balls off every axis: in view of the fixed camera, and of the one on the hand.
FAR = [
    (2.5 + 0.12 * i, 2.5 + 0.12 * j, 0.1 + 0.02 * ((i + j) % 3))
    for i in range(10)
    for j in range(9)
]
NEAR = [
    (0.1 + 0.08 * i, -0.4 + 0.08 * j, 0.04 + 0.02 * (i % 3)) for i in range(8) for j in range(16)
]
CAMERAS = {
    "corner": {"fovy": 70, "offset": rc.Pose(translation=[2.9, 2.7, 1.1], rpy=[0.35, 0.2, 0.4])},
    "hand": {
        "fovy": 50,
        "robot_name": "robot",
        "offset": rc.Pose(translation=[0.12, 0, 0], rpy=[np.pi, 0, 0]),
    },
}
BALLS = {f"ball{i}": np.array(place) for i, place in enumerate(FAR + NEAR)}


def watched(camera: str, width: int, height: int, streams: dict[str, dict]) -> rc.Env:
    """The built-in robot, the balls, and streams of one camera."""
    ball = {
        "shape": "sphere",
        "size": [RADIUS, 0, 0],
        "mass": 1,
        "rgba": [1, 0, 0, 1],
        "friction": [1, 0.005, 0.0001],
        "fixed": True,
    }
    every = {"camera": camera, "width": width, "height": height, "segmentation": True}
    return rc.Env(
        rc.EnvConfig(
            name="cell",
            robots={"robot": rc.models.robot_file("rc7")},
            add_floor=True,
            world_frame_objects={
                name: ball | {"offset": rc.Pose(translation=place)} for name, place in BALLS.items()
            },
            camera_adds={camera: CAMERAS[camera]},
            cameras={"streams": [every | {"name": n} | more for n, more in streams.items()]},
            sim={"async_control": True},
        )
    )


def seen(env: rc.Env, frame: dict) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Of each ball that is whole in the image its place there, (u, v) found and expected."""
    image = frame["segmentation"]
    height, width, _ = image["data"].shape
    k = image["intrinsics"]
    for name, place in BALLS.items():
        x, y, z, _ = image["extrinsics"] @ [*place, 1]
        if z < 2 * RADIUS:
            continue
        # The centre of a sphere's image lies off the image of its centre.
        away = z / (z * z - RADIUS * RADIUS)
        expected = (k @ [x * away, y * away, 1])[:2]
        if np.any(expected < 25) or np.any(expected > np.array([width, height]) - 26):
            continue
        v, u, _ = np.nonzero(image["data"] == env.scene.model.body(name).id)
        assert len(u) > 40, (name, expected, len(u))
        yield np.array([u.mean(), v.mean()]), expected


def off_by(env: rc.Env, frame: dict) -> np.ndarray:
    """(n, 2) pixels, of the balls that are whole in the image."""
    return np.array([found - expected for found, expected in seen(env, frame)])


def camera_place(frame: dict) -> np.ndarray:
    return np.linalg.inv(frame["rgb"]["extrinsics"])[:3, 3]


def check(off: np.ndarray, at_least: int):
    """The bounds of the renderer's own test."""
    assert len(off) >= at_least
    assert np.linalg.norm(off, axis=1).max() < 0.35
    assert np.abs(off.mean(axis=0)).max() < 0.05


@pytest.mark.parametrize(("width", "height"), [(320, 240), (428, 240), (200, 300)])
def test_projected_bodies_match_a_fixed_camera(width: int, height: int):
    env = watched("corner", width, height, {"corner": {}})
    frame = env.reset(seed=0)[0]["frames"]["corner"]
    check(off_by(env, frame), at_least=25)
    for key in ("intrinsics", "extrinsics"):
        np.testing.assert_array_equal(frame["rgb"][key], frame["segmentation"][key])


def test_a_held_frame_keeps_the_camera_of_its_own_time():
    env = watched("hand", 320, 240, {"now": {}, "slow": {"rate": 7}})
    moves = np.outer([1] * 5 + [-1] * 6, [0.1, 0.05, 0.05, -0.05, 0, 0, 0.1])
    observations = [env.reset(seed=0)[0]]
    for joints in moves:
        observations.append(env.step({"robot": {"joints": joints, "gripper": 1}})[0])
    now, slow = ([o["frames"][name] for o in observations] for name in ("now", "slow"))
    check(np.vstack([off_by(env, frame) for frame in now]), at_least=100)
    check(np.vstack([off_by(env, frame) for frame in slow]), at_least=100)
    times = [frame["time"][0] for frame in now]
    places = np.array([camera_place(frame) for frame in now])
    held = 0
    for present, frame in zip(now, slow, strict=True):
        # Between two observations the camera's way is straight to some millimetres.
        then = [np.interp(frame["time"][0], times, way) for way in places.T]
        assert np.linalg.norm(camera_place(frame) - then) < 0.005
        held += np.linalg.norm(camera_place(frame) - camera_place(present)) > 0.03
    assert held >= 6, "else the camera stood still"
