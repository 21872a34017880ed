"""From the source of a kernel to machine code, by LLVM, and from there to functions that Python calls."""

from __future__ import annotations

import ctypes
import gc
import itertools
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.engine.kernel_text import KernelSource
from stickslip.engine.shared_arrays import address_of
from stickslip.engine.signatures import BOOLEAN, FLOAT64, INT8, INT64, VOID, InMemory, Number, Several, Signature, signature

_LEVEL = 3  # of optimisation
#: Processors that STICKSLIP_CPU may name, and what they need.
_LEVELS = {
    "x86-64": (),
    "x86-64-v2": ("sse4.2", "popcnt"),
    "x86-64-v3": ("sse4.2", "popcnt", "avx2", "fma", "bmi2"),
    "x86-64-v4": ("sse4.2", "popcnt", "avx2", "fma", "bmi2", "avx512f", "avx512bw", "avx512dq", "avx512vl"),
}
_number = itertools.count()
_linking = threading.Lock()
_KINDS = {VOID: None, INT64: ctypes.c_int64, FLOAT64: ctypes.c_double, BOOLEAN: ctypes.c_int64}
_ELEMENTS = {FLOAT64: "float64", INT64: "int64", INT8: "int8"}
#: Functions of C that kernels call; on Windows they stand in no list of symbols of the process.
_OF_C = ("asin", "cos", "expm1", "log2", "sin")


@lru_cache(1)
def versions() -> str:
    """What decides on machine code beside its source: the compiler, and the processor."""
    import llvmlite

    return " ".join([llvmlite.__version__, *_processor()])


@lru_cache(1)
def _processor() -> tuple[str, str]:
    """The name and the features of the processor for which is compiled: this one, or the one that STICKSLIP_CPU names."""
    import llvmlite.binding as llvm

    try:
        own = llvm.get_host_cpu_features()
    except RuntimeError:  # a processor of which LLVM asks nothing
        own = llvm.FeatureMap()
    asked = os.environ.get("STICKSLIP_CPU", "")
    if not asked:
        return llvm.get_host_cpu_name(), str(own.flatten())
    allowed = [name for name, needed in _LEVELS.items() if all(map(own.get, needed)) and own.get("sse2")]
    if asked not in allowed:
        names = ", ".join(allowed) or "nothing here: unset it"
        raise InputError("STICKSLIP_CPU", [f"STICKSLIP_CPU = {asked!r}; allowed on this processor is {names}"])
    return asked, ""


def _target() -> Any:
    """The machine here, for code that need not be moved to another."""
    import llvmlite.binding as llvm

    _begin()
    target = llvm.Target.from_default_triple()
    name, features = _processor()
    fixed = "static" if target.name.startswith("x86") else "default"
    return target.create_target_machine(opt=_LEVEL, cpu=name, features=features, reloc=fixed, codemodel="jitdefault", jit=True)


@lru_cache(1)
def _begin() -> None:
    import sys

    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    if sys.platform == "win32":
        library = ctypes.CDLL("ucrtbase")
        for name in _OF_C:
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)


@lru_cache(1)
def _machine() -> Any:
    """The machine for which code is compiled."""
    return _target()


@lru_cache(1)
def _loader() -> Any:
    """What loads code into this process."""
    import llvmlite.binding as llvm

    return llvm.create_lljit_compiler(_target())


@contextmanager
def _without_collections() -> Iterator[None]:
    """Compiling makes a million objects that live until it is done: looking for garbage among them takes up to a fifth of its time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def machine_code(source: KernelSource) -> bytes:
    """The object file of a kernel, for this machine."""
    import llvmlite.binding as llvm

    machine = _machine()
    with _without_collections():
        module = llvm.parse_assembly(instructions(source))
    module.triple, module.data_layout = llvm.get_process_triple(), str(machine.target_data)
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=_LEVEL)
    options.loop_vectorization, options.slp_vectorization = not source.short_loops, False
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    return bytes(machine.emit_object(module))


def instructions(source: KernelSource) -> str:
    """The text of a kernel's instructions, as LLVM reads it."""
    from stickslip.engine.addresses import outside
    from stickslip.engine.emit import write
    from stickslip.engine.functions import write_functions
    from stickslip.engine.instructions import Module

    module, writers = Module(), outside(source.calls, source.shared)
    if source.step is not None:
        step = source.step

        def write_step(builder: Any, args: list[Any]) -> None:
            S, rtol, budget = args
            numbers = {"rtol": rtol, "budget": budget}
            write(builder, S.data, step, numbers)

        writers["step"] = write_step
    write_functions(module, source.entries, source.text, writers)
    return module.text()


