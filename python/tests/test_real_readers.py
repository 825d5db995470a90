"""Exports of one mixed dataset, read by the readers that people train with, each in its own venv.

Two robots, three tasks, two cameras with depth. `make soak` runs this file; the rules of the
readers are tested in `make test` by the tests of each format.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import robocell
from lerobot_venv import lerobot_python
from mixed import CAMERAS, ROBOTS, mixed_dataset, of_robot
from reader_venvs import reader_python, run_reader
from robocell.export import export_dataset

pytestmark = pytest.mark.soak

LEROBOT = ("lerobot-v3", "lerobot-v2.1")  # read by lerobot 0.4.4 and 0.3.3
LEAST_PSNR = 30.0  # dB, of frame i and the image of row i


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return mixed_dataset(tmp_path_factory)


def expected(dataset: robocell.Dataset, robot: str, folder: Path) -> Path:
    """What a reader has to find, for programs without robocell."""
    wanted: dict[str, NDArray[Any]] = {}
    for index, name in enumerate(of_robot(dataset, robot)):
        episode, column = dataset[name], f"robots/{robot}"
        arm, opening = episode[f"{column}/arm/qpos"], episode[f"{column}/opening"]
        [gripper] = [
            each
            for each in episode.columns
            if each.startswith(f"{column}/action/")
            and list(episode.column(each).names) == ["opening"]
            and not each.endswith("_relative")
        ]
        wanted[f"state_{index}"] = np.column_stack([arm, opening]).astype(np.float32)
        acted = [episode[f"{column}/action/arm"], episode[gripper]]
        wanted[f"action_{index}"] = np.column_stack(acted).astype(np.float32)
        for camera in CAMERAS:
            wanted[f"{camera}_{index}"] = episode.frames(camera)
        wanted[f"task_{index}"] = np.array(episode.metadata["instruction"])
    path = folder / "expected.npz"
    np.savez(path, **wanted)
    return path


def last_line(said: str) -> Any:
    """What a program found; libraries print lines of their own before."""
    return json.loads(said.splitlines()[-1])


COMMON = """
import json, sys
import numpy as np
folder, wanted = sys.argv[1], dict(np.load(sys.argv[2]))
count = sum(name.startswith("state_") for name in wanted)
def psnr(one, other):
    error = np.mean((one.astype(float) - other.astype(float)) ** 2)
    return 99.0 if error == 0 else float(10 * np.log10(255**2 / error))
def same(one, other, what):
    assert one.shape == other.shape and np.allclose(one, other, atol=1e-6), what
"""
READ_LEROBOT = (
    COMMON
    + """
from lerobot.datasets.lerobot_dataset import LeRobotDataset
dataset = LeRobotDataset("local/mixed", root=folder, video_backend="pyav")
assert dataset.num_episodes == count, dataset.num_episodes
worst, row = 99.0, 0
for episode in range(count):
    for frame in range(len(wanted[f"state_{episode}"])):
        item = dataset[row]
        row += 1
        assert int(item["episode_index"]) == episode and int(item["frame_index"]) == frame
        assert item["task"] == str(wanted[f"task_{episode}"])
        same(item["observation.state"].numpy(), wanted[f"state_{episode}"][frame], "state")
        same(item["action"].numpy(), wanted[f"action_{episode}"][frame], "action")
        for camera in ("wrist", "exo"):
            image = item[f"observation.images.{camera}"].numpy().transpose(1, 2, 0) * 255
            worst = min(worst, psnr(image, wanted[f"{camera}_{episode}"][frame]))
assert row == len(dataset)
print(json.dumps({"rows": row, "psnr": worst}))
"""
)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("format", LEROBOT)
def test_lerobot_reads_every_row(mixed: robocell.Dataset, tmp_path: Path, format: str, robot: str):
    export_dataset(mixed, tmp_path / "out", format, episodes=of_robot(mixed, robot))
    is_v3 = format == "lerobot-v3"
    python = lerobot_python() if is_v3 else reader_python("lerobot_033", ["lerobot==0.3.3"])
    found = last_line(
        run_reader(python, READ_LEROBOT, tmp_path / "out", expected(mixed, robot, tmp_path))
    )
    assert found["rows"] == sum(len(mixed[name]) for name in of_robot(mixed, robot))
    assert found["psnr"] >= LEAST_PSNR, "frame i is row i"


READ_ROBOMIMIC = (
    COMMON
    + """
from robomimic.utils.dataset import SequenceDataset
import robomimic.utils.obs_utils as obs_utils
import h5py
with h5py.File(folder + "/dataset.hdf5") as file:
    keys = sorted(file["data/demo_0/obs"])
images = [key for key in keys if key.endswith("_image")]
numbers = [key for key in keys if not key.endswith("_image")]
obs_utils.initialize_obs_utils_with_obs_specs({"obs": {"low_dim": numbers, "rgb": images}})
dataset = SequenceDataset(
    hdf5_path=folder + "/dataset.hdf5", obs_keys=keys, dataset_keys=("actions", "rewards", "dones"),
    frame_stack=1, seq_length=1, hdf5_cache_mode=None, hdf5_use_swmr=False, load_next_obs=False,
)
rows = sum(len(wanted[f"state_{i}"]) for i in range(count))
assert len(dataset) == rows, (len(dataset), rows)
index = 0
for episode in range(count):
    for row in range(len(wanted[f"state_{episode}"])):
        item = dataset[index]
        index += 1
        for camera in ("wrist", "exo"):
            image = np.asarray(item["obs"][f"{camera}_image"])[0]
            if image.shape[0] == 3:
                image = image.transpose(1, 2, 0) * 255
            assert psnr(image, wanted[f"{camera}_{episode}"][row]) > 50
        assert np.abs(item["actions"]).max() <= 1
