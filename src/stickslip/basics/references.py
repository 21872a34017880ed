"""What functions read besides their arguments: global names, closures, attributes of classes and of objects, recursively.

Functions and classes of Python, of NumPy and of this package that compute the same whenever they are called are not searched. Where
something else can change, such as a file, a clock, a generator of random numbers or an object without attributes, the list of what is
read is not complete.
"""

from __future__ import annotations

import dis
import enum
import functools
import sys
import types
from abc import ABCMeta
from collections.abc import Iterator, Mapping
from itertools import repeat
from operator import is_
from typing import Any

import numpy as np

from stickslip.basics.fingerprints import content_of, is_of_library, within_descriptor

_MOST, _LARGEST = 1500, 4096  # objects that are searched; numbers of an array
_NOTHING = object()  # where a name is not defined
_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(...), np.generic, np.ufunc)
#: Libraries whose functions give the same for the same arguments, and those parts of them that do not.
_PURE = frozenset(
    {
        "stickslip", "numpy", "math", "cmath", "builtins", "functools", "itertools", "operator", "dataclasses", "typing", "types", "abc",
        "collections", "enum", "numbers", "fractions", "decimal", "statistics", "contextlib", "_abc", "_collections", "_functools",
        "_operator", "__future__",
    }
)  # fmt: skip
_PURE_OWN = ("stickslip.basics", "stickslip.models", "stickslip.maths")
_IMPURE = frozenset(
    {
        "random", "load", "loadtxt", "genfromtxt", "fromfile", "memmap", "open", "input", "eval", "exec", "compile", "globals", "locals",
        "vars", "getattr", "setattr", "id", "hash", "dir", "__import__", "breakpoint", "attrgetter", "methodcaller",
    }
)  # fmt: skip
_CACHES = type(functools.lru_cache(abs))
_HELD = (types.GetSetDescriptorType, types.MemberDescriptorType, types.WrapperDescriptorType, types.MethodDescriptorType)
_MADE = frozenset({"__init__", "__eq__", "__hash__", "__setattr__", "__delattr__", "__lt__", "__le__", "__gt__", "__ge__"})
_ASIDE = frozenset({"__doc__", "__annotations__", "__dataclass_fields__", "__dataclass_params__", "__repr__", "__str__"})
_ON_HEAP = 1 << 9  # flag of classes that are written in Python


