"""Recorded motions of an arm: what was commanded and what was measured."""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robocell._core import ArgumentError, Dataset, Episode, IoError, Robot

Numbers = NDArray[np.float64]
ARRAYS = ("time", "command", "measured")
LEAST_ROWS = 20
SAME = 1e-6  # rad, m or s


@dataclass(frozen=True)
class ArmTrajectory:
    """A motion of an arm.

    Attributes:
        time: (n,), s, increasing.
        command: (n, joints) commanded positions, rad or m.
        measured: (n, joints) positions, rad or m.
        holds: True if each command holds until the next; otherwise commands are interpolated.
    """

    time: Numbers
    command: Numbers
    measured: Numbers
    holds: bool = False

    @classmethod
    def of(
        cls, time: ArrayLike, command: ArrayLike, measured: ArrayLike, holds: bool = False
    ) -> ArmTrajectory:
        """Returns a trajectory of arrays. Raises ArgumentError if they do not fit together."""
        arrays = [np.array(each, dtype=float) for each in (time, command, measured)]
        rows = arrays[0].shape[0] if arrays[0].ndim == 1 else -1
        for name, each in zip(ARRAYS, arrays, strict=True):
            if not np.isfinite(each).all():
                raise ArgumentError(f"`{name}` has values that are not finite")
        if rows < LEAST_ROWS:
            raise ArgumentError(
                f"`time` has the shape {arrays[0].shape}; expected (n,) with at least {LEAST_ROWS}"
            )
        for name, each in zip(ARRAYS[1:], arrays[1:], strict=True):
            if each.ndim != 2 or each.shape != (rows, *arrays[2].shape[1:]):
                raise ArgumentError(
                    f"`{name}` has the shape {each.shape}; expected a row of joints for each of "
                    f"{rows} times"
                )
        if not (np.diff(arrays[0]) > 0).all():
            raise ArgumentError("`time` must increase from row to row")
        return cls(arrays[0] - arrays[0][0], arrays[1], arrays[2], holds)

    @classmethod
    def load(cls, path: str | Path, robot: Robot | None = None) -> ArmTrajectory:
        """Reads a .npz with `time`, `command`, `measured` and perhaps `holds`, or an episode.

        Args:
            path: The file, or DATASET/EPISODE.
            robot: Whose columns of an episode are meant.

        Raises:
            ArgumentError: It has no such arrays or columns.
            IoError: It cannot be read.
        """
        path = Path(path)
        if path.is_dir():
            return cls._of_episode(path, robot)
        try:
            loaded: Any = np.load(path, allow_pickle=False)
            if not isinstance(loaded, np.lib.npyio.NpzFile):
                raise ArgumentError("it is one array, and no .npz file of arrays")
            with loaded as file:
                if missing := [name for name in ARRAYS if name not in file]:
                    raise ArgumentError(
                        f"no array `{missing[0]}`; it has {', '.join(file) or 'none'}"
                    )
                holds = bool(file["holds"]) if "holds" in file else False
                return cls.of(file["time"], file["command"], file["measured"], holds)
        except OSError as error:
            raise IoError(f"cannot read '{path}': {error.strerror or error}") from error
        except ArgumentError as error:
            raise ArgumentError(f"'{path}': {error}") from error
        except (ValueError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
            raise ArgumentError(f"'{path}' is no .npz file of arrays: {error}") from error

    @classmethod
    def _of_episode(cls, folder: Path, robot: Robot | None) -> ArmTrajectory:
        if robot is None:
            raise ArgumentError(f"'{folder}' is an episode; give the robot whose columns are meant")
        episode = Dataset(folder.parent)[folder.name]
        place = f"robots/{robot.name}"
        own = robot.arm.name
        names = ("time", f"{place}/{own}/target", f"{place}/{own}/qpos")
        if missing := [name for name in names if name not in episode.columns]:
            parts = [name.split("/") for name in episode.columns]
            robots = sorted({part[1] for part in parts if part[0] == "robots"})
            raise ArgumentError(
                f"episode '{folder}' has no column '{missing[0]}'. Its robots: {', '.join(robots)}"
            )
        time, before, measured = (episode[name] for name in names)
        # Targets are those before the action of their row. A command that holds is the action; one
        # that moves on within the rows is known at their times.
        after = f"{place}/action/{own}"
        if after in episode.columns and not _moves_within_rows(episode, robot):
            return cls.of(time, episode[after], measured, holds=True)
        return cls.of(time, before, measured)

    def save(self, path: str | Path) -> None:
        """Writes a .npz that `load` reads."""
        arrays = {name: getattr(self, name) for name in ARRAYS}
        np.savez(path, holds=np.array(self.holds), **arrays)


def _moves_within_rows(episode: Episode, robot: Robot) -> bool:
    """Returns True if the recorded controls of the arm change between the rows of an episode."""
    if "control/ctrl" not in episode.columns:
        return False
    own = tuple(name.removeprefix(robot.prefix) for name in robot.arm.actuator_names)
    arms = [name.endswith(own) for name in episode.column("control/ctrl").names]
    changes = (np.abs(np.diff(episode["control/ctrl"], axis=0)) > SAME)[:, arms].any(axis=1)
    rows = np.searchsorted(episode["time"], episode["control/time"] + SAME, side="right")
    return bool((changes & (rows[1:] == rows[:-1])).any())


def excitation(
    robot: Robot, seconds: float = 6.0, rate: float = 200.0, share: float = 0.25, seed: int = 0
) -> tuple[Numbers, Numbers]:
    """Returns times and commands that excite all joints about their present positions.

    Args:
        robot: The robot.
        seconds: How long.
        rate: Commands per second.
        share: Largest displacement, as a share of each joint's range (of 2 rad without limits).
        seed: Seed of the phases.

    Returns:
        times (n,) and commands (n, joints): sums of four sines, from rest.

    Raises:
        ArgumentError: These are too few commands.
    """
    if not (seconds * rate >= LEAST_ROWS and np.isfinite(seconds * rate)):
        raise ArgumentError(
            f"{seconds} s with {rate} commands per second are fewer than {LEAST_ROWS} commands"
        )
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * rate)) / rate
    start = np.array(robot.jnt_pos_msr)
    lower, upper = np.asarray(robot.joint_limits, dtype=float).T
    bounded = np.isfinite(upper - lower)
    room = np.where(bounded, np.minimum(upper - start, start - lower), 1.0)
    most = np.minimum(share * np.where(bounded, upper - lower, 2.0), 0.9 * np.maximum(room, 0))
    command = np.tile(start, (len(time), 1))
    for joint in range(len(start)):
        hertz = rng.uniform([0.1, 0.3, 0.7, 1.2], [0.3, 0.7, 1.2, 2.0])
        phase = rng.uniform(0, 2 * np.pi, 4)
        waves = np.sin(2 * np.pi * hertz * time[:, None] + phase) / [1, 2, 4, 6]
        shape = waves.sum(axis=1)
        ramp = np.minimum(1.0, time / 0.5)
        command[:, joint] += most[joint] * shape / np.abs(shape).max() * ramp
    return time, command
