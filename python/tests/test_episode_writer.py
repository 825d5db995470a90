"""Episodes that are written row by row, as those of a real robot."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import subprocess
import threading
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from robocell.data import CameraStream, ColumnSpec, EpisodeWriter
from robocell.export import export_dataset
from robocell.export._mp4 import Mp4, packets

COLUMNS = {
    "time": ColumnSpec(units="s"),
    "robots/ur5e/arm/qpos": ColumnSpec(
        shape=3, units="rad", names=["pan", "lift", "elbow"], description="before the action"
    ),
    "touched": ColumnSpec("bool"),
    "phase": ColumnSpec("int32", values=("reach", "grasp")),
    "small": ColumnSpec("float32"),
}
WRIST = {"wrist": CameraStream(64, 48, fps=500 / 33, intrinsics=np.eye(3), depth=True)}


def row(i: int, **other: Any) -> dict[str, Any]:
    qpos = np.arange(3) * 0.1 * i
    return {
        "time": i * 0.066,
        "robots/ur5e/arm/qpos": qpos,
        "touched": i > 1,
        "phase": i % 2,
        "small": i,
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


def test_a_row_that_is_rejected_leaves_nothing(tmp_path: Path):
    cameras = {"a": CameraStream(64, 48), "b": CameraStream(64, 48, table="slow")}
    columns = {"time": ColumnSpec(), "slow/time": ColumnSpec()}
    with EpisodeWriter(tmp_path, "a", columns, cameras, tables=["slow"]) as episode:
        for frames, message in [
            ({"a": rgb(0), "b": rgb(0)}, "camera 'b' has one image for each row of table 'slow'"),
            ({"a": rgb(0)[:3]}, r"images of camera 'a' are uint8 of shape"),
            ({"a": [[1], [2, 3]]}, "camera 'a': the value is no array"),
            (rgb(0), r"frames are \{camera: image\}"),
        ]:
            with pytest.raises(rc.ArgumentError, match=message):
                episode.add_row({"time": 0}, frames)
        for i in range(3):
            episode.add_row({"time": i}, {"a": rgb(i)})
        episode.add_row({"slow/time": 0}, {"b": rgb(0)}, table="slow")
        folder = episode.commit(success=True)
    back = rc.data.Episode(folder)
    assert (back["time"].tolist(), back["slow/time"].tolist()) == ([0, 1, 2], [0])

    with EpisodeWriter(tmp_path, "b", columns, cameras, tables=["slow"]) as episode:
        episode.add_rows({"slow/time": [0]}, table="slow")
        episode.add_frame("b", rgb(0))
        episode.add_video("a", folder / "a.mp4")
        episode.add_rows({"time": [0, 1]})
        with pytest.raises(rc.ArgumentError, match="camera 'a' has a video already"):
            episode.add_row({"time": 2}, {"a": rgb(2)})
        episode.add_row({"time": 2})
        episode.commit(success=True)


def test_an_image_is_that_of_its_row(tmp_path: Path):
    with EpisodeWriter(tmp_path, "a", {"time": ColumnSpec()}, {"w": CameraStream(64, 48)}) as one:
        one.add_row({"time": 0})
        with pytest.raises(rc.ArgumentError, match="row 0 of 'steps' has no image of camera 'w'"):
            one.add_row({"time": 1}, {"w": rgb(1)})
        one.add_frame("w", rgb(0))
        one.add_row({"time": 1}, {"w": rgb(1)})
        one.add_row({"time": 2})
        with pytest.raises(rc.ArgumentError, match="row 2 of 'steps' has no image of camera 'w'"):
            one.add_row({"time": 3})
        one.add_frame("w", rgb(2))
        one.add_frame("w", rgb(3))
        with pytest.raises(rc.ArgumentError, match="row 3 of 'steps' has an image of camera 'w'"):
            one.add_row({"time": 3}, {"w": rgb(3)})
        one.add_row({"time": 3})
        folder = one.commit(success=True)
    frames = rc.data.Episode(folder).frames("w")
    assert [round(frame.mean() / 40) for frame in frames] == [0, 1, 2, 3]


def ffmpeg(out: Path, *arguments: str) -> Path:
    command = ["ffmpeg", "-loglevel", "error", "-y", *arguments, f"file:{out}"]
    subprocess.run(command, check=True)
    return out


def test_a_video_with_sound_is_exported_and_several_videos_are_refused(tmp_path: Path):
    pictures = ("-f", "lavfi", "-i", "testsrc=size=64x48:rate=30:duration=0.4")
    sound = ("-f", "lavfi", "-i", "sine=duration=0.4")
    encoded = ("-c:v", "libx264", "-bf", "0", "-pix_fmt", "yuv420p")
    loud = ffmpeg(tmp_path / "loud.mp4", *sound, *pictures, *encoded)
    twice = ffmpeg(tmp_path / "two.mp4", *pictures, *encoded, "-map", "0:v", "-map", "0:v")
    loud.chmod(0o400)
    with EpisodeWriter(
        tmp_path / "d", "a", {"time": ColumnSpec()}, {"w": CameraStream(64, 48)}
    ) as episode:
        episode.add_rows({"time": np.arange(12) / 30})
        with pytest.raises(rc.ArgumentError, match=r"camera 'w': '.*two.mp4' has 2 videos"):
            episode.add_video("w", twice)
        episode.add_video("w", loud)
        folder = episode.commit(success=True)
    assert (folder / "w.mp4").stat().st_mode == (folder / "steps.h5").stat().st_mode
    assert rc.data.verify(tmp_path / "d", decode_videos=True).ok
    assert sum(1 for _ in packets(folder / "w.mp4")) == 12
    assert Mp4.read(folder / "w.mp4").frames == 12


def test_a_damaged_video_is_refused(tmp_path: Path):
    good = ffmpeg(
        tmp_path / "good.mp4",
        *("-f", "lavfi", "-i", "testsrc=size=64x48:rate=30:duration=0.4"),
        *("-c:v", "libx264", "-bf", "0", "-pix_fmt", "yuv420p"),
    )
    content = bytearray(good.read_bytes())
    begin = content.index(b"mdat") + 900
    content[begin : begin + 300] = bytes(300)
    (tmp_path / "bad.mp4").write_bytes(content)
    cameras = {"w": CameraStream(64, 48)}
    with EpisodeWriter(tmp_path / "d", "a", {"time": ColumnSpec()}, cameras) as episode:
        with pytest.raises(rc.ArgumentError, match=r"camera 'w': cannot decode '.*bad.mp4'"):
            episode.add_video("w", tmp_path / "bad.mp4")
        with pytest.raises(rc.ArgumentError, match=r"camera 'w': there is no file"):
            episode.add_video("w", tmp_path)
        with pytest.raises(rc.ArgumentError, match=r"a video is a path, got 3"):
            episode.add_video("w", 3)  # type: ignore[arg-type]
        episode.add_video("w", good)
        episode.abort()


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
    ("wrong", "message"),
    [
        ({"time": "soon"}, r"column 'time' was declared as float64, which cannot store <U4 soon"),
        ({"time": None}, r"column 'time' was declared as float64, which cannot store object None"),
        ({"time": [1.0]}, r"column 'time' takes the shape \(\), got \(1,\)"),
        ({"time": True}, r"cannot store bool True"),
        ({"robots/ur5e/arm/qpos": [0, 0]}, r"qpos' takes the shape \(3,\), got \(2,\)"),
        ({"robots/ur5e/arm/qpos": [[0], [0, 1], 2]}, r"qpos': the value is no array"),
        ({"touched": 1}, r"'touched' was declared as bool, which cannot store int64 1"),
        ({"phase": 0.5}, r"'phase' was declared as int32, which cannot store float64 0.5"),
        ({"phase": 2}, r"column 'phase' has names for 2 values, 0 to 1, got 2"),
        ({"small": 1e300}, r"'small' was declared as float32, which cannot store float64 1e\+300"),
        ({"time": np.longdouble("1e4000")}, r"'time' was declared as float64, which cannot store"),
        ({"time": np.ma.masked}, r"column 'time': the value has masked numbers"),
        (
            {"robots/ur5e/arm/qpos": np.ma.array([0.0, 1, 2], mask=[1, 0, 0])},
            r"qpos': the value has masked numbers",
        ),
        ({"phase": 2**31}, r"'phase' was declared as int32, which cannot store int64 2147483648"),
        ({"phse": 1}, r"no column of table 'steps' 'phse'. Did you mean 'phase'\? Declared: time"),
    ],
)
def test_wrong_values_are_named_and_can_be_corrected(
    tmp_path: Path, wrong: dict[str, Any], message: str
):
    with EpisodeWriter(tmp_path, "a", COLUMNS) as episode:
        with pytest.raises((rc.ArgumentError, rc.NotFoundError), match=message):
            episode.add_row(row(0, **wrong))
        episode.add_row(row(0, time=math.nan))
        episode.commit(success=True)
    assert len(rc.Dataset(tmp_path)["a"]) == 1


def test_missing_values_and_images_are_named(tmp_path: Path):
    with EpisodeWriter(tmp_path, "a", COLUMNS, WRIST) as episode:
        with pytest.raises(
            rc.ArgumentError, match="has no value for touched, phase, small; each row"
        ):
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
    ("columns", "options", "message"),
    [
        ({"time": ColumnSpec("double")}, {}, "'double' is not a type of columns: float64"),
        ({"time": ColumnSpec(shape=0)}, {}, r"shape \(0\) has an axis shorter than 1"),
        ({"time": ColumnSpec(names="ab")}, {}, "column 'time': names is a list of texts"),
        ({"a": ColumnSpec(), "a/b": ColumnSpec()}, {}, "'a/b'"),
        ({"steps/x": ColumnSpec()}, {}, "column 'steps/x': columns of the table 'steps' have no"),
        ({"x": ColumnSpec(shape="3")}, {}, "column 'x': each number of the shape is a whole numb"),
        ({"x": ColumnSpec(shape=3.0)}, {}, "column 'x': each number of the shape is a whole numb"),
        ({"x": ColumnSpec(shape=(2**40,))}, {}, "column 'x': each number of the shape is at most"),
        ({"x": ColumnSpec(shape=(1,) * 40)}, {}, r"column 'x': shape .* is too large"),
        ({"x": ColumnSpec(units="metres")}, {}, "column 'x': unit 'metres' .*Did you mean 'm'"),
        ({"x": ColumnSpec(units=3)}, {}, "column 'x': units is a text, got 3"),
        ({"x": ColumnSpec(np.complex128)}, {}, "column 'x': 'complex128' is not a type of col"),
        ({"x": ColumnSpec(None)}, {}, "column 'x': 'None' is not a type of columns"),
        ({"x": {"shape": 3}}, {}, r"columns: 'x' is a ColumnSpec, got \{'shape': 3\}"),
        (["x"], {}, r"columns are \{name: ColumnSpec\(...\)\}, got \['x'\]"),
        ({3: ColumnSpec()}, {}, "columns: a name is a text, got 3"),
        ({}, {"tables": "control"}, "tables is a list of texts, got 'control'"),
        ({}, {"tables": ["control"]}, "table 'control' has no column; .* called 'control/...'"),
        (
            {"control/x": ColumnSpec()},
            {"tables": ["contrl"]},
            "table 'contrl' has no column.*Did you mean 'control'",
        ),
        ({"cameras/w": ColumnSpec()}, {"cameras": {"w": CameraStream(64, 48)}}, "group of camera"),
        ({}, {"cameras": {"w": (64, 48)}}, "cameras: 'w' is a CameraStream, got"),
        ({}, {"cameras": {"w": CameraStream(64.0, 48)}}, "'w': width is a whole number, got 64.0"),
        ({}, {"cameras": {"w": CameraStream(64, 48, depth=1)}}, "'w': depth is True or False"),
        ({}, {"cameras": {"w": CameraStream(64, 48, fps=math.nan)}}, "'w': fps is a number above"),
        ({}, {"cameras": {"w": CameraStream(64, 48, fps=math.inf)}}, "'w': fps is a number above"),
        ({}, {"cameras": {"w": CameraStream(64, 48, fps="30")}}, "'w': fps is a number above 0"),
        ({}, {"cameras": {"w": CameraStream(64, 48, fps=2**40)}}, "'w': fps is a number above 0"),
        ({}, {"cameras": {"w": CameraStream(64, 48, fps=0.0004)}}, "'w': fps is a number above"),
        (
            {},
            {"cameras": {"w": CameraStream(64, 48, intrinsics=np.full((3, 3), math.nan))}},
            "camera 'w': intrinsics must be finite",
        ),
        ({}, {"cameras": {"w": CameraStream(63, 48)}}, "even"),
        ({}, {"cameras": {"w": CameraStream(64, 48, intrinsics=[1])}}, "are a 3x3 matrix"),
        ({}, {"cameras": {"w": CameraStream(64, 48, table="fast")}}, "no table 'fast'"),
        ({}, {"metadata": {"x": math.nan}}, "metadata cannot be kept with episodes, as JSON"),
        ({}, {"metadata": {"x": object()}}, "metadata cannot be kept with episodes, as JSON"),
    ],
)
def test_wrong_declarations_are_named(
    tmp_path: Path, columns, options: dict[str, Any], message: str
):
    with pytest.raises((rc.ArgumentError, rc.NotFoundError), match=message):
        EpisodeWriter(tmp_path, "a", columns, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("id", [".a", "../a", "models", "dataset.json", "report-0-of-2.json", 7])
def test_names_that_are_no_ids_are_refused(tmp_path: Path, id: Any):
    with pytest.raises(rc.ArgumentError, match=r"cannot be an episode's id|is a text, got 7"):
        EpisodeWriter(tmp_path, id, COLUMNS)
    assert not list(tmp_path.iterdir())


def test_numbers_and_types_of_numpy_declare_columns_and_cameras(tmp_path: Path):
    columns = {"x": ColumnSpec(np.float32, np.int64(3)), "y": ColumnSpec(np.dtype("int32"))}
    cameras = {"w": CameraStream(np.int32(64), np.int64(48), fps=np.float32(30))}
    with EpisodeWriter(tmp_path, "a", columns, cameras) as episode:
        episode.add_row({"x": [0, 1, 2], "y": np.int8(1)}, {"w": rgb(0)})
        folder = episode.commit(np.linalg.norm([0.1]) < 0.3, truncated=np.bool_(False))
    back = rc.data.Episode(folder)
    assert (back["x"].dtype, back.json["cameras"]["w"]["fps"]) == (np.float32, [30, 1])
    assert back.success is True


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"success": "yes"}, "success is True or False, got 'yes'"),
        ({"success": 1}, "success is True or False, got 1"),
        ({"success": True, "terminated": 0}, "terminated is True or False, got 0"),
        ({"success": True, "warnings": "slow"}, "warnings is a list of texts, got 'slow'"),
        ({"success": True, "end_reason": 3}, "end_reason is a text, got 3"),
    ],
)
def test_a_wrong_commit_can_be_corrected(tmp_path: Path, arguments: dict[str, Any], message: str):
    with EpisodeWriter(tmp_path, "a", {"time": ColumnSpec()}) as episode:
        episode.add_row({"time": 0})
        with pytest.raises(rc.ArgumentError, match=f"episode 'a': {message}"):
            episode.commit(**arguments)
        episode.commit(success=True)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"time": [0, 1], "q": [[1, 2], [3]]}, "column 'q': the value is no array"),
        ({"time": [0, 1, 2], "q": [[1, 2]]}, "column 'q' has 1 rows, column 'time' has 3"),
        ({"time": 0, "q": [[1, 2]]}, r"column 'time' takes the shape \(1,\), got \(\)"),
        ([[1, 2]], r"a row takes \{column: value\}"),
    ],
)
def test_wrong_rows_name_their_column(tmp_path: Path, values: Any, message: str):
    columns = {"time": ColumnSpec(), "q": ColumnSpec(shape=2)}
    with EpisodeWriter(tmp_path, "a", columns) as episode:
        with pytest.raises(rc.ArgumentError, match=message):
            episode.add_rows(values)
        episode.add_rows({"time": [0], "q": [[1, 2]]})
        episode.commit(success=True)
    assert len(rc.Dataset(tmp_path)["a"]) == 1


def test_the_dataset_of_a_run_takes_no_other_episodes(tmp_path: Path):
    (tmp_path / "dataset.json").write_text("{}")
    with pytest.raises(rc.ArgumentError, match="is the dataset of a run, whose episodes are those"):
        EpisodeWriter(tmp_path, "a", COLUMNS)
    assert [file.name for file in tmp_path.iterdir()] == ["dataset.json"]


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
    with pytest.warns(RuntimeWarning, match=r"episode 'a' was not committed and is gone"):
        begin()  # and freed
    assert not list(tmp_path.iterdir())


def test_what_a_killed_writer_left_is_removed_by_the_next(tmp_path: Path):
    def work() -> None:
        episode = EpisodeWriter(tmp_path, "a", COLUMNS)
        episode.add_row(row(0))
        os.kill(os.getpid(), signal.SIGKILL)

    process = multiprocessing.get_context("fork").Process(target=work)
    process.start()
    process.join()
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(".a.")
    other = EpisodeWriter(tmp_path, "a.b", COLUMNS)
    assert left.exists()
    with EpisodeWriter(tmp_path, "a", COLUMNS) as episode:
        assert not left.exists()
        episode.add_row(row(0))
        episode.commit(success=True)
    other.abort()
    assert [folder.name for folder in tmp_path.iterdir()] == ["a"]


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


def test_threads_do_not_mix_rows_and_images(tmp_path: Path):
    images = [np.full((16, 16, 3), 6 * i, np.uint8) for i in range(40)]

    def work(first: int) -> None:
        for i in range(first, 40, 4):
            episode.add_row({"i": i}, {"w": images[i]})

    columns, cameras = {"i": ColumnSpec("int64")}, {"w": CameraStream(16, 16, Fraction(30))}
    with EpisodeWriter(tmp_path, "a", columns, cameras) as episode:
        threads = [threading.Thread(target=work, args=(first,)) for first in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        back = rc.data.Episode(episode.commit(success=True))
    shown = [round(frame.mean() / 6) for frame in back.frames("w")]
    assert shown == back["i"].tolist()
    assert sorted(shown) == list(range(40))


def test_an_interrupt_between_row_and_image_ends_the_episode(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    with EpisodeWriter(tmp_path, "a", {"time": ColumnSpec()}, {"w": CameraStream(64, 48)}) as one:
        one.add_row({"time": 0}, {"w": rgb(0)})

        class Interrupted:
            def __init__(self, writer: Any) -> None:
                self._writer = writer

            def __getattr__(self, name: str) -> Any:
                if name == "write_frame":
                    raise KeyboardInterrupt
                return getattr(self._writer, name)

        monkeypatch.setattr(one, "_writer", Interrupted(one._writer))
        with pytest.raises(KeyboardInterrupt):
            one.add_row({"time": 1}, {"w": rgb(1)})
        assert not one.is_open
    assert not list(tmp_path.iterdir())
