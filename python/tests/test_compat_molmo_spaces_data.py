"""Data generation with MolmoSpaces' classes: users' places, sensors and groups in episodes."""

from __future__ import annotations

import resource
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mujoco import mj_geomDistance

import robocell as rc
from molmospaces_toys import (
    ArmGroup,
    FlyingView,
    HandGroup,
    MobileView,
    ToyConfig,
    ToyView,
    TwoArms,
    TwoArmsView,
)
from robocell.compat.molmo_spaces._command import run_main
from robocell.compat.molmo_spaces._groups import OwnMoveGroup
from robocell.compat.molmo_spaces.configs import PickTaskSamplerConfig
from robocell.compat.molmo_spaces.configs.abstract_exp_config import MlSpacesExpConfig
from robocell.compat.molmo_spaces.configs.camera_configs import (
    CameraSystemConfig,
    RobotMountedCameraConfig,
)
from robocell.compat.molmo_spaces.data_generation import _robot_files, _run
from robocell.compat.molmo_spaces.data_generation._robot_files import write_robot
from robocell.compat.molmo_spaces.data_generation._run import write_run
from robocell.compat.molmo_spaces.data_generation._sampler import install_groups

# A user's module: a robot with a sensor of its own, and a sampler that chooses where it stands.
MODULE = """
from pathlib import Path

import numpy as np

from molmospaces_toys import Rc7Config, Rc7Robot
from robocell.compat.molmo_spaces.configs import PickTaskSamplerConfig
from robocell.compat.molmo_spaces.configs.base_pick_config import PickBaseConfig
from robocell.compat.molmo_spaces.configs.camera_configs import (
    CameraSystemConfig,
    RandomizedExocentricCameraConfig,
)
from robocell.compat.molmo_spaces.data_generation.config_registry import register_config
from robocell.compat.molmo_spaces.env.data_views import create_mlspaces_body
from robocell.compat.molmo_spaces.tasks.pick_task_sampler import PickTaskSampler


class Facing(PickTaskSampler):
    def _sample_and_place_robot(self, env):
        assert np.allclose(env.current_robot.robot_view.base.pose, np.eye(4))
        super()._sample_and_place_robot(env)
        task = self.config.task_config
        lies = create_mlspaces_body(env.current_data, task.pickup_obj_name)
        assert np.allclose(lies.position, task.pickup_obj_start_pose[:3])
        assert np.isclose(task.pickup_obj_goal_pose[2], lies.position[2] + 0.05)
        base = env.current_robot.robot_view.base
        pose = base.pose
        pose[2, 3] += 0.01 + 1e-3 * np.random.rand()
        base.pose = pose


@register_config("FacingPick")
class FacingPick(PickBaseConfig):
    robot_config: Rc7Config = Rc7Config()
    camera_config: CameraSystemConfig = CameraSystemConfig(
        img_resolution=(64, 36),
        cameras=[
            RandomizedExocentricCameraConfig(
                name="side",
                distance_range=(0.6, 0.9),
                height_range=(0.2, 0.5),
                azimuth_range=(-1, 1),
                fov_range=(40, 60),
                visibility_constraints={"__task_objects__": 0.001},
            )
        ],
    )
    output_dir: Path = Path("out")
    task_sampler_config: PickTaskSamplerConfig = PickTaskSamplerConfig(
        task_sampler_class=Facing,
        house_inds=[0],
        samples_per_house=1,
        base_pose_sampling_radius_range=(0.35, 0.6),
        robot_object_z_offset=-0.25,
        robot_object_z_offset_random_min=-0.05,
        robot_object_z_offset_random_max=0.05,
    )
"""


@pytest.fixture
def toy() -> rc.Scene:
    """The arm of two joints in a scene of robocell, as data generation makes it."""
    with tempfile.TemporaryDirectory() as folder:
        robot = write_robot(ToyConfig(), Path(folder))
        spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="toy", config=robot, prefix="robot_0/"))
        return rc.Scene.build(spec)


