"""Functions on plain numbers and arrays as LLVM instructions: the driver of all kernels, in one piece.

Numba compiles each function by itself, with all that it calls, again and again on the way up: twenty seconds for a driver of sixty
functions, most of it in its front end. Here Numba sees one call, of an intrinsic that writes all functions which that one needs
(`write_functions`), and LLVM optimises them together, once. A kernel's file imports this.

The text is Python and means what Python means by it, on 64-bit whole numbers, floats, truth values and arrays whose numbers stand in a
row; Numba would compile it to the same numbers. Each function has its types in its decorator: ``@njit(void(int64, f1))``. A name has the
type of what it is first given; what is taken from an array is a view of it, and ``np.empty`` and ``np.zeros`` make one that lasts as long
as the call. There is no check of bounds, no negative place, and no exception.
"""

from __future__ import annotations

import ast
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any

from llvmlite import ir
from numba import boolean, float64, int8, int64, types, void
from numba.core import types as kinds

from stickslip.engine.expressions import BOOL, FLOAT64, INT8, INT64, INTRINSICS, Expressions

#: Types, by the names that they have in a text.
f1, f2, f3, i1, i2, b2 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1], int64[:, ::1], int8[:, ::1]
KINDS = {
    "void": void, "int64": int64, "float64": float64, "boolean": boolean, "UniTuple": types.UniTuple, "Tuple": types.Tuple,
    "f1": f1, "f2": f2, "f3": f3, "i1": i1, "i2": i2, "b2": b2,
}  # fmt: skip
#: Of floats, beside `INTRINSICS`.
OF_FLOATS = {"math.floor": "llvm.floor.f64", "math.log2": "llvm.log2.f64", "math.copysign": "llvm.copysign.f64", "math.expm1": "expm1"}


@dataclass(frozen=True)
class View:
    """An array: where its first number stands, and how many there are in each direction."""

    data: Any
    shape: tuple[Any, ...]


@dataclass(frozen=True)
class _Text:
    """What a text declares: its functions, with the types of each, and its constants."""

    functions: dict[str, ast.FunctionDef]
    signatures: dict[str, Any]
    constants: dict[str, Any]


@lru_cache(1)
def _declared(text: str) -> _Text:
    """The parts of a text. A kernel's functions, which are compiled one after the other, share one."""
    functions, signatures, constants = {}, {}, {"__builtins__": {"range": range, "object": object}}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = node
            kind = node.decorator_list[0].args[0]  # type: ignore[attr-defined]
            source = kind.value if isinstance(kind, ast.Constant) else ast.unparse(kind)
            signatures[node.name] = eval(source, {"__builtins__": {}}, KINDS)
        elif isinstance(node, ast.Assign):
            exec(ast.unparse(node), constants)
    return _Text(functions, signatures, constants)


class _Program:
    """All functions of a text, which are written when something calls them.

    `outside` are the functions that something else writes, given the builder and the arguments.
    """

    def __init__(self, module: Any, text: str, outside: dict[str, Any]) -> None:
        self.module, self.outside, declared = module, outside, _declared(text)
        self.texts, self.signatures, self.constants = declared.functions, declared.signatures, declared.constants
        self.made, self.rows, self.waiting = dict[str, Any](), dict[str, Any](), list[str]()

    def function(self, name: str) -> Any:
        """A function of the text, by its name."""
        if name not in self.made:
            takes = [part for kind in self.signatures[name].args for part in self.parts(kind)]
            result = self.result(self.signatures[name].return_type)
            made = ir.Function(self.module, ir.FunctionType(result, takes), self.module.get_unique_name(name))
            made.linkage = "internal"
            made.attributes.add("nounwind")
            if any(isinstance(node, (ast.For, ast.While)) for node in ast.walk(self.texts[name])):
                made.attributes.add("noinline")  # a call is nothing beside a loop, and every copy is to be compiled
            self.made[name] = made
            self.waiting.append(name)
        return self.made[name]

    def write(self) -> None:
        """Write whatever is called and not yet written."""
        while self.waiting:
            name = self.waiting.pop()
            _Body(self, self.made[name], self.texts[name], self.signatures[name])

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
        found = {kinds.int64: INT64, kinds.float64: FLOAT64, kinds.boolean: BOOL, kinds.int8: INT8}.get(kind)
        if found is None:
            raise TypeError(f"{kind} is not among the types of a function of plain numbers")
        return found

    def parts(self, kind: Any) -> list[Any]:
        """An argument's types: of an array a place and its lengths."""
        return [self.number(kind.dtype).as_pointer(), *[INT64] * kind.ndim] if isinstance(kind, kinds.Array) else [self.number(kind)]

    def result(self, kind: Any) -> Any:
        if kind == kinds.void:
            return ir.VoidType()
        return ir.LiteralStructType(map(self.number, kind.types)) if isinstance(kind, kinds.BaseTuple) else self.number(kind)


