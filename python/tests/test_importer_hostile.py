"""Imports of datasets made to hurt: nothing outside of the dataset is read, nothing is executed."""

from __future__ import annotations

import json
import os
import pickle
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import zarr

import foreign_datasets as foreign
import robocell
from robocell.importer import import_dataset

LINK = "outside of '.*'. Datasets have their files inside; copy links with `cp -rL`"


def refused(source: Path, message: str, **options: Any) -> None:
    """The import must fail with a message, and leave nothing."""
    out = source.with_name("out")
    with pytest.raises((robocell.IoError, robocell.ArgumentError), match=message):
        import_dataset(source, out, **options)
    assert not out.exists()


def change(root: Path, **entries: Any) -> None:
    """Changes entries of a LeRobot dataset's description."""
    file = root / "meta/info.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | entries))


@pytest.mark.parametrize("is_absolute", [False, True])
def test_videos_outside_of_a_lerobot_dataset_are_refused(tmp_path: Path, is_absolute: bool):
    root = foreign.lerobot_v3(tmp_path / "there")
    [video] = root.rglob("*.mp4")
    shutil.copy(video, tmp_path / "secret.mp4")
    path = str(tmp_path / "secret.mp4") if is_absolute else "../secret.mp4"
    change(root, video_path=path)
    refused(root, f"names the file '{path}', which is {LINK}")


@pytest.mark.parametrize(
    "path",
    [
        "{episode_chunk.__class__}",
        "{episode_index!r}",
        "{episode_index:1000000000d}",
        "{0}",
        "{secret}",
        "data/{",
    ],
)
def test_templates_of_paths_have_numbers_alone(tmp_path: Path, path: str):
    root = foreign.lerobot_v2(tmp_path / "there")
    change(root, data_path=path)
    refused(root, "info.json': 'data_path'")


def test_images_outside_of_a_lerobot_dataset_are_refused(tmp_path: Path):
    root = foreign.lerobot_v2(tmp_path / "there")
    for number, file in enumerate(foreign.files(foreign.ROWS[0], "PNG")):
        (tmp_path / f"secret-{number}.png").write_bytes(file)
    file = root / "data/chunk-000/episode_000000.parquet"
    table = pq.read_table(file, partitioning=None)
    images = [{"bytes": b"", "path": f"../secret-{row}.png"} for row in range(len(table))]
    pq.write_table(foreign.replaced(table, "observation.images.still", images), file)
    refused(root, f"'observation.images.still' row 0 names the file '../secret-0.png'.*{LINK}")


@pytest.mark.parametrize("kind", foreign.DATASETS)
def test_links_to_the_outside_are_refused(tmp_path: Path, kind: str):
    root = foreign.DATASETS[kind](tmp_path / "there")
    kinds = {".parquet", ".hdf5", ""}
    *_, file = sorted(each for each in root.rglob("*") if each.is_file() and each.suffix in kinds)
    shutil.move(file, tmp_path / "secret")
    file.symlink_to(tmp_path / "secret")
    options = {"rate": 10} if kind == "replay_buffer" else {}
    refused(root, f"is a link to '.*secret', {LINK}", **options)


def test_damaged_frames_are_not_copied(tmp_path: Path):
    root = foreign.lerobot_v3(tmp_path / "there")
    [video] = root.rglob("*.mp4")
    content = bytearray(video.read_bytes())
    start = content.index(b"mdat") + 700  # behind the settings of the encoder
    content[start : start + 40] = bytes(40)
    video.write_bytes(content)
    refused(root, f"cannot cut '{video}' into '.*top.mp4': ffmpeg: ")


def test_links_inside_of_a_dataset_are_followed(tmp_path: Path):
    root = foreign.lerobot_v2(tmp_path / "there")
    (root / "data").rename(root / "stored")
    (root / "data").symlink_to("stored")
    assert import_dataset(root, tmp_path / "out").episodes == 2


def test_arrays_of_other_hdf5_files_are_refused(tmp_path: Path):
    root = foreign.robomimic(tmp_path / "there")
    file, secret = root / "demo.hdf5", tmp_path / "secret.hdf5"
    shutil.copy(file, secret)
    shape = (foreign.ROWS[0], 2)
    with h5py.File(file, "a") as content:
        layout = h5py.VirtualLayout(shape, np.float64)
        layout[:] = h5py.VirtualSource(str(secret), "data/demo_0/obs/object", shape)
        del content["data/demo_0/obs/object"]
        content.create_virtual_dataset("data/demo_0/obs/object", layout)
    refused(root, "data/demo_0/obs/object has its numbers in another file, '.*secret.hdf5'")
    with h5py.File(file, "a") as content:
        del content["data/demo_0/obs/object"]
        content.create_dataset(
            "data/demo_0/obs/object",
            shape,
            np.float64,
            external=[(str(secret), 0, 8 * shape[0] * shape[1])],
        )
    refused(root, "data/demo_0/obs/object has its numbers in another file, '.*secret.hdf5'")
    with h5py.File(file, "a") as content:
        del content["data/demo_0/obs"]
        content["data/demo_0/obs"] = h5py.ExternalLink(str(secret), "data/demo_0/obs")
    refused(root, "data/demo_0/obs is a link to another file")


