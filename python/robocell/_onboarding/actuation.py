"""Actuators and couplings that move a model's joints."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from robocell._onboarding.guess import shortened
from robocell._onboarding.source_model import SourceModel, Vector

LEAST_MOMENT = 1e-9


class Drive(enum.Enum):
    """Kinds of actuators; the value is the word used in comments."""

    POSITION = "position servo"
    VELOCITY = "velocity servo"
    MOTOR = "motor"
    ADHESION = "adhesion"
    OTHER = "actuator of another kind"


@dataclass(frozen=True)
class Actuator:
    """An actuator with the joints that it pulls directly."""

    id: int
    name: str
    drive: Drive
    joints: tuple[int, ...]
    is_on_joint: bool  # not through a tendon or at a site
    body: int | None = None  # of an adhesion actuator


@dataclass(frozen=True)
class Follower:
    """A joint whose position is a polynomial of another's."""

    joint: int
    leader: int
    slope: float  # of the linear part
    polynomial: tuple[float, ...]  # of the leader's displacement, constant first


class Actuation:
    """All actuators and couplings of a model."""

    def __init__(self, source: SourceModel):
        self._source = source
        self.actuators = [_actuator(source, index) for index in range(source.model.nactuator)]
        self.followers = _followers(source)
        self._coupled = _coupled_joints(source, self.followers)

    def of_joint(self, joint: int) -> list[Actuator]:
        """Returns the actuators that pull a joint directly."""
        return [each for each in self.actuators if joint in each.joints]

    def on_joint(self, joint: int) -> list[Actuator]:
        """Returns the actuators that pull this joint and no other."""
        return [each for each in self.of_joint(joint) if each.is_on_joint]

    def coupled(self, joint: int) -> frozenset[int]:
        """Returns the joints that constraints move with this one, itself included."""
        return self._coupled.get(joint, frozenset((joint,)))

    def moved_by(self, actuator: Actuator) -> set[int]:
        """Returns all joints that an actuator moves, directly or through constraints."""
        return {joint for each in actuator.joints for joint in self.coupled(each)}

    def leader(self, joint: int, joints: list[int]) -> int | None:
        """Returns the one of `joints` that leads a joint, directly or through others; or None.

        Joints that follow each other in a circle are led by the first of them.
        """
        way = [joint]
        while (follower := self.follower(way[-1])) is not None:
            if follower.leader in way:
                way = [min(way[way.index(follower.leader) :])]
                break
            way.append(follower.leader)
        leader = next((each for each in reversed(way) if each in joints), joint)
        return leader if leader != joint else None

    def settled(self, qpos: Vector) -> Vector:
        """Returns joint positions in which those that follow others are where they belong."""
        m = self._source.model
        settled = np.array(qpos)
        for _ in self.followers:  # chains of followers settle one by one
            before = settled.copy()
            for each in self.followers:
                own, lead = m.jnt_qposadr[each.joint], m.jnt_qposadr[each.leader]
                moved = settled[lead] - m.qpos0[lead]
                settled[own] = m.qpos0[own] + np.polyval(each.polynomial[::-1], moved)
            if np.array_equal(before, settled):
                break
        return settled

    def is_moved(self, joint: int) -> bool:
        """Returns True if an actuator moves the joint."""
        return any(self.of_joint(each) for each in self.coupled(joint))

    def loop_of(self, joint: int) -> str:
        """Describes the constraint that moves a joint and is no equality of two joints, or ""."""
        m, source = self._source.model, self._source
        for index in range(m.neq):
            first, second = int(m.eq_obj1id[index]), int(m.eq_obj2id[index])
            if not m.eq_active0[index] or joint not in _joints_tied(source, index):
                continue
            name = m.equality(index).name or f"#{index}"
            if int(m.eq_type[index]) == int(mujoco.mjtEq.mjEQ_TENDON):
                tendons = [m.tendon(t).name or f"#{t}" for t in (first, second) if t >= 0]
                return f"one of the joints that equality '{name}' of {shortened(tendons)} ties"
            return f"part of the loop that equality '{name}' closes"
        return ""

    def follower(self, joint: int) -> Follower | None:
        """Returns how a joint follows another; None if independent."""
        return next((each for each in self.followers if each.joint == joint), None)


def _actuator(source: SourceModel, index: int) -> Actuator:
    m = source.model
    name = source.actuator_name(index)
    transmission = int(m.actuator_trntype[index])
    if transmission == int(mujoco.mjtTrn.mjTRN_BODY):
        return Actuator(
            index, name, Drive.ADHESION, (), False, body=int(m.actuator_trnid[index][0])
        )
    on_joint = transmission in (
        int(mujoco.mjtTrn.mjTRN_JOINT),
        int(mujoco.mjtTrn.mjTRN_JOINTINPARENT),
    )
    if on_joint:
        joints: tuple[int, ...] = (int(m.actuator_trnid[index][0]),)
    else:
        joints = _pulled(source, index)
    return Actuator(index, name, _drive(m, index), joints, on_joint)


