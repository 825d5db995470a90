"""Check house rules that a compiler does not: engine strings, actuators, quaternions, chance.

Prints each finding as ``file:line: reason`` and exits with 1 when there is any. A line that must
break a rule says so itself: a comment with ``rule-ok:`` and the reason.

- MuJoCo's strings and vectors (``mjString*``, ``mjDoubleVec*``) are C++ objects of another library:
  they are read and written by ``mjs_get*`` and ``mjs_set*`` only, never dereferenced.
- Quaternions are xyzw; wxyz lives in mujoco/ and in the conversions that everybody calls.
- Chance comes from base/rng.h: ``std::*_distribution`` differs between standard libraries, and
  global generators make results depend on history.
- An actuator may have several inputs and outputs: its id counts neither, so what is per output is
  read by mujoco/actuators.h, and nothing but tests loops to ``nu``.
- The hooks of a task are called by task/task_calls.h and task/task_judge.h alone, so that their
  errors name the hook and its line everywhere.
- Nothing in the repository names a path of somebody's machine.
- A header that a comment or a page names is there.
- A C++ source has a test that one finds by its name, ``scene.cc`` in ``scene_test.cc``, or stands
  in ``tested_elsewhere.txt`` with the test that holds its behaviour. That list only gets shorter.
- A Python module whose path has no underscore is public: it says by ``__all__`` what it offers. The
  others begin with an underscore, or are in a package that does, and have different names.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from pathlib import Path, PurePath

ENGINE_STRINGS = (
    "bodyname|bodyname1|bodyname2|childclass|comment|content_type|cubefiles|file|geomname1|"
    "geomname2|hfieldname|info|material|meshdir|meshname|modelfiledir|modelname|name|name1|name2|"
    "nodebody|objname|plugin_name|refname|refsite|slidersite|targetbody|texture|texturedir|"
    "textures|userdata|vertbody"
)
USES_SPEC = re.compile(r"\bmjs[A-Z_]")
# *body->name and (*body)->name, but not a * b->name; body->name->c_str().
DEREFERENCE = re.compile(
    rf"(?:(?:^|[=(,{{;!&|?:<>+]|\breturn|\bcase)\s*\*\s*\(?[\w.\->\[\]()]*->(?:{ENGINE_STRINGS})\b"
    rf"(?!\s*(?:->|\[|\()))|->(?:{ENGINE_STRINGS})->"
)
WXYZ = re.compile(r"\w*wxyz\w*", re.IGNORECASE)
WXYZ_CONVERSIONS = {
    "FromWxyz",
    "ToWxyz",
    "QuaternionFromWxyz",
    "QuaternionToWxyz",
    "quaternion_wxyz",
    "quat_wxyz",
}
WXYZ_FILES = re.compile(r"^src/robocell/(mujoco/|math/(rotation|pose)|spec/yaml_reader)|_test\.cc$")
CPP_CHANCE = re.compile(
    r"std::\w+_distribution|std::(mt19937|random_device|default_random_engine)|\bs?rand(48)?\s*\("
)
PYTHON_CHANCE = re.compile(
    r"\b(?:np|numpy)\.random\.(?!Generator|default_rng|SeedSequence|PCG64|Philox)\w+"
    r"|^\s*(?:import random\b|from random import)"
)
# Code of users draws from the global generators, which this file seeds for each start.
SEEDS_USERS_CHANCE = re.compile(r"/compat/molmo_spaces/data_generation/_sampler\.py$")
BY_ACTUATOR = re.compile(
    r"->actuator_(?:gear|acc0|length0|lengthrange)\b|mjModel::nu\b"
    r"|\bfor\s*\([^;]*;[^;]*<\s*[\w.>()-]*->nu\s*;"
)
BY_ACTUATOR_FILES = re.compile(r"^src/robocell/mujoco/actuators\.h$|_test\.cc$")
TASK_HOOK = re.compile(
    r"\btask(?:_|\(\))?(?:->|\.)(?:Prepare|PrepareIn|Bind|Starts|Arrange|Begin|Judge|instruction|"
    r"objects|resting_objects|subtasks|base_range|places|why_not_done|memory|Recall|CanRecall|"
    r"HoldsElsewhere|CheckStart|kind_of|signals|Observe)\("
)
CALLS_TASK_HOOKS = re.compile(
    r"^src/robocell/task/(task|task_calls|task_features|task_judge)\.cc$|_test\.cc$"
    r"|^(?!src/robocell/|python/bindings/)"
)
MACHINE_PATH = re.compile(r"(?<![\w.~])/(?:home|root|work|Users|mnt|media)/\w")
NAMED_HEADER = re.compile(r"(?<![<\w])(?:\w+/)*([\w-]+\.h)\b(?!>)")
OTHERS_HEADERS = {"mujoco.h"}
PACKAGE = "python/robocell"
LISTS_ITS_NAMES = re.compile(r"^__all__\b", re.MULTILINE)
DEFINES = re.compile(r"^(?:def|class|from|import|\w+ =) ?", re.MULTILINE)
MARKER = "rule-ok:"
ELSEWHERE = "scripts/tested_elsewhere.txt"
MOST_ELSEWHERE = 28  # lower it with every test that is written


@dataclass(frozen=True)
class Finding:
    """One broken rule."""

    path: str
    line: int
    reason: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.reason}"


def without_comments(text: str) -> str:
    """C++ text with comments blanked, line numbers kept."""
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.DOTALL)
    return re.sub(r"//[^\n]*", "", text)


def engine_strings(path: str, line: str) -> str | None:
    """A dereferenced field of the engine's spec."""
    match = DEREFERENCE.search(line)
    return match and f"'{match.group().strip()}': use mjs_getString, mjs_setString and friends"


