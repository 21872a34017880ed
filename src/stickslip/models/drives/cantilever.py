"""A clamped beam with a mass at its tip: eigenvalues, mode shapes and modal masses (Eqs 3.4 and 3.5).

Everything here is about the *unit beam*: lengths in units of L, masses in units of the beam's mass rho A L. Then one number is left,
the tip mass ratio R, and a frequency is b with ``omega = b**2 sqrt(EI/(rho A L**4))``.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import Numbers, explains_arguments
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import checked_number
from stickslip.basics.quantities import at_least

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@explains_arguments
def cantilever_eigenvalues(tip_mass_ratio: Numbers, n: int) -> NDArray[np.float64]:
    r"""Eigenvalues :math:`\beta_i L` of a clamped beam with a mass at its tip: the first `n` roots of Eq. 3.5.

    .. math:: 1 + \cos b\cosh b + R\,b\,(\cos b\sinh b - \sin b\cosh b) = 0, \qquad R = \frac{m}{\rho A L}

    No root can be missed. The force that moves the tip with amplitude 1, K - m omega^2, decreases strictly with omega^2 from +infinity
    to -infinity between two frequencies of the beam whose tip is pinned (tan b = tanh b). Each of these intervals, and the first one
    that begins at 0, therefore contains exactly one root, and the i-th interval contains the i-th root. The roots are bisected down to
    the last bit.

    Parameters
    ----------
    tip_mass_ratio : float or array
        Tip mass over the mass of the beam, R [-], zero or more.
    n : int
        How many.

    Returns
    -------
    array
        Of shape (n,), or the shape of `tip_mass_ratio` with n after it, ascending. With b = beta_i L the i-th angular frequency is
        b^2 sqrt(EI / (rho A L^4)).

    References
    ----------
    The count of roots by the fall of a dynamic stiffness: W. H. Wittrick, F. W. Williams, A general algorithm for computing natural
    frequencies of elastic structures, Quarterly Journal of Mechanics and Applied Mathematics 24 (1971) 263-284.

    Examples
    --------
    >>> cantilever_eigenvalues(1.0, 3).round(9).tolist()
    [1.24791741, 4.031139437, 7.134132241]
    >>> cantilever_eigenvalues([0.0, 10.0], 1).round(6).tolist()
    [[1.875104], [0.735782]]
    """
    import numpy as np

    ratio = np.asarray(_checked(tip_mass_ratio, n), float)
    return _roots_of_one(float(ratio), n) if ratio.ndim == 0 else _roots(ratio, n)


@functools.lru_cache(maxsize=64)
def _roots_of_one(ratio: float, n: int) -> Any:
    """The roots of one beam, remembered: whoever drags its voltage asks for them again and again."""
    import numpy as np

    roots = _roots(np.asarray(ratio), n)
    roots.setflags(write=False)
    return roots


def _roots(ratio: Any, n: int) -> Any:
    """The roots for every ratio, in a last axis of length n."""
    import numpy as np

    ratio = ratio[..., None]
    ends = _pinned_eigenvalues(n)
    falls = (-1.0) ** np.arange(n)  # sign of Eq. 3.5 at the left end of each interval
    low, high = (np.broadcast_to(e, (*ratio.shape[:-1], n)) for e in (ends[:-1], ends[1:]))
    while True:
        middle = 0.5 * (low + high)
        if np.all((middle <= low) | (middle >= high)):
            return middle
        before = falls * _characteristic(middle, ratio) > 0
        low, high = np.where(before, middle, low), np.where(before, high, middle)


def _checked(tip_mass_ratio: Numeric, n: Any) -> Any:
    """The ratio as a number; what is wrong with both arguments at once."""
    problems = Problems("cantilever_eigenvalues")
    allowed, typed = "a finite number, zero or more", "tip_mass_ratio=1.2"
    ratio = checked_number("tip_mass_ratio", tip_mass_ratio, problems, at_least(0.0), allowed, typed)
    problems.whole("n", n, 1, example=5, most=10_000)
    problems.check()
    return ratio


def _pinned_eigenvalues(n: int) -> Any:
    """0 and the first n roots of tan b = tanh b: one on each branch of the tangent, between i pi and i pi + pi/4."""
    import numpy as np

    branch = np.pi * np.arange(n + 1)
    b = branch + np.pi / 4
    for _ in range(8):  # b = i pi + atan(tanh b) contracts at least 1000-fold
        b = branch + np.arctan(np.tanh(b))
    b[0] = 0.0
    return b


def _characteristic(b: Any, ratio: Any) -> Any:
    """Eq. 3.5 over cosh b, which neither overflows nor, for small b, cancels."""
    import numpy as np

    decay = np.exp(-b)
    sech = 2 * decay / (1 + decay * decay)
    small = np.minimum(b, 1.0)
    power = small**4
    # cos sinh - sin cosh as a power series: its derivative is -2 sin sinh = -2 (b^2 - b^6/90 + b^10/113400 - 128 b^14/14! + ...)
    series = -2 * small**3 * (1 / 3 - power * (1 / 630 - power * (1 / 1247400 - power * (128 / 1307674368000))))
    return sech + np.cos(b) + ratio * b * np.where(b < 1.0, series * sech, np.cos(b) * np.tanh(b) - np.sin(b))


def mode_shape(b: Numeric, s: Numeric, derivative: int = 0) -> Any:
    r"""Shape of a clamped beam that vibrates at frequency b with no moment at its tip (Eqs 3.4 and 3.5), or its derivative.

    .. math:: \varphi(s) = \cosh bs - \cos bs - r(\sinh bs - \sin bs), \qquad r = \frac{\cosh b + \cos b}{\sinh b + \sin b}

    For an eigenvalue b this is the mode, the bracket of Eq. 3.6 with its sign changed; at any other frequency it is the shape under a
    force at the tip. Written with exponentials that only decay, it overflows for no b.

    Parameters
    ----------
    b : float or array
        Frequency parameter beta L [-].
    s : float or array
        Place x/L [-], from 0 to 1; it broadcasts with `b`.
    derivative : int
        Which derivative with respect to s.

    Returns
    -------
    array
        The shape [-].

    Examples
    --------
    >>> b = cantilever_eigenvalues(0.0, 1)
    >>> [float(mode_shape(b, s)[0].round(6)) for s in (0.0, 0.5, 1.0)]
    [0.0, 0.679046, 2.0]
    """
    import numpy as np

    beta: Any = np.asarray(b)
    x: Any = np.asarray(s)
    decay = np.exp(-beta)
    q = (np.sin(beta) - np.cos(beta) - decay) / (1 - decay**2 + 2 * decay * np.sin(beta))
    rising, falling = q * np.exp(-beta * (1 - x)), (1 - q * decay) * np.exp(-beta * x)
    c, sn = np.cos(beta * x), np.sin(beta * x)
    cosine, sine = ((c, sn), (-sn, c), (-c, -sn), (sn, -c))[derivative % 4]
    return beta**derivative * (rising + (-1) ** derivative * falling - cosine + (1 - 2 * q * decay) * sine)


def modal_mass(b: Numeric, tip_mass_ratio: Numeric) -> Any:
    r"""Modal mass of `mode_shape`, with the tip mass, in closed form.

    .. math:: m_i = \int_0^1 \varphi_i^2\,ds + R\,\varphi_i(1)^2 = 1 + \frac{R}{4}\,\varphi_i(1)^2

    Parameters
    ----------
    b : float or array
        Eigenvalues beta_i L [-].
    tip_mass_ratio : float or array
        R [-].

    Returns
    -------
    array
        In units of the beam's mass [-].

    Examples
    --------
    >>> modal_mass(cantilever_eigenvalues(0.0, 2), 0.0).tolist()
    [1.0, 1.0]
    """
    return 1 + tip_mass_ratio * mode_shape(b, 1.0) ** 2 / 4
