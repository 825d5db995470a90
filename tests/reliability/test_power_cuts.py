"""Every command that writes, and the power that goes off at any instant.

A command is recorded once (`record_io.c`). From the record `power.py` builds folders that a power
cut may leave, on a journalling file system and on one that promises less. Of each: what was
acknowledged is there, what counts as whole has the right bytes, and the same command ends with the
bytes of an undisturbed one. `make test` builds a hundred folders, `make soak` more than 2000.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import figures
import pytest
from disks import quick_folder
from ledger import BUILD
from power import Cut, Record

import robocell
from command_line import environment_with, robocell_command, write_run
from exported import INSTALLED
from made_once import made_once
from robocell.data import pack
from robocell.export import export_dataset

# A person who moves the arm a little, and says that it was a success.
TELEOP = """
import json, os, sys
import robocell as rc
from robocell.teleop import Device, Motion, OperatorOptions, record

class Says(Device):
    left = 0
    def read(self, seconds):
        self.left -= 1
        if self.left < 0:
            self.left = 8
            return Motion(commands=("record",))
        return Motion((0.01, 0, 0)) if self.left else Motion(clutch=False, commands=("success",))

def acknowledge(recorded):
    event = {"event": "episode", "result": {"id": recorded.id, "success": True}}
    os.write(1, (json.dumps(event) + chr(10)).encode())

