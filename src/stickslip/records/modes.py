"""Modes of a structure from its measured frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.information import Information

if TYPE_CHECKING:
    from stickslip.records.record import Record


_BAND = 12  # lines on either side of a peak
_UNKNOWN = 8  # numbers of a mode: frequency and damping, and a, b and c, which are complex


@sealed
@dataclass(frozen=True)
class Mode:
    """A mode: natural frequency (in the unit of the axis) and damping ratio, with standard errors (infinite: not determined)."""

    frequency: float
    damping: float
    frequency_error: float
    damping_error: float


def modes(rec: Record, channel: str | None = None, count: int = 1) -> tuple[Mode, ...]:
    r"""The strongest modes in a frequency response.

    Around each peak the response is :math:`a/(f_n^2-f^2+2i\zeta f_n f) + b + c f` with complex a, b, c.

    Parameters
    ----------
    channel : str, optional
        A complex channel over frequency; by default the first there is.
    count : int
        How many modes, the strongest first.

    Returns
    -------
    tuple of Mode
    """
    c = _response(rec, channel)
    f, H = c.t, np.asarray(c.values)
    left, open_lines, strongest = np.array(H), np.arange(len(H)) > 0, []
    for _ in range(count):
        peak = int(np.argmax(np.where(open_lines, abs(left), 0.0)))
        mode, share = _fitted(f, left, peak)
        strongest.append(mode)
        left = left - share  # so that the flank of a mode is not taken for another one
        open_lines[max(peak - _BAND, 0) : peak + _BAND + 1] = False
    return tuple(strongest)


def _response(rec: Record, channel: str | None) -> Any:
    if channel is not None:
        return rec[channel]
    responses = [c for c in rec.channels.values() if np.iscomplexobj(c.values) and not c.over_time]
    if not responses:
        raise InputError("modes", ["the record has no complex channel over frequency; give channel= the name of a frequency response"])
    return responses[0]


def _fitted(f: Any, H: Any, peak: int) -> tuple[Mode, Any]:
    """The mode of a peak, and its share in the response at all lines."""
    from scipy.optimize import least_squares

    band = slice(max(peak - _BAND, 1), peak + _BAND + 1)
    x, y = f[band], H[band] / abs(H[peak])

    def pole(p: Any, x: Numeric) -> Any:
        return p[0] ** 2 / (p[0] ** 2 - x**2 + 2j * np.exp(p[1]) * p[0] * x)

    def parts(p: Any) -> tuple[Any, Any]:
        basis = np.stack([pole(p, x), np.ones(len(x)), (x - p[0]) / np.ptp(x) + 0j], axis=1)
        return basis, np.linalg.lstsq(basis, y, rcond=None)[0]

    def left(p: Any) -> Any:
        basis, factors = parts(p)
        rest = basis @ factors - y
        return np.concatenate([rest.real, rest.imag])

    step = f[peak] - f[peak - 1]
    starts = [(f[peak] + s * step, np.log(d)) for s in (-0.4, 0.0, 0.4) for d in (3e-4, 1e-3, 1e-2)]
    fits = [least_squares(left, p, x_scale=(step, 1.0), xtol=1e-12, ftol=1e-12) for p in starts]
    best = min(fits, key=lambda fit: fit.cost)
    spare = len(best.fun) - _UNKNOWN
    # SciPy's derivatives are one-sided. Where nothing is left to tell the noise, nothing is known of the errors.
    errors = Information(best.jac, 1e-4).errors(np.sqrt(2 * best.cost / spare)) if spare > 0 else np.full(2, np.inf)
    damping = float(np.exp(best.x[1]))
    share = parts(best.x)[1][0] * abs(H[peak]) * pole(best.x, f)
    damping_error = damping * errors[1] if np.isfinite(errors[1]) else np.inf
    return Mode(float(best.x[0]), damping, float(errors[0]), float(damping_error)), share
