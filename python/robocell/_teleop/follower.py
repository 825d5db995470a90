"""Lets an arm follow the motions of a device, within its limits and without collisions."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import (
    ArgumentError,
    CollisionFilter,
    Error,
    GroupCommand,
    MotionPlanner,
    NotFoundError,
    Pose,
    Robot,
    Scene,
)
from robocell._suggestions import did_you_mean
from robocell._teleop.device import FRAMES, Motion

# The device's x forward, y left, z up in MuJoCo's axes of cameras: x right, y up, view along -z.
DEVICE_IN_CAMERA = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
PARTS = 8  # of an action, so that the TCP keeps to its line and its speed
TESTED_STEP = 0.005  # rad or m of a joint between two postures that are tested for collisions
NEARER = 1e-7  # m; distances that differ by less are the same


@dataclass(frozen=True)
class FollowOptions:
    """How an arm follows.

    Attributes:
        scale: Metres of the TCP for a metre of the device.
        rotation_scale: Angle of the TCP for an angle of the device.
        frame: Axes of the device: "base" of the robot, "world", "tool", or "camera:NAME" for those
            of a camera of the scene.
        max_speed: Largest speed of the TCP, m/s; of leader arms, too.
        max_angular_speed: Its largest angular speed, rad/s; of leader arms, too.
        max_joint_speed: Largest speed of a joint, rad/s or m/s.
        max_lead: How far the command of a joint may lead the joint, rad or m: a blocked arm presses
            no harder.
        clearance: Distance that the arm keeps from everything that stands still, m.
        stops_at_collisions: False lets the arm touch everything.
    """

    scale: float = 1.0
    rotation_scale: float = 1.0
    frame: str = "base"
    max_speed: float = 0.25
    max_angular_speed: float = 1.5
    max_joint_speed: float = 1.5
    max_lead: float = 0.15
    clearance: float = 0.0
    stops_at_collisions: bool = True

    def __post_init__(self) -> None:
        """Raises ArgumentError for values that are out of range, or of another kind."""
        for name, default in ((each.name, each.default) for each in fields(self)):
            value, expected = getattr(self, name), type(default)
            if isinstance(value, bool) != (expected is bool) or not isinstance(
                value, int | float if expected is float else expected
            ):
                raise ArgumentError(f"{name} is {value!r}, not a {expected.__name__}")
        for name in ("max_speed", "max_angular_speed", "max_joint_speed", "max_lead"):
            if not 0 < getattr(self, name) < np.inf:
                raise ArgumentError(f"{name} must be above 0, got {getattr(self, name)}")
        for name in ("scale", "rotation_scale", "clearance"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ArgumentError(f"{name} must be at least 0, got {getattr(self, name)}")
        kind, _, camera = self.frame.partition(":")
        if kind not in FRAMES or (kind == "camera") != bool(camera):
            raise ArgumentError(
                f"no frame '{self.frame}'; there are base, world, tool and camera:NAME"
            )


class ArmFollower:
    """Turns motions into commands of a robot's arm and gripper.

    Args:
        robot: The robot, at the start of an episode, seen from the arm that follows.
        options: How it follows.
        hand: The robot that is the arm's gripper, if it is not the arm's own.
        opening: The opening that is commanded at first; default the measured one.

    Attributes:
        blocked: Why the last motion was cut short: "collision", "limit", or "".
    """

    def __init__(
        self,
        robot: Robot,
        options: FollowOptions,
        hand: Robot | None = None,
        opening: float | None = None,
    ) -> None:
        self._robot, self._options, self._hand = robot, options, hand
        self._scene: Scene = robot.scene
        kind, _, camera = options.frame.partition(":")
        self._frame, self._camera = kind, camera
        if camera and camera not in self._scene.camera_names():
            cameras = self._scene.camera_names()
            raise NotFoundError(
                f"no camera '{camera}' for the frame.{did_you_mean(camera, cameras)} "
                f"The scene has: {', '.join(cameras)}"
            )
        self._names = _plain(robot)
        self._limits = np.asarray(robot.joint_limits)
        self._command = np.array(robot.arm.joint_pos, float)
        gripping = hand or robot
        self._opening = opening
        if opening is None and gripping.has_gripper:
            self._opening = float(gripping.gripper.opening)
        self._filter = self._make_filter()
        self._depth: _Depth | None = None
        self.blocked = ""

    @property
    def command(self) -> NDArray[np.float64]:
        """The commanded joint positions (n,), a copy."""
        return self._command.copy()

    @property
    def opening(self) -> float | None:
        """The commanded opening, 0 closed to 1 open; None without a gripper."""
        return self._opening

    @property
    def gripper(self) -> tuple[str, str]:
        """Robot and group of the gripper; ("", "") without one."""
        if self._hand is not None:
            return self._hand.name, self._hand.gripper.name
        own = self._robot.gripper_of(self._arm)
        return (self._robot.name, own) if own else ("", "")

    def resync(self) -> None:
        """Lets the command begin at the measured positions again."""
        self._command = np.clip(self._robot.arm.joint_pos, *self._limits.T)

    def hold(self) -> dict[str, GroupCommand]:
        """Returns the commands that keep arm and gripper where they are commanded to be."""
        self.blocked = ""
        commands = {self._arm: GroupCommand.joints(self._command)}
        robot, gripper = self.gripper
        if self._opening is not None and gripper and robot == self._robot.name:
            commands[gripper] = GroupCommand.opening(self._opening)
        return commands

    def follow(self, motion: Motion, seconds: float) -> dict[str, GroupCommand]:
        """Returns the commands of one action of so many seconds."""
        self.blocked = ""
        if not motion.clutch:
            return self.hold()
        if motion.opening is not None and self._opening is not None:
            self._opening = min(max(motion.opening, 0.0), 1.0)
        wanted = (
            self._towards_joints(motion, seconds)
            if motion.joints
            else self._towards_pose(motion, seconds)
        )
        self._go_to(wanted)
        blocked = self.blocked
        commands = self.hold()
        self.blocked = blocked
        return commands

    @property
    def _arm(self) -> str:
        return str(self._robot.arm.name)

    def _towards_pose(self, motion: Motion, seconds: float) -> NDArray[np.float64]:
        options = self._options
        frame, camera = motion.frame or self._frame, self._camera
        linear = _cut(options.scale * np.array(motion.translation), options.max_speed * seconds)
        angular = _cut(
            options.rotation_scale * np.array(motion.rotation), options.max_angular_speed * seconds
        )
        if not linear.any() and not angular.any():
            return self._command
        turn = self._axes_in_base(frame, camera)
        twist = np.concatenate([turn @ linear, turn @ angular]) / seconds
        wanted, part = self._command, seconds / PARTS
        fastest = np.full(len(wanted), options.max_joint_speed)
        for _ in range(PARTS):
            moved = self._robot.kinematics.differential_ik(
                wanted, twist, "base", part, fastest, None, 0.0
            )
            wanted = wanted + part * np.asarray(moved.velocity)
            if moved.slower:
                self.blocked = "limit"
        return self._no_faster(wanted, seconds)

    def _no_faster(self, wanted: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
        """Shortens a motion whose TCP moves or turns further than its speeds allow.

        A leader's joints may do that, and so may turning that costs translation at limits.
        """
        longest = self._options.max_speed * seconds
        widest = min(self._options.max_angular_speed * seconds, np.pi)
        start = self._robot.fk_frame(self._command)
        for _ in range(PARTS):  # joints move the TCP on arcs, so that one division is not exact
            tcp = self._robot.fk_frame(wanted)
            moved = float(np.linalg.norm(tcp.translation - start.translation))
            turned = _angle(np.asarray(start.rotation).T @ np.asarray(tcp.rotation))
            excess = max(moved / longest, turned / widest)
            if excess <= 1 + 1e-6:
                break
            wanted = self._command + (wanted - self._command) / excess
        return wanted

    def _axes_in_base(self, frame: str, camera: str) -> NDArray[np.float64]:
        """Returns the axes of a frame in those of the robot's base (3, 3)."""
        base = self._robot.base_in_world.rotation
        if frame == "base":
            return np.eye(3)
        if frame == "tool":
            tcp: Pose = self._robot.fk_frame(self._command)
            return np.asarray(tcp.rotation)
        if frame == "camera" and camera:
            world = self._scene.camera_pose(camera).rotation @ DEVICE_IN_CAMERA
            return np.asarray(base.T @ world)
        return np.asarray(base.T)  # of a page's own view, which sends world axes, too

    def _towards_joints(self, motion: Motion, seconds: float) -> NDArray[np.float64]:
        wanted = self._command.copy()
        for name, value in motion.joints.items():
            wanted[self._place(name)] = value
        wanted = np.clip(wanted, *self._limits.T)
        step = self._options.max_joint_speed * seconds
        wanted = self._command + np.clip(wanted - self._command, -step, step)
        return self._no_faster(wanted, seconds)

    def _place(self, name: str) -> int:
        if name in self._names:
            return self._names.index(name)
        if name.isdigit() and int(name) < len(self._names):
            return int(name)
        raise NotFoundError(
            f"the device moves '{name}', which is no joint of robot '{self._robot.name}'."
            f"{did_you_mean(name, self._names)} Its joints: {', '.join(self._names)}; or 0 to "
            f"{len(self._names) - 1}"
        )

    def _go_to(self, wanted: NDArray[np.float64]) -> None:
        """Moves the command towards a posture, up to the last one that the arm may take.

        The command leads the arm by no more than `max_lead`. Where a collision forbids every such
        command on the way, the arm stays where it is.
        """
        measured = np.asarray(self._robot.arm.joint_pos)
        lead = self._options.max_lead
        wanted = np.clip(measured + np.clip(wanted - measured, -lead, lead), *self._limits.T)
        reached = self._last_allowed(wanted)
        if np.any(reached != wanted):
            self.blocked = "collision"
        if np.any(np.abs(reached - measured) > lead + 1e-9):
            reached = np.clip(measured, *self._limits.T)
        self._command = reached

    def _make_filter(self) -> Any:
        """Returns the test of configurations: only what stands still is in the way.

        Objects, doors and drawers must be touched to be moved.
        """
        if not self._options.stops_at_collisions:
            return None
        ignored = _movable_bodies(self._scene)
        return CollisionFilter(self._robot, self._options.clearance, ignored)

    def _last_allowed(self, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the last posture on the way that is free of collisions.

        An arm that touches something already may move away from it, or along it.
        """
        furthest = float(np.max(np.abs(wanted - self._command), initial=0.0))
        if self._filter is None or furthest == 0:
            return wanted
        self._filter.update()
        way = np.linspace(self._command, wanted, 1 + int(np.ceil(furthest / TESTED_STEP)))
        free = np.asarray(self._filter(way))
        if free.all():
            return wanted
        last, depths = 0, self._depths()
        for k in range(1, len(way)):
            if not free[k] and (free[last] or not depths.is_no_deeper(way[0], way[k])):
                break
            last = k
        return np.asarray(way[last])

    def _depths(self) -> _Depth:
        """Returns the measure of how deep the arm is in what it touches."""
        self._depth = self._depth or _Depth(self._robot, self._options.clearance)
        self._depth.update()
        return self._depth


class _Depth:
    """Compares how near two postures of an arm come to what stands still, and to itself."""

    def __init__(self, robot: Robot, clearance: float) -> None:
        record = next(each for each in robot.scene.compiled.robots if each.name == robot.name)
        ignored = [(body, "") for body in _movable_bodies(robot.scene)]
        itself = [(record.top_body, record.top_body)]
        self._clearance = max(clearance, 1e-6)
        self._planners: list[MotionPlanner] = []
        try:
            for allowed in (ignored, [*ignored, *itself]):
                planner = MotionPlanner(
                    robot,
                    groups=[robot.arm.name],
                    clearance=clearance,
                    allowed_contacts=allowed,
                )
                self._planners.append(planner)
        except Error:  # a robot for which nothing can be planned: no motion counts as a way out
            self._planners = []
            return
        names = list(robot.joint_names)
        self._order = [names.index(name) for name in self._planners[0].joint_names]

    def update(self) -> None:
        """Copies the scene's present state."""
        for planner in self._planners:
            planner.update()

    def is_no_deeper(self, start: NDArray[np.float64], end: NDArray[np.float64]) -> bool:
        """Returns True if the arm is at `end` no nearer to anything than at `start`."""
        if not self._planners:
            return False
        whole, others = self._planners
        return all(
            planner.clearance(end[self._order], horizon)
            >= planner.clearance(start[self._order], horizon) - NEARER
            for planner, horizon in ((whole, 1e-6), (others, self._clearance))
        )


def _angle(rotation: NDArray[np.float64]) -> float:
    """Returns the angle of a rotation matrix (3, 3), rad; exact for small ones, too."""
    skew = rotation - rotation.T
    sine = float(np.linalg.norm([skew[2, 1], skew[0, 2], skew[1, 0]])) / 2
    return float(np.arctan2(sine, (np.trace(rotation) - 1) / 2))


def _cut(vector: NDArray[np.float64], longest: float) -> NDArray[np.float64]:
    length = float(np.linalg.norm(vector))
    return vector if length <= longest else vector * (longest / length)


def _plain(robot: Robot) -> list[str]:
    """Returns the names of the joints as the robot's file has them."""
    return [name.removeprefix(robot.prefix) for name in robot.joint_names]


def _movable_bodies(scene: Scene) -> list[str]:
    """Returns the bodies, of no robot, that hang on joints: the first one of each tree."""
    model: Any = scene.model
    tops = {int(model.body(record.top_body).id) for record in scene.compiled.robots}
    of_robot = np.zeros(model.nbody, bool)
    found = []
    for i in range(1, model.nbody):
        parent = int(model.body_parentid[i])
        of_robot[i] = i in tops or of_robot[parent]
        moves = model.body_jntnum[i] > 0 or model.body_mocapid[i] >= 0
        parent_moves = parent != 0 and model.body_weldid[parent] != 0
        if moves and not parent_moves and not of_robot[i] and model.body(i).name:
            found.append(model.body(i).name)
    return found
