"""The core's peak in double-precision fused multiply-adds: what any solver here can at most use.

A compiled loop with independent vector accumulators, enough of them to hide the latency of the multiply-add. It is emitted through
Numba's intrinsics: a plain loop over an array would measure loads and stores, one over scalars would not become a vector.
"""

from __future__ import annotations

from functools import cache
from time import process_time

WIDTHS = (1, 2, 4, 8)
ACCUMULATORS = (8, 12, 16, 24)
ROUNDS = 2_000_000


def _emitter(width: int, accumulators: int):
    """Code generator of a loop that does a -> a x + y on every accumulator and returns a sum of all."""
    from llvmlite import ir
    from numba.core import cgutils

    double, whole, index = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
    vector = ir.VectorType(double, width)

    def spread(builder, value):
        empty = ir.Constant(vector, ir.Undefined)
        one = builder.insert_element(empty, value, index(0))
        return builder.shuffle_vector(one, empty, ir.Constant(ir.VectorType(index, width), [0] * width))

    def emit(_context, builder, _signature, args):
        kind = ir.FunctionType(vector, [vector] * 3)
        fma = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fma.v{width}f64")
        rounds, x, y = args[0], spread(builder, args[1]), spread(builder, args[2])
        entry, body, after = builder.block, builder.append_basic_block("body"), builder.append_basic_block("after")
        builder.branch(body)
        builder.position_at_end(body)
        count, state = builder.phi(whole), [builder.phi(vector) for _ in range(accumulators)]
        following, new = builder.add(count, whole(1)), [builder.call(fma, [a, x, y]) for a in state]
        for k, (a, b) in enumerate(zip([count, *state], [following, *new], strict=True)):
            a.add_incoming(whole(0) if k == 0 else ir.Constant(vector, [k + 0.1 * lane for lane in range(width)]), entry)
            a.add_incoming(b, body)
        builder.cbranch(builder.icmp_signed("<", following, rounds), body, after)
        builder.position_at_end(after)
        total = new[0]
        for b in new[1:]:
            total = builder.fadd(total, b)
        return builder.extract_element(total, index(0))

    return emit


@cache
def _loop(width: int, accumulators: int):
    """Compiled function of (rounds, x, y)."""
    from numba import njit, types
    from numba.extending import intrinsic

    emit = _emitter(width, accumulators)

    @intrinsic
    def spin(_typing, rounds, x, y):
        return types.float64(types.int64, types.float64, types.float64), emit

    return njit(lambda rounds, x, y: spin(rounds, x, y))


def gigaflops(width: int, accumulators: int) -> float:
    """Best of five [GFLOP/s], a multiply-add counted as two."""
    loop = _loop(width, accumulators)
    loop(10, 0.999, 1e-3)
    times = []
    for _ in range(5):
        start = process_time()
        loop(ROUNDS, 0.999, 1e-3)
        times.append(process_time() - start)
    return 2 * width * accumulators * ROUNDS / min(times) / 1e9


def report() -> dict[str, float]:
    """Prints the peak for each vector width; returns it as {"8 doubles": GFLOP/s, ...}."""
    print("double FMA peak of one core [GFLOP/s], the best over the number of independent accumulators")
    found = {}
    for width in WIDTHS:
        best, k = max((gigaflops(width, k), k) for k in ACCUMULATORS)
        found[f"{width} doubles"] = best
        print(f"  vectors of {width}: {best:7.1f}   ({k} accumulators)")
    return found
