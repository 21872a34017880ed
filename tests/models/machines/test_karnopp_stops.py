"""Karnopp's band where a stop stays closed: the bodies that it moves as one bear together what is applied to all of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.maths import sin
from stickslip.models.friction.law_adapter import adapted


@dataclass(frozen=True, eq=False)
class Pair(ss.Machine):
    """A body that a force drives against another one, which it may push along."""

    friction: Any
    bias: float = 1.2
    push: float = 2.0
    omega: float = 20.0

    @property
    def period(self):
        """That of the force."""
        return 2 * np.pi / self.omega

    def bodies(self):
        """The first one is driven."""
        return {"a": ss.Body(0.5, force=lambda t, x, v: self.bias + self.push * sin(self.omega * t)), "b": ss.Body(0.2)}

    def contacts(self):
        """Both rub."""
        return {"a": ss.Contact("a", self.friction, load=5.0), "b": ss.Contact("b", self.friction, load=2.0)}

    def stops(self):
        """Plastic."""
        return {("a", "b"): ss.Stop(gap=1e-3, restitution=0.0)}


COEFFICIENTS = {"mu_plus": 0.2, "mu_minus": 0.2, "f_plus": 0.3, "f_minus": 0.3}


def _ways(friction, **how):
    pair = Pair(friction)
    return ss.solve(pair, periods=2, **how).with_axes.at(np.linspace(0.1, 2, 9) * pair.period * (1 - 1e-9))["x"]


@pytest.mark.slow
def test_karnopp_behind_a_closed_stop_approaches_coulomb_as_its_band_narrows():
    """A body that breaks away with a force that grows steadily is in the band for a time in proportion to the root of its width."""
    exact = _ways(ss.Coulomb(**COEFFICIENTS), method="dop853")
    off = [np.max(abs(_ways(ss.friction.Karnopp(**COEFFICIENTS, width=width), rtol=1e-9) - exact)) for width in (1e-4, 1e-6)]
    assert off[1] == pytest.approx(0.1 * off[0], rel=0.05)
    assert off[1] < 1e-3 * np.max(abs(exact))


@pytest.mark.slow
def test_engine_and_judge_agree_on_karnopp_behind_a_closed_stop():
    """The judge's steps are held to 1e-9 of the state, ours too; hundreds of steps, so a few hundred times that."""
    law = ss.friction.Karnopp(**COEFFICIENTS, width=1e-4)
    np.testing.assert_allclose(_ways(law, rtol=1e-9), _ways(law, rtol=1e-9, method="bdf"), rtol=0.0, atol=1e-6)


def test_friction_that_creeps_is_the_law_above_the_least_velocity_and_proportional_below_it():
    """Above w the two differ by w^2/v^2 times at most 1 + 1/ln(v/creep) < 2; below it half the velocity is half the force."""
    law, w = adapted(ss.friction.RateState(mu0=0.6, a=0.01, b=0.015, Dc=1e-5, v0=1e-6)), 1e-12

    def forces(v):
        return law.resolved(w, v, (0.3,), (0.0,), 2.0), law.force(v, (0.3,), (0.0,), 2.0)

    for v in (-1e-2, -1e-9, 1e-10, 1e-6, 1.0):
        ours, own = forces(v)
        assert abs(ours / own - 1) < 2 * (w / v) ** 2 + 1e-15
    assert forces(0.0)[0] == 0.0
    assert forces(1e-15)[0] == pytest.approx(2 * forces(5e-16)[0], rel=1e-5)
