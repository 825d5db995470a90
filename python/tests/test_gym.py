"""Environments as Gymnasium's: its own checker, seeds, pictures, copies."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import warnings
from functools import partial
from pathlib import Path
from types import MappingProxyType, SimpleNamespace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils import seeding
from gymnasium.utils.env_checker import check_env

import robocell as rc
from graphics import require_gl
from robocell import _window
from robocell.gym import GymEnv, VectorGymEnv, pick_cube_config

RC7 = rc.models.robot_file("rc7")
MODES = [
    (m, r) for m in ("joints", "cartesian_trpy", "cartesian_tquat") for r in ("last_step", "none")
]


def config(**fields) -> rc.EnvConfig:
    return rc.EnvConfig(robots={"robot": RC7}, sim={"async_control": True}, **fields)


@pytest.mark.parametrize(("mode", "relative_to"), MODES)
def test_passes_the_gymnasium_checker(mode, relative_to):
    env = GymEnv(config(control_mode=mode, relative_to=relative_to), render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Ours are metres and radians.
        warnings.filterwarnings("ignore", ".*we recommend using a symmetric and normalized space")
        check_env(env, skip_render_check=True)
    env.close()


@pytest.mark.parametrize(("mode", "relative_to"), MODES)
def test_spaces_hold_everything_and_equal_seeds_give_equal_episodes(mode, relative_to):
    episodes = []
    for _ in range(2):
        env = GymEnv(config(control_mode=mode, relative_to=relative_to))
        env.action_space.seed(1)
        observation, _ = env.reset(seed=3)
        seen = []
        for _ in range(20):
            action = env.action_space.sample()
            assert env.action_space.contains(action)
            observation, *_ = env.step(action)
            assert env.observation_space.contains(observation)
            seen.append(np.concatenate(list(observation["robot"].values())))
        env.close()
        episodes.append(seen)
    assert np.array_equal(*episodes)
    assert np.ptp(episodes[0], axis=0)[:7].min() > 0, "nothing stands still"


def test_render_returns_images_of_the_requested_size():
    env = GymEnv(config(), render_mode="rgb_array", render_size=(64, 48))
    assert env.metadata["render_fps"] == 30
    env.reset(seed=0)
    picture = env.render()
    assert (picture.shape, picture.dtype) == ((48, 64, 3), np.uint8)
    assert np.ptp(picture) > 50
    env.close()


def test_the_checker_draws_the_registered_environment_in_every_mode(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(_window, "_warned", {_window.NO_WINDOW})
    env = gym.make("robocell/PickCube-v0", render_mode="rgb_array").unwrapped
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*we recommend using a symmetric and normalized space")
        # A window draws by itself, so that render() has nothing to give.
        check_env(env)
    env.close()


SEEDED = """
import sys
import numpy as np
from robocell.gym import GymEnv, pick_cube_config
config = pick_cube_config(variations={"cube": {"mass": [0.5, 2], "colour": 0.2}})
config.robots["robot"].home_noise = {"arm": [0.05]}
env = GymEnv(config)
for seed in (7, None, 8):
    observation, _ = env.reset(seed=seed)
    mass = env.core.scene.model.body("cube_green_cube").mass
    parts = (*observation["robot"].values(), observation["objects"]["cube"]["tquat"], mass)
    sys.stdout.write(np.concatenate(parts).tobytes().hex() + "\\n")
