"""Makes one kind of thing over and over and says what stays behind; a process of its own.

    python leaks.py scenes 1000

Prints a JSON object: the growth over the rounds after a warm-up. Of memory, what malloc has handed
out and what the process has resident (graphics drivers map memory of their own, malloc keeps
fragments); of each the least growth of all rounds, since pools grow now and then, while a leak does
so in every round.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import robocell
import robocell.gym

ROUNDS = 4
DEMO = Path(__file__).parents[2] / "examples" / "demo.yaml"
Work = Callable[[], None]


def cell() -> robocell.Scene:
    """The built-in robot on a floor."""
    spec = robocell.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = robocell.RobotConfig.load(robocell.models.robot_file("rc7"))
    spec.robots.append(robocell.RobotSpec(name="a", config=config))
    return robocell.Scene.build(spec)


def scenes(_folder: Path) -> Work:
    """Built, hooked, driven and let go."""

    def work() -> None:
        scene = cell()
        scene.on_reset(lambda context: scene.time())  # a cycle
        scene.reset()
        robot = scene.robot("a")
        robot.update()
        scene.step()

    return work


def resets(_folder: Path) -> Work:
    """Of one scene."""
    scene = cell()

    def work() -> None:
        scene.reset()
        scene.step()

    return work


def contexts(_folder: Path) -> Work:
    """Renderers, each with an OpenGL context."""
    scene = cell()

    def work() -> None:
        image = robocell.render.Renderer(scene).render(robocell.render.OrbitCamera(), 32, 24)
        assert image["rgb"].any()

    return work


def children(folder: Path) -> Work:
    """Encoders, every second one dropped before its video is finished."""
    scene, count = cell(), 0

    def work() -> None:
        nonlocal count
        count += 1
        path = folder / f"{count % 2}.mp4"
        recorder = robocell.render.VideoRecorder(scene, path, 32, 24, 30)
        recorder.record_frame()
        if count % 2:
            recorder.finish()

    return work


def errors(folder: Path) -> Work:
    """Files that cannot be read, models that cannot be compiled."""
    bad = folder / "bad.xml"
    bad.write_text("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>")
    spec = robocell.SceneSpec(name="bad", timestep=0.002, add_floor=True, add_skybox=False)
    spec.base = str(bad)

    def work() -> None:
        for fail in (
            lambda: robocell.Scene.build(spec),
            lambda: robocell.RunConfig.load(bad),
            lambda: robocell.Dataset(folder)["none"],
        ):
            try:
                fail()
            except robocell.Error:
                continue
            raise AssertionError("that should have failed")

    return work


def batches(_folder: Path) -> Work:
    """Copies of an environment, whose model is frozen and measured once."""
    config = robocell.gym.pick_cube_config()

    def work() -> None:
        robocell.gym.VectorGymEnv(config, num_envs=2, threads=2).close()

    return work


KINDS = {work.__name__: work for work in (scenes, resets, contexts, children, errors, batches)}


class MallInfo(ctypes.Structure):
    """glibc's struct mallinfo2."""

    _names = "arena ordblks smblks hblks hblkhd usmblks fsmblks used free keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in _names.split()]


def heap_bytes() -> int:
    """What malloc has handed out."""
    read = ctypes.CDLL(None).mallinfo2
    read.restype = MallInfo
    info = read()
    return int(info.used + info.hblkhd)


def counts() -> dict[str, int]:
    """What this process holds."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)  # what is freed goes back to the system
    task = Path(f"/proc/self/task/{os.getpid()}/children")
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return {
        "files": len(os.listdir("/proc/self/fd")),
        "threads": len(os.listdir("/proc/self/task")),
        "children": len(task.read_text().split()),
        "heap": heap_bytes(),
        "resident": pages * os.sysconf("SC_PAGE_SIZE"),
    }


def growth(kind: str, times: int) -> dict[str, int]:
    """Returns what stays behind: bytes of memory per object, numbers of everything else."""
    with tempfile.TemporaryDirectory() as folder:
        work = KINDS[kind](Path(folder))
        each = max(times // ROUNDS, 1)
        for _ in range(each):
            work()
        first = before = counts()
        least = {"heap": sys.maxsize, "resident": sys.maxsize}
        for _ in range(ROUNDS):
            for _ in range(each):
                work()
            after = counts()
            least = {name: min(least[name], after[name] - before[name]) for name in least}
            before = after
    grown = {name: before[name] - first[name] for name in ("files", "threads", "children")}
    per_thing = {f"{name}_each": round(least[name] / each) for name in least}
    return {"times": each * ROUNDS, **grown, **per_thing}


if __name__ == "__main__":
    print(json.dumps(growth(sys.argv[1], int(sys.argv[2]))))
