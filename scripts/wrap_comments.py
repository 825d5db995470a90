"""Wrap C++ comments wider than 100 columns: ``wrap_comments.py [--check] FILE ...``.

clang-format leaves comments alone, because tables and examples in them do not survive being filled.
``make format`` calls this; with --check (``make check-format``) wide comments are only listed.

Touches wide lines only. A wide comment line is filled together with the plain lines after it;
tables, lists, code and blank comment lines end the paragraph. A wide comment behind code moves to
a line of its own above it.
"""

from __future__ import annotations

import re
import sys
import textwrap
from pathlib import Path

WIDTH = 100
COMMENT = re.compile(r"^(\s*)// ?(.*)$")
BEHIND_CODE = re.compile(r"^(\s*)(\S.*?)\s+// (.*)$")


def is_plain(text: str) -> bool:
    """Whether the text of a comment line is running prose: no table, list, code or blank line."""
    return bool(text) and not re.search(r"^\s|^[-*]\s|^\d+\.\s|\S {2,}\S", text)


def fill(indent: str, text: str) -> list[str]:
    """Comment lines of at most WIDTH columns."""
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=f"{indent}// ",
        subsequent_indent=f"{indent}// ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def wrap(lines: list[str]) -> list[str]:
    """The lines of a file with wide comments wrapped."""
    result: list[str] = []
    position = 0
    while position < len(lines):
        line = lines[position]
        position += 1
        if len(line) <= WIDTH:
            result.append(line)
            continue
        comment = COMMENT.match(line)
        behind = BEHIND_CODE.match(line)
        if comment and is_plain(comment[2]):
            text = [comment[2]]
            while position < len(lines):
                following = COMMENT.match(lines[position])
                if not following or following[1] != comment[1] or not is_plain(following[2]):
                    break
                text.append(following[2])
                position += 1
            result += fill(comment[1], " ".join(text))
        elif behind and not comment and '"' not in line:
            result += [*fill(behind[1], behind[3]), behind[1] + behind[2]]
        else:
            result.append(line)
    return result


def list_wide(name: str) -> int:
    """Print the wide comments of a file; how many there are."""
    lines = Path(name).read_text().split("\n")
    wide = [number for number, line in enumerate(lines, 1) if len(line) > WIDTH and "//" in line]
    for number in wide:
        print(f"{name}:{number}: {len(lines[number - 1])} columns, {WIDTH} are allowed")
    return len(wide)


def main() -> int:
    """Rewrite the files named on the command line where needed, or list what is wide."""
    if sys.argv[1:2] == ["--check"]:
        return 1 if sum(list_wide(name) for name in sys.argv[2:]) else 0
    for name in sys.argv[1:]:
        path = Path(name)
        text = path.read_text()
        wrapped = "\n".join(wrap(text.split("\n")))
        if wrapped != text:
            path.write_text(wrapped)
    return 0


if __name__ == "__main__":
    sys.exit(main())
