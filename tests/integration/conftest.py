"""The datasets that the tests of the main job share: made once, by the command that users type."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import ROOT, generate
from generated_run import GeneratedRun
from memory import resident_bytes_from_now

import robocell
from made_once import made_once
from menagerie import require_menagerie
from robocell._generation.procfs import MemoryWatch

EXAMPLE = ROOT / "examples" / "xarm7_pick.yaml"
DEMO = ROOT / "examples" / "demo.yaml"
FILMED_EPISODES = 5  # one of each kind of object: what they show takes nearly all of the time
DEMO_EPISODES = 5
BLIND = ("--set", "cameras.streams=[]")
# Drawn in a third of the time; no claim is about the size or what draws.
SMALL = ("--set", "cameras.resolution=[312,176]", "--set", "cameras.renderer=soft")


@pytest.fixture(scope="session")
def xarm7_blind_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """Twenty picks with the Menagerie's xArm7, without the cameras, which change no episode."""
    require_menagerie("ufactory_xarm7")
    return generated_once(tmp_path_factory, "xarm7_blind", EXAMPLE, *BLIND)


@pytest.fixture(scope="session")
def xarm7_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """The first of them, with two small cameras, made by two workers."""
    require_menagerie("ufactory_xarm7")
    few = ("--episodes", FILMED_EPISODES)
    return generated_once(tmp_path_factory, "xarm7_pick", EXAMPLE, *few, *SMALL)


@pytest.fixture(scope="session")
def xarm7_filmed_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """The same with the cameras of the example's file: 624x352, by OpenGL."""
    require_menagerie("ufactory_xarm7")
    few = ("--episodes", FILMED_EPISODES)
    return generated_once(tmp_path_factory, "xarm7_filmed", EXAMPLE, *few)


@pytest.fixture(scope="session")
def xarm7_whole_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """All twenty with both cameras, as the example's file says."""
    require_menagerie("ufactory_xarm7")
    return generated_once(tmp_path_factory, "xarm7_whole", EXAMPLE)


@pytest.fixture(scope="session")
def rc7_run(tmp_path_factory: pytest.TempPathFactory) -> GeneratedRun:
    """Picks with the built-in robot, whose file names its model relative to itself."""
    return generated_once(tmp_path_factory, "demo", DEMO, "--episodes", DEMO_EPISODES)


FILMED = [
    "xarm7_run",
    "rc7_run",
    pytest.param("xarm7_filmed_run", marks=pytest.mark.proof),
    pytest.param("xarm7_whole_run", marks=pytest.mark.soak),
]


@pytest.fixture(scope="session", params=FILMED)
def any_run(request: pytest.FixtureRequest) -> GeneratedRun:
    """Each of those with cameras."""
    run: GeneratedRun = request.getfixturevalue(request.param)
    return run


@pytest.fixture(
    scope="session",
    params=["xarm7_blind_run", pytest.param("xarm7_whole_run", marks=pytest.mark.soak)],
)
def twenty(request: pytest.FixtureRequest) -> GeneratedRun:
    """All episodes of the xArm7's example."""
    run: GeneratedRun = request.getfixturevalue(request.param)
    return run


def generated_once(
    tmp_path_factory: pytest.TempPathFactory, name: str, run_file: Path, *options: object
) -> GeneratedRun:
    """The dataset of a run, made by the first process that asks."""

    def make(folder: Path) -> None:
        with MemoryWatch(resident_bytes_from_now()) as watch:
            words = ("--workers", 2, *options)
            events = generate(run_file, folder / "out", *words, as_a_person=True)
        made = {"totals": events[-1]["totals"], "peak_bytes": watch.bytes}
        (folder / "counts.json").write_text(json.dumps(made))

    folder = made_once(tmp_path_factory, name, make)
    counts = json.loads((folder / "counts.json").read_text())
    return GeneratedRun(robocell.RunConfig.load(run_file), folder / "out", **counts)
