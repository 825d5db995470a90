"""Doors, drawers and lids are opened and closed by hands without two moving fingers."""

from __future__ import annotations

from pathlib import Path

import pytest

import other_hands
import robocell as rc

HANDS = {"cup": other_hands.suction_cup, "one_finger": other_hands.one_moving_finger}


def successes(robot: Path, task: dict, folder: Path, starts: int) -> int:
    run = rc.RunConfig(run="hands", robot=str(robot), output=str(folder / "out"))
    run.task, run.scenes, run.seed = task, {"source": "tabletop"}, 0
    run.episodes, run.max_attempts, run.rates.max_steps = starts, 20, 800
    run.keep = rc.generate.Keep.FIRST
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    return sum(runner.run(item).success for item in rc.generate.make_plan(run))


@pytest.mark.proof
@pytest.mark.parametrize("kind", ["open", "close"])
@pytest.mark.parametrize("hand", HANDS)
def test_a_joint_is_opened_and_closed(hand: str, kind: str, tmp_path: Path):
    robot = HANDS[hand](tmp_path / "robot")
    furnitures = ["drawer_unit", "cupboard", "lid_box"]
    if (hand, kind) == ("cup", "open"):
        furnitures.remove("lid_box")  # the hand would have to turn with the lid, which few arms can
    for furniture in furnitures:
        task = {"kind": kind, "objects": [furniture]}
        assert successes(robot, task, tmp_path / furniture, 3) >= 2, furniture
