"""Fits the values of an arm's model to a recorded motion by least squares."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from robocell._core import ArgumentError, Robot, atomic_write
from robocell._extras import needed_by
from robocell._identify.rollouts import KINDS, UNITS, ArmRollouts
from robocell._identify.trajectory import ArmTrajectory, Numbers
from robocell._suggestions import did_you_mean

with needed_by("robocell.identify", "identify"):
    from scipy.optimize import least_squares

PARAMETERS = (*KINDS, "delay")
STEP = 1e-4  # of a finite difference, in units of the usual values
MOST_ITERATIONS = 100
LONGEST_DELAY_S = 0.2
USUAL_DELAY_S = 0.01
USUAL_OFFSET, USUAL_SPEED = 1e-3, 0.1  # of the start: rad or m, and their rates
Z95 = 1.959964  # standard deviations of a 95 % interval


@dataclass(frozen=True)
class Parameter:
    """A value that was fitted.

    Attributes:
        name: damping, frictionloss, armature, gain or delay.
        joint: The joint; "" for the delay.
        unit: Its unit.
        before: The model's value.
        value: The fitted value.
        error: Half of its 95 % confidence interval; infinite if the motion does not show it.
    """

    name: str
    joint: str
    unit: str
    before: float
    value: float
    error: float

    @property
    def is_shown(self) -> bool:
        """False if the motion says too little about it: its error is larger than the value."""
        return self.error <= max(abs(self.value), 1e-12)

    @property
    def is_known(self) -> bool:
        """True if its error is small beside the value or the model's: also for one that is 0."""
        return self.error <= max(abs(self.value), abs(self.before), 1e-12)


@dataclass(frozen=True)
class Identified:
    """What `identify` found.

    Attributes:
        parameters: The fitted values.
        rms_before: Root mean square of the residuals with the model's values, rad or m.
        rms: The same with the fitted values.
        time: (n,) times of the trajectory, s.
        measured: (n, joints) measured positions.
        simulated: (n, joints) positions of the fitted model.
        joints: Names of the joints.
        evaluations: Number of simulated motions.
    """

    parameters: list[Parameter]
    rms_before: float
    rms: float
    time: Numbers
    measured: Numbers
    simulated: Numbers
    joints: list[str]
    evaluations: int = field(default=0)

    def value(self, name: str, joint: str = "") -> float:
        """Returns a fitted value. Raises ArgumentError if there is none."""
        for each in self.parameters:
            if (each.name, each.joint) == (name, joint):
                return each.value
        raise ArgumentError(f"no {name} of joint '{joint}' was fitted")

    def edits(self) -> str:
        """Returns the YAML of `edits` for the robot file, with the fitted values of its joints.

        Values that the motion does not show are left out; "" if there are no others.
        """
        lines = []
        for joint in self.joints:
            name = json.dumps(joint)  # YAML of any name
            known = [each for each in self.parameters if each.joint == joint and each.is_known]
            values = [f"{each.name}: {each.value:.6g}" for each in known if each.name != "gain"]
            gains = [each.value for each in known if each.name == "gain"]
            if values:
                lines.append(f"  - {{joint: {name}, {', '.join(values)}}}")
            lines += [f"  - {{actuator: {{joint: {name}}}, kp: {gain:.6g}}}" for gain in gains]
        return "\n".join(["edits:", *lines, ""]) if lines else ""

    def save(self, path: str | Path) -> None:
        """Writes the values as JSON; the error of one that the motion does not show is null.

        Raises IoError.
        """
        content = {
            "rms_before": self.rms_before,
            "rms": self.rms,
            "parameters": [
                vars(each) | {"error": each.error if math.isfinite(each.error) else None}
                for each in self.parameters
            ],
        }
        atomic_write(Path(path), f"{json.dumps(content, indent=1)}\n".encode())


def identify(
    robot: Robot,
    trajectory: ArmTrajectory,
    parameters: Sequence[str] = PARAMETERS,
    on_progress: Callable[[int, float], object] = lambda _count, _rms: None,
) -> Identified:
    """Fits joint damping, friction loss, armature, servo gains and the delay of commands.

    The arm is simulated with the commands of the trajectory, and the differences between simulated
    and measured positions are made small by least squares (scipy's `least_squares`, trust region).
    Where the arm began, and how fast, is fitted too, since it is measured with noise.
    A servo's own damping (kv) acts like the joint's: it stays, and the joint's is fitted.

    Args:
        robot: The robot, alone in its scene, with a position servo on each joint of its arm.
        trajectory: The recorded motion.
        parameters: What is fitted, of damping, frictionloss, armature, gain, delay.
        on_progress: Called after each evaluation with the number of simulated motions and the
            residuals' root mean square.

    Raises:
        ArgumentError: The arm has no position servos, or other joints than the trajectory.
    """
    for name in parameters:
        if name not in PARAMETERS:
            raise ArgumentError(
                f"no parameter '{name}'.{did_you_mean(name, PARAMETERS)} There are "
                f"{', '.join(PARAMETERS)}"
            )
    if not parameters:
        raise ArgumentError(f"no parameter to fit; there are {', '.join(PARAMETERS)}")
    fit = _Fit(ArmRollouts(robot, trajectory), trajectory, tuple(dict.fromkeys(parameters)))
    return fit.run(on_progress)


