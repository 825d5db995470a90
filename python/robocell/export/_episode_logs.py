"""Formats with one file for each episode, which is complete or absent."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from robocell._staging import Staging
from robocell.export._source import Item, Source

WriteEpisode = Callable[[Source, Item, Path, Path], dict[str, str]]


def write_logs(
    source: Source,
    staging: Staging,
    ending: str,
    write_episode: WriteEpisode,
    on_episode: Callable[[int], None],
) -> tuple[int, dict[str, str]]:
    """Writes `<id>.<ending>` of each episode, after the last complete one of a killed export.

    Args:
        source: The episodes.
        staging: Folder of the result.
        ending: Of the files, without a dot.
        write_episode: Writes an episode to a path, with another for a temporary video; returns why
            videos were encoded again.
        on_episode: Called with the number of episodes so far.

    Returns:
        Number of episodes that were complete before, and why videos were encoded again.
    """
    resumed = 0
    encoded: dict[str, str] = {}
    for index, item in enumerate(source.items):
        file = staging.path(f"{item.id}.{ending}")
        reasons = staging.state(item.id)
        if file.exists() and reasons is not None:
            resumed += 1
        else:
            partial = staging.scratch(f"episode.{ending}")
            reasons = write_episode(source, item, partial, staging.scratch("video.mp4"))
            staging.keep(item.id, reasons)
            staging.put(partial, file)
        encoded |= reasons
        on_episode(index + 1)
    return resumed, encoded
