"""Episodes that are written row by row, as those of a real robot."""

from __future__ import annotations

import math
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from robocell.data import CameraStream, ColumnSpec, EpisodeWriter
from robocell.export import export_dataset

COLUMNS = {
    "time": ColumnSpec(units="s"),
    "robots/ur5e/arm/qpos": ColumnSpec(
        shape=3, units="rad", names=["pan", "lift", "elbow"], description="before the action"
    ),
    "touched": ColumnSpec("bool"),
    "phase": ColumnSpec("int32", values=("reach", "grasp")),
}
WRIST = {"wrist": CameraStream(64, 48, fps=500 / 33, intrinsics=np.eye(3), depth=True)}


def row(i: int, **other: Any) -> dict[str, Any]:
    qpos = np.arange(3) * 0.1 * i
    return {
        "time": i * 0.066,
        "robots/ur5e/arm/qpos": qpos,
        "touched": i > 1,
        "phase": i % 2,
    } | other


def rgb(i: int) -> np.ndarray:
    return np.full((48, 64, 3), 40 * i, np.uint8)


def test_rows_frames_and_metadata_come_back(tmp_path: Path):
    metadata = {"instruction": "pick up the cube", "operator": None, "trials": [1, 2.5]}
    with EpisodeWriter(
        tmp_path / "new/real", "pick-0", COLUMNS, WRIST, metadata=metadata, versions={"own": "3"}
    ) as episode:
        for i in range(4):
            episode.add_row(row(i), {"wrist": rgb(i)})
            episode.add_depth("wrist", np.full((48, 64), 1000 + i, np.uint16))
        episode.add_file("notes.txt", "lamp off")
        assert episode.is_open
        assert rc.data.verify(tmp_path / "new/real").being_written
        folder = episode.commit(
            success=True, warnings=["slow"], results={"effort": 0.5}, run={"lab": "b"}
        )
    assert not episode.is_open
    assert folder == tmp_path / "new/real/pick-0"
    assert (folder / "notes.txt").read_text() == "lamp off"
    result = rc.data.verify(tmp_path / "new/real", decode_videos=True)
    assert (result.good, result.ok) == (["pick-0"], True)
    back = rc.Dataset(tmp_path / "new/real")["pick-0"]
    assert (back.success, back.terminated, back.truncated) == (True, True, False)
    assert (back.end_reason, back.warnings) == ("success", ["slow"])
    assert (back.metadata, back.results) == (metadata, {"effort": 0.5})
    assert np.array_equal(back["robots/ur5e/arm/qpos"], np.outer(range(4), np.arange(3) * 0.1))
    assert (back["touched"].dtype, back["phase"].tolist()) == (bool, [0, 1, 0, 1])
    column = back.column("robots/ur5e/arm/qpos")
    assert (column.units, column.names) == ("rad", ["pan", "lift", "elbow"])
    assert column.description == "before the action"
    assert back.column("phase").values == ["reach", "grasp"]
    assert back.json["cameras"]["wrist"]["fps"] == [500, 33]
    assert back.json["versions"]["own"] == "3"
    assert back.json["run"]["lab"] == "b"
    assert abs(back.frame("wrist", 2).astype(int) - 80).max() < 6


def test_rows_at_once_are_the_same_bytes_as_one_by_one(tmp_path: Path):
    many = {name: np.stack([row(i)[name] for i in range(700)]) for name in COLUMNS}
    with EpisodeWriter(tmp_path, "a", COLUMNS) as one, EpisodeWriter(tmp_path, "b", COLUMNS) as two:
        for i in range(700):
            one.add_row(row(i))
        two.add_rows({name: values[:500] for name, values in many.items()})
        two.add_rows({name: values[500:].tolist() for name, values in many.items()})
        two.add_rows(
            {name: [] for name in many if name == "time"}
            | {name: values[:0] for name, values in many.items() if name != "time"}
        )
        a, b = one.commit(success=False), two.commit(success=False)
    assert (a / "steps.h5").read_bytes() == (b / "steps.h5").read_bytes()
    assert rc.Dataset(tmp_path)["a"].end_reason == "stopped"