"""


@pytest.mark.parametrize("flat", [False, True])
def test_a_row_has_the_names_of_columns(flat):
    env = gym.make("robocell/PickCube-v0", flat=flat).unwrapped
    env.reset(seed=0)
    row, core = env.row(), env.core.row()
    assert list(row) == list(core)
    assert all(np.array_equal(row[name], core[name]) for name in core)
    env.close()


def test_the_generator_is_that_of_the_seed():
    env = GymEnv(pick_cube_config())
    env.reset(seed=5)
    expected, _ = seeding.np_random(5)
    assert env.np_random_seed == 5
    assert env.np_random.random() == expected.random()
    env.reset()
    assert env.np_random.random() == expected.random(), "it goes on"
    for seed in (-1, 1.5, "1"):
        with pytest.raises(gym.error.Error, match="Seed must be"):
            env.reset(seed=seed)
    own = np.random.default_rng(3)
    env.np_random = own
    assert env.np_random is own
    assert env.np_random_seed == -1
    env.reset(seed=5)
    assert env.np_random.random() == seeding.np_random(5)[0].random()
    env.close()


def test_seeded_resets_are_the_same_in_every_process():
    starts = [
        subprocess.run(
            [sys.executable, "-c", SEEDED],
            env=os.environ | {"PYTHONHASHSEED": salt},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        for salt in ("1", "2")
    ]
    assert starts[0] == starts[1]
    assert len(set(starts[0])) == 3


def test_any_configuration_has_a_registered_name(tmp_path):
    file = tmp_path / "cell.yaml"
    file.write_text(f"robots: {{robot: {RC7}}}\nsim: {{async_control: true}}\n")
    own = rc.EnvConfig.load(file)
    for given in (file, str(file), own):
        env = gym.make("robocell/Env-v0", config=given, control_mode="cartesian_trpy")
        assert set(env.action_space["robot"].spaces) == {"xyzrpy", "gripper"}
        assert env.reset(seed=0)[0]["robot"]["joints"].shape == (7,)
        env.close()
    assert own.control_mode == rc.envs.ControlMode.JOINTS, "it stays as it is"
    short = gym.make("robocell/Env-v0", config=own, max_episode_steps=1, flat=True)
    short.reset(seed=0)
    assert short.step(np.zeros(8, dtype=np.float32))[3]
    assert gym.make(short.spec).action_space == short.action_space
    short.close()
    vector = gym.make_vec("robocell/Env-v0", num_envs=2, config=own, max_episode_steps=1)
    vector.reset(seed=0)
    assert vector.step(vector.action_space.sample())[3].all()
    vector.close()
    with pytest.raises(AttributeError, match="control_mode"):
        gym.make("robocell/Env-v0", config=own, control_mod="joints")


@pytest.mark.parametrize(
    "robot",
    [
        "xarm7",
        "gen3_2f85",
        *(pytest.param(name, marks=pytest.mark.proof) for name in ("fr3", "panda")),
    ],
)
def test_pick_cube_accepts_robots_by_cell_name(menagerie, robot):
    env = gym.make("robocell/PickCube-v0", robot=robot)
    observation, _ = env.reset(seed=0)
    assert set(observation["robot"]) == {"tquat", "xyzrpy", "joints", "gripper"}
    *_, info = env.step(env.action_space.sample())
    assert info["reason"] != "diverged"
    env.close()


def test_rejects_unknown_cells_and_robots(menagerie):
    duo = gym.make("robocell/Env-v0", config="fr3_duo")
    assert set(duo.observation_space.spaces) == {"left", "right"}
    duo.close()
    with pytest.raises(rc.ArgumentError, match=r"the cell 'fr3_duo' has 2 robots \(left, right\)"):
        gym.make("robocell/PickCube-v0", robot="fr3_duo")
    for make in (
        lambda: gym.make("robocell/PickCube-v0", robot="xarm8"),
        lambda: gym.make("robocell/Env-v0", config="xarm8"),
    ):
        with pytest.raises(rc.NotFoundError, match=r"no cell 'xarm8'\..* Did you mean 'xarm7'\?"):
            make()
        with pytest.raises(
            rc.NotFoundError, match=r"A file is given with its ending, 'xarm8\.yaml'"
        ):
            make()
    for make in (gym.make, gym.make_vec):
        with pytest.raises(
            rc.ArgumentError, match=r"needs a config: .* cell \(fr3, .*config='rc7'"
        ):
            make("robocell/Env-v0")


def test_factories_are_pickled():
    make = pickle.loads(pickle.dumps(partial(GymEnv, config())))
    env = make()
    assert env.reset(seed=0)[0]["robot"]["joints"].shape == (7,)
    env.close()
    env.close()


def test_works_with_gymnasium_vectors():
    vector = gym.vector.SyncVectorEnv([partial(GymEnv, config())] * 2)
    observation, _ = vector.reset(seed=[1, 2])
    assert observation["robot"]["tquat"].shape == (2, 7)
    assert not np.array_equal(*observation["robot"]["joints"])
    vector.step(vector.action_space.sample())
    vector.close()


FORKED = """
import os, sys
import robocell as rc
from robocell.gym import GymEnv, pick_cube_config

