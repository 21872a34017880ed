"""Mechanisms: the test benches of the field, each equations of motion with one contact. `MECHANISMS` lists them by name."""

from stickslip.mechanisms.block_on_belt import BlockOnBelt
from stickslip.mechanisms.forced_oscillator import ForcedOscillator
from stickslip.mechanisms.pulled_mass import PulledMass

__all__ = ["MECHANISMS", "BlockOnBelt", "ForcedOscillator", "PulledMass"]

MECHANISMS = {cls.kind: cls for cls in (BlockOnBelt, ForcedOscillator, PulledMass)}
