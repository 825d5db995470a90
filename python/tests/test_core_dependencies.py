"""`pip install robocell` alone: what works with it, and what names the extra that it needs."""

from __future__ import annotations

import ast
import importlib.metadata
import sys

import pytest

import only_core
from command_line import write_run
from robocell._extras import EXTRAS, install_command, needed_by

SOURCES = only_core.ROOT / "python" / "robocell"
# Packages that go by another name than their module.
MODULES = {
    "foxglove-schemas-protobuf": "foxglove_schemas_protobuf",
    "hidapi": "hid",
    "mcap-protobuf-support": "mcap_protobuf",
    "mujoco-menagerie": "mujoco_menagerie",
    "pillow": "PIL",
    "rerun-sdk": "rerun",
    "protobuf": "google",
    "pyyaml": "yaml",
    "stable-baselines3": "stable_baselines3",
}
# Debian's, for which PyPI has no wheel: _pykdl.py has the command.
SYSTEM = {"PyKDL"}
BROUGHT_BY_MUJOCO = {"glfw"}


def modules_of(requirements: list[str]) -> set[str]:
    names = [only_core.normalized(requirement) for requirement in requirements]
    return {MODULES.get(name, name) for name in names}


def imported() -> set[str]:
    """Top-level modules that the package imports, other than its own and Python's."""
    found = set()
    for file in SOURCES.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module)
    tops = {name.partition(".")[0] for name in found}
    return tops - set(sys.stdlib_module_names) - {"robocell"} - SYSTEM - BROUGHT_BY_MUJOCO


def test_dependencies_match_the_imports():
    project = only_core.project()
    core = modules_of(project["dependencies"])
    extras = {name: modules_of(list(EXTRAS[name].values())) for name in EXTRAS}
    assert imported() == core.union(*extras.values())
    declared = project["optional-dependencies"]
    assert {name: modules_of(declared[name]) for name in EXTRAS} == extras
    assert set(declared) - set(EXTRAS) == {"learning"}  # for an example, not for the package


def test_the_blocker_blocks():
    result = only_core.run("import numpy, mujoco, typer, rich\nimport gymnasium")
    assert "No module named 'gymnasium'" in result.stderr
    assert {"gymnasium", "h5py", "matplotlib", "yaml", "PIL"} <= only_core.blocked_modules()


CELL = """
import robocell as rc

spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec.robots.append(rc.RobotSpec(name="arm", config=config))
with rc.Scene.build(spec) as scene:
    robot = rc.Robot.of(scene, "arm")
    robot.update()
    goal = robot.base_in_world.inverse() * robot.tcp_in_world
    found = robot.ik(goal)
    assert robot.kinematics.fk(found.q).is_close(goal, 1e-4, 1e-4)
    scene.step()
    assert scene.data.time > 0
"""


def test_scenes_robots_and_kinematics_need_no_extra():
    result = only_core.run(CELL)
    assert result.returncode == 0, result.stderr


ENVIRONMENT = """
import robocell as rc
env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
observation, info = env.reset(seed=1)
still = {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": [1]}
observation, reward, terminated, truncated, info = env.step({"robot": still})
assert info["robots"]["robot"]["ik_success"]
"""


def test_environments_need_no_extra():
    result = only_core.run(ENVIRONMENT)
    assert result.returncode == 0, result.stderr


COMMAND = """
from robocell.__main__ import run
run()
"""


def test_a_dataset_is_generated_and_verified_without_extras(tmp_path):
    run = write_run(tmp_path, episodes_per_scene=1, cameras={"streams": []})
    result = only_core.run(COMMAND, "generate", run, "--workers", "1", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert len(list(tmp_path.rglob("episode.json"))) == 1, result.stdout
    result = only_core.run(COMMAND, "verify", tmp_path / "out")
    assert result.returncode == 0, result.stderr + result.stdout


def test_the_doctor_names_extras_as_optional():
    result = only_core.run(COMMAND, "doctor")
    words = " ".join(result.stdout.split())
    assert "extra: envs (for robocell.gym, robocell.lerobot and compat.rcs) is optional" in words
    assert "pip install matplotlib plotly" in words
    assert "packages is broken" not in words


@pytest.mark.parametrize(
    ("code", "message"),
    [
        (
            "import robocell.gym",
            "robocell.gym needs the package gymnasium, which is not installed: "
            "pip install gymnasium. Without it: robocell.Env",
        ),
        (
            "import robocell.lerobot",
            "robocell.lerobot needs the package gymnasium, which is not installed: "
            "pip install gymnasium",
        ),
        (
            "import robocell.sb3",
            "robocell.sb3 needs the package gymnasium, which is not installed: "
            "pip install gymnasium stable-baselines3",
        ),
    ],
)
def test_a_missing_extra_is_an_error_with_the_pip_command_of_a_checkout(code, message):
    result = only_core.run(code)
    assert f"ModuleNotFoundError: {message}" in result.stderr


def test_the_pip_command_of_an_installed_package_names_its_extra(monkeypatch):
    def distribution(name: str) -> str:
        return name

    monkeypatch.setattr(importlib.metadata, "distribution", distribution)
    assert {extra: install_command(extra) for extra in EXTRAS} == {
        extra: f"pip install 'robocell[{extra}]'" for extra in EXTRAS
    }


def test_no_other_module_writes_the_command_itself():
    for file in SOURCES.rglob("*.py"):
        if file.name != "_extras.py":
            code = ast.walk(ast.parse(file.read_text()))
            texts = [node.value for node in code if isinstance(node, ast.Constant)]
            docs = [text for text in texts if "pip install 'robocell[" in str(text)]
            assert all("checkout" in text for text in docs), file


def test_reach_names_the_extra_before_it_computes(tmp_path):
    from command_line import RC7

    result = only_core.run(COMMAND, "reach", RC7, "--plane", "z=0.4", cwd=tmp_path)
    assert result.returncode == 2
    assert (
        "robocell reach needs the package matplotlib, which is not installed: "
        "pip install matplotlib plotly. Numbers alone: robot.kinematics.reach_map"
    ) in " ".join(result.stderr.split())
    assert not list(tmp_path.iterdir())


def test_another_missing_module_keeps_its_own_error():
    missing = pytest.raises(ModuleNotFoundError, match="No module named 'no_such_module'")
    with missing, needed_by("robocell.gym", "envs"):
        import no_such_module  # noqa: F401
