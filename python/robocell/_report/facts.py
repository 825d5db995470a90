"""What episode.json says about each episode of a dataset; no time series, no images."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

from robocell._core import Dataset, Episode, IoError
from robocell._generation.items import recorded_frames
from robocell._stored_files import stored_bytes

# With `keep: all` each attempt of an item is an episode of its own: s0000_e0017_a02.
ATTEMPT = re.compile(r"_a\d+$")
KEEP = re.compile(r"^keep: *(\w+)", re.MULTILINE)


@dataclass(frozen=True)
class EarlierAttempt:
    """An attempt at an episode's item before the one that the episode is.

    Attributes:
        object_kind: Kind of its target; '' if unknown.
        refused: The start was rejected; else the rollout failed.
        reason: Why.
        raised: A user's code raised, so that there was no whole rollout.
    """

    object_kind: str
    refused: bool
    reason: str
    raised: bool = False


@dataclass(frozen=True)
class EpisodeFacts:
    """One episode as its episode.json describes it.

    Attributes:
        id: Its id.
        item: The item of the plan that it belongs to, or its id.
        object_kind: Kind of the task's first object; '' if unknown.
        target: Name of the task's object in its scene; '' if unknown.
        task: Kind of the task; '' if unknown.
        instruction: The task in words; '' if unknown.
        robots: Its robots.
        success: Whether the task was done.
        end_reason: Why it ended.
        rows: Rows of its steps.
        rate: Rows per second; None if unknown.
        frames: Images of all videos.
        bytes: Size of its files.
        keep: `keep` of its run: 'successes', 'all', 'first'; '' without a run.
        earlier: The attempts at its item before it.
        scene: The scene's spec as YAML; '' if unknown.
        cameras: Camera -> (width, height, frames per second, kinds of images).
        versions: Part -> version.
        warnings: Warnings of its scene.
        seed: The seed of its run; None if unknown.
        randomized: Name -> number or word, of the values that `randomize` drew.
    """

    id: str
    item: str
    object_kind: str
    target: str
    task: str
    instruction: str
    robots: tuple[str, ...]
    success: bool
    end_reason: str
    rows: int
    rate: float | None
    frames: int
    bytes: int
    keep: str
    earlier: tuple[EarlierAttempt, ...]
    scene: str
    cameras: Mapping[str, tuple[int, int, float, str]]
    versions: Mapping[str, str]
    warnings: tuple[str, ...]
    seed: int | None
    randomized: Mapping[str, float | str] = field(default_factory=dict)

    @classmethod
    def of(cls, episode: Episode) -> EpisodeFacts:
        """Reads them. Raises IoError for a damaged episode."""
        described = cast(dict[str, Any], episode.json)
        metadata = described.get("metadata")
        metadata = metadata if isinstance(metadata, dict) else {}
        files = sum(facts["bytes"] for facts in described["files"].values())
        kept = KEEP.search(_text(metadata, "identity"))
        return cls(
            id=episode.id,
            item=ATTEMPT.sub("", episode.id) if "attempt" in metadata else episode.id,
            object_kind=_text_of(next(iter(metadata.get("object_kinds") or ()), "")),
            target=_text(metadata, "target_object"),
            task=_task(metadata),
            instruction=_text(metadata, "instruction"),
            robots=_robots(described, episode),
            success=episode.success,
            end_reason=episode.end_reason,
            rows=episode.rows(),
            rate=_rate(described, metadata),
            frames=recorded_frames(described),
            bytes=files + stored_bytes(episode.folder / "episode.json"),
            keep=kept[1] if kept else "",
            earlier=_earlier(metadata),
            scene=_text(metadata, "scene_spec"),
            cameras={name: _camera(camera) for name, camera in described["cameras"].items()},
            versions={part: str(number) for part, number in described["versions"].items()},
            warnings=tuple(episode.warnings),
            seed=metadata["seed"] if isinstance(metadata.get("seed"), int) else None,
            randomized=_randomized(metadata.get("randomized")),
        )

    @property
    def seconds(self) -> float:
        """Its length; 0 if the rate is unknown."""
        return self.rows / self.rate if self.rate else 0.0


def read(dataset: Path) -> tuple[list[EpisodeFacts], dict[str, str], dict[str, str]]:
    """Returns the episodes, the errors of the damaged ones by id, and the misnamed ones.

    The latter are folders that were copied or renamed, with the ids of their episodes.
    """
    found, damaged = [], {}
    episodes = Dataset(dataset)
    for name in episodes.ids:
        try:
            found.append(EpisodeFacts.of(episodes[name]))
        except IoError as error:
            damaged[name] = str(error)
    return found, damaged, dict(episodes.misnamed)


def _text(values: Mapping[str, Any], name: str) -> str:
    return _text_of(values.get(name))


def _text_of(value: object) -> str:
    return value if isinstance(value, str) else ""


def _task(metadata: Mapping[str, Any]) -> str:
    """Returns the kind of the task: of a run, or of the environment that was recorded."""
    environment = metadata.get("environment")
    if "task" not in metadata and isinstance(environment, dict):
        task = environment.get("task")
        return _text(task, "kind") if isinstance(task, dict) else _text_of(task)
    return _text(metadata, "task")


def _robots(described: Mapping[str, Any], episode: Episode) -> tuple[str, ...]:
    features = described.get("features")
    columns = [feature["name"] for feature in features] if features else episode.columns
    parts = (column.split("/") for column in columns)
    return tuple(dict.fromkeys(each[1] for each in parts if each[0] == "robots" and each[2:]))


def _rate(described: Mapping[str, Any], metadata: Mapping[str, Any]) -> float | None:
    rates = metadata.get("rates")
    pairs = [rates.get("policy_hz")] if isinstance(rates, dict) else []
    pairs += [
        camera["fps"] for camera in described["cameras"].values() if camera["table"] == "steps"
    ]
    for pair in pairs:
        if isinstance(pair, list) and len(pair) == 2 and all(pair):
            return float(Fraction(*pair))
    return None


def _camera(described: Mapping[str, Any]) -> tuple[int, int, float, str]:
    kinds = [kind for kind in ("depth", "segmentation") if kind in described]
    return (
        described["width"],
        described["height"],
        described["fps"][0] / described["fps"][1],
        ", ".join(["colour", *kinds]),
    )


def _randomized(recorded: object) -> dict[str, float | str]:
    """Returns one number for each channel of a colour; seeds of textures explain nothing."""
    values: dict[str, float | str] = {}
    for name, value in recorded.items() if isinstance(recorded, dict) else ():
        if name.endswith("/texture_seed"):
            continue
        if isinstance(value, str):
            values[name] = value
        elif isinstance(value, int | float) and not isinstance(value, bool):
            values[name] = float(value)
        elif isinstance(value, list) and len(value) == 3:
            channels = zip(("red", "green", "blue"), value, strict=True)
            values |= {f"{name}, {channel}": float(number) for channel, number in channels}
    return values


def _earlier(metadata: Mapping[str, Any]) -> tuple[EarlierAttempt, ...]:
    listed = metadata.get("earlier_attempts")
    attempts = []
    for described in listed if isinstance(listed, list) else ():
        refused = "refused" in described
        reason = described.get("refused" if refused else "failed", "unknown")
        attempts.append(
            EarlierAttempt(
                object_kind=_text(described, "object_kind"),
                refused=refused,
                reason=str(reason),
                raised=described.get("raised") is True,
            )
        )
    return tuple(attempts)
