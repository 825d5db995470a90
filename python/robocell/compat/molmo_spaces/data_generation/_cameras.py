"""The cameras of an experiment as those of a run: image streams, and `start.cameras`.

A camera of the robot's model that nothing changes is named by its stream. Every other one is
placed by robocell in each start, and is in the scene that an episode records.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell._suggestions import did_you_mean, shortened
from robocell.compat.molmo_spaces._assembly import compile_alone
from robocell.compat.molmo_spaces._elements import look_up
from robocell.compat.molmo_spaces.configs.camera_configs import (
    FixedExocentricCameraConfig,
    MjcfCameraConfig,
    RandomizedExocentricCameraConfig,
    RobotMountedCameraConfig,
)
from robocell.compat.molmo_spaces.data_generation._robot_files import PREFIX, own_name
from robocell.compat.molmo_spaces.utils.pose import pos_quat_to_pose_mat, pose_mat_to_pos_quat

Numbers = NDArray[np.float64]
# What the original calls the objects of the task and the gripper in `visibility_constraints`.
MEANT = {"__task_objects__": "target", "__gripper__": "gripper"}


@dataclass
class Cameras:
    """The cameras of a run.

    Attributes:
        streams: Their image streams.
        placed: Fields of `start.cameras` by name.
    """

    streams: list[rc.render.CameraConfig] = field(default_factory=list)
    placed: dict[str, dict[str, Any]] = field(default_factory=dict)


def cameras_of(experiment: Any, robot: rc.RobotConfig) -> Cameras:
    """Returns the cameras of an experiment with this robot.

    Raises NotFoundError and ArgumentError, with camera and field, for what there is not.
    """
    model, _, _ = compile_alone(experiment.robot_config, PREFIX)
    own = {own_name(model, "camera", i) for i in range(model.ncam)}
    found = Cameras()
    for camera in experiment.camera_config.cameras:
        where = f"camera '{camera.name}' ({type(experiment.camera_config).__name__})"
        name = camera.name
        if isinstance(camera, MjcfCameraConfig):
            fields = _of_model(camera, model, where)
        elif isinstance(camera, RobotMountedCameraConfig):
            fields = _mounted(camera, model, where)
        elif isinstance(camera, FixedExocentricCameraConfig):
            fields = _fixed(camera, where)
        else:
            fields = _around(camera, _has_arm(robot), where)
        sees = _sees(camera, experiment, where)
        if sees:
            fields["sees"] = sees
        if fields.keys() == {"camera"}:
            name = fields["camera"]
        else:
            if name in own or name == fields.get("camera"):
                name = f"{name}_of_start"  # the models have a camera of its own name
            found.placed[name] = fields
        found.streams.append(
            rc.render.CameraConfig(name=camera.name, camera=name, depth=camera.record_depth)
        )
    return found


def looking(eye: Any, point: Any, up: Any, where: str = "camera") -> Numbers:
    """Returns the pose (4, 4) of a camera at `eye` that looks at `point`, along its -z axis.

    Its y axis, up in the image, is nearest to the direction `up`. Raises ArgumentError where the
    camera looks along it.
    """
    eye = np.asarray(eye, dtype=np.float64)
    back = eye - np.asarray(point, dtype=np.float64)
    right = np.cross(np.asarray(up, dtype=np.float64), back)
    if np.linalg.norm(right) < 1e-9:
        raise rc.ArgumentError(
            f"{where}: it looks along the direction that is up, {list(up)}, so that nothing is up "
            "in the image; choose another one"
        )
    z, x = back / np.linalg.norm(back), right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = eye
    return pose


def _of_model(camera: MjcfCameraConfig, model: mujoco.MjModel, where: str) -> dict[str, Any]:
    """Returns a camera of the robot's model or of the scene; `camera` alone without changes."""
    is_robots = camera.robot_namespace is not None
    own = [own_name(model, "camera", i) for i in range(model.ncam)]
    if is_robots and camera.mjcf_name not in own:
        raise rc.NotFoundError(
            f"{where}: the robot's model has no camera '{camera.mjcf_name}'. Its cameras: "
            f"{shortened(own) or 'none'}.{did_you_mean(camera.mjcf_name, own)} Add "
            '<camera name="..."> to a body of the MJCF, or use RobotMountedCameraConfig'
        )
    shift, offset = _spread(camera.pos_noise_range, f"{where}: pos_noise_range")
    (fov_shift, *_), (fov_noise, *_) = _spread(
        camera.fov_noise_degrees, f"{where}: fov_noise_degrees"
    )
    fields: dict[str, Any] = {"camera": camera.mjcf_name}
    fov = camera.fov
    if fov_shift or (shift.any() and is_robots):
        fov = _lens(camera, model, own, where) + fov_shift
    if shift.any():
        if not is_robots:
            raise rc.ArgumentError(
                f"{where}: pos_noise_range: for a camera of the scene, give a range that is "
                f"symmetric about 0, such as {(-float(offset.max()), float(offset.max()))}"
            )
        number = own.index(camera.mjcf_name)
        pose = pos_quat_to_pose_mat(model.cam_pos[number], model.cam_quat[number])
        body = own_name(model, "body", model.cam_bodyid[number])
        fields = {"mount": body} | _at(pose[:3, 3] + pose[:3, :3] @ shift, pose)
    if fov is not None:
        fields["fovy"] = float(fov)
    return fields | _noise(camera, offset, fov_noise, where)


