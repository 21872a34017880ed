"""Mechanisms: the standard test benches of the field, each with one contact.

`MECHANISMS` lists by name what the table [mechanism] of a study file may contain: the benches, chains of robots, and masses on moving
tracks.
"""

from typing import Any

from stickslip.contracts import Machine
from stickslip.machines.chain import Chain
from stickslip.machines.joint import Joint
from stickslip.machines.moving_track import MovingTrack
from stickslip.mechanisms.block_on_belt import BlockOnBelt
from stickslip.mechanisms.forced_oscillator import ForcedOscillator
from stickslip.mechanisms.pulled_mass import PulledMass

__all__ = ["MECHANISMS", "BlockOnBelt", "ForcedOscillator", "PulledMass"]

_ALL = (BlockOnBelt, ForcedOscillator, PulledMass)
_KEEPING_THE_CONTRACT: tuple[type[Machine], ...] = _ALL  # mypy compares their methods
MECHANISMS: dict[str, Any] = {cls.kind: cls for cls in (*_ALL, Chain, Joint, MovingTrack)}
