"""The clamped beam of `cantilever` under a bending couple on 0 < s < l0: static, by modes, and in closed form (Eqs 3.1, 3.3 and 3.7).

Units are those of the unit beam, couples in units of EI/L.
"""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.models.drives.cantilever import cantilever_eigenvalues, modal_mass, mode_shape


def tip_participation(b: Numeric, tip_mass_ratio: Numeric, end: Numeric) -> Any:
    """Each mode's share in the tip's motion for a couple on 0 < s < `end`: Y_i(1) Y_i'(end) over the modal mass [-].

    A patch pushes with a couple at its end and the opposite one at s = 0, where the clamp takes it.

    Examples
    --------
    >>> b = cantilever_eigenvalues(1.0, 40)
    >>> round(float((tip_participation(b, 1.0, 0.4) / b**4).sum()), 5)  # the static deflection, end (1 - end/2)
    0.32
    """
    return mode_shape(b, 1.0) * mode_shape(b, end, derivative=1) / modal_mass(b, tip_mass_ratio)


def modal_amplitudes(frequency: Numeric, tip_mass_ratio: Numeric, end: Numeric, n: int, damping: Numeric = 0.0) -> Any:
    r"""Complex amplitudes of the first `n` modes for a unit couple on 0 < s < `end`: the C_i B_i of Eq. 3.7.

    .. math:: \frac{\varphi_i'(l_0)/m_i}{\omega_i^2 - \omega^2 + 2j\zeta_i\omega_i\omega}

    Parameters
    ----------
    frequency : float or array
        Angular frequency omega over sqrt(EI / (rho A L^4)) [-], where the modes have b_i^2.
    tip_mass_ratio, end : float or array
        R and l0/L [-].
    n : int
        Number of modes.
    damping : float or array
        Damping ratios zeta_i; an array has the modes as its last axis [-].

    Returns
    -------
    array
        Of the shape of the arguments with n after it: what multiplies `mode_shape`. Its angle is the phase before the couple.

    Examples
    --------
    >>> abs(modal_amplitudes(0.36, 1.0, 0.4, 3)).round(4).tolist()
    [0.3399, 0.0111, 0.002]
    """
    import numpy as np

    ratio, edge, omega = (np.asarray(a, float)[..., None] for a in (tip_mass_ratio, end, frequency))
    b = cantilever_eigenvalues(tip_mass_ratio, n)
    free = b**2
    push = mode_shape(b, edge, derivative=1) / modal_mass(b, ratio)
    return push / (free**2 - omega**2 + 2j * damping * free * omega)


def tip_by_modes(frequency: Numeric, tip_mass_ratio: Numeric, end: Numeric, n: int, damping: Numeric = 0.0) -> Any:
    """Complex amplitude u(1)/M0 of the tip: the sum of the first `n` modes (Eq. 3.7). Arguments as for `modal_amplitudes`.

    Examples
    --------
    >>> f"{complex(tip_by_modes(0.36, 1.0, 0.4, 200)).real:.6f}", f"{tip_in_closed_form(0.6, 1.0, 0.4):.6f}"
    ('0.338267', '0.338267')
    """
    b = cantilever_eigenvalues(tip_mass_ratio, n)
    return (modal_amplitudes(frequency, tip_mass_ratio, end, n, damping) * mode_shape(b, 1.0)).sum(axis=-1)


def tip_in_closed_form(b: Numeric, tip_mass_ratio: Numeric, end: Numeric) -> Any:
    r"""The same without damping and without modes: the boundary value problem itself, solved.

    .. math:: \frac{u(1)}{M_0} = -\frac{\varphi_b'(l_0)}{\varphi_b'''(1) + R\,b^4\varphi_b(1)}

    By reciprocity the tip's answer to a couple at l0 is the slope at l0 under a unit force at the tip, and that has the shape
    `mode_shape` for any b. Structural damping with loss factor eta is a complex b, b^4 = omega^2/(1 + j eta), and a couple divided by
    1 + j eta.

    Parameters
    ----------
    b : float, complex or array
        Square root of the angular frequency of the unit beam, b > 0. Digits are lost as 1/b^2 when b is small.
    tip_mass_ratio, end : float or array
        R and l0/L [-].

    Returns
    -------
    array
        u(1)/M0 [-].

    Examples
    --------
    >>> print(f"{tip_in_closed_form(0.6, 1.0, 0.4):.11f}")
    0.33826656453
    """
    return -mode_shape(b, end, derivative=1) / (mode_shape(b, 1.0, derivative=3) + tip_mass_ratio * b**4 * mode_shape(b, 1.0))