class _Body(Expressions):
    """The instructions of one function."""

    where = "a function of plain numbers"

    def __init__(self, program: _Program, function: Any, text: ast.FunctionDef, signature: Any) -> None:
        self.program, self.function, self.result = program, function, function.function_type.return_type
        self.entry = function.append_basic_block("places")
        start = function.append_basic_block("start")
        super().__init__(ir.IRBuilder(start), lanes=1)
        # of each name its value, or the places where it stands: one of a number, of an array one more for each length
        self.names, self.loops = dict[str, Any](), list[tuple[Any, Any]]()
        self.settled = _settled(text)
        given = iter(function.args)
        for arg, kind in zip(text.args.args, signature.args, strict=True):
            first = next(given)
            self.give(arg.arg, View(first, tuple(next(given) for _ in range(kind.ndim))) if isinstance(kind, kinds.Array) else first)
        self.write(text.body)
        if not self.builder.block.is_terminated:
            self.builder.ret_void() if self.result == ir.VoidType() else self.builder.unreachable()
        ir.IRBuilder(self.entry).branch(start)

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
        whole = ir.Constant(ir.LiteralStructType([value.type for value in values]), ir.Undefined)
        return reduce(lambda found, pair: self.builder.insert_value(found, pair[1], pair[0]), enumerate(values), whole)

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
            place = self.element(node.target)
            self.store(place, self.operation(node, node.op, self.load(place), self.visit(node.value)))

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
        first, end = ends[:2] if len(ends) > 1 else (ir.Constant(INT64, 0), ends[0])
        by = ends[2] if len(ends) > 2 else ir.Constant(INT64, 1)
        if not isinstance(by, ir.Constant):
            self.refuse(node)

        def one_round(now: Any) -> None:
            self.give(target.id, now)
            self.write(node.body)

        self.count(first, end, by, one_round)

    def count(self, first: Any, end: Any, by: Any, one_round: Any) -> None:
        """A loop that counts on its own: what a round does to a name that has the number is no matter of the next one."""
        place = self.place(INT64)
        self.builder.store(first, place)
        self.loop(
            lambda: self.builder.icmp_signed("<" if by.constant > 0 else ">", self.builder.load(place), end),
            lambda: one_round(self.builder.load(place)),
            lambda: self.builder.store(self.builder.add(self.builder.load(place), by), place),
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

    # ---- names and places ----
    def place(self, kind: Any) -> Any:
        """Room for a number that lasts as long as the call."""
        return ir.IRBuilder(self.entry).alloca(kind)

    def give(self, name: str, value: Any) -> None:
        """Give a name its value; one that never has another needs no place for it."""
        if name in self.settled:
            self.names[name] = value
            return
        parts = (value.data, *value.shape) if isinstance(value, View) else (value,)
        if name not in self.names:
            self.names[name] = tuple(self.place(part.type) for part in parts)
        for place, part in zip(self.names[name], parts, strict=True):
            self.builder.store(self.as_kind(part, place.type.pointee), place)

    def assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.give(target.id, value)
        else:
            self.store(self.element(target), value)

    def store(self, place: Any, value: Any) -> None:
        if place.type.pointee == INT8:
            self.builder.store(self.builder.trunc(value, INT8), place)
        else:
            self.builder.store(self.as_kind(value, place.type.pointee), place)

    def load(self, place: Any) -> Any:
        value = self.builder.load(place)
        return self.builder.sext(value, INT64) if value.type == INT8 else value

    def element(self, node: ast.expr) -> Any:
        """The place of one number of an array."""
        found = self.part(node, self.visit(node.value)) if isinstance(node, ast.Subscript) else None
        if found is None or found.shape:
            self.refuse(node)
        return found.data  # type: ignore[union-attr]

    def part(self, node: ast.Subscript, array: View) -> View:
        """What stands at the first places of an array, or from a place on."""
        if isinstance(node.slice, ast.Slice):
            if node.slice.lower is None or node.slice.upper is not None or node.slice.step is not None or len(array.shape) > 1:
                self.refuse(node)
            first = self.visit(node.slice.lower)  # type: ignore[arg-type]
            (length,) = array.shape
            return View(self.builder.gep(array.data, [first]), (self.builder.sub(length, first),))
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        at = reduce(
            lambda found, pair: self.builder.add(self.builder.mul(found, pair[1]), self.visit(pair[0])),
            zip(indices[1:], array.shape[1:], strict=False),
            self.visit(indices[0]),
        )
        rest = array.shape[len(indices) :]
        return View(self.builder.gep(array.data, [reduce(self.builder.mul, rest, at)]), rest)

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
        found = self.part(node, whole)
        return found if found.shape else self.load(found.data)

    def negative(self, node: ast.AST, x: Any) -> Any:
        return self.builder.neg(self.as_kind(x, INT64))

    def operation(self, node: ast.AST, op: ast.operator, a: Any, b: Any) -> Any:
        if isinstance(op, ast.Pow) and isinstance(b, ir.Constant) and b.constant == 0.5:
            return self.intrinsic(node, "math.sqrt", [a])
        if FLOAT64 not in (a.type, b.type):
            a, b = self.as_kind(a, INT64), self.as_kind(b, INT64)
            if isinstance(op, (ast.FloorDiv, ast.Mod)):
                return self.floored(op, a, b)
        return super().operation(node, op, a, b)

    def floored(self, op: ast.operator, a: Any, b: Any) -> Any:
        """Quotient or remainder of whole numbers, towards minus infinity."""
        rest = self.builder.srem(a, b)
        zero = ir.Constant(INT64, 0)
        off = self.builder.and_(self.builder.icmp_signed("!=", rest, zero), self.builder.icmp_signed("<", self.builder.xor(rest, b), zero))
        if isinstance(op, ast.Mod):
            return self.builder.select(off, self.builder.add(rest, b), rest)
        return self.builder.sub(self.builder.sdiv(a, b), self.builder.zext(off, INT64))

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        """What stands further right is looked at only if the rest does not decide."""
        found, after = [], self.function.append_basic_block("decided")
        for value in node.values[:-1]:
            holds, next_one = self.condition(value), self.function.append_basic_block("undecided")
            found.append((holds, self.builder.block))
            self.builder.cbranch(holds, *((next_one, after) if isinstance(node.op, ast.And) else (after, next_one)))
            self.builder.position_at_end(next_one)
        found.append((self.condition(node.values[-1]), self.builder.block))
        return self.met(found, after)

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
        return self.met(list(zip(values, ends, strict=True)), after)

    def met(self, found: list[tuple[Any, Any]], after: Any) -> Any:
        """The value with which one of several blocks comes to the one after them."""
        for _, block in found:
            if not block.is_terminated:
                ir.IRBuilder(block).branch(after)
        self.builder.position_at_end(after)
        value = self.builder.phi(found[0][0].type)
        for each, block in found:
            value.add_incoming(each, block)
        return value

    def visit_Call(self, node: ast.Call) -> Any:
        name = ast.unparse(node.func)
        if name == "float":
            return ir.Constant(FLOAT64, float(ast.literal_eval(node.args[0])))
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
            negative = self.builder.icmp_signed("<", args[0], ir.Constant(INT64, 0))
            return self.builder.select(negative, self.builder.neg(args[0]), args[0])
        if name in INTRINSICS:
            return self.intrinsic(node, name, args)
        return self.of_reals(node, OF_FLOATS[name], args) if name in OF_FLOATS else self.refuse(node)

    def called(self, name: str, args: list[Any]) -> Any:
        """A function of the text."""
        function, given = self.program.function(name), []
        for arg in args:
            given += [arg.data, *arg.shape] if isinstance(arg, View) else [arg]
        given = [self.as_kind(*pair) for pair in zip(given, function.function_type.args, strict=True)]
        found = self.builder.call(function, given)
        if not isinstance(found.type, ir.LiteralStructType):
            return found
        return [self.builder.extract_value(found, k) for k in range(len(found.type.elements))]

    def room(self, node: ast.Call, count: Any, zero: bool) -> View:
        """An array that lasts as long as the call."""
        kind = INT64 if any(ast.unparse(each.value) == "np.int64" for each in node.keywords) else FLOAT64
        data = self.builder.alloca(kind, size=count)
        if zero:
            nothing, one = ir.Constant(INT64, 0), ir.Constant(INT64, 1)
            self.count(nothing, count, one, lambda at: self.builder.store(ir.Constant(kind, 0), self.builder.gep(data, [at])))
        return View(data, (count,))

    def extreme(self, node: ast.AST, sign: str, a: Any, b: Any) -> Any:
        a, b = self.alike(node, a, b)
        return self.builder.select(self.compared(node, sign, b, a), b, a)

    # ---- types ----
    def condition(self, node: ast.expr) -> Any:
        """Whether a number is not zero, or a truth value."""
        value = self.visit(node)
        if value.type == BOOL:
            return value
        zero = ir.Constant(value.type, 0)
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
        raise TypeError(f"a number of type {value.type} is given to a name, a place or an argument of type {kind}")


def _settled(text: ast.FunctionDef) -> set[str]:
    """The names that a function gives a value once, for all that follows: in no branch, in no loop."""
    whole = [arg.arg for arg in text.args.args]
    given = Counter(whole)
    given.update(node.id for node in ast.walk(text) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))
    whole += [node.id for each in text.body if isinstance(each, ast.Assign) for node in ast.walk(each) if isinstance(node, ast.Name)]
    return {name for name in whole if given[name] == 1}


