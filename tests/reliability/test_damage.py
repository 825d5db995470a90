"""Damage on the disk: it is named, moved aside, and exactly what is missing is made again."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import figures
import pytest
from storm import Storm

import robocell

EPISODES = 3


def flip_a_bit(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 0x10
    file.write_bytes(content)


def truncate(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])


def empty(file: Path) -> None:
    file.write_bytes(b"")


def remove(file: Path) -> None:
    file.unlink()


@pytest.fixture(scope="module")
def calm(tmp_path_factory: pytest.TempPathFactory) -> Storm:
    calm = Storm(tmp_path_factory.mktemp("calm"), EPISODES)
    calm.finish()
    return calm


def robocell_command(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "robocell", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize("name", ["steps.h5", "wrist.mp4", "episode.json"])
@pytest.mark.parametrize("damage", [flip_a_bit, truncate, empty, remove])
def test_damage_is_named_set_aside_and_made_good(
    damage: Callable[[Path], None], name: str, tmp_path: Path, calm: Storm
):
    storm = Storm(tmp_path, EPISODES)
    shutil.copytree(calm.dataset, storm.dataset)
    victim, *others = robocell.Dataset(storm.dataset).ids
    damage(storm.dataset / victim / name)

    report = robocell.verify(storm.dataset)
    assert not report.ok
    assert victim in str(report)
    assert name in str(report)
    assert report.good == others, "the others stay readable"
    found = robocell_command("verify", storm.dataset)
    assert found.returncode != 0
    assert victim in found.stdout + found.stderr

    repaired = robocell_command("verify", "--repair", storm.dataset)
    assert robocell.verify(storm.dataset).ok, repaired.stdout + repaired.stderr
    assert (storm.dataset / ".quarantine").is_dir(), "nothing is deleted"
    storm.finish()
    assert storm.contents() == calm.contents()


def flip_bit(content: bytes, at: int) -> bytes:
    return content[:at] + bytes([content[at] ^ 1 << at % 8]) + content[at + 1 :]


def cut(content: bytes, at: int) -> bytes:
    return content[:at]


@pytest.mark.soak
@pytest.mark.parametrize("damage", [flip_bit, cut])
def test_damage_at_every_hundredth_of_every_file_is_named(
    damage: Callable[[bytes, int], bytes], tmp_path: Path, calm: Storm
):
    dataset = shutil.copytree(calm.dataset, tmp_path / "out")
    victim, *others = robocell.Dataset(dataset).ids
    for file in sorted((dataset / victim).iterdir()):
        whole = file.read_bytes()
        for part in range(100):
            file.write_bytes(damage(whole, len(whole) * part // 100))
            report = robocell.verify(dataset)
            assert report.good == others, f"{file.name}, {part} %"
            assert f"{victim}/{file.name}" in str(report), f"{file.name}, {part} %"
        file.write_bytes(whole)
        figures.note("damage", file=file.name, how=damage.__name__, times=100)
    assert robocell.verify(dataset).ok
