"""Packed datasets: the same bytes again, complete or absent, and damage is named."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from typing import Any

import pytest
import typer

import robocell
from exported import hashes, three_episodes
from robocell._cli.pack import pack as pack_command
from robocell._cli.unpack import unpack as unpack_command
from robocell._cli.verify import verify as verify_command
from robocell.data import pack as packing
from robocell.data.pack import damage_of_packed, is_packed, pack, read_packed, unpack


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def packed(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One shard for every episode."""
    out = tmp_path_factory.mktemp("packed") / "out"
    result = pack(dataset.folder, out, shard_bytes=1)
    assert (result.episodes, result.folder) == (3, out)
    assert result.shards > 3
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
    for shard in json.loads((packed / "packed.json").read_text())["shards"]:
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
    assert seen == set(stored)
    whole = pack(Path(dataset.folder), tmp_path / "whole")
    assert whole.shards == 1
    again = pack(dataset.folder, tmp_path / "again", shard_bytes=1)
    assert hashes(again.folder) == hashes(packed), "the same files give the same shards"


def test_one_file_of_an_episode_is_read_alone(dataset: robocell.Dataset, packed: Path):
    id = dataset.ids[1]
    assert read_packed(packed, id) == (Path(dataset.folder) / id / "episode.json").read_bytes()
    assert read_packed(packed, id, "exo.mp4")[4:8] == b"ftyp"
    with pytest.raises(robocell.ArgumentError, match=r"has no 's9/episode\.json'; 'packed\.json'"):
        read_packed(packed, "s9")


def test_damage_is_found_before_it_is_unpacked(packed: Path, tmp_path: Path):
    broken = tmp_path / "broken"
    shutil.copytree(packed, broken)
    index = json.loads((packed / "packed.json").read_text())
    shard = next(each for each in index["shards"] if any("steps.h5" in n for n in each["files"]))
    name = next(n for n in shard["files"] if n.endswith("steps.h5"))
    content = bytearray((broken / shard["file"]).read_bytes())
    content[shard["files"][name]["offset"] + 100] ^= 1
    (broken / shard["file"]).write_bytes(content)
    assert damage_of_packed(packed) == []
    told = f"'{name}' in '{broken / shard['file']}' is damaged: its hash does not match"
    assert damage_of_packed(broken) == [told]
    other = next(n for n in shard["files"] if n.endswith("episode.json"))
    twice = bytearray(content)
    twice[shard["files"][other]["offset"] + 9] ^= 1
    (broken / shard["file"]).write_bytes(twice + b"?")
    found = damage_of_packed(broken)
    assert f"has {len(twice) + 1} bytes instead of {len(twice)}" in found[0]
    assert [text.split("'")[1] for text in found[1:]] == sorted(
        (name, other), key=list(shard["files"]).index
    )
    (broken / shard["file"]).write_bytes(content)
    for action in (
        lambda: unpack(broken, tmp_path / "out"),
        lambda: read_packed(broken, *name.split("/")),
    ):
        with pytest.raises(robocell.IoError, match="its hash does not match"):
            action()
    assert not (tmp_path / "out").exists()
    (broken / shard["file"]).write_bytes(content[:200])
    assert "the shard is too short" in damage_of_packed(broken)[-1]
    (broken / shard["file"]).unlink()
    assert "cannot read" in damage_of_packed(broken)[0]
    with pytest.raises(typer.Exit):
        verify_command(broken)


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


@pytest.mark.parametrize("at", [0, 2, 4])
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

    def killed(folder: Path, shard: dict[str, Any]) -> Any:
        opened.append(shard["file"])
        for number, each in enumerate(contents(folder, shard)):
            if number == 1 and opened.count("shard-00001.zip") == 1:
                raise KeyboardInterrupt
            yield each

    flushed: set[Path] = set()
    flush, keep = packing.flush_path, packing.Staging.keep

    def checked(place: Any, name: str, content: Any) -> None:
        if name != "request":  # a power cut may take what is not flushed; nobody looks again
            there = [path for path in place.folder.rglob("*") if ".state" not in path.parts]
            assert there
            assert {place.folder, *there} <= flushed
        keep(place, name, content)

    monkeypatch.setattr(packing, "flush_path", lambda path: (flushed.add(path), flush(path)))
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


def test_the_commands_pack_and_unpack(
    dataset: robocell.Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "out"
    pack_command(Path(dataset.folder), out, 1024.0)
    number = len(visible(Path(dataset.folder)))
    assert capsys.readouterr().out == f"3 episodes, {number} files in 1 shard: {out}\n"
    assert is_packed(out)
    verify_command(out)
    assert capsys.readouterr().out == f"packed dataset, intact: {out}\n"
    with pytest.raises(robocell.ArgumentError, match=r"packed dataset\. `robocell unpack .* OUT`"):
        robocell.Dataset(out)
    unpack_command(out, tmp_path / "again")
    assert capsys.readouterr().out == f"3 episodes, {number} files: {tmp_path / 'again'}\n"
    with pytest.raises(robocell.ArgumentError, match=r"it has no packed\.json; `robocell pack`"):
        unpack(tmp_path / "again", tmp_path / "more")
    with pytest.raises(robocell.ArgumentError, match="exists already"):
        unpack(out, tmp_path / "again")
    with pytest.raises(robocell.ArgumentError, match="is inside the dataset"):
        pack(dataset.folder, Path(dataset.folder) / "out")
