"""Libraries learn in vector environments: the examples of examples/learning."""

from __future__ import annotations

import ast
import importlib.util
import os
import re
import subprocess
import sysconfig
import time
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "learning"


# A few demonstrations are a part of `make test`: all of the example runs, and learns too little to
# be measured. `make check` runs it with more, and as it is.
@pytest.mark.parametrize(
    ("episodes", "trials", "least", "longest_s"),
    [
        (6, 3, 0.0, 20),
        pytest.param(40, 15, 0.5, 40, marks=pytest.mark.proof),
        pytest.param(100, 40, 0.7, 100, marks=pytest.mark.proof),
        pytest.param(200, 50, 0.7, 180, marks=pytest.mark.proof),
    ],
)
def test_a_cloned_policy_picks_cylinders_at_unseen_places(
    episodes: int,
    trials: int,
    least: float,
    longest_s: float,
    capsys: pytest.CaptureFixture[str],
):
    spec = importlib.util.spec_from_file_location("clone", EXAMPLES / "clone.py")
    assert spec is not None
    assert spec.loader is not None
    clone = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(clone)
    began = time.process_time()
    assert clone.main(episodes, trials, served=3) >= least
    said = capsys.readouterr().out
    assert re.search(r"in the environment: picked up \d+ of \d+, 95 % interval \d+% \.\.\.", said)
    assert re.search(r"through a server: picked up \d of 3, 95 % interval \d+% \.\.\. ", said)
    assert time.process_time() - began < longest_s, "seconds of the processor, as the page promises"
    assert indices_of((EXAMPLES / "clone.py").read_text()) == []


def indices_of(text: str) -> list[str]:
    """What a program takes by number or slice: columns of a dataset have names."""
    found = [each for each in ast.walk(ast.parse(text)) if isinstance(each, ast.Subscript)]
    numbers = (ast.Slice, ast.Tuple, ast.UnaryOp)
    return [
        ast.unparse(each)
        for each in found
        if isinstance(each.slice, numbers)
        or (isinstance(each.slice, ast.Constant) and isinstance(each.slice.value, int))
    ]


def test_index_arithmetic_is_found():
    assert indices_of("a[0], b[3:], c[:, 1], d[-1], e['x'], f[name]") == [
        "a[0]",
        "b[3:]",
        "c[:, 1]",
        "d[-1]",
    ]


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
def test_ppo_learns_to_approach_the_cube():
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


# torch and what it brings are downloaded when it is run for the first time.
@pytest.mark.soak
def test_a_network_learns_from_images_and_is_evaluated_through_a_server():
    python = environment_with("torch==2.10.0")
    paths = [str(ROOT / "python"), sysconfig.get_path("platlib")]
    run = subprocess.run(
        [python, EXAMPLES / "image_clone.py"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths), "CUDA_VISIBLE_DEVICES": ""},
        capture_output=True, text=True, check=False, timeout=3600,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    said = r"picked up (\d+) of 30 cylinders .*: \d+%, 95 % interval \d+% \.\.\. \d+%"
    found = re.search(said, run.stdout)
    assert found is not None, run.stdout
    assert int(found[1]) >= 3, "one of six after 40 demonstrations and 12 epochs"
