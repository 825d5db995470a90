"""The supervisor against workers that die, hang, raise and chatter."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import fake_worker
from robocell._generation import supervisor as supervisor_module
from robocell._generation import worker_process
from robocell._generation.disk import with_trouble
from robocell._generation.items import Item, ItemRecord
from robocell._generation.observer import Observer
from robocell._generation.supervisor import Limits, Supervisor
from robocell._generation.totals import Totals, Unmade

SOON_S = 20.0


class Recorder(Observer):
    """Keeps what happened; can act when something does."""

    def __init__(self) -> None:
        self.events: list[tuple[str, str]] = []
        self.on_episode: Callable[[], None] = lambda: None
        self.on_tick: Callable[[], None] = lambda: None

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        self.events.append(("episode", result.id))
        self.on_episode()

    def retry(self, item_id: str, reason: str, totals: Totals) -> None:
        self.events.append(("retry", f"{item_id}: {reason}"))

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        self.events.append(("unmade", f"{unmade.id}: {unmade.reason}"))

    def warning(self, text: str) -> None:
        self.events.append(("warning", text))

    def stopping(self, reason: str, totals: Totals) -> None:
        self.events.append(("stopping", reason))

    def tick(self, totals: Totals) -> None:
        self.on_tick()

    def of(self, kind: str) -> list[str]:
        return [text for event, text in self.events if event == kind]


@pytest.fixture(autouse=True)
def _importable_in_children(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))


def ids(count: int) -> list[str]:
    return [f"e{i}" for i in range(count)]


def supervise(
    folder: Path,
    script: dict[str, Any],
    count: int = 4,
    workers: int = 2,
    observer: Observer | None = None,
    **options: Any,
) -> Supervisor:
    command = [sys.executable, fake_worker.__file__, str(folder), json.dumps(script)]
    items = [Item(name, i) for i, name in enumerate(ids(count)) if not (folder / name).exists()]
    return Supervisor(
        items,
        command,
        workers=workers,
        logs=options.pop("logs", folder),
        on_disk=lambda name: fake_worker.result_of(name) if (folder / name).exists() else None,
        observer=observer,
        reproduce=lambda item: f"robocell generate run.yaml --shard {item.index}/{count}",
        **options,
    )


def episodes(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.is_dir())


def gone(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return True
    return state == "Z"


def wait_for(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def test_every_item_is_generated_once_for_any_number_of_workers(tmp_path: Path):
    for workers in (1, 3):
        folder = tmp_path / str(workers)
        folder.mkdir()
        outcome = supervise(folder, {}, count=7, workers=workers).run()
        assert episodes(folder) == ids(7)
        assert sorted(fake_worker.tries_of(folder)) == ids(7)
        totals = outcome.totals
        assert (totals.made, totals.attempts, totals.accepted, totals.rows) == (7, 14, 7, 63)
        assert (totals.success_rate, totals.acceptance_rate) == (1.0, 0.5)
        assert outcome.totals.refusals == {"too far": 7}
        assert not outcome.interrupted
        assert outcome.fatal is None


def test_starts_no_more_workers_than_items(tmp_path: Path):
    supervise(tmp_path, {}, count=1, workers=5).run()
    assert [path.name for path in tmp_path.glob("worker-*.log")] == ["worker-0.log"]
    assert supervise(tmp_path, {}, count=1, workers=5).run().totals.made == 0


def test_each_worker_has_its_turn_among_the_graphics_cards(tmp_path: Path):
    supervise(tmp_path, {}, count=30, workers=3).run()
    lines = (tmp_path / "tries").read_text().splitlines()
    turns = {tuple(line.split()[1:]) for line in lines}
    assert len({pid for pid, _ in turns}) == len({turn for _, turn in turns}) == len(turns)
    assert {turn for _, turn in turns} <= {"0", "1", "2"}


def test_a_killed_worker_is_reported_and_its_item_is_repeated(tmp_path: Path):
    recorder = Recorder()
    outcome = supervise(tmp_path, {"e1": ["kill", "make"]}, observer=recorder).run()
    assert episodes(tmp_path) == ids(4)
    (retry,) = recorder.of("retry")
    assert retry.startswith("e1: worker ")
    assert retry.endswith("was killed by SIGKILL (out of memory?)")
    assert outcome.totals.retries == 1
    assert not outcome.totals.unmade
    (death,) = outcome.totals.deaths
    assert (death.item, death.reason) == ("e1", "was killed by SIGKILL (out of memory?)")
    assert 0 < death.after_s <= outcome.totals.elapsed_s
    assert sorted(result.id for result in outcome.results) == ids(4)


@pytest.mark.parametrize("how", ["fork, kill", "fork in C, kill"])
def test_a_killed_worker_is_found_although_a_process_that_it_forked_lives(tmp_path: Path, how: str):
    outcome = supervise(tmp_path, {"e1": [how, "make"]}).run()
    assert episodes(tmp_path) == ids(4)
    (death,) = outcome.totals.deaths
    assert death.reason == "was killed by SIGKILL (out of memory?)"
    assert outcome.totals.elapsed_s < fake_worker.Maker.FORKED_S / 2


def test_the_input_of_an_item_and_its_children_is_empty(tmp_path: Path):
    outcome = supervise(tmp_path, {"*": ["read"]}).run()
    assert episodes(tmp_path) == ids(4)
    assert not outcome.totals.deaths
    assert not outcome.totals.again


def test_errors_beside_exception_are_told_like_others(tmp_path: Path):
    outcome = supervise(tmp_path, {"e1": ["cancel"]}).run()
    assert episodes(tmp_path) == ["e0", "e2", "e3"]
    (unmade,) = outcome.totals.unmade
    assert "CancelledError: late" in unmade.reason


def test_an_item_that_always_crashes_is_listed_after_three_tries(tmp_path: Path):
    recorder = Recorder()
    outcome = supervise(tmp_path, {"e1": ["kill"]}, observer=recorder).run()
    assert episodes(tmp_path) == ["e0", "e2", "e3"]
    assert fake_worker.tries_of(tmp_path).count("e1") == 3
    (unmade,) = outcome.totals.unmade
    assert unmade.id == "e1"
    assert "killed by SIGKILL" in unmade.reason
    assert unmade.reason.endswith("about to die"), "the end of its log is shown"
    assert unmade.reproduce == "robocell generate run.yaml --shard 1/4"
    assert not outcome.interrupted


def test_an_item_given_up_before_is_tried_once(tmp_path: Path):
    script = {"e1": ["kill"], "e2": ["kill", "make"]}
    outcome = supervise(tmp_path, script, tried_once={"e1"}).run()
    assert episodes(tmp_path) == ["e0", "e2", "e3"]
    assert fake_worker.tries_of(tmp_path).count("e1") == 1
    assert [unmade.id for unmade in outcome.totals.unmade] == ["e1"]


def test_a_worker_that_dies_after_a_commit_loses_and_duplicates_nothing(tmp_path: Path):
    recorder = Recorder()
    outcome = supervise(tmp_path, {"e1": ["commit, kill"]}, observer=recorder).run()
    assert fake_worker.tries_of(tmp_path).count("e1") == 1
    totals = outcome.totals
    assert (totals.made, totals.attempts, totals.accepted, totals.rows) == (4, 8, 4, 36)
    assert sorted(recorder.of("episode")) == ids(4)
    assert recorder.of("retry") == []


def test_an_episode_that_may_not_be_on_disk_is_flushed_again(tmp_path: Path):
    recorder, flushed = Recorder(), []
    supervisor = supervise(
        tmp_path, {"e1": ["commit, io"]}, observer=recorder, flush=lambda: flushed.append(1)
    )
    outcome = supervisor.run()
    assert (outcome.fatal, outcome.totals.made, len(flushed)) == (None, 4, 1)
    assert recorder.of("warning") == [
        "e1 is there, and was brought to the disk again: "
        "'e1' is in place, but a power cut may still undo that"
    ]


def test_an_episode_that_cannot_be_brought_to_the_disk_is_not_acknowledged(tmp_path: Path):
    def flush() -> None:
        raise OSError("cannot flush 'out': Input/output error")

    recorder = Recorder()
    script = {"e1": ["commit, io"]}
    outcome = supervise(tmp_path, script, workers=1, observer=recorder, flush=flush).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "io"
    assert "'e1' is in place, but a power cut may still undo that\ncannot" in outcome.fatal.message
    assert recorder.of("episode") == ["e0"]
    assert outcome.totals.made == 1


def test_a_removed_log_folder_is_created_again(tmp_path: Path):
    recorder, logs = Recorder(), tmp_path / "a/logs"
    recorder.on_episode = lambda: shutil.rmtree(logs, ignore_errors=True)
    script = {"e1": ["kill", "make"]}
    outcome = supervise(tmp_path, script, workers=1, observer=recorder, logs=logs).run()
    assert (outcome.fatal, outcome.totals.made) == (None, 4)


def test_a_worker_that_cannot_be_started_ends_the_run_with_the_reason(tmp_path: Path):
    (tmp_path / "logs").write_text("in the way")
    outcome = supervise(tmp_path, {}, logs=tmp_path / "logs").run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "io"
    assert "worker 0 cannot be started: " in outcome.fatal.message
    assert str(tmp_path / "logs") in outcome.fatal.message


def test_an_exception_uses_a_try_and_replaces_the_worker(tmp_path: Path):
    recorder = Recorder()
    supervise(tmp_path, {"e0": ["raise", "make"]}, workers=1, observer=recorder).run()
    assert episodes(tmp_path) == ids(4)
    (said,) = recorder.of("retry")
    assert said.startswith("e0: ValueError: a bug ("), "with file and line"
    assert "fake_worker.py:" in said
    pids = {line.split()[1] for line in (tmp_path / "tries").read_text().splitlines()}
    assert len(pids) == 2, "a fresh worker went on"
    assert "Traceback" in (tmp_path / "worker-0.log").read_text(), "for whoever looks into it"


def test_a_user_exception_is_shown_without_internal_frames(tmp_path: Path):
    outcome = supervise(tmp_path, {"e0": ["raise"]}, workers=1).run()
    (unmade,) = outcome.totals.unmade
    first, *lines = unmade.reason.splitlines()
    assert first.startswith("ValueError: a bug (")
    assert any("fake_worker.py" in line for line in lines), "the lines that lead there"
    assert not any("Traceback" in line or "_generation/worker.py" in line for line in lines)


def test_an_exit_in_user_code_is_an_error_with_file_and_line(tmp_path: Path):
    recorder = Recorder()
    outcome = supervise(tmp_path, {"e0": ["exit", "make"]}, workers=1, observer=recorder).run()
    (said,) = recorder.of("retry")
    assert said.startswith("e0: SystemExit: 0 (")
    assert not outcome.totals.deaths


def test_an_item_without_success_is_not_retried(tmp_path: Path):
    outcome = supervise(tmp_path, {"e2": ["fail"]}).run()
    assert fake_worker.tries_of(tmp_path).count("e2") == 1
    (unmade,) = outcome.totals.unmade
    assert unmade.reason == "no success in 6 attempts: dropped 3, not lifted 2"
    assert outcome.totals.success_rate == 3 / 8


class Clock:
    """Stands in for `time` in the supervisor: stands still until it is put forward."""

    def __init__(self) -> None:
        self.now = time.monotonic()
        self.sleep = time.sleep

    def monotonic(self) -> float:
        return self.now


def test_a_hung_item_is_stopped_at_its_deadline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The limit counts from the moment at which the item was handed out, by a clock of our own."""
    clock, recorder = Clock(), Recorder()
    monkeypatch.setattr(supervisor_module, "time", clock)
    monkeypatch.setattr(worker_process, "time", clock)
    passed = 0

    def pass_time() -> None:
        """Puts the clock forward once in each try, when the other items are made."""
        nonlocal passed
        hung = fake_worker.hangs_of(tmp_path)
        if episodes(tmp_path) == ["e0", "e2", "e3"] and hung > passed:
            passed = hung
            clock.now += 4.1

    recorder.on_tick = pass_time
    limits = Limits(tries=2, item_timeout_s=4)
    outcome = supervise(tmp_path, {"e1": ["hang"]}, observer=recorder, limits=limits).run()
    assert episodes(tmp_path) == ["e0", "e2", "e3"]
    assert len(recorder.of("retry")) == 1
    assert "was killed: e1 took more than 4 s" in recorder.of("retry")[0]
    reason = outcome.totals.unmade[0].reason
    assert re.search(r"was killed: e1 took more than 4 s \(.*fake_worker.py:\d+, in act\)$", reason)
    assert passed == 2
    assert 'fake_worker.py", line' in (tmp_path / "worker-0.log").read_text(), "the stacks"


