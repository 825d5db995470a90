"""benchmarks/verdicts.py: floors and aims are judged by what is recorded, and by all of it."""

import ctypes
import itertools
import math
import platform
import random
import sys
from pathlib import Path
from unittest import mock

import pytest

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
import recorded
from bench_program import Turns
from floor import Floor
from floors import FLOORS, UNRECORDED
from ik import BATCH, Side
from instruction_set import KERNELS, compiler_flags, instruction_set, with_avx2
from measures import MORE_TIME, P50, P99, RATE, SOLVED, TIMES_AS_LONG
from record import sections
from table import Row, markdown
from verdicts import BEGIN, END, judge, summary, warnings

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
RESULTS = (BENCHMARKS / "RESULTS.md").read_text()
SOLVES = "solved 99.40% (beyond limits too: 100.00%) / 90.00%; p50, p99 1.5, 2.8 / 108.1, 217.4 µs"


def section(*rows: Row, on: str = "AVX2") -> dict[str, str]:
    return {"s": f"- machine: x\n- instruction set: {on}\n\n{markdown(rows)}"}


def tick(robot: str, ours: float, peer: float, name: str = "`mj_step` alone") -> Row:
    return Row(f"tick, {robot}", "µs", [ours], [peer], note=f"peer: {name}, same controls")


def floor_of(**fields: object) -> Floor:
    return Floor("P0", "a tick", "s", "tick, {robot}", **fields)  # type: ignore[arg-type]


def test_a_row_is_read_as_it_was_written():
    (row,) = recorded.rows(section(tick("rc7", 12, 10))["s"])
    assert (row.name, row.unit, row.ours, row.peer) == ("tick, rc7", "µs", 12, 10)
    assert row.speed == pytest.approx(10 / 12)
    rate = Row("r", "1/s", [8, 9], [3], better="higher")
    assert recorded.rows(markdown([rate]))[0].speed == pytest.approx(3)
    alone = Row("r", "1/h", [8], better="higher")
    assert recorded.rows(markdown([alone]))[0].speed is None


def of_turns(robot: str, *ratios: float) -> Row:
    return Row(f"tick, {robot}", "µs", [9, 12], [10, 10], note="peer: `mj_step`", ratios=ratios)


def test_a_ratio_of_turns_is_that_of_the_row():
    row = of_turns("a", 1.09, 1.06, 1.02)
    assert row.ratio == 1.06
    assert row.to_json()["ratio of"] == "turns"
    assert "| 9 / 10.5 | 10 / 10 | 1.060 turns |" in markdown([row])
    (read,) = recorded.rows(markdown([row]))
    assert (read.ours, read.peer, read.ratio, read.speed) == (9, 10, 1.06, 1 / 1.06)
    rate = Row("r", "1/s", [8], [3], better="higher", ratios=[0.9])
    assert recorded.rows(markdown([rate]))[0].speed == 0.9
    (best,) = recorded.rows(section(tick("a", 12, 10))["s"])
    assert best.ratio_of_turns is None
    assert tick("a", 12, 10).to_json()["ratio of"] == "best"


def test_ratios_of_turns_are_judged_where_they_are():
    found = section(of_turns("a", 1.06), of_turns("b", 1.04))
    verdict = judge(floor_of(measure=MORE_TIME, floor=1.05), found)
    assert verdict.values == {"a": pytest.approx(1.06), "b": pytest.approx(1.04)}
    assert verdict.says == "**floor missed**"
    assert not warnings(found)
    assert len(warnings(section(of_turns("a", 0.99)))) == 1


def test_turns_find_a_ratio_on_a_machine_that_is_disturbed():
    rng, turn = random.Random(1), itertools.count()

    def seconds(alone: float) -> float:
        """With a clock that goes up and down, and a process that often takes the core."""
        clock = 1 + 0.3 * math.sin(next(turn) / 40)
        return alone * clock * rng.uniform(0.99, 1.01) + (0.004 if rng.random() < 0.2 else 0)

    turns = Turns()
    turns.take(lambda: seconds(1.05e-3), lambda: seconds(1e-3), rounds=400)
    assert turns.ratios == [pytest.approx(1.05, abs=2e-3)]
    assert 1 < 1e3 * turns.peer[0] < 1.3


