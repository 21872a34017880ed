"""What can be dragged: every number of the page once, with its letter, units, the reach of its slider and what is allowed."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["PARAMETERS", "Parameter"]


@dataclass(frozen=True)
class Parameter:
    """One number of the page; everything is in SI units but what is shown.

    Parameters
    ----------
    name : str
        Its name in messages, in the address and in the page.
    symbol, label : str
        Its letter and what it is.
    default, low, high : float
        Where the slider stands at first, and its two ends.
    unit : str
        The unit that is shown.
    factor : float
        The shown number is the value times this.
    least, most : float
        What is allowed, however it is typed.

    Examples
    --------
    >>> A = PARAMETERS["amplitude"]
    >>> A.shown(A.default)
    '0.5525 mm'
    """

    name: str
    symbol: str
    label: str
    default: float
    low: float
    high: float
    unit: str = ""
    factor: float = 1.0
    least: float = 0.0
    most: float = 1e9

    def shown(self, value: float) -> str:
        """A value as a person reads it."""
        return f"{value * self.factor:.6g} {self.unit}".rstrip()

    def allowed(self) -> str:
        """What may be given."""
        return f"{self.shown(self.least)} to {self.shown(self.most)}"


_KILO, _MEGA = 1e3, 1e6
_DEGREES = 180 / math.pi

_ALL = (
    # ---- drives ----
    Parameter("amplitude", "A", "amplitude of the inner mass", 5.525e-4, 0.0, 1.6e-3, "mm", _KILO, 0.0, 0.1),
    Parameter("omega", "ω", "angular frequency", 65.4 * math.pi, 60.0, 400.0, "rad/s", 1.0, 1.0, 1e5),
    Parameter("second_amplitude", "A₂", "amplitude of the second harmonic", 1e-4, 0.0, 5e-4, "mm", _KILO, 0.0, 0.1),
    Parameter("second_phase", "φ₂", "phase of the second harmonic", -0.5 * math.pi, -math.pi, math.pi, "°", _DEGREES, -10.0, 10.0),
    Parameter("stroke", "L", "stroke of the inner mass", 0.01, 1e-3, 0.03, "mm", _KILO, 1e-7, 1.0),
    Parameter("u1", "u₁", "relative speed forwards", 0.05, 0.01, 0.5, "m/s", 1.0, 1e-5, 100.0),
    Parameter("u2", "u₂", "relative speed backwards", 0.4, 0.01, 1.0, "m/s", 1.0, 1e-5, 100.0),
    Parameter("three_u1", "u₁", "speed in the first phase", 0.3, 0.05, 1.0, "m/s", 1.0, 1e-5, 100.0),
    Parameter("w1", "w₁", "acceleration in the first phase", 10.0, 1.0, 60.0, "m/s²", 1.0, 1e-3, 1e6),
    Parameter("w2", "w₂", "acceleration in the second phase", 60.0, 1.0, 120.0, "m/s²", 1.0, 1e-3, 1e6),
    Parameter("w3", "w₃", "acceleration in the third phase", 12.0, 1.0, 60.0, "m/s²", 1.0, 1e-3, 1e6),
    Parameter("a1", "a₁", "first acceleration", 20.0, 2.0, 100.0, "m/s²", 1.0, 1e-3, 1e6),
    Parameter("a2", "a₂", "second acceleration", 40.0, 2.0, 100.0, "m/s²", 1.0, 1e-3, 1e6),
    Parameter("bang_period", "T", "period", 0.03, 0.005, 0.1, "ms", _KILO, 1e-5, 10.0),
    Parameter("ramp_u1", "u₁", "relative speed forwards", 0.05, 0.01, 0.5, "m/s", 1.0, 1e-5, 100.0),
    Parameter("ramp_u2", "u₂", "relative speed backwards", 0.4, 0.05, 1.0, "m/s", 1.0, 1e-5, 100.0),
    Parameter("ramp", "τ", "duration of a ramp", 0.01, 1e-3, 0.012, "ms", _KILO, 1e-6, 10.0),
    Parameter("ramp_period", "T", "period", 0.25, 0.05, 0.6, "ms", _KILO, 1e-4, 100.0),
    Parameter("rise", "t_r", "duration of the rise", 0.2, 0.005, 0.5, "ms", _KILO, 1e-6, 10.0),
    Parameter("fall", "t_f", "duration of the fall", 0.025, 0.005, 0.5, "ms", _KILO, 1e-6, 10.0),
    Parameter("piece_d1", "d₁", "duration of the first piece", 0.022, 0.002, 0.06, "ms", _KILO, 1e-6, 10.0),
    Parameter("piece_d2", "d₂", "duration of the second piece", 0.022, 0.002, 0.06, "ms", _KILO, 1e-6, 10.0),
    Parameter("piece_d3", "d₃", "duration of the third piece", 0.015, 0.002, 0.06, "ms", _KILO, 1e-6, 10.0),
    Parameter("piece_a1", "a₁", "acceleration on the first piece", 18.65, -60.0, 60.0, "m/s²", 1.0, -1e6, 1e6),
    Parameter("piece_a2", "a₂", "acceleration on the second piece", -60.0, -120.0, 120.0, "m/s²", 1.0, -1e6, 1e6),
    Parameter("lift", "B", "amplitude of the vertical motion", 1e-4, 0.0, 5e-4, "mm", _KILO, 0.0, 0.1),
    Parameter("lift_phase", "φ", "phase of the vertical motion", 0.5 * math.pi, -math.pi, math.pi, "°", _DEGREES, -10.0, 10.0),
    Parameter("voltage", "V", "voltage on the patches", 20.0, 0.0, 60.0, "V", 1.0, 0.0, 1000.0),
    Parameter("frequency", "f", "frequency of the voltage", 32.7, 5.0, 60.0, "Hz", 1.0, 0.1, 1e4),
    Parameter("length", "L", "length of the beam", 0.1, 0.07, 0.14, "mm", _KILO, 0.04, 1.0),
    Parameter("thickness", "h₁", "thickness of the beam", 1e-3, 5e-4, 2e-3, "mm", _KILO, 1e-4, 0.02),
    # ---- track and masses ----
    Parameter("tilt_deg", "θ", "tilt of the track, downhill is forwards", 1.7, -8.0, 8.0, "°", 1.0, -60.0, 60.0),
    Parameter("depth", "d", "depth of the variation of friction", 0.3, 0.0, 0.9, "", 1.0, 0.0, 0.99),
    Parameter("grip_phase", "φ", "phase of the variation of friction", 0.0, -math.pi, math.pi, "°", _DEGREES, -10.0, 10.0),
    Parameter("body_mass", "M", "mass of the body", 62.59e-3, 0.01, 0.2, "g", _KILO, 1e-4, 100.0),
    Parameter("inner_mass", "m", "inner mass", 9.48e-3, 1e-3, 0.05, "g", _KILO, 1e-5, 100.0),
    Parameter("gravity", "g", "acceleration of gravity", 9.81, 1.0, 15.0, "m/s²", 1.0, 1e-3, 1e3),
    # ---- friction ----
    Parameter("mu0", "μ₀", "kinetic friction coefficient", 0.18, 0.02, 0.6, "", 1.0, 1e-4, 10.0),
    Parameter("f0", "f₀", "static friction coefficient", 0.21, 0.02, 1.0, "", 1.0, 1e-4, 10.0),
    Parameter("mu_plus", "μ₊", "kinetic friction coefficient forwards", 0.15, 0.02, 0.6, "", 1.0, 1e-4, 10.0),
    Parameter("mu_minus", "μ₋", "kinetic friction coefficient backwards", 0.21, 0.02, 0.6, "", 1.0, 1e-4, 10.0),
    Parameter("f_plus", "f₊", "static friction coefficient forwards", 0.18, 0.02, 1.0, "", 1.0, 1e-4, 10.0),
    Parameter("f_minus", "f₋", "static friction coefficient backwards", 0.24, 0.02, 1.0, "", 1.0, 1e-4, 10.0),
    Parameter("sigma0", "σ₀", "bristle stiffness", 4e5, 2e4, 1e6, "kN/m", 1e-3, 1e2, 1e8),
    Parameter("sigma1", "σ₁", "bristle damping", 100.0, 0.0, 400.0, "N s/m", 1.0, 0.0, 1e5),
    Parameter("sigma2", "σ₂", "viscous friction of the bristles", 0.04, 0.0, 2.0, "N s/m", 1.0, 0.0, 1e4),
    Parameter("v_s", "vₛ", "Stribeck velocity", 2e-3, 2e-4, 2e-2, "mm/s", _KILO, 1e-6, 10.0),
    Parameter("exponent", "δ", "exponent of the Stribeck curve", 2.0, 0.5, 4.0, "", 1.0, 0.2, 8.0),
    Parameter("dahl_exponent", "n", "exponent of Dahl's law", 1.0, 0.5, 3.0, "", 1.0, 0.2, 8.0),
    Parameter("z_ba", "z_ba", "deflection below which nothing slips", 2e-7, 2e-8, 2e-6, "µm", _MEGA, 1e-9, 1e-3),
    Parameter("attraction", "C", "attraction to the Stribeck curve", 100.0, 5.0, 500.0, "N/s", 1.0, 1e-2, 1e6),
    Parameter("a", "a", "direct effect of the speed", 0.01, 1e-3, 0.05, "", 1.0, 1e-3, 1.0),
    Parameter("b", "b", "effect of the age", 0.02, 0.0, 0.05, "", 1.0, 0.0, 1.0),
    Parameter("Dc", "D_c", "slip that renews the contacts", 2e-6, 1e-7, 2e-5, "µm", _MEGA, 1e-9, 1e-2),
    Parameter("v0", "v₀", "reference speed", 1e-3, 1e-5, 1e-2, "mm/s", _KILO, 1e-9, 10.0),
    Parameter("width", "Δv", "width of the smoothed step", 1e-3, 1e-4, 1e-2, "mm/s", _KILO, 1e-6, 1.0),
    Parameter("viscous", "η", "viscous friction", 0.4, 0.0, 4.0, "N s/m", 1.0, 0.0, 1e4),
    Parameter("quadratic", "η₂", "quadratic friction", 2.0, 0.0, 20.0, "N s²/m²", 1.0, 0.0, 1e5),
    Parameter("viscous_plus", "η₊", "viscous friction forwards", 0.4, 0.05, 4.0, "N s/m", 1.0, 0.0, 1e4),
    Parameter("viscous_minus", "η₋", "viscous friction backwards", 0.6, 0.05, 4.0, "N s/m", 1.0, 0.0, 1e4),
    Parameter("quadratic_plus", "η₂₊", "quadratic friction forwards", 2.0, 0.0, 20.0, "N s²/m²", 1.0, 0.0, 1e5),
    Parameter("quadratic_minus", "η₂₋", "quadratic friction backwards", 3.0, 0.0, 20.0, "N s²/m²", 1.0, 0.0, 1e5),
)  # fmt: skip
PARAMETERS: dict[str, Parameter] = {p.name: p for p in _ALL}
"""Every parameter by name, in the order of the page."""
