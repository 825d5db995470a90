"""MolmoSpaces' tutorial on custom robots runs as it is printed, but for the package's name."""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

import molmospaces_tutorial as tutorial
import robocell as rc
from robocell.compat.molmo_spaces._command import config_class
from robocell.compat.molmo_spaces.data_generation import main as generation
from robocell.compat.molmo_spaces.kinematics import test_robot_ik as ik_tool
from robocell.compat.molmo_spaces.robots import find_gripper_finger_range as range_tool

MODULES = ("xarm7_view", "xarm7", "xarm7_config", "xarm7_datagen")
REGISTERED = "XArm7PickDataGenConfig"


@contextlib.contextmanager
def in_folder(folder: Path) -> Iterator[None]:
    """The tutorial's commands are started in the project's folder."""
    before = list(sys.path)
    try:
        with contextlib.chdir(folder):
            yield
    finally:
        sys.path[:] = before


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    from menagerie import require_menagerie

    arm = require_menagerie("ufactory_xarm7").path("ufactory_xarm7")
    folder = tutorial.write_project(tmp_path_factory.mktemp("my_project"), arm)
    with in_folder(folder):
        yield folder
    for name in MODULES:
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def datagen(project: Path) -> ModuleType:
    sys.path.insert(0, str(project))
    return importlib.import_module("xarm7_datagen")


@pytest.fixture(scope="module")
def config(datagen: ModuleType) -> Any:
    return datagen.XArm7RobotConfig()


def test_the_code_is_the_tutorials():
    if not tutorial.PAGE.is_file():
        pytest.skip(f"{tutorial.PAGE} is not here")
    page = tutorial.PAGE.read_text()
    for name, code in tutorial.blocks().items():
        for kind in re.split(r"\n\n(?=class |@)", code.strip()):
            assert kind in page, f"{name}: {kind[:60]}"


