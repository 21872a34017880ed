"""Modes of a structure from its measured frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.information import Information
from stickslip.sealing import sealed

__all__ = ["Mode", "modes"]

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


def modes(rec: Any, channel: str | None = None, count: int = 1) -> tuple[Mode, ...]:
    r"""The strongest modes in a frequency response.

    Around each peak the response is :math:`a/(f_n^2-f^2+2i\zeta f_n f) + b + c f` with complex a, b, c.

    Parameters
    ----------
    rec : Record
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
    size = abs(H).copy()
    found = []
    for _ in range(count):
        peak = int(np.argmax(size[1:])) + 1
        found.append(_fitted(f, H, peak))
        size[max(peak - _BAND, 0) : peak + _BAND + 1] = 0
    return tuple(found)


def _response(rec: Any, channel: str | None) -> Any:
    if channel is not None:
        return rec[channel]
    found = [c for c in rec.channels.values() if np.iscomplexobj(c.values) and not c.over_time]
    if not found:
        raise InputError("modes", ["the record has no complex channel over frequency; give channel= the name of a frequency response"])
    return found[0]


def _fitted(f: Any, H: Any, peak: int) -> Mode:
    from scipy.optimize import least_squares

    band = slice(max(peak - _BAND, 1), peak + _BAND + 1)
    x, y = f[band], H[band] / abs(H[peak])

    def parts(p: Any) -> Any:
        pole = 1 / (p[0] ** 2 - x**2 + 2j * np.exp(p[1]) * p[0] * x)
        basis = np.stack([pole * p[0] ** 2, np.ones_like(pole), (x - p[0]) / np.ptp(x) + 0j], axis=1)
        return basis @ np.linalg.lstsq(basis, y, rcond=None)[0]

    def left(p: Any) -> Any:
        rest = parts(p) - y
        return np.concatenate([rest.real, rest.imag])

    step = f[peak] - f[peak - 1]
    starts = [(f[peak] + s * step, np.log(d)) for s in (-0.4, 0.0, 0.4) for d in (3e-4, 1e-3, 1e-2)]
    fits = [least_squares(left, p, x_scale=(step, 1.0), xtol=1e-12, ftol=1e-12) for p in starts]
    best = min(fits, key=lambda fit: fit.cost)
    spare = len(best.fun) - _UNKNOWN
    # SciPy's derivatives are one-sided. Where nothing is left to tell the noise, nothing is known of the errors.
    errors = Information(best.jac, 1e-4).errors(np.sqrt(2 * best.cost / spare)) if spare > 0 else np.full(2, np.inf)
    damping = float(np.exp(best.x[1]))
    return Mode(float(best.x[0]), damping, float(errors[0]), float(damping * errors[1]))
