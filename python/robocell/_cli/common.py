"""Exit codes, messages and checks of arguments that the commands share."""

from __future__ import annotations

import difflib
import enum
import itertools
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer
from rich.console import Console
from rich.measure import Measurement
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from robocell import _core
from robocell._suggestions import counted

if TYPE_CHECKING:
    from robocell.data.derive import Derived

SHOWN_FILES = 8
ENTRIES_LOOKED_AT = 100  # of a folder that may be a dataset
MOST_COLUMNS = 10_000  # more than any table needs


class ExitCode(enum.IntEnum):
    """Exit codes of the commands."""

    DONE = 0
    INCOMPLETE = 1  # some items could not be made, or something was found wrong
    USAGE = 2  # the command, a spec or a robot file is wrong
    OUTPUT = 3  # reading or writing failed
    INTERRUPTED = 130


def print_error(message: str) -> None:
    """Prints an error to standard error; the word 'error' is red on a terminal."""
    text = Text.assemble(("error: ", "bold red"), message)
    Console(stderr=True).print(text, soft_wrap=True)


def print_warning(message: str) -> None:
    """Prints a warning to standard error; the word 'warning' is yellow on a terminal."""
    text = Text.assemble(("warning: ", "bold yellow"), message)
    Console(stderr=True).print(text, soft_wrap=True)


def fail(message: str, code: ExitCode = ExitCode.USAGE) -> NoReturn:
    """Ends the command with a message."""
    print_error(message)
    raise typer.Exit(code)


PACKAGE_OPTION = typer.Option(
    "--package",
    metavar="NAME=FOLDER",
    help="Folder of a ROS package that a URDF names its meshes in. May be given several times.",
)


def declare_packages(packages: list[str] | None) -> None:
    """Adds packages for `package://NAME/...` in URDFs to ROBOCELL_PACKAGES, NAME=FOLDER each."""
    if packages:
        before = os.environ.get("ROBOCELL_PACKAGES")
        os.environ["ROBOCELL_PACKAGES"] = ":".join([*([before] if before else []), *packages])


def require_spec_file(path: Path, spec: type) -> None:
    """Ends the command with an explanation unless `path` is a file.

    Args:
        path: As given by the user.
        spec: The type read from it: `RobotConfig`, `RunConfig`.
    """
    if missing := _core.missing_spec_file(str(path), spec.__name__):
        fail(missing)


COPY_OPTION = typer.Option("--copy", help="Copy files. Default: hard links, where possible.")


@contextmanager
def counting(what: str = "episodes") -> Iterator[Callable[[int, int], None]]:
    """A bar that counts on a terminal; the block gets a function of (done, whole)."""
    with Progress(
        "{task.description}",
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
        transient=True,
    ) as progress:
        bar = progress.add_task(what, total=None)
        yield lambda done, whole: progress.update(bar, completed=done, total=whole)


def print_derived(result: Derived) -> None:
    """Prints what is worth knowing about the files of a dataset that was made from others."""
    if result.copied:
        print(f"{counted(result.copied, 'file')} could not be linked here, and were copied")


def require_png(path: Path) -> None:
    """Ends the command unless a picture can be written to `path`: PNG is the only format."""
    if path.is_dir():
        fail(f"'{path}' is a folder; give the picture a name: '{path / 'picture.png'}'")
    if path.suffix.lower() != ".png":
        fail(f"pictures are PNG files: give '{path.with_suffix('.png')}' instead of '{path}'")
    if not path.parent.is_dir():
        fail(f"cannot write '{path}': there is no folder '{path.parent}'", ExitCode.OUTPUT)


def print_wide(table: Table, **options: Any) -> None:
    """Prints to standard output without wrapping.

    Long paths stay in one piece, so that they can be copied; a terminal breaks the lines itself.
    Lines for files and pipes have no trailing blanks.
    """
    console = Console(**options)
    needed = Measurement.get(console, console.options.update(max_width=MOST_COLUMNS), table).maximum
    wide = Console(**options, width=max(console.width, needed))
    if wide.is_terminal:
        wide.print(table, soft_wrap=True)
    else:
        with wide.capture() as text:
            wide.print(table, soft_wrap=True)
        print("\n".join(line.rstrip() for line in text.get().splitlines()))


