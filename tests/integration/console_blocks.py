"""The commands that a page shows: ``console`` blocks, and the files that they need.

A line that begins with ``$ `` is a command; the lines below it, up to the next command, are what it
prints. In a printed line ``…`` stands for anything; a line ``...`` stands for any lines. A block
with a title (```` ```yaml title="run.yaml" ````) is a file of that name; further blocks with that
title continue it.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from command_line import command_server, environment_with

LONGEST_S = 900
# Words and quoted words: such a command needs no shell.
PLAIN = re.compile(r"robocell [\w ./:=,@%+'\[\]-]+")
FILE = re.compile(r'^```\w+ title="([^"]+)"\n(.*?)^```', re.DOTALL | re.MULTILINE)
CONSOLE = re.compile(r"^```console\n(.*?)^```", re.DOTALL | re.MULTILINE)


@dataclass
class Command:
    """A command and what the page says it prints."""

    line: str
    printed: list[str]


def files(page: Path) -> dict[str, str]:
    """The files that a page shows, by name."""
    found: dict[str, str] = {}
    for name, content in FILE.findall(page.read_text()):
        found[name] = found.get(name, "") + content
    return found


def write_files(page: Path, folder: Path) -> None:
    """Writes the files that a page shows."""
    for name, content in files(page).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)


def commands(page: Path) -> list[Command]:
    """All commands of a page, in order. A line that ends with a backslash goes on in the next."""
    found: list[Command] = []
    goes_on = False
    for block in CONSOLE.findall(page.read_text()):
        for line in block.splitlines():
            if goes_on:
                found[-1].line += "\n" + line
            elif line.startswith("$ "):
                found.append(Command(line[2:], []))
            else:
                found[-1].printed.append(line)
                continue
            goes_on = line.endswith("\\")
    return found


def run(line: str, folder: Path) -> list[str]:
    """What a command prints, standard error included, without colours."""
    environment = environment_with({})
    if "COLUMNS" not in os.environ:
        del environment["COLUMNS"]  # the pages show lines as they are without a terminal
    if PLAIN.fullmatch(line) and command_server().serves(environment):
        done = command_server().run(
            *shlex.split(line)[1:],
            environment=environment,
            timeout_s=LONGEST_S,
            folder=folder,
            merged=True,
        )
        return _lines(done.stdout)
    python = f'python() {{ "{sys.executable}" "$@"; }}\n'
    robocell = 'robocell() { python -m robocell "$@"; }\n'
    done = subprocess.run(
        ["bash", "-c", python + robocell + line],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        check=False,
    )
    return _lines(done.stdout)


def _lines(text: str) -> list[str]:
    return [part.rstrip() for part in text.rstrip("\n").split("\n")] if text else []


def agrees(shown: list[str], printed: list[str]) -> bool:
    """Whether a command printed what the page shows."""
    pattern = ""
    for line in shown:
        if line.strip() == "...":
            pattern += r"(?:.*\n)*?"
        else:
            pattern += ".*".join(re.escape(piece) for piece in line.rstrip().split("…")) + "\n"
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in printed)) is not None
