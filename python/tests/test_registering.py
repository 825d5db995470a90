"""What the register_* functions refuse when a module is imported, before any run."""

from __future__ import annotations

import functools
import importlib
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import robocell as rc
from robocell.gym import pick_cube_config
from robocell.policy import Policy, maker_of_policy, register_named_policy, register_policy

REGISTERS: dict[str, Any] = {
    "register_task": rc.register_task,
    "register_expert": rc.tasks.register_expert,
    "register_scene_source": rc.scenes.register_scene_source,
    "register_sampler": rc.tasks.register_sampler,
    "register_feature": rc.features.register_feature,
}
BASES = {
    "register_task": ("rc.tasks.Task", "Task"),
    "register_expert": ("rc.tasks.Expert", "Expert"),
    "register_scene_source": ("rc.scenes.SceneSource", "SceneSource"),
    "register_sampler": ("rc.tasks.TaskSampler", "TaskSampler"),
}


class Push(rc.tasks.Task):
    """A task without fields."""

    def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
        return rc.tasks.TaskVerdict()

    def instruction(self) -> str:
        return "push"


@pytest.mark.parametrize("function", REGISTERS)
def test_rejects_a_decorator_without_parentheses(function: str):
    class TidyUp(rc.tasks.Task): ...

    with pytest.raises(rc.ArgumentError) as caught:
        REGISTERS[function](TidyUp)
    said = str(caught.value)
    assert said == f"{function} takes the name first: write @{function}('tidy_up') above TidyUp"
    with pytest.raises(rc.ArgumentError, match="must be a name that is not empty, got 3"):
        REGISTERS[function](3)


@pytest.mark.parametrize("function", BASES)
def test_rejects_an_unrelated_class(function: str):
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
        "register_feature": ("unit", "units"),
    }.get(function, ("file", "files"))
    with pytest.raises(TypeError, match=rf"no argument '{wrong}'.* Did you mean '{right}'\?"):
        REGISTERS[function]("thing_of_test", **{wrong: ()})


@dataclass
class Size:
    size: float = 0.03


@dataclass
class Words:
    words: list[str] = field(default_factory=list)
    more: tuple[str, ...] = ()
    numbers: list[float] = field(default_factory=list)


def test_an_empty_list_has_the_type_of_its_hint():
    @rc.register_task("words_of_test")
    class Spell(rc.tasks.Task):
        Fields = Words

        def __init__(self, fields: Words) -> None:
            super().__init__()

        def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
            return rc.tasks.TaskVerdict()

        def instruction(self) -> str:
            return "spell"

    config = rc.EnvConfig.load(rc.models.cell_file("rc7"))
    config.task = {"kind": "words_of_test", "words": ["red", "blue"], "more": ["on"]}
    assert list(config.task.words) == ["red", "blue"]
    config.task.more = ["off"]
    config.task.numbers = [1, 2.5]
    with pytest.raises(TypeError, match="words"):
        config.task.words = [1, 2]


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
    @rc.tasks.register_expert("of_test")
    class Stacker(rc.tasks.Expert):
        def __init__(self) -> None:
            super().__init__()


def source_without_fields() -> None:
    @rc.scenes.register_scene_source("of_test")
    class Lab(rc.scenes.SceneSource):
        Fields = Size

        def __init__(self, *, directory: str) -> None:
            super().__init__()


def sampler_of_start() -> None:
    @rc.tasks.register_sampler("of_test")
    def sampler(run: rc.RunConfig, start: Any) -> Any: ...


def feature_of_nothing() -> None:
    @rc.features.register_feature("of_test")
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
def test_rejects_classes_that_cannot_be_constructed(register: Callable[[], None], text: str):
    with pytest.raises(rc.ArgumentError, match=text):
        register()


def test_rejects_a_default_of_an_unsupported_type():
    @dataclass
    class Odd:
        size: Any = None

    text = r"register_task\('odd_of_test'\): Fields\.size must be a default that is a bool, .* None"
    with pytest.raises(TypeError, match=text):
        rc.register_task("odd_of_test", fields=Odd)(lambda fields: Push())


