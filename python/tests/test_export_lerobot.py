"""Exports to LeRobot, held against what LeRobot's readers rely on and against the episodes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import textwrap
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import mujoco
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from numpy.typing import NDArray

import robocell
from command_line import refused, robocell_command
from exported import INSTALLED, hashes, psnr, three_episodes
from read_back import decoded
from robocell.data import CameraStream, ColumnSpec, EpisodeWriter
from robocell.export import _lerobot_rows as lerobot_rows
from robocell.export import _lerobot_v3 as lerobot_v3
from robocell.export import _lerobot_v21 as lerobot_v21
from robocell.export import export_dataset
from robocell.export._mp4 import Mp4
from robocell.export._source import choose
from robocell.export._statistics import Images, Vectors

FPS = 8  # of episodes with 250/33 rows per second
SIZE = (48, 64)
ARM = [f"joint{i}" for i in range(1, 8)]
ROBOT = "robots/rc7"
WRIST, EXO = "observation.images.wrist", "observation.images.exo"
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def exported(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("exported") / "lerobot"
    export_dataset(dataset, out)
    return out


def read_json(path: Path) -> Any:
    return json.loads(path.read_text())


def info_of(root: Path) -> Any:
    return read_json(root / "meta/info.json")


def episodes_of(root: Path) -> list[dict[str, Any]]:
    """As readers do: every file of meta/episodes."""
    files = sorted((root / "meta/episodes").glob("*/*.parquet"))
    return pa.concat_tables([pq.read_table(file) for file in files]).to_pylist()


def data_file(root: Path, episode: dict[str, Any]) -> Path:
    place = {name: episode[f"data/{name}"] for name in ("chunk_index", "file_index")}
    return root / info_of(root)["data_path"].format(**place)


def video_file(root: Path, episode: dict[str, Any], key: str) -> Path:
    place = {name: episode[f"videos/{key}/{name}"] for name in ("chunk_index", "file_index")}
    return root / info_of(root)["video_path"].format(video_key=key, **place)


def rows_of(root: Path, episode: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """The rows of an episode, found by its index."""
    table = pq.read_table(data_file(root, episode))
    own = table.filter(pa.compute.equal(table["episode_index"], episode["episode_index"]))
    return {name: np.array(own[name].to_pylist()) for name in own.column_names}


def frames_at(root: Path, episode: dict[str, Any], key: str) -> NDArray[Any]:
    """The frames that a decoder finds at the timestamps of the rows."""
    video = video_file(root, episode, key)
    times = frame_times(video)
    wanted = episode[f"videos/{key}/from_timestamp"] + rows_of(root, episode)["timestamp"]
    nearest = np.abs(times[None] - wanted[:, None]).argmin(axis=1)
    assert np.abs(times[nearest] - wanted).max() < 1e-4, "the reader's tolerance"
    exact = ("-vf", "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact")
    return decoded(video, *exact)[nearest]


def frame_times(video: Path) -> NDArray[Any]:
    command = ["ffprobe", "-v", "error", "-select_streams", "v", "-of", "json"]
    command += ["-show_entries", "packet=pts:stream=time_base,avg_frame_rate", str(video)]
    said = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    [stream] = said["streams"]
    assert Fraction(stream["avg_frame_rate"]) == FPS
    base = Fraction(stream["time_base"])
    exact = [packet["pts"] * base for packet in said["packets"]]
    assert exact == [Fraction(i, FPS) for i in range(len(exact))]
    return np.array([float(time) for time in exact])


def test_info_has_what_readers_rely_on(dataset: robocell.Dataset, exported: Path):
    info = info_of(exported)
    rows = sum(len(episode) for episode in dataset)
    assert info["codebase_version"] == "v3.0"
    assert (info["fps"], info["robot_type"], info["chunks_size"]) == (FPS, "rc7", 1000)
    assert (info["total_episodes"], info["total_frames"]) == (3, rows)
    assert info["splits"] == {"train": "0:3"}
    assert info["data_path"] == "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
    features = info["features"]
    assert features["observation.state"] == {
        "dtype": "float32",
        "shape": [8],
        "names": [*ARM, "opening"],
    }
    assert features["action"]["names"] == [*ARM, "opening"]
    assert features["next.done"] == {"dtype": "bool", "shape": [1], "names": ["done"]}
    for name, dtype in lerobot_rows.OWN.items():
        assert features[name] == {"dtype": dtype, "shape": [1], "names": None}
    video = features[WRIST]
    assert (video["dtype"], video["shape"]) == ("video", [*SIZE, 3])
    assert video["names"] == ["height", "width", "channels"]
    assert video["info"]["video.codec"] == "h264"
    assert video["info"]["video.fps"] == FPS
    assert not video["info"]["has_audio"]


def test_rows_are_the_columns_of_the_episodes(dataset: robocell.Dataset, exported: Path):
    info, episodes = info_of(exported), episodes_of(exported)
    assert [each["length"] for each in episodes] == [len(episode) for episode in dataset]
    at = 0
    for index, (described, episode) in enumerate(zip(episodes, dataset, strict=True)):
        count = len(episode)
        rows = rows_of(exported, described)
        expected = {
            "observation.state": [
                episode[f"{ROBOT}/arm/qpos"],
                episode[f"{ROBOT}/opening"][:, None],
            ],
            "action": [episode[f"{ROBOT}/action/arm"], episode[f"{ROBOT}/action/gripper"]],
        }
        for name, parts in expected.items():
            assert np.array_equal(rows[name], np.hstack(parts).astype(np.float32)), name
        assert np.array_equal(rows["next.reward"], episode["reward"].astype(np.float32))
        assert np.array_equal(rows["next.success"], episode["success"])
        assert rows["next.done"].tolist() == [False] * (count - 1) + [True]
        assert rows["frame_index"].tolist() == list(range(count))
        assert rows["index"].tolist() == list(range(at, at + count))
        assert np.array_equal(rows["timestamp"], (np.arange(count) / FPS).astype(np.float32))
        assert set(rows["episode_index"]) == {index}
        assert (described["dataset_from_index"], described["dataset_to_index"]) == (at, at + count)
        assert described["tasks"] == [episode.metadata["instruction"]]
        at += count
    assert at == info["total_frames"]


def test_exported_actions_give_the_exported_states_in_plain_mujoco(
    dataset: robocell.Dataset, exported: Path, tmp_path: Path
):
    """From the recorded start on, nothing but the actions of the export acts, through mj_step."""
    for described, episode in zip(episodes_of(exported), dataset, strict=True):
        rows = rows_of(exported, described)
        binary = tmp_path / f"{episode.id}.mjb"
        robocell.Scene.build(robocell.data.recorded_scene(episode)).save_binary(binary)
        model = mujoco.MjModel.from_binary_path(str(binary))
        data = mujoco.MjData(model)
        with h5py.File(episode.folder / "steps.h5") as steps:
            start, period = steps["initial_state"][:], steps["time"][1] - steps["time"][0]
        mujoco.mj_setState(model, data, start, mujoco.mjtState.mjSTATE_INTEGRATION)
        servos = [model.actuator(f"robot_0/servo{i}").id for i in range(1, 8)]
        hand = model.actuator("robot_0/gripper").id
        joints = [model.joint(f"robot_0/{name}").qposadr[0] for name in ARM]
        for action, state in zip(rows["action"], rows["observation.state"], strict=True):
            assert np.allclose(data.qpos[joints], state[:7], atol=1e-4)
            data.ctrl[servos], data.ctrl[hand] = action[:7], 100 * action[7]
            mujoco.mj_step(model, data, round(period / model.opt.timestep))
        target = model.joint("target_joint").qposadr[0]
        lifted = episode["objects/target/pose"][-1, 2] - episode["objects/target/pose"][0, 2]
        assert data.qpos[target + 2] - episode["objects/target/pose"][0, 2] > 0.5 * lifted


@pytest.mark.parametrize("name", ["zarr", "mcap"])
def test_every_card_says_yield_and_licence(dataset: robocell.Dataset, tmp_path: Path, name: str):
    export_dataset(dataset, tmp_path / "out", name, cameras=[])
    card = (tmp_path / "out" / "README.md").read_text()
    earlier = [each for episode in dataset for each in episode.metadata["earlier_attempts"]]
    refused = sum("refused" in each for each in earlier)
    said = re.search(r"Before these episodes: (\d+) failed rollouts?, (\d+) rejected starts?", card)
    assert said is not None
    assert (int(said[1]), int(said[2])) == (len(earlier) - refused, refused)
    assert "**Licence.**" in card
    assert "robocell export" in card


def test_data_files_have_the_types_of_the_features(exported: Path):
    features = info_of(exported)["features"]
    for file in (exported / "data").rglob("*.parquet"):
        schema = pq.read_schema(file)
        assert schema.names == [name for name in features if features[name]["dtype"] != "video"]
        for name in schema.names:
            shape, dtype = features[name]["shape"], features[name]["dtype"]
            one = {"float32": pa.float32(), "int64": pa.int64(), "bool": pa.bool_()}[dtype]
            assert schema.field(name).type == (one if shape == [1] else pa.list_(one, shape[0]))
        content = pq.ParquetFile(file)
        assert content.num_row_groups == len(set(content.read()["episode_index"].to_pylist()))
        assert content.metadata.row_group(0).column(0).compression == "SNAPPY"


def test_tasks_are_read_by_pandas_with_the_task_as_index(exported: Path):
    table = pq.read_table(exported / "meta/tasks.parquet")
    described = json.loads(table.schema.metadata[b"pandas"])
    assert described["index_columns"] == ["task"]
    assert [column["name"] for column in described["columns"]] == ["task_index", "task"]
    assert table["task_index"].to_pylist() == list(range(info_of(exported)["total_tasks"]))
    tasks = table["task"].to_pylist()
    assert len(set(tasks)) == len(tasks)
    for episode in episodes_of(exported):
        [index] = set(rows_of(exported, episode)["task_index"])
        assert episode["tasks"] == [tasks[index]]


def test_frame_i_of_a_video_is_row_i(dataset: robocell.Dataset, exported: Path):
    for described, episode in zip(episodes_of(exported), dataset, strict=True):
        for key, camera in ((WRIST, "wrist"), (EXO, "exo")):
            length = (
                described[f"videos/{key}/to_timestamp"] - described[f"videos/{key}/from_timestamp"]
            )
            assert length == pytest.approx(len(episode) / FPS)
            frames = frames_at(exported, described, key)
            assert psnr(frames, episode.frames(camera)) > 60  # the frames were copied


def test_frames_are_encoded_again_for_nearer_key_frames(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "lerobot"
    result = export_dataset(dataset, out, keyframe_interval=2, cameras=["wrist"])
    assert list(result.encoded) == [WRIST]
    assert "key frames are 30 frames apart" in result.encoded[WRIST]
    assert set(result.left_out) == {"depth of wrist", "camera exo"}
    described = episodes_of(out)
    video = Mp4.read(video_file(out, described[0], WRIST))
    assert video.longest_interval <= 2
    for each, episode in zip(described, dataset, strict=True):
        assert round(each[f"videos/{WRIST}/from_timestamp"] * FPS) in video.key_frames
        frames, own = frames_at(out, each, WRIST), episode.frames("wrist")
        assert psnr(frames, own) > 30
        assert psnr(frames[1:], own[1:]) > psnr(frames[1:], own[:-1]) + 3  # not one frame late
    assert "encoded again: key frames are 30 frames apart" in (out / "README.md").read_text()


def test_statistics_are_those_of_the_rows(exported: Path):
    described = episodes_of(exported)
    rows = [rows_of(exported, each) for each in described]
    whole = read_json(exported / "meta/stats.json")
    assert set(whole) == set(info_of(exported)["features"])
    for name in rows[0]:
        everything = np.concatenate([each[name] for each in rows])
        require_statistics(whole[name], everything)
        for each, own in zip(described, rows, strict=True):
            flat = {
                key.rpartition("/")[2]: value
                for key, value in each.items()
                if key.rpartition("/")[0] == f"stats/{name}"
            }
            require_statistics(flat, own[name])


def require_statistics(found: dict[str, Any], rows: NDArray[Any]) -> None:
    values = rows.reshape(len(rows), -1).astype(float)
    expected = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0)}
    expected |= {"std": values.std(0), "count": np.array([len(values)])}
    expected |= {name: np.quantile(values, share, axis=0) for name, share in QUANTILES.items()}
    assert set(found) == set(expected)
    for name, value in expected.items():
        assert np.allclose(found[name], value, rtol=1e-9, atol=1e-9), name


def test_statistics_of_images_are_those_of_key_frames(dataset: robocell.Dataset, exported: Path):
    found = read_json(exported / "meta/stats.json")[WRIST]
    images = np.concatenate([episode.frames("wrist")[::30] for episode in dataset]) / 255
    assert found["count"] == [len(images)]
    pixels = images.reshape(-1, 3)
    for name, value in (("mean", pixels.mean(0)), ("std", pixels.std(0)), ("max", pixels.max(0))):
        assert np.shape(found[name]) == (3, 1, 1)
        assert np.allclose(np.ravel(found[name]), value, atol=1e-9), name
    assert np.allclose(np.ravel(found["q50"]), np.quantile(pixels, 0.5, axis=0), atol=1 / 255)


@pytest.mark.parametrize("kind", ["flash", "black", "noise", "marked"])
def test_i_frames_that_are_no_key_frames_are_exported(tmp_path: Path, kind: str):
    random = np.random.default_rng(0)
    scene = random.integers(0, 255, (48, 64, 3), np.uint8)

    def image(i: int) -> np.ndarray[Any, Any]:
        if kind == "noise":
            return random.integers(0, 255, (48, 64, 3), np.uint8)
        is_white, is_black = kind != "black" and i == 31, kind == "black" and i < 2
        return np.full_like(scene, 255 * is_white) if is_white or is_black else np.roll(scene, i, 1)

    names = ("robots/ur5e/arm/qpos", "robots/ur5e/arm/target", "robots/ur5e/action/arm")
    columns = {"time": ColumnSpec()} | {name: ColumnSpec(shape=6) for name in names}
    metadata, cameras = {"instruction": "x"}, {"w": CameraStream(64, 48)}
    for id in ("a", "b"):
        with EpisodeWriter(tmp_path / "d", id, columns, cameras, metadata=metadata) as episode:
            rows = {name: np.zeros((40, 6)) for name in names}
            episode.add_rows({"time": np.arange(40) / 30} | rows)
            if kind == "marked" and id == "b":  # as `ffmpeg -c copy` marks every I frame
                marked = tmp_path / "marked.mp4"
                copied = ("-i", tmp_path / "d/a/w.mp4", "-c", "copy", marked)
                subprocess.run(["ffmpeg", "-loglevel", "error", *copied], check=True)
                episode.add_video("w", marked)
                assert Mp4.read(marked).has_false_keys
            else:
                for i in range(40):
                    episode.add_frame("w", image(i))
            episode.commit(success=True)
    done = export_dataset(tmp_path / "d", tmp_path / "out", "lerobot-v3")
    assert set(done.encoded) == ({"observation.images.w"} if kind == "marked" else set())
    facts = Mp4.read(next((tmp_path / "out/videos").rglob("*.mp4")))
    assert (facts.frames, facts.has_false_keys) == (80, False)
    assert {0, 30, 40, 70} <= set(facts.key_frames)


def test_statistics_need_no_more_memory_for_more_rows(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Vectors, "KEPT", 1000)
    rows = np.random.default_rng(0).normal(size=(50_000, 3)) * [1, 10, 0.1] + 5
    found = Vectors(3)
    for part in np.array_split(rows, 77):
        found.add(part)
        assert len(found._kept) <= 1000
    result = found.result()
    assert np.allclose(result["mean"], rows.mean(0))
    assert np.allclose(result["std"], rows.std(0))
    assert result["count"] == [50_000]
    assert np.allclose((np.array(result["q90"]) - 5) / [1, 10, 0.1], 1.28, atol=0.2)
    images = Images()
    images.add(np.full((4, 4, 3), 255, np.uint8))
    assert images.result()["min"] == [[[1.0]]] * 3


@pytest.mark.proof
def test_many_files_hold_the_same_rows_as_one(
    dataset: robocell.Dataset, exported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(lerobot_v3, "VIDEO_MB", 0)
    monkeypatch.setattr(lerobot_v3, "CHUNK", 2)
    out = tmp_path / "lerobot"
    export_dataset(dataset, out)
    described = episodes_of(out)
    places = [(each["data/chunk_index"], each["data/file_index"]) for each in described]
    assert places == [(0, 0), (0, 1), (1, 0)]
    for mine, theirs in zip(described, episodes_of(exported), strict=True):
        assert mine[f"videos/{WRIST}/from_timestamp"] == 0
        assert mine["dataset_from_index"] == theirs["dataset_from_index"]
        one, other = rows_of(out, mine), rows_of(exported, theirs)
        assert all(np.array_equal(one[name], other[name]) for name in other)
        for key in (WRIST, EXO):
            assert np.array_equal(frames_at(out, mine, key), frames_at(exported, theirs, key))
    assert read_json(out / "meta/stats.json") == read_json(exported / "meta/stats.json")


@pytest.mark.parametrize(
    ("actions", "columns"),
    [
        ("joints_relative", ["arm_relative", "gripper"]),
        ("tcp_pose", ["tcp_pose", "gripper"]),
        ("tcp_displacement", ["tcp_displacement", "gripper"]),
        ("robots/rc7/action/gripper, robots/rc7/action/arm", ["gripper", "arm"]),
        ("robots/*/action/tcp_pose", ["tcp_pose"]),
    ],
)
def test_actions_are_chosen_by_name(
    dataset: robocell.Dataset, tmp_path: Path, actions: str, columns: list[str]
):
    out = tmp_path / "lerobot"
    export_dataset(dataset, out, actions=actions, cameras=[], episodes=["0"])
    [described] = episodes_of(out)
    names = [
        next(
            name
            for each in column.split("|")
            if (name := f"{ROBOT}/action/{each}") in dataset[0].columns
        )
        for column in columns
    ]
    expected = np.hstack([dataset[0][name] for name in names]).astype(np.float32)
    assert np.array_equal(rows_of(out, described)["action"], expected)
    assert info_of(out)["features"]["action"]["shape"] == [expected.shape[1]]
    assert info_of(out)["video_path"] is None
    assert not (out / "videos").exists()
    card = (out / "README.md").read_text()
    assert all(f"`{name}`" in card for name in names)


def test_a_mapping_file_adds_renames_and_removes_features(
    dataset: robocell.Dataset, tmp_path: Path
):
    table = {
        "features": {
            "observation.environment_state": ["objects/target/*"],
            "observation.phase": ["phase"],
            "next.reward": None,
        },
        "images": {"observation.images.top": "exo"},
        "task": {"text": "pick it up"},
    }
    file = tmp_path / "mapping.yaml"
    file.write_text(yaml.safe_dump(table))
    out = tmp_path / "lerobot"
    export_dataset(dataset, out, mapping=file, actions="tcp_pose")
    features = info_of(out)["features"]
    assert "next.reward" not in features
    assert features["observation.phase"]["dtype"] == "int64"
    assert [name for name in features if features[name]["dtype"] == "video"] == [
        "observation.images.top"
    ]
    for described, episode in zip(episodes_of(out), dataset, strict=True):
        rows = rows_of(out, described)
        poses = episode["objects/target/pose"].astype(np.float32)
        assert np.array_equal(rows["observation.environment_state"], poses)
        assert np.array_equal(rows["observation.phase"], episode["phase"])
        assert described["tasks"] == ["pick it up"]
        frames = frames_at(out, described, "observation.images.top")
        assert psnr(frames, episode.frames("exo")) > 60
    assert "Values: 0 open" in (out / "README.md").read_text()


def test_the_command_exports_and_the_card_says_what_is_in_it(
    dataset: robocell.Dataset, tmp_path: Path
):
    out = tmp_path / "lerobot"
    result = robocell_command("export", dataset.folder, out, "--episodes", "1:3")
    assert result.returncode == 0, result.stderr
    rows = sum(len(episode) for episode in dataset[1:])
    assert f"LeRobot v3.0: 2 episodes, {rows} frames at 8 fps, 2 cameras: {out}" in result.stdout
    assert "not exported: depth of wrist" in result.stdout
    assert "7.5758 rows per second and LeRobot v3.0 needs a whole number" in result.stderr
    card = (out / "README.md").read_text()
    for text in (
        f"2 episodes, {rows} frames at 8 fps",
        f"| {dataset[1].metadata['instruction']} | rc7 | ",
        "The episodes have 7.5758 rows per second (250/33).",
        "| 7 | opening | 1 | – | `robots/rc7/action/gripper` |",
        "`opening` is 0 closed and 1 open",
        f"| `{WRIST}` | wrist | 64x48 | h264 | copied |",
        "Not exported: depth of wrist.",
        f"robocell export {dataset.folder} {out} --episodes 1:3",
        f"| robocell, of the export | {robocell.__version__} |",
    ):
        assert text in card, card
    sources = read_json(out / "meta/robocell/episodes.json")["episodes"]
    assert [each["id"] for each in sources] == dataset.ids[1:3]
    assert not list(tmp_path.glob(".*"))


KILLED = """
    import os, signal
    from robocell.export import _card as card, export_dataset, _lerobot_v3 as lerobot_v3

    lerobot_v3.VIDEO_MB = 0  # a file for each episode
    write = lerobot_v3.write_shard

    def killed(source, path_of, options, number, *others):
        if number == {number}:
            {cut}
            os.kill(os.getpid(), signal.SIGKILL)
        return write(source, path_of, options, number, *others)

    lerobot_v3.write_shard = killed
    export_dataset({dataset!r}, {out!r})
