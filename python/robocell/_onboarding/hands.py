"""Finds the fingers of a hand by moving its actuators in a copy of the model.

With linkages, tendons and equalities, a hand's tree does not show the effect of an actuator. So the
hand is moved from one end of its controls to the other: without gravity, with a fixed arm, and with
contacts only within the hand. The two bodies that come together are its fingers.
"""

from __future__ import annotations

import copy
import itertools
from collections import Counter
from dataclasses import dataclass, field

import mujoco
import numpy as np

from robocell._onboarding.actuation import Actuation, Actuator, Drive
from robocell._onboarding.geometry import surface_points
from robocell._onboarding.jaws import jaw_tips
from robocell._onboarding.limbs import Hand
from robocell._onboarding.named_poses import HandPoses, named_poses
from robocell._onboarding.source_model import SourceModel, Vector

MOST_ACTUATORS = 3  # of a gripper; hands with more have named poses
LONGEST_S = 3.0
HELD = 0.5  # of an actuator's push: dry friction above this keeps fingers from closing
STILL = 1e-3  # rad/s or m/s
LEAST_TRAVEL = 0.004  # m between open and closed
FARTHEST = 0.5  # m that distances are measured to
# The part of two fingers that meets: within this of their least distance, m.
PAD_DEPTH = 0.004
# Pairs of bodies are as good as closed, and as wide, within these, m.
NEARLY_CLOSED = 0.01
NEARLY_AS_WIDE = 0.006
NEARLY_CLOSED_SHARE = 0.2
# Further fingers open to this share of the widest pair's distance, and reach out as far.
ALMOST = 0.7


@dataclass
class Fingers:
    """The two parts that grip, with where they do, in the frame of the hand's body.

    Attributes:
        bodies: Those of the fingers.
        closed: Their distance when closed, m.
        open: Their distance when open, m: the least of all their geoms.
        pad_closed: The distance of the points that meet, closed.
        pad_open: The same, open. Of fingers that turn it is larger than `open`.
        open_qpos: Joint positions of the whole model with the hand open.
        closed_qpos: The same with the hand closed.
        middle: Between the pads, in the frame of `Hand.body`.
        closing: Unit vector from the first finger to the second.
        open_ctrl: The controls of the actuators with the hand open.
        closed_ctrl: The same with the hand closed.
        meets: The share of the travel, from closed (0) to open (1), at which they meet.
        is_jaw: Whether one of them is the hand itself.
        tips: Where each finger meets the other, in the frame of its body.
        others: Further fingers that close against the first, each with its body and its tip.
    """

    bodies: tuple[int, int]
    closed: float
    open: float
    pad_closed: float
    pad_open: float
    open_qpos: Vector
    closed_qpos: Vector
    middle: Vector
    closing: Vector
    open_ctrl: list[float]
    closed_ctrl: list[float]
    meets: float
    is_jaw: bool
    tips: tuple[Vector, Vector]
    others: list[tuple[int, Vector]] = field(default_factory=list)


@dataclass
class HandMotion:
    """Motion of a hand's actuators; `fingers` is None for the reason `why_none`.

    `friction` has smaller friction losses for joints whose actuators cannot overcome theirs.
    """

    actuators: list[Actuator]
    fingers: Fingers | None
    why_none: str = ""
    friction: dict[int, float] = field(default_factory=dict)
    poses: HandPoses | None = None  # of a hand with many joints


def hand_actuators(actuation: Actuation, hand: Hand) -> list[Actuator]:
    """Returns the actuators that move only joints of the hand."""
    own = set(hand.joints)
    found = []
    for actuator in actuation.actuators:
        moved = set(actuator.joints)
        if moved and moved <= own:
            found.append(actuator)
    return found


def find_fingers(
    source: SourceModel, actuation: Actuation, hand: Hand, qpos: Vector | None = None
) -> HandMotion:
    """Moves the hand and looks which parts of it meet.

    Args:
        source: The model.
        actuation: Its actuators.
        hand: The hand, with its joints.
        qpos: Where the rest of the robot stands; the reference pose unless given.
    """
    actuators = hand_actuators(actuation, hand)
    if not actuators:
        return HandMotion([], None, "no actuator moves its joints")
    ends = [control_range(source, actuator) for actuator in actuators]
    if None in ends:
        return HandMotion(actuators, None, "its actuators have no control range")
    if len(actuators) > MOST_ACTUATORS:
        return _many_joints(source, actuation, hand, actuators, [e for e in ends if e], qpos)
    friction = _lower_friction(source, actuators)
    poses = []
    for corner in itertools.product((0, 1), repeat=len(ends)):
        ctrl = [end[index] for end, index in zip(ends, corner, strict=True) if end]
        qpos_there = _moved(source, hand, actuators, ctrl, qpos, friction)
        if qpos_there is None:
            return HandMotion(actuators, None, "the simulation of its motion diverged")
        poses.append(_Pose(ctrl, qpos_there, source.new_data(qpos_there)))
    branches = _branches(source, hand)
    if len(branches) > 1:
        groups = _linkages(source, [source.subtree(branch) for branch in branches])
        fingers = _meeting_pair(source, hand, groups, poses)
    else:
        fingers = _jaw(source, hand, poses)
    if fingers is None:
        return HandMotion(actuators, None, "no two parts of it come together when it is driven")
    return HandMotion(actuators, fingers, friction=friction)


