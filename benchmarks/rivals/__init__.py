"""Everybody else: one module per library, each with its RIVALS."""

from rivals import diffrax_jax, numbalsoda_c, rk4, scipy_ode, sundae, taylor_heyoka
from rivals.base import Outcome, Rival

ALL = taylor_heyoka.RIVALS + rk4.RIVALS + numbalsoda_c.RIVALS + sundae.RIVALS + scipy_ode.RIVALS + diffrax_jax.RIVALS

__all__ = ["ALL", "Outcome", "Rival"]
