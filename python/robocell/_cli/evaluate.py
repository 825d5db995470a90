"""`robocell evaluate`: measures the success rate of a policy or an expert, from new starts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

from robocell._cli.common import (
    ExitCode,
    print_warning,
    print_wide,
    require_preset,
    require_run_source,
)
from robocell._core import atomic_write

if TYPE_CHECKING:
    from robocell.evaluate import Evaluation


def evaluate(
    source: Annotated[
        str,
        typer.Argument(
            metavar="DATASET|RUN.yaml|BENCHMARK.json",
            help="A dataset, for its cell; a run file; or a file of `robocell benchmark`, which "
            "says seed and episodes.",
        ),
    ],
    policy: Annotated[
        str,
        typer.Option(
            metavar="MODULE:CLASS|URL",
            help="module:Class or file.py:Class of a policy, ws://HOST:PORT of a policy server, "
            "zmq://HOST:PORT of GR00T's, or expert, random, replay.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PATH",
            help="Folder of the rollouts. Default: DATASET_evaluation/POLICY-SEED, beside the "
            "dataset or the run file.",
        ),
    ] = None,
    episodes: Annotated[
        int | None,
        typer.Option(
            "--episodes",
            "-n",
            min=1,
            help="Number of rollouts, each from its own start. Default: 100; for replay all.",
        ),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Worker processes.")] = 1,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the starts.")] = None,
    no_cameras: Annotated[
        bool, typer.Option("--no-cameras", help="Draw no images, and keep no videos.")
    ] = False,
    no_rollouts: Annotated[
        bool,
        typer.Option(
            "--no-rollouts", help="Keep results, seeds and failures, and no episodes: faster."
        ),
    ] = False,
    imports: Annotated[
        list[str] | None,
        typer.Option("--import", metavar="MODULE", help="A module that registers tasks."),
    ] = None,
    item_timeout: Annotated[
        float,
        typer.Option(
            "--item-timeout", metavar="S", min=1.0, help="Time limit of a rollout, seconds."
        ),
    ] = 1800.0,
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME|FILE.yaml",
            help="Names and units that a policy server expects: droid, libero, aloha, roboarena, "
            "or a file.",
        ),
    ] = "",
    horizon: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Actions of a chunk to take before the next call. Default: those of the preset, "
            "or all.",
        ),
    ] = None,
    ensemble: Annotated[
        bool,
        typer.Option(
            "--ensemble", help="Take the mean of what all chunks say about a moment (ACT)."
        ),
    ] = False,
    policy_timeout: Annotated[
        float | None,
        typer.Option(
            "--policy-timeout",
            metavar="S",
            min=0.001,
            help="Longest time of a call of a policy server, seconds. Default: 120.",
        ),
    ] = None,
    latency: Annotated[
        str,
        typer.Option(
            metavar="MS|measured|recorded:PATH",
            help="Simulated time from an observation to its actions; actions of the last chunk are "
            "taken meanwhile: milliseconds, those of each call, or those recorded in another "
            "evaluation. Default: 0, the simulation waits.",
        ),
    ] = "0",
    max_steps: Annotated[
        int | None,
        typer.Option(
            "--max-steps",
            min=1,
            metavar="N",
            help="Actions after which a rollout fails. Default: those of the run; in a recorded "
            "environment those of its longest episode.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Measure a policy's success rate.

    Every policy gets the same starts. Repeat the command to continue.

    Exit codes:
    0  evaluated
    1  some rollouts could not be made, or errors of the policy ended all
    2  wrong command or spec
    3  reading or writing failed
    """
    from robocell._generation.supervisor import Limits
    from robocell._raised import without_names
    from robocell.evaluate import evaluate as evaluate_run

    def print_count(done: int, of: int, success: bool) -> None:
        if not as_json and (done == of or done % 10 == 0):
            print(f"{done}/{of} rollouts", flush=True)

    require_run_source(source)
    require_preset(preset)
    run: Callable[..., Evaluation] = evaluate_run
    if source.endswith(".json"):
        from robocell.benchmark import evaluate as run
    result = run(
        source,
        policy,
        episodes=episodes,
        workers=workers,
        seed=seed,
        output=output,
        cameras=not no_cameras,
        imports=imports or [],
        on_rollout=print_count,
        limits=Limits(item_timeout_s=item_timeout),
        preset=preset,
        horizon=horizon,
        ensemble=ensemble,
        policy_timeout_s=policy_timeout,
        latency=latency,
        rollouts=not no_rollouts,
        max_steps=max_steps,
    )
    atomic_write(Path(result.dataset) / "evaluation.json", (result.to_json() + "\n").encode())
    if as_json:
        print(result.to_json())
    else:
        print_wide(_table(result))
        if kinds := result.breakdown.get("object"):
            listed = ", ".join(f"{kind} {good}/{of}" for kind, (good, of) in kinds.items())
            print(f"success by object: {listed}")
        if result.failures:
            failures = result.failures.items()
            counts = ", ".join(f"{without_names(reason)} {count}" for reason, count in failures)
            print(f"failures: {counts}")
        if result.server and result.latency:
            calls = result.latency
            print(
                f"calls of the policy: {calls['calls']}, median {calls['median_ms']:.3g} ms, "
                f"99 % below {calls['p99_ms']:.3g} ms"
            )
        print(f"rollouts: {result.dataset}")
    if result.unmade:
        print_warning(
            f"{result.unmade} rollouts could not be made, see above; they count "
            "neither as success nor as failure"
        )
    every = 0 < result.rollouts == result.policy_errors
    if every:
        print_warning("errors of the policy ended every rollout, see above: it was not evaluated")
    if result.unmade or every:
        raise typer.Exit(ExitCode.INCOMPLETE)


def _table(result: Evaluation) -> Table:
    low, high = (100 * bound for bound in result.interval)
    table = Table(box=SIMPLE)
    columns = {
        "policy": result.policy,
        "success": f"{result.successes}/{result.rollouts}",
        "rate": f"{100 * result.rate:.0f} %",
        "95 % interval": f"{low:.0f} ... {high:.0f} %",
        "mean length": f"{result.mean_length:.1f}",
        "errors": str(result.policy_errors),
    }
    for name in columns:
        table.add_column(name, justify="left" if name == "policy" else "right", no_wrap=True)
    table.add_row(*map(Text, columns.values()))
    return table
