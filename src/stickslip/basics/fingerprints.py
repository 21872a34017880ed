"""Fingerprints of Python objects: equal in every process for objects that compute the same, whatever their addresses and line numbers.

A function is identified by its instructions, constants, closure, defaults, attributes, and by the global values and functions to which it
refers, recursively; an object by its class and its attributes; data by their values. Names of files, line numbers, comments, docstrings
and names of local variables do not matter. The functions and classes of Python, of this package and of the libraries that it is built on
are identified by name, since their versions are recorded elsewhere. What has no content that could be compared is listed as unchecked.
"""

from __future__ import annotations

import dis
import enum
import functools
import hashlib
import importlib
import os
import re
import sys
import types
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Libraries whose functions and classes are identified by name.
_LIBRARIES = frozenset({"stickslip", "numpy", "scipy", "xarray", "pandas", "llvmlite", "h5py", "h5netcdf", "matplotlib", "dask"})
_MOST, _DEEPEST = 50_000, 150  # objects of one fingerprint; what refers to more, such as to a whole library, is unchecked
#: Attributes of a class that say nothing about what it computes, or that follow from others.
_ASIDE = frozenset(
    {
        "__doc__", "__module__", "__qualname__", "__dict__", "__weakref__", "__firstlineno__", "__static_attributes__", "__annotations__",
        "__annotate__", "__annotate_func__", "__annotations_cache__", "__dataclass_fields__", "__dataclass_params__", "__match_args__",
        "__abstractmethods__", "_abc_impl", "__parameters__", "__orig_bases__", "__slots__", "__repr__", "__str__", "__replace__",
    }
)  # fmt: skip
_BY_TEXT = frozenset({"eval", "exec", "compile", "globals", "getattr", "vars", "import_module", "attrgetter", "__import__"})
_IMPORTERS = frozenset({"import_module", "__import__", "exec"})
_ENVIRONMENT = frozenset({"environ", "getenv", "environb", "expandvars"})
_READERS = frozenset({"open", "read_text", "read_bytes", "loadtxt", "genfromtxt", "fromfile", "read_csv", "load", "urlopen"})
_NAME = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True)
class Fingerprint:
    """The fingerprint of an object.

    Parameters
    ----------
    digest : str
        Hash of its content.
    unchecked : tuple of str
        Parts that have no content that could be compared, as sentences.
    """

    digest: str
    unchecked: tuple[str, ...] = ()


def fingerprint(*things: Any) -> Fingerprint:
    """The fingerprint of some objects together.

    Examples
    --------
    >>> def scaled(factor):
    ...     return lambda x: factor * x
    >>> fingerprint(scaled(2.0)) == fingerprint(scaled(2.0)), fingerprint(scaled(2.0)) == fingerprint(scaled(3.0))
    (True, False)
    >>> import threading
    >>> fingerprint({"lock": threading.Lock()}).unchecked
    ('a lock, whose content cannot be compared',)
    """
    walk = _Walk()
    walk.several("together", things)
    return Fingerprint(walk.hash.hexdigest(), tuple(dict.fromkeys(walk.unchecked)))


def is_of_library(thing: Any) -> bool:
    """Whether a function or a class belongs to Python, to this package, or to a library that it is built on.

    It must be what the library has under that name: what a user makes, and gives the name of something of a library, is the user's own.

    Examples
    --------
    >>> is_of_library(os.path.join), is_of_library(np.ndarray), is_of_library(functools.wraps(os.path.join)(lambda x: x))
    (True, True, False)
    """
    if isinstance(thing, types.FunctionType):
        module, name = str(thing.__globals__.get("__name__", "")), thing.__code__.co_qualname
        return _is_library(module) and "<" not in name and vars(sys.modules.get(module, object)) is thing.__globals__
    if isinstance(thing, type):
        return _is_library(thing.__module__) and (not thing.__flags__ & _ON_HEAP or _is_there(thing))
    return _is_library(getattr(thing, "__module__", None) or "builtins")


_ON_HEAP, _UNCHANGEABLE = 1 << 9, 1 << 8  # flags of classes: those that are written in Python have the first one only


def _is_there(cls: type) -> bool:
    """Whether a class is what its module has under its name."""
    owner: Any = sys.modules.get(cls.__module__)
    for name in cls.__qualname__.split("."):
        owner = getattr(owner, name, None)
    return owner is cls


def _is_library(module: Any) -> bool:
    name = str(module or "").partition(".")[0]
    return name in _LIBRARIES or (name in sys.stdlib_module_names and name != "__main__") or name == "builtins"


