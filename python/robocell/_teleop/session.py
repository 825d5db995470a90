"""Records the episodes of a run as a person performs them.

Episodes are those of the run's plan, one after the other: the same starts as those of `robocell
generate`, judged by the same task and written by the same writer. A repeated session goes on with
the first episode that is missing. `device_sessions/<episode>.json` beside the episodes has what the
device said, which `replay:FILE` repeats.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    DatasetLock,
    EpisodeStart,
    IoError,
    ItemResult,
    PlanItem,
    RunConfig,
    Runner,
    atomic_write,
    is_complete,
    make_plan,
    prepare_dataset,
)
from robocell._teleop.device import Device, Motion
from robocell._teleop.operator import Operator, OperatorOptions, Screen, Teleoperator
from robocell.generate import Keep
from robocell.tasks import Expert, expert_registration

TELEOP = "teleop"  # the kind of expert in a run
FOLDER = "device_sessions"
FORMAT = 1


@dataclass(frozen=True)
class Recorded:
    """An episode of a session.

    Attributes:
        id: Its id.
        success: As the task judged it.
        reason: Why it was no success; "" otherwise.
        rows: Its actions.
    """

    id: str
    success: bool
    reason: str
    rows: int


def record(
    run: RunConfig,
    device: Device,
    options: OperatorOptions | None = None,
    screen: Screen | None = None,
    on_recorded: Callable[[Recorded], object] = lambda _recorded: None,
) -> list[Recorded]:
    """Records the episodes of a run until all are there, or the person quits.

    Args:
        run: The run; `output` is the folder of the dataset.
        device: What the person moves.
        options: How the session goes.
        screen: Shows it.
        on_recorded: Called after each episode.

    Returns:
        The episodes of this session.

    Raises:
        DeviceLostError: The device is gone. What was kept stays.
        SpecError: The run is not valid, or its output belongs to another run.
    """
    operator = Operator(device, options or OperatorOptions(), screen)
    expert_registration(TELEOP, (), __name__)(_teleoperator)
    run.expert, run.keep = TELEOP, Keep.FIRST
    prepare_dataset(run)
    folder = Path(run.output)
    recorded: list[Recorded] = []
    device.start()
    _acting.append(operator)
    try:
        with DatasetLock(folder, 0, 1):
            runner = Runner(run)
            for item in make_plan(run):
                if is_complete(run, item):
                    continue
                if not _record_one(runner, item, operator, folder, recorded, on_recorded):
                    break
    finally:
        _acting.remove(operator)
        device.close()
    return recorded


# Whoever acts: what is registered lives as long as the process, and must not keep a scene.
_acting: list[Operator] = []


def _teleoperator(run: RunConfig, start: EpisodeStart) -> Expert:
    if not _acting:
        raise ArgumentError(
            f"the expert '{TELEOP}' is a person: record episodes with `robocell teleop`"
        )
    return Teleoperator(run, start, _acting[-1])


def _record_one(
    runner: Runner,
    item: PlanItem,
    operator: Operator,
    folder: Path,
    recorded: list[Recorded],
    on_recorded: Callable[[Recorded], object],
) -> bool:
    """Records an episode, again after each one that is discarded. Returns False at the end."""
    while not operator.quits:
        operator.renew()
        operator.note(episode=item.id)
        try:
            result = runner.run(item, operator.stop)
        finally:
            if operator.lost is not None:
                raise operator.lost
        if result.committed and not result.resumed:
            save_session(folder, item.id, operator)
            recorded.append(_recorded(item, result))
            on_recorded(recorded[-1])
            return True
        if not result.stopped:
            raise ArgumentError(f"no start for episode '{item.id}': {result.advice or 'refused'}")
    return False


def _recorded(item: PlanItem, result: ItemResult) -> Recorded:
    reason = "" if result.success else next(iter(result.failures), "")
    return Recorded(item.id, result.success, reason, result.rows)


def save_session(folder: Path, episode: str, operator: Operator) -> Path:
    """Writes what the device said in an episode. Raises IoError."""
    place = folder / FOLDER
    try:
        place.mkdir(exist_ok=True)
    except OSError as error:
        raise IoError(f"cannot make '{place}': {error.strerror}") from error
    content = {
        "format": FORMAT,
        "episode": episode,
        "robot": operator.options.robot,
        "follow": asdict(operator.options.follow),
        "ends_at_success": operator.options.ends_at_success,
        "motions": [None if each is None else each.as_json() for each in operator.motions],
    }
    file = place / f"{episode}.json"
    atomic_write(file, f"{json.dumps(content)}\n".encode())
    return file


def load_session(file: Path) -> dict[str, Any]:
    """Returns what `save_session` wrote, with `motions` as Motions.

    Raises:
        IoError: The file cannot be read.
        ArgumentError: It is no session.
    """
    try:
        content = json.loads(file.read_text())
    except OSError as error:
        raise IoError(f"cannot read '{file}': {error.strerror}") from error
    except ValueError as error:
        raise ArgumentError(f"'{file}' is no session of a device: {error}") from error
    motions = content.get("motions") if isinstance(content, dict) else None
    if not isinstance(motions, list) or content.get("format") != FORMAT:
        raise ArgumentError(
            f"'{file}' is no session of a device: give a file of a dataset's {FOLDER}/"
        )
    content["motions"] = [None if each is None else Motion.of_json(each) for each in motions]
    return content