def config_of(kind: str, more: str = "") -> rc.RunConfig:
    robot = rc.models.robot_file("rc7")
    text = f"run: a\nrobot: {robot}\ntask: {{kind: {kind}{more}}}\nscenes: {{source: tabletop}}\n"
    return rc.RunConfig.from_yaml(text + "output: out\n", "run.yaml", "/")


class Pushed(Push):
    made: ClassVar[list[Any]] = []

    def __init__(self, fields: Any) -> None:
        super().__init__()
        self.made.append(fields)


def test_the_types_of_fields_count():
    @dataclass
    class Typed:
        size: float = 1
        counts: list[int] = field(default_factory=lambda: [1, 2])

    rc.register_task("typed_of_test", fields=Typed)(Pushed)
    run = config_of("typed_of_test", ", size: 1.5, counts: [3, 4]")
    assert run.task.size == 1.5
    rc.envs.RunEnv(run).reset(0)
    assert Pushed.made[-1] == Typed(1.5, [3, 4])
    assert all(isinstance(count, int) for count in Pushed.made[-1].counts)
    with pytest.raises(rc.ArgumentError, match=r"'counts' takes whole numbers, got 1\.5"):
        rc.envs.RunEnv(config_of("typed_of_test", ", counts: [1.5]")).reset(0)


@pytest.mark.parametrize("default", [math.inf, math.nan, [1.0, -math.inf]])
def test_rejects_a_default_that_is_not_finite(default: Any):
    @dataclass
    class Endless:
        size: Any = field(default_factory=lambda: default)

    text = r"register_task\('odd_of_test'\): the default of field 'size' must be finite, got .*"
    with pytest.raises(rc.ArgumentError, match=text):
        rc.register_task("odd_of_test", fields=Endless)(lambda fields: Push())


def test_fields_that_are_no_dataclass_are_named():
    class Plain:
        size = 0.03

    text = r"register_task\('plain_of_test'\): `Fields` must be a dataclass, got .*Plain"
    with pytest.raises(TypeError, match=text):
        rc.register_task("plain_of_test", fields=Plain)(lambda fields: Push())


MAKERS = """
from robocell.policy import Policy

class Weights(Policy):
    def __init__(self, weights="bell.pkl"):
        self.given = weights
    def act(self, observation):
        return {}

class Options(Weights):
    def __init__(self, **options):
        self.given = options

class OfRun(Weights):
    def __init__(self, run=None):
        self.given = run

class Needs(Weights):
    def __init__(self, config):
        self.given = config
"""


@pytest.mark.parametrize(
    ("made", "given"),
    [("Weights", "bell.pkl"), ("Options", {}), ("OfRun", "run"), ("Needs", "run")],
)
def test_a_policy_gets_the_run_where_it_is_meant(made: str, given: Any, tmp_path: Path):
    module = f"makers_of_{made.lower()}.py"
    (tmp_path / module).write_text(MAKERS)
    make, _ = maker_of_policy(f"{module}:{made}", tmp_path)
    run = rc.RunConfig()
    policy: Any = make(run)
    assert policy.given is run if given == "run" else policy.given == given


def test_a_configuration_that_is_older_than_its_kind_is_named():
    rc.register_task("older_of_test", fields=Size)(Pushed)
    run = config_of("older_of_test")

    @dataclass
    class Sizes:
        sizes: tuple[float, ...] = (0.03,)

    rc.register_task("older_of_test", fields=Sizes)(Pushed)
    said = "'older_of_test' was registered again .*: 'size' before, 'sizes' now. Make the config"
    with pytest.raises(rc.ArgumentError, match=said):
        rc.envs.RunEnv(run).reset(0)
    rc.register_task("older_of_test")(Push)
    with pytest.raises(rc.ArgumentError, match="'size' before, none now"):
        rc.envs.RunEnv(run).reset(0)


