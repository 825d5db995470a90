"""Lines of a robot file: values in YAML's short form, comments wrapped above them."""

from __future__ import annotations

import re
import textwrap

from robocell.robots import expand_names

WIDTH = 100
PLAIN = re.compile(r"[A-Za-z_][\w./-]*")
# Words that YAML reads as something else than a text.
RESERVED = {"true", "false", "null", "yes", "no", "on", "off", "y", "n", "nan", "inf", "none"}


def flow(value: object) -> str:
    """Formats a value in one line: `{kind: arm, joints: [a, b]}`."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(flow(each) for each in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value) if isinstance(value, Raw) else quoted(str(value))


def quoted(text: str) -> str:
    """Returns a text, in quotes if YAML would read something else."""
    if PLAIN.fullmatch(text) and text.lower() not in RESERVED:
        return text
    return "'" + text.replace("'", "''") + "'"


def comment(text: str, indent: str = "") -> list[str]:
    """Formats a comment as lines of limited length."""
    lead = f"{indent}# "
    return textwrap.wrap(
        " ".join(text.split()),
        WIDTH,
        initial_indent=lead,
        subsequent_indent=lead,
        break_long_words=False,
        break_on_hyphens=False,
    )


def name_list(names: list[str]) -> object:
    """Names as the robot file has them: a range where they are numbered, else a list."""
    if len(names) > 2:
        short = f"{names[0]}..{names[-1]}"
        try:
            if list(expand_names(short)) == names and PLAIN.fullmatch(names[0]):
                return Raw(short)
        except (ValueError, RuntimeError):
            pass
    return names


class Raw(str):
    """A text that is YAML already: a range of names, an edit that a finding proposes."""
