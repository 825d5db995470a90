"""GR00T's files beside a LeRobot dataset of version 2.1, held against the rules of its loader."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

import robocell
from command_line import refused
from exported import three_episodes
from robocell.export import export_dataset

STATISTICS = {"min", "max", "mean", "std", "q01", "q99"}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def exported(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("groot") / "out"
    export_dataset(dataset, out, "lerobot-v2.1")
    return out


def read(root: Path, name: str) -> Any:
    return json.loads((root / "meta" / name).read_text())


def loaded(root: Path, index: int) -> dict[str, NDArray[Any]]:
    """An episode as GR00T's loader cuts it: a range of the vectors for each key."""
    info, modality = read(root, "info.json"), read(root, "modality.json")
    place = {"episode_chunk": index // info["chunks_size"], "episode_index": index}
    table = pq.read_table(root / info["data_path"].format(**place))
    columns = {"state": "observation.state", "action": "action"}
    return {
        f"{kind}.{key}": np.array(table[columns[kind]].to_pylist())[:, each["start"] : each["end"]]
        for kind in columns
        for key, each in modality[kind].items()
    }


def chunks(root: Path, key: str, horizon: int) -> NDArray[np.float32]:
    """As GR00T's stats.py: the actions of a chunk minus the state at its first row."""
    found = []
    for index in range(read(root, "info.json")["total_episodes"]):
        rows = loaded(root, index)
        action, state = rows[f"action.{key}"], rows[f"state.{key}"]
        for first in range(len(action) - horizon + 1):
            found.append(action[first : first + horizon] - state[first])
    return np.array(found, np.float32)


@pytest.mark.parametrize("horizon", [None, 5])
def test_relative_statistics_are_those_of_chunks_minus_the_state(
    dataset: robocell.Dataset, exported: Path, tmp_path: Path, horizon: int | None
):
    out = exported
    if horizon is not None:
        out = tmp_path / "out"
        export_dataset(dataset, out, "lerobot-v2.1", cameras=[], action_horizon=horizon)
    found = read(out, "relative_stats.json")
    assert set(found) == {"arm", "gripper"}
    for key, own in found.items():
        relative = chunks(out, key, horizon or 16)
        assert len(relative) > 50
        expected = {
            "min": relative.min(0),
            "max": relative.max(0),
            "mean": relative.mean(0, dtype=float),
            "std": relative.std(0, dtype=float),
            "q01": np.quantile(relative, 0.01, axis=0),
            "q99": np.quantile(relative, 0.99, axis=0),
        }
        assert set(own) == STATISTICS
        for name, values in expected.items():
            assert np.shape(own[name]) == relative.shape[1:]
            assert np.allclose(own[name], values, atol=1e-5), (key, name)
    card = (out / "README.md").read_text()
    assert f"chunks of {horizon or 16} actions" in card


def test_the_loader_finds_its_keys_and_statistics(exported: Path):
    info, modality = read(exported, "info.json"), read(exported, "modality.json")
    statistics = read(exported, "stats.json")
    for column in ("observation.state", "action"):
        assert set(statistics[column]) >= STATISTICS
    tasks = [json.loads(line) for line in (exported / "meta/tasks.jsonl").read_text().splitlines()]
    [(key, annotation)] = modality["annotation"].items()
    assert key == "human.task_description"
    table = pq.read_table(exported / "data/chunk-000/episode_000000.parquet")
    assert set(table[annotation["original_key"]].to_pylist()) <= {
        each["task_index"] for each in tasks
    }
    for key, video in modality["video"].items():
        assert info["features"][video["original_key"]]["dtype"] == "video", key
    rows = loaded(exported, 0)
    assert {name: each.shape[1] for name, each in rows.items()} == {
        "state.arm": 7,
        "state.gripper": 1,
        "action.arm": 7,
        "action.gripper": 1,
    }


def test_displacements_have_no_relative_statistics(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "out"
    export_dataset(dataset, out, "lerobot-v2.1", cameras=[], actions="tcp_displacement")
    assert set(read(out, "relative_stats.json")) == {"gripper"}


def test_chunks_longer_than_every_episode_leave_the_statistics_out(
    dataset: robocell.Dataset, tmp_path: Path
):
    out = tmp_path / "out"
    export_dataset(dataset, out, "lerobot-v2.1", cameras=[], action_horizon=1000)
    assert not (out / "meta/relative_stats.json").exists()
    assert "relative_stats" not in (out / "README.md").read_text()


def test_a_horizon_is_for_version_2_1(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "out"
    with pytest.raises(robocell.ArgumentError) as raised:
        export_dataset(dataset, out, "lerobot-v3", action_horizon=8)
    assert str(raised.value) == (
        "format 'lerobot-v3' takes no action_horizon. Formats that do: lerobot-v2.1"
    )
    with pytest.raises(robocell.ArgumentError, match="action_horizon is 0; at least 1"):
        export_dataset(dataset, out, "lerobot-v2.1", action_horizon=0)
    said = refused("export", dataset.folder, out, "--format", "zarr", "--action-horizon", 8)
    assert "format 'zarr' takes no action_horizon. Formats that do: lerobot-v2.1" in said