def test_classes_with_any_signature_are_registered():
    @rc.register_task("any_of_test")
    class Any1(Push):
        Fields = Size

        def __init__(self, *args: Any, **more: Any) -> None:
            super().__init__()

    rc.tasks.register_expert("any_of_test")(rc.tasks.PickPlanner)
    rc.register_task("any_of_test")(Push)
    rc.register_task("any_of_test", fields=Size)(lambda fields: Push())
    rc.tasks.register_sampler("any_of_test")(rc.tasks.StartSampler)
    for kinds in (rc.tasks.task_kinds, rc.tasks.expert_kinds, rc.tasks.sampler_kinds):
        assert kinds().count("any_of_test") == 1, kinds


class HalfAnExpert(rc.tasks.Expert):
    def __init__(self, run: rc.RunConfig, start: rc.tasks.EpisodeStart) -> None:
        super().__init__()

    def begin(self, scene: rc.Scene, rng: rc.tasks.Rng) -> None: ...

    def done(self) -> bool:
        return True


class Speechless(rc.tasks.Task):
    def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
        return rc.tasks.TaskVerdict()


class OnlyRewarded(rc.tasks.Task):
    def reward(self, scene: rc.Scene) -> float:
        return 0


@pytest.mark.parametrize(
    ("function", "made", "lacks"),
    [
        ("register_expert", HalfAnExpert, ["act(self, scene, rng)", "failure(self)", "phase(self)",
            "phase_names(self)"]),
        ("register_task", type("Empty", (rc.tasks.Task,), {}),
            ["judge(self, scene)", "instruction(self)"]),
        ("register_task", Speechless, ["instruction(self)"]),
        ("register_task", OnlyRewarded, ["success(self, scene)", "instruction(self)"]),
    ],
)  # fmt: skip
def test_rejects_a_class_that_lacks_methods_and_lists_them_all(
    function: str, made: type, lacks: list[str]
):
    with pytest.raises(TypeError) as caught:
        REGISTERS[function]("lacking_of_test")(made)
    article, base = ("an", "Expert") if function == "register_expert" else ("a", "Task")
    added = ", ".join(f"def {method}" for method in lacks)
    assert str(caught.value) == (
        f"{function}('lacking_of_test'): class {made.__name__} lacks methods that {article} {base} "
        f"must define: add {added}"
    )
    assert "lacking_of_test" not in rc.tasks.task_kinds()


def test_inherited_methods_count_as_defined():
    class Judging:
        def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
            return rc.tasks.TaskVerdict()

    class Mixed(Judging, rc.tasks.Task):
        def instruction(self) -> str:
            return "mixed"

    class InParts(OnlyRewarded):
        def success(self, scene: rc.Scene) -> bool:
            return False

        def instruction(self) -> str:
            return "in parts"

    class Picks(rc.tasks.PickPlanner): ...

    rc.register_task("mixed_of_test")(Mixed)
    rc.register_task("in_parts_of_test")(InParts)
    rc.tasks.register_expert("picks_of_test")(Picks)
    assert {"mixed_of_test", "in_parts_of_test"} <= set(rc.tasks.task_kinds())
    assert "picks_of_test" in rc.tasks.expert_kinds()
    for kind, instruction in (("mixed_of_test", "mixed"), ("in_parts_of_test", "in parts")):
        env = rc.Env(pick_cube_config(task={"kind": kind}))
        env.reset(seed=0)
        assert env.instruction == instruction
        env.close()


def test_warns_about_a_misspelt_method_name():
    class Pushes(rc.tasks.Task):
        def begins(self, scene: rc.Scene) -> None: ...
        def why_not_donee(self) -> str:
            return ""

        def judge(self, scene: rc.Scene) -> Any:
            return self.judges(scene)

        def judges(self, scene: rc.Scene) -> Any:  # a helper: others use it
            return rc.tasks.TaskVerdict()

        def instruction(self) -> str:
            return "push"

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
        class Whole(Push):
            def begin(self, scene: rc.Scene) -> None: ...
            def begins(self, scene: rc.Scene) -> None: ...
            def measure(self) -> None: ...


def feature_in_a_cell(name: str) -> rc.features.Feature:
    """The description of a registered feature in an environment's schema."""
    env = rc.Env(pick_cube_config(features=[name]))
    (feature,) = [each for each in env.observed if each.name.endswith(name)]
    env.close()
    return feature


