"""Dry friction from a table: a measured curve of the friction coefficient against speed."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere
from stickslip.basics.maths import where
from stickslip.basics.quantities import at_least, quantity
from stickslip.models.friction.coefficients import F_MINUS, F_PLUS, MU_MINUS, MU_PLUS
from stickslip.models.friction.law import Law, field_numbers
from stickslip.models.friction.sides import by_side, static


@dataclass(frozen=True, eq=False)
class Tabulated(Law):
    r"""Anisotropic dry friction that follows a table of coefficients against speed: a set-valued law.

    .. math:: R = \pm N h_\pm(|v|) \;(v \ne 0), \qquad -f_- N \le R \le f_+ N \;(v = 0)

    Between the knots of the table h is a cubic with a continuous slope that never overshoots (Fritsch and Carlson's); below the first
    and above the last knot it is constant. For a formula of your own write a class with `sliding` and `breakaway` instead.

    Parameters
    ----------
    speed : tuple of float
        Speeds at the knots, rising, zero or more [m/s].
    mu_plus, mu_minus : tuple of float
        Friction coefficients at the knots, forwards and backwards [-].
    f_plus, f_minus : float, optional
        Static (break-away) coefficients [-]; ``None`` means the first of the table.

    References
    ----------
    F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation, SIAM J. Numerical Analysis 17 (1980) 238-246;
    the slopes are those of F. N. Fritsch, J. Butland, SIAM J. Scientific and Statistical Computing 5 (1984) 300-304.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.Tabulated(speed=(0.0, 1e-3, 1e-2, 0.1), mu_plus=(0.18, 0.16, 0.15, 0.17), mu_minus=(0.24, 0.22, 0.21, 0.23))
    >>> [round(law.sliding(v, load=10.0), 9) for v in (1e-3, -1e-2, 5.0)]
    [1.6, -2.1, 1.7]
    >>> law.breakaway(load=10.0)
    (-2.4, 1.8)
    """

    speed: tuple[float, ...] = field(
        metadata=quantity(
            "speed of the table",
            "m/s",
            "h",
            example=(0.0, 1e-3, 4e-3, 2e-2, 0.1),
            rule=at_least(0.0),
            allowed="several speeds, zero or more and rising [m/s]",
        )
    )
    mu_plus: tuple[float, ...] = field(
        metadata=MU_PLUS | {"example": (0.18, 0.165, 0.151, 0.15, 0.17), "allowed": "several coefficients, zero or more"}
    )
    mu_minus: tuple[float, ...] = field(
        metadata=MU_MINUS | {"example": (0.24, 0.225, 0.211, 0.21, 0.22), "allowed": "several coefficients, zero or more"}
    )
    f_plus: float | None = field(default=None, metadata=F_PLUS | {"example": None})
    f_minus: float | None = field(default=None, metadata=F_MINUS | {"example": None})

    def _check(self, problems: Problems) -> None:
        speed = field_numbers(self.speed)
        _check_rising(speed, problems)
        if isinstance(self.speed, tuple) and len(self.speed) < 2:
            problems.add(f"speed has {len(self.speed)} values; allowed is a table of two or more; type for example speed=(0.0, 0.1)")
        for side in ("plus", "minus"):
            mu, f = field_numbers(getattr(self, f"mu_{side}")), getattr(self, f"f_{side}")
            if mu and speed and len(mu) != len(speed):
                problems.add(f"mu_{side} has {len(mu)} values and speed {len(speed)}; allowed is one coefficient for every speed")
            if mu and f is not None and not everywhere(f >= mu[0]):
                problems.add(
                    f"f_{side} = {describe(f)} is below mu_{side}[0] = {describe(mu[0])}; allowed is f_{side} >= mu_{side}[0]; "
                    f"type f_{side}=None for equal ones"
                )

    def coefficient(self, v: Numeric) -> Any:
        """Friction coefficient, positive both ways [-]."""
        speed, x = abs(v), self.speed
        plus, minus = _pieces(x, self.mu_plus), _pieces(x, self.mu_minus)
        pieces = [tuple(by_side(v, a, b) for a, b in zip(*both, strict=True)) for both in zip(plus, minus, strict=True)]
        chosen, start = pieces[0], x[0]
        for piece, knot in zip(pieces[1:], x, strict=True):
            chosen = tuple(where(speed > knot, new, old) for new, old in zip(piece, chosen, strict=True))
            start = where(speed > knot, knot, start)
        c0, c1, c2, c3 = chosen
        s = speed - start
        return c0 + s * (c1 + s * (c2 + s * c3))

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R while sliding with velocity v [N]."""
        return by_side(v, 1.0, -1.0) * self.coefficient(v) * load

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """Static friction limits (backward, forward) [N]."""
        return -static(self.f_minus, self.mu_minus[0]) * load, static(self.f_plus, self.mu_plus[0]) * load

    def velocity_scale(self) -> Any:
        """The velocity over which friction changes: the first interval of the table [m/s]."""
        return self.speed[1] - self.speed[0]


def _check_rising(speed: tuple[Any, ...], problems: Problems) -> None:
    """A table is a function of speed."""
    for k in range(1, len(speed)):
        if everywhere(speed[k] > speed[k - 1]):
            continue
        given = f"speed[{k}] = {describe(speed[k])} after speed[{k - 1}] = {describe(speed[k - 1])}"
        if everywhere(speed[k] == speed[k - 1]):
            problems.add(f"the table is not single-valued: {given}; allowed is one coefficient for a speed; remove one, or put their mean")
        else:
            problems.add(f"the table does not rise: {given}; allowed are rising speeds; sort the table by speed")


def _pieces(x: tuple[Any, ...], y: tuple[Any, ...]) -> list[tuple[Any, Any, Any, Any]]:
    """Coefficients (c0, c1, c2, c3) in s = speed - knot: constant below, a cubic for each interval, constant above."""
    h = [b - a for a, b in pairwise(x)]
    rise = [(b - a) / step for (a, b), step in zip(pairwise(y), h, strict=True)]
    slope = _slopes(h, rise)
    pieces = [(y[0], 0.0, 0.0, 0.0)]
    for k, step in enumerate(h):
        c2 = (3.0 * rise[k] - 2.0 * slope[k] - slope[k + 1]) / step
        c3 = (slope[k] + slope[k + 1] - 2.0 * rise[k]) / (step * step)
        pieces.append((y[k], slope[k], c2, c3))
    return [*pieces, (y[-1], 0.0, 0.0, 0.0)]


def _slopes(h: list[Any], rise: list[Any]) -> list[Any]:
    """Slopes at the knots: zero at turning points, else a weighted harmonic mean of the neighbours'."""
    if len(h) == 1:
        return [rise[0], rise[0]]
    inner = [_middle(h[k], h[k + 1], rise[k], rise[k + 1]) for k in range(len(h) - 1)]
    return [_end(h[0], h[1], rise[0], rise[1]), *inner, _end(h[-1], h[-2], rise[-1], rise[-2])]


def _middle(ha: Any, hb: Any, a: Any, b: Numeric) -> Any:
    wa, wb = 2.0 * hb + ha, hb + 2.0 * ha
    below = where(a * b > 0, wa * b + wb * a, 1.0)
    return where(a * b > 0, (wa + wb) * a * b / below, 0.0)


def _end(ha: Any, hb: Any, a: Any, b: Numeric) -> Any:
    """One-sided slope of three points, made not to overshoot."""
    slope = ((2.0 * ha + hb) * a - ha * b) / (ha + hb)
    steep = where(a * b > 0, slope, where(abs(slope) > 3.0 * abs(a), 3.0 * a, slope))
    return where(slope * a > 0, steep, 0.0)
