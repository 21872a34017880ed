"""How a frame of small changes grows: along the orbit of a map, and along a flow from stretch to stretch.

Maps and flows whose functions can be called with symbols are compiled, with their derivatives; others go by plain Python.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.errors import InputError
from stickslip.basics.interruption import look
from stickslip.dynamics.flows.flow_stretches import passage, started
from stickslip.engine.frames import carried
from stickslip.engine.iterated_maps import MapSteps
from stickslip.engine.remembered import Remembered
from stickslip.models.switching_flow import SwitchingFlow
from stickslip.solvers.flow_engine import MOST_STRETCHES, FlowStart, derivatives_along, is_smooth, map_steps, unknown
from stickslip.solvers.plain.user_functions import coordinates_of_map, of_state

_CHECKED, _SAME = 32, 1e-9  # iterations that are compared, and what differs by less of the largest number is rounding
_maps: Remembered[SwitchingFlow] = Remembered(most=64)
_flows: Remembered[SwitchingFlow] = Remembered(most=64)


def grown(M: Array, Q: Array) -> tuple[Array, Array]:
    """The frame that a derivative makes of another, and the logarithms of its growth."""
    Q, R = np.linalg.qr(M @ Q)
    with np.errstate(divide="ignore"):
        return Q, np.log(abs(np.diag(R)))


class CompiledMap:
    """An orbit of a compiled map, and a frame that it carries along."""

    method, most = "compiled", 20_000  # iterations between two looks whether to end

    def __init__(self, steps: MapSteps, numbers: Mapping[str, Any], x: Array):
        self.steps, self.row, self.x, self.frame = steps, steps.row(numbers, 1), np.array(x, float), np.eye(len(x))

    def settled(self, count: int) -> None:
        """Iterate so often."""
        self.x = self.steps.after(self.row, self.x[None], count)[0]

    def grown(self, count: int) -> Array:
        """Logarithms of the growth in each of so many iterations (count, n), of at most `most`."""
        sizes = self.steps.growth(self.row[0], self.x, self.frame, count)
        with np.errstate(divide="ignore"):
            return np.log(sizes, out=sizes)


class PlainMap:
    """The same by plain Python, of a map that cannot be called with symbols, or whose Jacobian matrix is given."""

    most = 1

    def __init__(self, f: Callable[..., Any], slope: Callable[[Any], Any], x: Array, why: str):
        self.f, self.slope, self.x, self.frame, self.method = f, slope, x, np.eye(len(x)), f"plain Python: {why}"

    def settled(self, count: int) -> None:
        """Iterate so often."""
        for _ in range(count):
            look()
            self.x = coordinates_of_map(self.f, self.x)

    def grown(self, count: int) -> Array:
        """Logarithms of the growth in each of so many iterations (count, n)."""
        logs = np.empty((count, len(self.x)))
        for k in range(count):
            self.frame, logs[k] = grown(np.asarray(self.slope(self.x), float), self.frame)
            self.x = coordinates_of_map(self.f, self.x)
        return logs


def orbit_of_map(f: Callable[..., Any], x: Array, jacobian: Callable[[Any], Any] | None) -> CompiledMap | PlainMap:
    """The orbit of a map from a start, compiled where the map can be called with symbols.

    Examples
    --------
    >>> orbit = orbit_of_map(lambda x: (4 * x[0] * (1 - x[0]),), np.array([0.2]), None)
    >>> orbit.method, orbit.grown(2).round(6).tolist(), orbit.x.round(4).tolist()  # slopes 4 (1 - 2 x) at 0.2 and 0.64
    ('compiled', [[0.875469], [0.113329]], [0.9216])
    """
    if jacobian is not None:
        return PlainMap(f, jacobian, x, "its Jacobian matrix is given")
    flow = _maps(f, lambda: SwitchingFlow.of_map(f))
    if why := _unknown(flow, len(x)):
        return PlainMap(f, lambda x: of_state(f, x)[1], x, why)
    compiled = CompiledMap(map_steps(flow, len(x)), {}, x)
    if not _agrees(f, compiled):
        return PlainMap(f, lambda x: of_state(f, x)[1], x, "it does something else with symbols than with numbers")
    return compiled


def growth_along(orbit: CompiledMap | PlainMap, count: int) -> Iterator[Array]:
    """Logarithms of the growth in so many iterations: arrays (iterations, n), `count` in all."""
    for first in range(0, count, orbit.most):
        look()
        yield orbit.grown(min(orbit.most, count - first))


def _agrees(f: Callable[..., Any], compiled: CompiledMap) -> bool:
    """Whether a compiled map is that of plain Python at the first states of its orbit."""
    x = compiled.x
    for _ in range(_CHECKED):
        y, own = coordinates_of_map(f, x), compiled.steps.after(compiled.row, x[None], 1)[0]
        if not np.allclose(own, y, rtol=0.0, atol=_SAME * max(abs(x).max(), abs(y).max()), equal_nan=True):
            return False
        x = y
    return True


def compiled_flow(f: Callable[..., Any], n: int, by_user: bool) -> tuple[SwitchingFlow | None, str]:
    """The flow of n rates f(x) if the engine can follow it, else None and why; it does not where the user has its derivatives."""
    if by_user:
        return None, "its Jacobian matrix is given"
    flow = _flows(f, lambda: SwitchingFlow(lambda t, y: f(y)))
    why = _unknown(flow, n)
    return None if why else flow, why


def _unknown(flow: SwitchingFlow, n: int) -> str:
    """Why the engine cannot follow a flow; also one of functions that give another value each time, or another one for symbols."""
    try:
        return unknown(flow, n)
    except InputError as error:
        return error.problems[0]


def stretches_of(flow: Any, state: Numeric, mode: Any, *, count: int, settle: int, every: float, rtol: float) -> Iterator[Array]:
    """Logarithms of the growth in stretches of a switching flow, right at its switches: arrays (stretches, n), `count` in all.

    Parameters
    ----------
    settle : int
        Stretches before these.
    every : float
        How long a stretch is; a period, of a flow that has one.
    rtol : float
        Tolerance of SciPy's integrator, where the engine cannot follow the flow.
    """
    y, t = started(flow, FlowStart(state, mode), every, rtol), 0.0  # type: ignore[arg-type]
    if flow.map is not None and not unknown(flow, len(y)):
        motion = CompiledMap(map_steps(flow, len(y)), flow.numbers, y)
        motion.settled(settle)
        yield from growth_along(motion, count)
        return
    drifts, smooth, begun = flow.drifts, is_smooth(flow, len(y)), -settle
    Q = np.eye(len(y) - len(drifts.free))
    while begun < count:
        look()
        several = min(MOST_STRETCHES, (0 if begun < 0 else count) - begun)
        known = derivatives_along(flow, y, mode, every, several, begun >= 0) if smooth else None
        if known is None:  # something switches, or it cannot be followed so far, which is said where that happens
            done = passage(flow, y, mode, every, begin=t, rtol=rtol)
            known, mode, several = (done.state[None], done.monodromy[None]), done.mode, 1
        if begun >= 0:
            Q, sizes = carried(drifts.without(known[1]), Q)
            with np.errstate(divide="ignore"):
                yield np.log(sizes)
        y, begun, t = drifts.wrapped(known[0][-1]), begun + several, t + several * every
