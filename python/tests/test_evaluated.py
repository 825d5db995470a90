"""Reasons of rollouts that an error of a policy or an expert ended."""

from __future__ import annotations

from typing import Any

import robocell as rc
from robocell.evaluated import ending_at_errors


class Forgets(rc.tasks.Expert):
    def done(self) -> Any:
        return None


def test_a_reason_has_one_place():
    expert = ending_at_errors(lambda *_: Forgets())(None, None)
    assert expert.done() is True
    reason = expert.failure()
    line = Forgets.done.__code__.co_firstlineno
    said = "policy error: TypeError: Forgets.done() must return True or False, got None"
    assert reason == f"{said} ({__file__}:{line}, in done)"
