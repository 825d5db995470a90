"""What the disk says about the rollouts of an evaluation, and about the cell that they were in."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robocell._core import Episode
from robocell._dataset_run import manifest_of_dataset
from robocell._env_job import EnvJob
from robocell._generation.job import Job
from robocell._generation.unstored import UnstoredRollout
from robocell._policy_calls import error_of
from robocell._spec_fields import fields_of, file_hashes
from robocell._stored_files import is_stored
from robocell._suggestions import shortened
from robocell.policy import POLICY_ERROR

if TYPE_CHECKING:
    from robocell._report.facts import EpisodeFacts
    from robocell._report.rollouts import Rate

# Fields of a run that belong to the policy, to the number of rollouts or to where they are kept.
OF_THE_POLICY = (
    *("run", "expert", "keep", "episodes", "episodes_per_scene", "seed", "cameras.draw"),
    *("workers", "output", "render", "imports", "scenes.houses"),
)
CODE = "code/"  # begins the names of files of code in a dataset's manifest
# Rollouts are counted by these, and by each randomised value.
BREAKDOWN: dict[str, Callable[[EpisodeFacts], str]] = {
    "object": lambda facts: facts.object_kind,
    "task": lambda facts: facts.task,
    "robot": lambda facts: ", ".join(facts.robots),
}
POLICY_ERROR_RESULT = "policy_error"  # src/robocell/rollout/rollout.cc


@dataclass(frozen=True)
class RolloutEnd:
    """How a rollout ended.

    Attributes:
        success: Whether it succeeded.
        reason: Why it ended.
        rows: Number of its actions.
        policy_error: Whether an error of the policy or expert ended it.
    """

    success: bool
    reason: str
    rows: int
    policy_error: bool


def rollout_end(dataset: Path, rollout: str) -> RolloutEnd | None:
    """Returns how a rollout ended; None for one that was not made. Raises IoError if damaged."""
    error = error_of(dataset, rollout)
    if not is_stored(dataset / rollout / "episode.json"):
        if (unstored := UnstoredRollout.find(dataset, rollout)) is not None:
            record, reason = unstored.record, unstored.failure or "success"
            is_error = reason.startswith(POLICY_ERROR)
            return RolloutEnd(record.success, reason, record.rows, is_error)
        return RolloutEnd(False, f"{POLICY_ERROR}{error}", 0, True) if error else None
    episode = Episode(dataset / rollout)
    results: Mapping[str, Any] = episode.results
    is_error = bool(error) or bool(results.get(POLICY_ERROR_RESULT))
    return RolloutEnd(bool(episode.success), str(episode.end_reason), len(episode), is_error)


def breakdown_of(dataset: Path, rollouts: Iterable[str]) -> dict[str, dict[str, list[int]]]:
    """Returns the successes and the number of rollouts by each value that differs between starts.

    Rollouts that ended before their first action have no start on the disk, and do not count. Those
    that were not kept count by object and robot only.
    """
    from robocell._report import variation
    from robocell._report.facts import EpisodeFacts
    from robocell._report.rollouts import rates

    planned = list(rollouts)
    there = [name for name in planned if is_stored(dataset / name / "episode.json")]
    facts = [EpisodeFacts.of(Episode(dataset / name)) for name in there]
    stored = set(there)
    absent = [name for name in planned if name not in stored]
    unstored = [each.record for name in absent if (each := UnstoredRollout.find(dataset, name))]
    known = {
        "object": [(record.object_kind, record.success) for record in unstored],
        "robot": [(record.robot, record.success) for record in unstored],
    }
    groups = {
        part: rates([*((value_of(each), each.success) for each in facts), *known.get(part, [])])
        for part, value_of in BREAKDOWN.items()
    }
    if facts:
        with contextlib.suppress(ModuleNotFoundError):  # without PyYAML scenes are not read
            groups |= {each.name: list(each.groups) for each in variation.find(facts, {})}
    return _differing(groups)


def _differing(groups: Mapping[str, Sequence[Rate]]) -> dict[str, dict[str, list[int]]]:
    return {
        part: {rate.name: [rate.successes, rate.rollouts] for rate in found}
        for part, found in groups.items()
        if len(found) > 1
    }


def cell_of(job: Job | EnvJob) -> dict[str, str]:
    """Returns the fields of a run or environment without the policy's, and hashes of its models."""
    if isinstance(job, EnvJob):
        return job.cell
    fields = fields_of(job.run)
    cell = {name: value for name, value in fields.items() if not _is_of_the_policy(name)}
    files: Mapping[str, str] = (manifest_of_dataset(job.dataset) or {}).get("files", {})
    return cell | file_hashes(each for each in files.items() if not each[0].startswith(CODE))


def _is_of_the_policy(name: str) -> bool:
    return any(name == each or name.startswith(f"{each}.") for each in OF_THE_POLICY)


def difference_of(one: Mapping[str, str], other: Mapping[str, str]) -> str:
    """Returns 'rates.policy_ms: 40 and 20', all names that differ; "" without any."""
    nothing = "nothing"
    differing = [name for name in dict.fromkeys([*one, *other]) if one.get(name) != other.get(name)]
    shown = [
        name
        if name.startswith("file ")
        else f"{name}: {_short(one.get(name, nothing))} and {_short(other.get(name, nothing))}"
        for name in differing
    ]
    return shortened(shown)


def _short(value: str) -> str:
    return value if len(value) <= 40 else f"{value[:37]}..."
