"""Datasets that are made from others: merged, split, filtered."""

from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import pytest
from robocell._core import json_damage

import robocell
from command_line import refused, robocell_command
from exported import hashes, three_episodes
from robocell._dataset_run import run_of_dataset
from robocell.data import derive
from robocell.data.derive import keep, merge, split


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def renamed(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset whose episodes have the ids of the others and are other recordings."""
    folder = tmp_path_factory.mktemp("others") / "others"
    shutil.copytree(dataset.folder, folder)
    for episode in robocell.Dataset(folder):
        change(episode.folder / "episode.json", lambda described: described["files"].pop("exo.mp4"))
        (episode.folder / "exo.mp4").unlink()
    return folder


def change(file: Path, edit: Any) -> None:
    described = json.loads(file.read_text())
    edit(described)
    described["cameras"].pop("exo", None)
    described["run"]["json_sha256"] = "0" * 64
    file.write_text(robocell._core.self_hashed_json(json.dumps(described, indent=2)))


def derived(folder: Path) -> Any:
    text = (folder / "dataset.json").read_text()
    assert json_damage(text) is None
    return json.loads(text)["derived"]


def intact(folder: Path) -> list[str]:
    result = robocell.data.verify(folder)
    assert not result.problems
    return list(result.good)


def test_a_merged_dataset_has_all_episodes_with_their_origin(
    dataset: robocell.Dataset, renamed: Path, tmp_path: Path
):
    out = tmp_path / "both"
    result = robocell_command("merge", dataset.folder, renamed, out)
    assert result.returncode == 0, result.stderr
    assert f"6 episodes of 2 datasets: {out}" in result.stdout
    assert "3 episodes renamed: dataset.json has their former ids" in result.stdout
    names = [f"others_{id}" for id in dataset.ids]
    assert intact(out) == sorted([*dataset.ids, *names])
    first, second = derived(out)["sources"]
    assert first["folder"] == str(dataset.folder.resolve())
    assert first["episodes"] == {id: id for id in dataset.ids}
    assert second["episodes"] == dict(zip(names, dataset.ids, strict=True))
    assert first["run"] == "tiny"
    for id in dataset.ids:
        one, other = robocell.Dataset(out)[id], robocell.Dataset(out)[f"others_{id}"]
        assert (one.folder / "steps.h5").samefile(dataset[id].folder / "steps.h5")
        assert other.metadata == dataset[id].metadata
        assert (one["reward"] == other["reward"]).all()
    assert robocell.data.verify_replay(robocell.Dataset(out)[names[0]]).ok


def test_a_recording_in_two_datasets_is_taken_once(dataset: robocell.Dataset, tmp_path: Path):
    half = tmp_path / "half"
    keep(dataset, "episode < 2", half)
    result = merge([half, dataset], tmp_path / "both")
    assert (result.episodes, result.of, result.renamed) == (3, 5, 0)
    assert intact(tmp_path / "both") == dataset.ids
    # Parts of one run are the run's dataset again.
    assert run_of_dataset(tmp_path / "both").run == "tiny"


def test_a_filtered_dataset_has_the_episodes_that_fit(dataset: robocell.Dataset, tmp_path: Path):
    lengths = {episode.id: len(episode) for episode in dataset}
    longest = max(lengths.values())
    condition = f"success and length < {longest}"
    listed = robocell_command("filter", dataset.folder, "--where", condition)
    assert listed.stdout.split() == [id for id, rows in lengths.items() if rows < longest]
    out = tmp_path / "short"
    result = robocell_command("filter", dataset.folder, out, "--where", condition)
    assert result.stdout == f"2 of 3 episodes: {out}\n"
    assert intact(out) == listed.stdout.split()
    assert derived(out)["where"] == condition
    used = {Path(path).parts[1] for each in robocell.Dataset(out) for path in each.models.values()}
    assert {path.name for path in (out / "models").iterdir()} == used


@pytest.mark.parametrize(
    ("condition", "told"),
    [
        ("lenght < 3", "episodes have no 'lenght'. Did you mean 'length'? They have: attempt, "),
        ("length < 3", "'length < 3' holds for none of the 3 episodes of"),
        ("length <", "the end instead of a number"),
        ("instruction contains 3", "'instruction' is a text and 3 is a number"),
    ],
)
def test_bad_conditions_are_named(
    dataset: robocell.Dataset, tmp_path: Path, condition: str, told: str
):
    assert told in refused("filter", dataset.folder, tmp_path / "out", "--where", condition)
    assert not list(tmp_path.iterdir())


def test_parts_of_a_split_have_every_episode_once(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "parts"
    result = robocell_command("split", dataset.folder, out, "--parts", "train=0.6,valid=0.4")
    assert result.returncode == 0, result.stderr
    train, valid = intact(out / "train"), intact(out / "valid")
    assert (len(train), len(valid)) == (2, 1)
    assert sorted([*train, *valid]) == dataset.ids
    again = split(dataset, {"train": 0.6, "valid": 0.4}, tmp_path / "again")
    assert intact(again["train"].folder) == train
    others = {
        tuple(derive._chosen(dataset, {"a": 0.6, "b": 0.4}, seed, None)["b"]) for seed in range(20)
    }
    assert len(others) == 3


def test_episodes_that_share_a_field_stay_together(dataset: robocell.Dataset):
    with pytest.raises(robocell.ArgumentError, match="has 1 value of 'scene' for 2 parts"):
        derive._chosen(dataset, {"a": 0.5, "b": 0.5}, 0, "scene")
    with pytest.raises(robocell.NotFoundError, match="Did you mean"):
        derive._chosen(dataset, {"a": 0.5, "b": 0.5}, 0, "scen")
    tasks = derive._chosen(dataset, {"a": 0.5, "b": 0.5}, 0, "task")
    assert sorted(len(ids) for ids in tasks.values()) == [1, 2]


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ("train=0.9", "a split has two or more parts"),
        ("train=0.9,valid=0.2", "the shares of train, valid sum to 1.1 instead of 1"),
        ("train=1.5,valid=-0.5", "the share of 'train' is 1.5; shares are between 0 and 1"),
        ("train,valid=0.5", "'train' is no part. Write name=share"),
        ("a=0.5,a=0.5", "'a' is given twice"),
        ("../a=0.5,b=0.5", "'../a' cannot be the name of a part"),
        ("a=0.98,b=0.01,c=0.01", "would be empty: dataset"),
    ],
)
def test_bad_parts_are_named(dataset: robocell.Dataset, tmp_path: Path, parts: str, told: str):
    assert told in refused("split", dataset.folder, tmp_path / "out", "--parts", parts)
    assert not list(tmp_path.iterdir())


def test_files_are_copied_on_request_and_where_links_are_impossible(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    result = keep(dataset, "success", tmp_path / "copied", copy=True)
    assert result.copied == 0
    steps = tmp_path / "copied" / dataset.ids[0] / "steps.h5"
    assert steps.stat().st_nlink == 1

    def refuse(*_: object) -> None:
        raise OSError(errno.EXDEV, "Invalid cross-device link")

    monkeypatch.setattr(os, "link", refuse)
    assert keep(dataset, "success", tmp_path / "far").copied > 15
    assert intact(tmp_path / "far") == dataset.ids


KILLED = """
    import os, signal
    from robocell.data import derive

    add, derive.BATCH = derive._add_file, 1

    def killed(source, to, copy):
        if {id!r} in str(source) and to.name == "steps.h5":
            os.kill(os.getpid(), signal.SIGKILL)
        return add(source, to, copy)

    derive._add_file = killed
    derive.merge([{dataset!r}, {other!r}], {out!r})
"""


def test_a_killed_merge_leaves_nothing_under_its_name_and_continues(
    dataset: robocell.Dataset, renamed: Path, tmp_path: Path
):
    out = tmp_path / "both"
    program = textwrap.dedent(KILLED).format(
        id=f"others/{dataset.ids[1]}",
        dataset=str(dataset.folder),
        other=str(renamed),
        out=str(out),
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    assert not out.exists()
    kept = tmp_path / ".both.partial" / dataset.ids[0]
    inode = kept.stat().st_ino
    merge([dataset, renamed], out)
    assert (out / dataset.ids[0]).stat().st_ino == inode  # it was not made again
    assert [path.name for path in tmp_path.iterdir()] == ["both"]
    merge([dataset, renamed], tmp_path / "whole" / "both")
    assert hashes(out) == hashes(tmp_path / "whole" / "both")


def test_a_merge_does_not_continue_with_another_recording_of_the_same_id(
    dataset: robocell.Dataset, tmp_path: Path
):
    source, out = tmp_path / "source", tmp_path / "out"
    shutil.copytree(dataset.folder, source)

    def stop(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        merge([source], out, on_episodes=stop)
    episode = source / dataset.ids[0]
    change(episode / "episode.json", lambda described: described["files"].pop("exo.mp4"))
    (episode / "exo.mp4").unlink()
    merge([source], out)
    assert hashes(out / dataset.ids[0]) == hashes(episode)


def test_the_command_says_how_many_datasets_were_merged(dataset: robocell.Dataset, tmp_path: Path):
    said = robocell_command("merge", dataset.folder, tmp_path / "out").stdout
    assert "3 episodes of 1 dataset:" in said


def test_what_cannot_be_merged_is_named(dataset: robocell.Dataset, tmp_path: Path):
    folder = dataset.folder
    assert "is given twice" in refused("merge", folder, folder, tmp_path / "out")
    assert "is inside the dataset" in refused("merge", folder, folder / "out")
    assert "no dataset" in refused("merge", folder, tmp_path / "none", tmp_path / "out")
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine").touch()
    assert "exists already, a folder that is not empty" in refused("merge", folder, out)
    assert [path.name for path in tmp_path.rglob("*")] == ["out", "mine"]


def test_models_of_an_extended_dataset_are_on_the_disk(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    flushed: list[tuple[Path, list[str]]] = []
    monkeypatch.setattr(
        derive, "flush_path", lambda path: flushed.append((path, sorted(os.listdir(path))))
    )
    folder = tmp_path / "out"
    folder.mkdir()
    derive.extend(folder, [(dataset, "a")], {})
    assert flushed[-1] == (folder / "models", sorted(os.listdir(folder / "models")))
