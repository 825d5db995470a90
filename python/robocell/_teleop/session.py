"""Records the episodes of a run as a person performs them.

Episodes are those of the run's plan, one after the other: the same starts as those of `robocell
generate`, judged by the same task and written by the same writer. A repeated session goes on with
the first episode that is missing. `device_sessions/<episode>.json` beside the episodes has what the
device said, which `replay:FILE` repeats.
"""

from __future__ import annotations

import copy
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
from robocell._durable import make_folders
from robocell._teleop.device import Device, Motion
from robocell._teleop.follower import FollowOptions
from robocell._teleop.operator import Operator, OperatorOptions, Screen, Teleoperator
from robocell._teleop.real_arms import RealArms
from robocell.generate import Keep
from robocell.tasks import Expert, expert_registration

TELEOP = "teleop"  # the kind of expert in a run
FOLDER = "device_sessions"
FORMAT = 1
FIELDS = {
    "episode": str,
    "robot": str,
    "follow": dict,
    "ends_at_success": bool,
    "max_steps": int,
    "seed": int,
}


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
    real_arms: RealArms | None = None,
) -> list[Recorded]:
    """Records the episodes of a run until all are there, or the person quits.

    Args:
        run: The run; `output` is the folder of the dataset. Its `expert` and `keep` do not count.
        device: What the person moves.
        options: How the session goes.
        screen: Shows it.
        on_recorded: Called after each episode.
        real_arms: Arms that follow with those of the scene. They hold between episodes.

    Returns:
        The episodes of this session.

    Raises:
        ArmStoppedError: A real arm has stopped. What was kept stays.
        ArgumentError: The options ask for an episode that is not of the run, or is there already.
        DeviceLostError: The device is gone. What was kept stays.
        SpecError: The run is not valid, or its output belongs to another run.
    """
    options = options or OperatorOptions()
    operator = Operator(device, options, screen, real_arms)
    expert_registration(TELEOP, (), __name__)(_teleoperator)
    run = copy.deepcopy(run)
    run.expert, run.keep = TELEOP, Keep.FIRST
    if options.max_steps:
        run.rates.max_steps = options.max_steps
    folder = Path(run.output)
    recorded: list[Recorded] = []
    _acting.append(operator)
    try:
        operator.call("start")
        if operator.lost is not None:
            raise operator.lost
        items = _items(run, options.episode)
        prepare_dataset(run)
        with DatasetLock(folder, 0, 1):
            runner = Runner(run)
            for item in items:
                if is_complete(run, item):
                    if options.episode:
                        raise ArgumentError(
                            f"episode '{item.id}' is in '{folder}' already; choose another output"
                        )
                    continue
                if not _record_one(runner, item, operator, folder, recorded, on_recorded):
                    break
    finally:
        _acting.remove(operator)
        operator.close()
    return recorded


def _items(run: RunConfig, episode: str) -> list[PlanItem]:
    """Returns the episodes of the run's plan, or the one that is named."""
    plan = list(make_plan(run))
    if not episode:
        return plan
    if found := [item for item in plan if item.id == episode]:
        return found
    names = [item.id for item in plan]
    shown = ", ".join(names[:5]) + (" ..." if len(names) > 5 else "")
    raise ArgumentError(
        f"the session is of episode '{episode}', which the run does not have; it has {shown}. Give "
        "the session's run, with as many episodes"
    )


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
            operator.untie()
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


def save_session(folder: Path, episode: str, operator: Operator, seed: int | None = None) -> Path:
    """Writes what the device said in an episode, which began with a seed. Raises IoError."""
    place = folder / FOLDER
    try:
        make_folders(place)
    except OSError as error:
        raise IoError(f"cannot make '{place}': {error.strerror}") from error
    content = {
        "format": FORMAT,
        "episode": episode,
        "robot": operator.options.robot,
        "follow": asdict(operator.options.follow),
        "ends_at_success": operator.options.ends_at_success,
        "max_steps": operator.max_steps,
        "seed": operator.options.seed if seed is None else seed,
        "motions": [None if each is None else each.as_json() for each in operator.motions],
    }
    file = place / f"{episode}.json"
    atomic_write(file, f"{json.dumps(content)}\n".encode())
    return file


def load_session(file: Path) -> dict[str, Any]:
    """Returns what `save_session` wrote, with `motions` as Motions and `follow` as FollowOptions.

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
    content = {"max_steps": 0, "seed": 0, **content}
    for name, kind in FIELDS.items():
        if not isinstance(content.get(name), kind) or isinstance(content[name], bool) != (
            kind is bool
        ):
            raise ArgumentError(
                f"'{file}': `{name}` is {content.get(name)!r}, not a {kind.__name__}"
            )
    try:
        content["follow"] = FollowOptions(**content["follow"])
    except (ArgumentError, TypeError) as error:
        raise ArgumentError(f"'{file}': `follow`: {error}") from error
    for i, each in enumerate(motions):
        try:
            motions[i] = None if each is None else Motion.of_json(each)
        except ArgumentError as error:
            raise ArgumentError(f"'{file}': `motions[{i}]`: {error}") from error
    return content
