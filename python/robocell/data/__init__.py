"""Datasets: record, read and check them, and give their steps to whoever learns from them.

    dataset = robocell.data.Dataset("experiment_output/demo")
    episode = dataset[0]
    episode["robots/rc7/arm/qpos"]  # a whole column
    episode.column("robots/rc7/arm/qpos")[10:20]  # ten rows of it
    episode.frame("wrist", 17)  # one image

    keys = {"robots/rc7/arm/qpos": 0, "wrist": 0, "robots/rc7/action/arm": range(16)}
    robocell.data.torch_dataset(dataset, keys)  # one item for each step
    robocell.data.rows(dataset, ["robots/rc7/arm/qpos"])  # one matrix of all episodes

    with robocell.data.EnvRecorder(env, "out/teleop"):  # episodes from an environment
        env.reset()
        env.step(action)
    with robocell.data.EpisodeWriter("out/real", "pick-000", columns) as episode:  # or row by row
        episode.add_row({"time": 0.0, "robots/ur5e/arm/qpos": qpos})
        episode.commit(success=True)

Importing it loads neither numpy nor torch. docs/data.md describes the files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from robocell._core import (
    NO_SEGMENT,
    Column,
    Dataset,
    DatasetLock,
    Episode,
    RepairResult,
    ReplayDifference,
    ReplayResult,
    SegmentLabel,
    VerifyProblem,
    VerifyResult,
    recorded_scene,
    release_idle_files,
    remove_leftovers,
    repair,
    replay_actions,
    verify,
    verify_replay,
)
from robocell._elsewhere import no_such, not_in
from robocell.data._environments import env_of_episode
from robocell.data._recorder import EnvRecorder, Recordable
from robocell.data._writer import CameraStream, ColumnSpec, EpisodeWriter

if TYPE_CHECKING:
    from robocell.data._matrix import rows
    from robocell.data._steps import Steps, torch_dataset

__all__ = [
    "NO_SEGMENT",
    "CameraStream",
    "Column",
    "ColumnSpec",
    "Dataset",
    "DatasetLock",
    "EnvRecorder",
    "Episode",
    "EpisodeWriter",
    "Recordable",
    "RepairResult",
    "ReplayDifference",
    "ReplayResult",
    "SegmentLabel",
    "Steps",
    "VerifyProblem",
    "VerifyResult",
    "env_of_episode",
    "recorded_scene",
    "release_idle_files",
    "remove_leftovers",
    "repair",
    "replay_actions",
    "rows",
    "torch_dataset",
    "verify",
    "verify_replay",
]


def __getattr__(name: str) -> Any:
    """Loads the names that need numpy on first use."""
    import importlib

    module = {"rows": "_matrix", "Steps": "_steps", "torch_dataset": "_steps"}.get(name)
    if module is None:
        raise no_such(not_in("robocell.data", name, __all__), name)
    value = getattr(importlib.import_module(f"robocell.data.{module}"), name)
    globals()[name] = value
    return value
