"""Libraries learn in vector environments: the examples of examples/learning."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sysconfig
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "learning"


def test_a_cloned_policy_picks_up_cylinders_that_lie_where_it_saw_none():
    """Part of `make test`, so that what breaks datasets or experts shows at once."""
    spec = importlib.util.spec_from_file_location("clone", EXAMPLES / "clone.py")
    assert spec is not None
    assert spec.loader is not None
    clone = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(clone)
    assert clone.main() >= 0.7
    text = (EXAMPLES / "clone.py").read_text()
    assert "[:" not in text


def environment_with(package: str) -> Path:
    """The interpreter of an environment of its own; made when it is not there."""
    folder = ROOT / "build" / "soak" / package.split("==")[0].replace("-", "_")
    python, ready = folder / "bin" / "python", folder / "ready"
    if not ready.exists():
        venv.create(folder, with_pip=True, clear=True)
        pins = [ROOT / "scripts" / name for name in ("requirements.txt", "constraints.txt")]
        constraints = [part for file in pins for part in ("--constraint", file)]
        # -I: packages elsewhere on PYTHONPATH would count as installed
        subprocess.run(
            [python, "-I", "-m", "pip", "install", "-q", package, *constraints], check=True
        )
        ready.touch()
    return python


# Gigabytes are downloaded when it is run for the first time.
@pytest.mark.soak
def test_ppo_learns_to_come_near_the_cube():
    python = environment_with("stable-baselines3==2.9.2")
    # robocell, and what it needs, are where this interpreter has them.
    paths = [str(ROOT / "python"), sysconfig.get_path("platlib")]
    run = subprocess.run(
        [python, EXAMPLES / "ppo.py", "40000"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True, text=True, check=False, timeout=1800,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    rewards = re.search(r"reward of an episode: (\S+) before, (\S+) after (\d+) steps", run.stdout)
    assert rewards is not None, run.stdout
    before, after, steps = map(float, rewards.groups())
    assert steps >= 40_000
    assert after > 2 * before > 0