class Compiled:
    r"""Compiled functions in this process; they are freed with the last who holds this or one of them.

    Parameters
    ----------
    source : KernelSource
    code : bytes
        Its object file.

    Attributes
    ----------
    addresses : dict
        Where its functions stand, by name.

    Examples
    --------
    >>> source = KernelSource("@typed(float64(float64))\ndef half(x):\n    return x / 2\n", {"half": "float64(float64)"})
    >>> Compiled(source, machine_code(source))["half"](3.0)
    1.5
    """

    def __init__(self, source: KernelSource, code: bytes, name: str = ""):
        import llvmlite.binding as llvm

        self.source, self.name = source, name
        library = llvm.JITLibraryBuilder().add_current_process().add_object_img(code)
        for entry in source.entries:
            library.export_symbol(entry)
        with _linking:
            self._code = library.link(_loader(), f"kernel {next(_number)}")
        self.addresses: dict[str, int] = {entry: self._code[entry] for entry in source.entries}
        self._functions = dict[str, CompiledFunction]()

    def __getitem__(self, name: str) -> CompiledFunction:
        """A function, by its name."""
        if name not in self._functions:
            self._functions[name] = CompiledFunction(self._code, self.addresses[name], signature(self.source.entries[name]))
        return self._functions[name]


class CompiledFunction:
    """A compiled function, called with numbers and arrays; the interpreter goes on meanwhile in other threads.

    An array of another type, or whose numbers do not stand in a row, is a `TypeError`.
    """

    def __init__(self, code: Any, address: int, kind: Signature):
        import numpy as np

        self._code, self._returns = code, kind.returns  # machine code is freed with the last who holds it
        self._room = _room(kind.returns) if isinstance(kind.returns, Several) else None
        takes: list[Any] = []
        for each in kind.takes:
            takes += [ctypes.c_void_p, *[ctypes.c_int64] * each.axes] if isinstance(each, InMemory) else [_KINDS[each]]
        result = None if isinstance(kind.returns, Several) else _KINDS[kind.returns]
        self._call = ctypes.CFUNCTYPE(result, *takes, *([] if self._room is None else [ctypes.c_void_p]))(address)
        #: Of each argument what makes a number of it, or the type and the axes of an array.
        self._takes = [
            (None, np.dtype(_ELEMENTS[each.number]), each.axes) if isinstance(each, InMemory) else _number_of(each) for each in kind.takes
        ]

    def __call__(self, *args: Any) -> Any:
        """Its result."""
        given = self._converted(args)
        if self._room is not None:
            return self._several(given)
        result = self._call(*given)
        return bool(result) if self._returns is BOOLEAN else result

    def _converted(self, args: tuple[Any, ...]) -> list[Any]:
        """Numbers and arrays as C takes them."""
        given = list[Any]()
        for (number, dtype, axes), arg in zip(self._takes, args, strict=True):
            if number is not None:
                given.append(number(arg))
            elif arg.dtype == dtype and arg.ndim == axes and arg.flags.c_contiguous:
                given += address_of(arg), *arg.shape
            else:
                raise TypeError(f"an array of {arg.dtype} with {arg.ndim} axes is given for one of {dtype} in a row with {axes}")
        return given

    def on(self, *args: Any) -> Callable[[], Any]:
        """A call with these arrays and numbers, which costs less than one that is given them anew."""
        given, call = self._converted(args), self._call
        return lambda _=(self, args): call(*given)  # code and arrays stay with it

    def _several(self, given: list[Any]) -> tuple[Any, ...]:
        """Several numbers."""
        room = self._room()
        self._call(*given, ctypes.addressof(room))
        parts = (getattr(room, name) for name, _ in self._room._fields_)
        return tuple(bool(part) if kind is BOOLEAN else part for kind, part in zip(self._returns.numbers, parts, strict=True))


def _number_of(kind: Number) -> tuple[Any, None, int]:
    """What makes an argument of a number."""
    return (float if kind is FLOAT64 else int), None, 0


def _room(kind: Several) -> Any:
    """Where several numbers are returned."""
    fields = [(f"part{k}", _KINDS[number]) for k, number in enumerate(kind.numbers)]
    return type("Room", (ctypes.Structure,), {"_fields_": fields})
