"""The exceptions and what else they are."""

import mujoco
import pytest

import robocell as rc


@pytest.mark.parametrize(
    ("error", "also"),
    [
        (rc.Error, RuntimeError),
        (rc.SpecError, ValueError),
        (rc.NotFoundError, LookupError),
        (rc.ArgumentError, ValueError),
        (rc.ClosedError, RuntimeError),
        (rc.DivergedError, RuntimeError),
        (rc.EngineError, RuntimeError),
        (rc.IoError, OSError),
    ],
)
def test_every_error_is_a_robocell_error_and_what_python_would_raise(error, also):
    assert issubclass(error, rc.Error)
    assert issubclass(error, also)
    assert error.__module__ == "robocell"
    assert error.__doc__


def test_c_plus_plus_errors_arrive_as_their_class():
    with pytest.raises(rc.NotFoundError, match="Did you mean 'rc7'"):
        rc.models.robot_file("rc8")
    with pytest.raises(rc.IoError, match=r"nothing\.yaml"):
        rc.RobotConfig.load("/nonexistent/nothing.yaml")


def test_versions_are_texts():
    assert rc.__version__.count(".") == 2
    assert rc.mujoco_version() == mujoco.mj_versionString()
    assert rc.__mujoco_version__ == rc.mujoco_version()


def test_log_levels():
    before = rc.log_level()
    for level in ("error", "warn", "info", "debug", "none"):
        rc.set_log_level(level)
        assert rc.log_level() == level
    with pytest.raises(rc.NotFoundError):
        rc.set_log_level("loud")
    rc.set_log_level(before)
