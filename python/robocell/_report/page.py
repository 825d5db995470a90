"""Makes the page of a report from its parts and writes it as one file."""

from __future__ import annotations

import json
import shlex
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import robocell
from robocell import _core
from robocell._core import IoError
from robocell._extras import needed_by
from robocell._generation.items import STAGES, ItemRecord
from robocell._generation.report import RunReport, whole
from robocell._generation.totals import Totals, duration, percent, size
from robocell._report import motion as motions
from robocell._report import pictures, rollouts, variation
from robocell._report.facts import EpisodeFacts
from robocell._suggestions import counted

MOST_READ = 500  # episodes whose time series are read
SHOWN = 6  # episodes with pictures
MOST_REASONS = 6  # of failures with pictures
MOST_NAMED = 20  # of a list of episodes


@dataclass(frozen=True)
class Contents:
    """What a page is made of.

    Attributes:
        dataset: Folder of the dataset.
        episodes: Its episodes.
        reports: What the commands reported that made them.
        problems: Damaged files, in words.
        misnamed: Folders that were copied or renamed, with the ids of their episodes.
    """

    dataset: Path
    episodes: Sequence[EpisodeFacts]
    reports: Sequence[RunReport]
    problems: Sequence[str] = ()
    misnamed: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Written:
    """A page that was written.

    Attributes:
        path: The file.
        bytes: Its size.
        read: Episodes whose time series were read.
        pictured: Episodes with pictures.
        problems: What could not be read in that, in words.
    """

    path: Path
    bytes: int
    read: int
    pictured: int
    problems: list[str]


def load_packages() -> None:
    """Loads what pages need. Raises ModuleNotFoundError with the pip command."""
    with needed_by("robocell report --output", "report", "Without --output it needs no package"):
        import jinja2  # noqa: F401
        import PIL.Image  # noqa: F401
        import plotly.graph_objects  # noqa: F401
        import yaml  # noqa: F401


def write(
    contents: Contents,
    out: Path,
    *,
    most_read: int = MOST_READ,
    most_speed: float | None = None,
    on_stage: Callable[[str], object] = lambda stage: None,
) -> Written:
    """Writes a page that needs no other file and no network.

    Args:
        contents: What to report.
        out: The file; it is replaced in one step.
        most_read: Most episodes whose time series are read.
        most_speed: Speed limit of all joints, rad/s or m/s, for the count of faster rows.
        on_stage: Called with the name of each stage.

    Raises:
        IoError: The file cannot be written.
        ModuleNotFoundError: A package of the extra `report` is not installed.
    """
    load_packages()
    begin = time.perf_counter()
    dataset = robocell.Dataset(contents.dataset)
    on_stage("time series")
    sampled = motions.sample(contents.episodes, most_read)
    motion = motions.read(dataset, sampled)
    on_stage("pictures")
    cards = [pictures.card(dataset, each) for each in pictures.chosen(contents.episodes, SHOWN)]
    failed = {
        reason: pictures.card(dataset, each)
        for reason, each in pictures.failed(contents.episodes, MOST_REASONS).items()
    }
    on_stage("page")
    shown = [card for card in cards if card]
    problems = list(motion.damaged.values())
    page = _Page(contents, motion, shown, failed, most_speed)
    text = page.render(problems, time.perf_counter() - begin)
    try:
        _core.atomic_write(out, text.encode())
    except OSError as error:
        raise IoError(f"cannot write '{out}': {error.strerror or error}") from error
    pictured = len(shown) + sum(card is not None for card in failed.values())
    return Written(out, len(text.encode()), len(motion.read), pictured, problems)