class _Fit:
    """One fit. Its unknowns are values in units of what is usual for the joint."""

    def __init__(
        self, arm: ArmRollouts, trajectory: ArmTrajectory, parameters: tuple[str, ...]
    ) -> None:
        self._arm, self._trajectory = arm, trajectory
        self._rows = [KINDS.index(name) for name in parameters if name != "delay"]
        self._has_delay = "delay" in parameters
        self._own, self._usual = arm.values(), arm.scales()
        self.evaluations = 0

    def _values(self, x: Numbers) -> tuple[Numbers, float, Numbers]:
        """Returns values, delay and start; the start's unknowns come last."""
        values, n = self._own.copy(), self._own.shape[1]
        for i, row in enumerate(self._rows):
            values[row] = x[i * n : (i + 1) * n] * self._usual[row]
        start = x[-2 * n :].reshape(2, n) * [[USUAL_OFFSET], [USUAL_SPEED]]
        return values, float(x[-2 * n - 1]) * USUAL_DELAY_S if self._has_delay else 0.0, start

    def _residuals(self, points: Sequence[Numbers]) -> Numbers:
        self.evaluations += len(points)
        values, delays, starts = zip(*map(self._values, points), strict=True)
        positions = self._arm.positions(values, delays, starts)
        flat = (positions - self._trajectory.measured).reshape(len(points), -1)
        # Values that make the simulation diverge are as bad as it gets, not an error.
        return np.where(np.isfinite(flat), np.clip(flat, -1e3, 1e3), 1e3)

    def _jacobian(self, x: Numbers) -> Numbers:
        ahead = [x + STEP * np.eye(len(x))[i] for i in range(len(x))]
        behind = [np.maximum(x - STEP * np.eye(len(x))[i], self._lowest) for i in range(len(x))]
        far, near = self._residuals(ahead), self._residuals(behind)
        widths = np.array([a[i] - b[i] for i, (a, b) in enumerate(zip(ahead, behind, strict=True))])
        return np.asarray(((far - near) / widths[:, None]).T)

    def run(self, on_progress: Callable[[int, float], object]) -> Identified:
        n = self._own.shape[1]
        begin = [np.ones(n) for _ in self._rows]
        # Gains and armatures of 0 have no servo and may have no mass.
        lowest = [np.full(n, 1e-3 if KINDS[row] == "gain" else 0.0) for row in self._rows]
        highest = [np.full(n, np.inf) for _ in self._rows]
        if self._has_delay:
            begin.append(np.array([0.5]))
            lowest.append(np.array([0.0]))
            highest.append(np.array([LONGEST_DELAY_S / USUAL_DELAY_S]))
        begin.append(np.zeros(2 * n))
        lowest.append(np.full(2 * n, -np.inf))
        highest.append(np.full(2 * n, np.inf))
        self._lowest = np.concatenate(lowest)

        def residuals(x: Numbers) -> Numbers:
            found = self._residuals([x])[0]
            on_progress(self.evaluations, _rms(found))
            return found

        best = least_squares(
            residuals,
            np.concatenate(begin),
            jac=self._jacobian,
            bounds=(self._lowest, np.concatenate(highest)),
            x_scale="jac",
            xtol=1e-7,
            ftol=1e-9,
            gtol=1e-12,
            max_nfev=MOST_ITERATIONS,
        )
        if best.status == 0:
            warnings.warn(
                f"the fit has not settled after {MOST_ITERATIONS} iterations, so its values may "
                "still change; fit less, or record a motion of all joints",
                stacklevel=3,
            )
        values, delay, start = self._values(best.x)
        simulated = self._arm.positions([values], [delay], [start])[0]
        own = self._arm.positions([self._own], [0.0], [0 * start])[0]
        return Identified(
            self._parameters(values, delay, self._errors(best.x, best.fun)),
            _rms(own - self._trajectory.measured),
            _rms(simulated - self._trajectory.measured),
            self._trajectory.time,
            self._trajectory.measured,
            simulated,
            self._arm.joints,
            self.evaluations,
        )

    def _errors(self, x: Numbers, residuals: Numbers) -> Numbers:
        """Returns half of each 95 % interval, by the linearised model at the end."""
        jacobian = self._jacobian(x)
        left = max(1, len(residuals) - len(x))
        variance = float(residuals @ residuals) / left
        _, singular, v = np.linalg.svd(jacobian, full_matrices=False)
        tiny = singular < 1e-10 * singular[0]
        spread = np.divide(v.T, singular, out=np.zeros_like(v.T), where=~tiny)
        sigma = np.sqrt(variance * (spread**2).sum(axis=1))
        sigma[(v[tiny] ** 2).sum(axis=0) > 1e-6] = np.inf
        return np.asarray(Z95 * sigma)

    def _parameters(self, values: Numbers, delay: float, errors: Numbers) -> list[Parameter]:
        found, n = [], self._own.shape[1]
        for i, row in enumerate(self._rows):
            for j, joint in enumerate(self._arm.joints):
                error = float(errors[i * n + j] * self._usual[row, j])
                before, value = float(self._own[row, j]), float(values[row, j])
                found.append(Parameter(KINDS[row], joint, UNITS[KINDS[row]], before, value, error))
        if self._has_delay:
            error = float(errors[-2 * n - 1]) * USUAL_DELAY_S
            found.append(Parameter("delay", "", UNITS["delay"], 0.0, delay, error))
        return found


def _rms(residuals: Numbers) -> float:
    return float(np.sqrt(np.mean(np.square(residuals))))
