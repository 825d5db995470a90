"""Hands of two jaws: one is the arm's last link, the other turns or slides against it."""

from __future__ import annotations

from typing import Any

import numpy as np

from robocell._onboarding.geometry import nearest_points, surface_points
from robocell._onboarding.source_model import SourceModel, Vector

# A jaw closes when its tip comes this near to the hand (m) at one end of its range, and is this
# much farther away at the other.
JAW_GAP = 0.015
JAW_TRAVEL = 0.015
# The part of a jaw that is its tip, in shares of its length from the joint; and where its
# counterpart begins.
TIP_SHARE = 0.6
COUNTERPART_SHARE = 0.4


def is_jaw(source: SourceModel, joint: int) -> bool:
    """Returns True if a joint's body closes against its parent body and points away from the arm.

    A wrist that folds back onto the forearm also approaches its parent, but then it points back.
    """
    limits = source.limits(joint)
    if limits is None or not source.is_scalar(joint):
        return False
    ends = [_closing(source, joint, value) for value in limits]
    if None in ends:
        return False
    gaps = [end[0] for end in ends if end]
    closed = int(np.argmin(gaps))
    tip = ends[closed]
    if gaps[closed] > JAW_GAP or gaps[1 - closed] < gaps[closed] + JAW_TRAVEL or tip is None:
        return False
    return _points_away(source, joint, tip[1])


def jaw_tips(source: SourceModel, joint: int, value: float) -> tuple[Vector, Vector] | None:
    """Returns the closest points of the moving and the fixed jaw at a joint value, in the world."""
    found = _closing(source, joint, value)
    return (found[1], found[2]) if found else None


def _closing(source: SourceModel, joint: int, value: float) -> tuple[float, Vector, Vector] | None:
    """Returns distance and points of the moving tip and its counterpart; None without one."""
    m = source.model
    body = int(m.jnt_bodyid[joint])
    carrier = int(m.body_parentid[body])
    qpos = m.qpos0.copy()
    qpos[m.jnt_qposadr[joint]] = value
    data = source.new_data(qpos)
    moving = surface_points(source, data, jaw_geoms(source, body))
    fixed = surface_points(source, data, carrier_geoms(source, carrier))
    if len(moving) == 0 or len(fixed) == 0:
        return None
    origin = data.xanchor[joint]
    length = _distances(moving, origin).max()
    tip = moving[_distances(moving, origin) > TIP_SHARE * length]
    counterpart = fixed[_distances(fixed, origin) > COUNTERPART_SHARE * length]
    if len(counterpart) == 0:
        return None
    return nearest_points(tip, counterpart)


def jaw_geoms(source: SourceModel, body: int) -> list[int]:
    """Returns the moving jaw's geoms: the colliding ones, if any."""
    geoms = [geom for each in source.subtree(body) for geom in source.geoms_of(each)]
    return [geom for geom in geoms if source.collides(geom)] or geoms


def carrier_geoms(source: SourceModel, carrier: int) -> list[int]:
    """Returns the fixed jaw's geoms: those of the parent body and of bodies fixed to it."""
    bodies = [each for each in source.rigid_with(carrier) if source.is_below(each, carrier)]
    geoms = [geom for each in bodies for geom in source.geoms_of(each)]
    return [geom for geom in geoms if source.collides(geom)] or geoms


def _points_away(source: SourceModel, joint: int, tip: Vector) -> bool:
    """Returns True if the tip of a closed jaw is beyond its joint, seen from the arm."""
    m, d = source.model, source.data
    carrier = int(m.body_parentid[m.jnt_bodyid[joint]])
    wrist = _wrist(source, carrier)
    hinge: Any = d.xanchor[joint]
    return float(np.dot(tip - hinge, hinge - wrist)) > 0 or (
        float(np.linalg.norm(tip - wrist)) > float(np.linalg.norm(hinge - wrist))
    )


def _wrist(source: SourceModel, body: int) -> Vector:
    """Returns the position of the joint that moves a body."""
    while body and not source.joints_of(body):
        body = int(source.model.body_parentid[body])
    joints = source.joints_of(body)
    return np.array(source.data.xanchor[joints[-1]] if joints else source.data.xpos[body])


def _distances(points: Vector, origin: Vector) -> Vector:
    return np.asarray(np.linalg.norm(points - origin, axis=1))