class References:
    """Everything that some objects read, with what it is now.

    Attributes
    ----------
    complete : bool
        Whether nothing else can change what the objects compute.
    patched : bool
        Whether a method of this package is somebody else's.

    Examples
    --------
    >>> factor = 2.0
    >>> read = References(lambda x: factor * x)
    >>> read.complete, read.unchanged()
    (True, True)
    >>> factor = 3.0
    >>> read.unchanged()
    False
    >>> import time
    >>> References(lambda x: time.time() * x).complete
    False
    """

    def __init__(self, *things: Any):
        self.complete, self.patched = True, False
        self._read: dict[int, Any] = {}  # by id; the objects are held, so that their ids stay their own
        self._modules: dict[tuple[int, frozenset[str]], Any] = {}
        self._whole: list[tuple[Mapping[Any, Any], tuple[Any, ...]]] = []
        self._named: list[tuple[Mapping[Any, Any], tuple[str, ...], tuple[Any, ...]]] = []
        self._lists: list[tuple[list[Any], tuple[Any, ...]]] = []
        self._arrays: list[tuple[np.ndarray[Any, Any], bytes]] = []
        self._cells: list[tuple[Any, Any]] = []
        self._functions: list[tuple[Any, Any, Any, Any]] = []
        for thing in things:
            self._search(thing)

    def unchanged(self) -> bool:
        """Whether all that is read is the same as it was."""
        for mapping, values in self._whole:
            if len(mapping) != len(values) or not all(map(is_, mapping.values(), values)):
                return False
        for mapping, names, values in self._named:
            if not all(map(is_, map(mapping.get, names, repeat(_NOTHING)), values)):
                return False
        for cell, value in self._cells:
            if content_of(cell, _NOTHING) is not value:
                return False
        for function, code, defaults, keywords in self._functions:
            if function.__code__ is not code or function.__defaults__ is not defaults or function.__kwdefaults__ is not keywords:
                return False
        for items, values in self._lists:
            if len(items) != len(values) or not all(map(is_, items, values)):
                return False
        return all(array.tobytes() == content for array, content in self._arrays)

    def _search(self, thing: Any, ours: bool = False) -> None:
        """Search an object; `ours` if a record of this package holds it, which does not change."""
        if isinstance(thing, _PLAIN) or not self.complete or id(thing) in self._read:
            return
        self._read[id(thing)] = thing
        if len(self._read) > _MOST:
            self.complete = False
        elif isinstance(thing, type):
            self._class(thing)
        elif isinstance(thing, types.FunctionType):
            self._function(thing)
        elif isinstance(thing, types.ModuleType):
            self.complete = False
        elif isinstance(thing, (types.BuiltinFunctionType, *_HELD)):
            self._builtin(thing)
        elif not self._several(thing, ours) and not self._wrapper(thing):
            self._object(thing)

    def _several(self, thing: Any, ours: bool) -> bool:
        kind = type(thing)
        if isinstance(thing, np.ndarray):
            fixed = ours and not thing.flags.writeable
            if kind is not np.ndarray or thing.dtype.hasobject or (thing.size > _LARGEST and not fixed):
                self.complete = False
            elif not fixed:
                self._arrays.append((thing, thing.tobytes()))
            return True
        if kind is dict or kind is types.MappingProxyType:
            values = tuple(thing.values())
            self._whole.append((thing, values))
        elif kind is list:
            values = tuple(thing)
            self._lists.append((thing, values))
        elif kind in (tuple, frozenset) or (isinstance(thing, tuple) and hasattr(kind, "_fields")):
            values = tuple(thing)
        else:
            return False
        for value in values:
            self._search(value, ours)
        return True

    def _wrapper(self, thing: Any) -> bool:
        kind = type(thing)
        if kind is types.MethodType:
            parts = [thing.__func__, thing.__self__]
        elif kind is functools.partial:
            parts = [thing.func, thing.args, thing.keywords]
        elif kind is _CACHES:
            parts = [thing.__wrapped__]
        elif isinstance(thing, (property, staticmethod, classmethod, functools.cached_property)):
            parts = [getattr(thing, name, None) for name in ("fget", "fset", "__func__", "func")]
        elif isinstance(thing, enum.Enum):
            parts = [thing.value]
        else:
            return kind.__module__ in ("typing", "types")
        for part in parts:
            self._search(part)
        return True

    def _builtin(self, thing: Any) -> None:
        owner = getattr(thing, "__self__", None)
        if isinstance(owner, types.ModuleType) or owner is None:
            self.complete &= thing.__name__ not in _IMPURE and (isinstance(thing, _HELD) or _is_pure(thing.__module__))
        else:
            self._search(owner)

    def _class(self, cls: Any) -> None:
        if not isinstance(cls, ABCMeta) and type(cls) is not type and not is_of_library(type(cls)):
            self.complete = False
        for base in cls.__mro__:
            library = is_of_library(base)
            if library and not base.__module__.startswith("stickslip"):
                self.complete &= _is_pure(base.__module__)
                continue
            if id(base) in self._read and base is not cls:
                continue
            self._read[id(base)] = base
            self._whole.append((vars(base), tuple(vars(base).values())))
            for name, part in list(vars(base).items()):
                if name in _ASIDE or (name in _MADE and getattr(getattr(part, "__code__", None), "co_filename", "") == "<string>"):
                    continue
                if not library or _is_changed(part):
                    self.patched |= library
                    self._search(part)

    def _object(self, thing: Any) -> None:
        cls = type(thing)
        python = all(base is object or (base.__flags__ & _ON_HEAP and not vars(base).get("__slots__")) for base in cls.__mro__)
        if not python or not hasattr(thing, "__dict__"):
            self.complete = False
            return
        self._search(cls)
        ours = is_of_library(cls)
        if not ours:
            self._whole.append((vars(thing), tuple(vars(thing).values())))
        for value in tuple(vars(thing).values()):
            self._search(value, ours)

    def _function(self, function: types.FunctionType) -> None:
        if is_of_library(function):
            module = str(function.__globals__.get("__name__", ""))
            own = not module.startswith("stickslip") or module.startswith(_PURE_OWN)
            self.complete &= own and _is_pure(module) and function.__name__ not in _IMPURE
            return
        self._functions.append((function, function.__code__, function.__defaults__, function.__kwdefaults__))
        self._search(function.__defaults__)
        self._search(function.__kwdefaults__)
        if vars(function):
            self._search(vars(function))
        for cell in function.__closure__ or ():
            content = content_of(cell, _NOTHING)
            self._cells.append((cell, content))
            if content is not _NOTHING:
                self._search(content)
        names, attributes, imported = _names(function.__code__)
        known = function.__globals__
        if (names - known.keys()) & _IMPURE:
            self.complete = False
        used = tuple(sorted(names))
        self._named.append((known, used, tuple(known.get(name, _NOTHING) for name in used)))
        for name in imported:
            loaded = sys.modules.get(name)  # none for what is not imported yet, and for a name within a package
            self.complete &= isinstance(loaded, types.ModuleType)
            self._value(loaded, attributes | names)
        for name in used:
            if name in known:
                self._value(known[name], attributes)

    def _value(self, value: Any, attributes: frozenset[str]) -> None:
        """Search a global value; of a module the parts that are named."""
        if not isinstance(value, types.ModuleType):
            if value is not _NOTHING:
                self._search(value)
            return
        held = vars(value)
        if (id(value), attributes) in self._modules:
            return
        self._modules[id(value), attributes] = value
        library = _is_pure(value.__name__)
        if "__getattr__" in held and not library:
            self.complete = False
            return
        names = tuple(sorted(attributes & held.keys()))
        self._named.append((held, names, tuple(held[name] for name in names)))
        for name in names:
            if library and name in _IMPURE:
                self.complete = False
            self._value(held[name], attributes)


def _is_pure(module: str | None) -> bool:
    return str(module or "builtins").partition(".")[0] in _PURE and not str(module).startswith("numpy.random")


def _is_changed(part: Any) -> bool:
    """Whether a part of a class of this package is a function that somebody else put there."""
    inner = within_descriptor(part)
    own = ("stickslip", "typing", "dataclasses")
    return isinstance(inner, types.FunctionType) and not str(inner.__globals__.get("__name__")).startswith(own)


@functools.lru_cache(maxsize=1024)
def _names(code: types.CodeType) -> tuple[frozenset[str], frozenset[str], frozenset[str]]:
    """The global names, the attributes and the modules that a function's code names, with those of the functions within it."""
    names, attributes, imported = set[str](), set[str](), set[str]()
    for step in _steps(code):
        if step.opname == "IMPORT_NAME":
            imported.add(str(step.argval))
        elif step.opname in ("LOAD_GLOBAL", "LOAD_NAME", "STORE_GLOBAL", "STORE_NAME"):
            names.add(str(step.argval))
        elif step.opcode in dis.hasname:
            attributes.add(str(step.argval))
    return frozenset(names), frozenset(attributes), frozenset(imported)


def _steps(code: types.CodeType) -> Iterator[dis.Instruction]:
    yield from dis.get_instructions(code)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _steps(constant)