def _lens(camera: MjcfCameraConfig, model: mujoco.MjModel, own: list[str], where: str) -> float:
    """Returns the vertical field of view of a camera without noise, degrees."""
    if camera.fov is not None:
        return camera.fov
    if camera.robot_namespace is not None:
        number = own.index(camera.mjcf_name)
        if not model.cam_sensorsize[number].any():
            return float(model.cam_fovy[number])
    raise rc.ArgumentError(
        f"{where}: the ranges of its noise are not symmetric about 0, and the field of view is "
        "only in its model: give `fov`, degrees"
    )


def _mounted(camera: RobotMountedCameraConfig, model: mujoco.MjModel, where: str) -> dict[str, Any]:
    bodies = [own_name(model, "body", i) for i in range(model.nbody)]
    body = next((each for each in camera.reference_body_names if each in bodies), None)
    if body is None:
        wanted = camera.reference_body_names
        near = did_you_mean(wanted[0], bodies) if wanted else ""
        raise rc.NotFoundError(
            f"{where}: the robot has none of the bodies {', '.join(wanted) or '(none)'}.{near}"
        )
    fields: dict[str, Any] = {"mount": body, "fovy": _own_fov(camera, where)}
    shift, offset = _spread(camera.pos_noise_range, f"{where}: pos_noise_range")
    noise = _noise(camera, offset, 0, where)
    if camera.camera_quaternion is not None:
        if camera.lookat_noise_range is not None:
            warnings.warn(
                f"{where}: lookat_noise_range has no effect with camera_quaternion", stacklevel=2
            )
        quaternion = np.asarray(camera.camera_quaternion, dtype=np.float64)
        pose = pos_quat_to_pose_mat(camera.camera_offset, quaternion / np.linalg.norm(quaternion))
        return fields | _at(pose[:3, 3] + pose[:3, :3] @ shift, pose) | noise
    up = dict(zip("xyz", np.eye(3).tolist(), strict=True))
    axis = look_up(up, camera.up_axis, f"{where}: up_axis")
    looks_shift, looks_noise = _spread(camera.lookat_noise_range, f"{where}: lookat_noise_range")
    point = np.asarray(camera.lookat_offset, dtype=np.float64) + looks_shift
    pose = looking(camera.camera_offset, point, axis, where)
    moved = pose[:3, :3] @ shift
    return (
        fields
        | {"pos": _listed(pose[:3, 3] + moved), "look_at": _listed(point + moved), "up": axis}
        | ({"look_at_noise": float(looks_noise[0])} if looks_noise[0] else {})
        | noise
    )


def _fixed(camera: FixedExocentricCameraConfig, where: str) -> dict[str, Any]:
    shift, offset = _spread(camera.pos_noise_range, f"{where}: pos_noise_range")
    pose = looking(camera.pos, np.add(camera.pos, camera.forward), camera.up, where)
    at = _at(pose[:3, 3] + pose[:3, :3] @ shift, pose)
    return {"fovy": _own_fov(camera, where)} | at | _noise(camera, offset, 0, where)


