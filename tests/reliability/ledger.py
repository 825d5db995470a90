"""Runs `write_ledger` over a disk that fails, and holds the disk against what it acknowledged."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

import robocell

BUILD = Path(__file__).resolve().parents[2] / "build" / "release"
COUNT = 2  # the first episode has no video, the last has one
_FAULT = re.compile(r"fault: \w+ \S+")
IDS = [f"e{number}" for number in range(COUNT)]


@dataclass(frozen=True)
class Ending:
    """How a run of the program ended.

    Attributes:
        code: Exit code; negative for a signal.
        acknowledged: Ids of the episodes that it said were committed.
        said: Standard error.
    """

    code: int
    acknowledged: list[str]
    said: str

    @property
    def fault(self) -> str:
        """The call that was made to fail, with its path; empty when none was reached."""
        found = _FAULT.search(self.said)  # an encoder's words are quoted in the message
        return found[0] if found else ""

    @property
    def message(self) -> str:
        """What the program said itself."""
        return _FAULT.sub("", self.said)


def write(dataset: Path, program: str = "", at: int = 0, do: str = "") -> Ending:
    """Writes the episodes; with a program, its call number `at` under the dataset meets `do`."""
    faults = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": program,
        "FAULT_UNDER": f"{dataset}/",
        "FAULT_AT": str(at),
        "FAULT_DO": do,
    }
    run = subprocess.run(
        [BUILD / "write_ledger", dataset, str(COUNT)],
        env={**os.environ, **(faults if program else {})},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return Ending(run.returncode, run.stdout.split(), run.stderr)


def contents(dataset: Path) -> dict[str, bytes]:
    """Everything of the episodes that must be the same whenever they are written."""
    files = [*dataset.glob("e*/steps.h5"), *dataset.glob("e*/*.mp4"), *dataset.glob("e*/*.mjb")]
    return {str(file.relative_to(dataset)): file.read_bytes() for file in files}


def is_blank(dataset: Path) -> bool:
    """Whether nothing at all was written yet: `verify` rightly takes that for no dataset."""
    return not any(dataset.iterdir())


def require_sound(dataset: Path, ending: Ending) -> None:
    """Every acknowledged episode is there, and every episode that is there is intact."""
    if is_blank(dataset):
        assert ending.acknowledged == [], f"{ending.fault}: nothing is there"
        return
    report = robocell.verify(dataset)
    assert report.bad == [], f"{ending.fault}: {report}"
    assert set(ending.acknowledged) <= set(report.good), f"{ending.fault}: {report}"
