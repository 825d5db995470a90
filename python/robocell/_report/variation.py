"""What differs between the starts of episodes: objects, their places and looks, the robot's base.

Objects are described by the scene's spec in episode.json, so all episodes count. Where the base
stands is in the first row of the time series, so only episodes count that were read in full.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robocell._report.facts import EpisodeFacts
from robocell._report.rollouts import Rate, rates

Value = float | str
BINS = 5
MOST_CATEGORIES = 12
MOST_SHOWN = 12
SMALLEST_RANGE = 1e-6  # m or rad; below it a value does not vary


@dataclass(frozen=True)
class Varied:
    """A value that differs between episodes.

    Attributes:
        name: What it is, with its unit.
        values: Episode -> value.
        groups: Success rates of its values or ranges of values, in order.
    """

    name: str
    values: Mapping[str, Value]
    groups: Sequence[Rate]


@dataclass(frozen=True)
class Effect:
    """A value that `randomize` drew, and the success of the episodes by it.

    Attributes:
        name: Its name in the episodes.
        range: The values that came, in words.
        groups: Success rates of its values or ranges of values, in order; [] if it never differs.
        share: Share of the variance of success that the groups explain beyond chance, 0 to 1
            (omega squared).
    """

    name: str
    range: str
    groups: Sequence[Rate]
    share: float


def effects(episodes: Sequence[EpisodeFacts]) -> list[Effect]:
    """Returns the randomised values, those first that explain most of the failures."""
    success = {episode.id: episode.success for episode in episodes}
    found: dict[str, dict[str, Value]] = {}
    for episode in episodes:
        for name, value in episode.randomized.items():
            found.setdefault(name, {})[episode.id] = value
    listed = []
    for name, values in found.items():
        groups = _grouped(values, success)
        listed.append(Effect(name, _range(values.values()), groups, _explained(groups)))
    return sorted(listed, key=lambda each: (-each.share, each.name))


def _range(values: Iterable[Value]) -> str:
    listed = list(values)
    words = sorted({value for value in listed if isinstance(value, str)})
    if words:
        more = len(words) - MOST_CATEGORIES
        return ", ".join(words[:MOST_CATEGORIES]) + (f" and {more} more" if more > 0 else "")
    low, high = min(map(float, listed)), max(map(float, listed))
    return f"{low:.4g}" if low == high else f"{low:.4g} … {high:.4g}"


def _explained(groups: Sequence[Rate]) -> float:
    """Returns omega squared of success over the groups: 0 where chance explains them."""
    number = sum(group.rollouts for group in groups)
    if len(groups) < 2 or number <= len(groups):
        return 0.0
    mean = sum(group.successes for group in groups) / number
    between = sum(group.rollouts * (group.share - mean) ** 2 for group in groups)
    total = number * mean * (1 - mean)
    within = (total - between) / (number - len(groups))
    if total + within <= 0:
        return 0.0
    return max(0.0, (between - (len(groups) - 1) * within) / (total + within))


def find(
    episodes: Sequence[EpisodeFacts], started: Mapping[str, Mapping[str, float]]
) -> list[Varied]:
    """Returns the values that differ, at most `MOST_SHOWN`; those of the task's objects first.

    Args:
        episodes: The episodes.
        started: Episode -> value at its start by name, of those that were read in full.
    """
    success = {episode.id: episode.success for episode in episodes}
    found: dict[str, dict[str, Value]] = {}
    parsed: dict[str, dict[str, Value]] = {}
    for episode in episodes:
        text = _objects(episode.scene)
        if text not in parsed:
            parsed[text] = _values(text)
        for name, value in (*parsed[text].items(), *started.get(episode.id, {}).items()):
            found.setdefault(name, {})[episode.id] = value
    varied = []
    for name, values in found.items():
        groups = _grouped(values, success)
        if len(groups) > 1:
            varied.append(Varied(name, values, groups))
    targets = tuple(f"{name}: " for name in {episode.target for episode in episodes} if name)
    others = {name for values in parsed.values() for name in values}
    varied.sort(key=lambda each: (not each.name.startswith(targets), each.name in others))
    return varied[:MOST_SHOWN]


def _objects(scene: str) -> str:
    """Returns the block `objects:` of a scene's spec: parsing all of it takes six times as long."""
    _, key, rest = f"\n{scene}".partition("\nobjects:")
    if not key:
        return ""
    lines = rest.split("\n")
    end = next((i for i, line in enumerate(lines[1:], 1) if line[:1] not in ("", " ", "-")), None)
    return "objects:" + "\n".join(lines[:end])


