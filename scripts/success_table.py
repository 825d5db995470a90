"""Print a table of success: kinds of tasks by robots, each with its failures by reason.

    python scripts/success_table.py [--starts 50] [--robots rc7,xarm7] [--kinds open,close]

The scripted expert gets one rollout from each start on the built-in table, without cameras. The
interval is Wilson's, with 95 %.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import robocell as rc

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = {
    "rc7": ROOT / "models/robots/rc7/rc7.yaml",
    "xarm7": ROOT / "examples/xarm7.yaml",
    "panda": ROOT / "examples/panda.yaml",
    "fr3_2f85": ROOT / "examples/fr3_2f85.yaml",
}
KINDS = (
    *("stack", "place_next_to", "open", "close", "press", "push"),
    *("insert", "sort", "wipe", "pour"),
)
# The least share of successes that the soak test asks of kinds beside the nine tenths of others.
LEAST = {"insert": 0.75, "sort": 0.75, "wipe": 0.75, "pour": 0.75}
MOST_REFUSED = 40  # starts in a row


@dataclass
class Cell:
    """What became of the starts of one kind with one robot."""

    starts: int
    successes: int = 0
    failures: Counter[str] = field(default_factory=Counter)

    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the rate."""
        z, n, rate = 1.96, self.starts, self.successes / self.starts
        middle = (rate + z * z / (2 * n)) / (1 + z * z / n)
        half = z * math.sqrt(rate * (1 - rate) / n + z * z / (4 * n * n)) / (1 + z * z / n)
        return middle - half, middle + half


def measure(robot: str, kind: str, starts: int, seed: int = 0) -> Cell:
    """Rolls the expert out from this many starts."""
    cell = Cell(starts)
    with tempfile.TemporaryDirectory() as folder:
        run = rc.RunConfig(run="table", robot=str(ROBOTS[robot]), output=folder + "/out")
        run.task, run.scenes, run.seed = {"kind": kind}, {"source": "tabletop"}, seed
        run.episodes, run.max_attempts, run.rates.max_steps = starts, MOST_REFUSED, 800
        run.keep = rc.generate.Keep.FIRST
        rc.generate.prepare_dataset(run)
        runner = rc.generate.Runner(run)
        for item in rc.generate.make_plan(run):
            result = runner.run(item)
            cell.successes += result.success
            cell.failures.update(result.failures)
            if result.accepted == 0:
                cell.failures["no start"] += 1
    return cell


def main() -> None:
    """Prints the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=50)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--kinds", default=",".join(KINDS))
    words = parser.parse_args()
    print("| kind | robot | success | 95 % | failures |\n|---|---|---|---|---|")
    for kind in words.kinds.split(","):
        for robot in words.robots.split(","):
            cell = measure(robot, kind, words.starts)
            low, high = cell.interval()
            why = ", ".join(f"{count} {reason}" for reason, count in cell.failures.most_common())
            rate = f"{cell.successes}/{cell.starts}"
            interval = f"{100 * low:.0f}-{100 * high:.0f} %"
            print(f"| `{kind}` | {robot} | {rate} | {interval} | {why} |", flush=True)


if __name__ == "__main__":
    main()
