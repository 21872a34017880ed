"""Motions that are proved: enclosures hold closed formulas of 30 digits and published numbers, and what is on a border is not proved."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.dynamics.periodic.ball_arithmetic import above_zero, flint_for, krawczyk

flint = pytest.importorskip("flint")
arb = flint.arb


def proof_of(plus, minus, digits=20, **static):
    """Of the robot with these alphas."""
    robot = ss.presets.coulomb_robot(plus, minus)
    return ss.dynamics.certify(ss.periodic_orbit(robot.replace(friction=ss.Coulomb(plus, minus, **static))), digits)


@each_row(
    ("alphas", "mean", "shares"),
    [
        ((0.5, 1.2), 0.201452203333669, {"+": 0.5241295584, "0": 1 - 0.5241295584}),  # T7
        ((0.7, 0.9), 0.0615227380297986, {"+": 0.3890396524, "0": 0.1657688566 + 0.2283168943, "-": 0.2168745967}),  # T8
        ((0.4, 0.8), 0.269172787549942, {"+": 0.5891171251, "-": 0.3047022137, "0": 0.1061806613}),  # T9
        ((0.4, 0.5), 0.122475359974498, {"+": 5 / 9, "-": 4 / 9}),  # T10
    ],
)
def test_known_motions_are_proved(alphas, mean, shares):
    found = proof_of(*alphas)
    assert found.proved
    assert float(found.mean_velocity) == pytest.approx(mean, abs=1e-14)  # as printed
    assert {sign: float(part) for sign, part in found.shares.items()} == pytest.approx(shares, abs=1e-10)
    assert ("0" in found.pattern) == (found.multiplier.high < 1e-300)


def test_static_friction_delays_break_away_in_the_proof_too():  # T11
    found = proof_of(0.5, 1.2, f_plus=0.8, f_minus=1.4)
    assert found.proved and float(found.mean_velocity) == pytest.approx(0.170822286993, abs=1e-12)


def test_an_enclosure_holds_the_closed_formula_in_forty_digits():  # T2
    found = proof_of(0.4, 0.5, digits=30)
    with mpmath.workdps(40):
        plus, minus = mpmath.mpf("0.4"), mpmath.mpf("0.5")
        delta = mpmath.pi * minus / (plus + minus)
        kappa = plus * delta
        mean = -mpmath.cos(delta) * mpmath.sqrt(1 - (kappa / mpmath.sin(delta)) ** 2)
        middle, radius = (mpmath.mpf(part) for part in str(found.mean_velocity).split("+/-"))
        assert abs(middle - mean) <= radius < mpmath.mpf(10) ** -28


def test_a_motion_without_rest_has_the_multiplier_of_its_derivative():
    found = proof_of(0.4, 0.5)
    orbit = ss.periodic_orbit(ss.presets.coulomb_robot(0.4, 0.5))
    assert float(np.real(orbit.multipliers[0])) in ss.dynamics.Enclosure(found.multiplier.low - 1e-12, found.multiplier.high + 1e-12, "")


@each_row("alphas", [(1.0, 1.0), (0.5, 1.0)], ids=["rest", "T5"])
def test_on_a_border_nothing_is_proved(alphas):
    found = proof_of(*alphas)
    assert not found.proved and "cannot be told from" in found.why and found.mean_velocity is None
    assert str(found).startswith("not proved: ")


def test_rest_is_proved_next_to_its_border():
    found = proof_of(1.0 + 1e-12, 1.0 + 1e-12)
    assert found.proved and found.pattern == "0" and found.mean_velocity.low < 0 < found.mean_velocity.high


def test_two_zeros_or_none_in_a_box_are_not_called_one():
    middle = [arb(0.001)]
    assert krawczyk(flint, lambda x: [x[0] ** 2], lambda x: flint.arb_mat(1, 1, [2 * x[0]]), middle, arb("0.5")) is None
    assert krawczyk(flint, lambda x: [x[0] ** 2 + 1], lambda x: flint.arb_mat(1, 1, [2 * x[0]]), middle, arb("0.5")) is None


def test_a_dip_below_zero_is_not_missed():
    dip = arb("0.5003")
    for least, found in ((arb("1e-12"), True), (arb("-1e-12"), False), (arb(0), False)):
        lowest = above_zero(arb, lambda x, c=least: (x - dip) ** 2 + c, lambda x: 2 * (x - dip), arb(0), arb(1))
        assert (lowest is not None) is found


def test_what_cannot_be_proved_is_refused_in_words(monkeypatch):
    with pytest.raises(ss.InputError, match="exact arcs need a set-valued law"):
        ss.dynamics.certify(ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="lugre")))
    monkeypatch.setitem(__import__("sys").modules, "flint", None)
    with pytest.raises(ss.InputError, match=r'pip install "stickslip\[certify\]"'):
        flint_for("certify")
