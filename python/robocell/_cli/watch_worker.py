"""`robocell view DATASET --worker K`: what a worker of a running generation does at present.

The randomness of an episode depends on its run and number alone. So this process makes the worker's
present episode itself, at the speed of the viewer, and stores nothing: the worker is not slowed,
and it may be ahead. Every episode is shown from its first attempt.
"""

from __future__ import annotations

import copy
import os
import re
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from robocell._cli.common import fail
from robocell._core import (
    EpisodeStart,
    Error,
    PlanItem,
    Refusal,
    Rng,
    RunConfig,
    Runner,
    SampleRequest,
    Scene,
    StartSampler,
    StopFlag,
    TaskSampler,
    make_plan,
    prepare_dataset,
)
from robocell.viewer import Viewer

WRITTEN = re.compile(r"^\.(?P<name>.+)\.(?P<process>\d+)\.\d+\.partial$")
ATTEMPT = re.compile(r"_a\d+$")  # of an episode of a run that keeps all attempts
LOOK_S = 0.1
PATIENCE_S = 30.0  # while a worker writes nothing, it looks for a start
NICER = 10


def written_by_workers(dataset: Path) -> dict[int, str]:
    """Returns the episodes that are being written, by the processes that write them, in order."""
    found = {}
    for folder in dataset.glob(".*.partial"):
        name = WRITTEN.match(folder.name)
        if name and _is_alive(process := int(name["process"])):
            found[process] = name["name"]
    return dict(sorted(found.items()))


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


class Watched(TaskSampler):
    """The sampler of a run, which says when a scene is ready to be shown."""

    def __init__(self, run: RunConfig, on_start: Callable[[Scene], object]) -> None:
        super().__init__()
        self._sampler, self._on_start = StartSampler(run), on_start

    def sample(self, request: SampleRequest, rng: Rng) -> EpisodeStart | Refusal:
        """Returns the start of the run's own sampler."""
        start = self._sampler.sample(request, rng)
        if isinstance(start, EpisodeStart):
            self._on_start(start.scene)
        return start


def item_of(run: RunConfig, episode: str) -> PlanItem:
    """Returns the item of an episode, whatever number of episodes the run has now."""
    name = ATTEMPT.sub("", episode)
    number = re.search(r"_e(\d+)$", name)
    run = copy.deepcopy(run)
    run.episodes_per_scene = 1 + int(number[1]) if number else 1
    found = [item for item in make_plan(run) if item.id == name]
    if not found:
        fail(f"--worker: episode '{name}' is not one that a run of this dataset makes")
    return found[0]


def show_episode(run: RunConfig, item: PlanItem, on_start: Callable[[Scene], object]) -> bool:
    """Makes an episode of a run without storing it. Returns False if the user closed the window.

    Args:
        run: The run.
        item: The episode.
        on_start: Gets the scene of each attempt before it moves, to open a viewer.

    Raises:
        Error: That of `on_start`, such as without a display.
    """
    stop, raised = StopFlag(), list[Error]()

    def show(scene: Scene) -> None:
        try:
            on_start(scene)
        except Error as error:  # the runner would try again
            raised.append(error)
            stop.set()

    with tempfile.TemporaryDirectory() as folder:
        run = copy.deepcopy(run)
        run.output = f"{folder}/watched"  # a dataset without episodes, beside the worker's
        prepare_dataset(run)
        runner = Runner(run, sampler=lambda made: Watched(made, show), stores=False)
        stopped = runner.run(item, stop).stopped
    if raised:
        raise raised[0]
    return not stopped


def watch(dataset: Path, worker: int, speed: float, imports: list[str]) -> None:
    """Shows the episodes of a worker until the generation ends, or the user closes the window."""
    from robocell._dataset_run import run_of_dataset

    run = run_of_dataset(dataset, imports)
    if run.sampler:
        fail(f"--worker: the run has a sampler of its own, '{run.sampler}'; watch its episodes")
    os.nice(NICER)
    shown: Viewer | None = None
    title = ""

    def open_viewer(scene: Scene) -> None:
        nonlocal shown
        if shown is not None and shown.scene == scene and shown.is_running:
            return
        if shown is not None:
            shown.close()
        shown = Viewer.open(scene, title)
        shown.realtime_factor = speed

    last = ""
    process: int | None = None  # between episodes others must not take the worker's number
    heard = time.monotonic()
    try:
        while True:
            written = written_by_workers(dataset)
            if process is None or not _is_alive(process):
                process = dict(enumerate(written)).get(worker)
            name = "" if process is None else written.get(process, "")
            if name:
                heard = time.monotonic()
            if name and name != last:
                last, title = name, f"worker {worker}: {name}"
                print(title, flush=True)
                if not show_episode(run, item_of(run, name), open_viewer):
                    return
                heard = time.monotonic()
                continue
            if not name and time.monotonic() - heard > PATIENCE_S:
                if last:
                    return  # the generation has ended
                fail(_nobody(dataset, worker))
            if shown is not None and not shown.show():
                return
            time.sleep(LOOK_S)
    finally:
        if shown is not None:
            shown.close()


def _nobody(dataset: Path, worker: int) -> str:
    count = len(written_by_workers(dataset))
    if count == 0:
        return f"no worker writes into '{dataset}': start `robocell generate` first"
    return f"there is no worker {worker}: {count} write into '{dataset}', from 0 to {count - 1}"
