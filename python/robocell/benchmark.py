"""Benchmarks: JSON files with frozen starts, so that two people evaluate the same episodes.

    create("examples/demo.yaml", "picks.json", episodes=100)
    result = evaluate("picks.json", "my_policy.py:Policy")

A start is drawn again from the run and its seed, and then compared with the file, number by number:
another model, sampler or version is an error instead of another success rate.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robocell import __version__
from robocell._core import (
    ArgumentError,
    Dataset,
    IoError,
    NotFoundError,
    PlanItem,
    RunConfig,
    RunEnv,
    atomic_write,
    json_damage,
    make_plan,
    prepare_dataset,
    self_hashed_json,
)
from robocell._dataset_run import manifest_of_dataset
from robocell._generation.run_source import RunSource
from robocell._molmospaces_benchmark import from_molmospaces, to_molmospaces
from robocell._named_modules import (
    hash_of,
    imports_of,
    needed_imports,
    require_named,
    stored_name,
)
from robocell._own_code import modules_of_one_run
from robocell.evaluate import SEED, Evaluation
from robocell.evaluate import evaluate as evaluate_run

__all__ = ["Benchmark", "create", "evaluate", "load"]

FORMAT, VERSION = "robocell-benchmark", 1
MOLMOSPACES = "molmospaces"
SCHEMAS = (FORMAT, MOLMOSPACES)
CONTENT: dict[str, type] = {
    "source": str,
    "imports": dict,
    "seed": int,
    "task": str,
    "starts": list,
    "files": dict,
}
# Columns of a row that describe a start have names that end so.
STATE = ("/qpos", "/base_pose", "/pose")


@dataclass(frozen=True)
class Benchmark:
    """A benchmark.

    Attributes:
        path: Its file.
        source: The run file or dataset, as a path from the file's folder or absolute.
        imports: Modules that register its task or features -> SHA-256 of their files. Paths are
            relative to the file's folder.
        seed: Seed of the starts.
        task: The task with all its fields, as YAML: what counts as a success.
        starts: Each start: `id`, `instruction`, `object_kinds`, and the numbers of its `state`.
        files: SHA-256 of the files of the models, by name.
    """

    path: Path
    source: str
    imports: dict[str, str]
    seed: int
    task: str
    starts: tuple[dict[str, Any], ...]
    files: dict[str, str]

    @property
    def place(self) -> Path:
        """Where the run file or the dataset is."""
        return self.path.parent / self.source


def create(
    source: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    episodes: int = 100,
    seed: int = SEED,
    imports: Sequence[str] = (),
    schema: str = FORMAT,
    on_start: Callable[[int, int], None] | None = None,
) -> Benchmark:
    """Draws starts, and writes them to a file.

    Args:
        source: A run file or a dataset.
        out: The file to write; it must not exist.
        episodes: Number of starts.
        seed: Seed of the starts. The default is that of `robocell.evaluate`.
        imports: Modules to import first, which register the task or features.
        schema: "robocell-benchmark", or "molmospaces" for a list of MolmoSpaces' episodes, which
            robocell reads as well.
        on_start: Is called with the number of starts that are drawn, and of all.

    Raises:
        ArgumentError: `out` exists, there are less than one start, or there is no such schema.
        SpecError: The run is not one.
        IoError: The file cannot be written.
    """
    if episodes < 1:
        raise ArgumentError(f"episodes is {episodes}; at least 1")
    if schema not in SCHEMAS:
        raise ArgumentError(f"no schema '{schema}' of benchmarks. Schemas: {', '.join(SCHEMAS)}")
    path = Path(out)
    if path.exists():
        raise ArgumentError(f"'{path}' exists already. Choose another name; nothing is replaced")
    if not Path(source).exists():
        raise NotFoundError(f"there is no run file or dataset '{source}', which a benchmark names")
    named = [imports] if isinstance(imports, str) else imports
    needed = needed_imports(source, named)
    with modules_of_one_run():
        run = _run_of(source, named, seed, episodes)
        starts = []
        plan = make_plan(run)[:episodes]
        details = {
            "scene_dataset": run.scenes.source,
            "robot_name": run.robot.name,
            "img_resolution": [int(side) for side in run.cameras.resolution],
            "task_type": run.task.kind,
        }
        for done, start in enumerate(_drawn(run, plan), 1):
            starts.append(start)
            if on_start is not None:
                on_start(done, episodes)
        manifest = _manifest_of(run)
    relative = os.path.relpath(Path(source).resolve(), path.resolve().parent)
    content = {
        "format": FORMAT,
        "format_version": VERSION,
        "source": relative,
        "imports": {
            stored_name(name, file, path.absolute().parent): hash_of(file)
            for name, file in needed.items()
        },
        "seed": seed,
        "task": _task_of(manifest),
        "versions": {"robocell": __version__, **manifest.get("versions", {})},
        "files": manifest.get("files", {}),
        "starts": starts,
        "json_sha256": "0" * 64,
    }
    if schema == MOLMOSPACES:
        text = to_molmospaces(content, [item.scene for item in plan], details)
    else:
        text = self_hashed_json(json.dumps(content, indent=1) + "\n")
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(path, text.encode())
    return load(path)


def load(file: str | os.PathLike[str]) -> Benchmark:
    """Reads a benchmark, in either schema.

    Raises:
        ArgumentError: The episodes are those of MolmoSpaces itself.
        IoError: The file cannot be read, is damaged, or is no benchmark of this version.
    """
    path = Path(file)
    try:
        text = path.read_text()
        content = json.loads(text)
    except (OSError, ValueError) as error:
        raise IoError(f"cannot read benchmark '{path}': {error}") from error
    is_molmospaces = isinstance(content, list)
    if is_molmospaces:
        content = from_molmospaces(content, path)
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise IoError(f"'{path}' is no benchmark; `robocell benchmark` writes one")
    if content.get("format_version") != VERSION:
        raise IoError(
            f"benchmark '{path}' has the format version {content.get('format_version')}; this "
            f"robocell reads {VERSION}"
        )
    if not is_molmospaces and (damage := json_damage(text)) is not None:
        raise IoError(f"benchmark '{path}' is damaged or was edited: {damage}")
    for name, kind in CONTENT.items():
        if not isinstance(content.get(name), kind) or (name == "starts" and not content[name]):
            raise IoError(
                f"benchmark '{path}' has no {name} of this version of robocell; write it again "
                "with `robocell benchmark`"
            )
    return Benchmark(
        path,
        content["source"],
        content["imports"],
        content["seed"],
        content["task"],
        tuple(content["starts"]),
        content["files"],
    )


def evaluate(
    benchmark: Benchmark | str | os.PathLike[str],
    policy: str,
    *,
    output: str | os.PathLike[str] | None = None,
    imports: Sequence[str] = (),
    **options: Any,
) -> Evaluation:
    """Evaluates a policy from the starts of a benchmark.

    The file imports nothing: `imports` names the modules that it needs, after reading them.

    Args:
        benchmark: A benchmark or its file.
        policy: As for `robocell.evaluate.evaluate`.
        output: Folder of the rollouts; default: beside the file, `<name>_evaluation/<policy>-...`.
        imports: The modules of the benchmark and of its run file, by name or file; their contents
            have to be those that the benchmark was made with.
        options: Further arguments of `robocell.evaluate.evaluate`; seed and episodes are those of
            the benchmark.

    Raises:
        ArgumentError: A start, a file of the models or a module is not that of the benchmark; a
            module is not named; or an option belongs to the benchmark.
        NotFoundError: The run file or dataset is not where the benchmark says.
    """
    from robocell.evaluate import default_output

    own = benchmark if isinstance(benchmark, Benchmark) else load(benchmark)
    for name in ("seed", "episodes"):
        if options.get(name):
            raise ArgumentError(f"{name} is that of the benchmark '{own.path}'; leave it out")
        options.pop(name, None)
    if not own.place.exists():
        raise NotFoundError(
            f"benchmark '{own.path}' is of '{own.source}', and there is no '{own.place}'"
        )
    if not options.get("rollouts", True):
        raise ArgumentError(
            "--no-rollouts: a benchmark compares the starts of its rollouts, so it keeps them"
        )
    if policy == "replay":
        raise ArgumentError("a benchmark has new starts, and no recorded actions to replay")
    named = [imports] if isinstance(imports, str) else list(imports)
    command = ["robocell", "evaluate", str(own.path), "--policy", policy]
    command += [] if output is None else ["--output", str(output)]
    require_named(own.path, own.imports, imports_of(own.place).values(), named, command)
    with modules_of_one_run():
        run = _run_of(own.place, named, own.seed, len(own.starts))
        first = next(iter(_drawn(run, make_plan(run)[:1])))
        manifest = _manifest_of(run)
    _require_same(own, own.starts[0], first)  # before hours of rollouts
    _require_same_task(own, manifest)
    place = Path(output) if output is not None else default_output(own.path, policy, own.seed)
    result = evaluate_run(
        own.place,
        policy,
        episodes=len(own.starts),
        seed=own.seed,
        imports=named,
        output=place,
        **options,
    )
    _require_rollouts(own, Dataset(Path(result.dataset)))
    return result


def _run_of(
    source: str | os.PathLike[str], imports: Sequence[str], seed: int, episodes: int
) -> RunConfig:
    """Returns the run with the seed and number of the starts, without images."""
    # A dataset is the source of evaluations only.
    policy = "expert" if Path(source).is_dir() else ""
    overrides = [f"seed={seed}", f"episodes={episodes}", "output=nowhere"]
    run = RunSource(str(source), tuple(imports), policy).load(overrides)
    run.cameras.draw = False
    return run


def _drawn(run: RunConfig, plan: Sequence[PlanItem]) -> Iterator[dict[str, Any]]:
    """Yields the starts of items of a plan."""
    cell = RunEnv(run)
    for item in plan:
        cell.reset(item.index)
        row = cell.row()
        yield {
            "id": item.id,
            "instruction": cell.instruction,
            "object_kinds": list(cell.object_kinds),
            "state": {
                name: np.ravel(value).tolist() for name, value in row.items() if _is_state(name)
            },
        }


def _manifest_of(run: RunConfig) -> dict[str, Any]:
    """Returns what a dataset of the run would say of it. Changes the run's output."""
    with tempfile.TemporaryDirectory() as folder:
        run.output = str(Path(folder) / "out")
        prepare_dataset(run)
        return manifest_of_dataset(run.output) or {}


