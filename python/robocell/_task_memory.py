"""Stores the attributes of a Python task that defines no memory().

Stored are the attributes that differ from those at the binding to the scene: numbers, strings,
arrays, poses, enumerations, containers of them, and the attributes of its own objects. Bound
attributes belong to the configuration and may differ where a state is restored. Handles of robocell
(scenes, robots, bodies) belong to the scene and stay unchanged. Saving a state rejects anything
else: a missing attribute would change the continuation. It also rejects containers and arrays that
two places share, at any depth: each place would get its own copy; functions whose closure, defaults
or attributes the episode has set; and attributes of the class that it has changed.

The attributes are JSON, packed into numbers as the states of environments are. Nothing of a state
is executed or imported.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import json
import logging
import pathlib
import re
import sys
import types
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from robocell._core import ArgumentError, Pose, Rng, TaskVerdict
from robocell._shared_places import shared_places

# The attribute that holds the others as they were when the task was bound: name -> JSON.
_BOUND = "_robocell_bound"
# The same of the attributes of its class, and of the classes of its objects: class -> name -> JSON.
_BOUND_CLASSES = "_robocell_bound_classes"

_BYTES_PER_NUMBER = 6  # doubles hold 48-bit integers exactly


class _UnknownError(Exception):
    """A value that cannot be kept; its text is the reason."""


def remember_bound(task: Any) -> None:
    """Notes the attributes of a task that has just been bound to its scene."""
    bound: dict[str, str] = {}
    classes = {type(task)}
    for name, value in _attributes(task):
        encoder = _Encoder(task)
        try:
            bound[name] = encoder.text(value)
        except _UnknownError:  # refused when a state is saved
            continue
        finally:
            classes |= encoder.classes
    setattr(task, _BOUND, bound)
    setattr(task, _BOUND_CLASSES, {kind: _class_texts(kind) for kind in classes})


def memory_of(task: Any) -> npt.NDArray[np.float64]:
    """Returns the attributes that the episode has set.

    Raises:
        ArgumentError: An attribute cannot be stored; the message names it.
    """
    bound: Mapping[str, str] = getattr(task, _BOUND, {})
    changed: dict[str, str] = {}
    for name, value in _attributes(task):
        encoder = _Encoder(task)
        try:
            text = encoder.text(value)
            if bound.get(name) == text or _is_handle(value):
                continue
            if encoder.has_functions_with_state:
                raise _UnknownError(
                    "holds a function with a closure, defaults or attributes of its own, which "
                    "robocell cannot keep"
                )
            if encoder.has_objects_in_containers:
                raise _UnknownError("holds a container of objects, which robocell cannot keep")
        except _UnknownError as error:
            raise ArgumentError(
                f"{_called(task)}: its state cannot be saved, because attribute '{name}' {error}. "
                f"{_NEXT_STEP}"
            ) from None
        changed[name] = text
    _require_same_classes(task)
    for one, other in shared_places(_attributes(task), task, _has_stored_attributes, _attributes):
        if one.attribute in changed or other.attribute in changed:
            raise ArgumentError(
                f"{_called(task)}: its state cannot be saved, because '{other}' is the same "
                f"object as '{one}' or shares its numbers, and two copies would be restored. "
                f"{_NEXT_STEP}"
            )
    return _to_numbers(json.dumps(changed))


def _require_same_classes(task: Any) -> None:
    """Raises ArgumentError if an attribute of a class has changed since the task was bound."""
    bound: Mapping[type, Mapping[str, str]] = getattr(task, _BOUND_CLASSES, {})
    for kind, before in bound.items():
        now = _class_texts(kind)
        for name in dict.fromkeys((*before, *now)):
            if name in before and before[name] == now.get(name) != _UNKNOWN:
                continue
            what = "is no value that can be kept" if now.get(name) == _UNKNOWN else "has changed"
            raise ArgumentError(
                f"{_called(task)}: its state cannot be saved, because attribute '{name}' of class "
                f"'{kind.__name__}' {what}, and all tasks of the class share it. Set it in bind() "
                f"or begin() as self.{name}"
            )


def _class_texts(kind: type) -> dict[str, str]:
    """Returns the attributes of a class and of its bases that are values, as JSON."""
    texts: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        if base.__module__.partition(".")[0] in ("robocell", "builtins", "abc", "typing", "enum"):
            continue
        for name, value in vars(base).items():
            if name.startswith(("__", "_abc_")) or hasattr(type(value), "__get__"):
                continue  # of Python's own, or functions and properties
            try:
                texts[name] = _Encoder(kind).text(value)
            except _UnknownError:
                if not _is_value(value):
                    texts[name] = _UNKNOWN
    return texts


_UNKNOWN = ""  # instead of the JSON of what cannot be kept


def _is_value(value: Any) -> bool:
    """Returns True for values that are equal by their content, such as a Fraction: none changes."""
    kind = type(value)
    return kind.__eq__ is not object.__eq__ and kind.__hash__ not in (None, object.__hash__)


def has_attributes(memory: npt.NDArray[np.float64]) -> bool:
    """Returns True if the result of `memory_of` has attributes."""
    return bool(memory.size) and bool(_parse(memory))


def recall(task: Any, memory: npt.NDArray[np.float64]) -> None:
    """Restores the result of `memory_of`; nothing of an older state that has none."""
    if not memory.size:
        return
    wanted = {**getattr(task, _BOUND, {}), **_parse(memory)}
    present = dict(_attributes(task))
    for name, value in present.items():
        if name not in wanted and not _is_handle(value):
            delattr(task, name)
    for name, text in wanted.items():
        try:
            if name in present and _text_of(task, present[name]) == text:
                continue
            _set(task, name, _from_json(json.loads(text), present.get(name)))
        except _UnknownError as error:
            raise ArgumentError(
                f"{_called(task)}: attribute '{name}' of the state cannot be restored: {error}. "
                f"{_NEXT_STEP}"
            ) from None
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            raise ArgumentError(
                f"{_called(task)}: attribute '{name}' of the state cannot be restored: the state "
                f"is damaged, or of another task ({error})"
            ) from None


_NEXT_STEP = (
    "Define memory(), which returns what the episode has set as numbers, and recall(memory), which "
    "restores it"
)


def _called(task: Any) -> str:
    return f"task '{type(task).__name__}'"


def _text_of(task: Any, value: Any) -> str | None:
    try:
        return _Encoder(task).text(value)
    except _UnknownError:
        return None


def _attributes(owner: Any) -> Iterator[tuple[str, Any]]:
    """Yields the attributes of an object itself, not of its class."""
    for name, value in list(getattr(owner, "__dict__", {}).items()):
        if name not in (_BOUND, _BOUND_CLASSES):
            yield name, value
    for name in _slots(type(owner)):
        if hasattr(owner, name):
            yield name, getattr(owner, name)


def _slots(kind: type) -> list[str]:
    names: list[str] = []
    for base in kind.__mro__:
        slots = vars(base).get("__slots__", ())
        names += (slots,) if isinstance(slots, str) else slots
    return [name for name in names if name not in ("__dict__", "__weakref__")]


def _set(owner: Any, name: str, value: Any) -> None:
    if value is getattr(owner, name, None):
        return
    try:
        setattr(owner, name, value)
    except dataclasses.FrozenInstanceError:
        object.__setattr__(owner, name, value)


def _is_handle(value: Any) -> bool:
    """Returns True for robocell's objects and for objects of classes derived from them."""
    bases = (base.__module__ for base in type(value).__mro__)
    return not isinstance(value, _OWN_VALUES) and any(
        each.split(".")[0] == "robocell" for each in bases
    )


