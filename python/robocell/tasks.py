"""Your own tasks, experts, scene sources and samplers, registered by name.

They work in run files, environments and on all workers.

    @register_task("sort")
    class Sort(Task):
        @dataclass
        class Fields:
            size: float = 0.03  # m

        def __init__(self, fields): ...

    @register_expert("sort")
    class SortExpert(Expert):
        def __init__(self, run, start): ...

    @register_scene_source("lab")
    class Lab(SceneSource):
        def __init__(self): ...

    @register_sampler("on_the_floor")
    class OnTheFloor(TaskSampler):
        def __init__(self, run): ...

`task: {kind: sort, size: 0.04}` then works like `task: {kind: pick}`, `scenes: {source: lab}` like
`scenes: {source: tabletop}`, and `robocell generate run.yaml --import my_tasks` makes the dataset.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import inspect
import math
import numbers
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

from robocell._arguments import with_hints
from robocell._core import (
    ArgumentError,
    BasePlacement,
    BaseRange,
    CameraSight,
    CarryTaskConfig,
    CloseTaskConfig,
    EpisodeStart,
    Expert,
    Grasp,
    GraspProof,
    GraspSet,
    HandoverTaskConfig,
    InsertTaskConfig,
    NavigateTaskConfig,
    OpenTaskConfig,
    PickAndPlacePlanner,
    PickAndPlaceTaskConfig,
    PickPlanner,
    PickTask,
    PickTaskConfig,
    PlaceNextToTaskConfig,
    PourTaskConfig,
    PressTaskConfig,
    PushTaskConfig,
    RandomClutter,
    RandomDynamics,
    RandomizeConfig,
    RandomizedValue,
    RandomizeEvery,
    RandomLights,
    RandomLook,
    RandomNumber,
    RandomProperty,
    ReachableGrasp,
    Refusal,
    RefusalReason,
    RelationsTaskConfig,
    Rng,
    SampleRequest,
    SceneSource,
    SortTaskConfig,
    StackTaskConfig,
    StartCamera,
    StartConfig,
    StartSampler,
    StartTurn,
    Task,
    TaskFields,
    TaskSampler,
    TaskSetting,
    TaskVerdict,
    WipeTaskConfig,
    _register_expert,
    _register_sampler,
    _register_scene_source,
    _register_task,
    check_grasps,
    default_object_kinds,
    expert_kinds,
    grasp_libraries,
    grasps,
    load_grasps,
    make_object,
    object_categories,
    object_info,
    object_kinds,
    object_kinds_of,
    register_grasp_library,
    relation_holds,
    relation_poses,
    relations,
    sampler_kinds,
    task_kinds,
    unregister_grasp_library,
)
from robocell._own_code import calling_module, code_of, paths_of
from robocell._registering import (
    note_registered,
    require_hooks,
    require_maker,
    require_methods,
    require_name,
    require_takes,
)

__all__ = [
    "BasePlacement",
    "BaseRange",
    "CameraSight",
    "CarryTaskConfig",
    "CloseTaskConfig",
    "EpisodeStart",
    "Expert",
    "Grasp",
    "GraspProof",
    "GraspSet",
    "HandoverTaskConfig",
    "InsertTaskConfig",
    "NavigateTaskConfig",
    "OpenTaskConfig",
    "PickAndPlacePlanner",
    "PickAndPlaceTaskConfig",
    "PickPlanner",
    "PickTask",
    "PickTaskConfig",
    "PlaceNextToTaskConfig",
    "PourTaskConfig",
    "PressTaskConfig",
    "PushTaskConfig",
    "RandomClutter",
    "RandomDynamics",
    "RandomLights",
    "RandomLook",
    "RandomNumber",
    "RandomProperty",
    "RandomizeConfig",
    "RandomizeEvery",
    "RandomizedValue",
    "ReachableGrasp",
    "Refusal",
    "RefusalReason",
    "RelationsTaskConfig",
    "Rng",
    "SampleRequest",
    "SortTaskConfig",
    "StackTaskConfig",
    "StartCamera",
    "StartConfig",
    "StartSampler",
    "StartTurn",
    "Task",
    "TaskFields",
    "TaskSampler",
    "TaskSetting",
    "TaskVerdict",
    "WipeTaskConfig",
    "check_grasps",
    "default_object_kinds",
    "expert_kinds",
    "grasp_libraries",
    "grasps",
    "load_grasps",
    "make_object",
    "object_categories",
    "object_info",
    "object_kinds",
    "object_kinds_of",
    "register_expert",
    "register_grasp_library",
    "register_sampler",
    "register_task",
    "relation_holds",
    "relation_poses",
    "relations",
    "sampler_kinds",
    "task_kinds",
    "unregister_grasp_library",
]

# The methods that the base classes do not have, and that runs and environments call.
_OF_A_TASK = ["judge(self, scene)", "instruction(self)"]
_OF_A_TASK_IN_PARTS = ["reward(self, scene)", "success(self, scene)", "instruction(self)"]
_OF_AN_EXPERT = [
    "begin(self, scene, rng)",
    "act(self, scene, rng)",
    "done(self)",
    "failure(self)",
    "phase(self)",
    "phase_names(self)",
]

TaskClass = TypeVar("TaskClass", bound=Callable[..., Task])
ExpertClass = TypeVar("ExpertClass", bound=Callable[..., Expert])
SourceClass = TypeVar("SourceClass", bound=Callable[..., SceneSource])
SamplerClass = TypeVar("SamplerClass", bound=Callable[..., TaskSampler])


@with_hints
def register_task(
    kind: str, *, fields: type[Any] | None = None
) -> Callable[[TaskClass], TaskClass]:
    """Registers a class as a kind of task, for run files and environments of this process.

    Args:
        kind: Name of the task in `task: {kind: ...}`.
        fields: A dataclass whose fields, all with defaults, the configuration may set: bools,
            finite numbers, texts, and lists of numbers or texts. Default: the class `Fields` inside
            the task's class; without one the task has no fields.

    The task is made as `cls(fields)`, or `cls()` without fields. Registering a name again replaces
    it, for example when a notebook's cell is run again. Replacing one of robocell's own kinds
    raises ArgumentError. A function that returns a Task may stand in place of the class. A class
    without the methods that a Task must define raises TypeError, which lists them.

    Examples:
        >>> @rc.register_task("lift_it")
        ... class Lift(rc.tasks.Task):
        ...     def instruction(self):
        ...         return "lift the cube"
        ...     def judge(self, scene):
        ...         height = scene.body_pose("cube").translation[2]
        ...         return rc.tasks.TaskVerdict(reward=height, success=height > 0.1)
        >>> "lift_it" in rc.tasks.task_kinds()
        True
    """
    call = f"register_task({kind!r})"
    registering = calling_module()
    require_name("register_task", kind)

    def register(maker: TaskClass) -> TaskClass:
        require_maker(call, maker, Task)
        described = fields if fields is not None else getattr(maker, "Fields", None)
        require_takes(call, maker, *_given(described))
        require_methods(call, maker, Task, _OF_A_TASK, _OF_A_TASK_IN_PARTS)
        _require_hooks_of_class(call, maker, Task)
        code = code_of(maker, registering=registering)
        defaults = _defaults(call, described)
        with _naming_fields(call):
            make = _checked(call, _maker(f"task {kind!r}", maker, described), Task)
            _register_task(kind, make, defaults, code)
        note_registered("task", kind, registering)
        return maker

    return register


@with_hints
def register_expert(
    kind: str, *, files: str | Path | Sequence[str | Path] = ()
) -> Callable[[ExpertClass], ExpertClass]:
    """Registers a class as the expert that demonstrates the task of this kind.

    The expert is made as `cls(run, start)` for each rollout, from the RunConfig and the
    EpisodeStart. Registering a name again replaces it; replacing a built-in one raises
    ArgumentError. A class without the methods that an Expert must define raises TypeError, which
    lists them. `files`: files or folders that the expert uses beside its code, such as weights,
    relative to the module; a dataset records their content.
    """
    require_name("register_expert", kind)
    return expert_registration(kind, files, calling_module())


def expert_registration(
    kind: str, files: str | Path | Sequence[str | Path], registering: str
) -> Callable[[ExpertClass], ExpertClass]:
    """Registers an expert as `register_expert` does, for the module `registering`."""
    call = f"register_expert({kind!r})"
    paths = paths_of(call, files, registering)

    def register(maker: ExpertClass) -> ExpertClass:
        require_maker(call, maker, Expert)
        require_takes(call, maker, ["run", "start"])
        require_methods(call, maker, Expert, _OF_AN_EXPERT)
        _require_hooks_of_class(call, maker, Expert)
        code = code_of(maker, paths, registering)
        _register_expert(kind, _checked(call, maker, Expert), code)
        note_registered("expert", kind, registering)
        return maker

    return register


@with_hints
def register_scene_source(
    kind: str, *, fields: type[Any] | None = None, files: str | Path | Sequence[str | Path] = ()
) -> Callable[[SourceClass], SourceClass]:
    """Registers a class as a kind of scene source, for `scenes: {source: ...}` of runs.

    It is created as `cls(fields)`, or `cls()` without fields. Fields are described as for
    `register_task`; `source` and `houses` are reserved. A parameter `directory` gets the folder of
    the run file, where relative paths of the fields start ("" for a run made in Python).

    Registering a name again replaces it; replacing a built-in one raises ArgumentError. `files`:
    files or folders for making scenes, beside the code and the models, such as lists of positions,
    relative to the module; a dataset records their content.
    """
    call = f"register_scene_source({kind!r})"
    registering = calling_module()
    require_name("register_scene_source", kind)
    paths = paths_of(call, files, registering)

    def register(maker: SourceClass) -> SourceClass:
        require_maker(call, maker, SceneSource)
        described = fields if fields is not None else getattr(maker, "Fields", None)
        given, why = _given(described)
        require_takes(call, maker, given, why, ["directory"] if _takes_directory(maker) else [])
        _require_hooks_of_class(call, maker, SceneSource)
        defaults = _defaults(call, described, ("source", "houses"))
        code = code_of(maker, paths, registering)
        with _naming_fields(call):
            source = _source_maker(f"scene source {kind!r}", maker, described)
            make = _checked(call, source, SceneSource)
            _register_scene_source(kind, make, defaults, code)
        note_registered("scene source", kind, registering)
        return maker

    return register


@with_hints
def register_sampler(
    kind: str, *, files: str | Path | Sequence[str | Path] = ()
) -> Callable[[SamplerClass], SamplerClass]:
    """Registers a class as a kind of sampler, for `sampler: ...` of runs.

    Each process creates it as `cls(run)`. It replaces the sampler of the run's task. Registering a
    name again replaces it; replacing one from C++ raises ArgumentError. `files`: files or folders
    that it uses beside its code, relative to the module; a dataset records their content.
    """
    call = f"register_sampler({kind!r})"
    registering = calling_module()
    require_name("register_sampler", kind)
    paths = paths_of(call, files, registering)

    def register(maker: SamplerClass) -> SamplerClass:
        require_maker(call, maker, TaskSampler)
        require_takes(call, maker, ["run"])
        _require_hooks_of_class(call, maker, TaskSampler)
        code = code_of(maker, paths, registering)
        _register_sampler(kind, _checked(call, maker, TaskSampler), code)
        note_registered("sampler", kind, registering)
        return maker

    return register


def _require_hooks_of_class(call: str, maker: object, base: type) -> None:
    """Checks the hooks of a class; those of what a function makes are checked when it is made."""
    if inspect.isclass(maker):
        require_hooks(call, maker, base)


def _checked(call: str, make: Callable[..., Any], base: type) -> Callable[..., Any]:
    """Returns the factory, which also checks what it made: an attribute may hide a method."""

    @functools.wraps(make, assigned=(), updated=())  # messages say where the maker is written
    def checked(*given: Any) -> Any:
        made = make(*given)
        if isinstance(made, base):  # the core rejects anything else
            require_hooks(call, made, base)
        return made

    return checked


def _maker(
    of: str, maker: Callable[..., Any], fields: type[Any] | None
) -> Callable[[dict[str, Any]], Any]:
    """Returns the factory that C++ calls with the values of the fields of `of`, "task 'stack'"."""
    if fields is None:

        @functools.wraps(maker, assigned=(), updated=())  # messages say where the maker is written
        def make_without(values: dict[str, Any]) -> Any:
            _require_fields(of, values, [])
            return maker()

        return make_without
    names = [field.name for field in dataclasses.fields(fields)]
    whole = [name for name, hint in _hints(fields).items() if hint in (list[int], Sequence[int])]

    @functools.wraps(maker, assigned=(), updated=())
    def make(values: dict[str, Any]) -> Any:
        _require_fields(of, values, names)
        lists = {name: _whole_numbers(of, name, values[name]) for name in whole}
        return maker(fields(**{**values, **lists}))

    return make


def _require_fields(of: str, values: dict[str, Any], names: Sequence[str]) -> None:
    """Raises ArgumentError for the values of a configuration that is older than the kind."""
    if values.keys() == set(names):
        return
    before, now = (", ".join(map(repr, each)) or "none" for each in (values, names))
    raise ArgumentError(
        f"{of} was registered again with other fields than this configuration has: {before} "
        f"before, {now} now. Make the configuration again"
    )


def _whole_numbers(of: str, name: str, values: Sequence[float]) -> list[int]:
    if odd := [value for value in values if value != int(value)]:
        raise ArgumentError(f"{of}: '{name}' takes whole numbers, got {odd[0]:g}")
    return [int(value) for value in values]


def _hints(fields: type[Any]) -> dict[str, Any]:
    """Returns the types of the fields; none if they cannot be looked up."""
    try:
        return get_type_hints(fields)
    except Exception:  # of names that exist only for type checkers
        return {}


def _source_maker(
    of: str, maker: Callable[..., Any], fields: type[Any] | None
) -> Callable[[dict[str, Any], str], Any]:
    """Works like `_maker`, and passes the folder of relative paths to classes that take it."""
    if not _takes_directory(maker):
        make = _maker(of, maker, fields)
        return lambda values, _directory: make(values)
    return lambda values, directory: _maker(
        of, functools.partial(maker, directory=directory), fields
    )(values)


@contextlib.contextmanager
def _naming_fields(call: str) -> Iterator[None]:
    """Context manager: adds call and field to the core's errors about defaults."""
    try:
        yield
    except (TypeError, ArgumentError) as error:
        text = str(error).replace("fields of a kind.", f"{call}: Fields.")
        raise type(error)(text) from None


