"""What the register_* functions refuse when a module is imported, before any run."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import robocell as rc
from robocell.policy import Policy, register_named_policy, register_policy

REGISTERS: dict[str, Any] = {
    "register_task": rc.register_task,
    "register_expert": rc.register_expert,
    "register_scene_source": rc.register_scene_source,
    "register_sampler": rc.register_sampler,
    "register_feature": rc.register_feature,
}
BASES = {
    "register_task": ("rc.tasks.Task", "Task"),
    "register_expert": ("rc.tasks.Expert", "Expert"),
    "register_scene_source": ("rc.scenes.SceneSource", "SceneSource"),
    "register_sampler": ("rc.tasks.TaskSampler", "TaskSampler"),
}


class Push(rc.tasks.Task):
    """A task without fields."""


@pytest.mark.parametrize("function", REGISTERS)
def test_a_decorator_without_parentheses_is_refused(function: str):
    class TidyUp(rc.tasks.Task): ...

    with pytest.raises(rc.ArgumentError) as caught:
        REGISTERS[function](TidyUp)
    said = str(caught.value)
    assert said == f"{function} takes the name first: write @{function}('tidy_up') above TidyUp"
    with pytest.raises(rc.ArgumentError, match="must be a name that is not empty, got 3"):
        REGISTERS[function](3)


@pytest.mark.parametrize("function", BASES)
def test_a_class_of_something_else_is_refused(function: str):
    class Thing: ...

    home, base = BASES[function]
    with pytest.raises(TypeError) as caught:
        REGISTERS[function]("thing_of_test")(Thing)
    said = f"class Thing is not derived from {base}: write class Thing({home})"
    assert str(caught.value) == f"{function}('thing_of_test'): {said}"
    with pytest.raises(TypeError, match=f"expected a class derived from {base} or a function"):
        REGISTERS[function]("thing_of_test")("thing")
    assert "thing_of_test" not in rc.tasks.task_kinds()


@pytest.mark.parametrize("function", REGISTERS)
def test_a_misspelt_argument_has_the_nearest(function: str):
    wrong, right = {
        "register_task": ("field", "fields"),
        "register_scene_source": ("feilds", "fields"),
        "register_feature": ("units", "unit"),
    }.get(function, ("file", "files"))
    with pytest.raises(TypeError, match=rf"no argument '{wrong}'.* Did you mean '{right}'\?"):
        REGISTERS[function]("thing_of_test", **{wrong: ()})


@dataclass
class Size:
    size: float = 0.03


def task_without_fields(kind: str = "of_test") -> None:
    @rc.register_task(kind)
    class Stack(rc.tasks.Task):
        Fields = Size

        def __init__(self) -> None:
            super().__init__()


def task_without_init() -> None:
    @rc.register_task("of_test")
    class Stack(rc.tasks.Task):
        Fields = Size


def task_with_fields() -> None:
    @rc.register_task("of_test")
    class Stack(rc.tasks.Task):
        def __init__(self, fields: Any) -> None:
            super().__init__()


def expert_of_nothing() -> None:
    @rc.register_expert("of_test")
    class Stacker(rc.tasks.Expert):
        def __init__(self) -> None:
            super().__init__()


def source_without_fields() -> None:
    @rc.register_scene_source("of_test")
    class Lab(rc.scenes.SceneSource):
        Fields = Size

        def __init__(self, *, directory: str) -> None:
            super().__init__()


def sampler_of_start() -> None:
    @rc.register_sampler("of_test")
    def sampler(run: rc.RunConfig, start: Any) -> Any: ...


def feature_of_nothing() -> None:
    @rc.register_feature("of_test")
    def height() -> float:
        return 0.0


def policy_of_nothing() -> None:
    register_policy("of_test", lambda: Policy())


@pytest.mark.parametrize(
    ("register", "text"),
    [
        (task_without_fields, r"Stack is made as Stack\(fields\) with its Size, which does not fit"
            r" its arguments \(\).*: write def __init__\(self, fields\)"),
        (task_without_init, r"Stack is made as Stack\(fields\) with its Size, .*"
            r"write def __init__\(self, fields\)"),
        (task_with_fields, r"Stack is made as Stack\(\), without fields since it has no class "
            r"Fields, .* arguments \(fields: .*write def __init__\(self\)"),
        (expert_of_nothing, r"Stacker is made as Stacker\(run, start\), .*"
            r"write def __init__\(self, run, start\)"),
        (source_without_fields, r"Lab\(fields\).* write def __init__\(self, fields, directory\)"),
        (sampler_of_start, r"sampler is called as sampler\(run\), .*write def sampler\(run\)"),
        (feature_of_nothing, r"height is called as height\(scene\), .*write def height\(scene\)"),
        (policy_of_nothing, r"is called as <lambda>\(run\)"),
    ],
)  # fmt: skip
def test_what_cannot_be_made_of_its_arguments_is_refused(register: Callable[[], None], text: str):
    with pytest.raises(rc.ArgumentError, match=text):
        register()


def test_a_default_that_no_configuration_can_say_is_refused():
    @dataclass
    class Odd:
        size: Any = None

    text = r"register_task\('odd_of_test'\): Fields\.size must be a default that is a bool, .* None"
    with pytest.raises(TypeError, match=text):
        rc.register_task("odd_of_test", fields=Odd)(lambda fields: Push())


def test_classes_that_take_their_arguments_in_any_way_are_registered():
    @rc.register_task("any_of_test")
    class Any1(rc.tasks.Task):
        Fields = Size

        def __init__(self, *args: Any, **more: Any) -> None:
            super().__init__()

    rc.register_expert("any_of_test")(rc.tasks.PickPlanner)
    rc.register_task("any_of_test")(Push)
    rc.register_task("any_of_test", fields=Size)(lambda fields: Push())
    rc.register_sampler("any_of_test")(rc.tasks.PickTaskSampler)


def test_a_method_that_is_almost_one_of_the_base_is_warned_of():
    class Pushes(rc.tasks.Task):
        def begins(self, scene: rc.Scene) -> None: ...
        def why_not_donee(self) -> str:
            return ""

        def judge(self, scene: rc.Scene) -> Any:
            return self.judges(scene)

        def judges(self, scene: rc.Scene) -> Any:  # a helper: others use it
            return rc.tasks.TaskVerdict()

    with pytest.warns(UserWarning, match="nothing calls Pushes") as caught:
        rc.register_task("pushes_of_test")(Pushes)
    assert {str(warning.message) for warning in caught} == {
        "nothing calls Pushes.begins(): a Task has no such method. Did you mean begin()?",
        "nothing calls Pushes.why_not_donee(): a Task has no such method. "
        "Did you mean why_not_done()?",
    }
    assert {warning.filename for warning in caught} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error")

        @rc.register_task("pushes_of_test")
        class Whole(rc.tasks.Task):
            def begin(self, scene: rc.Scene) -> None: ...
            def begins(self, scene: rc.Scene) -> None: ...
            def measure(self) -> None: ...


@pytest.mark.parametrize(
    "unit",
    ["", "m", "1", "rad/s", "N m", "m, 1", "m/s^2", "kg m^2/s", "%", "mm", "deg", "N*m", "m²"],
)
def test_units_of_known_symbols_are_taken(unit: str):
    rc.register_feature("unit_of_test", unit=unit)(lambda scene: 0.0)


@pytest.mark.parametrize(
    ("unit", "near"),
    [("metres", "m"), ("radians", "rad"), ("meters/second", "m"), ("Rad", "rad"), ("Nm", "N m")],
)
def test_a_unit_of_unknown_words_is_refused(unit: str, near: str):
    with pytest.raises(rc.ArgumentError, match=rf"no known symbol .* Did you mean '{near}'\?"):
        rc.register_feature("unit_of_test", unit=unit)


@pytest.mark.parametrize(
    "frame", ["", "world", "base of rc7", "TCP of rc7", "body 'cup'", "shared base frame"]
)
def test_frames_as_robocell_names_them_are_taken(frame: str):
    rc.register_feature("frame_of_test", frame=frame)(lambda scene: 0.0)


def test_a_frame_that_nobody_knows_is_refused():
    with pytest.raises(rc.ArgumentError, match=r"no frame 'wrold'. Did you mean 'world'\? Frames"):
        rc.register_feature("frame_of_test", frame="wrold")
    with pytest.raises(rc.ArgumentError, match=r"no frame 'cup'\. Frames are such as"):
        rc.register_feature("frame_of_test", frame="cup")


def test_a_policy_that_takes_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sys.path", [str(tmp_path)])
    (tmp_path / "takes_of_test.py").write_text(
        "class Clone:\n    def __init__(self, weights, size): ...\n"
    )
    with pytest.raises(rc.SpecError, match=r"made as Clone\(\) or Clone\(run\), which does not"):
        register_named_policy("takes_of_test.py:Clone", tmp_path)
    with pytest.raises(rc.SpecError, match=r"no class or function 'Cone'. Did you mean 'Clone'\?"):
        register_named_policy("takes_of_test.py:Cone", tmp_path)
