"""Makes pages that are written for GitHub's Markdown read the same in Python-Markdown.

GitHub starts a list, a table or a code block right below a paragraph; Python-Markdown wants an
empty line in between. GitHub indents what belongs to a list item by two or three spaces,
Python-Markdown by four.
"""

from __future__ import annotations

import re

ITEM = re.compile(r"(\s*)([-*]|\d+\.) +")
FENCE = re.compile(r"\s*(```+)")


def for_python_markdown(markdown: str) -> str:
    """The same page with the empty lines and indentation that Python-Markdown wants."""
    out: list[str] = []
    fence = ""  # the backticks that end the code block
    in_list = False
    for line in markdown.split("\n"):
        previous = out[-1] if out else ""
        found = FENCE.match(line)
        if not fence and line.strip():
            in_list = bool(ITEM.match(line)) or (in_list and line.startswith(" "))
        if fence:
            if line.strip() == fence:
                fence = ""
        elif found:
            fence = found[1]
            if previous.strip():
                out.append("")
        elif previous.strip() and needs_empty_line(previous, line):
            out.append("")
        if in_list and line.startswith("  "):
            line = "  " + line if fence and not found else wider_indent(line)
        out.append(line)
    return "\n".join(out)


def needs_empty_line(previous: str, line: str) -> bool:
    """Whether `line` starts a list or a table right below something else."""
    if ITEM.match(line):
        return not (ITEM.match(previous) or previous.startswith(" "))
    return line.startswith("|") and not previous.startswith("|")


def wider_indent(line: str) -> str:
    """Two or three leading spaces become four."""
    return re.sub(r"^ {2,3}(?=\S)", "    ", line)
