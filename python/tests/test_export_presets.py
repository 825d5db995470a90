"""Presets of `robocell export`: names, sizes and numbers of openpi's datasets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from numpy.typing import NDArray

import robocell
from command_line import refused, robocell_command
from exported import psnr, three_episodes
from robocell.export import export_dataset
from robocell.export._features import rotation_vectors
from robocell.export._mp4 import Mp4
from robocell.export._videos import images

ROBOT = "robots/rc7"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def exported(dataset: robocell.Dataset, out: Path, **options: Any) -> dict[str, NDArray[Any]]:
    """The rows of the first episode."""
    export_dataset(dataset, out, "lerobot-v2.1", episodes=["0"], **options)
    table = pq.read_table(out / "data/chunk-000/episode_000000.parquet")
    return {name: np.array(table[name].to_pylist()) for name in table.column_names}


def shapes(out: Path) -> dict[str, list[int]]:
    features = json.loads((out / "meta/info.json").read_text())["features"]
    own = ("timestamp", "frame_index", "episode_index", "index", "task_index")
    return {name: feature["shape"] for name, feature in features.items() if name not in own}


def frames(out: Path, feature: str) -> NDArray[np.uint8]:
    video = out / f"videos/chunk-000/{feature}/episode_000000.mp4"
    return np.concatenate(list(images(video, Mp4.read(video))))


def test_droid_has_joint_velocities_and_a_closing_gripper(
    dataset: robocell.Dataset, tmp_path: Path
):
    out, episode = tmp_path / "droid", dataset[0]
    rows = exported(dataset, out, preset="droid")
    assert shapes(out) == {
        "wrist_image_left": [180, 320, 3],
        "exterior_image_1_left": [180, 320, 3],
        "joint_position": [7],
        "gripper_position": [1],
        "actions": [8],
    }
    assert np.allclose(rows["joint_position"], episode[f"{ROBOT}/arm/qpos"])
    assert np.allclose(rows["gripper_position"], 1 - episode[f"{ROBOT}/opening"], atol=1e-6)
    velocities = episode[f"{ROBOT}/action/arm_relative"] / 0.2
    assert np.allclose(rows["actions"][:, :7], velocities, atol=1e-6)
    assert np.allclose(rows["actions"][:, 7:], 1 - episode[f"{ROBOT}/action/gripper"])
    card = (out / "README.md").read_text()
    assert "`opening` is 1 closed and 0 open" in card
    assert "| 0 | joint1 | 0.2 rad |" in card


def test_images_keep_their_shape_between_black_borders(dataset: robocell.Dataset, tmp_path: Path):
    out = tmp_path / "droid"
    result = export_dataset(dataset, out, "lerobot-v2.1", episodes=["0"], preset="droid")
    assert result.encoded["wrist_image_left"] == "images of 64x48 are brought to 320x180"
    found, own = frames(out, "wrist_image_left"), dataset[0].frames("wrist")
    assert found.shape == (len(own), 180, 320, 3)
    assert found[:, :, :39].max() < 24  # 240x180 in the middle of 320x180
    assert found[:, :, 281:].max() < 24
    inner = found[:, :, 40:280]
    # Every pixel of the episode is 3.75 pixels here; compare the means of 15x15 pixels and 4x4.
    small = inner.reshape(-1, 12, 15, 16, 15, 3).mean((2, 4))
    wanted = own.reshape(-1, 12, 4, 16, 4, 3).mean((2, 4))
    assert psnr(small, wanted) > 35
    assert psnr(small[1:], wanted[1:]) > psnr(small[1:], wanted[:-1]) + 3  # not one frame late


def test_libero_has_displacements_and_a_gripper_from_minus_one_to_one(
    dataset: robocell.Dataset, tmp_path: Path
):
    out, episode = tmp_path / "libero", dataset[0]
    rows = exported(dataset, out, preset="libero")
    assert shapes(out) == {
        "wrist_image": [256, 256, 3],
        "image": [256, 256, 3],
        "state": [8],
        "actions": [7],
    }
    pose = episode[f"{ROBOT}/tcp_pose_in_base"]
    assert np.allclose(rows["state"][:, :3], pose[:, :3])
    for vector, own in zip(rows["state"][:, 3:6], pose, strict=True):
        rotation = robocell.Pose(quaternion=own[3:]).rotation
        assert np.allclose(rotated(vector), rotation, atol=1e-5)
    assert np.allclose(rows["state"][:, 6:], episode[f"{ROBOT}/gripper/qpos"])
    moved = episode[f"{ROBOT}/action/tcp_displacement"]
    assert np.allclose(rows["actions"][:, :3], moved[:, :3] / 0.05, atol=1e-6)
    assert np.allclose(rows["actions"][:, 3:6], moved[:, 3:] / 0.5, atol=1e-6)
    assert np.allclose(rows["actions"][:, 6], 1 - 2 * episode[f"{ROBOT}/action/gripper"].ravel())
    assert "`opening` is 1 closed and -1 open" in (out / "README.md").read_text()


def rotated(vector: NDArray[Any]) -> NDArray[Any]:
    """The matrix of a rotation vector, by Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def test_rotation_vectors_are_exact_near_zero_and_half_a_turn():
    q = np.array([[0, 0, 0, 1], [1e-13, 0, 0, 1], [0, 0, 1, 0], [0, -1, 0, -1e-3], [0, 0, 0, -1]])
    vectors = rotation_vectors(q / np.linalg.norm(q, axis=1, keepdims=True))
    expected = [[0, 0, 0], [2e-13, 0, 0], [0, 0, np.pi], [0, np.pi - 2e-3, 0], [0, 0, 0]]
    assert np.allclose(vectors, expected, rtol=1e-6, atol=1e-14)


