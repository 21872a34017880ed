"""Lines of straight text as LLVM instructions: all lanes of a kernel as one vector, or plain numbers for one lane.

The lines are Python and mean what Python means by them, on floats, 64-bit whole numbers and conditions: ``name = expression``, loops
``for m in range(first, end):``, and ``if condition:`` around what is wanted only where the condition holds: lanes jump over it together,
if none of them asks for it. A loop over ``each(first, end)`` is written out round by round, and one over ``outwards(first, end)`` begins in
the middle: sums whose outermost terms are ready last; one over ``while_any(condition, most)`` goes on while the condition holds for a lane.
A part that begins with ``if more(this, that):`` is done if this holds for no fewer
lanes than that, and for some: lanes that want different things wait for one another. ``name = row(17)`` is 17 numbers in memory, for each
lane, which are read and written by their places, as the rows that a lane holds are. Every decision inside an expression is one select
instruction, and nothing is fused or reordered that is not written so: the bits do not depend on the number of lanes.
"""

from __future__ import annotations

import ast
from typing import Any

from stickslip.engine.expressions import FLOAT64, INT64, INTRINSICS, ON_INTEGERS, Expressions, all_statements, names_given
from stickslip.engine.instructions import VOID, Builder, Constant, Function, array_of, function_type, integer

FOLDED = {ast.Add: int.__add__, ast.Sub: int.__sub__, ast.Mult: int.__mul__}  # done at once with numbers that are known
JOIN = {ast.And: "and", ast.Or: "or"}
CASTS = {"as_bits": ("bitcast", "real", "whole"), "as_float": ("bitcast", "whole", "real"), "np.int64": ("fptosi", "real", "whole")}


LINE_OF_CACHE = 64  # bytes


class _Changes(dict[ast.stmt, list[str]]):
    """The names to which the lines of a branch or a loop give a value, listed once: a loop that is written out asks again in each round."""

    def __missing__(self, node: Any) -> list[str]:
        within = (each for statement in node.body for each in all_statements([statement]))
        self[node] = list(dict.fromkeys(name for each in within for name in names_given(each)))
        return self[node]