class _Page:
    """The values that the template shows."""

    def __init__(
        self,
        contents: Contents,
        motion: motions.Motion,
        cards: Sequence[pictures.Card],
        failed: dict[str, pictures.Card | None],
        most_speed: float | None,
    ) -> None:
        self.contents = contents
        self.episodes = contents.episodes
        self.motion = motion
        self.cards = cards
        self.failed = failed
        self.most_speed = most_speed
        self.totals = whole(contents.reports) if contents.reports else Totals(planned=0)
        records = [item for report in contents.reports for item in report.episodes.values()]
        self.records: dict[str, ItemRecord] = {item.id: item for item in records}
        self.rollouts = rollouts.count(self.episodes, self.records.values())
        self.keep = {episode.keep for episode in self.episodes}

    def render(self, problems: Sequence[str], seconds: float) -> str:
        """Returns the page."""
        import jinja2

        from robocell._report import charts

        environment = jinja2.Environment(
            loader=jinja2.FileSystemLoader(Path(__file__).parent),
            autoescape=True,
            undefined=jinja2.StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        environment.filters |= {"thousands": thousands, "percent": percent, "size": size}
        return environment.get_template("page.html").render(
            name=self.contents.reports[0].run if self.contents.reports else self._folder.name,
            folder=str(self._folder),
            made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
            version=robocell.__version__,
            plotly=charts.plotly_script(),
            tiles=self._tiles(),
            notes=self._notes(problems),
            instructions=self._instructions(),
            cameras=self._cameras(),
            groups=self._groups(charts),
            success=self._success(charts),
            variations=self._variations(charts),
            effects=variation.effects(self.episodes),
            only_successes=self.keep == {"successes"},
            stages=self._stages(charts),
            lengths=self._lengths(charts),
            robots=self._robots(charts),
            read=len(self.motion.read),
            count=len(self.episodes),
            most_speed=self.most_speed,
            ik_failed=self.motion.ik_failed,
            engine_warnings=self.motion.engine_warnings,
            cards=self.cards,
            failures=self._failures(),
            timing=self._timing(charts),
            commands=[c for report in self.contents.reports for c in report.commands],
            deaths=self.totals.deaths,
            unmade=self.totals.unmade[:MOST_NAMED],
            versions=self._versions(),
            again=self._again(),
            spent=duration(seconds),
            names=_names,
        )

    @property
    def _folder(self) -> Path:
        return self.contents.dataset.absolute()

    def _tiles(self) -> list[tuple[str, str, str]]:
        """Returns the numbers at the top: value, label, explanation."""
        rows = sum(episode.rows for episode in self.episodes)
        seconds = sum(episode.seconds for episode in self.episodes)
        stored = sum(episode.bytes for episode in self.episodes)
        frames = sum(episode.frames for episode in self.episodes)
        good = sum(episode.success for episode in self.episodes)
        tiles = [
            (thousands(len(self.episodes)), "episodes", f"{thousands(good)} successful"),
        ]
        if rate := self.rollouts.whole.rollouts:
            low, high = self.rollouts.whole.interval
            tiles.append(
                (
                    percent(self.rollouts.whole.share),
                    f"of {thousands(rate)} rollouts succeeded",
                    f"95 %: {100 * low:.1f} … {100 * high:.1f} %",
                )
            )
        tiles.append((duration(seconds), "of robot time", f"{thousands(rows)} rows"))
        if frames:
            tiles.append(
                (thousands(frames), "images", f"{counted(len(self._cameras()), 'stream')}")
            )
        tiles.append(
            (size(stored), "on the disk", f"{size(stored / max(1, len(self.episodes)))} an episode")
        )
        if self.totals.made and self.totals.elapsed_s > 0:
            tiles.append(
                (
                    f"{thousands(round(self.totals.per_hour))}/h",
                    "episodes made",
                    f"on {counted(self.totals.workers, 'worker')}",
                )
            )
        return tiles

    def _notes(self, problems: Sequence[str]) -> list[str]:
        """Returns what a reader must know before the numbers."""
        notes = [*self.contents.problems, *problems]
        if self.contents.misnamed:
            notes.append(
                f"{counted(len(self.contents.misnamed), 'folder')} copied or renamed, not "
                f"counted: {_names(sorted(self.contents.misnamed))}"
            )
        warned = Counter(text for episode in self.episodes for text in episode.warnings)
        notes += [f"{text} ({counted(n, 'episode')})" for text, n in warned.most_common(5)]
        if self.episodes and not self.contents.reports:
            notes.append(
                "There is no report.json: attempts are counted from the episodes, and items that "
                "were given up are unknown."
            )
        return notes

    def _instructions(self) -> list[tuple[str, int]]:
        return Counter(e.instruction for e in self.episodes if e.instruction).most_common(12)

    def _cameras(self) -> list[tuple[str, str, str, str, int]]:
        """Returns name, size, rate, kinds of images, and number of episodes of each camera."""
        seen = Counter(
            (name, *facts) for episode in self.episodes for name, facts in episode.cameras.items()
        )
        return [
            (name, f"{width} x {height}", f"{rate:.4g} Hz", kinds, number)
            for (name, width, height, rate, kinds), number in sorted(seen.items())
        ]

    def _groups(self, charts: Any) -> list[tuple[str, str]]:
        """Returns the episodes by task, object and robot, as charts; without parts of one value."""
        parts = {
            "task": Counter(e.task or "unknown" for e in self.episodes),
            "object": Counter(e.object_kind or "unknown" for e in self.episodes),
            "robot": Counter(", ".join(e.robots) or "unknown" for e in self.episodes),
        }
        return [
            (f"Episodes by {name}", charts.bars(counts, charts.BLUE))
            for name, counts in parts.items()
            if set(counts) - {"unknown"}
        ]

    def _success(self, charts: Any) -> list[tuple[str, str]]:
        return [
            (f"By {name}", charts.rates(groups[:20]))
            for name in ("object", "task", "robot")
            if (groups := self.rollouts.by[name])
        ]

    def _variations(self, charts: Any) -> list[tuple[str, int, str]]:
        """Returns the name, the number of episodes and a chart of each randomised value."""
        found = variation.find(self.episodes, self.motion.started)
        if self.keep == {"successes"}:  # each value would show 100 %
            return [(each.name, len(each.values), _distribution(charts, each)) for each in found]
        return [(each.name, len(each.values), charts.rates(each.groups)) for each in found]

    def _stages(self, charts: Any) -> dict[str, str]:
        done = self.rollouts
        stages = {}
        if self.totals.tried > done.sampled:
            stages["places tried"] = self.totals.tried
        if done.refusals:
            stages["starts sampled"] = done.sampled
        stages |= {
            "rollouts": done.whole.rollouts,
            "successes": done.whole.successes,
            "episodes kept": len(self.episodes),
        }
        parts = {"Yield": charts.steps(stages)}
        for title, counts, colour in (
            ("Places rejected", self.totals.redrawn, charts.GREY),
            ("Starts refused", done.refusals, charts.ORANGE),
            ("Rollouts failed", done.failures, charts.RED),
        ):
            if counts:
                parts[title] = charts.bars(counts, colour)
        return parts

    def _lengths(self, charts: Any) -> list[tuple[str, str]]:
        if not self.episodes:
            return []
        known = all(episode.rate for episode in self.episodes)
        lengths = {
            name: [e.seconds if known else e.rows for e in self.episodes if e.success == success]
            for name, success in (("success", True), ("failure", False))
        }
        lengths = {name: values for name, values in lengths.items() if values}
        parts = [("Length of episodes", charts.histogram(lengths, "seconds" if known else "rows"))]
        for tcp in self.motion.tcps.values():
            title = f"Path of the TCP of {tcp.robot}"
            parts.append((title, charts.histogram({"path": tcp.lengths}, "metres")))
        return parts

    def _robots(self, charts: Any) -> list[dict[str, Any]]:
        """Returns what moved, by robot."""
        robots: dict[str, dict[str, Any]] = {}

        def of(name: str) -> dict[str, Any]:
            empty: dict[str, Any] = {"name": name, "groups": [], "tcp": None, "gripper": None}
            return robots.setdefault(name, empty)

        for (robot, group), joints in self.motion.joints.items():
            if not joints.positions:
                continue
            numbers = motions.numbers(joints, self.most_speed)
            entry = of(robot)
            known = any(each.lower < each.upper for each in numbers)
            entry["groups"].append(
                {
                    "name": group,
                    "numbers": numbers,
                    "chart": charts.joints(numbers),
                    "known": known,
                    "violating": sorted({name for each in numbers for name in each.violating}),
                }
            )
        for tcp in self.motion.tcps.values():
            entry = of(tcp.robot)
            entry["tcp"] = {
                "chart": charts.tcp(tcp),
                "frame": tcp.frame,
                "speed": max(tcp.speeds),
                "jerk": charts.histogram({"jerk": tcp.jerks}, "root mean square of the jerk, m/s³"),
            }
        for gripper in self.motion.grippers.values():
            counts = Counter(gripper.counts)
            entry = of(gripper.robot)
            entry["gripper"] = {
                "chart": charts.gripper(gripper),
                "held": charts.histogram({"opening": gripper.held}, "opening while closed")
                if gripper.held
                else "",
                "counts": counts.most_common(6),
            }
        return list(robots.values())

    def _failures(self) -> list[dict[str, Any]]:
        """Returns the reasons for failed rollouts with their pictures, the most frequent first."""
        total = self.rollouts.failures.total()
        kept = Counter(e.end_reason for e in self.episodes if not e.success)
        # An episode that was deleted, or never counted by a command, can have a reason of its own.
        reasons = self.rollouts.failures | (kept - self.rollouts.failures)
        return [
            {
                "reason": reason,
                "number": number,
                "share": percent(number / total) if total else "-",
                "card": self.failed.get(reason),
                "episodes": [
                    e.id for e in self.episodes if not e.success and e.end_reason == reason
                ],
            }
            for reason, number in reasons.most_common(30)
        ]

    def _timing(self, charts: Any) -> str:
        spent = {stage: self.totals.seconds.get(stage, 0.0) for stage in STAGES}
        return charts.bars(spent, charts.BLUE, " s") if sum(spent.values()) else ""

    def _versions(self) -> list[tuple[str, str]]:
        seen: dict[str, Counter[str]] = {}
        for episode in self.episodes:
            for part, number in episode.versions.items():
                seen.setdefault(part, Counter())[number] += 1
        for report in self.contents.reports:
            for part, number in report.versions.items():
                seen.setdefault(part, Counter())[str(number)] += 0
        return [
            (
                part,
                ", ".join(
                    f"{number} ({counted(n, 'episode')})" if len(numbers) > 1 and n else number
                    for number, n in numbers.items()
                ),
            )
            for part, numbers in seen.items()
        ]

    def _again(self) -> dict[str, Any]:
        """Returns the run file and the commands that make, check and replay the dataset."""
        path = self.contents.dataset / "dataset.json"
        identity = ""
        try:
            report = json.loads(path.read_bytes())
            identity = report.get("identity", "") if isinstance(report, dict) else ""
        except (OSError, ValueError):
            pass
        folder = shlex.quote(str(self.contents.dataset))
        commands = [f"robocell verify {folder}"]
        if self.episodes:
            commands.append(f"robocell replay {folder} {self.episodes[0].id}")
        if identity:
            commands.insert(
                0, f"robocell generate run.yaml --output NEW --episodes {len(self.episodes)}"
            )
        return {"run": identity if isinstance(identity, str) else "", "commands": commands}


def _distribution(charts: Any, varied: variation.Varied) -> str:
    """Returns how often each value occurs."""
    texts = [value for value in varied.values.values() if isinstance(value, str)]
    if texts:
        return str(charts.bars(Counter(texts), charts.BLUE))
    numbers = [float(value) for value in varied.values.values()]
    unit = varied.name.rpartition(", ")[2] if ", " in varied.name else ""
    return str(charts.histogram({"episodes": numbers}, unit))


def _names(names: Sequence[str], most: int = MOST_NAMED) -> str:
    """Returns 'a, b, c and 5 more'."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {thousands(more)} more" if more > 0 else "")


def thousands(number: float) -> str:
    """Returns '12 345', with narrow spaces that do not break."""
    return f"{number:,.0f}".replace(",", "\u202f")
