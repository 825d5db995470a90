"""Run clang-tidy over the project's sources, in parallel, and only over what changed.

    scripts/tidy.py --build build/tidy [--jobs N] [FILE ...]

Uses compile_commands.json of the build folder (``cmake --preset tidy``). Nearly all of clang-tidy's
time goes into the headers, so it looks at the sources that are compiled together (ROBOCELL_UNITY)
together, and the headers once. Each of them is parsed on its own as well, with clang's warnings: a
missing include of ours, or what the compiler says of a main file only, comes out there (the large
headers of others are precompiled for that). A group that was
clean is remembered under ``<build>/tidy`` by a hash of its text, of all our headers, of its
command, of .clang-tidy and of this file, so that a second run takes seconds. Tests are left out:
their macros cost most and find least.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OURS = ("src/robocell/", "python/bindings/", "examples/", "benchmarks/")
# The file that includes a group is not ours to judge: what it includes, and our headers, are.
LINES = json.dumps([{"name": ".cc"}, {"name": ".h"}])
# The commands were written for g++; clang need not know every option. (.clang-tidy has the same.)
LENIENT = (
    "-Qunused-arguments",
    "-Wno-unknown-warning-option",
    "-Wno-ignored-optimization-argument",
)
# Headers of others that most sources have, by one way or another.
COMMON = (
    "Eigen/Dense",
    "algorithm",
    "filesystem",
    "fmt/format.h",
    "functional",
    "map",
    "memory",
    "mujoco/mujoco.h",
    "nanobind/nanobind.h",
    "nanobind/ndarray.h",
    "optional",
    "set",
    "string",
    "vector",
)
PRECOMPILING = threading.Lock()


@dataclass(frozen=True)
class Group:
    """Sources (relative to the repository) that are compiled together.

    Attributes:
        file: What the compiler is given: a file that includes the sources, or the one source.
        sources: The sources.
        command: What compiles it.
        folder: Where.
    """

    file: Path
    sources: tuple[str, ...]
    command: str
    folder: str

    def size(self) -> int:
        """How much text it is: about how long it takes."""
        return sum((ROOT / source).stat().st_size for source in self.sources)

    def stamp(self, build: Path, common: bytes) -> Path:
        """The file that says that these texts were clean."""
        digest = hashlib.sha256(common + self.command.encode())
        for source in self.sources:
            digest.update((ROOT / source).read_bytes())
        return build / "tidy" / f"{self.file.stem}-{digest.hexdigest()[:20]}"


def sources_of(file: Path) -> tuple[str, ...]:
    """The sources that a file of the compilation database stands for."""
    files = [str(file)]
    if file.parent.parent.name == "Unity":
        named = re.findall(r'^#include "(.*)"', file.read_text(), re.MULTILINE)
        files = [str((ROOT / "src" if "../" not in name else file.parent) / name) for name in named]
    return tuple(os.path.relpath(name, ROOT) for name in files)


def groups(build: Path) -> list[Group]:
    """Our sources as they are compiled, the longest first."""
    result = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = Path(entry["file"])
        sources = sources_of(file)
        skipped = sources[0].endswith("_test.cc") or "/testing/" in sources[0]
        if sources[0].startswith(OURS) and not skipped:
            result.append(Group(file, sources, entry["command"], entry["directory"]))
    return sorted(result, key=Group.size, reverse=True)


def includes(source: str, header: str) -> bool:
    """Whether a source names one of our headers."""
    name = header.removeprefix("src/")
    return f'#include "{name}"' in (ROOT / source).read_text()


def chosen(named: set[str], every: list[Group]) -> tuple[list[Group], list[str]]:
    """The groups of the named files, of a header those that include it; and what is in none.

    Tests are in none and left out on purpose, so naming one is no mistake.
    """
    wanted, unknown = set[Group](), []
    for name in sorted(named):
        header = name.endswith(".h") and (ROOT / name).is_file()
        found = {
            group
            for group in every
            if name in group.sources
            or (header and any(includes(source, name) for source in group.sources))
        }
        test = name.endswith("_test.cc") or "/testing/" in name
        if not found and not (test and (ROOT / name).is_file()):
            unknown.append(name)
        wanted |= found
    return [group for group in every if group in wanted], unknown


def common_hash() -> bytes:
    """A hash of everything that can change the result of every file."""
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes() + Path(__file__).read_bytes())
    for folder in OURS:
        for header in sorted((ROOT / folder).rglob("*.h")):
            digest.update(header.read_bytes())
    return digest.digest()


def output_about(command: list[str], folder: str) -> str:
    """Returns what a command prints about our files; a failure that prints nothing counts too."""
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    noise = re.compile(r"^(?:\d+ (?:warning|error)s?|Suppressed|Use ).*$\n?", re.MULTILINE)
    text = run.stdout + noise.sub("", run.stderr)
    return text or (f"{shlex.join(command)}: exit code {run.returncode}\n" * bool(run.returncode))


def options(group: Group) -> list[str]:
    """How the sources of a group are compiled, for clang."""
    words = shlex.split(group.command)
    first = next(i for i, word in enumerate(words) if word.startswith("-"))
    end = words.index("-o")  # from here on: what is written, and the file that includes the group
    return [*words[first:end], *LENIENT]


def precompiled(build: Path, group: Group) -> Path:
    """Common headers as the sources of a group see them; made once for each set of options."""
    flags = options(group)
    name = hashlib.sha256(repr((flags, COMMON)).encode()).hexdigest()[:20]
    header = build / "tidy" / f"{name}.h"
    result = header.with_suffix(".pch")
    with PRECOMPILING:
        if not result.exists():
            lines = (f"#if __has_include(<{h}>)\n#include <{h}>\n#endif\n" for h in COMMON)
            header.write_text("".join(lines))
            make = ["clang++", *flags, "-fpch-instantiate-templates", "-x", "c++-header"]
            part = header.with_suffix(".part")
            run = [*make, str(header), "-o", str(part)]
            subprocess.run(run, cwd=group.folder, capture_output=True, check=True)
            part.rename(result)
    return result


def alone(build: Path, group: Group, source: str) -> str:
    """What clang says of one source of a group, compiled on its own."""
    parse = ["clang++", *options(group), "-fsyntax-only", str(ROOT / source)]
    common = precompiled(build, group)
    text = output_about([*parse, "-include-pch", str(common)], group.folder)
    if "precompiled" not in text and "PCH" not in text:
        return text
    common.unlink(missing_ok=True)  # of a header that has changed since, or of another clang
    return output_about(parse, group.folder)


def tidy(build: Path, group: Group) -> str:
    """The findings on a group; empty when there are none."""
    lenient = (f"--extra-arg={option}" for option in LENIENT)
    rules = f"--config-file={ROOT / '.clang-tidy'}"
    look = ["clang-tidy", "--quiet", rules, f"--line-filter={LINES}", *lenient, "-p", str(build)]
    found = [output_about([*look, str(group.file)], group.folder)]
    if group.file != ROOT / group.sources[0]:
        found += [alone(build, group, source) for source in group.sources]
    return "".join(found)


def findings(text: str) -> list[str]:
    """The output of one run, cut into findings, each with the lines that belong to it."""
    return [part for part in re.split(r"(?m)^(?=/.*?:\d+:\d+: (?:error|warning):)", text) if part]


def main() -> int:
    """Check the files named on the command line, or all. 1 when some are dirty or not known."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, default=Path("build/tidy"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("files", nargs="*")
    arguments = parser.parse_args()
    build: Path = arguments.build.resolve()

    named = {os.path.relpath(file, ROOT) for file in arguments.files}
    every = groups(build)
    wanted, unknown = chosen(named, every) if named else (every, [])
    for name in unknown:
        print(f"clang-tidy: {name} is no source of {arguments.build}, nor included by one")
    common = common_hash()
    (build / "tidy").mkdir(exist_ok=True)
    stamps = {group: group.stamp(build, common) for group in wanted}
    todo = [group for group, file in stamps.items() if not file.exists()]
    count, total = (sum(len(group.sources) for group in some) for some in (todo, wanted))
    print(f"clang-tidy: {count} of {total} files to look at", flush=True)
    dirty = 0
    seen: set[str] = set()  # a finding in a header comes back with every file that includes it
    with ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(lambda group: tidy(build, group), todo)
        for group, text in zip(todo, results, strict=True):
            if text:
                dirty += 1
                news = [finding for finding in findings(text) if finding not in seen]
                seen.update(news)
                print("".join(news), end="", flush=True)
            else:
                stamps[group].touch()
    print(f"clang-tidy: findings in {dirty} groups" if dirty else "clang-tidy: nothing found")
    return 1 if dirty or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