def test_tables_have_rows_of_their_own(tmp_path: Path):
    columns = {"time": ColumnSpec(), "control/time": ColumnSpec(), "control/ctrl": ColumnSpec()}
    with EpisodeWriter(tmp_path, "a", columns, tables=["control"]) as episode:
        episode.add_row({"time": 0})
        episode.add_rows({"control/time": [0, 1], "control/ctrl": [3, 4]}, table="control")
        with pytest.raises(rc.NotFoundError, match=r"no column of table 'steps' 'control/time'"):
            episode.add_row({"time": 0, "control/time": 1})
        with pytest.raises(rc.NotFoundError, match=r"no table 'contrl'. Did you mean 'control'"):
            episode.add_row({}, table="contrl")
        episode.commit(success=True)
    back = rc.Dataset(tmp_path)["a"]
    assert (len(back), back["control/ctrl"].tolist()) == (1, [3, 4])


def test_a_finished_video_is_copied(tmp_path: Path):
    cameras = {"wrist": CameraStream(64, 48)}
    with EpisodeWriter(tmp_path, "a", {"time": ColumnSpec()}, cameras) as first:
        for i in range(3):
            first.add_row({"time": i}, {"wrist": rgb(i)})
        video = first.commit(success=True) / "wrist.mp4"
    with EpisodeWriter(tmp_path, "b", {"time": ColumnSpec()}, cameras) as second:
        second.add_rows({"time": range(3)})
        with pytest.raises(rc.ArgumentError, match=r"episode 'b': camera 'wrist': .*none.mp4"):
            second.add_video("wrist", tmp_path / "none.mp4")
        second.add_video("wrist", video)
        copied = second.commit(success=True) / "wrist.mp4"
    assert copied.read_bytes() == video.read_bytes()


def test_an_export_finds_the_robot_by_the_names_of_its_columns(tmp_path: Path):
    names = ("robots/ur5e/arm/qpos", "robots/ur5e/arm/target", "robots/ur5e/action/arm")
    columns = {"time": ColumnSpec()} | {name: ColumnSpec(shape=6) for name in names}
    metadata = {"instruction": "pick up the cube"}
    with EpisodeWriter(tmp_path / "real", "a", columns, metadata=metadata) as episode:
        for i in range(5):
            episode.add_row({"time": i / 30} | {name: np.full(6, i) for name in names})
        episode.commit(success=True)
    done = export_dataset(rc.Dataset(tmp_path / "real"), tmp_path / "out", "zarr")
    assert (done.episodes, done.frames) == (1, 5)
    assert done.rate == pytest.approx(30)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"time": "soon"}, r"column 'time' was declared as float64, which cannot store <U4 soon"),
        ({"time": None}, r"column 'time' was declared as float64, which cannot store object None"),
        ({"time": [1.0]}, r"column 'time' takes the shape \(\), got \(1,\)"),
        ({"time": True}, r"cannot store bool True"),
        ({"robots/ur5e/arm/qpos": [0, 0]}, r"qpos' takes the shape \(3,\), got \(2,\)"),
        ({"robots/ur5e/arm/qpos": [[0], [0, 1], 2]}, r"qpos': the value is no array"),
        ({"touched": 1}, r"'touched' was declared as bool, which cannot store int64 1"),
        ({"phase": 0.5}, r"'phase' was declared as int32, which cannot store float64 0.5"),
        ({"phase": 2**31}, r"'phase' was declared as int32, which cannot store int64 2147483648"),
        ({"phse": 1}, r"no column of table 'steps' 'phse'. Did you mean 'phase'\? Declared: time"),
    ],
)
def test_wrong_values_are_named_and_can_be_corrected(
    tmp_path: Path, wrong: dict[str, Any], told: str
):
    with EpisodeWriter(tmp_path, "a", COLUMNS) as episode:
        with pytest.raises((rc.ArgumentError, rc.NotFoundError), match=told):
            episode.add_row(row(0, **wrong))
        episode.add_row(row(0, time=math.nan))
        episode.commit(success=True)
    assert len(rc.Dataset(tmp_path)["a"]) == 1