def at_points(builder: Any, args: list[Any]) -> None:
    """A polynomial S[at + m * apart] and its slope at `count` points in a row, into two other rows of the same array: one vector each."""
    S, at, rows, x, to, slopes_to = args[:6]
    order, apart, count = (arg.constant for arg in args[6:])
    vector, index = ir.VectorType(FLOAT64, count), ir.IntType(32)
    fma = builder.module.declare_intrinsic(f"llvm.fma.v{count}f64", (), ir.FunctionType(vector, [vector] * 3))

    def row(first: Any) -> Any:
        return builder.bitcast(builder.gep(rows.data, [first]), vector.as_pointer())

    def coefficient(m: int) -> Any:
        number = builder.load(builder.gep(S.data, [builder.add(at, ir.Constant(INT64, m * apart))]))
        one = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(index, 0))
        return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(index, count), [0] * count))

    points = builder.load(row(x), align=8)
    value, slope = coefficient(order), ir.Constant(vector, [0.0] * count)
    for m in range(order - 1, -1, -1):  # Horner's scheme
        slope = builder.call(fma, [slope, points, value])
        value = builder.call(fma, [value, points, coefficient(m)])
    builder.store(value, row(to), align=8)
    builder.store(slope, row(slopes_to), align=8)


def write_functions(context: Any, builder: Any, sig: Any, args: Any, name: str, text: str, outside: dict[str, Any]) -> Any:
    """A call of one function of a text, with the arguments that Numba has; it and all that it needs are written."""
    program, given = _Program(builder.module, text, outside), []
    for kind, arg in zip(sig.args, args, strict=True):
        if isinstance(kind, kinds.Array):
            array = context.make_array(kind)(context, builder, arg)
            given += [array.data, *(builder.extract_value(array.shape, k) for k in range(kind.ndim))]
        else:
            given.append(arg)
    found = builder.call(program.function(name), given)
    program.write()
    return context.get_dummy_value() if sig.return_type == kinds.void else found
