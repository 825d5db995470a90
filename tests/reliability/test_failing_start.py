"""`robocell generate` before and after its workers: calls of prepare, lock and report may fail.

Chosen ones in `make test`, more in `make check-proofs`, every one in `make soak`.
The episode is there, without cameras; manifest, models, lock and report are not. What workers do is
for test_failing_disk.py.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from fnmatch import fnmatch
from pathlib import Path

import figures
import pytest
import yaml
from disks import quick_folder
from ledger import BUILD, HARMLESS, Ending
from storm import RUN, Storm, marks

import robocell
from command_line import robocell_command
from contents import contents
from made_once import made_once

FAR_TOO_MANY = 2000
POINTS = [
    "mkdir .probe.*",
    "write .dataset.json.*",
    "fsync .dataset.json.*",
    "rename dataset.json",
    "fsync .",
    "mkdir models/.rc7-*",
    "rename models/rc7-*",
    "fsync models",
    "create .lock",
    "mkdir .logs",
    "rename report.json",
]


class Command:
    """The command for a dataset of one episode, which is there.

    Attributes:
        storm: The dataset.
        episode: The marks of its files.
        whole: What it holds when nothing fails.
    """

    def __init__(self, blind: Storm, folder: Path) -> None:
        self._blind = blind
        self.storm = Storm(folder)
        shutil.copy(blind.folder / "run.yaml", folder)
        faults = {
            "LD_PRELOAD": str(BUILD / "libfault_io.so"),
            "FAULT_PROGRAM": Path(sys.executable).name,
            "FAULT_UNDER": str(self.storm.dataset),
        }
        self._forks = subprocess.Popen(
            [sys.executable, Path(__file__).with_name("forks.py")],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **faults},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.fresh()
        assert self.run().code == 0
        self.whole = contents(self.storm.dataset)

    def fresh(self) -> None:
        """Only the episode is there."""
        shutil.rmtree(self.storm.dataset, ignore_errors=True)
        [episode] = robocell.Dataset(self._blind.dataset).ids
        shutil.copytree(self._blind.dataset / episode, self.storm.dataset / episode)
        self.episode = marks(self.storm)

    def run(self, at: int | str = 0, do: str = "") -> Ending:
        """Runs it; its call `at` in the dataset meets `do`."""
        arguments = ["generate", str(self.storm.folder / "run.yaml"), "--progress", "jsonl"]
        arguments += ["--output", str(self.storm.dataset)]
        assert self._forks.stdin is not None
        assert self._forks.stdout is not None
        request = {"arguments": arguments, "at": at, "do": do}
        print(json.dumps(request), file=self._forks.stdin, flush=True)
        answer = json.loads(self._forks.stdout.readline())
        return Ending(self.storm.dataset, answer["code"], [], answer["said"])

    def close(self) -> None:
        """Ends the process."""
        self._forks.communicate()

    def at_some_points(self, do: str) -> Iterator[Ending]:
        """One ending per second point; a death and an error share them."""
        return self.at_points(do, POINTS[do == "fail" :: 2])

    def at_points(self, do: str, points: Sequence[str] = POINTS) -> Iterator[Ending]:
        """One ending per point."""
        for point in points:
            self.fresh()
            call, path = point.split()
            ending = self.run(f"{call} {self.storm.dataset / path}", do)
            assert fnmatch(ending.fault, point), f"{point} was not met: {ending.said}"
            yield ending
        figures.note("calls", program="generate", do=do, times=len(points))

    def everywhere(self, do: str) -> Iterator[Ending]:
        """One ending per call, until the fault comes too late."""
        seen: list[str] = []
        for number in range(1, FAR_TOO_MANY):
            self.fresh()
            ending = self.run(number, do)
            if not ending.fault:
                missed = [point for point in POINTS if not any(fnmatch(met, point) for met in seen)]
                assert missed == [], seen
                figures.note("calls", program="generate", do=do, times=number - 1)
                return
            seen.append(ending.fault)
            yield ending
        raise AssertionError("the sweep has no end")


@pytest.fixture(scope="session")
def blind(tmp_path_factory: pytest.TempPathFactory) -> Storm:
    """One episode without cameras."""

    def make(folder: Path) -> None:
        run = {**RUN, "episodes_per_scene": 1, "cameras": {"streams": []}}
        (folder / "run.yaml").write_text(yaml.safe_dump(run))
        words = ("generate", folder / "run.yaml", "--output", Storm(folder).dataset)
        result = robocell_command(*words)
        assert result.returncode == 0, result.stderr

    return Storm(made_once(tmp_path_factory, "blind", make))


@pytest.fixture
def command(blind: Storm, tmp_path: Path) -> Iterator[Command]:
    with quick_folder(tmp_path) as folder:
        command = Command(blind, folder)
        yield command
        command.close()


ENDINGS = [
    Command.at_some_points,
    pytest.param(Command.at_points, marks=pytest.mark.proof),
    pytest.param(Command.everywhere, marks=pytest.mark.soak),
]


@pytest.mark.parametrize("endings", ENDINGS)
@pytest.mark.parametrize(
    "do",
    [
        "fail",
        pytest.param("full", marks=pytest.mark.proof),
        pytest.param("kill_before", marks=pytest.mark.proof),
    ],
)
def test_a_call_outside_the_workers_can_fail(
    do: str, endings: Callable[[Command, str], Iterator[Ending]], command: Command
):
    for ending in endings(command, do):
        where = f"{ending.fault}: {ending.said}"
        if do == "kill_before":
            assert ending.code == -9, where
        elif "the report could not be written" in ending.said:  # the episodes are there
            assert ending.code == 0, where
        elif not (do == "fail" and ending.fault == HARMLESS):
            assert ending.code == 3, where
            assert str(command.storm.dataset) in ending.message, where
            assert "Traceback" not in ending.said, where
            if do == "full":
                hint = "bytes are needed" if ending.is_write else "No space left on device"
                assert hint in ending.message, where
        again = command.run()
        assert again.code == 0, f"after {where}: {again.said}"
        assert contents(command.storm.dataset) == command.whole, where
        assert marks(command.storm) == command.episode, where
        assert robocell.data.verify(command.storm.dataset).leftovers == [], where
