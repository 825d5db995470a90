"""Sessions of a policy server around policies of robocell.

A client speaks the names of a dataset's columns, or those of a preset. A connection has its own
policy; one that is left by its client serves the next.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import (
    ArgumentError,
    Dataset,
    Feature,
    RunConfig,
    RunEnv,
)
from robocell._own_code import RAISED, raise_interrupt
from robocell._policy_presets import Bound, Preset
from robocell._row import Row
from robocell._suggestions import counted
from robocell.policy import (
    EXPERT,
    RANDOM,
    REPLAY,
    Context,
    Policy,
    RandomPolicy,
    ReplayPolicy,
    maker_of_policy,
)
from robocell.policy_server._batches import Reply
from robocell.policy_server._remote_policy import PROMPT
from robocell.policy_server._served_expert import ExpertSession, PlannedRollouts
from robocell.policy_server._server import HOST, PORT, PolicyServer

SEED = 0  # of a client that names none


@dataclass(frozen=True)
class ServedCell:
    """The cell that a served policy acts in.

    Attributes:
        run: Its configuration.
        features: What it observes and commands; empty if it is unknown.
        cameras: Its image streams.
    """

    run: RunConfig = field(default_factory=RunConfig)
    features: tuple[Feature, ...] = ()
    cameras: tuple[str, ...] = ()

    @classmethod
    def open(cls, source: str | Path, imports: Sequence[str] = ()) -> ServedCell:
        """Reads the cell of a run file or a dataset. Raises as `evaluate` does."""
        from robocell._generation.run_source import RunSource

        # A dataset is a source of evaluations only; the random policy needs nothing of its own.
        # Nothing is written to its output.
        run = RunSource(str(source), tuple(imports), RANDOM).load(['output="nowhere"'])
        cameras = tuple(stream.name for stream in run.cameras.streams)
        if Path(source).is_dir():
            return cls(run, tuple(Dataset(Path(source))[0].features), cameras)
        run.cameras.draw = False
        env = RunEnv(run)
        env.reset(0)
        return cls(run, (*env.observed, *env.commanded), cameras)

    def context(self, info: Mapping[str, Any]) -> Context:
        """Returns what a policy is told at the beginning of a rollout.

        `info` may have the instruction as `prompt`, and `seed`.
        """
        prompt, seed = info.get(PROMPT, ""), info.get("seed", SEED)
        return Context(
            instruction=prompt if isinstance(prompt, str) else "",
            run=self.run,
            seed=seed if type(seed) is int and 0 <= seed < 2**63 else SEED,
            features=list(self.features),
        )


class PolicySession:
    """One client of a policy.

    Args:
        policy: Acts for this client alone.
        cell: What `reset` is told about the cell.
        bound: The preset that the client speaks; None for the names of columns.
    """

    def __init__(self, policy: Policy, cell: ServedCell, bound: Bound | None = None) -> None:
        self.policy = policy
        self._cell, self._bound = cell, bound
        self._begun = False

    def reset(self, info: Mapping[str, Any]) -> None:
        """Resets the policy; `info` may have the instruction as `prompt`, and `seed`."""
        self._begun = True
        self.policy.reset(self._cell.context(info))

    def infer(self, observation: dict[str, Any]) -> dict[str, Any]:
        """Returns the policy's actions."""
        who = f"{type(self.policy).__name__}.act()"
        row, prompt = read_row(who, observation, self._bound)
        if not self._begun:  # a client of openpi says no more than this
            self.reset({PROMPT: prompt})
        return reply_of(who, self.policy.act(row), self._bound)