def _takes_directory(maker: Callable[..., Any]) -> bool:
    try:
        return "directory" in inspect.signature(maker).parameters
    except (TypeError, ValueError):  # of a callable that has no signature
        return False


def _given(fields: type[Any] | None) -> tuple[list[str], str]:
    """Returns the arguments that a maker gets, and why."""
    if fields is None:
        return [], ", without fields since it has no class Fields"
    return ["fields"], f" with its {getattr(fields, '__name__', 'Fields')}"


def _defaults(
    call: str, fields: type[Any] | None, taken: Sequence[str] = ("kind",)
) -> list[tuple[str, Any, str, bool]]:
    """Returns name, default, documentation and whether it holds texts, of each field.

    Rejects `taken` names.
    """
    if fields is None:
        return []
    if not dataclasses.is_dataclass(fields):
        raise TypeError(f"{call}: `Fields` must be a dataclass, got {fields!r}")
    found: list[tuple[str, Any, str, bool]] = []
    hints = _hints(fields)
    for field in dataclasses.fields(fields):
        if field.name in taken:
            raise ArgumentError(
                f"{call}: a field cannot be called '{field.name}', which has a meaning already"
            )
        if field.default is not dataclasses.MISSING:
            default = field.default
        elif field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        else:
            raise ArgumentError(
                f"{call}: field '{field.name}' needs a default: a configuration may leave it out"
            )
        if hints.get(field.name) is float and _is_whole(default):
            default = float(default)
        _require_finite(call, field.name, default)
        doc = str(field.metadata.get("doc", ""))
        found.append((field.name, default, doc, str in get_args(hints.get(field.name))))
    return found


def _is_whole(value: Any) -> bool:
    return isinstance(value, numbers.Integral) and not isinstance(value, bool)


def _require_finite(call: str, name: str, default: Any) -> None:
    """Raises ArgumentError for a default that no run file could contain."""
    for value in default if isinstance(default, list | tuple) else [default]:
        if isinstance(value, numbers.Real) and not math.isfinite(value):
            raise ArgumentError(
                f"{call}: the default of field '{name}' must be finite, got {default!r}; take a "
                "large number, or another field that says so"
            )
