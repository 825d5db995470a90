"""What a generated house promises, measured in stock MuJoCo."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray


@dataclass
class HouseFindings:
    """What was measured in one house, and what it breaks of its promises."""

    objects: int = 0
    slots: int = 0  # supports and containers
    openings: int = 0  # doors and drawers
    penetration: float = 0.0  # m, the deepest at the start
    moved: float = 0.0  # m, the farthest that an object went
    opened: float = 1.0  # the least share of its range that a door or drawer opened
    broken: list[str] = field(default_factory=list)


def load(path: Path) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Returns the model of a file with its state at the start."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def free_bodies(model: mujoco.MjModel) -> list[int]:
    """Returns the bodies of objects."""
    return [
        model.jnt_bodyid[joint]
        for joint in range(model.njnt)
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
    ]


def check_house(path: Path, seconds: float) -> HouseFindings:
    """Returns what a house keeps of its promises, over some seconds of simulation."""
    model, data = load(path)
    objects = free_bodies(model)
    found = HouseFindings(objects=len(objects))
    if not objects:
        found.broken.append("no objects")
        return found
    found.penetration = max((-contact.dist for contact in data.contact), default=0.0)
    if found.penetration > 1e-3:
        deepest = min(data.contact, key=lambda contact: contact.dist)
        names = [model.geom(geom).name for geom in deepest.geom]
        found.broken.append(f"{names} overlap by {1000 * found.penetration:.1f} mm")
    start = data.xpos[objects].copy()
    check_slots(model, data, path, found)
    check_openings(model, data, found)
    mujoco.mj_resetData(model, data)
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    moved = np.linalg.norm(data.xpos[objects] - start, axis=1)
    found.moved = float(moved.max())
    found.broken += [
        f"{model.body(objects[i]).name} moves by {moved[i]:.3f} m"
        for i in np.flatnonzero(~(moved < 0.02))
    ]
    if data.warning.number.any():
        found.broken.append("warnings of the engine")
    return found


def check_slots(
    model: mujoco.MjModel, data: mujoco.MjData, path: Path, found: HouseFindings
) -> None:
    """Every declared support and container holds an object."""
    stem = path.stem.removesuffix("_ceiling")
    metadata = json.loads(path.with_name(f"{stem}_metadata.json").read_text())["objects"]
    sites = [site for entry in metadata.values() for site in entry["name_map"]["sites"]]
    found.slots = len(sites)
    if not sites:
        found.broken.append("no supports and containers")
    objects = free_bodies(model)
    for name in sites:
        site = data.site(name)
        within = np.abs((data.xpos[objects] - site.xpos) @ site.xmat.reshape(3, 3)) <= (
            model.site(name).size + 0.01
        )
        if not within.all(axis=1).any():
            found.broken.append(f"{name} is empty")
    children = [child for entry in metadata.values() for child in entry["children"]]
    if sorted(children) != sorted(model.body(body).name for body in objects):
        found.broken.append("the metadata list other objects than the model has")


def check_openings(model: mujoco.MjModel, data: mujoco.MjData, found: HouseFindings) -> None:
    """Doors and drawers open by themselves when they are pulled."""
    joints = [j for j in range(model.njnt) if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
    found.openings = len(joints)
    if not joints:
        found.broken.append("no doors and drawers")
        return
    opened = open_by_pulling(model, data, joints)
    # What falls out of one may lie in the way of another: those are pulled alone.
    for i in np.flatnonzero(~(opened > 0.9)):
        mujoco.mj_resetData(model, data)
        opened[i] = open_by_pulling(model, data, [joints[i]])[0]
    found.opened = float(opened.min())
    found.broken += [
        f"{model.joint(joints[i]).name} opens by {100 * opened[i]:.0f} %"
        for i in np.flatnonzero(~(opened > 0.9))
    ]


def open_by_pulling(
    model: mujoco.MjModel, data: mujoco.MjData, joints: list[int]
) -> NDArray[np.float64]:
    """Pulls at joints for six seconds, and returns the shares of their ranges that they opened."""
    dofs = model.jnt_dofadr[joints]
    for _ in range(round(6 / model.opt.timestep)):
        slow = data.qvel[dofs] < 0.4
        data.qfrc_applied[dofs] = np.where(slow, 6.0, 0.0)
        mujoco.mj_step(model, data)
    return data.qpos[model.jnt_qposadr[joints]] / model.jnt_range[joints, 1]


def sum_of(found: Sequence[HouseFindings]) -> dict[str, float]:
    """Returns the figures of several houses: counts are added, the rest are the worst."""
    return {
        "houses": len(found),
        "kept": sum(not each.broken for each in found),
        "objects": sum(each.objects for each in found),
        "slots": sum(each.slots for each in found),
        "openings": sum(each.openings for each in found),
        "penetration": max(each.penetration for each in found),
        "moved": max(each.moved for each in found),
        "opened": min(each.opened for each in found),
    }
