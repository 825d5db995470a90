"""P16: houses: compiling, the same in a later process, reset, and pick episodes per hour.

`robocell make-houses` writes the houses; the same seed gives the same bytes.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from episodes import ROOT, environment, episodes_of
from scene_again import milliseconds
from table import Row

HOUSES = 3
REPETITIONS = 5
RUN = ROOT / "benchmarks" / "house_pick.yaml"
COMPILE = """
import sys, time
import robocell as rc
spec = rc.SceneSpec(base=sys.argv[1], timestep=0.002)
spec.robots.append(rc.RobotSpec(config=rc.RobotConfig.load(rc.models.robot_file("rc7"))))
begin = time.perf_counter()
compiled = rc.scene.compile_scene(spec, cache=sys.argv[2] if sys.argv[2] else False)
taken = time.perf_counter() - begin
"""
TIME = COMPILE + "print(1e3 * taken)"
RESET = (
    COMPILE
    + """
import statistics
scene = rc.Scene.from_compiled(compiled)
scene.reset(seed=0)
times = []
for seed in range(50):
    for _ in range(10):
        scene.step()
    begin = time.perf_counter()
    scene.reset(seed=seed)
    times.append(time.perf_counter() - begin)
print(1e3 * statistics.median(times))
"""
)


def rows(folder: Path) -> list[Row]:
    """Scenes of houses, and episodes in them."""
    own = folder / "houses"
    shutil.rmtree(own, ignore_errors=True)
    make = ["make-houses", str(own), "-n", str(HOUSES)]
    subprocess.run(
        [sys.executable, "-m", "robocell", *make],
        env=environment(folder / "byte_code"),
        capture_output=True,
        check=True,
    )
    return [*_scenes(own, folder / "house_scenes"), *_episodes(folder)]


def house_files(folder: Path) -> list[Path]:
    """The houses of a folder, without their ceilings."""
    files = sorted(folder.rglob("*.xml"))
    return [file for file in files if _is_house(file, files)]


def _is_house(file: Path, files: list[Path]) -> bool:
    return file.with_name(f"{file.stem}_ceiling.xml") in files


def _scenes(own: Path, cache: Path) -> list[Row]:
    cold, later, resets = list[float](), list[float](), list[float]()
    for _ in range(REPETITIONS):
        for file in house_files(own):
            shutil.rmtree(cache, ignore_errors=True)
            cold.append(milliseconds(TIME, file, ""))
            milliseconds(TIME, file, cache)  # the earlier process
            later.append(milliseconds(TIME, file, cache))
            resets.append(milliseconds(RESET, file, cache))
    note = f"rc7 in {HOUSES} generated houses, one core"
    return [
        Row("house compiled, rc7", "ms", cold, note=note),
        Row("house in a later process, rc7", "ms", later, note=note),
        Row("house reset, rc7", "ms", resets, note=f"{note}; RoboCasa publishes 3390 to 4350 ms"),
    ]


def _episodes(folder: Path) -> list[Row]:
    variants = {
        "without cameras": ["--set", "cameras.streams=[]", "--episodes", "40"],
        "with two cameras 320x240": ["--episodes", "10"],
    }
    values: dict[str, list[float]] = {name: [] for name in variants}
    for repetition in range(REPETITIONS):
        for name, options in variants.items():
            rate = episodes_of(RUN, folder / "house_episodes", repetition, options)
            values[name].append(rate)
    note = "20 built-in houses, one worker, one core, start-up included; a user of MolmoSpaces "
    note += "reports 270 a day with four workers"
    return [
        Row(f"pick episodes in houses, rc7, {name}", "1/h", rates, better="higher", note=note)
        for name, rates in values.items()
    ]
