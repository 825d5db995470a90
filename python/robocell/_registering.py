"""Checks of what the register_* functions get: a name, and a class or a function that fits.

They run when a module is imported, so that a mistake is reported with its line before any run.
"""

from __future__ import annotations

import difflib
import inspect
import re
import warnings
from collections.abc import Iterator, Sequence

from robocell._arguments import parse
from robocell._core import ArgumentError

# How alike a method and a hook must be for the method to be a probable misspelling of the hook.
LIKE_A_HOOK = 0.85


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
    article = "an" if base.__name__[0] in "AEIOU" else "a"
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


def require_takes(
    call: str,
    maker: object,
    given: Sequence[str],
    why: str = "",
    keywords: Sequence[str] = (),
) -> None:
    """Raises ArgumentError unless a class or a function can be called with what it will be given.

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


def _home_of(base: type) -> str:
    """Returns "rc.tasks.Task", where users have the class."""
    import robocell

    for topic in (robocell.tasks, robocell.scenes):
        if base.__name__ in topic.__all__:
            return f"rc.{topic.__name__.rpartition('.')[2]}.{base.__name__}"
    return base.__name__


def _like_hooks(made: type, base: type) -> Iterator[tuple[str, str]]:
    """Yields methods that are probably misspelt, with the hooks that they are near to.

    A method that others of the class use is a helper, whatever its name.
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
