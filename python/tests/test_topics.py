"""Everyday names are at the top, everything is in a topic, and a miss shows the way."""

import ast
import importlib
import importlib.util
import inspect
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import robocell as rc
from robocell import _core, _elsewhere

TOPICS = [getattr(rc, topic) for topic in _elsewhere.TOPICS]
OF_CORE = [topic for topic in TOPICS if topic not in (rc.models, rc.menagerie)]
ERRORS = [
    name
    for name, value in vars(_core).items()
    if inspect.isclass(value) and issubclass(value, Exception)
]
# Only the package itself uses these.
OWN = {
    "SpecT", "advice_about_pointers", "atomic_write", "ffmpeg_answer", "ffmpeg_input",
    "first_episode_of_run",
    "import_mujoco",
    "imports_of_run_file", "json_damage", "load_plugin", "make_task", "missing_spec_file",
    "other_run_of", "override_file", "packed_part", "plan_numbers", "require_dataset",
    "run_of_dataset", "set_aside", "self_hashed_json", "stand_in_reach", "temporary_path",
    "urdf_to_mjcf",
}  # fmt: skip
SHORTER_ELSEWHERE = ("builtin_", "menagerie_", "models_root", "resolve_model")  # robocell.models


# Names that most programs use. Errors are at the top too: tracebacks show robocell.SpecError.
EVERYDAY = {
    "Dataset", "Env", "EnvConfig", "Pose", "Robot", "RobotConfig", "RobotSpec", "RunConfig",
    "Scene", "SceneObject", "SceneSpec", "Shape", "register_task", "show",
}  # fmt: skip


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.__name__)
def test_a_topic_documents_its_purpose_and_names(topic):
    assert topic.__doc__
    assert len(topic.__all__) == len(set(topic.__all__))
    for name in topic.__all__:
        value = getattr(topic, name)
        if callable(value):
            assert value.__doc__, name


def test_every_name_of_the_core_is_in_one_topic():
    homes = {}
    for topic in OF_CORE:
        for name in topic.__all__:
            homes.setdefault(name, []).append(topic.__name__)
    public = {name for name in vars(_core) if not name.startswith(("_", *SHORTER_ELSEWHERE))}
    assert public - set(homes) == OWN | set(ERRORS)
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def test_common_names_are_also_at_the_top_level():
    modules = {name for name in rc.__all__ if inspect.ismodule(getattr(rc, name))}
    assert modules == set(_elsewhere.TOPICS)
    names = (
        set(rc.__all__) - modules - set(ERRORS) - {"__version__", "__mujoco_version__", "cmake_dir"}
    )
    assert names == EVERYDAY
    for name in names:
        [home] = [topic for topic in TOPICS if name in topic.__all__]
        assert getattr(rc, name) is getattr(home, name)
    assert set(ERRORS) <= set(rc.__all__)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("IkSolver", "It is in a topic: robocell.kinematics.IkSolver"),
        ("VideoRecorder", "It is in a topic: robocell.render.VideoRecorder"),
        ("register_expert", "It is in a topic: robocell.tasks.register_expert"),
        ("AttachKind", "It is in a topic: robocell.robots.AttachKind"),
        ("CtrlMode", "It is in a topic: robocell.control.CtrlMode"),
        ("PickTaskConfig", "It is in a topic: robocell.tasks.PickTaskConfig"),
        ("from_dataset", "It is in a topic: robocell.envs.from_dataset"),
        ("model_path", "It is in a topic: robocell.menagerie.model_path"),
        ("gym", "It is a module to import: import robocell.gym"),
        ("Policy", "It is in a topic: robocell.policy.Policy"),
        ("polcy", "Did you mean robocell.policy?"),
        ("iksolver", "Did you mean robocell.kinematics.IkSolver?"),
        ("SceneSpek", "Did you mean robocell.SceneSpec?"),
        ("Scen", "Did you mean robocell.Scene?"),
        ("scen", "Did you mean robocell.scene?"),
        ("zzz", f"Its topics: {', '.join((*_elsewhere.TOPICS, *_elsewhere.ON_FIRST_USE))}"),
    ],
)
def test_a_missing_top_level_name_points_to_its_topic(name, told):
    # A process that imports nothing else.
    program = f"import robocell\ntry: robocell.{name}\nexcept AttributeError as error: print(error)"
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert result.stdout == f"module 'robocell' has no attribute '{name}'. {told}\n"


