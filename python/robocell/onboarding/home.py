"""Where the arms stand when an episode begins: a keyframe of the model, or a pose with room.

A pose has room when it touches nothing, no joint is near a limit, the TCP can move in every
direction, and it is in front of the robot, above its base and pointing down, where things to pick
are.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from robocell.onboarding.guess import Confidence, Guess
from robocell.onboarding.source_model import SourceModel, Vector

SAMPLES = 4000
TRIED = 200  # of the best, for contacts
DEEP = 0.001  # m; parts that touch less than this only rest on each other
# Manipulability below this share of what the arm has elsewhere is a singular pose.
SINGULAR_SHARE = 0.08


@dataclass(frozen=True)
class Home:
    """Joint positions of a whole model."""

    qpos: Vector
    name: str  # of the keyframe; "" for a pose that was looked for

    def __str__(self) -> str:
        return f"keyframe '{self.name}'" if self.name else "a pose that was looked for"


@dataclass(frozen=True)
class ArmFrame:
    """What is needed of an arm to judge its poses."""

    joints: list[int]
    base: int  # body
    tip_body: int
    tip: Vector  # TCP in the frame of the tip's body
    approach: Vector  # z of the TCP in that frame
    robot: list[int]  # bodies whose contacts count


def guess_home(source: SourceModel, arms: list[ArmFrame], start: Vector) -> Guess[Home]:
    """The home of all arms.

    Args:
        source: The model.
        arms: What can move; those that come later are kept clear of.
        start: Joint positions of the rest, hands open.
    """
    keys = [(str(source.model.key(k).name), k) for k in range(source.model.nkey)]
    usable = [Home(np.array(source.model.key_qpos[k]), name or f"key{k}") for name, k in keys]
    named = sorted(usable, key=lambda home: home.name != "home")
    reasons = []
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
    if not wrong and all(has_room(source, arm, start) for arm in arms):
        return Guess(Home(start, ""), "all joints at their reference", Confidence.MEDIUM)
    reasons.append(f"not the reference pose: {wrong or 'the arm is stretched out or at a limit there'}")
    qpos = start.copy()
    for arm in arms:
        qpos = _looked_for(source, arm, qpos)
    left = what_is_wrong(source, arms, qpos)
    reasons.insert(0, f"looked for: nothing touches, room to move, TCP in front{' (but ' + left + ')' if left else ''}")
    return Guess(
        Home(qpos, ""), "; ".join(reasons), Confidence.LOW if left else Confidence.MEDIUM, ()
    )


def what_is_wrong(source: SourceModel, arms: list[ArmFrame], qpos: Vector) -> str:
    """Why a pose cannot be home; "" for one that can."""
    m = source.model
    for arm in arms:
        for joint in arm.joints:
            limits = source.limits(joint)
            value = qpos[m.jnt_qposadr[joint]]
            if limits and not limits[0] - 1e-3 <= value <= limits[1] + 1e-3:
                return f"joint '{source.joint_name(joint)}' is beyond its limits there"
    pair = first_contact(source, arms[0].robot if arms else [], qpos)
    return f"'{pair[0]}' touches '{pair[1]}' there" if pair else ""


def first_contact(
    source: SourceModel, robot: list[int], qpos: Vector
) -> tuple[str, str] | None:
    """Two bodies of the robot that are in each other, neighbours left out."""
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


def has_room(source: SourceModel, arm: ArmFrame, qpos: Vector) -> bool:
    """Whether the arm can move in every direction and no joint is near a limit."""
    best = max(_manipulability(source, arm, each) for each in _samples(source, arm, qpos, 60))
    margin = _margin(source, arm, qpos)
    return margin > 0.03 and _manipulability(source, arm, qpos) > SINGULAR_SHARE * best


# --- Looking for a pose ---


def _looked_for(source: SourceModel, arm: ArmFrame, start: Vector) -> Vector:
    samples = _samples(source, arm, start, SAMPLES)
    scores = np.array([_score(source, arm, qpos) for qpos in samples])
    order = np.argsort(-scores)[:TRIED]
    for index in order:
        qpos = _improved(source, arm, samples[index], float(scores[index]))
        if first_contact(source, arm.robot, qpos) is None:
            return _tidied(source, arm, qpos)
    return start


def _samples(source: SourceModel, arm: ArmFrame, start: Vector, count: int) -> Vector:
    """Joint positions spread over the limits of an arm."""
    rng = np.random.default_rng(0)
    qpos = np.tile(start, (count, 1))
    for joint in arm.joints:
        lower, upper = source.limits(joint) or (-np.pi, np.pi)
        if not source.is_slide(joint):
            lower, upper = max(lower, -np.pi), min(upper, np.pi)
        qpos[:, source.model.jnt_qposadr[joint]] = rng.uniform(lower, upper, count)
    return qpos


def _improved(source: SourceModel, arm: ArmFrame, qpos: Vector, score: float) -> Vector:
    """Climbs to a better pose nearby by small random steps."""
    rng = np.random.default_rng(1)
    addresses = [int(source.model.jnt_qposadr[joint]) for joint in arm.joints]
    size = 0.3
    for _ in range(400):
        other = qpos.copy()
        for joint, address in zip(arm.joints, addresses, strict=True):
            lower, upper = source.limits(joint) or (-np.pi, np.pi)
            step = size * rng.normal() * (0.3 if source.is_slide(joint) else 1.0)
            other[address] = np.clip(other[address] + step, lower, upper)
        found = _score(source, arm, other)
        if found > score:
            qpos, score = other, found
        else:
            size = max(size * 0.985, 0.01)
    return qpos


def _tidied(source: SourceModel, arm: ArmFrame, qpos: Vector) -> Vector:
    """Two digits behind the point are enough for a pose that was found by chance."""
    tidy = qpos.copy()
    for joint in arm.joints:
        address = int(source.model.jnt_qposadr[joint])
        lower, upper = source.limits(joint) or (-np.inf, np.inf)
        tidy[address] = np.clip(np.round(qpos[address], 2), lower, upper)
    return tidy if first_contact(source, arm.robot, tidy) is None else qpos


_scratch: dict[int, mujoco.MjData] = {}


def _kinematics(source: SourceModel, qpos: Vector) -> mujoco.MjData:
    data = _scratch.setdefault(id(source.model), mujoco.MjData(source.model))
    data.qpos[:] = qpos
    mujoco.mj_kinematics(source.model, data)
    return data


def _score(source: SourceModel, arm: ArmFrame, qpos: Vector) -> float:
    data = _kinematics(source, qpos)
    rotation = data.xmat[arm.tip_body].reshape(3, 3)
    base = data.xmat[arm.base].reshape(3, 3)
    tip = base.T @ (rotation @ arm.tip + data.xpos[arm.tip_body] - data.xpos[arm.base])
    down = -float((base.T @ rotation @ arm.approach)[2])
    reach = _reach(source, arm)
    ahead = float(np.hypot(tip[0], tip[1])) / reach
    aside = abs(float(np.arctan2(tip[1], tip[0])))
    height = float(tip[2]) / reach
    score = 2.0 * down - 3.0 * abs(ahead - 0.55) - 2.0 * abs(height - 0.25) - 0.5 * aside
    score += min(_margin(source, arm, qpos), 0.15) * 6
    middle = 0.0
    for joint in arm.joints:
        limits = source.limits(joint)
        if limits:
            value = qpos[source.model.jnt_qposadr[joint]]
            middle += abs(2 * (value - limits[0]) / max(limits[1] - limits[0], 1e-9) - 1)
    lowest = min(float(data.xpos[body][2] - data.xpos[arm.base][2]) for body in arm.robot)
    return score - 0.1 * middle / len(arm.joints) - 4 * max(0.0, -lowest - 0.3 * reach)


def _margin(source: SourceModel, arm: ArmFrame, qpos: Vector) -> float:
    """The least share of its range that a joint has left to a limit."""
    least = 0.5
    for joint in arm.joints:
        limits = source.limits(joint)
        if limits and limits[1] > limits[0]:
            value = qpos[source.model.jnt_qposadr[joint]]
            least = min(
                least, float(min(value - limits[0], limits[1] - value) / (limits[1] - limits[0]))
            )
    return least


def _manipulability(source: SourceModel, arm: ArmFrame, qpos: Vector) -> float:
    """The smallest velocity of the TCP that joints at unit speed give it in some direction."""
    data = source.new_data(qpos)
    rotation = data.xmat[arm.tip_body].reshape(3, 3)
    point = rotation @ arm.tip + data.xpos[arm.tip_body]
    jacobian = np.zeros((3, source.model.nv))
    mujoco.mj_jac(source.model, data, jacobian, None, point, arm.tip_body)
    columns = jacobian[:, [int(source.model.jnt_dofadr[joint]) for joint in arm.joints]]
    values = np.linalg.svd(columns, compute_uv=False)
    return float(values[min(3, len(arm.joints)) - 1])


_reaches: dict[tuple[int, int], float] = {}


def _reach(source: SourceModel, arm: ArmFrame) -> float:
    """The farthest that random poses put the TCP from the base, m."""
    key = (id(source.model), arm.tip_body)
    if key not in _reaches:
        best = 1e-3
        for qpos in _samples(source, arm, source.model.qpos0, 300):
            data = _kinematics(source, qpos)
            rotation = data.xmat[arm.tip_body].reshape(3, 3)
            tip = rotation @ arm.tip + data.xpos[arm.tip_body] - data.xpos[arm.base]
            best = max(best, float(np.linalg.norm(tip)))
        _reaches[key] = best
    return _reaches[key]


def reach_of(source: SourceModel, arm: ArmFrame) -> float:
    """How far the TCP gets from the base, roughly, m."""
    return _reach(source, arm)
