"""The public names that people use most, by count in docs, examples and tests.

    python scripts/docsite/most_used_names.py           the hundred of Python and of C++
    python scripts/docsite/most_used_names.py --most 200

A use of a member counts for its class. If several classes have such a member, it counts for the one
that the variable is named after: `robot_spec.prefix` is RobotSpec's. A use that fits no class, or
several, does not count. Nothing is imported.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import cpp_reference
from public_docstrings import docstrings

ROOT = Path(__file__).resolve().parents[2]
MOST = 100
# A name that is no member; functions of Python's modules are used as `rc.data.verify`.
PYTHON_WORD = re.compile(
    r"(?<![.\w])(?:(?:rc|robocell)\.(?:\w+\.)?)?([A-Z]\w*)|(?<![.\w])(?:rc|robocell)\.(?:\w+\.)?([a-z]\w+)"
)
CPP_WORD = re.compile(r"(?<![.>:\w])(?:robocell::)?([A-Z]\w*)")
MEMBER = re.compile(r"\b(\w+)(?:\([^()]*\))?(?:\[[^\[\]]*\])*(?:\.|->|::)(\w+)\b")
# Variables that are not named after the class of what they hold.
VARIABLES = {
    "arm": "MoveGroup", "base": "Pose", "config": "RobotConfig", "cube": "SceneObject",
    "found": "IkResult", "goal": "Pose", "group": "MoveGroup", "gripper": "AttachmentSpec",
    "move": "PoseMove", "recorder": "VideoRecorder", "request": "SampleRequest",
    "run": "RunConfig", "solver": "IkSolver", "spec": "SceneSpec", "tcp": "Pose",
    "target": "Pose", "vector": "EnvBatch", "video": "VideoRecorder",
}  # fmt: skip
# Containers, strings, arrays and standard types have these members too.
COMMON = {
    *dir(list), *dir(dict), *dir(str), *dir(Path),
    "Read", "Write", "add", "all", "at", "begin", "build", "c_str", "dtype", "empty", "end", "fill",
    "find", "height", "matrix", "max", "min", "norm", "pos", "push_back", "read", "run", "seed",
    "shape", "size", "str", "time", "width", "write",
}  # fmt: skip


def tracked(*patterns: str) -> list[Path]:
    """The files that git knows."""
    command = ["git", "ls-files", *patterns]
    listing = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [path for name in listing.splitlines() if (path := ROOT / name).is_file()]


def blocks(language: str) -> Iterator[str]:
    """Code blocks of the pages."""
    for page in tracked("README.md", "docs/**/*.md", "docs/*.md"):
        yield "\n".join(
            re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
        )


def python_programs() -> Iterator[str]:
    """The Python that users read: pages, notebooks, examples and tests."""
    yield from blocks("python")
    for notebook in tracked("docs/notebooks/*.ipynb"):
        cells = json.loads(notebook.read_text())["cells"]
        yield "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")
    for file in tracked("examples/*.py", "examples/**/*.py", "python/tests/*.py", "tests/**/*.py"):
        yield file.read_text()


def cpp_programs() -> Iterator[str]:
    """The C++ that users read: pages, examples and tests."""
    yield from blocks("cpp")
    for file in tracked("examples/*.cc", "examples/**/*.cc", "src/robocell/**/*_test.cc"):
        yield re.sub(r"//.*", "", file.read_text())


@cache
def cpp_names() -> set[str]:
    """The public types, functions and member functions, such as 'Scene::Step'."""
    found = set()
    for header in cpp_reference.public_headers():
        lines = (cpp_reference.SRC / header).read_text().split("\n")
        for declaration in cpp_reference.declarations(lines):
            for code in declaration.code:
                name = cpp_reference.name_of(code)
                kind, _, plain = name.rpartition(" ")
                if not re.fullmatch(r"\w+", plain) or plain.startswith("ROBOCELL_"):
                    continue
                found.add(plain)
                if kind in ("class", "struct"):
                    found |= {f"{plain}::{member}" for member in member_functions(code, plain)}
    return found


def member_functions(code: str, owner: str) -> set[str]:
    """The names of a class's functions, without constructors and operators."""
    found = re.findall(r"^  (?! )(?:[^()=\n]*?[ &*])?(\w+)\(", code, re.MULTILINE)
    return {name for name in found if name not in (owner, "operator", "explicit", "noexcept")}


def snake(name: str) -> str:
    """'SceneSpec' as 'scene_spec'."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def count(
    programs: Iterable[str], names: set[str], dot: str, word: re.Pattern[str]
) -> Counter[str]:
    """How often each name is used; `dot` is between a class and its member."""
    owners: dict[str, set[str]] = {}
    for name in names:
        if dot in name:
            owner, _, member = name.rpartition(dot)
            owners.setdefault(member, set()).add(owner)
    uses: Counter[str] = Counter()
    for text in programs:
        modules = set(re.findall(r"^(?:import|from .* import) .*?(\w+)$", text, re.MULTILINE))
        uses.update(found[found.lastindex or 0] for found in word.finditer(text))
        for variable, member in MEMBER.findall(text):
            found = owners.get(member, set())
            if variable in found:
                uses[f"{variable}{dot}{member}"] += 1
            elif found and variable not in modules | {"self", "rc", "robocell", "std"}:
                owner = owner_of(variable.strip("_"), found, member)
                if owner:
                    uses[f"{owner}{dot}{member}"] += 1
    return Counter({name: uses[name] for name in names if uses[name]})


def owner_of(variable: str, owners: set[str], member: str) -> str:
    """The class that a variable is named after, else the only one with such a member."""
    named = [owner for owner in owners if snake(owner) == variable]
    named += [owner for owner in owners if VARIABLES.get(variable) == owner]
    if named:
        return named[0]
    return next(iter(owners)) if len(owners) == 1 and member not in COMMON else ""


@cache
def python_counts() -> Counter[str]:
    """Uses of each public name of the Python package."""
    return count(python_programs(), {*docstrings()}, ".", PYTHON_WORD)


@cache
def cpp_counts() -> Counter[str]:
    """Uses of each public name of the C++ library."""
    return count(cpp_programs(), cpp_names(), "::", CPP_WORD)


def most_used(counts: Counter[str], most: int = MOST) -> list[str]:
    """The names that are used most; of as many uses, the first by name."""
    return sorted(counts, key=lambda name: (-counts[name], name))[:most]


def main() -> None:
    """Prints both lists."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--most", type=int, default=MOST, help="names of each language")
    most = parser.parse_args().most
    for language, counts in {"Python": python_counts(), "C++": cpp_counts()}.items():
        print(language)
        for name in most_used(counts, most):
            print(f"  {counts[name]:5d}  {name}")


if __name__ == "__main__":
    main()