def test_aloha_keeps_names_and_openings(dataset: robocell.Dataset, tmp_path: Path):
    out, episode = tmp_path / "aloha", dataset[0]
    rows = exported(dataset, out, preset="aloha")
    assert shapes(out) == {
        "observation.images.cam_left_wrist": [480, 640, 3],
        "observation.images.cam_high": [480, 640, 3],
        "observation.state": [8],
        "action": [8],
    }
    assert np.allclose(rows["observation.state"][:, 7], episode[f"{ROBOT}/opening"])


def test_a_preset_of_ones_own_and_the_options_that_replace_its_entries(
    dataset: robocell.Dataset, tmp_path: Path
):
    preset = tmp_path / "mine.yaml"
    preset.write_text(
        yaml.safe_dump(
            {
                "action_feature": "do",
                "gripper": {"open": 10, "closed": 20},
                "features": {"do": "joints", "see": [f"{ROBOT}/action/gripper_relative"]},
                "images": {"eye": "*"},
            }
        )
    )
    out = tmp_path / "out"
    options = ["--preset", preset, "--actions", f"{ROBOT}/action/gripper", "--cameras", "exo"]
    result = robocell_command(
        "export", dataset.folder, out, "--episodes", 0, "--format", "lerobot-v2.1", *options
    )
    assert result.returncode == 0, result.stderr
    assert shapes(out) == {"eye": [48, 64, 3], "do": [1], "see": [1]}
    assert np.array_equal(frames(out, "eye"), dataset[0].frames("exo"))
    table = pq.read_table(out / "data/chunk-000/episode_000000.parquet")
    opening = dataset[0][f"{ROBOT}/action/gripper"].ravel()
    assert np.allclose(table["do"], 20 - 10 * opening)
    change = dataset[0][f"{ROBOT}/action/gripper_relative"].ravel()
    assert np.allclose(table["see"], -10 * change)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"image_size": [320, 181]}, "image_size is width and height, even numbers up to 8192"),
        ({"gripper": {"open": 1}}, "gripper is {open: 1, closed: 0}, got {'open': 1}"),
        ({"gripper": {"open": 1, "closed": 1}}, "open and closed are two numbers, got 1 for"),
        ({"action_feature": 3}, "action_feature is the name of a feature"),
        (
            {"features": {"x": [{"column": "phase", "part": "x"}]}},
            "x[0]: no field 'part'. Its fields: column, times, as",
        ),
        (
            {"features": {"x": [{"column": "phase", "as": "positon"}]}},
            "x[0]: no form 'positon'. Did you mean 'position'? There are: position, quaternion",
        ),
        ({"features": {"x": [{"column": "phase", "times": "2"}]}}, "times is a number"),
        (
            {"features": {"x": [{"as": "position"}]}},
            "x[0]: expected a column, or {column: ...}, got {'as'",
        ),
        (
            {"features": {"x": [{"column": "phase", "as": "quaternion"}]}},
            "column 'phase' has 1 numbers and no quaternion; poses have 7, displacements 6",
        ),
        ({"images": {"x": "top*"}}, "no camera 'top*' with colour images. Its cameras: wrist, exo"),
        ({"images": {"x": 3}}, "images is a table of cameras"),
        ({"images": {"../x": "exo"}}, "'../x' cannot be the name of a feature"),
        ({"features": {"/x": ["phase"]}}, "'/x' cannot be the name of a feature"),
        ({"features": {"exo": ["phase"]}, "images": {"exo": "exo"}}, "two features 'exo'"),
        (
            {"features": {"x": ["phase"], "x/y": ["phase"]}},
            "feature 'x/y' cannot be inside feature 'x'",
        ),
    ],
)
def test_bad_presets_are_named(dataset: robocell.Dataset, tmp_path: Path, content: Any, told: str):
    preset = tmp_path / "mine.yaml"
    preset.write_text(yaml.safe_dump(content))
    with pytest.raises(robocell.Error) as raised:
        export_dataset(dataset, tmp_path / "out", preset=preset)
    assert told in str(raised.value)
    assert not (tmp_path / "out").exists()


