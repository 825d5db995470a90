"""Finds a user's own source files, and those that define a task, expert or feature.

A dataset records their content, so that it is not continued with other code. Nothing is imported
to find them: what a source mentions is looked up on the disk.
"""

from __future__ import annotations

import ast
import functools
import importlib.util
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import FrameType

from robocell._arguments import with_hints

# The errors that a user's code may raise: also `sys.exit()`, which ends no process here, cancelled
# tasks of asyncio and panics of extensions in Rust. What catches them begins with
# `raise_interrupt(error)`.
RAISED = BaseException

# Modules that the run in work names, by whose import any class may have been changed.
_modules_of_run: tuple[str, ...] = ()


def raise_interrupt(error: BaseException) -> None:
    """Raises an error that is none of a user's code: Ctrl-C, or the end of a generator."""
    if isinstance(error, KeyboardInterrupt | GeneratorExit):
        raise error


def set_modules_of_run(modules: Sequence[str]) -> None:
    """Makes modules a part of the code of every kind and feature, until others are set."""
    global _modules_of_run
    _modules_of_run = tuple(modules)


def modules_now() -> tuple[str, ...]:
    """Returns the modules that `set_modules_of_run` has set."""
    return _modules_of_run


@contextmanager
def modules_of_one_run() -> Iterator[None]:
    """Context manager for one run in a longer process: restores the module list afterwards."""
    before = _modules_of_run
    try:
        yield
    finally:
        set_modules_of_run(before)


def calling_module() -> str:
    """Returns the name of the module that calls the function which calls this one."""
    frame: FrameType | None = sys._getframe(2)
    while frame is not None and frame.f_globals.get("__name__") == with_hints.__module__:
        frame = frame.f_back  # the function is decorated
    return str(frame.f_globals.get("__name__", "")) if frame is not None else ""


def file_of_module(name: str) -> Path | None:
    """Returns the file that a module was loaded from; None in a notebook."""
    file = _file_of_loaded(name)
    return file.resolve() if file else None


def paths_of(call: str, files: str | Path | Sequence[str | Path], module: str) -> list[Path]:
    """Returns absolute paths of one or several files, which are relative to a module's folder."""
    home = file_of_module(module)
    beside = home.parent if home else Path.cwd()
    listed = [files] if isinstance(files, str | os.PathLike) else list(files)
    for file in listed:
        if not isinstance(file, str | os.PathLike) or not os.fspath(file):
            raise TypeError(f"{call}: `files` lists paths of files and folders, got {file!r}")
    return [(beside / file).absolute() for file in listed]


def _files_in(paths: Iterable[Path]) -> Iterator[Path]:
    """Returns the files among the paths, and all in the folders among them, as they are now."""
    for path in paths:
        if not path.is_dir():
            yield path
            continue
        inside = (file for file in path.rglob("*") if "__pycache__" not in file.parts)
        yield from sorted(file for file in inside if file.is_file())


def code_of(
    maker: object, files: Sequence[Path] = (), registering: str = ""
) -> Callable[[], list[str]]:
    """Returns a function that lists the files of the code when a dataset is begun or checked.

    The code is that of the module which defines `maker`, of the one which registers it, with
    arguments perhaps, and of the modules that the run names.

    Args:
        maker: What was registered.
        files: Further files that it uses, such as weights, or folders of them.
        registering: Name of the module that registers it.
    """
    while isinstance(maker, functools.partial):
        maker = maker.func
    module = getattr(inspect.unwrap(maker), "__module__", None)  # type: ignore[arg-type]

    def listed() -> list[str]:
        sources = own_sources(module, registering, *_modules_of_run)
        return [str(path) for path in (*sources, *_files_in(files))]

    return listed


def own_sources(*modules: str | None) -> list[Path]:
    """Returns the source files of modules and their imports, except installed ones.

    Not installed are the files that a user edits: outside of Python's own folders and
    site-packages. Imports anywhere in the sources count, and where values come from.
    """
    found: dict[Path, None] = {}
    waiting = [module for module in modules if module]
    seen = set[str]()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        if "." in name:  # a folder without code has parents with code
            waiting.append(name.rpartition(".")[0])
        file = source_of_module(name)
        if file is None or not is_own(file):
            continue
        found[file.resolve()] = None
        waiting += _imports_of(file, name)
        waiting += _homes_of_values(name)
    return sorted(found)


