"""The page of `robocell report --output`: its numbers against oracles, and what it must not do."""

from __future__ import annotations

import json
import os
import shutil
import time
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell
from command_line import refused, robocell_command
from report_dataset import mixed_dataset
from robocell._generation.items import ItemRecord
from robocell._report import facts, motion, pictures, rollouts, variation
from robocell._report.facts import EarlierAttempt, EpisodeFacts
from robocell._report.page import Contents, thousands, write
from robocell.data import derive
from robocell.evaluate import wilson_interval

HOSTILE = "</script><script>document.title = 'taken'</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mixed_dataset(tmp_path_factory)


@pytest.fixture(scope="module")
def page(dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    out = tmp_path_factory.mktemp("page") / "report.html"
    result = robocell_command("report", dataset, "-o", out)
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith(f"{out}: 6 episodes, time series of 6, pictures of ")
    return out.read_text()


class Parts(HTMLParser):
    """Links, sources and text of a page, without its scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.tags: Counter[str] = Counter()
        self.text = ""
        self._hidden = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags[tag] += 1
        self._hidden = tag in ("script", "style")
        self.links += [
            v or "" for k, v in attrs if k in ("src", "href", "srcset", "data", "action")
        ]

    def handle_endtag(self, tag: str) -> None:
        self._hidden = False

    def handle_data(self, data: str) -> None:
        self.text += "" if self._hidden else f" {data}"


def test_a_page_is_one_file_that_needs_no_network(page: str):
    parts = Parts(page)
    assert all(link.startswith(("data:image/", "#")) for link in parts.links)
    assert parts.tags["link"] == parts.tags["iframe"] == 0
    assert "default-src 'none'" in page, "the browser fetches nothing, whatever a script asks for"
    assert "@import" not in page.partition("<script>")[0]
    assert "url(" not in page.partition("<script>")[0]
    assert len(page) < 8_000_000


def test_a_page_shows_counts_rates_and_reasons(dataset: Path, page: str):
    text = " ".join(Parts(page).text.split())
    episodes = list(robocell.Dataset(dataset))
    good = sum(episode.success for episode in episodes)
    assert 0 < good < len(episodes), "the dataset has both"
    low, high = wilson_interval(good, len(episodes))
    assert f"6 episodes {good} successful" in text
    assert f"{100 * good / 6:.0f} % of 6 rollouts succeeded" in text
    assert f"95 %: {100 * low:.1f} … {100 * high:.1f} %" in text
    assert f"timeout : {6 - good} (100 % of the failures)" in text
    for episode in episodes:
        assert episode.success or episode.id in text
    assert f"{sum(map(len, episodes))} rows" in text
    assert "64 x 48" in text
    assert "mujoco" in text
    assert f"robocell verify {dataset}" in text
    assert "source: tabletop" in text, "the run file"
    assert page.count("data:image/webp") == good + 1, "a loop of each success and each reason"


def test_every_episode_counts_once(dataset: Path):
    found, damaged, misnamed = facts.read(dataset)
    assert (damaged, misnamed) == ({}, {})
    told = json.loads((dataset / "report.json").read_text())["episodes"]
    reported = rollouts.count(found, [ItemRecord.from_json(item) for item in told])
    unreported = rollouts.count(found, [])
    for counted in (reported, unreported):
        assert counted.whole.rollouts == 6
        assert counted.whole.successes == sum(episode.success for episode in found)
        assert counted.failures == {"timeout": 6 - counted.whole.successes}
        assert [rate.name for rate in counted.by["robot"]] == ["rc7"]
        assert [rate.name for rate in counted.by["task"]] == ["pick"]
        kinds = {rate.name: rate.rollouts for rate in counted.by["object"]}
        assert kinds == Counter(episode.object_kind for episode in found)


def an_episode(name: str, **changes: Any) -> EpisodeFacts:
    known: dict[str, Any] = {
        "id": name,
        "item": name,
        "object_kind": "mug",
        "target": "target",
        "task": "pick",
        "instruction": "pick up the mug",
        "robots": ("rc7",),
        "success": True,
        "end_reason": "success",
        "rows": 10,
        "rate": 10.0,
        "frames": 0,
        "bytes": 1,
        "keep": "successes",
        "earlier": (),
        "scene": "",
        "cameras": {},
        "versions": {},
        "warnings": (),
        "seed": 0,
    }
    return EpisodeFacts(**{**known, **changes})


def test_attempts_before_an_episode_count_unless_they_are_episodes():
    earlier = (EarlierAttempt("mug", True, "too far"), EarlierAttempt("box", False, "dropped"))
    counted = rollouts.count([an_episode("a", earlier=earlier), an_episode("b")], [])
    assert (counted.whole.successes, counted.whole.rollouts) == (2, 3)
    assert counted.failures == {"dropped": 1}
    assert counted.refusals == {"too far": 1}
    assert counted.sampled == 4
    assert {rate.name: rate.rollouts for rate in counted.by["object"]} == {"mug": 2, "box": 1}
    first = an_episode("a_a00", item="a", keep="all", success=False, end_reason="dropped")
    second = an_episode("a_a01", item="a", keep="all", earlier=earlier)
    counted = rollouts.count([first, second], [])
    assert (counted.whole.successes, counted.whole.rollouts) == (1, 2)
    assert (counted.failures, counted.refusals) == ({"dropped": 1}, {"too far": 1})


def test_attempts_in_which_a_users_code_raised_are_failures_without_a_rollout():
    earlier = (EarlierAttempt("mug", False, "mine.py:3, in act: no", raised=True),)
    for keep in ("successes", "all"):
        counted = rollouts.count([an_episode("a", keep=keep, earlier=earlier)], [])
        assert (counted.whole.successes, counted.whole.rollouts) == (1, 1)
        assert counted.failures == {"mine.py:3, in act: no": 1}
        record = ItemRecord("a", success=True, attempts=2, accepted=1, failures=counted.failures)
        assert rollouts.count([an_episode("a", keep=keep)], [record]).whole == counted.whole
    described = [{"object_kind": "mug", "failed": "no", "raised": True}, {"failed": "dropped"}]
    read = facts._earlier({"earlier_attempts": described})
    assert [attempt.raised for attempt in read] == [True, False]


def test_items_that_were_given_up_count():
    given_up = ItemRecord(
        "b",
        attempts=5,
        accepted=3,
        refusals={"too far": 2},
        failures={"dropped": 3},
        robot="rc7",
        rollouts={"nut": 3},
    )
    counted = rollouts.count([an_episode("a")], [given_up])
    assert (counted.whole.successes, counted.whole.rollouts) == (1, 4)
    assert {rate.name: rate.share for rate in counted.by["object"]} == {"mug": 1.0, "nut": 0.0}
    assert counted.by["task"] == [rollouts.Rate("pick", 1, 4)], "a run has one task"


def test_randomised_values_are_those_that_differ():
    def scene(i: int) -> str:
        return (
            "name: x\nobjects:\n  - name: target\n    mass: 0.1\n"
            f"    pos: [{0.01 * i}, 0, 0.4]\n    rgba: [{i % 2}, 0, 0, 1]\n"
            f"    quat: [0, 0, {np.sin(0.05 * i)}, {np.cos(0.05 * i)}]\ncameras: []\n"
        )

    episodes = [an_episode(f"e{i:02d}", scene=scene(i), success=i >= 10) for i in range(20)]
    heights = {episode.id: {"rc7: base height, m": 0.4 + i} for i, episode in enumerate(episodes)}
    found = {each.name: each for each in variation.find(episodes, heights)}
    assert list(found) == [
        "target: x, m",
        "target: angle about z, rad",
        "target: colour",
        "rc7: base height, m",
    ]
    for each in found.values():
        assert sum(group.rollouts for group in each.groups) == 20
        assert sum(group.successes for group in each.groups) == 10
    assert [g.share for g in found["target: x, m"].groups] == [0, 0, 0.5, 1, 1]
    assert found["target: angle about z, rad"].values["e03"] == pytest.approx(0.3)
    assert [g.name for g in found["target: colour"].groups] == ["#000000", "#ff0000"]


def test_the_value_that_explains_the_failures_comes_first():
    rng = np.random.default_rng(1)
    noise, mass = rng.uniform(0, 1, 60), rng.uniform(0.5, 2, 60)
    episodes = [
        replace(
            an_episode(f"e{i:02d}", success=bool(mass[i] < 1.4)),
            randomized={
                "light/0/intensity": float(noise[i]),
                "cube/mass_scale": float(mass[i]),
                "table/texture": "wood" if i % 2 else "noise",
                "light/number": 2.0,
            },
        )
        for i in range(60)
    ]
    found = {effect.name: effect for effect in variation.effects(episodes)}
    assert next(iter(found)) == "cube/mass_scale"
    heavy = found["cube/mass_scale"]
    assert heavy.share > 0.6
    assert [group.share for group in heavy.groups][::4] == [1.0, 0.0]
    assert sum(group.rollouts for group in heavy.groups) == 60
    assert found["light/0/intensity"].share < 0.1
    assert found["table/texture"].range == "noise, wood"
    assert found["light/number"].groups == []
    assert found["light/number"].range == "2"


def test_recorded_values_become_numbers_and_words():
    recorded = {
        "cube/colour": [1, 0, 0.5],
        "cube/texture": "wood",
        "cube/texture_seed": 12,
        "light/number": 2,
        "strange": {"a": 1},
    }
    assert facts._randomized(recorded) == {
        "cube/colour, red": 1.0,
        "cube/colour, green": 0.0,
        "cube/colour, blue": 0.5,
        "cube/texture": "wood",
        "light/number": 2.0,
    }
    assert facts._randomized(None) == {}


@pytest.mark.parametrize("scene", ["", "objects: [", "objects: 3", "objects:\n  - 7", "\0"])
def test_scenes_that_are_not_specs_have_no_randomised_values(scene: str):
    assert variation.find([an_episode("a", scene=scene), an_episode("b", scene=scene)], {}) == []


def joints(positions: np.ndarray, speeds: np.ndarray, rate: float) -> motion.Joints:
    return motion.Joints(
        robot="r",
        group="arm",
        names=["a"],
        units=["rad"],
        lower=np.array([-1.0]),
        upper=np.array([1.0]),
        positions=[positions[:, None]],
        speeds=[speeds[:, None]],
        jerks=[np.diff(speeds[:, None], n=2, axis=0) * rate**2],
        episodes=["e"],
    )


def test_limits_speeds_and_jerks_are_those_of_the_curve():
    rate = 50.0
    t = np.arange(51) / rate
    (one,) = motion.numbers(joints(1.1 * t**3, 3.3 * t**2, rate), most_speed=2.0)
    assert one.jerk == pytest.approx(6.6), "of a cubic curve the jerk is constant"
    assert one.speed == pytest.approx(3.3)
    assert one.too_fast == (3.3 * t**2 > 2).sum()
    assert one.beyond == (1.1 * t**3 > 1.001).sum() > 0
    assert one.worst == pytest.approx(0.1)
    assert (one.least, one.greatest) == (0, pytest.approx(1.1))
    assert one.violating == ["e"]
    assert one.near == pytest.approx((1.1 * t**3 > 0.96).mean())
    (still,) = motion.numbers(joints(np.zeros(5), np.zeros(5), rate))
    assert (still.beyond, still.too_fast, still.jerk, still.violating) == (0, None, 0, [])
    assert still.density.sum() == pytest.approx(1)


def test_motion_agrees_with_the_columns(dataset: Path):
    found, _, _ = facts.read(dataset)
    read = motion.read(robocell.Dataset(dataset), found)
    assert read.read == [episode.id for episode in found]
    arm = read.joints["rc7", "arm"]
    episodes = list(robocell.Dataset(dataset))
    every = np.concatenate([episode["robots/rc7/arm/qpos"] for episode in episodes])
    numbers = motion.numbers(arm)
    assert [each.greatest for each in numbers] == pytest.approx(every.max(axis=0))
    assert [each.upper for each in numbers[:2]] == [2.9, 1.9], "rc7.xml, without a margin"
    assert all(each.beyond == 0 for each in numbers)
    tcp = read.tcps["rc7"]
    first = episodes[0]["robots/rc7/tcp_pose_in_base"][:, :3]
    assert tcp.lengths[0] == pytest.approx(np.linalg.norm(np.diff(first, axis=0), axis=1).sum())
    gripper = read.grippers["rc7"]
    for episode, (closings, openings) in zip(episodes, gripper.counts, strict=True):
        commanded = episode["robots/rc7/gripper/target"][:, 0] > 0.5
        assert closings == (commanded[:-1] & ~commanded[1:]).sum()
        assert openings == (~commanded[:-1] & commanded[1:]).sum()
    heights = [read.started[e.id]["rc7: base height, m"] for e in episodes]
    assert heights == [e["robots/rc7/base_pose"][0, 2] for e in episodes]


def test_samples_keep_the_share_of_failures():
    episodes = [an_episode(f"{i}", success=i % 10 != 0) for i in range(1000)]
    sampled = motion.sample(episodes, 100)
    assert len(sampled) == 100
    assert sum(not episode.success for episode in sampled) == pytest.approx(10, abs=1)
    assert [int(each.id) for each in sampled] == sorted(int(each.id) for each in sampled)
    assert motion.sample(episodes[:3], 100) == episodes[:3]


def test_pictures_show_as_many_kinds_as_possible():
    camera = {"cameras": {"wrist": (64, 48, 15.0, "colour")}}
    episodes = [an_episode(f"{i}", object_kind="abc"[i // 4], **camera) for i in range(12)]
    episodes.append(an_episode("blind", object_kind="d"))
    chosen = pictures.chosen(episodes, 4)
    assert Counter(episode.object_kind for episode in chosen) == {"a": 2, "b": 1, "c": 1}
    lost = [replace(e, success=False, end_reason=f"why {i % 2}") for i, e in enumerate(episodes)]
    assert list(pictures.failed(lost, 5)) == ["why 0", "why 1"]


def test_names_from_a_dataset_are_text(dataset: Path, tmp_path: Path):
    found, _, _ = facts.read(dataset)
    names = {"instruction": HOSTILE, "object_kind": HOSTILE, "task": HOSTILE, "robots": (HOSTILE,)}
    changed = [replace(episode, cameras={}, end_reason=HOSTILE, **names) for episode in found]
    out = tmp_path / "report.html"
    write(Contents(dataset, changed, [], [HOSTILE], {HOSTILE: HOSTILE}), out)
    page = out.read_text()
    assert "<script>document" not in page
    assert "<img src=x" not in page
    assert HOSTILE in Parts(page).text


def test_damaged_episodes_are_named_on_the_page(dataset: Path, tmp_path: Path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    ids = robocell.Dataset(copy).ids
    (copy / ids[0] / "episode.json").write_text("{")
    (copy / "report-0-of-2.json").write_text("{")
    (copy / ids[1] / "steps.h5").write_bytes(b"0" * (copy / ids[1] / "steps.h5").stat().st_size)
    result = robocell_command("report", copy, "-o", tmp_path / "report.html")
    assert result.returncode == 3
    assert "5 episodes, time series of 4" in result.stdout
    text = Parts((tmp_path / "report.html").read_text()).text
    named = (
        f"{ids[0]}': episode.json is damaged",
        "report-0-of-2.json' is damaged",
        f"{ids[1]}': 'steps.h5' is damaged",
    )
    for said in named:
        assert said in text
        assert said in result.stderr


def test_datasets_without_cameras_and_without_a_report_have_a_page(dataset: Path, tmp_path: Path):
    found, _, _ = facts.read(dataset)
    bare = [replace(each, cameras={}, robots=(), rate=None, scene="") for each in found]
    out = tmp_path / "report.html"
    written = write(Contents(dataset, bare, []), out)
    assert (written.pictured, written.read) == (0, 6)
    text = Parts(out.read_text()).text
    assert "No pictures: no successful episode has a camera" in text
    assert "The episodes have no columns of robots" in text
    assert "There is no report.json" in text


def test_the_command_rejects_what_it_cannot_write(dataset: Path, tmp_path: Path):
    page = tmp_path / "report.html"
    page.write_text("mine")
    assert f"'{page}' exists. Replace it with --force" in refused("report", dataset, "-o", page)
    assert page.read_text() == "mine"
    assert "give the page a name: " in refused("report", dataset, "-o", tmp_path)
    assert f"give '{tmp_path / 'a.html'}'" in refused("report", dataset, "-o", tmp_path / "a.pdf")
    missing = tmp_path / "none" / "report.html"
    assert "there is no folder" in refused("report", dataset, "-o", missing, code=3)
    said = refused("report", dataset, "-o", "/proc/report.html", "--sample", 1, code=3)
    assert "cannot write '/proc/report.html'" in said
    other = tmp_path / "other.html"
    assert "--json print" in refused("report", dataset, "-o", other, "--json")
    assert "add --output FILE.html" in refused("report", dataset, "--sample", 3)
    assert "is not a speed" in refused("report", dataset, "-o", other, "--max-speed", -1)
    (tmp_path / "empty" / ".quarantine").mkdir(parents=True)
    assert "holds no episodes" in refused("report", tmp_path / "empty", "-o", other)
    assert not other.exists()


def test_sampling_force_and_speed_limits(dataset: Path, tmp_path: Path):
    page = tmp_path / "report.html"
    page.write_text("old")
    options = ("--sample", 2, "--max-speed", 0.01, "--force")
    result = robocell_command("report", dataset, "-o", page, *options)
    assert result.returncode == 0, result.stderr
    assert "6 episodes, time series of 2, " in result.stdout
    text = " ".join(Parts(page.read_text()).text.split())
    assert "time series of 2 of 6 episodes, evenly spread over results" in text
    assert "faster than 0.01" in text
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_large_numbers_are_grouped():
    assert thousands(12345678) == "12\u202f345\u202f678"


EPISODES = 10_000


@pytest.mark.soak
def test_ten_thousand_episodes_have_a_page_within_a_minute(dataset: Path, tmp_path: Path):
    there = robocell.Dataset(dataset)
    for number in range(EPISODES):
        source = there[number % len(there)]
        place = tmp_path / "many" / f"e{number:05d}"
        place.mkdir(parents=True)
        for file in source.folder.iterdir():
            if file.name != "episode.json":
                os.link(file, place / file.name)
        (place / "episode.json").write_text(derive._renamed(source, place.name))
    out = tmp_path / "many.html"
    began = time.monotonic()
    said = robocell_command("report", tmp_path / "many", "-o", out)
    elapsed = time.monotonic() - began
    assert said.returncode == 0, said.stderr
    assert said.stdout.startswith(f"{out}: {EPISODES} episodes, ")
    assert elapsed < 60
