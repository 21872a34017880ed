"""Every case of the paper as data: section 4's four experiments and the twenty figures of section 5."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stickslip.basics.quantities import PAPER_AMPLITUDES

__all__ = ["AMPLITUDE_5", "CASES", "EXPERIMENTS", "FAST_FIGURES", "OMEGA", "PRINTED", "Case", "PrintedExperiment", "rig"]

#: Drive frequency of the experiments [rad/s] (section 4).
OMEGA = 65.4 * math.pi
#: Amplitude taken for sections 5.2 to 5.4, which print none [m]: in the middle of those that satisfy most statements (`one_amplitude`).
AMPLITUDE_5 = 6.8e-4
#: Sources of an amplitude.
PRINTED = "printed"
_DATA = tomllib.loads(Path(__file__).with_name("cases.toml").read_text(encoding="utf-8"))
#: Figures drawn in the fast subset.
FAST_FIGURES = (6, 7, 8, 9, 10, 11, 15, 20, 22, 23, 27)


@dataclass(frozen=True)
class PrintedExperiment:
    """One experiment of section 4 with the printed results.

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
        Motion type according to the paper.
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
    amplitude_source: str = _DATA["inferred"]["4"]


EXPERIMENTS = tuple(
    PrintedExperiment(name, amplitude=PAPER_AMPLITUDES[row["tilt_deg"]], **row) for name, row in _DATA["experiments"].items()
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
        The varied quantity, as in the caption.
    statement : str
        The paper's statement on this figure, if any.
    amplitude_source : str
        "printed", or how it was inferred.
    """

    figure: int
    section: str
    amplitude: float
    varied: str
    changes: dict[str, float] = field(default_factory=dict)
    statement: str = ""
    amplitude_source: str = _DATA["inferred"]["5"]
    tilt_deg: float = 1.7

    @property
    def inferred(self) -> bool:
        """Whether the amplitude is inferred."""
        return self.amplitude_source != PRINTED


def _case(figure: str, row: dict[str, Any]) -> Case:
    given = {"amplitude": AMPLITUDE_5, **row} | ({"amplitude_source": PRINTED} if "amplitude" in row else {})
    changes = dict(row.get("changes", {}))
    if "omega_over_pi" in changes:
        changes["omega"] = changes.pop("omega_over_pi") * math.pi
    return Case(int(figure), **{**given, "changes": changes})


CASES = tuple(_case(figure, row) for figure, row in _DATA["figures"].items())


def rig(case: Case | PrintedExperiment, **arguments: Any) -> Any:
    """The robot of a case; arguments of the preset override it.

    Examples
    --------
    >>> rig(CASES[0]).drive.amplitude, rig(EXPERIMENTS[0], law="coulomb").friction.f_plus
    (1e-06, None)
    """
    from stickslip.models.presets import piezo_rig

    return piezo_rig(**{"tilt_deg": case.tilt_deg, "amplitude": case.amplitude, **getattr(case, "changes", {}), **arguments})
