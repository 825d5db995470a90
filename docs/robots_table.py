"""Writes docs/robots_table.md: twenty picks with every robot that has a run file in examples/.

    .venv/bin/python docs/robots_table.py

Takes some minutes, so `make docs` does not run it. Robots whose models are not on this machine are
left out of the table, and named.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import yaml

import robocell as rc
from robocell._cli.robot_scene import load_robot

DOCS = Path(__file__).resolve().parent
EXAMPLES = DOCS.parent / "examples"
PAGE = DOCS / "robots_table.md"
EPISODES = 20
WORKERS = 2

HEAD = f"""# Robots that pick

{EPISODES} picks with each robot that has a run file in [`examples/`](../examples/), from that file
without cameras, on {WORKERS} workers and {{cores}} CPU cores. The expert is the same for all.
Reproduce it with
```
.venv/bin/python docs/robots_table.py
```

- **success**: episodes made, of the rollouts that were begun.
- **accepted**: starts that the sampler took, of those it drew.
- **episode**: mean length in simulated seconds.
- **episodes/h**: by the clock on the wall in one short run; other work on the machine lowers it
  (its load was {{load:.0f}}, of which {WORKERS} are these).
- **gripper**: distance of the fingers, closed and open, as `robocell gripper-range` prints it.

| robot | run file | success | accepted | episode | episodes/h | gripper |
|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Row:
    """One robot's line and picture."""

    robot_file: Path
    run_file: Path
    totals: dict[str, float]
    mean_seconds: float
    gripper: tuple[float, float]

    def line(self) -> str:
        """In Markdown."""
        t = self.totals
        cells = (
            _link(self.robot_file),
            _link(self.run_file),
            _share(t["made"], t["accepted"]),
            _share(t["accepted"], t["attempts"]),
            f"{self.mean_seconds:.1f} s",
            f"{t['per_hour']:.0f}",
            f"{self.gripper[0]:.3f} to {self.gripper[1]:.3f} m",
        )
        return f"| {' | '.join(cells)} |"

    def picture(self) -> str:
        """In Markdown; drawn by docs/make_check_picture.py."""
        name = self.robot_file.stem
        return f"### {name}\n![{name} as `robocell check` draws it](check_{name}.png)\n"


def _link(file: Path) -> str:
    return f"[{file.stem}]({os.path.relpath(file, DOCS)})"


def _share(part: float, whole: float) -> str:
    return f"{100 * part / whole:.0f} % of {whole:.0f}"


def run_files() -> list[Path]:
    """The run files of examples/, the built-in robot's first."""
    found = [
        file for file in EXAMPLES.glob("*.yaml") if "robot" in yaml.safe_load(file.read_text())
    ]
    return sorted(found, key=lambda file: (file.stem != "demo", file.stem))


def measure(run_file: Path) -> Row | None:
    """Makes the episodes in a scratch folder. Reports a command that fails and returns None."""
    command = [sys.executable, "-m", "robocell", "generate", str(run_file), "--progress", "jsonl"]
    options = ["--workers", str(WORKERS), "--episodes", str(EPISODES)]
    for field in (f"episodes_per_scene={EPISODES}", "cameras.streams=[]"):
        options += ["--set", field]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [*command, *options, "--output", str(Path(folder) / "dataset")],
            check=False,
            capture_output=True,
            text=True,
        )
    if done.returncode:
        print(f"{run_file.stem}: left out: {done.stderr.strip()}")
        return None
    events = [json.loads(line) for line in done.stdout.splitlines()]
    rows = [event["result"]["rows"] for event in events if event["event"] == "episode"]
    run = rc.RunConfig.load(run_file)
    robot_file = (run_file.parent / yaml.safe_load(run_file.read_text())["robot"]).resolve()
    return Row(
        robot_file,
        run_file,
        events[-1]["totals"],
        sum(rows) / len(rows) * run.rates.policy_period(),
        load_robot(robot_file).robot.gripper.inter_finger_dist_range,
    )


def main() -> None:
    """Measures all and writes the page."""
    rows = []
    for run_file in run_files():
        if row := measure(run_file):
            print(row.line(), flush=True)
            rows.append(row)
    head = HEAD.format(cores=len(os.sched_getaffinity(0)), load=os.getloadavg()[1])
    lines = "\n".join(row.line() for row in rows)
    pictures = "\n".join(row.picture() for row in rows)
    PAGE.write_text(f"{head}{lines}\n\n{pictures}")
    print(PAGE)


if __name__ == "__main__":
    main()
