"""One mixed dataset for tests of exports: two robots, three tasks, two cameras with depth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import robocell
from command_line import REPOSITORY, robocell_command, write_run
from made_once import made_once
from robocell.data.derive import merge

ROBOTS = ("rc7", "panda")
CAMERAS = ("wrist", "exo")
RUNS: dict[str, dict[str, Any]] = {
    "pick": {"task": {"kind": "pick", "objects": ["box", "cylinder"]}},
    "place": {"task": {"kind": "pick_and_place", "objects": ["box"]}},
    "lift": {"task": {"kind": "pick", "objects": ["sphere"]}, "run": "lift"},
    "panda": {"robot": str(REPOSITORY / "examples" / "panda.yaml")},
}


def mixed_dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    """Four episodes; no test may change it."""

    def make(folder: Path) -> None:
        for name, changes in RUNS.items():
            place = folder / name
            place.mkdir()
            streams = [
                {"name": camera, "camera": f"{camera}_camera", "depth": True} for camera in CAMERAS
            ]
            cameras = {
                "resolution": [128, 96],
                "renderer": {"backend": "soft"},
                "streams": streams,
            }
            rates = {"policy_ms": 100, "control_ms": 2, "sim_ms": 2, "max_steps": 500}
            run = write_run(place, cameras=cameras, rates=rates, **changes)
            said = robocell_command("generate", run, "--workers", 1)
            assert said.returncode == 0, said.stderr
        merge([folder / name / "out" for name in RUNS], folder / "mixed")

    return robocell.Dataset(made_once(tmp_path_factory, "mixed", make) / "mixed")


def of_robot(dataset: robocell.Dataset, robot: str) -> list[str]:
    """The ids of the episodes of a robot."""
    return [each.id for each in dataset if f"robots/{robot}/tcp_pose" in each.columns]
