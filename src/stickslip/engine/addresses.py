"""What a text of functions calls and does not hold: functions at addresses, and arrays that Python and the driver share."""

from __future__ import annotations

from functools import partial
from typing import Any

from llvmlite import ir
from numba import int64
from numba.np.arrayobj import populate_array

from stickslip.engine.expressions import FLOAT64, INT64
from stickslip.engine.function_body import View
from stickslip.engine.functions import KINDS


def outside(context: Any, functions: dict[str, str], shared: dict[str, str]) -> dict[str, Any]:
    """Writers of such calls by their names: ``call_NAME`` of a function at an address, ``NAME_of`` of a shared array, and `at_points`.

    Parameters
    ----------
    context : Numba's target context
    functions, shared : dict
        Names and types, as texts.
    """

    def at_address(kind: Any, builder: Any, args: list[Any]) -> Any:
        given = zip(kind.args, args[1:], strict=True)
        whole = [as_array(context, builder, takes, arg) if isinstance(arg, View) else arg for takes, arg in given]
        return call(context, builder, kind.return_type(int64, *kind.args), [args[0], *whole])

    def shared_array(which: int, kind: Any, builder: Any, args: list[Any]) -> View:
        numbers = builder.inttoptr(args[0], INT64.as_pointer())
        first, *shape = (builder.load(builder.gep(numbers, [ir.Constant(INT64, 4 * which + k)])) for k in range(1 + kind.ndim))
        return View(builder.inttoptr(first, context.get_data_type(kind.dtype).as_pointer()), tuple(shape))

    writers: dict[str, Any] = {f"call_{name}": partial(at_address, eval(kind, dict(KINDS))) for name, kind in functions.items()}
    writers |= {f"{name}_of": partial(shared_array, which, KINDS[kind]) for which, (name, kind) in enumerate(shared.items())}
    return writers | {"at_points": at_points}


def call(context: Any, builder: Any, sig: Any, args: list[Any]) -> Any:
    """A call of the function at the address args[0] with the arguments after it."""
    kind = context.call_conv.get_function_type(sig.return_type, sig.args[1:])
    function = builder.inttoptr(args[0], kind.as_pointer())
    return context.call_conv.call_function(builder, function, sig.return_type, sig.args[1:], args[1:])[1]


def as_array(context: Any, builder: Any, kind: Any, view: View) -> Any:
    """An array as Numba's functions take it."""
    size = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    array = context.make_array(kind)(context, builder)
    strides = [ir.Constant(INT64, size)]
    for length in view.shape[:0:-1]:
        strides.insert(0, builder.mul(strides[0], length))
    populate_array(array, view.data, view.shape, strides, size, None)
    return array._getvalue()


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
