"""What a policy may return as an action, before any robot gets it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from robocell._core import NotFoundError

from robocell._acting_policy import ActingPolicy
from robocell._row import Row
from robocell.policy import Context, Policy

ARM, GRIPPER = "robots/a/action/arm", "robots/a/action/gripper"


def actions(action: Any) -> list[dict[str, np.ndarray]]:
    """All actions of the chunk that a policy returns, as rollouts get them."""
    calls: list[None] = []

    class Once(Policy):
        def act(self, observation: Any) -> Any:
            calls.append(None)
            return action

    acting = ActingPolicy(Once())
    sizes = {ARM: 7, GRIPPER: 1}
    features = [SimpleNamespace(name=name, role="action", shape=(n,)) for name, n in sizes.items()]
    acting.begin(Context("", None, 0, features))  # type: ignore[arg-type]
    taken = [acting.next({})]
    while not acting._chunks.need_call():
        taken.append(acting.next({}))
    assert len(calls) == 1
    return taken


@pytest.mark.parametrize(
    "gripper", [0.5, [0.5], [[0.5]], np.array([0.5], object), np.float16(0.5), np.ma.array([0.5])]
)
def test_one_action_may_be_a_chunk_of_one(gripper: Any):
    for arm in (np.zeros(7), np.zeros((1, 7), np.float32)):
        (action,) = actions({ARM: arm, GRIPPER: gripper})
        assert (action[ARM].shape, action[GRIPPER].shape) == ((7,), (1,))
        assert action[GRIPPER] == 0.5
    assert len(actions({ARM: np.zeros((1, 7))})) == 1
    with pytest.raises(Exception, match=r"columns of one chunk differ in length: .* 2, .* 1"):
        actions({ARM: np.zeros((2, 7)), GRIPPER: 0.5})


@pytest.mark.parametrize(
    ("values", "what"),
    [
        ("0.5", "texts: <U3"),
        (["0.5"], "texts: <U3"),
        ([b"0.5"], "texts: |S3"),
        (np.array(["0.5"], object), "texts: '0.5'"),
        (np.array(["2020-01-01"], "datetime64[D]"), "times: datetime64[D]"),
        (np.array([3], "timedelta64[s]"), "times: timedelta64[s]"),
        (np.zeros(1, [("a", float)]), "records: [('a', '<f8')]"),
        (np.ma.array([0.5], mask=[True]), "a masked array: fill its masked entries"),
        (0.5j, "complex ones: complex128"),
    ],
)
def test_rejects_what_is_no_real_number(values: Any, what: str):
    with pytest.raises(TypeError) as caught:
        actions({GRIPPER: values})
    assert str(caught.value) == f"Once.act(): '{GRIPPER}' must be real numbers, got {what}"


def test_rejects_names_that_are_no_text():
    with pytest.raises(TypeError, match="the names of actions are texts, got 3"):
        actions({3: [0.5]})


@pytest.mark.parametrize(
    ("has_streams", "draws", "hint"),
    [
        (False, True, r" The rollouts draw no images: the cell has no `cameras\.streams`\."),
        (False, False, r" The rollouts draw no images: the cell has no `cameras\.streams`\."),
        (True, False, r" The rollouts draw no images: leave out --no-cameras .*"),
        (True, True, ""),
    ],
)
def test_a_missing_image_has_a_next_step_that_can_be_taken(
    has_streams: bool, draws: bool, hint: str
):
    row = Row({"time": np.zeros(1)}, (), lambda: None)
    ActingPolicy(Policy()).name_in(row, has_streams, draws)
    with pytest.raises(
        NotFoundError, match=rf"the observation has no 'wrist'\.{hint} It has: time"
    ):
        row["wrist"]
