"""Machines with published or plainly labelled numbers, one function each, with their source."""

from typing import TYPE_CHECKING

from stickslip.basics.lazy_names import listing
from stickslip.basics.quantities import PAPER_AMPLITUDES
from stickslip.models.presets.boxes import hopping_robot, rocking_block
from stickslip.models.presets.capsules import capsubot, capsule
from stickslip.models.presets.chains import two_modules, worm
from stickslip.models.presets.in_the_plane import block_on_wedge, bristle_bot, cart_pole, mode_coupling, sliding_rod, two_link_arm
from stickslip.models.presets.joints import gear_joint, servo
from stickslip.models.presets.robots import coulomb_robot, piezo_beam_rig, piezo_rig
from stickslip.models.presets.stages_and_conveyors import conveyor, stick_slip_stage

__all__ = [
    "PAPER_AMPLITUDES",
    "PRESETS",
    "block_on_wedge",
    "bristle_bot",
    "capsubot",
    "capsule",
    "cart_pole",
    "conveyor",
    "coulomb_robot",
    "gear_joint",
    "hopping_robot",
    "mode_coupling",
    "piezo_beam_rig",
    "piezo_rig",
    "rocking_block",
    "servo",
    "sliding_rod",
    "stick_slip_stage",
    "two_link_arm",
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
    gear_joint,
    stick_slip_stage,
    conveyor,
    hopping_robot,
    rocking_block,
    bristle_bot,
    cart_pole,
    block_on_wedge,
    sliding_rod,
    two_link_arm,
    mode_coupling,
)
#: Every preset by its name.
PRESETS = {preset.__name__: preset for preset in _ALL}


if not TYPE_CHECKING:  # a type checker would take every name for one of ours

    def __getattr__(name: str) -> object:
        from stickslip.basics.errors import did_you_mean

        raise AttributeError(f"stickslip.presets has no {name!r}; {did_you_mean(name, PRESETS)}")


#: Presets whose units are all 1: what they give is not a number of meters or seconds.
DIMENSIONLESS = ("coulomb_robot", "capsule")
