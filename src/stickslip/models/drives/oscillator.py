"""One mode of vibration, q'' + 2 zeta omega_i q' + omega_i^2 q = f(t) from rest: in closed form for a sine and for a record."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Array, Numeric


def sine_from_rest(t: Numeric, omega: Numeric, free: Any, damping: Numeric) -> Any:
    r"""Answer to a force sin(omega t) that begins at t = 0: the braces of Eq. 3.6, corrected.

    .. math:: B_i\left\{e^{-\zeta_i\omega_i t}\left[\sin\varphi_i\cos\omega_d t + \frac{\omega_i}{\omega_d}\left(\zeta_i\sin\varphi_i
        - \frac{\omega}{\omega_i}\cos\varphi_i\right)\sin\omega_d t\right] + \sin(\omega t-\varphi_i)\right\}

    The paper prints the first cosine with omega_i instead of the damped frequency :math:`\omega_d=\omega_i\sqrt{1-\zeta_i^2}`.

    Parameters
    ----------
    t : array
        Times [s].
    omega, free, damping : float or array
        Angular frequency of the force, and omega_i and zeta_i of the mode [rad/s, rad/s, -]; they broadcast with `t`.

    Returns
    -------
    array
        q(t), per unit of force over modal mass [s^2].

    Examples
    --------
    >>> q = sine_from_rest([0.0, 0.1, 100.0], omega=2.0, free=3.0, damping=0.1)
    >>> [f"{value:.6f}" for value in q]
    ['0.000000', '0.000326', '-0.187258']
    """
    import numpy as np

    t = np.asarray(t, float)
    size = 1 / np.hypot(free**2 - omega**2, 2 * damping * free * omega)
    lag = np.arctan2(2 * damping * free * omega, free**2 - omega**2)
    damped = free * np.sqrt(1 - damping**2)
    swing = free / damped * (damping * np.sin(lag) - omega / free * np.cos(lag)) * np.sin(damped * t)
    return size * (np.exp(-damping * free * t) * (np.sin(lag) * np.cos(damped * t) + swing) + np.sin(omega * t - lag))


def modal_response(t: Array, force: Any, free: Any, damping: Array) -> Any:
    """Answer of several modes, at rest at the first time, to a force that is linear between its samples: exact, whatever the steps.

    Parameters
    ----------
    t : array (times,)
        Ascending times [s].
    force : array (times,)
        The force there.
    free, damping : array (modes,)
        omega_i and zeta_i [rad/s, -].

    Returns
    -------
    array (times, modes)
        q(t), per unit of force over modal mass [s^2].

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 5.0, 2001)
    >>> q = modal_response(t, np.sin(2.0 * t), np.array([3.0]), np.array([0.1]))[:, 0]
    >>> bool(abs(q - sine_from_rest(t, 2.0, 3.0, 0.1)).max() < 1e-6)
    True
    """
    import numpy as np

    rate = free * (-damping + 1j * np.sqrt(1 - damping**2))  # q = Im(y)/omega_d with y' = rate y + f
    step = np.diff(t)[:, None]
    decay = np.exp(rate * step)
    whole, ramp = step * _phi(rate * step, 1), step * _phi(rate * step, 2)
    gain = (whole - ramp) * force[:-1, None] + ramp * force[1:, None]
    y = np.zeros((len(t), np.size(free)), complex)
    for k in range(len(step)):
        y[k + 1] = decay[k] * y[k] + gain[k]
    return y.imag / rate.imag


def _phi(z: Any, order: int) -> Any:
    """(e^z - 1)/z for order 1, (e^z - 1 - z)/z^2 for order 2; by its series where that would cancel."""
    import numpy as np

    small = abs(z) < 0.5
    near, far = np.where(small, z, 0.0), np.where(small, 1.0, z)
    series = np.zeros_like(near)
    for k in range(16, -1, -1):  # sum of z^k/(k + order)!, Horner
        series = 1 + near * series / (k + order + 1)
    whole = (np.exp(far) - 1) / far if order == 1 else (np.exp(far) - 1 - far) / far**2
    return np.where(small, series / order, whole)
