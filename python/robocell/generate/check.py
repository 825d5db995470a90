"""Looks through a run before it starts, in a process of its own: a model may crash the engine.

    for text in check_in_child(RunSource("run.yaml"), ["workers=2"]).warnings:
        print(text)

The module is that process. The last line of its standard output is what it
raised, {"failed": {...}}, or what it found, {"warnings": [...], "ffmpeg": "..."}.
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
from robocell._own_code import RAISED
from robocell.diagnose import check_run, describe_gl
from robocell.generate.own_process import ask_process, end_with_asker
from robocell.generate.protocol import Failure
from robocell.generate.run_source import RunSource, is_of_own_code
from robocell.generate.supervisor import Limits
from robocell.generate.worker_process import describe_exit

CRASHES = {
    -number
    for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
}

SOFTWARE = "llvmpipe"  # what draws where there is no graphics card


@dataclass(frozen=True)
class Found:
    """By a process that looked a run through.

    Attributes:
        warnings: The run's, or that a model crashed the engine.
        environment: Variables that spare workers to find out again what this process has.
    """

    warnings: list[str]
    environment: Mapping[str, str] = field(default_factory=dict)


def check_in_child(
    source: RunSource, overrides: Sequence[str], longest_s: float = Limits.item_timeout_s
) -> Found:
    """Raises what `robocell.diagnose.check_run` raises.

    Models that crash or stall the engine must not end the run: workers meet them again, one at a
    time, and what they cannot make is listed. Such a process is given `longest_s` seconds. IoError
    when it ended in another way.
    """
    sets = [f"--set={override}" for override in overrides]
    try:
        options = [*source.options(), *sets, "--", source.run]
        done = ask_process("robocell.generate.check", options, longest_s)
    except subprocess.TimeoutExpired:
        slow = f"the run could not be looked through within {longest_s:g} s: a model takes too long"
        return Found([slow])
    sys.stderr.write(done.stderr)
    said = _last_line(done.stdout)
    if done.returncode == 0:
        answer = str(said.get("ffmpeg", ""))
        known = {"ROBOCELL_FFMPEG_ANSWER": answer} if answer else {}
        return Found(list(map(str, said.get("warnings", []))), known)
    how = f"the process that looked through the run {describe_exit(done.returncode)}"
    if done.returncode in CRASHES:
        blame = "one of its models crashes the engine. Episodes that need it will be listed"
        return Found([f"{how}: {blame}"])
    if failure := _failure(said):
        raise failure.error()
    again = " when more memory is free" if done.returncode == -signal.SIGKILL else ""
    raise IoError(f"{how}. Nothing was written; give the same command again{again}")


def _last_line(said: str) -> dict[str, Any]:
    """What the process said, if it came to say something."""
    try:
        last = json.loads(said.splitlines()[-1])
    except (ValueError, IndexError):
        return {}
    return last if isinstance(last, dict) else {}


def _failure(said: dict[str, Any]) -> Failure | None:
    """What the process raised."""
    try:
        return Failure.from_json(said["failed"])
    except (ValueError, KeyError, TypeError):
        return None


def graphics_warnings(run: RunConfig, root: str = "/") -> list[str]:
    """What to do where a run with cameras would leave a graphics card idle.

    `root` is the folder that the machine's files are looked up in. Without a card nothing is drawn.
    """
    backend = run.cameras.renderer.backend
    if backend == "auto":
        backend = os.environ.get("ROBOCELL_RENDERER", backend)
    if backend == "soft":  # on purpose
        return []
    if not run.cameras.streams or not _core.graphics_advice(SOFTWARE, root):
        return []
    try:
        drawing = describe_gl()
    except Error:  # workers say what was tried
        return []
    advice = _core.graphics_advice(drawing, root)
    return [advice] if advice else []


def main() -> int:
    """The process."""
    parser = argparse.ArgumentParser(prog="robocell.generate.check", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    RunSource.add_options(parser)
    arguments = parser.parse_args()
    end_with_asker()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the process that asks has imported the modules, too
            run = RunSource.of(arguments).load(arguments.set)
        found = check_run(run) + graphics_warnings(run)
    except RAISED as error:
        if not isinstance(error, Error | OSError) and not is_of_own_code(error):
            traceback.print_exc()  # a defect: the message alone does not say where
        print(json.dumps({"failed": Failure.of(error).to_json()}))
        return 1
    print(json.dumps({"warnings": found, "ffmpeg": _core.ffmpeg_answer()}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