def test_a_crash_names_the_place_in_user_code(tmp_path: Path):
    outcome = supervise(tmp_path, {"e1": ["crash"]}, workers=1, limits=Limits(tries=1)).run()
    (death,) = outcome.totals.deaths
    assert re.fullmatch(r"was killed by SIGSEGV \(.*fake_worker.py:\d+, in act\)", death.reason)
    reason = outcome.totals.unmade[0].reason
    assert reason.endswith("\nabout to crash"), "without the stacks"
    assert "Segmentation fault" in (tmp_path / "worker-0.log").read_text()


def test_library_output_goes_to_the_log(tmp_path: Path):
    outcome = supervise(tmp_path, {"*": ["print"]}, workers=1).run()
    assert outcome.totals.made == 4
    log = (tmp_path / "worker-0.log").read_text()
    assert "chatter of a library" in log
    assert "chatter of a child" in log


def test_a_stop_request_ends_running_items_and_keeps_finished_ones(tmp_path: Path):
    recorder = Recorder()
    supervisor = supervise(tmp_path, {"e1": ["patient"]}, workers=1, observer=recorder)

    def stop_at_e1() -> None:  # once: the second time kills
        if "e1" in fake_worker.tries_of(tmp_path) and not recorder.of("stopping"):
            supervisor.request_stop("test")

    recorder.on_tick = stop_at_e1
    outcome = supervisor.run()
    assert outcome.interrupted
    assert episodes(tmp_path) == ["e0"]
    assert recorder.of("stopping") == ["test"]
    assert outcome.totals.unmade == [], "stopped is not failed"
    totals = outcome.totals
    assert (totals.attempts, totals.accepted, totals.undecided) == (2, 1, 1), "it is made again"
    assert not totals.failures

    assert not supervise(tmp_path, {}).run().interrupted
    assert episodes(tmp_path) == ids(4)
    assert fake_worker.tries_of(tmp_path).count("e0") == 1, "what was made was not made again"


