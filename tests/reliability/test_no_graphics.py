"""Machines without graphics libraries, by a shim that hides them from dlopen(3)."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from ledger import BUILD

from command_line import new_process, write_run

CAMERAS = {
    "resolution": [64, 48],
    "renderer": {"quality": "standard"},  # and the back end of the machine
    "streams": [{"name": "wrist", "camera": "wrist_camera", "depth": True, "segmentation": True}],
}


def test_datasets_are_generated_and_verified_without_graphics_libraries(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1, cameras=CAMERAS)
    libraries = {"LD_PRELOAD": str(BUILD / "libno_graphics.so")}
    chosen = ("ROBOCELL_RENDERER", "ROBOCELL_GL", "MUJOCO_GL")
    environment = {name: value for name, value in os.environ.items() if name not in chosen}
    environment |= {"PYTHONPATH": os.pathsep.join(sys.path), **libraries}
    options = {"environment": environment, "timeout_s": 120}
    made = new_process("generate", run, **options)
    assert made.returncode == 0, made.stderr
    assert json.loads((tmp_path / "out/dataset.json").read_text())["renderer"] == "soft"
    verified = new_process("verify", tmp_path / "out", **options)
    assert verified.returncode == 0, verified.stdout
    told = new_process("doctor", **options)
    assert told.returncode == 0
    assert "is optional: sudo apt install libegl1" in told.stdout
    assert "this machine can generate datasets" in told.stdout
    with_gl = new_process("generate", run, "--set", "cameras.renderer.backend=gl", **options)
    assert with_gl.returncode != 0
    assert "libEGL.so.1: cannot open shared object file" in with_gl.stderr
    assert "ROBOCELL_RENDERER=soft draws without OpenGL" in with_gl.stderr
