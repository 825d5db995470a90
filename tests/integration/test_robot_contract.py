"""What holds for every robot file that robocell ships; a new file is tested by being there.

Two robots that are as unlike as can be are a part of `make test`; `make check` has them all.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from commands import generate, robocell_command
from numpy.typing import NDArray
from robot_files import GRASPING_FILES, ROBOT_FILES

import robocell as rc
from menagerie import require_menagerie
from robocell._cli.ik_answers import reachable_poses, solve_each
from robocell._cli.robot_scene import RobotScene, load_robot
from robocell.gym import GymEnv

Array = NDArray[np.float64]

IK_TARGETS, IK_TOLERANCE = 100, 1e-5
TIMESTEP_S = 0.002
BOX_MASS = 0.03
MOVE = 0.2  # rad, of every joint of the arm
EPISODES = 2
# One whose model is robocell's own; one of the Menagerie, with the fingers of another model.
QUICK = {"rc7", "gen3_2f85"}


def each(files: list[Path]) -> list[Any]:
    """Parameters: the files, of which all but the quick ones are proofs."""
    assert {file.stem for file in files} >= QUICK
    marks = {True: (), False: pytest.mark.proof}
    return [pytest.param(file, id=file.stem, marks=marks[file.stem in QUICK]) for file in files]


@pytest.fixture(params=each(ROBOT_FILES))
def robot_file(request: pytest.FixtureRequest) -> Path:
    """Each shipped robot file whose models are on this machine."""
    return on_this_machine(request.param)


@pytest.fixture(params=each(GRASPING_FILES))
def grasping_file(request: pytest.FixtureRequest) -> Path:
    """The same of those with a gripper."""
    return on_this_machine(request.param)


def on_this_machine(file: Path) -> Path:
    """The file, once its models are there."""
    models = re.findall(r"menagerie:(\w+)/", file.read_text())
    if models:
        require_menagerie(*models)
    return file


@pytest.fixture
def loaded(robot_file: Path) -> RobotScene:
    """The robot alone in a scene, at home."""
    return at_home(robot_file)


@pytest.fixture
def grasping(grasping_file: Path) -> RobotScene:
    """The same of one with a gripper."""
    return at_home(grasping_file)


def at_home(file: Path) -> RobotScene:
    """A robot alone in a scene."""
    loaded = load_robot(file)
    loaded.scene.reset()
    return loaded


def run(scene: rc.Scene, robot: rc.Robot, seconds: float) -> None:
    """Lets the controllers work."""
    for _ in range(round(seconds / TIMESTEP_S)):
        robot.update()
        result = scene.step()
        assert result, result.message


def test_check_reports_no_problem(robot_file: Path):
    done = robocell_command("check", robot_file)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "no problems found", done.stdout
    assert done.stderr == ""


def test_a_robot_starts_at_home_and_stays_there(loaded: RobotScene):
    scene, robot, config = loaded.scene, loaded.robot, loaded.config
    home = np.array(robot.arm.joint_pos)
    if "arm" in config.home:
        np.testing.assert_allclose(home, config.home["arm"], atol=1e-12)
    limits = np.array(robot.joint_limits)
    assert np.all((limits[:, 0] <= home) & (home <= limits[:, 1]))
    run(scene, robot, 1)
    np.testing.assert_allclose(robot.arm.joint_pos, home, atol=config.arrival_tolerance)


def test_a_gripper_is_open_at_home_and_stays_open(grasping: RobotScene):
    assert grasping.robot.gripper.is_open
    run(grasping.scene, grasping.robot, 1)
    assert grasping.robot.gripper.is_open


def test_a_seeded_reset_stays_near_home(loaded: RobotScene):
    scene, robot, config = loaded.scene, loaded.robot, loaded.config
    home = np.array(robot.arm.joint_pos)
    noise = np.array(config.home_noise.get(robot.arm.name, [0.0]))
    scene.reset(rc.scene.ResetOptions(seed=3))
    assert np.all(np.abs(np.array(robot.arm.joint_pos) - home) <= noise + 1e-12)


def test_inverse_kinematics_recovers_every_pose(loaded: RobotScene):
    targets = reachable_poses(loaded.robot, IK_TARGETS, np.random.default_rng(5))
    answers = solve_each(loaded.robot, targets, IK_TOLERANCE)
    assert np.all(answers.solved(IK_TOLERANCE)), np.flatnonzero(~answers.solved(IK_TOLERANCE))


def finger_geoms(model: mujoco.MjModel, ref: rc.scene.ElementRef) -> list[int]:
    """What collides of a finger that `fingers` names: a geom, or all of a body."""
    if ref.body:  # the i-th geom of a body
        return [int(model.body(ref.body).geomadr[0]) + ref.index]
    geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, ref.name)
    return [geom] if geom >= 0 else body_geoms(model, int(model.body(ref.name).id))


def body_geoms(model: mujoco.MjModel, body: int) -> list[int]:
    """The geoms of a body that collide."""
    own = np.flatnonzero((model.geom_bodyid == body) & (model.geom_contype > 0))
    return [int(geom) for geom in own]


def hand_sides(loaded: RobotScene) -> list[list[int]]:
    """The geoms of the two fingers; without `fingers` they are the bodies of the two joints."""
    model, group = loaded.scene.model, loaded.config.move_groups[loaded.robot.gripper.name]
    if len(group.fingers):
        return [finger_geoms(model, ref) for ref in group.fingers]
    return [body_geoms(model, int(model.joint(name).bodyid[0])) for name in group.joints]


def between_the_fingers(loaded: RobotScene) -> tuple[Array, Array]:
    """The point between the open fingers, and the unit vector from one to the other."""
    model, data = loaded.scene.model, loaded.scene.data
    nearest, ends = np.inf, np.zeros(6)
    left, right = hand_sides(loaded)
    for one in left:
        for other in right:
            line = np.zeros(6)
            distance = mujoco.mj_geomDistance(model, data, one, other, 1.0, line)
            if distance < nearest:
                nearest, ends = distance, line
    across = ends[3:] - ends[:3]
    return (ends[:3] + ends[3:]) / 2, across / np.linalg.norm(across)


def scene_with_box(loaded: RobotScene, width: float) -> rc.Scene:
    """The robot at home with a box between its fingers, `width` along the closing direction."""
    middle, closing = between_the_fingers(loaded)
    forward = loaded.robot.tcp_in_world.rotation[:, 2]
    forward = forward - closing * (closing @ forward)
    forward /= np.linalg.norm(forward)
    axes = np.column_stack([np.cross(closing, forward), closing, forward])
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    spec = rc.SceneSpec(name="hold", timestep=TIMESTEP_S, add_floor=True, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name=loaded.config.name, config=loaded.config))
    spec.objects.append(
        rc.SceneObject(
            name="box",
            shape=rc.Shape.BOX,
            size=[0.012, width / 2, 0.012],
            rgba=[0.9, 0.2, 0.2, 1],
            mass=BOX_MASS,
            friction=[1, 0.02, 0.001],
            pos=list(middle),
            quat=rc.Pose(matrix=matrix).quaternion,
        )
    )
    return rc.Scene.build(spec)


def test_the_gripper_holds_a_box_while_the_arm_moves(grasping: RobotScene):
    closed, opened = grasping.robot.gripper.inter_finger_dist_range
    width = closed + 0.4 * (opened - closed)
    scene = scene_with_box(grasping, width)
    robot = scene.robot(grasping.config.name)
    scene.reset()
    gripper, gravity = robot.gripper, scene.model.opt.gravity.copy()
    assert gripper.inter_finger_dist == pytest.approx(opened, abs=0.005)
    assert not gripper.is_grasping("box")

    scene.model.opt.gravity[:] = 0  # nothing holds it yet
    gripper.close()
    run(scene, robot, 1.5)
    assert gripper.is_grasping("box")
    assert gripper.inter_finger_dist == pytest.approx(width, abs=0.005)
    assert not gripper.is_open

    scene.model.opt.gravity[:] = gravity
    before = robot.tcp_in_world
    held = before.inverse() * scene.body_pose("box")
    home = np.array(robot.jnt_pos_cmd)
    # Each joint to where there is more room.
    limits = np.clip(np.array(robot.joint_limits), -np.pi, np.pi)
    target = home + MOVE * np.sign(limits.mean(axis=1) - home + 1e-9)
    for share in np.linspace(0, 1, 100):
        robot.jnt_pos_cmd = home + share * (target - home)
        run(scene, robot, 0.02)
    run(scene, robot, 0.5)
    assert np.linalg.norm(robot.tcp_in_world.translation - before.translation) > 0.05
    now = robot.tcp_in_world.inverse() * scene.body_pose("box")
    assert gripper.is_grasping("box")
    assert np.linalg.norm(now.translation - held.translation) < 0.01

    gripper.open()
    run(scene, robot, 1)
    assert gripper.is_open
    assert not gripper.is_grasping("box")
    assert gripper.inter_finger_dist == pytest.approx(opened, abs=0.005)


def test_two_picks_are_generated_and_intact(grasping_file: Path, tmp_path: Path):
    base = rc.RobotConfig.load(grasping_file).base
    height = 0.0 if base.size is None else base.size[2]  # the robot stands level with the table
    start = f"{{base_distance: [0.35, 0.5], base_height_offset: {-height}}}"
    run_file = tmp_path / "run.yaml"
    run_file.write_text(
        f"run: contract\nrobot: {grasping_file}\nstart: {start}\nepisodes_per_scene: {EPISODES}\n"
        f"output: {tmp_path / 'unused'}\n"
    )
    dataset = tmp_path / "dataset"
    totals = generate(run_file, dataset, "--workers", 1)[-1]["totals"]
    assert totals["made"] == EPISODES
    result = rc.data.verify(dataset)
    assert result.ok, str(result)
    assert len(list(dataset.glob("*/episode.json"))) == EPISODES


@pytest.mark.parametrize("mode", ["joints", "cartesian_trpy", "cartesian_tquat"])
def test_an_environment_is_deterministic_and_stays_in_its_spaces(robot_file: Path, mode: str):
    env = GymEnv(
        rc.EnvConfig(robots={"robot": robot_file}, control_mode=mode, sim={"async_control": True})
    )
    episodes = []
    for _ in range(2):
        env.action_space.seed(0)
        observation, _ = env.reset(seed=0)
        seen, moving = [], []
        for _ in range(8):
            observation, _, _, diverged, info = env.step(env.action_space.sample())
            assert env.observation_space.contains(observation)
            assert not diverged, info["message"]
            # A robot with several arms has a key for each.
            arms = [arm for name, arm in observation.items() if name.split("/")[0] == "robot"]
            seen.append(np.concatenate([value for arm in arms for value in arm.values()]))
            moving += [[v for arm in arms for k in arm if k != "gripper" for v in arm[k]]]
        episodes.append(seen)
    env.close()
    assert np.array_equal(*episodes)
    assert np.ptp(moving, axis=0).min() > 0, "nothing stands still"