class _Vector(Expressions):
    """Writes lines as instructions on one vector of lanes.

    `known` has the value of each name, `rows` where each row begins and how far it is from one of its numbers to the next.
    """

    where = "a line of a step"

    def __init__(self, builder: Any, data: Any, first: int, lanes: int, every: int, changed: _Changes) -> None:
        super().__init__(builder, lanes)
        self.data, self.first, self.every, self.changed = data, first, every, changed
        self.known, self.rows, self.unread = dict[str, Any](), dict[str, Any](), dict[str, int]()

    # ---- numbers in and out ----
    def read(self, name: str) -> Any:
        """What the lanes have in a field, read where it is first asked for: until then it needs no register."""
        self.known[name] = self.builder.load(self.place(self.unread[name]), align=8)
        return self.known[name]

    def read_changed(self, node: ast.If) -> None:
        """What lines may give a new value to has one before."""
        for name in self.changed[node]:
            if name in self.unread and name not in self.known:
                self.read(name)

    def keep(self, name: str, at: int) -> None:
        """Put it there."""
        self.builder.store(self.known[name], self.place(at), align=8)

    def place(self, at: int) -> Any:
        pointer = self.builder.gep(self.data, Constant(INT64, at + self.first))
        return self.builder.bitcast(pointer, self.real.as_pointer())

    def held_row(self, name: str, at: int) -> None:
        """A row of fields that the lanes hold, from the one that begins at `at`."""
        self.rows[name] = self.builder.gep(self.data, Constant(INT64, at + self.first)), self.every

    def in_row(self, node: ast.Subscript) -> Any:
        """The place of one number of a row."""
        row, index = self.rows.get(ast.unparse(node.value)), self.visit(node.slice)
        if row is None or index.type != INT64:
            self.refuse(node)
        begin, apart = row
        pointer = self.builder.gep(begin, self.whole_number(ast.Mult(), index, Constant(INT64, apart)))
        return self.builder.bitcast(pointer, self.real.as_pointer())

    # ---- statements ----
    def visit_Assign(self, node: ast.Assign) -> None:
        (target,) = node.targets
        if isinstance(target, ast.Subscript):
            value = self.spread(self.visit(node.value))
            self.builder.store(self.as_real(node, value), self.in_row(target), align=8)
        elif not isinstance(target, ast.Name):
            self.refuse(node)
        elif isinstance(node.value, ast.Call) and ast.unparse(node.value.func) == "row":
            self.rows[target.id] = self.new_row(node.value)
        else:
            self.known[target.id] = self.spread(self.visit(node.value))

    def new_row(self, node: ast.Call) -> tuple[Any, int]:
        """Room for a row, in the memory of this call."""
        (length,) = (self.visit(a) for a in node.args)
        if not isinstance(length, Constant) or length.type != INT64:
            self.refuse(node)
        room = self.builder.first_alloca(array_of(self.real, length.constant))
        return self.builder.bitcast(room, self.real.as_pointer()), 1

    # ---- expressions ----
    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.known:
            return self.known[node.id]
        return self.read(node.id) if node.id in self.unread else self.refuse(node, "has no value")

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        return self.builder.load(self.in_row(node), align=8)

    def operation(self, node: ast.AST, op: ast.operator, a: Any, b: Any) -> Any:
        if a.type == b.type == INT64 and type(op) in FOLDED:
            return self.whole_number(op, a, b)
        return super().operation(node, op, a, b)

    def whole_number(self, op: ast.operator, a: Any, b: Any) -> Any:
        """What is counted with: places in rows that are written out are known, so that such rows need no memory."""
        if isinstance(a, Constant) and isinstance(b, Constant):
            return Constant(INT64, FOLDED[type(op)](a.constant, b.constant))
        return self.builder.on_integers(ON_INTEGERS[type(op)], a, b)

    def compared(self, node: ast.AST, sign: str, a: Any, b: Any) -> Any:
        return super().compared(node, sign, a, b) if {self.real, FLOAT64} & {a.type, b.type} else self.refuse(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        joined, *others = (self.visit(value) for value in node.values)
        for value in others:
            if {joined.type, value.type} != {self.truth}:
                self.refuse(node)
            joined = self.builder.on_integers(JOIN[type(node.op)], joined, value)
        return joined

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        test = self.visit(node.test)
        yes, no = map(self.spread, self.alike(node, self.visit(node.body), self.visit(node.orelse)))
        return self.builder.select(test, yes, no) if test.type == self.truth else self.refuse(node)

    def visit_Call(self, node: ast.Call) -> Any:
        name, args = ast.unparse(node.func), [self.spread(self.visit(a)) for a in node.args]
        if name in INTRINSICS:
            return self.intrinsic(node, name, args)
        if name == "bits" and [a.type for a in args] == [self.truth]:
            whole = self.builder.zext(self.builder.bitcast(args[0], integer(self.lanes)), INT64)
            return self.builder.bitcast(whole, FLOAT64)
        cast, given, wanted = CASTS.get(name, ("", "", ""))
        if not cast or [a.type for a in args] != [getattr(self, given)]:
            self.refuse(node)
        return self.builder.cast(cast, args[0], getattr(self, wanted))

    def as_real(self, node: ast.AST, x: Any) -> Any:
        return self.refuse(node) if x.type == self.truth else super().as_real(node, x)


def write(builder: Any, data: Any, step: Any, numbers: Any) -> None:
    """Read fields, write all lines, keep fields: a function for a group of lanes, called for each group in turn.

    Each line of the step is written for all vectors of `step.width` lanes of a group: their chains of operations hide each other's latency.
    `numbers` are the same for all lanes.
    """
    given = list(numbers.values())
    function = _function(builder.module, [data.type, *(number.type for number in given)])
    own = Builder(function.append_basic_block())
    changed = _Changes()
    vectors = [_Vector(own, function.args[0], first, step.width, step.lanes, changed) for first in range(0, step.group, step.width)]
    for vector in vectors:
        vector.known |= {name: vector.spread(number) for name, number in zip(numbers, function.args[1:], strict=True)}
        vector.unread |= step.reads
        for name, at in step.rows.items():
            vector.held_row(name, at)
    _write_all(own, vectors, ast.parse(step.lines).body)
    for vector in vectors:
        for name, at in step.writes.items():
            vector.keep(name, at)
    own.ret_void()
    for first in range(0, step.lanes, step.group):
        builder.call(function, [builder.gep(data, Constant(INT64, first)), *given])


def _function(module: Any, kinds: list[Any]) -> Any:
    """A function that is not inlined, whose vectors in memory never lie across two lines of the cache."""
    function = Function(module, function_type(VOID, tuple(kinds)), module.get_unique_name("lines"))
    function.is_internal, function.attributes = True, ["noinline", "nounwind", f"alignstack({LINE_OF_CACHE})"]
    return function


def _write_all(builder: Any, vectors: list[_Vector], statements: list[ast.stmt]) -> None:
    for statement in statements:
        if isinstance(statement, ast.For):
            (_loop if ast.unparse(statement.iter).startswith(("range", "while_any")) else _rounds)(builder, vectors, statement)
        elif isinstance(statement, ast.If):
            _branch(builder, vectors, statement)
        else:
            for vector in vectors:
                vector.visit(statement)


def _branch(builder: Any, vectors: list[_Vector], node: ast.If) -> None:
    """A branch, taken for all lanes if one of them asks for it; a name that had a value before has one of two after it."""
    if node.orelse:
        vectors[0].refuse(node)
    condition = _condition(builder, vectors, node.test)
    for vector in vectors:
        vector.read_changed(node)
    before, start = [vector.known for vector in vectors], builder.block
    for vector in vectors:
        vector.known = dict(vector.known)
    with builder.if_then(condition):
        _write_all(builder, vectors, node.body)
        end = builder.block
    for vector, known in zip(vectors, before, strict=True):
        within, vector.known = vector.known, known
        for name in [name for name, value in known.items() if within[name] is not value]:
            joined = builder.phi(known[name].type)
            joined.add_incoming(known[name], start)
            joined.add_incoming(within[name], end)
            known[name] = joined


def _condition(builder: Any, vectors: list[_Vector], test: ast.expr) -> Any:
    """Whether something holds for a lane, or, ``more(this, that)``, for some lanes and for no fewer than something else."""
    if isinstance(test, ast.Call) and ast.unparse(test.func) == "more" and len(test.args) == 2:
        these, those = (_count(builder, vectors, each) for each in test.args)
        return builder.and_(builder.icmp_signed(">=", these, those), builder.icmp_signed(">", these, Constant(INT64, 0)))
    return builder.icmp_signed(">", _count(builder, vectors, test), Constant(INT64, 0))


def _count(builder: Any, vectors: list[_Vector], test: ast.expr) -> Any:
    """For how many lanes something holds."""
    count = Constant(INT64, 0)
    for vector in vectors:
        holds = vector.visit(test)
        if holds.type != vector.truth:
            vector.refuse(test)
        bits = builder.zext(builder.bitcast(holds, integer(vector.lanes)), INT64)
        count = builder.add(count, builder.ctpop(bits))
    return count


def _rounds(builder: Any, vectors: list[_Vector], node: ast.For) -> None:
    """A loop that is written out, round by round, its number known in each; names go on from round to round."""
    name, ends = _counted(vectors[0], node, *ROUNDS)
    if not all(isinstance(end, Constant) for end in ends):
        vectors[0].refuse(node)
    for k in ROUNDS[ast.unparse(node.iter.func)](*(end.constant for end in ends)):  # type: ignore[attr-defined]
        for vector in vectors:
            vector.known[name] = Constant(INT64, k)
        _write_all(builder, vectors, node.body)


def _outwards(first: int, end: int) -> list[int]:
    return sorted(range(first, end), key=lambda k: (abs(2 * k - first - end + 1), k))


#: Loops that are written out, by what they are over, and their rounds in order: all, from the middle, from there down, the middle itself.
ROUNDS = {
    "each": range,
    "outwards": _outwards,
    "halves": lambda first, end: [k for k in _outwards(first, end) if 2 * k < first + end - 1],
    "middle": lambda first, end: [k for k in range(first, end) if 2 * k == first + end - 1],
}


def _loop(builder: Any, vectors: list[_Vector], node: ast.For) -> None:
    """One loop for all vectors; a name that had a value before takes its new one to the next round, and is known after the last."""
    name, first, end, asking = _looped(vectors[0], node)
    for vector in vectors:
        vector.read_changed(node)
    start, head, body, after = builder.block, *(builder.append_basic_block(part) for part in ("rounds", "round", "after"))
    builder.branch(head)
    builder.position_at_end(head)
    changed = {*vectors[0].changed[node]} - {name}
    count, carried = builder.phi(INT64), []
    count.add_incoming(first, start)
    for vector in vectors:
        joined = {key: builder.phi(value.type) for key, value in vector.known.items() if key in changed}
        for key, phi in joined.items():
            phi.add_incoming(vector.known[key], start)
        carried.append((vector, joined, vector.known | joined))
        vector.known = vector.known | joined | {name: count}
    more = builder.icmp_signed("<", count, end)
    builder.cbranch(more if asking is None else builder.and_(more, _condition(builder, vectors, asking)), body, after)
    builder.position_at_end(body)
    _write_all(builder, vectors, node.body)
    count.add_incoming(builder.add(count, Constant(INT64, 1)), builder.block)
    for vector, joined, outside in carried:
        for key, phi in joined.items():
            phi.add_incoming(vector.known[key], builder.block)
        vector.known = outside
    builder.branch(head)
    builder.position_at_end(after)


def _looped(vector: _Vector, node: ast.For) -> tuple[str, Any, Any, ast.expr | None]:
    """The name that counts, its first value, the one after its last, and what must hold for some lane that a round is made."""
    called = node.iter
    if (
        isinstance(called, ast.Call)
        and ast.unparse(called.func) == "while_any"
        and len(called.args) == 2
        and isinstance(node.target, ast.Name)
    ):
        return node.target.id, Constant(INT64, 0), vector.visit(called.args[1]), called.args[0]
    name, (first, end) = _counted(vector, node, "range")
    return name, first, end, None


def _counted(vector: _Vector, node: ast.For, *over: str) -> tuple[str, list[Any]]:
    """The name that counts, its first value and the one after its last."""
    called = node.iter
    if not isinstance(node.target, ast.Name) or node.orelse or not isinstance(called, ast.Call) or len(called.args) != 2:
        vector.refuse(node)
    if ast.unparse(called.func) not in over or called.keywords:
        vector.refuse(node)
    ends = [vector.visit(a) for a in called.args]
    return (node.target.id, ends) if all(end.type == INT64 for end in ends) else vector.refuse(node)