def _pulled(source: SourceModel, index: int) -> tuple[int, ...]:
    """Returns the joints on which an actuator has a moment arm."""
    m, d = source.model, source.data
    first = int(m.actuator_outadr[index])
    joints: dict[int, None] = {}
    for row in range(first, first + int(m.actuator_outnum[index])):
        begin = int(d.moment_rowadr[row])
        for k in range(begin, begin + int(d.moment_rownnz[row])):
            if abs(d.actuator_moment[k]) > LEAST_MOMENT:
                joints[source.joint_of_dof(int(d.moment_colind[k]))] = None
    return tuple(joints)


def _drive(m: Any, index: int) -> Drive:
    """Classifies an actuator by force = gain * ctrl + bias."""
    gain = m.actuator_gainprm[index][0]
    bias = m.actuator_biasprm[index]
    if int(m.actuator_gaintype[index]) != int(mujoco.mjtGain.mjGAIN_FIXED) or gain == 0:
        return Drive.OTHER
    dynamics = int(m.actuator_dyntype[index])
    filtered = (int(mujoco.mjtDyn.mjDYN_FILTER), int(mujoco.mjtDyn.mjDYN_FILTEREXACT))
    bias_type = int(m.actuator_biastype[index])
    found = Drive.OTHER
    if bias_type == int(mujoco.mjtBias.mjBIAS_NONE):
        found = Drive.MOTOR
    elif bias_type == int(mujoco.mjtBias.mjBIAS_AFFINE):
        if bias[1] < 0:
            found = Drive.POSITION
        elif bias[0] == 0 and bias[1] == 0 and bias[2] == -gain:
            found = Drive.VELOCITY
    if dynamics == int(mujoco.mjtDyn.mjDYN_NONE):
        return found
    return found if dynamics in filtered and found is Drive.POSITION else Drive.OTHER


def _followers(source: SourceModel) -> list[Follower]:
    m = source.model
    found = []
    for index in range(m.neq):
        leader = int(m.eq_obj2id[index])
        is_joint = int(m.eq_type[index]) == int(mujoco.mjtEq.mjEQ_JOINT)
        if is_joint and leader >= 0 and m.eq_active0[index]:
            polynomial = tuple(float(value) for value in m.eq_data[index][:5])
            found.append(Follower(int(m.eq_obj1id[index]), leader, polynomial[1], polynomial))
    return found


def _coupled_joints(source: SourceModel, followers: list[Follower]) -> dict[int, frozenset[int]]:
    """Sets of joints that equalities tie together, by joint."""
    m = source.model
    parent = list(range(m.njnt))

    def root(joint: int) -> int:
        while parent[joint] != joint:
            joint = parent[joint]
        return joint

    def tie(joints: list[int]) -> None:
        for joint in joints[1:]:
            parent[root(joint)] = root(joints[0])

    for follower in followers:
        tie([follower.leader, follower.joint])
    for index in range(m.neq):
        if not m.eq_active0[index]:
            continue
        tie(_joints_tied(source, index))
    sets: dict[int, set[int]] = {}
    for joint in range(m.njnt):
        sets.setdefault(root(joint), set()).add(joint)
    return {joint: frozenset(members) for members in sets.values() for joint in members}


def _joints_tied(source: SourceModel, index: int) -> list[int]:
    """Returns the joints that an equality of tendons or of bodies ties together."""
    m = source.model
    kind = int(m.eq_type[index])
    first, second = int(m.eq_obj1id[index]), int(m.eq_obj2id[index])
    if kind == int(mujoco.mjtEq.mjEQ_TENDON):
        return [j for t in (first, second) if t >= 0 for j in _joints_of_tendon(source, t)]
    if kind in (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)):
        return _joints_of_loop(source, index, first, second)
    return []


def _joints_of_tendon(source: SourceModel, tendon: int) -> list[int]:
    m = source.model
    begin = int(m.tendon_adr[tendon])
    return [
        int(m.wrap_objid[w])
        for w in range(begin, begin + int(m.tendon_num[tendon]))
        if int(m.wrap_type[w]) == int(mujoco.mjtWrap.mjWRAP_JOINT)
    ]


def _joints_of_loop(source: SourceModel, index: int, first: int, second: int) -> list[int]:
    """Returns the joints of both branches of a closed loop, up to where they part."""
    m = source.model
    if int(m.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
        first, second = int(m.site_bodyid[first]), int(m.site_bodyid[second])
    if 0 in (first, second):
        return []  # held by the world: nothing moves along
    top = source.common_ancestor(first, second)
    if top == 0:
        return []
    branches = [*source.bodies_between(top, first), *source.bodies_between(top, second)]
    return [joint for body in branches for joint in source.joints_of(body)]


def reflected_inertia(source: SourceModel, joint: int, qpos: Any) -> float:
    """Returns the effective inertia of a joint at joint positions, kg m2 or kg."""
    data = source.new_data(qpos)
    mujoco.mj_makeM(source.model, data)
    mass = np.zeros((source.model.nv, source.model.nv))
    mujoco.mj_fullM(source.model, data, mass)
    dof = int(source.model.jnt_dofadr[joint])
    return float(mass[dof, dof])
