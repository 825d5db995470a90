"""Several runs that make one dataset: `runs:` of a file for `robocell generate`."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from robocell._core import SpecError

import robocell
from command_line import RUN, refused, robocell_command
from contents import contents
from robocell._dataset_run import manifest_of_dataset
from robocell._generation.mixture import MixtureJob, PartJob, is_mixture, load_mixture
from robocell._generation.mixture_work import _Maker
from robocell._generation.observer import Observer
from robocell._generation.resume import DamagedEpisodesError
from robocell._generation.supervisor import Limits
from robocell._own_code import modules_of_one_run
from robocell.data.derive import extend

BLIND = {**RUN, "cameras": {"draw": False}}


def write(folder: Path, **fields: object) -> Path:
    """Two runs, and the mixture of them."""
    runs = {
        "pick": {**BLIND, "run": "pick", "episodes_per_scene": 2},
        "far": {
            **BLIND,
            "run": "far",
            "seed": 3,
            "start": {**RUN["start"], "base_distance": [0.5, 0.52]},
        },
    }
    for name, run in runs.items():
        (folder / f"{name}.yaml").write_text(yaml.safe_dump({**run, "output": "unused"}))
    mixture = {
        "run": "both",
        "runs": ["pick.yaml", {"run": "far.yaml", "episodes": 1}],
        "output": str(folder / "out"),
        "workers": 1,
    }
    file = folder / "mixture.yaml"
    file.write_text(yaml.safe_dump({**mixture, **fields}))
    return file


@pytest.mark.proof
def test_a_mixture_is_one_dataset_with_the_bytes_of_its_runs(tmp_path: Path):
    file = write(tmp_path)
    done = robocell_command("generate", file)
    assert done.returncode == 0, done.stderr
    out = tmp_path / "out"
    ids = ["far_s0000_e0000", "pick_s0000_e0000", "pick_s0000_e0001"]
    assert sorted(robocell.Dataset(out).ids) == ids
    assert robocell.data.verify(out).ok
    alone = robocell_command("generate", tmp_path / "pick.yaml", "--output", tmp_path / "alone")
    assert alone.returncode == 0, alone.stderr
    assert contents(out / ".parts" / "pick") == contents(tmp_path / "alone")
    steps = (out / ids[1] / "steps.h5").read_bytes()
    assert steps == (tmp_path / "alone" / "s0000_e0000" / "steps.h5").read_bytes()

    report = robocell_command("report", out, "--episodes").stdout
    assert "3 of 3" in report
    assert all(name in report for name in ids)

    # Damaged episodes are links to damaged ones. The same command makes them again, and adds more.
    before = contents(out)
    with (out / ids[0] / "steps.h5").open("r+b") as file_of_both:
        file_of_both.seek(100)
        file_of_both.write(b"damage")
    repaired = robocell_command("verify", "--repair", out)
    assert repaired.returncode == 0, repaired.stdout
    assert not (out / ids[0]).exists()
    assert not (out / ".parts" / "far" / "s0000_e0000").exists()
    write(tmp_path, runs=["pick.yaml", {"run": "far.yaml", "episodes": 2}])
    more = robocell_command("generate", file)
    assert more.returncode == 0, more.stderr
    assert "4 of 4 (2 made before)" in more.stdout
    after = contents(out)
    assert {name: after[name] for name in before if name != "dataset.json"} == {
        name: content for name, content in before.items() if name != "dataset.json"
    }
    assert set(robocell.Dataset(out).ids) == {*ids, "far_s0000_e0001"}
    assert robocell.data.verify(out).ok

    described = out / ".parts" / "pick" / "s0000_e0000" / "episode.json"
    described.write_text("{}")
    with modules_of_one_run():
        job = MixtureJob(load_mixture(str(file)))
        with pytest.raises(DamagedEpisodesError, match="pick") as error:
            job.made()
    assert len(error.value.made) == 3
    repaired = robocell_command("verify", "--repair", out)
    assert repaired.returncode == 0, repaired.stdout
    assert not described.exists()

    write(tmp_path, runs=["pick.yaml"])
    assert "begun with the run 'far', which the file no longer has" in refused("generate", file)
    for option in (["--shard", "0/2"], ["--episodes", "3"]):
        assert "are of one run" in refused("generate", file, *option)


def test_names_that_look_like_items_are_told_apart(tmp_path: Path):
    runs = ["pick.yaml", {"run": "pick.yaml", "name": "pick_s0000"}]
    maker = _Maker(load_mixture(str(write(tmp_path, runs=runs))), robocell.generate.StopFlag())
    assert maker._split("pick_s0000_e0000") == ("pick", "s0000_e0000")
    assert maker._split("pick_s0000_s0001_e0002") == ("pick_s0000", "s0001_e0002")


def test_nothing_is_written_before_all_runs_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def inspect(part: PartJob, observer: Observer, limits: Limits) -> dict[str, str]:
        if part.run.run == "far":
            raise SpecError("it cannot work")
        return {}

    monkeypatch.setattr(PartJob, "inspect", inspect)
    with modules_of_one_run():
        job = MixtureJob(load_mixture(str(write(tmp_path)), workers=3))
        assert [part.workers for part in job.parts.values()] == [3, 3], "for the estimate"
        with pytest.raises(SpecError, match="it cannot work"):
            job.prepare(Observer(), Limits())
    assert not (tmp_path / "out").exists()


def test_a_mixture_without_an_episode_yet_is_an_empty_dataset(tmp_path: Path):
    (tmp_path / "part").mkdir()
    (tmp_path / "out").mkdir()
    parts = [(robocell.Dataset(tmp_path / "part"), "pick")]
    assert extend(tmp_path / "out", parts, {"mixture": ["pick"]}) == 0
    assert not robocell.Dataset(tmp_path / "out").ids
    assert manifest_of_dataset(tmp_path / "out")["derived"]["mixture"] == ["pick"]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"runs": []}, "runs is not a list of run files"),
        ({"runs": ["pick.yaml", "pick.yaml"]}, "another run is called 'pick'"),
        ({"runs": ["nowhere.yaml"]}, "there is no run file"),
        ({"runs": ["mixture.yaml"]}, "has `runs`, too. List its runs here"),
        ({"runs": [{"run": "pick.yaml", "episode": 2}]}, "Did you mean 'episodes'?"),
        ({"runs": [{"run": "pick.yaml", "episodes": 0}]}, "is not a number of episodes: 0"),
        ({"runs": [{"run": "pick.yaml", "name": "../x"}]}, "the name '../x' begins ids"),
        ({"runs": [3]}, "is neither a run file nor"),
        ({"worker": 2}, "Did you mean 'workers'?"),
        ({"workers": "all"}, "is not a number of processes: 'all'"),
    ],
)
def test_mistakes_are_named_with_their_line(tmp_path: Path, fields: dict, message: str):
    file = write(tmp_path, **fields)
    assert is_mixture(str(file))
    with pytest.raises(SpecError, match=r"mixture.yaml:\d+:\d+") as error:
        load_mixture(str(file))
    assert message in str(error.value)


def test_what_belongs_to_all_runs_is_not_replaced_in_each(tmp_path: Path):
    with pytest.raises(robocell.ArgumentError, match="write `episodes` beside a run"):
        load_mixture(str(write(tmp_path)), overrides=["episodes=3"])
    assert not is_mixture(str(tmp_path / "pick.yaml"))
    assert not is_mixture(str(tmp_path / "nowhere.yaml"))
    mixture = load_mixture(str(write(tmp_path)), output="elsewhere", workers=3)
    assert (mixture.output, mixture.workers) == (Path("elsewhere"), 3)


HOUSES = Path(__file__).parents[2] / "examples/houses"


def test_the_example_in_houses_has_what_its_first_line_says():
    parts = load_mixture(str(HOUSES / "houses.yaml")).parts
    runs = [part.source.load(list(part.overrides)) for part in parts]
    plans = [robocell.generate.make_plan(run) for run in runs]
    assert sum(len(plan) for plan in plans) == 200
    assert len({run.robot.name for run in runs}) == 3
    assert len({run.task.kind for run in runs}) == 4
    for run, plan in zip(runs, plans, strict=True):
        assert {item.scene for item in plan} == set(range(20))
        assert [stream.name for stream in run.cameras.streams] == ["wrist", "side", "high"]


@pytest.mark.proof
def test_the_example_in_houses_makes_episodes_of_all_its_runs(tmp_path: Path):
    """One of each run, with a page of pictures; and what slept in them changes no replay."""
    names = ("pick", "place", "next_to", "stack")
    runs = [{"run": str(HOUSES / f"{name}.yaml"), "episodes": 1} for name in names]
    file = tmp_path / "houses.yaml"
    out = tmp_path / "out"
    file.write_text(yaml.safe_dump({"run": "houses", "runs": runs, "output": str(out)}))
    assert robocell_command("generate", file, "--render-kept").returncode == 0
    dataset = robocell.Dataset(out)
    assert len(dataset) == 4
    assert all(episode.success for episode in dataset)
    assert robocell_command("replay", out, "--tolerance", "0").returncode == 0
    assert robocell_command("report", out, "-o", tmp_path / "page.html").returncode == 0
    assert (tmp_path / "page.html").stat().st_size > 50_000
