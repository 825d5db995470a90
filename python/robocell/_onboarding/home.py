"""Chooses the arms' start configuration: a keyframe of the model, or a pose with room.

A pose has room if it is collision-free, no joint is near a limit, the TCP can move in every
direction, and it is in front of the robot, above its base and pointing down, where objects to pick
are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from robocell._onboarding.guess import Confidence, Guess
from robocell._onboarding.source_model import SourceModel, Vector

SAMPLES = 4000
TRIED = 200  # of the best, for contacts
DEEP = 0.001  # m; parts that touch less than this only rest on each other
# Manipulability below this share of what the arm has elsewhere is a singular pose.
SINGULAR_SHARE = 0.08
ASIDE = 1e-6  # rad or m, of differences
LEAST_MARGIN = 0.03  # of a joint's range, to its nearer limit


@dataclass(frozen=True)
class Home:
    """Joint positions of a whole model."""

    qpos: Vector
    name: str  # of the keyframe; "" for a pose that was looked for

    def __str__(self) -> str:
        return f"keyframe '{self.name}'" if self.name else "a pose that was looked for"


@dataclass(frozen=True)
class ArmFrame:
    """Data for judging an arm's poses."""

    joints: list[int]
    followers: list[int]  # joints of the arm that follow those
    settled: Callable[[Vector], Vector]  # puts followers where they belong
    base: int  # body
    tip_body: int
    tip: Vector  # TCP in the frame of the tip's body
    approach: Vector  # z of the TCP in that frame
    robot: list[int]  # bodies whose contacts count
    moving: list[int]  # bodies that the arm moves


def guess_home(source: SourceModel, arms: list[ArmFrame], start: Vector) -> Guess[Home]:
    """Guesses the home of all arms.

    Args:
        source: The model.
        arms: What can move; those that come later are kept clear of.
        start: Joint positions of the rest, hands open.
    """
    keys = [(str(source.model.key(k).name), k) for k in range(source.model.nkey)]
    usable = [Home(np.array(source.model.key_qpos[k]), name or f"key{k}") for name, k in keys]
    named = sorted(usable, key=lambda home: home.name != "home")
    reasons = []
    for arm in arms:
        start = arm.settled(start)
    for home in named:
        wrong = what_is_wrong(source, arms, home.qpos)
        if not wrong:
            first = home.name == "home"
            return Guess(
                home,
                f"the model's keyframe '{home.name}'",
                Confidence.HIGH if first else Confidence.MEDIUM,
                tuple(other for other in named if other is not home),
            )
        reasons.append(f"not the keyframe '{home.name}': {wrong}")
    wrong = what_is_wrong(source, arms, start)
    judges = [PoseJudge(source, arm) for arm in arms]
    if not wrong and all(judge.has_room(start) for judge in judges):
        return Guess(Home(start, ""), "all joints at their reference", Confidence.MEDIUM)
    reasons.append(
        f"not the reference pose: {wrong or 'the arm is stretched out or at a limit there'}"
    )
    qpos = start.copy()
    for judge in judges:
        qpos = judge.found(qpos)
    left = what_is_wrong(source, arms, qpos)
    found = "looked for: nothing touches, room to move, TCP in front"
    reasons.insert(0, f"{found}, but {left}" if left else found)
    return Guess(
        Home(qpos, ""), "; ".join(reasons), Confidence.LOW if left else Confidence.MEDIUM, ()
    )


def what_is_wrong(source: SourceModel, arms: list[ArmFrame], qpos: Vector) -> str:
    """Returns why a pose cannot be home; "" if it can."""
    m = source.model
    for arm in arms:
        for joint in [*arm.joints, *arm.followers]:
            limits = source.limits(joint)
            value = qpos[m.jnt_qposadr[joint]]
            if limits and not limits[0] - 1e-3 <= value <= limits[1] + 1e-3:
                return f"joint '{source.joint_name(joint)}' is beyond its limits there"
    pair = first_contact(source, arms[0].robot if arms else [], qpos)
    return f"'{pair[0]}' touches '{pair[1]}' there" if pair else ""


