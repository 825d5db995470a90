"""Estimates a run (episodes, frames, bytes, time, memory) from a few temporary episodes."""

from __future__ import annotations

import json
import os
import subprocess
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from robocell._generation.items import counts_text
from robocell._generation.own_process import ask_process
from robocell._generation.probe import MOST_BLIND, Probe, Sample, spread
from robocell._generation.probe_folder import probe_folder
from robocell._generation.procfs import peak_bytes
from robocell._generation.protocol import Failure
from robocell._generation.run_source import RunSource
from robocell._generation.totals import duration, size, time_hint
from robocell._suggestions import counted

LONGEST_S = 300.0


class ProbeError(Exception):
    """The probe could not make its episodes."""

    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.message)
        self.failure = failure


@dataclass(frozen=True)
class Estimate:
    """Estimate for the remaining items.

    Attributes:
        items: Remaining items of the plan.
        episodes: Episodes that will be stored.
        successes: Items expected to succeed.
        rows, frames: Rows and frames of these episodes.
        bytes: Size on the disk.
        seconds: Time with `workers` processes on these cores.
        workers: Configured worker processes.
        memory_bytes: Peak memory of this command, its workers and their encoders, on all machines.
        tried, seen: Items made without and with cameras for the estimate.
        files: Number of files of the episodes.
        per_core_hour: Episodes per hour of processor time, with images and encoders.
        cores: Cores that share the work.
        reasons: Reason -> rejected starts and failed rollouts of these items.
        advice: Reason and remedy of rejected starts, for an item without an accepted one.
    """

    items: int
    episodes: int
    successes: int
    rows: int
    frames: int
    bytes: int
    seconds: float
    workers: int
    memory_bytes: int
    tried: int
    seen: int
    files: int = 0
    per_core_hour: float = 0.0
    cores: int = 0
    reasons: Mapping[str, int] = field(default_factory=dict)
    advice: str = ""

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        # asdict makes pairs of a Counter's keys and values.
        return asdict(replace(self, reasons=Counter())) | {"reasons": dict(self.reasons)}

    def rows_of_text(self) -> dict[str, str]:
        """Returns label -> text, in order."""
        share = f" ({self.successes} of {counted(self.items, 'item')} succeed)"
        failing = self.successes < self.items
        hint = time_hint(self.reasons) or self.advice if failing else ""
        return {
            "episodes": f"{self.episodes}{share if failing else ''}",
            **({"reasons": counts_text(self.reasons, 6)} if failing and self.reasons else {}),
            **({"hint": hint} if hint else {}),
            "frames": f"{self.frames} ({counted(self.rows, 'row')})",
            "size": f"{size(self.bytes)}{self._each()}",
            "rate": f"{self.per_core_hour:.0f} episodes/h per core",
            "time": f"{duration(self.seconds)} on {counted(self.workers, 'worker')}"
            f" and {counted(self.cores, 'core')}",
            "memory": size(self.memory_bytes),
        }

    def _each(self) -> str:
        """Returns ' in 60 files, 0.8 MB per episode'."""
        if not self.episodes:
            return ""
        each = size(self.bytes / self.episodes)
        return f" in {counted(self.files, 'file')}, {each} per episode"


def estimate(
    source: RunSource,
    overrides: Sequence[str],
    indices: Sequence[int],
    workers: int,
    *,
    before_s: float = 0.0,
    cores: int | None = None,
) -> Estimate:
    """Makes a few of the plan's items (by index) in a temporary folder and scales up.

    `before_s` is the time before the command starts its workers; `cores` is the number of cores
    like those of this machine that share the work, None for its own. Raises ProbeError if the
    episodes cannot be made.
    """
    tried = [indices[place] for place in spread(len(indices), MOST_BLIND)]
    with probe_folder() as folder:
        probe = _probe(source, overrides, tried, folder)
    return scaled(
        probe, len(indices), workers, cores=cores, before_s=before_s, own_bytes=peak_bytes()
    )


