"""Writes docs/spec_fields.md: every field of what scenes, runs and environments are made of.

From the declarations in src/robocell/spec, by way of the docstrings that Python has of them.
"""

from __future__ import annotations

import enum
import re
import sys
from pathlib import Path

import numpy as np

import robocell as rc
from robocell.scenes import FilesScenes, HousesScenes

PAGE = Path(__file__).parent / "spec_fields.md"
SCENES = (rc.SceneSpec, rc.RobotSpec, rc.SceneObject, rc.scene.SimOptions)
RUNS = (
    rc.RunConfig,
    rc.tasks.PickTaskConfig,
    rc.tasks.PickAndPlaceTaskConfig,
    rc.tasks.RelationsTaskConfig,
    rc.tasks.StackTaskConfig,
    rc.tasks.PlaceNextToTaskConfig,
    rc.tasks.OpenTaskConfig,
    rc.tasks.CloseTaskConfig,
    rc.tasks.PressTaskConfig,
    rc.tasks.PushTaskConfig,
    rc.tasks.InsertTaskConfig,
    rc.tasks.SortTaskConfig,
    rc.tasks.WipeTaskConfig,
    rc.tasks.PourTaskConfig,
    rc.tasks.HandoverTaskConfig,
    rc.tasks.CarryTaskConfig,
    rc.tasks.NavigateTaskConfig,
    rc.tasks.StartConfig,
    rc.tasks.RandomizeConfig,
    rc.tasks.RandomLights,
    rc.tasks.RandomLook,
    rc.tasks.RandomDynamics,
    rc.tasks.RandomClutter,
    rc.tasks.RandomNumber,
    rc.tasks.RandomProperty,
    rc.tasks.RandomizedValue,
    rc.tasks.StartCamera,
    rc.tasks.CameraSight,
    rc.generate.AugmentConfig,
    rc.generate.ActionNoiseConfig,
    rc.scenes.ObjectPlace,
    rc.scenes.SceneSourceSpec,
    FilesScenes,
    HousesScenes,
    rc.render.CameraSystemConfig,
    rc.render.CameraConfig,
    rc.render.RendererConfig,
    rc.render.RenderQuality,
    rc.control.Rates,
)
ENVIRONMENTS = (
    rc.EnvConfig,
    rc.envs.EnvObject,
    rc.envs.ObjectVariation,
    rc.envs.CameraAdderConfig,
    rc.envs.SimSettings,
    rc.envs.WrapperConfig,
)
PYTHON_ONLY = ("gravity_z",)  # another name for a part of a field
HEAD = """# All fields of scenes, runs and environments

Written by `docs/make_spec_fields.py` from the declarations in `src/robocell/spec`. What robots are
made of (`RobotConfig`, `AttachmentSpec`, `CameraSpec`, edits): [robots](robots.md#reference). A
field without a default is unset, or empty.
"""


def default(value: object) -> str:
    """As it is written in YAML; nothing for what is unset."""
    if isinstance(value, enum.Enum):
        return f"`{value.name.lower()}`"
    if isinstance(value, np.ndarray):
        return f"`[{', '.join(f'{number:g}' for number in value)}]`"
    if isinstance(value, rc.Pose):
        return "the identity"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, int | float):
        return f"`{value:g}`"
    if isinstance(value, rc.robots.AttachTarget):
        return f"`{value.kind.name.lower()}`"
    return f"`{value}`" if isinstance(value, str) and value else ""


def fields(spec: type) -> list[str]:
    """The names of a spec's fields, in the order of their declaration."""
    return [
        name
        for name, value in vars(spec).items()
        if isinstance(value, property) and name not in PYTHON_ONLY
    ]


def meaning(spec: type, name: str) -> str:
    """The docstring of a field without the array's shape, which the default shows."""
    text = " ".join(getattr(spec, name).__doc__.split())
    return re.sub(r" Shape \(\d+,\)\.$", "", text)


def table(spec: type) -> str:
    """One spec as a table."""
    empty = spec()
    lines = [
        f"| `{name}` | {meaning(spec, name)} | {default(getattr(empty, name))} |"
        for name in fields(spec)
    ]
    head = f"### {spec.__name__}\n{(spec.__doc__ or '').strip().splitlines()[0]}\n"
    return "\n".join([head, "| field | meaning | default |", "|---|---|---|", *lines, ""])


def page() -> str:
    """The whole page."""
    parts = [HEAD, "## Scenes\n", *map(table, SCENES), "## Runs\n", *map(table, RUNS)]
    parts += ["## Environments\n", *map(table, ENVIRONMENTS)]
    return "\n".join(parts)


def main() -> int:
    """Writes it; with --check says whether it is as it would be written."""
    if "--check" in sys.argv:
        return 0 if PAGE.read_text() == page() else 1
    PAGE.write_text(page())
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
