"""Evaluations of policies behind a socket, and policies that robocell serves."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import ROOT, refusal

import robocell as rc
from openpi_peer import OpenpiClient, openpi_server
from robocell._generation.supervisor import Limits
from robocell._policy_latency import Latency
from robocell._policy_options import PolicyOptions
from robocell.evaluate import Evaluation, default_output, evaluate
from robocell.policy import expert_of_policy
from robocell.policy_server import PolicyClient, PolicyServerError, policy_server

STEPS = 20
ARM = "robots/rc7/action/arm"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of short rollouts with two small cameras."""
    text = (ROOT / "examples" / "demo.yaml").read_text()
    text = text.replace("../models", str(ROOT / "models"))
    text = text.replace("[320, 240]", "[64, 48]").replace("max_steps: 500", f"max_steps: {STEPS}")
    file = tmp_path_factory.mktemp("runs") / "short.yaml"
    file.write_text(text)
    return file


@contextlib.contextmanager
def served(policy: str, source: Path) -> Iterator[str]:
    """The URL of a server in this process."""
    server = policy_server(policy, source, port=0)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    yield server.url
    server.close()
    thread.join(5)


@dataclass(frozen=True)
class Evaluated:
    """An evaluation of a server of openpi, and the observations that it got."""

    result: Evaluation
    seen: list[dict[str, Any]]
    url: str


