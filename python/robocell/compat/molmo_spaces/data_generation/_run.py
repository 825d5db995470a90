"""An experiment of the original's classes as a run of robocell: a folder with its run file."""

from __future__ import annotations

import inspect
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import robocell as rc
from robocell._suggestions import did_you_mean
from robocell.compat.molmo_spaces._assembly import compile_alone
from robocell.compat.molmo_spaces._elements import look_up
from robocell.compat.molmo_spaces.configs.camera_configs import (
    MjcfCameraConfig,
    RobotMountedCameraConfig,
)
from robocell.compat.molmo_spaces.configs.task_sampler_configs import set_without_effect
from robocell.compat.molmo_spaces.data_generation._cameras import looking
from robocell.compat.molmo_spaces.data_generation._robot_files import (
    PREFIX,
    file_name,
    own_name,
    write_robot,
)
from robocell.compat.molmo_spaces.data_generation._sampler import sampler_class, sampler_kind
from robocell.compat.molmo_spaces.env.env import CPUMujocoEnv

SENSORS = '''"""Features of the experiment '{name}': the sensors of its robot."""

from robocell.compat.molmo_spaces.data_generation._sampler import register_sensors

register_sensors({name!r}, {sensors!r})
'''
OBJECT = "__task_objects__"


def write_run(name: str, experiment: Any, folder: Path | None = None) -> Path:
    """Writes the run of a registered experiment: run file, robot and sensors. Returns the run file.

    Args:
        name: The name that the experiment is registered under.
        experiment: The experiment.
        folder: Where the files go. None: beside the dataset, `<output_dir>/<name>.run`.

    Raises SpecError, ArgumentError or NotFoundError with the field for what cannot be taken over.
    """
    folder = folder or Path(experiment.output_dir) / f"{name}.run"
    folder = folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    _warn_of_unused(experiment)
    robot = write_robot(experiment.robot_config, folder)
    streams = streams_of(experiment, robot)
    sensors = _sensors(experiment)
    module = inspect.getfile(type(experiment))
    imports = [str(Path(module).absolute())]
    if sensors:
        file = folder / f"{file_name(name)}_sensors.py"
        file.write_text(SENSORS.format(name=name, sensors=sensors))
        imports.append(str(file))
    sampler = experiment.task_sampler_config
    sampler_class(experiment)
    task: dict[str, Any] = {"kind": "pick"}
    if sampler.pickup_types is not None:
        task["objects"] = list(sampler.pickup_types)
    noise = (sampler.robot_object_z_offset_random_min, sampler.robot_object_z_offset_random_max)
    run = rc.RunConfig(
        run=experiment.tag,
        robot=robot,
        task=task,
        start={
            "base_distance": list(sampler.base_pose_sampling_radius_range),
            "base_height_offset": sampler.robot_object_z_offset,
            "base_height_noise": list(noise),
            "base_facing_noise": sampler.robot_placement_rotation_range_rad,
            **_visibility(experiment),
        },
        sampler=sampler_kind(name),
        scenes=_scenes(experiment),
        cameras={"resolution": list(experiment.camera_config.img_resolution), "streams": streams},
        features=[uuid for uuid, _, _ in sensors],
        rates={
            "policy_ms": experiment.policy_dt_ms,
            "control_ms": experiment.ctrl_dt_ms,
            "sim_ms": experiment.sim_dt_ms,
            "max_steps": experiment.task_horizon,
        },
        keep="successes" if experiment.filter_for_successful_trajectories else "all",
        workers=experiment.num_workers,
        seed=experiment.seed or 0,
        output=str((Path(experiment.output_dir) / name).absolute()),
        imports=imports,
    )
    if sampler.samples_per_house is not None:
        run.episodes_per_scene = sampler.samples_per_house
        # Robocell counts the attempts at each episode.
        run.max_attempts = max(run.max_attempts, sampler.max_total_attempts_multiplier)
    if math.isfinite(sampler.max_tasks):
        run.episodes = int(sampler.max_tasks)
    path = folder / "run.yaml"
    path.write_text(run.to_yaml())
    return path


def _scenes(experiment: Any) -> dict[str, Any]:
    """Returns the source of scenes: the set of houses, else the built-in ones."""
    sampler = experiment.task_sampler_config
    own = type(sampler).model_fields["dataset_name"].default
    name = sampler.dataset_name if sampler.dataset_name != own else experiment.scene_dataset
    if name == "user" or sampler.scene_xml_paths:
        if not sampler.scene_xml_paths:
            raise rc.ArgumentError(
                "task_sampler_config.scene_xml_paths: dataset_name='user' needs the paths of your "
                "MJCF files there"
            )
        files = [str(Path(file).absolute()) for file in sampler.scene_xml_paths]
        return _numbered({"source": "files", "files": files}, sampler.house_inds)
    houses: dict[str, Any] = {
        "source": "houses",
        "dataset": name,
        "split": experiment.data_split,
        "ceiling": sampler.house_variant == "ceiling",
    }
    try:
        _source_of(houses)
    except rc.Error as error:
        built_in = _numbered({"source": "houses"}, sampler.house_inds)
        size = _source_of({"source": "houses"}).size()
        most = max(sampler.house_inds or [0])
        if size is not None and most >= size:
            built_in["houses"] = sorted({index % size for index in sampler.house_inds})
        warnings.warn(
            f"the houses '{name}' are not on this machine; robocell's {size} built-in houses take "
            f"their place. To use '{name}', put it into a folder of ROBOCELL_SCENE_PATH. {error}",
            stacklevel=2,
        )
        return built_in
    return _numbered(houses, sampler.house_inds)


