"""Cameras of MolmoSpaces' experiments: their places, noise and conditions in starts of a run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc
from molmospaces_toys import Rc7Config, Rc7Robot, ToyConfig
from robocell.compat.molmo_spaces.configs import PickTaskSamplerConfig
from robocell.compat.molmo_spaces.configs.abstract_exp_config import MlSpacesExpConfig
from robocell.compat.molmo_spaces.configs.camera_configs import (
    CameraSystemConfig,
    FixedExocentricCameraConfig,
    MjcfCameraConfig,
    RandomizedExocentricCameraConfig,
    RobotMountedCameraConfig,
)
from robocell.compat.molmo_spaces.data_generation._cameras import Cameras, cameras_of, looking
from robocell.compat.molmo_spaces.data_generation._robot_files import write_robot

SIZE = (96, 54)
EYE, TURN, FOVY = [0.05, 0.02, -0.01], [0.5, 0.5, -0.5, 0.5], 48.0  # of a camera of the model

ROOM = """
<mujoco><worldbody><light pos="0 0 3"/><geom name="floor" type="plane" size="4 4 .1"/>
  <camera name="corner" pos="2 2 2" xyaxes="-1 1 0 -1 -1 2" fovy="70"/>
  <body name="table" pos="0 0 .2"><geom type="box" size=".5 .4 .2"/></body>
