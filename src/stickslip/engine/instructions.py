"""Instructions as LLVM reads them: types, values, functions of blocks, and a builder that writes one line for each instruction.

Only what kernels are made of. llvmlite has objects for all of LLVM's language, each checked and written by itself, which took a third of
the time of a kernel's compilation; a mistake here is found by LLVM's own reader and verifier (`machine_code.py`).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any


class Type:
    """The type of a value; two that are written alike are one object, pointers apart, which know what they point to."""

    __slots__ = ("args", "elements", "kind", "pointee", "pointer", "return_type", "text")

    def __init__(self, text: str, kind: str, pointee: Any = None, elements: tuple[Any, ...] = (), return_type: Any = None):
        self.text, self.kind, self.pointee, self.elements, self.return_type = text, kind, pointee, elements, return_type
        self.args, self.pointer = elements, None

    def as_pointer(self) -> Type:
        """A pointer to a value of this type."""
        if self.pointer is None:
            self.pointer = Type("ptr", "pointer", pointee=self)  # type: ignore[assignment]
        return self.pointer  # type: ignore[return-value]


@lru_cache
def integer(bits: int) -> Type:
    """Whole numbers of some bits."""
    return Type(f"i{bits}", "whole")


@lru_cache
def vector_of(kind: Type, count: int) -> Type:
    """Some numbers side by side."""
    return Type(f"<{count} x {kind.text}>", "vector", elements=(kind,) * count)


@lru_cache
def array_of(kind: Type, count: int) -> Type:
    """Some values one after the other in memory."""
    return Type(f"[{count} x {kind.text}]", "array", elements=(kind,) * count)


@lru_cache
def struct_of(kinds: tuple[Type, ...]) -> Type:
    """Several values as one."""
    return Type(f"{{ {', '.join(kind.text for kind in kinds)} }}", "struct", elements=kinds)


@lru_cache
def function_type(returns: Type, takes: tuple[Type, ...]) -> Type:
    """Functions."""
    return Type(f"{returns.text} ({', '.join(kind.text for kind in takes)})", "function", elements=takes, return_type=returns)


DOUBLE, VOID = Type("double", "real"), Type("void", "void")
UNDEFINED = object()


class Value:
    """What an instruction takes: its type, and how it is written."""

    __slots__ = ("text", "type")

    def __init__(self, kind: Type, text: str):
        self.type, self.text = kind, text


class Constant(Value):
    """A number that is known, or several, or what is not defined."""

    __slots__ = ("constant",)

    def __init__(self, kind: Type, constant: Any):
        self.constant = constant
        super().__init__(kind, _constant(kind, constant))


def _constant(kind: Type, number: Any) -> str:
    """How a constant is written: floats by their bits."""
    if number is UNDEFINED:
        return "undef"
    if kind.kind == "real":
        return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016x}"
    if kind.kind == "whole":
        return str(int(number))
    each = ", ".join(f"{part.text} {_constant(part, value)}" for part, value in zip(kind.elements, number, strict=True))
    return f"<{each}>" if kind.kind == "vector" else f"[{each}]"


class Block:
    """Instructions that follow one another, of which the last says where it goes on."""

    __slots__ = ("function", "is_terminated", "lines", "name")

    def __init__(self, function: Function, name: str):
        self.function, self.name, self.lines, self.is_terminated = function, name, list[Any](), False


class Function:
    """A function: its arguments, attributes and blocks."""

    def __init__(self, module: Module, kind: Type, name: str):
        self.module, self.function_type, self.name, self.attributes = module, kind, name, list[str]()
        self.is_internal = self.is_fused = False
        self.args = [Value(of, f"%a{k}") for k, of in enumerate(kind.elements)]
        self.blocks, self.count = list[Block](), 0
        module.functions[name] = self

    def append_basic_block(self, name: str = "") -> Block:
        """A new block, after all others."""
        block = Block(self, f"b{len(self.blocks)}{name}")
        self.blocks.append(block)
        return block

    def new(self) -> str:
        """The name of a new value."""
        self.count += 1
        return f"%v{self.count}"

    def text(self) -> str:
        """How it is written."""
        kind = self.function_type
        takes = ", ".join(f"{arg.type.text} {arg.text}" if self.blocks else arg.type.text for arg in self.args)
        head = f"{kind.return_type.text} @{self.name}({takes})"
        if not self.blocks:
            return f"declare {head}"
        attributes = "".join(f" {each}" for each in self.attributes)
        lines = [f"define {'internal ' if self.is_internal else ''}{head}{attributes} {{"]
        for block in self.blocks:
            lines.append(f"{block.name}:")
            lines += [line if type(line) is str else line.line() for line in block.lines]
        return "\n".join([*lines, "}"])


class Module:
    """Functions and constants that are compiled together."""

    def __init__(self) -> None:
        self.functions, self.constants, self._names = dict[str, Function](), dict[str, str](), dict[str, int]()

    def get_unique_name(self, name: str) -> str:
        """A name that nothing here has."""
        count = self._names[name] = self._names.get(name, -1) + 1
        unique = name if count == 0 else f"{name}.{count}"
        return unique if unique not in self.functions else self.get_unique_name(name)

    def declared(self, name: str, kind: Type) -> Function:
        """A function that is not written here, such as one of LLVM's."""
        return self.functions.get(name) or Function(self, kind, name)

    def row(self, name: str, numbers: Sequence[float]) -> Value:
        """A pointer to constants one after the other."""
        unique, kind = self.get_unique_name(name), array_of(DOUBLE, len(numbers))
        self.constants[unique] = f"@{unique} = internal constant {kind.text} {_constant(kind, numbers)}"
        return Value(DOUBLE.as_pointer(), f"@{unique}")

    def text(self) -> str:
        """How it is written."""
        return "\n".join([*self.constants.values(), *(function.text() for function in self.functions.values()), ""])


