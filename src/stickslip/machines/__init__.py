"""Machines: bodies with contacts, links and stops, declared in plain Python."""

from stickslip.machines.chain import Chain
from stickslip.machines.machine import Machine
from stickslip.machines.parts import Body, Contact, Rigid, Spring, Stop

__all__ = ["Body", "Chain", "Contact", "Machine", "Rigid", "Spring", "Stop"]
