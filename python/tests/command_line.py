"""Runs and robot files for tests of the command line, and the command itself."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

import robocell

REPOSITORY = Path(__file__).resolve().parents[2]


RC7 = Path(robocell.models.robot_file("rc7"))


RUN = {
    "run": "tiny",
    "robot": str(RC7),
    "task": {
        "kind": "pick",
        "base_distance": [0.3, 0.55],
        "base_height_offset": -0.25,
        "base_height_noise": [-0.15, 0.1],
    },
    "scenes": {"source": "tabletop"},
    "episodes_per_scene": 2,
    "cameras": {"resolution": [64, 48], "streams": [{"name": "wrist", "camera": "wrist_camera"}]},
    "rates": {"policy_ms": 66, "control_ms": 2, "sim_ms": 2, "max_steps": 500},
}


def write_run(folder: Path, **changes: object) -> Path:
    """A run file; `changes` replace top-level fields."""
    path = folder / "run.yaml"
    path.write_text(yaml.safe_dump({**RUN, "output": str(folder / "out"), **changes}))
    return path


def robocell_command(
    *arguments: object,
    environment: dict[str, object] | None = None,
    timeout_s: float = 240,
    **options: object,
) -> subprocess.CompletedProcess[str]:
    """Runs the command line in a process of its own; `options` are those of `subprocess.run`."""
    given = {name: str(value) for name, value in (environment or {}).items()}
    own = {"PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "200"}
    return subprocess.run(
        [sys.executable, "-m", "robocell", *map(str, arguments)],
        env={**os.environ, **own, **given},
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout_s,
        **options,  # type: ignore[call-overload]
    )


def refused(*arguments: object, code: int = 2) -> str:
    """Standard error of a command that must end with `code` and without a traceback."""
    result = robocell_command(*arguments)
    assert result.returncode == code, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    return result.stderr


def write_robot(folder: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """The built-in robot's file with a change."""
    config = yaml.safe_load(RC7.read_text())
    config["model"] = str(RC7.parent / config["model"])
    change(config)
    path = folder / "robot.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


def set_in(*keys: str | int, value: object) -> Callable[[dict[str, Any]], object]:
    """A change: config[key][key]... = value."""

    def change(config: Any) -> None:
        for key in keys[:-1]:
            config = config[key]
        config[keys[-1]] = value

    return change