def first_contact(source: SourceModel, robot: list[int], qpos: Vector) -> tuple[str, str] | None:
    """Returns two penetrating bodies of the robot, neighbours excluded."""
    m = source.model
    own = set(robot)
    data = source.new_data(qpos)
    mujoco.mj_collision(m, data)
    for contact in data.contact[: data.ncon]:
        a, b = (int(m.geom_bodyid[geom]) for geom in contact.geom)
        if a not in own or b not in own or contact.dist > -DEEP:
            continue
        if not _are_neighbours(source, a, b):
            return source.body_name(a), source.body_name(b)
    return None


def _are_neighbours(source: SourceModel, a: int, b: int) -> bool:
    m = source.model
    first, second = int(m.body_weldid[a]), int(m.body_weldid[b])
    parents = [int(m.body_weldid[m.body_parentid[each]]) for each in (first, second)]
    return first == second or parents[0] == second or parents[1] == first


class PoseJudge:
    """Judges joint positions of one arm; keeps its buffers between calls."""

    def __init__(self, source: SourceModel, arm: ArmFrame):
        self._source = source
        self._arm = arm
        self._data = mujoco.MjData(source.model)
        self._addresses = [int(source.model.jnt_qposadr[joint]) for joint in arm.joints]
        self._dofs = [int(source.model.jnt_dofadr[joint]) for joint in arm.joints]
        self._limits = [source.limits(joint) for joint in arm.joints]
        self.reach = self._measured_reach()

    def has_room(self, qpos: Vector) -> bool:
        """Returns True if the arm can move in every direction and no joint is near a limit."""
        best = max(self.manipulability(each) for each in self.samples(qpos, 60))
        return self.margin(qpos) > LEAST_MARGIN and (
            self.manipulability(qpos) > SINGULAR_SHARE * best
        )

    def found(self, start: Vector) -> Vector:
        """Returns a pose with room; `start` if every tried one is in collision."""
        samples = self.samples(start, SAMPLES)
        scores = np.array([self.score(qpos) for qpos in samples])
        for index in np.argsort(-scores)[:TRIED]:
            if not self._is_free(samples[index]):
                continue
            qpos = self._improved(samples[index], float(scores[index]))
            for each in (self._tidied(qpos), qpos, samples[index]):
                if self._is_free(each):
                    return np.asarray(each)
        return start

    def _is_free(self, qpos: Vector) -> bool:
        """Returns True if nothing touches and the joints that follow are within their limits."""
        for joint in self._arm.followers:
            limits = self._source.limits(joint)
            value = float(qpos[self._source.model.jnt_qposadr[joint]])
            if limits and not limits[0] <= value <= limits[1]:
                return False
        return first_contact(self._source, self._arm.robot, qpos) is None

    def samples(self, start: Vector, count: int) -> Vector:
        """(count, nq) joint positions spread over the limits of the arm."""
        rng = np.random.default_rng(0)
        qpos = np.tile(start, (count, 1))
        for joint, address, limits in zip(
            self._arm.joints, self._addresses, self._limits, strict=True
        ):
            lower, upper = limits or (-np.pi, np.pi)
            if not self._source.is_slide(joint):
                lower, upper = max(lower, -np.pi), min(upper, np.pi)
            qpos[:, address] = rng.uniform(min(lower, upper), upper, count)
        if self._arm.followers:
            qpos = np.array([self._arm.settled(each) for each in qpos])
        return qpos

    def score(self, qpos: Vector) -> float:
        """Scores a pose higher for a TCP in front, above the base, pointing down, with room."""
        arm, data = self._arm, self._at(qpos)
        rotation = data.xmat[arm.tip_body].reshape(3, 3)
        base = data.xmat[arm.base].reshape(3, 3)
        tip = base.T @ (rotation @ arm.tip + data.xpos[arm.tip_body] - data.xpos[arm.base])
        tip = tip / self.reach
        down = -float((base.T @ rotation @ arm.approach)[2])
        ahead, aside = float(np.hypot(tip[0], tip[1])), abs(float(np.arctan2(tip[1], tip[0])))
        score = 2.0 * down - 3.0 * abs(ahead - 0.5) - 2.0 * abs(float(tip[2]) - 0.25) - 0.5 * aside
        score += 6 * min(self.margin(qpos), 0.15)
        lowest = min(float(data.xpos[body][2] - data.xpos[arm.base][2]) for body in arm.moving)
        return score - 4 * max(0.0, -lowest) / self.reach

    def margin(self, qpos: Vector) -> float:
        """Returns the least share of its range that a joint has left to a limit."""
        least = 0.5
        for address, limits in zip(self._addresses, self._limits, strict=True):
            if limits and limits[1] > limits[0]:
                left = min(qpos[address] - limits[0], limits[1] - qpos[address])
                least = min(least, float(left / (limits[1] - limits[0])))
        return least

    def manipulability(self, qpos: Vector) -> float:
        """Returns the TCP's smallest velocity in any direction for joints at unit speed."""
        data = self._at(qpos)
        mujoco.mj_comPos(self._source.model, data)
        rotation = data.xmat[self._arm.tip_body].reshape(3, 3)
        point = rotation @ self._arm.tip + data.xpos[self._arm.tip_body]
        jacobian = np.zeros((3, self._source.model.nv))
        mujoco.mj_jac(self._source.model, data, jacobian, None, point, self._arm.tip_body)
        columns = jacobian @ self._with_followers(qpos)
        values = np.linalg.svd(columns, compute_uv=False)
        return float(values[min(3, len(self._dofs)) - 1])

    def _with_followers(self, qpos: Vector) -> Vector:
        """Returns (nv, n) velocities of the model's joints for each joint of the arm."""
        m = self._source.model
        velocities = np.zeros((m.nv, len(self._dofs)))
        for column, (dof, address) in enumerate(zip(self._dofs, self._addresses, strict=True)):
            velocities[dof, column] = 1
            if not self._arm.followers:
                continue
            aside = np.array(qpos)
            aside[address] += ASIDE
            moved = (self._arm.settled(aside) - self._arm.settled(qpos)) / ASIDE
            for joint in self._arm.followers:
                velocities[m.jnt_dofadr[joint], column] = moved[m.jnt_qposadr[joint]]
        return velocities

    def _at(self, qpos: Vector) -> mujoco.MjData:
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self._source.model, self._data)
        return self._data

    def _measured_reach(self) -> float:
        best, arm = 1e-3, self._arm
        for qpos in self.samples(self._source.model.qpos0, 400):
            data = self._at(qpos)
            rotation = data.xmat[arm.tip_body].reshape(3, 3)
            tip = rotation @ arm.tip + data.xpos[arm.tip_body] - data.xpos[arm.base]
            best = max(best, float(np.linalg.norm(tip)))
        return best

    def _improved(self, qpos: Vector, score: float) -> Vector:
        """Climbs to a better pose nearby by small random steps."""
        rng = np.random.default_rng(1)
        size = 0.3
        for _ in range(400):
            other = qpos.copy()
            for joint, address, limits in zip(
                self._arm.joints, self._addresses, self._limits, strict=True
            ):
                lower, upper = limits or (-np.pi, np.pi)
                step = size * rng.normal() * (0.3 if self._source.is_slide(joint) else 1.0)
                other[address] = np.clip(other[address] + step, lower, upper)
            other = self._arm.settled(other)
            found = self.score(other)
            if found > score:
                qpos, score = other, found
            else:
                size = max(size * 0.985, 0.01)
        return qpos

    def _tidied(self, qpos: Vector) -> Vector:
        """Rounds a pose that was found by chance to two digits."""
        tidy = qpos.copy()
        for address, limits in zip(self._addresses, self._limits, strict=True):
            lower, upper = limits or (-np.inf, np.inf)
            tidy[address] = np.clip(np.round(qpos[address], 2), lower, upper)
        return self._arm.settled(tidy)
