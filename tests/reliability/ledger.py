"""Runs `write_ledger` over a disk that fails, and holds the disk against what it acknowledged."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import robocell

BUILD = Path(__file__).resolve().parents[2] / "build" / "release"
MODEL = Path(robocell.models.root()) / "robots" / "rc7" / "rc7.xml"  # any file
# Whose lock it is, is only a note for others.
HARMLESS = "write .lock"
_FAULT = re.compile(r"fault: (\w+) (\S+)")


@dataclass(frozen=True)
class Ending:
    """How a run of the program ended.

    Attributes:
        dataset: Where it wrote.
        code: Exit code; negative for a signal.
        acknowledged: Ids of the episodes that it said were committed.
        said: Standard error.
    """

    dataset: Path
    code: int
    acknowledged: list[str]
    said: str

    @property
    def fault(self) -> str:
        """The call that was made to fail: "rename e0", "fsync ."; empty when none was reached."""
        found = _FAULT.search(self.said)  # an encoder's words are quoted in the message
        return f"{found[1]} {os.path.relpath(found[2], self.dataset)}" if found else ""

    @property
    def is_write(self) -> bool:
        """Whether it would have made a file longer."""
        return "write" in self.fault and ".lock" not in self.fault

    @property
    def message(self) -> str:
        """What the program said itself."""
        return _FAULT.sub("", self.said)


def write(
    dataset: Path, kinds: Sequence[str], program: str = "", at: int | str = 0, do: str = ""
) -> Ending:
    """Writes an episode of each kind; with a program, its call `at` in the dataset meets `do`."""
    faults = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": program,
        "FAULT_UNDER": str(dataset),  # the folder itself too
        "FAULT_AT": str(at),
        "FAULT_DO": do,
    }
    run = subprocess.run(
        [BUILD / "write_ledger", dataset, MODEL, *kinds],
        env={**os.environ, **(faults if program else {})},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return Ending(dataset, run.returncode, run.stdout.split(), run.stderr)


def is_blank(dataset: Path) -> bool:
    """Whether nothing at all was written yet: `verify` rightly takes that for no dataset."""
    return not any(dataset.iterdir())


def require_sound(dataset: Path, ending: Ending) -> None:
    """Every acknowledged episode is there, and every episode that is there is intact."""
    if is_blank(dataset):
        assert ending.acknowledged == [], f"{ending.fault}: nothing is there"
        return
    result = robocell.data.verify(dataset)
    assert result.bad == [], f"{ending.fault}: {result}"
    assert set(ending.acknowledged) <= set(result.good), f"{ending.fault}: {result}"
