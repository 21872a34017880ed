"""Machines: bodies with contacts, links and stops, declared in plain Python."""

from stickslip.machines.bodies import Bodies
from stickslip.machines.chain import Chain
from stickslip.machines.forced import Forced
from stickslip.machines.machine import Machine
from stickslip.machines.parts import Body, Contact, Gait, Rigid, Spring, Stop

__all__ = ["Bodies", "Body", "Chain", "Contact", "Forced", "Gait", "Machine", "Rigid", "Spring", "Stop"]
