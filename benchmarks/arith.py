"""The core's peak in double-precision fused multiply-adds: what any solver here can at most use.

A compiled loop with independent vector accumulators, enough of them to hide the latency of the multiply-add. It is written in LLVM's own
instructions: a plain loop over an array would measure loads and stores, one over scalars would not become a vector.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from time import process_time

import llvmlite.binding as llvm

WIDTHS = (1, 2, 4, 8)
ACCUMULATORS = (8, 12, 16, 24)
ROUNDS = 2_000_000


def _instructions(width: int, accumulators: int) -> str:
    """A loop that does a -> a x + y on every accumulator, and returns a lane of the sum of all."""
    kind, each = f"<{width} x double>", range(accumulators)

    def spread(name: str) -> list[str]:
        return [
            f"  %{name}1 = insertelement {kind} undef, double %{name}, i32 0",
            f"  %{name}s = shufflevector {kind} %{name}1, {kind} undef, <{width} x i32> zeroinitializer",
        ]

    def begun(k: int) -> str:
        return "<" + ", ".join(f"double {k + 0.1 * lane!r}" for lane in range(width)) + ">"

    return "\n".join(
        [
            f"declare {kind} @llvm.fma.v{width}f64({kind}, {kind}, {kind})",
            "define double @spin(i64 %rounds, double %x, double %y) {",
            "entry:", *spread("x"), *spread("y"), "  br label %body",
            "body:", "  %n = phi i64 [ 0, %entry ], [ %m, %body ]",
            *(f"  %a{k} = phi {kind} [ {begun(k)}, %entry ], [ %b{k}, %body ]" for k in each),
            *(f"  %b{k} = call {kind} @llvm.fma.v{width}f64({kind} %a{k}, {kind} %xs, {kind} %ys)" for k in each),
            "  %m = add i64 %n, 1", "  %more = icmp slt i64 %m, %rounds", "  br i1 %more, label %body, label %after",
            "after:", f"  %t0 = fadd {kind} %b0, %b0",
            *(f"  %t{k} = fadd {kind} %t{k - 1}, %b{k}" for k in each if k),
            f"  %end = extractelement {kind} %t{accumulators - 1}, i32 0", "  ret double %end", "}",
        ]
    )  # fmt: skip


@cache
def _loop(width: int, accumulators: int) -> Callable[[int, float, float], float]:
    """Compiled function of (rounds, x, y), for this processor."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=3, cpu=llvm.get_host_cpu_name(), features=features)
    module = llvm.parse_assembly(_instructions(width, accumulators))
    module.verify()
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    spin = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_double, ctypes.c_double)(engine.get_function_address("spin"))
    return lambda rounds, x, y, _=engine: spin(rounds, x, y)  # the machine code lives as long as its engine


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
