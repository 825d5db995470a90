"""`python -m robocell.generate.work`: a worker process. Started by the supervisor, not by people.

It loads the run file itself and refuses to go on when that is not what the supervisor loaded.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections.abc import Sequence

from robocell import RunConfig, Runner, SpecError, StopFlag, make_plan, run_identity
from robocell.generate.items import Item, Report
from robocell.generate.worker import MakeEpisode, serve


def command(run_file: str, overrides: Sequence[str], run: RunConfig) -> list[str]:
    """The command that starts a worker for a run."""
    sets = [f"--set={override}" for override in overrides]
    module = "robocell.generate.work"
    return [sys.executable, "-m", module, f"--identity={_digest(run)}", *sets, "--", run_file]


def _digest(run: RunConfig) -> str:
    return hashlib.sha256(run_identity(run).encode()).hexdigest()[:16]


def _open_maker(arguments: argparse.Namespace, stop: StopFlag) -> MakeEpisode:
    run = RunConfig.load(arguments.run_file, arguments.set)
    if _digest(run) != arguments.identity:
        raise SpecError(
            f"'{arguments.run_file}' or the robot file it names was changed after the run began; "
            "start the command again"
        )
    runner = Runner(run)
    plan = {item.id: item for item in make_plan(run)}

    def make(item: Item) -> Report:
        return Report.from_core(runner.run(plan[item.id], stop=stop))

    return make


def main() -> int:
    """The process."""
    parser = argparse.ArgumentParser(prog="robocell.generate.work", description=__doc__)
    parser.add_argument("--identity", required=True)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("run_file")
    arguments = parser.parse_args()
    stop = StopFlag()
    return serve(lambda: _open_maker(arguments, stop), stop)


if __name__ == "__main__":
    sys.exit(main())