@pytest.fixture(scope="module")
def evaluated(run: Path, tmp_path_factory: pytest.TempPathFactory) -> Evaluated:
    seen: list[dict[str, Any]] = []

    def infer(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        actions = np.zeros((10, 8), np.float32)
        actions[:, 0] = 0.1
        return {"actions": actions, "server_timing": {"infer_ms": 2.5}}

    out = tmp_path_factory.mktemp("evaluated") / "out"
    with openpi_server(infer, {"model": "pi0"}) as url:
        result = evaluate(run, url, episodes=2, output=out, preset="droid")
    return Evaluated(result, seen, url)


def test_a_policy_of_openpi_is_evaluated_with_a_preset(evaluated: Evaluated):
    result, seen = evaluated.result, evaluated.seen
    assert (result.rollouts, result.policy_errors, result.failures) == (2, 0, {"timeout": 2})
    assert (result.policy, result.server) == (evaluated.url, {"model": "pi0"})
    assert len(seen) == 2 * 3, "eight of ten actions are taken: 8, 8 and 4"
    assert result.latency["calls"] == len(seen)
    assert result.latency["median_ms"] <= result.latency["p99_ms"] <= result.latency["max_ms"]
    first = seen[0]
    assert first["observation/exterior_image_1_left"].shape == (224, 224, 3)
    assert first["observation/wrist_image_left"].any()
    assert first["prompt"].startswith("pick up ")
    out = Path(result.dataset)
    for episode in rc.Dataset(out):
        np.testing.assert_allclose(np.diff(episode[ARM][:, 0]), 0.02, atol=1e-6)
        recorded = json.loads((out / "policy_calls" / f"{episode.id}.json").read_text())
        assert [call["step"] for call in recorded["calls"]] == [0, 8, 16]
        for call in recorded["calls"]:
            assert call["actions"] == 10
            assert call["server_ms"] == 2.5
            assert call["ms"] > call["round_trip_ms"] > 0
    qpos = rc.Dataset(out)[0]["robots/rc7/arm/qpos"]
    np.testing.assert_allclose(first["observation/joint_position"], qpos[0], atol=1e-6)


@pytest.mark.parametrize("recorded", [False, pytest.param(True, marks=pytest.mark.proof)])
def test_a_preset_may_be_a_file_in_the_working_folder(
    run: Path, evaluated: Evaluated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recorded: bool
):
    (tmp_path / "mine.yaml").write_text("extends: droid\n")
    monkeypatch.chdir(tmp_path)
    source = Path(evaluated.result.dataset) if recorded else run
    with openpi_server(lambda _: {"actions": np.zeros((10, 8), np.float32)}) as url:
        options: dict[str, Any] = {"episodes": 1, "output": "out", "preset": "mine.yaml"}
        result = evaluate(source, url, **options)
        assert (result.rollouts, result.policy_errors) == (1, 0)
        again = evaluate(source, url, **(options | {"preset": tmp_path / "mine.yaml"}))
        assert again.outcomes == result.outcomes


@pytest.mark.proof
def test_recorded_actions_over_the_socket_repeat_an_evaluation(
    run: Path, evaluated: Evaluated, tmp_path: Path
):
    with served("replay", Path(evaluated.result.dataset)) as url:
        again = evaluate(run, url, episodes=2, output=tmp_path / "again", horizon=3)
    assert (again.outcomes, again.policy_errors) == (evaluated.result.outcomes, 0)
    for one in rc.Dataset(evaluated.result.dataset):
        other = rc.Dataset(tmp_path / "again")[one.id]
        for name in (ARM, "robots/rc7/arm/qpos", "objects/target/pose"):
            assert np.array_equal(one[name], other[name])


@pytest.mark.proof
def test_a_hostile_server_fails_rollouts_and_a_lost_one_stops_the_evaluation(
    run: Path, tmp_path: Path
):
    """A wrong reply is a failure with its reason; a rollout without a server is none."""
    bad = np.zeros((10, 8))
    bad[4, 2] = np.inf
    is_ill, stop = threading.Event(), threading.Event()
    is_ill.set()
    calls: list[int] = []
    replies = [
        lambda: {"actions": bad},
        lambda: {"actions": np.zeros((10, 7))},
        lambda: "Traceback (most recent call last):\nRuntimeError: out of memory",
        lambda: b"\xdd\x7f\xff\xff\xff",
        lambda: stop.wait(3.0) and bad,
    ]

    def infer(_: dict[str, Any]) -> Any:
        calls.append(1)
        if len(calls) <= len(replies):
            return replies[len(calls) - 1]()
        return ... if is_ill.is_set() else np.zeros((10, 8), np.float32)

    with openpi_server(infer) as url:
        options = {"episodes": len(replies) + 1, "output": tmp_path / "out", "preset": "droid"}
        options |= {"policy_timeout_s": 1.0, "limits": Limits(tries=1)}
        with pytest.raises(rc.IoError, match=f"policy server {url}: the other end closed the conn"):
            evaluate(run, url, **options)
        stop.set()
        assert len(rc.Dataset(tmp_path / "out")) == len(replies)
        tried = len(calls) - len(replies)
        assert tried == 2, "a dropped connection is tried once more"
        is_ill.clear()
        result = evaluate(run, url, **options)
        assert len(calls) == len(replies) + tried + 3, "the other rollouts are not repeated"
    assert (result.rollouts, result.unmade, result.policy_errors) == (6, 0, 5)
    assert result.failures.pop("timeout") == 1
    said = "\n".join(result.failures)
    for reason in (
        "not finite: entry [4, 2] is inf",
        "an action has 8 numbers: robots/rc7/action/arm_relative (7), robots/rc7/action/gripper (1)"
        "; the policy returned the shape (10, 7)",
        "the server has an error: RuntimeError: out of memory",
        "are not a msgpack message",
        "no answer within 1 s",
    ):
        assert reason in said
    assert all(reason.startswith("policy error: policy server ws://") for reason in result.failures)


@pytest.mark.proof  # several workers are below
def test_an_expert_over_the_socket_succeeds(tmp_path: Path):
    demo = ROOT / "examples" / "demo.yaml"
    with served("expert", demo) as url:
        result = evaluate(
            demo, url, episodes=2, output=tmp_path / "out", cameras=False, horizon=20, workers=2
        )
        assert (result.successes, result.policy_errors) == (2, 0)
        steps = sum(len(episode) for episode in rc.Dataset(tmp_path / "out"))
        assert steps / 20 <= result.latency["calls"] <= steps / 20 + 2
        with pytest.raises(RuntimeError, match="which only `robocell evaluate` names"):
            OpenpiClient(url).infer({"prompt": "pick"})
        client = PolicyClient(url)
        with pytest.raises(PolicyServerError, match="has no rollout 's0009_e0000'"):
            client.reset({}, {"rollout": "s0009_e0000", "run_seed": 0})
        with pytest.raises(PolicyServerError, match="beyond 100000 episodes of a scene"):
            client.reset({}, {"rollout": "s0000_e999999999", "run_seed": 0})


def test_the_command_serves_until_it_is_interrupted(tmp_path: Path):
    (tmp_path / "waits.py").write_text(WAITS)
    command = [sys.executable, "-m", "robocell", "serve-policy", "waits.py:Waits", "--port", "0"]
    environment = os.environ | {"ROBOCELL_POLICY_API_KEY": "secret"}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, env=environment, text=True, cwd=tmp_path
    ) as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        found = re.fullmatch(r"waits\.py:Waits: (ws://127\.0\.0\.1:\d+)\n", said)
        assert found is not None, said
        client = OpenpiClient(found[1], "secret")
        assert client.metadata["policy"] == "waits.py:Waits"
        assert client.infer({"q": np.ones(3)})["actions"].tolist() == [[1, 1, 1]]
        with pytest.raises(PolicyServerError, match="set the variable ROBOCELL_POLICY_API_KEY"):
            PolicyClient(found[1]).connect()
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 0