def require_folder(path: Path, what: str) -> None:
    """Ends the command unless `path` is a folder."""
    if path.is_file():
        fail(f"'{path}' is a file; give the folder of a {what}.")
    if path.is_dir():
        return
    fail_missing(path, what, Path.is_dir, lists_datasets=True)


def require_mapping(path: Path | None) -> None:
    """Ends the command if the file of `--mapping` does not exist."""
    if path is not None and not os.path.lexists(path):
        fail_missing(path, "mapping file", is_yaml)


def require_preset(preset: str) -> None:
    """Ends the command if `--preset` names a YAML file that does not exist."""
    path = Path(preset)
    if is_yaml(path) and not os.path.lexists(path):
        fail_missing(path, "preset file", is_yaml)


def require_run_source(source: str) -> None:
    """Ends the command if there is no such dataset, run file or benchmark.

    `module:name` is looked up later.
    """
    path = Path(source)
    if os.path.lexists(path) or ":" in path.name or path.suffix == ".py":
        return
    if is_yaml(path):
        require_spec_file(path, _core.RunConfig)
    if path.suffix == ".json":
        fail_missing(path, "benchmark", lambda file: file.suffix == ".json")
    fail_missing(path, "dataset or run file", lambda each: is_yaml(each) or each.is_dir())


def is_yaml(path: Path) -> bool:
    """Returns True for the name of a YAML file."""
    return path.suffix in (".yaml", ".yml")


def is_dataset(path: Path) -> bool:
    """Returns True for a folder that looks like a dataset: it says so, or has episodes."""
    if not path.is_dir():
        return False
    try:
        first = itertools.islice(path.iterdir(), ENTRIES_LOOKED_AT)
        named = ("dataset.json", "packed.json")
        return any((path / name).is_file() for name in named) or any(
            (entry / "episode.json").is_file() for entry in first
        )
    except OSError:  # no access
        return False


def fail_missing(
    path: Path, what: str, is_one: Callable[[Path], bool], *, lists_datasets: bool = False
) -> NoReturn:
    """Ends the command and names the nearest of the entries beside `path`.

    Args:
        path: What there is not.
        what: What it was meant to be.
        is_one: Whether an entry may be one by its name and kind. Its content may be anything, so
            that only near names are worth telling.
        lists_datasets: Whether all datasets beside `path` are listed.
    """
    folder = path.parent
    if not folder.is_dir():
        fail(f"no {what} '{path}': there is no folder '{folder}'.")
    entries = sorted(entry for entry in folder.iterdir() if is_one(entry))
    names = {_plain(entry): entry for entry in entries}
    near = difflib.get_close_matches(_plain(path), names, n=1)
    hint = f" Did you mean '{names[near[0]]}'?" if near else ""
    listed = ""
    if lists_datasets:
        datasets = [entry.name for entry in entries if is_dataset(entry)]
        listed = _list(f"Datasets in {str(folder).rstrip('/')}/", datasets)
    fail(f"no {what} '{path}'.{listed}{hint}")


def _plain(path: Path) -> str:
    """Returns a name without the suffix that all files of its kind have: it makes none nearer."""
    return path.stem if path.suffix in (".yaml", ".yml", ".json") else path.name


def _list(place: str, names: Iterable[str]) -> str:
    """Returns ' In examples/: demo.yaml, xarm7.yaml.', or that there are none."""
    every = [name for name in names if not name.startswith(".")]
    if not every:
        return f" {place}: none."
    more = f" and {len(every) - SHOWN_FILES} more" if len(every) > SHOWN_FILES else ""
    return f" {place}: {', '.join(every[:SHOWN_FILES])}{more}."
