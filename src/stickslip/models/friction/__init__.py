"""Friction laws: one law, one file. `LAWS` lists the elementary ones by name; `Sum` adds them."""

from stickslip.basics.contracts import Law
from stickslip.basics.lazy_names import listing
from stickslip.models.friction.bristle import Bristle
from stickslip.models.friction.coulomb import Coulomb
from stickslip.models.friction.coulomb_viscous import CoulombViscous
from stickslip.models.friction.dahl import Dahl
from stickslip.models.friction.dead_band import DeadBand
from stickslip.models.friction.elasto_plastic import ElastoPlastic
from stickslip.models.friction.gms import GMS
from stickslip.models.friction.karnopp import Karnopp
from stickslip.models.friction.lugre import LuGre
from stickslip.models.friction.rate_state import RateState
from stickslip.models.friction.reset_integrator import ResetIntegrator
from stickslip.models.friction.stribeck import Stribeck
from stickslip.models.friction.sum import Sum as Sum
from stickslip.models.friction.tabulated import Tabulated
from stickslip.models.friction.tanh_coulomb import TanhCoulomb
from stickslip.models.friction.viscous import Viscous

_ALL = (
    Coulomb, Viscous, CoulombViscous, Stribeck, Tabulated, Dahl, LuGre, ElastoPlastic, GMS, Bristle, ResetIntegrator, RateState,
    TanhCoulomb, DeadBand, Karnopp,
)  # fmt: skip
_KEEPING_THE_CONTRACT: tuple[type[Law], ...] = _ALL  # mypy compares their methods
#: Every law by its name in lower case.
LAWS = {law.__name__.lower(): law for law in _ALL}

__all__ = [
    "GMS", "LAWS", "Bristle", "Coulomb", "CoulombViscous", "Dahl", "DeadBand", "ElastoPlastic", "Karnopp", "LuGre", "RateState",
    "ResetIntegrator", "Stribeck", "Sum", "Tabulated", "TanhCoulomb", "Viscous",
]  # fmt: skip
__dir__ = listing(__all__)
