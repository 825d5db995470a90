"""The environment of an export, and the package by which LeRobot finds it."""

from __future__ import annotations

import importlib
import json
import os
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import gymnasium
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from gymnasium.utils.env_checker import check_env

import robocell
from command_line import RC7
from exported import three_episodes
from lerobot_venv import lerobot_python
from robocell._cli.robot_scene import load_robot
from robocell.export import export_dataset
from robocell.lerobot import ExportedEnv

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "packages" / "lerobot_env_robocell"
ROBOT = "robots/rc7"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


def exported(dataset: robocell.Dataset, out: Path, **options: Any) -> dict[str, Any]:
    """The rows of the first episode in a LeRobot dataset."""
    export_dataset(dataset, out, "lerobot-v2.1", episodes=["0"], cameras=[], **options)
    table = pq.read_table(out / "data/chunk-000/episode_000000.parquet")
    return {
        name: np.array(table[name].to_pylist(), np.float32)
        for name in ("observation.state", "action")
    }


@pytest.mark.parametrize("options", [{}, {"actions": "tcp_displacement"}, {"mapping": True}])
def test_exported_actions_give_the_exported_states(
    dataset: robocell.Dataset, tmp_path: Path, options: dict[str, Any]
):
    if "mapping" in options:
        options = {"mapping": tmp_path / "mapping.yaml"}
        options["mapping"].write_text(
            yaml.safe_dump(
                {
                    "gripper": {"open": -1, "closed": 3},
                    "features": {
                        "action": [
                            {"column": f"{ROBOT}/action/arm", "times": 2},
                            f"{ROBOT}/action/gripper",
                        ]
                    },
                }
            )
        )
    rows = exported(dataset, tmp_path / "out", **options)
    env = ExportedEnv(dataset, cameras=[], **options)
    fk = load_robot(RC7).robot.kinematics.fk

    def seen(state: Any) -> Any:
        """What the actions determine: displacements leave the elbow of seven joints free."""
        if options.get("actions") != "tcp_displacement":
            return state.astype(float)
        return np.append(fk(state[:7]).matrix, state[7])

    near = 0.01 if options.get("actions") == "tcp_displacement" else 1e-4
    observation, info = env.reset(seed=0)
    assert info["is_success"] is False
    for state, action in zip(rows["observation.state"], rows["action"], strict=True):
        assert env.observation_space.contains(observation)
        assert np.allclose(seen(observation["agent_pos"]), seen(state), atol=near)
        observation, _, terminated, truncated, info = env.step(action)
        assert "is_success" in info
        if terminated or truncated:
            break
    assert info["is_success"], "the recorded actions do the task again"
    env.close()


def test_images_are_those_of_the_export(dataset: robocell.Dataset):
    env = ExportedEnv(dataset, max_episode_steps=2)
    observation, _ = env.reset(seed=0)
    assert list(observation["pixels"]) == ["wrist", "exo"]
    assert observation["pixels"]["exo"].shape == (48, 64, 3)
    assert np.array_equal(env.render(), observation["pixels"]["wrist"])
    assert env.metadata["render_fps"] == 8
    assert env.task_description == dataset[0].metadata["instruction"]
    held = np.concatenate([dataset[0][f"{ROBOT}/action/arm"][0], [1]]).astype(np.float32)
    assert not env.step(held)[3]
    assert env.step(held)[3], "truncated after max_episode_steps"
    with pytest.raises(robocell.ArgumentError, match="an action has 8 numbers, got the shape"):
        env.step(held[:7])


def test_gymnasium_accepts_it(dataset: robocell.Dataset):
    check_env(ExportedEnv(dataset, cameras=["exo"]).unwrapped, skip_render_check=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"preset": "droid"}, "has no 'observation.state', which LeRobot's environments need"),
        ({"preset": "aloha"}, "brings images to (640, 480); environments show them as they are"),
        ({"max_episode_steps": 0}, "max_episode_steps is 0; at least 1"),
        ({"cameras": ["top"]}, "no camera 'top'"),
    ],
)
def test_what_it_cannot_be_is_named(
    dataset: robocell.Dataset, options: dict[str, Any], message: str
):
    with pytest.raises(robocell.Error) as raised:
        ExportedEnv(dataset, **options)
    assert message in str(raised.value)


def test_parts_of_columns_are_refused(dataset: robocell.Dataset, tmp_path: Path):
    mapping = tmp_path / "mapping.yaml"
    content = {"observation.state": [{"column": f"{ROBOT}/tcp_pose", "as": "position"}]}
    mapping.write_text(yaml.safe_dump({"features": content}))
    with pytest.raises(robocell.ArgumentError, match="takes the part 'position'"):
        ExportedEnv(dataset, mapping=mapping)


