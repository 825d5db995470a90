"""Where a run comes from: a run file, or a configuration made in Python, and the modules it needs.

    RunSource("run.yaml", imports=("my_tasks",)).load(["seed=2"])
    RunSource("my_tasks.py:my_config").load()

Modules are imported only here, for a run that somebody starts: never because a dataset names them.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import importlib.util
import re
import sys
import sysconfig
import traceback
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import TypeGuard

from robocell import Error, NotFoundError, RunConfig, SpecError
from robocell._core import imports_of_run_file, load_plugin
from robocell._extras import needed_modules
from robocell._own_code import RAISED, is_own, set_modules_of_run
from robocell._suggestions import did_you_mean, shortened
from robocell.generate import Keep


@dataclass(frozen=True)
class RunSource:
    """What a command was given.

    Attributes:
        run: A run file, or `module:name` or `file.py:name` of a RunConfig or of a function that
            makes one.
        imports: Modules to import first, by name or file, which register tasks, experts, scene
            sources, samplers or features; shared libraries (`.so`) that do so are loaded.
        policy: Who is evaluated in the run, as `robocell evaluate` names it; "" for generation.
    """

    run: str
    imports: tuple[str, ...] = ()
    policy: str = ""

    @property
    def in_python(self) -> bool:
        """Whether a module or a dataset makes the configuration, and no run file."""
        return self._split() is not None or (Path(self.run) / "dataset.json").is_file()

    def options(self) -> list[str]:
        """What gives another process the same source, before `--` and the run."""
        policy = [f"--policy={self.policy}"] if self.policy else []
        return [*(f"--import={module}" for module in self.imports), *policy]

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        """What `options` gives, for a process that is started with them."""
        parser.add_argument("--import", dest="imports", action="append", default=[])
        parser.add_argument("--policy", default="")
        parser.add_argument("run")

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> RunSource:
        """From the arguments of such a process."""
        return cls(arguments.run, tuple(arguments.imports), arguments.policy)

    def absolute(self) -> RunSource:
        """The same whatever the working folder becomes: a user's code may change it."""
        is_path = self._split() is None
        return replace(self, run=str(Path(self.run).absolute())) if is_path else self

    def load(self, overrides: Sequence[str] = ()) -> RunConfig:
        """Imports the modules and reads the run.

        SpecError for what the run says and for modules that cannot be imported, with file and line.
        """
        run = self._load(overrides)
        if self.policy:
            from robocell.policy import expert_of_policy

            run.expert = expert_of_policy(self.policy, self.run)
            run.keep = Keep.FIRST
        return run

    def _load(self, overrides: Sequence[str]) -> RunConfig:
        set_modules_of_run(())
        # All of them are the run's code: an import may change classes of other modules.
        modules = [import_named(module, Path.cwd()) for module in self.imports]
        if (split := self._split()) is not None:
            made = self._from_python(*split, overrides)
            modules.append(import_module(split[0], Path.cwd()).__name__)
        elif Path(self.run).is_dir():
            from robocell.dataset_run import run_of_dataset

            made = _overridden(run_of_dataset(self.run), self.run, overrides)
        else:
            folder = Path(self.run).absolute().parent
            for module, place in imports_of_run_file(self.run):
                try:
                    modules.append(import_named(module, folder))
                except SpecError as error:
                    raise SpecError(f"{place}: imports: {error}") from error
            made = RunConfig.load(self.run, list(overrides))
        set_modules_of_run([module for module in modules if module])
        return made

    def _split(self) -> tuple[str, str] | None:
        module, colon, name = self.run.rpartition(":")
        if not colon or not name.isidentifier() or Path(self.run).exists():
            return None
        return module, name

    def _from_python(self, module: str, name: str, overrides: Sequence[str]) -> RunConfig:
        loaded = import_module(module, Path.cwd())
        if not hasattr(loaded, name):
            known = [key for key, value in vars(loaded).items() if isinstance(value, RunConfig)]
            here = f" Its configurations: {', '.join(known)}." if known else ""
            near = did_you_mean(name, [key for key in vars(loaded) if not key.startswith("_")])
            raise NotFoundError(f"{self.run}: module '{module}' has no '{name}'.{here}{near}")
        made = getattr(loaded, name)
        if callable(made):
            try:
                with _in_the_same_folder():
                    made = made()
            except RAISED as error:
                raise SpecError(f"{self.run} cannot be made: {place_of(error)}") from error
        if not isinstance(made, RunConfig):
            raise SpecError(
                f"{self.run}: expected a RunConfig or a function that returns one, got a "
                f"{type(made).__name__}"
            )
        return _overridden(made, self.run, overrides)


