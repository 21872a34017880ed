"""From strobe states and one sampled motion period to the raw results of a case: for the methods that have no lanes."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.forces import held_velocity, is_dynamic, law_rate, normal_load
from stickslip.solvers.gather import NEEDED, Raw

__all__ = ["NOTHING", "codes_of", "margin_force", "period_of", "raw", "segments_of", "strobe_tolerance", "window_of"]

LONGEST = 16  # largest period number that is looked for
SEGMENTS = 32  # most segments of one motion period


#: Results of a case that could not be solved.
NOTHING: dict[str, Any] = {
    "displacement": np.nan, "window": 1.0, "period": 0, "periods_run": 0, "status": 4, "v_min": np.nan, "v_max": np.nan,
    "seg_count": 0, "seg_time": np.zeros(SEGMENTS), "seg_code": np.zeros(SEGMENTS, np.int8), "margin_force": np.inf,
}  # fmt: skip


def strobe_tolerance(method: str, rtol: float) -> float:
    """How close strobe points must come to count as one, in their scales: 30 rtol, at most 1e-3; for exact arcs 1e-8.

    Examples
    --------
    >>> strobe_tolerance("exact", 1e-4), strobe_tolerance("radau", 1e-4), round(strobe_tolerance("Rodas5P", 1e-6), 9)
    (1e-08, 0.001, 3e-05)
    """
    return 1e-8 if method == "exact" else min(30 * float(rtol), 1e-3)


# Who else asks whether a motion repeats asks something else. The compiled lanes and arcs remember the last strobe points of a case only
# (engine/kernels); dynamics/diagrams looks at points that were all taken after settling, up to period 32, and dynamics/repeating tells
# the evidence beside it; identifying/steady_curves extrapolates from few points; records/measures knows noisy samples and no states.
def period_of(model: Any, strobe: Any, tolerance: float, settle: int) -> int:
    """Smallest p up to `LONGEST` after which the strobe states of a run come back and have stopped drifting; 0 if none.

    `strobe` is (periods + 1, 1 + states): x, v, z, of which the first `settle` periods do not count. The states are compared on
    their own scales.
    """
    y, done = strobe[:, 1:] / _scales(model, strobe), len(strobe) - 1
    window = max(done - settle, min(1, done))
    for p in range(1, min(LONGEST, window // 2) + 1):
        if _repeats(y[-1 - window :], p, tolerance):
            return p
    return 0


def _repeats(y: Any, p: int, tolerance: float) -> bool:
    """Whether the points repeat after p, and have settled."""
    n = len(y) - 1
    tail = max(n // 4, p)
    if not abs(y[-tail:] - y[-tail - p : -p]).max() <= tolerance:  # nor does what is not a number
        return False
    lag = p * max(n // (2 * p), 1)
    late = abs(y[-p:] - y[-p - lag : -lag]).max()
    if late > tolerance:
        return False
    if late <= 0.1 * tolerance or n < 2 * lag + p - 1:
        return True
    early = abs(y[-p - lag : -lag] - y[-p - 2 * lag : n + 1 - 2 * lag]).max()
    return bool(late < early and late * late / (early - late) <= tolerance)


def _scales(model: Any, strobe: Any) -> Any:
    """Sizes of v and of each inner state: what the drive does to a body without friction, the law's scale or the largest value."""
    scale, inner = getattr(model.friction, "scale", None), np.full(strobe.shape[1] - 2, np.nan)
    if scale is not None and len(inner):
        inner = np.broadcast_to(np.asarray(scale(normal_load(model, 0.0, 0.0)), float), len(inner))
    inner = np.where(np.isfinite(inner), inner, abs(strobe[:, 2:]).max(axis=0))
    scales = np.concatenate([[float(getattr(model, "free_velocity", model.velocity_scale))], inner])
    return np.where(scales > 0, scales, 1.0)


def window_of(strobe: Any, settle: int, period: int) -> tuple[float, float]:
    """Displacement over the part after settling and its length: whole motion periods if a period was found."""
    done = len(strobe) - 1
    count = done - settle
    count -= count % (period or 1) if count > (period or 1) else 0
    return float(strobe[-1, 0] - strobe[-1 - count, 0]), float(count)


def codes_of(model: Any, v: Any, z: Any, mode: Any, slip_ratio: float, t: Any, x: Any, memory: Any = ()) -> Any:
    """What the body does at sampled instants: +2, -2 slipping, 0 stuck, +1, -1 elastic (see `stickslip.segments`)."""
    if not is_dynamic(model.friction) or z.shape[1] == 0:
        return 2 * mode
    slip = held_velocity(model.contact_velocity(v), mode, 1e-9 * float(model.velocity_scale) or 1e-9)
    rate = law_rate(model.friction, slip, z[:, 0] if z.shape[1] == 1 else tuple(z.T), normal_load(model, t, x), memory)
    ratio = 1 - (rate if z.shape[1] == 1 else rate[0]) / slip
    return mode * np.where(ratio >= slip_ratio, 2, 1)


def margin_force(model: Any) -> float:
    """Nothing these methods measure: without meaning for a dynamic law, not known for a set-valued one."""
    return float("inf" if is_dynamic(model.friction) else "nan")


def segments_of(durations: Any, codes: Any) -> tuple[int, Any, Any]:
    """Stretches of one code: their number (-1 if too many to keep), durations and codes."""
    seg_time, seg_code = np.zeros(SEGMENTS), np.zeros(SEGMENTS, np.int8)
    starts = np.flatnonzero(np.diff(codes, prepend=99))
    if len(starts) > SEGMENTS:
        return -1, seg_time, seg_code
    seg_time[: len(starts)] = np.add.reduceat(durations, starts)
    seg_code[: len(starts)] = codes[starts]
    return len(starts), seg_time, seg_code


def raw(cases: list[dict[str, Any]]) -> Raw:
    """The results of several cases, each a dict by the names of `Raw`, as one."""
    return Raw(**{name: np.array([case[name] for case in cases]) for name in NEEDED})
