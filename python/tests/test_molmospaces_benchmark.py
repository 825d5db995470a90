"""Benchmarks in MolmoSpaces' schema have what its models require, and robocell reads them back."""

from __future__ import annotations

import json
import subprocess
import venv
from pathlib import Path
from typing import Any

import pytest

import robocell
from command_line import REPOSITORY, robocell_command, write_run
from robocell import benchmark

# Fields of EpisodeSpec, RobotSpec, BaseTaskSpec, PickTaskSpec and LanguageSpec without a default.
REQUIRED: dict[str, dict[str, type]] = {
    "": {
        "house_index": int,
        "scene_dataset": str,
        "robot": dict,
        "img_resolution": list,
        "task": dict,
        "language": dict,
    },
    "robot": {"robot_name": str, "init_qpos": dict},
    "task": {
        "task_cls": str,
        "robot_base_pose": list,
        "pickup_obj_name": str,
        "pickup_obj_start_pose": list,
    },
    "language": {"task_description": str},
}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("molmospaces")
    write_run(folder, cameras={"streams": []})
    out = folder / "picks.json"
    said = robocell_command(
        "benchmark", folder / "run.yaml", out, "-n", 2, "--format", "molmospaces"
    )
    assert said.returncode == 0, said.stderr
    return out


def test_episodes_have_the_fields_that_molmospaces_requires(file: Path):
    episodes = json.loads(file.read_text())
    assert len(episodes) == 2
    for episode, start in zip(episodes, benchmark.load(file).starts, strict=True):
        for part, fields in REQUIRED.items():
            for name, kind in fields.items():
                assert type((episode[part] if part else episode)[name]) is kind, name
        state = start["state"]
        assert episode["language"]["task_description"] == start["instruction"]
        assert episode["robot"]["init_qpos"]["arm"] == state["robots/rc7/arm/qpos"]
        x, y, z, qx, qy, qz, qw = state["objects/target/pose"]
        poses = episode["scene_modifications"]["object_poses"]
        assert poses["target"] == [x, y, z, qw, qx, qy, qz]
        assert episode["task"]["pickup_obj_start_pose"] == poses["target"]
        assert len(episode["task"]["robot_base_pose"]) == 7
        assert episode["task_relevant_objects"] == ["target"]


@pytest.mark.proof
def test_the_same_starts_are_evaluated_as_of_a_benchmark_of_robocell(file: Path, tmp_path: Path):
    own = benchmark.create(file.parent / "run.yaml", tmp_path / "own.json", episodes=2)
    made = benchmark.load(file)
    assert (made.starts, made.files, made.task) == (own.starts, own.files, own.task)
    result = benchmark.evaluate(file, "expert", output=tmp_path / "expert", cameras=False)
    assert result.outcomes.keys() == {start["id"] for start in made.starts}


def test_an_edited_start_is_refused(file: Path, tmp_path: Path):
    episodes = json.loads(file.read_text())
    episodes[1]["scene_modifications"]["object_poses"]["target"][0] += 0.1
    edited = tmp_path / "edited.json"
    edited.write_text(json.dumps(episodes))
    with pytest.raises(robocell.IoError, match="damaged or was edited"):
        benchmark.load(edited)


@pytest.mark.parametrize(
    ("content", "error", "said"),
    [
        (
            [{"scene_dataset": "procthor-10k", "robot": {"robot_name": "franka_droid"}}],
            robocell.ArgumentError,
            "has 1 episodes of MolmoSpaces: scenes procthor-10k, robots franka_droid",
        ),
        ([], robocell.ArgumentError, "0 episodes"),
        ([1], robocell.IoError, "no list of episodes"),
        ([{"robocell": {}}], robocell.IoError, "damaged"),
    ],
)
def test_other_lists_are_explained(content: Any, error: type[Exception], said: str, tmp_path: Path):
    (tmp_path / "other.json").write_text(json.dumps(content))
    with pytest.raises(error, match=said):
        benchmark.load(tmp_path / "other.json")


def test_a_misspelt_schema_is_named(file: Path, tmp_path: Path):
    with pytest.raises(robocell.ArgumentError, match=r"no schema 'molmo'.*molmospaces"):
        benchmark.create(file.parent / "run.yaml", tmp_path / "a.json", schema="molmo")


READ = """
import importlib.util, sys
from pathlib import Path
[site] = [each for each in sys.path if (Path(each) / "molmo_spaces").is_dir()]
path = Path(site) / "molmo_spaces/evaluation/benchmark_schema.py"
spec = importlib.util.spec_from_file_location("benchmark_schema", path)
schema = importlib.util.module_from_spec(spec)
sys.modules["benchmark_schema"] = schema
spec.loader.exec_module(schema)
import json
for entry in json.loads(Path(sys.argv[1]).read_text()):
    episode = schema.EpisodeSpec.model_validate(entry)
    schema.PickTaskSpec.model_validate(episode.task)
    print(episode.house_index, episode.language.task_description)
"""


@pytest.mark.soak
def test_molmospaces_own_models_accept_the_episodes(file: Path):
    folder = REPOSITORY / "build" / "soak" / "molmo_spaces"
    python = folder / "bin" / "python"
    if not (folder / "ready").exists():
        venv.create(folder, with_pip=True, clear=True)
        install = [python, "-I", "-m", "pip", "install", "-q"]
        subprocess.run([*install, "--no-deps", "molmo-spaces==0.2.9"], check=True)
        subprocess.run([*install, "pydantic==2.12.5", "numpy<3"], check=True)
        (folder / "ready").touch()
    said = subprocess.run(
        [python, "-I", "-c", READ, file], capture_output=True, text=True, check=False
    )
    assert said.returncode == 0, said.stderr
    assert said.stdout.count("pick up the ") == 2
