"""Finds the joints that move a robot's root, and chooses its kind of base."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from robocell._onboarding.actuation import Actuation
from robocell._onboarding.geometry import surface_points
from robocell._onboarding.guess import Confidence, Guess
from robocell._onboarding.source_model import SourceModel, Vector

WIDE_M = 2.0  # the travel of a slide that moves a base and not a gantry
# Pedestals of arms that reach this far, m; smaller ones stand on the table.
REACH_FOR_PEDESTAL = 0.62
# A base whose lowest point is higher than this above its frame hangs there, m.
HELD_M = 0.3
# A base whose lowest point is farther than this from its frame is moved to stand on its box, m.
FLUSH_M = 0.008


@dataclass
class Base:
    """The joints before the arms, and the body that they move."""

    free_joint: int | None
    joints: list[int]  # slides and hinges that move the base: x, y, perhaps z, yaw
    body: int  # the last one that they move; the root without any


def find_base(source: SourceModel, root: int) -> Base:
    """Finds the base joints at the top of a robot's tree."""
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
    source: SourceModel, actuation: Actuation, base: Base, *, reach: float, on_box: bool
) -> Guess[dict[str, object]]:
    """Guesses the field `base` of the robot file.

    Args:
        source: The model.
        actuation: Its actuators.
        base: The joints of the base.
        reach: Reach of the first arm, m; 0 without one.
        on_box: True if the arms' base stands on a box; False if a torso carries it.
    """
    has_arm = reach > 0
    value: dict[str, object] = {"kind": "mocap"}
    driven = any(actuation.is_moved(joint) for joint in base.joints)
    on_box = on_box and not base.joints and _stands_upright(source, base.body)
    if on_box and reach > REACH_FOR_PEDESTAL:
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


def _fixed_points(source: SourceModel, body: int) -> Vector:
    """Returns (n, 3) points on the base and the bodies fixed to it, in its frame."""
    bodies = [each for each in source.rigid_with(body) if source.is_below(each, body)]
    geoms = [geom for each in bodies for geom in source.geoms_of(each)]
    points = surface_points(source, source.data, geoms)
    rotation = source.data.xmat[body].reshape(3, 3)
    return np.asarray((points - source.data.xpos[body]) @ rotation)


def lowest_of_base(source: SourceModel, body: int) -> float:
    """Returns the height of the lowest point of a base in its frame, m; 0 without geoms."""
    points = _fixed_points(source, body)
    return float(points[:, 2].min()) if len(points) else 0.0


def sinks(source: SourceModel, base: Base, root: int) -> bool:
    """Returns True if a base that stands upright reaches below the floor in its model."""
    if base.joints or base.free_joint is not None or not _stands_upright(source, base.body):
        return False
    return float(source.data.xpos[root][2]) + lowest_of_base(source, root) < -FLUSH_M


def _stands_upright(source: SourceModel, body: int) -> bool:
    """Returns True if a box of `pedestal_size` below its frame is below the base."""
    points = _fixed_points(source, body)
    if len(points) == 0:
        return True
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    if float(points[:, 2].min()) > HELD_M:
        return False  # something that the model leaves out holds it there
    is_over_it = bool((low < 0.05).all() and (high > -0.05).all())
    return bool(source.data.xmat[body][8] > 0.99) and is_over_it and float(high.max()) < 1


def is_at_origin(source: SourceModel, root: int) -> bool:
    """Returns True if the model's topmost body is at the world's origin, upright."""
    at, quat = source.model.body_pos[root], source.model.body_quat[root]
    return bool(np.abs(at).max() < 1e-6 and abs(abs(quat[0]) - 1) < 1e-6)


def pedestal_size(source: SourceModel, body: int, reach: float) -> list[float]:
    """Returns length, width and height of a box under the base, m."""
    points = _fixed_points(source, body)
    half = float(np.abs(points[:, :2]).max()) if len(points) else 0.0
    side = round(min(max(2 * half + 0.04, 0.16), 0.4), 2)
    return [side, side, round(min(0.3, 0.3 * reach), 2)]
