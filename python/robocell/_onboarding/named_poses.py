"""Named poses of hands with many joints: `open`, `closed`, `pinch`, and those of keyframes.

The thumb is the finger whose tip stands apart from the others. The controls of the servos at which
the tips meet, and those at which they are apart by `GAP`, are found by damped least squares over
the tips of all fingers. Both are then tried in a copy of the model.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np

from robocell._onboarding.actuation import Actuation, Actuator, Drive
from robocell._onboarding.geometry import surface_points
from robocell._onboarding.source_model import SourceModel, Vector

GAP = 0.08  # m between the thumb and the others in the open pose
TIP_SHARE = 0.8  # of a finger's length: what is farther out is its tip
MEETS = 0.01  # m: tips that come this near meet
# Controls go on beyond contact by this share of the way, so that the fingers press.
SQUEEZE = 0.12
STEPS = 120
DAMPING = 1e-4  # m^2, of steps in shares of the control ranges
STAY = 2e-3  # m for each share of a control range: of equal solutions the nearest is taken
MIDDLE = 0.3  # weight of the place where tips meet against their distances


@dataclass(frozen=True)
class Tip:
    """A fingertip.

    Attributes:
        body: The body that carries it.
        point: Its middle, in the frame of the body.
        radius: Its half thickness, m.
        branch: The body that the finger begins with.
    """

    body: int
    point: Vector
    radius: float
    branch: int


@dataclass
class HandPoses:
    """The poses of a hand: controls by the names of actuators.

    Attributes:
        tips: The thumb's first.
        poses: `open`, `closed` and `pinch`, and those of the model's keyframes.
        partner: Index of the finger that pinches with the thumb.
        keys: Names of the keyframes by the names of their poses.
    """

    tips: list[Tip]
    poses: dict[str, dict[str, float]]
    partner: int
    keys: dict[str, str] = field(default_factory=dict)


def named_poses(
    source: SourceModel,
    actuation: Actuation,
    actuators: list[Actuator],
    ranges: list[tuple[float, float]],
    branches: list[int],
    qpos: Vector | None = None,
) -> HandPoses | None:
    """Returns the poses of a hand; None if its fingers do not meet or servos do not hold them.

    Args:
        source: The model.
        actuation: Its actuators and couplings.
        actuators: Those of the hand.
        ranges: Their control ranges.
        branches: The bodies with which its fingers begin.
        qpos: Where the rest of the robot stands.
    """
    if any(actuator.drive is not Drive.POSITION for actuator in actuators):
        return None
    start = np.array(source.model.qpos0 if qpos is None else qpos)
    moved = {joint for actuator in actuators for joint in actuation.moved_by(actuator)}
    tips = [_tip(source, branch, moved) for branch in branches]
    found = [tip for tip in tips if tip is not None]
    if len(found) < 2:
        return None
    hand = _Servos(source, actuation, actuators, ranges, start)
    tips_in_order = _thumb_first(source, hand, found)
    search = _Search(hand, tips_in_order)
    pairs = [search.met([index]) for index in range(1, len(found))]
    partner = 1 + int(np.argmin([gap for _, gap in pairs]))
    pinch, gap = pairs[partner - 1]
    everything = list(range(1, len(found)))
    closed, _ = search.met(everything)
    if min(gap, search.gap_to_middle(closed)) > MEETS:
        return None
    opened = search.apart(closed, everything)
    poses = {
        "open": hand.named(opened),
        "closed": hand.named(hand.beyond(opened, closed)),
    }
    if len(found) > 2 and gap <= MEETS:
        pinch = np.where(search.moves([0, partner]), hand.beyond(opened, pinch), opened)
        poses["pinch"] = hand.named(pinch)
    keys = _keyframes(source, hand, poses)
    return HandPoses(tips_in_order, poses, partner, keys)


def _tip(source: SourceModel, branch: int, moved: set[int]) -> Tip | None:
    """Returns the end of a finger at the reference pose; None for a part that nothing moves."""
    bodies = source.subtree(branch)
    if not moved & set(source.joints_below(branch)):
        return None
    data = source.data
    origin = np.array(data.xpos[branch])
    best: tuple[float, int, Vector] | None = None
    for body in bodies:
        geoms = [geom for geom in source.geoms_of(body) if source.collides(geom)]
        points = surface_points(source, data, geoms)
        if len(points) == 0:
            continue
        far = float(np.linalg.norm(points - origin, axis=1).max())
        if best is None or far > best[0]:
            best = (far, body, points)
    if best is None:
        return None
    far, body, points = best
    end = points[np.linalg.norm(points - origin, axis=1) > TIP_SHARE * far]
    middle = end.mean(axis=0)
    away = (middle - origin) / max(float(np.linalg.norm(middle - origin)), 1e-9)
    beside = end - middle
    beside = beside - np.outer(beside @ away, away)
    radius = float(np.linalg.norm(beside, axis=1).mean())
    point = data.xmat[body].reshape(3, 3).T @ (middle - data.xpos[body])
    return Tip(body, np.asarray(point), radius, branch)


def _thumb_first(source: SourceModel, hand: _Servos, tips: list[Tip]) -> list[Tip]:
    """Returns the tips with the one first that is farthest from the others in mid range."""
    points = hand.points(hand.middle(), tips)
    apart = [
        float(np.linalg.norm(points[i] - np.delete(points, i, axis=0).mean(axis=0)))
        for i in range(len(tips))
    ]
    thumb = int(np.argmax(apart)) if len(tips) > 2 else 0
    return [tips[thumb], *(tip for index, tip in enumerate(tips) if index != thumb)]


class _Servos:
    """Joint positions of a hand under controls of its servos, without forces."""

    def __init__(
        self,
        source: SourceModel,
        actuation: Actuation,
        actuators: list[Actuator],
        ranges: list[tuple[float, float]],
        start: Vector,
    ):
        self._source = source
        self._actuators = actuators
        self.lower = np.array([low for low, _ in ranges])
        self.upper = np.array([high for _, high in ranges])
        self._start = start
        self._data = source.new_data(start)
        self._shares = [_joint_shares(source, actuator) for actuator in actuators]
        self._actuation = actuation

    def middle(self) -> Vector:
        """Returns the middle of the control ranges."""
        return (self.lower + self.upper) / 2

    def rest(self) -> Vector:
        """Returns the controls that hold the start, within their ranges."""
        ctrl = []
        for shares in self._shares:
            length = sum(
                self._start[address] * weight * shares.squared for address, weight in shares.joints
            )
            ctrl.append((length + shares.offset) / shares.gain)
        return np.clip(np.array(ctrl), self.lower, self.upper)

    def beyond(self, opened: Vector, closed: Vector) -> Vector:
        """Returns controls that go on a little beyond `closed`."""
        return np.clip(closed + SQUEEZE * (closed - opened), self.lower, self.upper)

    def named(self, ctrl: Vector) -> dict[str, float]:
        """Returns the controls by the names of the actuators."""
        return {
            actuator.name: round(float(value), 4) + 0.0
            for actuator, value in zip(self._actuators, ctrl, strict=True)
        }

    def ctrl_of(self, values: Vector) -> Vector:
        """Returns those of the whole model's controls that are the hand's."""
        addresses = self._source.model.actuator_ctrladr
        own = [float(values[int(addresses[actuator.id])]) for actuator in self._actuators]
        return np.clip(np.array(own), self.lower, self.upper)

    def ctrl_at(self, qpos: Vector) -> Vector:
        """Returns the controls that hold joint positions of the whole model."""
        self._start, before = qpos, self._start
        ctrl = self.rest()
        self._start = before
        return ctrl

    def points(self, ctrl: Vector, tips: list[Tip]) -> Vector:
        """Returns (n, 3) places of tips in the world."""
        m, d = self._source.model, self._data
        d.qpos[:] = self._start
        for shares, value in zip(self._shares, ctrl, strict=True):
            length = shares.gain * value - shares.offset
            for address, weight in shares.joints:
                d.qpos[address] = weight * length
        d.qpos[:] = self._actuation.settled(d.qpos)
        for joint in range(m.njnt):
            limits = self._source.limits(joint)
            if limits and self._source.is_scalar(joint):
                d.qpos[m.jnt_qposadr[joint]] = np.clip(d.qpos[m.jnt_qposadr[joint]], *limits)
        mujoco.mj_kinematics(m, d)
        return np.array([d.xmat[t.body].reshape(3, 3) @ t.point + d.xpos[t.body] for t in tips])


@dataclass(frozen=True)
class _Shares:
    """What one servo does to joints: q = weight * (gain * ctrl - offset)."""

    joints: list[tuple[int, float]]  # address and weight
    gain: float
    offset: float
    squared: float  # of the moments


def _joint_shares(source: SourceModel, actuator: Actuator) -> _Shares:
    m, d = source.model, source.data
    row = int(m.actuator_outadr[actuator.id])
    begin = int(d.moment_rowadr[row])
    moments = {
        source.joint_of_dof(int(d.moment_colind[k])): float(d.actuator_moment[k])
        for k in range(begin, begin + int(d.moment_rownnz[row]))
    }
    squared = sum(moment**2 for moment in moments.values())
    at_reference = sum(
        moment * float(d.qpos[m.jnt_qposadr[joint]]) for joint, moment in moments.items()
    )
    bias = m.actuator_biasprm[actuator.id]
    gain = float(m.actuator_gainprm[actuator.id][0] / -bias[1])
    joints = [(int(m.jnt_qposadr[j]), moments[j] / squared) for j in actuator.joints]
    offset = float(d.actuator_length[row]) - at_reference - float(bias[0] / -bias[1])
    return _Shares(joints, gain, offset, squared)


class _Search:
    """Looks for controls that bring tips together or apart."""

    def __init__(self, hand: _Servos, tips: list[Tip]):
        self._hand = hand
        self._tips = tips
        points = hand.points(hand.middle(), tips)
        self._spread = points - points[1:].mean(axis=0)

    def met(self, others: list[int]) -> tuple[Vector, float]:
        """Returns controls at which the thumb meets other fingers, and the largest gap, m."""
        best: tuple[Vector, float] | None = None
        for start in (self._hand.middle(), self._hand.rest()):
            ctrl = self._solved(start, lambda points: self._distances(points, others, 0.0))
            points = self._hand.points(ctrl, self._tips)
            gap = max(
                float(np.linalg.norm(points[i] - points[0]))
                - self._tips[i].radius
                - self._tips[0].radius
                for i in others
            )
            if best is None or gap < best[1]:
                best = (ctrl, gap)
        assert best is not None
        return best

    def gap_to_middle(self, ctrl: Vector) -> float:
        """Returns the gap between the thumb and the middle of the others, which may straddle it."""
        points = self._hand.points(ctrl, self._tips)
        radius = self._tips[0].radius + float(np.mean([tip.radius for tip in self._tips[1:]]))
        return float(np.linalg.norm(points[1:].mean(axis=0) - points[0])) - radius

    def apart(self, closed: Vector, others: list[int]) -> Vector:
        """Returns controls near `closed` at which the thumb is `GAP` away from the others."""
        points = self._hand.points(closed, self._tips)
        middle = (points[0] + points[others].mean(axis=0)) / 2

        def wanted(points: Vector) -> Vector:
            here = (points[0] + points[others].mean(axis=0)) / 2
            return np.concatenate([self._distances(points, others, GAP), MIDDLE * (here - middle)])

        return self._solved(closed, wanted)

    def moves(self, fingers: list[int]) -> Vector:
        """Returns which actuators move the tips of fingers."""
        ctrl = self._hand.middle()
        at = self._hand.points(ctrl, self._tips)
        found = []
        for index in range(len(ctrl)):
            changed = ctrl.copy()
            changed[index] += 0.1 * (self._hand.upper[index] - self._hand.lower[index])
            motion = np.linalg.norm(self._hand.points(changed, self._tips) - at, axis=1)
            found.append(bool(motion[fingers].max() > 1e-4))
        return np.array(found)

    def _distances(self, points: Vector, others: list[int], gap: float) -> Vector:
        """Returns how far the others are from where they would be `gap` away from the thumb."""
        towards = points[others].mean(axis=0) - points[0]
        towards = towards / max(float(np.linalg.norm(towards)), 1e-6)
        missing = []
        for index in others:
            radius = self._tips[index].radius + self._tips[0].radius
            beside = self._spread[index] if len(others) > 1 else np.zeros(3)
            beside = beside - (beside @ towards) * towards
            missing.append(points[index] - points[0] - towards * (radius + gap) - beside)
        return np.concatenate(missing)

    def _solved(self, start: Vector, residual: Callable[[Vector], Vector]) -> Vector:
        """Returns controls with small residuals, by damped Gauss-Newton steps from a start."""
        hand = self._hand
        width = np.maximum(hand.upper - hand.lower, 1e-9)
        ctrl = np.clip(start, hand.lower, hand.upper)

        def at(values: Vector) -> Vector:
            stay = STAY * (values - start) / width
            return np.concatenate([residual(hand.points(values, self._tips)), stay])

        value = at(ctrl)
        damping = DAMPING
        for _ in range(STEPS):
            columns = []
            for index in range(len(ctrl)):
                aside = ctrl.copy()
                step = 1e-3 * width[index]
                aside[index] += step if aside[index] + step <= hand.upper[index] else -step
                columns.append((at(aside) - value) / ((aside[index] - ctrl[index]) / width[index]))
            jacobian = np.array(columns).T
            square = jacobian.T @ jacobian + damping * np.eye(len(ctrl))
            step = -np.linalg.solve(square, jacobian.T @ value)
            tried = np.clip(ctrl + np.clip(step, -0.2, 0.2) * width, hand.lower, hand.upper)
            now = at(tried)
            if now @ now < value @ value:
                moved = float(np.abs((tried - ctrl) / width).max())
                ctrl, value, damping = tried, now, max(damping / 3, 1e-8)
                if moved < 1e-4:
                    break
            else:
                damping *= 5
                if damping > 1e3:
                    break
        return np.asarray(ctrl)


def _keyframes(
    source: SourceModel, hand: _Servos, poses: dict[str, dict[str, float]]
) -> dict[str, str]:
    """Adds the poses of the model's keyframes; returns the keyframes by the names of poses."""
    m = source.model
    found = {}
    for index in range(m.nkey):
        key = str(m.key(index).name)
        name = re.sub(r"[^A-Za-z0-9]+", "_", key).strip("_").lower()
        if not name or not name[0].isalpha() or name == "home" or name in poses:
            continue
        ctrl = hand.ctrl_of(m.key_ctrl[index])
        if not m.key_ctrl[index].any():
            ctrl = hand.ctrl_at(np.array(m.key_qpos[index]))
        poses[name] = hand.named(ctrl)
        found[name] = key
    return found
