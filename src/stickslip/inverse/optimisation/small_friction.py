"""The largest possible speed of a robot in the limit of small friction, the reference for drives."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.errors import StickslipError
from stickslip.inverse.optimisation.constraints import Limit
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.tracks.tracks import grip_of

_POINTS = 32  # of Gauss's formula between two breaks of the drive
_SPEEDS = (1e-4, 1e-2, 1.0)  # at which friction has to be the same


def small_friction_limit(model: Any, limits: list[Limit], forwards: bool = True) -> tuple[float | None, str]:
    r"""The largest mean velocity of a robot with small Coulomb friction [m/s], and which limit it is; None, and why none is known.

    With bounded relative velocity :math:`|\dot\xi|\le U` it is :math:`\mu U\min(1,\mu_-/\mu_+)`; for the r.m.s. vibration velocity
    :math:`\sigma` of the body it is :math:`\sigma\sqrt{\mu_-/\mu_+}`, by the one-sided inequality of Chebyshev: where friction is small
    the time of sliding forwards is :math:`\mu_-/(\mu_-+\mu_+)` of the period.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(0.0626, 0.0095, ss.Harmonic(amplitude=5e-4, omega=200.0), ss.Coulomb(0.15, 0.25))
    >>> value, what = small_friction_limit(robot, [Limit("relative_velocity", -np.inf, 0.2)])
    >>> round(value / (robot.mass_ratio * 0.2), 12), what[:36]
    (1.0, 'small friction, relative velocity up')
    """
    ratio, why = _ratio(model)
    if ratio is None:
        return None, why
    ratio = ratio if forwards else 1.0 / ratio
    known = {limit.name: limit.high for limit in limits}
    U = known.get("relative_velocity", np.inf)
    if np.isfinite(U):
        return model.mass_ratio * U * min(1.0, ratio), f"small friction, relative velocity up to {U:g} m/s: mu U min(1, mu_minus/mu_plus)"
    sigma = model.mass_ratio * _rms(model.drive)
    return sigma * ratio**0.5, f"small friction, r.m.s. vibration velocity {sigma:.6g} m/s of the body: sigma sqrt(mu_minus/mu_plus)"


def _ratio(model: Any) -> tuple[float | None, str]:
    """Friction backwards over forwards; None with the reason where it is not constant, or not alone."""
    machine = machine_of(model)
    if machine.drive is None or not hasattr(model, "mass_ratio"):
        return None, f"no limit is known for a {type(model).__name__}: allowed is a robot of one body with a drive"
    if machine.has_inner_states:
        return None, f"no limit is known for {machine.law_names}: friction depends on more than the direction of sliding"
    if drive_of(machine.drive).vertical_acceleration is not None or grip_of(model.track) is not None:
        return None, "no limit is known where the load varies"
    try:
        if abs(float(model.track.along(model.gravity))) > 0.0:
            return None, "no limit is known on an incline: gravity acts along the track"
        load, law = model.load(0.0, 0.0), law_of(model)
        ahead, back = ([abs(float(law.sliding(s * v, load))) for v in _SPEEDS] for s in (1.0, -1.0))
    except (StickslipError, TypeError, AttributeError):
        return None, "no limit is known for this law"
    if np.ptp(ahead) > 1e-9 * ahead[0] or np.ptp(back) > 1e-9 * back[0] or not ahead[0] > 0.0:
        return None, f"no limit is known for {machine.law_names}: friction depends on the speed of sliding"
    return back[0] / ahead[0], ""


def _rms(drive: Any) -> float:
    """R.m.s. of the relative velocity, exact between breaks for all but very high harmonics [m/s]."""
    T, asked = float(drive.period), drive_of(drive)
    known = [*(float(s) for s in asked.breaks or ()), *(float(s) for s, _ in asked.jumps or ())]
    ends = np.unique(np.concatenate([np.linspace(0.0, T, 65), known]))
    x, w = np.polynomial.legendre.leggauss(_POINTS)
    half = 0.5 * np.diff(ends)
    times = 0.5 * (ends[:-1] + ends[1:]) + half * x[:, None]
    v = np.broadcast_to(drive.velocity(times), times.shape)
    return float(np.sqrt(np.sum(w[:, None] * v**2 * half) / T))
