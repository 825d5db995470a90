"""Policies: what they see and do, and what is said of those that are wrong."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import pytest
from commands import generate, refusal, robocell_command
from test_evaluate import DEMO, REPLAYER, dataset, policy_file

import robocell as rc
from robocell._dataset_run import run_of_dataset
from robocell._policy_calls import present
from robocell._policy_latency import CallDelays, Latency
from robocell.evaluate import evaluate
from robocell.policy import Policy, PolicyExpert

__all__ = ["dataset"]  # a fixture


class Spy(Policy):
    def __init__(self, actions: list[np.ndarray]) -> None:
        self.seen: list[dict[str, np.ndarray]] = []
        self.actions = actions

    def act(self, observation):
        self.seen.append(observation)
        at = min(len(self.seen), len(self.actions)) - 1
        arm, opening = self.actions[at]
        return {"robots/rc7/action/arm": arm, "robots/rc7/action/gripper": opening}


def test_a_policy_sees_the_rows_that_a_dataset_records(dataset: Path, tmp_path: Path):
    """The recorded actions, played by a policy, lead through the recorded rows."""
    run = run_of_dataset(dataset)
    run.output = str(tmp_path / "played")
    source = rc.Dataset(dataset)[0]
    actions = list(
        zip(source["robots/rc7/action/arm"], source["robots/rc7/action/gripper"], strict=True)
    )
    spies: list[Spy] = []

    def expert(run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> rc.tasks.Expert:
        spies.append(Spy(actions))
        return PolicyExpert(run, start, spies[-1])

    run.keep = rc.generate.Keep.FIRST
    run.episodes, run.max_attempts = 1, 20
    rc.generate.prepare_dataset(run)
    result = rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
    assert result.committed
    played = rc.Dataset(run.output)[0]
    spy = spies[-1]
    assert len(spy.seen) == len(played)
    for name in (
        "robots/rc7/arm/qpos",
        "robots/rc7/arm/qvel",
        "robots/rc7/tcp_pose",
        "robots/rc7/tcp_pose_in_base",
        "robots/rc7/base_pose",
        "robots/rc7/opening",
        "objects/target/pose",
        "time",
    ):
        seen = np.array([row[name] for row in spy.seen])
        np.testing.assert_allclose(seen, played[name], rtol=0, atol=1e-12, err_msg=name)


class Ramp(Policy):
    """Chunks of six targets of the first joint, 0.01 rad apart."""

    def __init__(self, run: rc.RunConfig) -> None:
        self.home = np.array(run.robot.home["arm"])

    def act(self, observation):
        targets = np.tile(self.home, (6, 1))
        targets[:, 0] += 0.1 + 0.01 * np.arange(6)
        return {"robots/rc7/action/arm": targets, "robots/rc7/action/gripper": np.ones((6, 1))}


def test_late_actions_repeat_exactly_and_the_robot_waits_for_the_first(
    dataset: Path, tmp_path: Path
):
    rc.policy.register_policy("late ramp", Ramp, latency=100)
    played = []
    for name in ("one", "other"):
        run = run_of_dataset(dataset)
        run.output, run.expert, run.keep = str(tmp_path / name), "late ramp", "first"
        run.cameras.draw = False
        run.rates.policy_ms, run.rates.max_steps, run.episodes = 66, 12, 1
        rc.generate.prepare_dataset(run)
        rc.generate.Runner(run).run(rc.generate.make_plan(run)[0])
        played.append(rc.Dataset(run.output)[0])
    one, other = played
    assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.columns)
    taken = one["robots/rc7/action/arm"][:, 0] - run.robot.home["arm"][0]
    held = one["robots/rc7/arm/target"][0, 0] - run.robot.home["arm"][0]
    # 100 ms are two actions of 66 ms: the first two of each chunk come too late.
    chunk = [0.12, 0.13, 0.14, 0.15]
    assert np.allclose(taken, [held, held, *chunk, *chunk, *chunk[:2]])


class Slow(Ramp):
    """Ramps whose calls take 0, 1, 2 and 3 actions in turn, in the first evaluation only."""

    sleeps = True

    def __init__(self, run: rc.RunConfig) -> None:
        super().__init__(run)
        self.calls = 0

    def act(self, observation):
        if self.sleeps:
            time.sleep(0.066 * (self.calls % 4))
        self.calls += 1
        action = super().act(observation)
        action["robots/rc7/action/arm"][:, 0] += 0.001 * self.calls
        return action


def test_measured_latencies_of_calls_are_repeated_exactly(
    dataset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def play(latency: str, name: str, steps: int = 20) -> tuple[rc.Episode, list[dict[str, float]]]:
        rc.policy.register_policy(f"slow {name}", Slow, latency=latency)
        run = run_of_dataset(dataset)
        run.output, run.expert, run.keep = str(tmp_path / name), f"slow {name}", "first"
        run.cameras.draw = False
        run.rates.policy_ms, run.rates.max_steps, run.episodes = 66, steps, 1
        rc.generate.prepare_dataset(run)
        (item,) = rc.generate.make_plan(run)
        present.rollout = item.id
        rc.generate.Runner(run).run(item)
        present.save(Path(run.output))
        return rc.Dataset(run.output)[0], list(present.calls)

    measured, calls = play("measured", "measured")
    delays = [call["delay"] for call in calls]
    assert delays == [math.ceil(call["ms"] / 66) for call in calls]
    assert delays[0] <= 1
    assert all(delay > number % 4 for number, delay in enumerate(delays) if number % 4)
    monkeypatch.setattr(Slow, "sleeps", False)
    recorded = f"recorded:{tmp_path / 'measured'}"
    again, repeated = play(recorded, "again")
    assert [call["delay"] for call in repeated] == delays
    steps = [episode.folder / "steps.h5" for episode in (measured, again)]
    assert steps[0].read_bytes() == steps[1].read_bytes()
    _, more = play(recorded, "longer", 30)
    assert [call["delay"] for call in more[: len(delays)]] == delays
    assert {call["delay"] for call in more[len(delays) :]} == {delays[-1]}, "the last one stays"
    late = Latency.parse(recorded)
    late.require_recorded([present.rollout])
    with pytest.raises(rc.ArgumentError, match="the folder lacks the calls of s9_e9"):
        late.require_recorded([present.rollout, "s9_e9"])
    with pytest.raises(rc.ArgumentError, match="evaluation that `robocell evaluate` completed"):
        Latency.parse(f"recorded:{tmp_path}").require_recorded([present.rollout])
    for rollout in ("", "s9_e9"):  # a run that is no evaluation gives its rollouts no names
        with pytest.raises(rc.ArgumentError, match="lacks the calls of this rollout"):
            CallDelays(late, 66).begin(rollout)


def test_latencies_are_read_from_text():
    for text in ("0", "80", "62.5", "measured", "recorded:out/eval"):
        assert str(Latency.parse(text)) == text
    assert [bool(Latency.parse(text)) for text in ("0", "1", "measured")] == [False, True, True]
    for wrong in ("recorded:", "fast", "-1", "nan", "inf"):
        with pytest.raises(rc.ArgumentError, match="latency"):
            Latency.parse(wrong)


def test_errors_explain_an_invalid_policy(dataset: Path, tmp_path: Path):
    (tmp_path / "mine.py").write_text(REPLAYER)
    out = tmp_path / "out"

    def said(policy: str) -> str:
        return refusal("evaluate", dataset, "--policy", policy, "-n", "1", "--output", out)

    assert "expected module:Class" in said("mine")
    assert "Did you mean 'expert'?" in said("expret")
    file = tmp_path / "mine.py"
    assert f"name the class of the policy too: {file}:" in said(str(file))
    assert "no class or function 'Gone'" in said(f"{tmp_path / 'mine.py'}:Gone")
    assert "there is no such file" in said(f"{tmp_path / 'no.py'}:Stay")
    wrong = robocell_command(
        *("evaluate", dataset, "--policy", f"{tmp_path / 'mine.py'}:Wrong", "-n", "1"),
        *("--output", out),
    )
    assert wrong.returncode == 1, "errors of the policy ended all rollouts"
    assert "policy error: Wrong.act(): no action 'robots/rc7/action/am'" in wrong.stderr
    assert "robots/rc7/action/arm" in wrong.stderr
    assert wrong.stderr.count("Wrong.act()") == 1, "once is enough"


def test_an_exception_in_a_policy_fails_and_names_its_line(dataset: Path, tmp_path: Path):
    file = policy_file(tmp_path, "raising")
    line = 1 + REPLAYER[: REPLAYER.index("return 1 / 0")].count("\n")
    result = evaluate(
        dataset, f"{file}:Raising", episodes=3, workers=2, output=tmp_path / "out", cameras=False
    )
    assert (result.successes, result.rollouts, result.unmade) == (0, 3, 0)
    assert result.policy_errors == 3
    (reason,) = result.failures
    assert reason.startswith("policy error: ZeroDivisionError: division by zero (")
    assert reason.endswith(f"raising.py:{line}, in act)")


BROKEN = """
import numpy as np
from robocell.policy import Policy

