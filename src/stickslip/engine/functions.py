"""Functions on plain numbers and arrays as LLVM instructions: the driver of all kernels, in one piece.

Numba compiles each function by itself, with all that it calls, again and again on the way up: twenty seconds for a driver of sixty
functions, most of it in its front end. Here Numba sees one call, of an intrinsic that writes all functions which that one needs
(`write_functions`), and LLVM optimises them together, once. A kernel's file imports this.

The text is Python and means what Python means by it, on 64-bit whole numbers, floats, truth values and arrays whose numbers stand in a
row; Numba would compile it to the same numbers. Each function has its types in its decorator: ``@njit(void(int64, f1))``. A name has the
type of what it is first given; what is taken from an array is a view of it, and ``np.empty`` and ``np.zeros`` make one that lasts as long
as the call. Only in a function with ``fastmath={"contract"}`` in its decorator may a product and a sum be rounded once, together. There is
no check of bounds, no negative index, and no exception.
"""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from llvmlite import ir
from numba import boolean, float64, int8, int64, types, void
from numba.core import types as kinds

from stickslip.engine.expressions import BOOL, FLOAT64, INT8, INT64, all_statements
from stickslip.engine.function_body import View, write_body

#: Types, by the names that they have in a text.
f1, f2, f3, i1, i2 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1], int64[:, ::1]
b1, b2 = int8[::1], int8[:, ::1]
KINDS = {
    "void": void, "int64": int64, "float64": float64, "boolean": boolean, "UniTuple": types.UniTuple, "Tuple": types.Tuple,
    "f1": f1, "f2": f2, "f3": f3, "i1": i1, "i2": i2, "b1": b1, "b2": b2,
}  # fmt: skip


@dataclass(frozen=True)
class _Text:
    """What a text declares: its functions, with the types of each, and its constants."""

    functions: dict[str, ast.FunctionDef]
    signatures: dict[str, Any]
    fused: set[str]
    constants: dict[str, Any]


@lru_cache(1)
def _declared(text: str) -> _Text:
    """The parts of a text. A kernel's functions, which are compiled one after the other, share one."""
    functions, signatures, fused, constants = {}, {}, set(), {"__builtins__": {"range": range, "object": object}, "math": math}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = node
            declared = node.decorator_list[0]
            kind = declared.args[0]  # type: ignore[attr-defined]
            source = kind.value if isinstance(kind, ast.Constant) else ast.unparse(kind)
            signatures[node.name] = eval(source, {"__builtins__": {}}, KINDS)
            if any(option.arg == "fastmath" for option in declared.keywords):  # type: ignore[attr-defined]
                fused.add(node.name)
        elif isinstance(node, ast.Assign):
            exec(ast.unparse(node), constants)
    return _Text(functions, signatures, fused, constants)


