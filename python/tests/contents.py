"""What of a dataset must be the same whoever made it, and however often that was killed."""

from __future__ import annotations

import json
from pathlib import Path


def contents(dataset: Path) -> dict[str, bytes]:
    """Every file of the dataset by its path, episode.json without what is of its run.

    Left out are reports, which tell what happened, and hidden files: locks, logs, what was set
    aside.
    """
    files = {file.relative_to(dataset): file for file in dataset.rglob("*") if file.is_file()}
    return {
        str(name): _lasting(file)
        for name, file in sorted(files.items())
        if not any(part.startswith(".") for part in name.parts) and not name.match("report*.json")
    }


def _lasting(file: Path) -> bytes:
    if file.name != "episode.json":
        return file.read_bytes()
    described = json.loads(file.read_bytes())
    del described["run"]
    return json.dumps(described).encode()


def of_episodes(files: dict[str, bytes]) -> dict[str, bytes]:
    """Of these, the files in episodes' folders."""
    return {name: content for name, content in files.items() if name.startswith("s0")}
