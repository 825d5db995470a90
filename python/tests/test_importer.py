"""Imports of other formats: what an export wrote comes back as episodes that verify."""

from __future__ import annotations

import io
import json
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
import zarr
from PIL import Image

import foreign_datasets
import robocell
from command_line import refused, robocell_command
from exported import hashes, psnr, three_episodes
from lerobot_venv import lerobot_python
from robocell.export import export_dataset
from robocell.export._videos import encode
from robocell.importer import _episodes, import_dataset

ROBOT = "robots/rc7"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def opened(folder: Path) -> robocell.Dataset:
    """A dataset in which every byte, column and frame is in order."""
    result = robocell.data.verify(folder, decode_videos=True)
    assert result.ok, str(result)
    return robocell.Dataset(folder)


@pytest.mark.parametrize(
    "format", ["lerobot-v3", pytest.param("lerobot-v2.1", marks=pytest.mark.proof)]
)
def test_lerobot_datasets_come_back(dataset: robocell.Dataset, tmp_path: Path, format: str):
    export_dataset(dataset, tmp_path / "there", format)
    result = import_dataset(tmp_path / "there", tmp_path / "back")
    assert (result.episodes, result.cameras, result.rate, result.silent) == (3, 2, 8, 0)
    back = opened(tmp_path / "back")
    assert back.ids == [f"episode-{i:06d}" for i in range(3)]
    for own, episode in zip(back, dataset, strict=True):
        arm, opening = episode[f"{ROBOT}/arm/qpos"], episode[f"{ROBOT}/opening"]
        state = np.column_stack([arm, opening]).astype(np.float32)
        assert np.array_equal(own["observation/state"], state)
        assert own.column("observation/state").names[:2] == ["joint1", "joint2"]
        assert np.array_equal(own["reward"], episode["reward"].astype(np.float32))
        assert np.array_equal(own["success"], episode["success"])
        assert np.allclose(own["time"], np.arange(len(episode)) / 8)
        assert own.success == bool(episode["success"][-1])
        assert own.terminated
        assert own.metadata["instruction"] == episode.metadata["instruction"]
        assert own.metadata["robots"] == "rc7"
        for camera in ("wrist", "exo"):
            assert np.array_equal(own.frames(camera), episode.frames(camera)), "copied"


@pytest.mark.proof
def test_videos_with_other_key_frames_are_cut_at_the_frame(
    dataset: robocell.Dataset, tmp_path: Path
):
    """Episodes that begin between key frames: one video of all, as LeRobot may write it."""
    export_dataset(dataset, tmp_path / "there", "lerobot-v3", cameras=["exo"])
    [video] = (tmp_path / "there/videos").rglob("*.mp4")
    frames = np.concatenate([episode.frames("exo") for episode in dataset])
    encode(
        [frames.tobytes()],
        ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", "64x48", "-r", "8"],
        Fraction(8),
        video,
        "all",
    )
    import_dataset(tmp_path / "there", tmp_path / "back")
    for own, episode in zip(opened(tmp_path / "back"), dataset, strict=True):
        found, wanted = own.frames("exo"), episode.frames("exo")
        assert psnr(found, wanted) > 30
        assert psnr(found[1:], wanted[1:]) > psnr(found[1:], wanted[:-1]) + 3  # not one late


@pytest.mark.parametrize("format", ["robomimic", "aloha", "zarr"])
def test_arrays_come_back(dataset: robocell.Dataset, tmp_path: Path, format: str):
    export_dataset(dataset, tmp_path / "there", format, episodes=["1"], cameras=["exo"])
    given = {"rate": 500 / 33} if format == "zarr" else {}
    result = import_dataset(tmp_path / "there", tmp_path / "back", **given, assume_success=True)
    assert result.rate == pytest.approx(250 / 33 if not given else 500 / 33)
    assert (result.episodes, result.successes, result.silent) == (1, 1, 1)
    names = {
        "robomimic": ("observation/robot0_joint_pos", "actions_abs"),
        "aloha": ("observation/qpos", "action"),
        "zarr": ("observation/state", "action"),
    }
    state, action = names[format]
    for own, episode in zip(opened(tmp_path / "back"), dataset[1:2], strict=True):
        arm = episode[f"{ROBOT}/arm/qpos"].astype(np.float32)
        assert np.array_equal(own[state][:, :7], arm)
        assert np.array_equal(own[action][:, :7], episode[f"{ROBOT}/action/arm"].astype(np.float32))
        if format == "robomimic":
            assert own["states"].shape[0] == len(episode)
            assert own.metadata["imported"]["episode"].startswith("demo_")
        found, wanted = own.frames("exo"), episode.frames("exo")
        assert psnr(found, wanted) > 30
        assert psnr(found[1:], wanted[1:]) > psnr(found[1:], wanted[:-1]) + 3


