"""The arms of a cell, one of which a device moves, or each of which has its own device."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from robocell._core import GroupCommand, NotFoundError, Robot, Scene
from robocell._suggestions import did_you_mean
from robocell._teleop.device import Motion
from robocell._teleop.follower import ArmFollower, FollowOptions

HAND = "gripper"  # in environments the gripper of robot `left` is the robot `gripperleft`


@dataclass(frozen=True)
class Arm:
    """An arm of a scene.

    Attributes:
        name: "left" of a robot with one arm, else "torso/left": as environments name them.
        robot: Its robot, seen from this arm.
        hand: The robot that is its gripper, if it is not the arm's own.
        opening: The opening that its gripper has at first; None for that of the scene.
    """

    name: str
    robot: Robot
    hand: Robot | None = None
    opening: float | None = None


def arms_of(scene: Scene) -> list[Arm]:
    """Returns the arms of a scene, in the order of its robots and their files."""
    robots = {robot.name: robot for robot in scene.robots}
    found = []
    for name, robot in robots.items():
        groups = [each for each in robot.group_names if robot.group(each).kind == "arm"]
        for group in groups:
            if len(groups) > 1:
                found.append(Arm(f"{name}/{group}", scene.robot(f"{name}/{group}")))
                continue
            hand = robots.get(f"{HAND}{name}")
            mounted = hand if hand is not None and hand.has_gripper else None
            found.append(Arm(name, robot, None if robot.has_gripper else mounted))
    return found


def arm_named(arms: Sequence[Arm], name: str) -> int:
    """Returns the place of an arm; 0 for "".

    Args:
        arms: The arms.
        name: Name of an arm, of a robot, whose first arm is meant, or of a group that one arm has.

    Raises:
        NotFoundError: There is no such arm, or several.
    """
    names = [arm.name for arm in arms]
    if not arms:
        raise NotFoundError("no robot of the scene has an arm")
    if not name:
        return 0
    for known in (names, [arm.robot.name for arm in arms]):
        if name in known:
            return known.index(name)
    found = [i for i, arm in enumerate(arms) if arm.robot.arm.name == name]
    if len(found) == 1:
        return found[0]
    if found:
        several = ", ".join(names[i] for i in found)
        raise NotFoundError(f"several arms are called '{name}': {several}. Give one of these names")
    raise NotFoundError(
        f"no arm '{name}'.{did_you_mean(name, names)} The scene has: {', '.join(names)}"
    )


class DrivenArms:
    """Turns what a device says into commands of all arms of a scene.

    A device moves the chosen arm; `next_arm` chooses the next one. A device that says `arms` moves
    several at once. Every other arm holds.

    Args:
        arms: The arms, at the start of an episode.
        first: Name of the arm that is chosen first; "" for the first one.
        options: How they follow.

    Raises:
        NotFoundError: There is no such arm.

    Attributes:
        chosen: Place of the chosen arm.
        blocked: Why the last motion was cut short, "" if it was not.
    """

    def __init__(self, arms: Sequence[Arm], first: str, options: FollowOptions) -> None:
        self.arms = list(arms)
        self.chosen = arm_named(self.arms, first)
        self.blocked = ""
        self._options = options
        self._followers: dict[int, ArmFollower] = {}  # of arms that moved, by place
        self._follower(self.chosen)
        self._said: float | None = None  # the opening that the device said last
        self._ignored: float | None = None  # an opening that was said to another arm

    @property
    def names(self) -> list[str]:
        """Names of the arms."""
        return [each.name for each in self.arms]

    @property
    def name(self) -> str:
        """Name of the chosen arm."""
        return self.arms[self.chosen].name

    def choose_next(self) -> None:
        """Chooses the next arm. It keeps its opening until the device says another one."""
        self.chosen = (self.chosen + 1) % len(self.arms)
        self._ignored = self._said
        self._follower(self.chosen)

    def resync(self) -> None:
        """Lets the commands begin at the measured positions again."""
        for follower in self._followers.values():
            follower.resync()

    def follow(self, motion: Motion | None, seconds: float) -> None:
        """Follows for one action of so many seconds; without a motion all arms hold.

        Raises NotFoundError for a motion of an unknown arm or joint.
        """
        self.blocked = ""
        if motion is None:
            return
        if not motion.arms:
            self._follow(self.chosen, self._with_new_opening(motion), seconds)
            return
        for name, each in motion.arms.items():
            self._follow(arm_named(self.arms, name), each, seconds)

    def held_by(self, motion: Motion | None) -> list[str]:
        """Returns the names of the arms whose clutch the person holds.

        Raises NotFoundError for a motion of an unknown arm.
        """
        if motion is None:
            return []
        if not motion.arms:
            return self.names if motion.clutch else []
        return [
            self.arms[arm_named(self.arms, name)].name
            for name, each in motion.arms.items()
            if each.clutch
        ]

    def commands(self) -> dict[str, dict[str, GroupCommand]]:
        """Returns the commands of the arms that moved, and of their grippers, for experts."""
        found: dict[str, dict[str, GroupCommand]] = {}
        for arm, follower in self._moved():
            found.setdefault(arm.robot.name, {}).update(follower.hold())
            if arm.hand is not None and follower.opening is not None:
                robot, group = follower.gripper
                found.setdefault(robot, {})[group] = GroupCommand.opening(follower.opening)
        return found

    def columns(self) -> dict[str, list[float]]:
        """Returns the same by the names of action columns, for environments."""
        found = {}
        for arm, follower in self._moved():
            name = f"robots/{arm.robot.name}/action/{arm.robot.arm.name}"
            found[name] = [float(value) for value in follower.command]
            robot, group = follower.gripper
            if group and follower.opening is not None:
                found[f"robots/{robot}/action/{group}"] = [follower.opening]
        return found

    def _moved(self) -> list[tuple[Arm, ArmFollower]]:
        return [(self.arms[i], self._followers[i]) for i in sorted(self._followers)]

    def _follower(self, place: int) -> ArmFollower:
        arm = self.arms[place]
        if place not in self._followers:
            self._followers[place] = ArmFollower(arm.robot, self._options, arm.hand, arm.opening)
        return self._followers[place]

    def _follow(self, place: int, motion: Motion, seconds: float) -> None:
        follower = self._follower(place)
        follower.follow(motion, seconds)
        if follower.blocked and len(self.arms) > 1:
            self.blocked = f"{self.arms[place].name}: {follower.blocked}"
        else:
            self.blocked = follower.blocked or self.blocked

    def _with_new_opening(self, motion: Motion) -> Motion:
        """Leaves out an opening that the device repeats from before another arm was chosen."""
        if not motion.clutch:
            return motion
        self._said = motion.opening
        if self._said != self._ignored:
            self._ignored = None
        if self._ignored is None:
            return motion
        return replace(motion, opening=None)
