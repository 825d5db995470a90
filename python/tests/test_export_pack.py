"""Packed exports of LeRobot v3.0: the same dataset by way of a file for each episode."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import robocell
from command_line import refused
from exported import hashes, three_episodes
from read_back import decoded
from robocell.export import _lerobot_pack, _lerobot_v3, export_dataset

KEYS = ("observation.images.wrist", "observation.images.exo")


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def episodes(root: Path) -> list[dict[str, Any]]:
    files = sorted((root / "meta/episodes").rglob("*.parquet"))
    return pa.concat_tables([pq.read_table(file) for file in files]).to_pylist()


def test_a_packed_dataset_has_the_bytes_of_one_that_is_not(
    dataset: robocell.Dataset, tmp_path: Path
):
    export_dataset(dataset, tmp_path / "at_once")
    result = export_dataset(dataset, tmp_path / "packed", pack=True)
    assert (result.episodes, result.encoded) == (3, {})
    first, second = hashes(tmp_path / "at_once"), hashes(tmp_path / "packed")
    for own in (first, second):
        del own["README.md"]  # it names the command
    # The index of a joined video may be laid out in another way; its frames are the same.
    videos = {name for name in first if name.endswith(".mp4")}
    assert {n: h for n, h in first.items() if n not in videos} == {
        n: h for n, h in second.items() if n not in videos
    }
    for name in videos:
        assert np.array_equal(
            decoded(tmp_path / "at_once" / name), decoded(tmp_path / "packed" / name)
        )


@pytest.mark.proof
def test_shards_are_as_large_as_the_files_are(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    sizes = [max((e.folder / f"{c}.mp4").stat().st_size for c in ("wrist", "exo")) for e in dataset]
    # A file has space for two episodes, not for three.
    monkeypatch.setattr(_lerobot_v3, "VIDEO_MB", (sum(sizes) - min(sizes) // 2) / (1 << 20))
    export_dataset(dataset, tmp_path / "out", pack=True)
    rows = episodes(tmp_path / "out")
    assert [row["data/file_index"] for row in rows] == [0, 0, 1]
    for key in KEYS:
        assert [row[f"videos/{key}/file_index"] for row in rows] == [0, 0, 1]
        starts = [row[f"videos/{key}/from_timestamp"] for row in rows]
        assert starts == [0, len(dataset[0]) / 8, 0]
        frames = decoded(tmp_path / f"out/videos/{key}/chunk-000/file-001.mp4")
        assert np.array_equal(frames, decoded(dataset[2].folder / f"{key.rpartition('.')[2]}.mp4"))
    assert len(list((tmp_path / "out").rglob("*.parquet"))) == 4  # two of data, episodes, tasks
    info = json.loads((tmp_path / "out/meta/info.json").read_text())
    assert info["total_frames"] == sum(map(len, dataset))


@pytest.mark.parametrize("place", ["write_shard", "_pack"])
def test_an_interrupted_export_keeps_every_episode(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
):
    module = _lerobot_v3 if place == "write_shard" else _lerobot_pack
    write = getattr(module, place)

    def full(*arguments: Any) -> Any:
        if place == "_pack" or arguments[3] == 2:
            raise OSError(28, "No space left on device")
        return write(*arguments)

    monkeypatch.setattr(module, place, full)
    out = tmp_path / "out"
    with pytest.raises(robocell.IoError, match="No space left on device"):
        export_dataset(dataset, out, pack=True, cameras=["exo"])
    assert not out.exists()
    monkeypatch.undo()
    resumed = export_dataset(dataset, out, pack=True, cameras=["exo"]).resumed
    assert resumed == (2 if place == "write_shard" else 3)
    assert len(episodes(out)) == 3


@pytest.mark.proof
def test_images_that_were_encoded_again_are_packed(dataset: robocell.Dataset, tmp_path: Path):
    result = export_dataset(dataset, tmp_path / "out", pack=True, preset="aloha", cameras=["exo"])
    assert result.encoded == {
        "observation.images.cam_high": "images of 64x48 are brought to 640x480"
    }
    [video] = (tmp_path / "out/videos").rglob("*.mp4")
    statistics = json.loads((tmp_path / "out/meta/stats.json").read_text())
    [key_frames] = statistics["observation.images.cam_high"]["count"]
    assert key_frames == len(_lerobot_pack.Mp4.read(video).key_frames)


def test_packing_is_for_version_3(dataset: robocell.Dataset, tmp_path: Path):
    said = refused("export", dataset.folder, tmp_path / "a", "--format", "lerobot-v2.1", "--pack")
    assert "format 'lerobot-v2.1' takes no pack. Formats that do: lerobot-v3" in said
