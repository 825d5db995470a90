"""Runs one of our google-benchmark programs and reads its rows."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = ROOT / "build" / "release"
CORE = min(os.sched_getaffinity(0))  # where all run that have one only


def seconds(
    program: str | Path,
    files: Sequence[Path],
    folder: Path,
    *,
    repetitions: int = 9,
    one_core: bool = True,
) -> dict[str, dict[str, list[float]]]:
    """Row -> side -> seconds of each repetition, of one of what the program counts.

    A program is one of build/release, or has a path of its own.
    """
    values: defaultdict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for measured in _run(program, files, folder, repetitions, one_core):
        row, side = measured["run_name"].split("/")[:2]
        values[row][side].append(measured["each_s"])
    return values


@dataclass
class Turns:
    """What the sides of a pair took that took turns (turns.h): one value of each process.

    Attributes:
        ours: Median of the turns, in seconds, of one of what the program counts, or how many a
            second.
        peer: The same of the peer's.
        ratios: Median of what neighbouring turns make, ours to the peer's.
    """

    ours: list[float] = field(default_factory=list)
    peer: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)

    def add(self, ours: float, peer: float, ratio: float) -> None:
        """What one process says."""
        self.ours.append(ours)
        self.peer.append(peer)
        self.ratios.append(ratio)

    def take(self, ours: Callable[[], float], peer: Callable[[], float], rounds: int) -> None:
        """Lets two sides take turns as those of a program's pair do; the value of one process."""
        pairs: list[tuple[float, float]] = []
        for _ in range(rounds):
            before, after = (ours(), peer()), (peer(), ours())
            pairs += [before, after[::-1]]
        self.add_turns(pairs)

    def add_turns(self, pairs: Iterable[tuple[float, float]]) -> None:
        """What the sides took in neighbouring turns of one process, or how many a second."""
        all_pairs = list(pairs)
        self.add(
            statistics.median(one for one, _ in all_pairs),
            statistics.median(other for _, other in all_pairs),
            statistics.median(one / other for one, other in all_pairs),
        )

    def spread(self) -> str:
        """For notes: how far apart the processes are."""
        return f"processes said {min(self.ratios):.3f} to {max(self.ratios):.3f}"


def turns(
    program: str | Path, files: Sequence[Path], folder: Path, *, processes: int = 9
) -> dict[str, Turns]:
    """Row -> what both of its sides took, by a program of pairs.

    In several processes, one after the other, stacks and heaps lie elsewhere each time, which moves
    what takes a few microseconds by a percent or two.
    """
    values: defaultdict[str, Turns] = defaultdict(Turns)
    for _ in range(processes):
        for measured in _run(program, files, folder, repetitions=1, one_core=True):
            row = values[measured["run_name"].split("/")[0]]
            row.add(measured["ours_s"], measured["peer_s"], measured["ratio"])
    return values


class OtherProcess:
    """Runs our side of a pair in a process of its own, which takes a turn on request."""

    def __init__(self, program: str, row: str, file: Path) -> None:
        """Starts it and waits until it is ready."""
        self.row = row
        self.process = subprocess.Popen(
            [*on_one_core(), PROGRAMS / program, "--turns", row, file],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._said()

    def __enter__(self) -> Self:
        """For turns until the end of a `with`."""
        return self

    def __exit__(self, *_: object) -> None:
        """Ends it."""
        self.process.communicate()

    def turn(self) -> float:
        """The seconds of its next turn, of one of what the program counts."""
        assert self.process.stdin is not None
        print(file=self.process.stdin, flush=True)
        return 1e-9 * float(self._said())

    def _said(self) -> str:
        assert self.process.stdout is not None
        if line := self.process.stdout.readline():
            return line
        raise RuntimeError(f"{self.row} failed:\n{self.process.communicate()[1]}")


def on_one_core() -> tuple[str, ...]:
    """Begins a command."""
    return "taskset", "--cpu-list", str(CORE)


def _run(
    program: str | Path, files: Sequence[Path], folder: Path, repetitions: int, one_core: bool
) -> Iterator[dict[str, Any]]:
    """What each repetition in one process says."""
    result = folder / f"{Path(program).name}.json"
    run = subprocess.run(
        [
            *(on_one_core() if one_core else ()),
            PROGRAMS / program,
            f"--benchmark_repetitions={repetitions}",
            "--benchmark_enable_random_interleaving=true",
            f"--benchmark_out={result}",
            "--benchmark_out_format=json",
            *files,
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    if run.returncode:
        raise RuntimeError(f"{program} failed:\n{run.stdout}{run.stderr}")
    for measured in json.loads(result.read_text())["benchmarks"]:
        if measured.get("error_occurred"):
            raise RuntimeError(f"{measured['name']}: {measured['error_message']}")
        if measured["run_type"] == "iteration":
            yield measured


def scaled(values: Sequence[float], factor: float) -> list[float]:
    """In another unit."""
    return [factor * value for value in values]
