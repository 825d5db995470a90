"""Workers on other machines, without a cluster: machines are threads of this process."""

from __future__ import annotations

import hashlib
import json
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import fake_worker
from robocell import _core
from robocell._generation import pieces, remote_worker, supervisor, worker_process
from robocell._generation.items import Item
from robocell._generation.remote_host import RemoteHost, RemoteJob
from robocell._generation.remote_worker import RemoteWorker, RemoteWorkers
from robocell._generation.run_source import RunSource
from robocell._generation.supervisor import TURN_VARIABLE, Limits, Supervisor
from test_supervisor import Clock, Recorder


class LostError(Exception):
    """What a call to a lost machine raises."""


class Host(RemoteHost):
    """Starts the fake worker, which commits folders, and makes episodes of them."""

    script: dict[str, Any] = {}  # noqa: RUF012

    def _command(self, job: RemoteJob, dataset: Path) -> list[str]:
        script = json.dumps(self.script)
        return [sys.executable, fake_worker.__file__, str(dataset), script]

    def listing(self, item_id: str) -> list[pieces.Folder]:
        write_episode(self.dataset, item_id)
        return super().listing(item_id)


class Link:
    """Calls a host of this process, in threads; `lose` is the end of its machine."""

    def __init__(self, script: dict[str, Any], placed: threading.Event) -> None:
        self.host = Host()
        self.host.script = script
        self._placed = placed
        self._threads = ThreadPoolExecutor(4)
        self._lost = self._closed = False

    def call(self, method: str, *arguments: Any) -> Future[Any]:
        return self._threads.submit(self._call, method, *arguments)

    def _call(self, method: str, *arguments: Any) -> Any:
        while not self._placed.wait(0.02):
            if self._closed:
                raise LostError("closed")
        answer = getattr(self.host, method)(*arguments)
        if self._lost:
            raise LostError("its node has died")
        return answer

    def lose(self) -> None:
        self._lost = True
        self.host.worker.kill("the machine is switched off")

    def loss(self, error: BaseException) -> str:
        return str(error) if isinstance(error, LostError) else ""

    def close(self) -> None:
        self._closed = True
        self._threads.shutdown(wait=False)


class Cluster:
    """Machines with a number of cores, for the supervisor of a dataset."""

    def __init__(self, folder: Path, script: dict[str, Any], cores: int, *, fetch: bool) -> None:
        self.dataset = folder / "dataset"
        self.dataset.mkdir()
        (self.dataset / "dataset.json").write_text("{}")
        self.script, self.links = script, list[Link]()
        self.placed = [threading.Event() for _ in range(cores)]
        for event in self.placed:
            event.set()
        self.workers = RemoteWorkers(
            RunSource("run.yaml"), (), self.dataset, self.dataset / ".logs",
            turn_variable=TURN_VARIABLE, fetch=fetch,
        )  # fmt: skip

    def start(self, number: int, log: Path) -> RemoteWorker:
        has_core = number < len(self.placed)
        link = Link(self.script, self.placed[number] if has_core else threading.Event())
        self.links.append(link)
        return RemoteWorker(number, log, link, self.workers)

    def run(self, count: int, workers: int = 2, **options: Any) -> Any:
        whole = Supervisor(
            [Item(f"e{i}", i) for i in range(count)],
            [],
            workers=workers,
            logs=self.dataset / ".logs",
            on_disk=lambda name: (
                fake_worker.result_of(name) if (self.dataset / name).exists() else None
            ),
            start_worker=self.start,
            **options,
        )
        try:
            return whole.run()
        finally:
            self.workers.close()

    def episodes(self) -> list[str]:
        return sorted(path.name for path in self.dataset.iterdir() if path.name.startswith("e"))


@pytest.fixture(autouse=True)
def _importable_in_children(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))


