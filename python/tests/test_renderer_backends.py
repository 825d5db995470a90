"""Renderers by name, from Python."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc
from command_line import write_run
from graphics import require_gl

BARE = """
import robocell as rc
scene = rc.Scene.build(rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=True))
print(rc.render.Renderer(scene).description)
"""


@pytest.fixture(scope="module")
def scene() -> rc.Scene:
    return rc.Scene.build(rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=True))


def test_soft_matches_gl(scene: rc.Scene):
    require_gl()
    gl, soft = (
        rc.render.Renderer(scene, backend=name).render("", 160, 120, depth=True, segmentation=True)
        for name in ("gl", "soft")
    )
    assert np.mean(gl["segmentation"] != soft["segmentation"]) < 1e-3
    assert np.abs(gl["rgb"].astype(int) - soft["rgb"]).mean() < 3


def test_an_unknown_back_end_error_lists_the_back_ends(scene: rc.Scene):
    with pytest.raises(rc.NotFoundError, match=r"no back end 'sofd'.*auto, gl, soft.*'soft'"):
        rc.render.Renderer(scene, backend="sofd")


def test_a_quality_has_a_name_and_excludes_single_effects(scene: rc.Scene):
    rc.render.Renderer(scene, backend="soft", quality="high")
    with pytest.raises(rc.NotFoundError, match="Its qualities: fast, standard, high"):
        rc.render.Renderer(scene, quality="best")
    with pytest.raises(ValueError, match="not both"):
        rc.render.Renderer(scene, quality="high", shadows=True)
    with pytest.raises(ValueError, match="not both"):
        rc.render.Renderer(scene, quality="standard", shadow_size=512)


def description(**variables: str) -> str:
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        [sys.executable, "-c", BARE],
        env={**environment, **variables},
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_the_environment_chooses():
    assert description(ROBOCELL_RENDERER="soft").startswith("soft: ")


def test_without_egl_another_back_end_draws():
    found = description(__EGL_VENDOR_LIBRARY_FILENAMES="/no")
    assert found.startswith(("soft: ", "gl: osmesa"))  # OSMesa may be installed


def services(device: str) -> list[int]:
    """The drawing services for this choice of a device."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if b"robocell_drawing_service" not in (process / "cmdline").read_bytes():
                continue
            if f"CUDA_VISIBLE_DEVICES={device}".encode() in (process / "environ").read_bytes():
                found.append(int(process.name))
        except OSError:  # it has ended
            continue
    return found


@pytest.mark.proof
def test_a_run_whose_drawing_service_is_killed_has_the_same_videos(tmp_path: Path):
    require_gl()
    run = write_run(tmp_path)
    device = str(os.getpid())  # no card has this number: a service of this test alone
    videos, killed = [], []
    for service in "01":
        words = ["generate", run, "--workers", 2, "--output", tmp_path / service]
        words += ["--set", "cameras.renderer.backend=gl"]
        process = subprocess.Popen(
            [sys.executable, "-m", "robocell", *map(str, words)],
            env={**os.environ, "ROBOCELL_GL_SERVICE": service, "CUDA_VISIBLE_DEVICES": device},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        while service == "1" and process.poll() is None and len(killed) < 2:
            time.sleep(0.02)
            for pid in services(device):
                if pid not in killed:
                    time.sleep(0.2)
                    os.kill(pid, signal.SIGKILL)
                    killed.append(pid)
        _, errors = process.communicate()
        assert process.returncode == 0, errors
        files = sorted((tmp_path / service).glob("*/*.mp4"))
        videos.append({f.relative_to(tmp_path / service): f.read_bytes() for f in files})
    assert killed
    assert videos[0]
    assert videos[0] == videos[1]


# Sizes that fill no whole block of 4x4 pixels, one pixel, and one that is larger than a screen.
@pytest.mark.parametrize("size", [(1, 1), (65, 17), (3, 641), (4096, 2160)])
def test_soft_draws_images_of_any_size(size: tuple[int, int]):
    """Depth at random pixels is that of the engine's rays; threads change no byte."""
    width, height = size
    spec = rc.SceneSpec(name="room", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="arm", config=config))
    scene = rc.Scene.build(spec)
    view = rc.render.OrbitCamera(lookat=(0, 0, 0.4), distance=1.6, azimuth=130, elevation=-30)
    drawn = [
        rc.render.Renderer(scene, backend="soft", quality="standard", threads=threads).render(
            view, width, height, depth=True, segmentation=True
        )
        for threads in (1, 3)
    ]
    image = drawn[0]
    for kind in ("rgb", "depth", "segmentation"):
        assert np.array_equal(drawn[0][kind], drawn[1][kind]), kind
    to_world = np.linalg.inv(image["extrinsics"])
    rng = np.random.default_rng(width)
    rows, columns = rng.integers(height, size=40), rng.integers(width, size=40)
    pixels = np.stack([columns, rows, np.ones(40)])
    rays = to_world[:3, :3] @ np.linalg.inv(image["intrinsics"]) @ pixels
    visible = np.array([1, 1, 1, 0, 0, 0], np.uint8)
    hit = [
        mujoco.mj_ray(
            scene.model, scene.data, to_world[:3, 3], ray, visible, 1, -1, np.zeros(1, np.int32)
        )
        for ray in rays.T
    ]
    expected = np.maximum(hit, 0)  # rays have the length of one metre of depth
    near = np.abs(image["depth"][rows, columns] - expected) < 1e-3 + 1e-4 * expected
    assert np.mean(near) >= 0.95  # facets of round shapes differ at their edges
    assert np.any(expected > 0)
