"""The command line while it starts: Ctrl-C, and what counts as the command."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import robocell as rc
from robocell._cli import COMMANDS
from robocell._startup import COMMANDS_OF_MODULES, is_command, refusal_of_module

ROOT = Path(__file__).resolve().parents[2]

CTRL_C_AT_IMPORT = """
import builtins, os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
real = builtins.__import__
def load(name, *rest, **more):
    if name == "{module}":
        os.kill(os.getpid(), signal.SIGINT)
    return real(name, *rest, **more)
builtins.__import__ = load
"""


def interrupted_at_import(
    folder: Path, module: str, *arguments: str
) -> subprocess.CompletedProcess[str]:
    """Runs Python, with Ctrl-C when it comes to import a module."""
    (folder / "sitecustomize.py").write_text(CTRL_C_AT_IMPORT.format(module=module))
    return subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("module", ["robocell._core", "typer", "robocell._cli.probes"])
def test_ctrl_c_while_the_command_is_loaded_leaves_no_traceback(tmp_path: Path, module: str):
    result = interrupted_at_import(tmp_path, module, "-m", "robocell", "doctor")
    assert (result.returncode, result.stderr) == (-signal.SIGINT, "")


def test_a_program_that_imports_robocell_keeps_its_ctrl_c(tmp_path: Path):
    code = "try: import robocell\nexcept KeyboardInterrupt: print('heard')"
    result = interrupted_at_import(tmp_path, "robocell._core", "-c", code)
    assert (result.returncode, result.stdout) == (0, "heard\n")


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("/usr/bin/robocell generate run.yaml", True),
        ("python -m robocell check", True),
        ("/usr/bin/python3 -X dev -u -m robocell", True),
        ("python3 /opt/bin/robocell check", True),
        ("python -m robocell._generation.worker", False),
        ("python -m pytest robocell", False),
        ("python script.py robocell", False),
        ("python -c code robocell", False),
        ("python", False),
    ],
)
def test_recognises_the_command_line(line: str, command: bool):
    assert is_command(line.split()) is command


@pytest.mark.parametrize("module", COMMANDS_OF_MODULES)
def test_a_module_that_is_run_like_a_command_names_the_command(module: str):
    done = subprocess.run(
        [sys.executable, "-m", f"robocell.{module}", "run.yaml"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"error: 'robocell.{module}' is a module to import, and does nothing by itself. Run "
        f"`robocell {COMMANDS_OF_MODULES[module]}`\n"
    )
    assert COMMANDS_OF_MODULES[module] in COMMANDS


@pytest.mark.parametrize(
    ("line", "is_refused"),
    [
        ("python -u -m robocell.data.derive", True),
        ("python -m robocell", False),
        ("python -m robocell.compat.molmo_spaces.data_generation.main a:B", False),
        ("python -m robocell.compat.molmo_spaces.env.env", True),
        ("python -m robocell._generation.work run.yaml", False),
        ("python -m robocell.nothing", False),
        ("python script.py -m robocell.generate", False),
        ("python -c code -m robocell.generate", False),
        ("python", False),
    ],
)
def test_recognises_modules_that_do_nothing(line: str, is_refused: bool):
    assert bool(refusal_of_module(line.split())) is is_refused


def test_it_starts_in_a_folder_that_was_deleted(tmp_path: Path):
    gone = tmp_path / "gone"
    gone.mkdir()
    start = 'rmdir ../gone && exec "$0" -m robocell --version'
    done = subprocess.run(
        ["sh", "-c", start, sys.executable],
        cwd=gone,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"robocell {rc.__version__}\n"


@pytest.mark.parametrize("name", ["json", "random"])
def test_rejects_a_file_named_like_a_standard_module(tmp_path: Path, name: str):
    """Also by `python -m`, which would look for modules in the working folder first."""
    (tmp_path / f"{name}.py").write_text("raise RuntimeError('not meant')\n")
    (tmp_path / "run.yaml").write_text("{}\n")
    command = [sys.executable, "-m", "robocell", "generate", "run.yaml", "--import", f"{name}.py"]
    environment = {**os.environ, "PYTHONPATH": str(Path(rc.__file__).parents[1])}
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert f"'{name}' is the name of a module of Python itself" in done.stderr


@pytest.mark.parametrize(
    "closed",
    [
        *(pytest.param(one, marks=pytest.mark.proof) for one in ("2>&-", ">&-", "<&-")),
        "<&- >&- 2>&-",
    ],
)
def test_standard_streams_may_be_closed(tmp_path: Path, closed: str):
    """Workers and encoders would else write to a file that took the number of a stream."""
    words = f"{sys.executable} -m robocell generate {ROOT}/examples/demo.yaml --episodes 1 --set"
    command = f"{words} cameras.streams=[] --output out {closed}"
    result = subprocess.run(command, shell=True, cwd=tmp_path, check=False, capture_output=True)
    assert result.returncode == 0
    assert len(rc.Dataset(tmp_path / "out")) == 1