def test_the_robot_is_in_a_model_as_its_class_puts_it(config: Any):
    spec = mujoco.MjSpec()
    config.robot_cls.add_robot_to_scene(config, spec, "robot_0/", [0.1, 0.2], [1, 0, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    robot = config.robot_factory(data, SimpleNamespace(robot_config=config))
    robot.reset()
    mujoco.mj_forward(model, data)
    view = robot.robot_view
    assert view.move_group_ids() == ["base", "arm", "gripper"]
    assert np.allclose(view.base.pose[:3, 3], [0.1, 0.2, 0])
    # The arm stands on the pedestal, and its TCP's x axis points away from the base.
    arm = view.get_move_group("arm")
    assert np.allclose(arm.root_frame_to_robot[:3, 3], [0, 0, 0.25])
    assert arm.leaf_frame_to_robot[0, 0] > 0.99
    site = model.site("robot_0/link_tcp").id
    assert np.allclose(arm.leaf_frame_to_world[:3, 3], data.site_xpos[site])
    assert [sensor.uuid for sensor in robot.create_robot_sensors()] == ["tcp_pose"]
    robot.update_control({"arm": np.full(7, 0.1), "gripper": [255]})
    robot.compute_control()
    assert view.get_gripper("gripper").ctrl.tolist() == [255]


def test_the_fingers_are_measured_as_the_tutorial_prints_them(
    project: Path, capsys: pytest.CaptureFixture[str]
):
    assert range_tool.main(["xarm7_config", "XArm7RobotConfig"]) == 0
    title, line = capsys.readouterr().out.splitlines()
    assert title == "Gripper finger ranges:"
    assert line == "    Gripper 'gripper': 0.004 - 0.089"


@pytest.mark.parametrize("parallel", [False, True])
def test_the_tcp_goes_back_and_forth(config: Any, parallel: bool):
    answers = ik_tool.back_and_forth(config, parallel=parallel, count=2)
    heights = [answer.target[2, 3] for answer in answers]
    assert heights[0] - heights[1] == pytest.approx(0.1)
    for answer in answers:
        assert answer.positions is not None
        assert answer.position_error < 5e-4
        assert answer.rotation_error < 1e-3
        assert answer.positions["gripper"].tolist() == [0, 0]


@pytest.mark.proof
def test_without_a_display_the_ik_test_draws_a_strip(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    picture = tmp_path / "ik.png"
    options = ["--config_module", "xarm7_config", "--parallel", "--picture", str(picture)]
    assert ik_tool.main(["XArm7RobotConfig", *options]) == 0
    assert "6 of 6 targets reached" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000


def test_the_experiment_becomes_a_run(project: Path, datagen: ModuleType, tmp_path: Path):
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        path = generation.prepare(f"xarm7_datagen:{REGISTERED}", tmp_path / "run")
    assert "'procthor-10k' are not on this machine" in said.getvalue()
    assert "built-in houses take their place" in said.getvalue()
    run = rc.RunConfig.load(path)
    assert run.run == "xarm7_pick_datagen"
    assert run.robot.base.kind == rc.robots.BaseKind.MOCAP
    assert list(run.robot.move_groups) == ["arm", "gripper"]
    gripper = run.robot.move_groups["gripper"]
    assert [str(finger.name) for finger in gripper.fingers] == [
        "left_finger_pad_2",
        "right_finger_pad_2",
    ]
    assert (gripper.ctrl.open, gripper.ctrl.closed) == (0, 255)
    assert run.cameras.resolution.tolist() == [624, 352]
    assert [(stream.name, stream.camera) for stream in run.cameras.streams] == [
        ("wrist_camera_zed_mini", "wrist_camera"),
        ("exo_camera_zed_2", "exo_camera"),
    ]
    assert run.start.base_distance.tolist() == [0.15, 0.6]
    assert run.start.base_height_offset == -0.25
    assert run.start.base_height_noise.tolist() == [-0.2, 0.2]
    assert list(run.scenes.houses) == [0, 1, 2, 3]
    assert (run.episodes_per_scene, run.workers) == (2, 4)
    assert list(run.features) == ["tcp_pose"]
    # The same experiment is the same run, so that data generation continues.
    texts = {file: file.read_bytes() for file in path.parent.rglob("*") if file.is_file()}
    with contextlib.redirect_stderr(io.StringIO()):
        generation.prepare(f"xarm7_datagen:{REGISTERED}", tmp_path / "run")
    assert texts == {file: file.read_bytes() for file in path.parent.rglob("*") if file.is_file()}


def test_the_runs_robot_is_the_users_in_the_engine(project: Path, config: Any, tmp_path: Path):
    from robocell.compat.molmo_spaces._assembly import compile_alone
    from robocell.compat.molmo_spaces.data_generation._robot_files import write_robot

    robot = write_robot(config, tmp_path)
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="xarm7", config=robot, prefix="robot_0/"))
    scene = rc.Scene.build(spec)
    model, _, view = compile_alone(config, "robot_0/")
    there = config.robot_view_factory(scene.data, "robot_0/")
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = rng.uniform(-1, 1, 7)
        for each in (view, there):
            each.get_move_group("arm").joint_pos = q
            mujoco.mj_forward(each.mj_model, each.mj_data)
        one, other = (each.get_move_group("arm").leaf_frame_to_robot for each in (view, there))
        assert np.allclose(one, other, atol=1e-5)
    own = [i for i in range(model.nbody) if model.body(i).name.startswith("robot_0/")]
    for i in own:
        twin = scene.model.body(model.body(i).name)
        assert twin.mass[0] == pytest.approx(model.body_mass[i], rel=1e-4), model.body(i).name
    assert np.array_equal(scene.model.body_gravcomp[twin.id], model.body_gravcomp[i])


def test_wrong_names_get_the_next_step(project: Path):
    with pytest.raises(rc.NotFoundError, match=r"no module 'xarm_config'.*Did you mean 'xarm7"):
        config_class("xarm_config", "XArm7RobotConfig")
    with pytest.raises(rc.NotFoundError, match=r"has no 'XArm7Config'.*XArm7RobotConfig"):
        config_class("xarm7_config", "XArm7Config")
    with pytest.raises(rc.ArgumentError, match="is not a class of BaseRobotConfig"):
        config_class("xarm7", "XArm7Robot")
    Path("original.py").write_text("import molmo_spaces.robots.abstract\n")
    with pytest.raises(rc.NotFoundError, match=r"is called 'robocell.compat.molmo_spaces': write"):
        config_class("original", "X")
    with pytest.raises(rc.NotFoundError, match="no 'XArm7Pick'"):
        generation.prepare("xarm7_datagen:XArm7Pick", Path("unused"))


def test_cameras_that_are_not_there_are_named(datagen: ModuleType):
    from robocell.compat.molmo_spaces.configs.camera_configs import (
        MjcfCameraConfig,
        RobotMountedCameraConfig,
    )
    from robocell.compat.molmo_spaces.data_generation._cameras import cameras_of

    experiment = getattr(datagen, REGISTERED)()
    wrong = (
        (
            MjcfCameraConfig(name="a", mjcf_name="wrist_cam", robot_namespace="robot_0/"),
            "wrist_cam",
        ),
        (RobotMountedCameraConfig(name="a", reference_body_names=["link_9"], fov=60), "link_9"),
        (RobotMountedCameraConfig(name="a", reference_body_names=["link7"]), "fov is not set"),
    )
    for camera, said in wrong:
        experiment.camera_config.cameras = [camera]
        with pytest.raises(rc.Error, match=rf"camera 'a'.*{said}"):
            cameras_of(experiment, rc.RobotConfig())


@pytest.mark.proof
def test_the_tutorials_command_makes_its_dataset(project: Path):
    """Runs the printed command, and exports what it makes in the original's schema."""
    import subprocess

    h5py = pytest.importorskip("h5py")
    command = [sys.executable, "-m", "robocell.compat.molmo_spaces.data_generation.main"]
    made = subprocess.run(
        [*command, f"xarm7_datagen:{REGISTERED}"],
        capture_output=True,
        text=True,
        cwd=project,
        env=os.environ | {"COLUMNS": "200"},
        timeout=900,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    dataset = rc.data.Dataset(project / "experiment_output/datagen/xarm7_pick_v1" / REGISTERED)
    assert len(dataset) == 8
    episode = dataset[0]
    tcp = np.asarray(episode["features/tcp_pose"])
    assert tcp.shape[1] == 7
    exported = project / "exported"
    subprocess.run(
        [
            *(sys.executable, "-m", "robocell", "export", str(dataset.folder), str(exported)),
            *("--format", "molmospaces"),
        ],
        check=True,
        capture_output=True,
    )
    with h5py.File(next(exported.rglob("house_0/*.h5"))) as file:
        assert {"actions", "obs", "rewards", "success"} <= set(file["traj_0"])