def _overridden(made: RunConfig, name: str, overrides: Sequence[str]) -> RunConfig:
    """The configuration with replaced fields, which go the way of those of files."""
    # Paths are relative to where it was loaded, and those of the robot to its own file.
    folder = made.source_dir or str(Path.cwd())
    of_robot = [o for o in overrides if o.split("=", 1)[0].startswith("robot")]
    rest = [o for o in overrides if o not in of_robot]
    run = RunConfig.from_yaml(made.to_yaml(), name, folder, rest)
    run.robot = made.robot
    if of_robot:
        text = made.to_yaml()
        own = RunConfig.from_yaml(text, name, made.robot.source_dir or folder, of_robot)
        run.robot = own.robot
    return run


def import_named(name: str, folder: Path) -> str:
    """Imports a module, or loads a shared library that registers kinds (`libstack.so`).

    Returns the module's name, "" for a library. SpecError for what cannot be imported.
    """
    if not name.endswith(".so"):
        return import_module(name, folder).__name__
    if not (folder / name).exists():
        raise SpecError(_no_file(folder / name))
    try:
        with _in_the_same_folder():
            load_plugin(folder / name)
    except Error as error:
        raise SpecError(f"cannot import '{folder / name}': {error}") from error
    return ""


def import_module(name: str, folder: Path) -> ModuleType:
    """A module by its name or its file.

    Names are looked up as Python does, and in `folder`. SpecError names file and line of what went
    wrong in it, and names that are Python's own or robocell's.
    """
    _require_name_of_ones_own(name)
    try:
        with _in_the_same_folder():
            if name.endswith(".py") or "/" in name:
                return _import_file(folder / name)
            if str(folder) not in sys.path:
                sys.path.append(str(folder))
            return _require_code(importlib.import_module(name))
    except SpecError:
        raise
    except ModuleNotFoundError as error:
        if error.name == name.split(".")[0]:
            raise SpecError(
                f"cannot import '{name}': no such module in '{folder}' or among the installed "
                f"ones; name a file (--import path/to/{name}.py) or install it."
                f"{did_you_mean(name, _modules_in(folder))}"
            ) from error
        raise SpecError(f"cannot import '{name}': {place_of(error)}") from error
    except RAISED as error:
        raise SpecError(f"cannot import '{name}': {place_of(error)}") from error


def _in_the_same_folder() -> AbstractContextManager[None]:
    """Around a user's code: sets the working folder back, from which the command's paths count."""
    return contextlib.chdir(Path.cwd())


def _require_name_of_ones_own(name: str) -> None:
    """SpecError for a name whose module Python or robocell itself needs.

    A file that took the name would break what imports the other module, far from here.
    """
    is_file = name.endswith(".py") or "/" in name
    module = Path(name).stem if is_file else name.partition(".")[0]
    whose = ""
    if module in sys.stdlib_module_names:
        whose = "of Python itself"
    elif is_file and module == "robocell":
        whose = "of robocell itself"
    elif is_file and module in needed_modules():
        whose = "that robocell needs"
    if whose:
        raise SpecError(
            f"cannot import '{name}': '{module}' is the name of a module {whose}; give the file "
            f"another name, such as my_{module}.py"
        )


def _require_code(module: ModuleType) -> ModuleType:
    """Refuses a folder that only looks like a module: importing it runs nothing."""
    folders = [] if getattr(module, "__file__", None) else list(getattr(module, "__path__", ()))
    if folders:
        raise SpecError(f"cannot import '{module.__name__}': {_what_to_name(Path(folders[0]))}")
    return module


def _no_file(path: Path) -> str:
    """Says that there is no such file, and which is near, in its folder or elsewhere."""
    folder = path.parent
    start = f"cannot import '{path}': there is no such file"
    if not folder.is_dir():
        return f"{start}: there is no folder '{folder}'"
    files = sorted(file.name for file in folder.glob(f"*{path.suffix}") if file.is_file())
    if not files:
        return start
    near = did_you_mean(path.name, files)
    return f"{start}.{near or f' There are: {shortened(files)}'}"


def _modules_in(folder: Path) -> list[str]:
    """Returns the names of the modules in a folder."""
    return sorted(file.stem for file in folder.glob("*.py"))


