"""How robots moved in a sample of episodes: joints, TCP, gripper, and where episodes began.

Speeds of joints are recorded. Accelerations, jerks and speeds of the TCP are differences between
rows, so they are means over a row and smaller than the peaks within it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Dataset, Episode, IoError
from robocell._report.facts import EpisodeFacts
from robocell._report.variation import yaw

Array = NDArray[np.float64]
NEAR = 0.02  # of a joint's range: this close to a limit counts as near it
TOLERANCE = 1e-3  # rad or m beyond a limit that do not count
OPEN, CLOSED = 0.6, 0.4  # of the opening: the gripper's state changes beyond these
MOST_POINTS = 4000  # of a picture


@dataclass
class Joints:
    """A move group of one robot over all episodes that were read.

    Attributes:
        robot, group: Names.
        names: Joints.
        units: Of positions: rad, m.
        lower, upper: Limits (n), NaN where unknown.
        positions, speeds, jerks: By episode: (rows, n), of jerks three rows fewer.
        episodes: Their ids.
    """

    robot: str
    group: str
    names: list[str]
    units: list[str]
    lower: Array
    upper: Array
    positions: list[Array] = field(default_factory=list)
    speeds: list[Array] = field(default_factory=list)
    jerks: list[Array] = field(default_factory=list)
    episodes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class JointNumbers:
    """One joint over all episodes that were read; angles in rad, lengths in m.

    Attributes:
        robot, group, name, unit: Which joint.
        lower, upper: Its limits, NaN where unknown.
        least, greatest: The positions that it reached.
        density: Share of the rows in each of 40 parts between its limits, or of what it reached.
        near: Share of the rows within 2 % of a limit.
        beyond: Rows beyond a limit.
        worst: The largest excess.
        speed: Largest speed; `usual_speed` is not exceeded in 99 % of the rows.
        too_fast: Rows above the speed limit; None without one.
        jerk: Largest jerk; `usual_jerk` is not exceeded in 99 % of the rows.
        violating: Episodes with a row beyond a limit or too fast.
    """

    robot: str
    group: str
    name: str
    unit: str
    lower: float
    upper: float
    least: float
    greatest: float
    density: Array
    near: float
    beyond: int
    worst: float
    speed: float
    usual_speed: float
    too_fast: int | None
    jerk: float
    usual_jerk: float
    violating: list[str]


@dataclass
class Tcp:
    """The TCP of one robot over all episodes that were read.

    Attributes:
        robot: Its name.
        frame: The frame of the positions.
        positions: By episode: (rows, 3), m.
        lengths: By episode: length of its path, m.
        speeds: By episode: largest speed, m/s.
        jerks: By episode: root mean square of the jerk, m/s^3.
    """

    robot: str
    frame: str
    positions: list[Array] = field(default_factory=list)
    lengths: list[float] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)
    jerks: list[float] = field(default_factory=list)

    def points(self) -> Array:
        """Returns at most `MOST_POINTS` positions, evenly spread over all rows."""
        points = np.concatenate(self.positions)
        return points[:: max(1, -(-len(points) // MOST_POINTS))]


@dataclass
class Gripper:
    """The gripper of one robot over all episodes that were read.

    Attributes:
        robot: Its name.
        closings, openings: Moments of the commands, as shares of the episodes' lengths (0 to 1).
        counts: By episode: number of closings and openings.
        held: Measured opening while it is closed, for each closing (0 closed, 1 open).
    """

    robot: str
    closings: list[float] = field(default_factory=list)
    openings: list[float] = field(default_factory=list)
    counts: list[tuple[int, int]] = field(default_factory=list)
    held: list[float] = field(default_factory=list)


@dataclass
class Motion:
    """What the time series of some episodes say.

    Attributes:
        read: Episodes that were read.
        damaged: Episode -> why it could not be read.
        started: Episode -> value at its start by name: where the base stands.
        ik_failed: Episode -> rows whose pose command had no solution.
        engine_warnings: Episode -> warnings of the engine.
    """

    read: list[str] = field(default_factory=list)
    damaged: dict[str, str] = field(default_factory=dict)
    joints: dict[tuple[str, str], Joints] = field(default_factory=dict)
    tcps: dict[str, Tcp] = field(default_factory=dict)
    grippers: dict[str, Gripper] = field(default_factory=dict)
    started: dict[str, dict[str, float]] = field(default_factory=lambda: defaultdict(dict))
    ik_failed: dict[str, int] = field(default_factory=dict)
    engine_warnings: dict[str, int] = field(default_factory=dict)


def sample(episodes: Sequence[EpisodeFacts], size: int) -> list[EpisodeFacts]:
    """Returns evenly spread episodes, at most `size`; failures are as frequent as in all."""
    ordered = sorted(episodes, key=lambda episode: (episode.success, episode.end_reason))
    if len(ordered) <= size:
        return list(episodes)
    places = np.linspace(0, len(ordered) - 1, size).round().astype(int)
    chosen = {ordered[place].id for place in np.unique(places)}
    return [episode for episode in episodes if episode.id in chosen]


def read(dataset: Dataset, episodes: Iterable[EpisodeFacts]) -> Motion:
    """Reads the time series of these episodes; a damaged one is named and left out."""
    motion = Motion()
    for facts in episodes:
        try:
            _add(motion, dataset[facts.id], facts)
        except IoError as error:
            motion.damaged[facts.id] = str(error)
        else:
            motion.read.append(facts.id)
    return motion


def numbers(joints: Joints, most_speed: float | None = None) -> list[JointNumbers]:
    """Returns the numbers of each joint of a group.

    Args:
        joints: The group.
        most_speed: Speed limit of all joints, rad/s or m/s; None without one.
    """
    q, v = np.concatenate(joints.positions), np.abs(np.concatenate(joints.speeds))
    jerk = np.abs(np.concatenate(joints.jerks))
    found = []
    for i, name in enumerate(joints.names):
        lower, upper = joints.lower[i], joints.upper[i]
        known = bool(np.isfinite(lower) and np.isfinite(upper) and upper > lower)
        ends = (lower, upper) if known else _ends(q[:, i])
        density, _ = np.histogram(q[:, i], bins=40, range=ends)
        excess = np.maximum(lower - q[:, i], q[:, i] - upper) if known else np.full(len(q), -1.0)
        margin = NEAR * (upper - lower)
        fast = None if most_speed is None else int((v[:, i] > most_speed).sum())
        found.append(
            JointNumbers(
                robot=joints.robot,
                group=joints.group,
                name=name,
                unit=joints.units[i],
                lower=float(lower),
                upper=float(upper),
                least=float(q[:, i].min()),
                greatest=float(q[:, i].max()),
                density=density / max(1, len(q)),
                near=float((excess > -margin).mean()) if known else 0.0,
                beyond=int((excess > TOLERANCE).sum()),
                worst=float(max(0.0, excess.max())),
                speed=float(v[:, i].max()),
                usual_speed=float(np.quantile(v[:, i], 0.99)),
                too_fast=fast,
                jerk=float(jerk[:, i].max()) if len(jerk) else 0.0,
                usual_jerk=float(np.quantile(jerk[:, i], 0.99)) if len(jerk) else 0.0,
                violating=[
                    episode
                    for episode, at, moving in zip(
                        joints.episodes, joints.positions, joints.speeds, strict=True
                    )
                    if (
                        known
                        and np.maximum(lower - at[:, i], at[:, i] - upper).max(initial=-1)
                        > TOLERANCE
                    )
                    or (most_speed is not None and np.abs(moving[:, i]).max(initial=0) > most_speed)
                ],
            )
        )
    return found


def _ends(values: Array) -> tuple[float, float]:
    least, greatest = float(values.min()), float(values.max())
    return (least, greatest) if greatest > least else (least - 0.5, greatest + 0.5)


def _add(motion: Motion, episode: Episode, facts: EpisodeFacts) -> None:
    columns = set(episode.columns)
    rows = episode.rows()
    if not rows:
        return
    described: Any = episode.json
    features = {feature["name"]: feature for feature in described.get("features", ())}
    for robot in facts.robots:
        stem = f"robots/{robot}/"
        groups = {
            name.removeprefix(stem).removesuffix("/qpos")
            for name in columns
            if name.startswith(stem) and name.endswith("/qpos")
        }
        for group in sorted(group for group in groups if "/" not in group):
            if f"{stem}{group}/qvel" in columns:
                _add_joints(motion, episode, (robot, group), features, facts.rate)
        for name, frame in (("tcp_pose_in_base", f"base of {robot}"), ("tcp_pose", "world")):
            if stem + name in columns:
                _add_tcp(motion, robot, frame, episode[stem + name], facts.rate)
                break
        if f"{stem}opening" in columns:
            _add_gripper(motion, robot, episode, columns)
        if f"{stem}base_pose" in columns:
            _add_start(motion, episode, robot, columns, facts.target)
    if "ik_failed" in columns and (failed := int(episode["ik_failed"].sum())):
        motion.ik_failed[episode.id] = failed
    if "engine_warnings" in columns and (warned := int(episode["engine_warnings"].max())):
        motion.engine_warnings[episode.id] = warned


def _add_joints(
    motion: Motion,
    episode: Episode,
    key: tuple[str, str],
    features: dict[str, Any],
    rate: float | None,
) -> None:
    stem = f"robots/{key[0]}/{key[1]}"
    q, v = _table(episode[f"{stem}/qpos"]), _table(episode[f"{stem}/qvel"])
    joints = motion.joints.get(key)
    if joints is None:
        joints = motion.joints[key] = _new_joints(episode, key, q.shape[1], features)
    finite = np.isfinite(q).all(axis=1)
    if q.shape[1] != len(joints.names) or v.shape != q.shape or not finite.any():
        return  # another robot of this name, or one that diverged at once
    q, v = q[finite], np.nan_to_num(v[finite])
    joints.positions.append(q)
    joints.speeds.append(v)
    joints.jerks.append(np.diff(v, n=2, axis=0) * (rate or 1.0) ** 2)
    joints.episodes.append(episode.id)


def _new_joints(
    episode: Episode, key: tuple[str, str], size: int, features: dict[str, Any]
) -> Joints:
    robot, group = key
    column = episode.column(f"robots/{robot}/{group}/qpos")
    names = list(column.names)
    names = names if len(names) == size else [f"joint {i}" for i in range(size)]
    units = [unit.strip() for unit in column.units.split(",")]
    lower, upper = np.full(size, np.nan), np.full(size, np.nan)
    # The ranges of measured positions and of targets have a margin; that of actions is the limits.
    described = features.get(f"robots/{robot}/action/{group}", {})
    ends = described.get("lower"), described.get("upper")
    if described.get("names") == list(column.names) and all(len(end or ()) == size for end in ends):
        lower, upper = (np.array(end, dtype=float) for end in ends)
    return Joints(
        robot,
        group,
        [name.rpartition("/")[2] for name in names],
        units if len(units) == size else [units[0]] * size,
        lower,
        upper,
    )


def _table(values: NDArray[Any]) -> Array:
    return values.reshape(len(values), -1).astype(float)


def _add_tcp(
    motion: Motion, robot: str, frame: str, poses: NDArray[Any], rate: float | None
) -> None:
    positions = poses[:, :3].astype(float)
    positions = positions[np.isfinite(positions).all(axis=1)]
    if not len(positions):
        return
    tcp = motion.tcps.setdefault(robot, Tcp(robot, frame))
    steps = np.diff(positions, axis=0)
    hertz = rate or 1.0
    tcp.positions.append(positions)
    tcp.lengths.append(float(np.linalg.norm(steps, axis=1).sum()))
    tcp.speeds.append(float(np.linalg.norm(steps, axis=1).max(initial=0)) * hertz)
    jerk = np.diff(positions, n=3, axis=0) * hertz**3
    tcp.jerks.append(float(np.sqrt((jerk**2).sum(axis=1).mean())) if len(jerk) else 0.0)


def _add_gripper(motion: Motion, robot: str, episode: Episode, columns: set[str]) -> None:
    gripper = motion.grippers.setdefault(robot, Gripper(robot))
    opening = episode[f"robots/{robot}/opening"]
    command = opening
    # Commands are counted rather than measurements: fingers that hold a wide object stay open.
    for name in sorted(columns):
        if name.startswith(f"robots/{robot}/") and name.endswith("/target"):
            column = episode.column(name)
            if list(column.names) == ["opening"]:
                command = episode[name][:, 0]
    rows, counts = max(1, len(opening) - 1), [0, 0]
    is_open = bool(command[0] > (OPEN + CLOSED) / 2)
    closed_at = None
    for row, value in enumerate(command):
        if is_open and value < CLOSED:
            is_open, closed_at = False, row
            counts[0] += 1
            gripper.closings.append(row / rows)
        elif not is_open and value > OPEN:
            is_open = True
            counts[1] += 1
            gripper.openings.append(row / rows)
            if closed_at is not None:
                gripper.held.append(_settled(opening[closed_at:row]))
                closed_at = None
    if closed_at is not None:
        gripper.held.append(_settled(opening[closed_at:]))
    gripper.counts.append((counts[0], counts[1]))


def _settled(opening: NDArray[Any]) -> float:
    """Returns the opening after the fingers have moved: the median of the second half."""
    return float(np.median(opening[len(opening) // 2 :]))


def _add_start(
    motion: Motion, episode: Episode, robot: str, columns: set[str], target: str
) -> None:
    base = episode.read(f"robots/{robot}/base_pose", 0, 1)[0].astype(float)
    values = {f"{robot}: base height, m": float(base[2])}
    if f"objects/{target}/pose" in columns:
        pose = episode.read(f"objects/{target}/pose", 0, 1)[0].astype(float)
        to = pose[:2] - base[:2]
        values[f"{robot}: distance of the base to {target}, m"] = float(np.hypot(*to))
        bearing = np.arctan2(to[1], to[0]) - yaw(base[3:])
        values[f"{robot}: bearing of {target} from the base, rad"] = float(
            np.arctan2(np.sin(bearing), np.cos(bearing))
        )
    motion.started[episode.id].update(
        {name: value for name, value in values.items() if np.isfinite(value)}
    )