class BatchedPolicy:
    """A policy with `act_batch`, for clients that send observations of several rollouts at once.

    Args:
        policy: Acts in all rollouts.
        cell: What `act_batch` is told about the cell.
        bound: The preset that clients speak; None for the names of columns.
    """

    def __init__(self, policy: Policy, cell: ServedCell, bound: Bound | None = None) -> None:
        self.policy, self.cell, self.bound = policy, cell, bound
        self._lock = threading.Lock()  # of the policy: every connection has a thread

    def session(self) -> BatchedSession:
        """Returns the session of a client."""
        return BatchedSession(self.cell)

    def infer_many(
        self, sessions: Sequence[BatchedSession], observations: Sequence[dict[str, Any]]
    ) -> list[Reply]:
        """Returns the reply to each observation, or the error of this one alone."""
        who = f"{type(self.policy).__name__}.act_batch()"
        replies: dict[int, Reply] = {}
        rows: dict[int, Row] = {}
        for place, (session, observation) in enumerate(zip(sessions, observations, strict=True)):
            try:
                rows[place], prompt = read_row(who, observation, self.bound)
                if session.context is None:
                    session.begin({PROMPT: prompt})
            except RAISED as error:
                raise_interrupt(error)
                rows.pop(place, None)
                replies[place] = error
        replies |= self._act([(place, row, sessions[place]) for place, row in rows.items()])
        return [replies[place] for place in range(len(sessions))]

    def _act(self, rollouts: Sequence[tuple[int, Row, BatchedSession]]) -> dict[int, Reply]:
        """Returns the replies by place."""
        if not rollouts:
            return {}
        who = f"{type(self.policy).__name__}.act_batch()"
        contexts = [context for *_, each in rollouts if (context := each.context) is not None]
        try:
            with self._lock:
                actions = self.policy.act_batch([row for _, row, _ in rollouts], contexts)
            if not isinstance(actions, Sequence) or len(actions) != len(rollouts):
                found = f"{len(actions)}" if isinstance(actions, Sequence) else repr(actions)
                raise ArgumentError(
                    f"{who} must return a list of {counted(len(rollouts), 'action')}, got {found}"
                )
        except RAISED as error:
            raise_interrupt(error)
            if len(rollouts) == 1:
                return {rollouts[0][0]: error}
            # One observation may be wrong: each gets what it would get alone.
            return {place: reply for each in rollouts for place, reply in self._act([each]).items()}
        replies: dict[int, Reply] = {}
        for (place, *_), action in zip(rollouts, actions, strict=True):
            try:
                replies[place] = reply_of(who, action, self.bound)
            except RAISED as error:
                raise_interrupt(error)
                replies[place] = error
        return replies


class BatchedSession:
    """One rollout of a batched policy.

    Attributes:
        context: What a policy's `reset` would get; None before the rollout begins.
    """

    def __init__(self, cell: ServedCell) -> None:
        self._cell = cell
        self.context: Context | None = None

    def begin(self, info: Mapping[str, Any]) -> None:
        """Begins a rollout."""
        self.context = self._cell.context(info)


def read_row(who: str, observation: dict[str, Any], bound: Bound | None) -> tuple[Row, Any]:
    """Returns the row and the instruction in an observation."""
    # Arrays of a message are read-only views of it; a policy may write into its own.
    if bound is None:
        prompt = observation.pop(PROMPT, "")
        numbers = np.ndarray | np.generic | int | float
        row = {k: np.array(v) for k, v in observation.items() if isinstance(v, numbers)}
    else:
        row, prompt = bound.row(observation)
        row = {name: np.array(value) for name, value in row.items()}
    seen = Row(row, [], lambda: None)
    seen.title = f"{who}: the client's observation"
    return seen, prompt


def reply_of(who: str, action: object, bound: Bound | None) -> dict[str, Any]:
    """Returns the reply with an action or a chunk."""
    columns = _checked(who, action)
    if bound is not None:
        return {"actions": np.atleast_2d(bound.reply(columns))}
    parts = [np.atleast_2d(values) for values in columns.values()]
    return {
        "actions": np.concatenate(parts, axis=1),
        "action_columns": [
            [name, part.shape[1]] for name, part in zip(columns, parts, strict=True)
        ],
    }


def _checked(who: str, action: object) -> dict[str, NDArray[np.float64]]:
    """Returns an action or a chunk whose columns have one length."""
    if not isinstance(action, Mapping) or not action:
        raise TypeError(f"{who} must return a dict of columns to numbers, got {action!r}")
    columns = {}
    for name, values in action.items():
        array = np.asarray(values, np.float64)
        if not isinstance(name, str) or array.ndim > 2 or not array.size:
            raise ArgumentError(f"{who}: {name!r} has the shape {array.shape}")
        columns[name] = array if array.ndim == 2 else array.reshape(1, -1)
    lengths = {len(array) for array in columns.values()}
    if len(lengths) > 1:
        found = ", ".join(f"'{name}' {len(array)}" for name, array in columns.items())
        raise ArgumentError(f"{who}: columns of one chunk differ in length: {found}")
    return columns


