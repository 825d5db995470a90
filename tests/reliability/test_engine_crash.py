"""Models that crash the engine: they cost workers, not the run."""

from __future__ import annotations

import json
import shlex
import sys
import threading
from pathlib import Path
from typing import Any

import pytest
import storm
import yaml

import robocell
from command_line import robocell_command

CRASHING = Path(__file__).parent / "hard_models/attaches_itself.xml"


@pytest.fixture(autouse=True)
def _importable_in_children(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", ":".join(sys.path))


@pytest.fixture
def run_file(tmp_path: Path) -> Path:
    """A run of three scenes with an episode each; the second crashes the engine."""
    tabletop = Path(robocell.models.__file__).parents[2] / "models/scenes/tabletop.xml"
    for name in ("one", "two"):
        (tmp_path / f"{name}.xml").write_bytes(tabletop.read_bytes())
    crashing = tmp_path / CRASHING.name
    crashing.write_bytes(CRASHING.read_bytes())
    path = tmp_path / "run.yaml"
    run = {
        **storm.RUN,
        "scenes": {"source": "files", "files": ["one.xml", crashing.name, "two.xml"]},
        "episodes_per_scene": 1,
        "cameras": {"streams": []},
        "output": str(tmp_path / "out"),
    }
    path.write_text(yaml.safe_dump(run))
    return path


def crash(run_file: Path) -> tuple[Path, dict[str, Any]]:
    """Runs it; returns the dataset and what the report says of the item that crashes."""
    done = robocell_command("generate", str(run_file), "--workers", "2")
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    looked = "the process that looked through the run was killed by SIGSEGV: one of its models"
    assert looked in done.stderr
    dataset = run_file.parent / "out"
    result = robocell.data.verify(dataset)
    assert result.ok, str(result)
    assert result.good == ["s0000_e0000", "s0002_e0000"]

    totals = json.loads((dataset / "report.json").read_text())["commands"][0]["totals"]
    deaths = totals["deaths"]
    assert [death["item"] for death in deaths] == ["s0001_e0000"] * 3
    assert {death["reason"] for death in deaths} == {"was killed by SIGSEGV"}
    (unmade,) = totals["unmade"]
    assert unmade["id"] == "s0001_e0000"
    assert "was killed by SIGSEGV" in unmade["reason"]
    assert "try it alone: " + unmade["reproduce"] in done.stderr
    kept = json.loads((dataset / "dataset.json").read_text())["identity"]
    assert CRASHING.name in kept, "what the item was made from is kept with the dataset"
    return dataset, unmade


@pytest.mark.proof
def test_a_model_that_crashes_the_engine_loses_workers_but_not_the_run(run_file: Path):
    crash(run_file)


@pytest.mark.proof
def test_an_item_that_crashed_is_tried_alone_and_by_the_next_command(run_file: Path):
    dataset, unmade = crash(run_file)
    good = robocell.data.verify(dataset).good
    program, *arguments = shlex.split(unmade["reproduce"])
    assert program == "robocell"
    with robocell.data.DatasetLock(dataset):  # as when the run still goes on
        again = robocell_command(*arguments)
    assert again.returncode == 1, again.stderr
    assert "s0001_e0000 could not be made" in again.stderr
    assert "was killed by SIGSEGV" in again.stderr
    assert robocell.data.verify(dataset).good == good

    on = robocell_command("generate", str(run_file))
    assert on.returncode == 1, on.stderr
    assert "given up before for errors, and tried once now instead of 3 times: s0001" in on.stderr
    commands = json.loads((dataset / "report.json").read_text())["commands"]
    assert len(commands[1]["totals"]["deaths"]) == 1


def crowd(name: str, memory: str) -> robocell.SceneSpec:
    """Thirty boxes within each other in a world with so much memory."""
    spec = robocell.SceneSpec(name=name, timestep=0.002, add_floor=True, add_skybox=False)
    spec.options.jacobian = "dense"  # with any engine the same memory
    spec.base = memory
    for i in range(30):
        box = robocell.SceneObject(
            name=f"box{i}",
            shape="box",
            size=[0.02] * 3,
            rgba=[1] * 4,
            mass=0.1,
            friction=[0.8, 0.02, 0.001],
            pos=[0.02 * (i % 6), 0.02 * (i // 6), 0.03],
        )
        spec.objects.append(box)
    return spec


def test_fatal_errors_of_two_threads_become_separate_exceptions(tmp_path: Path):
    small = tmp_path / "small.xml"
    small.write_text('<mujoco><size memory="5000K"/></mujoco>')
    said: dict[str, list[str]] = {"left": [], "right": []}

    def build(name: str) -> None:
        for _ in range(20):
            with pytest.raises(robocell.EngineError) as raised:
                robocell.Scene.build(crowd(name, str(small)))
            said[name].append(str(raised.value))

    threads = [threading.Thread(target=build, args=(name,)) for name in said]
    for thread in threads:
        thread.start()
    bystander = robocell.Scene.build(
        robocell.SceneSpec(name="bystander", timestep=0.002, add_floor=True, add_skybox=False)
    )
    while any(thread.is_alive() for thread in threads):
        assert bystander.step_n(10)
    for name, messages in said.items():
        assert len(messages) == 20
        for message in messages:
            assert message.startswith(f"scene '{name}': mj_stackAlloc: out of memory")
            assert "increase <size memory" in message
