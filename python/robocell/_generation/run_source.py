"""The source of a run: a run file or a configuration made in Python, and the modules it needs.

    RunSource("run.yaml", imports=("my_tasks",)).load(["seed=2"])
    RunSource("my_tasks.py:my_config").load()

Modules are imported only here, for a run that a user starts: never because a dataset names them.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import importlib.util
import inspect
import json
import shlex
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType

from robocell import ArgumentError, Error, NotFoundError, RunConfig, SpecError
from robocell._core import imports_of_run_file, load_plugin
from robocell._extras import needed_modules
from robocell._own_code import RAISED, raise_interrupt, set_modules_of_run
from robocell._policy_options import PolicyOptions, is_url
from robocell._raised import place_of
from robocell._suggestions import did_you_mean, shortened
from robocell.generate import Keep

VARIADIC = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
_NO_CONFIGURATION = " Name a RunConfig in it, or a function that returns one."
_WITH_IMPORT = "name it with --import"  # of the messages about unknown kinds


@dataclass(frozen=True)
class RunSource:
    """The run that a command was given.

    Attributes:
        run: A run file, or `module:name` or `file.py:name` of a RunConfig or of a function that
            makes one.
        imports: Modules to import first, by name or file, which register tasks, experts, scene
            sources, samplers or features; shared libraries (`.so`) that do so are loaded.
        policy: The policy to evaluate, as `robocell evaluate` names it; "" for generation.
        acting: How the policy is asked for actions.
        augment: A dataset whose episodes are moved to new starts of the run, by `robocell augment`;
            `run` may be the same dataset, for the run that made it.
    """

    run: str
    imports: tuple[str, ...] = ()
    policy: str = ""
    acting: PolicyOptions = field(default_factory=PolicyOptions)
    augment: str = ""

    def __post_init__(self) -> None:
        """Raises ArgumentError for names that a dataset cannot store."""
        for text in (self.run, *self.imports, self.policy, self.acting.preset, self.augment):
            require_utf8(text)
        with contextlib.suppress(OSError):  # without a working folder
            require_utf8(str(Path.cwd()))

    @property
    def in_python(self) -> bool:
        """True if a module or a dataset provides the configuration."""
        return self._split() is not None or (Path(self.run) / "dataset.json").is_file()

    def options(self) -> list[str]:
        """Returns options that give another process the same source, before `--` and the run."""
        policy = [f"--policy={self.policy}"] if self.policy else []
        augment = [f"--augment={self.augment}"] if self.augment else []
        return [
            *(f"--import={module}" for module in self.imports),
            *policy,
            *augment,
            *self.acting.arguments(),
        ]

    def evaluation_command(
        self, episodes: int, seed: int | None, max_steps: int | None, cameras: bool, output: Path
    ) -> str:
        """Returns the command that evaluates the policy; None leaves an option out."""
        imports = [part for module in self.imports for part in ("--import", module)]
        options = [
            *("--policy", self.policy, *self.acting.arguments()),
            *("-n", str(episodes)),
            *([] if seed is None else ["--seed", str(seed)]),
            *([] if max_steps is None else ["--max-steps", str(max_steps)]),
            *([] if cameras else ["--no-cameras"]),
            *("--output", str(output)),
        ]
        return shlex.join(["robocell", "evaluate", self.run, *imports, *options])

    @staticmethod
    def add_options(parser: argparse.ArgumentParser) -> None:
        """Adds the options of `options` to a parser."""
        parser.add_argument("--import", dest="imports", action="append", default=[])
        parser.add_argument("--policy", default="")
        parser.add_argument("--augment", default="")
        PolicyOptions.add_options(parser)
        parser.add_argument("run")

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> RunSource:
        """Makes a source from parsed arguments."""
        acting = PolicyOptions.of(arguments)
        augment = arguments.augment
        return cls(arguments.run, tuple(arguments.imports), arguments.policy, acting, augment)

    def absolute(self) -> RunSource:
        """Returns it with absolute paths, because a user's code may change the working folder."""
        is_path = self._split() is None
        run = str(Path(self.run).absolute()) if is_path else self.run
        augment = str(Path(self.augment).absolute()) if self.augment else ""
        return replace(self, run=run, acting=self.acting.absolute(), augment=augment)

    def load(self, overrides: Sequence[str] = ()) -> RunConfig:
        """Imports the modules and reads the run.

        Raises SpecError, with file and line, for errors in the run and failed imports.
        """
        run = self._load([*self._augmenting(), *overrides])
        if self.policy:
            from robocell.policy import expert_of_policy

            run.expert = expert_of_policy(self.policy, self.run, self.acting)
            run.keep = Keep.FIRST
            run.augment = None
            run.noise = None  # a policy is judged by its own actions, from the starts of the task
        return run

    def _augmenting(self) -> list[str]:
        """Returns the overrides by which the episodes are made from those of a dataset."""
        if not self.augment:
            return []
        dataset = json.dumps(str(Path(self.augment).absolute()))
        return ['expert=""', f"augment.dataset={dataset}"]

    def _load(self, overrides: Sequence[str]) -> RunConfig:
        set_modules_of_run(())
        # All of them are the run's code: an import may change classes of other modules.
        modules = [import_named(module, Path.cwd()) for module in self.imports]
        if (split := self._split()) is not None:
            self._import_policy()
            made = self._from_python(*split, overrides)
            modules.append(import_module(split[0], Path.cwd()).__name__)
        elif Path(self.run).is_dir():
            if not self.policy and not self.augment:
                raise SpecError(_not_a_run(self.run))
            from robocell._dataset_run import (
                naming_what_to_evaluate,
                naming_where_to_augment,
                run_of_dataset,
            )

            self._import_policy()
            with naming_what_to_evaluate() if self.policy else naming_where_to_augment():
                made = run_of_dataset(self.run, modules)
            made = _overridden(made, self.run, overrides)
        elif self.run.endswith(".py"):
            raise SpecError(_not_a_run_file(self.run))
        else:
            folder = Path(self.run).absolute().parent
            for module, place in imports_of_run_file(self.run):
                try:
                    modules.append(import_named(module, folder))
                except SpecError as error:
                    raise SpecError(f"{place}: imports: {error}") from error
            self._import_policy()
            with _naming_imports_of_runs():
                made = RunConfig.load(self.run, list(overrides))
        set_modules_of_run([module for module in modules if module])
        return made

    def _import_policy(self) -> None:
        """Imports the policy's module before the run is read: it may register kinds, too."""
        module, colon, _ = self.policy.rpartition(":")
        if colon and not is_url(self.policy):
            import_module(module, Path.cwd())

    def _split(self) -> tuple[str, str] | None:
        module, colon, name = self.run.rpartition(":")
        if not colon or not name.isidentifier() or Path(self.run).exists():
            return None
        return module, name

    def _from_python(self, module: str, name: str, overrides: Sequence[str]) -> RunConfig:
        loaded = import_module(module, Path.cwd())
        if not hasattr(loaded, name):
            known = [key for key, value in vars(loaded).items() if isinstance(value, RunConfig)]
            here = f" Its configurations: {', '.join(known)}." if known else _NO_CONFIGURATION
            if functions := _makers_in(loaded):
                here += f" Its functions: {shortened(functions)}."
            near = did_you_mean(name, [key for key in vars(loaded) if not key.startswith("_")])
            raise NotFoundError(f"{self.run}: module '{module}' has no '{name}'.{here}{near}")
        made = getattr(loaded, name)
        if callable(made):
            try:
                with _in_the_same_folder():
                    made = made()
            except RAISED as error:
                raise_interrupt(error)
                raise SpecError(f"{self.run} cannot be made: {place_of(error)}") from error
        if not isinstance(made, RunConfig):
            raise SpecError(
                f"{self.run}: expected a RunConfig or a function that returns one, got a "
                f"{type(made).__name__}"
            )
        return _overridden(made, self.run, overrides)


