"""From strobe states and one sampled motion period to the raw results of a case: for the methods that have no lanes."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.forces import held_velocity, is_dynamic, law_rate, normal_load
from stickslip.solvers.gather import NEEDED, Raw

__all__ = ["NOTHING", "codes_of", "margin_force", "period_of", "raw", "segments_of", "window_of"]

LONGEST = 16  # largest period number that is looked for
SEGMENTS = 32  # most segments of one motion period


#: Results of a case that could not be solved.
NOTHING: dict[str, Any] = {
    "displacement": np.nan, "window": 1.0, "period": 0, "periods_run": 0, "status": 4, "v_min": np.nan, "v_max": np.nan,
    "seg_count": 0, "seg_time": np.zeros(SEGMENTS), "seg_code": np.zeros(SEGMENTS, np.int8), "margin_force": np.inf,
}  # fmt: skip


def period_of(model: Any, strobe: Any, tolerance: float) -> int:
    """Smallest p for which the last two strobe states came back after p periods; 0 if none.

    `strobe` is (periods + 1, 1 + states): x, v, z. The states are compared on their own scales.
    """
    y = strobe[:, 1:] / _scales(model, strobe)
    for p in range(1, min(LONGEST, (len(y) - 1) // 2) + 1):
        if abs(y[-2:] - y[-2 - p : -p]).max() <= tolerance:
            return p
    return 0


def _scales(model: Any, strobe: Any) -> Any:
    scale = getattr(model.friction, "scale", None)
    inner = (
        np.full(strobe.shape[1] - 2, np.nan)
        if scale is None
        else np.broadcast_to(np.asarray(scale(normal_load(model, 0.0, 0.0)), float), strobe.shape[1] - 2)
    )
    inner = np.where(np.isfinite(inner), inner, abs(strobe[:, 2:]).max(axis=0))
    scales = np.concatenate([[float(model.velocity_scale)], inner])
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