def test_a_worker_that_does_not_stop_is_killed(tmp_path: Path):
    supervisor = supervise(tmp_path, {"*": ["hang"]}, limits=Limits(stop_grace_s=0.5))
    timer = threading.Timer(1.5, supervisor.request_stop)
    timer.start()
    begin = time.monotonic()
    assert supervisor.run().interrupted
    assert time.monotonic() - begin < 10


def test_the_second_stop_request_does_not_wait(tmp_path: Path):
    supervisor = supervise(tmp_path, {"*": ["hang"]}, limits=Limits(stop_grace_s=1000))
    for delay in (1.5, 2.0):
        threading.Timer(delay, supervisor.request_stop).start()
    assert supervisor.run().interrupted


def test_a_stop_after_the_last_item_is_not_an_interruption(tmp_path: Path):
    recorder = Recorder()
    supervisor = supervise(tmp_path, {}, count=1, observer=recorder)
    recorder.on_episode = supervisor.request_stop
    assert not supervisor.run().interrupted


def test_a_run_that_cannot_be_loaded_ends_at_once_with_the_message(tmp_path: Path):
    outcome = supervise(tmp_path, {"refuse": []}).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "spec"
    assert outcome.fatal.message == "run.yaml:3:1: no field 'tsak'. Did you mean 'task'?"
    assert not outcome.interrupted