@pytest.mark.parametrize(
    "unit",
    ["", "m", "1", "rad/s", "N m", "m, 1", "m/s^2", "kg m^2/s", "%", "mm", "deg", "N*m", "m²"],
)
def test_accepts_units_of_known_symbols(unit: str):
    rc.features.register_feature("unit_of_test", units=unit)(lambda scene: 0.0)
    assert feature_in_a_cell("unit_of_test").units == unit


@pytest.mark.parametrize(
    ("unit", "near"),
    [("metres", "m"), ("radians", "rad"), ("meters/second", "m"), ("Rad", "rad"), ("Nm", "N m")],
)
def test_rejects_an_unknown_unit(unit: str, near: str):
    with pytest.raises(rc.ArgumentError, match=rf"no known symbol .* Did you mean '{near}'\?"):
        rc.features.register_feature("unit_of_test", units=unit)


@pytest.mark.parametrize(
    "frame",
    ["", "world", "base of robot", "TCP of robot", "body 'cube_green_cube'", "shared base frame"],
)
def test_accepts_frames_of_robocell(frame: str):
    rc.features.register_feature("frame_of_test", frame=frame)(lambda scene: 0.0)
    assert feature_in_a_cell("frame_of_test").frame == frame


def test_rejects_an_unknown_frame():
    with pytest.raises(rc.ArgumentError, match=r"no frame 'wrold'. Did you mean 'world'\? Frames"):
        rc.features.register_feature("frame_of_test", frame="wrold")
    with pytest.raises(rc.ArgumentError, match=r"no frame 'cup'\. Frames are such as"):
        rc.features.register_feature("frame_of_test", frame="cup")


def test_rejects_a_policy_with_required_arguments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "takes_of_test.py").write_text(
        "class Clone:\n    def __init__(self, weights, size): ...\n"
    )
    with pytest.raises(rc.SpecError, match=r"made as Clone\(\) or Clone\(run\), which does not"):
        register_named_policy("takes_of_test.py:Clone", tmp_path)
    with pytest.raises(
        rc.SpecError, match=r"no class or function 'Cone'. Did you mean 'Clone'\? It has: Clone"
    ):
        register_named_policy("takes_of_test.py:Cone", tmp_path)


def test_warns_when_a_module_replaces_the_kind_of_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.syspath_prepend(tmp_path)
    text = (
        "import robocell as rc\nrc.features.register_feature('twice_of_test')(lambda scene: 0.0)\n"
    )
    for name in ("first_of_test", "second_of_test"):
        (tmp_path / f"{name}.py").write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        first = importlib.import_module("first_of_test")
        importlib.reload(first)
    with pytest.warns(UserWarning, match="feature 'twice_of_test' of '.*first_of_test.py' is") as w:
        importlib.import_module("second_of_test")
    assert [warning.filename for warning in w] == [str(tmp_path / "second_of_test.py")]
    assert f"replaced by that of '{tmp_path / 'second_of_test.py'}'" in str(w[0].message)


def judging_nothing() -> type:
    class Press(Push):
        def judge(self) -> Any: ...  # type: ignore[override]

    return Press


def beginning_without_rng() -> type:
    class Presser(rc.tasks.PickPlanner):
        def begin(self, scene: rc.Scene) -> None: ...  # type: ignore[override]

    return Presser


def sampling_with_more() -> type:
    class Places(rc.tasks.TaskSampler):
        def __init__(self, run: rc.RunConfig) -> None:
            super().__init__()

        def sample(self, request: Any, rng: Any, scene: Any) -> Any: ...

    return Places


def making_by_name() -> type:
    class Lab(rc.scenes.SceneSource):
        def make(self, *, index: int) -> Any: ...  # type: ignore[override]

    return Lab


def static_judge() -> type:
    class Press(Push):
        @staticmethod
        def judge(self: Any, scene: Any) -> Any: ...  # type: ignore[override]

    return Press