def _values(text: str) -> dict[str, Value]:
    """Returns the values of all objects by name; none for a text that is not of our specs."""
    import yaml

    try:
        read = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except yaml.YAMLError:
        return {}
    listed = read.get("objects") if isinstance(read, dict) else None
    values: dict[str, Value] = {}
    for described in listed if isinstance(listed, list) else ():
        if isinstance(described, dict):
            values |= _of_object(described)
    return values


def _of_object(described: Mapping[str, Any]) -> dict[str, Value]:
    name = str(described.get("name", "object"))
    values: dict[str, Value] = {}
    place = described.get("pos") or []
    if _is_numbers(place, 3):
        values |= {f"{name}: {axis}, m": float(place[i]) for i, axis in enumerate("xy")}
    turned = described.get("quat") or []
    if _is_numbers(turned, 4):
        values[f"{name}: angle about z, rad"] = yaw(turned)
    if _is_numbers(described.get("mass")):
        values[f"{name}: mass, kg"] = float(described["mass"])
    friction = described.get("friction")
    if isinstance(friction, list) and friction and _is_numbers(friction[0]):
        values[f"{name}: sliding friction"] = float(friction[0])
    size = described.get("size")
    if isinstance(size, list) and size and _is_numbers(size[0]):
        values[f"{name}: first half size, m"] = float(size[0])
    colour = described.get("rgba") or []
    if _is_numbers(colour, 4):
        values[f"{name}: colour"] = "#" + "".join(
            f"{round(255 * min(1.0, max(0.0, part))):02x}" for part in colour[:3]
        )
    return values


def yaw(quaternion: Sequence[float]) -> float:
    """Returns the angle about z of a rotation (xyzw), -pi to pi."""
    x, y, z, w = quaternion
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _is_numbers(value: Any, length: int | None = None) -> bool:
    if length is not None:
        return isinstance(value, list) and len(value) == length and all(map(_is_numbers, value))
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _grouped(values: Mapping[str, Value], success: Mapping[str, bool]) -> list[Rate]:
    """Returns rates by text or by range of numbers; [] for values that cannot be grouped."""
    if all(isinstance(value, str) for value in values.values()):
        groups = rates((str(value), success[name]) for name, value in values.items())
        return sorted(groups, key=lambda rate: rate.name) if len(groups) <= MOST_CATEGORIES else []
    numbers = {name: float(v) for name, v in values.items() if not isinstance(v, str)}
    numbers = {name: number for name, number in numbers.items() if math.isfinite(number)}
    if not numbers or np.ptp(list(numbers.values())) < SMALLEST_RANGE:
        return []
    different = sorted(set(numbers.values()))
    if len(different) <= BINS:
        return [
            Rate(f"{value:.4g}", sum(success[n] for n in names), len(names))
            for value in different
            for names in [[n for n, number in numbers.items() if number == value]]
        ]
    edges = np.unique(np.quantile(list(numbers.values()), np.linspace(0, 1, BINS + 1)))
    place = np.clip(np.searchsorted(edges, list(numbers.values()), "right") - 1, 0, len(edges) - 2)
    good = np.array([success[name] for name in numbers])
    return [
        Rate(f"{edges[i]:.3g} … {edges[i + 1]:.3g}", int(good[place == i].sum()), int(n))
        for i in range(len(edges) - 1)
        if (n := (place == i).sum())
    ]
