"""Steps of a dataset as items: judged by whole columns and videos, as h5py and ffmpeg read them."""

from __future__ import annotations

import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell
from read_back import column_by_h5py, frames_by_ffmpeg, read_back_dataset
from robocell._extras import install_command
from robocell.data import Steps, torch_dataset

ARM = "robots/rc7/arm/qpos"
ACTION = "robots/rc7/action/arm"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return read_back_dataset(tmp_path_factory)


@pytest.fixture(scope="module")
def dataset(folder: Path) -> robocell.Dataset:
    return robocell.Dataset(folder)


def expected_values(episode: robocell.data.Episode, name: str) -> Any:
    return (
        frames_by_ffmpeg(episode, name)
        if name in episode.streams
        else column_by_h5py(episode, name)
    )


def rows_and_pads(row: int, offsets: Any, count: int) -> tuple[list[int], list[bool]]:
    """One by one: where an episode ends its last row stands in."""
    rows = [min(max(row + offset, 0), count - 1) for offset in offsets]
    return rows, [not 0 <= row + offset < count for offset in offsets]


def test_an_item_is_a_row_of_an_episode(dataset: robocell.Dataset):
    steps = Steps(dataset, [ARM, "phase", "wrist", "cameras/wrist/intrinsics"])
    counts = [len(episode) for episode in dataset]
    assert len(steps) == sum(counts)
    assert steps.starts == [0, counts[0], counts[0] + counts[1]]
    for index in (0, counts[0] - 1, counts[0], len(steps) - 1, -1, -len(steps)):
        item = steps[index]
        place = index % len(steps)
        episode = int(np.searchsorted(np.cumsum(counts), place, side="right"))
        assert (item["episode"], item["row"]) == (episode, place - steps.starts[episode])
        assert list(item) == [ARM, "phase", "wrist", "cameras/wrist/intrinsics", "episode", "row"]
        for name in (ARM, "phase", "wrist"):
            expected = expected_values(dataset[episode], name)[item["row"]]
            np.testing.assert_array_equal(item[name], expected)
            assert np.asarray(item[name]).dtype == expected.dtype
        assert item["cameras/wrist/intrinsics"].shape == (3, 3)


@pytest.mark.parametrize("seed", range(4))
def test_windows_are_filled_at_both_ends(dataset: robocell.Dataset, seed: int):
    rng = np.random.default_rng(seed)
    keys: dict[str, Any] = {
        ARM: [-1, 0],
        ACTION: range(16),
        "exo": sorted(int(i) for i in rng.integers(-6, 4, size=3)),
        "wrist.depth": [0],
        "reward": sorted(int(i) for i in rng.integers(-60, 60, size=4)),
    }
    steps = Steps(dataset, keys)
    ends = [start + d for start in [*steps.starts, len(steps)] for d in (-2, -1, 0, 1)]
    some = [index for index in ends if 0 <= index < len(steps)]
    for index in [*some, *rng.integers(len(steps), size=15).tolist()]:
        item = steps[index]
        episode = dataset[item["episode"]]
        for name, offsets in keys.items():
            rows, pads = rows_and_pads(item["row"], offsets, len(episode))
            np.testing.assert_array_equal(item[name], expected_values(episode, name)[rows])
            assert item[f"{name}_is_pad"].dtype == bool
            assert item[f"{name}_is_pad"].tolist() == pads, name


def test_a_batch_contains_the_requested_items(dataset: robocell.Dataset):
    steps = Steps(dataset, {ARM: 0, "wrist.segmentation": 0})
    indices = np.random.default_rng(0).permutation(len(steps))[:20].tolist()
    for index, item in zip(indices, steps.__getitems__(indices), strict=True):
        alone = steps[index]
        assert steps.locate(index) == (item["episode"], item["row"])
        for name in (ARM, "wrist.segmentation"):
            np.testing.assert_array_equal(item[name], alone[name])


def test_parts_of_a_dataset_and_folders_are_datasets(folder: Path, dataset: robocell.Dataset):
    training, held_out = Steps(dataset[:2], [ARM]), Steps(dataset[2:], [ARM])
    assert len(training) + len(held_out) == len(Steps(folder, [ARM])) == len(Steps(dataset, [ARM]))
    np.testing.assert_array_equal(held_out[0][ARM], column_by_h5py(dataset[2], ARM)[0])


