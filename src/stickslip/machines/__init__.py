"""Machines: bodies with contacts, links and stops, declared in plain Python."""

from stickslip.machines.bodies import Bodies
from stickslip.machines.chain import Chain
from stickslip.machines.forced import Forced
from stickslip.machines.joint import Joint
from stickslip.machines.machine import Machine
from stickslip.machines.moving_track import MovingTrack
from stickslip.machines.parts import Body, Contact, Gait, Rigid, Spring, Stop
from stickslip.machines.pid import PID

__all__ = [
    "PID", "Bodies", "Body", "Chain", "Contact", "Forced", "Gait", "Joint", "Machine", "MovingTrack", "Rigid", "Spring", "Stop",
]  # fmt: skip
