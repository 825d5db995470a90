"""The modules that a benchmark needs, and whether the user named them.

A file from elsewhere imports nothing: it says which modules it needs and what they contain, the
user names them, and the contents are compared before any is imported.
"""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Iterable, Mapping, Sequence
from importlib.machinery import PathFinder
from pathlib import Path

from robocell._core import ArgumentError, NotFoundError, imports_of_run_file
from robocell._own_code import source_of_module


def needed_imports(source: str | os.PathLike[str], imports: Sequence[str]) -> dict[str, Path]:
    """Returns module -> its file: those of a command, and those that a run file names."""
    files = {name: file_of_import(name, Path.cwd()) for name in imports}
    return files | imports_of(Path(source))


def imports_of(run: Path) -> dict[str, Path]:
    """Returns module -> its file of the modules that a run file imports; none of other sources."""
    if not run.is_file() or run.suffix == ".py":
        return {}
    folder = run.absolute().parent
    return {name: file_of_import(name, folder) for name, _ in imports_of_run_file(str(run))}


def file_of_import(name: str, folder: Path) -> Path:
    """Returns the file that an import of a module, file or library reads; imports nothing.

    Raises NotFoundError without one.
    """
    found: Path | None = folder / name
    if not name.endswith((".py", ".so")) and "/" not in name:
        found = source_of_module(name)
        if found is None:  # names are looked up in the folder, too
            spec = PathFinder.find_spec(name.partition(".")[0], [str(folder)])
            beside = Path(spec.origin) if spec is not None and spec.origin else None
            if beside is not None and "." in name:
                beside = beside.parent.joinpath(*name.split(".")[1:]).with_suffix(".py")
            found = beside
    if found is None or not found.is_file():
        raise NotFoundError(f"module '{name}' has no file here; name its file, such as tasks.py")
    return found.resolve()


def hash_of(file: Path) -> str:
    """Returns the SHA-256 of a file's content."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def stored_name(name: str, file: Path, folder: Path) -> str:
    """Returns a module's name as a file in `folder` has it: paths are relative to the folder."""
    is_path = name.endswith((".py", ".so")) or "/" in name
    return os.path.relpath(file, folder.resolve()) if is_path else name


def require_named(
    place: Path,
    needed: Mapping[str, str],
    of_run: Iterable[Path],
    imports: Sequence[str],
    command: Sequence[str],
) -> None:
    """Checks the modules that a user named against those that a benchmark needs.

    Args:
        place: The benchmark's file, which paths in it are relative to.
        needed: Module -> SHA-256, of the benchmark.
        of_run: Files that its run file imports.
        imports: The modules that the user named.
        command: The command without its imports, for the message.

    Raises:
        ArgumentError: A module is missing, has another content, or is none of the benchmark.
    """
    given = {file_of_import(name, Path.cwd()): name for name in imports}
    hashes = {file: hash_of(file) for file in given}
    missing = [name for name, digest in needed.items() if digest not in hashes.values()]
    # The same content in another folder imports other modules beside it.
    unnamed = [file for file in of_run if file not in given]
    wanted = [_here(name, place) for name in missing]
    wanted += [name for file in unnamed if (name := os.path.relpath(file)) not in wanted]
    names = {Path(_here(name, place)).name for name in missing}
    for file, name in given.items():
        if hashes[file] in needed.values():
            continue
        if file.name in names or name in missing:
            raise ArgumentError(
                f"'{name}' is not the module that benchmark '{place}' was made with: its SHA-256 "
                f"is {hashes[file]}, and the benchmark's {_digest_of(needed, file, name)}. Use the "
                "file that came with the benchmark"
            )
        raise ArgumentError(
            f"benchmark '{place}' was made without the module '{name}'; leave it out of --import. "
            f"Its modules: {', '.join(needed) or 'none'}"
        )
    if wanted:
        options = [part for name in (*imports, *wanted) for part in ("--import", name)]
        raise ArgumentError(
            f"benchmark '{place}' needs {_and(wanted)}, and a file never imports code by itself. "
            f"Read the code, then name it: `{shlex.join([*command, *options])}`"
        )
    if others := [file for file in of_run if hashes[file] not in needed.values()]:
        raise ArgumentError(
            f"the run file of benchmark '{place}' imports {_and(map(str, others))}, which the "
            "benchmark was made without"
        )


def _here(name: str, place: Path) -> str:
    """Returns a stored name as this working folder has it."""
    is_path = name.endswith((".py", ".so")) or "/" in name
    return os.path.relpath(place.absolute().parent / name) if is_path else name


def _digest_of(needed: Mapping[str, str], file: Path, name: str) -> str:
    same = (digest for each, digest in needed.items() if Path(each).name == file.name)
    return needed.get(name) or next(same)


def _and(names: Iterable[str]) -> str:
    shown = [f"'{name}'" for name in names]
    return ("the module " if len(shown) == 1 else "the modules ") + " and ".join(shown)
