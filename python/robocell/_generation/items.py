"""Messages between supervisor and worker: plan items and the records of their results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

STAGES = ("sampling", "acting", "rendering", "writing")


@dataclass(frozen=True)
class Item:
    """One episode to be made: its id and its index in the whole plan."""

    id: str
    index: int

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        return asdict(self)

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Item:
        """Reads a JSON object. Raises KeyError for a missing key."""
        return cls(id=str(values["id"]), index=int(values["index"]))


@dataclass(frozen=True)
class ItemRecord:
    """Record of the result of one item: what workers send, and what `report.json` keeps.

    Attributes:
        id: The item's id.
        success: A successful episode is on the disk.
        complete: The item needs no more attempts: success, or with `keep: first` any rollout.
        stopped: The item was ended by a stop request; nothing was decided about it.
        resumed: An earlier command decided it: all its attempts are on the disk.
        attempts: Starts sampled.
        accepted: Starts that the sampler accepted, that is rollouts.
        undecided: Attempts that a stop request ended; no other count includes them.
        refusals: Reason -> number of rejected starts.
        advice: Reason and remedy of the last rejected start, if none was accepted.
        redrawn: Reason -> number of placements rejected within the attempts.
        failures: Reason -> number of rollouts that failed.
        rows: Rows of the episode.
        seconds: Stage (see `STAGES`) -> seconds spent in it.
        robot: Name of the robot.
        object_kind: Kind of the last attempt's target; '' if unknown.
        kinds: Object kind -> attempts.
        rollouts: Object kind -> rollouts.
    """

    id: str
    success: bool = False
    complete: bool = False
    stopped: bool = False
    resumed: bool = False
    attempts: int = 0
    accepted: int = 0
    undecided: int = 0
    refusals: Mapping[str, int] = field(default_factory=dict)
    failures: Mapping[str, int] = field(default_factory=dict)
    redrawn: Mapping[str, int] = field(default_factory=dict)
    rows: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    robot: str = ""
    object_kind: str = ""
    kinds: Mapping[str, int] = field(default_factory=dict)
    rollouts: Mapping[str, int] = field(default_factory=dict)
    advice: str = ""

    @classmethod
    def from_core(cls, result: Any, *, stores: bool = True) -> ItemRecord:
        """Converts the `ItemResult` of a runner; `stores`: whether it writes episodes."""
        return cls(
            id=result.item.id,
            success=result.success and (result.committed or not stores),
            complete=result.complete,
            stopped=result.stopped,
            resumed=result.resumed,
            attempts=result.attempts,
            accepted=result.accepted,
            undecided=result.undecided,
            refusals=dict(result.refusals),
            failures=dict(result.failures),
            redrawn=dict(result.redrawn),
            rows=result.rows,
            seconds={stage: getattr(result, f"seconds_{stage}") for stage in STAGES},
            robot=result.robot,
            object_kind=result.object_kind,
            kinds=dict(result.kinds),
            rollouts=dict(result.rollouts),
            advice=result.advice,
        )

    @property
    def made_of(self) -> Mapping[str, int]:
        """Object kind -> episodes made."""
        return {self.object_kind: 1} if self.success and self.object_kind else {}

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        # asdict makes pairs of a Counter's keys and values.
        return {k: dict(v) if isinstance(v, Mapping) else v for k, v in vars(self).items()}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> ItemRecord:
        """Reads a JSON object. Raises TypeError for unknown keys."""
        return cls(**values)

    def why_unmade(self) -> str:
        """Returns 'robot 'rc7', object 'mug': no success in 5 attempts: dropped 3, too far 2'."""
        if self.resumed:
            return "its attempts were used up before; all of them are kept, and none succeeded"
        reasons = counts_text({**self.refusals, **self.failures}) or "no reason was given"
        tried = f"{self.attempts} attempt" + ("s" if self.attempts != 1 else "")
        objects = ", ".join(f"'{kind}'" for kind in self.kinds)
        what = [f"robot '{self.robot}'"] if self.robot else []
        what += [f"object {objects}"] if objects else []
        text = f"no success in {tried}: {reasons}"
        return f"{', '.join(what)}: {text}" if what else text


def recorded_frames(described: Mapping[str, Any]) -> int:
    """Frames of all videos of an episode, of every kind of image, from its episode.json."""
    nothing = {"frames": 0}
    return sum(
        images["frames"]
        for camera in described["cameras"].values()
        for images in (camera, camera.get("depth", nothing), camera.get("segmentation", nothing))
    )


def counts_text(counts: Mapping[str, int], limit: int | None = None) -> str:
    """Returns 'dropped 3, too far 2': the most frequent first; after `limit`, 'and 4 more'."""
    ordered = sorted(counts.items(), key=lambda entry: (-entry[1], entry[0]))
    shown = [f"{reason} {count}" for reason, count in ordered[:limit]]
    hidden = sum(count for _, count in ordered[len(shown) :])
    return ", ".join([*shown, f"and {hidden} more"] if hidden else shown)
