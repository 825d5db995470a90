"""Depth in exports, beside the images, with its unit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import zarr
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import robocell
from command_line import refused
from exported import three_episodes
from robocell.export import FORMATS, export_dataset


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def test_zarr_has_millimetres(dataset: robocell.Dataset, tmp_path: Path):
    made = export_dataset(dataset, tmp_path / "out", "zarr", depth=True)
    assert made.left_out == ()
    group: Any = zarr.open_group(str(tmp_path / "out" / "replay_buffer.zarr"), mode="r")
    array = group["data/wrist_depth"]
    assert (array.dtype, array.attrs["unit"]) == (np.uint16, "mm")
    whole = np.concatenate([episode.frames("wrist", kind="depth") for episode in dataset])
    np.testing.assert_array_equal(array[:][..., 0], whole)
    assert "data/exo_depth" not in group, "it was recorded without depth"
    card = " ".join((tmp_path / "out" / "README.md").read_text().split())
    assert "along the camera's axis, uint16 in millimetres, 0 for no hit: `wrist_depth`" in card


def test_robomimic_has_metres(dataset: robocell.Dataset, tmp_path: Path):
    export_dataset(dataset, tmp_path / "out", "robomimic", depth=True, episodes=["1"])
    with h5py.File(tmp_path / "out" / "dataset.hdf5") as file:
        depth = file["data/demo_0/obs/wrist_depth"]
        assert (depth.dtype, depth.attrs["unit"]) == (np.float32, "m")
        wanted = dataset[1].frames("wrist", kind="depth")
        np.testing.assert_allclose(depth[:][..., 0], wanted / 1000, rtol=1e-6)


def test_logs_have_raw_images(dataset: robocell.Dataset, tmp_path: Path):
    export_dataset(dataset, tmp_path / "out", "mcap", depth=True, episodes=["0"])
    with (tmp_path / "out" / f"{dataset.ids[0]}.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        topic = ["/cameras/wrist/depth"]
        found = [(m.log_time, image) for _, _, m, image in reader.iter_decoded_messages(topic)]
    wanted = dataset[0].frames("wrist", kind="depth")
    assert len(found) == len(wanted)
    for (time, image), depth, moment in zip(found, wanted, dataset[0]["time"], strict=True):
        assert (image.encoding, image.step, image.frame_id) == ("16UC1", 128, "cameras/wrist")
        np.testing.assert_array_equal(np.frombuffer(image.data, "<u2").reshape(48, 64), depth)
        assert time == pytest.approx(1e9 * moment, abs=1)


@pytest.mark.proof
def test_depth_is_resampled_with_its_rows(dataset: robocell.Dataset, tmp_path: Path):
    export_dataset(dataset, tmp_path / "out", "zarr", depth=True, rate=3, episodes=["0"])
    group: Any = zarr.open_group(str(tmp_path / "out" / "replay_buffer.zarr"), mode="r")
    depth = dataset[0].frames("wrist", kind="depth")
    rows = [int(k / 3 / 0.132 + 1e-9) for k in range(group["data/state"].shape[0])]
    np.testing.assert_array_equal(group["data/wrist_depth"][:][..., 0], depth[rows])


@pytest.mark.proof
def test_depth_that_is_left_out_says_how_to_export_it(dataset: robocell.Dataset, tmp_path: Path):
    for name, form in FORMATS.items():
        if name in ("umi", "rerun"):
            continue
        made = export_dataset(dataset, tmp_path / name, name, episodes=["0"])
        (text,) = made.left_out
        assert text.startswith("depth of wrist")
        assert text.endswith("(--depth exports it)") == ("depth" in form.options)


def test_depth_that_cannot_be_exported_is_refused(dataset: robocell.Dataset, tmp_path: Path):
    out, folder = tmp_path / "out", dataset.folder
    text = refused("export", folder, out, "--depth")
    assert "format 'lerobot-v3' takes no depth. Formats that do: robomimic, zarr" in text
    text = " ".join(
        refused("export", folder, out, "--format", "zarr", "--depth", "--cameras", "exo").split()
    )
    assert "none of the exported cameras has depth; these have: wrist" in text
    mapping = tmp_path / "small.yaml"
    mapping.write_text("image_size: [32, 24]\n")
    text = refused("export", folder, out, "--format", "zarr", "--depth", "--mapping", mapping)
    assert "`image_size` resizes images, and depth keeps the size" in " ".join(text.split())
    assert not out.exists()