@pytest.fixture
def plugin(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The package, imported beside the few names of LeRobot that it uses."""
    chosen: dict[str, type] = {}

    class EnvConfig:
        @classmethod
        def register_subclass(cls, name: str) -> Any:
            return lambda own: chosen.setdefault(name, own)

    @dataclass
    class PolicyFeature:
        type: str
        shape: tuple[int, ...]

    class FeatureType:
        STATE, VISUAL, ACTION = "STATE", "VISUAL", "ACTION"

    modules = {name: ModuleType(name) for name in ("lerobot", "lerobot.configs", "lerobot.envs")}
    modules["lerobot.configs.types"] = types = ModuleType("lerobot.configs.types")
    modules["lerobot.envs.configs"] = configs = ModuleType("lerobot.envs.configs")
    types.FeatureType, types.PolicyFeature = FeatureType, PolicyFeature  # type: ignore[attr-defined]
    configs.EnvConfig = EnvConfig  # type: ignore[attr-defined]
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.syspath_prepend(str(PACKAGE))
    monkeypatch.delitem(sys.modules, "lerobot_env_robocell", raising=False)
    importlib.import_module("lerobot_env_robocell")
    yield chosen
    gymnasium.registry.pop("lerobot_env_robocell/Cell-v0")


def test_the_package_has_the_name_that_lerobot_looks_for():
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["project"]
    assert project["name"].startswith("lerobot_env_")
    assert project["name"] == PACKAGE.name
    assert (PACKAGE / project["name"] / "__init__.py").is_file()


def test_it_imports_the_modules_that_its_configuration_names(
    dataset: robocell.Dataset,
    plugin: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
):
    for name in ("lerobot_tasks_one", "lerobot_tasks_two"):
        (tmp_path / f"{name}.py").write_text(f"NAME = {name!r}\n")
    monkeypatch.chdir(tmp_path)
    names = "lerobot_tasks_one, lerobot_tasks_two.py"
    config = plugin["robocell"](task=str(dataset.folder), cameras="", imports=names)
    assert config.of_cell["imports"] == ["lerobot_tasks_one", "lerobot_tasks_two.py"]
    for name in ("lerobot_tasks_one", "lerobot_tasks_two"):
        assert name == sys.modules.pop(name).NAME
    vector = config.create_envs()["robocell"][0]
    assert "lerobot_tasks_one" in sys.modules
    vector.close()


def test_its_configuration_knows_the_features_of_the_export(
    dataset: robocell.Dataset, plugin: dict[str, Any]
):
    config = plugin["robocell"](task=str(dataset.folder))
    assert {name: each.shape for name, each in config.features.items()} == {
        "action": (8,),
        "agent_pos": (8,),
        "pixels/wrist": (48, 64, 3),
        "pixels/exo": (48, 64, 3),
    }
    assert config.features_map["pixels/exo"] == "observation.images.exo"
    assert config.fps == 8
    empty = plugin["robocell"]()
    with pytest.raises(ValueError, match=r"--env.task is missing"):
        empty.create_envs()


def test_its_environments_are_vectors_and_entries_of_gymnasium(
    dataset: robocell.Dataset, plugin: dict[str, Any]
):
    config = plugin["robocell"](task=str(dataset.folder), cameras="", episode_length=3)
    vector = config.create_envs(n_envs=2)["robocell"][0]
    observations, _ = vector.reset(seed=[0, 1])
    assert observations["agent_pos"].shape == (2, 8)
    assert vector.call("_max_episode_steps") == (3, 3)
    vector.close()
    one = gymnasium.make(config.gym_id, render_mode="rgb_array", **config.gym_kwargs)
    assert (one.task, one.task_description) == (dataset.folder.name, "pick up the sphere")
    first, _ = one.reset(seed=0)
    assert np.array_equal(first["agent_pos"], observations["agent_pos"][0])
    one.close()


@pytest.mark.soak
def test_lerobot_trains_and_evaluates_with_it(dataset: robocell.Dataset, tmp_path: Path):
    python = lerobot_python()
    package = shutil.copytree(PACKAGE, tmp_path / PACKAGE.name)  # building writes into it
    install = [python, "-m", "pip", "install", "-q", "--no-deps", package]
    subprocess.run(install, check=True)
    export_dataset(dataset, tmp_path / "data")
    command = [python.with_name("lerobot-train"), "--dataset.repo_id=local/picks"]
    command += [f"--dataset.root={tmp_path / 'data'}", "--dataset.video_backend=pyav"]
    command += ["--policy.type=act", "--policy.device=cpu", "--policy.push_to_hub=false"]
    command += ["--policy.dim_model=64", "--policy.n_heads=2", "--policy.dim_feedforward=64"]
    command += ["--policy.chunk_size=8", "--policy.n_action_steps=8", "--policy.use_vae=false"]
    command += ["--policy.pretrained_backbone_weights=null", "--batch_size=2", "--steps=2"]
    command += ["--env.discover_packages_path=lerobot_env_robocell"]
    command += ["--env.type=robocell", f"--env.task={dataset.folder}", "--env.episode_length=4"]
    command += ["--eval_freq=2", "--eval.n_episodes=1", "--eval.batch_size=1", "--num_workers=0"]
    command += [f"--output_dir={tmp_path / 'out'}", "--wandb.enable=false"]
    known = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "HF_HUB_OFFLINE": "1"}
    words = list(map(str, command))
    said = subprocess.run(words, capture_output=True, text=True, env=known)
    assert said.returncode == 0, said.stdout + said.stderr
    assert "pc_success" in said.stdout + said.stderr
    json.loads((tmp_path / "out/checkpoints/last/pretrained_model/config.json").read_text())