class TestGroupsInScenes:
    def test_a_users_arm_is_a_group_of_the_robot(self, toy: rc.Scene):
        robot = toy.robot("toy")
        view = ToyView(toy.data, "robot_0/")
        robot.set_group(OwnMoveGroup(view.get_move_group("arm")))
        robot.apply({"arm": rc.control.GroupCommand.joints([0.3, 0.2])})
        robot.update()
        assert view.get_move_group("arm").ctrl.tolist() == [0.3, 0.2]
        arm = robot.group("arm")
        assert np.allclose(arm.joint_pos_limits, view.get_move_group("arm").joint_pos_limits)
        assert np.allclose(arm.jacobian(), view.get_jacobian("arm", ["arm"]))

    def test_a_group_that_holds_itself_differently_replaces_robocells(self, toy: rc.Scene):
        class Heavy(ArmGroup):
            @property
            def noop_ctrl(self) -> Any:
                return self.joint_pos + 0.125

        class HeavyView(ToyView):
            def __init__(self, mj_data: mujoco.MjData, namespace: str) -> None:
                super().__init__(mj_data, namespace)
                self._move_groups["arm"] = Heavy(mj_data, self.base, namespace)
                self._move_groups["arm"]._name = "arm"

        robot, before = toy.robot("toy"), toy.robot("toy").arm
        install_groups(robot, _Experiment(ToyConfig()))
        assert robot.arm is before or type(robot.arm) is type(before)
        install_groups(robot, _Experiment(ToyConfig(robot_view_factory=HeavyView)))
        assert np.allclose(robot.arm.noop_ctrl, robot.arm.joint_pos + 0.125)

    def test_a_base_on_wheels_drives_from_where_it_was_put(self, tmp_path: Path):
        from test_compat_molmo_spaces import _Mobile

        config = ToyConfig(
            robot_xml_path=Path("mobile.xml"),
            robot_view_factory=MobileView,
            robot_cls=_Mobile,
            init_qpos={},
        )
        spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
        robot_config = write_robot(config, tmp_path)
        spec.robots.append(rc.RobotSpec(name="toy", config=robot_config, prefix="robot_0/"))
        scene = rc.Scene.build(spec)
        view = MobileView(scene.data, "robot_0/")
        scene.robot("toy").base.pose = rc.Pose(translation=[0.5, -0.25, 0], rpy=[0, 0, 1])
        scene.forward()
        assert np.allclose(view.base.pose[:2, 3], [0.5, -0.25])
        view.base.pose = rc.Pose(translation=[0.75, 0.5, 0], rpy=[0, 0, 0.5]).matrix
        scene.forward()
        assert np.allclose(scene.body_pose("robot_0/wheels").matrix, view.base.pose)
        assert np.allclose(view.base.noop_ctrl, view.base.joint_pos)
        assert scene.robot("toy").group("base_joints").nu == 3