def test_few_episodes_stay_open_and_pickles_hold_none(dataset: robocell.Dataset):
    steps = Steps(dataset, [ARM], open_episodes=1)
    values = [steps[index][ARM].tolist() for index in (*steps.starts, *steps.starts)]
    again = pickle.loads(pickle.dumps(steps))
    assert [again[index][ARM].tolist() for index in (*steps.starts, *steps.starts)] == values
    assert len(pickle.dumps(steps)) < 3000


def test_errors_explain_invalid_keys(dataset: robocell.Dataset, tmp_path: Path):
    with pytest.raises(robocell.NotFoundError, match=f"Did you mean '{ARM}'"):
        Steps(dataset, [ARM + "s"])
    with pytest.raises(robocell.NotFoundError, match=r"Did you mean 'wrist\.depth'"):
        Steps(dataset, ["wrist.dpth"])
    with pytest.raises(robocell.ArgumentError, match="is of table 'control'"):
        Steps(dataset, ["control/ctrl"])
    with pytest.raises(robocell.ArgumentError, match="is a constant, without rows"):
        Steps(dataset, {"initial_state": [0, 1]})
    for rows in ([], [0.5], "01", None, 1.0):
        with pytest.raises(robocell.ArgumentError, match=r"such as \[-1, 0\] or range\(16\)"):
            Steps(dataset, {ARM: rows})  # type: ignore[dict-item]
    with pytest.raises(robocell.ArgumentError, match="list of names or a dictionary"):
        Steps(dataset, ARM)
    with pytest.raises(robocell.ArgumentError, match="there are no keys"):
        Steps(dataset, {})
    with pytest.raises(robocell.ArgumentError, match="has no episodes"):
        Steps(tmp_path, [ARM])
    with pytest.raises(IndexError, match=r"has \d+ steps in 3 episodes"):
        Steps(dataset, [ARM])[10**6]
    with pytest.raises(TypeError):
        Steps(dataset, [ARM])[1.5]  # type: ignore[index]


def test_all_items_in_a_loop_end(dataset: robocell.Dataset):
    steps = Steps(dataset[:1], ["time"])
    times = [item["time"] for item in steps]  # type: ignore[attr-defined]
    np.testing.assert_array_equal(times, column_by_h5py(dataset[0], "time"))


def test_without_torch_the_command_that_installs_it_is_named(
    dataset: robocell.Dataset, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.delitem(sys.modules, "robocell.data._torch", raising=False)
    needed = rf"{re.escape(install_command('torch'))}\. .*Steps"
    with pytest.raises(ModuleNotFoundError, match=needed) as error:
        torch_dataset(dataset, [ARM])
    assert error.value.name == "torch"


def test_the_module_is_lazy_and_does_not_import_torch():
    code = (
        "import sys, robocell; robocell.data.Dataset; "
        "assert robocell.data.Dataset is robocell.Dataset; "
        "assert not {'numpy', 'torch'} & set(sys.modules); "
        "assert set(robocell.data.__all__) <= set(dir(robocell.data)); "
        "[getattr(robocell.data, name) for name in robocell.data.__all__]; "
        "assert 'torch' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with pytest.raises(AttributeError, match="no attribute 'Stepz'"):
        robocell.data.Stepz  # noqa: B018


def test_a_star_matches_any_part_of_a_name(dataset: robocell.Dataset):
    first = dataset[0]
    groups = [name for name in first.columns if name.startswith("robots/") and "/qpos" in name]
    assert len(groups) > 1
    steps = Steps(dataset, {"robots/*/qpos": [-1, 0], "reward": 0})
    assert [key.name for key in steps.keys] == [*groups, "reward"]
    assert steps[0][ARM].shape == (2, 7)
    table = robocell.data.rows(dataset, ["reward", "robots/*/qpos", ARM])
    assert np.array_equal(table, robocell.data.rows(dataset, ["reward", *groups]))
    for read in (lambda names: Steps(dataset, names), lambda n: robocell.data.rows(dataset, n)):
        with pytest.raises(
            robocell.NotFoundError, match=r"nothing fits 'sensrs/\*'\. There are: c"
        ):
            read(["sensrs/*"])
