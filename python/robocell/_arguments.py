"""Explains why the arguments of a call to the C++ core do not fit: class, method, argument.

The core calls `explain` when no signature of a function takes the arguments; it has the signatures
as text.
"""

from __future__ import annotations

import ast
import functools
import inspect
import os
import re
import reprlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ParamSpec, Protocol, TypeVar

from robocell import _core
from robocell._suggestions import did_you_mean

MOST_REPR = 60  # characters of a value that a message shows
MOST_TYPED = 6  # parameters that are shown with their types
NOTHING_LIKE = (str, bytes, list, tuple, dict, set, type(None))
NUMBERS: dict[str, type | tuple[type, ...]] = {"int": int, "float": (int, float)}
WORDS = {
    "str": "a str",
    "int": "a whole number",
    "float": "a number",
    "bool": "True or False",
    "bytes": "bytes",
    "None": "None",
    "object": "a value",
    "numpy.typing.ArrayLike": "numbers",
    "os.PathLike": "a path",
}
# Words with the same meaning, one of which a function uses.
SYNONYMS = (
    {"translation", "pos", "position", "xyz"},
    {"quaternion", "quat", "orientation"},
    {"rpy", "euler"},
)
CALLABLE = "collections.abc.Callable"
P = ParamSpec("P")
T = TypeVar("T")
LISTS = ("list", "collections.abc.Sequence", "collections.abc.Iterable")
MAPS = ("dict", "collections.abc.Mapping")


class Function(Protocol):
    """The Python type of a function that nanobind wraps."""

    __nb_signature__: tuple[tuple[str, str | None, tuple[object, ...] | None], ...]


@dataclass
class Parameter:
    name: str
    kind: ast.expr | None
    default: str | None  # None: it must be given

    def __str__(self) -> str:
        kind = f": {short(self.kind)}" if self.kind else ""
        return f"{self.name}{kind}" + ("" if self.default is None else f" = {self.default}")


@dataclass
class Form:
    """A signature without `self`."""

    positional: list[Parameter]
    keyword_only: list[Parameter]
    has_self: bool
    open: bool  # takes any further arguments

    @property
    def all(self) -> list[Parameter]:
        return self.positional + self.keyword_only

    def text(self, name: str) -> str:
        if len(self.all) > MOST_TYPED:
            parts = [parameter.name for parameter in self.positional]
            parts += [f"{parameter.name}=..." for parameter in self.keyword_only]
        else:
            parts = [str(parameter) for parameter in self.positional]
            parts += ["*"] if self.keyword_only else []
            parts += [str(parameter) for parameter in self.keyword_only]
        return f"{name}({', '.join(parts)})"


