"""Looks through a run before it starts, in a process of its own: a model may crash the engine.

    crash = check_apart(run, "run.yaml", ["workers=2"])

`python -m robocell.generate.check` is that process.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence

from robocell import RunConfig, check_run
from robocell.generate.worker_process import describe_exit

LONGEST_S = 1800.0


def check_apart(run: RunConfig, run_file: str, overrides: Sequence[str]) -> str | None:
    """Raises what `robocell.check_run` raises; what to say when the process did not survive it.

    Models that crash the engine must not end the run: workers meet them again, one at a time, and
    what they cannot make is listed.
    """
    sets = [f"--set={override}" for override in overrides]
    command = [sys.executable, "-m", "robocell.generate.check", *sets, "--", run_file]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LONGEST_S
        )
    except subprocess.TimeoutExpired:
        return f"the run could not be looked through within {LONGEST_S:g} s: a model takes too long"
    if done.returncode > 0:
        check_run(run)  # says here what it said there
    sys.stderr.write(done.stderr)
    if done.returncode >= 0:
        return None
    return (
        f"the process that looked through the run {describe_exit(done.returncode)}: one of its "
        "models crashes the engine. Episodes that need it will be listed"
    )


def main() -> int:
    """The process."""
    parser = argparse.ArgumentParser(prog="robocell.generate.check", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("run_file")
    arguments = parser.parse_args()
    try:
        check_run(RunConfig.load(arguments.run_file, arguments.set))
    except Exception:
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