</worldbody></mujoco>"""


class SeeingRobot(Rc7Robot):
    """The built-in arm with a camera in its model."""

    @classmethod
    def add_robot_to_scene(
        cls, robot_config: Any, spec: mujoco.MjSpec, prefix: str, *args: Any, **kwargs: Any
    ) -> None:
        super().add_robot_to_scene(robot_config, spec, prefix, *args, **kwargs)
        spec.body(f"{prefix}hand").add_camera(
            name=f"{prefix}wrist_camera", pos=EYE, quat=TURN, fovy=FOVY
        )


def seeing_config() -> Rc7Config:
    return Rc7Config(robot_cls=SeeingRobot, robot_factory=SeeingRobot)


def experiment_with(cameras: list[Any], robot: Any = None, **sampler: Any) -> MlSpacesExpConfig:
    return MlSpacesExpConfig(
        robot_config=robot or seeing_config(),
        camera_config=CameraSystemConfig(img_resolution=SIZE, cameras=cameras),
        task_sampler_config=PickTaskSamplerConfig(**sampler),
    )


def cameras_with(cameras: list[Any], **sampler: Any) -> Cameras:
    robot = rc.RobotConfig(move_groups={"arm": {"kind": "arm"}})
    return cameras_of(experiment_with(cameras, **sampler), robot)


def starts_with(
    cameras: list[Any], folder: Path, count: int = 3, scenes: dict[str, Any] | None = None
) -> Iterator[rc.Scene]:
    """Samples starts of a run whose robot and cameras are those of an experiment."""
    experiment = experiment_with(cameras)
    robot = write_robot(experiment.robot_config, folder)
    found = cameras_of(experiment, robot)
    run = rc.RunConfig(
        run="cameras",
        robot=robot,
        task={"kind": "pick", "objects": ["mug"]},
        scenes=scenes or {"source": "tabletop"},
        start={"base_height_offset": -0.25, "cameras": found.placed},
        cameras={"resolution": list(SIZE), "streams": found.streams},
    )
    sampler, made, attempt = rc.tasks.StartSampler(run), 0, 0
    while made < count:
        request = rc.tasks.SampleRequest(scene=0, episode=made, attempt=attempt)
        start = sampler.sample(request, rc.tasks.Rng.stream(3, f"attempt {attempt}"))
        attempt += 1
        assert attempt < 60, start
        if isinstance(start, rc.tasks.EpisodeStart):
            made += 1
            yield start.scene


def test_a_camera_looks_at_its_point():
    point = np.array([0.5, -1, 0.2])
    for up in np.eye(3):
        pose = rc.Pose(looking([1, 2, 3], point, up))
        seen = pose.inverse() * rc.Pose(translation=point)
        assert np.allclose(seen.translation[:2], 0, atol=1e-9)
        assert seen.translation[2] < 0
        higher = pose.inverse() * rc.Pose(translation=point + 0.1 * up)
        assert higher.translation[1] > 0
    with pytest.raises(rc.ArgumentError, match="looks along the direction that is up"):
        looking([0, 0, 1], [0, 0, 0], [0, 0, 1])


def test_each_start_places_its_cameras(tmp_path: Path):
    """A fixed one stands in the world, a drawn one in its ranges, noise in its bounds."""
    eye, point = np.array([0.08, 0.02, -0.03]), np.array([0.0, 0.01, 0.2])
    cameras = [
        FixedExocentricCameraConfig(
            name="fixed", fov=60, pos=[2, 1, 1.5], forward=[-1, 0, -0.5], up=[0, 0, 1]
        ),
        RandomizedExocentricCameraConfig(
            name="drawn",
            distance_range=(0.8, 1.2),
            height_range=(0.3, 0.6),
            azimuth_range=(0, 1),
            fov_range=(40, 50),
        ),
        RobotMountedCameraConfig(
            name="shifted",
            reference_body_names=["nothing", "hand"],
            camera_offset=eye.tolist(),
            lookat_offset=point.tolist(),
            up_axis="y",
            fov=60,
            pos_noise_range=(0.01, 0.03),
        ),
        RobotMountedCameraConfig(
            name="aimed",
            reference_body_names=["hand"],
            camera_offset=eye.tolist(),
            lookat_offset=point.tolist(),
            up_axis="y",
            fov=60,
            lookat_noise_range=(0.0, 0.05),
        ),
        RobotMountedCameraConfig(
            name="turned",
            reference_body_names=["hand"],
            camera_offset=eye.tolist(),
            camera_quaternion=[2, 0, 0, 2],
            fov=60,
            orientation_noise_degrees=2,
        ),
        MjcfCameraConfig(
            name="own",
            mjcf_name="wrist_camera",
            robot_namespace="robot_0/",
            pos_noise_range=((0, 0.01, -0.02), (0.02, 0.02, -0.01)),
            fov_noise_degrees=(1, 3),
        ),
        MjcfCameraConfig(
            name="narrow", mjcf_name="wrist_camera", robot_namespace="robot_0/", fov=20
        ),
    ]
    as_compiled = rc.Pose(looking(eye, point, [0, 1, 0]))
    drawn, aims = [], []
    for scene in starts_with(cameras, tmp_path):
        in_world = {camera.name: scene.camera_pose(camera.name) for camera in cameras}
        hand = scene.body_pose("robot_0/hand")
        in_hand = {name: hand.inverse() * pose for name, pose in in_world.items()}
        assert np.allclose(in_world["fixed"].translation, [2, 1, 1.5])
        assert np.allclose(
            in_world["fixed"].rotation[:, 2], np.array([1, 0, 0.5]) / np.hypot(1, 0.5)
        )

        robot = scene.robots[0]
        body = scene.compiled.object("target").root_body
        target = scene.data.subtree_com[scene.model.body(body).id]
        middle = (target + robot.tcp_in_world.translation) / 2
        away = in_world["drawn"].translation - middle
        assert 0.8 <= np.hypot(*away[:2]) <= 1.2
        assert 0.3 <= away[2] <= 0.6
        beyond = middle - robot.base_in_world.translation
        azimuth = np.arctan2(away[1], away[0]) - np.arctan2(beyond[1], beyond[0])
        assert 0 <= azimuth % (2 * np.pi) <= 1
        assert 40 <= scene.model.camera("drawn").fovy[0] <= 50
        drawn.append(away)

        moved = as_compiled.inverse() * in_hand["shifted"]
        assert np.all((moved.translation > 0.01 - 1e-6) & (moved.translation < 0.03 + 1e-6))
        assert moved.angle < 1e-6

        # The camera stays, and its axis hits a point within the range.
        assert np.allclose(in_hand["aimed"].translation, eye, atol=1e-6)
        axis = -in_hand["aimed"].rotation[:, 2]
        nearest, farthest = 0.0, np.inf  # along the axis, where it is in the box of the points
        for low, high, start, slope in zip(point, point + 0.05, eye, axis, strict=True):
            ends = sorted([(low - start) / slope, (high - start) / slope])
            nearest, farthest = max(nearest, ends[0]), min(farthest, ends[1])
        assert nearest <= farthest + 1e-6
        aims.append(axis)

        quarter = rc.Pose(translation=eye, rpy=[0, 0, np.pi / 2])
        turned = quarter.inverse() * in_hand["turned"]
        assert np.allclose(turned.translation, 0, atol=1e-6)
        assert 0 < turned.angle <= np.radians(2)

        own = rc.Pose(translation=EYE, quaternion=[*TURN[1:], TURN[0]])
        moved = own.inverse() * in_hand["own"]
        low, high = np.array([[0, 0.01, -0.02], [0.02, 0.02, -0.01]])
        assert np.all((moved.translation >= low - 1e-6) & (moved.translation <= high + 1e-6))
        assert moved.angle < 1e-6
        assert FOVY + 1 <= scene.model.camera("own").fovy[0] <= FOVY + 3
        assert np.allclose(in_hand["narrow"].matrix, own.matrix, atol=1e-6)
        assert scene.model.camera("narrow").fovy[0] == 20
    assert np.ptp(drawn, axis=0).max() > 0.05
    assert np.ptp(aims, axis=0).max() > 0.01


def test_cameras_that_must_see_the_object_see_it(tmp_path: Path):
    """The share is one of the image, as counted in an image of body ids."""
    share = 0.004
    camera = RandomizedExocentricCameraConfig(
        name="side",
        distance_range=(0.4, 1.5),
        height_range=(0.1, 0.6),
        azimuth_range=(-np.pi, np.pi),
        fov=50,
        visibility_constraints={"__task_objects__": share, "__gripper__": 0.001},
    )
    for scene in starts_with([camera], tmp_path, 2):
        renderer = rc.render.Renderer(scene, backend="soft")
        ids = renderer.render("side", *SIZE, segmentation=True)["segmentation"]
        body = scene.model.body(scene.compiled.object("target").root_body).id
        assert np.mean(ids == body) >= share


def test_conditions_of_all_bodies_are_in_the_run():
    def sees(constraints: dict[str, float], **sampler: Any) -> Any:
        camera = FixedExocentricCameraConfig(
            name="a",
            fov=60,
            pos=[1, 0, 1],
            forward=[-1, 0, 0],
            up=[0, 0, 1],
            visibility_constraints=constraints,
        )
        return cameras_with([camera], **sampler).placed["a"].get("sees")

    given = {"__task_objects__": 0.001, "__gripper__": 0.01, "robot_0/hand": 1, "shelf": 0}
    assert sees(given) == {
        "target": {"pixels": 6},  # of 5184
        "gripper": {"pixels": 52},
        "robot_0/hand": {"pixels": 5184},
    }
    assert sees(given, check_robot_placement_visibility=False) is None
    with pytest.raises(rc.ArgumentError, match=r"camera 'a'.*\['shelf'\]: 1.5 is no share"):
        sees({"shelf": 1.5})


def test_cameras_of_models_keep_what_is_not_changed():
    def of_model(robot: bool, **fields: Any) -> tuple[str, dict[str, Any]]:
        namespace = "robot_0/" if robot else None
        name = "wrist_camera" if robot else "corner"
        fields = {"name": name, "mjcf_name": name, "robot_namespace": namespace} | fields
        found = cameras_with([MjcfCameraConfig(**fields)])
        return found.streams[0].camera, next(iter(found.placed.values()), {})

    for robot in (True, False):
        name, placed = of_model(robot)
        assert (name, placed) == ("wrist_camera" if robot else "corner", {})
        name, placed = of_model(robot, fov=33.0)
        assert placed == {"camera": "wrist_camera" if robot else "corner", "fovy": 33}
        assert name == placed["camera"] + "_of_start"
        _, placed = of_model(
            robot, pos_noise_range=((-0.1, -0.2, 0), (0.1, 0.2, 0)), fov_noise_degrees=(-2, 2)
        )
        assert placed["pos_noise"] == [0.1, 0.2, 0]
        assert placed["fovy_noise"] == 2
        assert "fovy" not in placed
    # A range that is not symmetric moves the middle, where it is known.
    _, placed = of_model(True, pos_noise_range=(0.01, 0.03), fov_noise_degrees=(0, 4), fov=50)
    assert placed["mount"] == "hand"
    assert placed["fovy"] == 52
    assert np.allclose(placed["pos_noise"], 0.01)
    assert np.allclose(of_model(True, fov_noise_degrees=(0, 4), fov=50)[1]["fovy"], 52)
    with pytest.raises(rc.ArgumentError, match="pos_noise_range: for a camera of the scene"):
        of_model(False, pos_noise_range=(0.0, 0.1))
    with pytest.raises(rc.ArgumentError, match="give `fov`"):
        of_model(False, fov_noise_degrees=(0, 4))
    with pytest.raises(rc.ArgumentError, match="about any axis: give one number, such as 3"):
        of_model(True, orientation_noise_degrees=(1, 2, 3))
    with pytest.raises(rc.ArgumentError, match=r"fov_noise_degrees: \(4.0, 0.0\) is not"):
        of_model(True, fov_noise_degrees=(4, 0))


def test_cameras_of_the_scene_have_the_lens_and_the_noise_of_the_experiment(tmp_path: Path):
    (tmp_path / "room.xml").write_text(ROOM)
    cameras = [
        MjcfCameraConfig(name="narrow", mjcf_name="corner", fov=25),
        MjcfCameraConfig(name="corner", mjcf_name="corner", pos_noise_range=(-0.1, 0.1)),
    ]
    scenes = {"source": "files", "files": [str(tmp_path / "room.xml")]}
    (scene,) = starts_with(cameras, tmp_path, 1, scenes)
    own, narrow, moved = (
        scene.camera_pose(name) for name in ("corner", "narrow", "corner_of_start")
    )
    fovy = {
        name: scene.model.camera(name).fovy[0] for name in ("corner", "narrow", "corner_of_start")
    }
    assert fovy == {"corner": 70, "narrow": 25, "corner_of_start": 70}
    assert np.allclose(narrow.matrix, own.matrix)
    offset = (own.inverse() * moved).translation
    assert 0 < np.abs(offset).max() <= 0.1


def test_a_camera_of_a_models_name_does_not_replace_it(tmp_path: Path):
    """A stream of the model's camera shows it, beside another camera of its name."""
    mounted = RobotMountedCameraConfig(name="wrist_camera", reference_body_names=["hand"], fov=30)
    plain = MjcfCameraConfig(name="plain", mjcf_name="wrist_camera", robot_namespace="robot_0/")
    experiment = experiment_with([mounted, plain])
    streams = cameras_of(experiment, write_robot(experiment.robot_config, tmp_path)).streams
    (scene,) = starts_with([mounted, plain], tmp_path, 1)
    there = {scene.model.camera(i).name for i in range(scene.model.ncam)}
    assert there == {"robot_0/wrist_camera", "wrist_camera_of_start"}
    # A stream names a camera of the scene, else one of the robot.
    assert [stream.camera for stream in streams] == ["wrist_camera_of_start", "wrist_camera"]


