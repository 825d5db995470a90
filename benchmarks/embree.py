"""Embree's program of row P11b, and what it needs to know of a scene."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import numpy as np

SOURCE = Path(__file__).with_name("embree_peer.cc")
PROGRAM = Path(__file__).resolve().parents[1] / "build" / "bench" / "embree_peer"
HEADERS = Path("/usr/include/embree3/rtcore.h")


def embree_peer() -> Path | None:
    """The program, compiled unless it is there; None, having said why, if it cannot be."""
    if not HEADERS.exists():
        print("left out: Embree: apt-get install libembree-dev")
        return None
    if PROGRAM.exists() and PROGRAM.stat().st_mtime > SOURCE.stat().st_mtime:
        return PROGRAM
    engine = Path(sysconfig.get_path("purelib")) / "mujoco"
    library = f"libmujoco.so.{importlib.metadata.version('mujoco')}"
    PROGRAM.parent.mkdir(parents=True, exist_ok=True)
    words = ["c++", "-std=c++20", "-O3", "-march=native", "-DNDEBUG", str(SOURCE)]
    words += ["-o", str(PROGRAM)]
    engines = [
        "-isystem",
        str(engine / "include"),
        f"-L{engine}",
        f"-l:{library}",
        f"-Wl,-rpath,{engine}",
    ]
    try:
        subprocess.run([*words, *engines, "-lembree3"], capture_output=True, text=True, check=True)
    except subprocess.CalledProcessError as error:
        print(f"left out: Embree: its program does not compile:\n{error.stderr}")
        return None
    return PROGRAM


def milliseconds(model: Any, states: list[np.ndarray], view: dict[str, Any], folder: Path) -> str:
    """What the program prints of these states, seen through an orbit camera."""
    import mujoco as mj

    file, listed = folder / "scene.mjb", folder / "states.txt"
    mj.mj_saveModel(model, str(file))
    np.savetxt(listed, np.array(states))
    planes = (model.vis.map.znear, model.vis.map.zfar)
    orbit = (view["distance"], view["azimuth"], view["elevation"], *view["lookat"])
    numbers = [*(plane * model.stat.extent for plane in planes), *orbit]
    words = [str(PROGRAM), str(file), str(listed), *(str(number) for number in numbers)]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout
