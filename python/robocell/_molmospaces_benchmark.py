"""Benchmarks in the schema of MolmoSpaces: a list of episodes, each with its start and its task.

An episode has MolmoSpaces' own fields, for its readers, and beside them `robocell`, which says how
robocell draws the start again: MolmoSpaces allows more fields than its own.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from robocell._core import ArgumentError, IoError

OWN = "robocell"
HASH = "json_sha256"
POSE, BASE, JOINTS = "/pose", "/base_pose", "/qpos"
TARGET, GOAL = "target", "goal"
WXYZ = (0, 1, 2, 6, 3, 4, 5)  # of x y z, qx qy qz qw


def to_molmospaces(
    content: Mapping[str, Any], scenes: Sequence[int], details: Mapping[str, Any]
) -> str:
    """Returns the text of a file in MolmoSpaces' schema.

    Args:
        content: A benchmark of robocell.
        scenes: The scene of each start.
        details: `scene_dataset`, `robot_name`, `img_resolution` and `task_type` of the run.
    """
    shared = {name: value for name, value in content.items() if name not in ("starts", HASH)}
    episodes = [
        _episode(start, scene, int(content["seed"]), details)
        for start, scene in zip(content["starts"], scenes, strict=True)
    ]
    for episode, start in zip(episodes, content["starts"], strict=True):
        episode[OWN] = {"start": start}
    episodes[0][OWN] |= {"benchmark": shared}
    episodes[0][OWN][HASH] = _digest(episodes)
    return json.dumps(episodes, indent=1) + "\n"


def from_molmospaces(episodes: object, path: Path) -> dict[str, Any]:
    """Returns the benchmark of robocell in a file of this schema.

    Raises:
        ArgumentError: The episodes are those of another simulator.
        IoError: The file is damaged or was edited.
    """
    if not isinstance(episodes, list) or not all(isinstance(each, dict) for each in episodes):
        raise IoError(f"'{path}' is no list of episodes")
    if not episodes or not all(isinstance(each.get(OWN), dict) for each in episodes):
        raise ArgumentError(_foreign(episodes, path))
    first = episodes[0][OWN]
    benchmark = first.get("benchmark")
    starts = [each[OWN].get("start") for each in episodes]
    if first.get(HASH) != _digest(episodes):
        raise IoError(f"benchmark '{path}' is damaged or was edited: its {HASH} is another one")
    if not isinstance(benchmark, dict) or not all(isinstance(start, dict) for start in starts):
        raise IoError(f"benchmark '{path}' lacks the entries of '{OWN}'")
    return {**benchmark, "starts": starts}


def _foreign(episodes: Sequence[Mapping[str, Any]], path: Path) -> str:
    """Returns why a benchmark of MolmoSpaces itself is not evaluated, with what it is of."""
    scenes = sorted({str(each.get("scene_dataset")) for each in episodes})
    robots = sorted(
        {str(each["robot"].get("robot_name")) for each in episodes if _is_map(each.get("robot"))}
    )
    return (
        f"'{path}' has {len(episodes)} episodes of MolmoSpaces: scenes {', '.join(scenes) or '-'}, "
        f"robots {', '.join(robots) or '-'}. robocell evaluates the benchmarks that `robocell "
        "benchmark --format molmospaces` writes; these need MolmoSpaces and its houses"
    )


def _is_map(value: object) -> bool:
    return isinstance(value, dict)


def _episode(
    start: Mapping[str, Any], scene: int, seed: int, details: Mapping[str, Any]
) -> dict[str, Any]:
    state: Mapping[str, list[float]] = start["state"]
    objects = {
        name.removeprefix("objects/").removesuffix(POSE): _wxyz(value)
        for name, value in state.items()
        if name.startswith("objects/") and name.endswith(POSE) and len(value) == 7
    }
    bases = [value for name, value in state.items() if name.endswith(BASE)]
    joints = {
        name.split("/", 2)[2].removesuffix(JOINTS): list(value)
        for name, value in state.items()
        if name.startswith("robots/") and name.endswith(JOINTS)
    }
    task: dict[str, Any] = {
        "task_cls": f"{OWN}.{details['task_type']}",
        "task_type": details["task_type"],
        "robot_base_pose": _wxyz(bases[0]) if bases else [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    }
    if TARGET in objects:
        task |= {"pickup_obj_name": TARGET, "pickup_obj_start_pose": objects[TARGET]}
    if GOAL in objects:
        task |= {
            "place_receptacle_name": GOAL,
            "place_receptacle_start_pose": objects[GOAL],
        }
    return {
        "source": None,
        "house_index": scene,
        "scene_dataset": details["scene_dataset"],
        "data_split": "val",
        "seed": seed,
        "robot": {"robot_name": details["robot_name"], "init_qpos": joints},
        "img_resolution": list(details["img_resolution"]),
        "cameras": [],
        "scene_modifications": {"object_poses": objects},
        "task": task,
        "task_relevant_objects": [name for name in (TARGET, GOAL) if name in objects],
        "language": {"task_description": start["instruction"], "referral_expressions": {}},
    }


def _wxyz(pose: Sequence[float]) -> list[float]:
    return [pose[i] for i in WXYZ]


def _digest(episodes: Sequence[Mapping[str, Any]]) -> str:
    """Returns the hash of all episodes, without the hash itself."""
    first = {**episodes[0], OWN: {k: v for k, v in episodes[0][OWN].items() if k != HASH}}
    text = json.dumps([first, *episodes[1:]], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