def quaternion_order(path: str, line: str) -> str | None:
    """A wxyz quaternion where only xyzw may be."""
    if WXYZ_FILES.search(path):
        return None
    words = [word for word in WXYZ.findall(line) if word not in WXYZ_CONVERSIONS]
    return f"'{words[0]}': quaternions are xyzw outside mujoco/" if words else None


def actuator_counts(path: str, line: str) -> str | None:
    """What is per input or output, read as if it were per actuator."""
    match = None if BY_ACTUATOR_FILES.search(path) else BY_ACTUATOR.search(line)
    return match and (
        f"'{match.group().strip()}': an actuator's id counts no inputs (nu) or outputs (nout); "
        "see mujoco/actuators.h"
    )


def cpp_chance(path: str, line: str) -> str | None:
    """A source of chance other than base/rng.h."""
    match = CPP_CHANCE.search(line)
    return match and f"'{match.group().strip()}': use robocell/base/rng.h"


def python_chance(path: str, line: str) -> str | None:
    """A global random generator in the Python package."""
    match = None if SEEDS_USERS_CHANCE.search(path) else PYTHON_CHANCE.search(line)
    return match and f"'{match.group().strip()}': use a seeded numpy.random.Generator"


def task_hooks(path: str, line: str) -> str | None:
    """A hook of a task that is called without what makes its errors."""
    match = None if CALLS_TASK_HOOKS.search(path) else TASK_HOOK.search(line)
    return match and f"'{match.group()}': call hooks of tasks through task/task_calls.h"


def machine_path(path: str, line: str) -> str | None:
    """An absolute path that exists on one machine only."""
    match = MACHINE_PATH.search(line)
    return match and f"'{match.group()}...': a path of one machine"


Rule = Callable[[str, str], str | None]


def check_text(path: str, text: str) -> Iterator[Finding]:
    """Broken rules in one file's text; path is relative to the repository."""
    lines = text.splitlines()
    rules: list[Rule] = []
    code = lines
    if path.endswith((".cc", ".h")):
        stripped = without_comments(text)
        code = stripped.splitlines()
        rules = [quaternion_order, actuator_counts, cpp_chance, task_hooks]
        if USES_SPEC.search(stripped):
            rules.append(engine_strings)
    elif path.endswith(".py") and path.startswith("python/robocell/"):
        rules = [python_chance]
    for number, line in enumerate(lines, start=1):
        if MARKER in line:
            continue
        found = [rule(path, code[number - 1]) for rule in rules if number <= len(code)]
        found.append(machine_path(path, line))
        yield from (Finding(path, number, reason) for reason in found if reason)