def _source_of(scenes: dict[str, Any]) -> rc.scenes.SceneSource:
    """Returns a source of scenes. Raises Error, with the places, for a set that is not there."""
    return rc.scenes.make_scene_source(rc.RunConfig(scenes=scenes))


def _numbered(source: dict[str, Any], numbers: list[int] | None) -> dict[str, Any]:
    return source if numbers is None else source | {"houses": list(numbers)}


def streams_of(experiment: Any, robot: rc.RobotConfig) -> list[rc.render.CameraConfig]:
    """Returns an image stream for each camera; adds those on bodies to the robot."""
    model, _, _ = compile_alone(experiment.robot_config, PREFIX)
    bodies = [own_name(model, "body", i) for i in range(model.nbody)]
    own_cameras = [own_name(model, "camera", i) for i in range(model.ncam)]
    streams = []
    for camera in experiment.camera_config.cameras:
        name = camera.name
        where = f"camera '{name}' ({type(experiment.camera_config).__name__})"
        if isinstance(camera, MjcfCameraConfig):
            source = camera.mjcf_name
            if camera.robot_namespace is not None and source not in own_cameras:
                raise rc.NotFoundError(
                    f"{where}: the robot's model has no camera '{source}'. Its cameras: "
                    f"{', '.join(own_cameras) or 'none'}.{did_you_mean(source, own_cameras)} Add "
                    '<camera name="..."> to a body of the MJCF, or use RobotMountedCameraConfig'
                )
            if camera.fov is not None and camera.robot_namespace is not None:
                robot.edits.append(rc.robots.Edit(camera=source, fovy=camera.fov))
        elif isinstance(camera, RobotMountedCameraConfig):
            source = name
            robot.cameras.append(_mounted(camera, bodies, where))
        else:
            source = name
            robot.cameras.append(_beside(camera, robot.root_body, where))
        streams.append(rc.render.CameraConfig(name=name, camera=source, depth=camera.record_depth))
    return streams


def _mounted(
    camera: RobotMountedCameraConfig, bodies: list[str], where: str
) -> rc.render.CameraSpec:
    body = next((each for each in camera.reference_body_names if each in bodies), None)
    if body is None:
        wanted = camera.reference_body_names
        near = did_you_mean(wanted[0], bodies) if wanted else ""
        raise rc.NotFoundError(
            f"{where}: the robot has none of the bodies {', '.join(wanted) or '(none)'}.{near}"
        )
    if camera.fov is None:
        raise rc.ArgumentError(f"{where}: fov is not set: give the vertical field of view, degrees")
    spec = rc.render.CameraSpec(
        name=camera.name,
        pos=camera.camera_offset,
        fovy=camera.fov,
        attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Body, body),
    )
    if camera.camera_quaternion is not None:
        w, x, y, z = np.asarray(camera.camera_quaternion) / np.linalg.norm(camera.camera_quaternion)
        spec.quat = [x, y, z, w]
    else:
        up = dict(zip("xyz", np.eye(3).tolist(), strict=True))
        axis = look_up(up, camera.up_axis, f"{where}: up_axis")
        pose = looking(camera.camera_offset, camera.lookat_offset, axis, where)
        spec.quat = list(rc.Pose(pose).quaternion)
    return spec


def _beside(camera: Any, base: str, where: str) -> rc.render.CameraSpec:
    """Returns a camera on the base, which each start puts where it belongs."""
    fov_range = getattr(camera, "fov_range", None)
    if camera.fov is None and fov_range is None:
        raise rc.ArgumentError(f"{where}: fov is not set: give the vertical field of view, degrees")
    return rc.render.CameraSpec(
        name=camera.name,
        pos=[1, 1, 1],
        look_at=[0, 0, 0],
        fovy=camera.fov if fov_range is None else float(np.mean(fov_range)),
        attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Body, base),
    )


def _visibility(experiment: Any) -> dict[str, Any]:
    """Returns the cameras that have to see the object, and the largest share they ask for."""
    if not experiment.task_sampler_config.check_robot_placement_visibility:
        return {}
    shares = {
        camera.name: camera.visibility_constraints[OBJECT]
        for camera in experiment.camera_config.cameras
        if camera.visibility_constraints and OBJECT in camera.visibility_constraints
    }
    if not shares:
        return {}
    return {"visible_from": list(shares), "visible_share": max(shares.values())}


def _sensors(experiment: Any) -> list[tuple[str, tuple[int, ...], str]]:
    """Returns uuid, shape and unit of the sensors of the robot, which it is asked for once."""
    config = experiment.robot_config
    if config.robot_factory is None:
        return []
    model, data, _ = compile_alone(config, config.robot_namespace)
    env = CPUMujocoEnv(experiment, model, data)
    found = []
    for sensor in env.current_robot.create_robot_sensors():
        shape = np.asarray(sensor.get_observation(env, None, 0)).shape
        found.append((sensor.uuid, shape, getattr(sensor, "unit", "1")))
    return found


def _warn_of_unused(experiment: Any) -> None:
    unused = set_without_effect(experiment.task_sampler_config)
    if unused:
        warnings.warn(
            f"task_sampler_config: {', '.join(unused)} have no effect in robocell", stacklevel=2
        )
    libraries = experiment.task_sampler_config.grasp_libraries or []
    known = rc.tasks.grasp_libraries()
    for library in libraries:
        if library not in known:
            warnings.warn(
                f"task_sampler_config.grasp_libraries: '{library}' is not registered; robocell "
                "computes grasps where it has none",
                stacklevel=2,
            )
