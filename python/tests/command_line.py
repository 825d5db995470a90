"""Runs and robot files for tests of the command line, and the command itself."""

from __future__ import annotations

import atexit
import functools
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

import robocell

REPOSITORY = Path(__file__).resolve().parents[2]


RC7 = Path(robocell.models.robot_file("rc7"))


RUN = {
    "run": "tiny",
    "robot": str(RC7),
    "task": {"kind": "pick"},
    "start": {
        "base_distance": [0.3, 0.55],
        "base_height_offset": -0.25,
        "base_height_noise": [-0.15, 0.1],
    },
    "scenes": {"source": "tabletop"},
    "episodes_per_scene": 2,
    # OpenGL starts anew in each process, which takes longer than all images of a run.
    "cameras": {
        "resolution": [64, 48],
        "renderer": {"backend": "soft"},
        "streams": [{"name": "wrist", "camera": "wrist_camera"}],
    },
    # Few images: tests hardly ever look at them.
    "rates": {"policy_ms": 198, "control_ms": 2, "sim_ms": 2, "max_steps": 500},
}


def write_run(folder: Path, **changes: object) -> Path:
    """A run file; `changes` replace top-level fields."""
    path = folder / "run.yaml"
    path.write_text(yaml.safe_dump({**RUN, "output": str(folder / "out"), **changes}))
    return path


def new_process(
    *arguments: object,
    environment: Mapping[str, str],
    timeout_s: float,
    **options: object,
) -> subprocess.CompletedProcess[str]:
    """Runs the command line as a person does; `options` are those of `subprocess.run`."""
    return subprocess.run(
        [sys.executable, "-m", "robocell", *map(str, arguments)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout_s,
        **options,  # type: ignore[call-overload]
    )


def environment_with(changes: Mapping[str, object]) -> dict[str, str]:
    """Of a command: it finds the modules that this process finds, and has wide lines."""
    own = {"PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "200"}
    return {**os.environ, **own, **{name: str(value) for name, value in changes.items()}}


class CommandServer:
    """Forks of a process that has the command line loaded, see `command_server`."""

    # Files that a process reads while it starts or loads a module.
    READ_AT_START = ("PYTHON", "LD_", "MUJOCO_", "ROBOCELL_", "OPENBLAS_", "MALLOC_")

    def __init__(self) -> None:
        self._start = self._of_start(environment_with({}))
        self._folder = tempfile.TemporaryDirectory()
        self._out, self._err = (Path(self._folder.name) / name for name in ("out", "err"))
        self._process = subprocess.Popen(
            [sys.executable, Path(__file__).with_name("command_server.py")],
            env={**environment_with({}), "OPENBLAS_NUM_THREADS": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def serves(self, environment: Mapping[str, str]) -> bool:
        """Whether a fork is what a new process with these variables would be."""
        return self._of_start(environment) == self._start

    def run(
        self,
        *arguments: object,
        environment: Mapping[str, str],
        timeout_s: float,
        folder: Path | None = None,
        merged: bool = False,
    ) -> subprocess.CompletedProcess[str]:
        """Runs the command line in a folder; `merged` adds standard error to the output."""
        for file in (self._out, self._err):
            file.write_bytes(b"")
        command = ["robocell", *map(str, arguments)]
        request = {
            "arguments": command[1:],
            "environment": dict(environment),
            "folder": str(folder or os.getcwd()),
            "out": str(self._out),
            "err": str(self._out if merged else self._err),
            "timeout_s": timeout_s,
        }
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(json.dumps(request), file=self._process.stdin, flush=True)
        code = int(self._process.stdout.readline())
        if code == -signal.SIGALRM:
            raise subprocess.TimeoutExpired(command, timeout_s)
        out, err = self._out.read_text(), self._err.read_text()
        return subprocess.CompletedProcess(command, code, out, err)

    def close(self) -> None:
        """Ends the process."""
        self._process.communicate()
        self._folder.cleanup()

    def _of_start(self, environment: Mapping[str, str]) -> dict[str, str]:
        return {
            name: value
            for name, value in environment.items()
            if name.startswith(self.READ_AT_START)
        }


@functools.cache
def command_server() -> CommandServer:
    """The one of this process, which ends with it."""
    server = CommandServer()
    atexit.register(server.close)
    return server


def robocell_command(
    *arguments: object,
    environment: Mapping[str, object] | None = None,
    timeout_s: float = 240,
    cwd: Path | None = None,
    **options: object,
) -> subprocess.CompletedProcess[str]:
    """Runs the command line in a process of its own: a new one where a fork would not be the same.

    `options` are those of `subprocess.run`.
    """
    found = environment_with(environment or {})
    if options or not command_server().serves(found):
        return new_process(*arguments, environment=found, timeout_s=timeout_s, cwd=cwd, **options)
    return command_server().run(*arguments, environment=found, timeout_s=timeout_s, folder=cwd)


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
