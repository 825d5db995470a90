"""`python -m robocell._generation.probe`: makes a few episodes of a run into a temporary folder.

`robocell._generation.estimate` starts it, in a separate process so that its memory is that of a
worker. Answers with one JSON object: a `Probe`, or {"failed": {...}}.

Without cameras an episode costs little and has the same rows, so many are made blind, and few with
cameras. The difference between both kinds of one episode is the share of cameras.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from robocell import Dataset, RunConfig
from robocell._ending import end_in_time
from robocell._generation.items import recorded_frames
from robocell._generation.own_process import Asker
from robocell._generation.procfs import MemoryWatch, age_s, children_peak_bytes, peak_bytes
from robocell._generation.protocol import Failure
from robocell._generation.run_source import RunSource
from robocell._own_code import RAISED, raise_interrupt
from robocell.generate import PlanItem, Runner, make_plan, prepare_dataset

MOST_BLIND, BLIND_S = 24, 8.0
MOST_SEEING, SEEING_S = 2, 10.0


@dataclass(frozen=True)
class Sample:
    """Measurements of one item of the plan.

    Attributes:
        success: A successful episode was made.
        kept: Episodes on the disk.
        rollouts: Starts that were acted on.
        rows: Rows of the episodes on the disk.
        frames: Frames of these episodes.
        bytes: Size of all their files.
        video_bytes: Size of their videos.
        seconds: Elapsed time.
        cpu_seconds: Time of all cores, with the encoders.
        files: Number of the files.
        reasons: Reason -> rejected starts and failed rollouts.
        advice: Reason and remedy of rejected starts, if none was accepted.
    """

    success: bool
    kept: int
    rollouts: int
    rows: int
    frames: int
    bytes: int
    video_bytes: int
    seconds: float
    cpu_seconds: float
    files: int = 0
    reasons: Mapping[str, int] = field(default_factory=dict)
    advice: str = ""


@dataclass(frozen=True)
class Probe:
    """Measurements of a probe.

    Attributes:
        blind: Items without cameras.
        seeing: The first of them with cameras, if the run has any.
        start_s: Time from the start of the process to the start of the first item.
        worker_bytes: Peak memory of this process.
        encoder_bytes: Peak memory of its encoders, together.
    """

    blind: Sequence[Sample]
    seeing: Sequence[Sample]
    start_s: float
    worker_bytes: int
    encoder_bytes: int

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Probe:
        """Reads a JSON object."""
        samples = {kind: [Sample(**sample) for sample in values[kind]] for kind in KINDS}
        return cls(**{**values, **samples})


KINDS = ("blind", "seeing")


def spread(count: int, most: int) -> list[int]:
    """Returns at most `most` of `count` indices, evenly spaced."""
    taken = min(count, most)
    return [index * count // taken for index in range(taken)]


def measure(
    source: RunSource, overrides: Sequence[str], indices: Sequence[int], folder: Path
) -> Probe:
    """Makes these items of the plan: blind first, then some of them again with their cameras.

    A run without cameras has no second part, which would leave this process with more memory than a
    worker.
    """
    blind_run = _load(source, [*overrides, "cameras.draw=false"], folder / "blind")
    plan = make_plan(blind_run)
    items = [plan[index] for index in indices]
    start_s = age_s()
    blind = _make(blind_run, items, BLIND_S)
    seeing_run = _load(source, overrides, folder / "seeing")
    if not (seeing_run.cameras.draw and seeing_run.cameras.streams):
        return Probe(blind, [], start_s, peak_bytes(), encoder_bytes=0)
    with MemoryWatch(children_peak_bytes) as encoders:
        seeing = _make(seeing_run, items[: min(MOST_SEEING, len(blind))], SEEING_S)
    return Probe(blind, seeing, start_s, peak_bytes(), encoders.bytes)


def _load(source: RunSource, overrides: Sequence[str], folder: Path) -> RunConfig:
    folder.mkdir()
    return source.load([*overrides, f"output={json.dumps(str(folder))}"])


def _make(run: RunConfig, items: Sequence[PlanItem], budget_s: float) -> list[Sample]:
    """Makes as many items as the time allows, at least one."""
    prepare_dataset(run, validate=False)  # who asks has done that
    runner, folder = Runner(run), Path(run.output)
    samples: list[Sample] = []
    began = time.monotonic()
    for item in items:
        if samples and time.monotonic() - began > budget_s:
            break
        samples.append(_make_one(runner, item, folder))
    return samples


def _make_one(runner: Runner, item: PlanItem, folder: Path) -> Sample:
    began, cpu_before = time.monotonic(), _cpu_seconds()
    result = runner.run(item)
    seconds, cpu_seconds = time.monotonic() - began, _cpu_seconds() - cpu_before
    dataset = Dataset(folder)
    ids = [name for name in dataset.ids if name == item.id or name.startswith(f"{item.id}_a")]
    files = [file for name in ids for file in (dataset.folder / name).iterdir()]
    videos = [file for file in files if file.name not in ("steps.h5", "episode.json")]
    described: list[Any] = [dataset[name].json for name in ids]
    return Sample(
        success=result.success,
        kept=result.kept,
        rollouts=result.accepted,
        rows=sum(len(dataset[name]) for name in ids),
        frames=sum(recorded_frames(each) for each in described),
        bytes=sum(file.stat().st_size for file in files),
        video_bytes=sum(file.stat().st_size for file in videos),
        seconds=seconds,
        cpu_seconds=cpu_seconds,
        files=len(files),
        reasons={**result.refusals, **result.failures},
        advice=result.advice,
    )


def _cpu_seconds() -> float:
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def main() -> int:
    """Entry point of the process."""
    parser = argparse.ArgumentParser(prog="robocell._generation.probe", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--item", action="append", type=int, required=True)
    RunSource.add_options(parser)
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    asker = Asker()
    try:
        source = RunSource.of(arguments)
        probe = measure(source, arguments.set, arguments.item, arguments.folder)
    except RAISED as error:
        raise_interrupt(error)
        asker.answer({"failed": Failure.of(error).to_json()})
        return 1
    asker.answer(asdict(probe))
    return 0


if __name__ == "__main__":
    ended_with = main()
    end_in_time(ended_with, quiet=True)  # a user's threads are warned about where they matter
    sys.exit(ended_with)
