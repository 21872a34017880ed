"""Friction laws: one law, one file. `LAWS` lists them by name."""

from stickslip.friction.coulomb import Coulomb
from stickslip.friction.lugre import LuGre

__all__ = ["LAWS", "Coulomb", "LuGre"]

LAWS = {"coulomb": Coulomb, "lugre": LuGre}