def write_episode(dataset: Path, name: str) -> None:
    """The files of an episode with a model, and their hashes."""
    folder, model = dataset / name, dataset / "models" / "arm-12"
    folder.mkdir(exist_ok=True)
    model.mkdir(parents=True, exist_ok=True)
    (model / "arm.xml").write_text("<mujoco/>")
    steps = name.encode() * 1000
    (folder / "steps.h5").write_bytes(steps)
    (folder / "empty.mp4").write_bytes(b"")
    files = {
        file: {"sha256": hashlib.sha256(content).hexdigest()}
        for file, content in (("steps.h5", steps), ("empty.mp4", b""))
    }
    described = {
        "models": {"arm": "models/arm-12/arm.xml"}, "files": files, "json_sha256": "0" * 64
    }  # fmt: skip
    (folder / "episode.json").write_text(_core.self_hashed_json(json.dumps(described)))


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and ".logs" not in file.parts
    }


def test_machines_that_share_the_folder_write_there(tmp_path: Path):
    cluster = Cluster(tmp_path, {}, 2, fetch=False)
    outcome = cluster.run(5)
    assert outcome.totals.made == 5
    assert cluster.episodes() == ["e0", "e1", "e2", "e3", "e4"]
    assert sorted(fake_worker.tries_of(cluster.dataset)) == cluster.episodes()


