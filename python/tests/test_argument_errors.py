"""Calls with wrong arguments: class, method, argument, what is expected and what came."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc
from robocell import _arguments, _core


@pytest.fixture(scope="module")
def scene() -> rc.Scene:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    return rc.Scene.build(spec)


def told(call: Callable[[], Any]) -> str:
    with pytest.raises(TypeError) as caught:
        call()
    return str(caught.value)


NAN = float("nan")
POSE = "Pose(matrix: ArrayLike | Pose | None = None, *, translation: ArrayLike | None = None, "


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda s: s.robot(3),
            "Scene.robot(): `name` must be a str, got 3 (int). It is called as ",
        ),
        (lambda s: s.robot(), "Scene.robot(): `name` is missing. It is called as Scene.robot("),
        (
            lambda s: s.robot("a", "b"),
            "Scene.robot(): takes 1 argument (name) by position, got 2. ",
        ),
        (
            lambda s: s.body_pose(nmae="a"),
            "Scene.body_pose(): no argument 'nmae'. Its arguments: name. Did you mean 'name'?; "
            "`name` is missing. It is called as Scene.body_pose(name: str)",
        ),
        (lambda s: s.step_n(2.5), "Scene.step_n(): `n` must be a whole number, got 2.5 (float)."),
        (lambda s: s.step(1), "Scene.step(): takes 0 arguments by position, got 1. "),
        (lambda s: s.contacts(of=None), "Scene.contacts(): `of` must be a str, got None. "),
        (
            lambda s: rc.Scene.build("cell.yaml"),
            "Scene.build(): `spec` must be a SceneSpec, got 'cell.yaml'; "
            "SceneSpec.load('cell.yaml') reads one from a file. ",
        ),
        (
            lambda s: rc.scene.compile_scene(s),
            "compile_scene(): `spec` must be a SceneSpec, got <Scene ",
        ),
        (
            lambda s: rc.render.Renderer("cell.yaml"),
            "Renderer(): `scene` must be a Scene, got 'cell.yaml'; make it with Scene.build(...) "
            "or Scene.from_compiled(...). ",
        ),
        (lambda s: rc.Pose([1, 2, 3], [0, 0, 0, 1]), "Pose(): takes 1 argument (matrix) by "),
        (
            lambda s: rc.Pose(position=[1, 2, 3]),
            "Pose(): no argument 'position'. Its arguments: matrix, translation, quaternion, rpy, "
            "rotvec, rotation. Did you mean 'translation'? ",
        ),
        (lambda s: rc.Pose(pos=[1, 2, 3]), "Pose(): no argument 'pos'. Its arguments: matrix, "),
        (lambda s: rc.RobotSpec("arm.yaml"), "RobotSpec(): its arguments are given by name, such "),
        (
            lambda s: rc.RobotConfig("arm"),
            "RobotConfig(): its arguments are given by name, such as ",
        ),
        (
            lambda s: s.robot("a").ik("up"),
            "Robot.ik(): `pose` must be a Pose or numbers, got 'up'. It is called as Robot.ik(",
        ),
        (
            lambda s: s.on_reset(5),
            "Scene.on_reset(): `hook` must be a function, got 5 (int). It is called as ",
        ),
        (
            lambda s: s.robot("a").set_joint_pos(None),
            "Robot.set_joint_pos(): `q` must be a value, ",
        ),
        (
            lambda s: s.robot("a").apply([1]),
            "Robot.apply(): `action` must be a dict {str: GroupCommand}, got [1] (list). ",
        ),
        (
            lambda s: s.robot("a").apply(
                {"arm": rc.control.GroupCommand.joints([0] * 7), "gripper": 1}
            ),
            "Robot.apply(): `action['gripper']` must be a GroupCommand, got 1 (int); make it with "
            "GroupCommand.joints(...) or GroupCommand.relative_joints(...) or "
            "GroupCommand.leaf_pose(...) or GroupCommand.base_pose(...) or "
            "GroupCommand.opening(...) or ",
        ),
        (
            lambda s: rc.control.Stepper(s, s.robots).advance({"a": {"arm": [0] * 7}}),
            "Stepper.advance(): `action['a']['arm']` must be a GroupCommand, got [0, 0, 0, 0, 0, "
            "0, 0] (list); make it with ",
        ),
        (
            lambda s: setattr(s.robot("a"), "ctrl_mode", 3),
            "ctrl_mode must be a CtrlMode or one of position, velocity, torque, got int",
        ),
        (
            lambda s: rc.SceneObject(condim=4),
            "condim must be a Condim or one of tangential, torsional, rolling, got int",
        ),
        (
            lambda s: rc.control.Stepper(s, s.robot("a")),
            "Stepper(): `robots` must be a list of Robot, got <Robot 'a'>. It is called ",
        ),
        (lambda s: rc.Dataset(3), "Dataset(): `folder` must be a str or a path, got 3 (int). "),
        (
            lambda s: rc.render.Renderer(s).render(None, "big"),
            "Renderer.render(): `width` must be a whole",
        ),
        (
            lambda s: rc.generate.Runner("run.yaml"),
            "Runner(): `run` must be a RunConfig, got 'run.yaml'; RunConf",
        ),
        (
            lambda s: rc.tasks.Rng.stream(-1, "x"),
            "Rng.stream(): `seed` cannot be negative, got -1. It is called as Rng.stream(seed:",
        ),
        (
            lambda s: s.reset(seed=-1),
            "Scene.reset(): `seed` cannot be negative, got -1. It is called as Scene.reset(",
        ),
        (
            lambda s: s.reset(seed=1 << 70),
            "Scene.reset(): cannot be called with (seed=1180591620717411303424); is a whole number "
            "out of range? It is called as Scene.reset(",
        ),
        (
            lambda s: setattr(rc.scene.ResetOptions(), "use_keyframe", 3),
            "ResetOptions.use_keyframe must be True or False, got 3 (int)",
        ),
    ],
)
def test_errors_name_the_wrong_argument(
    scene: rc.Scene, call: Callable[[rc.Scene], Any], message: str
):
    text = told(lambda: call(scene))
    assert text.startswith(message), text
    assert "robocell._core." not in text.replace("<robocell._core.", "<")
    assert "incompatible function arguments" not in text


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda s: rc.Pose([1, 2, 3]),
            "Pose: by position it takes a 4x4 matrix, got 3 numbers; a position is given as "
            "Pose(translation=[1, 2, 3])",
        ),
        (lambda s: rc.Pose([[1, 2], [3, 4], [5, 6]]), "matrix must be a 4x4 matrix, got 3 rows"),
        (
            lambda s: setattr(s.robot("a"), "jnt_pos_cmd", None),
            "jnt_pos_cmd must be a list of numbers, got None",
        ),
        (
            lambda s: setattr(s.robot("a"), "jnt_pos_cmd", 3),
            "jnt_pos_cmd must be a list of numbers, got 3",
        ),
        (lambda s: s.robot("a").gravity_torques(NAN), "gravity_z is nan; it must be finite"),
    ],
)
def test_errors_name_the_argument_with_a_wrong_value(
    scene: rc.Scene, call: Callable[[rc.Scene], Any], message: str
):
    with pytest.raises(rc.ArgumentError) as caught:
        call(scene)
    assert message in str(caught.value)


SPOILT = [0.0, 0.0, NAN, 0.0, 0.0, 0.0, 0.0]
BAD_JOINT = (
    "chain 'base_link' -> site 'tcp': {}: joint 'joint3' is nan; joint values must be finite"
)


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda r: r.kinematics.fk(SPOILT), "q"),
        (lambda r: r.kinematics.jacobian(SPOILT), "q"),
        (lambda r: r.fk_frame(SPOILT), "q"),
        (lambda r: r.chain.fk(SPOILT), "q"),
        (lambda r: r.chain.jacobian(SPOILT), "q"),
        (lambda r: r.chain.mass_matrix(SPOILT), "q"),
        (lambda r: r.chain.gravity_torques(SPOILT), "q"),
        (lambda r: r.chain.coriolis_torques([0] * 7, SPOILT), "qd"),
        (lambda r: r.chain.inverse_dynamics([0] * 7, [0] * 7, SPOILT), "qdd"),
    ],
)
def test_errors_name_argument_and_joint_of_a_non_finite_value(
    scene: rc.Scene, call: Callable[[rc.Robot], Any], argument: str
):
    with pytest.raises(rc.ArgumentError) as caught:
        call(scene.robot("a"))
    assert str(caught.value) == BAD_JOINT.format(argument)


def test_errors_name_the_component_of_a_non_finite_gravity(scene: rc.Scene):
    with pytest.raises(rc.ArgumentError, match=r"^gravity\[2\] must be finite, is nan$"):
        scene.robot("a").chain.gravity_torques([0] * 7, gravity=(0, 0, NAN))


def test_gravity_torques_have_no_negative_zeros(scene: rc.Scene):
    robot = scene.robot("a")
    for torques in (robot.gravity_torques(), robot.chain.gravity_torques([0] * 7)):
        assert not any(value == 0 and str(value).startswith("-") for value in torques)


def test_a_missing_dataset_error_names_the_nearest_dataset(tmp_path: Path):
    (tmp_path / "pick_v1").mkdir()
    with pytest.raises(rc.IoError) as caught:
        rc.Dataset(tmp_path / "pick_v2")
    path = tmp_path / "pick_v2"
    assert str(caught.value) == (
        f"no dataset '{path}': there is no such folder. Did you mean 'pick_v1'? `robocell generate "
        f"RUN.yaml --output {path}` makes one"
    )


def test_large_values_are_not_inspected_in_full():
    class Seen:
        count = 0

        def __repr__(self) -> str:
            Seen.count += 1
            return "x"

    text = told(lambda: rc.Scene.build([Seen()] * 100_000))
    assert text.startswith("Scene.build(): `spec` must be a SceneSpec, got [x, x, x, x"), text
    assert Seen.count < 100
    assert "got <ndarray of shape (1000, 1000)>." in told(
        lambda: rc.Scene.build(np.zeros((1000, 1000)))
    )
    assert "got <1000000 bytes>." in told(lambda: rc.Scene.build(bytes(1_000_000)))


def test_rejects_a_frame_with_a_malformed_quaternion(scene: rc.Scene):
    class Rotation:
        def GetQuaternion(self) -> tuple[float, ...]:
            return (0.0, 0.0, 0.0)

    class Frame:
        M = Rotation()
        p = (0.0, 0.0, 0.0)

    with pytest.raises(ValueError, match="frame must be 4 numbers, got 3"):
        scene.robot("a").ik(Frame())


def test_the_full_message_names_the_matching_signature():
    text = told(lambda: rc.Pose([1, 2, 3], [0, 0, 0, 1]))
    assert text == (
        "Pose(): takes 1 argument (matrix) by position, got 2. It is called as "
        + POSE
        + "quaternion: "
        "ArrayLike | None = None, rpy: ArrayLike | None = None, rotvec: ArrayLike | None = None, "
        "rotation: ArrayLike | None = None)"
    )


def test_reports_a_missing_super_init_call(scene: rc.Scene):
    class Mine(rc.tasks.Task):
        def __init__(self) -> None:
            pass

    text = told(lambda: rc.tasks.PickPlanner(rc.RunConfig(), Mine()))
    assert text.startswith("Mine.__init__() must call super().__init__(...)")
    with pytest.warns(RuntimeWarning, match="uninitialized instance"):
        assert told(lambda: Mine().begin(scene)).startswith("Mine.__init__() must call super()")


def test_errors_unrelated_to_arguments_stay_unchanged(scene: rc.Scene):
    with pytest.raises(rc.NotFoundError, match="no robot 'b'"):
        scene.robot("b")


@pytest.mark.parametrize("name", ["mine", "reset"])
def test_an_error_in_a_callback_stays_unchanged(scene: rc.Scene, name: str):
    message = f"{name}(): incompatible function arguments."

    def hook(context: rc.scene.ResetContext) -> None:
        raise TypeError(message)

    number = scene.on_reset(hook)
    with pytest.raises(TypeError) as caught:
        scene.reset()
    scene.remove_reset_hook(number)
    assert str(caught.value) == message
    assert caught.traceback[-1].name == "hook"


def test_an_error_of_the_mujoco_bindings_stays_unchanged(scene: rc.Scene):
    def hook(context: rc.scene.ResetContext) -> None:
        mujoco.mj_step("x")  # type: ignore[call-arg, arg-type]

    number = scene.on_reset(hook)
    with pytest.raises(TypeError, match=r"^mj_step\(\): incompatible function arguments") as caught:
        scene.reset()
    scene.remove_reset_hook(number)
    assert "hook" in [entry.name for entry in caught.traceback]


def functions() -> Iterator[Any]:
    """All that is bound, with the setters."""
    for member in vars(_core).values():
        members = vars(member).values() if isinstance(member, type) else [member]
        for item in members:
            for one in (item.fget, item.fset) if isinstance(item, property) else (item,):
                if hasattr(one, "__nb_signature__"):
                    yield one


def test_every_signature_of_the_core_is_understood():
    count = 0
    for function in functions():
        for text, _, defaults in function.__nb_signature__:
            form = _arguments.parse(text, defaults)
            assert all(not p.kind or isinstance(p.kind, ast.expr) for p in form.all)
            count += 1
    assert count > 500


def test_a_misspelt_attribute_is_never_set(scene: rc.Scene):
    class Own(rc.SceneSpec):
        pass

    with pytest.raises(AttributeError) as caught:
        rc.SceneSpec().timstep = 1  # type: ignore[attr-defined]
    assert str(caught.value) == "a SceneSpec has no 'timstep'. Did you mean 'timestep'?"
    for owner, name, meant in (
        (scene.robot("a"), "jnt_pos_cmnd", "jnt_pos_cmd"),
        (scene.robot("a").gripper, "openning", "opening"),
    ):
        with pytest.raises(AttributeError, match=f"no '{name}'. Did you mean '{meant}'"):
            setattr(owner, name, 1)
    with pytest.raises(AttributeError, match=r"an IkResult has no 'zzz'\. It has "):
        scene.robot("a").ik(rc.Pose()).zzz = 1  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match="no setter"):
        scene.name = "b"  # type: ignore[misc]
    own = Own()
    own.note = "mine"  # type: ignore[attr-defined]
    assert own.note == "mine"  # type: ignore[attr-defined]


@pytest.mark.parametrize("reward", [np.zeros(2), np.zeros(1)])
def test_an_array_is_no_number(reward: np.ndarray):
    said = told(lambda: rc.tasks.TaskVerdict(reward=reward, success=False, subtask=0))
    assert "`reward` must be a number, got array(" in said
    assert "out of range" not in said
    assert "out of range?" in told(lambda: rc.tasks.TaskVerdict(subtask=10**20))
