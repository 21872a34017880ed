"""What a call of a kernel's step costs beside the core's multiply-add peak: explicit steps of LuGre and Dahl robots that stick.

    python benchmarks/steps.py

Sixteen robots under a tenth of the force that would let them slip make explicit steps alone, without events; the step is called for
them again and again. Operations are counted in its text (a multiply-add is two), in those parts that such a step runs through, loops
round by round; what the processor does beside them (decisions, numbers fetched and put away) is what is missing to the peak.
"""

from __future__ import annotations

import ast
from time import process_time
from typing import Any

import numpy as np

import arith
import pin  # noqa: F401  (one core)
import stickslip as ss
from stickslip.engine import cache, driver, emit, lanes, slaved, tableaux
from stickslip.solvers.lane_tables import CaseTable
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings

CALLS = 20_000


def operations(lines: list[ast.stmt], known: dict[str, int]) -> int:
    """Floating-point operations of one lane in lines, of branches only those of lanes that make an explicit step."""
    count = 0
    for node in lines:
        if isinstance(node, ast.For):
            over = ast.unparse(node.iter.func)
            if over == "while_any":
                continue
            ends = [eval(ast.unparse(end), {}, known) for end in node.iter.args]
            for k in emit.ROUNDS.get(over, range)(*ends):
                count += operations(node.body, known | {node.target.id: k})
        elif isinstance(node, ast.If):
            if ast.unparse(node.test) == "_mine":
                count += operations(node.body, known)
        else:
            count += in_expression(node, known)
    return count


def in_expression(node: ast.AST, known: dict[str, int]) -> int:
    """Those of a line: places in rows, loop counters and copies are none."""
    if isinstance(node, ast.Subscript):
        return 0
    own = 2 * (isinstance(node, ast.Call) and ast.unparse(node.func) == "fma")
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub, ast.Mult, ast.Div)):
        copied = isinstance(node.left, ast.Constant) and node.left.value == 1.0
        counted = all(each.id in known for each in ast.walk(node) if isinstance(each, ast.Name))
        own = int(not copied and not counted)
    return own + sum(in_expression(each, known) for each in ast.iter_child_nodes(node))


def called(robot: ss.Robot, method: object) -> tuple[float, int]:
    """Seconds of a call for sixteen robots, and operations of a lane in it."""
    kernel = lanes.kernel_of(robot, method, False)
    todo = request(robot, Settings(periods=2, settle=0, keep="summary"))
    table, held = CaseTable(robot, kernel, todo.start, todo.span), []
    room = lanes._aligned
    lanes._aligned = lambda count: held.append(room(count)) or held[-1]
    try:
        lanes.run(kernel, table.rows, table.start, lanes.Job(10**9, 0, False, 1e-6, 0.75, 1e9), progress=stop, slice_calls=50)
    except StopIteration:
        pass
    finally:
        lanes._aligned = room
    S, many = held[0], repeated()
    S[kernel.table[driver.column("F_TEND")] :][: kernel.lanes] = 1e9
    many(S, 1e-6, 1e18, CALLS, kernel.table)
    begun = process_time()
    many(S, 1e-6, 1e18, CALLS, kernel.table)
    return (process_time() - begun) / CALLS, operations(ast.parse(kernel.code.source.step.lines).body, {})


def stop(_: int) -> None:
    """Leave the run as it is."""
    raise StopIteration


def repeated() -> Any:
    """What calls the step of a kernel many times, as its driver does."""
    kind = "void(f1, float64, float64, int64, i1)"
    call = "    for k in range(count):\n        call_step(table[AT_STEP], S, rtol, budget)\n"
    text = f"@typed({kind})\ndef many(S, rtol, budget, count, table):\n{call}"
    return cache.load(driver.source({"many": kind}, [text], ()), "many_steps", "many steps")["many"]


def main() -> None:
    """The table."""
    peak = max(arith.gigaflops(8, k) for k in arith.ACCUMULATORS)
    rig = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=np.linspace(1e-5, 1.2e-5, 16))
    dahl = rig.replace(friction=ss.Dahl(0.15, 0.21, 4e5))
    print(f"{'step':24s} {'ns a call':>10s} {'operations a lane':>18s} {'GFLOP/s':>8s} {'of the peak':>12s}")
    for name, robot in (("LuGre", rig), ("Dahl", dahl)):
        for method in [series for _, series in slaved.SERIES] + [tableaux.RODAS4]:
            seconds, count = called(robot, method)
            speed = 16 * count / seconds * 1e-9
            print(f"{name + ', ' + method.name:24s} {1e9 * seconds:10.0f} {count:18d} {speed:8.1f} {speed / peak:12.0%}")


if __name__ == "__main__":
    main()
