"""Parts that a model ties to its robot by `weld`, such as the tool in a tool changer.

Robot files describe one tree of bodies. A part with a free joint that an active `weld` holds on
another body moves with that body, so a copy of the model hangs it there.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from robocell import SpecError
from robocell._onboarding.prepared import (
    add_keys,
    drop_keys,
    make_paths_absolute,
    write_pose,
)
from robocell._onboarding.source_model import SourceModel, Vector


@dataclass(frozen=True)
class Mount:
    """A part with its free joint, what holds it, and its pose there."""

    part: int
    carrier: int
    equality: int
    pos: Vector
    quat: Vector


def find_mounts(source: SourceModel) -> list[Mount]:
    """Returns the parts that active welds hold on other bodies, one for each."""
    m = source.model
    mounts: dict[int, Mount] = {}
    for equality in range(m.neq):
        if int(m.eq_type[equality]) != int(mujoco.mjtEq.mjEQ_WELD) or not m.eq_active0[equality]:
            continue
        if int(m.eq_objtype[equality]) != int(mujoco.mjtObj.mjOBJ_BODY):
            continue
        first, second = int(m.eq_obj1id[equality]), int(m.eq_obj2id[equality])
        pos, quat = _pose_of_second(m.eq_data[equality])
        for carrier, part, inverted in ((first, second, False), (second, first, True)):
            tops = (int(m.body_rootid[carrier]), int(m.body_rootid[part]))
            if 0 in (carrier, part) or not _floats(source, part) or tops[0] == tops[1]:
                continue
            if part in mounts or _is_mounted_on(mounts, m, carrier, part):
                continue
            if inverted:
                own = np.zeros(3), np.zeros(4)
                mujoco.mju_negPose(*own, pos, quat)
                pos, quat = own
            mounts[part] = Mount(part, carrier, equality, pos, quat)
            break
    return list(mounts.values())


def mount(source: SourceModel, mounts: list[Mount], file: Path) -> SourceModel:
    """Returns the model with its parts on what carries them, as it will be read from `file`."""
    spec = source.spec.copy()
    make_paths_absolute(spec, source)
    drop_keys(spec)
    for number, element in enumerate(spec.equalities):
        if not element.name:
            element.name = f"equality{number}"
    held = [spec.equalities[each.equality].name for each in mounts]
    try:
        spec.compile()
        tree = ElementTree.fromstring(spec.to_xml())
        _hang(tree, source, mounts)
        for parent in tree.iter("equality"):
            for weld in list(parent):
                if weld.get("name") in held:
                    parent.remove(weld)
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(tree, encoding="unicode"))
        model = spec.compile()
        if source.model.nkey:
            add_keys(source, spec, model)
            model = spec.compile()
    except (ValueError, OSError) as error:
        raise SpecError(
            f"{source.path}: its parts cannot be put on what welds hold them on: "
            f"{str(error).strip()}. Hang them there in the model's file by hand"
        ) from error
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return SourceModel(file.absolute(), spec, model, data)


def reasons_to_mount(source: SourceModel, mounts: list[Mount]) -> list[str]:
    """Returns why the model needs a modified copy."""
    return [
        f"a weld holds '{source.body_name(each.part)}' on '{source.body_name(each.carrier)}', and "
        "the bodies of a robot are one tree"
        for each in mounts
    ]


def _pose_of_second(numbers: Vector) -> tuple[Vector, Vector]:
    """Returns the pose that a weld gives the second body in the frame of the first.

    MuJoCo keeps a point in both frames, the second body's first, and the orientation.
    """
    pos, quat, turned = numbers[3:6].copy(), numbers[6:10].copy(), np.zeros(3)
    mujoco.mju_rotVecQuat(turned, numbers[:3], quat)
    return pos - turned, quat


def _floats(source: SourceModel, body: int) -> bool:
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    return any(int(source.model.jnt_type[joint]) == free for joint in source.joints_of(body))


def _is_mounted_on(mounts: dict[int, Mount], model: mujoco.MjModel, body: int, part: int) -> bool:
    """Returns True if a body hangs, over other mounts, on a part."""
    top = int(model.body_rootid[body])
    while top != part and top in mounts:
        top = int(model.body_rootid[mounts[top].carrier])
    return top == part


def _hang(tree: ElementTree.Element, source: SourceModel, mounts: list[Mount]) -> None:
    parents = {child: parent for parent in tree.iter() for child in parent}
    bodies = {body.get("name"): body for body in tree.iter("body")}
    for each in mounts:
        part, carrier = (bodies[source.body_name(body)] for body in (each.part, each.carrier))
        parents[part].remove(part)
        for joint in list(part):
            if joint.tag == "freejoint" or joint.get("type") == "free":
                part.remove(joint)
        write_pose(part, each.pos, each.quat)
        if part.get("childclass") is None:
            part.set("childclass", "main")  # else its elements take the defaults of the carrier
        carrier.append(part)
