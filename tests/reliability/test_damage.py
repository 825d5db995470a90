"""Damage on the disk: it is named, moved aside, and exactly the missing episodes are made again."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import figures
import pytest
from disks import quick_folder
from storm import Storm, marks

import robocell
from command_line import robocell_command

OF_AN_EPISODE = ["steps.h5", "wrist.mp4", "wrist.depth.mov", "episode.json"]
OF_THE_DATASET = ["dataset.json", "report.json"]
OF_A_MODEL = ["models/rc7-*/rc7.xml", "models/rc7-*/SHA256SUMS"]
MOVED_ALONE = [*OF_THE_DATASET, OF_A_MODEL[1]]  # a model's list is written again
FEW = 2  # episodes are enough to damage one of them
EVERY = [*OF_AN_EPISODE, *OF_THE_DATASET, *OF_A_MODEL]


def flip_bit(content: bytes, at: int) -> bytes:
    return content[:at] + bytes([content[at] ^ 1 << at % 8]) + content[at + 1 :]


def cut(content: bytes, at: int) -> bytes:
    return content[:at]


Damage = Callable[[bytes, int], bytes]


def damage_at(file: Path, damage: Damage, percent: int) -> None:
    whole = file.read_bytes()
    file.write_bytes(damage(whole, len(whole) * percent // 100))


class Victim:
    """One file of a copy of the dataset's first episodes.

    Attributes:
        dataset: The copy.
        file: The one.
        name: How `verify` calls it.
        part: What `repair` moves because of it: the episode, the model, or the file itself.
        others: The episodes that have nothing to do with it.
    """

    def __init__(self, calm: Storm, folder: Path, kind: str) -> None:
        self._calm = calm
        self._kind = kind
        self.dataset = folder / "out"
        self.fresh()
        ids = robocell.Dataset(self.dataset).ids
        episode = ids[1] if kind in OF_AN_EPISODE else None
        self.file = next(self.dataset.glob(f"{episode}/{kind}" if episode else kind))
        self.name = str(self.file.relative_to(self.dataset))
        self.part = self.file.name if kind in MOVED_ALONE else self.file.parent.name
        self.others = [name for name in ids if name != episode]

    def fresh(self) -> None:
        """Everything is as it was."""
        shutil.rmtree(self.dataset, ignore_errors=True)
        rest = robocell.Dataset(self._calm.dataset).ids[FEW:]
        if self._kind != "report.json":
            rest.append("report.json")  # it knows of all of them
        shutil.copytree(self._calm.dataset, self.dataset, ignore=shutil.ignore_patterns(*rest))


def require_named_and_set_aside(victim: Victim, where: str) -> None:
    result = robocell.data.verify(victim.dataset)
    assert [str(problem).startswith(f"{victim.name}: ") for problem in result.problems] == [True], (
        f"{where}: {result}"
    )
    assert result.good == victim.others, f"{where}: the others stay readable"
    assert robocell.data.repair(victim.dataset).moved == [victim.part], where
    assert (victim.dataset / ".quarantine" / victim.part).exists(), f"{where}: nothing is deleted"
    after = robocell.data.verify(victim.dataset)
    assert after.good == victim.others, f"{where}: {after}"
    missing = [problem for problem in after.problems if "it is missing" in problem.reason]
    assert after.problems == missing, f"{where}: {after}"
    assert after.ok or "models/" in victim.name, "a model is needed, not to read but to replay"


@pytest.mark.parametrize("kind", EVERY)
@pytest.mark.parametrize("damage", [flip_bit, pytest.param(cut, marks=pytest.mark.proof)])
@pytest.mark.parametrize(
    "step",
    [50, pytest.param(20, marks=pytest.mark.proof), pytest.param(1, marks=pytest.mark.soak)],
)
def test_damage_anywhere_is_reported_and_quarantined(
    step: int, damage: Damage, kind: str, tmp_path: Path, calm: Storm
):
    with quick_folder(tmp_path) as folder:
        victim = Victim(calm, folder, kind)
        for percent in range(0, 100, step):
            victim.fresh()
            damage_at(victim.file, damage, percent)
            require_named_and_set_aside(victim, f"{kind}, {percent} %")
    times = len(range(0, 100, step))
    figures.note("damage", file=Path(kind).name, how=damage.__name__, times=times)


@pytest.mark.parametrize("kind", [*OF_AN_EPISODE, *OF_A_MODEL[:1]])
def test_a_missing_file_is_reported_and_the_rest_is_quarantined(
    kind: str, tmp_path: Path, calm: Storm
):
    victim = Victim(calm, tmp_path, kind)
    victim.file.unlink()
    require_named_and_set_aside(victim, kind)


def test_only_quarantined_episodes_are_generated_again(tmp_path: Path, calm: Storm):
    storm = Storm(tmp_path)
    shutil.copytree(calm.dataset, storm.dataset)
    ids = robocell.Dataset(storm.dataset).ids
    files = [f"{ids[number]}/{name}" for number, name in enumerate(OF_AN_EPISODE)]
    victims = [next(storm.dataset.glob(name)) for name in [*files, *OF_THE_DATASET, *OF_A_MODEL]]
    for number, file in enumerate(victims):
        damage_at(file, [flip_bit, cut][number % 2], 10 * number)

    found = robocell_command("verify", storm.dataset)
    assert found.returncode == 1
    for file in victims:
        assert file.name in found.stdout or "models/" in str(file)
    repaired = robocell_command("verify", "--repair", storm.dataset)
    assert "moved aside: " in repaired.stdout
    assert robocell.Dataset(storm.dataset).ids == ids[len(files) :]

    before = marks(storm)
    storm.finish()
    assert before.items() <= marks(storm).items(), "what was whole was not written again"
    assert len(storm.acknowledged) == len(files)
    assert robocell.data.verify(storm.dataset, decode_videos=True).ok
    assert storm.contents() == calm.contents()


def test_a_damaged_run_file_is_rejected_or_gives_the_same_episodes(tmp_path: Path, calm: Storm):
    file = tmp_path / "run.yaml"
    whole = (calm.folder / "run.yaml").read_bytes()
    same, refused = robocell.RunConfig.load(calm.folder / "run.yaml"), 0
    for damage in (flip_bit, cut):
        for at in range(0, len(whole), max(1, len(whole) // 100)):
            file.write_bytes(damage(whole, at))
            try:
                run = robocell.RunConfig.load(file)
                run.output = str(calm.dataset)
                robocell.generate.validate_dataset(run)
            except robocell.Error:
                refused += 1
            else:
                assert robocell.generate.run_identity(run) == robocell.generate.run_identity(
                    same
                ), (damage, at)
    assert refused > 0
    assert robocell.data.verify(calm.dataset).ok