def test_a_camera_that_the_scene_lacks_is_named(tmp_path: Path):
    camera = MjcfCameraConfig(name="top", mjcf_name="ceiling_camera", pos_noise_range=(-0.1, 0.1))
    with pytest.raises(rc.NotFoundError, match=r"camera 'top'.*ceiling_camera.*wrist_camera"):
        next(starts_with([camera], tmp_path))


def test_fields_that_are_not_taken_over_are_reported():
    around = {
        "name": "a",
        "distance_range": (1, 2),
        "height_range": (0, 1),
        "azimuth_range": (0, 1),
        "fov": 60,
    }
    relaxed = around | {
        "allow_relaxed_constraints": True,
        "visibility_constraints": {"__gripper__": 0.1},
    }
    with pytest.warns(UserWarning, match=r"camera 'a'.*allow_relaxed_constraints has no effect"):
        cameras_with([RandomizedExocentricCameraConfig(**relaxed)])
    lopsided = around | {"lookat_noise_range": (0, 0.1)}
    with pytest.raises(rc.ArgumentError, match="lookat_noise_range: give a range that is symm"):
        cameras_with([RandomizedExocentricCameraConfig(**lopsided)])
    mounted = RobotMountedCameraConfig(
        name="b",
        reference_body_names=["hand"],
        camera_quaternion=[1, 0, 0, 0],
        lookat_noise_range=(-0.1, 0.1),
        fov=60,
    )
    with pytest.warns(UserWarning, match="lookat_noise_range has no effect with camera_quat"):
        cameras_with([mounted])


def test_robots_without_an_arm_have_cameras_too():
    camera = RandomizedExocentricCameraConfig(
        name="a", distance_range=(1, 2), height_range=(0, 1), azimuth_range=(0, 1), fov=60
    )
    found = cameras_of(experiment_with([camera], ToyConfig()), rc.RobotConfig())
    assert found.placed["a"]["around"] == ["target"]
