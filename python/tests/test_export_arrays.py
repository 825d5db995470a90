"""Exports to robomimic, Diffusion Policy and ALOHA, read back as their loaders read them."""

from __future__ import annotations

import errno
import io
import json
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import h5py
import mujoco
import numpy as np
import pytest
import yaml
import zarr
from numpy.typing import NDArray

import robocell
from command_line import refused
from exported import hashes, three_episodes
from robocell.export import _hdf5 as hdf5
from robocell.export import _videos as videos
from robocell.export import export_dataset
from robocell.export._replay_buffer import _remove_remains
from robocell.export._robomimic import masks, scaled

ROBOT = "robots/rc7"
CAMERAS = ("wrist", "exo")


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def demos(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("exported") / "robomimic"
    export_dataset(dataset, out, "robomimic")
    return out


def columns(episode: robocell.data.Episode, *names: str) -> NDArray[Any]:
    parts = [episode[f"{ROBOT}/{name}"] for name in names]
    return np.hstack([part.reshape(len(part), -1) for part in parts]).astype(np.float32)


def joints(episode: robocell.data.Episode) -> NDArray[Any]:
    return columns(episode, "action/arm", "action/gripper")


def test_robomimic_finds_what_its_loader_reads(dataset: robocell.Dataset, demos: Path):
    with h5py.File(demos / "dataset.hdf5") as file:
        names = sorted(file["data"], key=lambda name: int(name.removeprefix("demo_")))
        assert len(names) == len(dataset)
        assert file["data"].attrs["total"] == sum(len(episode) for episode in dataset)
        environment = json.loads(file["data"].attrs["env_args"])
        assert {"env_name", "type", "env_kwargs"} <= set(environment)
        train, valid = (
            {name.decode() for name in file[f"mask/{key}"]} for key in ("train", "valid")
        )
        assert train | valid == set(names)
        assert not train & valid
        for name, episode in zip(names, dataset, strict=True):
            demo = file["data"][name]
            rows = demo.attrs["num_samples"]
            assert rows == len(episode)
            assert np.array_equal(demo["rewards"], episode["reward"].astype(np.float32))
            assert demo["dones"][()].tolist() == [0] * (rows - 1) + [1]
            pose = columns(episode, "tcp_pose_in_base")
            expected = {
                "robot0_joint_pos": columns(episode, "arm/qpos"),
                "robot0_joint_vel": columns(episode, "arm/qvel"),
                "robot0_eef_pos": pose[:, :3],
                "robot0_eef_quat": pose[:, 3:],
                "robot0_gripper_qpos": columns(episode, "gripper/qpos"),
                "object": episode["objects/target/pose"].astype(np.float32),
            }
            for key, values in expected.items():
                assert np.array_equal(demo["obs"][key], values), key
                following = [*range(1, rows), rows - 1]
                assert np.array_equal(demo["next_obs"][key], values[following]), key
            for camera in CAMERAS:
                assert np.array_equal(demo["obs"][f"{camera}_image"], episode.frames(camera))
            lengths = [len(each) for each in demo.values() if isinstance(each, h5py.Dataset)]
            assert set(lengths) == {rows}


def test_robomimic_actions_are_within_one_and_can_be_undone(dataset: robocell.Dataset, demos: Path):
    reached = []
    with h5py.File(demos / "dataset.hdf5") as file:
        low, high = (file["data"].attrs[f"actions_{end}"] for end in ("min", "max"))
        for index, episode in enumerate(dataset):
            demo = file["data"][f"demo_{index}"]
            actions = demo["actions"][()]
            assert np.abs(actions).max() <= 1
            reached += [actions.min(0), actions.max(0)]
            assert np.array_equal(demo["actions_abs"], joints(episode))
            undone = low + (actions + 1) / 2 * (high - low)
            assert np.allclose(undone, joints(episode), atol=1e-6)
    assert np.array_equal(np.min(reached, 0), -np.ones(8))
    assert np.array_equal(np.max(reached, 0), np.ones(8))
    same = np.full((2, 1), 7.0)
    assert scaled(same, same[0], same[0]).tolist() == [[0], [0]]


def test_robomimic_states_are_those_of_plain_mujoco(
    dataset: robocell.Dataset, demos: Path, tmp_path: Path
):
    episode = dataset[1]
    with h5py.File(demos / "dataset.hdf5") as file:
        states = file["data/demo_1/states"][()]
    assert np.allclose(states[:, 0], episode["time"], atol=1e-9)
    binary = tmp_path / "scene.mjb"
    robocell.Scene.build(robocell.data.recorded_scene(episode)).save_binary(binary)
    model = mujoco.MjModel.from_binary_path(str(binary))
    data = mujoco.MjData(model)
    assert states.shape == (len(episode), 1 + model.nq + model.nv)
    for row in (0, 20, len(episode) - 1):
        data.qpos, data.qvel = np.split(states[row, 1:], [model.nq])
        mujoco.mj_kinematics(model, data)
        assert np.allclose(
            data.joint("target_joint").qpos[:3], episode["objects/target/pose"][row, :3]
        )
        arm = [data.joint(f"robot_0/joint{i}").qpos[0] for i in range(1, 8)]
        assert np.allclose(arm, episode[f"{ROBOT}/arm/qpos"][row])


@pytest.mark.parametrize(("count", "valid"), [(1, 0), (2, 1), (3, 1), (40, 4)])
def test_masks_hold_a_tenth_out(count: int, valid: int):
    split = masks(count)
    assert len(split["train"]) == count - valid
    assert len(split.get("valid", [])) == valid
    assert len({*split["train"], *split.get("valid", [])}) == count


def test_diffusion_policy_reads_the_replay_buffer(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(videos, "BLOCK_BYTES", 7 * 64 * 48 * 3)  # several blocks per episode
    out = tmp_path / "buffer"
    export_dataset(dataset, out, "zarr", actions="tcp_pose")
    root = zarr.open_group(str(out / "replay_buffer.zarr"), mode="r")
    ends = root["meta/episode_ends"][:]
    assert ends.dtype == np.int64
    assert ends.tolist() == np.cumsum([len(episode) for episode in dataset]).tolist()
    data = dict(root["data"].arrays())
    assert set(data) == {"state", "action", "wrist_image", "exo_image"}
    assert {array.shape[0] for array in data.values()} == {ends[-1]}
    assert {array.metadata.zarr_format for array in data.values()} == {2}
    for end, episode in zip(ends, dataset, strict=True):
        own = slice(end - len(episode), end)
        assert np.array_equal(data["state"][own], columns(episode, "arm/qpos", "opening"))
        wanted = columns(episode, "action/tcp_pose", "action/gripper")
        assert np.array_equal(data["action"][own], wanted)
        for camera in CAMERAS:
            assert np.array_equal(data[f"{camera}_image"][own], episode.frames(camera))


def test_act_reads_the_episodes(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "aloha"
    export_dataset(dataset, out, "aloha")
    for index, episode in enumerate(dataset):
        with h5py.File(out / f"episode_{index}.hdf5") as file:
            assert file.attrs["sim"]
            assert not file.attrs["compress"]
            assert file.attrs["instruction"] == episode.metadata["instruction"]
            assert np.array_equal(file["action"], joints(episode))
            qpos, qvel = file["observations/qpos"][()], file["observations/qvel"][()]
            assert np.array_equal(qpos, columns(episode, "arm/qpos", "opening"))
            assert qvel.shape == qpos.shape
            assert np.array_equal(qvel[:, :7], columns(episode, "arm/qvel"))
            change = np.diff(episode[f"{ROBOT}/opening"]) / np.diff(episode["time"])
            assert np.allclose(qvel[:, 7], [0, *change], atol=1e-5)
            assert set(file["observations/images"]) == set(CAMERAS)
            for camera in CAMERAS:
                assert np.array_equal(file[f"observations/images/{camera}"], episode.frames(camera))
    card = (out / "README.md").read_text()
    lengths = sorted(len(episode) for episode in dataset)
    assert f"Episodes have {lengths[0]} to {lengths[-1]} rows." in card
    assert "A row is 33/250 s." in card


KILLED = """
    import os, signal
    from robocell.export import export_dataset, _{module} as module

    begun = []
    blocks = module.blocks

    def killed(source, item, camera):
        begun.append(item.id)
        if len(begun) == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return blocks(source, item, camera)

    module.blocks = killed
    export_dataset({dataset!r}, {out!r}, {format!r}, cameras=["wrist"])
"""


@pytest.mark.parametrize(
    ("format", "module"),
    [
        ("robomimic", "hdf5"),
        pytest.param("zarr", "replay_buffer", marks=pytest.mark.proof),
        pytest.param("aloha", "hdf5", marks=pytest.mark.proof),
    ],
)
def test_a_killed_export_leaves_nothing_under_its_name_and_continues(
    dataset: robocell.Dataset, tmp_path: Path, format: str, module: str
):
    out = tmp_path / "out"
    program = textwrap.dedent(KILLED).format(
        module=module,
        dataset=str(dataset.folder),
        out=str(out),
        format=format,
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    assert not out.exists()
    assert export_dataset(dataset, out, format, cameras=["wrist"]).resumed == 2
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert not list(out.rglob(".state"))
    whole = tmp_path / "whole" / "out"
    export_dataset(dataset, whole, format, cameras=["wrist"])
    ours, theirs = hashes(out), hashes(whole)
    assert ours.pop("README.md") != theirs.pop("README.md")  # it has the command
    assert ours == theirs


FULL = """
    import resource
    from pathlib import Path
    import numpy as np
    from robocell.export._hdf5 import new_file

    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))
    kept = []
    try:
        with new_file(Path({path!r})) as file:
            for i in range(100):
                file.add(f"a/{{i}}", np.full(5000, i))
                kept.append(i)
    except OSError as error:
        print(len(kept), error)
"""


def test_a_full_disk_is_an_error_and_no_crash(tmp_path: Path):
    program = textwrap.dedent(FULL).format(path=str(tmp_path / "full.hdf5"))
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (result.returncode, result.stderr) == (0, "")
    kept, _, error = result.stdout.partition(" ")
    assert int(kept) <= 3
    assert "File too large" in error


@pytest.mark.parametrize("format", ["robomimic", "aloha", "molmospaces"])
def test_an_export_to_a_full_disk_leaves_no_result(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: str
):
    write = hdf5._Guarded._write

    def full(guarded: hdf5._Guarded, view: memoryview) -> None:
        if guarded.tell() + len(view) > 20_000:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(guarded, view)

    monkeypatch.setattr(hdf5._Guarded, "_write", full)
    out = tmp_path / "out"
    cameras = [] if format == "molmospaces" else ["wrist"]
    with pytest.raises(robocell.IoError, match="No space left on device"):
        export_dataset(dataset, out, format, cameras=cameras, episodes=["0"])
    assert not out.exists()


def test_what_a_full_disk_does_not_take_is_read_back(tmp_path: Path):
    path = tmp_path / "file"
    with io.FileIO(path, "w+") as raw:
        guarded = hdf5._Guarded(raw)
        assert guarded.write(b"abcdef") == 6
        guarded.error = OSError("full")
        guarded.seek(4)
        guarded.write(b"XYZ")
        guarded.seek(1)
        assert guarded.read(8) == b"bcdXYZ\0\0"
        assert guarded.seek(0, 2) == 7
    assert path.read_bytes() == b"abcdef"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--format", "zar"], "no format 'zar'. Did you mean 'zarr'? Formats: lerobot-v3, "),
        (
            ["--format", "zarr", "--preset", "droid"],
            "format 'zarr' takes no preset. Formats that do: lerobot-v3, lerobot-v2.1",
        ),
        (
            ["--format", "aloha", "--keyframe-interval", "2"],
            "format 'aloha' takes no keyframe_interval. Formats that do: lerobot-v3",
        ),
        (["--format", "robomimic", "--cameras", "wrst"], "Did you mean 'wrist'?"),
    ],
)
def test_bad_arguments_are_named(
    dataset: robocell.Dataset, tmp_path: Path, options: list[str], told: str
):
    assert told in refused("export", dataset.folder, tmp_path / "out", *options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("format", "feature", "told"),
    [
        ("robomimic", "actions", "robomimic datasets have actions"),
        ("aloha", "observations/qpos", "ALOHA episodes have 'observations/qpos'"),
    ],
)
def test_a_format_needs_its_features(
    dataset: robocell.Dataset, tmp_path: Path, format: str, feature: str, told: str
):
    file = tmp_path / "mapping.yaml"
    file.write_text(yaml.safe_dump({"features": {feature: None}}))
    with pytest.raises(robocell.ArgumentError, match=told):
        export_dataset(dataset, tmp_path / "out", format, mapping=file)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("format", "content", "told"),
    [
        ("robomimic", {"features": {"next_obs/x": ["phase"]}}, "features.next_obs/x is written by"),
        ("robomimic", {"images": {"states": "wrist"}}, "images.states is written by the export"),
        (
            "molmospaces",
            {"features": {"obs/sensor_data/wrist": ["phase"]}},
            "features.obs/sensor_data/wrist is written by the export itself",
        ),
    ],
)
def test_arrays_of_the_format_itself_cannot_be_replaced(
    dataset: robocell.Dataset, tmp_path: Path, format: str, content: Any, told: str
):
    file = tmp_path / "mapping.yaml"
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(robocell.SpecError, match=told):
        export_dataset(dataset, tmp_path / "out", format, mapping=file)
    assert [each.name for each in tmp_path.iterdir()] == ["mapping.yaml"]


@pytest.mark.proof
def test_umi_reads_the_zip(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "umi"
    result = export_dataset(dataset, out, "umi")
    assert (result.episodes, result.cameras) == (3, 2)
    store = zarr.storage.ZipStore(out / "dataset.zarr.zip", mode="r")
    root = zarr.open_group(store, mode="r")
    ends = root["meta/episode_ends"][:]
    data = dict(root["data"].arrays())
    own = ("eef_pos", "eef_rot_axis_angle", "gripper_width", "demo_start_pose", "demo_end_pose")
    assert set(data) == {"camera0_rgb", "camera1_rgb", *(f"robot0_{name}" for name in own)}
    assert {array.metadata.zarr_format for array in data.values()} == {2}
    codec = {"id": "imagecodecs_jpegxl", "effort": 3, "lossless": True, "numthreads": 1}
    assert data["camera0_rgb"].metadata.to_dict()["compressor"] == codec
    for end, episode in zip(ends, dataset, strict=True):
        rows = slice(end - len(episode), end)
        pose = episode[f"{ROBOT}/tcp_pose"]
        assert np.allclose(data["robot0_eef_pos"][rows], pose[:, :3], atol=1e-6)
        vectors = np.array([robocell.Pose(quaternion=each[3:]).rotvec for each in pose])
        assert np.allclose(data["robot0_eef_rot_axis_angle"][rows], vectors, atol=1e-6)
        assert np.allclose(data["robot0_gripper_width"][rows, 0], episode[f"{ROBOT}/opening"])
        for name, row in (("start", 0), ("end", -1)):
            poses = data[f"robot0_demo_{name}_pose"][rows]
            assert np.allclose(poses, [*pose[row, :3], *vectors[row]], atol=1e-6)
        for camera, feature in (("wrist", "camera0_rgb"), ("exo", "camera1_rgb")):
            assert np.array_equal(data[feature][rows], episode.frames(camera))


@pytest.mark.proof  # to compress images takes longest of all formats
def test_the_zip_of_umi_has_the_same_bytes_again(dataset: robocell.Dataset, tmp_path: Path):
    one, again = tmp_path / "umi", tmp_path / "again" / "umi"
    for out in (one, again):
        export_dataset(dataset, out, "umi")
    assert hashes(one)["dataset.zarr.zip"] == hashes(again)["dataset.zarr.zip"]


def test_a_replay_buffer_keeps_only_images_of_a_killed_export(tmp_path: Path):
    """Numbers are written again, and half files of zarr have no place in a result."""
    images = {"data/wrist/.zarray", "data/wrist/0.0.0.0", "data/side/wide/3.0.0.0", ".zgroup"}
    others = {"data/wrist/1.0.0.0.77.partial", "data/action/.zarray", "meta/episode_ends/0"}
    for name in images | others:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    _remove_remains(tmp_path, ["wrist", "side/wide"])
    assert {str(f.relative_to(tmp_path)) for f in tmp_path.rglob("*") if f.is_file()} == images