def aloha_with_jpegs(folder: Path, rows: int = 6) -> list[Image.Image]:
    """An episode as RoboTwin writes it: JPEG files padded with zeros to one length."""
    folder.mkdir()
    images = [Image.new("RGB", (32, 16), (30 * row, 80, 250 - 40 * row)) for row in range(rows)]
    files = []
    for image in images:
        stream = io.BytesIO()
        image.save(stream, "JPEG", quality=95)
        files.append(np.frombuffer(stream.getvalue(), np.uint8))
    padded = np.zeros((rows, max(map(len, files))), np.uint8)
    for row, file in enumerate(files):
        padded[row, : len(file)] = file
    for index in (0, 10, 2):
        with h5py.File(folder / f"episode_{index}.hdf5", "w") as file:
            file.attrs["compress"] = True
            file["action"] = np.full((rows, 14), index, np.float64)
            file["observations/qpos"] = np.random.default_rng(0).normal(size=(rows, 14))
            file["observations/images/cam_high"] = padded
    return images


def test_compressed_images_of_aloha_are_decoded(tmp_path: Path):
    images = aloha_with_jpegs(tmp_path / "there")
    with pytest.raises(robocell.ArgumentError, match="does not say how many rows there are"):
        import_dataset(tmp_path / "there", tmp_path / "back")
    result = import_dataset(tmp_path / "there", tmp_path / "back", rate=50, task="stack")
    back = opened(tmp_path / "back")
    assert result.successes == 0
    assert [int(episode["action"][0, 0]) for episode in back] == [0, 2, 10]
    assert [episode.metadata["instruction"] for episode in back] == ["stack"] * 3
    assert back[0]["time"][1] == 1 / 50
    assert psnr(back[0].frames("cam_high"), np.stack([np.asarray(each) for each in images])) > 35


def test_images_in_the_tables_of_lerobot_are_decoded(tmp_path: Path):
    root = tmp_path / "there"
    (root / "meta").mkdir(parents=True)
    (root / "data/chunk-000").mkdir(parents=True)
    colours = [(200, 40, 10), (20, 220, 60), (5, 10, 240)]
    files = []
    for colour in colours:
        stream = io.BytesIO()
        Image.new("RGB", (16, 16), colour).save(stream, "PNG")
        files.append({"bytes": stream.getvalue(), "path": None})
    features = {
        "image": {"dtype": "image", "shape": [16, 16, 3], "names": None},
        "state": {"dtype": "float32", "shape": [2], "names": {"motors": ["a", "b"]}},
        "note": {"dtype": "string", "shape": [1], "names": None},
        "index": {"dtype": "int64", "shape": [1], "names": None},
    }
    info = {
        "codebase_version": "v2.0",
        "fps": 10,
        "features": features,
        "chunks_size": 1000,
        "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
    }
    (root / "meta/info.json").write_text(json.dumps(info))
    (root / "meta/episodes.jsonl").write_text(
        json.dumps({"episode_index": 0, "tasks": ["sort"], "length": 3}) + "\n"
    )
    table = {
        "image": files,
        "state": [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]],
        "note": ["a", "b", "c"],
        "index": [0, 1, 2],
        "episode_index": [0, 0, 0],
    }
    pq.write_table(pa.table(table), root / "data/chunk-000/episode_000000.parquet")
    import_dataset(root, tmp_path / "back")
    [episode] = opened(tmp_path / "back")
    assert episode.columns == ["state", "time"]
    assert list(episode.column("state").names) == ["a", "b"]
    assert episode["state"].tolist() == table["state"]
    assert psnr(episode.frames("image")[:, 8, 8], np.array(colours)) > 35


