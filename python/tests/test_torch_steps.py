"""Steps as tensors, through data loaders with processes of all kinds. For who has torch."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from torch.utils.data import DataLoader

import robocell
from read_back import read_back_dataset
from robocell.data import Steps, torch_dataset

ARM = "robots/rc7/arm/qpos"
ACTION = "robots/rc7/action/arm"
KEYS: dict[str, Any] = {
    ARM: [-1, 0],
    ACTION: range(8),
    "wrist": 0,
    "wrist.depth": 0,
    "wrist.segmentation": [0],
    "phase": 0,
    "ik_failed": 0,
    "cameras/wrist/intrinsics": 0,
}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return robocell.Dataset(read_back_dataset(tmp_path_factory))


def test_items_match_the_arrays_as_tensors(dataset: robocell.Dataset):
    tensors, arrays = torch_dataset(dataset, KEYS), Steps(dataset, KEYS)
    assert isinstance(tensors, torch.utils.data.Dataset)
    assert len(tensors) == len(arrays)
    for index in (0, 17, len(arrays) - 1):
        item, own = tensors[index], arrays[index]
        assert set(item) == set(own)
        assert {name: (tuple(v.shape), v.dtype) for name, v in item.items()} == {
            ARM: ((2, 7), torch.float32),
            f"{ARM}_is_pad": ((2,), torch.bool),
            ACTION: ((8, 7), torch.float32),
            f"{ACTION}_is_pad": ((8,), torch.bool),
            "wrist": ((3, 48, 64), torch.uint8),
            "wrist.depth": ((1, 48, 64), torch.float32),
            "wrist.segmentation": ((1, 1, 48, 64), torch.int32),
            "wrist.segmentation_is_pad": ((1,), torch.bool),
            "phase": ((), torch.int32),
            "ik_failed": ((), torch.bool),
            "cameras/wrist/intrinsics": ((3, 3), torch.float32),
            "episode": ((), torch.int64),
            "row": ((), torch.int64),
        }
        for name in (ARM, ACTION):
            np.testing.assert_array_equal(item[name].numpy(), own[name].astype(np.float32))
            np.testing.assert_array_equal(item[f"{name}_is_pad"].numpy(), own[f"{name}_is_pad"])
        np.testing.assert_array_equal(item["wrist"].numpy().transpose(1, 2, 0), own["wrist"])
        metres = (own["wrist.depth"] / 1000).astype(np.float32)
        np.testing.assert_array_equal(item["wrist.depth"][0].numpy(), metres)
        np.testing.assert_array_equal(item["wrist.segmentation"][:, 0], own["wrist.segmentation"])
        assert (int(item["episode"]), int(item["row"])) == arrays.locate(index)


def test_floats_have_the_requested_dtype(dataset: robocell.Dataset):
    exact = torch_dataset(dataset, KEYS, dtype="float64")[3]
    np.testing.assert_array_equal(exact[ARM].numpy(), Steps(dataset, KEYS)[3][ARM])
    assert torch_dataset(dataset, [ARM], dtype="float16")[3][ARM].dtype == torch.float16
    with pytest.raises(robocell.ArgumentError, match="dtype is 'int8'"):
        torch_dataset(dataset, [ARM], dtype="int8")


def shapes_only(item: dict[str, Any]) -> list[int]:
    return list(item[ARM].shape)


def test_a_transform_is_applied_to_each_item(dataset: robocell.Dataset):
    steps = torch_dataset(dataset, [ARM], transform=shapes_only)
    assert steps[0] == [7]
    assert steps.__getitems__([0, 5]) == [[7], [7]]


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver", None])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_loaders_yield_every_item_once(dataset: robocell.Dataset, method: str | None):
    steps = torch_dataset(dataset[:2], KEYS)
    expected = [steps[index] for index in range(0, len(steps), 3)]  # with decoders that are open
    part = torch.utils.data.Subset(steps, range(0, len(steps), 3))
    loader: DataLoader[Any] = DataLoader(
        part,
        batch_size=4,
        num_workers=2 if method else 0,
        multiprocessing_context=method,
        shuffle=True,
        generator=torch.Generator().manual_seed(1),
    )
    found = {}
    for batch in loader:
        for i in range(len(batch["row"])):
            item = {name: values[i] for name, values in batch.items()}
            found[int(item["episode"]), int(item["row"])] = item
    assert len(found) == len(expected)
    for item in expected:
        same = found[int(item["episode"]), int(item["row"])]
        for name, values in item.items():
            assert torch.equal(values, same[name]), name


def test_the_example_of_the_page_runs(dataset: robocell.Dataset):
    """Its keys are those of the page's code before it, which runs without torch too."""
    page = (Path(__file__).parents[2] / "docs" / "data.md").read_text()
    begin = page.index("    from torch.utils.data import DataLoader")
    example = textwrap.dedent(page[begin : page.index("\n\nReal numbers are float32")])
    keys = {ARM: [-1, 0], "wrist": 0, ACTION: range(16)}
    known: dict[str, Any] = {"robocell": robocell, "dataset": dataset, "keys": keys}
    exec(example, known)
    assert known["batch"][ACTION].shape[1:] == (16, 7)
    assert len(known["steps"]) == sum(len(episode) for episode in dataset)