@pytest.mark.parametrize(
    ("topic", "name", "told"),
    [
        ("tasks", "Refusl", "Did you mean Refusal?"),
        ("envs", "envbatch", "Did you mean EnvBatch?"),
        ("data", "EnvRecordr", "Did you mean EnvRecorder?"),
        ("scenes", "Refusal", "It is robocell.tasks.Refusal"),
        ("menagerie", "model_pth", "Did you mean model_path?"),
    ],
)
def test_an_unknown_name_in_a_topic_suggests_the_nearest(topic, name, told):
    module = getattr(rc, topic)
    with pytest.raises(AttributeError) as error:
        getattr(module, name)
    assert str(error.value) == f"module 'robocell.{topic}' has no attribute '{name}'. {told}"


# Objects, a name that each lacks, and the one that it has.
NEAR = {
    "robocell": ("Scenee", "Scene"),
    "robocell.log": ("set_log_leve", "set_log_level"),
    "robocell.envs": ("EnvBatc", "EnvBatch"),
    "robocell.data": ("Step", "Steps"),
    "robocell.compat.mj_kdl_wrapper": ("set_log_leve", "set_log_level"),
}


@pytest.mark.parametrize("module", NEAR)
def test_python_adds_no_second_suggestion(module: str, capsys):
    wrong, right = NEAR[module]
    with pytest.raises(AttributeError) as error:
        getattr(importlib.import_module(module), wrong)
    assert right in str(error.value)
    sys.__excepthook__(error.type, error.value, None)  # it adds them as a program's end does
    assert capsys.readouterr().err.endswith(f"AttributeError: {error.value}\n")


def test_python_adds_no_second_suggestion_to_wrapped_objects(capsys):
    from robocell.compat.mj_kdl_wrapper._forward import Forwarding

    class Wrapper(Forwarding):
        __slots__ = ("pose",)
        _wraps = "pose"

    wrapper = Wrapper()
    wrapper.pose = rc.Pose()
    with pytest.raises(AttributeError, match=r"has no 'translatio'. Did you mean 'trans") as error:
        wrapper.translatio  # noqa: B018
    sys.__excepthook__(error.type, error.value, None)
    assert capsys.readouterr().err.endswith(f"AttributeError: {error.value}\n")


@pytest.mark.parametrize("topic", _elsewhere.TOPICS)
def test_every_topic_rejects_unknown_names(topic):
    module = importlib.import_module(f"robocell.{topic}")
    assert not hasattr(module, "zzz")
    with pytest.raises(AttributeError, match=f"module 'robocell.{topic}' has no attribute 'zzz'$"):
        module.zzz  # noqa: B018


def test_hasattr_with_an_unknown_name_is_false():
    assert not hasattr(rc, "Nope")
    with pytest.raises(ImportError, match="cannot import name 'Nope' from 'robocell'"):
        exec("from robocell import Nope")


@pytest.mark.parametrize(
    "topic", ["control", "diagnose", "kinematics", "log", "render", "robots", "scene"]
)
def test_examples_of_topics_run(topic):
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="rc7", config=config))
    scene = rc.Scene.build(spec)
    run = rc.RunConfig(run="shown", robot=config, output="not written")
    shown = [
        line
        for line in importlib.import_module(f"robocell.{topic}").__doc__.splitlines()
        if line.startswith("    ")
    ]
    assert shown
    run = rc.RunConfig.load(Path(__file__).parents[2] / "examples" / "demo.yaml")
    level, sink = rc.log.log_level(), rc.log.set_log_sink(None)
    try:
        exec(
            textwrap.dedent("\n".join(shown)),
            {"robocell": rc, "scene": scene, "robot": scene.robot("rc7"), "run": run},
        )
    finally:
        rc.log.set_log_level(level)
        rc.log.set_log_sink(sink)


@pytest.mark.parametrize("name", _elsewhere.OF_EXTRAS)
def test_a_class_of_an_extra_is_in_the_named_module(name):
    module = _elsewhere.OF_EXTRAS[name]
    with pytest.raises(AttributeError, match=rf"import: {module}\.{name}"):
        getattr(rc, name)
    # The extra need not be installed: what a module has is read from its source.
    names = set()
    for node in ast.parse(Path(importlib.util.find_spec(module).origin).read_text()).body:
        if isinstance(node, ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
    assert name in names


def test_dir_lists_public_names_and_no_imports():
    for topic in TOPICS:
        assert dir(topic) == sorted(topic.__all__)
    assert set(rc.__all__) <= set(dir(rc))
    assert set(dir(rc)) <= {*rc.__all__, *_elsewhere.BESIDE, *_elsewhere.ON_FIRST_USE}