class Phi(Value):
    """The value that a block has from the one that it was reached by."""

    __slots__ = ("incoming",)

    def __init__(self, kind: Type, text: str):
        super().__init__(kind, text)
        self.incoming = list[str]()

    def add_incoming(self, value: Value, block: Block) -> None:
        """The value if it was reached by this block."""
        self.incoming.append(f"[ {value.text}, %{block.name} ]")

    def line(self) -> str:
        """The instruction."""
        return f"{self.text} = phi {self.type.text} {', '.join(self.incoming)}"


_SIGNED = {"==": "eq", "!=": "ne", "<": "slt", "<=": "sle", ">": "sgt", ">=": "sge"}
_ORDERED = {"==": "eq", "!=": "ne", "<": "lt", "<=": "le", ">": "gt", ">=": "ge"}


class Builder:
    """Writes instructions at the end of a block."""

    __slots__ = ("block", "function", "module")

    def __init__(self, block: Block):
        self.block, self.function, self.module = block, block.function, block.function.module

    # ---- blocks ----
    def position_at_end(self, block: Block) -> None:
        """Go on in another block."""
        self.block = block

    def append_basic_block(self, name: str = "") -> Block:
        """A new block of the function."""
        return self.function.append_basic_block(name)

    def branch(self, block: Block) -> None:
        """Go on in a block."""
        self._end(f"br label %{block.name}")

    def cbranch(self, condition: Value, yes: Block, no: Block) -> None:
        """Go on in one of two blocks."""
        self._end(f"br i1 {condition.text}, label %{yes.name}, label %{no.name}")

    def ret(self, value: Value) -> None:
        """Return a value."""
        self._end(f"ret {value.type.text} {value.text}")

    def ret_void(self) -> None:
        """Return."""
        self._end("ret void")

    def unreachable(self) -> None:
        """Nothing comes here."""
        self._end("unreachable")

    def _end(self, line: str) -> None:
        self.block.lines.append(line)
        self.block.is_terminated = True

    @contextmanager
    def if_then(self, condition: Value) -> Iterator[None]:
        """Instructions that are carried out where a condition holds."""
        yes, after = self.append_basic_block("if"), self.append_basic_block("endif")
        self.cbranch(condition, yes, after)
        self.position_at_end(yes)
        yield
        if not self.block.is_terminated:
            self.branch(after)
        self.position_at_end(after)

    # ---- instructions ----
    def put(self, kind: Type, line: str) -> Value:
        """One instruction, and its value."""
        name = self.function.new()
        self.block.lines.append(f"{name} = {line}")
        return Value(kind, name)

    def phi(self, kind: Type) -> Phi:
        """A value that depends on the block before."""
        phi = Phi(kind, self.function.new())
        self.block.lines.append(phi)
        return phi

    def on_floats(self, name: str, a: Value, b: Value) -> Value:
        """``fadd``, ``fsub``, ``fmul`` or ``fdiv``; the first three may be fused with one another in a function that says so."""
        flag = " contract" if self.function.is_fused and name != "fdiv" else ""
        return self.put(a.type, f"{name}{flag} {a.type.text} {a.text}, {b.text}")

    def on_integers(self, name: str, a: Value, b: Value) -> Value:
        """``add``, ``sub``, ``mul``, ``sdiv``, ``srem``, ``shl``, ``ashr``, ``and``, ``or`` or ``xor``."""
        return self.put(a.type, f"{name} {a.type.text} {a.text}, {b.text}")

    def add(self, a: Value, b: Value) -> Value:
        """A sum of whole numbers."""
        return self.on_integers("add", a, b)

    def sub(self, a: Value, b: Value) -> Value:
        """A difference of whole numbers."""
        return self.on_integers("sub", a, b)

    def mul(self, a: Value, b: Value) -> Value:
        """A product of whole numbers."""
        return self.on_integers("mul", a, b)

    def and_(self, a: Value, b: Value) -> Value:
        """Both, bit by bit."""
        return self.on_integers("and", a, b)

    def xor(self, a: Value, b: Value) -> Value:
        """Either but not both, bit by bit."""
        return self.on_integers("xor", a, b)

    def neg(self, a: Value) -> Value:
        """Minus a whole number."""
        return self.put(a.type, f"sub {a.type.text} 0, {a.text}")

    def not_(self, a: Value) -> Value:
        """A whole number with its bits turned over."""
        return self.put(a.type, f"xor {a.type.text} {a.text}, -1")

    def fneg(self, a: Value) -> Value:
        """Minus a float."""
        return self.put(a.type, f"fneg {a.type.text} {a.text}")

    def icmp_signed(self, sign: str, a: Value, b: Value) -> Value:
        """A comparison of whole numbers."""
        return self.put(_truth(a.type), f"icmp {_SIGNED[sign]} {a.type.text} {a.text}, {b.text}")

    def fcmp_ordered(self, sign: str, a: Value, b: Value) -> Value:
        """A comparison of floats; it does not hold where one is not a number."""
        return self.put(_truth(a.type), f"fcmp o{_ORDERED[sign]} {a.type.text} {a.text}, {b.text}")

    def fcmp_unordered(self, sign: str, a: Value, b: Value) -> Value:
        """A comparison of floats; it holds where one is not a number."""
        return self.put(_truth(a.type), f"fcmp u{_ORDERED[sign]} {a.type.text} {a.text}, {b.text}")

    def select(self, test: Value, yes: Value, no: Value) -> Value:
        """One of two values."""
        return self.put(yes.type, f"select {test.type.text} {test.text}, {yes.type.text} {yes.text}, {no.type.text} {no.text}")

    def cast(self, name: str, value: Value, kind: Type) -> Value:
        """A value as one of another type; a pointer to something else is the same pointer."""
        if value.type is kind:
            return value
        if value.type.kind == kind.kind == "pointer":
            return Value(kind, value.text)
        return self.put(kind, f"{name} {value.type.text} {value.text} to {kind.text}")

    def bitcast(self, value: Value, kind: Type) -> Value:
        """The same bits."""
        return self.cast("bitcast", value, kind)

    def inttoptr(self, value: Value, kind: Type) -> Value:
        """An address as a pointer."""
        return self.cast("inttoptr", value, kind)

    def zext(self, value: Value, kind: Type) -> Value:
        """A longer whole number, with zeros before it."""
        return self.cast("zext", value, kind)

    def sext(self, value: Value, kind: Type) -> Value:
        """A longer whole number of the same value."""
        return self.cast("sext", value, kind)

    def trunc(self, value: Value, kind: Type) -> Value:
        """The last bits of a whole number."""
        return self.cast("trunc", value, kind)

    def sitofp(self, value: Value, kind: Type) -> Value:
        """A whole number as a float."""
        return self.cast("sitofp", value, kind)

    def uitofp(self, value: Value, kind: Type) -> Value:
        """A condition as a float."""
        return self.cast("uitofp", value, kind)

    def fptosi(self, value: Value, kind: Type) -> Value:
        """A float as a whole number, towards zero."""
        return self.cast("fptosi", value, kind)

    # ---- memory ----
    def alloca(self, kind: Type, size: Value | None = None) -> Value:
        """Room for a value, or several, that lasts as long as the call."""
        many = "" if size is None else f", {size.type.text} {size.text}"
        return self.put(kind.as_pointer(), f"alloca {kind.text}{many}")

    def first_alloca(self, kind: Type) -> Value:
        """Room for a value, at the begin of the function."""
        block, name = self.function.blocks[0], self.function.new()
        block.lines.insert(len(block.lines) - int(block.is_terminated), f"{name} = alloca {kind.text}")
        return Value(kind.as_pointer(), name)

    def gep(self, pointer: Value, at: Value) -> Value:
        """A pointer to a later value of a row."""
        return self.put(pointer.type, f"getelementptr {pointer.type.pointee.text}, ptr {pointer.text}, {at.type.text} {at.text}")

    def load(self, pointer: Value, align: int | None = None) -> Value:
        """What stands at a pointer."""
        kind = pointer.type.pointee
        return self.put(kind, f"load {kind.text}, ptr {pointer.text}{'' if align is None else f', align {align}'}")

    def store(self, value: Value, pointer: Value, align: int | None = None) -> None:
        """Put a value at a pointer."""
        end = "" if align is None else f", align {align}"
        self.block.lines.append(f"store {value.type.text} {value.text}, ptr {pointer.text}{end}")

    # ---- several values ----
    def extract_value(self, whole: Value, k: int) -> Value:
        """One of several values."""
        return self.put(whole.type.elements[k], f"extractvalue {whole.type.text} {whole.text}, {k}")

    def insert_value(self, whole: Value, part: Value, k: int) -> Value:
        """Several values with another one at a place."""
        return self.put(whole.type, f"insertvalue {whole.type.text} {whole.text}, {part.type.text} {part.text}, {k}")

    def spread(self, value: Value, kind: Type) -> Value:
        """A vector that has one number in each lane."""
        first = self.put(kind, f"insertelement {kind.text} undef, {value.type.text} {value.text}, i32 0")
        mask = f"<{len(kind.elements)} x i32> zeroinitializer"
        return self.put(kind, f"shufflevector {kind.text} {first.text}, {kind.text} undef, {mask}")

    # ---- calls ----
    def call(self, function: Function, args: Sequence[Value]) -> Value:
        """A call of a function of the module."""
        return self._call(function.function_type, f"@{function.name}", args)

    def call_at(self, pointer: Value, args: Sequence[Value]) -> Value:
        """A call of the function at a pointer."""
        return self._call(pointer.type.pointee, pointer.text, args)

    def _call(self, kind: Type, name: str, args: Sequence[Value]) -> Value:
        given = ", ".join([f"{arg.type.text} {arg.text}" for arg in args])
        line = f"call {kind.return_type.text} {name}({given})"
        if kind.return_type is VOID:
            self.block.lines.append(line)
            return Value(VOID, "")
        return self.put(kind.return_type, line)

    def ctpop(self, value: Value) -> Value:
        """How many bits are set."""
        kind = value.type
        return self.call(self.module.declared(f"llvm.ctpop.{kind.text}", function_type(kind, (kind,))), [value])


def _truth(kind: Type) -> Type:
    """The type of a comparison of values of a type."""
    return vector_of(integer(1), len(kind.elements)) if kind.kind == "vector" else integer(1)
