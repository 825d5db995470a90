"""Check who includes whom: the table of layers in docs/architecture.md, enforced.

Reads the ``#include`` lines of src/robocell and python/bindings and prints every forbidden one as
``file:line: reason``. Exit code 1 when there is any. It does not parse C++; an include inside
``#if 0`` counts too.

A function is defined in the layer that declares it, but for those of DEFINED_ABOVE.

Installed are the headers that robocell.h reaches (cmake/RobocellHeaders.cmake). It includes none
that only the bindings use: the documentation, an example or another public header names what each
of them declares. They define nothing
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
    "hardware": "+robot",
    "diagnose": "+rollout",
    "viewer": "+rollout",
}

# Functions that a layer declares and one above it defines, since reading a configuration needs the
# kinds that only higher layers know: file of the declaration -> name. No other may be so.
DEFINED_ABOVE = {
    "src/robocell/spec/task_spec.h": "TaskKindRegistry",
    "src/robocell/spec/scene_source_spec.h": "SceneSourceRegistry",
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
# These headers know no concrete task or expert: `rollout`, the layers above it, `env` and the
# bindings know them by their registries only.
BY_REGISTRY = {
    "task": {
        "task",
        "task_kind",
        "task_features",
        "task_calls",
        "task_judge",
        "task_sampler",
        "sampler_kind",
        "refusal",
        "start_cameras",
        "start_contents",
        "start_sampler",
        "start_turn",
        "base_placement",
        "grasp",
        "grasp_generator",
        "grasp_library",
        "grasp_proof",
        "reachable_grasps",
    },
    "expert": {"demonstration", "expert", "expert_kind"},
}
# The layers between data/ and `rollout` know only its schema types: a task knows nothing of
# files.
SCHEMA_TYPES = {"column", "episode_schema", "feature_schema"}
KNOW_NO_FILES = ("features", "task", "expert", "env")
KNOW_NO_TASK = ("env", "rollout", "diagnose", "viewer", "bindings")
# The bindings of the concrete tasks and experts themselves.
BIND_THEM = ("python/bindings/pick.cc", "python/bindings/pick_fields.cc")
# Layers below task/ cannot include a task; they may not name one either.
NAME_NO_TASK = ("spec", "scene", "robot", "motion", "scenes", "features", *KNOW_NO_TASK)
# A struct with the fields of a kind, and the kind.
KIND_STRUCT = re.compile(
    r'^struct (\w+) \{(?:(?!^\};).)*?\bkKind = "(\w+)";', re.DOTALL | re.MULTILINE
)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
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
ANONYMOUS = "(anonymous)"
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
    knows_schema = target == "data" and layer in KNOW_NO_FILES and not is_test
    if knows_schema and Path(header).stem not in SCHEMA_TYPES:
        return (
            f'{layer}/ may not include "{header}": of data/ it knows the schema only '
            f"({', '.join(sorted(SCHEMA_TYPES))})"
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
                    scopes.append((space.group(1) or ANONYMOUS) if space else None)
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


# Kinds of tasks whose names mean other things too, such as the "press" of a mouse button: their
# structs tell them apart.
PLAIN_WORDS = {"open", "close", "press", "push", "stack", "insert", "sort", "pour"}


def concrete_tasks(root: Path) -> dict[str, str]:
    """The structs of fields in task/, and the C++ texts of their kinds; each with what it is."""
    found = dict[str, str]()
    for file in sorted((root / "src/robocell/task").glob("*.h")):
        for struct, kind in KIND_STRUCT.findall(file.read_text()):
            found[struct] = f"the fields of task '{kind}'"
            if kind not in PLAIN_WORDS:
                found[f'"{kind}"'] = "the name of a task"
    return found


def check_tasks(root: Path, path: Path, tasks: dict[str, str]) -> Iterator[Finding]:
    """Lines of a file that name a concrete task, in a layer that knows none."""
    is_test = path.stem.endswith("_test") or "testing" in path.parts
    if is_test or layer_of(path) not in NAME_NO_TASK or path.as_posix() in BIND_THEM:
        return
    code = COMMENT.sub(lambda match: "\n" * match.group().count("\n"), (root / path).read_text())
    for number, line in enumerate(code.splitlines(), start=1):
        for word in re.findall(r'"\w+"|\w+', line):
            if word in tasks:
                reason = f"{word} is {tasks[word]}: {layer_of(path)}/ knows tasks by registry only"
                yield Finding(path, number, reason)


# The beginning of a function that belongs to no class: "void InspectRobot(const".
FUNCTION = re.compile(r"(?:\[\[\w+\]\] )?[\w:<>,*& ]+[\s*&](\w+)\(")


def functions_of(file: Path) -> dict[str, int]:
    """The functions that a file declares or defines for other files: name -> line."""
    found = dict[str, int]()
    for declaration in declarations(file.read_text()):
        match = FUNCTION.match(declaration.text)
        words = declaration.text.split("(")[0].split()
        if declaration.namespace.endswith(ANONYMOUS):
            continue
        if match and not {"template", "operator", "=", "using", "struct", "class"} & set(words):
            found[match.group(1)] = declaration.line
    return found


def check_definitions(root: Path) -> Iterator[Finding]:
    """Functions that one layer defines and a lower one declares."""
    folder = root / "src" / "robocell"
    declared = dict[str, set[str]]()  # name -> layers
    files = dict[tuple[str, str], Path]()
    for file in sorted(folder.rglob("*.h")):
        path = file.relative_to(root)
        for name in functions_of(file):
            declared.setdefault(name, set()).add(layer_of(path))
            files[name, layer_of(path)] = path
    for file in sorted(folder.rglob("*.cc")):
        path = file.relative_to(root)
        layer = layer_of(path)
        if path.stem.endswith("_test") or layer not in TABLE:
            continue
        for name, line in functions_of(file).items():
            layers = declared.get(name, set())
            if not layers or layer in layers:
                continue
            for lower in sorted(layers & allowed(layer)):
                where = files[name, lower]
                if DEFINED_ABOVE.get(where.as_posix()) != name:
                    yield Finding(path, line, f"{name} is declared in {where}: define it there")


def includes_of(file: Path) -> set[str]:
    """The headers that a file includes."""
    matches = (INCLUDE.match(line) for line in file.read_text().splitlines())
    return {match.group(1) for match in matches if match}


def installed_headers(root: Path) -> set[str]:
    """The headers that ROOTS reach."""
    src = root / "src"
    waiting, installed = [name for name in ROOTS if (src / name).is_file()], set[str]()
    while waiting:
        name = waiting.pop()
        if name not in installed and (src / name).is_file():
            installed.add(name)
            waiting += [found for found in includes_of(src / name) if found.startswith("robocell/")]
    return installed


def bound_headers(root: Path) -> set[str]:
    """The headers that the bindings include."""
    files = (root / "python" / "bindings").rglob("*.[ch]*")
    return {header for file in files for header in includes_of(file)}


# The texts that C++ users read. Headers that none of them names are not for users.
FOR_USERS = ("README.md", "docs/**/*.md", "examples/**/*.cc", "tests/integration/**/*.cc")
DECLARED = re.compile(
    r"(?:template ?<[^>]*> ?)?(?:class|struct|enum(?: class| struct)?|concept|using) (\w+)"
)
MACRO = re.compile(r"^#define (ROBOCELL_\w+)", re.MULTILINE)


def check_for_users(root: Path) -> Iterator[Finding]:
    """Headers that robocell.h includes and only the bindings use."""
    src, umbrella = root / "src", root / "src" / "robocell" / "robocell.h"
    if not umbrella.is_file():
        return
    read = "\n".join(file.read_text() for glob in FOR_USERS for file in sorted(root.glob(glob)))
    words, files = set(re.findall(r"\w+", read)), set(re.findall(r"\w+\.h\b", read))
    bound = bound_headers(root)
    others = {
        header
        for name in installed_headers(root) - {"robocell/robocell.h"}
        for header in includes_of(src / name)
    }
    for number, line in enumerate(umbrella.read_text().splitlines(), start=1):
        header = match.group(1) if (match := INCLUDE.match(line)) else ""
        if header not in bound or header in others or Path(header).name in files:
            continue
        text = (src / header).read_text()
        names = set(functions_of(src / header)) | set(MACRO.findall(text))
        names |= {m.group(1) for d in declarations(text) if (m := DECLARED.match(d.text))}
        if not names & words:
            reason = f"only the bindings use {header}: leave it out, or document what it is for"
            yield Finding(umbrella.relative_to(root), number, reason)


def check_names(root: Path) -> Iterator[Finding]:
    """Names in the wrong one of the namespaces robocell and robocell::internal."""
    src, installed, bound = root / "src", installed_headers(root), bound_headers(root)
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
    tasks = concrete_tasks(root)
    found = [finding for file in files for finding in check_file(root, file)]
    found += [finding for file in files for finding in check_tasks(root, file, tasks)]
    found += [*check_names(root), *check_definitions(root)]
    return found + list(check_for_users(root))


def main() -> int:
    """Check the repository this script belongs to."""
    findings = check(Path(__file__).resolve().parents[1])
    for finding in findings:
        print(finding)
    print(f"includes: {len(findings)} forbidden" if findings else "includes: as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
