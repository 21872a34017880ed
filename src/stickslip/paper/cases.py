"""Every case of the paper as data: section 4's four experiments and the twenty figures of section 5."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

__all__ = ["AMPLITUDE_5", "CASES", "EXPERIMENTS", "FAST_FIGURES", "OMEGA", "PRINTED", "Case", "Experiment", "rig"]

#: Drive frequency of the experiments [rad/s] (section 4).
OMEGA = 65.4 * math.pi
#: Amplitude taken for sections 5.2 to 5.4, which print none [m].
AMPLITUDE_5 = 6e-4
#: Where an amplitude comes from.
PRINTED = "printed"
INFERRED_4 = "inferred: the paper prints no amplitude here; this one reproduces the printed type and mean velocities of this angle"
INFERRED_5 = (
    "inferred: the paper prints no amplitude here; this is the only multiple of 0.1 mm for which the five frequencies give rest and "
    "all four types, "
    "and μ₀ = 0.04 gives period two"
)
#: Figures that the fast subset draws.
FAST_FIGURES = (6, 7, 8, 9, 10, 11, 15, 20, 22, 23, 27)


@dataclass(frozen=True)
class Experiment:
    """One experiment of section 4 with what the paper prints about it.

    Parameters
    ----------
    name : str
        Our name for it, in the order of the angles.
    figure : int
        The paper's figure.
    section : str
        The paper's section.
    tilt_deg : float
        Angle of the slope [degrees].
    amplitude : float
        Inferred amplitude of the inner mass [m].
    type : str
        Motion type that the paper gives it.
    coulomb, lugre, measured : float
        Printed mean velocities [m/s]: simulated with either law, and measured.
    """

    name: str
    figure: int
    section: str
    tilt_deg: float
    amplitude: float
    type: str
    coulomb: float
    lugre: float
    measured: float
    amplitude_source: str = INFERRED_4


EXPERIMENTS = (
    Experiment("P1", 7, "4.2.1", 1.7, 5.525e-4, "I", 0.0020, 0.0018, 0.0017),
    Experiment("P2", 9, "4.2.3", 2.7, 6.032e-4, "III", 0.0038, 0.0037, 0.0036),
    Experiment("P3", 8, "4.2.2", 4.7, 4.564e-4, "II", 0.0040, 0.0037, 0.0040),
    Experiment("P4", 10, "4.2.4", 5.7, 1.487e-3, "IV", 0.0287, 0.0281, 0.0254),
)


@dataclass(frozen=True)
class Case:
    """One figure of section 5: LuGre friction at 1.7 degrees, with one number changed.

    Parameters
    ----------
    figure : int
        The paper's figure.
    section : str
        The paper's section.
    amplitude : float
        Amplitude of the inner mass [m].
    changes : dict
        Arguments of the preset that differ from its defaults.
    varied : str
        What the section varies, as the caption writes it.
    statement : str
        What the paper says about this figure, if anything.
    amplitude_source : str
        "printed", or how it was inferred.
    """

    figure: int
    section: str
    amplitude: float
    varied: str
    changes: dict[str, float] = field(default_factory=dict)
    statement: str = ""
    amplitude_source: str = INFERRED_5
    tilt_deg: float = 1.7

    @property
    def inferred(self) -> bool:
        """Whether the amplitude is inferred."""
        return self.amplitude_source != PRINTED


def _by_amplitude() -> tuple[Case, ...]:
    values = (1e-6, 3e-4, 4e-4, 5e-4, 6e-4, 8e-4)
    texts = ("A = 10⁻⁶ m", "A = 0.3 mm", "A = 0.4 mm", "A = 0.5 mm", "A = 0.6 mm", "A = 0.8 mm")
    said = ("simple harmonic vibration, monocyclic", *("one of the four types, periodic",) * 5)
    return tuple(Case(11 + i, "5.1", A, text, {}, s, PRINTED) for i, (A, text, s) in enumerate(zip(values, texts, said, strict=True)))


def _by_frequency() -> tuple[Case, ...]:
    return tuple(
        Case(17 + i, "5.2", AMPLITUDE_5, f"ω = {n}π s⁻¹", {"omega": n * math.pi}, "as by the amplitude")
        for i, n in enumerate((30, 46, 52, 65, 80))
    )


def _by_friction() -> tuple[Case, ...]:
    kinetic = ((0.03, "quasi-periodic"), (0.04, "period two"), (0.05, "type III or IV"), (0.10, "type III or IV"), (0.21, "type III or IV"))
    static = (0.18, 0.35, 0.5, 1.0)
    moving = tuple(Case(22 + i, "5.3", AMPLITUDE_5, f"μ₀ = {v:g}", {"mu0": v}, said) for i, (v, said) in enumerate(kinetic))
    return moving + tuple(
        Case(27 + i, "5.4", AMPLITUDE_5, f"f₀ = {v:g}", {"f0": v}, "all four types in the four figures") for i, v in enumerate(static)
    )


CASES = _by_amplitude() + _by_frequency() + _by_friction()


def rig(case: Case | Experiment, **arguments: Any) -> Any:
    """The robot of a case; arguments of the preset override it.

    Examples
    --------
    >>> rig(CASES[0]).drive.amplitude, rig(EXPERIMENTS[0], law="coulomb").friction.f_plus
    (1e-06, None)
    """
    from stickslip.presets import piezo_rig

    return piezo_rig(**{"tilt_deg": case.tilt_deg, "amplitude": case.amplitude, **getattr(case, "changes", {}), **arguments})
