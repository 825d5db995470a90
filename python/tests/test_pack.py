"""Packed datasets: the same bytes again, complete or absent, and damage is named."""

from __future__ import annotations

import hashlib
import json
import pickle
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

import robocell
from command_line import REPOSITORY
from exported import hashes, three_episodes
from robocell import _durable as durable
from robocell._cli.common import is_dataset
from robocell._cli.pack import pack as pack_command
from robocell._cli.unpack import unpack as unpack_command
from robocell._cli.verify import verify as verify_command
from robocell._dataset_run import manifest_of_dataset
from robocell._generation.run_source import RunSource
from robocell._policy_calls import PolicyCalls, error_of
from robocell._stored_files import read_stored
from robocell.data import pack as packing
from robocell.data.derive import keep, merge, split
from robocell.data.pack import is_packed, pack, read_packed, unpack
from robocell.export import export_dataset


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def packed(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One shard for every episode."""
    out = tmp_path_factory.mktemp("packed") / "out"
    result = pack(dataset.folder, out, shard_bytes=1)
    assert (result.episodes, result.folder) == (3, out)
    assert result.shards == 3
    return out


def visible(folder: Path) -> dict[str, str]:
    """Hashes of the files of a dataset, without its locks and logs."""
    return {name: h for name, h in hashes(folder).items() if not name.startswith(".")}


def test_an_unpacked_dataset_has_the_same_bytes(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    result = unpack(packed, tmp_path / "again")
    assert visible(tmp_path / "again") == visible(Path(dataset.folder))
    assert result.files == len(visible(Path(dataset.folder)))
    assert robocell.data.verify(tmp_path / "again").ok
    assert robocell.data.verify_replay(robocell.Dataset(tmp_path / "again")[0]).ok


def test_shards_are_zip_files_with_an_index(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    stored = visible(Path(dataset.folder))
    seen: set[str] = set()
    index = json.loads((packed / "packed.json").read_text())
    for shard in index["shards"]:
        with zipfile.ZipFile(packed / shard["file"]) as file:
            assert file.testzip() is None
            assert set(file.namelist()) == set(shard["files"])
        content = (packed / shard["file"]).read_bytes()
        assert len(content) == shard["bytes"]
        for name, facts in shard["files"].items():
            begin = facts["offset"]
            own = (Path(dataset.folder) / name).read_bytes()
            assert content[begin : begin + facts["bytes"]] == own
        seen |= set(shard["files"])
    for name in index["files"]:  # simulators open models by their paths
        assert (packed / name).read_bytes() == (Path(dataset.folder) / name).read_bytes()
    assert seen | set(index["files"]) == set(stored)
    assert {"dataset.json", "models"} <= {name.split("/")[0] for name in index["files"]}
    whole = pack(Path(dataset.folder), tmp_path / "whole")
    assert whole.shards == 1
    again = pack(dataset.folder, tmp_path / "again", shard_bytes=1)
    assert hashes(again.folder) == hashes(packed), "the same files give the same shards"


def test_a_packed_dataset_is_read_as_any_other(
    dataset: robocell.Dataset, packed: Path, monkeypatch: pytest.MonkeyPatch
):
    opened = robocell.Dataset(packed)
    assert opened.ids == dataset.ids
    assert not opened.broken
    for one, other in zip(opened, dataset, strict=True):
        assert one.json == other.json
        for name in other.columns:
            assert np.array_equal(one[name], other[name]), name
        for camera in other.cameras:
            assert np.array_equal(one.frames(camera), other.frames(camera))
            assert np.array_equal(one.frame(camera, 3), other.frame(camera, 3))
    assert robocell.data.verify_replay(opened[1]).ok
    assert pickle.loads(pickle.dumps(opened[0])).json == dataset[0].json
    monkeypatch.chdir(packed)
    assert robocell.Dataset(".")[0].json == dataset[0].json
    with pytest.raises(robocell.NotFoundError, match=r"no episode 's9'"):
        opened["s9"]
    result = robocell.data.verify(packed, decode_videos=True)
    assert (result.ok, result.good, result.others) == (True, dataset.ids, [])
    from robocell._web.episode_page import EpisodePage

    page = EpisodePage(opened[0])
    assert page.video("exo") == (Path(dataset.folder) / dataset.ids[0] / "exo.mp4").read_bytes()


@pytest.mark.parametrize("format", ["lerobot-v3", "robomimic"])
def test_exports_of_a_packed_dataset_are_those_of_the_dataset(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path, format: str
):
    """One copies the videos as they are, the other decodes them."""
    for name, source in (("own", dataset.folder), ("packed", packed)):
        export_dataset(source, tmp_path / name, format)
    own, other = hashes(tmp_path / "own"), hashes(tmp_path / "packed")
    for each in (own, other):
        each.pop("README.md", None)  # names the dataset
    assert own == other


def test_datasets_are_made_from_packed_ones(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    merged = merge([packed, tmp_path_of_copy(dataset, tmp_path)], tmp_path / "merged")
    files = sum(len(each.files) + 1 for each in dataset)
    assert (merged.episodes, merged.copied) == (3, files), "bytes of a shard cannot be linked"
    first = dataset.ids[0]
    kept = keep(packed, f'id == "{first}"', tmp_path / "kept")
    parts = split(packed, {"a": 0.5, "b": 0.5}, tmp_path / "parts")
    for folder, ids in (
        (tmp_path / "merged", dataset.ids),
        (kept.folder, [first]),
        *((part.folder, robocell.Dataset(part.folder).ids) for part in parts.values()),
    ):
        result = robocell.data.verify(folder)
        assert (result.ok, result.good) == (True, ids)
    name = f"{first}/steps.h5"
    assert (kept.folder / name).read_bytes() == (Path(dataset.folder) / name).read_bytes()


def tmp_path_of_copy(dataset: robocell.Dataset, tmp_path: Path) -> Path:
    shutil.copytree(dataset.folder, tmp_path / "copy")
    return tmp_path / "copy"


def test_sources_of_augmented_runs_may_be_packed(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    output = f"output={tmp_path / 'augmented'}"
    run = RunSource(str(packed), augment=str(packed)).load([output])
    robocell.generate.prepare_dataset(run)
    stored = json.loads((tmp_path / "augmented/dataset.json").read_text())
    own = hashlib.sha256((Path(dataset.folder) / dataset.ids[0] / "episode.json").read_bytes())
    assert own.hexdigest() in json.dumps(stored), "the hash of a source"
    assert is_dataset(packed)


def test_shards_that_were_unzipped_in_place_do_not_count(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    """Any zip program unpacks them; the index says what is in the dataset."""
    copy = tmp_path / "copy"
    shutil.copytree(packed, copy)
    for shard in copy.glob("*.zip"):
        with zipfile.ZipFile(shard) as file:
            file.extractall(copy)
    for steps in copy.glob("*/steps.h5"):
        steps.write_bytes(b"edited")
    result = robocell.data.verify(copy)
    assert (result.problems, result.good, result.others) == ([], dataset.ids, dataset.ids)
    for one, other in zip(robocell.Dataset(copy), dataset, strict=True):
        assert np.array_equal(one["time"], other["time"])
    merged = merge([copy], tmp_path / "merged").folder
    assert robocell.data.verify(merged).good == dataset.ids


def test_packed_datasets_are_not_written_into(
    dataset: robocell.Dataset, packed: Path, tmp_path: Path
):
    before = hashes(packed)
    run = robocell.RunConfig.load(REPOSITORY / "examples" / "demo.yaml")
    run.output = str(packed)
    recording = tmp_path / "recording"  # of no run
    shutil.copytree(packed, recording)
    (recording / "dataset.json").unlink()
    columns = {"time": robocell.data.ColumnSpec("float64")}
    for action in (
        lambda: robocell.generate.prepare_dataset(run),
        lambda: robocell.data.repair(packed),
        lambda: robocell.data.DatasetLock(packed).__enter__(),
        lambda: robocell.data.EpisodeWriter(recording, "mine", columns),
        lambda: pack(packed, tmp_path / "out"),
    ):
        with pytest.raises(robocell.ArgumentError, match=r"packed.*`robocell unpack .* OUT`"):
            action()
    assert hashes(packed) == before


def test_one_file_of_an_episode_is_read_alone(dataset: robocell.Dataset, packed: Path):
    id = dataset.ids[1]
    assert read_packed(packed, id) == (Path(dataset.folder) / id / "episode.json").read_bytes()
    assert read_packed(packed, id, "exo.mp4")[4:8] == b"ftyp"
    with pytest.raises(robocell.ArgumentError, match=r"has no 's9/episode\.json'; 'packed\.json'"):
        read_packed(packed, "s9")


def flip(file: Path, at: int) -> None:
    content = bytearray(file.read_bytes())
    content[at] ^= 1
    file.write_bytes(content)


def test_damage_is_found_and_named(packed: Path, tmp_path: Path, capsys: Any):
    broken = tmp_path / "broken"
    shutil.copytree(packed, broken)
    index = json.loads((packed / "packed.json").read_text())
    ids = index["episodes"]
    first, second, third = index["shards"]

    def problems() -> list[str]:
        return [str(each) for each in robocell.data.verify(broken).problems]

    name = f"{ids[0]}/steps.h5"
    flip(broken / first["file"], first["files"][name]["offset"] + 100)
    assert problems() == [f"{name}: its hash does not match its bytes"]
    with pytest.raises(robocell.IoError, match=r"steps\.h5' is damaged.*unpack --skip-damaged"):
        robocell.Dataset(broken)[0]["time"]
    for action in (
        lambda: unpack(broken, tmp_path / "out"),
        lambda: read_packed(broken, *name.split("/")),
    ):
        with pytest.raises(robocell.IoError, match="its hash does not match"):
            action()
    assert not (tmp_path / "out").exists()
    flip(broken / second["file"], 1)  # of the zip file's own bytes
    model = next(each for each in index["files"] if each.startswith("models/"))
    flip(broken / model, -1)
    assert problems() == [
        f"{name}: its hash does not match its bytes",
        f"{second['file']}: the zip file's own tables are damaged; its episodes are read without "
        "them",
        f"{model}: its hash does not match its bytes",
    ]
    flip(broken / model, -1)
    (broken / third["file"]).unlink()
    found = problems()
    assert f"{third['file']}: it is missing" in found
    assert any(each.startswith(f"{ids[2]}/episode.json: it is missing") for each in found)
    with pytest.raises(typer.Exit):
        verify_command(broken)
    assert "robocell unpack --skip-damaged" in capsys.readouterr().out
    result = unpack(broken, tmp_path / "rest", skip_damaged=True)
    assert (result.episodes, result.skipped) == (1, (ids[0], ids[2]))
    assert robocell.data.verify(tmp_path / "rest").good == [ids[1]]
    flip(broken / "packed.json", 40)
    with pytest.raises(robocell.IoError, match=r"packed\.json' is damaged: its hash"):
        robocell.Dataset(broken)


def test_files_of_no_episode_are_left_out_if_damaged(
    dataset: robocell.Dataset, tmp_path: Path, capsys: Any
):
    source, broken = tmp_path / "source", tmp_path / "broken"
    shutil.copytree(dataset.folder, source)
    (source / "policy_calls").mkdir()
    (source / "policy_calls/a.json").write_text("{}")
    (source / "policy_calls/b.json").write_text("{}")
    (source / "models/.unfinished").mkdir()
    (source / "models/.unfinished/arm.xml").touch()
    pack(source, broken, shard_bytes=1)
    index = json.loads((broken / "packed.json").read_text())
    assert not [name for name in index["files"] if "unfinished" in name]
    shard = next(each for each in index["shards"] if "policy_calls/a.json" in each["files"])
    flip(broken / shard["file"], shard["files"]["policy_calls/a.json"]["offset"])
    model = next(name for name in index["files"] if name.startswith("models/"))
    flip(broken / model, -1)
    flip(broken / "dataset.json", 30)
    with pytest.raises(robocell.IoError, match=r"dataset\.json' is damaged.*Copy it again"):
        manifest_of_dataset(broken)
    model = "/".join(model.split("/")[:2])
    unpack_command(broken, tmp_path / "rest", skip_damaged=True)
    told = capsys.readouterr().out
    left_out = ("dataset.json", model, "policy_calls/a.json")
    assert told.startswith("".join(f"damaged, left out: {name}\n" for name in left_out))
    rest, own = hashes(tmp_path / "rest"), hashes(Path(dataset.folder))
    assert f"3 episodes, {len(rest)} files: " in told
    expected = {name: own[name] for name in visible(Path(dataset.folder))}
    expected = {n: h for n, h in expected.items() if n not in left_out and not n.startswith(model)}
    assert {name: rest[name] for name in rest if not name.startswith("policy")} == expected
    assert (tmp_path / "rest/policy_calls/b.json").read_text() == "{}"
    assert robocell.data.verify(tmp_path / "rest").good == dataset.ids


def test_advice_to_write_into_a_packed_dataset_begins_with_unpack(packed: Path, tmp_path: Path):
    shutil.copytree(packed, tmp_path / "copy")
    shutil.rmtree(tmp_path / "copy/models")
    told = [str(each) for each in robocell.data.verify(tmp_path / "copy").problems]
    advice = "not replayed. After `robocell unpack`, `robocell generate` with the run's file"
    assert any(advice in each for each in told)


def test_a_file_in_a_shard_that_is_cut_short_is_an_error(packed: Path, tmp_path: Path):
    cut = tmp_path / "cut"
    shutil.copytree(packed, cut)
    shard = json.loads((cut / "packed.json").read_text())["shards"][0]
    name = next(name for name in shard["files"] if name.endswith(".mp4"))
    with (cut / shard["file"]).open("r+b") as file:
        file.truncate(shard["files"][name]["offset"] + 9)
    with pytest.raises(OSError, match=r"shard-00000\.zip' is cut short"):
        read_stored(cut / name)


def test_calls_of_a_policy_are_read_from_a_packed_evaluation(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    flushed: list[Path] = []
    monkeypatch.setattr("robocell._policy_calls.flush_path", flushed.append)
    source = tmp_path / "source"
    shutil.copytree(dataset.folder, source)
    for rollout in dataset.ids:
        PolicyCalls(rollout, error=f"of {rollout}").save(source)
    assert flushed == [source], "the entry of the new folder"
    pack(source, tmp_path / "packed")
    assert [error_of(tmp_path / "packed", id) for id in dataset.ids] == [
        f"of {id}" for id in dataset.ids
    ]


def test_a_damaged_source_is_not_packed(dataset: robocell.Dataset, tmp_path: Path):
    source = tmp_path / "source"
    shutil.copytree(Path(dataset.folder), source)
    file = source / dataset.ids[2] / "exo.mp4"
    content = bytearray(file.read_bytes())
    content[-1] ^= 1
    file.write_bytes(content)
    with pytest.raises(robocell.IoError, match=r"exo\.mp4' is damaged: its hash does not match"):
        pack(source, tmp_path / "out")
    file.unlink()
    with pytest.raises(robocell.IoError, match=r"exo\.mp4': No such file"):
        pack(source, tmp_path / "out")
    assert not list(tmp_path.glob("*out*"))


@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_killed_command_leaves_nothing_and_continues(
    dataset: robocell.Dataset,
    packed: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    at: int,
):
    write = packing._write_shard
    written: list[str] = []

    def killed(place: Any, name: str, units: Any) -> dict[str, Any]:
        if len(written) == at:
            raise KeyboardInterrupt
        written.append(name)
        return write(place, name, units)

    monkeypatch.setattr(packing, "_write_shard", killed)
    with pytest.raises(KeyboardInterrupt):
        pack(dataset.folder, tmp_path / "out", shard_bytes=1)
    assert not (tmp_path / "out").exists()
    before, at = list(written), 99
    pack(dataset.folder, tmp_path / "out", shard_bytes=1)
    assert len(written) == len(set(written)), "no shard was written twice"
    assert written[: len(before)] == before
    assert hashes(tmp_path / "out") == hashes(packed)
    assert not list(tmp_path.glob(".*"))


def test_a_killed_unpack_continues(packed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    contents = packing._contents
    opened: list[str] = []

    def killed(folder: Path, shard: dict[str, Any], skipped: Any) -> Any:
        opened.append(shard["file"])
        for number, each in enumerate(contents(folder, shard, skipped)):
            if number == 1 and opened.count("shard-00001.zip") == 1:
                raise KeyboardInterrupt
            yield each

    flushed: set[Path] = set()
    flush, keep = durable.flush_path, packing.Staging.keep

    def checked(place: Any, name: str, content: Any) -> None:
        keep(place, name, content)
        if name != "request":  # a power cut may take what is not flushed; nobody looks again
            there = [path for path in place.folder.rglob("*") if ".state" not in path.parts]
            assert there
            assert {place.folder, *there} <= flushed

    monkeypatch.setattr(durable, "flush_path", lambda path: (flushed.add(path), flush(path)))
    monkeypatch.setattr(packing.Staging, "keep", checked)
    monkeypatch.setattr(packing, "_contents", killed)
    with pytest.raises(KeyboardInterrupt):
        unpack(packed, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    unpack(packed, tmp_path / "out")
    assert opened.count("shard-00000.zip") == 1, "it was there"
    assert robocell.data.verify(tmp_path / "out").ok


@pytest.mark.parametrize(
    "name", ["../out", "/tmp/out", "a/../../out", ".state/shard-00000.zip.json"]
)
def test_an_index_cannot_lead_out_of_the_dataset(packed: Path, tmp_path: Path, name: str):
    foreign = tmp_path / "foreign"
    shutil.copytree(packed, foreign)
    index = json.loads((foreign / "packed.json").read_text())
    files = index["shards"][0]["files"]
    files[name] = files.pop(next(iter(files)))
    index["json_sha256"] = "0" * 64
    text = robocell._core.self_hashed_json(json.dumps(index, indent=1))
    (foreign / "packed.json").write_text(text)
    with pytest.raises(robocell.IoError, match="is not inside a dataset"):
        unpack(foreign, tmp_path / "out")
    (foreign / "packed.json").write_text(text.replace("shard-00000", "shard-00009", 1))
    with pytest.raises(robocell.IoError, match="is damaged"):
        unpack(foreign, tmp_path / "out")
    with (foreign / "packed.json").open("r+b") as file:
        file.truncate(2 << 30)  # a hole: it takes no space
    for read in (lambda: unpack(foreign, tmp_path / "out"), lambda: robocell.Dataset(foreign)):
        with pytest.raises(robocell.IoError, match="it has 2147483648 bytes"):
            read()


def test_the_commands_pack_and_unpack(
    dataset: robocell.Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "out"
    pack_command(Path(dataset.folder), out, 1024.0)
    number = len(visible(Path(dataset.folder)))
    assert capsys.readouterr().out == f"3 episodes, {number} files in 1 shard: {out}\n"
    assert is_packed(out)
    verify_command(out)
    assert capsys.readouterr().out == "3 episodes intact, 0 damaged\n"
    unpack_command(out, tmp_path / "again")
    assert capsys.readouterr().out == f"3 episodes, {number} files: {tmp_path / 'again'}\n"
    with pytest.raises(robocell.ArgumentError, match=r"it has no packed\.json; `robocell pack`"):
        unpack(tmp_path / "again", tmp_path / "more")
    with pytest.raises(robocell.ArgumentError, match="exists already"):
        unpack(out, tmp_path / "again")
    with pytest.raises(robocell.ArgumentError, match="is inside the dataset"):
        pack(dataset.folder, Path(dataset.folder) / "out")