def test_episodes_of_other_machines_are_fetched_whole(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(pieces, "PIECE_BYTES", 700)
    cluster = Cluster(tmp_path, {}, 2, fetch=True)
    outcome = cluster.run(3)
    assert (outcome.totals.made, outcome.totals.retries) == (3, 0)
    same = tmp_path / "same"
    same.mkdir()
    (same / "dataset.json").write_text("{}")
    for name in cluster.episodes():
        write_episode(same, name)
    assert bytes_of(cluster.dataset) == bytes_of(same)
    assert not list((cluster.dataset / ".logs").glob("fetched*"))
    assert all(not link.host.dataset.exists() for link in cluster.links)


def test_items_of_a_lost_machine_are_made_on_another(tmp_path: Path):
    cluster = Cluster(tmp_path, {"e1": ["hang", "make"]}, 2, fetch=False)

    class Watcher(Recorder):
        def tick(self, totals: Any) -> None:
            if fake_worker.hangs_of(cluster.dataset) and not self.of("retry"):
                next(link for link in cluster.links if holds(link)).lose()

    def holds(link: Link) -> bool:
        return str(link.host.worker.pid) in (cluster.dataset / "tries").read_text()

    # One worker: the machine that hangs is the only one.
    watcher = Watcher()
    outcome = cluster.run(3, workers=1, observer=watcher, limits=Limits(tries=1))
    assert cluster.episodes() == ["e0", "e1", "e2"]
    assert not outcome.totals.unmade  # the item is not blamed for its machine
    assert len(watcher.of("retry")) == 1
    assert "was lost: its node has died, on " in watcher.of("retry")[0]


def test_workers_without_a_free_core_wait_and_end_with_the_run(tmp_path: Path):
    cluster = Cluster(tmp_path, {}, 1, fetch=False)
    outcome = cluster.run(4, workers=3)
    assert outcome.totals.made == 4
    assert (outcome.totals.deaths, outcome.fatal) == ([], None)


def test_deadlines_and_crashes_are_those_of_local_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    clock, recorder = Clock(), Recorder()
    for module in (supervisor, remote_worker, worker_process):
        monkeypatch.setattr(module, "time", clock)

    passed = False

    def pass_time() -> None:
        nonlocal passed
        if not passed and fake_worker.hangs_of(cluster.dataset):
            passed = True
            clock.now += 3.1

    recorder.on_tick = pass_time
    script = {"e0": ["crash", "make"], "e1": ["hang", "make"]}
    cluster = Cluster(tmp_path, script, 1, fetch=False)
    limits = Limits(item_timeout_s=3.0)
    outcome = cluster.run(2, workers=1, observer=recorder, limits=limits)
    assert outcome.totals.made == 2
    crash, hang = (death.reason for death in outcome.totals.deaths)
    assert "was killed by SIGSEGV" in crash
    assert "e1 took more than 3 s" in hang
    assert "about to crash" in (cluster.dataset / ".logs" / "worker-0.log").read_text()


class Silent:
    """Calls a machine that answers once."""

    def call(self, method: str, *arguments: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if method == "start":
            future.set_result({"pid": 7, "node": "far", "fetches": False})
        return future

    def loss(self, error: BaseException) -> str:
        return ""

    def close(self) -> None:
        pass


def test_a_machine_that_no_longer_answers_is_given_up(tmp_path: Path, monkeypatch):
    clock = Clock()
    monkeypatch.setattr(remote_worker, "time", clock)
    cluster = Cluster(tmp_path, {}, 1, fetch=False)
    worker = RemoteWorker(0, tmp_path / "log", Silent(), cluster.workers)
    worker.kill("e0 took more than 3 s")
    assert list(worker.messages() or "none") == []
    clock.now += remote_worker.BURIAL_S + 1
    assert worker.messages() is None
    assert worker.bury() == "was killed: e0 took more than 3 s, on 'far'"
    cluster.workers.close()


def test_a_machine_without_the_working_folder_is_named(tmp_path: Path):
    cluster = Cluster(tmp_path, {}, 1, fetch=False)
    cluster.workers.job = replace(cluster.workers.job, folder=str(tmp_path / "nowhere"))
    outcome = cluster.run(2, workers=1)
    assert outcome.fatal.kind == "io"
    assert "cannot enter the working folder" in outcome.fatal.message
    assert "ray job submit --working-dir" in outcome.fatal.message


@pytest.mark.parametrize(
    ("error", "starts", "end"),
    [
        (ImportError("no robocell there"), 3, "failed: no robocell there"),
        (LostError("its node has died"), 20, "was lost: its node has died"),
    ],
)
def test_machines_on_which_no_worker_starts_end_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, starts: int, end: str
):
    def fails(*arguments: Any) -> None:
        raise error

    monkeypatch.setattr(Host, "start", fails)
    cluster = Cluster(tmp_path, {}, 2, fetch=False)
    outcome = cluster.run(4)
    assert outcome.fatal.message.startswith("worker ")
    assert f"{end} before it could take an item" in outcome.fatal.message
    assert f"as did {starts - 1} before it" in outcome.fatal.message
    assert not outcome.totals.unmade, "no item is blamed"


def damaged(read: pieces.Read, change: Callable[[bytes], bytes]) -> pieces.Read:
    return lambda folder, offset, size: change(read(folder, offset, size))


def test_a_fetched_folder_is_verified_by_hash_and_complete_or_absent(tmp_path: Path):
    there, here, staging = (tmp_path / name for name in ("there", "here", "staging"))
    for folder in (there, here, staging):
        folder.mkdir()
    write_episode(there, "e0")
    model, episode = pieces.listing(there, "e0")
    assert (model.name, episode.name) == ("models/arm-12", "e0")

    def read(folder: pieces.Folder, offset: int, size: int) -> bytes:
        return pieces.read(there, folder, offset, min(size, 77))

    for change in (lambda data: data[:-1] + b"?", lambda data: b""):
        with pytest.raises(pieces.DamagedPieceError, match="e0"):
            pieces.receive(episode, damaged(read, change), here, staging)
        assert not list(here.iterdir())
    # A file of another episode, with the hash of what was sent.
    (there / "e0" / "steps.h5").write_bytes(b"others")
    with pytest.raises(pieces.DamagedPieceError, match="is not the file of its episode"):
        pieces.receive(pieces.listing(there, "e0")[1], read, here, staging)
    write_episode(there, "e0")
    for folder in pieces.listing(there, "e0"):
        pieces.receive(folder, read, here, staging)
        pieces.receive(folder, read, here, staging)  # it is there
    assert bytes_of(here) == bytes_of(there)


def test_attempts_are_listed_in_order_and_those_of_other_items_are_not(tmp_path: Path):
    for name in ("e1_a9", "e1_a10", "e1", "e10", "e1_about"):
        write_episode(tmp_path, name)
    names = [folder.name for folder in pieces.listing(tmp_path, "e1")]
    assert names == ["models/arm-12", "e1_a9", "e1_a10", "e1"]