def _task_of(manifest: dict[str, Any]) -> str:
    """Returns the task in a dataset's description of its run."""
    lines = str(manifest.get("identity", "")).splitlines(keepends=True)
    first = next((i for i, line in enumerate(lines) if line.startswith("task:")), len(lines))
    task = lines[first : first + 1]
    for line in lines[first + 1 :]:
        if not line.startswith(" "):
            break
        task.append(line)
    return "".join(task)


def _is_state(name: str) -> bool:
    return name.endswith(STATE) and "/action/" not in name


def _require_rollouts(own: Benchmark, rollouts: Dataset) -> None:
    """Raises ArgumentError unless rollouts began as the benchmark says, with its models."""
    _require_same_task(own, manifest_of_dataset(rollouts.folder) or {})
    for start in own.starts:
        if start["id"] in rollouts:
            episode = rollouts[start["id"]]
            state = {
                name: np.ravel(episode[name][0]).tolist()
                for name in start["state"]
                if name in episode
            }
            _require_same(own, start, {"state": state})


def _require_same_task(own: Benchmark, manifest: dict[str, Any]) -> None:
    """Raises ArgumentError unless a dataset has the task and the models of the benchmark."""
    for name, digest in manifest.get("files", {}).items():
        if own.files.get(name, digest) != digest:
            raise ArgumentError(
                f"'{name}' is not the file that benchmark '{own.path}' was made with: its rollouts "
                "cannot be compared with those of others"
            )
    if (task := _task_of(manifest)) != own.task:
        raise ArgumentError(
            f"the task is not that of benchmark '{own.path}', so its successes mean something "
            f"else:\n{task}instead of\n{own.task}"
        )


def _require_same(own: Benchmark, start: dict[str, Any], found: dict[str, Any]) -> None:
    """Raises ArgumentError with the first number that differs."""
    for name, values in start["state"].items():
        there = found["state"].get(name)
        if there != values:
            raise ArgumentError(
                f"benchmark '{own.path}': start '{start['id']}' is another one here: '{name}' is "
                f"{there} instead of {values}. Use the run file, the models and the version of "
                "robocell that the benchmark names"
            )