def missing_headers(path: str, text: str, known: Set[str]) -> Iterator[Finding]:
    """Headers that a C++ comment or a page of docs names and that are in no folder of ours."""
    is_code = path.endswith((".cc", ".h"))
    is_page = path.endswith(".md") and path.startswith("docs/") and "decisions" not in path
    if not is_code and not is_page:
        return
    for number, line in enumerate(text.splitlines(), start=1):
        said = line.partition("//")[2] if is_code else line
        for match in NAMED_HEADER.finditer(said):
            if match[1] not in known | OTHERS_HEADERS:
                yield Finding(path, number, f"there is no header '{match[0]}'")


def untested(root: Path) -> Iterator[Finding]:
    """Sources without a test of their name that are not listed, and wrong entries of the list."""
    folder = root / "src" / "robocell"
    sources = {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*.cc")
        if not path.stem.endswith("_test") and "testing" not in path.parts
    }
    alone = {path for path in sources if not (folder / f"{path[:-3]}_test.cc").exists()}
    lines = (root / ELSEWHERE).read_text().splitlines()
    listed: set[str] = set()
    for number, line in enumerate(lines, start=1):
        if line.startswith("#"):
            continue
        source, _, test = line.partition(": ")
        listed.add(source)
        if source not in alone:
            yield Finding(ELSEWHERE, number, f"'{source}' has a test of its own, or is gone")
        if not (folder / test).is_file():
            yield Finding(ELSEWHERE, number, f"no test '{test}'")
    if len(listed) > MOST_ELSEWHERE:
        reason = f"{len(listed)} sources; the list only gets shorter than {MOST_ELSEWHERE}"
        yield Finding(ELSEWHERE, 1, reason)
    for source in sorted(alone - listed):
        reason = f"no test of this name: write '{source[:-3]}_test.cc'"
        yield Finding(f"src/robocell/{source}", 1, reason)


def python_modules(texts: Mapping[str, str]) -> Iterator[Finding]:
    """Public modules without `__all__`, and private ones of one name; `texts` by their path."""
    names: dict[str, str] = {}
    for path, text in sorted(texts.items()):
        parts = PurePath(path).relative_to(PACKAGE).parts
        name = parts[-1]
        if name.startswith("_") and not name.startswith("__"):
            if (other := names.setdefault(name, path)) != path:
                yield Finding(path, 1, f"'{other}' has the same name")
            continue
        is_public = not any(part.startswith("_") for part in parts[:-1]) and name != "__main__.py"
        if is_public and not LISTS_ITS_NAMES.search(text) and DEFINES.search(text):
            yield Finding(path, 1, "no `__all__`: list what is public, or begin its name with '_'")


def check(root: Path) -> list[Finding]:
    """Broken rules in all text files that git knows or would add."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    findings: list[Finding] = []
    modules: dict[str, str] = {}
    headers = {Path(path).name for path in listing.splitlines() if path.endswith(".h")}
    for path in listing.splitlines():
        file = root / path
        if not file.is_file() or Path(path).stem == "test_check_rules":
            continue
        data = file.read_bytes()
        if b"\0" not in data:
            text = data.decode(errors="replace")
            findings += check_text(path, text)
            findings += missing_headers(path, text, headers)
            if path.startswith(f"{PACKAGE}/") and path.endswith(".py"):
                modules[path] = text
    return [*findings, *python_modules(modules), *untested(root)]


def main() -> int:
    """Check the repository this script belongs to."""
    findings = check(Path(__file__).resolve().parents[1])
    for finding in findings:
        print(finding)
    print(f"house rules: {len(findings)} broken" if findings else "house rules: kept")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
