"""Notes on a piezo beam and its drive: limits of the paper's hardware and of linear beam theory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Numeric
from stickslip.models.drives.cantilever import cantilever_eigenvalues, mode_shape
from stickslip.models.drives.patch_moment import modal_amplitudes

if TYPE_CHECKING:
    from stickslip.models.drives.piezo_beam import PiezoBeam


#: Range of the voltage [V] and bound of the frequency [Hz] of the paper's hardware (section 3.1).
VOLTAGE, FREQUENCY = (10.0, 150.0), 5000.0
#: Slope [rad] above which linear beam theory is off by more than about 1 per cent (a static tip deflection of a tenth of the length).
SLOPE = 0.15
PLACES = 24


def of_beam(beam: PiezoBeam) -> list[str]:
    """Remarks on the beam alone."""
    import numpy as np

    arm = (beam.thickness + beam.patch_thickness) / 2
    area = beam.width * beam.patch_thickness
    patches = 2 * beam.patch_modulus * area * (beam.patch_thickness**2 / 12 + arm**2)
    stiffer = float(np.max(1 + patches / beam.bending_stiffness))
    return [
        f"the stiffness of the patches is left out, as in Eq. 3.1: with it the root is {stiffer:.3g} times as stiff, so that a real beam "
        "moves less per volt, at higher frequencies"
    ]


def of_use(beam: PiezoBeam, voltage: Numeric, frequency: Numeric) -> list[str]:
    """Remarks on driving it with this voltage [V] and frequency [Hz]."""
    import numpy as np

    low, high = VOLTAGE
    top = np.min(beam.frequencies()[..., -1])
    slope = abs(beam.spread(largest_slope, voltage, frequency))
    checks = (
        (voltage, (np.asarray(voltage) < low) | (np.asarray(voltage) > high), "V",
         f"voltage is outside the {low:g} to {high:g} V of the paper's hardware"),
        (frequency, np.asarray(frequency) >= FREQUENCY, "Hz",
         f"frequency is not below {FREQUENCY:g} Hz, the bound of the paper's hardware"),
        (frequency, np.asarray(frequency) > top, "Hz", f"frequency is above that of the highest mode, {top:.5g} Hz: take more modes"),
        (slope, np.asarray(slope) > SLOPE, "rad",
         f"slope of the beam is above {SLOPE:g} rad, where linear theory is off by more than about 1 per cent"),
    )  # fmt: skip
    return [_sentence(value, bad, unit, text) for value, bad, unit, text in checks if np.any(bad)]


def _sentence(value: Numeric, bad: Any, unit: str, text: str) -> str:
    """The remark with its number, or with the count of cases and their largest number."""
    import numpy as np

    values = np.asarray(value, float)
    if values.ndim == 0:
        return f"{text}: {float(values):.5g} {unit}"
    chosen = values[np.asarray(bad)]
    return f"{text}: {chosen.min():.5g} to {chosen.max():.5g} {unit} in {chosen.size} of {values.size} cases"


def largest_slope(frequency: Numeric, tip_mass_ratio: Numeric, end: Numeric, n: int, damping: Numeric) -> Any:
    """Largest slope along the unit beam for a unit couple; arguments as for `modal_amplitudes` [-].

    Examples
    --------
    >>> round(float(largest_slope(1e-6, 1.0, 0.4, 200, 0.02)), 2)  # static: the beam is straight behind the couple
    0.4
    """
    import numpy as np

    b = cantilever_eigenvalues(tip_mass_ratio, n)
    amplitudes = modal_amplitudes(frequency, tip_mass_ratio, end, n, damping)
    largest = np.zeros(np.shape(amplitudes)[:-1])
    for s in np.linspace(0.0, 1.0, PLACES + 1)[1:]:
        largest = np.maximum(largest, abs((amplitudes * mode_shape(b, s, derivative=1)).sum(axis=-1)))
    return largest
