"""The base class of robots: view, kinematics, controllers, and how they get into a model."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces.controllers.abstract import (
    AbstractPositionController,
    Controller,
)
from robocell.compat.molmo_spaces.robots.robot_views.abstract import RobotView
from robocell.compat.molmo_spaces.utils.pose import pos_quat_to_pose_mat

if TYPE_CHECKING:
    from robocell.compat.molmo_spaces.configs.robot_configs import ActionNoiseConfig
    from robocell.compat.molmo_spaces.env.abstract_sensors import Sensor
    from robocell.compat.molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
    from robocell.compat.molmo_spaces.kinematics.parallel.parallel_kinematics import (
        ParallelKinematics,
    )

__all__ = ["Robot"]

Numbers = NDArray[np.float64]


class Robot(abc.ABC):
    """A robot in a `mujoco.MjData`.

    Subclasses define `namespace`, `robot_view`, `kinematics`, `parallel_kinematics`, `controllers`,
    `reset` and `robot_model_root_name`.

    Attributes:
        mj_model: The model.
        mj_data: The data.
        exp_config: The experiment, whose `robot_config` is this robot's.
        rng: The generator of action noise; set one with a seed to repeat it.
    """

    def __init__(self, mj_data: mujoco.MjData, exp_config: Any) -> None:
        """Keeps data and experiment."""
        self.mj_model: mujoco.MjModel = mj_data.model
        self.mj_data = mj_data
        self.exp_config = exp_config
        self.rng = np.random.default_rng()
        self._last_unnoised_cmd_joint_pos: dict[str, Numbers] | None = None

    @property
    @abc.abstractmethod
    def namespace(self) -> str:
        """Prefix of the robot's names in the model."""

    @property
    @abc.abstractmethod
    def robot_view(self) -> RobotView:
        """The move groups."""

    @property
    @abc.abstractmethod
    def kinematics(self) -> MlSpacesKinematics:
        """Kinematics of single poses."""

    @property
    @abc.abstractmethod
    def parallel_kinematics(self) -> ParallelKinematics:
        """Kinematics of many poses."""

    @property
    @abc.abstractmethod
    def controllers(self) -> dict[str, Controller]:
        """A controller for each group that is driven."""

    @abc.abstractmethod
    def reset(self) -> None:
        """Puts the groups where they begin."""

    @staticmethod
    @abc.abstractmethod
    def robot_model_root_name() -> str:
        """Name of the root body in the robot's own model."""

    def create_robot_sensors(self) -> list[Sensor]:
        """Returns the robot's own sensors, which runs record as features. Default: none."""
        return []

    def get_arm_move_group_ids(self) -> list[str]:
        """Returns the groups whose commands get noise that is bounded at the TCP. Default: none."""
        return []

    def update_control(self, action_command_dict: Mapping[str, ArrayLike | None]) -> None:
        """Sets the targets of the controllers, with noise on arms; groups that are missing hold.

        The targets without noise are kept for `last_unnoised_cmd_joint_pos`.
        """
        self._set_targets(action_command_dict)
        self._last_unnoised_cmd_joint_pos = {
            name: controller.target_pos.copy()
            for name, controller in self.controllers.items()
            if isinstance(controller, AbstractPositionController)
        }
        noisy = self.apply_action_noise(action_command_dict)
        if noisy is not action_command_dict:
            self._set_targets(noisy)

    def compute_control(self) -> None:
        """Writes the controls of all controllers into the data."""
        for controller in self.controllers.values():
            controller.robot_move_group.ctrl = controller.compute_ctrl_inputs()

    def last_unnoised_cmd_joint_pos(self) -> dict[str, Numbers] | None:
        """Returns the targets of the last action without noise; None before the first one."""
        kept = self._last_unnoised_cmd_joint_pos
        return None if kept is None else {name: target.copy() for name, target in kept.items()}

    def apply_action_noise(self, action: Mapping[str, Any]) -> Mapping[str, Any]:
        """Returns the action with noise on its arms, in proportion to the motion of the TCP.

        Without noise, or where there is nothing to add, it returns `action` itself.
        """
        noise: ActionNoiseConfig = self.exp_config.robot_config.action_noise_config
        arms = [name for name in self.get_arm_move_group_ids() if action.get(name) is not None]
        if not noise.enabled or not arms:
            return action
        return {**action, **{name: self._noisy(name, action[name], noise) for name in arms}}

    def set_joint_pos(self, robot_joint_pos_dict: Mapping[str, ArrayLike]) -> None:
        """Sets the joint positions of the groups in it."""
        self.robot_view.set_qpos_dict(dict(robot_joint_pos_dict))

    def set_world_pose(self, robot_world_pose: ArrayLike) -> None:
        """Puts the base at a pose (4, 4), at x, y and yaw (3,), or at xyz and wxyz (7,)."""
        pose = np.asarray(robot_world_pose, dtype=np.float64)
        if pose.shape == (3,):
            half = pose[2] / 2
            pose = pos_quat_to_pose_mat([*pose[:2], 0], [np.cos(half), 0, 0, np.sin(half)])
        elif pose.shape == (7,):
            pose = pos_quat_to_pose_mat(pose[:3], pose[3:])
        if pose.shape != (4, 4):
            raise rc.ArgumentError(
                "set_world_pose: expected a matrix (4, 4), x, y, yaw (3,) or xyz, wxyz (7,), got "
                f"an array of shape {pose.shape}"
            )
        self.robot_view.base.pose = pose

    def set_stationary(self) -> None:
        """Holds every group where it is."""
        for controller in self.controllers.values():
            if not controller.stationary:
                controller.set_to_stationary()

    @classmethod
    def add_robot_to_scene(
        cls,
        robot_config: Any,
        spec: mujoco.MjSpec,
        prefix: str,
        pos: list[float],
        quat: list[float],
        randomize_textures: bool = False,
        strip_meshes: bool = False,
    ) -> None:
        """Attaches the robot's model to a spec at `pos` (2 or 3 numbers, m) and `quat` (wxyz).

        The names of the model get `prefix`. `strip_meshes` leaves geoms of meshes out, with masses
        and inertias as they are. `randomize_textures` has no effect on models without textures.
        """
        del randomize_textures
        at = [*pos, 0.0] if len(pos) == 2 else pos
        frame = spec.worldbody.add_frame(pos=at, quat=quat)
        robot_spec = cls._load_robot_spec(robot_config, strip_meshes=strip_meshes)
        frame.attach_body(cls._root_of(robot_spec), prefix, "")

    @classmethod
    def apply_control_overrides(cls, spec: mujoco.MjSpec, robot_config: Any) -> None:
        """Applies gravcomp, gains and force limits of the configuration to the robot in a spec.

        Gains and limits are those of the robot's own actuators, in their order.
        """
        namespace = robot_config.robot_namespace
        root = spec.body(namespace + cls.robot_model_root_name())
        if root is None:
            raise rc.NotFoundError(
                f"no body '{namespace}{cls.robot_model_root_name()}' in the scene: add the robot "
                f"with the prefix '{namespace}' first (robot_namespace)"
            )
        if robot_config.gravcomp:
            for body in [root, *root.find_all("body")]:
                body.gravcomp = 1.0
        own = [each for each in spec.actuators if each.name.startswith(namespace)]
        for field in ("K_stiffness", "K_damping", "force_limit"):
            values = getattr(robot_config, field)
            if values is not None and len(values) > len(own):
                raise rc.ArgumentError(
                    f"{type(robot_config).__name__}.{field}: {len(values)} values for "
                    f"{len(own)} actuators ({', '.join(each.name for each in own)})"
                )
        for actuator, gain in zip(own, robot_config.K_stiffness or (), strict=False):
            actuator.gainprm[0], actuator.biasprm[1] = gain, -gain
        for actuator, gain in zip(own, robot_config.K_damping or (), strict=False):
            actuator.biasprm[2] = -gain
        for actuator, limit in zip(own, robot_config.force_limit or (), strict=False):
            actuator.forcelimited = 1
            actuator.forcerange = [-limit, limit]

    @classmethod
    def _load_robot_spec(cls, robot_config: Any, strip_meshes: bool = False) -> mujoco.MjSpec:
        """Reads the robot's model; its files have absolute paths, so that it can be attached."""
        from robocell.compat.molmo_spaces._assembly import load_spec, without_meshes

        spec = load_spec(robot_config.get_robot_xml_path())
        return without_meshes(spec) if strip_meshes else spec

    @classmethod
    def _root_of(cls, robot_spec: mujoco.MjSpec) -> mujoco.MjsBody:
        root = robot_spec.body(cls.robot_model_root_name())
        if root is None:
            names = [body.name for body in robot_spec.bodies if body.name != "world"]
            raise rc.NotFoundError(
                f"{cls.__name__}.robot_model_root_name: no body '{cls.robot_model_root_name()}'. "
                f"Bodies of the model: {', '.join(names)}"
            )
        return root

    def _set_targets(self, action: Mapping[str, Any]) -> None:
        unknown = set(action) - set(self.controllers) - {"done", "success"}
        if unknown:
            raise rc.NotFoundError(
                f"action: no controller for '{min(unknown)}'. Controllers: "
                f"{', '.join(self.controllers)}"
            )
        for name, controller in self.controllers.items():
            if action.get(name) is not None:
                controller.set_target(action[name])
            elif not controller.stationary:
                controller.set_to_stationary()

    def _noisy(self, name: str, command: ArrayLike, noise: ActionNoiseConfig) -> Numbers:
        group = self.robot_view.get_move_group(name)
        wanted = np.asarray(command, dtype=np.float64)
        relative = self.exp_config.robot_config.command_mode.get(name) == "joint_rel_position"
        change = wanted if relative else wanted - group.joint_pos
        jacobian = self.robot_view.get_jacobian(name, [name])
        spread = noise.action_scale_factor * float(np.linalg.norm((jacobian @ change)[:3]))
        at_tcp = [
            *self._truncated(spread, noise.max_tcp_position_noise),
            *self._truncated(spread * noise.rotation_noise_scale, noise.max_tcp_rotation_noise),
        ]
        moved = wanted + np.linalg.lstsq(jacobian, np.array(at_tcp), rcond=None)[0]
        start = group.joint_pos if relative else 0.0
        low, high = group.joint_pos_limits.T
        return np.clip(moved + start, low, high) - start

    def _truncated(self, spread: float, most: float, count: int = 3) -> Sequence[float]:
        """Draws from a normal distribution, again where a value is beyond `most`."""
        if spread <= 0 or most <= 0:
            return [0.0] * count
        drawn: list[float] = []
        while len(drawn) < count:
            if spread < most:
                value = self.rng.normal(0, spread)
                is_kept = abs(value) <= most
            else:  # uniform draws, kept in proportion to the density: 60 % and more of them
                value = self.rng.uniform(-most, most)
                is_kept = self.rng.uniform() < np.exp(-0.5 * (value / spread) ** 2)
            if is_kept:
                drawn.append(float(value))
        return drawn
