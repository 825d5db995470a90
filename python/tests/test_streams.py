"""Commands whose readers go away: what they do and how they end depends on nobody who looks on."""

from __future__ import annotations

import errno
import fcntl
import io
import os
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

import robocell
from command_line import environment_with, robocell_command, write_run
from robocell._generation import report as reports
from robocell._generation.streams import Forgiving, reader_is_gone, unforgiving

LONG_S = 240


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    run = write_run(folder, episodes_per_scene=1, cameras={"streams": []})
    done = robocell_command("generate", run, "--workers", 1)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def on_a_terminal(run: Path, *, controlling: bool) -> tuple[subprocess.Popen[bytes], int]:
    """The command with its standard error on a terminal, and the terminal's other side."""
    ours, theirs = os.openpty()

    def take_terminal() -> None:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        if controlling:
            fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

    command = subprocess.Popen(
        [sys.executable, "-m", "robocell", "generate", str(run), "--workers", "1"],
        env={**environment_with({}), "TERM": "xterm"},
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
        start_new_session=True,
        preexec_fn=take_terminal,
    )
    os.close(theirs)
    return command, ours


def close_after_first_episode(terminal: int, run: Path) -> None:
    """Reads on, as a terminal does, until there is an episode."""
    os.set_blocking(terminal, False)
    end = time.monotonic() + LONG_S
    while not list((run.parent / "out").glob("s*")):
        assert time.monotonic() < end
        time.sleep(0.02)
        try:
            os.read(terminal, 65536)
        except BlockingIOError:
            continue
    os.close(terminal)


def test_a_run_continues_when_its_terminal_closes(tmp_path: Path):
    """Of a command that was disowned: no signal comes."""
    run = write_run(tmp_path, episodes_per_scene=3, cameras={"streams": []})
    command, terminal = on_a_terminal(run, controlling=False)
    close_after_first_episode(terminal, run)
    assert command.wait(timeout=LONG_S) == 0
    assert len(robocell.data.verify(tmp_path / "out").good) == 3
    (told,) = reports.load(tmp_path / "out/report.json").commands
    assert told.end == "complete"


def test_a_terminal_that_is_closed_ends_a_run_tidily(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=200, cameras={"streams": []})
    command, terminal = on_a_terminal(run, controlling=True)
    close_after_first_episode(terminal, run)
    assert command.wait(timeout=LONG_S) == 130
    assert robocell.data.verify(tmp_path / "out").ok
    (told,) = reports.load(tmp_path / "out/report.json").commands
    assert told.end == "interrupted"


def without_reader(*arguments: object) -> tuple[int, str]:
    """As in `robocell ... | true`: the exit code and standard error."""
    ours, theirs = os.pipe()
    os.close(ours)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "robocell", *map(str, arguments)],
            env=environment_with({}),
            stdout=theirs,
            stderr=subprocess.PIPE,
            text=True,
            timeout=LONG_S,
            check=False,
        )
    finally:
        os.close(theirs)
    return done.returncode, done.stderr


@pytest.mark.proof
def test_a_closed_pipe_does_not_change_the_exit_code(dataset: Path, tmp_path: Path):
    run = dataset.parent / "run.yaml"
    assert without_reader("generate", run) == (
        0,
        "1 episode (1 on the disk), 0 workers\n1/1 episodes, 0/h, - left, success -\n",
    )
    for command in ("report", "verify"):
        assert without_reader(command, dataset) == (0, ""), command
    assert without_reader("--help") == (0, "")
    damaged = tmp_path / "damaged"
    damaged.mkdir()
    for path in dataset.rglob("*"):
        if path.is_file():
            (damaged / path.relative_to(dataset)).parent.mkdir(parents=True, exist_ok=True)
            (damaged / path.relative_to(dataset)).write_bytes(path.read_bytes())
    next(damaged.glob("s*/steps.h5")).write_bytes(b"half")
    assert without_reader("verify", damaged)[0] == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_reported_without_a_traceback(dataset: Path):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "robocell", "report", str(dataset), "--json"],
            env=environment_with({}),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=LONG_S,
            check=False,
        )
    assert done.returncode == 3
    assert "No space left on device" in done.stderr
    assert "Traceback" not in done.stderr


def test_unread_output_is_dropped_and_close_does_not_fail():
    ours, theirs = os.pipe()
    file = os.fdopen(theirs, "w")
    stream = Forgiving(file, reader_is_gone)
    print("read", file=stream, flush=True)
    assert os.read(ours, 100) == b"read\n"
    os.close(ours)
    for _ in range(2):
        print("unread", file=stream, flush=True)
    assert unforgiving(stream) is file  # type: ignore[arg-type]
    file.close()


def test_only_pipe_errors_mean_a_closed_reader(tmp_path: Path):
    with (tmp_path / "file").open("w") as file, open(os.devnull, "w") as device:
        for number, gone in ((errno.EPIPE, True), (errno.EIO, True), (errno.ENOSPC, False)):
            error = OSError(number, os.strerror(number))
            assert reader_is_gone(error, device) == gone
            assert not reader_is_gone(error, file), "a disk that fails is no reader"
            assert not reader_is_gone(error, io.StringIO())
    assert Forgiving(io.StringIO(), reader_is_gone).write("four") == 4