def _many_joints(
    source: SourceModel,
    actuation: Actuation,
    hand: Hand,
    actuators: list[Actuator],
    ranges: list[tuple[float, float]],
    qpos: Vector | None,
) -> HandMotion:
    """Returns the fingers of a hand that opens and closes between named poses."""
    found = named_poses(source, actuation, actuators, ranges, _branches(source, hand), qpos)
    if found is None:
        why = f"the tips of its fingers, moved by {len(actuators)} actuators, do not meet"
        return HandMotion(actuators, None, why)
    poses = []
    for name in ("closed", "open"):
        ctrl = [found.poses[name][actuator.name] for actuator in actuators]
        there = _moved(source, hand, actuators, ctrl, qpos, {})
        if there is None:
            return HandMotion(actuators, None, "the simulation of its motion diverged")
        poses.append(_Pose(ctrl, there, source.new_data(there)))
    bodies = (found.tips[0].body, found.tips[found.partner].body)
    closed, opened = (_gap(source, pose.data, *bodies) for pose in poses)
    if opened < max(closed, 0) + LEAST_TRAVEL:
        return HandMotion(actuators, None, "its thumb does not open from the other fingers")
    pair = _Pair(bodies, closed, opened, 0, 1)
    fingers = _fingers(source, hand, pair, _pads(source, pair, poses), poses)
    _centre(source, hand, fingers, [(tip.body, tip.point) for tip in found.tips], poses)
    return HandMotion(actuators, fingers, poses=found)


def _centre(
    source: SourceModel,
    hand: Hand,
    fingers: Fingers,
    tips: list[tuple[int, Vector]],
    poses: list[_Pose],
) -> None:
    """Centres a hand of three and more fingers between the first and the middle of the others."""
    between = source.new_data(_between(poses[0], poses[1], 0.5))
    first, *others = [_to_world(between, body, point) for body, point in tips]
    other = np.mean(others, axis=0)
    fingers.middle = _to_body(between, hand.body, (first + other) / 2)
    closing = between.xmat[hand.body].reshape(3, 3).T @ (other - first)
    fingers.closing = closing / max(float(np.linalg.norm(closing)), 1e-9)


def control_range(source: SourceModel, actuator: Actuator) -> tuple[float, float] | None:
    """Returns the ends of an actuator's control; its joint's for a servo without a range."""
    m = source.model
    address = int(m.actuator_ctrladr[actuator.id])
    if m.actuator_ctrllimited[address]:
        lower, upper = m.actuator_ctrlrange[address]
        return float(lower), float(upper)
    if actuator.drive is Drive.POSITION and actuator.is_on_joint:
        return source.limits(actuator.joints[0])
    return None


def _lower_friction(source: SourceModel, actuators: list[Actuator]) -> dict[int, float]:
    """Returns smaller friction losses by joint, for servos that cannot overcome the model's."""
    m = source.model
    found = {}
    for actuator in actuators:
        ends = control_range(source, actuator)
        if actuator.drive is not Drive.POSITION or not actuator.is_on_joint or not ends:
            continue
        joint = actuator.joints[0]
        push = float(m.actuator_gainprm[actuator.id][0]) * (ends[1] - ends[0])
        if m.actuator_forcelimited[actuator.id]:
            push = min(push, float(np.abs(m.actuator_forcerange[actuator.id]).max()))
        if m.dof_frictionloss[m.jnt_dofadr[joint]] > HELD * push:
            found[joint] = float(f"{push / 20:.1g}")
    return found


@dataclass
class _Pose:
    """The hand after it was driven to controls."""

    ctrl: list[float]
    qpos: Vector
    data: mujoco.MjData


# --- Moving it ---