def loaded_sources() -> list[Path]:
    """Returns the source files of all modules that are loaded, as far as they are a user's own."""
    names = [name for name in list(sys.modules) if (file := _file_of_loaded(name)) and is_own(file)]
    return own_sources(*names)


def is_own(file: Path) -> bool:
    """Returns True if a module's file is neither installed nor part of robocell or Python."""
    file = file.resolve()
    if {"site-packages", "dist-packages"} & set(file.parts):
        return False
    return not any(file.is_relative_to(folder) for folder in _installed_folders())


@functools.cache
def _installed_folders() -> list[Path]:
    # The extension of a checkout is in its build folder.
    package = [Path(folder) for folder in sys.modules["robocell"].__path__]
    folders = [Path(sys.base_prefix) / "lib", Path(sys.prefix) / "lib", *package]
    return [folder.resolve() for folder in folders]


def source_of_module(module: str) -> Path | None:
    """Returns the file that a module is or would be loaded from; None without one, or installed.

    `find_spec` of a dotted name imports its parents, which the user's code may never do: they may
    be slow, or raise. So each part is looked up in the folders of the one before.
    """
    if module in sys.modules:
        return _file_of_loaded(module)
    top, *rest = module.split(".")
    spec = _spec_of_top(top)
    folders = _folders_of(top, spec)
    for depth, part in enumerate(rest, start=2):
        if spec is not None and spec.has_location and not is_own(Path(str(spec.origin))):
            return None
        try:
            spec = PathFinder.find_spec(part, folders)
        except Exception:  # of a folder that cannot be read, or of somebody's import hook
            return None
        folders = _folders_of(".".join([top, *rest][:depth]), spec)
        if spec is None and not folders:
            return None
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _spec_of_top(name: str) -> ModuleSpec | None:
    try:
        return importlib.util.find_spec(name)
    except Exception:  # of a module without spec, or of somebody's import hook
        return None


def _folders_of(module: str, spec: ModuleSpec | None) -> list[str]:
    """Returns the folders where a package's modules are."""
    loaded = sys.modules.get(module)
    if loaded is not None:
        return [str(folder) for folder in getattr(loaded, "__path__", ())]
    return list(spec.submodule_search_locations or ()) if spec is not None else []


def _file_of_loaded(module: str) -> Path | None:
    try:
        file = getattr(sys.modules.get(module), "__file__", None)
    except Exception:  # of a proxy that loads its module when it is asked
        return None
    return Path(file) if isinstance(file, str) and file else None


def _homes_of_values(module: str) -> list[str]:
    """Returns the modules that the values of a loaded module come from."""
    loaded = sys.modules.get(module)
    homes = map(_home_of, list(vars(loaded).values())) if loaded is not None else ()
    return [home for home in homes if home]


def _home_of(value: object) -> str:
    try:
        home = value.__name__ if inspect.ismodule(value) else getattr(value, "__module__", None)
    except Exception:  # of a proxy that makes its value when it is asked
        return ""
    return home if isinstance(home, str) else ""


def _imports_of(file: Path, name: str) -> list[str]:
    """Returns the names that a source imports, at its top or in a function."""
    # A module's parts up to its package, from which relative names count.
    parts = name.split(".")
    package = parts if file.name == "__init__.py" else parts[:-1]
    try:
        return list(_imports_in(file.read_bytes(), tuple(package)))
    except OSError:
        return []


# A run looks at the same sources many times; to parse them takes longer than all else of it.
@functools.lru_cache(maxsize=256)
def _imports_in(source: bytes, package: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the names that the source of a module in a package imports."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ()
    names: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            parent = _absolute(package, node.level, node.module or "")
            names += [parent, *(f"{parent}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Call):
            names += _called_for(node, package)
    return tuple(each for each in names if each)


def _absolute(package: Sequence[str], level: int, name: str) -> str:
    """Returns the full name of '..name', where level counts the dots."""
    base: Iterable[str] = package[: len(package) - level + 1] if level else ()
    return ".".join([*base, *([name] if name else [])])


def _called_for(call: ast.Call, package: Sequence[str]) -> list[str]:
    """Returns 'a.b' for `import_module("a.b")` and `__import__("a.b")`."""
    function = call.func
    called = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    if called not in ("import_module", "__import__") or not call.args:
        return []
    first = call.args[0]
    if not isinstance(first, ast.Constant) or not isinstance(first.value, str):
        return []
    name = first.value.lstrip(".")
    return [_absolute(package, len(first.value) - len(name), name)]
