"""The body of a function on plain numbers and arrays as C99, statement by statement (`c_functions.py`)."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import reduce
from typing import Any, Protocol

from stickslip.engine.c_expressions import REAL, SMALL, TRUTH, WHOLE, CExpressions, Value, View, bare, c_name, constant, without_unread
from stickslip.engine.expressions import settled_names

_TYPES = {"int64": WHOLE, "float64": REAL, "boolean": TRUTH}
_ARRAYS = {"f": REAL, "i": WHOLE, "b": SMALL}


@dataclass
class CFunction:
    """A function that is written: its C, what it takes of its arguments, and what it returns (none: nothing)."""

    name: str
    text: str
    takes: tuple[tuple[int, int], ...]  # argument, and of an array -1 for its first number, or which of its lengths
    gives: tuple[str, ...]


class Program(Protocol):
    """The texts of which a function is one: what it calls, and the constants that it uses."""

    table: Any
    known: dict[str, Any]
    shared: dict[str, View]
    declared: dict[str, tuple[dict[str, ast.FunctionDef], dict[str, str], dict[str, Any]]]

    def function(self, letters: str, name: str) -> CFunction:
        """A function of a text."""

    def at_address(self, name: str) -> CFunction:
        """What is called at an address."""

    def row(self, letters: str, name: str) -> View:
        """An array of constants."""

    def whole_table(self) -> str:
        """The name of the array D."""


def write_c_body(program: Program, letters: str, name: str) -> CFunction:
    """The C of a function of a text, behind that of what it calls."""
    return _Body(program, letters, name).made()


def _result(kind: str) -> tuple[str, ...]:
    """The types that a function returns, by the text of its signature."""
    node: Any = ast.parse(kind, mode="eval").body.func  # type: ignore[attr-defined]
    if isinstance(node, ast.Name):
        return () if node.id == "void" else (_TYPES[node.id],)
    if ast.unparse(node.func) == "UniTuple":
        return (_TYPES[node.args[0].id],) * node.args[1].value
    return tuple(_TYPES[each.id] for each in node.args[0].elts)


def _argument(name: str, kind: ast.expr) -> Value | View:
    text = ast.unparse(kind)
    if text in _TYPES:
        return Value(name, "Lane *" if name == "W" else _TYPES[text])  # the arrays that all functions share
    return View(name, _ARRAYS[text[0]], tuple(Value(f"{name}_length{k or ''}", WHOLE) for k in range(int(text[1]))))


class _Body(CExpressions):
    """The C of one function."""

    where = "a function of plain numbers"

    def __init__(self, program: Program, letters: str, name: str):
        self.program, self.letters, self.name = program, letters, name
        functions, kinds, self.constants = program.declared[letters]
        self.text, self.gives = functions[name], _result(kinds[name])
        given = ast.parse(kinds[name], mode="eval").body.args  # type: ignore[attr-defined]
        self.arguments = [_argument(c_name(arg.arg), kind) for arg, kind in zip(self.text.args.args, given, strict=True)]
        self.names: dict[str, Any] = {
            arg.arg: program.known.get(arg.arg, value) for arg, value in zip(self.text.args.args, self.arguments, strict=True)
        }
        self.settled = settled_names(self.text)
        self.lines, self.declared, self.arrays = list[str](), dict[str, str](), dict[str, str]()
        self.indent, self.ended, self.count = "    ", False, 0
        for arg in self.text.args.args:
            if arg.arg not in self.settled and isinstance(self.names[arg.arg], Value):
                assert self.names[arg.arg].known is None, arg.arg

    def made(self) -> CFunction:
        self.write(self.text.body)
        lines, declared = without_unread(self.lines, self.declared)
        body = "\n".join(lines)
        takes, parameters = list[tuple[int, int]](), list[str]()
        for k, (arg, value) in enumerate(zip(self.text.args.args, self.arguments, strict=True)):
            if arg.arg in self.program.known or arg.arg == "D":
                continue
            if isinstance(value, Value):
                if _uses(body, value.text):
                    takes.append((k, -1))
                    parameters.append(f"{value.kind}{'' if value.kind.endswith('*') else ' '}{value.text}")
                continue
            if _uses(body, value.data):
                takes.append((k, -1))
                parameters.append(f"{value.kind} *{value.data}")
            for axis, length in enumerate(value.shape):
                if _uses(body, length.text):
                    takes.append((k, axis))
                    parameters.append(f"{WHOLE} {length}")
        own, head = f"{self.letters}{self.name}", []
        result = "void" if not self.gives else self.gives[0] if len(self.gives) == 1 else f"struct {own}_result"
        if len(self.gives) > 1:
            head.append(f"{result} {{ {' '.join(f'{kind} part{k};' for k, kind in enumerate(self.gives))} }};")
        if said := ast.get_docstring(self.text):
            head.append(f"/* {said.splitlines()[0].replace('*/', '* /')} */")
        head = [head[-1], *head[:-1]] if len(head) > 1 else head
        blank = {REAL: "0.0", TRUTH: "false"}
        slots = [f"    {kind}{'' if kind.endswith('*') else ' '}{name} = {blank.get(kind, '0')};" for name, kind in declared.items()]
        rooms = [f"    {line}" for name, line in self.arrays.items() if _uses(body, name)]
        first = f"static {result} {own}({', '.join(parameters) or 'void'})"
        text = "\n".join([first, "{", *rooms, *slots, *lines, "}", ""])
        return CFunction(own, "\n".join([*head, text]) if head and not text.startswith("/*") else text, tuple(takes), self.gives)

    # ---- statements ----
    def line(self, text: str) -> None:
        self.lines.append(f"{self.indent}{text}")

    def write(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            if self.ended:
                return
            self.visit(statement)

    def block(self, head: str, statements: list[ast.stmt]) -> bool:
        """A part in braces; whether it goes on behind it."""
        self.line(f"{head} {{")
        self.indent += "    "
        self.write(statements)
        ended, self.ended = self.ended, False
        self.indent = self.indent[:-4]
        self.line("}")
        return ended

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            value = self.visit(node.value)
            if value is not None and not isinstance(value, list):
                self.line(f"{value};")

    def visit_Return(self, node: ast.Return) -> None:
        self.ended = True
        if node.value is None:
            self.line("return;")
            return
        value = self.visit(node.value)
        if isinstance(value, list):
            parts = [self.as_kind(node, part, kind) for part, kind in zip(value, self.gives, strict=True)]
            self.line(f"struct {self.letters}{self.name}_result result = {{{', '.join(map(str, parts))}}};")
            self.line("return result;")
        else:
            self.line(f"return {bare(self.as_kind(node, value, self.gives[0]))};")

    def visit_Assign(self, node: ast.Assign) -> None:
        value = self.visit(node.value)
        for target in node.targets:
            if isinstance(target, ast.Tuple):
                value = [self.held(part) if len(target.elts) > 1 else part for part in value] if self.meets(target, value) else value
                for each, part in zip(target.elts, value, strict=True):
                    self.assign(each, part)
            else:
                self.assign(target, value)

    def meets(self, target: ast.Tuple, values: list[Any]) -> bool:
        """Whether a value of several depends on what one of the others is given to."""
        given = [ast.unparse(each) for each in target.elts]
        later = [value.text if isinstance(value, Value) else "" for value in values]
        return any(_uses(text, name.partition("[")[0]) for k, text in enumerate(later) for name in given[:k])

    def held(self, value: Any) -> Any:
        """A value in a place of its own."""
        if not isinstance(value, Value) or value.known is not None:
            return value
        name = self.fresh(value.kind)
        self.line(f"{name} = {bare(value)};")
        return Value(name, value.kind)

    def fresh(self, kind: str) -> str:
        self.count += 1
        self.declared[f"q{self.count}"] = kind
        return f"q{self.count}"

    def assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.give(target.id, value, target)
        else:
            element, kind = self.element(target)
            text = bare(value) if kind == SMALL else bare(self.as_kind(target, value, kind))
            self.line(f"{element} = {f'(int8_t)({text})' if kind == SMALL else text};")

    def give(self, name: str, value: Any, node: ast.AST) -> None:
        if name == "_":
            return
        if isinstance(value, View):
            if name in self.settled and (value.data.isidentifier() or value.data.startswith("W->")) and "[" not in value.data:
                self.names[name] = value
                return
            if name not in self.settled:
                self.refuse(node, "would be given several arrays")
            own = c_name(name)
            self.declared[own] = f"{value.kind} *"
            self.line(f"{own} = {value.data};")
            self.names[name] = View(own, value.kind, value.shape)
        elif name in self.settled and value.known is not None:
            self.names[name] = value
        else:
            known, own = self.names.get(name), c_name(name)
            kind = known.kind if known is not None else value.kind
            if known is None or known.text != own:
                self.declared[own] = kind
                self.names[name] = Value(own, kind)
            self.line(f"{own} = {bare(self.as_kind(node, value, kind))};")

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Name):
            self.give(node.target.id, self.operation(node, node.op, self.visit(node.target), self.visit(node.value)), node)
        else:
            element, kind = self.element(node.target)
            value = self.operation(node, node.op, Value(element, kind), self.visit(node.value))
            self.line(f"{element} = {bare(self.as_kind(node, value, kind))};")

    def visit_If(self, node: ast.If) -> None:
        test = self.condition(node.test)
        if test.known is not None:
            self.write(node.body if test.known else node.orelse)
            return
        yes = self.block(f"if ({bare(test)})", node.body)
        no = False
        if node.orelse:
            before = len(self.lines)
            no = self.block("else", node.orelse)
            if len(self.lines) == before + 2:
                del self.lines[before:]
        self.ended = yes and no and bool(node.orelse)

    def visit_While(self, node: ast.While) -> None:
        before = len(self.lines)
        test = self.condition(node.test)
        if len(self.lines) > before:
            self.refuse(node)
        self.block(f"while ({bare(test)})", node.body)

    def visit_For(self, node: ast.For) -> None:
        called, target = node.iter, node.target
        if node.orelse or not (isinstance(called, ast.Call) and ast.unparse(called.func) == "range" and isinstance(target, ast.Name)):
            self.refuse(node)
        ends = [self.visit(each) for each in called.args]
        first, end = ends[:2] if len(ends) > 1 else (constant(0), ends[0])
        by = ends[2].known if len(ends) > 2 else 1
        if first.known is not None and end.known is not None and (end.known - first.known) * by <= 0:
            return
        self.count += 1
        counter, stop = f"n{self.count}", "" if end.known is not None else f", end{self.count} = {bare(end)}"
        last = str(end) if end.known is not None else f"end{self.count}"
        step = {1: f"{counter}++", -1: f"{counter}--"}.get(by, f"{counter} += {by}")
        body = node.body
        self.line(f"for (int64_t {counter} = {bare(first)}{stop}; {counter} {'<' if by > 0 else '>'} {last}; {step}) {{")
        self.indent += "    "
        self.names.pop(target.id, None) if target.id in self.settled else None
        if target.id != "_":
            own = c_name(target.id)
            self.declared[own] = WHOLE
            self.names[target.id] = Value(own, WHOLE)
            self.line(f"{own} = {counter};")
        self.write(body)
        self.ended = False
        self.indent = self.indent[:-4]
        self.line("}")

    def visit_Continue(self, node: ast.Continue) -> None:
        self.line("continue;")
        self.ended = True

    def visit_Break(self, node: ast.Break) -> None:
        self.line("break;")
        self.ended = True

    # ---- arrays ----
    def element(self, node: ast.expr) -> tuple[str, str]:
        """The place of one number of an array, and its type."""
        part = self.part(node, self.visit(node.value)) if isinstance(node, ast.Subscript) else None
        if part is None or part.shape:
            self.refuse(node)
        return part.data, part.kind  # type: ignore[union-attr]

    def part(self, node: ast.Subscript, array: View) -> View:
        """What an array has at its first indices, or from an index on."""
        if isinstance(node.slice, ast.Slice):
            if node.slice.lower is None or node.slice.upper is not None or node.slice.step is not None or len(array.shape) > 1:
                self.refuse(node)
            first = self.visit(node.slice.lower)  # type: ignore[arg-type]
            return View(f"({array.data} + {first})", array.kind, (self.operation(node, ast.Sub(), array.shape[0], first),))
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        at = self.visit(indices[0])
        for index, length in zip(indices[1:], array.shape[1:], strict=False):
            at = self.operation(node, ast.Add(), self.operation(node, ast.Mult(), at, length), self.visit(index))
        rest = array.shape[len(indices) :]
        if not rest:
            return View(f"{array.data}[{bare(at)}]", array.kind, ())
        at = reduce(lambda a, b: self.operation(node, ast.Mult(), a, b), rest, at)
        return View(array.data if at.known == 0 else f"({array.data} + {at})", array.kind, rest)

    # ---- expressions ----
    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.names:
            return self.names[node.id]
        if node.id == "D":
            return View("D", WHOLE, (constant(len(self.program.table)),))
        if isinstance(self.constants.get(node.id), list):
            return self.program.row(self.letters, node.id)
        return constant(self.constants[node.id]) if node.id in self.constants else self.refuse(node, "has no value")

    def visit_Tuple(self, node: ast.Tuple) -> list[Any]:
        return [self.visit(each) for each in node.elts]

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return self.visit(node.value.value).shape[ast.literal_eval(node.slice)]
        whole = self.visit(node.value)
        if isinstance(whole, list):
            return whole[ast.literal_eval(node.slice)]
        if whole.data == "D":
            at = self.visit(node.slice)
            return (
                Value(f"{self.program.whole_table()}[{bare(at)}]", WHOLE)
                if at.known is None
                else constant(int(self.program.table[at.known]))
            )
        part = self.part(node, whole)
        if part.shape:
            return part
        return Value(f"(int64_t){part.data}", WHOLE) if part.kind == SMALL else Value(part.data, part.kind)

    def visit_Call(self, node: ast.Call) -> Any:
        name = ast.unparse(node.func)
        if name == "float":
            return constant(float(ast.literal_eval(node.args[0])))
        if name.endswith("_of") and name.removesuffix("_of") in self.program.shared:
            return self.program.shared[name.removesuffix("_of")]
        args = [self.visit(each) for each in node.args]
        if name == "at_points":
            return self.at_points(args)
        if name.startswith("call_"):
            return self.called(node, self.program.at_address(name.removeprefix("call_")), args[1:])
        if name in self.program.declared[self.letters][0]:
            return self.called(node, self.program.function(self.letters, name), args)
        if name == "len":
            return args[0].shape[0]
        if name in ("np.empty", "np.zeros"):
            return self.room(node, args[0], zero=name == "np.zeros")
        return self.function(node, name, args)

    def called(self, node: ast.Call, function: CFunction, args: list[Any]) -> Any:
        """A call of another function, with what it takes."""
        given = []
        for which, axis in function.takes:
            arg = args[which]
            given.append(str(arg) if isinstance(arg, Value) else arg.data if axis < 0 else str(arg.shape[axis]))
        text = f"{function.name}({', '.join(bare(Value(each, REAL)) for each in given)})"
        if len(function.gives) < 2:
            return Value(text, function.gives[0] if function.gives else "void")
        self.count += 1
        self.line(f"struct {function.name}_result r{self.count} = {text};")
        return [Value(f"r{self.count}.part{k}", kind) for k, kind in enumerate(function.gives)]

    def at_points(self, args: list[Any]) -> None:
        """A polynomial and its slope at some points in a row."""
        S, at, rows, x, to, slopes_to, order, apart, count = args
        if apart.known != 1:
            raise TypeError("the C of polynomials at points is for one lane")
        places = ", ".join(bare(each) for each in (x, to, slopes_to, order, count))
        self.line(f"at_points({S.data} + {at}, {rows.data}, {places});")

    def room(self, node: ast.Call, count: Value, zero: bool) -> View:
        """An array that lasts as long as the call."""
        if count.known is None:
            self.refuse(node, "has a length that is not known")
        kind = WHOLE if any(ast.unparse(each.value) == "np.int64" for each in node.keywords) else REAL
        self.count += 1
        name, length = f"room{self.count}", max(count.known, 1)
        self.arrays[name] = f"{kind} {name}[{length}]{' = {0}' if zero else ''};"
        if zero and len(self.indent) > 4:
            self.line(f"memset({name}, 0, sizeof {name});")
        return View(name, kind, (count,))

    def extreme(self, node: ast.AST, sign: str, a: Value, b: Value) -> Value:
        return super().extreme(node, sign, *(each if each.text.isidentifier() else self.held(each) for each in (a, b)))


def _uses(text: str, name: str) -> bool:
    return re.search(rf"(?<![\w.>]){re.escape(name)}(?!\w)", text) is not None
