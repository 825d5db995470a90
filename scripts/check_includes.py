"""Check who includes whom: the table of layers in docs/architecture.md, enforced.

Reads the ``#include`` lines of src/robocell and python/bindings and prints every forbidden one as
``file:line: reason``. Exit code 1 when there is any. It does not parse C++; an include inside
``#if 0`` counts too.

Installed are the headers that robocell.h reaches (cmake/RobocellHeaders.cmake). They define nothing
in ``robocell::internal``, whose names librobocell does not export: a class of it may be declared
and then named. All other headers declare their names in ``robocell::internal``, except those that
the bindings or only tests use.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

# Each layer may include these directly, beside itself. "+name": name and all that name may include.
TABLE: dict[str, str] = {
    "base": "",
    "math": "base",
    "media": "base",
    "mujoco": "base",
    "spec": "base math",
    "assets": "base spec",
    "scene": "base math mujoco spec assets",
    "kinematics": "base math mujoco",
    "robot": "+scene +kinematics",
    "control": "+robot",
    "render": "+scene media",
    "motion": "+robot",
    "scenes": "+motion +render",
    "features": "+control +render data",
    "task": "+scenes +features",
    "expert": "+task",
    "env": "+task",
    "data": "base math media",
    "rollout": "+env +expert +data",
    "hardware": "base math robot",
    "diagnose": "+rollout",
    "viewer": "+rollout",
}

# Headers that cost seconds to parse or bind users to a library: in .cc files only.
HEAVY = re.compile(
    r"Eigen/(Dense|Eigenvalues|SVD|QR|LU|Cholesky|Sparse)|yaml-cpp/|nlohmann/(?!json_fwd)|kdl/|hdf5|H5|spdlog/"
)
# Headers that only .cc files include: they may be heavy, and other headers may not include them.
INTERNAL = (
    "robocell/data/episode_commit.h",
    "robocell/kinematics/kdl_bridge.h",
    "robocell/spec/yaml_reader.h",
    "robocell/spec/yaml_writer.h",
)
# These headers know no concrete task or expert: `rollout`, the layers above it and the bindings
# know them by their registries only.
BY_REGISTRY = {
    "task": {
        "task",
        "task_kind",
        "task_features",
        "task_judge",
        "sampler_kind",
        "refusal",
        "base_placement",
    },
    "expert": {"expert_kind"},
}
KNOW_NO_TASK = ("rollout", "diagnose", "viewer", "bindings")
# The bindings of the concrete tasks and experts themselves.
BIND_THEM = ("python/bindings/pick.cc",)
KDL_LAYERS = ("kinematics", "bindings")
# Headers that these reach are installed.
ROOTS = ("robocell/robocell.h", "robocell/kinematics/kdl_bridge.h")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
# In C++, what is not code, or is none of the compiler's own.
NO_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|^\s*#(?:[^\n]*\\\n)*[^\n]*|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'',
    re.DOTALL | re.MULTILINE,
)
NAMESPACE = re.compile(r"(?:inline\s+)?namespace\s*([\w:]*)$")
FORWARD = re.compile(r"(?:class|struct|enum(?: class| struct)?) (\w+)(?: : [\w:]+)?")
# A class within another, which has to be where the other one is.
OF_A_CLASS = re.compile(r"(?:class|struct|enum(?: class| struct)?) \w+(?:::\w+)+\b")
NAMES_INTERNAL = re.compile(r"\binternal::(\w+)")


@dataclass(frozen=True)
class Finding:
    """One forbidden include."""

    path: Path
    line: int
    reason: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.reason}"


def allowed(layer: str) -> set[str]:
    """The layers that files of a layer may include, itself among them."""
    result = {layer}
    for word in TABLE[layer].split():
        result |= allowed(word[1:]) if word.startswith("+") else {word}
    return result


def layer_of(path: Path) -> str:
    """The layer a source file belongs to; its path is relative to the repository."""
    if path.parts[:2] == ("python", "bindings"):
        return "bindings"
    return path.parts[2] if len(path.parts) > 3 else "umbrella"


def reason_against(path: Path, header: str) -> str | None:
    """Why the file may not include the header, or None when it may."""
    layer = layer_of(path)
    is_internal = path.as_posix().removeprefix("src/") in INTERNAL
    is_header = path.suffix == ".h" and not is_internal
    if header.startswith("kdl/") and layer not in KDL_LAYERS:
        return f"<{header}>: only kinematics/ and python/bindings may include KDL"
    if is_header and HEAVY.match(header) and layer != "bindings":
        return f"<{header}> is heavy: include it in the .cc file"
    if not header.startswith("robocell/"):
        return None
    if is_header and header in INTERNAL and layer != "bindings":
        return f'"{header}" is internal: include it in .cc files only'
    parts = Path(header).parts
    if len(parts) == 2:
        if layer == "umbrella":
            return None
        return f'"{header}" is for users of the library; include what is needed'
    target = parts[1]
    is_test = path.stem.endswith("_test") or "testing" in path.parts
    if target == "testing":
        ok = is_test or layer == "testing"
        return None if ok else f'"{header}": testing/ is for tests only'
    if target not in TABLE:
        return f'"{header}": there is no layer {target}/'
    knows_none = layer in KNOW_NO_TASK and path.as_posix() not in BIND_THEM
    if not is_test and knows_none and target in BY_REGISTRY:
        known = BY_REGISTRY[target]
        if Path(header).stem not in known:
            return (
                f'{layer}/ may not include "{header}": it knows tasks and experts by their '
                f"registries only ({', '.join(sorted(known))})"
            )
    if layer in ("bindings", "umbrella", "testing") or target in allowed(layer):
        return None
    may = ", ".join(sorted(allowed(layer) - {layer})) or "nothing of ours"
    return f'{layer}/ may not include "{header}" (it may include {may})'


def check_file(root: Path, path: Path) -> Iterator[Finding]:
    """Forbidden includes of one file; path is relative to root."""
    layer = layer_of(path)
    if layer not in (*TABLE, "bindings", "umbrella", "testing"):
        yield Finding(path, 1, f"there is no layer {layer}/; layers: {', '.join(TABLE)}")
        return
    for number, text in enumerate((root / path).read_text().splitlines(), start=1):
        match = INCLUDE.match(text)
        reason = reason_against(path, match.group(1)) if match else None
        if reason:
            yield Finding(path, number, reason)


@dataclass(frozen=True)
class Declaration:
    """The beginning of something that is declared in a namespace, up to its first brace."""

    line: int
    namespace: str
    text: str
    is_forward: bool


def code_of(text: str) -> str:
    """C++ without comments, preprocessor and strings, line numbers kept."""
    return NO_CODE.sub(lambda match: "\n" * match.group().count("\n") or " ", text)


def declarations(text: str) -> Iterator[Declaration]:
    """What a header declares in its namespaces, in order; not what is within classes."""
    scopes: list[str | None] = []  # None for a brace that opens no namespace
    statement, line = "", 1
    for number, row in enumerate(code_of(text).split("\n"), start=1):
        for letter in (*row, "\n"):
            in_block = bool(scopes) and scopes[-1] is None
            if letter in "{};" and not in_block:
                head = " ".join(statement.split())
                statement = ""
                space = NAMESPACE.fullmatch(head) if letter == "{" else None
                if head and not space:
                    is_forward = letter == ";" and bool(FORWARD.fullmatch(head))
                    names = [name for name in scopes if name]
                    yield Declaration(line, "::".join(names), head, is_forward)
                if letter == "{":
                    scopes.append(space.group(1) if space else None)
                elif letter == "}" and scopes:
                    scopes.pop()
            elif letter == "{":
                scopes.append(None)
            elif letter == "}":
                scopes.pop()
            elif not in_block:
                if not statement.strip():
                    line = number
                statement += letter


def is_internal(declaration: Declaration) -> bool:
    """True for a declaration in robocell::internal or in a namespace within it."""
    return f"{declaration.namespace}::".startswith("robocell::internal::")


def check_installed(text: str) -> Iterator[tuple[int, str]]:
    """Lines of an installed header that declare or name what is internal."""
    ours = {
        match.group(1)
        for declaration in declarations(text)
        if is_internal(declaration) and (match := FORWARD.fullmatch(declaration.text))
    }
    for declaration in declarations(text):
        if is_internal(declaration) and not declaration.is_forward:
            reason = "it is internal, but installed headers include this one"
            yield declaration.line, f"'{declaration.text}': {reason}"
    for number, line in enumerate(code_of(text).split("\n"), start=1):
        for found in NAMES_INTERNAL.findall(line):
            if found not in ours:
                yield number, f"'internal::{found}' in an installed header: only what it declares"


def check_hidden(text: str) -> Iterator[tuple[int, str]]:
    """Lines of a header that only robocell itself uses which declare something for everybody."""
    for declaration in declarations(text):
        if not declaration.namespace.startswith("robocell") or is_internal(declaration):
            continue
        if not declaration.is_forward and not OF_A_CLASS.match(declaration.text):
            reason = "only robocell itself uses this header: declare it in robocell::internal"
            yield declaration.line, f"'{declaration.text}': {reason}"


def includes_of(file: Path) -> set[str]:
    """The headers that a file includes."""
    matches = (INCLUDE.match(line) for line in file.read_text().splitlines())
    return {match.group(1) for match in matches if match}


def check_names(root: Path) -> Iterator[Finding]:
    """Names in the wrong one of the namespaces robocell and robocell::internal."""
    src = root / "src"
    waiting, installed = [name for name in ROOTS if (src / name).is_file()], set[str]()
    while waiting:
        name = waiting.pop()
        if name not in installed and (src / name).is_file():
            installed.add(name)
            waiting += [found for found in includes_of(src / name) if found.startswith("robocell/")]
    bound = set[str]()
    for file in (root / "python" / "bindings").rglob("*.[ch]*"):
        bound |= includes_of(file)
    for file in sorted((src / "robocell").rglob("*.h")):
        name = file.relative_to(src).as_posix()
        if name in installed:
            found = check_installed(file.read_text())
        elif name in bound or "/testing/" in name:
            continue
        else:
            found = check_hidden(file.read_text())
        yield from (Finding(file.relative_to(root), line, reason) for line, reason in found)


def check(root: Path) -> list[Finding]:
    """Forbidden includes of all C++ files under root."""
    files = [
        file.relative_to(root)
        for folder in ("src/robocell", "python/bindings")
        for pattern in ("*.h", "*.cc")
        for file in sorted((root / folder).rglob(pattern))
    ]
    found = [finding for file in files for finding in check_file(root, file)]
    return found + list(check_names(root))


def main() -> int:
    """Check the repository this script belongs to."""
    findings = check(Path(__file__).resolve().parents[1])
    for finding in findings:
        print(finding)
    print(f"includes: {len(findings)} forbidden" if findings else "includes: as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