@pytest.mark.proof
def test_a_mapping_gives_columns_and_cameras_other_names(dataset: robocell.Dataset, tmp_path: Path):
    export_dataset(dataset, tmp_path / "there", "lerobot-v2.1", episodes=["0"])
    mapping = tmp_path / "names.yaml"
    mapping.write_text(
        yaml.safe_dump(
            {
                "columns": {
                    "observation.state": {f"{ROBOT}/arm/qpos": [0, 7], f"{ROBOT}/opening": [7, 8]},
                    "action": {f"{ROBOT}/action/arm": [0, 7], f"{ROBOT}/action/gripper": [7, 8]},
                    "next.reward": None,
                },
                "cameras": {
                    "observation.images.wrist": None,
                    "observation.images.exo": "front",
                },
            }
        )
    )
    import_dataset(tmp_path / "there", tmp_path / "back", mapping=mapping)
    [own] = opened(tmp_path / "back")
    assert "reward" not in own
    assert own.cameras == ["front"]
    assert list(own.column(f"{ROBOT}/arm/qpos").names) == [f"joint{i}" for i in range(1, 8)]
    assert own[f"{ROBOT}/opening"].shape == (len(own),)
    # The episodes go on to other formats.
    again = tmp_path / "table.yaml"
    again.write_text(
        yaml.safe_dump(
            {
                "features": {
                    "observation.state": [f"{ROBOT}/arm/qpos", f"{ROBOT}/opening"],
                    "action": [f"{ROBOT}/action/arm", f"{ROBOT}/action/gripper"],
                }
            }
        )
    )
    result = export_dataset(tmp_path / "back", tmp_path / "again", "lerobot-v2.1", mapping=again)
    assert (result.frames, result.cameras, result.encoded) == (len(own), 1, {})
    first, second = (
        pq.read_table(tmp_path / name / "data/chunk-000/episode_000000.parquet")["action"]
        for name in ("there", "again")
    )
    assert first.to_pylist() == second.to_pylist()


def test_imported_datasets_are_said_to_have_no_cell(dataset: robocell.Dataset, tmp_path: Path):
    export_dataset(dataset, tmp_path / "there", "lerobot-v2.1", cameras=[])
    back = tmp_path / "back"
    import_dataset(tmp_path / "there", back)
    reason = f"'{back}' was imported from LeRobot v2.1, so it has no cell to act in: train "
    with pytest.raises(robocell.ArgumentError) as raised:
        robocell.envs.from_dataset(back)
    assert reason in str(raised.value)
    assert "export it, or merge it" in str(raised.value)
    for policy in ("expert", "random", "replay"):
        said = refused("evaluate", back, "--policy", policy)
        assert reason in said
        assert said.count("Evaluate a run, or a dataset that") == 1
    said = refused("replay", back)
    assert said.count(reason) == 1, "once, not for each episode"
    report = robocell_command("report", back)
    assert (report.returncode, report.stderr) == (0, "")


def test_a_missing_source_of_an_import_is_a_wrong_command(tmp_path: Path):
    (tmp_path / "kitchen").mkdir()
    said = refused("import", tmp_path / "kitchn", tmp_path / "back")
    assert f"Did you mean '{tmp_path / 'kitchen'}'?" in said
    (tmp_path / "names.yaml").write_text("columns: {}")
    names = ("--mapping", tmp_path / "name.yaml")
    said = refused("import", tmp_path / "kitchen", tmp_path / "back", *names)
    assert f"Did you mean '{tmp_path / 'names.yaml'}'?" in said


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"colums": {}}, "no field 'colums'. Did you mean 'columns'? Its fields: columns, cameras"),
        ({"columns": {"x": 3}}, "columns.x is a column, null, or parts such as"),
        ({"columns": {"observation.stat": "a"}}, "has no column 'observation.stat'. Did you mean"),
        ({"cameras": {"observation.images.top": "a"}}, "has no camera 'observation.images.top'"),
        ({"columns": {"action": {"a": [0, 9]}}}, "'action' has 8 numbers; the part [0, 9] ends"),
        ({"columns": {"action": "reward"}}, "two columns would be 'reward'"),
    ],
)
def test_mistakes_in_a_mapping_are_named(
    dataset: robocell.Dataset, tmp_path: Path, content: Any, message: str
):
    export_dataset(dataset, tmp_path / "there", "lerobot-v2.1", episodes=["0"], cameras=[])
    mapping = tmp_path / "names.yaml"
    mapping.write_text(yaml.safe_dump(content))
    with pytest.raises(robocell.Error) as raised:
        import_dataset(tmp_path / "there", tmp_path / "back", mapping=mapping)
    assert message in str(raised.value)
    assert not (tmp_path / "back").exists()


