"""The command `robocell` over a disk that fails, in a fork for each fault: its start takes longest.

Started by test_failing_start.py with the shim preloaded. A request is a line of JSON with the
arguments and what the shim shall do: {"arguments": [...], "at": 17, "do": "fail"}; the answer has
the exit code and all that it said: {"code": 3, "said": "..."}.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from typing import Any

from robocell._cli import load, main
from robocell._generation import job
from robocell._generation.check import Found

COMMAND = load(["generate"])


def be_the_command(request: dict[str, Any], said: int) -> None:
    """In the child: never returns."""
    os.environ["FAULT_AT"], os.environ["FAULT_DO"] = str(request["at"]), request["do"]
    os.dup2(said, 1)
    os.dup2(said, 2)
    sys.argv = ["robocell", *request["arguments"]]
    try:
        main(COMMAND)
    except SystemExit as end:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(int(end.code or 0))
    sys.stdout.flush()
    os._exit(0)


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """How the command ended."""
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if child == 0:
            be_the_command(request, said.fileno())
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        return {"code": code, "said": said.read().decode()}


if __name__ == "__main__":
    # Done in a process of its own, that writes nothing: only its start would be waited for.
    job.check_in_child = lambda run_file, overrides, longest_s=0.0: Found([])
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), flush=True)
