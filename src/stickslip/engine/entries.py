"""How functions of a kernel are called from outside, by Python or at their addresses: as functions of C with plain arguments.

Of an array they take a pointer and its lengths, of a condition a whole number, 0 or 1; several numbers that they return stand
where their last argument points, eight bytes each.
"""

from __future__ import annotations

from typing import Any

from stickslip.engine import signatures
from stickslip.engine.expressions import BOOL, FLOAT64, INT8, INT64
from stickslip.engine.function_body import View, parts_of_arguments
from stickslip.engine.instructions import VOID, Builder, Constant, Function, function_type, struct_of
from stickslip.engine.signatures import InMemory, Number, Several, Signature

_NUMBERS = {signatures.INT64: INT64, signatures.FLOAT64: FLOAT64, signatures.BOOLEAN: BOOL, signatures.INT8: INT8}


def number_of(kind: Any) -> Any:
    """The type of a number."""
    if kind not in _NUMBERS:
        raise TypeError(f"{kind} is not among the types of a function of plain numbers")
    return _NUMBERS[kind]


def parts_of(kind: Number | InMemory) -> list[Any]:
    """An argument's types: of an array a pointer and its lengths."""
    return [number_of(kind.number).as_pointer(), *[INT64] * kind.axes] if isinstance(kind, InMemory) else [number_of(kind)]


def result_of(kind: Number | Several) -> Any:
    """The type of what a function returns."""
    if kind == signatures.VOID:
        return VOID
    return struct_of(tuple(map(number_of, kind.numbers))) if isinstance(kind, Several) else number_of(kind)


def entry_type(kind: Signature) -> Any:
    """The type of a function that is called from outside."""
    takes = [_outside(part) for each in kind.takes for part in parts_of(each)]
    if isinstance(kind.returns, Several):
        return function_type(VOID, (*takes, INT64.as_pointer()))
    return function_type(_outside(result_of(kind.returns)), tuple(takes))


def _outside(kind: Any) -> Any:
    """The type that a part has outside."""
    return INT64 if kind == BOOL else kind


def called(builder: Any, kind: Signature, address: Any, args: list[Any]) -> Any:
    """A call of the function at an address, of numbers and views."""
    given = [builder.zext(part, INT64) if part.type == BOOL else part for part in parts_of_arguments(args)]
    result = builder.call_at(builder.inttoptr(address, entry_type(kind).as_pointer()), given)
    return builder.trunc(result, BOOL) if kind.returns == signatures.BOOLEAN else result


def write_entry(module: Any, name: str, kind: Signature, call: Any) -> None:
    """A function that is called from outside; `call` writes, with a builder and a list of numbers and views, what it does."""
    function = Function(module, entry_type(kind), name)
    function.attributes.append("nounwind")
    builder = Builder(function.append_basic_block("entry"))
    given = iter(function.args)
    result = call(builder, [_taken(builder, each, given) for each in kind.takes])
    if isinstance(kind.returns, Several):
        room = function.args[-1]
        for k, number in enumerate(kind.returns.numbers):
            part = builder.extract_value(result, k)
            part = builder.zext(part, INT64) if part.type == BOOL else part
            pointer = builder.gep(room, Constant(INT64, k))
            builder.store(part, builder.bitcast(pointer, _outside(number_of(number)).as_pointer()))
    if isinstance(kind.returns, Several) or kind.returns == signatures.VOID:
        builder.ret_void()
    else:
        builder.ret(builder.zext(result, INT64) if result.type == BOOL else result)


def _taken(builder: Any, kind: Any, given: Any) -> Any:
    """An argument inside: a number or a view."""
    if isinstance(kind, InMemory):
        return View(next(given), tuple(next(given) for _ in range(kind.axes)))
    return builder.trunc(next(given), BOOL) if kind == signatures.BOOLEAN else next(given)