def test_workers_that_cannot_start_end_the_run_with_their_output(tmp_path: Path):
    outcome = supervise(tmp_path, {"crash": []}).run()
    assert outcome.fatal is not None
    assert "ended with exit code 7 before it could take an item" in outcome.fatal.message
    assert "libGL is missing" in outcome.fatal.message
    assert "worker-" in outcome.fatal.message


def test_a_spec_that_is_wrong_for_every_item_ends_the_run(tmp_path: Path):
    outcome = supervise(tmp_path, {"*": ["spec"]}).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "spec"
    assert "Did you mean 'wrist'?" in outcome.fatal.message
    assert sorted(fake_worker.tries_of(tmp_path)) == ids(4), "none is tried again"


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize("bad", ["e0", "e3"])
def test_a_wrong_spec_of_one_item_fails_only_that_item(tmp_path: Path, workers: int, bad: str):
    outcome = supervise(tmp_path, {bad: ["spec"]}, workers=workers).run()
    assert outcome.fatal is None
    assert episodes(tmp_path) == [name for name in ids(4) if name != bad]
    (unmade,) = outcome.totals.unmade
    assert (unmade.id, outcome.totals.retries) == (bad, 0)
    assert unmade.reproduce == f"robocell generate run.yaml --shard {bad[1:]}/4"


FIRST = ["e0", "e2", "e4", "e6", "e8"]  # of ten: spread over the plan


