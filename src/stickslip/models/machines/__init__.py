"""Machines: the field's test benches with one contact, and bodies with contacts, links and stops, declared in plain Python.

`MECHANISMS` lists by name what the table [mechanism] of a study file may contain.
"""

from typing import Any

from stickslip.basics.contracts import OneContact
from stickslip.basics.lazy_names import listing
from stickslip.models.flow_contacts import FlowContact
from stickslip.models.force_rig import ForceRig
from stickslip.models.link_ends import Angle, Point
from stickslip.models.machines.block_on_belt import BlockOnBelt
from stickslip.models.machines.block_on_wedge import BlockOnWedge
from stickslip.models.machines.bodies import Bodies
from stickslip.models.machines.bristle_bot import BristleBot, Lubricated
from stickslip.models.machines.cart_pole import CartPole
from stickslip.models.machines.chain import Chain
from stickslip.models.machines.forced import Forced
from stickslip.models.machines.forced_oscillator import ForcedOscillator
from stickslip.models.machines.joint import Joint
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.mode_coupling import ModeCoupling
from stickslip.models.machines.motors import Motor
from stickslip.models.machines.moving_track import MovingTrack
from stickslip.models.machines.parts import Body, Contact, Gait, Link, Rigid, Spring, Stop
from stickslip.models.machines.pid import PID
from stickslip.models.machines.pulled_mass import PulledMass
from stickslip.models.machines.servo_load import ServoLoad
from stickslip.models.machines.shaken_box import ShakenBox
from stickslip.models.machines.sliding_rod import SlidingRod
from stickslip.models.machines.two_link_arm import TwoLinkArm

__all__ = [
    "MECHANISMS", "PID", "Angle", "BlockOnBelt", "BlockOnWedge", "Bodies", "Body", "BristleBot", "CartPole", "Chain", "Contact",
    "FlowContact", "ForceRig", "Forced", "ForcedOscillator", "Gait", "Joint", "Link", "Lubricated", "Machine", "ModeCoupling",
    "Motor", "MovingTrack", "Point", "PulledMass", "Rigid", "ServoLoad", "ShakenBox", "SlidingRod", "Spring", "Stop", "TwoLinkArm",
]  # fmt: skip
__dir__ = listing(__all__)

_OF_ONE_CONTACT = (BlockOnBelt, ForcedOscillator, PulledMass)
_KEEPING_THE_CONTRACT: tuple[type[OneContact], ...] = _OF_ONE_CONTACT  # mypy compares their methods
_IN_THE_PLANE = (BlockOnWedge, BristleBot, CartPole, ModeCoupling, ShakenBox, SlidingRod, TwoLinkArm)
MECHANISMS: dict[str, Any] = {cls.kind: cls for cls in (*_OF_ONE_CONTACT, Chain, Joint, MovingTrack, *_IN_THE_PLANE)}
