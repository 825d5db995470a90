"""A dataset as RLDS for OpenVLA and Octo (`pip install tensorflow-cpu tensorflow-datasets`).

Each step has the images, the joints and the gripper, and the seven numbers of Open X-Embodiment as
action: displacement of the TCP in the robot's base frame (metres, rotation vector) and the
gripper, 1 open. Run: python examples/learning/rlds.py out/picks out/rlds
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import tensorflow_datasets as tfds

import robocell as rc


class RobocellPicks(tfds.core.GeneratorBasedBuilder):
    """Episodes of one robot. TFDS keeps a dataset of the name `robocell_picks`."""

    VERSION = tfds.core.Version("1.0.0")

    def __init__(self, *, dataset: str, **options: Any) -> None:
        self.dataset = rc.Dataset(dataset)
        self.robot = next(
            name.split("/")[1]
            for name in self.dataset[0].columns
            if name.endswith("/action/tcp_displacement")
        )
        super().__init__(**options)

    def _info(self) -> Any:
        first = self.dataset[0]
        images = {
            name: tfds.features.Image(shape=first.frame(name, 0).shape, encoding_format="jpeg")
            for name in first.cameras
        }
        state = tfds.features.Tensor(shape=self._state(first)[0].shape, dtype=np.float32)
        number = tfds.features.Scalar(dtype=np.float32)
        flag = tfds.features.Scalar(dtype=np.bool_)
        step = {
            "observation": tfds.features.FeaturesDict({**images, "state": state}),
            "action": tfds.features.Tensor(shape=(7,), dtype=np.float32),
            "reward": number,
            "discount": number,
            "is_first": flag,
            "is_last": flag,
            "is_terminal": flag,
            "language_instruction": tfds.features.Text(),
        }
        metadata = {"file_path": tfds.features.Text(), "success": flag}
        return tfds.core.DatasetInfo(
            builder=self,
            features=tfds.features.FeaturesDict(
                {
                    "steps": tfds.features.Dataset(step),
                    "episode_metadata": tfds.features.FeaturesDict(metadata),
                }
            ),
        )

    def _split_generators(self, download: Any) -> dict[str, Iterator[tuple[str, Any]]]:
        return {"train": self._generate_examples()}

    def _generate_examples(self) -> Iterator[tuple[str, dict[str, Any]]]:
        for episode in self.dataset:
            metadata = {"file_path": str(episode.folder), "success": bool(episode.success)}
            yield episode.id, {"steps": self._steps(episode), "episode_metadata": metadata}

    def _state(self, episode: rc.data.Episode) -> np.ndarray:
        """Joints of the arm and the opening of the gripper, (rows, numbers)."""
        joints = episode[f"robots/{self.robot}/arm/qpos"]
        opening = episode[f"robots/{self.robot}/opening"]
        return np.column_stack([joints, opening]).astype(np.float32)

    def _steps(self, episode: rc.data.Episode) -> list[dict[str, Any]]:
        action = f"robots/{self.robot}/action"
        actions = np.column_stack(
            [episode[f"{action}/tcp_displacement"], episode[f"{action}/gripper"]]
        ).astype(np.float32)
        state = self._state(episode)
        frames = {name: episode.frames(name) for name in episode.cameras}
        metadata: Any = episode.metadata
        last = len(episode) - 1
        return [
            {
                "observation": {
                    **{name: frames[name][row] for name in frames},
                    "state": state[row],
                },
                "action": actions[row],
                "reward": np.float32(episode.success and row == last),
                "discount": np.float32(1),
                "is_first": row == 0,
                "is_last": row == last,
                "is_terminal": row == last and bool(episode.terminated),
                "language_instruction": str(metadata["instruction"]),
            }
            for row in range(len(episode))
        ]


def main(dataset: str, out: str) -> None:
    builder = RobocellPicks(dataset=dataset, data_dir=out)
    builder.download_and_prepare()
    print(f"{len(rc.Dataset(dataset))} episodes: {Path(out) / builder.name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
