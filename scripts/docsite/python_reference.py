"""Writes one page for each topic of the Python package; mkdocstrings fills in the docstrings.

The names of a page are those of the module's ``__all__``. The extension's classes are read from
its stubs, `_core.pyi`, which the build writes: they are copied beside links to the package's
sources, so that nothing is imported while the site is built.
"""

from __future__ import annotations

import ast
import os
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "robocell"
STUBS = ROOT / (os.environ.get("ROBOCELL_BUILD") or "build/release") / "python" / "robocell"
# The names that the examples of docstrings use; tests/integration/test_docstrings.py runs them.
EXAMPLES_START = Path(__file__).with_name("examples_start.py")
# Module and what the table of topics says about it, in the order of the navigation.
TOPICS = {
    "robots": "robot files, attachments, `Robot` and its move groups",
    "scene": "`SceneSpec` and its parts, `Scene`, compiling, resets",
    "kinematics": "`Pose`, chains, inverse kinematics",
    "motion": "collision-free motions, straight lines, timing",
    "control": "controllers, commands, the stepper, smooth motions",
    "render": "cameras, `Renderer`, videos",
    "viewer": "the window",
    "scenes": "where runs take place: sources of scenes, and annotations",
    "envs": "`Env`, `EnvBatch`, their configuration, `from_dataset`",
    "tasks": "tasks, experts, samplers and their registration, `Rng`",
    "features": "features of your own in observations and recordings",
    "generate": "`RunConfig`, plans, `Runner`",
    "data": "`Dataset`, `Episode`, rows for learning, verifying, repairing",
    "export": "datasets in the formats of training stacks",
    "importer": "datasets of other formats as episodes",
    "evaluate": "success rates of policies",
    "benchmark": "evaluations from frozen starts",
    "policy": "policies and what they are asked",
    "policy_server": "policies over a socket",
    "teleop": "devices that a person moves, and recording what they do",
    "hardware": "real arms: drivers, what guards them, `connect`",
    "identify": "models of arms fitted to recorded motions",
    "diagnose": "checks of robots and runs, renderers of this machine",
    "models": "built-in robots, objects and scenes",
    "menagerie": "robots of the MuJoCo Menagerie",
    "log": "the level and the destination of messages",
    "gym": "Gymnasium environments",
    "sb3": "vectors of environments for stable-baselines3",
    "lerobot": "environments for LeRobot",
}


def source(topic: str) -> Path:
    """The file of a module of the package."""
    package = PACKAGE / topic / "__init__.py"
    return package if package.is_file() else PACKAGE / f"{topic}.py"


def public_names(file: Path) -> list[str]:
    """The module's `__all__`; without one, the names it defines that have no underscore."""
    body = ast.parse(file.read_text()).body
    for node in body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return list(ast.literal_eval(node.value))
    defined = [node.name for node in body if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    return [name for name in defined if not name.startswith("_")]


def link_package(folder: Path) -> None:
    """Fills `folder` with links to the package's sources, and with its stubs."""
    if not list(STUBS.glob("_core*")):
        raise FileNotFoundError(f"no stubs in {STUBS}; run `make` first")
    package = folder / "robocell"
    shutil.rmtree(package, ignore_errors=True)
    package.mkdir(parents=True)
    for file in PACKAGE.iterdir():
        if file.name != "__pycache__":
            (package / file.name).symlink_to(file)
    for stub in [*STUBS.glob("_core.pyi"), *STUBS.glob("_core/*.pyi")]:
        target = package / stub.relative_to(STUBS)
        target.parent.mkdir(exist_ok=True)
        # info['robots'][name] is no link of Markdown.
        target.write_text(stub.read_text().replace("'][", "']&#91;"))


def topic_page(topic: str) -> str:
    """The page of a module."""
    members = "".join(f"\n        - {name}" for name in public_names(source(topic)))
    return f"# robocell.{topic}\n\n::: robocell.{topic}\n    options:\n      members:{members}\n"


def index() -> str:
    """The page over all topics: the everyday names, and each module with its names."""
    parts = [
        "# Python", "",
        "`import robocell as rc` has the everyday names at its top, and every name in the module"
        " of its topic.", "", "| module | about | names |", "|---|---|---|",
    ]  # fmt: skip
    for topic, about in TOPICS.items():
        names = ", ".join(linked(topic, name) for name in public_names(source(topic)))
        parts.append(f"| [`{topic}`]({topic}.md) | {about} | {names} |")
    top = sorted(set(public_names(PACKAGE / "__init__.py")) - {*TOPICS})
    parts += [
        "", "## What the examples start with", "",
        "The examples on these pages continue this program:", "",
        f"```python\n{EXAMPLES_START.read_text()}```",
    ]  # fmt: skip
    parts += ["", "## At the top", "", ", ".join(f"`rc.{name}`" for name in top), ""]
    return "\n".join(parts)


def linked(topic: str, name: str) -> str:
    """A link to the name; a constant without documentation has none."""
    if name.isupper():
        return f'<autoref optional identifier="robocell.{topic}.{name}">`{name}`</autoref>'
    return f"[`{name}`][robocell.{topic}.{name}]"


def pages() -> dict[str, str]:
    """All pages by src_uri."""
    out = {f"reference/python/{topic}.md": topic_page(topic) for topic in TOPICS}
    out["reference/python/index.md"] = index()
    return out
