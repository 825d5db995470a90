"""Conditions on episodes: `success and length < 200`.

    condition = Condition.parse('success and (task contains "nut" or length < 200)')
    chosen = [episode.id for episode in dataset if condition.holds(fields(episode))]

    condition  = term {"or" term}
    term       = factor {"and" factor}
    factor     = "not" factor | "(" condition ")" | name [operator value]
    operator   = "==" | "!=" | "<" | "<=" | ">" | ">=" | "contains"
    value      = number | text in quotes | "true" | "false"

A name alone is a field that is true or false. No text is ever run as code.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from robocell._core import ArgumentError, Episode, NotFoundError
from robocell._suggestions import did_you_mean

Value = bool | float | str
Fields = Mapping[str, Value]

TOKEN = re.compile(
    r"""\s*(?:
        (?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<text>"[^"]*"|'[^']*')
      | (?P<word>[A-Za-z_][\w.]*)
      | (?P<sign><=|>=|==|!=|<|>|\(|\))
    )""",
    re.VERBOSE,
)
COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
CONTAINS = "contains"
WORDS = ("and", "or", "not", CONTAINS, "true", "false")
DEEPEST = 100  # parentheses inside each other
LONGEST = 10_000  # characters


@dataclass(frozen=True)
class Token:
    """A word, sign or value, and where it begins; the last one has the kind "end"."""

    kind: str
    text: str
    place: int


@dataclass(frozen=True)
class Comparison:
    """A field beside a value; without an operator, a field that is true or false."""

    name: str
    place: int
    sign: str = ""
    value: Value = True


@dataclass(frozen=True)
class Group:
    """Conditions joined by "and" or "or", or one behind "not"."""

    word: str
    parts: tuple[Node, ...]


Node = Comparison | Group


@dataclass(frozen=True)
class Condition:
    """A condition.

    Attributes:
        text: As it was written.
        root: What it consists of.
    """

    text: str
    root: Node

    @classmethod
    def parse(cls, text: str) -> Condition:
        """Reads a condition.

        Raises:
            ArgumentError: It is not one; the message has the place.
        """
        return cls(text, _Parser(text).parse())

    @property
    def names(self) -> list[str]:
        """The fields that it uses, each once."""
        return list(dict.fromkeys(each.name for each in _comparisons(self.root)))

    def require_known(self, known: Iterable[str]) -> None:
        """Raises NotFoundError, with the nearest name, for a field that no episode has."""
        there = sorted(set(known))
        for each in _comparisons(self.root):
            if each.name not in there:
                raise NotFoundError(
                    f"{_at(self.text, each.place)}: episodes have no '{each.name}'."
                    f"{did_you_mean(each.name, there)} They have: {', '.join(there)}"
                )

    def holds(self, fields: Fields) -> bool:
        """Returns whether the condition is true of an episode with these fields.

        A comparison with a field that the episode lacks is false.

        Raises:
            ArgumentError: A field has another type than the value beside it.
        """
        return self._holds(self.root, fields)

    def _holds(self, node: Node, fields: Fields) -> bool:
        if isinstance(node, Comparison):
            return self._compare(node, fields)
        if node.word == "not":
            return not self._holds(node.parts[0], fields)
        each = (self._holds(part, fields) for part in node.parts)
        return all(each) if node.word == "and" else any(each)

    def _compare(self, node: Comparison, fields: Fields) -> bool:
        if node.name not in fields:
            return False
        own = fields[node.name]
        place = _at(self.text, node.place)
        if not node.sign and not isinstance(own, bool):
            raise ArgumentError(
                f"{place}: '{node.name}' is {_kind(own)}, here {own!r}; compare it: "
                f"{node.name} == {_written(own)}"
            )
        if _kind(own) != _kind(node.value):
            raise ArgumentError(
                f"{place}: '{node.name}' is {_kind(own)} and {_written(node.value)} is "
                f"{_kind(node.value)}"
            )
        if node.sign == CONTAINS:
            if not isinstance(own, str):
                raise ArgumentError(f"{place}: contains is for texts; '{node.name}' is none")
            return str(node.value) in own
        if isinstance(own, bool) and node.sign not in ("", "==", "!="):
            raise ArgumentError(f"{place}: '{node.name}' is true or false; compare with == or !=")
        return COMPARISONS[node.sign or "=="](own, node.value)


def fields(episode: Episode) -> dict[str, Value]:
    """Returns what conditions can use of an episode.

    These are its id, its result, its length, its robots, and every number, text and truth value of
    its metadata; values inside others have names with dots, `rates.policy_ms`.
    """
    metadata: Any = episode.metadata or {}
    found = dict(_scalars(metadata, ""))
    if "task" in metadata:
        found["task_kind"] = found["task"]
    if isinstance(metadata.get("instruction"), str):
        found["task"] = metadata["instruction"]
    robots = [
        name.split("/")[1] for name in episode.columns if name.startswith("robots/") and "/" in name
    ]
    return found | {
        "id": episode.id,
        "success": episode.success,
        "terminated": episode.terminated,
        "truncated": episode.truncated,
        "end_reason": episode.end_reason,
        "length": float(len(episode)),
        "warnings": float(len(episode.warnings)),
        "robots": ", ".join(dict.fromkeys(robots)),
        "cameras": ", ".join(episode.cameras),
    }


LONGEST_TEXT = 200  # characters of a field; longer texts of the metadata are files


def _scalars(content: Any, prefix: str) -> Iterator[tuple[str, Value]]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _scalars(value, f"{prefix}{name}.")
        elif isinstance(value, int | float) or (
            isinstance(value, str) and len(value) <= LONGEST_TEXT
        ):
            yield f"{prefix}{name}", value


class _Parser:
    """Reads the tokens of a condition from the left."""

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST:
            raise ArgumentError(f"a condition has at most {LONGEST} characters")
        self._text = text
        self._tokens = list(_tokens(text))
        self._next = 0
        self._depth = 0

    def parse(self) -> Node:
        if self._token.kind == "end":
            raise ArgumentError("the condition is empty; an example: success and length < 200")
        node = self._any()
        if self._token.kind != "end":
            self._fail("'and' or 'or'")
        return node

    @property
    def _token(self) -> Token:
        return self._tokens[self._next]

    def _take(self) -> Token:
        token = self._token
        self._next += 1
        return token

    def _any(self) -> Node:
        return self._joined("or", lambda: self._joined("and", self._one))

    def _joined(self, word: str, part: Callable[[], Node]) -> Node:
        parts = [part()]
        while self._token.kind == "word" and self._token.text == word:
            self._take()
            parts.append(part())
        return parts[0] if len(parts) == 1 else Group(word, tuple(parts))

    def _one(self) -> Node:
        token = self._token
        negated, opened = token.text == "not", token.text == "("
        if (token.kind == "word" and negated) or (token.kind == "sign" and opened):
            self._take()
            self._depth += 1
            if self._depth > DEEPEST:
                raise ArgumentError(f"{_at(self._text, token.place)}: more than {DEEPEST} levels")
            node = Group("not", (self._one(),)) if negated else self._any()
            if opened and self._take_if(")") is None:
                self._fail("')'")
            self._depth -= 1
            return node
        if token.kind != "word" or token.text in WORDS:
            self._fail("a field of episodes, such as success or length")
        self._take()
        sign = self._token
        if not (sign.text == CONTAINS or (sign.kind == "sign" and sign.text in COMPARISONS)):
            if sign.text == "=":
                self._fail("'=='")
            return Comparison(token.text, token.place)
        self._take()
        return Comparison(token.text, token.place, sign.text, self._value())

    def _take_if(self, sign: str) -> Token | None:
        is_it = self._token.kind == "sign" and self._token.text == sign
        return self._take() if is_it else None

    def _value(self) -> Value:
        token = self._token
        if token.kind == "number":
            return _number(self._take().text)
        if token.kind == "text":
            return self._take().text[1:-1]
        if token.kind == "word" and token.text in ("true", "false"):
            return self._take().text == "true"
        what = "a number, a text in quotes, true or false"
        if token.kind == "word":
            what += f': "{token.text}" with quotes is a text'
        self._fail(what)
        raise AssertionError

    def _fail(self, wanted: str) -> None:
        token = self._token
        found = f"'{token.text}'" if token.kind != "end" else "the end"
        raise ArgumentError(f"{_at(self._text, token.place)}: {found} instead of {wanted}")


def _tokens(text: str) -> Iterator[Token]:
    place = 0
    while place < len(text.rstrip()):
        match = TOKEN.match(text, place)
        if match is None:
            at = place + len(text[place:]) - len(text[place:].lstrip())
            wrong = text[at]
            hint = " A comparison is written ==" if wrong == "=" else ""
            raise ArgumentError(f"{_at(text, at)}: '{wrong}' has no meaning here.{hint}")
        kind = str(match.lastgroup)
        yield Token(kind, match[kind], match.start(kind))
        place = match.end()
    yield Token("end", "", len(text))


def _number(text: str) -> float:
    """Returns a number; whole ones stay exact, because a seed may have 19 digits."""
    is_whole = text.lstrip("+-").isdigit() and len(text) < 100
    return int(text) if is_whole else float(text)


def _comparisons(node: Node) -> Iterator[Comparison]:
    if isinstance(node, Comparison):
        yield node
        return
    for part in node.parts:
        yield from _comparisons(part)


def _at(text: str, place: int) -> str:
    return f"condition '{text}', character {place + 1}"


def _kind(value: Value) -> str:
    if isinstance(value, bool):
        return "true or false"
    return "a text" if isinstance(value, str) else "a number"


def _written(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        return str(value)
    return f'"{value}"' if isinstance(value, str) else f"{value:g}"