def objects_of_a_property() -> type:
    class Press(Push):
        @property
        def objects(self) -> list[str]:  # type: ignore[override]
            return ["button"]

    return Press


def objects_of_a_list() -> type:
    class Press(Push):
        objects = ("button",)  # type: ignore[assignment]

    return Press


@pytest.mark.parametrize(
    ("function", "made", "text"),
    [
        ("register_task", judging_nothing, r"Press\.judge \(line \d+\) is called as judge\(scene\),"
            r" which does not fit its arguments \(self\).*: write def judge\(self, scene\)"),
        ("register_expert", beginning_without_rng, r"begin\(scene, rng\).* \(self, scene.*: write "
            r"def begin\(self, scene, rng\)"),
        ("register_sampler", sampling_with_more, r"sample\(request, rng\), which does not fit"),
        ("register_scene_source", making_by_name, r"make\(index\).*write def make\(self, index\)"),
        ("register_task", static_judge, r"judge\(scene\).*: write def judge\(scene\)"),
        ("register_task", objects_of_a_property, r"Press\.objects \(line \d+\) is a property, but "
            r"it is called as objects\(\): write it as a method, def objects\(self\)"),
        ("register_task", objects_of_a_list, r"Press\.objects must be a method, got \('button',\)"
            r": write def objects\(self\)"),
    ],
)  # fmt: skip
def test_rejects_a_hook_that_cannot_be_called(function: str, made: Callable[[], type], text: str):
    with pytest.raises(
        (rc.ArgumentError, TypeError), match=rf"{function}\('hook_of_test'\): .*{text}"
    ):
        REGISTERS[function]("hook_of_test")(made())
    assert "hook_of_test" not in rc.tasks.task_kinds()


def test_accepts_hooks_of_any_form_that_fits():
    class Any1(Push):
        def judge(self, *given: Any, extra: int = 0) -> Any: ...  # type: ignore[override]

        @staticmethod
        def objects() -> list[str]:  # type: ignore[override]
            return []

        @classmethod
        def instruction(cls) -> str:
            return "push"

        subtasks = functools.partialmethod(lambda self, names: names, ["push"])

    rc.register_task("any_hook_of_test")(Any1)
    assert "any_hook_of_test" in rc.tasks.task_kinds()


def test_rejects_an_attribute_that_hides_a_hook():
    @rc.register_task("hidden_of_test")
    class Hidden(Push):
        def __init__(self) -> None:
            super().__init__()
            self.objects = ["button"]  # type: ignore[assignment, method-assign]

    text = r"Hidden\.objects must be a method, got \['button'\].* give the attribute self\.objects"
    with pytest.raises(TypeError, match=text):
        rc.Env(pick_cube_config(task={"kind": "hidden_of_test"}))


def test_a_feature_takes_one_number_where_a_list_of_one_would_stand(
    monkeypatch: pytest.MonkeyPatch,
):
    registered: list[tuple[Any, ...]] = []

    def keep(*given: Any) -> None:
        registered.append(tuple(value for at, value in enumerate(given) if at not in (1, 10)))

    monkeypatch.setattr(rc.features, "_register_feature", keep)
    for given in (
        {"shape": 1, "names": "travel", "lower": 0, "upper": 0.012},
        {"shape": (1,), "names": ["travel"], "lower": [0], "upper": np.array([0.012])},
    ):
        rc.features.register_feature("one_of_test", **given)(lambda scene: 0.0)
    assert registered[0] == registered[1]
    assert registered[0][1] == [1]
    assert registered[0][-2:] == ([0.0], [0.012])


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"lower": "low", "upper": 1}, r"`lower` must be numbers such as \[0, 0\.5\].* got 'low'"),
        ({"upper": None}, r"`upper` must be numbers such as"),
        ({"shape": 2.5}, r"`shape` must be whole numbers such as \(3,\).* got 2\.5"),
    ],
)
def test_a_feature_rejects_what_are_no_numbers(given: dict[str, Any], text: str):
    with pytest.raises(rc.ArgumentError, match=rf"register_feature\('no_of_test'\): {text}"):
        rc.features.register_feature("no_of_test", **given)
