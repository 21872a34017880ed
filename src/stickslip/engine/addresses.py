"""What a text of functions calls and does not hold: functions at addresses, and arrays that Python and the driver share."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from stickslip.engine.entries import called, number_of
from stickslip.engine.expressions import FLOAT64, INT64
from stickslip.engine.function_body import View
from stickslip.engine.instructions import Constant, function_type, vector_of
from stickslip.engine.signatures import InMemory, Signature, array_type, signature


def outside(functions: Mapping[str, str], shared: Mapping[str, str]) -> dict[str, Any]:
    """Writers of such calls by their names: ``call_NAME`` of a function at an address, ``NAME_of`` of a shared array, and `at_points`.

    Parameters
    ----------
    functions, shared : dict
        Names and types, as texts.
    """
    writers: dict[str, Any] = {f"call_{name}": partial(_at_address, signature(kind)) for name, kind in functions.items()}
    writers |= {f"{name}_of": partial(_shared_array, which, array_type(kind)) for which, (name, kind) in enumerate(shared.items())}
    return writers | {"at_points": at_points}


def _at_address(kind: Signature, builder: Any, args: list[Any]) -> Any:
    """A call of the function at the address args[0] with the arguments after it."""
    return called(builder, kind, args[0], args[1:])


def _shared_array(which: int, kind: InMemory, builder: Any, args: list[Any]) -> View:
    numbers = builder.inttoptr(args[0], INT64.as_pointer())
    first, *shape = (builder.load(builder.gep(numbers, Constant(INT64, 4 * which + k))) for k in range(1 + kind.axes))
    return View(builder.inttoptr(first, number_of(kind.number).as_pointer()), tuple(shape))


def at_points(builder: Any, args: list[Any]) -> None:
    """A polynomial S[at + m * apart] and its slope at `count` points in a row, into two other rows of the same array: one vector each."""
    S, at, rows, x, to, slopes_to = args[:6]
    order, apart, count = (arg.constant for arg in args[6:])
    vector = vector_of(FLOAT64, count)
    fma = builder.module.declared(f"llvm.fma.v{count}f64", function_type(vector, (vector,) * 3))

    def row(first: Any) -> Any:
        return builder.bitcast(builder.gep(rows.data, first), vector.as_pointer())

    def coefficient(m: int) -> Any:
        number = builder.load(builder.gep(S.data, builder.add(at, Constant(INT64, m * apart))))
        return builder.spread(number, vector)

    points = builder.load(row(x), align=8)
    value, slope = coefficient(order), Constant(vector, [0.0] * count)
    for m in range(order - 1, -1, -1):  # Horner's scheme
        slope = builder.call(fma, [slope, points, value])
        value = builder.call(fma, [value, points, coefficient(m)])
    builder.store(value, row(to), align=8)
    builder.store(slope, row(slopes_to), align=8)