def _moved(
    source: SourceModel,
    hand: Hand,
    actuators: list[Actuator],
    ctrl: list[float],
    qpos: Vector | None,
    friction: dict[int, float],
) -> Vector | None:
    """Returns joint positions after the hand was driven to controls; None if that diverges."""
    m = copy.copy(source.model)
    m.opt.gravity[:] = 0
    for joint, loss in friction.items():
        m.dof_frictionloss[m.jnt_dofadr[joint]] = loss
    inside = set(source.subtree(hand.body))
    for geom in range(m.ngeom):
        if int(m.geom_bodyid[geom]) not in inside:
            m.geom_contype[geom] = m.geom_conaffinity[geom] = 0
    data = mujoco.MjData(m)
    if qpos is not None:
        data.qpos[:] = qpos
    for joint in hand.joints:  # fingers that begin beyond their limits would jam
        limits = source.limits(joint)
        if limits and source.is_scalar(joint):
            address = int(m.jnt_qposadr[joint])
            data.qpos[address] = np.clip(data.qpos[address], *limits)
    start = data.qpos.copy()
    others = [j for j in range(m.njnt) if j not in set(hand.joints)]
    held_q, held_v = _addresses(source, others)
    for actuator, value in zip(actuators, ctrl, strict=True):
        data.ctrl[int(m.actuator_ctrladr[actuator.id])] = value
    steps = int(LONGEST_S / m.opt.timestep)
    for step in range(min(steps, 4000)):
        mujoco.mj_step(m, data)
        data.qpos[held_q], data.qvel[held_v] = start[held_q], 0
        if not np.isfinite(data.qpos).all() or np.abs(data.qvel).max() > 1e5:
            return None
        if step * m.opt.timestep > 0.5 and np.abs(data.qvel).max() < STILL:
            break
    return np.array(data.qpos)


def _addresses(source: SourceModel, joints: list[int]) -> tuple[list[int], list[int]]:
    positions: list[int] = []
    velocities: list[int] = []
    widths = {0: (7, 6), 1: (4, 3), 2: (1, 1), 3: (1, 1)}
    for joint in joints:
        nq, nv = widths[int(source.model.jnt_type[joint])]
        q, v = int(source.model.jnt_qposadr[joint]), int(source.model.jnt_dofadr[joint])
        positions.extend(range(q, q + nq))
        velocities.extend(range(v, v + nv))
    return positions, velocities


# --- Which parts meet ---


def _branches(source: SourceModel, hand: Hand) -> list[int]:
    """Returns the bodies with which fingers begin; one for a jaw that closes against the hand."""
    body = hand.body
    while True:
        branches = [child for child in source.children(body) if source.joints_below(child)]
        if len(branches) != 1 or len(source.joints_below(branches[0])) == 1:
            return branches
        body = branches[0]


