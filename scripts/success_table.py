"""Print a table of success: kinds of tasks by robots, each with its failures by reason.

    python scripts/success_table.py [--starts 50] [--robots rc7,my_robot.yaml] [--kinds open,close]

The scripted expert gets one rollout from each start on the built-in table, without cameras. The
interval is Wilson's, with 95 %. The episodes per hour are those of one core: they follow from the
processor time of all starts after the first one, which measures the hand. A pair that does not
apply has its reason. Names and files are checked first. A pair that fails later has its error: the
others are measured, and the exit code is 1. `--page` writes the table between the marks of a page.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path

import robocell as rc

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = {
    "rc7": ROOT / "models/robots/rc7/rc7.yaml",
    "xarm7": ROOT / "examples/xarm7.yaml",
    "panda": ROOT / "examples/panda.yaml",
    "fr3_2f85": ROOT / "examples/fr3_2f85.yaml",
    "gen3_2f85": ROOT / "examples/gen3_2f85.yaml",
    "desk6": ROOT / "examples/desk6/desk6.yaml",
    "desk5": ROOT / "examples/desk6/desk5.yaml",
    "duo": ROOT / "examples/duo/duo.yaml",
    "torso": ROOT / "examples/duo/torso.yaml",
}
KINDS = (
    *("pick", "pick_and_place", "stack", "place_next_to"),
    *("open", "close", "press", "push"),
    *("insert", "sort", "wipe", "pour"),
    *("handover", "carry"),
)
TWO_ARMED = ("duo", "torso")
TWO_ARM_KINDS = ("handover", "carry")
# Their arms stand too high for the default places of other kinds.
TWO_ARM_KINDS_ONLY = ("torso",)
# The least share of successes that the soak test asks of kinds beside the nine tenths of others.
LEAST = dict.fromkeys(("insert", "sort", "wipe", "pour", *TWO_ARM_KINDS), 0.75)
MOST_REFUSED = 40  # starts in a row
MAX_STEPS = 800  # of kinds whose example has no more
BEGIN, END = "<!-- success: begin -->", "<!-- success: end -->"
HEAD = "| kind | robot | success | 95 % | episodes/h | failures |\n|---|---|---|---|---|---|"


def is_measured(kind: str, robot: str) -> bool:
    """Whether the table has a row for a pair; others are measured if they are asked for."""
    return kind in TWO_ARM_KINDS or robot not in TWO_ARM_KINDS_ONLY


def interval(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate."""
    z, rate = 1.96, successes / trials
    middle = (rate + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z * math.sqrt(rate * (1 - rate) / trials + z * z / (4 * trials * trials))
    half /= 1 + z * z / trials
    return max(0.0, middle - half), min(1.0, middle + half)


@dataclass
class Cell:
    """What became of the starts of one kind with one robot."""

    starts: int
    successes: int = 0
    refused: int = 0  # starts for which no attempt found a place
    failures: Counter[str] = field(default_factory=Counter)
    seconds: float = 0  # of processor time that a start takes, with its rollout; 0 if unknown
    why_not: str = ""  # why the kind does not apply to the robot; "" if it does
    error: str = ""  # what ended the measurement; "" if nothing did

    def row(self, kind: str, robot: str) -> str:
        """The cell as a row of the table."""
        if self.error:
            return f"| `{kind}` | {robot} | error | | | {self.error} |"
        if self.why_not:
            return f"| `{kind}` | {robot} | – | | | {self.why_not} |"
        low, high = interval(self.successes, self.starts)
        why = ", ".join(f"{count} {reason}" for reason, count in self.failures.most_common())
        rate = f"{self.successes}/{self.starts}"
        span = f"{100 * low:.0f}–{100 * high:.0f} %"
        digits = -2 if self.seconds < 3.6 else 0  # hundreds from a thousand on
        hourly = f"{round(3600 / self.seconds, digits):.0f}" if self.seconds else ""
        return f"| `{kind}` | {robot} | {rate} | {span} | {hourly} | {why} |"


def one_line(error: Exception) -> str:
    """The text of an error for a cell of the table."""
    return " ".join(str(error).split()).replace("|", "/")


def max_steps(kind: str) -> int:
    """The number of steps of a rollout: those of the kind's example, and MAX_STEPS at least."""
    example = ROOT / f"examples/tasks/{kind}.yaml"
    if not example.is_file():
        return MAX_STEPS
    return max(MAX_STEPS, rc.RunConfig.load(example).rates.max_steps)


def run_of(
    robot: str, kind: str, folder: str, objects: tuple[str, ...] = (), seed: int = 0
) -> rc.RunConfig:
    """The run of a pair. Raises Error without such a kind or file, TypeError without a field."""
    run = rc.RunConfig(run="table", robot=str(ROBOTS.get(robot, robot)), output=folder + "/out")
    run.task, run.scenes, run.seed = {"kind": kind}, {"source": "tabletop"}, seed
    if objects:
        run.task = {"kind": kind, "objects": list(objects)}
    run.rates.max_steps = max_steps(kind)
    run.keep = rc.generate.Keep.FIRST
    return run


def problems_of(kinds: Sequence[str], robots: Sequence[str], objects: tuple[str, ...]) -> list[str]:
    """What is wrong with names that were given, before anything is measured."""
    problems = []
    for kind in kinds:
        try:
            run_of("rc7", kind, "", objects)
        except (rc.Error, TypeError) as error:
            problems.append(f"--kinds: '{kind}': {one_line(error)}")
    for name in objects:
        known = [*rc.tasks.object_kinds(), *rc.tasks.object_categories()]
        if name in known or Path(name).is_file():
            continue
        try:
            rc.tasks.object_info(name)
        except rc.Error as error:
            problems.append(f"--objects: {one_line(error)}")
    for robot in robots:
        try:
            run_of(robot, "pick", "")
        except rc.Error as error:
            names = ", ".join(ROBOTS)
            problems.append(f"--robots: '{robot}': {one_line(error)}. Robots by name: {names}")
    return problems


def measure(
    robot: str, kind: str, starts: int, seed: int = 0, objects: tuple[str, ...] = ()
) -> Cell:
    """Rolls the expert out from this many starts. An error of robocell becomes the cell's."""
    try:
        return roll_out(robot, kind, starts, seed, objects)
    except rc.Error as error:
        return Cell(starts, error=f"{type(error).__name__}: {one_line(error)}")


def roll_out(robot: str, kind: str, starts: int, seed: int, objects: tuple[str, ...]) -> Cell:
    """Rolls the expert out from this many starts."""
    cell = Cell(starts)
    refusals: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        run = run_of(robot, kind, folder, objects, seed)
        run.episodes, run.max_attempts = starts, MOST_REFUSED
        try:
            rc.diagnose.check_run(run)
        except rc.SpecError as error:
            cell.why_not = one_line(error)
            return cell
        rc.generate.prepare_dataset(run)
        runner = rc.generate.Runner(run)
        began = 0.0
        for number, item in enumerate(rc.generate.make_plan(run)):
            if number == 1:
                began = time.process_time()
            result = runner.run(item)
            cell.successes += result.success
            cell.failures.update(result.failures)
            refusals.update(result.refusals)
            if result.accepted == 0:
                cell.refused += 1
                cell.failures["no start"] += 1
        if starts > 1:
            cell.seconds = (time.process_time() - began) / (starts - 1)
    if cell.refused == starts:
        cell.why_not = f"no start in {sum(refusals.values())}: {refusals.most_common(1)[0][0]}"
    return cell


def require_marks(page: Path) -> str:
    """The text of a page that has the marks."""
    if not page.is_file():
        raise SystemExit(f"{page}: is no file")
    text = page.read_text(encoding="utf-8")
    if END not in text.partition(BEGIN)[2]:
        raise SystemExit(f"{page}: has no lines {BEGIN} and {END} around its table")
    return text


def write_page(page: Path, table: str) -> None:
    """Replaces what is between the marks of a page."""
    before, rest = require_marks(page).split(BEGIN, 1)
    page.write_text(f"{before}{BEGIN}\n{table}\n{END}{rest.split(END, 1)[1]}", encoding="utf-8")


def main() -> None:
    """Prints the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=50, help="of each robot and kind")
    parser.add_argument("--robots", default=",".join(ROBOTS), help="names, or files of robots")
    parser.add_argument("--kinds", default=",".join(KINDS), help="kinds of tasks")
    parser.add_argument("--objects", default="", help="kinds of objects; default: the task's own")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--page", type=Path, help="a page whose table is replaced")
    words = parser.parse_args()
    if words.starts < 1 or words.workers < 1:
        parser.error("--starts and --workers are at least 1")
    kinds, robots, objects = (
        tuple(filter(None, text.split(","))) for text in (words.kinds, words.robots, words.objects)
    )
    if problems := problems_of(kinds, robots, objects):
        parser.error("\n".join(problems))
    if words.page:
        require_marks(words.page)
    pairs = list(product(kinds, robots))
    if robots == tuple(ROBOTS):
        pairs = [pair for pair in pairs if is_measured(*pair)]
    print(HEAD, flush=True)
    rows, errors = [], 0
    with ProcessPoolExecutor(words.workers) as pool:
        cells = [
            pool.submit(measure, robot, kind, words.starts, words.seed, objects)
            for kind, robot in pairs
        ]
        for (kind, robot), cell in zip(pairs, cells, strict=True):
            measured = cell.result()
            errors += bool(measured.error)
            rows.append(measured.row(kind, Path(robot).stem))
            print(rows[-1], flush=True)
    if words.page:
        write_page(words.page, "\n".join([HEAD, *rows]))
    if errors:
        raise SystemExit(f"{errors} of {len(rows)} pairs ended with an error")


if __name__ == "__main__":
    main()