class _Program:
    """All functions of a text, which are written when something calls them.

    `outside` are the functions that something else writes, given the builder and the arguments.
    """

    def __init__(self, module: Any, text: str, outside: dict[str, Any]) -> None:
        self.module, self.outside, declared = module, outside, _declared(text)
        self.texts, self.signatures, self.constants = declared.functions, declared.signatures, declared.constants
        self.fused = declared.fused
        self.made, self.rows, self.waiting = dict[str, Any](), dict[str, Any](), list[str]()

    def function(self, name: str) -> Any:
        """A function of the text, by its name."""
        if name not in self.made:
            takes = [part for kind in self.signatures[name].args for part in self.parts(kind)]
            result = self.result(self.signatures[name].return_type)
            made = ir.Function(self.module, ir.FunctionType(result, takes), self.module.get_unique_name(name))
            made.linkage = "internal"
            made.attributes.add("nounwind")
            if any(isinstance(node, (ast.For, ast.While)) for node in all_statements(self.texts[name].body)):
                made.attributes.add("noinline")  # a call is nothing beside a loop, and every copy is to be compiled
            self.made[name] = made
            self.waiting.append(name)
        return self.made[name]

    def write(self) -> None:
        """Write whatever is called and not yet written."""
        while self.waiting:
            name = self.waiting.pop()
            write_body(self, self.made[name], self.texts[name], self.signatures[name])
            if name in self.fused:
                _fuse(self.made[name])

    def row(self, name: str) -> View:
        """An array of constants."""
        numbers = self.constants[name]
        kind = ir.ArrayType(FLOAT64, len(numbers))
        if name not in self.rows:
            self.rows[name] = ir.GlobalVariable(self.module, kind, self.module.get_unique_name(name))
            self.rows[name].linkage, self.rows[name].global_constant = "internal", True
            self.rows[name].initializer = ir.Constant(kind, [ir.Constant(FLOAT64, number) for number in numbers])
        return View(self.rows[name].bitcast(FLOAT64.as_pointer()), (ir.Constant(INT64, len(numbers)),))

    def number(self, kind: Any) -> Any:
        """The type of a number."""
        known = {kinds.int64: INT64, kinds.float64: FLOAT64, kinds.boolean: BOOL, kinds.int8: INT8}
        if kind not in known:
            raise TypeError(f"{kind} is not among the types of a function of plain numbers")
        return known[kind]

    def parts(self, kind: Any) -> list[Any]:
        """An argument's types: of an array a pointer and its lengths."""
        return [self.number(kind.dtype).as_pointer(), *[INT64] * kind.ndim] if isinstance(kind, kinds.Array) else [self.number(kind)]

    def result(self, kind: Any) -> Any:
        if kind == kinds.void:
            return ir.VoidType()
        return ir.LiteralStructType(map(self.number, kind.types)) if isinstance(kind, kinds.BaseTuple) else self.number(kind)

    def call(self, builder: Any, name: str, args: list[Any]) -> Any:
        """A call of a function of the text, or of what something else writes, with numbers and views."""
        if name in self.outside:
            return self.outside[name](builder, args)
        given = [part for arg in args for part in ([arg.data, *arg.shape] if isinstance(arg, View) else [arg])]
        return builder.call(self.function(name), given)


def _fuse(function: Any) -> None:
    """Let products and sums of a function be rounded once, where the processor can."""
    for block in function.blocks:
        for instruction in block.instructions:
            if instruction.opname in ("fadd", "fsub", "fmul"):
                instruction.flags = [*instruction.flags, "contract"]


def _given(context: Any, builder: Any, kind: Any, arg: Any) -> Any:
    """An argument as Numba has it, of an array the view."""
    if not isinstance(kind, kinds.Array):
        return arg
    array = context.make_array(kind)(context, builder, arg)
    return View(array.data, tuple(builder.extract_value(array.shape, k) for k in range(kind.ndim)))


def write_functions(context: Any, builder: Any, sig: Any, args: Any, name: str, text: str, outside: dict[str, Any]) -> Any:
    """A call of one function of a text, with the arguments that Numba has; it and all that it needs are written."""
    program = _Program(builder.module, text, outside)
    result = program.call(builder, name, [_given(context, builder, *pair) for pair in zip(sig.args, args, strict=True)])
    program.write()
    return context.get_dummy_value() if sig.return_type == kinds.void else result


def write_addressed(context: Any, builder: Any, functions: dict[str, Any], text: str, outside: dict[str, Any]) -> Any:
    """Functions of a text, or of `outside`, that another kernel calls at their addresses, by their names with their types.

    Numba compiles the one function in which this stands, and these with it, once; each has its name, a dot and their own.
    """
    program, convention = _Program(builder.module, text, outside), context.call_conv
    for name, kind in functions.items():
        made = ir.Function(builder.module, convention.get_function_type(kind.return_type, kind.args), f"{builder.function.name}.{name}")
        convention.decorate_function(made, [f"a{k}" for k in range(len(kind.args))], kind.args)
        inner = ir.IRBuilder(made.append_basic_block())
        args = context.get_arg_packer(kind.args).from_arguments(inner, convention.get_arguments(made))
        result = program.call(inner, name, [_given(context, inner, *pair) for pair in zip(kind.args, args, strict=True)])
        result = context.get_dummy_value() if kind.return_type == kinds.void else result
        convention.return_value(inner, context.get_return_value(inner, kind.return_type, result))
    program.write()
    return context.get_dummy_value()
