"""A dataset that `robocell generate` made, as the tests of the main job look at it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import robocell


@dataclass(frozen=True)
class GeneratedRun:
    """What a run left.

    Attributes:
        run: The run file's content.
        dataset: Folder.
        totals: The counts that the command ended with.
        peak_bytes: Most memory that the command and its processes had at one time.
    """

    run: robocell.RunConfig
    dataset: Path
    totals: dict[str, Any]
    peak_bytes: int

    def episodes(self) -> list[Path]:
        """The folders of the episodes, in their order."""
        return sorted(file.parent for file in self.dataset.glob("*/episode.json"))


def read_json(episode: Path) -> dict[str, Any]:
    """An episode's episode.json."""
    content: dict[str, Any] = json.loads((episode / "episode.json").read_text())
    return content


def scene_spec(episode: Path) -> robocell.SceneSpec:
    """The scene an episode was made in."""
    return robocell.SceneSpec.from_yaml(read_json(episode)["metadata"]["scene_spec"])


def target_kind(episode: Path) -> str:
    """The kind of the object to lift, from what is in the scene."""
    target = next(item for item in scene_spec(episode).objects if item.name == "target")
    return target.mjcf_path or target.shape.name.lower()
