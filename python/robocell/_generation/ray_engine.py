"""Workers on the machines of a Ray cluster: `robocell generate RUN --engine ray`.

Ray places one `RemoteHost` on each core that a worker takes, and tells when a machine is lost.
Everything else is the same as on one machine: the plan, the worker process, the supervisor.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robocell import ArgumentError, Error
from robocell._extras import needed_by
from robocell._generation.remote_host import RemoteHost
from robocell._generation.remote_worker import RemoteWorker, RemoteWorkers
from robocell._generation.run_source import RunSource
from robocell._generation.supervisor import TURN_VARIABLE

CALLS_AT_ONCE = 8  # of one host: one of them listens
FILES_BESIDE_WORKERS = 512


@dataclass(frozen=True)
class RayEngine:
    """A Ray cluster.

    Attributes:
        address: Its address as `ray.init` takes it; None: the cluster of this machine, of
            RAY_ADDRESS, or a new one with the cores of this machine.
        fetch: Fetch episodes even from machines that see the folder of the dataset.
    """

    address: str | None = None
    fetch: bool = False

    def connect(self) -> int:
        """Connects, and returns the number of cores of the cluster.

        Raises ModuleNotFoundError without Ray, Error if no cluster answers.
        """
        ray = _ray()
        if not ray.is_initialized():
            try:
                ray.init(
                    address=self.address,
                    namespace="robocell",
                    log_to_driver=False,
                    logging_level="ERROR",
                )
            except ValueError as error:
                raise ArgumentError(f"--address {self.address}: {error}") from error
            except (ConnectionError, RuntimeError) as error:
                where = f"at '{self.address}'" if self.address else "here"
                raise Error(
                    f"no Ray cluster answers {where}: {_first_line(error)}. Start one with "
                    "`ray start --head` and add machines with `ray start --address=HEAD:6379`; "
                    "without --address, robocell uses the cluster of this machine"
                ) from error
        return int(ray.cluster_resources().get("CPU", 0))

    @contextmanager
    def workers(
        self, source: RunSource, overrides: tuple[str, ...], dataset: Path, logs: Path, count: int
    ) -> Iterator[Callable[[int, Path], RemoteWorker]]:
        """Context manager: a function that starts a worker with a number and a log file."""
        ray = _ray()
        _allow_files(count + FILES_BESIDE_WORKERS)
        host = ray.remote(RemoteHost).options(
            num_cpus=1,
            max_restarts=0,
            max_task_retries=0,
            max_concurrency=CALLS_AT_ONCE,
            scheduling_strategy="SPREAD",
        )
        remote = RemoteWorkers(
            source, overrides, dataset, logs, turn_variable=TURN_VARIABLE, fetch=self.fetch
        )
        # Ray prints the logs of lost machines, and once more when it ends; the report names them.
        with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere):
            try:
                yield lambda number, log: RemoteWorker(
                    number, log, _RayLink(ray, host.remote()), remote
                )
            finally:
                remote.close()
                ray.shutdown()


class _RayLink:
    """Calls the methods of an actor."""

    def __init__(self, ray: Any, actor: Any) -> None:
        self._ray = ray
        self._actor = actor

    def call(self, method: str, *arguments: Any) -> Future[Any]:
        """Calls a method."""
        future: Future[Any]
        try:
            future = getattr(self._actor, method).remote(*arguments).future()
        except self._ray.exceptions.RayError as error:
            future = Future()
            future.set_exception(error)
        return future

    def loss(self, error: BaseException) -> str:
        """Returns why the actor is gone, if the cluster lost it."""
        exceptions = self._ray.exceptions
        lost = (exceptions.RayActorError, exceptions.ObjectLostError, exceptions.NodeDiedError)
        if not isinstance(error, lost) or getattr(error, "actor_init_failed", False):
            return ""
        if isinstance(error, exceptions.ActorUnavailableError):
            return "its machine does not answer"
        return _reason(str(error))

    def close(self) -> None:
        """Ends the actor."""
        self._ray.kill(self._actor)


def _ray() -> Any:
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    # Without it, Ray would hide the graphics cards from actors that ask for none.
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    with needed_by("--engine ray", "ray", "Without it, --shard i/N splits a run over machines"):
        import ray
    return ray


def _reason(text: str) -> str:
    """Returns the sentence of Ray's message that says why."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    for line in lines:
        _, because, reason = line.partition(" because ")
        if because:
            return reason.partition(". ")[0].rstrip(".")
    return lines[0].rstrip(".") if lines else "the cluster does not say why"


def _first_line(error: BaseException) -> str:
    return str(error).strip().partition("\n")[0].rstrip(".")


def _allow_files(count: int) -> None:
    """Raises the limit of open files: each worker needs one."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < count:
        most = count if hard == resource.RLIM_INFINITY else min(count, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, most), hard))
