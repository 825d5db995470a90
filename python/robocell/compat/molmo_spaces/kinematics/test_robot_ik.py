"""Moves a robot's TCP up and down by inverse kinematics, in a window or as a strip of pictures.

python -m robocell.compat.molmo_spaces.kinematics.test_robot_ik CLASS --config_module MODULE
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell.compat.molmo_spaces._assembly import compile_alone
from robocell.compat.molmo_spaces._command import config_class, run_main
from robocell.compat.molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
from robocell.compat.molmo_spaces.kinematics.parallel.warp_kinematics import SimpleWarpKinematics

__all__ = ["Answer", "back_and_forth", "draw_strip", "main"]

Numbers = NDArray[np.float64]
STEP_M = 0.05  # above and below the beginning
PERIOD_S = 2.0
PICTURES = 6
SIZE_PX = (360, 360)
LARGEST_ERROR = 5e-4  # norm, m and rad, as SimpleWarpKinematics


@dataclass(frozen=True)
class Answer:
    """The answer to one target.

    Attributes:
        target: Pose (4, 4) of the leaf frame in the world.
        positions: Positions of all groups; None without a solution.
        position_error: Distance of the leaf frame from the target, m; NaN without a solution.
        rotation_error: Angle between them, rad; NaN without a solution.
    """

    target: Numbers
    positions: dict[str, Numbers] | None
    position_error: float
    rotation_error: float


def back_and_forth(
    config: Any,
    move_group: str | None = None,
    unlocked: Sequence[str] | None = None,
    parallel: bool = False,
    count: int = PICTURES,
) -> list[Answer]:
    """Solves for targets 5 cm above and below the leaf frame at `init_qpos`, in turn.

    Args:
        config: The robot's configuration.
        move_group: The group whose leaf frame moves. None: the first gripper.
        unlocked: Groups whose joints may move. None: all.
        parallel: Solve for all targets at once.
        count: Number of targets.

    The errors are those of a view of the solution, not what the solver says.
    """
    model, data, view = compile_alone(config, config.robot_namespace)
    group = _group(view, move_group)
    q0 = {name: view.get_move_group(name).joint_pos for name in view.move_group_ids()}
    start, base = view.get_move_group(group).leaf_frame_to_world, view.base.pose
    targets = np.repeat(start[np.newaxis], count, axis=0)
    targets[::2, 2, 3] += STEP_M
    targets[1::2, 2, 3] -= STEP_M
    found: list[dict[str, Numbers] | None]
    if parallel:
        found = SimpleWarpKinematics(config).ik(group, targets, unlocked, q0, base)  # type: ignore[assignment]
    else:
        one = MlSpacesKinematics(config)
        found = [one.ik(group, target, unlocked, q0, base) for target in targets]
    answers = []
    for target, positions in zip(targets, found, strict=True):
        errors = (float("nan"), float("nan"))
        if positions is not None:
            view.set_qpos_dict(positions)
            mujoco.mj_kinematics(model, data)
            reached = rc.Pose(view.get_move_group(group).leaf_frame_to_world)
            off = rc.Pose(target).inverse() * reached
            errors = (float(np.linalg.norm(off.translation)), float(off.angle))
        answers.append(Answer(target, positions, *errors))
    return answers


def _group(view: Any, name: str | None) -> str:
    if name is not None:
        view.get_move_group(name)
        return name
    grippers = view.get_gripper_movegroup_ids()
    if not grippers:
        raise rc.ArgumentError(
            f"robot view '{view.name}' has no gripper: name a group with --move-group. Its groups: "
            f"{', '.join(view.move_group_ids())}"
        )
    return grippers[0]


def draw_strip(config: Any, answers: Sequence[Answer], path: Path) -> None:
    """Writes the solutions side by side as a PNG; each target is drawn as axes."""
    from robocell.compat.molmo_spaces.data_generation._robot_files import write_robot

    with tempfile.TemporaryDirectory() as folder:
        robot = write_robot(config, Path(folder))
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True)
        spec.robots.append(rc.RobotSpec(name="robot", config=robot))
        scene = rc.Scene.build(spec)
        view = config.robot_view_factory(scene.data, scene.robots[0].prefix)
        renderer = rc.render.Renderer(scene, shadows=True)
        pictures = []
        seen: tuple[rc.render.OrbitCamera, float] | None = None
        for answer in answers:
            if answer.positions is not None:
                for name, positions in answer.positions.items():
                    view.get_move_group(name).joint_pos = positions
            scene.forward()
            eye, size = seen = seen or _eye_of(scene)
            frames = [("", rc.Pose(answer.target))]
            drawn = renderer.render(eye, *SIZE_PX, frames=frames, frame_length=0.15 * size)
            pictures.append(drawn["rgb"])
        rc.render.write_png(path, np.concatenate(pictures, axis=1))


def _eye_of(scene: rc.Scene) -> tuple[rc.render.OrbitCamera, float]:
    """Returns a view of all bodies, and their size, m."""
    model, data = scene.model, scene.data
    solid = model.geom_bodyid > 0
    at, around = data.geom_xpos[solid], model.geom_rbound[solid, np.newaxis]
    low, high = (at - around).min(axis=0), (at + around).max(axis=0)
    size = float(np.linalg.norm(high - low))
    eye = rc.render.OrbitCamera(
        lookat=(low + high) / 2, distance=1.2 * size, azimuth=130, elevation=-15, fovy=45
    )
    return eye, size


def _show(config: Any, answers: Sequence[Answer]) -> None:
    """Shows the solutions in turn until the window is closed."""
    from mujoco import viewer

    model, data, view = compile_alone(config, config.robot_namespace)
    with viewer.launch_passive(model, data) as window:
        turn = 0
        while window.is_running():
            answer = answers[turn % len(answers)]
            if answer.positions is not None:
                view.set_qpos_dict(answer.positions)
                mujoco.mj_forward(model, data)
            window.sync()
            time.sleep(PERIOD_S)
            turn += 1


def _report(answers: Sequence[Answer]) -> bool:
    """Prints a line for each target. Returns True if all are solved, and the errors are small."""
    for number, answer in enumerate(answers):
        if answer.positions is None:
            print(f"IK iteration {number}: Failed")
        else:
            print(
                f"IK iteration {number}: Success (off by {answer.position_error * 1e3:.4f} mm, "
                f"{answer.rotation_error:.6f} rad)"
            )
    good = [
        answer.positions is not None
        and np.hypot(answer.position_error, answer.rotation_error) <= LARGEST_ERROR
        for answer in answers
    ]
    print(f"{sum(good)} of {len(answers)} targets reached")
    return all(good)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command. Exit code 1 if a target is not reached."""
    parser = argparse.ArgumentParser(
        prog="test_robot_ik", description="Move a robot's TCP up and down by inverse kinematics."
    )
    parser.add_argument("config_class", help="class of the robot's configuration")
    parser.add_argument(
        "--config_module",
        default="robocell.compat.molmo_spaces.configs.robot_configs",
        help="module of the class (%(default)s)",
    )
    parser.add_argument("--move-group", help="group whose leaf frame moves (the first gripper)")
    parser.add_argument("--unlocked-move-groups", nargs="+", help="groups that may move (all)")
    parser.add_argument("--parallel", action="store_true", help="solve for all targets at once")
    parser.add_argument(
        "--picture",
        type=Path,
        help="write the pictures to this PNG, without a window (robot_ik.png without a display)",
    )
    given = parser.parse_args(arguments)
    config = config_class(given.config_module, given.config_class)()
    answers = back_and_forth(config, given.move_group, given.unlocked_move_groups, given.parallel)
    is_good = _report(answers)
    has_display = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    if given.picture is None and (has_display or sys.platform in ("darwin", "win32")):
        _show(config, answers)
    else:
        path = given.picture or Path("robot_ik.png")
        draw_strip(config, answers, path)
        print(f"pictures: {path}")
    return 0 if is_good else 1


if __name__ == "__main__":
    run_main(main)