def test_solutions_are_drawn_side_by_side(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    from robocell.compat.molmo_spaces.kinematics import test_robot_ik as ik_tool

    monkeypatch.setattr(ik_tool, "SIZE_PX", (40, 30))
    config = ToyConfig()
    answers = ik_tool.back_and_forth(config, "arm", count=2)
    ik_tool.draw_strip(config, answers, tmp_path / "strip.png")
    assert (tmp_path / "strip.png").read_bytes()[16:24] == (80).to_bytes(4) + (30).to_bytes(4)


def test_two_arms_of_one_robot_are_in_one_file(tmp_path: Path):
    config = ToyConfig(robot_view_factory=TwoArmsView, robot_cls=TwoArms, init_qpos={})
    spec = rc.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    robot_config = write_robot(config, tmp_path)
    spec.robots.append(rc.RobotSpec(name="toy", config=robot_config, prefix="robot_0/"))
    scene = rc.Scene.build(spec)
    robot, view = scene.robot("toy"), TwoArmsView(scene.data, "robot_0/")
    assert robot.gripper_of("left_arm") == "left_gripper"
    assert robot.gripper_of("right_arm") == "right_gripper"
    robot.apply({"right_arm": rc.control.GroupCommand.joints([0.3, 0.2])})
    robot.update()
    assert view.get_move_group("right_arm").ctrl.tolist() == [0.3, 0.2]


def test_a_users_place_and_sensors_are_in_the_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    from robocell._generation.run_source import RunSource
    from robocell._own_code import modules_of_one_run
    from robocell.compat.molmo_spaces.data_generation.main import prepare

    monkeypatch.chdir(tmp_path)
    Path("facing_pick.py").write_text(MODULE)
    with modules_of_one_run():
        run = RunSource(str(prepare("facing_pick:FacingPick"))).load(
            [
                "scenes={source: tabletop}",
                "rates.policy_ms=100",
                "cameras.renderer={backend: soft}",
            ]
        )
        assert list(run.features) == ["tcp_pose"]
        rc.generate.prepare_dataset(run)
        (item,) = rc.generate.make_plan(run)
        result = rc.generate.Runner(run).run(item)
        assert result.success
        episode = rc.data.Dataset(run.output)[0]
    sys.modules.pop("facing_pick", None)
    tcp = np.asarray(episode["features/tcp_pose"])
    base, world = (np.asarray(episode[f"robots/rc7/{name}"]) for name in ("base_pose", "tcp_pose"))
    assert tcp.shape == (len(base), 7)
    lengths = np.linalg.norm(tcp[:, 3:], axis=1)
    assert np.allclose(lengths, 1, atol=1e-5)
    assert world.shape[0] == len(tcp)
    # The camera of the start is in the scene that the episode records.
    scene = rc.Scene.build(rc.data.recorded_scene(episode))
    assert 40 <= scene.model.camera("side").fovy[0] <= 60
    to_side = np.asarray(episode["cameras/side/extrinsics"])[0]
    at = -to_side[:3, :3].T @ to_side[:3, 3]
    assert np.allclose(scene.model.camera("side").pos, at, atol=1e-9)


class NamedDistance(HandGroup):
    @property
    def inter_finger_dist(self) -> float:
        one, other = self._fingers
        return float(mj_geomDistance(self.mj_model, self.mj_data, one, other, 0.1, None))


class NamedDistanceView(ToyView):
    def __init__(self, mj_data: mujoco.MjData, namespace: str = "") -> None:
        super().__init__(mj_data, namespace)
        self._move_groups["gripper"] = NamedDistance(mj_data, self.base, namespace)
        self._move_groups["gripper"]._name = "gripper"


def test_fields_of_a_robot_without_an_effect_are_reported(tmp_path: Path):
    from test_compat_molmo_spaces import _Flying

    with pytest.raises(rc.NotFoundError, match=r"ToyConfig.init_qpos: .*'amr'.*mean 'arm'"):
        write_robot(ToyConfig(init_qpos={"amr": [0.1, 0.2]}), tmp_path)
    for fields, said in (
        ({"init_qpos_noise_range": {"hand": [0.1]}}, r"init_qpos_noise_range: .*no move group 'ha"),
        ({"command_mode": {"legs": "joint_position"}}, r"command_mode: .*no move group 'legs'"),
        ({"action_noise_config": {"action_scale_factor": 0.3}}, r"action_noise_config has no eff"),
    ):
        with pytest.warns(UserWarning, match=said):
            write_robot(ToyConfig(**fields), tmp_path)
    flying = ToyConfig(
        robot_xml_path=Path("flying.xml"),
        robot_view_factory=FlyingView,
        robot_cls=_Flying,
        init_qpos={"base": [0, 0, 1, 1, 0, 0, 0]},
    )
    with pytest.warns(UserWarning, match=r"init_qpos\['base'\] has no effect.*places the base"):
        write_robot(flying, tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_robot(ToyConfig(action_noise_config={"enabled": False}), tmp_path)


def test_fingers_are_found_where_the_distance_is_imported_by_name(tmp_path: Path):
    robot = write_robot(ToyConfig(robot_view_factory=NamedDistanceView), tmp_path)
    assert [str(each.name) for each in robot.move_groups["gripper"].fingers] == ["left", "right"]
    assert mj_geomDistance is mujoco.mj_geomDistance


def test_a_copy_of_a_file_is_complete_or_absent(tmp_path: Path):
    """The disk is full after 1000 bytes; the next copy does not find half of the file."""
    mesh, folder = tmp_path / "mesh.stl", tmp_path / "files"
    mesh.write_bytes(bytes(range(250)) * 8)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(OSError, match="mesh"):
            _robot_files._copied(mesh, folder)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    copy = tmp_path / _robot_files._copied(mesh, folder)
    assert copy.read_bytes() == mesh.read_bytes()


class TestWhatARunCannotTakeOver:
    def test_fields_without_an_effect_are_reported(self, tmp_path: Path):
        camera = RobotMountedCameraConfig(
            name="a", reference_body_names=["hand"], fov=60, is_warped=True
        )
        experiment = MlSpacesExpConfig(
            robot_config=ToyConfig(robot_factory=None),
            camera_config=CameraSystemConfig(cameras=[camera]),
            task_sampler_config=PickTaskSamplerConfig(
                robot_safety_radius=0.2, verbose=True, scene_xml_paths=[str(tmp_path / "a.xml")]
            ),
            end_on_success=True,
            use_wandb=True,
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            write_run("toys: 'a'", experiment, tmp_path)
        said = [str(each.message) for each in caught]
        assert "MlSpacesExpConfig: no effect in robocell: end_on_success, use_wandb" in said
        assert "task_sampler_config: no effect in robocell: robot_safety_radius, verbose" in said
        assert "camera 'a': no effect in robocell: is_warped" in said
        experiment.task_type = "open"
        with pytest.raises(rc.ArgumentError, match=r"task_type: 'open'.*Allowed: 'pick'"):
            write_run("toys", experiment, tmp_path)

    def test_the_built_in_houses_replace_only_a_set_that_is_not_there(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ):
        def scenes(**fields: Any) -> Any:
            return _run._scenes(MlSpacesExpConfig(robot_config=ToyConfig(), **fields))

        (tmp_path / "scenes" / "procthor-10k-train").mkdir(parents=True)
        (tmp_path / "scenes" / "procthor-10k-train" / "train_0.xml").write_text("<mujoco/>")
        monkeypatch.setenv("ROBOCELL_SCENE_PATH", str(tmp_path))
        with pytest.raises(rc.NotFoundError, match="split 'val'"):
            scenes(data_split="val")
        with pytest.raises(rc.Error, match="split"):
            scenes(data_split="vall")
        with pytest.warns(UserWarning, match="'ithor' are not on this machine"):
            built_in = scenes(task_sampler_config=PickTaskSamplerConfig(dataset_name="ithor"))
        assert built_in == {"source": "houses", "houses": [0, 1, 2, 3]}

    def test_values_of_another_type_are_named(self):
        with pytest.raises(rc.ArgumentError, match=r"CameraSystemConfig: img_resolution.1: .*'x'"):
            CameraSystemConfig(img_resolution=(3, "x"))
        system = CameraSystemConfig()
        with pytest.raises(rc.ArgumentError, match="img_resolution"):
            system.img_resolution = (0, 1)
        assert system.img_resolution == (624, 352)

    @pytest.mark.parametrize(
        ("error", "code"), [(rc.IoError("disk"), 3), (OSError("disk"), 3), (rc.SpecError("x"), 2)]
    )
    def test_exit_codes_are_those_of_robocells_commands(self, error: Exception, code: int):
        def failing() -> int:
            raise error

        with pytest.raises(SystemExit) as ended:
            run_main(failing)
        assert ended.value.code == code


class _Experiment:
    def __init__(self, robot_config: Any) -> None:
        self.robot_config = robot_config