def test_a_column_whose_name_begins_another_becomes_its_value(tmp_path: Path):
    root = zarr.open_group(str(tmp_path / "a.zarr"), mode="w", zarr_format=2)
    for name in ("pose", "pose/extra"):
        root.create_array(f"data/{name.replace('/', '.')}", data=np.ones((4, 2), np.float32))
    root.create_array("meta/episode_ends", data=np.array([1, 4]))
    mapping = tmp_path / "names.yaml"
    mapping.write_text("columns: {pose: pose, pose.extra: pose/extra}\n")
    import_dataset(tmp_path / "a.zarr", tmp_path / "back", rate=10, mapping=mapping)
    back = opened(tmp_path / "back")
    assert [len(episode) for episode in back] == [1, 3]
    assert set(back[0].columns) == {"pose/value", "pose/extra", "time"}


def test_the_command_reports_filters_and_says_what_is_unknown(
    dataset: robocell.Dataset, tmp_path: Path
):
    export_dataset(dataset, tmp_path / "there", "aloha", cameras=[], episodes=["0", "2"])
    result = robocell_command("import", tmp_path / "there", tmp_path / "back")
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("ALOHA HDF5: 2 episodes, ")
    assert "without a result: 2 episodes, counted as failures. --assume-success" in result.stdout
    said = robocell_command("report", tmp_path / "back")
    assert said.returncode == 0, said.stderr
    kept = robocell_command("filter", tmp_path / "back", tmp_path / "kept", "--where", "length > 0")
    assert kept.stdout.startswith("2 of 2 episodes")
    opened(tmp_path / "kept")


