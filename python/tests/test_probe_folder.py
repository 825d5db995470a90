"""Commands that are ended before they have workers: nothing of them goes on, nothing stays."""

from __future__ import annotations

import fcntl
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from command_line import REPOSITORY, environment_with, write_run
from robocell._generation.probe_folder import LOCK, PREFIX, probe_folder
from robocell._generation.procfs import children

STALLS = REPOSITORY / "tests/reliability/hard_models/replicate_in_replicate.xml"
SOON_S = 60


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def program(pid: int) -> str:
    """What a process runs; empty when it has ended."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


def limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))


def start(run: Path, *options: str, **environment: object) -> subprocess.Popen[str]:
    # A test run in the background may have signals ignored, which children inherit.
    code = "import signal; signal.signal(signal.SIGHUP, signal.SIG_DFL)"
    code += "; from robocell._cli import main; main()"
    return subprocess.Popen(
        [sys.executable, "-c", code, "generate", str(run), "--workers", "1", *options],
        env=environment_with(environment),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=limit_memory,
    )


def helper_of(command: subprocess.Popen[str], module: str) -> int:
    """The process that the command has started for this."""
    found: list[int] = []

    def look() -> bool:
        assert command.poll() is None, command.communicate()
        found[:] = [pid for pid in children(command.pid) if f"{module}\0" in program(pid)]
        return bool(found)

    wait_for(look)
    return found[0]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_the_check_process_ends_with_its_command(tmp_path: Path, number: signal.Signals):
    """While the engine is at a model that takes it hours."""
    scenes = {"source": "files", "files": [str(STALLS)]}
    command = start(write_run(tmp_path, scenes=scenes, episodes_per_scene=1))
    helper = helper_of(command, "robocell._generation.check")
    time.sleep(0.5)  # it loads, or is at it by now
    command.send_signal(number)
    _, said = command.communicate(timeout=SOON_S)
    wait_for(lambda: not program(helper))
    if number is signal.SIGKILL:
        return
    assert command.returncode == 130, said
    assert "interrupted before the first episode" in said
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()


def test_a_dry_run_that_is_ended_leaves_no_folder(tmp_path: Path):
    command = start(write_run(tmp_path), "--dry-run", TMPDIR=tmp_path)
    helper = helper_of(command, "robocell._generation.probe")
    command.terminate()
    _, said = command.communicate(timeout=SOON_S)
    assert command.returncode == 130, said
    wait_for(lambda: not program(helper))
    assert list(tmp_path.glob(f"{PREFIX}*")) == []


def test_the_next_run_removes_leftovers_of_a_killed_dry_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    left, elsewhere = tmp_path / f"{PREFIX}left", tmp_path / "elsewhere"
    for folder in (left, elsewhere, tmp_path / f"{PREFIX}of_another_making"):
        folder.mkdir()
    for folder in (left, elsewhere):
        (folder / LOCK).touch()
        (folder / "steps.h5").touch()
    (tmp_path / f"{PREFIX}file").touch()
    (tmp_path / f"{PREFIX}link").symlink_to(elsewhere)
    with probe_folder() as living, probe_folder() as other:
        assert living.is_dir(), "somebody works in it"
        names = {path.name.removeprefix(PREFIX) for path in tmp_path.iterdir()}
        own = {path.name.removeprefix(PREFIX) for path in (living, other)}
        assert names - own == {"elsewhere", "of_another_making", "file", "link"}
        assert sorted(path.name for path in elsewhere.iterdir()) == [LOCK, "steps.h5"]
    assert not living.exists()


def test_a_folder_removed_during_creation_is_created_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    lock, calls = fcntl.flock, []

    def swept_before(file: object, how: int) -> None:
        calls.append(how)
        if len(calls) == 1:
            for path in tmp_path.glob(f"{PREFIX}*/{LOCK}"):
                path.unlink()
        lock(file, how)  # type: ignore[arg-type]

    monkeypatch.setattr(fcntl, "flock", swept_before)
    with probe_folder() as folder:
        assert len(calls) == 2
        assert os.listdir(folder) == [LOCK]
