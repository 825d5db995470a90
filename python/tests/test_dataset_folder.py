"""What generation asks of a dataset's folder: is it free, is there room, what is made already."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import write_run
from robocell import IoError
from robocell._generation import report as reports
from robocell._generation import supervised_job
from robocell._generation.check import Found
from robocell._generation.job import Job
from robocell._generation.observer import Observer
from robocell._generation.resume import DamagedEpisodesError
from robocell.data import DatasetLock, remove_leftovers


def test_a_folder_is_generated_by_one_run_at_a_time(tmp_path: Path):
    with DatasetLock(tmp_path):
        with pytest.raises(IoError) as error, DatasetLock(tmp_path):
            pass
        assert f"process {os.getpid()} on" in str(error.value)
        assert "take another folder for the dataset" in str(error.value)
    with DatasetLock(tmp_path):
        pass


def test_shards_share_a_folder_but_not_a_shard(tmp_path: Path):
    with DatasetLock(tmp_path, 0, 2), DatasetLock(tmp_path, 1, 2):
        with pytest.raises(IoError), DatasetLock(tmp_path, 1, 2):
            pass
        with pytest.raises(IoError), DatasetLock(tmp_path):
            pass


def test_the_lock_of_a_killed_process_is_free(tmp_path: Path):
    code = (
        "import sys, time; from pathlib import Path\n"
        "from robocell.data import DatasetLock\n"
        f"with DatasetLock(Path({str(tmp_path)!r})): print('held', flush=True); time.sleep(100)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    owner = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, env=environment)
    assert owner.stdout is not None
    with owner.stdout:
        assert owner.stdout.readline() == b"held\n"
        with pytest.raises(IoError), DatasetLock(tmp_path):
            pass
        owner.kill()
        owner.wait()
    with DatasetLock(tmp_path):
        pass


class Told(Observer):
    """Keeps the warnings."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def warning(self, text: str) -> None:
        self.warnings.append(text)


def test_warns_about_leftovers_that_cannot_be_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def fail(*_: object) -> None:
        raise IoError("cannot list 'models/x'")

    monkeypatch.setattr(supervised_job, "remove_leftovers", fail)
    told = Told()
    Job(write_run(tmp_path), []).clean_up("e7", 42, told)
    assert told.warnings == [
        "what a worker (pid 42) left of e7 could not be removed: cannot list 'models/x'"
    ]


def test_a_run_writes_its_report_despite_damage_found_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    job = Job(write_run(tmp_path), [])
    ids = {item.id for item in job.items}
    answers = iter([ids, DamagedEpisodesError("'e' is half an episode", sorted(ids)[:1])])

    def made(self: Job) -> set[str]:
        answer = next(answers)
        if isinstance(answer, DamagedEpisodesError):
            raise answer
        return answer

    monkeypatch.setattr(Job, "_look_through", lambda self, longest_s: Found([]))
    monkeypatch.setattr(Job, "made", made)
    with pytest.raises(DamagedEpisodesError, match="half an episode"):
        job.do(Told())
    commands = reports.load(tmp_path / "out" / "report.json").commands
    assert [command.end for command in commands] == ["incomplete"]


def test_leftovers_of_the_dead_are_removed_and_never_those_of_the_living(tmp_path: Path):
    for name in (".e1.7.1.partial", ".e1_a03.7.2.partial", ".e2.7.1.partial", ".e1.8.1.partial"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "steps.h5").write_bytes(b"half")
    (tmp_path / "e1").mkdir()
    writer = os.open(tmp_path / ".e2.7.1.partial/.lock", os.O_RDWR | os.O_CREAT)
    fcntl.flock(writer, fcntl.LOCK_EX)  # as an episode's writer does
    assert remove_leftovers(tmp_path, "e1", 7) == [".e1.7.1.partial", ".e1_a03.7.2.partial"]
    assert remove_leftovers(tmp_path) == [".e1.8.1.partial"]
    os.close(writer)
    (tmp_path / ".report-0-of-2.json.7.1.partial").touch()
    assert remove_leftovers(tmp_path, folders_only=True) == [".e2.7.1.partial"], "for shards"
    assert remove_leftovers(tmp_path) == [".report-0-of-2.json.7.1.partial"]
    assert [path.name for path in tmp_path.iterdir()] == ["e1"]


def test_rejects_shards_of_different_counts_together(tmp_path: Path):
    with DatasetLock(tmp_path, 0, 2):
        with pytest.raises(IoError, match="as a shard of 2"), DatasetLock(tmp_path, 0, 3):
            pass
        with DatasetLock(tmp_path, 1, 2):
            pass
