"""Hits on stops with restitution: velocities jump at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Numeric
from stickslip.basics.errors import SolveError
from stickslip.solvers.plain.deciding import ROUNDING, AtZero, blocks, decide
from stickslip.solvers.plain.plain_equations import SHORT, ContactModes, Equations

_MOST = 100  # hits, one handing on the next, at one instant


def touching_stops(e: Equations, t: float, y: ArrayLike, fired: list[int]) -> list[int]:
    """Rows of all stops that touch."""
    q, _ = e.state(y)
    small = e.noise_of_gaps(q)
    return [e.k + s for s, gap in enumerate(e.gaps(t, q)) if gap <= small or e.k + s in fired]


def rebound(e: Equations, t: float, y: Numeric, rows: list[int]) -> tuple[Any, dict[int, float]]:
    """The state after all hits at one instant, and the velocity of approach of each stop that was hit [m/s]."""
    y, n, hits = np.array(y, float), e.n, dict[int, float]()
    G = np.array([[e.G[i][j] for j in rows] for i in rows])
    still = ROUNDING * e.scale_of_velocity
    for _ in range(_MOST):
        rates = e.slips(t, y[:n].tolist(), y[n : 2 * n].tolist())
        if all(rates[i] >= -still for i in rows) or (not hits and not rows):
            return y, hits
        for block in blocks(G):
            own = [rows[m] for m in block]
            approaching = [i for i in own if rates[i] < -still]
            if approaching:
                hits |= {i: rates[i] for i in approaching if i not in hits}
                y[n : 2 * n] -= _impulse(e, own, rates, _common_restitution(e, approaching), G[np.ix_(block, block)])
    raise SolveError(f"hits at t = {t:.6g} s hand one another on without end; take a restitution below 1")


def _common_restitution(e: Equations, rows: list[int]) -> float:
    values = {float(e.stops[i - e.k].restitution) for i in rows}
    if len(values) > 1:
        names = " and ".join(e.stops[i - e.k].name for i in rows)
        raise SolveError(f"the stops {names} are hit at one instant and have the restitutions {sorted(values)}; allowed is one for both")
    return values.pop()


def _impulse(e: Equations, rows: list[int], rates: list[float], restitution: float, G: Array) -> Any:
    """Change of the coordinates' velocities: impulses >= 0 with (rate after) >= -e (rate before) at each stop."""
    wanted = [(1 + restitution) * rates[i] if rates[i] < 0 else rates[i] for i in rows]
    impulses = decide(AtZero(G, wanted, [-np.inf] * len(rows), [0.0] * len(rows)))
    return sum(np.array(e.weights[i]) * force for i, force in zip(rows, impulses.R, strict=True))


def closing_stops(e: Equations, t: float, y: ArrayLike, mode: ContactModes, rows: list[int]) -> dict[int, float]:
    """Stops whose rebounds have become a geometric series that ends at once, or no higher than rounding, and when it does [s]."""
    rates = e.slips(t, *e.state(y))
    accelerations, small = e.slip_rates(t, y, mode), e.noise_of_gaps(e.state(y)[0])
    ends: dict[int, float] = {}
    for i in rows:
        loss, push, speed = 1.0 - float(e.stops[i - e.k].restitution), -accelerations[i], max(rates[i], 0.0)
        soon = speed <= (SHORT * e.scale_of_time) * push * loss / 2 or speed * speed <= 2 * push * small
        if push > 0 and soon and (loss > 0 or speed == 0):
            ends[i] = t + (2 * speed / (push * loss) if loss > 0 else 0.0)
    return ends