def test_the_order_of_turns_is_even():
    asked: list[str] = []

    def slower(name: str) -> float:
        asked.append(name)
        return float(len(asked))

    Turns().take(lambda: slower("ours"), lambda: slower("peer"), rounds=2)
    assert asked == ["ours", "peer", "peer", "ours"] * 2


def could_be(printed: float) -> tuple[float, float]:
    """Between which values lies what was printed with four digits."""
    half = 0.5 * 10.0 ** (math.floor(math.log10(printed)) - 3)
    return printed - half, printed + half


def test_a_printed_value_has_bounds_that_contain_the_original():
    for value in (1.0004, 9.9995, 12.6049, 0.0333333, 123456.0):
        low, high = could_be(float(f"{value:.4g}"))
        assert low <= value <= high


def test_ratios_agree_with_the_recorded_ones():
    checked = 0
    for line in RESULTS[RESULTS.index(END) :].splitlines():
        for row in recorded.rows(line):
            if row.speed is None or row.ratio_of_turns is not None:
                continue
            ratio = float(line.split("|")[5])  # of the values before they were rounded
            (least, most), (peer_least, peer_most) = could_be(row.ours), could_be(row.peer)
            assert least / peer_most - 5e-4 <= ratio <= most / peer_least + 5e-4, line
            checked += 1
    assert checked > 100


def test_peers_with_a_common_beginning_are_different():
    (row,) = recorded.rows(markdown([Row("r", "ns", [1], [2], note="of 2; peer: KDL-LMA; solved")]))
    assert row.has_peer("KDL-LMA")
    assert not row.has_peer("KDL")
    assert not row.has_peer("LMA")


def test_reads_our_numbers_from_a_note():
    (row,) = recorded.rows(markdown([Row("r", "1/s", [1], [2], note=f"peer: x; {SOLVES}")]))
    assert [measure.of(row) for measure in (SOLVED, P50, P99)] == [99.4, 1.5, 2.8]
    (bare,) = recorded.rows(markdown([Row("r", "1/s", [1], [2], note="peer: x")]))
    assert [measure.of(bare) for measure in (SOLVED, P50, P99)] == [None, None, None]


@pytest.mark.parametrize(
    ("worst", "says"),
    [(1.005, "aim met"), (1.03, "floor met"), (1.05, "floor met"), (1.07, "**floor missed**")],
)
def test_the_worst_robot_decides(worst: float, says: str):
    found = section(tick("a", 1, 1), tick("b", 100 * worst, 100))
    verdict = judge(floor_of(measure=MORE_TIME, floor=1.05, aim=1.01), found)
    assert verdict.says == says
    assert verdict.worst == pytest.approx(worst)


def test_more_is_better_only_where_it_is():
    found = section(tick("a", 1, 30), tick("b", 1, 50))
    assert judge(floor_of(floor=40), found).worst == 30
    assert judge(floor_of(floor=40), found).says == "**floor missed**"
    assert judge(floor_of(measure=TIMES_AS_LONG, floor=1), found).worst == pytest.approx(1 / 30)
    assert judge(floor_of(measure=RATE, aim=2), found).says == "aim missed"


@pytest.mark.parametrize(
    ("where", "says"),
    [("AVX2", "aim met"), ("AVX-512", "floor met"), ("plain x86-64", "floor met")],
)
def test_the_aim_is_that_of_the_instruction_set(where: str, says: str):
    floor = floor_of(floor=10, aims={"AVX2": 25, "AVX-512": 80})
    assert judge(floor, section(tick("a", 1, 30), on=where)).says == says


@pytest.mark.parametrize(
    ("unsolved", "says", "text"),
    [(0, "aim met", "100.00 %"), (2, "aim met", "99.99 %"), (3, "**floor missed**", "99.985 %")],
)
def test_the_solved_share_is_judged_to_the_last_target(unsolved: int, says: str, text: str):
    share = 1 - unsolved / BATCH
    note = f"peer: KDL-LMA; solved {Side('robocell batch', BATCH, solved=share).shares()} / 90.000%"
    verdict = judge(
        floor_of(measure=SOLVED, floor=99.99, aim=99.99),
        section(Row("tick, a", "1/s", [1], [1], note=note)),
    )
    assert verdict.says == says
    assert SOLVED.text(verdict.worst) == text