def _is_own_object(value: Any) -> bool:
    """Returns True for an instance of a Python class, which its attributes define."""
    kind = type(value)
    bases = [base for base in kind.__mro__ if base is not object]
    is_python = all(base.__flags__ & _HEAP_TYPE for base in bases)
    room = 8 * (2 + len(_slots(kind)))  # for __dict__ and __weakref__; C's classes need more
    return is_python and kind.__basicsize__ <= object.__basicsize__ + room


def _has_stored_attributes(value: Any) -> bool:
    """Returns True for objects that a state stores by their attributes."""
    if isinstance(value, (enum.Enum, *_CONSTANTS)) or _is_handle(value):
        return False
    return _is_own_object(value)


_OWN_VALUES = (Pose, Rng, TaskVerdict)  # robocell's own that are no handles
_HEAP_TYPE = 1 << 9  # Py_TPFLAGS_HEAPTYPE: not a class of Python's own
_CONSTANTS = (
    type,
    logging.Logger,
    pathlib.PurePath,
    re.Pattern,
    types.BuiltinFunctionType,
    types.FunctionType,
    types.MethodType,
    types.ModuleType,
)


class _Encoder:
    """Makes JSON of a value: lists [tag, content], and None, bool, int, float, str as they are."""

    def __init__(self, task: Any) -> None:
        self._outer = {id(task)}  # what the value is an attribute of
        self._depth = 0  # of containers
        self.has_objects_in_containers = False
        self.has_functions_with_state = False
        self.classes: set[type] = set()  # of the objects in it

    def text(self, value: Any) -> str:
        return json.dumps(self._plain(value))

    def _plain(self, value: Any) -> Any:
        if value is None or type(value) in (bool, int, float, str):
            return value
        if type(value) in _CONTAINERS:
            return self._container(value)
        if type(value) in _VALUES:
            tag, encode = _VALUES[type(value)]
            return [tag, encode(value)]
        if isinstance(value, enum.Enum):
            content = [type(value).__module__, type(value).__qualname__, value.name]
            if _enum(*content) is not value:
                raise _UnknownError(f"holds {value}, whose class is not found in its module")
            return ["enum", *content]
        if isinstance(value, np.generic) and not value.dtype.hasobject:
            return ["number", value.dtype.str, value.tobytes().hex()]
        return self._object(value)

    def _object(self, value: Any) -> Any:
        self.has_objects_in_containers |= self._depth > 0
        if id(value) in self._outer:
            return ["outer"]
        if isinstance(value, _CONSTANTS):
            self._outer.add(id(value))
            state = [self._plain(each) for each in _state_of(value)]
            if any(not _is_constant(each) for each in state):
                self.has_functions_with_state = True
                return ["constant", _name_of(value), state]
            return ["constant", _name_of(value)]
        if _is_handle(value):
            return ["handle"]
        if not _is_own_object(value):
            kind = type(value)
            raise _UnknownError(
                f"holds a {kind.__module__}.{kind.__qualname__}, which robocell cannot keep"
            )
        self._outer.add(id(value))
        self.classes.add(type(value))
        return ["object", {name: self._plain(each) for name, each in _attributes(value)}]

    def _container(self, value: Any) -> Any:
        if id(value) in self._outer:
            raise _UnknownError("holds a container that contains itself")
        self._outer.add(id(value))
        self._depth += 1
        if isinstance(value, dict):
            items = [[self._plain(key), self._plain(each)] for key, each in value.items()]
        else:
            items = [self._plain(each) for each in value]
            if isinstance(value, set | frozenset):
                items.sort(key=json.dumps)
        self._depth -= 1
        self._outer.discard(id(value))
        return [type(value).__name__, items]


