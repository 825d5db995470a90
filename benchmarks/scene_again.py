"""P10, second half: the scene that an earlier process had, in a new process.

Peers, each in a process of its own: robocell without its cache, and the engine alone reading the
same scene, saved as XML.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import robocell
from robots import robot_files
from table import Row

ROOT = Path(__file__).resolve().parents[1]
REPETITIONS = 7
SPEC = """
import sys, time
import robocell
spec = robocell.SceneSpec(name="again", timestep=0.002, add_floor=True, add_skybox=True)
spec.robots.append(robocell.RobotSpec(config=robocell.RobotConfig.load(sys.argv[1])))
"""
COMPILE = (
    SPEC
    + """
begin = time.perf_counter()
compiled = robocell.scene.compile_scene(spec, cache=sys.argv[2] if len(sys.argv) > 2 else False)
print(1e3 * (time.perf_counter() - begin))
"""
)
SAVE_XML = (
    SPEC
    + """
robocell.Scene.build(spec).save_xml(sys.argv[2])
"""
)
LOAD_XML = """
import sys, time
import mujoco
begin = time.perf_counter()
model = mujoco.MjModel.from_xml_path(sys.argv[1])
print(1e3 * (time.perf_counter() - begin))
"""


def printed(program: str, *arguments: object) -> str:
    """What a fresh process on one core prints."""
    return subprocess.run(
        ["taskset", "--cpu-list", "0", sys.executable, "-c", program, *map(str, arguments)],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT / "python")},
        check=True,
    ).stdout


def milliseconds(program: str, *arguments: object) -> float:
    """What a fresh process on one core measures."""
    return float(printed(program, *arguments))


def rows(folder: Path) -> list[Row]:
    """Two rows per robot."""
    result = []
    for robot in robot_files():
        cache = folder / "scenes"
        shutil.rmtree(cache, ignore_errors=True)
        milliseconds(COMPILE, robot, cache)  # the earlier process
        config = robocell.RobotConfig.load(robot)
        xml = folder / f"{config.name}.xml"
        printed(SAVE_XML, robot, xml)
        again, compiled, engine = [], [], []
        for _ in range(REPETITIONS):
            again.append(milliseconds(COMPILE, robot, cache))
            compiled.append(milliseconds(COMPILE, robot))
            engine.append(milliseconds(LOAD_XML, xml))
        for peer, note in (
            (compiled, "peer: the same scene compiled"),
            (engine, "peer: the engine alone reads it as XML"),
        ):
            name = f"scene in a later process, {config.name}"
            result.append(Row(name, "ms", again, peer, note=note))
    return result