streams = [rc.render.CameraConfig(name="eye", camera="exo_camera")]
config = pick_cube_config(cameras={"resolution": [64, 48], "streams": streams})


def try_in_a_fork(work):
    child = os.fork()
    if child == 0:
        try:
            work()
            print("drawn", flush=True)
        except rc.Error as error:
            print(error, flush=True)
        os._exit(0)
    os.waitpid(child, 0)


def drawn_alone():
    env = GymEnv(config)
    env.reset(seed=0)


try_in_a_fork(drawn_alone)
env = GymEnv(config)
env.reset(seed=0)
try_in_a_fork(drawn_alone)
try_in_a_fork(env.reset)
try_in_a_fork(env.close)
env.reset(seed=0)
"""


def test_warns_about_forking_after_rendering():
    """They waited for OpenGL's threads for ever."""
    done = subprocess.run(
        [sys.executable, "-c", FORKED],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    before, *forked, closed = done.stdout.splitlines()
    assert (before, len(forked), closed) == ("drawn", 2, "drawn")
    for told in forked:
        assert told.startswith("this process was forked after something had been drawn, and OpenGL")
        assert "context='forkserver' or 'spawn'" in told
        assert "gym.make_vec" in told


def test_gymnasiums_processes_draw_with_another_context():
    factory = partial(GymEnv, images_config())
    vector = gym.vector.AsyncVectorEnv([factory] * 2, context="forkserver")
    seen, _ = vector.reset(seed=0)
    assert seen["frames"]["eye"]["rgb"]["data"].shape == (2, 48, 64, 3)
    vector.close()


def images_config() -> rc.EnvConfig:
    streams = [rc.render.CameraConfig(name="eye", camera="exo_camera")]
    return pick_cube_config(cameras={"resolution": [64, 48], "streams": streams})


def test_images_are_part_of_the_space():
    streams = [{"name": "eye", "camera": "exo_camera", "depth": True, "segmentation": True}]
    images = config(cameras={"resolution": [32, 24], "streams": streams})
    env = GymEnv(images)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    assert set(observation["frames"]["eye"]) == {"time", "rgb", "depth", "segmentation"}
    assert env.observation_space.contains(env.step(env.action_space.sample())[0])
    env.close()


def test_the_registered_environment_is_about_a_cube():
    env = gym.make("robocell/PickCube-v0", render_mode="rgb_array")
    assert env.spec.max_episode_steps == 200
    starts = []
    for seed in (1, 1, 2):
        observation, info = env.reset(seed=seed)
        starts.append(observation["objects"]["cube"]["tquat"])
    assert np.array_equal(starts[0], starts[1])
    assert not np.array_equal(starts[0], starts[2])
    assert info["instruction"] == "pick up the cube"
    for _ in range(3):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        assert env.observation_space.contains(observation)
    assert 0 < reward < 1
    assert (terminated, truncated, info["is_success"]) == (False, False, False)
    env.close()


def test_zero_actions_hold_still_and_the_gripper_takes_any_number():
    env = gym.make("robocell/PickCube-v0").unwrapped
    still = {"robot": {"tquat": np.zeros(7), "gripper": np.zeros(1)}}
    assert env.action_space.contains(still)
    start, _ = env.reset(seed=0)
    for gripper in (1, 1.0, np.float32(1), np.int64(1), np.array(1.0), np.ones(1), [1]):
        robot = MappingProxyType({"tquat": np.zeros(7), "gripper": gripper})
        seen, *_ = env.step(MappingProxyType({"robot": robot}))
        assert seen["robot"]["gripper"] == [1]
    assert np.allclose(seen["robot"]["tquat"], start["robot"]["tquat"], atol=2e-3)
    for gripper, problem in [
        ("open", "action.robot.gripper must be a list of numbers, got str"),
        ([1, 2], "action.robot.gripper must be 1 number, got 2"),
        (None, "action.robot.gripper must be a number, got None"),
    ]:
        with pytest.raises((TypeError, rc.ArgumentError), match=problem):
            env.step({"robot": {"tquat": np.zeros(7), "gripper": gripper}})
    env.close()


def test_centimetres_never_swing_the_arm():
    # No arm follows that fast: nothing is taken back of what leads it.
    env = GymEnv(
        pick_cube_config(sim={"async_control": True, "frequency": 250}, max_target_lead=(100, 100))
    )
    env.reset(seed=0)
    arm = env.core.scene.robot("robot")
    rng = np.random.default_rng(1)
    failed, steps = 0, 600
    for step in range(steps):
        if step % 5 == 0:
            way = rng.normal(size=3)
            way *= 0.02 / np.linalg.norm(way)
        before = np.array(arm.jnt_pos_cmd)
        *_, info = env.step({"robot": {"tquat": [*way, 0, 0, 0, 1], "gripper": 1}})
        failed += not info["robots"]["robot"]["ik_success"]
        assert np.abs(np.array(arm.jnt_pos_cmd) - before).max() < 0.5
    assert failed < steps / 2
    env.close()


def test_pictures_show_the_robot_from_the_side_and_in_front():
    elsewhere = rc.Pose(translation=[3, 1, 0.5], rpy=[0, 0, 2])
    pictures = []
    for root in (rc.Pose(), elsewhere):
        env = GymEnv(
            config(root_frame_to_world=root, scene="empty_world"), "rgb_array", render_size=(64, 48)
        )
        env.reset(seed=0)
        renderer = rc.render.Renderer(env.core.scene)
        bodies = renderer.render(env._camera, width=64, height=48, segmentation=True)
        robot = bodies["segmentation"] > 0
        rows, columns = np.nonzero(robot)
        assert robot.mean() > 0.025, "it is large enough to be seen"
        assert np.ptp(rows) > np.ptp(columns) / 2, "it stands upright"
        assert abs(columns.mean() - 32) < 16
        pictures.append(robot)
        env.close()
    assert (pictures[0] == pictures[1]).mean() > 0.98, "the same wherever the rig stands"


def test_without_a_display_warns_once(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(_window, "_warned", set())
    with pytest.warns(UserWarning, match="viewer: no window: .*DISPLAY=.not set"):
        env = GymEnv(config(), render_mode="human")
    env.reset(seed=0)
    env.step(env.action_space.sample())
    assert env.render() is None
    env.close()
    monkeypatch.setenv("DISPLAY", ":no such display")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        GymEnv(config(headless=False)).close()


def test_a_window_follows_every_step_until_it_is_closed(monkeypatch):
    require_gl()

    class InMemory:
        @staticmethod
        def open(scene, **options):
            windows.append(rc.viewer.Viewer.open(scene, on_screen=False, **options))
            return windows[-1]

    windows: list[rc.viewer.Viewer] = []
    monkeypatch.setattr(_window, "Viewer", InMemory)
    env = GymEnv(config(headless=False))
    env.reset(seed=0)
    (window,) = windows
    assert not window.panels_shown
    tab = 258
    for shown in (True, False):
        window.post("key", key=tab)
        env.step(env.action_space.sample())
        assert window.panels_shown == shown, "each step handles the user's input"
    window.post("close")
    before = env.core.scene.time()
    env.step(env.action_space.sample())
    assert not window.is_running
    env.step(env.action_space.sample())
    assert env.core.scene.time() > before + 0.05, "the user has closed it"
    env.close()
    env.close()


def test_works_with_the_gymnasium_video_recorder(tmp_path, monkeypatch):
    """With a stand-in for moviepy, which wants an older pillow than we do."""
    clips = []

    class ImageSequenceClip:
        def __init__(self, frames, fps):
            clips.append((np.stack(frames), fps))

        def write_videofile(self, path, logger):
            assert Path(path).parent == tmp_path

    module = SimpleNamespace(ImageSequenceClip=ImageSequenceClip)
    for name in ("moviepy", "moviepy.video", "moviepy.video.io"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace())
    monkeypatch.setitem(sys.modules, "moviepy.video.io.ImageSequenceClip", module)
    single = GymEnv(config(), render_mode="rgb_array", render_size=(64, 48))
    env = gym.wrappers.RecordVideo(single, str(tmp_path / ""))
    env.reset(seed=0)
    for _ in range(5):
        env.step(env.action_space.sample())
    env.close()
    ((frames, fps),) = clips
    assert frames.shape == (6, 48, 64, 3)
    assert fps == single.metadata["render_fps"]
    assert len(np.unique(frames)) > 10, "they show something"


def with_a_bent_keyframe(tmp_path):
    """A configuration, the name of its robot, and that of a keyframe with 0.7 for joint 2."""
    robot = tmp_path / "robot.yaml"
    source = rc.models.robot_file("rc7")
    model = Path(source).parent / "rc7.xml"
    text = model.read_text()
    key = "<keyframe>" if "<keyframe>" in text else ""
    bent = '<key name="bent" qpos="0 0.7 0 1.3 0 0.6 0 0.045 0.045"/>'
    if key:
        text = text.replace(key, key + bent)
    else:
        text = text.replace("</mujoco>", f"<keyframe>{bent}</keyframe></mujoco>")
    (model_copy := tmp_path / "bent.xml").write_text(text)
    robot.write_text(Path(source).read_text().replace("rc7.xml", model_copy.name))
    given = config()
    (name,) = list(given.robots)
    given.robots[name] = rc.RobotConfig.load(robot)
    scene = rc.Env(given).scene
    return given, name, next(k for k in scene.keyframes() if k.endswith("bent"))


def test_a_reset_can_start_at_a_keyframe(tmp_path):
    given, name, bent_key = with_a_bent_keyframe(tmp_path)
    env = GymEnv(given)
    scene = env.core.scene
    env.reset(seed=1, options={"keyframe": bent_key})
    joint = scene.robot(name).group(scene.robot(name).arm.name).joint_names[1]
    assert scene.joint_pos(joint) == pytest.approx(0.7, abs=0.2), "home_noise is added"
    with pytest.raises(rc.NotFoundError, match="no keyframe 'bnt'"):
        env.reset(options={"keyframe": "bnt"})
    with pytest.raises(TypeError, match="keyframe"):
        env.reset(options={"keyframe": True})


def test_copies_in_a_vector_start_where_one_environment_does(tmp_path):
    given, name, _ = with_a_bent_keyframe(tmp_path)
    env, vector = GymEnv(given), VectorGymEnv(given, 2, max_episode_steps=1)
    options = {"keyframe": {name: "bent"}}
    one = env.reset(seed=3, options=options)[0][name]["joints"]
    home = env.reset(seed=3)[0][name]["joints"]
    assert abs(one[1] - home[1]) > 0.1
    vector.reset(seed=[3, 3])
    mask = np.array([False, True])
    some, _ = vector.reset(seed=[3, 3], options=options | {"reset_mask": mask})
    assert np.array_equal(some[name]["joints"], [home, one])
    stay = env.action_space.sample()
    both = {name: {key: np.stack([value, value]) for key, value in stay[name].items()}}
    vector.step(both)
    again = vector.step(both)[0][name]["joints"]  # their next episodes begin
    assert np.allclose(again[:, 1], home[1], atol=0.2), "at home"
    vector.close()
    env.close()


def test_rejects_unknown_render_modes_and_options():
    with pytest.raises(rc.ArgumentError, match="must be None, 'human' or 'rgb_array', got 'ansi'"):
        GymEnv(config(), render_mode="ansi")
    env = GymEnv(config())
    with pytest.raises(rc.ArgumentError, match="reset takes the option 'keyframe' here, got pose"):
        env.reset(options={"pose": 1})
    with pytest.raises(rc.ArgumentError, match="options of reset must be a dict or None, got list"):
        env.reset(options=[1])
    env.close()


@pytest.mark.parametrize("mode", ["joints", rc.envs.ControlMode.JOINTS])
def test_the_registered_environment_supports_joint_control(mode):
    for name in ("robocell/PickCube-v0", "robocell/PickPlace-v0"):
        env = gym.make(name, control_mode=mode)
        env.reset(seed=0)
        action = env.action_space.sample()
        assert set(action["robot"]) == {"joints", "gripper"}
        env.step(action)
        env.close()
    env = gym.make("robocell/PickCube-v0", control_mode=mode, max_relative_movement=[0.2])
    assert env.unwrapped.core.config.max_relative_movement == (0.2,)
    env.close()