def _what_to_name(folder: Path) -> str:
    if (folder / "__init__.py").is_file():
        return f"'{folder}' is a folder; import the package by its name: {folder.name}"
    files = sorted(file.name for file in folder.glob("*.py"))
    example = folder / (files[0] if files else "tasks.py")
    return f"'{folder}' is a folder without an __init__.py; name a file in it, such as {example}"


def _import_file(path: Path) -> ModuleType:
    path = path.resolve()
    if path.is_dir():
        raise SpecError(f"cannot import '{path}': {_what_to_name(path)}")
    if not path.is_file():
        raise SpecError(_no_file(path))
    name = path.stem
    loaded = sys.modules.get(name)
    if loaded is not None and Path(getattr(loaded, "__file__", "") or "").resolve() == path:
        return loaded
    if loaded is not None:
        raise SpecError(
            f"cannot import '{path}': a module '{name}' is loaded from "
            f"'{getattr(loaded, '__file__', 'Python itself')}' already; give the file another name"
        )
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))  # for what it imports beside it
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise SpecError(f"cannot import '{path}': it is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    return module


def is_of_users(error: BaseException) -> bool:
    """Whether it went through somebody's own code."""
    return bool(_frames_of_users(error))


def is_of_own_code(error: BaseException) -> bool:
    """Whether it went through somebody's own sources, not only through installed packages."""
    return bool(_own_frames(error))


def own_trace(error: BaseException) -> str:
    """Returns the traceback of an error, or of its cause, through somebody's own sources alone."""
    frames = _own_frames(error)
    while not frames and error.__cause__ is not None:
        error = error.__cause__
        frames = _own_frames(error)
    return "".join(traceback.format_list(frames)).rstrip()


def ends_with_place(text: str) -> bool:
    """Whether a message ends with the place of somebody's code: '(tasks.py:12, in judge)'."""
    return re.search(r" \([^()]+:\d+, in [^()]+\)$", text) is not None


def text_with_place(error: BaseException) -> str:
    """The text for a user of what a command raised, with the place of their own code, if any."""
    if not is_of_own_code(error):
        return text_of(error)
    if not isinstance(error, Error):
        return place_of(error)
    place = where(error)
    return text_of(error) if place in text_of(error) else f"{text_of(error)}{place}"


def place_of(error: BaseException) -> str:
    """'ValueError: text (tasks.py:12, in judge)': where somebody's own code raised it."""
    text = error.msg if _has_file(error) else text_of(error)
    return f"{type(error).__name__}: {text}{where(error)}"


def text_of(error: BaseException) -> str:
    """The error's text, also of a class that cannot make it."""
    try:
        return str(error)
    except Exception:
        return "(its text cannot be made)"


def where(error: BaseException) -> str:
    """' (tasks.py:12, in judge)', where somebody's own code raised it; '' for none of theirs."""
    if _has_file(error):
        return f" ({error.filename}:{error.lineno})"
    frames = _frames_of_users(error)
    if not frames:
        return ""
    last = frames[-1]
    return f" ({last.filename}:{last.lineno}, in {last.name})"


def _has_file(error: BaseException) -> TypeGuard[SyntaxError]:
    """Whether the error is of a source file that could not be parsed, not of a text."""
    return (
        isinstance(error, SyntaxError)
        and bool(error.filename)
        and not str(error.filename).startswith("<")
    )


def _frames_of_users(error: BaseException) -> list[traceback.FrameSummary]:
    """Returns the frames in somebody's own sources; of installed packages if there are none.

    Code of a user is often in the middle: robocell calls it, and it calls NumPy, which raises.
    """
    own = _own_frames(error)
    return own or [f for f in _frames(error) if _is_of_installed_package(Path(f.filename))]


def _own_frames(error: BaseException) -> list[traceback.FrameSummary]:
    return [frame for frame in _frames(error) if is_own(Path(frame.filename))]


def _frames(error: BaseException) -> list[traceback.FrameSummary]:
    """Returns the frames that are in files."""
    frames = traceback.extract_tb(error.__traceback__)
    return [frame for frame in frames if not frame.filename.startswith("<")]


def _is_of_installed_package(file: Path) -> bool:
    """Whether a source is neither robocell's nor of Python's own library."""
    file = file.resolve()
    if file.is_relative_to(Path(__file__).resolve().parents[1]):
        return False
    library = Path(sysconfig.get_path("stdlib")).resolve()
    packages = {"site-packages", "dist-packages"}
    return not file.is_relative_to(library) or bool(packages & set(file.parts))