class _Walk:
    """Writes the content of objects into a hash; each object is read once."""

    def __init__(self) -> None:
        self.hash = hashlib.sha256()
        self.unchecked: list[str] = []
        self._read: dict[int, tuple[str, Any]] = {}  # digests by id; the objects are kept, so that their ids stay their own
        self._inside: dict[int, int] = {}  # objects that are being read, with their depth

    def put(self, *words: str) -> None:
        """Write words."""
        for word in words:
            text = word.encode("utf-8", "surrogatepass")
            self.hash.update(b"%d:" % len(text) + text)

    def of(self, thing: Any) -> None:
        """Write an object."""
        self.put(self._digest(thing))

    def _digest(self, thing: Any) -> str:
        kind = type(thing)
        if kind in _PLAIN:
            return f"{kind.__name__} {thing.hex() if kind is float else repr(thing)}"
        key = id(thing)
        if key in self._read:
            return self._read[key][0]
        if key in self._inside:  # it refers to itself
            return f"above {len(self._inside) - self._inside[key]}"
        if len(self._read) > _MOST or len(self._inside) > _DEEPEST:
            self.unchecked.append(f"what more than {_MOST} objects refer to, or is more than {_DEEPEST} deep")
            return "unchecked"
        self._inside[key] = len(self._inside)
        outer, self.hash = self.hash, hashlib.sha256()
        try:
            next(write for test, write in _KINDS if test(thing))(self, thing)
            digest = self.hash.hexdigest()
        finally:
            self.hash = outer
            del self._inside[key]
        self._read[key] = digest, thing
        return digest

    def several(self, word: str, things: Iterable[Any]) -> None:
        """Write objects in their order."""
        digests = [self._digest(thing) for thing in things]
        self.put(word, str(len(digests)), *digests)

    def unordered(self, word: str, things: Iterable[Any]) -> None:
        """Write objects whose order says nothing."""
        digests = sorted(self._digest(thing) for thing in things)
        self.put(word, str(len(digests)), *digests)

    def named(self, word: str, values: Mapping[Any, Any]) -> None:
        """Write values with their names; their order says nothing."""
        self.unordered(word, list(values.items()))

    def cannot(self, what: str) -> None:
        """Note a part that is unchecked."""
        self.put("unchecked", what)
        self.unchecked.append(what)


_PLAIN = frozenset({bool, int, float, complex, str, bytes, type(None), type(...), type(NotImplemented)})


# ---- data ----
def _array(walk: _Walk, array: Any) -> None:
    walk.put("array", array.dtype.str, str(array.shape))
    if array.dtype.hasobject:
        walk.several("items", array.ravel().tolist())
    else:
        walk.hash.update(np.ascontiguousarray(array).tobytes())


def _labelled(walk: _Walk, array: Any) -> None:
    walk.put("labelled", *map(str, array.dims))
    walk.of(np.asarray(array.values))


def _sequence(walk: _Walk, items: Any) -> None:
    walk.several(type(items).__name__, items)
    _attributes(walk, items)


def _set(walk: _Walk, items: Any) -> None:
    walk.unordered("set", items)


def _mapping(walk: _Walk, items: Any) -> None:
    walk.named(type(items).__name__, dict(items))
    _attributes(walk, items)


def _member(walk: _Walk, member: Any) -> None:
    walk.put("member", type(member).__qualname__, member.name)
    walk.of(member.value)


# ---- functions ----
def _function(walk: _Walk, function: Any) -> None:
    if is_of_library(function):
        walk.put("named", f"{function.__module__}.{function.__qualname__}")
        return
    walk.put("function")
    walk.several("defaults", function.__defaults__ or ())
    walk.named("keywords", function.__kwdefaults__ or {})
    names = _code(walk, function.__code__)
    walk.several("closure", (content_of(cell) for cell in function.__closure__ or ()))
    walk.named("attributes", {name: value for name, value in vars(function).items() if name not in ("__wrapped__", "__doc__")})
    _globals(walk, function, names)


def content_of(cell: Any, empty: Any = ...) -> Any:
    """The value in a cell of a closure, or `empty` where its name is bound later."""
    try:
        return cell.cell_contents
    except ValueError:
        return empty


@dataclass(frozen=True)
class _Names:
    """What a function's code refers to: names, modules that it imports, and texts that may be names."""

    names: frozenset[str]
    imports: frozenset[str]
    texts: frozenset[str]


