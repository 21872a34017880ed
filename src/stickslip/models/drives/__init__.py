"""Drives: prescribed motions of the inner mass. One drive, one file; `DRIVES` lists them by name."""

from typing import Any

from stickslip.basics.contracts import Drive
from stickslip.basics.lazy_names import listing
from stickslip.models.drives.bang_bang import BangBang
from stickslip.models.drives.cantilever import cantilever_eigenvalues as cantilever_eigenvalues
from stickslip.models.drives.force import ForceSum
from stickslip.models.drives.harmonic import Harmonic
from stickslip.models.drives.harmonic_force import HarmonicForce
from stickslip.models.drives.multi_harmonic import MultiHarmonic
from stickslip.models.drives.pieces import Pieces
from stickslip.models.drives.piezo_beam import PiezoBeam as PiezoBeam
from stickslip.models.drives.pulses import Pulses
from stickslip.models.drives.recorded import Recorded
from stickslip.models.drives.recorded_force import RecordedForce
from stickslip.models.drives.sawtooth import Sawtooth
from stickslip.models.drives.three_phase import ThreePhase
from stickslip.models.drives.trapezoid import Trapezoid
from stickslip.models.drives.turned import Reversed
from stickslip.models.drives.two_phase import TwoPhase
from stickslip.models.drives.vertical import VerticalVibration

_ALL = (Harmonic, MultiHarmonic, TwoPhase, ThreePhase, BangBang, Trapezoid, Pieces, Sawtooth, Recorded, VerticalVibration, Reversed)
_KEEPING_THE_CONTRACT: tuple[type[Drive], ...] = _ALL  # mypy compares their methods
DRIVES = {drive.__name__.lower(): drive for drive in _ALL}
"""Every drive by its name in lower case. A `PiezoBeam` is not among them: it makes a `Harmonic` from volts and hertz."""

FORCES: dict[str, Any] = {"harmonic": HarmonicForce, "pulses": Pulses, "recorded": RecordedForce, "sum": ForceSum}
"""The forces on an inner mass by their names in a study file."""
ForceSum.part_kinds = {"parts": FORCES}

__all__ = [
    "DRIVES", "FORCES", "BangBang", "ForceSum", "Harmonic", "HarmonicForce", "MultiHarmonic", "Pieces", "PiezoBeam", "Pulses", "Recorded",
    "RecordedForce", "Reversed", "Sawtooth", "ThreePhase", "Trapezoid", "TwoPhase", "VerticalVibration", "cantilever_eigenvalues",
]  # fmt: skip
__dir__ = listing(__all__)