def _makers_in(module: ModuleType) -> list[str]:
    """Returns the names of a module's own functions that may return a RunConfig."""
    return [
        name
        for name, value in vars(module).items()
        if inspect.isfunction(value)
        and value.__module__ == module.__name__
        and not name.startswith("_")
        and not any(
            parameter.default is parameter.empty and parameter.kind not in VARIADIC
            for parameter in inspect.signature(value).parameters.values()
        )
    ]


def require_utf8(path: str) -> None:
    """Raises ArgumentError for a path that is not UTF-8: files of datasets contain paths."""
    try:
        path.encode()
    except UnicodeEncodeError:
        shown = path.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
        raise ArgumentError(
            f"the path '{shown}' is not valid UTF-8, in which datasets and run files are written: "
            "rename it, or take another folder"
        ) from None


def _overridden(made: RunConfig, name: str, overrides: Sequence[str]) -> RunConfig:
    """Returns the configuration with replaced fields, which are read like those of files."""
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


@contextlib.contextmanager
def _naming_imports_of_runs() -> Iterator[None]:
    """Context manager: errors about an unknown kind also name `imports`, which only runs have."""
    try:
        yield
    except SpecError as error:
        text = str(error)
        named = text.replace(
            _WITH_IMPORT, f"{_WITH_IMPORT}, or in the run file: imports: [tasks.py]"
        )
        if named == text:
            raise
        raise SpecError(named) from None


