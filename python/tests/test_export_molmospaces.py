"""Exports to MolmoSpaces, read back by the rules of its own converter to LeRobot."""

from __future__ import annotations

import json
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import robocell
from command_line import refused
from exported import hashes, psnr, three_episodes
from read_back import decoded
from robocell.export import export_dataset

ROBOT = "robots/rc7"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def exported(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("exported") / "molmospaces"
    export_dataset(dataset, out, "molmospaces")
    return out


def text_of(row: NDArray[np.uint8]) -> Any:
    return json.loads(row.tobytes().decode().rstrip("\x00"))


def trajectories(root: Path) -> Iterator[tuple[Path, int]]:
    """The file and the rows of every trajectory, as the index lists them."""
    index = json.loads((root / "train/valid_trajectory_index.json").read_text())
    for files in index.values():
        for name, lengths in files.items():
            for key, rows in lengths.items():
                assert key == "traj_0"
                yield root / "train" / name, rows


def test_states_and_actions_are_paired_as_readers_do(dataset: robocell.Dataset, exported: Path):
    found = list(trajectories(exported))
    assert len(found) == len(dataset)
    for (path, rows), episode in zip(found, dataset, strict=True):
        assert rows == len(episode) + 2
        effective = rows - 2  # what readers keep
        with h5py.File(path) as file:
            group = file["traj_0"]
            scene = json.loads(group["obs_scene"][()].decode())
            assert scene["task_description"] == episode.metadata["instruction"]
            assert round(1000 / scene["policy_dt_ms"], 4) == 7.5758
            states = [text_of(row) for row in group["obs/agent/qpos"][:effective]]
            actions = [text_of(row) for row in group["actions/joint_pos"][1 : effective + 1]]
            poses = [text_of(row) for row in group["actions/ee_pose"][1 : effective + 1]]
            qpos = episode[f"{ROBOT}/arm/qpos"]
            assert np.allclose([state["arm"] for state in states], qpos, atol=1e-6)
            fingers = episode[f"{ROBOT}/gripper/qpos"]
            assert np.allclose([state["gripper"] for state in states], fingers, atol=1e-6)
            arm = episode[f"{ROBOT}/action/arm"]
            assert np.allclose([action["arm"] for action in actions], arm, atol=1e-6)
            closing = 255 * (1 - episode[f"{ROBOT}/action/gripper"])
            assert np.allclose([action["gripper"] for action in actions], closing)
            first = [0, 1, 2, 6, 3, 4, 5]  # x y z, w x y z
            tcp = episode[f"{ROBOT}/action/tcp_pose"][:, first]
            assert np.allclose([pose["arm"] for pose in poses], tcp, atol=1e-6)
            own = episode[f"{ROBOT}/tcp_pose_in_base"][:, first]
            assert np.allclose(group["obs/extra/tcp_pose"][:effective], own, atol=1e-6)
            assert text_of(group["actions/joint_pos"][-1]) == {}
            assert np.allclose(group["rewards"][1:-1], episode["reward"])
            assert np.array_equal(group["success"][1:-1], episode["success"])
            assert np.array_equal(group["terminated"][1:-1], episode["terminated"])
            assert not group["fail"][()].any()
            own_rows = {len(group[name]) for name in ("rewards", "fail", "obs/agent/qvel")}
            assert own_rows == {rows}


def test_videos_are_found_and_frame_i_is_state_i(dataset: robocell.Dataset, exported: Path):
    for (path, rows), episode in zip(trajectories(exported), dataset, strict=True):
        with h5py.File(path) as file:
            for camera in ("wrist", "exo"):
                name = file[f"traj_0/obs/sensor_data/{camera}"][()].tobytes()
                assert len(name) == 100
                frames = decoded(path.parent / name.decode().rstrip("\x00"))
                own = episode.frames(camera)
                assert len(frames) == rows
                assert psnr(frames[:-2], own) > 30
                assert psnr(frames[1:-2], own[1:]) > psnr(frames[1:-2], own[:-1]) + 3
                assert psnr(frames[-1], frames[-3]) > 40


def test_cameras_have_their_poses(dataset: robocell.Dataset, exported: Path):
    path, rows = next(trajectories(exported))
    episode = dataset[0]
    with h5py.File(path) as file:
        own = file["traj_0/obs/sensor_param/wrist"]
        to_camera = episode["cameras/wrist/extrinsics"]
        assert own["extrinsic_cv"].shape == (rows, 3, 4)
        assert np.allclose(own["extrinsic_cv"][:-2], to_camera[:, :3], atol=1e-6)
        assert np.allclose(own["intrinsic_cv"][5], episode["cameras/wrist/intrinsics"])
        pose = own["cam2world_gl"][7]
    # A point one metre in front of the camera: -z of OpenGL's axes, z of OpenCV's.
    point = pose @ [0, 0, -1, 1]
    assert np.allclose(to_camera[7] @ point, [0, 0, 1, 1], atol=1e-5)


KILLED = """
    import os, signal
    from robocell.export import export_dataset, _molmospaces as molmospaces

    write = molmospaces._write_trajectory

    def killed(source, item, place, path):
        if item.id == source.items[2].id:
            os.kill(os.getpid(), signal.SIGKILL)
        write(source, item, place, path)

    molmospaces._write_trajectory = killed
    export_dataset({dataset!r}, {out!r}, "molmospaces", cameras=["wrist"])
"""


@pytest.mark.proof  # as in test_export_arrays.py
def test_a_killed_export_leaves_nothing_under_its_name_and_continues(
    dataset: robocell.Dataset, tmp_path: Path
):
    out = tmp_path / "out"
    program = textwrap.dedent(KILLED).format(dataset=str(dataset.folder), out=str(out))
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    assert not out.exists()
    assert export_dataset(dataset, out, "molmospaces", cameras=["wrist"]).resumed == 2
    whole = tmp_path / "whole" / "out"
    export_dataset(dataset, whole, "molmospaces", cameras=["wrist"])
    ours, theirs = hashes(out), hashes(whole)
    assert ours.pop("README.md") != theirs.pop("README.md")  # it has the command
    assert ours == theirs


def test_there_are_no_actions_to_choose(dataset: robocell.Dataset, tmp_path: Path):
    text = refused(
        "export", dataset.folder, tmp_path / "o", "--format", "molmospaces", "--actions", "joints"
    )
    assert "has actions of several kinds; 'joints' has nothing to choose" in text
