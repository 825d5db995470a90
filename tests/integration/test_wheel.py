"""The wheel in an environment of its own: what `make check-wheel` runs.

It is built and repaired as for users, and installed with pip into a fresh environment that has
nothing else. Nothing of the checkout may be used.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import mujoco
import pytest
from test_packaging import ROOT, build_consumer

pytestmark = pytest.mark.wheel

ENGINE = f"libmujoco.so.{mujoco.__version__}"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The repaired wheel."""
    out = tmp_path_factory.mktemp("dist")
    build = [ROOT / "scripts" / "build_wheel", out]
    subprocess.run(build, check=True)
    (file,) = out.glob("robocell-*.whl")
    return file


@pytest.fixture(scope="module")
def venv(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fresh environment with the wheel and what it requires."""
    folder = tmp_path_factory.mktemp("clean") / "venv"
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    options = ["--quiet", "--disable-pip-version-check", "--no-input"]
    pinned = ["--constraint", ROOT / "scripts/requirements.txt"]
    pinned += ["--constraint", ROOT / "scripts/constraints.txt"]
    install = [folder / "bin/python", "-m", "pip", "install", *options, *pinned, wheel]
    subprocess.run(install, check=True)
    return folder


def run(venv: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """A command of the environment, as in a new shell of a user without a checkout."""
    ours = ("PYTHONPATH", "ROBOCELL", "MUJOCO_ROOT", "MUJOCO_GL", "LD_LIBRARY_PATH")
    env = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    env["PATH"] = f"{venv}/bin:{env['PATH']}"
    command = [str(word) for word in words]
    return subprocess.run(
        command, env=env, cwd=venv, capture_output=True, text=True, check=False, timeout=300
    )


def python(venv: Path, code: str) -> str:
    """Runs code with the environment's Python; what it printed."""
    done = run(venv, venv / "bin/python", "-c", code)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.strip()


def test_the_wheel_bundles_libraries_except_the_engine(wheel):
    with zipfile.ZipFile(wheel) as content:
        names = content.namelist()
    libraries = [Path(name).name for name in names if name.startswith("robocell.libs/")]
    for wanted in ("liborocos-kdl", "libhdf5", "libyaml-cpp", "libspdlog", "libfmt", "libpng"):
        assert any(name.startswith(wanted) for name in libraries), (wanted, libraries)
    assert not [name for name in names if "libmujoco" in name]
    assert re.search(r"-manylinux_2_\d+_x86_64\.whl$", wheel.name)


def test_the_wheel_contains_stubs_types_models_and_one_library(wheel):
    with zipfile.ZipFile(wheel) as content:
        names = content.namelist()
    libraries = {
        "librobocell.so.0.1.0",
        "robocell_warm_start.so",
        "robocell_drawing_service",
    }
    wanted = {"py.typed", "_core.pyi", "models/robots/rc7/rc7.yaml"} | libraries
    assert {f"robocell/{name}" for name in wanted} <= set(names)
    assert [name for name in names if "/librobocell" in name] == ["robocell/librobocell.so.0.1.0"]
    assert not [name for name in names if name.endswith("_test.cc") or "/testing/" in name]


LOADED = """
import robocell as rc, mujoco
scene = rc.Scene.build(rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False))
scene.model
lines = open("/proc/self/maps").read().splitlines()
print(*sorted({line.split()[-1] for line in lines if ".so" in line}), sep="\\n")
"""


def test_one_engine_and_one_library_are_loaded_all_from_the_environment(venv):
    files = [Path(line) for line in python(venv, LOADED).splitlines()]
    site = next(venv.glob("lib/python3*/site-packages"))
    assert [file for file in files if "mujoco.so" in file.name] == [site / "mujoco" / ENGINE]
    (library,) = (file for file in files if "librobocell" in file.name)
    assert library == site / "robocell" / "librobocell.so.0.1.0"
    assert not [file for file in files if file.is_relative_to(ROOT) and venv not in file.parents]


def test_the_doctor_finds_nothing_broken(venv):
    done = run(venv, "robocell", "doctor")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "this machine can generate datasets" in done.stdout
    assert "pip install 'robocell[envs]'" in " ".join(done.stdout.split())


CELL = """
import robocell as rc
spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec.robots.append(rc.RobotSpec(name="arm", config=config))
scene = rc.Scene.build(spec)
robot = rc.Robot.of(scene, "arm")
robot.update()
goal = robot.base_in_world.inverse() * robot.tcp_in_world
goal = goal * rc.Pose(translation=[0, 0, 0.05])
found = robot.ik(goal)
assert found.success and robot.kinematics.fk(found.q).is_close(goal, 1e-4, 1e-4)
robot.jnt_pos_cmd[:] = found.q
for _ in range(1000):
    robot.update()
    scene.step()
robot.update()
reached = robot.base_in_world.inverse() * robot.tcp_in_world
assert reached.is_close(goal, 0.01, 0.05), (reached, goal)
"""


def test_a_built_in_robot_is_compiled_solved_and_moved(venv):
    python(venv, CELL)


ENVIRONMENT = """
import robocell as rc
env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
env.reset(seed=1)
up = {"tquat": [0, 0, 0.02, 0, 0, 0, 1], "gripper": [1]}
observation, reward, terminated, truncated, info = env.step({"robot": up})
assert info["robots"]["robot"]["ik_success"]
"""


def test_an_environment_steps(venv):
    python(venv, ENVIRONMENT)


PICTURE = """
import robocell as rc
spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec.robots.append(rc.RobotSpec(name="arm", config=config))
scene = rc.Scene.build(spec)
try:
    renderer = rc.render.Renderer(scene)
except rc.Error as error:
    print("no GL:", error)
else:
    image = renderer.render("", 64, 48)["rgb"]
    print(image.shape, image.std() > 1)
"""


def test_draws_a_picture_with_gl(venv):
    printed = python(venv, PICTURE)
    if printed.startswith("no GL:"):
        pytest.skip(printed)
    assert printed == "(48, 64, 3) True"


CHAIN = """
import robocell as rc
spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec.robots.append(rc.RobotSpec(name="arm", config=config))
robot = rc.Robot.of(rc.Scene.build(spec), "arm")
robot.update()
chain = robot.kdl_chain()
import PyKDL
assert type(chain) is PyKDL.Chain
joints = PyKDL.JntArray(chain.getNrOfJoints())
for i, value in enumerate(robot.jnt_pos_msr):
    joints[i] = value
frame = PyKDL.Frame()
PyKDL.ChainFkSolverPos_recursive(chain).JntToCart(joints, frame)
tcp = robot.base_in_world.inverse() * robot.tcp_in_world
assert rc.Pose.from_kdl(frame).is_close(tcp, 1e-9, 1e-9), (frame, tcp)
"""


def test_the_command_of_the_error_installs_pykdl(venv):
    """Runs, as a user without root does, the command that the ImportError prints."""
    missing = run(venv, venv / "bin/python", "-c", CHAIN)
    assert "ImportError: this needs PyKDL, which is not importable here." in missing.stderr
    command = re.search(r"(?:link it into this environment|Without root): (.*)", missing.stderr)
    assert command, missing.stderr
    done = run(venv, "bash", "-c", command[1])
    assert done.returncode == 0, command[1] + done.stderr
    python(venv, CHAIN)


def test_a_c_plus_plus_user_builds_against_the_wheel(venv, tmp_path):
    folder = Path(python(venv, "import robocell; print(robocell.cmake_dir())"))
    version, models, _ = build_consumer(folder, tmp_path / "build")
    site = next(venv.glob("lib/python3*/site-packages"))
    assert (version, Path(models)) == ("0.1.0", site / "robocell" / "models")