class _Pool:
    """Policies that no client uses are kept for the next one: loading weights takes time."""

    def __init__(self, make: Callable[[], Policy]) -> None:
        self._make = make
        self._free: queue.SimpleQueue[Policy] = queue.SimpleQueue()

    def take(self) -> Policy:
        try:
            return self._free.get_nowait()
        except queue.Empty:
            return self._make()

    def give(self, policy: Policy) -> None:
        self._free.put(policy)


def policy_server(
    policy: str,
    source: str | Path | None = None,
    *,
    preset: str | Path = "",
    imports: Sequence[str] = (),
    host: str = HOST,
    port: int = PORT,
    api_key: str | None = None,
) -> PolicyServer:
    """Returns a server of a policy, which listens already; its `serve` answers.

    Args:
        policy: `module:Class` or `file.py:Class` of a policy, `random`, `replay` or `expert`.
        source: Run file or dataset whose cell the policy acts in. The dataset that `replay` takes
            actions from; `module:Class` may do without.
        preset: Names and units that clients use; default: those of columns.
        imports: Modules to import first.
        host: Address to listen at.
        port: Port; 0 for a free one.
        api_key: Key that clients must have; default: the variable ROBOCELL_POLICY_API_KEY.

    Raises:
        ArgumentError: The policy needs a source, or a preset cannot be used with it.
        SpecError: An error in the run, the module or the preset.
        IoError: The port cannot be used.
    """
    if source is None and (preset or policy in (EXPERT, RANDOM, REPLAY)):
        what = f"--preset {preset}" if preset else f"policy '{policy}'"
        kind = "a dataset" if policy == REPLAY else "a run file or a dataset"
        raise ArgumentError(f"{what} needs the cell: name {kind} with --run")
    if policy == EXPERT and source is not None:
        if preset:
            raise ArgumentError("policy 'expert' needs all columns: leave --preset out")
        rollouts = PlannedRollouts(source, imports)
        return PolicyServer(
            lambda: ExpertSession(rollouts),
            {"policy": policy},
            host=host,
            port=port,
            api_key=api_key,
        )
    cell = ServedCell.open(source, imports) if source is not None else ServedCell()
    bound = None
    if preset:
        bound = Preset.load(preset).bind(cell.features, cell.cameras)
    pool = _Pool(_maker(policy, source, cell, bool(preset)))
    first = pool.take()  # errors of making it come before the first client
    batch = None
    if getattr(type(first), "act_batch", Policy.act_batch) is not Policy.act_batch:
        batch = BatchedPolicy(first, cell, bound)
    else:
        pool.give(first)

    def make_session() -> PolicySession:
        return PolicySession(pool.take(), cell, bound)

    def end_session(session: object) -> None:
        if isinstance(session, PolicySession):
            pool.give(session.policy)

    metadata = {
        "policy": policy,
        "preset": str(preset),
        "action_columns": [
            counted(each.width, f"number of {each.column}") for each in bound.actions
        ]
        if bound
        else [],
    }
    return PolicyServer(
        make_session,
        metadata,
        host=host,
        port=port,
        api_key=api_key,
        end_session=end_session,
        batch=batch,
    )


def _maker(
    policy: str, source: str | Path | None, cell: ServedCell, has_preset: bool
) -> Callable[[], Policy]:
    if policy == RANDOM:
        return lambda: RandomPolicy(cell.run)
    if policy == REPLAY:
        if has_preset:
            raise ArgumentError(
                "policy 'replay' finds its episode by all columns of a start, which a preset does "
                "not have: leave --preset out"
            )
        if source is None or not Path(source).is_dir():
            raise ArgumentError(f"policy 'replay' takes the actions of a dataset; got '{source}'")
        return lambda: ReplayPolicy(source)
    if ":" not in policy:
        raise ArgumentError(
            f"policy '{policy}': expected module:Class, file.py:Class, '{EXPERT}', '{RANDOM}' or "
            f"'{REPLAY}'"
        )
    make, _ = maker_of_policy(policy, Path.cwd())
    return lambda: make(cell.run)
