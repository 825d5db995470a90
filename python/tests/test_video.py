"""Videos of a scene: exact lengths and sizes, every kind of camera, through adding and removing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import robocell as rc

RED = [1, 0, 0, 1]


@pytest.fixture
def scene() -> rc.Scene:
    """A red ball that falls past a camera."""
    spec = rc.SceneSpec(
        name="falling",
        timestep=0.002,
        add_floor=True,
        add_skybox=False,
        objects=[ball("ball")],
        cameras=[rc.render.CameraSpec(name="side", pos=[0, -3, 0.7], fovy=45, look_at=[0, 0, 0.7])],
    )
    return rc.Scene.build(spec)


def ball(name: str, fixed: bool = False) -> rc.SceneObject:
    """At a height of one metre."""
    return rc.SceneObject(
        name=name, shape="sphere", size=[0.2, 0, 0], rgba=RED, mass=1, friction=[1, 0.01, 0.001],
        pos=[0, 0, 1], fixed=fixed,
    )  # fmt: skip


def frames_of(video: Path, width: int, height: int) -> np.ndarray:
    """Decoded by ffmpeg itself: (frames, height, width, 3)."""
    command = [
        "ffmpeg",
        "-v",
        "error",
        "-i",
        str(video),
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-",
    ]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width, 3)


def height_of_red(frame: np.ndarray) -> float:
    """Rows above the middle of the image; NaN without red."""
    red = (frame[..., 0] > 100) & (frame[..., 1] < 80)
    rows = np.nonzero(red)[0]
    return frame.shape[0] / 2 - 0.5 - rows.mean() if rows.size else float("nan")


def psnr(a: np.ndarray, b: np.ndarray) -> float:
    """How alike two images are, decibels."""
    return float(10 * np.log10(255**2 / np.mean((a.astype(float) - b) ** 2)))


def probe(video: Path) -> dict[str, str]:
    """What another program says of the file."""
    command = ["ffprobe", "-v", "error", "-select_streams", "v", "-count_frames", "-of"]
    command += ["default=noprint_wrappers=1", "-show_entries"]
    command += ["stream=codec_name,width,height,avg_frame_rate,nb_read_frames", str(video)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    return dict(line.split("=") for line in lines)


def record(scene: rc.Scene, video: rc.render.VideoRecorder, frames: int) -> None:
    """A frame each 16 ms."""
    for _ in range(frames):
        scene.step_n(8)
        video.record_frame()


@pytest.mark.parametrize(
    "frames", [60, pytest.param(3000, marks=pytest.mark.soak)], ids=["a second", "50 seconds"]
)
def test_a_preset_has_its_size_its_rate_and_every_frame(
    scene: rc.Scene, tmp_path: Path, frames: int
):
    path = tmp_path / "sim.mp4"
    video = rc.render.VideoRecorder.open_preset(
        scene, path, rc.render.VideoResolution.R720p, fps=60
    )
    video.set_free_camera(2.5, 135.0, -20.0, (0, 0, 0.7))
    record(scene, video, frames)
    video.finish()
    assert probe(path) == {
        "codec_name": "h264",
        "width": "1280",
        "height": "720",
        "avg_frame_rate": "60/1",
        "nb_read_frames": str(frames),
    }


def test_every_kind_of_camera(scene: rc.Scene, tmp_path: Path):
    with rc.render.VideoRecorder(scene, tmp_path / "a.mp4", 64, 48, fps=30) as video:
        video.record_frame()  # the whole model
        video.set_free_camera(3, 90, 0, [0, 0, 0.7])
        video.record_frame()
        video.set_tracking_camera("ball", distance=3, elevation=0)
        video.record_frame()
        record(scene, video, 12)
        video.use_camera("side")
        video.record_frame()
        video.use_camera("")
        video.record_frame()
        video.use_camera(rc.render.TrackingCamera("ball", distance=3, elevation=0))
        video.record_frame()
        video.use_camera(rc.render.OrbitCamera(lookat=[0, 0, 0.7], distance=3, elevation=0))
        video.record_frame()
    seen = [height_of_red(frame) for frame in frames_of(tmp_path / "a.mp4", 64, 48)]
    whole, free, tracking, *falling, fixed, free_again, tracking_again, orbit = seen
    assert not np.isnan(whole)
    assert free > 3
    assert np.abs([tracking, *falling, tracking_again]).max() < 1.5
    assert free_again < free - 3
    assert free_again == pytest.approx(orbit, abs=0.5)
    assert fixed == pytest.approx(free_again, abs=2)


def test_cameras_by_name(tmp_path: Path):
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    scene = rc.Scene.build(
        rc.SceneSpec(
            name="cell", timestep=0.002, add_floor=True, add_skybox=False, objects=[ball("ball")],
            robots=[rc.RobotSpec(name="r", config=config, prefix="r_", pos=[0, 1.5, 0])],
            cameras=[
                rc.render.CameraSpec(name="side", pos=[0, -3, 0.7], fovy=45, look_at=[0, 0, 0.7])
            ],
        )
    )  # fmt: skip
    path = tmp_path / "a.mp4"
    with rc.render.VideoRecorder(scene, path, 64, 48, fps=30) as video:
        names = video.camera_names()
        assert names == ["Current", "Free", "Tracking", "r_exo_camera", "r_wrist_camera", "side"]
        video.set_free_camera(3, 90, 0, [0, 0, 0.7])
        with pytest.raises(
            rc.ArgumentError,
            match=r"a.mp4': camera 'Tracking' has nothing to follow yet; .*set_tracking_camera\)",
        ):
            video.use_camera("Tracking")
        video.use_camera("Current")
        video.record_frame()
        video.set_tracking_camera("ball", distance=3, elevation=0)
        for name in [*names, "Current"]:
            video.use_camera(name)
            video.record_frame()
    renderer = rc.render.Renderer(scene)
    frames = frames_of(path, 64, 48)
    first, current, free, tracking, exo, wrist, side, last = frames
    low = height_of_red(first)
    assert low > 3
    assert height_of_red(free) == pytest.approx(low, abs=0.5)
    assert abs(height_of_red(current)) < 1.5
    assert abs(height_of_red(tracking)) < 1.5
    shown = {"r_exo_camera": [exo], "r_wrist_camera": [wrist], "side": [side, last]}
    images = {camera: renderer.render(camera, 64, 48)["rgb"] for camera in shown}
    for camera, filmed in shown.items():
        assert min(psnr(frame, images[camera]) for frame in filmed) > 28, camera
    assert max(psnr(exo, wrist), psnr(wrist, side), psnr(side, exo)) < 20


def test_images_accept_the_same_cameras(scene: rc.Scene):
    renderer = rc.render.Renderer(scene)
    whole = renderer.render("", 64, 48)["rgb"]
    assert not np.isnan(height_of_red(whole))
    scene.step_n(100)
    view = rc.render.TrackingCamera("ball", distance=3, azimuth=90, elevation=0)
    assert abs(height_of_red(renderer.render(view, 64, 48)["rgb"])) < 1.5
    with pytest.raises(rc.NotFoundError, match=r"no body 'bal'. Its bodies: .*Did you mean 'ball'"):
        renderer.render(rc.render.TrackingCamera("bal"), 64, 48)


def test_cameras_survive_added_and_removed_objects(scene: rc.Scene, tmp_path: Path):
    with rc.render.VideoRecorder(scene, tmp_path / "a.mp4", 64, 48, fps=30) as video:
        video.set_tracking_camera("ball", distance=3, elevation=0)
        scene.add_object(
            rc.SceneObject(name="post", shape="box", size=[0.05, 0.05, 0.3], rgba=[0, 0, 1, 1],
                           mass=1, friction=[1, 0.01, 0.001], pos=[1, 0, 0.3], fixed=True)
        )  # fmt: skip
        record(scene, video, 3)
        scene.remove_object("ball")
        for _ in range(2):
            with pytest.raises(rc.NotFoundError, match=r"a.mp4': no body 'ball'. Its bodies: "):
                video.record_frame()
        with pytest.raises(rc.NotFoundError, match="no body 'bal'"):
            video.set_tracking_camera("bal")
        video.use_camera("side")
        video.record_frame()
        scene.add_object(ball("other", fixed=True))
        video.set_tracking_camera("other", distance=3, elevation=0)
        video.record_frame()
        scene.remove_object("other")
        video.set_free_camera(3, 90, 0, [0, 0, 0.7])
        video.record_frame()
    seen = [height_of_red(frame) for frame in frames_of(tmp_path / "a.mp4", 64, 48)]
    assert np.isnan(seen).tolist() == [False, False, False, True, False, True]
    assert np.abs(np.array(seen)[[0, 1, 2, 4]]).max() < 1.5


def test_errors_name_wrong_cameras_sizes_and_paths(scene: rc.Scene, tmp_path: Path):
    video = rc.render.VideoRecorder(scene, tmp_path / "a.mp4", 64, 48)
    with pytest.raises(
        rc.NotFoundError,
        match=r"a.mp4': no camera 'sied'. Its cameras: Current, Free, Tracking, side. "
        r"Did you mean 'side'\?",
    ):
        video.use_camera("sied")
    with pytest.raises(TypeError, match="OrbitCamera, a FreeCamera or a TrackingCamera, got None"):
        video.use_camera(None)  # type: ignore[arg-type]
    with pytest.raises(rc.ArgumentError, match="lookat must be 3 numbers, got 2"):
        video.set_free_camera(1, 0, 0, [0, 0])
    with pytest.raises(rc.ArgumentError, match="63"):
        rc.render.VideoRecorder(scene, tmp_path / "odd.mp4", 63, 48)
    with pytest.raises(rc.IoError, match="nowhere"):
        rc.render.VideoRecorder(scene, tmp_path / "nowhere" / "a.mp4", 64, 48)
    video.record_frame()
    scene.close()
    with pytest.raises(rc.ClosedError, match="video recorder is closed"):
        video.record_frame()


RECORD = """
import sys, robocell as rc
scene = rc.Scene.build(rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=False))
try:
    rc.render.VideoRecorder(scene, sys.argv[1], 64, 48).record_frame()