def test_when_no_item_of_the_first_works_the_run_ends(tmp_path: Path):
    recorder = Recorder()
    outcome = supervise(tmp_path, {"*": ["kill"]}, count=10, workers=1, observer=recorder).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "other"
    message = outcome.fatal.message
    assert "was killed by SIGKILL (out of memory?)\nabout to die\n" in message
    assert (
        "None of the 5 items that were tried first, spread over the plan, could be made" in message
    )
    assert message.endswith("Try one alone: robocell generate run.yaml --shard 0/10")
    assert fake_worker.tries_of(tmp_path) == [name for name in FIRST for _ in range(3)]
    assert [text.split(":")[0] for text in recorder.of("unmade")] == FIRST
    assert not outcome.interrupted


@pytest.mark.parametrize("workers", [1, pytest.param(3, marks=pytest.mark.proof)])
def test_one_success_is_enough_to_continue(tmp_path: Path, workers: int):
    outcome = supervise(tmp_path, {"*": ["spec"], "e8": ["make"]}, count=10, workers=workers).run()
    assert outcome.fatal is None
    assert episodes(tmp_path) == ["e8"]
    assert sorted(fake_worker.tries_of(tmp_path)) == ids(10)
    assert len(outcome.totals.unmade) == 9


def test_items_without_success_do_not_end_the_run(tmp_path: Path):
    outcome = supervise(tmp_path, {"*": ["fail"]}, count=10).run()
    assert outcome.fatal is None
    assert len(outcome.totals.unmade) == 10


def test_with_earlier_successes_all_items_are_tried(tmp_path: Path):
    (tmp_path / "e0").mkdir()
    outcome = supervise(tmp_path, {"*": ["spec"]}, count=8, already=1).run()
    assert outcome.fatal is None
    assert sorted(fake_worker.tries_of(tmp_path)) == ids(8)[1:]


def test_a_worker_reports_its_failure_with_a_full_log_disk():
    command = [sys.executable, "-m", "robocell._generation.work", "--", "/no/such/run.yaml"]
    with Path("/dev/full").open("wb") as log:
        worker = subprocess.run(
            command,
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
            timeout=60,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
    assert "/no/such/run.yaml" in json.loads(worker.stdout)["refused"]["message"]


def test_a_full_disk_ends_the_run_at_once(tmp_path: Path):
    trouble = "the disk is full"
    outcome = supervise(tmp_path, {"*": ["io"]}, disk_trouble=lambda: trouble).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "io"
    assert "steps.h5" in outcome.fatal.message
    assert trouble in outcome.fatal.message
    assert len(fake_worker.tries_of(tmp_path)) <= 2


def test_the_free_space_of_a_full_disk_is_reported_once():
    said = "cannot write 'x': No space left on device. More than 9 bytes are needed, 9 are free"
    hint = f"{said} there. Make room and try again."
    assert with_trouble(hint, "the disk of 'out' is full: 0 kB are free") == hint
    assert with_trouble(said, "the disk of 'out' is full: 0 kB are free").count("free") == 2
    other = "cannot write into 'out': Permission denied"
    assert with_trouble(hint, other) == f"{hint}\n{other}"


def test_a_transient_write_error_is_retried_and_a_permanent_one_ends_the_run(tmp_path: Path):
    passing, lasting = tmp_path / "passing", tmp_path / "lasting"
    passing.mkdir()
    lasting.mkdir()
    assert supervise(passing, {"e0": ["io", "make"]}).run().fatal is None
    assert episodes(passing) == ids(4)
    outcome = supervise(lasting, {"e0": ["io"]}).run()
    assert outcome.fatal is not None
    assert outcome.fatal.kind == "io"
    assert fake_worker.tries_of(lasting).count("e0") == 3


def test_a_worker_that_sends_garbage_is_replaced(tmp_path: Path):
    command = [sys.executable, "-c", "print('hello'); input()"]
    supervisor = Supervisor(
        [Item("e0", 0)], command, workers=1, logs=tmp_path, on_disk=lambda name: None
    )
    fatal = supervisor.run().fatal
    assert fatal is not None
    assert "not a message: b'hello'" in fatal.message


def test_an_error_in_the_observer_leaves_no_worker_behind(tmp_path: Path):
    recorder = Recorder()

    def broken() -> None:
        raise ZeroDivisionError

    recorder.on_episode = broken
    script = {"e1": ["patient"]}
    with pytest.raises(ZeroDivisionError):
        supervise(tmp_path, script, observer=recorder).run()
    pids = [int(line.split()[1]) for line in (tmp_path / "tries").read_text().splitlines()]
    assert all(gone(pid) for pid in pids)


# rich ends the process where a pipe was closed.
@pytest.mark.parametrize("error", [BrokenPipeError("nobody reads"), SystemExit(1)])
@pytest.mark.parametrize("event", ["on_episode", "on_tick"])
def test_a_failing_observer_does_not_end_the_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], error: BaseException, event: str
):
    recorder, calls = Recorder(), []

    def broken() -> None:
        calls.append(event)
        raise error

    setattr(recorder, event, broken)
    outcome = supervise(tmp_path, {}, observer=recorder).run()
    assert outcome.totals.made == 4
    assert episodes(tmp_path) == ids(4)
    assert calls == [event], "it is not told again"
    text = f"progress cannot be shown any more ({error}); the run continues"
    assert capsys.readouterr().err == f"{text}\n"


