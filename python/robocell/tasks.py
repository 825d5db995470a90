"""Tasks, experts, scene sources and samplers of your own, known by a name.

They work in run files, environments and on all workers.

    @register_task("stack")
    class Stack(Task):
        @dataclass
        class Fields:
            size: float = 0.03  # m

        def __init__(self, fields): ...

    @register_expert("stack")
    class StackExpert(Expert):
        def __init__(self, run, start): ...

    @register_scene_source("lab")
    class Lab(SceneSource):
        def __init__(self): ...

    @register_sampler("on_the_floor")
    class OnTheFloor(TaskSampler):
        def __init__(self, run): ...

`task: {kind: stack, size: 0.04}` then works like `task: {kind: pick}`, `scenes: {source: lab}` like
`scenes: {source: tabletop}`, and `robocell generate run.yaml --import my_tasks` makes the dataset.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

from robocell._arguments import with_hints
from robocell._core import (
    ArgumentError,
    BasePlacement,
    BaseRange,
    EpisodeStart,
    Expert,
    PickAndPlacePlanner,
    PickAndPlaceTaskConfig,
    PickPlanner,
    PickTask,
    PickTaskConfig,
    PickTaskSampler,
    Refusal,
    RefusalReason,
    Rng,
    SampleRequest,
    SceneSource,
    StartConfig,
    Task,
    TaskFields,
    TaskSampler,
    TaskSetting,
    TaskVerdict,
    _register_expert,
    _register_sampler,
    _register_scene_source,
    _register_task,
    expert_kinds,
    object_kinds,
    sampler_kinds,
    task_kinds,
)
from robocell._own_code import calling_module, code_of
from robocell._registering import require_maker, require_name, require_takes

__all__ = [
    "BasePlacement",
    "BaseRange",
    "EpisodeStart",
    "Expert",
    "PickAndPlacePlanner",
    "PickAndPlaceTaskConfig",
    "PickPlanner",
    "PickTask",
    "PickTaskConfig",
    "PickTaskSampler",
    "Refusal",
    "RefusalReason",
    "Rng",
    "SampleRequest",
    "StartConfig",
    "Task",
    "TaskFields",
    "TaskSampler",
    "TaskSetting",
    "TaskVerdict",
    "expert_kinds",
    "object_kinds",
    "register_expert",
    "register_sampler",
    "register_task",
    "sampler_kinds",
    "task_kinds",
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
            numbers, texts, and lists of numbers or texts. Default: the class `Fields` inside the
            task's class; without one the task has no fields.

    The task is made as `cls(fields)`, or `cls()` without fields. Registering a name again replaces
    it, for example when a notebook's cell is run again. Replacing one of robocell's own kinds
    raises ArgumentError. A function that returns a Task may stand in place of the class.

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
        code = code_of(maker, registering=registering)
        with _naming_fields(call):
            _register_task(kind, _maker(maker, described), _defaults(call, described), code)
        return maker

    return register


@with_hints
def register_expert(
    kind: str, *, files: Sequence[str | Path] = ()
) -> Callable[[ExpertClass], ExpertClass]:
    """Registers a class as the expert that demonstrates the task of this kind.

    The expert is made as `cls(run, start)` for each rollout, from the RunConfig and the
    EpisodeStart. Registering a name again replaces it; replacing one of robocell's own raises
    ArgumentError. `files`: files that the expert uses beside its code, such as weights; a dataset
    records their content.
    """
    require_name("register_expert", kind)
    return expert_registration(kind, files, calling_module())


def expert_registration(
    kind: str, files: Sequence[str | Path], registering: str
) -> Callable[[ExpertClass], ExpertClass]:
    """Registers an expert as `register_expert` does, for the module that asks for it."""
    call = f"register_expert({kind!r})"

    def register(maker: ExpertClass) -> ExpertClass:
        require_maker(call, maker, Expert)
        require_takes(call, maker, ["run", "start"])
        _register_expert(kind, maker, code_of(maker, files, registering))
        return maker

    return register


@with_hints
def register_scene_source(
    kind: str, *, fields: type[Any] | None = None, files: Sequence[str | Path] = ()
) -> Callable[[SourceClass], SourceClass]:
    """Makes a class known as a kind of scene source, for `scenes: {source: ...}` of runs.

    It is made as `cls(fields)`, or `cls()` without fields, which are described as for
    `register_task`; `source` and `houses` are taken. A parameter `directory` gets the folder of the
    run file, where relative paths of the fields start ("" for a run made in Python).

    Registering a name again replaces it; robocell's own cannot be replaced (ArgumentError). `files`
    are what scenes are made from beside the code and the models, such as lists of places: a dataset
    remembers what they hold.
    """
    call = f"register_scene_source({kind!r})"
    registering = calling_module()
    require_name("register_scene_source", kind)

    def register(maker: SourceClass) -> SourceClass:
        require_maker(call, maker, SceneSource)
        described = fields if fields is not None else getattr(maker, "Fields", None)
        given, why = _given(described)
        require_takes(call, maker, given, why, ["directory"] if _takes_directory(maker) else [])
        defaults = _defaults(call, described, ("source", "houses"))
        code = code_of(maker, files, registering)
        with _naming_fields(call):
            _register_scene_source(kind, _source_maker(maker, described), defaults, code)
        return maker

    return register


@with_hints
def register_sampler(
    kind: str, *, files: Sequence[str | Path] = ()
) -> Callable[[SamplerClass], SamplerClass]:
    """Makes a class known as a kind of sampler, for `sampler: ...` of runs.

    It is made as `cls(run)` in each process, in the place of the sampler of the run's task.
    Registering a name again replaces it (ArgumentError for one of C++). `files` are what it acts
    from beside its code: a dataset remembers what they hold.
    """
    call = f"register_sampler({kind!r})"
    registering = calling_module()
    require_name("register_sampler", kind)

    def register(maker: SamplerClass) -> SamplerClass:
        require_maker(call, maker, TaskSampler)
        require_takes(call, maker, ["run"])
        _register_sampler(kind, maker, code_of(maker, files, registering))
        return maker

    return register


def _maker(maker: Callable[..., Any], fields: type[Any] | None) -> Callable[[dict[str, Any]], Any]:
    """What C++ calls with the values of the fields."""

    @functools.wraps(maker, assigned=(), updated=())  # messages say where the maker is written
    def make(values: dict[str, Any]) -> Any:
        return maker() if fields is None else maker(fields(**values))

    return make


def _source_maker(
    maker: Callable[..., Any], fields: type[Any] | None
) -> Callable[[dict[str, Any], str], Any]:
    """Like `_maker`, with the folder where relative paths start for those who take it."""
    if not _takes_directory(maker):
        make = _maker(maker, fields)
        return lambda values, _directory: make(values)
    return lambda values, directory: _maker(functools.partial(maker, directory=directory), fields)(
        values
    )


@contextlib.contextmanager
def _naming_fields(call: str) -> Iterator[None]:
    """Around a registration: errors of the core about defaults name the call and the field."""
    try:
        yield
    except (TypeError, ArgumentError) as error:
        said = str(error).replace("fields of a kind.", f"{call}: Fields.")
        raise type(error)(said) from None


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
) -> list[tuple[str, Any, str]]:
    """Name, default and documentation of each field; `taken` are names that it cannot have."""
    if fields is None:
        return []
    if not dataclasses.is_dataclass(fields):
        raise TypeError(f"{call}: `Fields` must be a dataclass, got {fields!r}")
    found: list[tuple[str, Any, str]] = []
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
        found.append((field.name, default, str(field.metadata.get("doc", ""))))
    return found
