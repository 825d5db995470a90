"""A write, flush, rename ... fails or kills: chosen ones in `make test`, every one in `make soak`.

There it is the N-th, N = 1, 2, ... until nothing is left to fail; here one where it hurts most.
Whatever the instant: what was acknowledged is there, what is there is intact, an error names the
path, and writing again completes the dataset with the bytes of an undisturbed run.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path

import figures
import pytest
from disks import quick_folder
from ledger import HARMLESS, Ending, is_blank, require_sound, write

import robocell
from contents import contents

# More calls than any program makes here: a sweep that gets there has lost its end.
FAR_TOO_MANY = 2000
Contents = dict[tuple[str, ...], dict[str, bytes]]


@dataclass(frozen=True)
class Case:
    """Who meets the fault, and when.

    Attributes:
        program: The one whose calls fail.
        before: Episodes that are there before.
        kinds: Those that there are to be.
        points: Calls where it hurts most: a sweep that misses one proves less than it says.
    """

    program: str
    before: tuple[str, ...]
    kinds: tuple[str, ...]
    points: tuple[str, ...]


# A program that dies from the creation of the lock on holds it.
PLAIN = Case(
    "write_ledger",
    before=(),
    kinds=("plain", "plain"),
    points=(
        "create .dataset.json.*",
        "write .dataset.json.*",
        "fsync .dataset.json.*",
        "rename dataset.json",
        "create .lock",
        "mkdir models",
        "mkdir models/.rc7-*",
        "write models/.rc7-*/.rc7.xml.*",
        "rename models/.rc7-*/SHA256SUMS",
        "fsync models/.rc7-*",
        "rename models/rc7-*",
        "fsync models",
        "mkdir .e0.*",
        "create .e0.*/steps.h5",
        "pwrite .e0.*/steps.h5",
        "write .e0.*/notes.txt",
        "create .e0.*/episode.json",
        "write .e0.*/episode.json",
        "fsync .e0.*/episode.json",
        "fsync .e0.*/notes.txt",
        "fsync .e0.*/steps.h5",
        "fsync .e0.*",
        "rename e0",
        "fsync .",
        "rename e1",
    ),
)
FILMED = Case(
    "write_ledger",
    before=("plain",),
    kinds=("plain", "filmed"),
    points=(
        "create .e1.*/.wrist.mp4.*",
        "rename .e1.*/wrist.mp4",
        "rename .e1.*/wrist.depth.mov",
        "fsync .e1.*/wrist.depth.mov",
        "rename e1",
    ),
)
ENCODER = Case(
    "ffmpeg",
    before=("plain",),
    kinds=("plain", "filmed"),
    points=(
        "create .e1.*/.wrist.mp4.*",
        "write .e1.*/.wrist.mp4.*",
    ),
)
# Both encoders meet a numbered call at once; only a named one distinguishes them.
DEPTH = replace(ENCODER, points=("write .e1.*/.wrist.depth.mov.*",))


def at_points(dataset: Path, case: Case, do: str) -> Iterator[Ending]:
    """One ending per point, each in a dataset of its own."""
    for point in case.points:
        call, path = point.split()
        ending = fault(dataset, case, f"{call} {dataset / path}", do)
        assert fnmatch(ending.fault, point), f"{point} was not met: {ending.said}"
        yield ending
    figures.note("calls", program=case.program, do=do, times=len(case.points))


def everywhere(dataset: Path, case: Case, do: str) -> Iterator[Ending]:
    """One ending per call, until the fault comes too late."""
    seen: list[str] = []
    for number in range(1, FAR_TOO_MANY):
        ending = fault(dataset, case, number, do)
        if not ending.fault:
            for point in case.points:
                assert any(fnmatch(met, point) for met in seen), f"{point} was not met: {seen}"
            figures.note("calls", program=case.program, do=do, times=number - 1)
            return
        seen.append(ending.fault)
        yield ending
    raise AssertionError("the sweep has no end")


def fault(dataset: Path, case: Case, at: int | str, do: str) -> Ending:
    shutil.rmtree(dataset, ignore_errors=True)
    before = dataset.parent / "before"
    if not before.exists():
        before.mkdir()
        assert not case.before or write(before, case.before).code == 0
    shutil.copytree(before, dataset)
    return write(dataset, case.kinds, case.program, at, do)


@pytest.fixture
def dataset(tmp_path: Path) -> Iterator[Path]:
    with quick_folder(tmp_path) as folder:
        yield folder / "dataset"


@pytest.fixture(scope="module")
def calm(tmp_path_factory: pytest.TempPathFactory) -> Contents:
    """What an undisturbed run writes, by its episodes."""
    calm = {}
    for case in (PLAIN, FILMED):
        dataset = tmp_path_factory.mktemp("calm")
        ending = write(dataset, case.kinds)
        assert ending.code == 0, ending.said
        assert ending.acknowledged == ["e0", "e1"]
        calm[case.kinds] = contents(dataset)
    return calm


# Every call is hundreds of runs: for `make soak`. Both encoders make a numbered call.
CASES = [
    pytest.param(PLAIN, at_points, id="plain"),
    pytest.param(FILMED, at_points, id="filmed"),
    pytest.param(ENCODER, at_points, id="encoder"),
    pytest.param(DEPTH, at_points, id="depth"),
    pytest.param(PLAIN, everywhere, id="plain, every call", marks=pytest.mark.soak),
    pytest.param(FILMED, everywhere, id="filmed, every call", marks=pytest.mark.soak),
    pytest.param(ENCODER, everywhere, id="encoder, every call", marks=pytest.mark.soak),
]
Endings = Callable[[Path, Case, str], Iterator[Ending]]


def require_completed(ending: Ending, case: Case, calm: Contents) -> None:
    """Writing again makes the missing episodes."""
    again = write(ending.dataset, case.kinds)
    assert again.code == 0, f"after {ending.fault}: {again.said}"
    assert contents(ending.dataset) == calm[case.kinds], f"after {ending.fault}"


@pytest.mark.parametrize(("case", "endings"), CASES)
@pytest.mark.parametrize("do", ["fail", pytest.param("full", marks=pytest.mark.proof)])
def test_a_call_that_fails_is_reported_and_loses_nothing(
    do: str, case: Case, endings: Endings, dataset: Path, calm: Contents
):
    for ending in endings(dataset, case, do):
        require_sound(dataset, ending)
        if do == "fail" and ending.fault == HARMLESS:
            assert ending.code == 0, ending.said
            continue
        assert ending.code == 3, f"{ending.fault} was swallowed: {ending.said}"
        assert str(dataset) in ending.message, f"{ending.fault}: {ending.said}"
        if do == "full":
            hint = "bytes are needed" if ending.is_write else "free there"
            assert hint in ending.message, f"{ending.fault}: {ending.said}"
        if not is_blank(dataset):
            assert robocell.data.verify(dataset).leftovers == [], (
                f"{ending.fault} left a half episode"
            )
        require_completed(ending, case, calm)


@pytest.mark.parametrize(("case", "endings"), CASES)
@pytest.mark.parametrize("do", ["kill_before", pytest.param("kill_after", marks=pytest.mark.proof)])
def test_death_at_a_call_loses_nothing(
    do: str, case: Case, endings: Endings, dataset: Path, calm: Contents
):
    for ending in endings(dataset, case, do):
        assert ending.code == (3 if case.program == "ffmpeg" else -9), ending.said
        require_sound(dataset, ending)
        require_completed(ending, case, calm)
