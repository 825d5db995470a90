"""What the guide says of closed objects: programs look for "robot is closed" in the message."""

from __future__ import annotations

import pytest

import robocell as rc
import robocell.compat.mj_kdl_wrapper as mjk

ALWAYS = {"name", "prefix", "scene"}


def env_of_rc7() -> mjk.Env:
    spec = mjk.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots = [mjk.RobotSpec(path=rc.models.resolve("rc7"))]
    return mjk.Env.build(spec)


def message(use) -> str:
    with pytest.raises(RuntimeError) as error:
        use()
    assert isinstance(error.value, rc.ClosedError)
    return str(error.value)


@pytest.mark.parametrize("close", ["env", "scene"])
def test_a_closed_robot_raises_closed_error(close: str):
    env = env_of_rc7()
    robot = env.create_robot("base_link", "link7")
    (env if close == "env" else env.scene).close()
    for use in (
        robot.update,
        robot.step,
        robot.fk_frame,
        robot.kdl_chain,
        robot.gravity_torques,
        lambda: robot.jnt_pos_msr,
        lambda: robot.n_joints,
        lambda: robot.tip_to_tcp,
        lambda: robot.set_joint_pos([0.0] * 7),
        lambda: setattr(robot, "jnt_pos_cmd", [0.0] * 7),
        lambda: setattr(robot, "ctrl_mode", mjk.CtrlMode.POSITION),
    ):
        assert message(use) in (
            "robot is closed: robot 'robot' is closed: its scene was closed",
            "robot is closed: scene 'cell' is closed",
        )
    assert robot.name


def test_every_failing_member_of_a_closed_robot_raises_closed_error():
    env = env_of_rc7()
    robot = env.create_robot("base_link", "link7")
    env.close()
    texts = {}
    for name in dir(robot):
        if name.startswith("_") or name in ALWAYS:
            continue
        try:
            member = getattr(robot, name)
            member()
        except rc.ClosedError as error:
            texts[name] = str(error)
        except TypeError:  # it needs arguments
            pass
    assert len(texts) > 15
    assert not [name for name, text in texts.items() if not text.startswith("robot is closed: ")]


def test_a_closed_env_raises_closed_error():
    env = env_of_rc7()
    env.close()
    env.close()
    for use in (
        lambda: env.step(),
        lambda: env.body_frame("base_link"),
        lambda: env.reset(),
        lambda: env.create_robot("base_link", "link7"),
        lambda: setattr(env, "on_reset", print),
        lambda: env.model,
    ):
        assert message(use) == "env is closed: scene 'cell' was closed"
    assert (env.name, env.closed) == ("cell", True)


def test_a_closed_recorder_raises_closed_error(tmp_path):
    recorder = mjk.VideoRecorder.open(env_of_rc7(), tmp_path / "a.mp4", 64, 48, 30)
    recorder.record_frame()
    recorder.close()
    for use in (
        recorder.record_frame,
        lambda: recorder.use_camera(""),
        lambda: recorder.set_free_camera(2.5, 135.0, -20.0, (0.0, 0.0, 0.7)),
    ):
        assert message(use).startswith("recorder is closed: ")
    assert recorder.frames == 1
