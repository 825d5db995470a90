"""Exports of recordings that robocell did not make, by the documented names of their columns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr
from numpy.typing import NDArray

import robocell as rc
from robocell.data import ColumnSpec, EpisodeWriter
from robocell.export import export_dataset

ROBOT = "robots/a"
ARM = {f"{ROBOT}/{name}": ColumnSpec(shape=6, units="rad") for name in ("arm/qpos", "action/arm")}
OPENING = {f"{ROBOT}/opening": ColumnSpec()}
ROWS = 5


def record(folder: Path, columns: dict[str, ColumnSpec]) -> rc.Dataset:
    """Records an episode of which every column has the row's share of the episode, 0 to 0.8."""
    columns = {"time": ColumnSpec(units="s"), **ARM, **columns}
    with EpisodeWriter(folder, "a", columns, metadata={"instruction": "pick"}) as episode:
        for i in range(ROWS):
            episode.add_row({n: np.full(c.shape, i / ROWS) for n, c in columns.items()})
        episode.commit(success=True)
    return rc.Dataset(folder)


def exported(dataset: rc.Dataset, out: Path, **options: Any) -> dict[str, NDArray[Any]]:
    export_dataset(dataset, out, "zarr", **options)
    data: Any = zarr.open_group(str(out / "replay_buffer.zarr"), mode="r")["data"]
    return {name: np.asarray(data[name]) for name in data}


@pytest.mark.parametrize(
    "gripper",
    [
        {"action/gripper": ColumnSpec(shape=1)},
        {"action/gripper": ColumnSpec(shape=1), "gripper/target": ColumnSpec(shape=1)},
        {"action/gripper": ColumnSpec(), "gripper/qpos": ColumnSpec(shape=2, units="m")},
        {"action/hand": ColumnSpec(shape=1, names=["opening"]), "hand/qpos": ColumnSpec()},
    ],
)
def test_an_export_has_the_gripper_of_a_recording(tmp_path: Path, gripper: dict[str, ColumnSpec]):
    columns = OPENING | {f"{ROBOT}/{name}": column for name, column in gripper.items()}
    dataset = record(tmp_path / "real", columns)
    preset = tmp_path / "closing.yaml"
    preset.write_text("gripper: {open: 0, closed: 1}\n")
    share = np.arange(ROWS) / ROWS
    for mapping, opening in ((None, share), (preset, 1 - share)):
        arrays = exported(dataset, tmp_path / f"out{mapping is None}", mapping=mapping)
        for name in ("state", "action"):
            assert arrays[name].shape == (ROWS, 7)
            np.testing.assert_allclose(arrays[name][:, 6], opening, atol=1e-6)


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        (
            {"action/left": ColumnSpec(shape=1), "action/right": ColumnSpec(shape=1)},
            r"robot 'a' has a gripper, 'robots/a/opening', and nothing says whether "
            r"'robots/a/action/left', 'robots/a/action/right' commands it. .*--mapping FILE",
        ),
        (
            {"action/hand": ColumnSpec(shape=16, units="rad")},
            r"'robots/a/action/hand' belongs to no group: there is no 'robots/a/hand/qpos' and no "
            r"'robots/a/hand/target'. .*--mapping FILE",
        ),
    ],
)
def test_commands_of_no_known_group_are_refused(
    tmp_path: Path, columns: dict[str, ColumnSpec], told: str
):
    named = {f"{ROBOT}/{name}": column for name, column in columns.items()}
    dataset = record(tmp_path / "real", OPENING | named)
    with pytest.raises(rc.ArgumentError, match=told):
        export_dataset(dataset, tmp_path / "out", "zarr")
    mapping = tmp_path / "mapping.yaml"
    mapping.write_text(f"features:\n  action: [{', '.join(named)}, {ROBOT}/action/arm]\n")
    arrays = exported(dataset, tmp_path / "out", mapping=mapping)
    assert arrays["action"].shape[1] == 6 + sum(int(np.prod(c.shape)) for c in columns.values())


def test_named_values_have_one_number_in_all_episodes(tmp_path: Path):
    phases = {"a": ("reach", "lift"), "b": ("reach", "open", "lift"), "c": ("open",)}
    codes = {"a": [0, 0, 1], "b": [0, 1, 2], "c": [0, 0, 0]}
    for name, values in phases.items():
        columns = {
            "time": ColumnSpec(units="s"),
            **ARM,
            "phase": ColumnSpec(dtype="int32", values=values),
        }
        with EpisodeWriter(
            tmp_path / "real", name, columns, metadata={"instruction": "x"}
        ) as episode:
            for i, code in enumerate(codes[name]):
                numbers = {n: np.full(c.shape, i / 10) for n, c in columns.items() if n != "phase"}
                episode.add_row({**numbers, "phase": code})
            episode.commit(success=True)
    mapping = tmp_path / "mapping.yaml"
    mapping.write_text('features: {subtask_index: ["subtask|phase?"]}\n')
    out = tmp_path / "out"
    export_dataset(rc.Dataset(tmp_path / "real"), out, "lerobot-v3", mapping=mapping)
    table = pq.read_table(out / "meta/subtasks.parquet").to_pydict()
    assert table == {"subtask_index": [0, 1, 2], "subtask": ["reach", "lift", "open"]}
    (file,) = (out / "data").rglob("*.parquet")
    rows = pq.read_table(file, columns=["subtask_index"]).to_pydict()["subtask_index"]
    told = [table["subtask"][row] for row in rows]
    assert told == [phases[name][code] for name in phases for code in codes[name]]
    assert "0 reach, 1 lift, 2 open" in (out / "README.md").read_text()

    unnamed = {**columns, "phase": ColumnSpec(dtype="int32")}
    with EpisodeWriter(tmp_path / "real", "d", unnamed, metadata={"instruction": "x"}) as episode:
        for i in range(2):
            numbers = {name: np.full(column.shape, i / 10) for name, column in unnamed.items()}
            episode.add_row({**numbers, "phase": 1})
        episode.commit(success=True)
    with pytest.raises(rc.ArgumentError, match=r"values without a name: it names none, and has 1"):
        export_dataset(
            rc.Dataset(tmp_path / "real"), tmp_path / "more", "lerobot-v3", mapping=mapping
        )