ARM, GRIPPER = "robots/rc7/action/arm", "robots/rc7/action/gripper"


class Picky(Policy):  # as Stay, and raises at what is on the left
    def act(self, observation):
        if observation["objects/target/pose"][1] > 0 and observation["time"] > 0.3:
            raise RuntimeError("not this\\nside")
        return {ARM: observation["robots/rc7/arm/target"], GRIPPER: 1}


class NotFinite(Policy):
    def act(self, observation):
        return {ARM: [0, 0, np.nan, 0, 0, 0, 0]}


class Shape(Policy):
    def act(self, observation):
        return {ARM: np.zeros(3)}


class Nothing(Policy):
    def act(self, observation):
        return None


class Turned(Policy):
    def act(self, observation):
        return {"robots/rc7/action/tcp_pose": np.zeros(7)}


class Exits(Policy):
    def act(self, observation):
        raise SystemExit(0)


class MuteError(Exception):
    def __str__(self):
        raise RuntimeError("no text")


class Mute(Policy):
    def act(self, observation):
        raise MuteError


class Complex(Policy):
    def act(self, observation):
        return {ARM: np.zeros(7) + 1j}


class Reset(Policy):
    def reset(self, context):
        raise KeyError("weights")

    def act(self, observation):
        return {}


class Each(Policy):  # one of those above in each rollout
    rollouts = iter([NotFinite, Shape, Complex, Nothing, Turned, Exits, Mute, Reset])

    def reset(self, context):
        self.own = next(Each.rollouts)()
        self.own.reset(context)

    def act(self, observation):
        return self.own.act(observation)


