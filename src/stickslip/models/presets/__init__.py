"""Machines with published or plainly labelled numbers, one function each, with their source."""

from typing import TYPE_CHECKING

from stickslip.basics.lazy_names import listing
from stickslip.basics.quantities import PAPER_AMPLITUDES
from stickslip.models.presets.boxes import hopping_robot, rocking_block
from stickslip.models.presets.capsules import capsubot, capsule
from stickslip.models.presets.chains import two_modules, worm
from stickslip.models.presets.joints import servo
from stickslip.models.presets.robots import coulomb_robot, piezo_beam_rig, piezo_rig
from stickslip.models.presets.stages_and_conveyors import conveyor, stick_slip_stage

__all__ = [
    "PAPER_AMPLITUDES",
    "PRESETS",
    "capsubot",
    "capsule",
    "conveyor",
    "coulomb_robot",
    "hopping_robot",
    "piezo_beam_rig",
    "piezo_rig",
    "rocking_block",
    "servo",
    "stick_slip_stage",
    "two_modules",
    "worm",
]
__dir__ = listing(__all__)

_ALL = (
    piezo_rig,
    piezo_beam_rig,
    coulomb_robot,
    two_modules,
    worm,
    capsubot,
    capsule,
    servo,
    stick_slip_stage,
    conveyor,
    hopping_robot,
    rocking_block,
)
#: Every preset by its name.
PRESETS = {preset.__name__: preset for preset in _ALL}


if not TYPE_CHECKING:  # a type checker would take every name for one of ours

    def __getattr__(name: str) -> object:
        from stickslip.basics.errors import did_you_mean

        raise AttributeError(f"stickslip.presets has no {name!r}; {did_you_mean(name, PRESETS)}")


#: Presets whose units are all 1: what they give is not a number of meters or seconds.
DIMENSIONLESS = ("coulomb_robot", "capsule")
