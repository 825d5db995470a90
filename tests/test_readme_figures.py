"""The figures in README.md are those of benchmarks/RESULTS.md and docs/reliability.md."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
RESULTS = (ROOT / "benchmarks" / "RESULTS.md").read_text()
NUMBER = r"[-+]?[\d,.]+(?:e[-+]?\d+)?"


def verdict(what: str, section: str) -> tuple[float, float]:
    """The figures of the worst and the best robot in the table of floors and aims."""
    for line in RESULTS.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) > 8 and cells[2] == what and f"(#{section})" in cells[8]:
            worst, best = (re.match(NUMBER, cell) for cell in cells[5:7])
            assert worst
            assert best
            return float(worst[0].replace(",", "")), float(best[0].replace(",", ""))
    raise AssertionError(f"benchmarks/RESULTS.md has no row '{what}' of {section}")


def best_of(what: str) -> float:
    """The best figure of robocell in a row of a section."""
    found = re.search(rf"^\| {re.escape(what)} \| 1/h \| ({NUMBER}) /", RESULTS, re.MULTILINE)
    assert found, f"benchmarks/RESULTS.md has no row '{what}'"
    return float(found[1])


def shown(pattern: str) -> list[float]:
    """The numbers that README.md shows at this place."""
    found = re.search(pattern, README)
    assert found, f"README.md has no '{pattern}'"
    return [float(number.replace(",", "")) for number in found.groups()]


@pytest.mark.parametrize(
    ("pattern", "what", "section"),
    [
        (r"(\S+) to (\S+) times as many per second as roboplan",
         "one IK query, from Python, beside roboplan", "ik"),
        (r"(\S+) to (\S+) times as fast as KDL", "gravity torques, beside KDL", "dynamics"),
        (r"(\S+) to (\S+) % more time than `mj_step`",
         "control tick, joint impedance, beside bare `mj_step`", "control_loop"),
        (r"(\S+) to (\S+) times as fast as `mujoco.Renderer`",
         "colour, depth and segmentation, beside `mujoco.Renderer`, default", "render"),
    ],
)  # fmt: skip
def test_a_range_over_robots_is_the_measured_one(pattern: str, what: str, section: str):
    measured = sorted(verdict(what, section))
    for number, figure in zip(shown(pattern), measured, strict=True):
        assert number == pytest.approx(figure, abs=0.5 if number.is_integer() else 0.05, rel=0)


def test_a_single_figure_is_the_measured_one():
    steps, _ = verdict("step of an environment from Python, beside robosuite's Lift", "env_step")
    assert shown(r"(\S+) times as many per second as robosuite") == pytest.approx([steps], abs=0.5)
    (median,) = shown(r"(\S+) µs, 58 to")
    assert median == verdict("one IK query, from Python: p50", "ik")[0]
    episodes = [best_of(f"pick episodes, rc7, {how}") for how in
                ("without cameras", "with two cameras 320x240")]  # fmt: skip
    pattern = r"(\S+) without cameras, (\S+) with two 320x240"
    assert shown(pattern) == pytest.approx(episodes, rel=0.02)


def test_as_many_kills_were_survived():
    survived = re.search(r"kills survived, nothing acknowledged lost \| (\d+)",
                         (ROOT / "docs" / "reliability.md").read_text())  # fmt: skip
    assert survived
    assert shown(r"\| (\d+), no acknowledged episode lost") == [float(survived[1])]
