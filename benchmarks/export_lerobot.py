"""P17: episodes exported as a LeRobot dataset, beside LeRobot's own writer on the same frames.

Both sides write a dataset of version 3.0 with the state, the action and two videos of 640x480.
robocell copies the encoded frames of its episodes; LeRobot is given the decoded ones, as it is when
it records. The peer runs in an environment of its own, where lerobot installs.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from lerobot_peer import PEER, peer_python
from table import Row

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

import robocell  # noqa: E402
from robocell.export import export_dataset  # noqa: E402

REPETITIONS = 5
EPISODES = 100
PEER_EPISODES = 4  # of the same; the rate per frame counts
ACTION = ("action/arm", "action/gripper")
RUN = ROOT / "examples" / "demo.yaml"


def rows(folder: Path, repetitions: int = REPETITIONS, episodes: int = EPISODES) -> list[Row]:
    """Frames per second: each row has a frame of each of the two cameras."""
    dataset = recorded(folder, episodes)
    ours = [exported_per_s(dataset, folder, number) for number in range(repetitions)]
    peer = peer_per_s(dataset, folder, repetitions)
    note = f"{len(dataset)} episodes, {sum(map(len, dataset))} rows, videos copied"
    if peer:
        note += f"; peer: {PEER} on {min(PEER_EPISODES, len(dataset))} of them"
    name = "frames exported as LeRobot v3.0, two cameras 640x480, rc7"
    return [Row(name, "1/s", ours, peer, better="higher", note=note)]


def recorded(folder: Path, episodes: int) -> robocell.Dataset:
    """Picks with two cameras, made once."""
    place = folder / f"export_{episodes}"
    if not (place / "done").exists():
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        run = yaml.safe_load(RUN.read_text())
        run |= {"robot": str(RUN.parent / run["robot"]), "output": str(place / "picks")}
        run |= {"episodes_per_scene": episodes}
        run["cameras"] |= {"resolution": [640, 480]}
        run["cameras"]["renderer"] = {"backend": "soft"}
        (place / "run.yaml").write_text(yaml.safe_dump(run))
        command = [sys.executable, "-m", "robocell", "generate", str(place / "run.yaml")]
        subprocess.run(command, check=True, capture_output=True)
        (place / "done").touch()
    return robocell.Dataset(place / "picks")


def exported_per_s(dataset: robocell.Dataset, folder: Path, number: int) -> float:
    """Frames of both cameras per second of an export, everything on the disk."""
    out = folder / f"exported_{number}"
    shutil.rmtree(out, ignore_errors=True)
    began = time.perf_counter()
    result = export_dataset(dataset, out)
    elapsed = time.perf_counter() - began
    if result.encoded:
        raise RuntimeError(f"videos were encoded again: {result.encoded}")
    frames = json.loads((out / "meta/info.json").read_text())["total_frames"]
    if frames != result.frames:
        raise RuntimeError(f"{frames} frames on the disk of {result.frames}")
    shutil.rmtree(out)
    return result.cameras * result.frames / elapsed


def peer_per_s(dataset: robocell.Dataset, folder: Path, repetitions: int) -> list[float]:
    """The same of LeRobot's writer; [] where it does not install."""
    python = peer_python(folder)
    if python is None:
        return []
    given = folder / "peer_episodes"
    shutil.rmtree(given, ignore_errors=True)
    given.mkdir()
    for index, episode in enumerate(list(dataset)[:PEER_EPISODES]):
        robot = "robots/rc7"
        arrays: dict[str, Any] = {name: episode.frames(name) for name in episode.cameras}
        for name, columns in (("state", ("arm/qpos", "opening")), ("action", ACTION)):
            arrays[name] = np.column_stack([episode[f"{robot}/{column}"] for column in columns])
        np.savez(given / f"{index}.npz", **arrays)
    found = []
    for _ in range(repetitions):
        out = folder / "peer_out"
        shutil.rmtree(out, ignore_errors=True)
        said = subprocess.run(
            [str(python), "-I", "-c", WRITE, str(given), str(out)],
            capture_output=True,
            text=True,
            check=False,
        )
        if said.returncode:
            raise RuntimeError(f"{PEER} failed:\n{said.stderr[-2000:]}")
        found.append(float(said.stdout.split()[-1]))
    return found


WRITE = """
import sys, time
from pathlib import Path
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

given, out = map(Path, sys.argv[1:])
episodes = [dict(np.load(file)) for file in sorted(given.glob("*.npz"))]
cameras = [name for name in episodes[0] if name not in ("state", "action")]
features = {
    "observation.state": {"dtype": "float32", "shape": (8,), "names": None},
    "action": {"dtype": "float32", "shape": (8,), "names": None},
}
for name in cameras:
    shape = episodes[0][name].shape[1:]
    features[f"observation.images.{name}"] = {
        "dtype": "video", "shape": shape, "names": ["height", "width", "channels"]
    }
began = time.perf_counter()
dataset = LeRobotDataset.create("local/peer", 15, features, root=out)
frames = 0
for episode in episodes:
    for row in range(len(episode["state"])):
        frame = {
            "observation.state": episode["state"][row].astype(np.float32),
            "action": episode["action"][row].astype(np.float32),
            "task": "pick up the part",
        }
        frame |= {f"observation.images.{name}": episode[name][row] for name in cameras}
        dataset.add_frame(frame)
        frames += len(cameras)
    dataset.save_episode()
dataset.finalize()
print(frames / (time.perf_counter() - began))
"""