class Made(Policy):
    def __init__(self):
        raise ImportError("no weights")

    def act(self, observation):
        return {}
"""


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A module is loaded from one file only."""
    file = tmp_path_factory.mktemp("policies") / "broken.py"
    file.write_text(BROKEN)
    return file


@pytest.mark.proof
def test_an_exception_in_a_policy_keeps_the_start(dataset: Path, broken: Path, tmp_path: Path):
    """The rollout from this start is a failure; another start would break the comparison."""
    picky = evaluate(dataset, f"{broken}:Picky", episodes=8, output=tmp_path / "out")
    assert (picky.rollouts, picky.unmade, picky.successes) == (8, 0, 0)
    other = evaluate(
        dataset, "random", episodes=8, output=tmp_path / "random", cameras=False
    ).outcomes
    assert other.keys() == picky.outcomes.keys()
    raised = 0
    for episode in rc.Dataset(tmp_path / "out"):
        start = episode["objects/target/pose"][0]
        twin = rc.Dataset(tmp_path / "random")[episode.id]
        assert np.array_equal(start, twin["objects/target/pose"][0])
        assert episode.metadata["attempt"] == twin.metadata["attempt"]
        if start[1] <= 0:
            assert episode.end_reason == "timeout"
            continue
        raised += 1
        assert "policy error: RuntimeError: not this side (" in episode.end_reason
        assert episode.end_reason.endswith("broken.py:11, in act)")
        assert not episode.success
        assert 5 < len(episode) < 20, "it was recorded until then"
        moved = np.abs(np.diff(episode["robots/rc7/action/arm"], axis=0)).max()
        assert moved < 0.01, "the targets are held in the last row"
    assert 0 < raised < 8, "the seed has starts of both kinds"
    assert picky.policy_errors == raised
    assert sum(picky.failures.values()) == 8


