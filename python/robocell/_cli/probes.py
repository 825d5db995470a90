"""Probes of `robocell doctor`. Each probe returns findings and never raises."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from robocell import _pykdl
from robocell._build_tree import build_folder
from robocell._extras import EXTRAS, install_command

PROBE_TIMEOUT_S = 60
GL_BACKENDS = ("egl", "osmesa")
GB = 1 << 30
ROBOTS_LISTED = 12  # more are counted
PACKAGES = ("numpy", "rich", "typer")
# The purpose of each optional part.
PURPOSES = {
    "graphics: egl": "one of the two draws `backend: gl`; `soft` needs neither",
    "graphics: osmesa": "one of the two draws `backend: gl`; `soft` needs neither",
    "menagerie": "for robots named `menagerie:...`; built-in robots do not need it",
    "extra: envs": "for robocell.gym, robocell.lerobot and compat.rcs",
    "extra: molmo-spaces": "for robocell.compat.molmo_spaces",
    "extra: plots": "for the pictures of `robocell reach`",
    "extra: sb3": "for robocell.sb3",
    "extra: teleop": "for `robocell teleop`: gamepads and SpaceMouse devices",
    "extra: torch": "for robocell.data.torch_dataset",
    "extra: web": "for pages in a browser: `robocell view --web`",
    "PyKDL": "for functions that return KDL objects",
}
GL_REMEDY = "unset MUJOCO_GL, or export MUJOCO_GL=egl"
DISK_REMEDY = "make room, or write elsewhere with `--output`"


class State(StrEnum):
    """Severity of a finding."""

    OK = "ok"
    SLOW = "slow"  # works, and there is something better that is not used
    MISSING = "optional"  # an optional part is not installed
    KNOWN = "known"  # a defect of another program that robocell knows about
    BROKEN = "broken"  # a part of robocell will fail


@dataclass(frozen=True)
class Finding:
    """One line of the report; `remedy` is the next step."""

    what: str
    state: State
    detail: str
    remedy: str = ""


def versions() -> list[Finding]:
    """Reports robocell, Python, the engine, and packages that robocell works with."""
    import robocell

    place = f"{robocell.__version__} in {Path(robocell.__file__).parent}"
    if build := build_folder():
        place += f", built in {build}"
    return [
        Finding("robocell", State.OK, place),
        Finding("python", State.OK, f"{platform.python_version()} ({sys.executable})"),
        engine(),
        *engine_defects(),
        packages(),
        *extras(),
    ]


def engine() -> Finding:
    """Reports the Python package mujoco, which scenes in Python need, and its engine."""
    import robocell
    from robocell import _core

    try:
        mujoco = _core.import_mujoco()
    except (robocell.Error, ImportError) as error:
        install = f"pip install mujoco=={robocell.__mujoco_version__}"
        remedy = GL_REMEDY if "MUJOCO_GL" in str(error) else install
        return Finding("mujoco", State.BROKEN, str(error), remedy)
    built, loaded = mujoco.__version__, mujoco.mj_versionString()
    return Finding("mujoco", State.OK, loaded if built == loaded else f"{loaded}, package {built}")


def engine_defects() -> list[Finding]:
    """Reports known defects of this engine version and robocell's workarounds."""
    import robocell

    return [
        Finding(
            f"mujoco: {defect.name}",
            State.KNOWN,
            f"{defect.what}. Guard: {defect.guard or 'none'}. Fixed in MuJoCo {defect.fixed_in}.",
        )
        for defect in robocell.diagnose.known_engine_defects()
    ]