def test_what_cannot_be_imported_is_named(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "out"
    assert "is a dataset of robocell already" in refused("import", dataset.folder, out)
    assert "no format 'lerobt'. Did you mean 'lerobot'?" in refused(
        "import", dataset.folder, out, "--format", "lerobt"
    )
    assert f"no file or folder '{tmp_path / 'none'}'." in refused("import", tmp_path / "none", out)
    old = tmp_path / "old"
    (old / "meta").mkdir(parents=True)
    info = {"codebase_version": "v1.6", "fps": 10, "features": {}}
    (old / "meta/info.json").write_text(json.dumps(info))
    assert "of version v1.6; versions that can be imported: v2.0, v2.1, v3.0" in refused(
        "import", old, out
    )
    (old / "meta/info.json").write_text("{")
    assert "info.json'" in refused("import", old, out, code=3)


def test_damaged_sources_leave_nothing(dataset: robocell.Dataset, tmp_path: Path):
    shortest, *_, longest = sorted(dataset, key=len)
    assert len(shortest) < len(longest)
    export_dataset(
        dataset, tmp_path / "there", "lerobot-v2.1", episodes=[longest.id], cameras=["exo"]
    )
    [video] = (tmp_path / "there/videos").rglob("*.mp4")
    video.unlink()
    video.write_bytes((shortest.folder / "exo.mp4").read_bytes())
    with pytest.raises(robocell.IoError, match="the dataset is damaged"):
        import_dataset(tmp_path / "there", tmp_path / "back")
    assert not (tmp_path / "back").exists()
    video.write_bytes(b"no video")
    with pytest.raises(robocell.IoError, match="is no MP4 file"):
        import_dataset(tmp_path / "there", tmp_path / "back")


def test_an_interrupted_import_continues_with_the_same_bytes(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    export_dataset(dataset, tmp_path / "there", "lerobot-v3", cameras=["exo"])
    commit = robocell.data.EpisodeWriter.commit

    def full(episode: robocell.data.EpisodeWriter, *arguments: Any, **options: Any) -> Path:
        if episode.id == "episode-000002":
            episode.abort()
            raise robocell.IoError("episode 'episode-000002' is not saved: No space left on device")
        return commit(episode, *arguments, **options)

    monkeypatch.setattr(_episodes.EpisodeWriter, "commit", full)
    with pytest.raises(
        robocell.IoError, match=r"No space left .*; the same import continues there"
    ):
        import_dataset(tmp_path / "there", tmp_path / "back")
    assert not (tmp_path / "back").exists()
    monkeypatch.undo()
    killed = tmp_path / ".back.partial" / ".episode-000002.4194999.1.partial"
    (killed / "content").mkdir(parents=True)
    (tmp_path / ".back.partial" / "episode-000002").mkdir()  # committed, and not noted any more
    assert import_dataset(tmp_path / "there", tmp_path / "back").resumed == 2
    assert import_dataset(tmp_path / "there", tmp_path / "other").resumed == 0
    assert not list((tmp_path / "back").glob(".*"))
    first, second = hashes(tmp_path / "back"), hashes(tmp_path / "other")
    data = {name for name in first if not name.endswith("episode.json")}
    assert {name: first[name] for name in data} == {name: second[name] for name in data}


def av1_dataset(folder: Path) -> Path:
    """A LeRobot dataset whose video is AV1, and the path of that video."""
    foreign_datasets.lerobot_v3(folder)
    [video] = folder.rglob("*.mp4")
    encoder = ["-c:v", "libaom-av1", "-cpu-used", "8", "-crf", "30", "-g", "2"]
    noise = f"testsrc2=size=64x48:rate=10:duration={sum(foreign_datasets.ROWS) / 10}"
    source = ["ffmpeg", "-v", "error", "-y", "-f", "lavfi", "-i", noise, "-pix_fmt", "yuv420p"]
    subprocess.run([*source, *encoder, video], check=True)
    return video


def test_av1_videos_are_decoded_strictly(tmp_path: Path):
    video = av1_dataset(tmp_path / "there")
    assert import_dataset(tmp_path / "there", tmp_path / "back").rows == sum(foreign_datasets.ROWS)
    opened(tmp_path / "back")
    whole = video.read_bytes()
    begin = whole.index(b"mdat") + 4
    size = int.from_bytes(whole[begin - 8 : begin - 4], "big") - 8
    for number, at in enumerate(range(begin + size // 4, begin + size - 40, size // 4)):
        damaged = bytearray(whole)
        for place in range(at, at + 30):
            damaged[place] ^= 0x5A
        video.write_bytes(damaged)
        with pytest.raises(robocell.IoError, match="cannot cut"):
            import_dataset(tmp_path / "there", tmp_path / f"damaged{number}")
        assert not (tmp_path / f"damaged{number}").exists()


WRITE = """
import sys

import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

image = {"shape": (48, 64, 3), "names": ["height", "width", "channels"]}
features = {
    "observation.state": {"dtype": "float32", "shape": (3,), "names": ["a", "b", "c"]},
    "observation.images.top": image | {"dtype": "video"},
    "observation.images.still": image | {"dtype": "image"},
}
dataset = LeRobotDataset.create("local/x", fps=10, features=features, root=sys.argv[1])
for episode in range(3):
    for row in range(20 + episode):
        frame = np.full((48, 64, 3), 0, np.uint8)
        frame[:, :, 0] = 80 * episode
        frame[:, 3 * row % 60 : 3 * row % 60 + 4, 1] = 255
        own = {name: frame for name in features if "images" in name}
        state = np.array([episode, row, 1], np.float32)
        dataset.add_frame({"observation.state": state, "task": f"do {episode}"} | own)
    dataset.save_episode()
dataset.finalize()
"""


@pytest.mark.soak
def test_a_dataset_that_lerobot_wrote_is_imported(tmp_path: Path):
    """One AV1 video of all episodes, and PNG files in the tables."""
    command = [lerobot_python(), "-c", WRITE, tmp_path / "there"]
    subprocess.run(command, check=True)
    import_dataset(tmp_path / "there", tmp_path / "back")
    for index, episode in enumerate(opened(tmp_path / "back")):
        rows = np.arange(20 + index)
        assert np.array_equal(episode["observation/state"][:, 1], rows)
        assert episode.metadata["instruction"] == f"do {index}"
        for camera in ("top", "still"):
            frames = episode.frames(camera).astype(int)
            bright = (frames[:, :, :, 1].mean(axis=1) > 128).argmax(axis=1)
            assert np.abs(bright - 3 * rows % 60).max() <= 1, "frame i is row i"
            assert np.abs(frames[..., 0] - 80 * index).mean() < 30
