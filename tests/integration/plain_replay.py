"""Replays a recorded episode with `mujoco`, `h5py` and `numpy` alone: robocell is not imported.

`python plain_replay.py SCENE.mjb STEPS.h5` prints what came out as JSON.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import h5py
import mujoco
import numpy as np

FULL_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
TARGET = "target"
PREFIX = "robot_0/"  # of the robot in scenes of runs; features have the names of its own model


def load(scene_file: Path | str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A scene that was saved as binary."""
    model = mujoco.MjModel.from_binary_path(str(scene_file))
    return model, mujoco.MjData(model)


def rows(model: mujoco.MjModel, data: mujoco.MjData, steps: h5py.File) -> Iterator[int]:
    """Puts `data` into the state of row 0, 1, 2, ..., and at last into that after the last action.

    From the recorded start on, nothing but the recorded controls acts, through `mj_step`.
    """
    mujoco.mj_setState(model, data, steps["initial_state"][:], FULL_STATE)
    ctrl, times = steps["control/ctrl"][:], steps["control/time"][:]
    count = len(steps["time"])
    ticks = len(ctrl) // count
    engine_steps = round((times[1] - times[0]) / model.opt.timestep)
    for row in range(count):
        yield row
        for tick in range(row * ticks, (row + 1) * ticks):
            data.ctrl[:] = ctrl[tick]
            mujoco.mj_step(model, data, engine_steps)
    yield count


def free_address(model: mujoco.MjModel, name: str) -> int:
    """Where the pose of a loose object begins in qpos."""
    return int(model.joint(f"{name}_joint").qposadr[0])


def joint_error(model: mujoco.MjModel, data: mujoco.MjData, steps: h5py.File, row: int) -> float:
    """How far the joints of all move groups are from what was recorded, rad or m."""
    worst = 0.0
    for robot in steps["robots"].values():
        for group in (item for item in robot.values() if isinstance(item, h5py.Group)):
            if "qpos" not in group:
                continue
            names = group["qpos"].attrs["names"]
            addresses = [int(model.joint(PREFIX + name).qposadr[0]) for name in names]
            worst = max(worst, np.abs(data.qpos[addresses] - group["qpos"][row]).max())
    return float(worst)


def object_error(model: mujoco.MjModel, data: mujoco.MjData, steps: h5py.File, row: int) -> float:
    """How far the objects are from where they were recorded: m, and quaternions up to sign."""
    worst = 0.0
    for name, group in steps["objects"].items():
        at = free_address(model, name)
        recorded = group["pose"][row]
        xyzw = np.roll(data.qpos[at + 3 : at + 7], -1)
        xyzw *= np.sign(xyzw @ recorded[3:]) / np.linalg.norm(xyzw)
        now = np.concatenate([data.qpos[at : at + 3], xyzw])
        worst = max(worst, np.abs(now - recorded).max())
    return float(worst)


def touching(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> list[str]:
    """Bodies that press on an object."""
    mujoco.mj_forward(model, data)
    root = model.body_rootid[int(model.joint(f"{name}_joint").bodyid[0])]
    found = set()
    for index in range(data.ncon):
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, index, force)
        bodies = model.geom_bodyid[data.contact[index].geom]
        others = [int(body) for body in bodies if model.body_rootid[body] != root]
        if force[0] > 0 and len(others) == 1:
            found.add(model.body(others[0]).name)
    return sorted(found)


def replay(scene_file: str, steps_file: str) -> dict[str, object]:
    """Largest deviations from the recording, the target's rise, and what touches it at the end."""
    model, data = load(scene_file)
    height = free_address(model, TARGET) + 2
    joints = objects = start = 0.0
    with h5py.File(steps_file) as steps:
        count = len(steps["time"])
        for row in rows(model, data, steps):
            if row == 0:
                start = float(data.qpos[height])
            if row < count:
                joints = max(joints, joint_error(model, data, steps, row))
                objects = max(objects, object_error(model, data, steps, row))
    return {
        "rows": count,
        "joint_error": joints,
        "object_error": objects,
        "rise": float(data.qpos[height]) - start,
        "touching": touching(model, data, TARGET),
        "modules_of_ours": sorted(name for name in sys.modules if name.startswith("robocell")),
    }


if __name__ == "__main__":
    print(json.dumps(replay(*sys.argv[1:])))
