"""Checks the arguments of the register_* functions: a name, and a class or function that fits.

They run when a module is imported, so that a mistake is reported with its line before any run.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from robocell._arguments import brief, parse
from robocell._core import ArgumentError
from robocell._own_code import file_of_module

# How alike a method and a hook must be for the method to be a probable misspelling of the hook.
LIKE_A_HOOK = 0.85

# ("task", "stack") -> the file of the module that registered it
_homes: dict[tuple[str, str], Path] = {}


def note_registered(what: str, name: str, module: str) -> None:
    """Stores which file registered a kind. Warns if that of another file is replaced.

    A cell of a notebook, or a module that is loaded again, replaces its own kind without a word.
    """
    file = file_of_module(module)
    before = _homes.pop((what, name), None)
    if file is None:
        return
    _homes[what, name] = file
    if before is not None and before != file:
        warnings.warn(
            f"{what} '{name}' of '{before}' is replaced by that of '{file}': the last one counts. "
            "If both are meant, give one another name",
            stacklevel=3,  # the line of the decorator
        )


def require_name(function: str, name: object, argument: str = "kind") -> None:
    """Raises ArgumentError for anything but a name, such as a class below a bare decorator."""
    if isinstance(name, str) and name:
        return
    if callable(name):
        own = getattr(name, "__name__", "")
        example = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", own).lower() or "my_name"
        raise ArgumentError(
            f"{function} takes the name first: write @{function}({example!r}) above "
            f"{own or repr(name)}"
        )
    raise ArgumentError(f"{function}: `{argument}` must be a name that is not empty, got {name!r}")


def require_maker(call: str, maker: object, base: type) -> None:
    """Raises TypeError for anything but a class derived from `base` or a function."""
    article = article_of(base)
    if not callable(maker):
        raise TypeError(
            f"{call}: expected a class derived from {base.__name__} or a function that makes "
            f"{article} {base.__name__}, got {maker!r}"
        )
    if not inspect.isclass(maker):
        return
    if not issubclass(maker, base):
        raise TypeError(
            f"{call}: class {maker.__name__} is not derived from {base.__name__}: write "
            f"class {maker.__name__}({_home_of(base)})"
        )
    for method, hook in _like_hooks(maker, base):
        warnings.warn(
            f"nothing calls {maker.__name__}.{method}(): {article} {base.__name__} has no such "
            f"method. Did you mean {hook}()?",
            stacklevel=3,  # the line of the decorator
        )


def require_methods(call: str, maker: object, base: type, *alternatives: Sequence[str]) -> None:
    """Raises TypeError for a class that defines the methods of no alternative completely.

    Each alternative lists the methods that a class must define itself, as "act(self, scene, rng)".
    The message lists all that the class lacks of the one of which it defines most.
    """
    if not inspect.isclass(maker):
        return

    def lacks(written: str) -> bool:
        name = written.partition("(")[0]
        return getattr(maker, name, None) is getattr(base, name)

    missing = [[each for each in methods if lacks(each)] for methods in alternatives]
    if [] in missing:
        return
    defined = [
        len(methods) - len(lack) for methods, lack in zip(alternatives, missing, strict=True)
    ]
    to_add = missing[defined.index(max(defined))]
    raise TypeError(
        f"{call}: class {maker.__name__} lacks methods that {article_of(base)} {base.__name__} "
        f"must define: add {', '.join(f'def {method}' for method in to_add)}"
    )


def require_takes(
    call: str,
    maker: object,
    given: Sequence[str],
    why: str = "",
    keywords: Sequence[str] = (),
) -> None:
    """Raises ArgumentError unless a class or a function accepts the arguments of its later calls.

    `given` are arguments by position, `keywords` those by name, `why` is a clause about them for
    the message. Callables whose arguments are unknown pass.
    """
    if takes(maker, len(given), keywords) is not False:
        return
    name = getattr(maker, "__name__", repr(maker))
    is_class = inspect.isclass(maker)
    function = "__init__" if is_class else name
    arguments = ", ".join([*(["self"] if is_class else []), *given, *keywords])
    written = f"lambda {arguments}: ..." if name == "<lambda>" else f"def {function}({arguments})"
    done = "made" if is_class else "called"
    raise ArgumentError(
        f"{call}: {name} is {done} as {name}({', '.join(given)}){why}, which does not fit its "
        f"arguments {arguments_of(maker)}: write {written}"
    )


def require_hooks(call: str, made: object, base: type) -> None:
    """Raises TypeError or ArgumentError for hooks that cannot be called as robocell calls them.

    `made` is a class, or an object whose attributes may hide its methods. Hooks are the methods of
    `base`: those that only `made` inherits from robocell fit.
    """
    kind = made if inspect.isclass(made) else type(made)
    for hook, own in _hooks_of(base):
        written = inspect.getattr_static(made, hook, own)
        if written is own or hasattr(written, "__nb_signature__"):
            continue
        given = _given_to(own)
        arguments = ", ".join(["self", *given])
        of_object = made is not kind and hook in getattr(made, "__dict__", {})
        called = f"{call}: {kind.__name__}.{hook}{_line_of(written)}"
        if isinstance(written, (property, functools.cached_property)):
            raise TypeError(
                f"{called} is a property, but it is called as {hook}({', '.join(given)}): write it "
                f"as a method, def {hook}({arguments})"
            )
        if not (callable(written) or hasattr(written, "__get__")):
            raise TypeError(
                f"{called} must be a method, got {brief(written)}: write def {hook}({arguments})"
                + (f", and give the attribute self.{hook} another name" if of_object else "")
            )
        bound = inspect.isfunction(written) and not of_object
        if isinstance(written, (staticmethod, classmethod)):
            called_as = written.__get__(None, kind)
        elif bound or not hasattr(written, "__get__") or of_object:
            called_as = written
        else:
            continue  # a descriptor of the user's own may make anything
        if takes(called_as, len(given) + bound) is False:
            raise ArgumentError(
                f"{called} is called as {hook}({', '.join(given)}), which does not fit its "
                f"arguments {arguments_of(called_as)}: write def {hook}"
                f"({arguments if bound else ', '.join(given)})"
            )


@functools.cache  # of robocell's own classes, for each object that a run makes
def _hooks_of(base: type) -> list[tuple[str, object]]:
    """Returns the public methods of a base class, by their names."""
    named = [(name, inspect.getattr_static(base, name)) for name in dir(base)]
    return [
        (name, own)
        for name, own in named
        if not name.startswith("_") and (hasattr(own, "__nb_signature__") or callable(own))
    ]


def _given_to(hook: object) -> list[str]:
    """Returns the names of the arguments that a method of a base class gets, without self."""
    if signatures := getattr(hook, "__nb_signature__", None):
        text, _, defaults = signatures[0]
        return [parameter.name for parameter in parse(text, defaults).positional]
    return list(inspect.signature(hook).parameters)[1:]  # type: ignore[arg-type]


def _line_of(written: object) -> str:
    """Returns " (line 12)", where a method begins; "" for a value, whose line is unknown."""
    function = getattr(written, "fget", None) or getattr(written, "func", None) or written
    code = getattr(inspect.unwrap(function), "__code__", None) if callable(function) else None
    return f" (line {code.co_firstlineno})" if code is not None else ""


def takes(maker: object, count: int, keywords: Sequence[str] = ()) -> bool | None:
    """Returns whether it takes so many arguments by position and others by name; None: unknown."""
    init = inspect.unwrap(maker.__init__) if inspect.isclass(maker) else None
    signatures = getattr(init, "__nb_signature__", None)
    if signatures:  # a class without an __init__ of its own has that of the core
        forms = [parse(text, defaults) for text, _, defaults in signatures]
        return any(
            sum(parameter.default is None for parameter in form.positional) <= count
            and (count <= len(form.positional) or form.open)
            for form in forms
        )
    try:
        signature = inspect.signature(maker)  # type: ignore[arg-type]
    except (TypeError, ValueError):  # of a callable that has no signature
        return None
    try:
        signature.bind(*[None] * count, **dict.fromkeys(keywords))
    except TypeError:
        return False
    return True


def arguments_of(maker: object) -> str:
    """Returns "(scale, run=None)"."""
    try:
        return str(inspect.signature(maker))  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return "()"


def article_of(base: type) -> str:
    """Returns "an" before the name of an Expert, else "a"."""
    return "an" if base.__name__[0] in "AEIOU" else "a"


def _home_of(base: type) -> str:
    """Returns "rc.tasks.Task", where users have the class."""
    import robocell

    for topic in (robocell.tasks, robocell.scenes):
        if base.__name__ in topic.__all__:
            return f"rc.{topic.__name__.rpartition('.')[2]}.{base.__name__}"
    return base.__name__


def _like_hooks(made: type, base: type) -> Iterator[tuple[str, str]]:
    """Yields methods that are probably misspelt, with the hooks that they resemble.

    A method that other methods of the class call is a helper, for any name.
    """
    own = [kind for kind in made.__mro__ if not kind.__module__.startswith("robocell.")]
    written = {name: value for kind in own for name, value in vars(kind).items()}
    hooks = [hook for hook in dir(base) if not hook.startswith("_") and hook not in written]
    known = set(dir(base))
    for kind in made.__mro__:
        if kind not in own:
            known |= set(dir(kind))
    functions = {name: value for name, value in written.items() if inspect.isfunction(value)}
    known |= {name for value in functions.values() for name in value.__code__.co_names}
    for name in functions:
        if name.startswith("_") or name in known:
            continue
        for hook in difflib.get_close_matches(name, hooks, 1, LIKE_A_HOOK):
            yield name, hook
