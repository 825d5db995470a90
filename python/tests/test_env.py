"""rc.Env from Python: dictionaries in and out, messages, copies."""

from __future__ import annotations

import numpy as np
import pytest

import robocell as rc

RC7 = rc.models.robot_file("rc7")


def config(**fields) -> rc.EnvConfig:
    fields.setdefault("control_mode", "cartesian_tquat")
    return rc.EnvConfig(
        name="duo",
        robots={"left": RC7, "right": RC7},
        robot_to_shared_base_frame={
            "left": rc.Pose(translation=[0, 0.3, 0], rpy=[-0.4, 0.1, 0]),
            "right": rc.Pose(translation=[0, -0.3, 0], rpy=[0.4, 0, 0.2]),
        },
        shared_base_frame_to_root_frame=rc.Pose(translation=[0, 0, 0.3]),
        **fields,
    )


STAY = {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": [1]}


@pytest.fixture(scope="module")
def env() -> rc.Env:
    return rc.Env(config())


def test_a_step_moves_only_the_commanded_arm(env):
    before, _ = env.reset(seed=1)
    after, reward, terminated, truncated, info = env.step(
        {"left": {"tquat": [0.01, 0, 0.02, 0, 0, 0, 1], "gripper": 0}, "right": STAY}
    )
    assert info["reason"] == "arrived"
    moved = after["left"]["tquat"][:3] - before["left"]["tquat"][:3]
    assert np.allclose(moved, [0.01, 0, 0.02], atol=0.006)
    assert np.allclose(after["right"]["tquat"], before["right"]["tquat"], atol=1e-3)
    assert (after["left"]["gripper"], after["right"]["gripper"]) == ([0], [1])
    assert (reward, terminated, truncated) == (0, False, False)
    left = info["robots"]["left"]
    assert (left["ik_success"], left["collision"]) == (True, False)


def test_observations_are_poses_in_the_shared_frame(env):
    observation, _ = env.reset(seed=2)
    shared = env.scene.shared_base_frame_to_world
    for name, own in observation.items():
        robot = env.scene.robot(name)
        world = robot.base_in_world * robot.kinematics.fk(own["joints"])
        tquat = rc.Pose(translation=own["tquat"][:3], quaternion=own["tquat"][3:])
        assert (shared * tquat).is_close(world, 1e-9, 1e-9)
        assert np.allclose(tquat.xyzrpy, own["xyzrpy"], atol=1e-12)


def test_the_same_pose_sends_both_arms_to_the_same_place_in_the_world():
    # For 2 ms each: they would meet there.
    env = rc.Env(config(relative_to="none", sim={"max_convergence_time": 0.002}))
    env.reset(seed=2)
    rng = np.random.default_rng(0)
    reached = 0
    for _ in range(30):
        pose = rc.Pose(
            translation=np.array([0.35, 0, 0.3]) + rng.uniform(-0.05, 0.05, 3),
            rpy=np.array([np.pi, 0, 0]) + rng.uniform(-0.3, 0.3, 3),
        )
        own = {"tquat": np.concatenate([pose.translation, pose.quaternion]), "gripper": 1}
        *_, info = env.step({"left": own, "right": own})
        if info["reason"] == "ik_failed":  # out of reach of one
            continue
        if any(robot["position_shortfall"] for robot in info["robots"].values()):
            continue
        reached += 1
        wanted = env.scene.shared_base_frame_to_world * pose
        for name in ("left", "right"):
            robot = env.scene.robot(name)
            sent = robot.base_in_world * robot.kinematics.fk(robot.jnt_pos_cmd)
            assert sent.is_close(wanted, 1e-4, 1e-4)
    assert reached >= 8


def sent(env: rc.Env, name: str) -> rc.Pose:
    """Where a robot was last sent, in the shared base frame."""
    robot = env.scene.robot(name)
    world = robot.base_in_world * robot.kinematics.fk(robot.jnt_pos_cmd)
    return env.scene.shared_base_frame_to_world.inverse() * world


@pytest.mark.parametrize("mode", ["cartesian_tquat", "cartesian_trpy"])
def test_relative_rotations_turn_about_the_tcp_with_the_axes_of_the_shared_frame(mode):
    """Of arms that are mounted off-centre and tilted, on a rig that is tilted too."""
    tilted = rc.Pose(translation=[1, 2, 0.5], rpy=[0.2, -0.1, 2])
    env = rc.Env(config(control_mode=mode, root_frame_to_world=tilted))
    env.reset(seed=1)
    turn = rc.Pose(rpy=[0.1, -0.2, 0.3])
    numbers = {
        "cartesian_tquat": {"tquat": [0, 0, 0, *turn.quaternion]},
        "cartesian_trpy": {"xyzrpy": [0, 0, 0, *turn.rpy]},
    }
    before = {name: sent(env, name) for name in ("left", "right")}
    *_, info = env.step(dict.fromkeys(before, numbers[mode] | {"gripper": 1}))
    for name, pose in before.items():
        assert info["robots"][name]["ik_success"]
        now = sent(env, name)
        assert np.abs(now.translation - pose.translation).max() < 3e-5
        assert np.allclose(now.rotation, turn.rotation @ pose.rotation, atol=5e-5)
    env.close()


def test_observations_are_copies(env):
    first, _ = env.reset(seed=3)
    kept = {name: {k: v.copy() for k, v in own.items()} for name, own in first.items()}
    env.step({"left": {"tquat": [0, 0, 0.05, 0, 0, 0, 1], "gripper": 0}, "right": STAY})
    for name, own in first.items():
        for key, value in own.items():
            assert np.array_equal(value, kept[name][key])
            assert not np.shares_memory(value, env.scene.data.qpos)


def test_observations_and_actions_stay_in_range(env):
    lower, upper = env.observation_range
    low, high = env.action_range
    rng = np.random.default_rng(0)
    env.reset(seed=4)
    for _ in range(10):
        action = {
            robot: {key: rng.uniform(low[robot][key], high[robot][key]) for key in low[robot]}
            for robot in low
        }
        observation, *_ = env.step(action)
        for robot, own in observation.items():
            for key, value in own.items():
                assert np.all(value >= lower[robot][key])
                assert np.all(value <= upper[robot][key])


def test_errors_name_the_wrong_part_of_an_action(env):
    env.reset()
    time = env.scene.time()

    def message(action) -> str:
        with pytest.raises((rc.ArgumentError, TypeError)) as error:
            env.step(action)
        return str(error.value)

    assert message({"left": STAY}) == (
        "environment 'duo': action has no 'right'; it takes left, right"
    )
    assert "action: no robot 'rigth'. Known robots: left, right. Did you mean 'right'?" in message(
        {"left": STAY, "rigth": STAY}
    )
    assert (
        "environment 'duo': action.left: no command 'joints'. Known commands: tquat, gripper. "
        "(control_mode cartesian_tquat)"
    ) in message({"left": {"joints": [0] * 7, "gripper": 1}, "right": STAY})
    assert "action.left.tquat must be 7 numbers, got 3" in message(
        {"left": {"tquat": [0, 0, 0], "gripper": 1}, "right": STAY}
    )
    assert "robot 'left': number 0 of its tquat is nan" in message(
        {"left": {"tquat": [np.nan, 0, 0, 0, 0, 0, 1], "gripper": 1}, "right": STAY}
    )
    assert "action must be a dict of robots, got list" in message([1, 2])
    assert env.scene.time() == time


def test_the_same_seed_is_the_same_episode():
    noisy = config(control_mode="joints")
    runs = []
    for _ in range(2):
        env = rc.Env(noisy)
        seen = [env.reset(seed=7)[0]]
        action = {r: {"joints": np.full(7, 0.02), "gripper": 0.2} for r in ("left", "right")}
        seen += [env.step(action)[0] for _ in range(3)]
        seen.append(env.reset()[0])
        runs.append(np.concatenate([own["joints"] for o in seen for own in o.values()]))
        env.close()
    assert np.array_equal(*runs)


def test_a_closed_environment_raises_closed_error():
    env = rc.Env(config())
    env.close()
    with pytest.raises(rc.ClosedError, match="environment 'duo' is closed"):
        env.reset()
    assert env.config.name == "duo"


def test_accepts_action_quaternions_of_any_finite_length():
    arms = rc.EnvConfig(
        robots={"arm": rc.models.robot_file("rc7")},
        control_mode=rc.envs.ControlMode.CARTESIAN_TQUAT,
        sim={"async_control": True, "frequency": 20},
    )
    seen = []
    turn = np.array([0, 0, 0.1, 1])
    for length in (1.0, 1e160, 1e300):
        env = rc.Env(arms)
        env.reset(seed=0)
        observation, *_ = env.step({"arm": {"tquat": [0, 0, 0, *(turn * length)], "gripper": 1}})
        seen.append(observation["arm"]["joints"])
        env.close()
    for joints in seen[1:]:
        np.testing.assert_allclose(joints, seen[0], atol=1e-9)


def test_robots_need_names_and_built_in_ones_have_a_file(tmp_path, monkeypatch):
    with pytest.raises(rc.SpecError, match="robots: is required: a name for each robot, found ''"):
        rc.Env(rc.EnvConfig(robots={"": rc.models.robot_file("rc7")}))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        rc.IoError, match=r"built-in robot, give the path.*robocell.models.robot_file\('rc7'\)"
    ):
        rc.EnvConfig(robots={"arm": "rc7"})