def _code(walk: _Walk, code: types.CodeType) -> _Names:
    """Write the instructions of a function and of those within it; what they refer to."""
    taken = code.co_argcount + code.co_kwonlyargcount
    walk.put("code", str((code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags & 0xFFFF)))
    walk.put(*code.co_varnames[:taken])
    walk.put(getattr(code, "co_exceptiontable", b"").hex())
    names, imports, texts = set(code.co_names), set[str](), set[str]()
    steps = [step for step in dis.get_instructions(code) if step.opname != "CACHE"]
    for at, (step, after) in enumerate(zip(steps, [*steps[1:], None], strict=True)):
        walk.put(step.opname)
        if step.opcode in dis.hasconst:
            if after is not None and after.opname == "STORE_NAME" and after.argval in ("__doc__", "__firstlineno__", "__qualname__"):
                continue
            for part in _constants(step.argval):
                if isinstance(part, types.CodeType):
                    inner = _code(walk, part)
                    names |= inner.names
                    imports |= inner.imports
                    texts |= inner.texts
                else:
                    walk.of(part)
                    texts |= {part} if isinstance(part, str) else set()
        elif step.opcode in dis.hasname or step.opcode in dis.hasfree:
            walk.put(str(step.argval))
            if step.opname == "IMPORT_NAME":
                imports.add("." * int(steps[at - 2].argval) + str(step.argval))  # level and names are loaded before
        else:
            walk.put(str(step.arg))
    return _Names(frozenset(names), frozenset(imports), frozenset(texts))


def _constants(value: Any) -> Iterator[Any]:
    """A constant, or the members of one that is a set or a tuple."""
    if isinstance(value, (tuple, frozenset)):
        yield f"{type(value).__name__} {len(value)}"
        for part in value if isinstance(value, tuple) else sorted(value, key=repr):
            yield from _constants(part)
    else:
        yield value


def _globals(walk: _Walk, function: Any, used: _Names) -> None:
    """Write the global values to which a function refers, the environment variables that it reads, and whether it reads files."""
    known, names, imports = function.__globals__, set(used.names), set(used.imports)
    if names & _BY_TEXT:
        words = {word for text in used.texts for word in _NAME.findall(text)}
        names |= words
        imports |= {word for word in words if not _is_library(word)} if names & _IMPORTERS else set()
    for name in sorted(names | imports):
        if name in known:
            walk.put("global", name)
            _value(walk, known[name], names)
        elif name in imports and (module := _module_of(name, known.get("__package__"))):
            _value(walk, module, names)
    if names & _ENVIRONMENT:
        read = sorted(text for text in used.texts | _texts(known, names) if _NAME.fullmatch(text))
        walk.several("environment", [part for name in read for part in (name, os.environ.get(name))])
        if not read:
            walk.cannot("environment variables whose names are computed")
    for name in sorted(names & _READERS):
        if name not in known and (name == "open" or not _is_attribute_of_own(known, names, name)):
            walk.cannot(f"a file that is read ({name}) whenever {function.__qualname__} is called")


def _module_of(name: str, package: str | None) -> types.ModuleType | None:
    """A module that a function imports, whether or not it has been called in this process; None if there is no such module."""
    try:
        return importlib.import_module(name, package)
    except Exception:  # whatever a module raises that is imported
        return None


def _texts(known: Mapping[str, Any], names: set[str]) -> set[str]:
    return {known[name] for name in names if isinstance(known.get(name), str)}


def _is_attribute_of_own(known: Mapping[str, Any], names: set[str], name: str) -> bool:
    """Whether a name is that of an attribute of something of the user's own, such as a method `load` of a law."""
    return name == "load" and not any(isinstance(known.get(each), types.ModuleType) and hasattr(known[each], "loadtxt") for each in names)


def _value(walk: _Walk, value: Any, names: set[str]) -> None:
    """Write a global value; of a module the parts that are named."""
    if not isinstance(value, types.ModuleType):
        walk.of(value)
        return
    own = not _is_library(value.__name__)
    walk.put("module", "" if own else value.__name__)
    for name in sorted(names & vars(value).keys()):
        part = vars(value)[name]
        if own and part is not value:
            walk.put(name)
            _value(walk, part, names)
        elif isinstance(part, types.FunctionType) and not is_of_library(part):  # put there by somebody
            walk.put(name)
            walk.of(part)


def _method(walk: _Walk, method: Any) -> None:
    walk.several("method", (method.__func__, method.__self__))


def _builtin(walk: _Walk, function: Any) -> None:
    walk.put("builtin", str(function.__qualname__))
    owner = getattr(function, "__self__", None)
    if not isinstance(owner, (types.ModuleType, type(None))):
        walk.of(owner)


def _by_name(walk: _Walk, thing: Any) -> None:
    walk.put("named", thing.__name__)


def _partial(walk: _Walk, made: Any) -> None:
    walk.several("partial", (made.func, made.args))
    walk.named("keywords", made.keywords)


def _wrapper(walk: _Walk, made: Any) -> None:
    walk.several("wrapper", (getattr(made, "__wrapped__", None) or made.py_func,))


def _descriptor(walk: _Walk, made: Any) -> None:
    names = ("fget", "fset", "fdel", "__func__", "func")
    walk.several(type(made).__name__, [getattr(made, name, None) for name in names])