def packages() -> Finding:
    """Reports the Python packages that robocell works with."""
    installed, missing = [], []
    for name in PACKAGES:
        try:
            installed.append(f"{name} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            missing.append(name)
    if not missing:
        return Finding("packages", State.OK, ", ".join(installed))
    remedy = f"pip install {' '.join(missing)}"
    return Finding("packages", State.BROKEN, f"no {', '.join(missing)}", remedy)


def extras() -> list[Finding]:
    """Reports the packages of each extra, which `pip install robocell` does not install."""
    found = []
    for extra, wanted in EXTRAS.items():
        missing = [name for module, name in wanted.items() if not importlib.util.find_spec(module)]
        state = State.MISSING if missing else State.OK
        detail = f"no {', '.join(missing)}" if missing else ", ".join(wanted.values())
        found.append(Finding(f"extra: {extra}", state, detail, install_command(extra)))
    return found


def graphics(root: str = "/") -> list[Finding]:
    """Probes every GL back end in a separate process: one process can use only one.

    Without one, the back end `soft` draws. `root` is the folder that the machine's files are looked
    up in.
    """
    from robocell import _core

    found = [_graphics(backend) for backend in GL_BACKENDS]
    for place, finding in enumerate(found):
        if finding.state is State.OK:  # the one that is used
            found[place] = judged(finding, root)
            return found
    state, remedy = (
        State.MISSING,
        "sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri libosmesa6",
    )
    if os.environ.get("ROBOCELL_RENDERER") == "gl":
        state = State.BROKEN
    elif advice := _core.graphics_advice("soft", root):
        state, remedy = State.SLOW, advice
    return [Finding(f.what, state, f.detail, remedy) for f in found]


def judged(graphics: Finding, root: str = "/") -> Finding:
    """Returns SLOW if software renders although the machine has a graphics card.

    `root` is the folder that the machine's files are looked up in.
    """
    from robocell import _core

    advice = _core.graphics_advice(graphics.detail, root)
    return replace(graphics, state=State.SLOW, remedy=advice) if advice else graphics


def _graphics(backend: str) -> Finding:
    code = "import robocell; print(robocell.diagnose.describe_gl())"
    what = f"graphics: {backend}"
    try:
        child = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "ROBOCELL_GL": backend},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PROBE_TIMEOUT_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return Finding(what, State.MISSING, str(error))
    lines = (child.stdout if child.returncode == 0 else child.stderr).strip().splitlines()
    # An error's text has a line of its own for each back end.
    reasons = [line.strip() for line in lines if line.strip().startswith(f"{backend}: ")]
    last = (reasons or lines or [f"ended with code {child.returncode}"])[-1]
    state = State.OK if child.returncode == 0 else State.MISSING
    return Finding(what, state, last.removeprefix("robocell.Error: "))


def video() -> list[Finding]:
    """Reports the ffmpeg program of the video writer, and its H.264 encoder."""
    program = find_ffmpeg()
    remedy = "sudo apt install ffmpeg, or set ROBOCELL_FFMPEG to the program"
    if program is None:
        return [Finding("video", State.BROKEN, "no ffmpeg found", remedy)]
    try:
        version = _ask(program, "-version").split(" Copyright")[0]
        encoders = _ask(program, "-encoders")
    except (OSError, subprocess.SubprocessError) as error:
        return [Finding("video", State.BROKEN, f"{program}: {error}", remedy)]
    if "libx264" not in encoders:
        return [Finding("video", State.BROKEN, f"{program} has no encoder libx264", remedy)]
    return [Finding("video", State.OK, f"{version} with libx264 ({program})")]


def find_ffmpeg() -> str | None:
    """Finds ffmpeg by the rule of media/ffmpeg.h."""
    if chosen := os.environ.get("ROBOCELL_FFMPEG"):
        return chosen
    return shutil.which("ffmpeg") or os.environ.get("IMAGEIO_FFMPEG_EXE") or None


def _ask(program: str, option: str) -> str:
    child = subprocess.run(
        [program, "-hide_banner", option],
        capture_output=True,
        text=True,
        errors="replace",
        timeout=PROBE_TIMEOUT_S,
        check=True,
    )
    return child.stdout


def robots() -> list[Finding]:
    """Reports where `menagerie:` models are found."""
    fetch = "robocell fetch ufactory_xarm7"
    package = importlib.util.find_spec("mujoco_menagerie")
    remedy = (fetch if package else f"pip install mujoco-menagerie && {fetch}") + (
        ", or set MENAGERIE_ROOT to a checkout of mujoco_menagerie"
    )
    try:
        from robocell import menagerie
    except ImportError as error:
        return [Finding("menagerie", State.MISSING, str(error), remedy)]
    found = menagerie.folders()
    root = os.environ.get("MENAGERIE_ROOT")
    looked = [f"MENAGERIE_ROOT={root}" if root else "MENAGERIE_ROOT (not set)", "the cache"]
    if not found:
        return [Finding("menagerie", State.MISSING, f"no robot in {' or '.join(looked)}", remedy)]
    places = sorted({str(Path(folder).parent) for folder in found.values()})
    names = ", ".join(found) if len(found) <= ROBOTS_LISTED else f"{len(found)} robots"
    return [Finding("menagerie", State.OK, f"{names} in {', '.join(places)}")]


def kdl() -> list[Finding]:
    """Reports PyKDL, which only functions that return KDL objects need."""
    try:
        module = importlib.import_module("PyKDL")
    except ImportError as error:
        return [Finding("PyKDL", State.MISSING, str(error), _pykdl.remedy())]
    return [Finding("PyKDL", State.OK, getattr(module, "__file__", "") or "")]


def machine() -> list[Finding]:
    """Cores, memory, and room for a dataset here."""
    disk = shutil.disk_usage(".")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    cores = len(os.sched_getaffinity(0))
    state = State.OK if disk.free > GB else State.BROKEN
    return [
        Finding("machine", State.OK, f"{cores} cores, {memory / GB:.1f} GB memory"),
        Finding("disk", state, f"{disk.free / GB:.1f} GB free in {Path.cwd()}", DISK_REMEDY),
    ]


PROBES: tuple[Callable[[], list[Finding]], ...] = (
    versions,
    machine,
    graphics,
    video,
    robots,
    kdl,
)
