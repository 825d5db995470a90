"""Exit codes, messages and checks of arguments that the commands share."""

from __future__ import annotations

import difflib
import enum
from collections.abc import Iterable
from pathlib import Path
from typing import NoReturn

import typer
import yaml
from rich.console import Console
from rich.text import Text

SHOWN_FILES = 8


class ExitCode(enum.IntEnum):
    """What the process says when it ends."""

    DONE = 0
    INCOMPLETE = 1  # some items could not be made, or something was found wrong
    USAGE = 2  # the command, a spec or a robot file is wrong
    OUTPUT = 3  # reading or writing failed
    INTERRUPTED = 130


def print_error(message: str) -> None:
    """To standard error; the word 'error' is red on a terminal."""
    text = Text.assemble(("error: ", "bold red"), message)
    Console(stderr=True).print(text, soft_wrap=True)


def print_warning(message: str) -> None:
    """To standard error; the word 'warning' is yellow on a terminal."""
    text = Text.assemble(("warning: ", "bold yellow"), message)
    Console(stderr=True).print(text, soft_wrap=True)


def fail(message: str, code: ExitCode = ExitCode.USAGE) -> NoReturn:
    """Ends the command with a message."""
    print_error(message)
    raise typer.Exit(code)


def require_file(path: Path, what: str, endings: tuple[str, ...] = (".yaml", ".yml")) -> None:
    """Ends the command unless `path` is a file; the message lists what is there instead."""
    if path.is_file():
        return
    if path.is_dir():
        files = sorted(entry.name for entry in path.iterdir() if entry.suffix in endings)
        fail(f"'{path}' is a folder; give a {what}." + _list(f"In {path}/", files))
    folder = path.parent
    if not folder.is_dir():
        fail(f"no {what} '{path}': there is no folder '{folder}'.")
    files = sorted(entry.name for entry in folder.iterdir() if entry.suffix in endings)
    near = difflib.get_close_matches(path.name, files, n=1, cutoff=0.5)
    hint = f" Did you mean '{folder / near[0]}'?" if near else ""
    fail(f"no {what} '{path}'.{_list(f'In {folder}/', files)}{hint}")


def top_keys(path: Path) -> set[str]:
    """The keys of a YAML file, to tell what kind of file it is; empty when it cannot be told."""
    try:
        content = yaml.safe_load(path.read_text())
    except (OSError, ValueError, yaml.YAMLError):
        return set()
    return {str(key) for key in content} if isinstance(content, dict) else set()


def require_folder(path: Path, what: str) -> None:
    """Ends the command unless `path` is a folder."""
    if path.is_file():
        fail(f"'{path}' is a file; give the folder of a {what}.")
    if path.is_dir():
        return
    folder = path.parent
    if not folder.is_dir():
        fail(f"no {what} '{path}': there is no folder '{folder}'.")
    names = sorted(entry.name for entry in folder.iterdir() if entry.is_dir())
    near = difflib.get_close_matches(path.name, names, n=1, cutoff=0.5)
    hint = f" Did you mean '{folder / near[0]}'?" if near else ""
    fail(f"no {what} '{path}'.{_list(f'Folders in {folder}/', names)}{hint}")


def _list(place: str, names: Iterable[str]) -> str:
    """' In examples/: demo.yaml, xarm7.yaml.', or that there are none."""
    every = [name for name in names if not name.startswith(".")]
    if not every:
        return f" {place}: none."
    more = f" and {len(every) - SHOWN_FILES} more" if len(every) > SHOWN_FILES else ""
    return f" {place}: {', '.join(every[:SHOWN_FILES])}{more}."
