"""Prints the table of docs/environments.md: how long converged steps of the built-in cells take.

MENAGERIE_ROOT=... python docs/measure_step_durations.py
"""

from __future__ import annotations

from collections import Counter

import numpy as np

import robocell as rc

STEPS = 100
MOVES = {"joints": 0.05, "xyzrpy": 0.02}  # the largest number of an action
MODES = {"joints": rc.envs.ControlMode.JOINTS, "xyzrpy": rc.envs.ControlMode.CARTESIAN_TRPY}


def environment(cell: str, key: str) -> rc.Env:
    """The cell with relative actions of this kind, and time to converge."""
    config = rc.EnvConfig.load(rc.models.cell_file(cell))
    config.control_mode, config.relative_to = MODES[key], rc.envs.RelativeTo.LAST_STEP
    config.max_relative_movement = ()
    config.sim.async_control = False
    config.sim.on_collision = "report"
    config.sim.max_convergence_time = 5
    return rc.Env(config)


def row(cell: str, key: str) -> str:
    """Simulated durations of the steps, and what was left of their motions."""
    env = environment(cell, key)
    env.reset(seed=1)
    rng = np.random.default_rng(1)
    sizes = {path: size for path, _, size in env.action_parts}
    durations, errors, speeds = [], [], []
    reasons: Counter[str] = Counter()
    before = 0.0
    for step in range(STEPS):
        if step % 2 == 0:  # there, and then back
            move = {p: rng.uniform(-MOVES[key], MOVES[key], n) for p, n in sizes.items()}
        action: dict[str, dict[str, object]] = {}
        for path, numbers in move.items():
            value = numbers if step % 2 == 0 else -numbers
            action.setdefault(path[0], {})[path[1]] = value if path[1] == key else 1
        *_, info = env.step(action)
        durations.append(info["time"] - before)
        before = info["time"]
        reasons[info["reason"]] += 1
        errors.append(1000 * max(robot["position_error"] for robot in info["robots"].values()))
        speeds.append(1000 * max(robot["linear_speed"] for robot in info["robots"].values()))
    env.close()
    low, median, high = np.percentile(durations, (0, 50, 100))
    ends = ", ".join(f"{name} {count}" for name, count in reasons.most_common())
    return (
        f"| `{cell}` | `{key}` | {low:.2f} / {median:.2f} / {high:.2f} "
        f"| {np.median(errors):.2f} / {max(errors):.2f} | {max(speeds):.1f} | {ends} |"
    )


def main() -> None:
    """Prints a row for each cell and kind of action."""
    print("| cell | action | step, s: least / median / most ", end="")
    print("| TCP error, mm: median / most | TCP speed, mm/s: most | ended |")
    print("|---|---|---|---|---|---|")
    for cell in rc.models.cells():
        for key in MOVES:
            print(row(cell, key), flush=True)


if __name__ == "__main__":
    main()
