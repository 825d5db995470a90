"""What a robot stands on: the joints that move its root, and the kind of base to give it."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from robocell.onboarding.actuation import Actuation
from robocell.onboarding.guess import Confidence, Guess
from robocell.onboarding.source_model import SourceModel

WIDE_M = 2.0  # the travel of a slide that moves a base and not a gantry
# Pedestals of arms that reach this far, m; smaller ones stand on the table.
REACH_FOR_PEDESTAL = 0.62


@dataclass
class Base:
    """The joints before the arms, and the body that they move."""

    free_joint: int | None
    joints: list[int]  # slides and hinges that move the base: x, y, perhaps z, yaw
    body: int  # the last one that they move; the root without any


def find_base(source: SourceModel, root: int) -> Base:
    """The base joints at the top of a robot's tree."""
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    base = Base(None, [], root)
    body = root
    while True:
        for joint in source.joints_of(body):
            if int(source.model.jnt_type[joint]) == free:
                base.free_joint, base.body = joint, body
            elif _moves_base(source, joint, base.joints):
                base.joints.append(joint)
                base.body = body
            else:
                return _settled(source, base, root)
        below = [child for child in source.children(body) if source.joints_below(child)]
        if len(below) != 1:
            return _settled(source, base, root)
        body = below[0]


def _settled(source: SourceModel, base: Base, root: int) -> Base:
    """Less than two slides are a rail or a turntable, which is a joint of the arm."""
    if sum(source.is_slide(joint) for joint in base.joints) < 2:
        base.joints = []
        base.body = root if base.free_joint is None else base.body
    return base


def _moves_base(source: SourceModel, joint: int, before: list[int]) -> bool:
    limits = source.limits(joint)
    if limits is not None and limits[1] - limits[0] < WIDE_M:
        return False
    if source.is_slide(joint):
        return True
    slides = [each for each in before if source.is_slide(each)]
    upright = abs(float(source.data.xaxis[joint][2])) > 0.99
    return source.is_scalar(joint) and upright and len(slides) >= 2 and len(before) == len(slides)


def guess_base(
    source: SourceModel, actuation: Actuation, base: Base, *, has_arm: bool, reach: float
) -> Guess[dict[str, object]]:
    """The field `base` of the robot file."""
    value: dict[str, object] = {"kind": "mocap"}
    driven = any(actuation.is_moved(joint) for joint in base.joints)
    if has_arm and reach > REACH_FOR_PEDESTAL and not base.joints:
        value["size"] = pedestal_size(source, base.body, reach)
    if base.joints:
        how = "its own joints drive it" if driven else "nothing drives the joints of its base"
        return Guess(
            value, f"tasks put it where the objects are; {how} from there", Confidence.MEDIUM
        )
    if base.free_joint is not None:
        return Guess(
            value,
            "it floats in the model; here it is held where a task puts it. For a robot that has to "
            "balance leave out `base` and the edit that deletes its free joint",
            Confidence.MEDIUM,
        )
    return Guess(
        value,
        "tasks can put it where the objects are; `fixed` bolts it down",
        Confidence.HIGH if has_arm else Confidence.MEDIUM,
    )


def pedestal_size(source: SourceModel, body: int, reach: float) -> list[float]:
    """Length, width and height of a box under the base, m."""
    half = 0.0
    for each in source.rigid_with(body):
        if not source.is_below(each, body):
            continue
        for geom in source.geoms_of(each):
            if source.model.geom_rbound[geom] > 0:
                offset = source.data.geom_xpos[geom] - source.data.xpos[body]
                half = max(half, float(max(abs(offset[0]), abs(offset[1]))))
                half = max(half, min(float(source.model.geom_rbound[geom]), 0.2) * 0.6)
    side = round(min(max(2 * half + 0.04, 0.16), 0.4), 2)
    return [side, side, round(min(0.3, 0.3 * reach), 2)]
