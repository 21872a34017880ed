"""Functions on plain numbers and arrays as LLVM instructions: the driver of all kernels, in one piece.

All functions that an entry needs are written, and LLVM optimises them together, once.

The text is Python and means what Python means by it, on 64-bit whole numbers, floats, truth values and arrays whose numbers stand in a
row. Each function has its types in its decorator: ``@typed(void(int64, f1))``. A name has the
type of what it is first given; what is taken from an array is a view of it, and ``np.empty`` and ``np.zeros`` make one that lasts as long
as the call. Only in a function with ``fused=True`` in its decorator may a product and a sum be rounded once, together. There is
no check of bounds, no negative index, and no exception.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

from stickslip.engine.entries import parts_of, result_of, write_entry
from stickslip.engine.expressions import INT64, all_statements
from stickslip.engine.function_body import View, parts_of_arguments, write_body
from stickslip.engine.instructions import Constant, Function, function_type
from stickslip.engine.signatures import signature


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
            signatures[node.name] = signature(source)
            if any(option.arg == "fused" for option in declared.keywords):  # type: ignore[attr-defined]
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
            takes = [part for kind in self.signatures[name].takes for part in parts_of(kind)]
            result = result_of(self.signatures[name].returns)
            made = Function(self.module, function_type(result, tuple(takes)), self.module.get_unique_name(name))
            made.is_internal, made.is_fused = True, name in self.fused
            made.attributes.append("nounwind")
            if any(isinstance(node, (ast.For, ast.While)) for node in all_statements(self.texts[name].body)):
                made.attributes.append("noinline")  # a call is nothing beside a loop, and every copy is to be compiled
            self.made[name] = made
            self.waiting.append(name)
        return self.made[name]

    def write(self) -> None:
        """Write whatever is called and not yet written."""
        while self.waiting:
            name = self.waiting.pop()
            write_body(self, self.made[name], self.texts[name], self.signatures[name])

    def row(self, name: str) -> View:
        """An array of constants."""
        numbers = self.constants[name]
        if name not in self.rows:
            self.rows[name] = self.module.row(name, numbers)
        return View(self.rows[name], (Constant(INT64, len(numbers)),))

    def call(self, name: str, builder: Any, args: list[Any]) -> Any:
        """A call of a function of the text, or of what something else writes, with numbers and views."""
        if name in self.outside:
            return self.outside[name](builder, args)
        return builder.call(self.function(name), parts_of_arguments(args))


def write_functions(module: Any, entries: Mapping[str, str], text: str, outside: dict[str, Any]) -> None:
    """Functions of a text, or of `outside`, that are called from outside, by their names with their types, and all that they need."""
    program = _Program(module, text, outside)
    for name, kind in entries.items():
        write_entry(module, name, signature(kind), partial(program.call, name))
    program.write()