# A test run in the background may have SIGINT ignored, which children inherit.
DRIVER = """
import signal, sys
for number in (signal.SIGINT, signal.SIGHUP):
    signal.signal(number, signal.SIG_IGN if number in {ignored!r} else signal.SIG_DFL)
sys.path[:0] = {path!r}
import test_supervisor as t
from pathlib import Path
supervisor = t.supervise(Path({folder!r}), {script!r}, limits=t.Limits(stop_grace_s=5))
from robocell._generation.signals import stop_on_signals
with stop_on_signals(supervisor.request_stop):
    outcome = supervisor.run()
sys.exit(130 if outcome.interrupted else 0)
"""


def drive(
    folder: Path, script: dict[str, list[str]], ignored: tuple[int, ...] = ()
) -> subprocess.Popen[bytes]:
    """A supervisor in a process group of its own, as a terminal starts it."""
    path = [str(Path(__file__).parent), *sys.path]
    code = DRIVER.format(path=path, folder=str(folder), script=script, ignored=ignored)
    return subprocess.Popen([sys.executable, "-c", code], start_new_session=True)


def started(folder: Path, *names: str) -> Callable[[], bool]:
    return lambda: set(names) <= set(fake_worker.tries_of(folder))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_sigterm_end_the_run_tidily(tmp_path: Path, number: signal.Signals):
    driver = drive(tmp_path, {"e2": ["patient"], "e3": ["patient"]})
    wait_for(started(tmp_path, "e2", "e3"))
    os.killpg(driver.pid, number)  # as a terminal does: to the whole group
    assert driver.wait(SOON_S) == 130
    assert episodes(tmp_path) == ["e0", "e1"]
    log = "".join(path.read_text() for path in tmp_path.glob("worker-*.log"))
    assert log == "", "no worker was hit by the signal itself"


def test_a_signal_that_is_ignored_stays_ignored(tmp_path: Path):
    driver = drive(tmp_path, {"*": ["slow"]}, ignored=(signal.SIGHUP.value,))
    wait_for(started(tmp_path, "e0"))
    os.killpg(driver.pid, signal.SIGHUP)  # the terminal of a `nohup` command closes
    assert driver.wait(SOON_S) == 0
    assert episodes(tmp_path) == ids(4)


def test_workers_end_when_their_supervisor_is_killed(tmp_path: Path):
    driver = drive(tmp_path, {"e2": ["patient"], "e3": ["patient"]})
    wait_for(started(tmp_path, "e2", "e3"))
    driver.kill()
    driver.wait(SOON_S)
    pids = [int(line.split()[1]) for line in (tmp_path / "tries").read_text().splitlines()]
    wait_for(lambda: all(gone(pid) for pid in pids))
    assert episodes(tmp_path) == ["e0", "e1"]


def test_a_worker_terminated_by_the_system_returns_its_item(tmp_path: Path):
    recorder = Recorder()
    supervisor = supervise(tmp_path, {"e0": ["patient", "make"]}, workers=1, observer=recorder)

    def terminate() -> None:
        if fake_worker.tries_of(tmp_path):
            pid = (tmp_path / "tries").read_text().split()[1]
            recorder.on_tick = lambda: None
            os.kill(int(pid), signal.SIGTERM)

    recorder.on_tick = terminate
    outcome = supervisor.run()
    assert episodes(tmp_path) == ids(4)
    assert outcome.totals.retries == 1
    assert "stopped by another process" in recorder.of("retry")[0]
