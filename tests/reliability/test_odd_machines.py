"""Machines that are unlike those of the developers: the same episodes come out, or an error.

Each run makes the episodes that an ordinary run made, and is held against its bytes.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from disks import bound_by_permissions, quick_folder
from ledger import BUILD

import robocell
from command_line import environment_with, write_run
from contents import contents
from made_once import made_once
from robocell.data import derive

TINY = {
    "episodes_per_scene": 1,
    "cameras": {"resolution": [32, 24], "renderer": {"backend": "soft"}, "streams": []},
}


def generated(folder: Path, wrap: Sequence[str] = (), **environment: str) -> dict[str, bytes]:
    """The bytes that a run makes in a folder; `wrap` is put before the command."""
    command = [*wrap, sys.executable, "-m", "robocell", "generate", str(write_run(folder, **TINY))]
    run = subprocess.run(
        [*command, "--workers", "1"],
        env=environment_with(environment),
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert robocell.data.verify(folder / "out").ok
    return contents(folder / "out")


@pytest.fixture(scope="module")
def ordinary(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = made_once(tmp_path_factory, "ordinary_machine", lambda folder: generated(folder))
    return contents(folder / "out")


def shim(name: str) -> dict[str, str]:
    return {"LD_PRELOAD": str(BUILD / f"lib{name}.so")}


@pytest.mark.proof
def test_an_odd_machine_makes_the_same_episodes(ordinary: dict[str, bytes], tmp_path: Path):
    """No home, an umask for one, a long path in several scripts, a jumping clock."""
    name = "a b'ü\N{GREEK SMALL LETTER ALPHA}漢字 🤖 $(touch injected) "
    folder = tmp_path
    while len(os.fsencode(folder)) < 240:
        folder = folder / name[: 240 - len(os.fsencode(folder))].rstrip()
    folder.mkdir(parents=True)
    umask = ["sh", "-c", 'umask 077; exec "$@"', "sh"]
    odd = {"HOME": "", "XDG_CACHE_HOME": "", "LANG": "C", "LC_ALL": "C", **shim("odd_clock")}
    assert generated(folder, umask, **odd) == ordinary
    assert not [path for path in tmp_path.rglob("*") if path.name == "injected"]
    for path in (folder / "out").rglob("*"):
        assert path.stat().st_mode & 0o077 == 0, f"{path} is open to others"


@pytest.mark.proof
@pytest.mark.parametrize("processors", [1, 128])
def test_any_number_of_processors_makes_the_same_episodes(
    processors: int, ordinary: dict[str, bytes], tmp_path: Path
):
    if processors == 1:
        assert generated(tmp_path, ["taskset", "-c", "0"]) == ordinary
    else:
        assert generated(tmp_path, **shim("many_processors")) == ordinary


@pytest.mark.proof
def test_a_home_that_cannot_be_written_costs_a_cache(ordinary: dict[str, bytes], tmp_path: Path):
    home = tmp_path / "home"
    home.mkdir(mode=0o555)
    found = {"HOME": str(home), "XDG_CACHE_HOME": ""}
    assert generated(tmp_path, bound_by_permissions([]), **found) == ordinary
    assert not list(home.iterdir())


ODD_HOST = "not a name; \N{SNOWMAN}%s\"'"
IN_NAMESPACES = """
import os, socket, subprocess, sys
subprocess.run("mount -t tmpfs -o size=4k shm /dev/shm".split(), check=True)
socket.sethostname(sys.argv[1])
os.execvp(sys.argv[2], sys.argv[2:])
"""


@pytest.mark.proof
def test_no_shared_memory_and_an_odd_name_make_the_same_episodes(
    ordinary: dict[str, bytes], tmp_path: Path
):
    for user in ([], ["--map-root-user"]):
        unshare = ["unshare", *user, "--mount", "--uts"]
        wrap = [*unshare, sys.executable, "-c", IN_NAMESPACES, ODD_HOST]
        if subprocess.run([*wrap, "true"], capture_output=True, check=False).returncode == 0:
            break
    else:
        wrap = []  # no namespaces here
    assert generated(tmp_path, wrap) == ordinary
    [episode] = robocell.Dataset(tmp_path / "out")
    run = json.loads((episode.folder / "episode.json").read_text())["run"]
    assert not wrap or run["host"] == ODD_HOST


# Python's own programs never set the locale of numbers; a program that embeds robocell may.
WITH_COMMAS = """
import locale, sys
locale.setlocale(locale.LC_ALL, sys.argv[1])
assert locale.localeconv()["decimal_point"] == sys.argv[2]
import numpy as np, robocell as rc
robot = rc.RobotSpec(name="a", path="rc7")
robot.pos[2] = 0.75
spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False, robots=[robot])
scene = rc.Scene.build(spec)
print(spec.to_yaml())
print(scene.model.body_pos.tolist(), scene.model.opt.timestep)
run = rc.RunConfig.load(sys.argv[3])
print(run.to_yaml())
try:
    rc.RunConfig.load(sys.argv[3], ["rates.policy_hz=30", "rates.policy_ms=0"])
except rc.Error as error:
    print(error)
"""


@pytest.mark.proof
def test_numbers_are_the_same_where_commas_divide_them(tmp_path: Path):
    if not shutil.which("localedef"):
        pytest.skip("no localedef here")
    locales = tmp_path / "locales"
    locales.mkdir()
    made = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(locales / "de_DE.UTF-8")]
    if subprocess.run(made, capture_output=True, check=False).returncode > 1:
        pytest.skip("no sources of locales here")
    run = write_run(tmp_path, rates={"policy_ms": 62.5, "control_ms": 2.5, "sim_ms": 2.5})

    def said(locale: str, point: str) -> str:
        program = subprocess.run(
            [sys.executable, "-c", WITH_COMMAS, locale, point, str(run)],
            env=environment_with({"LOCPATH": str(locales)}),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert program.returncode == 0, program.stderr
        return program.stdout

    assert said("de_DE.UTF-8", ",") == said("C", ".")


def test_a_result_on_another_disk_is_copied(tmp_path: Path):
    columns = {"x": robocell.data.ColumnSpec()}
    with robocell.data.EpisodeWriter(tmp_path / "one", "e0", columns) as episode:
        episode.add_row({"x": 1.5})
        episode.commit(success=True)
    with quick_folder(tmp_path) as other:
        merged = derive.merge([tmp_path / "one"], other / "merged")
        is_another = other.stat().st_dev != tmp_path.stat().st_dev
        assert merged.copied == (2 if is_another else 0)
        assert robocell.data.verify(other / "merged").ok