_CONTAINERS = (list, tuple, dict, set, frozenset)


def _state_of(value: Any) -> list[Any]:
    """Returns what a function has beside its code, or what a method is of."""
    owner = getattr(value, "__self__", None)
    if isinstance(value, types.MethodType | types.BuiltinFunctionType):
        return [] if owner is None or isinstance(owner, types.ModuleType | type) else [owner]
    if not isinstance(value, types.FunctionType):
        return []
    state = [*(value.__defaults__ or ()), *(value.__kwdefaults__ or {}).values()]
    state += vars(value).values()
    for cell in value.__closure__ or ():
        try:
            state.append(cell.cell_contents)
        except ValueError:  # not set yet
            continue
    return state


def _is_constant(plain: Any) -> bool:
    """Returns True for what restored states leave as it is."""
    return isinstance(plain, list) and plain[0] in ("outer", "handle", "constant")


def _name_of(value: Any) -> str:
    """Returns the name of a constant, with its line: functions without a name are many."""
    name = f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', value)}"
    code = getattr(value, "__code__", None)
    return f"{name}:{code.co_firstlineno}" if code is not None else name


def _array(value: npt.NDArray[Any]) -> Any:
    if value.dtype.hasobject or value.dtype.names:
        raise _UnknownError(f"holds an array of {value.dtype}, which robocell cannot keep")
    return [value.dtype.str, list(value.shape), np.ascontiguousarray(value).tobytes().hex()]