def test_a_preset_may_extend_a_shipped_one(dataset: robocell.Dataset, tmp_path: Path):
    preset, out = tmp_path / "mine.yaml", tmp_path / "out"
    preset.write_text("extends: droid\ngripper: {open: 1, closed: 0}\nimages: {x: exo}\n")
    rows = exported(dataset, out, preset=preset)
    assert shapes(out) == {
        "x": [180, 320, 3],
        "joint_position": [7],
        "gripper_position": [1],
        "actions": [8],
    }
    assert np.allclose(rows["gripper_position"], dataset[0][f"{ROBOT}/opening"], atol=1e-6)


def test_files_for_presets_are_called_presets(dataset: robocell.Dataset, tmp_path: Path):
    preset = tmp_path / "mine.yaml"
    for text, said in (
        ("- a", f"preset '{preset}' is a table with the fields extends, features"),
        ("a: [", f"preset '{preset}' is no YAML"),
        ("extends: droit", f"preset '{preset}:1:1': extends is a preset of robocell, aloha, droid"),
        ("feature: 1", f"preset '{preset}:1:1': no field 'feature'. Did you mean 'features'?"),
    ):
        preset.write_text(text)
        with pytest.raises(robocell.SpecError) as raised:
            export_dataset(dataset, tmp_path / "out", preset=preset)
        assert str(raised.value).startswith(said)


def test_an_unknown_preset_is_named(dataset: robocell.Dataset, tmp_path: Path):
    text = refused("export", dataset.folder, tmp_path / "out", "--preset", "driod")
    assert "no preset 'driod'. Did you mean 'droid'? Presets: aloha, droid, libero, or" in text


@pytest.mark.parametrize("cameras", ["wrst", "wrist,exo,wrst"])
def test_a_camera_that_is_not_there_is_named_with_a_preset_too(
    dataset: robocell.Dataset, tmp_path: Path, cameras: str
):
    options = ["--preset", "aloha", "--cameras", cameras]
    text = refused("export", dataset.folder, tmp_path / "out", *options)
    assert "has no camera 'wrst' with colour images. Did you mean 'wrist'?" in text
