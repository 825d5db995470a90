"""Run clang-tidy over the project's sources, in parallel, and only over what changed.

    scripts/tidy.py --build build/tidy [--jobs N] [FILE ...]

Uses compile_commands.json of the build folder (``cmake --preset tidy``: every source on its own). A
file that was clean is remembered under ``<build>/tidy`` by a hash of its text, of all our headers,
of its command and of .clang-tidy, so that a second run takes seconds. Tests are left out: their
macros cost most and find least.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OURS = ("src/robocell/", "python/bindings/", "examples/")


def commands(build: Path) -> dict[str, str]:
    """Our sources (relative to the repository) with the command that compiles each."""
    database = json.loads((build / "compile_commands.json").read_text())
    result = {}
    for entry in database:
        name = os.path.relpath(entry["file"], ROOT)
        skipped = name.endswith("_test.cc") or "/testing/" in name
        if name.startswith(OURS) and not skipped:
            result[name] = entry["command"]
    return result


def headers_hash() -> bytes:
    """A hash of everything that can change the result of every file."""
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for folder in OURS:
        for header in sorted((ROOT / folder).rglob("*.h")):
            digest.update(header.read_bytes())
    return digest.digest()


def stamp(build: Path, name: str, command: str, common: bytes) -> Path:
    """The file that says this text of this source was clean."""
    digest = hashlib.sha256(common + command.encode() + (ROOT / name).read_bytes())
    return build / "tidy" / f"{Path(name).stem}-{digest.hexdigest()[:20]}"


def tidy(build: Path, name: str) -> str:
    """The findings of clang-tidy on one source; empty when there are none."""
    # The commands were written for g++; clang need not know every option.
    run = subprocess.run(
        [
            "clang-tidy",
            "--quiet",
            "--extra-arg=-Qunused-arguments",
            "-p",
            str(build),
            str(ROOT / name),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode == 0:
        return ""
    noise = re.compile(r"^\d+ warnings? (?:generated|treated as).*$\n?", re.MULTILINE)
    return run.stdout + noise.sub("", run.stderr)


def findings(text: str) -> list[str]:
    """The output of one run, cut into findings, each with the lines that belong to it."""
    return [part for part in re.split(r"(?m)^(?=/.*?:\d+:\d+: (?:error|warning):)", text) if part]


def main() -> int:
    """Check the files named on the command line, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, default=Path("build/tidy"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("files", nargs="*")
    arguments = parser.parse_args()
    build: Path = arguments.build.resolve()

    known = commands(build)
    wanted = [os.path.relpath(file, ROOT) for file in arguments.files] or sorted(known)
    common = headers_hash()
    (build / "tidy").mkdir(exist_ok=True)
    stamps = {name: stamp(build, name, known[name], common) for name in wanted if name in known}
    todo = [name for name, file in stamps.items() if not file.exists()]
    print(f"clang-tidy: {len(todo)} of {len(wanted)} files to look at", flush=True)
    dirty = 0
    seen: set[str] = set()  # a finding in a header comes back with every file that includes it
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for name, text in zip(todo, pool.map(lambda name: tidy(build, name), todo), strict=True):
            if text:
                dirty += 1
                news = [finding for finding in findings(text) if finding not in seen]
                seen.update(news)
                print("".join(news), end="", flush=True)
            else:
                stamps[name].touch()
    print(f"clang-tidy: {dirty} files with findings" if dirty else "clang-tidy: nothing found")
    return 1 if dirty else 0


if __name__ == "__main__":
    sys.exit(main())