"""


@pytest.mark.proof  # as in test_export_arrays.py
@pytest.mark.parametrize(
    ("number", "cut"),
    [(0, "pass"), (2, "path_of('data/chunk-000/file-002.parquet').touch()")],
)
def test_a_killed_export_leaves_nothing_under_its_name_and_continues(
    dataset: robocell.Dataset,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    number: int,
    cut: str,
):
    out = tmp_path / "lerobot"
    program = textwrap.dedent(KILLED).format(
        number=number, cut=cut, dataset=str(dataset.folder), out=str(out)
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    assert not out.exists()
    assert (tmp_path / ".lerobot.partial").is_dir()
    monkeypatch.setattr(lerobot_v3, "VIDEO_MB", 0)
    assert export_dataset(dataset, out).resumed == number
    assert not (tmp_path / ".lerobot.partial").exists()
    whole = tmp_path / "other" / "lerobot"
    export_dataset(dataset, whole)
    ours, theirs = hashes(out), hashes(whole)
    assert ours.pop("README.md") != theirs.pop("README.md")  # it has the command
    assert ours == theirs


def test_another_export_of_the_same_name_begins_anew(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(lerobot_v3, "_write_names", lambda *_: 1 / 0)
    out = tmp_path / "lerobot"
    with pytest.raises(ZeroDivisionError):
        export_dataset(dataset, out)
    assert not out.exists()
    monkeypatch.undo()
    assert export_dataset(dataset, out, episodes=["0"], cameras=[]).resumed == 0
    assert not (out / "videos").exists()
    assert info_of(out)["total_episodes"] == 1


def test_two_exports_of_one_name_are_refused(dataset: robocell.Dataset, tmp_path: Path):
    from robocell._staging import staging

    out = tmp_path / "lerobot"
    with (
        staging(out, {}),
        pytest.raises(robocell.ArgumentError, match="another process makes"),
    ):
        export_dataset(dataset, out)


def test_only_successes_are_chosen_on_request():
    episodes = [SimpleNamespace(success=name != "b") for name in "abc"]

    class Stand:
        """As much of a dataset as choosing needs."""

        folder, ids = "out", ["a", "b", "c"]

        def __len__(self) -> int:
            return 3

        def __contains__(self, name: str) -> bool:
            return name in self.ids

        def __getitem__(self, name: str) -> Any:
            return episodes[self.ids.index(name)]

    stand: Any = Stand()
    assert choose(stand, successes_only=True) == ["a", "c"]
    assert choose(stand, ["2", "0:2", "a"]) == ["c", "a", "b"]
    assert choose(stand, ["-1:"]) == ["c"]
    with pytest.raises(robocell.ArgumentError, match="none of the episodes succeeded"):
        choose(stand, ["b"], successes_only=True)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (
            ["--format", "lerobot-v33"],
            "no format 'lerobot-v33'. Did you mean 'lerobot-v3'? Formats: ",
        ),
        (["--format", "rlds"], "no format 'rlds'. Formats: lerobot-v3, lerobot-v2.1, "),
        (["--actions", "joint"], "no actions 'joint'. Did you mean 'joints'? There are: joints, "),
        (
            ["--actions", "robots/rc7/action/arms"],
            "features.action: episode '{first}' has no column 'robots/rc7/action/arms'. Did you "
            "mean 'robots/rc7/action/arm'?",
        ),
        (
            ["--actions", "control/ctrl"],
            "'control/ctrl' is of table 'control'; features are columns",
        ),
        (["--cameras", "wrst"], "has no camera 'wrst' with colour images. Did you mean 'wrist'?"),
        (["--episodes", "s0000_e0009"], "has no episode 's0000_e0009'."),
        (["--episodes", "5:9"], "to export: the selection is empty. It has 3: s0000_e0000"),
        (["--mapping", "none.yaml"], "no mapping file 'none.yaml'."),
    ],
)
def test_bad_arguments_are_named(
    dataset: robocell.Dataset, tmp_path: Path, options: list[str], told: str
):
    text = refused("export", dataset.folder, tmp_path / "out", *options)
    assert told.format(first=dataset[0].folder) in re.sub(r"\s+", " ", text)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"feature": {}}, "no field 'feature'. Did you mean 'features'?"),
        ({"features": ["a"]}, "features is a table of lists of columns"),
        ({"features": {"x": "phase"}}, "x is a list of columns, got 'phase'"),
        ({"features": {"index": ["phase"]}}, "features.index is written by the export itself"),
        ({"features": {"action": "joint"}}, "no actions 'joint'. Did you mean 'joints'?"),
        ({"features": {"x": ["phse"]}}, "features.x: episode '{first}' has no column 'phse'. Did"),
        (
            "features:\n  x:\n    - phase\n    - phse\n",
            ":4:7': features.x: episode '{first}' has no",
        ),
        ({"images": {"a": "top"}}, "images.a: episode '{first}' has no camera 'top'"),
        ({"task": "instructions"}, "no text 'instructions'. Did you mean 'instruction'?"),
        ({"task": 3}, "task is an entry of the metadata"),
        ("features: [", "is no YAML"),
        ("- a", "is a table with the fields features, actions, action_feature, "),
    ],
)
def test_bad_mappings_are_named(dataset: robocell.Dataset, tmp_path: Path, content: Any, told: str):
    file = tmp_path / "mapping.yaml"
    file.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    with pytest.raises(robocell.Error) as raised:
        export_dataset(dataset, tmp_path / "out", mapping=file)
    assert told.format(first=dataset[0].folder) in str(raised.value)
    assert f"mapping '{file}" in str(raised.value)
    assert not (tmp_path / "out").exists()


def test_what_is_there_is_not_replaced(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine").touch()
    text = refused("export", dataset.folder, out)
    assert f"'{out}' exists already, a folder that is not empty" in text
    assert [path.name for path in tmp_path.rglob("*")] == ["out", "mine"]
    text = refused("export", dataset.folder, dataset.folder / "lerobot")
    assert "is inside the dataset" in text
    assert "no dataset" in refused("export", tmp_path / "none", tmp_path / "new")
    no_episodes = tmp_path / "empty"
    no_episodes.mkdir()
    (no_episodes / "dataset.json").write_bytes((dataset.folder / "dataset.json").read_bytes())
    text = refused("export", no_episodes, tmp_path / "new")
    assert f"dataset '{no_episodes}' has no episodes. `robocell generate`" in text


def test_numbers_that_are_none_are_named(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    from robocell.export import _features as features

    read = features._column

    def spoilt(episode: robocell.data.Episode, name: str) -> NDArray[Any]:
        values = read(episode, name)
        if name.endswith("/opening") and episode.id == dataset.ids[1]:
            values[7] = np.nan
        return values

    monkeypatch.setattr(features, "_column", spoilt)
    with pytest.raises(robocell.ArgumentError) as raised:
        export_dataset(dataset, tmp_path / "out")
    assert f"episode '{dataset[1].folder}': column 'robots/rc7/opening' is nan in row 7" in str(
        raised.value
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("format", INSTALLED)
def test_a_refusal_before_the_first_episode_leaves_nothing(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: str
):
    from robocell.export import _features as features

    read = features._column

    def spoilt(episode: robocell.data.Episode, name: str) -> NDArray[Any]:
        return np.full(read(episode, name).shape, np.nan)

    mapping = tmp_path / "mapping.yaml"
    mapping.write_text('features: {own: ["robots/rc7/opening"]}\n')
    folder = tmp_path / "results"
    folder.mkdir()
    monkeypatch.setattr(features, "_column", spoilt)
    with pytest.raises(robocell.ArgumentError, match="is nan in row 0"):
        export_dataset(dataset, folder / "out", format, mapping=mapping)
    assert not list(folder.iterdir())


def test_a_missing_package_is_named_with_the_command_that_installs_it(
    dataset: robocell.Dataset, tmp_path: Path
):
    program = (
        "import sys; sys.modules['pyarrow'] = None\n"
        "from robocell._cli import load, main\n"
        f"sys.argv = ['robocell', 'export', {str(dataset.folder)!r}, {str(tmp_path / 'out')!r}]\n"
        "main(load(sys.argv[1:]))"
    )
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert result.returncode == 2
    assert "needs the package pyarrow, which is not installed: pip install" in result.stderr


def test_a_failing_encoder_leaves_no_result(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    program = tmp_path / "ffmpeg"
    program.write_text("#!/bin/sh\necho out of luck >&2\nexit 1\n")
    program.chmod(0o755)
    monkeypatch.setenv("ROBOCELL_FFMPEG", str(program))
    with pytest.raises(robocell.IoError, match="ffmpeg: out of luck"):
        export_dataset(dataset, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_version_2_1_has_the_rows_of_3_0_in_a_file_for_each_episode(
    dataset: robocell.Dataset, exported: Path, tmp_path: Path
):
    out = tmp_path / "lerobot"
    result = export_dataset(dataset, out, "lerobot-v2.1")
    info, described = info_of(out), read_lines(out / "meta/episodes.jsonl")
    assert info["codebase_version"] == "v2.1"
    assert (info["total_videos"], info["total_chunks"]) == (6, 1)
    assert info["features"] == info_of(exported)["features"]
    assert result.frames == info["total_frames"] == sum(len(episode) for episode in dataset)
    tasks = {line["task_index"]: line["task"] for line in read_lines(out / "meta/tasks.jsonl")}
    statistics = read_lines(out / "meta/episodes_stats.jsonl")
    for index, (each, other) in enumerate(zip(described, episodes_of(exported), strict=True)):
        place = {"episode_chunk": 0, "episode_index": index}
        table = pq.read_table(out / info["data_path"].format(**place))
        rows = {name: np.array(table[name].to_pylist()) for name in table.column_names}
        expected = rows_of(exported, other)
        assert list(rows) == list(expected)
        assert all(np.array_equal(rows[name], expected[name]) for name in expected)
        assert each == {
            "episode_index": index,
            "tasks": [tasks[rows["task_index"][0]]],
            "length": len(dataset[index]),
        }
        own = statistics[index]["stats"]
        assert statistics[index]["episode_index"] == index
        assert set(own) == set(info["features"])
        assert all(set(own[name]) == {"min", "max", "mean", "std", "count"} for name in own)
        assert np.allclose(own["action"]["mean"], rows["action"].mean(0, dtype=float))
        assert np.shape(own[WRIST]["mean"]) == (3, 1, 1)
        for key in (WRIST, EXO):
            video = out / info["video_path"].format(video_key=key, **place)
            assert len(frame_times(video)) == len(dataset[index])
            assert np.array_equal(
                decoded(video), decoded(dataset[index].folder / f"{key[19:]}.mp4")
            )


def test_modality_ranges_cover_state_and_action(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "lerobot"
    export_dataset(dataset, out, "lerobot-v2.1", episodes=["0"], actions="tcp_pose")
    modality, features = read_json(out / "meta/modality.json"), info_of(out)["features"]
    assert modality["state"] == {
        "arm": {"start": 0, "end": 7},
        "gripper": {"start": 7, "end": 8},
    }
    for kind, feature in (("state", "observation.state"), ("action", "action")):
        ranges = list(modality[kind].values())
        assert [each["start"] for each in ranges] == [0, *(each["end"] for each in ranges[:-1])]
        assert ranges[-1]["end"] == features[feature]["shape"][0]
    assert modality["video"]["wrist"] == {"original_key": WRIST}
    assert modality["annotation"] == {"human.task_description": {"original_key": "task_index"}}
    statistics = read_json(out / "meta/stats.json")
    for name in ("observation.state", "action"):
        assert {"min", "max", "mean", "std", "q01", "q99"} <= set(statistics[name])


def test_an_interrupted_export_of_version_2_1_continues(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    out = tmp_path / "lerobot"
    write = lerobot_v21._write_episode

    def full(*arguments: Any) -> Any:
        if arguments[3] == 2:
            raise OSError(28, "No space left on device")
        return write(*arguments)

    monkeypatch.setattr(lerobot_v21, "_write_episode", full)
    with pytest.raises(robocell.IoError) as raised:
        export_dataset(dataset, out, "lerobot-v2.1", cameras=[])
    assert str(raised.value) == (
        f"cannot export to '{out}': No space left on device. What is written stays in "
        f"'{tmp_path}/.lerobot.partial'; the same export continues there"
    )
    assert not out.exists()
    monkeypatch.undo()
    assert export_dataset(dataset, out, "lerobot-v2.1", cameras=[]).resumed == 2
    assert len(read_lines(out / "meta/episodes.jsonl")) == 3


def read_lines(path: Path) -> list[Any]:
    return [json.loads(line) for line in path.read_text().splitlines()]
