"""Closed forms for the mechanisms: the forced oscillator that never stops, and stick-slip on a belt."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError

_PHASES = 400  # of a half-cycle, at which the velocity must keep its sign


def den_hartog_amplitude(ratio: Array, friction: Array) -> Array:
    r"""Amplitude of a harmonically forced oscillator with Coulomb friction that never stops.

    .. math:: \frac{X}{P/k} = \sqrt{V^2 - (F/P)^2\,U^2}, \qquad V = \frac{1}{1-r^2}, \quad U = \frac{\tan(\pi/2r)}{r}

    With :math:`r = \omega\sqrt{m/k}`, without viscous damping. It moves to and fro without a stop as long as at its turning points
    the net force exceeds friction, :math:`X/(P/k) \ge (F/P)/r^2`, and its velocity keeps its sign between them.

    Parameters
    ----------
    ratio : float or array
        r, frequency of the force over the natural frequency [-].
    friction : float or array
        F/P, friction force over amplitude of the force [-].

    Returns
    -------
    float or array
        k X / P [-]; NaN where the mass stops on its way, or at resonance without end.

    References
    ----------
    J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1930) 107-115.

    Examples
    --------
    >>> round(float(den_hartog_amplitude(0.7, 0.3)), 14)
    1.88569985041425
    """
    r, f = np.broadcast_arrays(np.asarray(ratio, float), np.asarray(friction, float))
    if not (np.all(r > 0) and np.all(f >= 0)):
        raise InputError("den_hartog_amplitude", ["ratio must be above 0 and friction 0 or more; type den_hartog_amplitude(0.7, 0.3)"])
    with np.errstate(divide="ignore", invalid="ignore"):
        V, U = 1 / (1 - r**2), np.tan(0.5 * np.pi / r) / r
        X = np.sqrt(V**2 - (f * U) ** 2)
        tau = np.linspace(0.0, np.pi, _PHASES + 2)[1:-1] / r[..., None]
        phase = np.arctan2(-f * U / V, X / V)  # V cos = X, V sin = -f U
        swing = (V * r)[..., None] * np.sin(r[..., None] * tau + phase[..., None])
        v = -swing + f[..., None] * np.sin(tau) - (r * f * U)[..., None] * np.cos(tau)
        never_stops = (X * r**2 >= f) & np.all(v < 0, axis=-1)
    return np.where(never_stops, X, np.nan)[()]


def belt_period(mass: Array, stiffness: Array, speed: Array, kinetic: Array, static: Array) -> tuple[Array, Array]:
    r"""How long a block on a belt sticks and slips in each cycle, with a higher static friction.

    .. math:: t_{stick} = \frac{2D}{u}, \qquad t_{slip} = \frac{2}{\omega}\left(\pi - \arctan\frac{D\,\omega}{u}\right), \qquad
              D = \frac{F_s - F_k}{k}

    Parameters
    ----------
    mass, stiffness, speed : float or array
        Mass [kg], stiffness [N/m], speed u of the belt [m/s].
    kinetic, static : float or array
        Friction forces F_k and F_s [N].

    Returns
    -------
    tuple
        t_stick and t_slip [s]; their sum is the period.

    Examples
    --------
    >>> stick, slip = belt_period(mass=1.0, stiffness=2.0, speed=0.1, kinetic=1.0, static=1.5)
    >>> round(float(stick + slip), 13)
    7.6112592541013
    """
    D, omega = (np.asarray(static) - kinetic) / stiffness, np.sqrt(np.asarray(stiffness, float) / mass)
    return 2 * D / speed, 2 / omega * (np.pi - np.arctan(D * omega / speed))