class Harm:
    """Writes a file when it is unpickled."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (str(self.file),)


@pytest.mark.parametrize("name", ["data/state", "data/img", "meta/episode_ends"])
def test_zarr_arrays_are_not_unpickled(tmp_path: Path, name: str):
    root = foreign.replay_buffer(tmp_path / "there")
    array = root / "a.zarr" / name
    described = json.loads((array / ".zarray").read_text())
    described |= {"compressor": {"id": "pickle", "protocol": 5}}
    (array / ".zarray").write_text(json.dumps(described))
    for chunk in array.glob("[0-9]*"):
        chunk.write_bytes(pickle.dumps(Harm(tmp_path / "harmed")))
    refused(root, f"{root}.*'pickle'", rate=10)
    assert not (tmp_path / "harmed").exists()


@pytest.mark.parametrize("name", ["data/state", "data/img", "meta/episode_ends"])
def test_zarr_codecs_that_are_not_known_are_named(tmp_path: Path, name: str):
    root = foreign.replay_buffer(tmp_path / "there")
    file = root / "a.zarr" / name / ".zarray"
    described = json.loads(file.read_text()) | {"compressor": {"id": "base64"}}
    file.write_text(json.dumps(described))
    refused(root, f"{name} is stored with the codec 'base64', which is not imported", rate=10)


def test_zarr_codecs_that_are_missing_are_named(tmp_path: Path):
    root = foreign.replay_buffer(tmp_path / "there")
    file = root / "a.zarr/data/img/.zarray"
    described = json.loads(file.read_text()) | {"compressor": {"id": "codec_of_nobody"}}
    file.write_text(json.dumps(described))
    refused(root, "data has an array whose codec is not imported: .*codec_of_nobody", rate=10)


def test_rows_in_another_order_than_images_are_refused(tmp_path: Path):
    root = foreign.lerobot_v2(tmp_path / "there")
    file = root / "data/chunk-000/episode_000001.parquet"
    table = pq.read_table(file, partitioning=None)
    for order, message in (([0, 2, 1], "'frame_index' does not count the rows"), ([0, 1, 2], "")):
        pq.write_table(table.append_column("frame_index", pa.array(order)), file)
        if message:
            refused(root, f"{file}' episode 1: {message}")
    assert import_dataset(root, tmp_path / "out").episodes == 2


def test_a_dataset_of_robocell_is_named(tmp_path: Path):
    root = foreign.aloha(tmp_path / "there")
    import_dataset(root, tmp_path / "back")
    refused(tmp_path / "back", "is a dataset of robocell already")


def test_zarr_arrays_without_description_are_not_left_out(tmp_path: Path):
    root = foreign.replay_buffer(tmp_path / "there")
    (root / "a.zarr/data/action/.zarray").unlink()
    refused(root, "data/action' has no description of an array", rate=10)


@pytest.mark.parametrize("is_zip", [False, True])
@pytest.mark.parametrize("chunk", ["data/action/0.0", "data/img/6.0.0.0", "meta/episode_ends/0"])
def test_missing_chunks_of_zarr_arrays_are_refused(tmp_path: Path, chunk: str, is_zip: bool):
    root = foreign.replay_buffer(tmp_path / "there")
    group = zarr.open_group(str(root / "a.zarr"), mode="a", zarr_format=2)
    images = {"data": foreign.pixels(7), "chunks": (1, 16, 16, 3), "overwrite": True}
    group.create_array("data/img", **images, config={"write_empty_chunks": True})
    (root / "a.zarr" / chunk).unlink()
    source = root
    if is_zip:
        source = Path(shutil.make_archive(str(tmp_path / "there.zarr"), "zip", root / "a.zarr"))
    name, _, key = chunk.rpartition("/")
    message = rf"{name}: chunk {key} is missing, of \d.*--fill-missing-chunks imports them"
    refused(source, message, rate=10)
    if not name.startswith("meta"):
        done = import_dataset(source, tmp_path / "out", rate=10, fill_missing_chunks=True)
        assert done.rows == 7


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("aloha", "no 1, 3 to 4 between episode_0 and episode_5"),
        ("robomimic", "no 1, 3 to 4 between demo_0 and demo_5"),
    ],
)
def test_numbers_that_are_missing_are_named(tmp_path: Path, kind: str, told: str):
    root = foreign.DATASETS[kind](tmp_path / "there")
    if kind == "aloha":
        for number in (2, 5):
            shutil.copy(root / "episode_1.hdf5", root / f"episode_{number}.hdf5")
        (root / "episode_1.hdf5").unlink()
    else:
        with h5py.File(root / "demo.hdf5", "a") as file:
            file.copy("data/demo_1", "data/demo_2")
            file.move("data/demo_1", "data/demo_5")
    done = import_dataset(root, tmp_path / "out", rate=10)
    assert (done.episodes, done.gaps) == (3, told)


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ([4, 4, 7], "episode 1 begins at row 4 and ends at row 4; expected at least one row"),
        ([3, 2, 7], "episode 1 begins at row 3 and ends at row 2"),
        ([-1, 7], "episode 0 begins at row 0 and ends at row -1"),
        ([3, 6], r"data/action has the shape \(7, 3\), the last episode ends at row 6"),
        ([4, 8], r"data/action has the shape \(7, 3\), the last episode ends at row 8"),
        ([4.0, float("nan")], "meta/episode_ends has the type float64; expected whole numbers"),
        ([[4], [7]], "meta/episode_ends is no list of numbers"),
        ([], "has no episodes to import"),
    ],
)
def test_ends_of_episodes_are_checked(tmp_path: Path, ends: Any, message: str):
    root = foreign.replay_buffer(tmp_path / "there")
    shutil.rmtree(root / "a.zarr/meta/episode_ends")
    group = zarr.open_group(str(root / "a.zarr"), mode="a", zarr_format=2)
    group.create_array("meta/episode_ends", data=np.array(ends, None if ends else np.int64))
    refused(root, message, rate=10)


@pytest.mark.parametrize("rate", [0, -1, float("nan"), float("inf"), 1e-9, 1e9])
def test_rates_that_videos_cannot_have_are_refused(tmp_path: Path, rate: float):
    root = foreign.lerobot_v2(tmp_path / "there")
    refused(root, "rate is .*; rows per second, from 0.001 to 100000", rate=rate)
    change(root, fps=rate)
    refused(root, "info.json': 'fps' is .*; rows per second, from 0.001 to 100000")


@pytest.mark.parametrize("rate", [29.97, 100.123456789, 0.1, 99_999.9])
def test_rates_fit_into_videos(tmp_path: Path, rate: float):
    root = foreign.lerobot_v2(tmp_path / "there")
    result = import_dataset(root, tmp_path / "out", rate=rate)
    assert result.rate == pytest.approx(rate, rel=1e-5)
    assert robocell.data.verify(tmp_path / "out", decode_videos=True).ok


def test_results_are_zeros_and_ones(tmp_path: Path):
    root = foreign.robomimic(tmp_path / "there")
    with h5py.File(root / "demo.hdf5", "a") as content:
        del content["data/demo_1/dones"]
        content["data/demo_1/dones"] = np.full(foreign.ROWS[1], np.nan)
    refused(root, "episode-000001: column 'terminated' has other values than one 0 or 1")


def test_a_changed_dataset_is_imported_from_the_beginning(tmp_path: Path):
    root = foreign.aloha(tmp_path / "there")
    last = root / "episode_1.hdf5"
    whole = last.read_bytes()
    last.write_bytes(whole[:100])
    refused(root, "cannot read '.*episode_1.hdf5'")
    with h5py.File(root / "episode_0.hdf5", "a") as content:
        content["action"][:] = 1
    last.write_bytes(whole)
    assert import_dataset(root, tmp_path / "out").resumed == 0
    assert (robocell.Dataset(tmp_path / "out")[0]["action"] == 1).all()


def test_columns_whose_names_begin_others_stay_apart(tmp_path: Path):
    root = foreign.lerobot_v2(tmp_path / "there")
    mapping = tmp_path / "names.yaml"
    mapping.write_text("columns: {observation.state: {a: [0, 1], a/b/c: [1, 2]}}\n")
    import_dataset(root, tmp_path / "out", mapping=mapping)
    [first, _] = robocell.Dataset(tmp_path / "out")
    assert {"a/value", "a/b/c"} < set(first.columns)
    for names, message in (
        ("{a: [0, 1], a/value: [1, 2]}", "two columns would be 'a/value'"),
        ("time/a", "column 'time/a' would be inside of 'time'"),
        ("../a", "would be '../a', which no column of an episode can be"),
        ("cameras/a", "would be 'cameras/a', which no column of an episode can be"),
        ("time", "'time' is made from the rate; choose another"),
    ):
        mapping.write_text(f"columns: {{observation.state: {names}}}\n")
        with pytest.raises(robocell.Error, match=message):
            import_dataset(root, tmp_path / "other", mapping=mapping)
    mapping.write_text("cameras: {observation.images.still: ../../a}\n")
    with pytest.raises(robocell.SpecError, match=r"'../../a', which no file can have"):
        import_dataset(root, tmp_path / "other", mapping=mapping)


def test_a_column_that_is_left_out_is_not_read(tmp_path: Path):
    root = foreign.robomimic(tmp_path / "there")
    with h5py.File(root / "demo.hdf5", "a") as content:
        del content["data/demo_1/rewards"]
        content["data/demo_1/rewards"] = np.zeros(100)
    refused(root, "data/demo_1/rewards has 100 rows, the actions have 3.*--mapping FILE")
    mapping = tmp_path / "names.yaml"
    mapping.write_text("columns: {rewards: null}\n")
    assert import_dataset(root, tmp_path / "out", mapping=mapping).episodes == 2