def _linkages(source: SourceModel, branches: list[list[int]]) -> list[list[int]]:
    """Returns branches that `connect` or `weld` tie together as one finger.

    If all are tied, as by a slider in their middle, they stay apart.
    """
    m = source.model
    groups = [list(branch) for branch in branches]
    kinds = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
    for index in range(m.neq):
        if int(m.eq_type[index]) not in kinds or not m.eq_active0[index]:
            continue
        ends = [int(m.eq_obj1id[index]), int(m.eq_obj2id[index])]
        if int(m.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
            ends = [int(m.site_bodyid[site]) for site in ends]
        tied = [group for group in groups if any(body in group for body in ends)]
        if len(tied) == 2 and len(groups) > 2:
            groups.remove(tied[1])
            tied[0].extend(tied[1])
    return groups


def _jaw(source: SourceModel, hand: Hand, poses: list[_Pose]) -> Fingers | None:
    """Returns a single jaw: its tip and that of the hand."""
    joint = hand.joints[-1]
    address = int(source.model.jnt_qposadr[joint])
    ends = [jaw_tips(source, joint, float(pose.qpos[address])) for pose in poses]
    tips = [end for end in ends if end is not None]
    if len(tips) < len(poses):
        return None
    gaps = [float(np.linalg.norm(moving - fixed)) for moving, fixed in tips]
    closed, opened = int(np.argmin(gaps)), int(np.argmax(gaps))
    jaw = int(source.model.jnt_bodyid[joint])
    bodies = (int(source.model.body_parentid[jaw]), jaw)
    pads = (
        _to_body(poses[closed].data, bodies[0], tips[closed][1]),
        _to_body(poses[closed].data, bodies[1], tips[closed][0]),
    )
    ends_open = [_to_world(poses[opened].data, b, p) for b, p in zip(bodies, pads, strict=True)]
    gap_open = float(np.linalg.norm(ends_open[1] - ends_open[0]))
    if gap_open < gaps[closed] + LEAST_TRAVEL:
        return None
    pair = _Pair(bodies, gaps[closed], gap_open, closed, opened)
    return _fingers(source, hand, pair, pads, poses)


@dataclass
class _Pair:
    bodies: tuple[int, int]
    closed: float
    open: float
    closed_pose: int
    open_pose: int


def _meeting_pair(
    source: SourceModel, hand: Hand, groups: list[list[int]], poses: list[_Pose]
) -> Fingers | None:
    """Returns the two bodies that come together, farthest apart before."""
    pairs = []
    for first, second in itertools.combinations(groups, 2):
        for bodies in itertools.product(first, second):
            gaps = [_gap(source, pose.data, *bodies) for pose in poses]
            closed, opened = int(np.argmin(gaps)), int(np.argmax(gaps))
            pairs.append(_Pair(bodies, gaps[closed], gaps[opened], closed, opened))
    pairs = [pair for pair in pairs if pair.open > max(pair.closed, 0) + LEAST_TRAVEL]
    if not pairs:
        return None
    nearest = min(pair.closed for pair in pairs)
    near = [pair for pair in pairs if pair.closed <= max(nearest, 0) + NEARLY_CLOSED]
    candidates = [_fingers(source, hand, pair, _pads(source, pair, poses), poses) for pair in near]
    overlaps = [pair for pair in pairs if pair.closed <= 0]
    meets = max((_meeting_share(source, pair, poses) for pair in overlaps), default=0.0)
    for candidate in candidates:
        candidate.meets = meets
    widest = max(fingers.open for fingers in candidates)
    best = [each for each in candidates if each.open > widest - NEARLY_AS_WIDE]

    def depth(each: Fingers) -> float:
        """The outermost of several equally wide geoms are pads; the others carry them."""
        return min(_distance_from(source, hand, body) for body in each.bodies)

    deepest = max(depth(each) for each in best)
    wide = [
        each
        for each in candidates
        if each.open > ALMOST * widest and depth(each) > ALMOST * deepest
    ]
    by_groups: dict[tuple[int, int], Fingers] = {}
    for candidate in sorted(wide, key=depth):
        one, other = (
            next(i for i, group in enumerate(groups) if body in group) for body in candidate.bodies
        )
        by_groups[one, other] = candidate
    return _all_against_one(source, hand, by_groups, poses) or max(best, key=depth)


def _all_against_one(
    source: SourceModel,
    hand: Hand,
    by_groups: dict[tuple[int, int], Fingers],
    poses: list[_Pose],
) -> Fingers | None:
    """Returns the finger against which several others close, with them; None for two fingers."""
    count = Counter(group for pair in by_groups for group in pair)
    first, most = max(count.items(), key=lambda item: (item[1], -item[0]))
    if most < 2:
        return None
    pairs = [(pair, found) for pair, found in by_groups.items() if first in pair]
    bodies = [found.bodies[::-1] if pair[1] == first else found.bodies for pair, found in pairs]
    own = bodies[0][0]
    partners = [body for _, body in bodies]
    gaps = np.array([[_gap(source, pose.data, own, b) for b in partners] for pose in poses])
    closed, opened = int(gaps.sum(axis=1).argmin()), int(gaps.sum(axis=1).argmax())
    pair = _Pair(
        (own, partners[0]), float(gaps[closed].min()), float(gaps[opened].min()), closed, opened
    )
    tips = _tips_against(source, poses[closed].data, own, partners)
    fingers = _fingers(source, hand, pair, (tips[0], tips[1]), poses)
    ends = list(zip([own, *partners], tips, strict=True))
    fingers.others = ends[2:]
    _centre(source, hand, fingers, ends, [poses[closed], poses[opened]])
    fingers.meets = pairs[0][1].meets
    return fingers


def _tips_against(
    source: SourceModel, data: mujoco.MjData, first: int, others: list[int]
) -> list[Vector]:
    """Returns where a finger and several others face each other, in the frames of their bodies."""
    points = [surface_points(source, data, _geoms(source, [body])) for body in (first, *others)]
    towards = np.mean([each.mean(axis=0) for each in points[1:]], axis=0) - points[0].mean(axis=0)
    towards = towards / max(float(np.linalg.norm(towards)), 1e-9)
    tips = []
    for body, cloud in zip((first, *others), points, strict=True):
        along = cloud @ towards * (1 if body == first else -1)
        near = cloud[along >= along.max() - PAD_DEPTH]
        tips.append(_to_body(data, body, near.mean(axis=0)))
    return tips


def _pads(source: SourceModel, pair: _Pair, poses: list[_Pose]) -> tuple[Vector, Vector]:
    closed = poses[pair.closed_pose].data
    return _pad(source, closed, pair.bodies, 0), _pad(source, closed, pair.bodies, 1)


def _distance_from(source: SourceModel, hand: Hand, body: int) -> float:
    """Returns the distance of a body's geoms from the hand at the reference pose, m."""
    d = source.data
    ends = [d.geom_xpos[geom] for geom in _geoms(source, [body])]
    return max((float(np.linalg.norm(end - d.xpos[hand.body])) for end in ends), default=0.0)


def _geoms(source: SourceModel, bodies: list[int]) -> list[int]:
    geoms = [geom for body in bodies for geom in source.geoms_of(body)]
    return [geom for geom in geoms if source.collides(geom)]


def _gap(source: SourceModel, data: mujoco.MjData, first: int, second: int) -> float:
    """Returns the least distance of two bodies' colliding geoms, m; `FARTHEST` without any."""
    m = source.model
    best = FARTHEST
    for a, b in itertools.product(_geoms(source, [first]), _geoms(source, [second])):
        apart = float(np.linalg.norm(data.geom_xpos[a] - data.geom_xpos[b]))
        if apart - m.geom_rbound[a] - m.geom_rbound[b] > best:
            continue
        best = min(best, float(mujoco.mj_geomDistance(m, data, a, b, FARTHEST, None)))
    return best


def _fingers(
    source: SourceModel,
    hand: Hand,
    pair: _Pair,
    pads: tuple[Vector, Vector],
    poses: list[_Pose],
) -> Fingers:
    closed, opened = poses[pair.closed_pose], poses[pair.open_pose]
    rigid = set(source.rigid_with(hand.body))
    is_jaw = any(body in rigid for body in pair.bodies)
    # A jaw swings wide: what it holds is where it is nearly closed.
    share = NEARLY_CLOSED_SHARE if is_jaw else 0.5
    between = source.new_data(_between(closed, opened, share))
    ends = [
        [_to_world(state, body, pad) for body, pad in zip(pair.bodies, pads, strict=True)]
        for state in (closed.data, opened.data, between)
    ]
    closing = between.xmat[hand.body].reshape(3, 3).T @ (ends[2][1] - ends[2][0])
    return Fingers(
        bodies=pair.bodies,
        closed=max(pair.closed, 0.0),
        open=pair.open,
        pad_closed=float(np.linalg.norm(ends[0][1] - ends[0][0])),
        pad_open=float(np.linalg.norm(ends[1][1] - ends[1][0])),
        open_qpos=opened.qpos,
        closed_qpos=closed.qpos,
        open_ctrl=opened.ctrl,
        closed_ctrl=closed.ctrl,
        meets=0.0,
        middle=_to_body(between, hand.body, (ends[2][0] + ends[2][1]) / 2),
        closing=closing / max(float(np.linalg.norm(closing)), 1e-9),
        is_jaw=is_jaw,
        tips=pads,
    )


def _between(closed: _Pose, opened: _Pose, share: float) -> Vector:
    """Interpolates joint positions; free and ball joints are the same at both ends."""
    return np.asarray(closed.qpos + share * (opened.qpos - closed.qpos))


def _meeting_share(source: SourceModel, pair: _Pair, poses: list[_Pose]) -> float:
    """Returns the share of the travel from closed on up to which two bodies overlap."""
    closed, opened = poses[pair.closed_pose], poses[pair.open_pose]
    for share in np.linspace(0, 1, 41):
        data = source.new_data(_between(closed, opened, float(share)))
        if _gap(source, data, *pair.bodies) > 0:
            return max(0.0, float(share) - 1 / 40)
    return 0.0


def _pad(source: SourceModel, data: mujoco.MjData, bodies: tuple[int, int], which: int) -> Vector:
    """Returns the centre of a finger's contact surface, in the frame of its body."""
    own, other = bodies[which], bodies[1 - which]
    points = surface_points(source, data, _geoms(source, [own]))
    others = surface_points(source, data, _geoms(source, [other]))
    gaps = np.linalg.norm(points[:, None, :] - others[None, :, :], axis=2).min(axis=1)
    near = points[gaps <= gaps.min() + PAD_DEPTH]
    return _to_body(data, own, near.mean(axis=0))


def _to_world(data: mujoco.MjData, body: int, point: Vector) -> Vector:
    return np.asarray(data.xmat[body].reshape(3, 3) @ point + data.xpos[body])


def _to_body(data: mujoco.MjData, body: int, point: Vector) -> Vector:
    return np.asarray(data.xmat[body].reshape(3, 3).T @ (point - data.xpos[body]))
