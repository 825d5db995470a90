"""Looks through a run before it starts, in a process of its own: a model may crash the engine.

    crash = check_apart("run.yaml", ["workers=2"])

`python -m robocell.generate.check` is that process. What it raised is the last line of its standard
output: {"failed": {...}}.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import traceback
from collections.abc import Sequence

from robocell import Error, IoError, RunConfig, check_run
from robocell.generate.protocol import Failure
from robocell.generate.worker_process import describe_exit

LONGEST_S = 1800.0
CRASHES = {
    -number
    for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
}


def check_apart(run_file: str, overrides: Sequence[str]) -> str | None:
    """Raises what `robocell.check_run` raises; what to say when a model crashed the engine.

    Models that crash the engine must not end the run: workers meet them again, one at a time, and
    what they cannot make is listed. IoError when the process ended in another way.
    """
    sets = [f"--set={override}" for override in overrides]
    command = [sys.executable, "-m", "robocell.generate.check", *sets, "--", run_file]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LONGEST_S
        )
    except subprocess.TimeoutExpired:
        return f"the run could not be looked through within {LONGEST_S:g} s: a model takes too long"
    sys.stderr.write(done.stderr)
    if done.returncode == 0:
        return None
    how = f"the process that looked through the run {describe_exit(done.returncode)}"
    if done.returncode in CRASHES:
        return f"{how}: one of its models crashes the engine. Episodes that need it will be listed"
    if failure := _failure(done.stdout):
        raise failure.error()
    again = " when more memory is free" if done.returncode == -signal.SIGKILL else ""
    raise IoError(f"{how}. Nothing was written; give the same command again{again}")


def _failure(said: str) -> Failure | None:
    """What the process raised, if it came to say so."""
    try:
        return Failure.from_json(json.loads(said.splitlines()[-1])["failed"])
    except (ValueError, IndexError, KeyError, TypeError):
        return None


def main() -> int:
    """The process."""
    parser = argparse.ArgumentParser(prog="robocell.generate.check", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("run_file")
    arguments = parser.parse_args()
    try:
        check_run(RunConfig.load(arguments.run_file, arguments.set))
    except Exception as error:
        if not isinstance(error, Error | OSError):
            traceback.print_exc()  # a defect: the message alone does not say where
        print(json.dumps({"failed": Failure.of(error).to_json()}))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
