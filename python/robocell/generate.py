"""Generating a dataset: the run and its plan, in this process, or with worker processes.

    run = robocell.RunConfig.load("pick.yaml")
    robocell.generate.prepare_dataset(run)
    runner = robocell.generate.Runner(run)
    for item in robocell.generate.make_plan(run):
        print(runner.run(item))

`robocell generate` makes the episodes in worker processes.
"""

from robocell._core import (
    ActionNoiseConfig,
    AugmentConfig,
    ItemResult,
    Keep,
    PlanItem,
    RenderWhen,
    RunConfig,
    Runner,
    StopFlag,
    is_complete,
    items_on_disk,
    make_plan,
    parse_shard,
    prepare_dataset,
    require_same_run,
    run_identity,
    shard_plan,
    validate_dataset,
)

__all__ = [
    "ActionNoiseConfig",
    "AugmentConfig",
    "ItemResult",
    "Keep",
    "PlanItem",
    "RenderWhen",
    "RunConfig",
    "Runner",
    "StopFlag",
    "is_complete",
    "items_on_disk",
    "make_plan",
    "parse_shard",
    "prepare_dataset",
    "require_same_run",
    "run_identity",
    "shard_plan",
    "validate_dataset",
]
