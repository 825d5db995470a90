"""Columns of episodes, read by rows. h5py is the judge."""

from __future__ import annotations

import pickle
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import robocell
from read_back import column_by_h5py, open_files, read_back_dataset


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return robocell.Dataset(read_back_dataset(tmp_path_factory))


def test_every_column_is_h5pys(dataset: robocell.Dataset):
    for episode in dataset:
        for name in episode.columns:
            expected = column_by_h5py(episode, name)
            column = episode.column(name)
            for values in (episode[name], column[...], np.asarray(column)):
                assert values.dtype == expected.dtype, name
                np.testing.assert_array_equal(values, expected, name)
            assert column.shape == expected.shape
            assert np.dtype(column.dtype) == expected.dtype


def test_column_metadata_matches_the_file(dataset: robocell.Dataset):
    episode = dataset[0]
    with h5py.File(episode.folder / "steps.h5") as steps:
        for name in episode.columns:
            column, stored = episode.column(name), steps[name].attrs
            assert column.name == name
            assert column.units == stored.get("units", "")
            assert column.frame == stored.get("frame", "")
            assert column.names == list(stored.get("names", []))
            assert column.values == list(stored.get("values", []))
            assert column.description == stored.get("description", "")
            assert column.table == stored.get("table", "")
            assert column.rows == (len(steps[name]) if column.table else 0)
    arm = episode.column("robots/rc7/arm/qpos")
    assert repr(arm) == f"<Column 'robots/rc7/arm/qpos': float64 (7), rad, {len(episode)} rows>"
    assert arm.row_shape == (7,)
    assert len(arm) == len(episode)
    assert repr(episode.column("initial_state")).endswith("constant>")


def random_key(rng: np.random.Generator, rows: int) -> Any:
    def end() -> int | None:
        return None if rng.random() < 0.3 else int(rng.integers(-rows - 3, rows + 3))

    kind = rng.integers(6)
    if kind == 0:
        return int(rng.integers(-rows, rows))
    if kind == 1:
        return slice(
            end(), end(), None if rng.random() < 0.3 else int(rng.choice([-3, -1, 1, 2, 5]))
        )
    if kind == 2:
        return rng.integers(-rows, rows, size=rng.integers(0, 6))
    if kind == 3:
        return [int(i) for i in rng.integers(-rows, rows, size=3)]
    if kind == 4:
        return rng.random(rows) < 0.3
    return rng.integers(0, rows, size=(2, 3))


@pytest.mark.parametrize("seed", range(5))
def test_rows_are_indexed_as_in_numpy(dataset: robocell.Dataset, seed: int):
    rng = np.random.default_rng(seed)
    episode = dataset[seed % 3]
    names = ["robots/rc7/arm/qpos", "reward", "success", "cameras/exo/extrinsics", "control/ctrl"]
    for _ in range(80):
        name = str(rng.choice(names))
        expected, column = column_by_h5py(episode, name), episode.column(name)
        key = random_key(rng, len(expected))
        if expected.ndim > 1 and rng.random() < 0.3:
            inner: Any = slice(0, 3) if rng.random() < 0.5 else int(rng.integers(4))
            key = (key, inner)
        np.testing.assert_array_equal(column[key], expected[key], f"{name} {key!r}")
        assert np.shape(column[key]) == np.shape(expected[key])


def test_rejects_rows_out_of_range(dataset: robocell.Dataset):
    episode = dataset[0]
    column = episode.column("reward")
    for row in (len(episode), -len(episode) - 1, [0, len(episode)]):
        with pytest.raises(IndexError, match=rf"of 'reward', it has {len(episode)} rows"):
            column[row]
    with pytest.raises(IndexError, match="2 truth values for the"):
        column[[True, False]]
    for key in ("units", 1.5, [0.5]):
        with pytest.raises(TypeError, match=r"attributes, such as \.units"):
            column[key]
    with pytest.raises(robocell.NotFoundError, match="Did you mean 'reward'"):
        episode.column("rewrad")


def test_a_constant_is_an_array_without_rows(dataset: robocell.Dataset):
    column = dataset[0].column("cameras/exo/intrinsics")
    expected = column_by_h5py(dataset[0], "cameras/exo/intrinsics")
    assert (column.table, column.rows, column.shape) == ("", 0, (3, 3))
    assert column[0, 0] == expected[0, 0]
    np.testing.assert_array_equal(column[1:], expected[1:])


def bytes_read() -> int:
    lines = Path("/proc/self/io").read_text().splitlines()
    return int(dict(line.split(": ") for line in lines)["rchar"])