train = SequenceDataset(
    hdf5_path=folder + "/dataset.hdf5", obs_keys=numbers, dataset_keys=("actions",), frame_stack=1,
    seq_length=10, hdf5_cache_mode="all", hdf5_use_swmr=False, filter_by_attribute="train",
    load_next_obs=False,
)
print(json.dumps({"rows": rows, "train": len(train)}))
"""
)


@pytest.mark.parametrize("robot", ROBOTS)
def test_robomimic_reads_every_row(mixed: robocell.Dataset, tmp_path: Path, robot: str):
    export_dataset(mixed, tmp_path / "out", "robomimic", episodes=of_robot(mixed, robot))
    packages = ["torch", "h5py", "tqdm", "psutil", "termcolor", "numpy<2", "imageio", "matplotlib"]
    packages += ["tensorboard", "tensorboardX", "transformers<5", "diffusers<0.40", "torchvision"]
    python = reader_python("robomimic", packages, ["robomimic==0.3.0"])
    wanted = expected(mixed, robot, tmp_path)
    found = last_line(run_reader(python, READ_ROBOMIMIC, tmp_path / "out", wanted))
    assert found["rows"] == sum(len(mixed[name]) for name in of_robot(mixed, robot))
    assert 0 < found["train"] <= found["rows"]


# The checks of ReplayBuffer of Diffusion Policy and UMI, with the zarr that they pin.
READ_ZARR = (
    COMMON
    + """
import zarr
assert zarr.__version__.startswith("2."), zarr.__version__
if folder.endswith(".zip"):
    import imagecodecs.numcodecs
    imagecodecs.numcodecs.register_codecs()
    root = zarr.group(zarr.ZipStore(folder, mode="r"))
else:
    root = zarr.open(folder, "r")
assert "data" in root and "meta" in root and "episode_ends" in root["meta"]
ends = root["meta"]["episode_ends"][:]
for name, value in root["data"].items():
    assert value.shape[0] == ends[-1], name
names = {camera: name for camera, name in zip(("wrist", "exo"), sys.argv[3:])}
first = 0
for episode in range(count):
    rows = slice(first, int(ends[episode]))
    first = int(ends[episode])
    assert rows.stop - rows.start == len(wanted[f"state_{episode}"])
    for camera, name in names.items():
        assert np.array_equal(root["data"][name][rows], wanted[f"{camera}_{episode}"]), camera
    if "state" in root["data"]:
        same(root["data"]["state"][rows], wanted[f"state_{episode}"], "state")
        same(root["data"]["action"][rows], wanted[f"action_{episode}"], "action")
print(json.dumps({"rows": first, "names": sorted(root["data"])}))
"""
)
ZARR = ["zarr==2.18.3", "numcodecs==0.15.1", "numpy<2.3", "imagecodecs"]


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(
    ("format", "file", "names"),
    [
        ("zarr", "replay_buffer.zarr", ("wrist_image", "exo_image")),
        ("umi", "dataset.zarr.zip", ("camera0_rgb", "camera1_rgb")),
    ],
)
def test_replay_buffers_are_read_with_zarr_2(
    mixed: robocell.Dataset,
    tmp_path: Path,
    robot: str,
    format: str,
    file: str,
    names: tuple[str, str],
):
    export_dataset(mixed, tmp_path / "out", format, episodes=of_robot(mixed, robot))
    python = reader_python("zarr", ZARR)
    wanted = expected(mixed, robot, tmp_path)
    found = last_line(run_reader(python, READ_ZARR, tmp_path / "out" / file, wanted, *names))
    assert found["rows"] == sum(len(mixed[name]) for name in of_robot(mixed, robot))


LINT = """
import subprocess, sys
from pathlib import Path
program = Path(sys.executable).with_name("lerobot-doctor")
said = subprocess.run([program, "check", sys.argv[1]], capture_output=True, text=True)
print(said.stdout, said.stderr)
sys.exit(said.returncode)
"""
# What the linter says of the files. Its other checks are about the demonstrations: arms that hold
# still while its gripper closes, episodes of less than 100 rows.
OF_FILES = (
    "Metadata & Format Compliance",
    "Temporal Consistency",
    "Video Integrity",
    "Data Distribution",
    "Feature Consistency",
    "Training Readiness",
    "Portability",
)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("format", LEROBOT)
def test_a_linter_finds_nothing_in_the_files(
    mixed: robocell.Dataset, tmp_path: Path, format: str, robot: str
):
    out = tmp_path / "out"
    export_dataset(mixed, out, format, episodes=of_robot(mixed, robot))
    said = run_reader(reader_python("doctor", ["lerobot-doctor==0.2.0"]), LINT, out)
    for check in OF_FILES:
        assert f"[PASS] {check}" in said, said
    assert "[FAIL]" not in said
