"""The hidden folder of a result: it stays where a command can continue, and nowhere else."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from robocell import ArgumentError, IoError
from robocell import _durable as durable
from robocell._staging import Staging, staging


def write_two(out: Path, request: dict[str, int], error: Exception) -> None:
    """Makes one episode, unless it is there, and fails at the next."""
    with staging(out, request) as place:
        if not place.has_episodes:
            place.path("e0").write_text("whole")
            place.keep("e0", 1)
        raise error


def fail(out: Path, error: BaseException) -> None:
    """Fails in the first episode."""
    with staging(out, {"of": 2}) as place:
        assert isinstance(place, Staging)
        assert not place.has_episodes
        place.path("data/half").touch()
        place.scratch("half").touch()
        raise error


def complete(out: Path, request: dict[str, int]) -> None:
    """Makes a part and the result."""
    with staging(out, request) as place:
        place.scratch("part").write_text("whole")
        place.keep("part", 1)
        place.commit()


@pytest.mark.parametrize("error", [ArgumentError("x"), IoError("x"), ZeroDivisionError("x")])
def test_a_refusal_before_the_first_episode_leaves_nothing(tmp_path: Path, error: Exception):
    with pytest.raises(type(error)):
        fail(tmp_path / "out", error)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("error", [OSError(28, "No space left"), KeyboardInterrupt()])
def test_a_full_disk_and_an_interrupt_leave_the_folder(tmp_path: Path, error: BaseException):
    with pytest.raises(type(error)):
        fail(tmp_path / "out", error)
    assert [path.name for path in tmp_path.iterdir()] == [".out.partial"]


def test_episodes_stay_for_the_command_that_continues(tmp_path: Path):
    for _ in range(2):  # the second one finds those of the first
        with pytest.raises(ArgumentError):
            write_two(tmp_path / "out", {"of": 1}, ArgumentError("e1 is refused"))
        assert (tmp_path / ".out.partial/e0").read_text() == "whole"
    with pytest.raises(ArgumentError):
        fail(tmp_path / "out", ArgumentError("another request has none of them"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("way", ["keep", "put"])
def test_what_was_written_is_on_the_disk_before_it_counts(
    way: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    flushed: list[Path] = []
    flush = durable.flush_path
    for module in ("_durable", "_staging"):
        monkeypatch.setattr(
            f"robocell.{module}.flush_path", lambda path: (flushed.append(path), flush(path))
        )
    with staging(tmp_path / "out", {}) as place:
        written = [place.path("data/deep/a"), place.scratch("b")]
        for path in written:
            path.write_text("whole")
        flushed.clear()
        if way == "keep":
            place.keep("a", 1)
        else:
            place.put(written[1], place.path("b"))
        folders = [place.folder / "data/deep", place.folder / "data", place.folder]
        assert {*written, *folders} <= set(flushed)
        flushed.clear()
        place.keep("more", 1)
        assert len(flushed) <= 2, "nothing is flushed twice but the name of what was put"
        place.commit()
        assert {tmp_path, place.folder, place.folder / "data/deep/a"} <= set(flushed)


def test_what_is_removed_halfway_is_not_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A kill may leave a value that says that a part is complete, and not the part."""
    remove = shutil.rmtree

    def killed(folder: Path, **options: bool) -> None:
        if Path(folder).name == ".state":
            (folder / "part").unlink(missing_ok=True)
            raise KeyboardInterrupt
        remove(folder, **options)

    monkeypatch.setattr(shutil, "rmtree", killed)
    for request in ({"of": 1}, {"of": 2}):  # at its end, and when another one begins
        with pytest.raises(KeyboardInterrupt):
            complete(tmp_path / "out", request)
    monkeypatch.undo()
    with staging(tmp_path / "out", {"of": 1}) as place:
        assert not place.has_episodes
        assert place.state("part") is None


def test_a_folder_of_another_process_stays(tmp_path: Path):
    with staging(tmp_path / "out", {}) as place:
        with (
            pytest.raises(ArgumentError, match="another process makes"),
            staging(tmp_path / "out", {}),
        ):
            pass
        place.path("e0").write_text("whole")
        place.commit()
    assert [path.name for path in tmp_path.rglob("*")] == ["out", "e0"]
