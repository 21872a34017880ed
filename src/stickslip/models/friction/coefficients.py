"""The numbers that several laws have, each described once."""

from __future__ import annotations

from stickslip.basics.quantities import at_least, positive, quantity

_SLIDING, _RESTING = (0.02, 0.6), (0.02, 1.0)
_ZERO = at_least(0.0)
#: Numbers that are forces where the load is 1, without a unit.
OF_LOAD = {"of_load": True}
#: For laws that divide by a coefficient: ``MU_PLUS | POSITIVE``.
POSITIVE = {"rule": positive}
MU0 = quantity("kinetic friction coefficient", "1", r"\mu_{0}", example=0.18, rule=positive, range=_SLIDING) | OF_LOAD
MU = quantity("friction coefficient", "1", r"\mu", example=0.3, range=_SLIDING) | OF_LOAD
F0 = quantity("static friction coefficient", "1", "f_{0}", example=0.21, rule=positive, range=_RESTING) | OF_LOAD
MU_PLUS = quantity("kinetic friction coefficient forwards", "1", r"\mu_{+}", example=0.15, rule=_ZERO, range=_SLIDING) | OF_LOAD
MU_MINUS = quantity("kinetic friction coefficient backwards", "1", r"\mu_{-}", example=0.21, rule=_ZERO, range=_SLIDING) | OF_LOAD
F_PLUS = quantity("static friction coefficient forwards", "1", "f_{+}", example=0.18, rule=_ZERO, range=_RESTING) | OF_LOAD
F_MINUS = quantity("static friction coefficient backwards", "1", "f_{-}", example=0.24, rule=_ZERO, range=_RESTING) | OF_LOAD
SIGMA0 = quantity("bristle stiffness", "N/m", r"\sigma_{0}", example=4e5, rule=positive, range=(2e4, 1e6), shown="kN/m")
SIGMA1 = quantity("bristle damping", "N s/m", r"\sigma_{1}", example=100.0, rule=_ZERO, range=(0.0, 400.0))
SIGMA2 = quantity("viscous friction of the bristles", "N s/m", r"\sigma_{2}", example=0.04, rule=_ZERO, range=(0.0, 2.0))
V_S = quantity("Stribeck velocity", "m/s", "v_{s}", example=2e-3, rule=positive, range=(2e-4, 2e-2), shown="mm/s")
VISCOUS = quantity("viscous friction", "N s/m", "c", example=0.4, rule=_ZERO, range=(0.0, 4.0))
QUADRATIC = quantity("quadratic friction", "N s^2/m^2", "d", example=2.0, rule=_ZERO, range=(0.0, 20.0))
WIDTH = quantity("width of the smoothed step", "m/s", r"\Delta v", example=1e-3, rule=positive, range=(1e-4, 1e-2), shown="mm/s")
