"""Runs the command line in processes of its own, as a person does. No test in itself."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

import command_line

ROOT = Path(__file__).resolve().parents[2]
LONGEST_S = 900


robocell_command = functools.partial(command_line.robocell_command, timeout_s=LONGEST_S)


def generate(
    run: Path, output: Path, *options: object, as_a_person: bool = False
) -> list[dict[str, Any]]:
    """The events of a `robocell generate` that must succeed.

    With `as_a_person` its first process is started anew, for measurements of time and memory; else
    it is a fork, which takes half the time. Its workers are new processes either way.
    """
    words = ("generate", run, "--output", output, "--progress", "jsonl", *options)
    if as_a_person:
        result = command_line.new_process(
            *words, environment=command_line.environment_with({}), timeout_s=LONGEST_S
        )
    else:
        result = robocell_command(*words)
    assert result.returncode == 0, result.stderr
    return [json.loads(line) for line in result.stdout.splitlines()]


def warnings_of(stderr: str) -> str:
    """What a script says on standard error, but for the note of a large model's guarded solver.

    The note is said once per process and asks nothing of the person who reads it.
    """
    return "".join(
        line for line in stderr.splitlines(keepends=True) if "gets a dense Jacobian" not in line
    )


def refusal(*arguments: object) -> str:
    """What a command says on standard error that must be refused, in one piece of text."""
    result = robocell_command(*arguments)
    assert result.returncode in (2, 3), result.stdout + result.stderr
    assert "Traceback" not in result.stdout + result.stderr
    assert "error: " in result.stderr
    return " ".join(result.stderr.split())
