"""Sizes of the motion and of the forces in records, from which bounds of a search follow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.inverse.identification.constant_speeds import is_of_constant_speeds

if TYPE_CHECKING:
    from stickslip.records.record import Record

_BULK = 98.0  # per cent of the samples, so that outliers set no bound
_WINDOW = 9  # samples over which a position is smoothed where only the size of its velocity is wanted


@dataclass(frozen=True)
class Sizes:
    """Sizes over all records, in SI units.

    Parameters
    ----------
    force : float
        Half the range of force, torque or current.
    speed, stroke, acceleration : float
        Largest speed, range of the position, and an acceleration of the usual size.
    """

    force: float
    speed: float
    stroke: float
    acceleration: float


def sizes_of(records: Sequence[Record], role: str) -> Sizes:
    """The sizes of a motion and of what was measured over it; `InputError` where one of them is zero."""
    each = [(_half_range(rec[role].si), *_motion(rec)) for rec in records]
    whole = Sizes(*(max(row[k] for row in each) for k in range(4)))
    for name, size in (("the force does not vary", whole.force), ("nothing moves", whole.speed)):
        if not size > 0:
            raise InputError("fit", [f"{name} in the record; check the columns with stickslip read FILE, or give a record that moves"])
    return whole


def _half_range(values: Any) -> float:
    good = values[np.isfinite(values)]
    return 0.5 * float(np.subtract(*np.percentile(good, [_BULK, 100 - _BULK]))) if len(good) else 0.0


def _motion(rec: Record) -> tuple[float, float, float]:
    """Speed, stroke, and acceleration as of a sine of that speed and stroke."""
    if is_of_constant_speeds(rec):  # no law that needs a stroke is fitted to it
        v = rec["velocity"].si
        return float(np.percentile(abs(v[np.isfinite(v)]), _BULK)), 0.0, 0.0
    if "velocity" in rec:
        v, t = rec["velocity"].si, rec["velocity"].time
    else:
        x, t = rec["position"].si, rec["position"].time
        kernel = np.ones(_WINDOW) / _WINDOW
        with np.errstate(all="ignore"):
            v = np.gradient(np.convolve(x, kernel, "same"), t)[_WINDOW:-_WINDOW]
        t = t[_WINDOW:-_WINDOW]
    good = np.isfinite(v) & np.isfinite(t)
    speed = float(np.percentile(abs(v[good]), _BULK)) if good.any() else 0.0
    if "position" in rec:
        stroke = 2 * _half_range(rec["position"].si)
    else:
        way = np.concatenate([[0.0], np.cumsum(v[good][1:] * np.diff(t[good]))])
        stroke = 2 * _half_range(way)
    return speed, stroke, 2 * speed**2 / stroke if stroke > 0 else 0.0
