"""`robocell generate --engine ray`."""

from __future__ import annotations

import json
import os
import subprocess
import sysconfig
from pathlib import Path

import pytest

import robocell
from command_line import REPOSITORY, refused, robocell_command, write_run
from contents import contents
from test_learning import environment_with

EPISODES = 16


def test_without_ray_the_error_names_the_command_that_installs_it(tmp_path: Path):
    run = write_run(tmp_path)
    message = refused("generate", run, "--engine", "ray")
    assert "--engine ray needs the package ray, which is not installed: pip install" in message
    assert "--shard i/N splits a run over machines" in message
    assert not (tmp_path / "out").exists()


def test_options_of_a_cluster_belong_to_ray(tmp_path: Path):
    for option in (["--fetch"], ["--address", "10.0.0.1:6379"]):
        assert "add --engine ray" in refused("generate", write_run(tmp_path), *option)
    assert "add --dry-run" in refused("generate", write_run(tmp_path), "--cores", 320)


# Ray is downloaded when it is run for the first time.
@pytest.mark.soak
@pytest.mark.parametrize("fetch", [False, True])
def test_a_killed_machine_loses_nothing(tmp_path: Path, fetch: bool):
    python = environment_with("ray==2.60.0")
    run = write_run(tmp_path, episodes_per_scene=EPISODES)
    done = robocell_command("generate", run, "--output", tmp_path / "local", "--workers", 2)
    assert done.returncode == 0, done.stderr
    paths = [str(REPOSITORY / "python"), sysconfig.get_path("platlib")]
    output = tmp_path / "cluster"
    program = Path(__file__).with_name("ray_cluster.py")
    options = ["--output", output, *(["--fetch"] if fetch else [])]
    result = subprocess.run(
        [python, program, "generate", run, *options],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True, text=True, check=False, timeout=1800,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr + result.stdout
    totals = json.loads(result.stdout.splitlines()[-1])["totals"]
    assert (totals["made"], totals["unmade"]) == (EPISODES, 0)
    assert totals["deaths"] >= 1, "a machine was killed at work"
    assert contents(output) == contents(tmp_path / "local")
    assert robocell.data.verify(output).ok
    # Whichever call found the machine gone.
    assert "was lost: " in (output / "report.json").read_text()
