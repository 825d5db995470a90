"""Example 15: record an environment: what somebody does with it becomes episodes of a dataset.

A script plays the operator: it draws two circles with the tool and gives up a third one. The
episodes are verified, read, and done again to the bit. The same in C++: 15_record.cc.
Run: python examples/15_record.py [folder]
"""

from __future__ import annotations

import math
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc
from robocell.data import EnvRecorder, env_of_episode, replay_actions

STEPS = 40


def draw_circle(env: rc.Env, radius: float, steps: int = STEPS) -> None:
    """Moves the tool along a circle in the plane before the robot, step by step."""
    for i in range(steps):
        angle = 2 * math.pi * i / STEPS
        way = 2 * math.pi * radius / STEPS
        across, up = -way * math.sin(angle), way * math.cos(angle)
        env.step({"robot": {"tquat": [0, across, up, 0, 0, 0, 1], "gripper": i % 2}})


def record(config: rc.EnvConfig, dataset: Path) -> list[str]:
    """Two episodes that are kept, and one that is not."""
    env = rc.Env(config)
    with EnvRecorder(env, dataset, metadata={"operator": "a script"}) as recorder:
        env.reset(seed=1)
        draw_circle(env, 0.10)
        env.reset(seed=2)  # saves the first one
        draw_circle(env, 0.05)
        recorder.save(success=True, reason="round enough")
        env.reset(seed=3)
        draw_circle(env, 0.07, steps=5)
        recorder.discard()
    env.close()
    return recorder.episodes


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    dataset = folder / "dataset"
    shutil.rmtree(dataset, ignore_errors=True)
    config = rc.EnvConfig.load(rc.models.cell_file("rc7"))
    config.cameras.resolution = [320, 240]
    config.cameras.streams.append(
        rc.render.CameraConfig(name="exo", camera="robotrobot_exo_camera")
    )

    for name in record(config, dataset):
        episode = rc.Dataset(dataset)[name]
        tool = episode["observation/robot/tquat"][:, :3]
        size = np.ptp(tool, axis=0)
        print(f"{name}: {len(episode)} steps, {episode.end_reason}")
        print(f"  the tool went {size[1]:.2f} m across and {size[2]:.2f} m up")
        assert rc.data.verify_replay(episode, 0).ok, "the controls give the same states"
        assert replay_actions(env_of_episode(episode), episode).ok, "and the actions the same"
    assert rc.data.verify(dataset).ok
    print("replayed: the same to the bit")
    frames = [rc.Dataset(dataset)[0].frame("exo", i) for i in (0, STEPS // 4, STEPS // 2)]
    rc.render.write_png(str(folder / "picture.png"), np.concatenate(frames, axis=1))


if __name__ == "__main__":
    main()