def test_invalid_actions_fail_their_rollouts(dataset: Path, broken: Path, tmp_path: Path):
    """One worker makes them all: a mistake costs its rollout alone."""
    arm = "'robots/rc7/action/arm'"
    reasons = (
        f"Each.act(): {arm} is not finite: entry [2] is nan",
        f"Each.act(): {arm} has 7 numbers, or (k, 7) for a chunk;",
        f"TypeError: Each.act(): {arm} must be real numbers",
        "TypeError: Each.act() must return a dict of columns",
        "action 'robots/rc7/action/tcp_pose': quaternion [0, 0, 0, 0] (xyzw) has length 0",
        "SystemExit: 0 (",
        "MuteError: (its text cannot be made) (",
        "KeyError: 'weights' (",
    )
    count = len(reasons)
    options = {"episodes": count, "output": tmp_path / "out", "cameras": False}
    result = evaluate(dataset, f"{broken}:Each", **options)
    assert (result.rollouts, result.unmade, result.policy_errors) == (count, 0, count)
    for reason in reasons:
        (said,) = (each for each in result.failures if each.startswith(f"policy error: {reason}"))
        assert "broken.py:" in said


def test_rejects_an_evaluation_without_a_policy(
    dataset: Path, broken: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(
        rc.Error, match=r"^[^\n]*ImportError: no weights \(.*broken\.py:\d+, in __init__\)$"
    ):
        evaluate(dataset, f"{broken}:Made", episodes=2, output=tmp_path / "out")
    said = capsys.readouterr().err
    assert said.count("no weights") > 1, "for each rollout"
    assert said.count('raise ImportError("no weights")') == 1, "the worker's traceback, once"


def test_a_dataset_replays_its_own_actions(dataset: Path, tmp_path: Path):
    result = evaluate(dataset, "replay", output=tmp_path / "out")
    assert (result.successes, result.rollouts) == (2, 2)
    for episode in rc.Dataset(dataset):
        again = rc.Dataset(tmp_path / "out")[episode.id]
        rows = len(again)  # a policy ends at success, an expert goes on to hold
        for name in ("robots/rc7/arm/qpos", "objects/target/pose"):
            assert np.array_equal(episode[name][:rows], again[name])
    said = refusal("evaluate", DEMO, "--policy", "replay", "-o", tmp_path / "none")
    assert "takes the actions of a dataset" in said
    said = robocell_command(
        *("evaluate", dataset, "--policy", "replay", "--seed", "5", "-n", "1"),
        *("-o", tmp_path / "other"),
    )
    assert "starts like this one" in said.stdout + said.stderr
    own = rc.Dataset(dataset)[0].metadata["seed"]
    assert f"Its own starts are those of --seed {own}" in said.stdout + said.stderr


@pytest.mark.parametrize("keep", ["successes", pytest.param("all", marks=pytest.mark.proof)])
def test_replay_begins_at_the_recorded_attempt(keep: str, tmp_path: Path):
    """Few steps let the first attempts of some episodes fail."""
    out = tmp_path / "out"
    words = ("--set", "cameras.streams=[]", "--set", "rates.max_steps=66", "--set", f"keep={keep}")
    generate(DEMO, out, "--episodes", 4, *words)
    recorded = {e.id: e.metadata["attempt"] for e in rc.Dataset(out) if e.success}
    assert max(recorded.values()) > 0
    result = evaluate(out, "replay", output=tmp_path / "again")
    assert (result.successes, result.rollouts) == (4, 4)
    again = [episode.metadata["attempt"] for episode in rc.Dataset(tmp_path / "again")]
    assert again == list(recorded.values())


def test_only_reading_an_image_draws_it_for_a_policy(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
):
    """Reading numbers, or the names, draws nothing of a rollout that is not kept."""

    class Reading(Policy):
        def __init__(self, key: str) -> None:
            self.key = key
            self.rows: list[dict[str, np.ndarray]] = []

        def act(self, observation):
            assert "wrist" in observation
            assert len(list(observation)) == len(observation)
            self.rows.append(observation)
            self.read = observation[self.key]
            return {"robots/rc7/action/arm": observation["robots/rc7/arm/qpos"]}

    run = rc.RunConfig.load(DEMO)
    run.episodes, run.max_attempts, run.rates.max_steps = 1, 1, 3
    run.render = rc.generate.RenderWhen.KEPT
    run.cameras.resolution = [64, 48]
    read = {}
    for key in ("time", "wrist"):
        run.output = str(tmp_path / key)
        policies: list[Reading] = []

        def expert(run, start, key=key, policies=policies):
            policies.append(Reading(key))
            return PolicyExpert(run, start, policies[-1])

        rc.generate.prepare_dataset(run)
        result = rc.generate.Runner(run, expert=expert).run(rc.generate.make_plan(run)[0])
        assert (result.accepted, result.committed) == (1, False)
        assert key == "wrist" or "looks at images" not in capfd.readouterr().err
        read[key] = policies[-1]
    assert read["wrist"].read.shape == (48, 64, 3)
    assert read["wrist"].rows[0]["exo"].any(), "kept with the one that was read"
    with pytest.raises(rc.Error, match=r"'exo' of an earlier row was not read in time: read"):
        read["time"].rows[0]["wrist"]


MISSING = """
from robocell.policy import Policy


class Turns(Policy):  # asks for a number in its first rollout, for an image in the next
    rollouts = 0

    def reset(self, context):
        Turns.rollouts += 1

    def act(self, observation):
        if Turns.rollouts == 1:
            return observation["robots/rc7/arm/qpo"]
        return observation["wrist_cam"]


class Idle(Policy):
    def acts(self, observation):
        return {}


class Odd(Policy):
    def act(self):
        return {}


class Duck:
    def act(self, observation):
        return {}


def idle(run):
    return Idle()
"""


@pytest.fixture(scope="module")
def missing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of the policies that lack something; a process imports one file of this name."""
    folder = tmp_path_factory.mktemp("missing")
    file = folder / f"{folder.name}.py"
    file.write_text(MISSING)
    return file


def test_a_missing_name_has_the_nearest_and_the_available_ones(
    dataset: Path, missing: Path, tmp_path: Path
):
    options = {"episodes": 2, "output": tmp_path / "out", "cameras": False}
    result = evaluate(dataset, f"{missing}:Turns", **options)
    image, near = sorted(result.failures, key=lambda reason: "wrist_cam" not in reason)
    assert "Turns.act(): the observation has no 'robots/rc7/arm/qpo'. Did you mean " in near
    assert "Did you mean 'robots/rc7/arm/qpos'? It has: " in near
    assert f"{missing.name}:13, in act)" in near
    assert "the cell has no `cameras.streams`" in image


@pytest.mark.parametrize(
    ("policy", "text"),
    [
        (
            "Idle",
            r"class Idle \(.*missing\d+.py:17\) lacks methods .* add def act\(self, observation",
        ),
        ("Odd", r"Odd\.act \(line 23\) is called as act\(observation\), .* write def act\(self, o"),
        ("Duck", r"class Duck \(.*missing\d+.py:27\) lacks .* add def reset\(self, context\)"),
        ("idle", r"class Idle \(.*missing\d+.py:17\) lacks methods"),
    ],
)
def test_a_class_that_is_no_policy_is_rejected(
    dataset: Path, missing: Path, tmp_path: Path, policy: str, text: str
):
    with pytest.raises(rc.Error, match=text):
        evaluate(dataset, f"{missing}:{policy}", episodes=1, output=tmp_path / policy)