_VALUES: dict[type, tuple[str, Callable[[Any], Any]]] = {
    bytes: ("bytes", lambda value: value.hex()),
    Pose: ("pose", lambda value: list(value.__getstate__())),
    np.ndarray: ("array", _array),
}


def _from_json(value: Any, present: Any) -> Any:
    """Returns the value; `present`: the one in its place, which handles and objects remain."""
    if not isinstance(value, list):
        return value
    tag, *content = value
    if tag in ("handle", "outer"):
        return present
    if tag == "constant":
        if content[0] != _name_of(present):
            raise _UnknownError(f"it is {content[0]}, and here {_name_of(present)}")
        return present
    if tag == "object":
        return _restored(present, content[0])
    if tag == "enum":
        return _enum(*content)
    return _FROM[tag](*content)


def _restored(present: Any, attributes: Mapping[str, Any]) -> Any:
    if not _is_own_object(present):
        raise _UnknownError("there is no such object here; make it in bind() or begin()")
    now = dict(_attributes(present))
    for name in now.keys() - attributes.keys():
        delattr(present, name)
    for name, each in attributes.items():
        _set(present, name, _from_json(each, now.get(name)))
    return present


def _inner(value: Any) -> Any:
    return _from_json(value, None)


def _enum(module: str, qualname: str, name: str) -> Any:
    """Returns the member; only of a class that is loaded."""
    try:
        kind = functools.reduce(getattr, qualname.split("."), sys.modules[module])
        if isinstance(kind, enum.EnumMeta):
            return kind[name]
    except (KeyError, AttributeError):
        pass
    raise _UnknownError(f"there is no {module}.{qualname}.{name}")


def _pose(numbers: list[float]) -> Pose:
    pose = Pose.__new__(Pose)
    pose.__setstate__(tuple(numbers))
    return pose


def _from_array(content: list[Any]) -> npt.NDArray[Any]:
    dtype, shape, data = content
    return np.frombuffer(bytes.fromhex(data), np.dtype(dtype)).reshape(shape).copy()


_FROM: dict[str, Callable[..., Any]] = {
    "bytes": bytes.fromhex,
    "pose": _pose,
    "array": _from_array,
    "number": lambda dtype, data: np.frombuffer(bytes.fromhex(data), np.dtype(dtype))[0],
    "list": lambda items: [_inner(each) for each in items],
    "tuple": lambda items: tuple(_inner(each) for each in items),
    "dict": lambda pairs: {_inner(key): _inner(each) for key, each in pairs},
    "set": lambda items: {_inner(each) for each in items},
    "frozenset": lambda items: frozenset(_inner(each) for each in items),
}


def _to_numbers(text: str) -> npt.NDArray[np.float64]:
    """Packs a text: its length in bytes, then integers of six bytes."""
    data = text.encode()
    padded = data + bytes(-len(data) % _BYTES_PER_NUMBER)
    rows = np.frombuffer(padded, np.uint8).reshape(-1, _BYTES_PER_NUMBER).astype(np.float64)
    values = rows @ (256.0 ** np.arange(_BYTES_PER_NUMBER))
    return np.concatenate([[float(len(data))], values])


def _parse(memory: npt.NDArray[np.float64]) -> dict[str, str]:
    """Reads the attributes from the numbers of a state. Raises ArgumentError for other numbers."""
    try:
        length, values = int(memory[0]), memory[1:].astype(np.uint64)
        shifts = np.arange(_BYTES_PER_NUMBER, dtype=np.uint64) * np.uint64(8)
        data = ((values[:, None] >> shifts) & np.uint64(255)).astype(np.uint8).tobytes()
        changed = json.loads(data[:length].decode())
        if isinstance(changed, dict) and all(isinstance(each, str) for each in changed.values()):
            return changed
    except (ValueError, OverflowError):
        pass
    raise ArgumentError(
        "the state does not hold a task's attributes: it is of another task, or of one that "
        "defines memory()"
    )
