"""Datasets of very many small episodes, and what commands on them take.

    python tests/reliability/many_episodes.py FOLDER COUNT   # prints a table; 100 000 take 2 GB

An episode's steps are hard links to one file; its description is its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robocell.data import ColumnSpec, EpisodeWriter

LINKS = 30_000  # of one file; ext4 allows 65 000
NO_HASH, NOTE_HASH, NOTE_SIZE = "0" * 64, "1" * 64, "987654321"


def make_many(folder: Path, count: int, model: Path | None = None, name: str = "e{:06}") -> None:
    """Makes a dataset of copies of an episode; without `model`, of five rows of an arm."""
    from robocell._core import self_hashed_json

    if model is None:
        model = _recorded(folder.with_name(f"{folder.name}-model"))
    folder.mkdir(parents=True, exist_ok=True)
    described = json.loads((model / "episode.json").read_text())

    described["run"]["json_sha256"] = NO_HASH
    described["files"]["note.txt"] = {"bytes": int(NOTE_SIZE), "sha256": NOTE_HASH}
    text = json.dumps(described, indent=2) + "\n"

    own = f'"id": {json.dumps(described["id"])}'
    files = [file for file in model.iterdir() if file.name != "episode.json"]
    for index in range(count):
        id = name.format(index)
        episode = folder / id
        if episode.exists():
            continue
        episode.mkdir()
        for file in files:
            shared = folder / f".{file.name}-{index // LINKS}"
            if not shared.exists():
                shutil.copyfile(file, shared)
            os.link(shared, episode / file.name)
        note = f"recording {index} of {folder.name}"  # or all are one recording
        (episode / "note.txt").write_text(note)
        changed = text.replace(own, f'"id": {json.dumps(id)}', 1)
        changed = changed.replace(NOTE_SIZE, str(len(note)), 1)
        changed = changed.replace(NOTE_HASH, hashlib.sha256(note.encode()).hexdigest(), 1)
        (episode / "episode.json").write_text(self_hashed_json(changed))


def _recorded(folder: Path) -> Path:
    robot = "robots/a"
    columns = {
        "time": ColumnSpec(units="s"),
        f"{robot}/arm/qpos": ColumnSpec(shape=6, units="rad"),
        f"{robot}/action/arm": ColumnSpec(shape=6, units="rad"),
        f"{robot}/opening": ColumnSpec(),
        f"{robot}/action/gripper": ColumnSpec(shape=1),
    }
    with EpisodeWriter(folder, "a", columns, metadata={"instruction": "pick"}) as episode:
        for i in range(5):
            episode.add_row({name: np.full(c.shape, i / 5) for name, c in columns.items()})
        return episode.commit(success=True)


@dataclass(frozen=True)
class Cost:
    """What a program took.

    Attributes:
        code: Exit code.
        seconds: Elapsed time.
        processor_seconds: Of all its processes.
        megabytes: Its largest process.
    """

    code: int
    seconds: float
    processor_seconds: float
    megabytes: float


def cost_of(command: list[object]) -> Cost:
    """Runs a program of Python."""
    begin = time.monotonic()
    words = [sys.executable, *map(str, command)]
    pid = os.posix_spawn(sys.executable, words, os.environ)
    _, status, usage = os.wait4(pid, 0)
    return Cost(
        os.waitstatus_to_exitcode(status),
        time.monotonic() - begin,
        usage.ru_utime + usage.ru_stime,
        usage.ru_maxrss / 1024,
    )


def jobs(folder: Path) -> dict[str, list[object]]:
    """The commands, in the order in which they run."""
    many = folder / "many"
    packed = folder / "packed"
    robocell = ["-m", "robocell"]
    count = "import robocell as rc; print(len(rc.Dataset({!r})))"
    exported = [*robocell, "export", many]
    return {
        "open": ["-c", count.format(str(many))],
        "verify": [*robocell, "verify", many],
        "report": [*robocell, "report", many],
        "filter": [*robocell, "filter", many, folder / "kept", "--where", "length > 1"],
        "merge": [*robocell, "merge", many, folder / "kept", folder / "merged"],
        "split": [*robocell, "split", many, folder / "parts"],
        "pack": [*robocell, "pack", many, packed],
        "open packed": ["-c", count.format(str(packed))],
        "unpack": [*robocell, "unpack", packed, folder / "unpacked"],
        "export lerobot-v3": [*exported, folder / "v3", "--format", "lerobot-v3"],
        "export zarr": [*exported, folder / "zarr", "--format", "zarr"],
    }


def inodes(folder: Path) -> int:
    """The files and folders of a disk."""
    status = os.statvfs(folder)
    return status.f_files - status.f_ffree


def main() -> None:
    """Prints a table."""
    folder, count = Path(sys.argv[1]), int(sys.argv[2])
    wanted = sys.argv[3].split(",") if len(sys.argv) > 3 else None
    begin = time.process_time()
    make_many(folder / "many", count)
    print(
        f"{count} episodes made in {time.process_time() - begin:.0f} s of a processor", flush=True
    )
    for name, command in jobs(folder).items():
        if wanted and name not in wanted:
            continue
        before = inodes(folder)
        cost = cost_of(command)
        print(
            f"| {name} | {cost.processor_seconds:.1f} | {cost.megabytes:.0f} | "
            f"{inodes(folder) - before} | code {cost.code}, {cost.seconds:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
