"""Environments from datasets: they act as recorded, and observe by the names of columns."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import robocell as rc
from robocell.envs import from_dataset
from robocell.evaluate import evaluate
from robocell.gym import pick_cube_config
from robocell.policy import Context, Policy, ReplayPolicy
from test_task import Idle

ROOT = Path(__file__).parents[2]


ARM, GRIPPER = "robots/rc7/action/arm", "robots/rc7/action/gripper"


def make(folder: Path, episodes: int, robot: Path | None = None, **fields: object) -> rc.Dataset:
    overrides = [] if robot is None else [f"robot={robot}"]
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml", overrides)
    run.cameras.resolution = [64, 48]
    for name, value in fields.items():
        setattr(run, name, value)
    run.output, run.episodes = str(folder), episodes
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        assert runner.run(item).success
    return rc.Dataset(folder)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> rc.Dataset:
    return make(tmp_path_factory.mktemp("picks") / "out", 2)


def test_an_episode_describes_its_columns(dataset: rc.Dataset):
    features = {feature.name: feature for feature in dataset[0].features}
    qpos = features["robots/rc7/arm/qpos"]
    assert (qpos.role, qpos.shape, qpos.units) == ("observation", (7,), "rad")
    assert qpos.names[0].endswith("joint1")
    assert features["objects/target/pose"].role == "privileged"
    assert features[ARM].role == "action"
    assert features["success"].role == "label"
    assert set(features) <= set(dataset[0].columns)


def test_an_environment_of_a_dataset_acts_as_recorded(dataset: rc.Dataset):
    env = from_dataset(dataset, privileged=True)
    assert {"wrist", "exo"} <= set(env.observations)
    for index, episode in enumerate(dataset):
        row, info = env.reset(seed=index)
        assert info["instruction"] == episode.metadata["instruction"]
        assert env.observation_space.contains(row)
        assert row["wrist"].shape == (48, 64, 3)
        for i, (arm, opening) in enumerate(zip(episode[ARM], episode[GRIPPER], strict=True)):
            for name in env.observations:
                if name in episode.columns:
                    assert np.array_equal(np.asarray(episode[name])[i], row[name]), name
            row, _, terminated, _, info = env.step({ARM: arm, GRIPPER: opening})
            if terminated:
                break
        assert info["is_success"]
        assert info["reason"] == "success"


def test_a_policy_sees_the_recorded_row_and_its_images(dataset: rc.Dataset, tmp_path: Path):
    code = tmp_path / "seer.py"
    code.write_text(
        "import pickle\n"
        "import numpy as np\n"
        "from robocell.policy import Policy\n"
        "class Seer(Policy):\n"
        "    def act(self, observation):\n"
        f"        with open({str(tmp_path / 'rows')!r}, 'ab') as file:\n"
        "            pickle.dump(observation, file)\n"
        "        return {'robots/rc7/action/arm_relative': np.full(7, 0.01)}\n"
    )
    out = tmp_path / "out"
    evaluate(dataset.folder, f"{code}:Seer", episodes=1, output=out)
    seen = []
    with (tmp_path / "rows").open("rb") as file:
        while file.peek(1):
            seen.append(pickle.load(file))
    episode = rc.Dataset(out)[0]
    assert len(seen) == len(episode)
    state = [f.name for f in episode.features if f.role in ("observation", "privileged")]
    assert {"wrist", "exo", *state} == set(seen[0])
    for i in (0, 7, len(seen) - 1):
        for name in state:
            assert np.array_equal(np.asarray(episode[name])[i], seen[i][name]), name
        # The video is lossy; the picture is the same.
        error = np.abs(episode.frame("exo", i).astype(float) - seen[i]["exo"].astype(float))
        assert error.mean() < 4


@pytest.mark.parametrize("cameras", [True, False])
def test_the_start_does_not_depend_on_whether_images_are_drawn(tmp_path: Path, cameras: bool):
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    run.cameras.renderer.backend = "soft"
    # A narrow image: most places of the robot do not see the object in it.
    exo = run.cameras.streams[1]
    exo.width, exo.height = 16, 96
    run.start.visible_from = [exo.name]
    run.start.visible_share = 0.9
    run.output, run.episodes, run.keep = str(tmp_path / "out"), 2, rc.generate.Keep.FIRST
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run, expert=lambda *_: Idle(1))
    for item in rc.generate.make_plan(run):
        assert runner.run(item).committed
    env = from_dataset(run.output, cameras=cameras, privileged=True)
    for number, episode in enumerate(rc.Dataset(run.output)):
        observation, _ = env.reset(seed=number)
        for name in ("objects/target/pose", "robots/rc7/base_pose"):
            assert np.array_equal(observation[name], episode[name][0]), name
        assert ("wrist" in observation) == cameras


def test_the_start_is_that_of_the_episode_after_failed_rollouts(tmp_path: Path):
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.output, run.episodes = str(tmp_path / "out"), 1
    rc.generate.prepare_dataset(run)
    failing = [True]

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        return Idle(1) if failing and failing.pop() else rc.tasks.PickPlanner(run, start)

    assert rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0]).success
    (episode,) = rc.Dataset(run.output)
    assert any("failed" in attempt for attempt in episode.metadata["earlier_attempts"])
    env = from_dataset(run.output, privileged=True)
    row, _ = env.reset(seed=0)
    for name in env.observations:
        assert np.array_equal(np.asarray(episode[name])[0], row[name]), name
    env.core.reset(0, 0)
    first = env.core.row()["objects/target/pose"]
    assert not np.array_equal(first, row["objects/target/pose"])
    for seed in range(1, 6):  # beyond the plan, with other objects
        if set(env.observations) <= set(next_row(env, seed)):
            env.reset(seed=seed)
        else:
            with pytest.raises(rc.NotFoundError, match=rf"start {seed} has no 'objects/object_"):
                env.reset(seed=seed)


def next_row(env: rc.envs.DatasetEnv, start: int) -> dict[str, np.ndarray]:
    env.core.reset(start)
    return env.core.row()


@pytest.mark.proof
def test_numbers_beyond_their_range_are_recorded_and_observed_in_the_space(tmp_path: Path):
    name = "features/beyond_of_dataset"

    @rc.features.register_feature("beyond_of_dataset", lower=[0.0], upper=[1.0])
    def beyond(scene: rc.Scene) -> float:
        return 1.3

    dataset = make(tmp_path / "out", 1, features=["beyond_of_dataset"])
    assert set(np.asarray(dataset[0][name])) == {1.3}
    env = from_dataset(dataset, cameras=False)
    row, _ = env.reset(seed=0)
    assert row[name] == env.observation_space[name].high == 1.0
    assert env.observation_space.contains(row)
    flat = from_dataset(dataset, flat=True)
    vector, _ = flat.reset(seed=0)
    assert flat.observation_space.contains(vector)


def test_actions_of_hinges_without_limits_have_the_range_of_env(tmp_path: Path):
    shutil.copytree(Path(rc.models.robot_file("rc7")).parent, tmp_path / "rc7")
    model = tmp_path / "rc7" / "rc7.xml"
    text = model.read_text()
    for limited, free in (
        ('"joint1" class="shoulder" range="-2.9 2.9"', '"joint1" class="shoulder" limited="false"'),
        ('joint="joint1"', 'joint="joint1" inheritrange="0" ctrlrange="-7 7"'),
    ):
        assert text.count(limited) == 1
        text = text.replace(limited, free)
    model.write_text(text)
    dataset = make(tmp_path / "out", 1, robot=tmp_path / "rc7" / "rc7.yaml")
    env = from_dataset(dataset, cameras=False)
    assert env.features[ARM].lower[0] == -np.inf
    space = env.action_space[ARM]
    assert (space.low[0], space.high[0]) == (-2 * np.pi, 2 * np.pi)
    assert (space.low[1], space.high[1]) == (-1.9, 1.9), "of the joint"
    seen = env.observation_space["robots/rc7/arm/qpos"]
    assert seen.high[0] == np.inf, "what is observed is not clipped"
    flat = from_dataset(dataset, flat=True)
    assert gymnasium.wrappers.RescaleAction(flat, -1.0, 1.0).action_space.is_bounded()


def test_rows_reject_an_image_stream(dataset: rc.Dataset):
    stream = dataset[0].streams[0]
    with pytest.raises(rc.ArgumentError, match=rf"'{stream}' is an image stream, not a column"):
        rc.data.rows(dataset, [stream])


def test_vectors_are_the_rows_of_the_dataset(dataset: rc.Dataset):
    seen, done = ["robots/rc7/arm/qpos", "robots/rc7/opening"], [ARM, GRIPPER]
    env = from_dataset(dataset, seen, done, flat=True)
    check_env(env, skip_render_check=True)
    vector, _ = env.reset(seed=0)
    rows = rc.data.rows(dataset, seen)
    assert np.array_equal(vector, rows[0])
    assert rows.shape == (sum(len(e) for e in dataset), 8)
    chunks = rc.data.rows(dataset, done, horizon=4)
    assert chunks.shape == (len(rows), 4, 8)
    assert np.array_equal(chunks[0, 1], chunks[1, 0])
    last = len(dataset[0]) - 1
    assert np.array_equal(chunks[last, 0], chunks[last, 3]), "no row of the next episode"


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"observations": ["robots/rc7/arm/qpso"]}, rc.NotFoundError, "arm/qpos'"),
        ({"actions": ["robots/rc7/action/amr"]}, rc.NotFoundError, "action/arm'"),
        (
            {"observations": ["reward"]},
            rc.NotFoundError,
            r"no observation 'reward' .* the role 'label'",
        ),
        ({"observations": [ARM]}, rc.NotFoundError, "role 'action'"),
        ({"observations": ARM}, rc.ArgumentError, "`observations` is a list of names, got '"),
    ],
)
def test_rejects_unknown_names(dataset: rc.Dataset, options, error, text):
    with pytest.raises(error, match=text):
        from_dataset(dataset, **options)


def test_depth_and_segmentation_are_observed_as_recorded(tmp_path: Path):
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    (wrist,) = [stream for stream in run.cameras.streams if stream.name == "wrist"]
    wrist.depth = wrist.segmentation = True
    dataset = make(tmp_path / "out", 1, cameras=run.cameras)
    env = from_dataset(dataset)
    row, _ = env.reset(seed=0)
    assert set(dataset[0].streams) <= set(env.observations)
    assert env.observation_space.contains(row)
    assert row["wrist.depth"].shape == row["wrist.segmentation"].shape == row["wrist"].shape[:2]
    assert np.array_equal(row["wrist.depth"], dataset[0].frame("wrist.depth", 0))
    with pytest.raises(
        rc.NotFoundError, match=r"no observation 'wrist.dpeth'.* mean 'wrist.depth'"
    ):
        from_dataset(dataset, observations=["wrist.dpeth"])


def test_imports_accepts_a_single_string(dataset: rc.Dataset, tmp_path: Path):
    module = tmp_path / "seen_by_text.py"
    module.write_text("import sys\nsys.seen_by_text = True\n")
    from_dataset(dataset, cameras=False, imports=str(module))
    import sys

    assert sys.seen_by_text  # type: ignore[attr-defined]


def test_rejects_an_action_that_is_not_a_dictionary(dataset: rc.Dataset):
    env = from_dataset(dataset, cameras=False)
    env.reset(seed=0)
    with pytest.raises(rc.ArgumentError, match=f"a dictionary of '{ARM}', '{GRIPPER}', got list"):
        env.step([0.0] * 8)


def test_rejects_impossible_actions(dataset: rc.Dataset):
    env = from_dataset(dataset, cameras=False)
    env.reset(seed=0)
    with pytest.raises(rc.ArgumentError, match="has 7 numbers, got 3"):
        env.step({ARM: [1, 2, 3], GRIPPER: 0.5})
    with pytest.raises(rc.ArgumentError, match="takes no options here"):
        env.reset(options={"keyframe": 1})
    flat = from_dataset(dataset, flat=True)
    flat.reset(seed=0)
    with pytest.raises(rc.ArgumentError, match="an action has 8 numbers"):
        flat.step(np.zeros(3))


def test_an_action_must_have_exactly_the_chosen_columns(dataset: rc.Dataset):
    twist = "robots/rc7/action/tcp_displacement"
    env = from_dataset(dataset, cameras=False)
    env.reset(seed=0)
    columns = f"has the columns '{ARM}', '{GRIPPER}'; got one with"
    with pytest.raises(rc.ArgumentError, match=f"{columns} no '{ARM}'. from_dataset"):
        env.step({GRIPPER: 0.5})
    with pytest.raises(rc.ArgumentError, match=f"{columns} '{twist}', which is not among them"):
        env.step({ARM: [0] * 7, GRIPPER: 1, twist: [0] * 6})
    with pytest.raises(rc.ArgumentError, match=rf"no '{ARM}' and .*amr'.* Did you mean '{ARM}'\?"):
        env.step({"robots/rc7/action/amr": [0] * 7, GRIPPER: 1})
    alone = from_dataset(dataset, actions=[GRIPPER], cameras=False)  # the arm stays
    alone.reset(seed=0)
    alone.step({GRIPPER: 0.5})


@pytest.mark.parametrize(
    ("actions", "first", "second", "group"),
    [
        (["robots/*/action/*"], "arm", "arm_relative", "arm"),
        ([f"{ARM}_relative", ARM], "arm", "arm_relative", "arm"),
        ([ARM, "robots/rc7/action/tcp_displacement"], "arm", "tcp_displacement", "arm"),
        (["robots/rc7/action/tcp_*"], "tcp_pose", "tcp_displacement", "arm"),
        ([f"{GRIPPER}*", ARM], "gripper", "gripper_relative", "gripper"),
    ],
)
def test_actions_of_one_group_cannot_be_chosen_together(
    dataset: rc.Dataset, actions: list[str], first: str, second: str, group: str
):
    names = " and ".join(f"'robots/rc7/action/{name}'" for name in (first, second))
    text = f"{names} both move group '{group}' of robot 'rc7'; choose one of them"
    with pytest.raises(rc.ArgumentError, match=text):
        from_dataset(dataset, actions=actions, cameras=False)


def test_a_star_matches_any_part_of_a_name(dataset: rc.Dataset):
    names = ["robots/*/qpos", "exo"]
    env = from_dataset(dataset, names, ["robots/*/arm", "robots/*/gripper"])
    assert env.observations == ["robots/rc7/arm/qpos", "robots/rc7/gripper/qpos", "exo"]
    assert env.actions == [ARM, GRIPPER]
    flat = from_dataset(dataset, names[:1], flat=True)
    vector, _ = flat.reset(seed=0)
    assert np.array_equal(vector, rc.data.rows(dataset, names[:1])[0])
    with pytest.raises(rc.NotFoundError, match="nothing fits 'sensors/\\*'"):
        from_dataset(dataset, ["sensors/*"])
    with pytest.raises(rc.ArgumentError, match="'exo' is an image, and this environment draws"):
        from_dataset(dataset, names, flat=True)


# Action of the arm, and the largest difference of its joints (rad) and TCP (m) in a replay. The
# page docs/environments.md has these numbers.
REPLAYED = [
    ("arm", 0, 0),
    ("arm_relative", 1e-4, 1e-4),
    ("tcp_pose", np.inf, 1e-3),  # the joints of a redundant arm do not follow from the pose
    ("tcp_displacement", np.inf, 5e-3),
]


@pytest.mark.parametrize(("arm", "joints", "tcp"), REPLAYED)
def test_absolute_targets_replay_bitwise_and_other_actions_closely(
    dataset: rc.Dataset, arm: str, joints: float, tcp: float
):
    seen = ["robots/rc7/arm/qpos", "robots/rc7/tcp_pose_in_base"]
    done = [f"robots/rc7/action/{arm}", GRIPPER]
    env = from_dataset(dataset, seen, done, flat=True)
    for index in range(len(dataset)):
        rows = rc.data.rows(dataset[index : index + 1], seen)
        actions = rc.data.rows(dataset[index : index + 1], done)
        observation, _ = env.reset(seed=index)
        for row, action in zip(rows, actions, strict=True):
            difference = abs(observation - row)
            assert difference[:7].max() <= joints
            assert difference[7:10].max() <= tcp
            observation, _, terminated, _, info = env.step(action)
            if terminated:
                break
        assert info["is_success"]


def recorded_cube(folder: Path) -> rc.Dataset:
    """Two episodes that an environment recorded, with relative actions of its own."""
    env = rc.Env(pick_cube_config(relative_to="last_step"))
    down = {"robot": {"tquat": [0, 0.02, -0.02, 0, 0, 0, 1], "gripper": 1}}
    close = {"robot": {"tquat": [0.01, 0, 0, 0, 0, 0, 1], "gripper": 0}}
    with rc.data.EnvRecorder(env, folder, images=False):
        for seed in (0, 1):
            env.reset(seed=seed)
            for action in (down, down, close, down):
                env.step(action)
    env.close()
    return rc.Dataset(folder)


def test_a_recorded_environment_replays_its_canonical_actions_bitwise(tmp_path: Path):
    dataset = recorded_cube(tmp_path)
    names = [f.name for f in dataset[0].features if f.role in ("observation", "privileged")]
    done = ["robots/robot/action/arm", "robots/robot/action/gripper"]
    env = from_dataset(dataset, names, done)
    for seed, episode in enumerate(dataset):
        row, _ = env.reset(seed=seed)
        columns = {name: np.asarray(episode[name]) for name in [*names, *done]}
        for i in range(len(episode)):
            for name in names:
                assert np.array_equal(columns[name][i], row[name]), (name, i)
            row, reward, *_ = env.step({name: columns[name][i] for name in done})
            assert reward == episode["reward"][i]
    flat = from_dataset(dataset, ["robots/robot/arm/qpos"], done, flat=True)
    vector, _ = flat.reset(seed=1)  # the last episode again, as vectors
    for action in rc.data.rows(dataset[1:], done):
        vector, *_ = flat.step(action)
    assert np.array_equal(vector, row["robots/robot/arm/qpos"])


@pytest.mark.parametrize("by_name", [True, False])
def test_the_replay_policy_repeats_both_forms_of_actions(tmp_path: Path, by_name: bool):
    env = rc.Env(pick_cube_config())
    with rc.data.EnvRecorder(env, tmp_path):
        env.reset(seed=1)
        for i in range(4):
            arm = env.row()["robots/robot/arm/target"] + 0.02
            own = {"robot": {"tquat": [0, 0, -0.01, 0, 0, 0, 1], "gripper": i % 2}}
            named = {"robots/robot/action/arm": arm, "robots/robot/action/gripper": i % 2}
            env.step(named if by_name else own)
    (episode,) = rc.Dataset(tmp_path)
    core = cast(Any, from_dataset(tmp_path, privileged=True).core)
    core.begin_at(rc.envs.EnvState(episode["env_state"]))
    replay = ReplayPolicy(tmp_path)
    features = [*core.observed, *core.commanded]
    replay.reset(Context(instruction="", run=core.env.config, seed=0, features=features))
    for row in range(4):
        assert np.array_equal(
            core.row()["robots/robot/arm/qpos"], episode["robots/robot/arm/qpos"][row]
        )
        action = replay.act(core.row())
        assert all(name.startswith("robots/") == by_name for name in action)
        _, _, _, info = core.act(action)
        assert info["is_success"] == episode["success"][row]
    env.close()


def test_errors_of_policies_in_a_recorded_environment_have_class_and_place(tmp_path: Path):
    recorded_cube(tmp_path / "cube")
    source = tmp_path / "halves.py"
    source.write_text(
        "from robocell.policy import Policy\n"
        "class Half(Policy):\n"
        "    def act(self, row):\n"
        "        if row['robots/robot/opening'] < 2:\n"
        "            return {'action/robot/tquat': [0, 0, 0, 0, 0, 0, 1]}\n"
    )
    result = evaluate(tmp_path / "cube", f"{source}:Half", episodes=1)
    assert result.failures == {
        "policy error: Half.act(): the action lacks 'action/robot/gripper'; an environment takes "
        f"whole actions ({source}:3, in act)": 1
    }


def test_a_dataset_that_was_written_row_by_row_has_no_cell(tmp_path: Path):
    with rc.data.EpisodeWriter(tmp_path, "a", {"time": rc.data.ColumnSpec()}) as episode:
        episode.add_row({"time": 0.0})
        episode.commit(success=True)
    told = r"was written row by row, .*env\.row\(\) .*env\.step .*robocell\.data\.rows"
    with pytest.raises(rc.ArgumentError, match=told):
        from_dataset(tmp_path)
    with pytest.raises(rc.ArgumentError, match=told):
        evaluate(tmp_path, "random")


def test_a_recorded_environment_takes_actions_of_one_kind(tmp_path: Path):
    dataset = recorded_cube(tmp_path)
    own = "action/robot/tquat"
    assert from_dataset(dataset).actions == [own, "action/robot/gripper"]
    gripper = "robots/robot/action/gripper"
    with pytest.raises(rc.ArgumentError, match=f"'{own}' and '{gripper}' are of two kinds"):
        from_dataset(dataset, actions=[own, gripper])
    with pytest.raises(rc.ArgumentError, match="these lack 'action/robot/gripper'"):
        from_dataset(dataset, actions=[own])
    core = from_dataset(dataset).core
    core.reset(0)
    with pytest.raises(rc.ArgumentError, match=f"'{own}' and '{gripper}' are of two kinds"):
        core.act({own: [0, 0, 0, 0, 0, 0, 1], gripper: 1})


def own_cell(name: str = "target", **fields: object) -> rc.Env:
    """The robot of the dataset before an object, in an environment of its own."""
    config = rc.EnvConfig(
        robots={"rc7": rc.models.robot_file("rc7")},
        root_frame_objects={
            name: {
                "shape": "cylinder",
                "size": [0.02, 0.04, 0],
                "mass": 0.1,
                "offset": rc.Pose(translation=[0.45, 0, 0.04]),
            }
        },
        task={"kind": "pick", "object": name},
        sim={"async_control": True, "frequency": 500 / 33},
        **fields,
    )
    return rc.Env(config)


def test_an_environment_of_ones_own_has_the_schema_of_a_dataset(dataset: rc.Dataset):
    seen = ["robots/rc7/arm/qpos", "robots/rc7/objects/target/pose_in_tcp", "robots/rc7/opening"]
    done = [ARM, GRIPPER]
    cell = own_cell()
    env = from_dataset(dataset, seen, done, flat=True, env=cell)
    vector, info = env.reset(seed=0)
    assert vector.shape == rc.data.rows(dataset, seen)[0].shape
    assert info["instruction"]
    action = np.append(vector[:7] + 0.02, 0.0)
    for _ in range(20):
        vector, *_, info = env.step(action)
    assert np.abs(vector[:7] - action[:7]).max() < 0.01
    row = cell.row()
    assert np.array_equal(vector, np.concatenate([np.ravel(row[name]) for name in seen]))
    assert row["robots/rc7/arm/target"] == pytest.approx(action[:7], abs=0)
    assert info["is_success"] is False
    with pytest.raises(rc.NotFoundError, match=r"Did you mean 'robots/rc7/action/arm'\?"):
        cell.step({"robots/rc7/action/amr": action[:7]})
    cell.close()


def test_an_environment_of_ones_own_is_compared_with_the_dataset(dataset: rc.Dataset):
    other = rc.Env(rc.EnvConfig(robots={"arm": rc.models.robot_file("rc7")}))
    with pytest.warns(UserWarning, match=r"until the arms .* a row .* 66 ms; set .* 500/33}"):
        env = from_dataset(dataset, ["robots/rc7/arm/qpos"], cameras=False, env=other)
    text = (
        r"'robots/rc7/arm/qpos' is in the dataset and not in the cell here, whose robots are: "
        r"'arm'. For 'rc7' name the robot so in `robots`"
    )
    with pytest.raises(rc.NotFoundError, match=text):
        env.reset(seed=0)
    other.close()
    cell = own_cell("cube")
    env = from_dataset(dataset, ["robots/rc7/objects/target/pose_in_tcp"], env=cell)
    with pytest.raises(rc.NotFoundError, match=r"whose objects are: 'cube'. For 'target' name it"):
        env.reset(seed=0)
    cell.close()


@pytest.mark.parametrize("kind", ["pick", "pick_and_place"])
def test_one_task_block_has_the_same_columns_in_a_run_and_an_environment(tmp_path: Path, kind: str):
    """A policy of the dataset sees the drawn objects by the same names, whichever are drawn."""
    task = {"kind": kind, "objects": ["box", "nut"]}
    dataset = make(tmp_path / "out", 2, task=task)
    cell = rc.Env(
        rc.EnvConfig(
            robots={"rc7": rc.models.robot_file("rc7")},
            add_floor=True,
            task=task,
            sim={"async_control": True, "frequency": 500 / 33},
        )
    )
    env = from_dataset(dataset, privileged=True, cameras=False, env=cell)
    shared = env.observations
    said = set()
    for seed in range(8):
        row, info = env.reset(seed=seed)
        assert list(row) == shared
        drawn = info["instruction"].split()[3]
        said.add(drawn)
        place = cell.scene.compiled.object(f"target_{drawn}").root_body
        pose = cell.scene.body_pose(place)
        np.testing.assert_allclose(row["objects/target/pose"][:3], pose.translation, atol=1e-9)
    assert said == {"box", "nut"}
    recorded = [f.name for f in dataset[0].features if f.name in shared]
    assert [name for name in cell.row() if name in shared] == recorded
    assert "objects/target/pose" in shared
    assert ("objects/goal/pose" in shared) == (kind == "pick_and_place")
    cell.close()


def test_the_random_policy_acts_on_any_group_name(dataset: rc.Dataset, tmp_path: Path):
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    assert isinstance(Policy(), Policy)
    result = evaluate(dataset.folder, "random", episodes=1, output=tmp_path / "out", cameras=False)
    assert result.rollouts == 1
    actions = rc.Dataset(tmp_path / "out")[0][ARM]
    assert len(np.unique(np.asarray(actions)[:, 0])) > 10
    assert run.robot.name == "rc7"


def recorded_where_arms_stay(folder: Path) -> rc.Dataset:
    config = pick_cube_config(relative_to="last_step")
    config.wrappers.home_on_reset = False
    env = rc.Env(config)
    with rc.data.EnvRecorder(env, folder):
        for seed in (3, 4):
            env.reset(seed=seed)
            for _ in range(3):
                env.step({"robot": {"tquat": [0.03, 0, -0.03, 0, 0, 0, 1], "gripper": 1}})
    env.close()
    return rc.Dataset(folder)


@pytest.mark.proof
def test_a_start_depends_on_its_number_alone_where_arms_stay(tmp_path: Path):
    dataset = recorded_where_arms_stay(tmp_path / "out")

    def start(numbers: list[int], steps: int) -> np.ndarray:
        env = from_dataset(dataset, cameras=False)
        for number in numbers:
            env.reset(seed=number)
            for _ in range(steps if number != numbers[-1] else 0):
                env.step(
                    {"action/robot/tquat": [0, 0, -0.05, 0, 0, 0, 1], "action/robot/gripper": [0]}
                )
        state = np.array(env.recordable.get_state().numbers)
        env.close()
        return state

    alone = start([5], 0)
    assert np.array_equal(alone, start([1, 5], 4))
    assert np.array_equal(alone, start([5, 2, 5], 2))
    assert not np.array_equal(alone, start([6], 0))

    one = evaluate(dataset.folder, "random", episodes=3, max_steps=2, output=tmp_path / "one")
    two = evaluate(
        dataset.folder, "random", episodes=3, max_steps=2, output=tmp_path / "two", workers=2
    )
    for id in one.outcomes.keys() | two.outcomes.keys():
        first, second = (rc.Dataset(tmp_path / name)[id]["env_state"] for name in ("one", "two"))
        assert np.array_equal(first, second)


def test_an_environment_of_ones_own_whose_arms_stay_is_rejected(tmp_path: Path):
    dataset = recorded_where_arms_stay(tmp_path / "out")
    config = pick_cube_config(relative_to="last_step")
    config.wrappers.home_on_reset = False
    env = rc.Env(config)
    with pytest.raises(rc.ArgumentError, match="its starts depend on the episodes before"):
        from_dataset(dataset, env=env)
    env.close()


def test_an_environment_of_your_own_is_an_object(dataset: rc.Dataset):
    with pytest.raises(rc.ArgumentError, match=r"`env` is an environment, .* got 'env.yaml'"):
        from_dataset(dataset, env="env.yaml")
