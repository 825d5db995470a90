"""Environments with the readers of other projects, gigabytes of them, which soak tests share."""

from __future__ import annotations

import fcntl
import os
import subprocess
import venv
from collections.abc import Sequence
from pathlib import Path

from command_line import REPOSITORY

SOAK = REPOSITORY / "build" / "soak"


def reader_python(name: str, packages: Sequence[str], without_deps: Sequence[str] = ()) -> Path:
    """The interpreter of an environment with these packages; made when it is not there.

    `without_deps` are packages whose requirements would bring what the reader does not need, or
    what does not install here.
    """
    folder = SOAK / name
    python, ready = folder / "bin" / "python", folder / "ready"
    listed = "\n".join([*packages, *without_deps])
    SOAK.mkdir(parents=True, exist_ok=True)
    with (SOAK / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not ready.exists() or ready.read_text() != listed:
            venv.create(folder, with_pip=True, clear=True)
            # -I: packages elsewhere on PYTHONPATH would count as installed
            install = [python, "-I", "-m", "pip", "install", "-q"]
            subprocess.run([*install, *packages], check=True)
            if without_deps:
                subprocess.run([*install, "--no-deps", *without_deps], check=True)
            ready.write_text(listed)
    return python


def run_reader(python: Path, program: str, *arguments: object, timeout_s: float = 900) -> str:
    """Runs a program in such an environment, without a network, and returns what it printed."""
    offline = {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1", "CUDA_VISIBLE_DEVICES": ""}
    said = subprocess.run(
        [str(python), "-I", "-c", program, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout_s,
        env={**os.environ, **offline},
    )
    assert said.returncode == 0, said.stdout + said.stderr
    return said.stdout