def test_missing_values_and_images_are_named(tmp_path: Path):
    with EpisodeWriter(tmp_path, "a", COLUMNS, WRIST) as episode:
        with pytest.raises(rc.ArgumentError, match="has no value for touched, phase; each row"):
            episode.add_row({"time": 0, "robots/ur5e/arm/qpos": [0, 0, 0]})
        turned = np.zeros((64, 48, 3), np.uint8)
        for image in (turned, turned.transpose(1, 0, 2).astype(float)):
            with pytest.raises(rc.ArgumentError, match=r"are uint8 of shape \(48, 64, 3\), got"):
                episode.add_row(row(0), {"wrist": image})
        with pytest.raises(rc.NotFoundError, match=r"no camera 'wrst'. Did you mean 'wrist'"):
            episode.add_frame("wrst", rgb(0))
        with pytest.raises(rc.ArgumentError, match="it has no row"):
            episode.commit(success=True)
        episode.add_row(row(0))
        with pytest.raises(rc.ArgumentError, match="camera 'wrist' has 0 frames for the 1 row"):
            episode.commit(success=True)
        episode.abort()


@pytest.mark.parametrize(
    ("columns", "options", "told"),
    [
        ({"time": ColumnSpec("double")}, {}, "'double' is not a type of columns: float64"),
        ({"time": ColumnSpec(shape=0)}, {}, r"shape \(0\) has an axis shorter than 1"),
        ({"time": ColumnSpec(names="ab")}, {}, "column 'time': names is a list of texts"),
        ({"a": ColumnSpec(), "a/b": ColumnSpec()}, {}, "a"),
        ({}, {"cameras": {"w": CameraStream(63, 48)}}, "even"),
        ({}, {"cameras": {"w": CameraStream(64, 48, intrinsics=[1])}}, "are a 3x3 matrix"),
        ({}, {"cameras": {"w": CameraStream(64, 48, table="fast")}}, "no table 'fast'"),
        ({}, {"metadata": {"x": math.nan}}, "metadata cannot be kept with episodes, as JSON"),
        ({}, {"metadata": {"x": object()}}, "metadata cannot be kept with episodes, as JSON"),
    ],
)
def test_wrong_declarations_are_named(tmp_path: Path, columns, options: dict[str, Any], told: str):
    with pytest.raises((rc.ArgumentError, rc.NotFoundError), match=told):
        EpisodeWriter(tmp_path, "a", columns, **options)
    with pytest.raises(rc.ArgumentError, match="cannot be an episode's id"):
        EpisodeWriter(tmp_path, ".a", COLUMNS)
    assert not list(tmp_path.iterdir())


def test_nothing_stays_without_commit(tmp_path: Path):
    def begin() -> EpisodeWriter:
        episode = EpisodeWriter(tmp_path, "a", COLUMNS)
        episode.add_row(row(0))
        return episode

    with pytest.warns(RuntimeWarning, match=r"episode 'a' was not committed and is gone"), begin():
        pass
    with begin() as episode:
        episode.abort()
    with pytest.raises(ZeroDivisionError), begin():
        raise ZeroDivisionError
    del episode
    begin()  # and freed
    assert not list(tmp_path.iterdir())


def test_an_episode_is_written_once(tmp_path: Path):
    with EpisodeWriter(tmp_path, "a", COLUMNS) as episode:
        episode.add_row(row(0))
        episode.commit(success=True)
        with pytest.raises(rc.ClosedError, match="after it was committed"):
            episode.add_row(row(1))
        episode.abort()
    with pytest.raises(rc.IoError, match="exists already"):
        EpisodeWriter(tmp_path, "a", COLUMNS)
    (tmp_path / "file").write_text("")
    with pytest.raises(rc.IoError, match="cannot create"):
        EpisodeWriter(tmp_path / "file/real", "a", COLUMNS)


def test_threads_take_turns(tmp_path: Path):
    with EpisodeWriter(tmp_path, "a", {"time": ColumnSpec()}) as episode:
        threads = [
            threading.Thread(target=lambda: [episode.add_row({"time": 1}) for _ in range(200)])
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        episode.commit(success=True)
    assert rc.Dataset(tmp_path)["a"]["time"].tolist() == [1] * 800
