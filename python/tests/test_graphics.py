"""The renderers of this machine, and the message when there is none."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from graphics import require_gl
from robocell._generation import check
from robocell._generation.check import graphics_warnings
from test_probes import machine_with_a_card

EXAMPLES = Path(__file__).parents[2] / "examples"


def describe(**environment: str) -> subprocess.CompletedProcess[str]:
    """`describe_gl()` in a process of its own."""
    code = "import robocell; print('draws:', robocell.diagnose.describe_gl())"
    return subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": ":".join(sys.path), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_describes_the_graphics():
    require_gl()
    said = describe().stdout
    assert said.startswith(("draws: egl: ", "draws: osmesa: "))


def test_a_rendering_error_lists_the_back_ends_tried():
    result = describe(ROBOCELL_GL="egl", __EGL_VENDOR_LIBRARY_FILENAMES="/no")
    assert result.returncode == 1
    assert "draws" not in result.stdout
    assert "Error: no OpenGL for off-screen rendering. Tried:\n  egl: " in result.stderr


def without_gl() -> str:
    raise rc.Error("no OpenGL for off-screen rendering")


def test_a_run_with_cameras_warns_once_about_an_idle_gpu(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    run = rc.RunConfig.load(str(EXAMPLES / "demo.yaml"))
    assert run.cameras.streams
    assert run.cameras.renderer.backend == "soft"
    root = machine_with_a_card(tmp_path / "card")
    assert graphics_warnings(run, root) == []  # it uses no card on purpose
    run.cameras.renderer.backend = "auto"
    assert graphics_warnings(run, str(tmp_path)) == []
    try:
        drawing = rc.diagnose.describe_gl()
    except rc.Error:
        drawing = "soft"
    if drawing == "soft" or "llvmpipe" in drawing:
        (warning,) = graphics_warnings(run, root)
        assert warning.startswith(f"images are drawn on the processor ({drawing}), although this")
    monkeypatch.setattr(check, "describe_gl", without_gl)
    (warning,) = graphics_warnings(run, root)
    assert warning.startswith("images are drawn on the processor (soft), although this machine")
    run.cameras.renderer.backend = "gl"
    assert graphics_warnings(run, root) == []  # the run is rejected
    run.cameras.renderer.backend = "auto"
    run.cameras.streams.clear()
    assert graphics_warnings(run, root) == []


def test_a_misspelt_back_end_is_named():
    result = describe(ROBOCELL_GL="elg")
    assert result.returncode == 1
    assert "environment variable ROBOCELL_GL: no GL back end 'elg'" in result.stderr
    assert issubclass(rc.NotFoundError, rc.Error)


def test_a_bad_mujoco_gl_is_reported_only_where_mujoco_is_needed(tmp_path: Path):
    # One process for all: the package is imported once in each.
    (tmp_path / ".quarantine").mkdir()  # a dataset, and nothing in it
    code = (
        "import sys, robocell\n"
        "from robocell._cli import main, probes\n"
        "print(probes.engine())\n"
        "def command(*words):\n"
        "    sys.argv[1:] = words\n"
        "    try: main()\n"
        "    except SystemExit as end: print('ended with', end.code, flush=True)\n"
        f"command('check', {rc.models.robot_file('rc7')!r})\n"
        f"command('verify', {str(tmp_path)!r})\n"
        f"command('report', {str(tmp_path)!r})\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "MUJOCO_GL": "foo"},
        capture_output=True,
        text=True,
        check=False,
    )
    message = (
        "the environment variable MUJOCO_GL is 'foo', and with that the Python package mujoco "
        "cannot be imported. It may be egl, osmesa, glfw or unset: `unset MUJOCO_GL`, or "
        "`export MUJOCO_GL=egl`"
    )
    assert result.returncode == 0, result.stderr
    assert "State.BROKEN" in result.stdout
    assert message in result.stdout
    assert "remedy='unset MUJOCO_GL, or export MUJOCO_GL=egl'" in result.stdout
    assert result.stderr.splitlines() == [
        f"error: {message}",
        f"error: '{tmp_path}' holds no episodes and no report: give the `robocell generate` "
        "command of this dataset again, it goes on",
    ]
    assert (
        "ended with 2\n0 episodes intact, 0 damaged\nended with 0\nended with 2\n" in result.stdout
    )


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((4, 6, 3)), "got float64 of shape (4, 6, 3); of values 0 ... 1: (x * 255).ast"),
        (np.zeros((4, 6, 3), int), "got int64 of shape (4, 6, 3), of values 0 ... 255: x.astype("),
        (np.zeros((4, 6), np.uint8), "got uint8 of shape (4, 6)"),
        (None, "got None"),
    ],
)
def test_rejects_images_that_are_not_uint8(tmp_path: Path, image: object, message: str):
    with pytest.raises(TypeError) as caught:
        rc.render.write_png(tmp_path / "x.png", image)  # type: ignore[arg-type]
    expected = "write_png: `rgb` must be a uint8 array of shape (height, width, 3), "
    assert expected + message in str(caught.value)
    assert not (tmp_path / "x.png").exists()


def test_accepts_a_view_as_an_image(tmp_path: Path):
    image = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)
    rc.render.write_png(tmp_path / "view.png", image[::2, ::-1])
    rc.render.write_png(tmp_path / "copy.png", image[::2, ::-1].copy())
    assert (tmp_path / "view.png").read_bytes() == (tmp_path / "copy.png").read_bytes()


def test_rejects_a_png_with_another_extension(tmp_path: Path):
    image = np.zeros((4, 6, 3), np.uint8)
    with pytest.raises(rc.ArgumentError, match=r"end in \.png or \.PNG: give '.*/a\.png' instead"):
        rc.render.write_png(tmp_path / "a.jpg", image)
    assert list(tmp_path.iterdir()) == []


def test_a_camera_is_a_name_or_a_view():
    scene = rc.Scene.build(rc.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=True))
    renderer = rc.render.Renderer(scene)
    for wrong in (5, None, rc.render.CameraSpec(name="wrist")):
        with pytest.raises(TypeError, match="must be the name of a camera, an OrbitCamera, a Free"):
            renderer.render(wrong)  # type: ignore[arg-type]
    with pytest.raises(rc.ArgumentError, match="an image of 1000000 x 240 pixels"):
        renderer.render(rc.render.OrbitCamera(), width=1_000_000)
