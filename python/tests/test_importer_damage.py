"""Damaged datasets of other formats: an import says what is wrong, or makes a dataset in order."""

from __future__ import annotations

import random
import resource
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import foreign_datasets
import robocell
from robocell.importer import import_dataset

SECONDS = 30  # for one import; most take a tenth
MEMORY = 1 << 30  # bytes more than before
OF_EACH = 12  # ways to damage a dataset in `make test`; `make soak` tries all
ALIKE = {"lerobot_v2", "lerobot_v3", "aloha"}  # of files as others of these datasets have
LONGEST = 700  # characters of a message


@contextmanager
def bounded() -> Iterator[None]:
    def stop(number: int, frame: Any) -> None:
        raise TimeoutError(f"longer than {SECONDS} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        yield
        assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) << 10 < MEMORY
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def require_clean(source: Path, out: Path) -> bool:
    """Imports; returns False if the import was refused, with a message that names the place."""
    try:
        with bounded():
            result = import_dataset(source, out, rate=10 if list(source.glob("*.zarr")) else None)
    except (robocell.ArgumentError, robocell.IoError) as error:
        said = str(error)
        assert str(source) in said or "episode-" in said, said
        assert len(said) < LONGEST + 4 * len(str(source)), said
        assert not out.exists()
        return False
    assert result.rows > 0
    verified = robocell.data.verify(out, decode_videos=True)
    assert verified.ok, str(verified)
    return True


def tried(parent: Path, kind: str, number: int | None) -> None:
    """Tries ways to damage a dataset: some, chosen once and for all, or all of them."""
    whole = foreign_datasets.DATASETS[kind](parent / "whole")
    assert require_clean(whole, parent / "good")
    damages = foreign_datasets.damages(whole)
    names = sorted(damages)
    if number is not None:
        names = random.Random(kind).sample(names, number)
    failed, refusals = [], 0
    for at, name in enumerate(names):
        place = parent / str(at)
        there = Path(shutil.copytree(whole, place / "there"))
        damages[name](there)
        try:
            refusals += not require_clean(there, place / "back")
        except Exception as error:
            failed.append(f"{name}: {type(error).__name__}: {error}")
        shutil.rmtree(place)
    assert not failed, "\n".join([f"{len(failed)} of {len(names)}:", *failed])
    assert refusals > len(names) / 3


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=pytest.mark.proof if kind in ALIKE else ())
        for kind in foreign_datasets.DATASETS
    ],
)
def test_damaged_datasets_are_refused_or_imported_in_order(tmp_path: Path, kind: str):
    tried(tmp_path, kind, OF_EACH)


@pytest.mark.soak
@pytest.mark.parametrize("kind", foreign_datasets.DATASETS)
def test_every_damage_is_refused_or_imported_in_order(tmp_path: Path, kind: str):
    tried(tmp_path, kind, None)
