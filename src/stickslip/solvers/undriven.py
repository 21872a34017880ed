"""Bodies without a drive (amplitude zero): at rest, or uniformly decelerated or accelerated."""

from __future__ import annotations

import math

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.solvers.closed_arcs import Arcs


def arcs_of(arcs: Arcs, i: int, v0: float, end: float) -> tuple[Array, Array, Array, Array]:
    """Start times, positions, velocities and modes of the arcs of case i up to a time (two at most)."""
    segments, t, x = [], 0.0, 0.0
    if v0 != 0.0:
        slowing = float(arcs.resist_plus[i] if v0 > 0 else arcs.resist_minus[i])
        segments.append((0.0, 0.0, v0, 1 if v0 > 0 else -1))
        t = abs(v0) / slowing if slowing > 0.0 else math.inf
        x = 0.5 * v0 * t
    if t < end:
        segments.append((t, x, 0.0, 1 if arcs.hold_plus[i] < 0 else -1 if arcs.hold_minus[i] < 0 else 0))
    t0, x0, start, mode = (np.array(column) for column in zip(*segments, strict=True))
    return t0, x0, start, mode.astype(np.int8)


def fill_case(raw: dict[str, Array], i: int, arcs: Arcs, v0: float, periods: int, settle: int | str) -> None:
    """Write the raw results of case i."""
    T, auto = float(arcs.period[i]), settle == "auto"
    t0, x0, start, mode = arcs_of(arcs, i, v0, periods * T)
    slope = np.where(mode > 0, -arcs.resist_plus[i], np.where(mode < 0, arcs.resist_minus[i], 0.0))

    def at(n: float) -> tuple[float, float]:
        k = int(np.searchsorted(t0, n * T, side="right")) - 1
        d = n * T - t0[k]
        return float(x0[k] + d * (start[k] + 0.5 * slope[k] * d)), float(start[k] + slope[k] * d)

    steady = bool(slope[-1] == 0.0) and t0[-1] <= (periods - 1) * T
    n = math.ceil(t0[-1] / T) + 1 if steady and auto else periods
    first = n - 1 if auto else int(settle)
    edges = np.concatenate([[(n - 1) * T], t0[(t0 > (n - 1) * T) & (t0 < n * T)], [n * T]])
    codes = 2 * mode[np.searchsorted(t0, edges[:-1], side="right") - 1]
    (x, v), (x_first, _) = at(n), at(first)
    speeds = [at(e / T)[1] for e in edges]
    raw["displacement"][i], raw["window"][i], raw["x_end"][i], raw["v_end"][i] = x - x_first, n - first, x, v
    raw["v_max"][i], raw["v_min"][i], raw["margin_force"][i] = max(speeds), min(speeds), math.inf
    speeds += [at(first)[1], *(at(t / T)[1] for t in t0[(t0 > first * T) & (t0 < n * T)])]
    raw["wide_max"][i], raw["wide_min"][i] = max(speeds), min(speeds)
    raw["strobe_error"][i], raw["period"][i], raw["periods_run"][i] = 0.0 if steady else math.inf, int(steady), n
    raw["limit"][i] = float(start[-1]) * T if slope[-1] == 0.0 else math.inf
    raw["status"][i], raw["seg_count"][i] = int(steady and auto), len(codes)
    raw["seg_time"][i], raw["seg_code"][i] = 0.0, 0
    raw["seg_time"][i, : len(codes)], raw["seg_code"][i, : len(codes)] = np.diff(edges) / T, codes