def test_excludes_other_robots():
    found = section(tick("a", 1, 30), tick("b", 1, 5))
    assert judge(floor_of(floor=10, not_meant=("b",)), found).values == {"a": 30}


def test_uses_only_rows_with_the_peer():
    found = section(tick("a", 1, 30), tick("a", 1, 5, "another"))
    assert judge(floor_of(peer="`mj_step`"), found).values == {"a": 30}
    assert judge(floor_of(peer="another"), found).values == {"a": 5}


def test_reports_rows_that_are_not_measured():
    assert judge(floor_of(floor=10), {}).says == "not measured"
    assert judge(Floor("P0", "unheard of", floor=10), section(tick("a", 1, 30))).values == {}
    assert "of 0 aims 0; 1 rows are not measured" in summary({}, [floor_of(floor=10)])


def test_being_faster_than_a_part_of_the_work_is_suspicious():
    found = section(tick("a", 92.5, 100), tick("b", 1.01, 1), tick("c", 1, 2, "KDL"))
    (warning,) = warnings(found)
    assert warning == (
        "- [`s`](#s), tick, a: 0.925 of the time (peer: `mj_step` alone, same controls)"
    )
    assert warning in summary(found, [floor_of()])
    assert "Disturbed" not in summary(section(tick("b", 1.01, 1)), [floor_of()])


def test_every_floor_finds_its_rows():
    known = sections(RESULTS)
    floors = [floor for floor in FLOORS if floor not in UNRECORDED]
    assert {floor.section for floor in floors if not floor.section.endswith("_avx2")} <= {
        "",
        *known,
    }
    recorded_floors = [floor for floor in floors if floor.section in known]
    unmeasured = {floor.what for floor in recorded_floors if not judge(floor, known).values}
    assert all(
        any(peer in what for peer in ("beside Pinocchio in C++", "beside rays on Embree"))
        for what in unmeasured
    )
    for floor in recorded_floors:
        before, _, after = floor.name.partition("{robot}")
        names = [row.name for row in recorded.rows(known[floor.section])]
        assert any(n.startswith(before) and n.endswith(after) for n in names), floor.what


def test_rows_without_a_record_are_judged_as_soon_as_they_have_one():
    for floor in UNRECORDED:
        assert (BENCHMARKS / f"{floor.section}.py").exists(), floor.section
        assert floor in FLOORS
        note = f"first; peer: {floor.peer}; last"
        row = Row(floor.name.format(robot="rc7"), "1/s", [1e6], [1], better="higher", note=note)
        assert judge(floor, {floor.section: markdown([row])}).says != "not measured"


def test_the_recorded_verdicts_are_those_of_the_recorded_sections():
    written = RESULTS[RESULTS.index(BEGIN) : RESULTS.index(END) + len(END)]
    assert written == summary(sections(RESULTS)).strip(), "run benchmarks/run.py --judge"


@pytest.mark.skipif(platform.machine() != "x86_64", reason="names of x86-64")
class TestInstructionSet:
    def test_an_instruction_set_requires_all_features_of_highway(self):
        for name, needed in KERNELS.items():
            assert instruction_set(f"flags\t\t: fpu {' '.join(needed)}\n") == name
            for missing in needed:
                flags = " ".join(flag for flag in needed if flag != missing)
                assert instruction_set(f"flags : {flags}") != name
        assert instruction_set("flags : fpu sse2") == "plain x86-64"

    def test_the_instruction_set_matches_highway(self):
        try:
            supported = ctypes.CDLL("libhwy.so.1")._ZN3hwy16SupportedTargetsEv
        except (OSError, AttributeError):
            pytest.skip("libhwy.so.1 is not here")
        supported.restype = ctypes.c_int64
        avx3, avx2 = 1 << 8, 1 << 9  # as in hwy/detect_targets.h
        targets = supported()
        best = "AVX-512" if targets & avx3 else "AVX2" if targets & avx2 else "plain x86-64"
        assert instruction_set() == best

    def test_peers_are_compiled_for_the_instruction_set_of_the_kernels(self, tmp_path):
        asked = []
        with mock.patch("instruction_set.instruction_set", return_value="AVX-512"):
            with_avx2(lambda folder: asked.append(compiler_flags()) or [])(tmp_path)
        assert asked == [("-march=native", "-mno-avx512f")]
        assert compiler_flags() == ("-march=native",)
