"""Base classes of laws with a kinetic and a static coefficient for each direction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere
from stickslip.models.friction.coefficients import F_MINUS, F_PLUS, MU_MINUS, MU_PLUS, POSITIVE, SIGMA0
from stickslip.models.friction.law import Law
from stickslip.models.friction.sides import static


@dataclass(frozen=True, eq=False)
class TwoSided(Law):
    """Kinetic and static coefficients forwards and backwards."""

    mu_plus: float = field(metadata=MU_PLUS)
    mu_minus: float = field(metadata=MU_MINUS)
    f_plus: float | None = field(metadata=F_PLUS)
    f_minus: float | None = field(metadata=F_MINUS)

    def _check(self, problems: Problems) -> None:
        for side in ("plus", "minus"):
            f, mu = getattr(self, f"f_{side}"), getattr(self, f"mu_{side}")
            try:
                good = f is None or everywhere(f >= mu)
            except (TypeError, ValueError):  # a number that was already reported, or shapes that the robot reports
                continue
            if not good:
                problems.add(
                    f"f_{side} = {describe(f)} is below mu_{side} = {describe(mu)}; allowed is f_{side} >= mu_{side} "
                    f"(static friction is not below kinetic friction); type f_{side}=None for equal ones"
                )

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """Static friction limits (backward, forward) [N] (of Coulomb: Eq. 2.4, fourth line)."""
        return -static(self.f_minus, self.mu_minus) * load, static(self.f_plus, self.mu_plus) * load


@dataclass(frozen=True, eq=False)
class Dry(TwoSided):
    """The static coefficients may be left out."""

    f_plus: float | None = field(default=None, metadata=F_PLUS)
    f_minus: float | None = field(default=None, metadata=F_MINUS)


class Elastic(Law):
    """Laws whose inner state is a deflection of stiffness sigma0."""

    def scale(self: Any, load: Numeric) -> Any:
        """A typical deflection, against which the error of z is measured [m]."""
        return 0.5 * (self.mu_plus + self.mu_minus) * load / self.sigma0


@dataclass(frozen=True, eq=False)
class Bristles(Elastic, TwoSided):
    """Bristles of stiffness sigma0, whose equations divide by every coefficient."""

    mu_plus: float = field(metadata=MU_PLUS | POSITIVE)
    mu_minus: float = field(metadata=MU_MINUS | POSITIVE)
    f_plus: float | None = field(metadata=F_PLUS | POSITIVE)
    f_minus: float | None = field(metadata=F_MINUS | POSITIVE)
    sigma0: float = field(metadata=SIGMA0)


class Fading(Law):
    """Laws with a Stribeck velocity v_s."""

    def velocity_scale(self: Any) -> Any:
        """The velocity over which friction changes, which limits the steps near v = 0 [m/s]."""
        return self.v_s
