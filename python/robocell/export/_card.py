"""The card of an exported dataset, README.md: what its numbers mean and where they come from."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from robocell import __version__
from robocell._placeholders import OPENING
from robocell._report.facts import ATTEMPT
from robocell._suggestions import counted
from robocell.export._formats import Format, Written
from robocell.export._source import Item, Source

FRONT = """\
---
task_categories:
- robotics
tags:
{tags}
---
"""
LICENCE = (
    "**Licence.** The recording states none. Models of robots and objects keep their own. Whoever "
    "publishes the dataset names one."
)
LEROBOT_TAGS = """\
- LeRobot
- robocell
configs:
- config_name: default
  data_files: data/*/*.parquet"""


def card(source: Source, form: Format, written: Written, *, title: str, command: str) -> str:
    """Returns the text of the card.

    Args:
        source: What was exported.
        form: To what.
        written: What the writer has done.
        title: Name of the result.
        command: What made the result.
    """
    first = source.episode(source.items[0])
    described: Any = first.json
    kind = f"LeRobot dataset {form.title.rpartition(' ')[2]}" if form.is_lerobot else form.title
    parts = [
        f"{FRONT.format(tags=LEROBOT_TAGS if form.is_lerobot else '- robocell')}\n# {title}",
        f"{counted(len(source.items), 'episode')}, {source.rows} frames {_rate(source, form)}. "
        f"Simulated with robocell; {kind}.",
        _success(source),
        _yield(source),
        _time(source, form),
        "## Features\n\nRow i holds the observation before action i.",
        *(_feature_table(feature) for feature in source.resolved.features),
        _conventions(source),
        "\n".join(f"- {note}" for note in written.notes),
        _cameras(source, written),
        "## How it was made",
        _table(("part", "version"), _versions(described)),
        f"```sh\n{command}\n```",
        "`meta/robocell/episodes.json` has the id, seed and result of every episode.",
        LICENCE,
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def episodes_json(source: Source) -> str:
    """Returns the content of meta/robocell/episodes.json: where each episode comes from."""
    episodes = []
    for index, item in enumerate(source.items):
        metadata: Any = source.episode(item).metadata or {}
        known = {
            name: metadata[name] for name in ("run", "seed", "scene", "episode") if name in metadata
        }
        own = {
            "episode_index": index,
            "id": item.id,
            "task": item.task,
            "success": item.success,
            "end_reason": item.end_reason,
            "episode_json_sha256": item.digest,
        }
        episodes.append(own | known)
    return json.dumps({"robocell": __version__, "episodes": episodes}, indent=1) + "\n"


def _success(source: Source) -> str:
    rows = []
    groups: dict[tuple[str, str], list[Item]] = {}
    for item in source.items:
        groups.setdefault((item.task, item.robots), []).append(item)
    for (task, robots), own in groups.items():
        good = sum(item.success for item in own)
        reasons = Counter(item.end_reason for item in own)
        ends = ", ".join(f"{reason} {count}" for reason, count in reasons.most_common())
        share = f"{good} of {len(own)} ({100 * good / len(own):.0f} %)"
        rows.append((task, robots or "–", share, ends))
    return "## Episodes\n\n" + _table(("task", "robot", "success", "ends"), rows)


def _yield(source: Source) -> str:
    """Returns how many attempts there were before the episodes; "" if they do not say it."""
    attempts: dict[str, list[Any]] = {}
    for item in source.items:
        metadata: Any = source.episode(item).metadata or {}
        listed = metadata.get("earlier_attempts")
        if not isinstance(listed, list):
            return ""
        # With `keep: all`, each episode of an item lists all attempts before it.
        name = ATTEMPT.sub("", item.id) if "attempt" in metadata else item.id
        if len(listed) >= len(attempts.get(name, ())):
            attempts[name] = listed
    every = [each for listed in attempts.values() for each in listed]
    refused = sum(isinstance(each, dict) and "refused" in each for each in every)
    failed = counted(len(every) - refused, "failed rollout")
    return f"Before these episodes: {failed}, {counted(refused, 'rejected start')}."


def _rate(source: Source, form: Format) -> str:
    if not source.is_even:
        return "at uneven times"
    rate = f"{source.fps} fps" if form.is_lerobot else f"{float(source.rate):.6g} Hz"
    return f"at {rate}, {source.rows / float(source.rate) / 60:.1f} minutes"


def _time(source: Source, form: Format) -> str:
    if not source.is_even:
        return "**Time.** Rows are not evenly spaced; every row has its own time."
    if source.resampled:
        return (
            f"**Time.** A row is {1 / source.rate} s. The episodes were recorded at another rate "
            "and resampled: each row has the state, the command and the images of the nearest "
            "recorded row before. Rewards since the last row are added; relative actions lead from "
            "one held target to the next."
        )
    if not form.is_lerobot:
        return f"A row is {1 / source.rate} s."
    if source.rate == source.fps:
        return f"A row is 1/{source.fps} s."
    return (
        f"**Time.** The episodes have {float(source.rate):.4f} rows per second ({source.rate}). "
        f"LeRobot needs a whole number, so `timestamp` and the videos count "
        f"{source.fps} per second. No row was added or left out."
    )


def _feature_table(feature: Any) -> str:
    rows = [
        (str(index), name, unit or "–", frame or "–", f"`{source}`")
        for index, (name, unit, frame, source) in enumerate(
            zip(feature.names, feature.units, feature.frames, feature.sources, strict=True)
        )
    ]
    table = _table(("index", "name", "unit", "frame", "column of the episode"), rows)
    values = ", ".join(f"{i} {name}" for i, name in enumerate(feature.values))
    return (
        f"### `{feature.name}`\n\n{feature.dtype}, {counted(feature.size, 'number')}.\n\n{table}"
        + (f"\n\nValues: {values}." if values else "")
    )


def _conventions(source: Source) -> str:
    sources = {each for feature in source.resolved.features for each in feature.sources}
    lines = ["Lengths are metres, angles radians, quaternions x, y, z, w."]
    names = [name for feature in source.resolved.features for name in feature.names]
    if any(name.rpartition(".")[2] == OPENING for name in names):
        gripper = source.gripper
        lines.append(
            f"Gripper: `opening` is {gripper.closed:g} closed and {gripper.open:g} open, in "
            "observations and in actions."
        )
    if any(name.endswith("_relative") for name in sources):
        lines.append(
            "Actions ending in `_relative` are differences from the controller's target before the "
            "action."
        )
    if any(name.endswith("/tcp_displacement") for name in sources):
        lines.append(
            "The action of the TCP is its displacement by this action: translation, then rotation "
            "vector."
        )
    return "**Conventions.** " + " ".join(lines)


def _cameras(source: Source, written: Written) -> str:
    if not source.cameras:
        return "## Cameras\n\nNone."
    rows = []
    for camera in source.cameras:
        height, width = source.shape_of(camera)
        row = [f"`{camera.feature}`", camera.name, f"{width}x{height}"]
        if written.codecs:
            reason = written.encoded.get(camera.feature)
            row.append(written.codecs[camera.feature])
            row.append(f"encoded again: {reason}" if reason else "copied")
        rows.append(row)
    head = ["feature", "camera", "size", *(["codec", "video"] if written.codecs else [])]
    text = "Image i belongs to row i: RGB, uint8, from the top left."
    if written.codecs:
        text = "Frame i of a video belongs to row i."
    if written.statistics:
        text += " Statistics of images are those of key frames."
    left = f"\n\nNot exported: {', '.join(source.left_out)}." if source.left_out else ""
    return f"## Cameras\n\n{text}\n\n{_table(head, rows)}{left}"


def _versions(described: Any) -> list[Sequence[str]]:
    recorded = described.get("versions", {})
    rows: list[Sequence[str]] = [("robocell, of the export", __version__)]
    rows += [(f"{name}, of the recording", str(value)) for name, value in recorded.items()]
    metadata = described.get("metadata") or {}
    for name in ("run", "renderer"):
        if name in metadata:
            rows.append((name, str(metadata[name])))
    return rows


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def line(cells: Sequence[str]) -> str:
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"

    return "\n".join([line(head), line(["---"] * len(head)), *map(line, rows)])
