"""The body of a function on plain numbers and arrays as LLVM instructions, statement by statement (`functions.py`)."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from typing import Any, Protocol

from stickslip.engine.expressions import BOOL, FLOAT64, INT8, INT64, INTRINSICS, Expressions, settled_names
from stickslip.engine.instructions import UNDEFINED, VOID, Builder, Constant, struct_of
from stickslip.engine.signatures import InMemory

#: Of floats, beside `INTRINSICS`.
OF_FLOATS = {"math.floor": "llvm.floor.f64", "math.log2": "llvm.log2.f64", "math.copysign": "llvm.copysign.f64", "math.expm1": "expm1"}
OF_FLOATS |= {"math.sin": "llvm.sin.f64", "math.cos": "llvm.cos.f64", "math.asin": "asin"}
#: What arrays of a call's own hold, by the names of types.
_HELD = {"np.int64": INT64, "np.int8": INT8}


@dataclass(frozen=True)
class View:
    """An array: a pointer to its first number, and how many there are along each axis."""

    data: Any
    shape: tuple[Any, ...]


def parts_of_arguments(args: Iterable[Any]) -> list[Any]:
    """Numbers, and of each view its pointer and its lengths."""
    return [part for arg in args for part in ((arg.data, *arg.shape) if isinstance(arg, View) else (arg,))]


class Program(Protocol):
    """The text of which a function is one: what it calls and the constants that it uses."""

    outside: dict[str, Any]
    signatures: dict[str, Any]
    constants: dict[str, Any]

    def function(self, name: str) -> Any:
        """A function of the text, by its name."""

    def row(self, name: str) -> View:
        """An array of constants."""


def write_body(program: Program, function: Any, text: ast.FunctionDef, signature: Any) -> None:
    """Write the instructions of a declared function: `text` is its Python, `signature` its types."""
    _Body(program, function, text, signature)


class _Body(Expressions):
    """The instructions of one function."""

    where = "a function of plain numbers"

    def __init__(self, program: Program, function: Any, text: ast.FunctionDef, signature: Any) -> None:
        self.program, self.function, self.result = program, function, function.function_type.return_type
        self.entry = function.append_basic_block("slots")
        start = function.append_basic_block("start")
        super().__init__(Builder(start), lanes=1)
        # of each name its value, or the slots where it stands: one of a number, of an array one more for each length
        self.names, self.loops = dict[str, Any](), list[tuple[Any, Any]]()
        self.settled = settled_names(text)
        given = iter(function.args)
        for arg, kind in zip(text.args.args, signature.takes, strict=True):
            first = next(given)
            self.give(arg.arg, View(first, tuple(next(given) for _ in range(kind.axes))) if isinstance(kind, InMemory) else first)
        self.write(text.body)
        if not self.builder.block.is_terminated:
            self.builder.ret_void() if self.result == VOID else self.builder.unreachable()
        Builder(self.entry).branch(start)

    # ---- statements ----
    def write(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            if self.builder.block.is_terminated:
                return
            self.visit(statement)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.visit(node.value)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is None:
            self.builder.ret_void()
        elif isinstance(node.value, ast.Tuple):
            values = [self.visit(each) for each in node.value.elts]
            self.builder.ret(self.joined([self.as_kind(*pair) for pair in zip(values, self.result.elements, strict=True)]))
        else:
            value = self.visit(node.value)
            self.builder.ret(self.joined(value) if isinstance(value, list) else self.as_kind(value, self.result))

    def joined(self, values: list[Any]) -> Any:
        """Several values as one."""
        whole = Constant(struct_of(tuple(value.type for value in values)), UNDEFINED)
        return reduce(lambda filled, part: self.builder.insert_value(filled, part[1], part[0]), enumerate(values), whole)

    def visit_Assign(self, node: ast.Assign) -> None:
        value = self.visit(node.value)
        for target in node.targets:
            if isinstance(target, ast.Tuple):
                for each, part in zip(target.elts, value, strict=True):
                    self.assign(each, part)
            else:
                self.assign(target, value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Name):
            self.give(node.target.id, self.operation(node, node.op, self.visit(node.target), self.visit(node.value)))
        else:
            pointer = self.element(node.target)
            self.store(pointer, self.operation(node, node.op, self.load(pointer), self.visit(node.value)))

    def visit_If(self, node: ast.If) -> None:
        yes, no, after = (self.function.append_basic_block(name) for name in ("yes", "no", "after"))
        self.builder.cbranch(self.condition(node.test), yes, no)
        for block, statements in ((yes, node.body), (no, node.orelse)):
            self.builder.position_at_end(block)
            self.write(statements)
            self.go_to(after)
        self.builder.position_at_end(after)

    def visit_While(self, node: ast.While) -> None:
        if node.orelse:
            self.refuse(node)
        self.loop(lambda: self.condition(node.test), lambda: self.write(node.body))

    def visit_For(self, node: ast.For) -> None:
        called, target = node.iter, node.target
        over_range = isinstance(called, ast.Call) and ast.unparse(called.func) == "range"
        if node.orelse or not (over_range and isinstance(target, ast.Name)):
            self.refuse(node)
        ends = [self.visit(each) for each in called.args]
        first, end = ends[:2] if len(ends) > 1 else (Constant(INT64, 0), ends[0])
        by = ends[2] if len(ends) > 2 else Constant(INT64, 1)
        if not isinstance(by, Constant):
            self.refuse(node)

        def one_round(now: Any) -> None:
            self.give(target.id, now)
            self.write(node.body)

        self.count(first, end, by, one_round)

    def count(self, first: Any, end: Any, by: Any, one_round: Any) -> None:
        """A loop that counts on its own: what a round does to a name that has the number is no matter of the next one."""
        counter = self.slot(INT64)
        self.builder.store(first, counter)
        self.loop(
            lambda: self.builder.icmp_signed("<" if by.constant > 0 else ">", self.builder.load(counter), end),
            lambda: one_round(self.builder.load(counter)),
            lambda: self.builder.store(self.builder.add(self.builder.load(counter), by), counter),
        )

    def loop(self, goes_on: Any, one_round: Any, step: Any = lambda: None) -> None:
        head, body, tail, after = (self.function.append_basic_block(name) for name in ("head", "round", "tail", "after"))
        self.builder.branch(head)
        self.builder.position_at_end(head)
        self.builder.cbranch(goes_on(), body, after)
        self.builder.position_at_end(body)
        self.loops.append((tail, after))
        one_round()
        self.loops.pop()
        self.go_to(tail)
        self.builder.position_at_end(tail)
        step()
        self.builder.branch(head)
        self.builder.position_at_end(after)

    def go_to(self, block: Any) -> None:
        if not self.builder.block.is_terminated:
            self.builder.branch(block)

    def visit_Continue(self, node: ast.Continue) -> None:
        self.builder.branch(self.loops[-1][0])

    def visit_Break(self, node: ast.Break) -> None:
        self.builder.branch(self.loops[-1][1])

    # ---- names and numbers in memory ----
    def slot(self, kind: Any) -> Any:
        """Room for a number that lasts as long as the call."""
        return Builder(self.entry).alloca(kind)

    def give(self, name: str, value: Any) -> None:
        """Give a name its value; one that never has another needs no slot for it."""
        if name in self.settled:
            self.names[name] = value
            return
        parts = (value.data, *value.shape) if isinstance(value, View) else (value,)
        if name not in self.names:
            self.names[name] = tuple(self.slot(part.type) for part in parts)
        for slot, part in zip(self.names[name], parts, strict=True):
            self.builder.store(self.as_kind(part, slot.type.pointee), slot)

    def assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.give(target.id, value)
        else:
            self.store(self.element(target), value)

    def store(self, pointer: Any, value: Any) -> None:
        if pointer.type.pointee == INT8:
            self.builder.store(self.builder.trunc(value, INT8), pointer)
        else:
            self.builder.store(self.as_kind(value, pointer.type.pointee), pointer)

    def load(self, pointer: Any) -> Any:
        value = self.builder.load(pointer)
        return self.builder.sext(value, INT64) if value.type == INT8 else value

    def element(self, node: ast.expr) -> Any:
        """The pointer to one number of an array."""
        number = self.part(node, self.visit(node.value)) if isinstance(node, ast.Subscript) else None
        if number is None or number.shape:
            self.refuse(node)
        return number.data  # type: ignore[union-attr]

    def part(self, node: ast.Subscript, array: View) -> View:
        """What an array has at its first indices, or from an index on."""
        if isinstance(node.slice, ast.Slice):
            if node.slice.lower is None or node.slice.upper is not None or node.slice.step is not None or len(array.shape) > 1:
                self.refuse(node)
            first = self.visit(node.slice.lower)  # type: ignore[arg-type]
            (length,) = array.shape
            return View(self.builder.gep(array.data, first), (self.builder.sub(length, first),))
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        at = reduce(
            lambda offset, pair: self.builder.add(self.builder.mul(offset, pair[1]), self.visit(pair[0])),
            zip(indices[1:], array.shape[1:], strict=False),
            self.visit(indices[0]),
        )
        rest = array.shape[len(indices) :]
        return View(self.builder.gep(array.data, reduce(self.builder.mul, rest, at)), rest)

    # ---- expressions ----
    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.names:
            known = self.names[node.id]
            if not isinstance(known, tuple):
                return known
            first, *rest = map(self.builder.load, known)
            return View(first, tuple(rest)) if rest else first
        if isinstance(self.program.constants.get(node.id), list):
            return self.program.row(node.id)
        if node.id in self.program.constants:
            return self.visit_Constant(ast.Constant(self.program.constants[node.id]))
        return self.refuse(node, "has no value")

    def visit_Tuple(self, node: ast.Tuple) -> list[Any]:
        return [self.visit(each) for each in node.elts]

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return self.visit(node.value.value).shape[ast.literal_eval(node.slice)]
        whole = self.visit(node.value)
        if isinstance(whole, list):
            return whole[ast.literal_eval(node.slice)]
        part = self.part(node, whole)
        return part if part.shape else self.load(part.data)

    def negative(self, node: ast.AST, x: Any) -> Any:
        return self.builder.neg(self.as_kind(x, INT64))

    def operation(self, node: ast.AST, op: ast.operator, a: Any, b: Any) -> Any:
        if isinstance(op, ast.Pow) and isinstance(b, Constant) and b.constant == 0.5:
            return self.intrinsic(node, "math.sqrt", [a])
        if FLOAT64 not in (a.type, b.type):
            a, b = self.as_kind(a, INT64), self.as_kind(b, INT64)
            if isinstance(op, (ast.FloorDiv, ast.Mod)):
                return self.floored(op, a, b)
        return super().operation(node, op, a, b)

    def floored(self, op: ast.operator, a: Any, b: Any) -> Any:
        """Quotient or remainder of whole numbers, towards minus infinity."""
        rest = self.builder.on_integers("srem", a, b)
        zero = Constant(INT64, 0)
        off = self.builder.and_(self.builder.icmp_signed("!=", rest, zero), self.builder.icmp_signed("<", self.builder.xor(rest, b), zero))
        if isinstance(op, ast.Mod):
            return self.builder.select(off, self.builder.add(rest, b), rest)
        return self.builder.sub(self.builder.on_integers("sdiv", a, b), self.builder.zext(off, INT64))

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        """What stands further right is looked at only if the rest does not decide."""
        incoming, after = [], self.function.append_basic_block("decided")
        for value in node.values[:-1]:
            holds, next_one = self.condition(value), self.function.append_basic_block("undecided")
            incoming.append((holds, self.builder.block))
            self.builder.cbranch(holds, *((next_one, after) if isinstance(node.op, ast.And) else (after, next_one)))
            self.builder.position_at_end(next_one)
        incoming.append((self.condition(node.values[-1]), self.builder.block))
        return self.joined_value(incoming, after)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        yes, no, after = (self.function.append_basic_block(name) for name in ("yes", "no", "chosen"))
        self.builder.cbranch(self.condition(node.test), yes, no)
        values, ends = [], []
        for block, value in ((yes, node.body), (no, node.orelse)):
            self.builder.position_at_end(block)
            values.append(self.visit(value))
            ends.append(self.builder.block)
        kind = self.common(*values)
        for k, end in enumerate(ends):
            self.builder.position_at_end(end)
            values[k] = self.as_kind(values[k], kind)
        return self.joined_value(list(zip(values, ends, strict=True)), after)

    def joined_value(self, incoming: list[tuple[Any, Any]], after: Any) -> Any:
        """The value that a block has from the one that comes to it, of several: pairs of a value and its block."""
        for _, block in incoming:
            if not block.is_terminated:
                Builder(block).branch(after)
        self.builder.position_at_end(after)
        phi = self.builder.phi(incoming[0][0].type)
        for value, block in incoming:
            phi.add_incoming(value, block)
        return phi

    def visit_Call(self, node: ast.Call) -> Any:
        name = ast.unparse(node.func)
        if name == "float":
            return Constant(FLOAT64, float(ast.literal_eval(node.args[0])))
        args = [self.visit(each) for each in node.args]
        if name in self.program.outside:
            return self.program.outside[name](self.builder, args)
        if name in self.program.signatures:
            return self.called(name, args)
        if name == "len":
            return args[0].shape[0]
        if name in ("np.empty", "np.zeros"):
            return self.room(node, args[0], zero=name == "np.zeros")
        if name in ("max", "min"):
            return reduce(lambda a, b: self.extreme(node, ">" if name == "max" else "<", a, b), args)
        if name in ("np.int64", "np.uint64"):
            return self.builder.fptosi(args[0], INT64) if args[0].type == FLOAT64 else self.as_kind(args[0], INT64)
        if name == "np.float64":
            return self.as_kind(args[0], FLOAT64)
        if name in ("as_bits", "as_float"):
            return self.builder.bitcast(args[0], INT64 if name == "as_bits" else FLOAT64)
        if name == "abs" and args[0].type == INT64:
            negative = self.builder.icmp_signed("<", args[0], Constant(INT64, 0))
            return self.builder.select(negative, self.builder.neg(args[0]), args[0])
        if name in INTRINSICS:
            return self.intrinsic(node, name, args)
        return self.of_reals(node, OF_FLOATS[name], args) if name in OF_FLOATS else self.refuse(node)

    def called(self, name: str, args: list[Any]) -> Any:
        """A function of the text."""
        function = self.program.function(name)
        given = [self.as_kind(*pair) for pair in zip(parts_of_arguments(args), function.function_type.args, strict=True)]
        result = self.builder.call(function, given)
        if result.type.kind != "struct":
            return result
        return [self.builder.extract_value(result, k) for k in range(len(result.type.elements))]

    def room(self, node: ast.Call, shape: Any, zero: bool) -> View:
        """An array that lasts as long as the call."""
        shape = shape if isinstance(shape, list) else [shape]
        kind, count = next((_HELD[ast.unparse(each.value)] for each in node.keywords), FLOAT64), reduce(self.builder.mul, shape)
        data = self.builder.alloca(kind, size=count)
        if zero:
            nothing, one = Constant(INT64, 0), Constant(INT64, 1)
            self.count(nothing, count, one, lambda at: self.builder.store(Constant(kind, 0), self.builder.gep(data, at)))
        return View(data, tuple(shape))

    def extreme(self, node: ast.AST, sign: str, a: Any, b: Any) -> Any:
        a, b = self.alike(node, a, b)
        return self.builder.select(self.compared(node, sign, b, a), b, a)

    # ---- types ----
    def condition(self, node: ast.expr) -> Any:
        """Whether a number is not zero, or a truth value."""
        value = self.visit(node)
        if value.type == BOOL:
            return value
        zero = Constant(value.type, 0)
        return self.builder.icmp_signed("!=", value, zero) if value.type == INT64 else self.builder.fcmp_unordered("!=", value, zero)

    def common(self, a: Any, b: Any) -> Any:
        """The type of either of two numbers."""
        return FLOAT64 if FLOAT64 in (a.type, b.type) else BOOL if a.type == b.type == BOOL else INT64

    def alike(self, node: ast.AST, a: Any, b: Any) -> tuple[Any, Any]:
        kind = self.common(a, b)
        return self.as_kind(a, kind), self.as_kind(b, kind)

    def as_real(self, node: ast.AST, x: Any) -> Any:
        return self.as_kind(x, FLOAT64)

    def as_kind(self, value: Any, kind: Any) -> Any:
        """A number as one of another type that can hold it."""
        if value.type == kind:
            return value
        if kind == FLOAT64 and value.type in (INT64, BOOL):
            return self.builder.sitofp(value, FLOAT64) if value.type == INT64 else self.builder.uitofp(value, FLOAT64)
        if kind == INT64 and value.type == BOOL:
            return self.builder.zext(value, INT64)
        raise TypeError(f"a number of type {value.type} is given to a name, an element or an argument of type {kind}")
