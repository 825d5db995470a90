"""Check who includes whom: the table of layers in docs/architecture.md, enforced.

Reads the ``#include`` lines of src/robocell and python/bindings and prints every forbidden one as
``file:line: reason``. Exit code 1 when there is any. It does not parse C++; an include inside
``#if 0`` counts too.

Installed are the headers that robocell.h reaches (cmake/RobocellHeaders.cmake). Headers of the
namespace ``robocell::internal`` are not among them: no header outside of it may include one.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

# What each layer may include directly, beside itself. "+name": name and all that name may include.
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
# Of tasks and experts, what knows no concrete one: `rollout` and what stands above it know them by
# their registries only.
BY_REGISTRY = {
    "task": {
        "task",
        "task_kind",
        "visible_from",
        "task_features",
        "sampler_kind",
        "refusal",
        "base_placement",
    },
    "expert": {"expert_kind"},
}
KNOW_NO_TASK = ("rollout", "diagnose", "viewer")
KDL_LAYERS = ("kinematics", "bindings")
# What makes a header one that is not installed.
HIDDEN = re.compile(r"^namespace robocell::internal\b", re.MULTILINE)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


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
    if not is_test and layer in KNOW_NO_TASK and target in BY_REGISTRY:
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


def check_public(root: Path) -> Iterator[Finding]:
    """Headers of the public namespace that include one of robocell::internal."""
    texts = {file: file.read_text() for file in sorted((root / "src" / "robocell").rglob("*.h"))}
    hidden = {
        file.relative_to(root / "src").as_posix()
        for file, text in texts.items()
        if HIDDEN.search(text)
    }
    for file, text in texts.items():
        name = file.relative_to(root / "src")
        if name.as_posix() in hidden or "testing" in name.parts:
            continue
        for number, line in enumerate(text.splitlines(), start=1):
            match = INCLUDE.match(line)
            if match and match.group(1) in hidden:
                reason = f'"{match.group(1)}" is of robocell::internal and not installed'
                yield Finding(file.relative_to(root), number, f"{reason}: include it in .cc files")


def check(root: Path) -> list[Finding]:
    """Forbidden includes of all C++ files under root."""
    files = [
        file.relative_to(root)
        for folder in ("src/robocell", "python/bindings")
        for pattern in ("*.h", "*.cc")
        for file in sorted((root / folder).rglob(pattern))
    ]
    found = [finding for file in files for finding in check_file(root, file)]
    return found + list(check_public(root))


def main() -> int:
    """Check the repository this script belongs to."""
    findings = check(Path(__file__).resolve().parents[1])
    for finding in findings:
        print(finding)
    print(f"includes: {len(findings)} forbidden" if findings else "includes: as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
