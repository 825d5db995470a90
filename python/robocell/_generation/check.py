"""Checks a run before it starts, in a separate process: a model may crash the engine.

    for text in check_in_child(RunSource("run.yaml"), ["workers=2"]).warnings:
        print(text)

The module is that process. Its answer is its error, {"failed": {...}}, or its findings,
{"warnings": [...], "ffmpeg": "..."}.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import traceback
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from robocell import Error, IoError, RunConfig, _core
from robocell._ending import end_in_time
from robocell._generation.own_process import Asker, ask_process
from robocell._generation.protocol import Failure
from robocell._generation.run_source import RunSource
from robocell._generation.supervisor import Limits
from robocell._generation.worker_process import describe_exit
from robocell._own_code import RAISED, raise_interrupt
from robocell._raised import is_of_own_code
from robocell.diagnose import check_run, describe_gl

CRASHES = {
    -number
    for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
}

SOFTWARE = "llvmpipe"  # what draws where there is no graphics card


@dataclass(frozen=True)
class Found:
    """Result of the process that checked a run.

    Attributes:
        warnings: Warnings of the run, or that a model crashed the engine.
        environment: Variables that pass results of this process to the workers.
    """

    warnings: list[str]
    environment: Mapping[str, str] = field(default_factory=dict)


def check_in_child(
    source: RunSource, overrides: Sequence[str], longest_s: float = Limits.item_timeout_s
) -> Found:
    """Raises what `robocell.diagnose.check_run` raises.

    Models that crash or stall the engine must not end the run: workers retry them one at a time,
    and failed items are listed. The process may take `longest_s` seconds. Raises IoError if it ends
    otherwise.
    """
    sets = [f"--set={override}" for override in overrides]
    try:
        options = [*source.options(), *sets, "--", source.run]
        done = ask_process("robocell._generation.check", options, longest_s)
    except subprocess.TimeoutExpired:
        slow = f"the run could not be looked through within {longest_s:g} s: a model takes too long"
        return Found([slow])
    sys.stderr.write(done.stderr)
    reply = _last_line(done.stdout)
    if done.returncode == 0:
        answer = str(reply.get("ffmpeg", ""))
        known = {"ROBOCELL_FFMPEG_ANSWER": answer} if answer else {}
        return Found(list(map(str, reply.get("warnings", []))), known)
    how = f"the process that looked through the run {describe_exit(done.returncode)}"
    if done.returncode in CRASHES:
        blame = "one of its models crashes the engine. Episodes that need it will be listed"
        return Found([f"{how}: {blame}"])
    if failure := _failure(reply):
        raise failure.error()
    again = " when more memory is free" if done.returncode == -signal.SIGKILL else ""
    raise IoError(f"{how}. Nothing was written; give the same command again{again}")


def _last_line(reply: str) -> dict[str, Any]:
    """Returns the process's last line, if it printed one."""
    try:
        last = json.loads(reply.splitlines()[-1])
    except (ValueError, IndexError):
        return {}
    return last if isinstance(last, dict) else {}


def _failure(reply: dict[str, Any]) -> Failure | None:
    """Returns the error that the process raised."""
    try:
        return Failure.from_json(reply["failed"])
    except (ValueError, KeyError, TypeError):
        return None


def graphics_warnings(run: RunConfig, root: str = "/") -> list[str]:
    """Returns advice if a run with cameras would not use the graphics card.

    `root` is the root folder of the machine's files. Without a card, no image is rendered.
    """
    backend = run.cameras.renderer.backend
    if backend == "auto":
        backend = os.environ.get("ROBOCELL_RENDERER", backend)
    if backend == "soft":  # on purpose
        return []
    if not (run.cameras.draw and run.cameras.streams) or not _core.graphics_advice(SOFTWARE, root):
        return []
    try:
        drawing = describe_gl()
    except Error:
        if backend != "auto":  # workers say what was tried
            return []
        drawing = "soft"
    advice = _core.graphics_advice(drawing, root)
    return [advice] if advice else []


def main() -> int:
    """Entry point of the process."""
    parser = argparse.ArgumentParser(prog="robocell._generation.check", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    RunSource.add_options(parser)
    arguments = parser.parse_args()
    asker = Asker()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the process that asks has imported the modules, too
            run = RunSource.of(arguments).load(arguments.set)
        found = [finding.line for finding in check_run(run)] + graphics_warnings(run)
    except RAISED as error:
        raise_interrupt(error)
        if not isinstance(error, Error | OSError) and not is_of_own_code(error):
            traceback.print_exc()  # a defect: the message alone does not say where
        asker.answer({"failed": Failure.of(error).to_json()})
        return 1
    asker.answer({"warnings": found, "ffmpeg": _core.ffmpeg_answer()})
    return 0


if __name__ == "__main__":
    ended_with = main()
    end_in_time(ended_with, quiet=True)  # a user's threads are warned about where they matter
    sys.exit(ended_with)
