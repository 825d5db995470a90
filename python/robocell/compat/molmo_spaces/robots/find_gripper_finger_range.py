"""Measures how far the fingers of a robot's grippers are apart, closed and open.

python -m robocell.compat.molmo_spaces.robots.find_gripper_finger_range MODULE CLASS
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import mujoco

import robocell as rc
from robocell.compat.molmo_spaces._assembly import compile_alone
from robocell.compat.molmo_spaces._command import config_class, run_main

__all__ = ["finger_ranges", "main"]


def finger_ranges(robot_config: Any, settle_time: float = 1.0) -> dict[str, tuple[float, float]]:
    """Opens, then closes all grippers, each for `settle_time` seconds of simulation.

    Returns the smaller and the larger distance, m, of each gripper. Raises NotFoundError for a
    robot without grippers, and DivergedError if the simulation diverges.
    """
    model, data, view = compile_alone(robot_config, robot_config.robot_namespace)
    names = view.get_gripper_movegroup_ids()
    if not names:
        raise rc.NotFoundError(
            f"robot '{robot_config.name}' has no GripperGroup. Its move groups: "
            f"{', '.join(view.move_group_ids())}"
        )
    for name in view.move_group_ids():
        group = view.get_move_group(name)
        if name not in names and group.n_actuators:
            group.ctrl = group.noop_ctrl
    measured: dict[str, list[float]] = {name: [] for name in names}
    for is_open in (True, False):
        for name in names:
            view.get_gripper(name).set_gripper_ctrl_open(is_open)
        mujoco.mj_step(model, data, max(1, round(settle_time / model.opt.timestep)))
        if any(warning.number for warning in (data.warning[i] for i in _BAD_STATES)):
            raise rc.DivergedError(
                f"robot '{robot_config.name}' diverged while its grippers "
                f"{'opened' if is_open else 'closed'}: check the gains of its servos and the "
                f"timestep of {model.opt.timestep:g} s"
            )
        mujoco.mj_forward(model, data)
        for name in names:
            measured[name].append(float(view.get_gripper(name).inter_finger_dist))
    return {name: (min(both), max(both)) for name, both in measured.items()}


_BAD_STATES = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command. Returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="find_gripper_finger_range", description="Measure the fingers of a robot's grippers."
    )
    parser.add_argument("module", help="module of the robot's configuration, such as xarm7_config")
    parser.add_argument("config_class", help="its class, such as XArm7RobotConfig")
    parser.add_argument(
        "--settle-time", type=float, default=1.0, help="seconds to open and to close (1)"
    )
    given = parser.parse_args(arguments)
    if not 0 < given.settle_time < 1000:
        parser.error(f"--settle-time: expected seconds above 0, got {given.settle_time:g}")
    ranges = finger_ranges(config_class(given.module, given.config_class)(), given.settle_time)
    print("Gripper finger ranges:")
    for name, (closed, opened) in ranges.items():
        print(f"    Gripper '{name}': {closed:.3f} - {opened:.3f}")
    return 0


if __name__ == "__main__":
    run_main(main)
