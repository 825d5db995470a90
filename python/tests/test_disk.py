"""Whether the disk of a dataset takes another episode, and what is said when not."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

import pytest

from robocell import _core
from robocell._durable import flush_path
from robocell._generation.disk import disk_trouble, require_writable
from robocell.data import remove_leftovers


def test_reports_why_a_folder_cannot_be_written(tmp_path: Path):
    assert disk_trouble(tmp_path) is None
    assert list(tmp_path.iterdir()) == []
    assert disk_trouble(tmp_path / "none") == (
        f"cannot write into '{tmp_path}/none': No such file or directory"
    )


def test_disk_probe_files_count_as_leftovers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Whoever is killed there leaves what the next command removes."""
    removed: list[str] = []
    monkeypatch.setattr(os, "fsync", lambda file: removed.extend(remove_leftovers(tmp_path)))
    assert disk_trouble(tmp_path) is None
    (name,) = removed
    assert re.fullmatch(rf"\.probe\.{os.getpid()}\.\d+\.partial", name)


def test_probe_files_of_a_process_with_the_same_id_do_not_collide(tmp_path: Path):
    """Containers that share a disk begin to count alike; one of them may have been killed."""
    number = int(_core.temporary_path(tmp_path, "probe").name.split(".")[3])
    taken = {f".probe.{os.getpid()}.{number + n}.partial" for n in range(1, 20)}
    for name in sorted(taken)[::2]:
        (tmp_path / name).touch()
    for name in sorted(taken)[1::2]:
        (tmp_path / name).mkdir()
    assert disk_trouble(tmp_path) is None
    require_writable(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == taken


@pytest.mark.parametrize("number", [errno.EINVAL, errno.ENOTSUP, errno.EIO])
def test_accepts_a_file_system_that_cannot_flush_folders(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def refuse(descriptor: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", refuse)
    if number != errno.EIO:
        flush_path(tmp_path)
        return
    with pytest.raises(OSError, match=f"cannot flush '{tmp_path}': Input/output error"):
        flush_path(tmp_path)