def _around(camera: RandomizedExocentricCameraConfig, has_arm: bool, where: str) -> dict[str, Any]:
    (looks_shift, *_), (looks_noise, *_) = _spread(
        camera.lookat_noise_range, f"{where}: lookat_noise_range"
    )
    if looks_shift:
        raise rc.ArgumentError(
            f"{where}: lookat_noise_range: give a range that is symmetric about 0, such as "
            f"{(-float(looks_noise), float(looks_noise))}"
        )
    if camera.allow_relaxed_constraints and camera.visibility_constraints:
        warnings.warn(
            f"{where}: allow_relaxed_constraints has no effect: a start is refused if none of "
            f"{camera.max_placement_attempts} places satisfies visibility_constraints",
            stacklevel=2,
        )
    if camera.fov_range is not None:
        (fov, *_), (fov_noise, *_) = _spread(camera.fov_range, f"{where}: fov_range")
    else:
        fov, fov_noise = _own_fov(camera, where), 0
    fields = {
        "around": ["target", "gripper"] if has_arm else ["target"],
        "distance": list(camera.distance_range),
        "height": list(camera.height_range),
        "azimuth": [math.degrees(angle) for angle in camera.azimuth_range],
        "fovy": float(fov),
        "tries": camera.max_placement_attempts,
    }
    if looks_noise:
        fields["look_at_noise"] = float(looks_noise)
    return fields | _noise(camera, np.zeros(3), fov_noise, where)


def _has_arm(robot: rc.RobotConfig) -> bool:
    return any(group.kind == rc.robots.MoveGroupKind.ARM for group in robot.move_groups.values())


def _own_fov(camera: Any, where: str) -> float:
    if camera.fov is None:
        raise rc.ArgumentError(f"{where}: fov is not set: give the vertical field of view, degrees")
    return float(camera.fov)


def _at(position: Numbers, pose: Numbers) -> dict[str, Any]:
    """Returns the fields of a pose (4, 4), with another position."""
    w, x, y, z = pose_mat_to_pos_quat(pose)[1]
    return {"pos": _listed(position), "quat": _listed([x, y, z, w])}


def _listed(numbers: Any) -> list[float]:
    return [float(number) for number in numbers]


def _noise(camera: Any, offset: Numbers, fov_noise: float, where: str) -> dict[str, Any]:
    """Returns the noise about the axes of a camera and of its lens."""
    fields: dict[str, Any] = {}
    if offset.any():
        fields["pos_noise"] = _listed(offset)
    most = getattr(camera, "orientation_noise_degrees", None)
    if most:
        angles = np.broadcast_to(most, 3)
        if np.ptp(angles):
            raise rc.ArgumentError(
                f"{where}: orientation_noise_degrees: robocell turns a camera about any axis: "
                f"give one number, such as {float(angles.max()):g}"
            )
        fields["rotation_noise"] = float(angles[0])
    if fov_noise:
        fields["fovy_noise"] = float(fov_noise)
    return fields


def _spread(bounds: Any, where: str) -> tuple[Numbers, Numbers]:
    """Returns the middle (3,) and half the width (3,) of (smallest, largest); zeros for None."""
    if bounds is None:
        return np.zeros(3), np.zeros(3)
    low, high = (np.broadcast_to(np.asarray(bound, dtype=np.float64), 3) for bound in bounds)
    if not np.all(low <= high):
        raise rc.ArgumentError(f"{where}: {bounds} is not (smallest, largest)")
    middle, half = (low + high) / 2, (high - low) / 2
    # What rounding leaves of a symmetric range is no shift.
    return np.where(np.abs(middle) > 1e-12 * half, middle, 0), half


def _sees(camera: Any, experiment: Any, where: str) -> dict[str, dict[str, int]]:
    """Returns the fewest pixels of the image that have to show each object, body or gripper."""
    if not experiment.task_sampler_config.check_robot_placement_visibility:
        return {}
    width, height = experiment.camera_config.img_resolution
    namespace = experiment.robot_config.robot_namespace
    sees = {}
    for name, share in (camera.visibility_constraints or {}).items():
        if not 0 <= share <= 1:
            raise rc.ArgumentError(
                f"{where}: visibility_constraints['{name}']: {share:g} is no share of the image, "
                "0 to 1"
            )
        meant = MEANT.get(name, name)
        if namespace and meant.startswith(namespace):
            meant = PREFIX + meant.removeprefix(namespace)
        pixels = math.ceil(share * width * height)
        if pixels:
            sees[meant] = {"pixels": pixels}
    return sees