run = rc.RunConfig.load(sys.argv[1])
run.rates.max_steps = 40
options = OperatorOptions(countdown_s=0, asks=False, real_time=False)
record(run, Says(), options, on_recorded=acknowledge)
"""
SOAK_CUTS = {"generate": 40, "generate --render-kept": 30, "augment": 30, "teleop": 40}
MANY = 75  # of every other command
FEW = 100  # in `make test`
RERUN = 10  # in `make test` every so many folders are finished by the command


@dataclass(frozen=True)
class Sources:
    """What commands read: two datasets, a packed one, exports to import."""

    folder: Path

    @property
    def one(self) -> Path:
        return self.folder / "one" / "out"

    @property
    def two(self) -> Path:
        return self.folder / "two" / "out"

    def packed(self) -> Path:
        out = self.folder / "packed"
        if not out.exists():
            pack.pack(self.one, out)
        return out

    def exported(self, format: str) -> Path:
        out = self.folder / f"exported {format}"
        if not out.exists():
            export_dataset(self.one, out, format)
        return out


Command = Callable[[Sources, Path], list[object]]


@dataclass(frozen=True)
class Job:
    """A command that is struck.

    Attributes:
        command: Its arguments, from what it reads and what it makes.
        is_dataset: Whether it makes a dataset, which `verify` reads.
        grows: Whether the result is there before it is complete.
        before: Prepares the folder of the result.
    """

    command: Command
    is_dataset: bool = True
    grows: bool = False
    before: Callable[[Sources, Path], object] = lambda sources, out: None


def _damaged(sources: Sources, out: Path) -> None:
    shutil.copytree(sources.one, out)
    for name, flip in (("steps.h5", 700), ("wrist.mp4", 900)):
        file = sorted(out.glob(f"s*/{name}"))[0]
        content = bytearray(file.read_bytes())
        content[flip] ^= 1
        file.write_bytes(content)


def _run(sources: Sources, out: Path) -> Path:
    return write_run(out.parent.parent, output=str(out), **SMALL)


def run_command(command: list[object], **shim: str) -> subprocess.CompletedProcess[str]:
    """Runs the command line, or a program of Python."""
    if command[0] != "-c":
        return robocell_command(*command, environment=shim)
    return subprocess.run(
        [sys.executable, *map(str, command)],
        env=environment_with(shim),
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )


SMALL = {"rates": {"policy_ms": 198, "control_ms": 2, "sim_ms": 2, "max_steps": 500}}
JOBS = {
    "merge": Job(lambda s, out: ["merge", s.one, s.two, out]),
    "merge --copy": Job(lambda s, out: ["merge", s.one, s.two, out, "--copy"]),
    "split": Job(
        lambda s, out: ["split", s.one, out, "--parts", "train=0.5,valid=0.5", "--copy"],
        is_dataset=False,
    ),
    "filter": Job(lambda s, out: ["filter", s.one, out, "--where", "length > 1"]),
    "pack": Job(lambda s, out: ["pack", s.one, out, "--shard-mb", 0.05]),
    "unpack": Job(lambda s, out: ["unpack", s.packed(), out]),
    **{
        f"export {name}": Job(
            lambda s, out, name=name: ["export", s.one, out, "--format", name],  # type: ignore[misc]
            is_dataset=False,
        )
        for name in INSTALLED
    },
    "export lerobot-v3 --pack": Job(
        lambda s, out: ["export", s.one, out, "--format", "lerobot-v3", "--pack"], is_dataset=False
    ),
    **{
        f"import {name}": Job(
            lambda s, out, name=name: [  # type: ignore[misc]
                "import",
                s.exported(name),
                out,
                *(["--rate", 5] if name in ("aloha", "zarr") else []),
            ]
        )
        for name in ("lerobot-v3", "robomimic", "aloha", "zarr")
    },
    "verify --repair": Job(lambda s, out: ["verify", out, "--repair"], grows=True, before=_damaged),
    "generate": Job(
        lambda s, out: ["generate", _run(s, out), "--workers", 1, "--progress", "jsonl"],
        grows=True,
    ),
    "generate --render-kept": Job(
        lambda s, out: [
            *["generate", _run(s, out), "--workers", 1, "--progress", "jsonl"],
            "--render-kept",
        ],
        grows=True,
    ),
    "augment": Job(
        lambda s, out: [
            *["augment", s.one, "-n", 2, "--output", out, "--workers", 1, "--progress", "jsonl"]
        ],
        grows=True,
    ),
    "teleop": Job(lambda s, out: ["-c", TELEOP, _run(s, out)], grows=True),
    "make-houses": Job(
        lambda s, out: [
            *["make-houses", out, "-n", 2, "--rooms", 1, 1, "--objects", 2, "--workers", 1]
        ],
        is_dataset=False,
        grows=True,
    ),
}


def lasting(files: dict[str, bytes | None]) -> dict[str, bytes]:
    """What is the same after every run: visible files, descriptions without their run."""
    kept = {}
    for name, content in files.items():
        parts = Path(name).parts
        is_report = parts[-1].startswith("report") and parts[-1].endswith(".json")
        if content is None or is_report or any(part.startswith(".") for part in parts):
            continue
        if parts[-1] == "episode.json":
            try:
                described = json.loads(content)
                del described["run"]
                content = json.dumps(described).encode()
            except (ValueError, KeyError):
                content = b"damaged " + content
        kept[name] = content
    return kept


def read(place: Path) -> dict[str, bytes | None]:
    return {
        str(path.relative_to(place)): None if path.is_dir() else path.read_bytes()
        for path in place.rglob("*")
    }


class Struck:
    """A command, its record, and what it makes undisturbed."""

    def __init__(self, name: str, sources: Sources, folder: Path) -> None:
        self.name, self.job, self.sources = name, JOBS[name], sources
        self.place = folder / "place"
        self.place.mkdir(parents=True)
        self.out = self.place / "out"
        self.job.before(sources, self.out)
        before = Record.snapshot(self.place)
        file = folder / "record"
        shim = {
            "LD_PRELOAD": str(BUILD / "librecord_io.so"),
            "RECORD_UNDER": str(self.place),
            "RECORD_TO": str(file),
        }
        self.command = self.job.command(sources, self.out)
        said = run_command(self.command, **shim)
        assert said.returncode == 0, said.stdout + said.stderr
        self.record = Record(self.place, before, file)
        left = read(self.place)
        recorded = self.record.whole().files()
        hidden = {name for name in left if ".logs" in name}
        assert {n for n in left if n not in hidden} == {n for n in recorded if ".logs" not in n}
        for each in left:
            assert each in hidden or left[each] == recorded[each], f"{each} was written unseen"
        self.whole = lasting(left)
        self.seen: set[str] = set()

    def check(self, seed: int, again: bool) -> bool:
        """Builds a folder and checks it; False if it was seen before."""
        cut = self.record.cut(seed)
        files = cut.files()
        digest = hashlib.sha256(repr(sorted(files.items())).encode()).hexdigest()
        if digest in self.seen:
            return False
        self.seen.add(digest)
        cut.build()
        what = f"{self.name}: {cut}"
        self._check_what_is_there(cut, what)
        is_refused = not self.job.grows and self.out.exists()  # nothing is replaced
        if again and not is_refused:
            said = run_command(self.command)
            # A second repair has nothing to repair, and names what is missing.
            codes = (0, 1) if self.job.before is _damaged else (0,)
            assert said.returncode in codes, f"{what}: {said.stdout}{said.stderr}"
            self._compare(lasting(read(self.place)), what)
        return True

    def _compare(self, found: dict[str, bytes], what: str) -> None:
        names = {*found, *self.whole}
        # The device's session of an episode that no message has acknowledged may be lost.
        names = {name for name in names if "/device_sessions/" not in name}
        wrong = [name for name in sorted(names) if found.get(name) != self.whole.get(name)]
        assert not wrong, f"{what}: differs from an undisturbed one: {wrong}"

    def _check_what_is_there(self, cut: Cut, what: str) -> None:
        there = lasting(read(self.place))
        acknowledged = any(self.record.last_naming < at < cut.at for at, _ in self.record.says)
        if not self.job.grows:
            assert not acknowledged or self.out.exists(), f"{what}: the result is lost"
            if self.out.exists():
                self._compare(there, what)
                if self.job.is_dataset:
                    assert robocell.data.verify(self.out).ok, what
            return
        if self.name == "make-houses":
            for name, content in there.items():
                assert content == self.whole[name], f"{what}: {name} is wrong"
            return
        made = {
            event["result"]["id"]
            for line in cut.said.splitlines()
            if line.startswith("{") and line.endswith("}")
            if (event := json.loads(line)).get("event") == "episode" and event["result"]["success"]
        }
        if not self.out.exists() or not any(self.out.iterdir()):
            assert not made, f"{what}: all is lost"
            return
        found = robocell.data.verify(self.out)
        assert made <= set(found.good), f"{what}: {made} were acknowledged: {found}"
        for name, content in there.items():
            if Path(name).parts[1] in found.good:
                assert content == self.whole[name], f"{what}: {name} counts as whole"
        if self.job.before is not _damaged:
            assert found.bad == [], f"{what}: {found}"


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Sources:
    def make(folder: Path) -> None:
        for name, seed in (("one", 0), ("two", 1)):
            (folder / name).mkdir()
            run = write_run(folder / name, seed=seed)
            said = robocell_command("generate", run, "--workers", 1)
            assert said.returncode == 0, said.stderr

    return Sources(made_once(tmp_path_factory, "failing_results", make))


def strike(name: str, sources: Sources, folder: Path, count: int, rerun: int = 1) -> None:
    """Builds so many different folders of a command."""
    struck = Struck(name, sources, folder)
    done = seed = 0
    while done < count and seed < 40 * count:
        done += struck.check(seed, again=seed % rerun == 0)
        seed += 1
    figures.note("power cuts", command=name, times=done)
    assert done == count, f"{name}: only {done} different folders"


def test_a_power_cut_loses_nothing(sources: Sources, tmp_path: Path):
    with quick_folder(tmp_path) as folder:
        strike("merge --copy", sources, folder, FEW, RERUN)


@pytest.mark.proof
@pytest.mark.parametrize("name", ["export aloha", "pack", "generate"])
def test_no_power_cut_loses_anything_at_a_few_instants(name: str, sources: Sources, tmp_path: Path):
    with quick_folder(tmp_path) as folder:
        strike(name, sources, folder, FEW // 5, RERUN)


@pytest.mark.soak
@pytest.mark.parametrize("name", JOBS)
def test_no_power_cut_loses_anything(name: str, sources: Sources, tmp_path: Path):
    with quick_folder(tmp_path) as folder:
        strike(name, sources, folder, SOAK_CUTS.get(name, MANY))
