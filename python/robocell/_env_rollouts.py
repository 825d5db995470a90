"""Rollouts of a policy in the environment that a dataset was recorded in.

The module is also the worker process of `_env_job`: it makes one rollout from each start that the
supervisor hands to it, and records it with `EnvRecorder`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from robocell._acting_policy import ActingPolicy
from robocell._action_chunks import Chunks
from robocell._core import ArgumentError, Dataset, EnvState, Episode, Error, SpecError, StopFlag
from robocell._generation.items import Item, ItemRecord
from robocell._generation.run_source import RunSource, import_named
from robocell._generation.worker import MakeEpisode
from robocell._generation.worker_entry import run_worker, worker_command
from robocell._own_code import RAISED, own_sources, raise_interrupt
from robocell._policy_calls import present
from robocell._raised import LostPolicyError, UnmadePolicyError, text_of_hook, text_of_method
from robocell._row import Row
from robocell._spec_fields import fields_of, file_hashes, hashes_in
from robocell.policy import (
    POLICY_ERROR,
    Context,
    NamedPolicy,
    named_policy,
)

if TYPE_CHECKING:
    from robocell.envs import RecordedCellEnv

MODELS = "models"  # a folder of every dataset
TIMEOUT = "timeout"  # end of a rollout whose actions are used up


@dataclass(frozen=True)
class EnvStarts:
    """What all rollouts of an evaluation have in common, beside the policy.

    Attributes:
        dataset: Folder of the recorded dataset.
        output: Folder of the rollouts.
        seed: Seed of the starts; None for the recorded starts, which `replay` begins from.
        max_steps: Actions of a rollout.
        cameras: Whether images are rendered.
    """

    dataset: Path
    output: Path
    seed: int | None
    max_steps: int
    cameras: bool

    def item(self, number: int) -> Item:
        """Returns the item of start `number`."""
        return Item(f"{self.prefix(number)}-000000", number)

    def prefix(self, number: int) -> str:
        """Returns the prefix of the recorder, whose first episode has the id of the item."""
        return f"{'recorded' if self.seed is None else 'start'}{number:06d}"

    def reset_seed(self, number: int) -> int:
        """Returns the seed of `reset` for start `number`."""
        return _derived(self.seed, number, "start")

    def policy_seed(self, number: int) -> int:
        """Returns the seed that the policy gets in the rollout from start `number`."""
        return _derived(self.seed, number, "policy")

    def arguments(self) -> list[str]:
        """Returns the options of the worker's command."""
        return [
            f"--output={self.output}",
            *([] if self.seed is None else [f"--seed={self.seed}"]),
            f"--max-steps={self.max_steps}",
            *([] if self.cameras else ["--no-cameras"]),
        ]


def _derived(seed: int | None, number: int, purpose: str) -> int:
    """Returns 31 bits that depend on all arguments."""
    digest = hashlib.sha256(f"{seed} {number} {purpose}".encode()).digest()
    return int.from_bytes(digest[:4], "little") >> 1


def identity_of(
    starts: EnvStarts, named: NamedPolicy, modules: Sequence[str], cell: str
) -> dict[str, Any]:
    """Returns what an evaluation is continued by: policy, code, starts; kept with each episode."""
    described = asdict(starts) | {"dataset": str(starts.dataset.absolute()), "policy": named.kind}
    del described["output"]
    files = [
        *own_sources(getattr(named.make, "__module__", None), *modules),
        *_files_of(named.files),
    ]
    described["cell"] = hashlib.sha256(cell.encode()).hexdigest()
    described["code"] = {str(file): _hash(file) for file in sorted(set(files))}
    return described


def _files_of(paths: Sequence[Path]) -> list[Path]:
    """Returns files, and those in folders."""
    return [
        file
        for path in paths
        for file in (path.rglob("*") if path.is_dir() else (path,))
        if file.is_file() and "__pycache__" not in file.parts
    ]


