"""Behaviour cloning from images, with torch on a processor (`pip install torch`).

The built-in arm picks up cylinders, seen from its wrist and from beside it. The dataset is exported
as a replay buffer, a small network learns which eight actions follow each pair of images, and the
policy is evaluated as a client sees it: through a server.
Run: python examples/learning/image_clone.py
"""

from __future__ import annotations

import os
import tempfile
import threading
from pathlib import Path
from typing import Any

import numpy as np
import torch
import zarr
from torch import nn

import robocell as rc
from robocell.export import export_dataset
from robocell.policy import Policy
from robocell.policy_server import policy_server

DEMO = Path(__file__).resolve().parent.parent / "demo.yaml"
WEIGHTS = "IMAGE_CLONE_WEIGHTS"  # environment variable with the file that the policy loads
CAMERAS = ("wrist", "exo")
CHUNK = 8
JOINTS = 8  # seven of the arm, and the opening of the gripper


class Network(nn.Module):
    """Images of both cameras and the joints in, a chunk of displacements and openings out."""

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for before, after in ((3 * len(CAMERAS), 32), (32, 48), (48, 64), (64, 64)):
            layers += [nn.Conv2d(before, after, 3, stride=2, padding=1), nn.ReLU()]
        self.images = nn.Sequential(*layers, nn.Flatten())
        self.head = nn.Sequential(
            nn.Linear(64 * 3 * 4 + JOINTS, 256), nn.ReLU(), nn.Linear(256, CHUNK * 7)
        )

    def forward(self, images: torch.Tensor, joints: torch.Tensor) -> torch.Tensor:
        """Returns (batch, CHUNK * 7) of scaled numbers."""
        seen = self.images(images.float() / 255 - 0.5)
        return self.head(torch.cat([seen, joints], dim=1))


class ImageClone(Policy):
    """Acts as the trained network says."""

    def __init__(self) -> None:
        stored = torch.load(os.environ[WEIGHTS], weights_only=True)
        self.network = Network()
        self.network.load_state_dict(stored["network"])
        self.mean, self.scale = stored["mean"], stored["scale"]

    def act(self, observation: Any) -> Any:
        """A chunk of eight actions."""
        images = np.concatenate([observation[name] for name in CAMERAS], axis=2)
        q = np.append(observation["robots/rc7/arm/qpos"], observation["robots/rc7/opening"])
        with torch.no_grad():
            chunk = self.network(
                torch.from_numpy(images.transpose(2, 0, 1))[None],
                torch.from_numpy(q.astype(np.float32))[None],
            )
        numbers = (chunk.reshape(CHUNK, 7) * self.scale + self.mean).numpy()
        return {
            "robots/rc7/action/tcp_displacement": numbers[:, :6],
            "robots/rc7/action/gripper": np.clip(numbers[:, 6:], 0, 1),
        }


def demonstrate(folder: Path, episodes: int) -> rc.Dataset:
    """Picks of cylinders, with images of 64x48."""
    run = rc.RunConfig.load(DEMO)
    run.task.objects = ["cylinder"]
    run.start.base_distance, run.start.base_height_noise = [0.38, 0.45], [-0.02, 0.02]
    run.cameras.resolution = [64, 48]
    run.output, run.episodes = str(folder), episodes
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return rc.Dataset(folder)


def train(buffer: Path, weights: Path, epochs: int) -> None:
    """Fits the network to a replay buffer of `robocell export --format zarr`."""
    torch.manual_seed(0)
    root: Any = zarr.open_group(str(buffer), mode="r")
    data, ends = root["data"], root["meta/episode_ends"][:]
    images = torch.from_numpy(
        np.concatenate([data[f"{name}_image"][:] for name in CAMERAS], axis=3)
    ).permute(0, 3, 1, 2)
    joints = torch.from_numpy(data["state"][:])
    actions = torch.from_numpy(data["action"][:])
    mean, scale = actions.mean(0), actions.std(0) + 1e-6
    # The actions after the last one of an episode are the last one again.
    last = torch.from_numpy(np.repeat(ends - 1, np.diff(ends, prepend=0)))
    steps = torch.minimum(torch.arange(len(last))[:, None] + torch.arange(CHUNK), last[:, None])
    chunks = ((actions - mean) / scale)[steps].flatten(1)
    network = Network()
    optimizer = torch.optim.AdamW(network.parameters(), 1e-3, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    for _ in range(epochs):
        for batch in torch.randperm(len(images)).split(64):
            loss = nn.functional.smooth_l1_loss(
                network(images[batch], joints[batch]), chunks[batch]
            )
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
        schedule.step()
    torch.save({"network": network.state_dict(), "mean": mean, "scale": scale}, weights)


def main(episodes: int = 150, epochs: int = 40, trials: int = 30) -> float:
    """Trains, evaluates through a server, and returns the success rate."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        dataset = demonstrate(place / "picks", episodes)
        export_dataset(dataset, place / "buffer", "zarr", actions="tcp_displacement")
        train(place / "buffer" / "replay_buffer.zarr", place / "weights.pt", epochs)
        os.environ[WEIGHTS] = str(place / "weights.pt")
        server = policy_server(f"{Path(__file__).resolve()}:ImageClone", port=0)
        threading.Thread(target=server.serve, daemon=True).start()
        result = rc.evaluate.evaluate(
            place / "picks", server.url, episodes=trials, output=place / "rollouts"
        )
        server.close()
    low, high = result.interval
    print(
        f"picked up {result.successes} of {result.rollouts} cylinders after {episodes} "
        f"demonstrations: {result.rate:.0%}, 95 % interval {low:.0%} ... {high:.0%}"
    )
    return result.rate


if __name__ == "__main__":
    main()