WAITS = """
from robocell.policy import Policy


class Waits(Policy):
    def act(self, observation):
        return {"robots/a/action/arm": observation["q"]}
"""


@pytest.mark.proof
def test_options_of_policies_that_do_not_fit_are_explained(run: Path, tmp_path: Path):
    def said(*options: str) -> str:
        return refusal("evaluate", run, *options, "-n", "1", "-o", tmp_path / "out")

    assert "--preset is for a policy server" in said("--policy", "random", "--preset", "droid")
    assert "for policies that return chunks" in said("--policy", "expert", "--horizon", "3")
    server = ("--policy", "ws://127.0.0.1:9")
    assert "no policy server at ws://127.0.0.1:9: Connection refused. Start it" in said(*server)
    assert "no preset 'driod'. Did you mean 'droid'?" in said(*server, "--preset", "driod")
    assert "such as ws://127.0.0.1:8000" in said("--policy", "ws://")
    for policy in ("replay", "expert"):
        assert "--run" in refusal("serve-policy", policy)
    assert not (tmp_path / "out").exists()


def test_options_are_part_of_what_an_evaluation_is():
    acting = PolicyOptions(horizon=3, ensemble=True)
    assert expert_of_policy("random", "", acting) == "random horizon=3 ensemble"
    late = PolicyOptions(latency=Latency(80))
    assert expert_of_policy("random", "", late) == "random latency=80"
    assert late.arguments() == ["--latency=80"]
    url = "ws://127.0.0.1:9"
    assert expert_of_policy(url, "", PolicyOptions("droid")) == f"{url} preset=droid"
    assert expert_of_policy(url, "", PolicyOptions(timeout_s=3)) == url


def test_an_evaluation_of_a_server_has_a_folder_of_its_own():
    assert default_output("out/picks", "ws://127.0.0.1:8000", 7) == Path(
        "out/picks_evaluation/127.0.0.1_8000-7"
    )
    assert default_output("out/picks", "wss://gpu.lab/pi0/", 7).name == "gpu.lab_pi0-7"


def test_an_evaluation_of_an_earlier_version_is_still_read(tmp_path: Path):
    stored = Evaluation("p", 1, 1, (0.2, 1.0), 3.0, 0, {}, 0, {"a": True}, "out", 1, {})
    content = json.loads(stored.to_json())
    del content["latency"], content["server"]
    (tmp_path / "evaluation.json").write_text(json.dumps(content))
    assert Evaluation.load(tmp_path) == stored


BATCHED = """
import numpy as np
from pathlib import Path
from robocell.policy import Policy

class Turns(Policy):
    def act_batch(self, observations, contexts):
        with Path(__file__).with_name("sizes.txt").open("a") as file:
            print(len(observations), file=file)
        q = np.stack([each["robots/rc7/arm/qpos"] for each in observations])
        return [
            {
                "robots/rc7/action/arm": row + 1e-3 * (each.seed % 7),
                "robots/rc7/action/gripper": 1.0,
            }
            for row, each in zip(q, contexts)
        ]

    def reset(self, context):
        self.context = context

    def act(self, observation):
        Path(__file__).with_name("alone.txt").touch()
        return self.act_batch([observation], [self.context])[0]
"""


def test_workers_share_a_connection_and_the_rollouts_are_the_same(run: Path, tmp_path: Path):
    policy = tmp_path / "batched_policy.py"
    policy.write_text(BATCHED)
    options: dict[str, Any] = {"episodes": 3, "cameras": False, "max_steps": 6}
    alone = evaluate(run, f"{policy}:Turns", output=tmp_path / "alone", **options)
    for name in ("sizes.txt", "alone.txt"):
        (tmp_path / name).unlink()
    with served(f"{policy}:Turns", run) as url:
        together = evaluate(run, url, output=tmp_path / "together", workers=2, **options)
    sizes = [int(line) for line in (tmp_path / "sizes.txt").read_text().split()]
    assert sum(sizes) == 3 * 6
    assert not (tmp_path / "alone.txt").exists(), "every observation came in a batch"
    assert (together.policy, together.server["batch"]) == (url, 64)
    assert together.outcomes == alone.outcomes
    for one, other in zip(
        rc.Dataset(tmp_path / "alone"), rc.Dataset(tmp_path / "together"), strict=True
    ):
        assert (one.folder / "steps.h5").read_bytes() == (other.folder / "steps.h5").read_bytes()
