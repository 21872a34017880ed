"""A period of a switching flow with its monodromy matrix: the compiled engine against SciPy's integrator in Python.

    python benchmarks/flows.py [--rounds 5]

CPU milliseconds of one process, without compilation; compare ratios, and only within one run.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from math import pi
from statistics import median
from time import process_time
from typing import Any

import stickslip as ss
from stickslip.maths import cos


def den_hartog(F: float, r: float = 0.7) -> ss.SwitchingFlow:
    """x'' + x + F sgn x' = cos(r t), with rest."""

    def offered(t: Any, y: Any) -> Any:
        return -y[0] + cos(r * t)

    def slide(side: int) -> Callable[[Any, Any], Any]:
        return lambda t, y: (y[1], offered(t, y) - side * F)

    def after(t: Any, y: Any) -> int:
        return 1 if offered(t, y) > F else -1 if offered(t, y) < -F else 0

    def stop(t: Any, y: Any) -> Any:
        return (y[0], 0.0)

    switches = {
        1: (ss.Switch(lambda t, y: y[1], after, stop),),
        -1: (ss.Switch(lambda t, y: -y[1], after, stop),),
        0: (ss.Switch(lambda t, y: F - offered(t, y), 1), ss.Switch(lambda t, y: F + offered(t, y), -1)),
    }
    return ss.SwitchingFlow({1: slide(1), -1: slide(-1), 0: lambda t, y: (0.0 * y[0], 0.0)}, switches, 2 * pi / r)


def impacts(r: float = 0.8, w: float = 2.8) -> ss.SwitchingFlow:
    """x'' + x = cos(w t) above a wall that throws back."""
    hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -r * y[1]))
    return ss.SwitchingFlow({0: lambda t, y: (y[1], -y[0] + cos(w * t))}, {0: (hit,)}, 2 * pi / w)


def ball(r: float = 0.8) -> ss.SwitchingFlow:
    """A ball that bounces; what stands for a period is two seconds, in which it does so five times."""
    return ss.SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -r * y[1])),)})


CASES: dict[str, tuple[ss.SwitchingFlow, list[float], int, float]] = {
    "Den Hartog, never at rest": (den_hartog(0.3), [1.0, 0.5], 1, 2 * pi / 0.7),
    "Den Hartog, with rest": (den_hartog(0.6), [1.0, 0.5], 1, 2 * pi / 0.7),
    "impact oscillator": (impacts(), [0.2, 0.3], 0, 2 * pi / 2.8),
    "bouncing ball, 2 s": (ball(), [1.0, 0.0], 0, 2.0),
}


def period(flow: ss.SwitchingFlow, state: list[float], mode: int, span: float, method: str) -> Any:
    """One of them, with its monodromy matrix."""
    return ss.dynamics.passage(flow, state, mode, span, method=method)


def milliseconds(work: Callable[[], Any], rounds: int, times: int) -> float:
    """Median CPU time of one call."""
    work()
    found = []
    for _ in range(rounds):
        begin = process_time()
        for _ in range(times):
            work()
        found.append(1e3 * (process_time() - begin) / times)
    return median(found)


def main() -> None:
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    print(f"{'flow':28}{'engine [ms]':>14}{'SciPy [ms]':>14}{'ratio':>8}")
    for name, case in CASES.items():
        ours = milliseconds(partial(period, *case, "exact"), rounds, 100)
        judge = milliseconds(partial(period, *case, "dop853"), rounds, 3)
        print(f"{name:28}{ours:14.3f}{judge:14.1f}{judge / ours:8.0f}")


if __name__ == "__main__":
    main()