def import_named(name: str, folder: Path) -> str:
    """Imports a module, or loads a shared library that registers kinds (`libstack.so`).

    Returns the module's name, "" for a library. Raises SpecError for a failed import.
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
    """Imports a module by its name or its file.

    Names are looked up as Python does, and in `folder`. Raises SpecError, with file and line, for
    errors in the module, and for names of Python's or robocell's own modules.
    """
    _require_name_of_ones_own(name)
    _require_importable(name, folder)
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
        raise_interrupt(error)
        raise SpecError(f"cannot import '{name}': {place_of(error)}") from error


def _in_the_same_folder() -> AbstractContextManager[None]:
    """Context manager: restores the working folder after a user's code."""
    return contextlib.chdir(Path.cwd())


def _require_name_of_ones_own(name: str) -> None:
    """Raises SpecError for a name whose module Python or robocell itself needs.

    A file with this name would break imports of the other module, far from here.
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


def _not_a_run(folder: str) -> str:
    """Returns why a run cannot be loaded from a folder, with the next step."""
    if (Path(folder) / "dataset.json").is_file():
        return (
            f"'{folder}' is a dataset. To continue it, name the run file that made it and the "
            f"same output: `robocell generate RUN.yaml --output {folder}`"
        )
    return f"'{folder}' is a folder; name a run file in it"


def _not_a_run_file(file: str) -> str:
    """Returns why a run cannot be loaded from a Python file alone, with the next step."""
    return (
        f"'{file}' is Python: write {file}:NAME, where NAME is a RunConfig in it or a function "
        f"that returns one; or write a run file (YAML) with `imports: [{Path(file).name}]`"
    )


def _no_file(path: Path) -> str:
    """Returns the message about a missing file, with the nearest one in its folder."""
    folder = path.parent
    start = f"cannot import '{path}': there is no such file"
    if not folder.is_dir():
        return f"{start}: there is no folder '{folder}'"
    files = sorted(file.name for file in folder.glob(f"*{path.suffix}") if file.is_file())
    if not files:
        return start
    near = did_you_mean(path.stem, [Path(file).stem for file in files])
    near = near.replace("'?", f"{path.suffix}'?")
    return f"{start}.{near or f' There are: {shortened(files)}'}"


def _modules_in(folder: Path) -> list[str]:
    """Returns the names of the modules in a folder."""
    return sorted(file.stem for file in folder.glob("*.py"))


def _require_importable(name: str, folder: Path) -> None:
    """Raises SpecError for a text that is neither a module's name nor a path to one."""
    if name.endswith(".py") or "/" in name:
        return  # `_import_file` checks these
    path = folder / name
    if all(part.isidentifier() for part in name.split(".")) and not (
        "." in name and path.is_file()
    ):
        return
    if path.is_dir():
        raise SpecError(f"cannot import '{name}': {_what_to_name(path)}")
    what = "no Python file" if path.is_file() else "no module's name"
    raise SpecError(
        f"cannot import '{name}': it is {what}; name a module (tasks) or its file (tasks.py)"
    )


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
