"""Exports, imports and datasets of datasets over a disk that fails, and killed at any instant.

A result is complete or absent, whichever call it was, and the same request then gives the bytes of
an undisturbed one. `make test` strikes a few, `make soak` every job at calls further and further.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from disks import quick_folder
from ledger import BUILD

from command_line import robocell_command, write_run
from exported import INSTALLED
from made_once import made_once
from robocell.export import export_dataset

# The commands' own notes: they have the path of the result, or the time.
NOTES = {"README.md", "episode.json", "dataset.json", "SHA256SUMS"}
KILL, FULL = "kill_before", "full"
FAR = 20_000  # calls; no job makes as many

EXPORT = "robocell.export.export_dataset({dataset!r}, {out!r}, {format!r}, **{options!r})"
IMPORT = "robocell.importer.import_dataset({source!r}, {out!r}, rate={rate!r})"
JOBS = {
    **{f"export {name}": EXPORT for name in INSTALLED},
    "export lerobot-v3, packed": EXPORT,
    "merge": "derive.merge([{dataset!r}, {other!r}], {out!r})",
    "split": "derive.split({dataset!r}, {{'train': 0.5, 'valid': 0.5}}, {out!r})",
    "filter": "derive.keep({dataset!r}, 'length > 1', {out!r})",
    **{
        f"import {name}": IMPORT
        for name in ("lerobot-v3", "lerobot-v2.1", "robomimic", "aloha", "zarr")
    },
}
QUICK = [  # what no other test of `make test` strikes
    pytest.param("split", KILL, 9, marks=pytest.mark.proof),
    ("filter", FULL, 12),
    ("import aloha", KILL, 15),
    pytest.param("export umi", FULL, 30, marks=pytest.mark.proof),
]


@dataclass(frozen=True)
class Datasets:
    """What jobs read: two datasets, and the exports that imports begin with."""

    folder: Path

    def program(self, job: str, out: Path) -> str:
        """The program of a job."""
        kind, _, rest = job.partition(" ")
        format = rest.partition(",")[0]
        call = JOBS[job].format(
            dataset=str(self.folder / "one" / "out"),
            other=str(self.folder / "two" / "out"),
            out=str(out),
            format=format,
            options={"pack": True} if rest.endswith("packed") else {},
            source=str(self.exported(format)) if kind == "import" else "",
            rate=5 if format in ("aloha", "zarr") else None,
        )
        modules = "robocell.export, robocell.importer"
        return f"import {modules}\nfrom robocell.data import derive\n{call}\n"

    def exported(self, format: str) -> Path:
        """An export, made when it is first needed."""
        out = self.folder / f"exported {format}"
        if not out.exists():
            export_dataset(self.folder / "one" / "out", out, format)
        return out


@pytest.fixture(scope="module")
def datasets(tmp_path_factory: pytest.TempPathFactory) -> Datasets:
    def make(folder: Path) -> None:
        for name, seed in (("one", 0), ("two", 1)):
            (folder / name).mkdir()
            run = write_run(folder / name, seed=seed)
            said = robocell_command("generate", run, "--workers", 1)
            assert said.returncode == 0, said.stderr

    return Datasets(made_once(tmp_path_factory, "failing_results", make))


def ran(program: str, under: Path = Path(), at: int = 0, do: str = "") -> tuple[int, str]:
    """Exit code and standard error of a program whose call `at` below a folder meets `do`."""
    faults = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": Path(sys.executable).name,
        "FAULT_UNDER": str(under),
        "FAULT_AT": str(at),
        "FAULT_DO": do,
    }
    own = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run(
        [sys.executable, "-c", program],
        env={**own, **(faults if do else {})},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    return run.returncode, run.stderr


def content(out: Path) -> dict[str, str]:
    """The hash of each file, the commands' notes apart."""
    return {
        str(path.relative_to(out)): "" if path.name in NOTES else digest(path)
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def strike(datasets: Datasets, job: str, do: str, at: int, folder: Path) -> bool:
    """Strikes a job at a call, and lets it run again. False if it makes fewer calls."""
    place = folder / "here"
    place.mkdir()
    out = place / "out"
    program = datasets.program(job, out)
    code, said = ran(program, place, at, do)
    what = f"{job}: {do} at call {at}: {said}"
    if "fault: " not in said:
        assert code == 0, what
        shutil.rmtree(place)
        return False
    assert code != 0 or out.exists(), what
    if out.exists():
        assert content(out) == whole_of(datasets, job, folder), what
    else:
        assert code != 0, what
        if do == FULL:
            assert "No space left on device" in said, what
        code, said = ran(program)
        assert code == 0, what + said
        assert [path.name for path in place.iterdir()] == ["out"], what
        assert content(out) == whole_of(datasets, job, folder), what
    shutil.rmtree(place)
    return True


def whole_of(datasets: Datasets, job: str, folder: Path) -> dict[str, str]:
    """The content of an undisturbed result."""
    whole = folder / "whole" / "out"
    if not whole.exists():
        code, said = ran(datasets.program(job, whole))
        assert code == 0, said
    return content(whole)


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Path]:
    with quick_folder(tmp_path) as folder:
        yield folder


@pytest.mark.parametrize(("job", "do", "at"), QUICK)
def test_a_struck_result_is_complete_or_absent(
    datasets: Datasets, job: str, do: str, at: int, place: Path
):
    assert strike(datasets, job, do, at, place)


@pytest.mark.soak
@pytest.mark.parametrize("do", [KILL, FULL])
@pytest.mark.parametrize("job", JOBS)
def test_every_result_is_complete_or_absent_wherever_it_is_struck(
    datasets: Datasets, job: str, do: str, place: Path
):
    at, further = 1, 1
    while strike(datasets, job, do, at, place):
        at, further = at + further, at
        assert at < FAR
    assert at > 5, "calls were seen"
