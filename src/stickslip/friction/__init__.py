"""Friction laws: one law, one file. `LAWS` lists the elementary ones by name; `Sum` adds them."""

from stickslip.contracts import Law
from stickslip.friction.bristle import Bristle
from stickslip.friction.coulomb import Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.friction.dahl import Dahl
from stickslip.friction.dead_band import DeadBand
from stickslip.friction.elasto_plastic import ElastoPlastic
from stickslip.friction.gms import GMS
from stickslip.friction.karnopp import Karnopp
from stickslip.friction.lugre import LuGre
from stickslip.friction.rate_state import RateState
from stickslip.friction.reset_integrator import ResetIntegrator
from stickslip.friction.stribeck import Stribeck
from stickslip.friction.sum import Sum as Sum
from stickslip.friction.tabulated import Tabulated
from stickslip.friction.tanh_coulomb import TanhCoulomb
from stickslip.friction.viscous import Viscous

_ALL = (
    Coulomb, Viscous, CoulombViscous, Stribeck, Tabulated, Dahl, LuGre, ElastoPlastic, GMS, Bristle, ResetIntegrator, RateState,
    TanhCoulomb, DeadBand, Karnopp,
)  # fmt: skip
_KEEPING_THE_CONTRACT: tuple[type[Law], ...] = _ALL  # mypy compares their methods
#: Every law by its name in lower case.
LAWS = {law.__name__.lower(): law for law in _ALL}