def scaled(
    probe: Probe,
    items: int,
    workers: int,
    *,
    cores: int | None = None,
    before_s: float = 0.0,
    own_bytes: int = 0,
) -> Estimate:
    """Scales from the tried items to all.

    Rows and bytes of the time series are those of the blind items. The share of cameras in an item
    (bytes of the files, seconds) is the difference between both kinds of the same items, in
    proportion to their rows. `before_s` passes before there are workers; `own_bytes` is the memory
    of the process that supervises them.
    """
    blind, seeing = probe.blind, probe.seeing
    same = blind[: len(seeing)]
    factor = items / len(blind)
    rows = _sum(blind, "rows") * factor
    kept = _sum(blind, "kept") * factor
    seen_rows = max(1, _sum(seeing, "rows"))
    video_bytes = _sum(seeing, "video_bytes") / seen_rows * rows
    more_bytes = _sum(seeing, "bytes") - _sum(seeing, "video_bytes") - _sum(same, "bytes")
    more_per_episode = more_bytes / max(1, _sum(seeing, "kept"))
    more_files = _sum(seeing, "files") - _sum(same, "files")
    files_each = more_files / max(1, _sum(seeing, "kept"))
    cores = cores or len(os.sched_getaffinity(0))
    at_once = max(1, min(workers, items, cores))
    elapsed = _with_cameras(probe, "seconds") * factor
    # An item with cameras draws and encodes at the same time: workers share what cores there are.
    of_cores = _with_cameras(probe, "cpu_seconds") * factor
    streams = _sum(seeing, "frames") / seen_rows
    return Estimate(
        items=items,
        episodes=round(kept),
        successes=round(_sum(blind, "success") * factor),
        rows=round(rows),
        frames=round(streams * rows),
        bytes=round(_sum(blind, "bytes") * factor + more_per_episode * kept + video_bytes),
        seconds=before_s + probe.start_s + max(elapsed / at_once, of_cores / cores),
        workers=workers,
        memory_bytes=own_bytes + min(workers, items) * (probe.worker_bytes + probe.encoder_bytes),
        tried=len(blind),
        seen=len(seeing),
        files=round(_sum(blind, "files") * factor + files_each * kept),
        per_core_hour=round(3600 * kept / max(of_cores, 1e-9), 1),
        cores=cores,
        reasons=sum((Counter(sample.reasons) for sample in blind), Counter()),
        advice=next((sample.advice for sample in blind if sample.advice), ""),
    )


def _with_cameras(probe: Probe, name: str) -> float:
    """Returns a value of the blind items with the share that cameras would have added."""
    seeing = probe.seeing
    more = max(0.0, _sum(seeing, name) - _sum(probe.blind[: len(seeing)], name))
    per_rollout = more / max(1, _sum(seeing, "rollouts"))
    return _sum(probe.blind, name) + per_rollout * _sum(probe.blind, "rollouts")


def _sum(samples: Sequence[Sample], name: str) -> float:
    return sum(getattr(sample, name) for sample in samples)


def _probe(
    source: RunSource, overrides: Sequence[str], tried: Sequence[int], folder: Path
) -> Probe:
    options = [*source.options(), *(f"--set={override}" for override in overrides)]
    options += [f"--item={index}" for index in tried]
    arguments = [*options, "--", source.run, str(folder)]
    try:
        done = ask_process("robocell._generation.probe", arguments, LONGEST_S)
    except subprocess.TimeoutExpired:
        message = f"the first episodes took more than {LONGEST_S:g} s"
        raise ProbeError(Failure("other", message)) from None
    try:
        content = json.loads(done.stdout.splitlines()[-1])
    except (ValueError, IndexError):
        output = done.stderr.strip() or f"it ended with exit code {done.returncode}"
        raise ProbeError(Failure("other", output)) from None
    if "failed" in content:
        raise ProbeError(Failure.from_json(content["failed"]))
    return Probe.from_json(content)
