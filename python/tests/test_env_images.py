"""Images, tasks and saved states of environments."""

from __future__ import annotations

import numpy as np
import pytest

import robocell as rc

RC7 = rc.models.robot_file("rc7")


def watched(**fields) -> rc.EnvConfig:
    """The built-in robot; a camera 1.5 m above the floor looks straight down."""
    return rc.EnvConfig(
        name="cell",
        robots={"robot": RC7},
        add_floor=True,
        camera_adds={"top": {"fovy": 30, "offset": rc.Pose(translation=[3, 3, 1.5])}},
        cameras={"resolution": [32, 24], "streams": [{"name": "top", "camera": "top"}]},
        sim={"async_control": True},
        **fields,
    )


def test_depth_is_in_millimetres():
    env = rc.Env(watched(wrappers={"include_depth": True}))
    frame = env.reset(seed=0)[0]["frames"]["top"]
    depth = frame["depth"]["data"]
    assert (depth.shape, depth.dtype) == ((24, 32, 1), np.uint16)
    assert np.abs(depth.astype(int) - 1500).max() <= 2
    assert frame["rgb"]["data"].shape == (24, 32, 3)
    assert "depth" not in rc.Env(watched()).reset()[0]["frames"]["top"]
    below = frame["depth"]["extrinsics"] @ [3, 3, 0, 1]
    pixel = frame["depth"]["intrinsics"] @ below[:3]
    assert np.allclose(pixel[:2] / pixel[2], [15.5, 11.5])


def test_frames_are_copies_with_their_time():
    env = rc.Env(watched())
    first = env.reset(seed=0)[0]["frames"]["top"]
    before = first["rgb"]["data"].copy()
    action = {"robot": {"joints": np.full(7, 0.05), "gripper": 1}}
    second = env.step(action)[0]["frames"]["top"]
    assert np.array_equal(first["rgb"]["data"], before)
    assert not np.shares_memory(first["rgb"]["data"], second["rgb"]["data"])
    assert (first["time"][0], second["time"][0]) == (0, pytest.approx(0.034))


def test_depth_saturates_and_is_zero_for_the_background():
    config = watched(wrappers={"include_depth": True})
    config.camera_adds["top"].offset = rc.Pose(translation=[3, 3, 80])
    config.camera_adds["up"] = {"offset": rc.Pose(translation=[3, 3, 1], rpy=[np.pi, 0, 0])}
    config.cameras.streams.append({"name": "up", "camera": "up", "segmentation": True})
    frames = rc.Env(config).reset(seed=0)[0]["frames"]
    assert np.all(frames["top"]["depth"]["data"] == 65535)
    assert np.all(frames["up"]["depth"]["data"] == 0)
    assert np.all(frames["up"]["segmentation"]["data"] == -1)


def test_frames_come_at_the_rate_of_their_stream():
    config = watched()
    for name, rate in (("slow", 10), ("fast", 100)):
        config.cameras.streams.append({"name": name, "camera": "top", "rate": rate})
    env = rc.Env(config)
    env.reset(seed=0)
    still = {"robot": {"joints": np.zeros(7), "gripper": 1}}
    for _ in range(9):
        observation, *_, info = env.step(still)
        now = info["time"]
        times = {name: frame["time"][0] for name, frame in observation["frames"].items()}
        assert times["top"] == now, "with every observation"
        assert 0 <= times["slow"] - np.floor(now * 10 + 1e-9) / 10 < 0.002
        assert 0 <= now - times["fast"] < 0.012


def test_no_stream_is_faster_than_the_engine():
    config = watched()
    config.cameras.streams.append({"name": "fast", "camera": "top", "rate": 1e9})
    text = (
        r"stream 'fast': its rate, 1e\+09 Hz, is more often than the engine steps, every 0.002 s; "
        "at most 500 Hz, or leave it out for a frame with every observation"
    )
    with pytest.raises(rc.ArgumentError, match=text):
        rc.Env(config)
    config.cameras.streams[1].rate = 500
    rc.Env(config).close()


def test_rejects_a_missing_camera():
    config = watched()
    config.cameras.streams[0].name = "eye"
    config.cameras.streams.append({"name": "hand", "camera": "wrst_camera"})
    with pytest.raises(rc.NotFoundError, match="stream 'hand': no camera 'wrst_camera'"):
        rc.Env(config)


def test_a_saved_state_restores_the_images():
    env = rc.Env(watched())
    env.reset(seed=0)
    action = {"robot": {"joints": np.full(7, 0.05), "gripper": 0}}
    then = env.step(action)[0]
    env.save("then")
    after = env.step(action)[0]
    assert env.saved == ["then"]
    back = env.restore("then")
    assert np.array_equal(back["robot"]["tquat"], then["robot"]["tquat"])
    assert np.array_equal(env.step(action)[0]["robot"]["tquat"], after["robot"]["tquat"])
    env.forget("then")
    with pytest.raises(rc.NotFoundError, match="environment 'cell': no saved state 'then'"):
        env.restore("then")