def _plain_code(walk: _Walk, code: Any) -> None:
    _code(walk, code)


def _module(walk: _Walk, module: Any) -> None:
    walk.put("module", module.__name__)


# ---- classes and objects ----
def _class(walk: _Walk, cls: Any) -> None:
    walk.put("class", cls.__qualname__)
    for base in cls.__mro__:
        ours = is_of_library(base)
        for name, part in sorted(vars(base).items()):
            if name in _ASIDE:
                continue
            if not ours:
                walk.put(name)
                walk.of(part)
            elif base.__module__.startswith("stickslip") and _is_changed(part, base):
                walk.put("changed", base.__qualname__, name)
                walk.of(part)


def within_descriptor(part: Any) -> Any:
    """The function in a property, a method of a class or a cached property; anything else as it is."""
    return getattr(part, "fget", None) or getattr(part, "__func__", None) or getattr(part, "func", None) or part


def _is_changed(part: Any, base: type) -> bool:
    """Whether a part of a class of this package is a function that somebody else put there, or a number."""
    inner = within_descriptor(part)
    if isinstance(inner, types.FunctionType):
        return not is_of_library(inner)
    return isinstance(part, (int, float, np.ndarray))


def _object(walk: _Walk, thing: Any) -> None:
    """Any other object: its class and its attributes; or what would be pickled of it."""
    cls = type(thing)
    walk.of(cls)
    if cls.__reduce_ex__ is object.__reduce_ex__ and cls.__reduce__ is object.__reduce__ and _has_attributes(cls):
        _attributes(walk, thing)
        return
    try:
        parts = thing.__reduce_ex__(4)
    except Exception:  # whatever an object raises that cannot be pickled
        walk.cannot(f"a {cls.__qualname__}, whose content cannot be compared")
        return
    if isinstance(parts, str):
        walk.put("named", parts)
        return
    make, arguments, state, *items = (*parts, None, None, None, None)[:5]
    walk.several("made", (make, arguments, state))
    for each in items:
        walk.several("items", each or ())


def _has_attributes(cls: type) -> bool:
    """Whether all that an object holds are its attributes: it is an instance of no class that is written in C, but `object`."""
    return all(base is object or _is_python(base) for base in cls.__mro__)


def _is_python(base: type) -> bool:
    is_written_in_c = not base.__flags__ & _ON_HEAP or base.__flags__ & _UNCHANGEABLE
    return not is_written_in_c and bool(base.__dictoffset__ or "__slots__" in vars(base))


def _attributes(walk: _Walk, thing: Any) -> None:
    """Write the attributes of an object, without what is computed of others and kept."""
    cls = type(thing)
    values = dict(getattr(thing, "__dict__", {}))
    slots = (name for base in cls.__mro__ for name in _slots(base) if not name.startswith("__"))
    values |= {name: getattr(thing, name) for name in slots if hasattr(thing, name)}
    kept = {name for name in values if isinstance(getattr(cls, name, None), functools.cached_property)}
    walk.named("attributes", {name: value for name, value in values.items() if name not in kept})


def _slots(base: type) -> tuple[str, ...]:
    slots = vars(base).get("__slots__", ())
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _is(*kinds: type) -> Callable[[Any], bool]:
    return lambda thing: isinstance(thing, kinds)


#: In the order in which they are asked.
_KINDS: tuple[tuple[Callable[[Any], bool], Callable[[_Walk, Any], None]], ...] = (
    (lambda thing: isinstance(thing, enum.Enum), _member),
    (_is(np.ndarray, np.generic), _array),
    (lambda thing: hasattr(type(thing), "dims") and hasattr(type(thing), "values"), _labelled),
    (_is(type), _class),
    (_is(types.FunctionType), _function),
    (_is(types.MethodType), _method),
    (_is(types.BuiltinFunctionType, types.MethodWrapperType, types.WrapperDescriptorType, types.MethodDescriptorType), _builtin),
    (
        _is(types.ClassMethodDescriptorType, types.GetSetDescriptorType, types.MemberDescriptorType, np.ufunc),
        lambda w, f: w.put(f.__name__),
    ),
    (_is(functools.partial), _partial),
    (lambda thing: callable(getattr(thing, "__wrapped__", None)) or callable(getattr(thing, "py_func", None)), _wrapper),
    (_is(property, staticmethod, classmethod, functools.cached_property), _descriptor),
    (_is(types.CodeType), _plain_code),
    (_is(types.ModuleType), _module),
    (_is(list, tuple), _sequence),
    (_is(set, frozenset), _set),
    (_is(dict, types.MappingProxyType), _mapping),
    (_is(weakref.ref), lambda walk, ref: walk.of(ref())),
    (lambda _: True, _object),
)
