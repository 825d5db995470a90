"""The N-th write, flush, rename ... fails or kills, N = 1, 2, ... until nothing is left to fail.

Whatever the instant: what was acknowledged is there, what is there is intact, an error names the
path, and writing again completes the dataset with the bytes of an undisturbed run.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import figures
import pytest
from ledger import IDS, Ending, contents, is_blank, require_sound, write

import robocell

# More calls than any program makes here: a sweep that gets there has lost its end.
FAR_TOO_MANY = 2000
PROGRAMS = ["write_ledger", "ffmpeg"]


@pytest.fixture(scope="module")
def calm(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What an undisturbed run writes."""
    dataset = tmp_path_factory.mktemp("calm")
    ending = write(dataset)
    assert ending.code == 0, ending.said
    assert ending.acknowledged == IDS
    return contents(dataset)


def sweep(dataset: Path, program: str, do: str) -> Iterator[Ending]:
    """One ending per instant, each in a dataset of its own, until the fault comes too late."""
    for at in range(1, FAR_TOO_MANY):
        shutil.rmtree(dataset, ignore_errors=True)
        dataset.mkdir()
        ending = write(dataset, program, at, do)
        if not ending.fault:
            assert at > 5, "the shim saw next to nothing: is it loaded?"
            figures.note("calls", program=program, do=do, times=at - 1)
            return
        yield ending
    raise AssertionError("the sweep has no end")


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize("do", ["fail", "full"])
def test_every_call_that_fails_is_reported_and_loses_nothing(
    do: str, program: str, tmp_path: Path, calm: dict[str, bytes]
):
    dataset = tmp_path / "dataset"
    for ending in sweep(dataset, program, do):
        assert ending.code == 3, f"{ending.fault} was swallowed: {ending.said}"
        assert str(dataset) in ending.message, f"{ending.fault}: {ending.said}"
        require_sound(dataset, ending)
        if not is_blank(dataset):
            assert robocell.verify(dataset).leftovers == [], f"{ending.fault} left a half episode"
        again = write(dataset)
        assert again.code == 0, f"after {ending.fault}: {again.said}"
        assert contents(dataset) == calm, f"after {ending.fault}"


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize("do", ["kill_before", "kill_after"])
def test_death_at_every_call_loses_nothing(
    do: str, program: str, tmp_path: Path, calm: dict[str, bytes]
):
    dataset = tmp_path / "dataset"
    for ending in sweep(dataset, program, do):
        assert ending.code == (-9 if program == "write_ledger" else 3), ending.said
        require_sound(dataset, ending)
        again = write(dataset)
        assert again.code == 0, f"after {ending.fault}: {again.said}"
        assert contents(dataset) == calm, f"after {ending.fault}"