except rc.Error as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("missing", "message"),
    [
        ({"PATH": "/nowhere"}, "no ffmpeg found for video: "),
        ({"ROBOCELL_GL": "egl", "__EGL_VENDOR_LIBRARY_FILENAMES": "/no"}, "no OpenGL for off-scre"),
    ],
    ids=["encoder", "GL"],
)
def test_reports_a_missing_encoder_and_missing_gl(
    missing: dict[str, str], message: str, tmp_path: Path
):
    path = tmp_path / "a.mp4"
    said = subprocess.run(
        [sys.executable, "-c", RECORD, str(path)],
        env={"PATH": os.environ["PATH"], "PYTHONPATH": ":".join(sys.path), **missing},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert message in said
    assert "nstall" in said
    assert not path.exists()


@pytest.mark.parametrize("fovy", [float("nan"), float("inf"), -5.0, 0.0, 180.0])
@pytest.mark.parametrize(
    "make",
    [
        lambda fovy: rc.render.FreeCamera(rc.Pose(), fovy=fovy),
        lambda fovy: rc.render.OrbitCamera(fovy=fovy),
        lambda fovy: rc.render.TrackingCamera("ball", fovy=fovy),
    ],
)
def test_rejects_impossible_fields_of_view(make, fovy):
    with pytest.raises(rc.ArgumentError, match=f"fovy is {fovy:g}; it must be above 0 and below"):
        make(fovy)