def test_reads_only_the_requested_rows(dataset: robocell.Dataset):
    episode = dataset[0]
    column = episode.column("control/ctrl")
    column[:1]  # opens and compares the file
    with h5py.File(episode.folder / "steps.h5") as steps:
        chunk = steps["control/ctrl"].chunks[0]
    assert column.rows > 2 * chunk
    whole = column.rows * 8 * column.row_shape[0]
    before = bytes_read()
    column[10:20]
    some = bytes_read() - before
    before = bytes_read()
    column[:]
    everything = bytes_read() - before
    assert everything >= whole
    assert some < everything / 2


def test_a_column_outlives_its_episode(dataset: robocell.Dataset):
    expected = column_by_h5py(dataset[0], "reward")
    column = dataset[0].column("reward")  # the episode is nobody's any more
    np.testing.assert_array_equal(column[3:9], expected[3:9])


def test_slices_of_a_dataset_are_datasets(dataset: robocell.Dataset):
    ids = dataset.ids
    assert len(dataset) == 3
    assert dataset[0:2].ids == ids[0:2]
    assert dataset[::-1].ids == ids[::-1]
    assert dataset[-1:][0].id == ids[-1]
    assert dataset[5:].ids == []
    assert [episode.id for episode in dataset[1:]] == ids[1:]
    assert dataset[ids[1]].id == ids[1]
    assert dataset[0:2][0:1].ids == ids[:1]
    assert dataset.select([ids[2], ids[0]]).ids == [ids[2], ids[0]]
    assert ids[0] not in dataset[1:]
    assert repr(dataset[0:2]).endswith(": 2 episodes, selected>")
    with pytest.raises(robocell.NotFoundError, match="no episode"):
        dataset[1:][ids[0]]
    with pytest.raises(robocell.NotFoundError, match="Did you mean"):
        dataset.select([ids[0][:-1]])
    with pytest.raises(IndexError, match="no episode 3, it has 3"):
        dataset[3]


def test_pickles_store_the_path_and_the_episode_list(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    shutil.copytree(dataset.folder, tmp_path / "copy")
    monkeypatch.chdir(tmp_path)
    copy = robocell.Dataset("copy")
    whole, some, episode = pickle.dumps(copy), pickle.dumps(copy[1:]), pickle.dumps(copy[0])
    assert max(map(len, (whole, some, episode))) < 600
    monkeypatch.chdir("/")
    shutil.rmtree(tmp_path / "copy" / dataset.ids[2])
    assert pickle.loads(some).ids == dataset.ids[1:], "a snapshot, as for who pickled it"
    assert pickle.loads(whole)[0].id == dataset.ids[0]
    again = pickle.loads(episode)
    np.testing.assert_array_equal(again["reward"], dataset[0]["reward"])
    refreshed = pickle.loads(some)
    refreshed.refresh()
    assert refreshed.ids == [dataset.ids[1]]
    shutil.rmtree(tmp_path / "copy")
    with pytest.raises(robocell.IoError, match=dataset.ids[0]):
        pickle.loads(episode)


def test_many_episodes_keep_few_files_open(dataset: robocell.Dataset, tmp_path: Path):
    robocell.data.release_idle_files()
    source, before = dataset[0], open_files()
    episodes = []
    for i in range(120):
        folder = tmp_path / str(i) / source.id
        folder.mkdir(parents=True)
        for file in source.folder.iterdir():
            (folder / file.name).hardlink_to(file)
        episodes.append(robocell.data.Episode(folder))
        assert len(episodes[-1].column("reward")[0:3]) == 3
    assert open_files() - before <= 40
    for episode in episodes:
        assert len(episode["time"]) == len(source)
    for episode in episodes[:20]:
        episode.frame("exo", 0)
    # Each of the eight decoders of a kind keeps two files open: its messages and its images.
    assert open_files() - before <= 40 + 2 * 8
    robocell.data.release_idle_files()
    assert open_files() == before


def test_thousands_of_episodes_work_with_few_descriptors(dataset: robocell.Dataset):
    """As many objects as a shuffled dataset has, where 64 descriptors are allowed."""
    limit = 64
    code = (
        "import resource, sys, robocell\n"
        f"resource.setrlimit(resource.RLIMIT_NOFILE, ({limit}, {limit}))\n"
        f"dataset = robocell.Dataset({str(dataset.folder)!r})\n"
        "all = [dataset[i % 3] for i in range(1500)]\n"
        "print(sum(len(e.column('reward')[:2]) + len(e.frame('exo', 1)) for e in all[::50]))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == 30 * (2 + 48)