def parse(signature: str, defaults: tuple[object, ...] | None) -> Form:
    """Parses 'def step(self, n: int) -> None' to a form; defaults are numbered after a slash."""
    text = re.sub(r"^def \(", "def f(", signature.rpartition(" -> ")[0])
    text = re.sub(r"\\(\d+)", lambda found: f"__default_{found[1]}", text)
    function = ast.parse(f"{text}: ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    arguments = function.args

    def shown(value: ast.expr | None) -> str | None:
        if value is None:
            return None
        number = re.fullmatch(r"__default_(\d+)", ast.unparse(value))
        return ast.unparse(value) if number is None else literal((defaults or ())[int(number[1])])

    plain = arguments.posonlyargs + arguments.args
    values = [None] * (len(plain) - len(arguments.defaults)) + [*arguments.defaults]
    positional = [
        Parameter(a.arg, a.annotation, shown(v)) for a, v in zip(plain, values, strict=True)
    ]
    keyword_only = [
        Parameter(a.arg, a.annotation, shown(v))
        for a, v in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    ]
    has_self = bool(plain) and plain[0].arg == "self"
    anything = bool(arguments.vararg or arguments.kwarg)
    return Form(positional[has_self:], keyword_only, has_self, anything)


def literal(value: object) -> str:
    """Returns a default as source text; '...' for objects."""
    return repr(value) if isinstance(value, (bool, int, float, str, type(None))) else "..."


def short(kind: ast.expr) -> str:
    """Removes the modules from the name of a type."""
    return re.sub(r"\b(?:[a-z_]+\.)+(?=[A-Z])", "", ast.unparse(kind))


def options(kind: ast.expr) -> list[ast.expr]:
    """Returns the members of a union."""
    if isinstance(kind, ast.BinOp) and isinstance(kind.op, ast.BitOr):
        return options(kind.left) + options(kind.right)
    return [kind]


def words(kind: ast.expr) -> str:
    """Describes the expected type: 'a str or None'."""
    return " or ".join(dict.fromkeys(word(option) for option in options(kind)))


def word(kind: ast.expr) -> str:
    text = ast.unparse(kind)
    name = text.partition("[")[0]
    if name in WORDS:
        return WORDS[name]
    if name == CALLABLE:
        return "a function"
    if isinstance(kind, ast.Subscript) and name in LISTS:
        return f"a list of {short(kind.slice)}"
    if isinstance(kind, ast.Subscript) and name in MAPS:
        return f"a dict {braces(kind)}"
    if class_of(kind):
        return f"{'an' if short(kind)[0] in 'AEIOU' else 'a'} {short(kind)}"
    return short(kind)


def braces(kind: ast.expr) -> str:
    """Formats a mapping type: '{str: {str: GroupCommand}}'."""
    if isinstance(kind, ast.Subscript) and isinstance(kind.slice, ast.Tuple):
        key, value = kind.slice.elts
        return f"{{{short(key)}: {braces(value)}}}"
    return short(kind)


def class_of(kind: ast.expr) -> type | None:
    """Returns the core's class that a type names."""
    found = getattr(_core, ast.unparse(kind).removeprefix("robocell._core."), None)
    return found if isinstance(found, type) else None


def fits(value: object, kind: ast.expr) -> bool | None:
    """Returns True if a value has a type; None if unknown."""
    answers = {fits_one(value, option) for option in options(kind)}
    return True if True in answers else None if None in answers else False


def fits_one(value: object, kind: ast.expr) -> bool | None:
    text = ast.unparse(kind)
    name = text.partition("[")[0]
    if text == "None":
        return value is None
    if text in ("object", "numpy.typing.ArrayLike"):
        texts = (type(None),) if text == "object" else (type(None), str)
        return False if isinstance(value, texts) else None
    if text in NUMBERS:
        if getattr(value, "ndim", 0):  # of an array
            return False
        if isinstance(value, NUMBERS[text]):
            return True
        return False if isinstance(value, (*NOTHING_LIKE, float)) else None
    if name == CALLABLE:
        return callable(value)
    if text in ("str", "bool", "bytes"):
        return isinstance(value, {"str": str, "bool": bool, "bytes": bytes}[text])
    if name == "os.PathLike":
        return hasattr(value, "__fspath__")
    if name in MAPS:
        inner = value_kind(kind)
        if not isinstance(value, Mapping):
            return False
        wrong = inner and any(fits(item, inner) is False for item in value.values())
        return False if wrong else None
    if isinstance(kind, ast.Subscript) and name in LISTS:
        if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
            return False
        known = isinstance(value, (list, tuple))
        return False if known and any(fits(item, kind.slice) is False for item in value) else None
    wanted = class_of(kind)
    return isinstance(value, wanted) if wanted else None


def shortened() -> reprlib.Repr:
    """Returns a repr that reads no more of a value than the message shows."""
    short = reprlib.Repr()
    for kind in ("list", "tuple", "dict", "set", "frozenset", "deque", "array"):
        setattr(short, f"max{kind}", MOST_REPR // 3)
    short.maxstring = short.maxlong = short.maxother = 2 * MOST_REPR
    return short


def brief(value: object) -> str:
    """Formats a value for a message; only the size of large arrays and buffers."""
    try:
        size, shape = getattr(value, "size", 0), getattr(value, "shape", None)
        if shape is not None and isinstance(size, int) and size > MOST_REPR:
            return f"<{type(value).__name__} of shape {shape}>"
        if isinstance(value, (bytes, bytearray)) and len(value) > MOST_REPR:
            return f"<{len(value)} {type(value).__name__}>"
        text = shortened().repr(value)
    except Exception:
        return f"a {type(value).__name__}"
    return text if len(text) <= MOST_REPR else text[:MOST_REPR] + " ..."


def show(value: object) -> str:
    """Formats a value with its type."""
    text = brief(value)
    known = value is None or isinstance(value, (str, bool)) or text.startswith("<")
    return text if known else f"{text} ({type(value).__name__})"


def number_problem(form: Form, given: int) -> str:
    """Describes too many positional arguments."""
    if not form.positional and form.keyword_only:
        first = form.keyword_only[0].name
        return f"its arguments are given by name, such as {first}=..."
    names = ", ".join(parameter.name for parameter in form.positional)
    most = len(form.positional)
    return (
        f"takes {most} argument{'s' if most != 1 else ''}{f' ({names})' if names else ''} by "
        + (f"position, got {given}")
    )


def name_problem(form: Form, name: str) -> str:
    names = [parameter.name for parameter in form.all]
    meant = set().union(*(group for group in SYNONYMS if name in group))
    same = [other for other in names if other in meant]
    hint = f" Did you mean '{same[0]}'?" if same else did_you_mean(name, names)
    known = f" Its arguments: {', '.join(names)}." if names else " It takes none."
    return f"no argument '{name}'.{known}{hint}"


def problems(form: Form, args: tuple[object, ...], kwargs: Mapping[str, object]) -> list[str]:
    """Describes what does not fit a form; empty if unknown."""
    if not form.open and len(args) > len(form.positional):
        return [number_problem(form, len(args))]
    given = dict(zip((parameter.name for parameter in form.positional), args, strict=False))
    found = [f"`{name}` is given twice" for name in kwargs if name in given]
    names = {parameter.name for parameter in form.all}
    found += [name_problem(form, name) for name in kwargs if name not in names and not form.open]
    given |= kwargs
    for parameter in form.all:
        if parameter.name not in given:
            if parameter.default is None:
                found.append(f"`{parameter.name}` is missing")
        elif parameter.kind and fits(given[parameter.name], parameter.kind) is False:
            found.append(value_problem(parameter.name, given[parameter.name], parameter.kind))
    return found


def negative_problem(
    form: Form, args: tuple[object, ...], kwargs: Mapping[str, object]
) -> str | None:
    """Describes a negative integer, if all arguments have the right types."""
    values = dict(zip((parameter.name for parameter in form.positional), args, strict=False))
    values |= kwargs
    kinds = {parameter.name: parameter.kind for parameter in form.all}
    for name, value in values.items():
        kind = kinds.get(name)
        if kind is None or not fits(value, kind):
            return None
    below = [name for name, value in values.items() if type(value) is int and value < 0]
    return f"`{below[0]}` cannot be negative, got {values[below[0]]}" if len(below) == 1 else None


def value_problem(name: str, value: object, kind: ast.expr) -> str:
    """Describes a wrong value, or one in it: "`action['arm']` must be a GroupCommand"."""
    if isinstance(value, Mapping) and (inner := value_kind(kind)):
        key = next(key for key, item in value.items() if fits(item, inner) is False)
        return value_problem(f"{name}[{key!r}]", value[key], inner)
    return f"`{name}` must be {words(kind)}, got {show(value)}{way_to(kind, value)}"


def value_kind(kind: ast.expr) -> ast.expr | None:
    """Returns the type of a mapping's values."""
    if ast.unparse(kind).partition("[")[0] not in MAPS or not isinstance(kind, ast.Subscript):
        return None
    return kind.slice.elts[1] if isinstance(kind.slice, ast.Tuple) else None


def way_to(kind: ast.expr, value: object) -> str:
    """Returns '; make it with Scene.build(...)' for classes without constructor, and files."""
    wanted = next(filter(None, map(class_of, options(kind))), None)
    if wanted is None:
        return ""
    if isinstance(value, (str, os.PathLike)) and hasattr(wanted, "load"):
        return f"; {wanted.__name__}.load({os.fspath(value)!r}) reads one from a file"
    if hasattr(vars(wanted).get("__init__"), "__nb_signature__"):
        return ""
    makers = [name for name, member in vars(wanted).items() if makes(member, wanted)]
    calls = [f"{wanted.__name__}.{name}(...)" for name in makers]
    return f"; make it with {' or '.join(calls)}" if calls else ""


def makes(member: object, wanted: type) -> bool:
    """Returns True if a static method returns an object of the class."""
    return any(
        text.endswith(f"-> robocell._core.{wanted.__name__}") and not parse(text, defaults).has_self
        for text, _, defaults in getattr(member, "__nb_signature__", ())
    )


def no_attribute(kind: type, name: str, wrapped: type = object) -> str:
    """Returns the message for setting an attribute that the class does not have."""
    names = [each for each in sorted({*dir(kind), *dir(wrapped)}) if not each.startswith("_")]
    hint = did_you_mean(name, names)
    article = "an" if kind.__name__[0] in "AEIOU" else "a"
    return f"{article} {kind.__name__} has no '{name}'.{hint or ' It has ' + ', '.join(names)}"


def explain(
    name: str, is_setter: bool, function: Function, args: tuple[Any, ...], kwargs: dict[str, Any]
) -> str:
    """Returns the message for a call to `name`, 'Scene.robot'; methods have self in `args`."""
    forms = [parse(text, defaults) for text, _, defaults in function.__nb_signature__]
    if forms[0].has_self:
        args = args[1:]
    if is_setter:
        kind = forms[0].positional[0].kind
        return f"{name} must be {words(kind) if kind else 'something else'}, got {show(args[0])}"
    usage = f"It is called as {' or '.join(form.text(name) for form in forms)}"
    found = problems(forms[0], args, kwargs) if len(forms) == 1 else []
    if found:
        text = "; ".join(found)
        return f"{name}(): {text}{'' if text[-1] in '.?' else '.'} {usage}"
    if len(forms) == 1 and (negative := negative_problem(forms[0], args, kwargs)):
        return f"{name}(): {negative}. {usage}"
    given = [brief(value) for value in args] + [f"{key}={brief(v)}" for key, v in kwargs.items()]
    number = any(is_long(value) for value in (*args, *kwargs.values()))
    hint = "; is a whole number out of range?" if number else "."
    return f"{name}(): cannot be called with ({', '.join(given)}){hint} {usage}"


def is_long(value: object) -> bool:
    """Returns True for a whole number that does not fit the smallest type of the core."""
    return isinstance(value, int) and not -(2**31) <= value < 2**31


def with_hints(function: Callable[P, T]) -> Callable[P, T]:
    """Returns a function of Python that answers a misspelt argument with the nearest one.

    Python itself names only the wrong one, in a TypeError.
    """
    known = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]
    form = Form([Parameter(name, None, None) for name in known], [], False, False)

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        for name in kwargs:
            if name not in known:
                raise TypeError(f"{function.__qualname__}(): {name_problem(form, name)}")
        return function(*args, **kwargs)

    return call
