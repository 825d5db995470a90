"""`robocell ik-test`: inverse kinematics of poses that the robot reaches."""

from __future__ import annotations

from command_line import (
    RC7,
    robocell_command,
)


def test_ik_test_solves_reachable_poses():
    for parallel in ((), ("--parallel",)):
        result = robocell_command("ik-test", RC7, "--samples", 200, *parallel)
        assert result.returncode == 0, result.stdout + result.stderr
        assert "of 200 at 1e-05 m, rad" in result.stdout
