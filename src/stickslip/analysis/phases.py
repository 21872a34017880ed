r"""Mean velocities of Coulomb robots with two- and three-phase drives, on paper.

The track is level (or folded), :math:`\mu` is the mass ratio and :math:`\mu_\pm` are the friction coefficients.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError
from stickslip.models.drives import ThreePhase, TwoPhase

_ROUNDING = 1 + 1e-12  # a body that is held exactly at its break-away is held


def two_phase(drive: TwoPhase, mass_ratio: Any, mu_plus: Any, mu_minus: Any, gravity: Numeric = 9.81) -> Any:
    r"""Mean velocity with a two-phase drive; J = mu (u1 + u2) is the jump of the body's velocity.

    .. math:: V = \frac{J^2}{2g(t_1+t_2)}\Bigl(\frac{1}{\mu_+}-\frac{1}{\mu_-}\Bigr), \qquad
        V = \frac{Jt_2-\tfrac12\mu_+g\,t_2^2\,(1+\mu_+/\mu_-)}{t_1+t_2}

    The first is for a body that comes to rest in both phases, the second for one that still slides forwards when the phase of -u2 ends;
    the mirror image of the second is for one that still slides backwards when the phase of +u1 ends. One of them always holds: a body
    that slides through one phase has lost less there than the other phase can take.

    Parameters
    ----------
    drive : TwoPhase
        Its numbers may be arrays.
    mass_ratio : float or array
        mu = m/(M + m) [-].
    mu_plus, mu_minus : float or array
        Friction coefficients forwards and backwards [-].
    gravity : float or array
        Acceleration of gravity across the track [m/s^2].

    Returns
    -------
    float or array
        V [m/s].

    Examples
    --------
    >>> round(float(two_phase(TwoPhase(stroke=0.01, u1=0.1, u2=0.1), 0.1315, 0.15, 0.25)), 12)
    0.000470057764
    >>> round(float(two_phase(TwoPhase(stroke=0.01, u1=0.05, u2=0.4), 0.1315, 0.15, 0.25)), 12)
    0.003305
    """
    _check(drive, TwoPhase)
    plus, minus = np.asarray(mu_plus * gravity), np.asarray(mu_minus * gravity)
    J, t1, t2 = mass_ratio * (drive.u1 + drive.u2), drive.t1, drive.t2
    rests = 0.5 * J**2 * (1 / plus - 1 / minus)
    slides_on = J * t2 - 0.5 * plus * t2**2 * (1 + plus / minus)
    slides_back = 0.5 * minus * t1**2 * (1 + minus / plus) - J * t1
    way = np.where((plus * t2 >= J) & (minus * t1 >= J), rests, np.where(plus * t2 <= minus * t1, slides_on, slides_back))
    return (way / (t1 + t2))[()]


def three_phase(drive: ThreePhase, mass_ratio: Any, mu_plus: Any, mu_minus: Any, gravity: Numeric = 9.81) -> Any:
    r"""Mean velocity with a three-phase drive that holds the body back in its phases of +w1 and +w3 and throws it forwards in that of -w2.

    .. math:: V = \frac{v_2^2}{2T}\Bigl(\frac{1}{a_2}+\frac{1}{a_3}\Bigr), \quad a_2 = \mu w_2-\mu_+g, \quad a_3 = \mu w_3+\mu_+g, \quad
        v_2 = a_2\,\frac{u_1+u_3}{w_2}

    if it comes to rest in the phase of +w3. If it still slides then, what is left of its velocity is braked by
    :math:`a_1 = \mu w_1+\mu_+g` in the next period's first phase, which is always long enough. For :math:`w_2\to\infty` and
    :math:`w_1 = w_3 = \mu_-g/\mu` this is :math:`V = \frac{\mu_-}{\mu_-+\mu_+}\sqrt{2\mu L\mu_-g}` with the stroke L.

    Parameters
    ----------
    drive : ThreePhase
        Its numbers may be arrays.
    mass_ratio, mu_plus, mu_minus, gravity : float or array
        As for `two_phase`.

    Returns
    -------
    float or array
        V [m/s]; 0 where nothing slides, NaN where the body slides backwards.

    Examples
    --------
    >>> drive = ThreePhase(u1=0.3, w1=10.0, w2=60.0, w3=12.0)
    >>> round(float(three_phase(drive, 0.1315, 0.15, 0.25)), 12)
    0.015990705704
    """
    _check(drive, ThreePhase)
    plus, minus = np.asarray(mu_plus * gravity), np.asarray(mu_minus * gravity)
    a1, a2, a3 = mass_ratio * drive.w1 + plus, mass_ratio * drive.w2 - plus, mass_ratio * drive.w3 + plus
    v2 = a2 * (drive.u1 + drive.u3) / drive.w2
    v3 = np.maximum(v2 - a3 * drive.u3 / drive.w3, 0.0)
    way = 0.5 * (v2**2 / np.where(a2 > 0, a2, 1.0) + (v2**2 - v3**2) / a3 + v3**2 / a1)
    held = mass_ratio * np.maximum(drive.w1, drive.w3) <= minus * _ROUNDING
    return np.where(held, np.where(a2 > 0, way / drive.period, 0.0), np.nan)[()]


def _check(drive: Any, kind: type) -> None:
    if not isinstance(drive, kind):
        raise InputError(kind.__name__, [f"drive is a {type(drive).__name__}; allowed is a {kind.__name__}; type drive=robot.drive"])