def _hash(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


class EnvRollouts:
    """Makes rollouts, one after another.

    Raises SpecError for a policy or modules that cannot be imported, ArgumentError for an
    environment without a task, and the errors of `from_dataset`.
    """

    def __init__(self, source: RunSource, starts: EnvStarts) -> None:
        from robocell.envs import from_dataset

        self.starts = starts
        modules = [import_named(module, Path.cwd()) for module in source.imports]
        self.named = named_policy(source.policy, starts.dataset, source.acting)
        self.env = from_dataset(
            starts.dataset, privileged=True, cameras=starts.cameras, imports=source.imports
        )
        self.cell = cast("RecordedCellEnv", self.env.core)
        self.config = self.cell.env.config
        if self.config.task is None:
            raise ArgumentError(
                f"'{starts.dataset}' was recorded in an environment without a task, so nothing "
                "says which rollouts succeed: give its configuration a `task`, such as {kind: "
                "pick}, and record again"
            )
        models = file_hashes(hashes_in(starts.dataset / MODELS))
        # Without images it has no streams either.
        cell = models | {
            name: value
            for name, value in fields_of(self.config).items()
            if not name.startswith("cameras.")
        }
        self.identity = identity_of(starts, self.named, modules, json.dumps(cell))
        self.cell_fields = cell | {"max_steps": str(starts.max_steps)}
        self._has_streams = bool(Dataset(starts.dataset)[0].streams)
        self._policy: ActingPolicy | None = None

    def run(self, item: Item, stop: StopFlag) -> ItemRecord:
        """Makes the rollout from a start, and commits its episode."""
        from robocell.data import EnvRecorder

        acting = self._acting()
        present.rollout, present.seed, present.error = item.id, self.starts.seed or 0, ""
        present.calls = []
        recorder = EnvRecorder(
            self.env,
            self.starts.output,
            prefix=self.starts.prefix(item.index),
            images=self.starts.cameras,
            metadata={"evaluation": self.identity},
        )
        with recorder:
            end = self._act(acting, item.index, stop)
            if end is None:
                recorder.discard()
                return ItemRecord(item.id, stopped=True, undecided=1)
            rows = recorder.rows
            if rows:
                success = end == ""
                recorder.save(success, end or "success")
        present.save(self.starts.output)
        return ItemRecord(
            item.id,
            success=end == "",
            complete=True,
            attempts=1,
            accepted=1,
            failures={end: 1} if end else {},
            rows=rows,
            robot=", ".join(self.config.robots.keys()),
        )

    def _acting(self) -> ActingPolicy:
        """Makes the policy at the first rollout."""
        if self._policy is None:
            try:
                policy = self.named.make(self.config)
            except RAISED as error:
                raise_interrupt(error)
                if isinstance(error, LostPolicyError):
                    raise
                text = f"policy '{self.named.kind}' cannot be made: {text_of_hook(error)}"
                raise UnmadePolicyError(text) from error
            self._policy = ActingPolicy(policy, Chunks(self.named.horizon, self.named.ensemble))
        return self._policy

    def _act(self, acting: ActingPolicy, number: int, stop: StopFlag) -> str | None:
        """Acts to the end. Returns "" for success, the reason of a failure, or None if stopped."""
        most = self._reset(number)
        context = Context(
            instruction=self.cell.instruction,
            run=self.config,
            seed=self.starts.policy_seed(number),
            features=[*self.cell.observed, *self.cell.commanded],
        )
        for step in range(most):
            if stop.is_set:
                return None
            try:
                if step == 0:
                    acting.begin(context)
                row = Row(self.cell.row(), (), lambda: None)
                action = acting.next(acting.name_in(row, self._has_streams, self.starts.cameras))
                self._require_actions(action, type(acting.policy).__name__)
            except RAISED as error:
                raise_interrupt(error)
                if isinstance(error, LostPolicyError):
                    raise
                present.error = text_of_method(error, acting.policy.act)
                return f"{POLICY_ERROR}{present.error}"
            _, terminated, truncated, info = self.cell.act(action)
            if info["is_success"]:
                return ""
            if terminated or truncated:
                return str(info.get("reason") or "the environment ended the episode")
        return TIMEOUT

    def _reset(self, number: int) -> int:
        """Goes to a start, and returns the number of actions from there."""
        if self.starts.seed is not None:
            self.env.reset(seed=self.starts.reset_seed(number))
            return self.starts.max_steps
        self.env.reset(seed=0)  # compares the schema
        episode = Dataset(self.starts.dataset)[number]
        self.cell.begin_at(EnvState(episode["env_state"]))
        return min(len(episode), self.starts.max_steps)

    def _require_actions(self, action: Mapping[str, Any], policy: str) -> None:
        """Raises ArgumentError if an action lacks a part: an environment takes whole actions."""
        known = [feature.name for feature in self.cell.commanded]
        own = [name for name in known if name.startswith("action/")]
        if any(name in own for name in action) and (lacks := [n for n in own if n not in action]):
            names = ", ".join(map(repr, lacks))
            raise ArgumentError(
                f"{policy}.act(): the action lacks {names}; an environment takes whole actions"
            )


def longest_episode(dataset: Path) -> int:
    """Returns the largest number of rows of an episode."""
    return max((len(episode) for episode in Dataset(dataset)), default=0)


def rollout_of(output: Path, item: Item) -> Episode | None:
    """Returns the episode of a rollout; None without one."""
    try:
        return Episode(output / item.id) if (output / item.id / "episode.json").is_file() else None
    except (Error, OSError):
        return None


def command(source: RunSource, starts: EnvStarts) -> list[str]:
    """Returns the command that starts a worker."""
    return worker_command("robocell._env_rollouts", source, starts.arguments())


def _open_maker(arguments: argparse.Namespace, stop: StopFlag) -> MakeEpisode:
    source = RunSource.of(arguments)
    starts = EnvStarts(
        Path(arguments.run).absolute(),
        Path(arguments.output).absolute(),
        arguments.seed,
        arguments.max_steps,
        not arguments.no_cameras,
    )
    try:
        rollouts = EnvRollouts(source, starts)
    except ArgumentError as error:
        raise SpecError(str(error)) from error
    return lambda item: rollouts.run(item, stop)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="robocell._env_rollouts", description=__doc__)
    parser.add_argument("--output", required=True)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--max-steps", type=int, required=True)
    parser.add_argument("--no-cameras", action="store_true")
    return parser


if __name__ == "__main__":
    run_worker(_parser(), _open_maker)
