"""Records episodes in a cell, or with a robot alone, as a person performs them.

They are episodes of an environment, as `EnvRecorder` writes them. Actions are joint positions,
whatever the cell's control mode. A cell without a task has no judge: the person ends an episode as
a success or as a failure.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from pathlib import Path

from robocell._core import Env, EnvConfig, Error, RobotConfig
from robocell._teleop.device import Device
from robocell._teleop.operator import Operator, OperatorOptions, Performance, Screen
from robocell._teleop.real_arms import RealArms
from robocell._teleop.session import Recorded, save_session
from robocell.data import EnvRecorder

FREQUENCY = 30.0  # actions per second of a robot alone
MAX_SECONDS = 120.0
TIMEOUT = "timeout"


def cell_of(robot: RobotConfig | str | Path) -> EnvConfig:
    """Returns a cell of a robot alone on a floor."""
    config = EnvConfig(name="robot", robots={"robot": robot}, add_floor=True)
    config.sim.async_control, config.sim.frequency = True, FREQUENCY
    return config


def record_cell(
    cell: EnvConfig,
    output: str | Path,
    device: Device,
    options: OperatorOptions | None = None,
    screen: Screen | None = None,
    on_recorded: Callable[[Recorded], object] = lambda _recorded: None,
    *,
    episodes: int | None = 1,
    real_arms: RealArms | None = None,
) -> list[Recorded]:
    """Records episodes of a cell until there are so many, or the person quits.

    Args:
        cell: The cell. Its steps take 1 / `sim.frequency`, also if it waits for robots to arrive.
        output: Folder of the dataset.
        device: What the person moves.
        options: How the session goes.
        screen: Shows it.
        on_recorded: Called after each episode.
        episodes: Number of episodes of the dataset; None for as many as the person wants.
        real_arms: Arms that follow with those of the scene. They hold between episodes.

    Returns:
        The episodes of this session.

    Raises:
        ArmStoppedError: A real arm has stopped. What was kept stays.
        DeviceLostError: The device is gone. What was kept stays.
        SpecError: The cell is not valid.
    """
    options = options or OperatorOptions()
    cell = copy.deepcopy(cell)
    cell.sim.async_control, cell.headless = True, True
    operator = Operator(device, options, screen, real_arms)
    recorded: list[Recorded] = []
    try:
        operator.call("start")
        if operator.lost is not None:
            raise operator.lost
        env = Env(cell)
        with EnvRecorder(env, output) as recorder:
            number = count_of(Path(output))
            wanted = math.inf if episodes is None else episodes - number
            if options.episode:
                wanted = 1
            while len(recorded) < wanted and not operator.quits:
                seed = options.seed if options.episode else options.seed + number + len(recorded)
                operator.renew()
                operator.note(episode=f"{1 + number + len(recorded)}")
                made = _record_one(env, recorder, operator, seed)
                if operator.lost is not None:
                    raise operator.lost
                if made is not None:
                    save_session(Path(output), made.id, operator, seed)
                    recorded.append(made)
                    on_recorded(made)
    finally:
        operator.close()
    return recorded


def count_of(dataset: Path) -> int:
    """Returns the number of episodes of a dataset, 0 without one."""
    return sum(1 for _ in dataset.glob("*/episode.json"))


def _record_one(env: Env, recorder: EnvRecorder, operator: Operator, seed: int) -> Recorded | None:
    """Records an episode. Returns None for one that is discarded."""
    seconds = 1 / env.config.sim.frequency
    operator.max_steps = operator.options.max_steps or round(MAX_SECONDS / seconds)
    performance = Performance(
        operator, lambda: env.scene, seconds, operator.max_steps, env.instruction or ""
    )
    try:
        env.reset(seed=seed)
        performance.begin()
        end = _perform(env, operator, performance)
        operator.untie()
        if end is None or operator.stop.is_set:
            recorder.discard()
            return None
        success, reason = end
        rows = recorder.rows
        name = recorder.save(success, reason)
    except Error as error:
        recorder.discard()
        operator.untie()
        operator.end(error)
        return None
    if name is None:
        return None
    return Recorded(name, success, "" if success else reason, rows)


def _perform(env: Env, operator: Operator, performance: Performance) -> tuple[bool, str] | None:
    """Lets the person act until the episode ends. Returns success and reason; None to drop it."""
    has_task = env.config.task is not None
    while not operator.stop.is_set:
        operator.row = env.row()
        arms = performance.act()
        if arms is None or operator.stop.is_set:
            return None
        *_, info = env.step(arms.columns())
        if info["reason"] in ("diverged", "stopped"):
            operator.note(dropped=info["message"] or info["reason"])
            return None
        success = bool(info.get("is_success")) if has_task else performance.marked == "success"
        is_over = performance.done()
        if has_task and success and not is_over:
            is_over = performance.ends_at_success()
        if not is_over:
            continue
        if performance.failure:
            return False, performance.failure
        if success:
            return True, "success"
        return False, "not done" if performance.marked else TIMEOUT
    return None
