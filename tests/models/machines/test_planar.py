"""Robots in the plane of the page of that name: a bristle-bot against the expansion in its force, and a cart with a pendulum by hand."""

from __future__ import annotations

from pathlib import Path
from runpy import run_path

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from cart_poles import CartAndBob
from rows import each_row

BOT = run_path(str(Path(__file__).parents[3] / "examples" / "planar.py"))["BOT"]


def speed(omega, force):
    """Mean velocity of its orbit, for a force of 1 N."""
    return ss.periodic_orbit(BOT.replace({"omega": omega, "force": force})).mean_velocity / force**2


@each_row("omega", [30.0, 60.0, 120.0])
def test_a_bristle_bot_goes_as_the_expansion_in_its_force_says(omega):
    """Cicconofri and DeSimone's model: the next order is smaller by the square of the force, so two forces give the limit."""
    one, half = (speed(omega, force) for force in (4e-3, 2e-3))
    limit, whole = BOT.replace({"omega": omega}).expanded / BOT.force**2, abs(speed(120.0, 2e-3))
    assert abs((4 * half - one) / 3 - limit) < 1e-6 * whole
    assert abs(one - half) < 1e-3 * whole


def test_a_bristle_bot_turns_round_at_a_frequency():
    """Backwards below it, forwards above: the orbit's mean velocity is zero there, up to the square of the force."""
    ends = [brentq(lambda omega, force=force: speed(omega, force), 58.0, 62.0, xtol=1e-9) for force in (4e-3, 2e-3)]
    assert (4 * ends[1] - ends[0]) / 3 == pytest.approx(BOT.reversal, rel=1e-6)
    assert ss.solve(BOT.replace({"omega": 30.0}), periods=30).mean_velocity < 0.0 < ss.solve(BOT, periods=30).mean_velocity


class FreeCart(CartAndBob):
    """A cart without friction that a rail holds."""

    def contacts(self):
        return {"rail": ss.Contact("cart", ss.Coulomb(0.0, 0.0), hold="both")}


def test_a_cart_with_a_pendulum_swings_as_by_hand():
    """Small swings without friction: angle a cos wt with w^2 = (g/l)(1 + m/M), and the cart the other way by m l/(m + M) of it."""
    cart, bob, length, first = 1.0, 0.8, 0.5, 1e-5
    run = ss.solve(FreeCart(cart, bob, length), duration=3.0, start={"x": {"angle": first}, "v": {}})
    swing = first * np.cos(np.sqrt(9.81 / length * (1 + bob / cart)) * run.t)
    assert np.max(abs(run.coordinates["angle"] - swing)) < 1e-9 * first
    assert np.allclose(run.coordinates["x"], bob * length / (bob + cart) * (first - swing), rtol=0, atol=1e-9 * first)
