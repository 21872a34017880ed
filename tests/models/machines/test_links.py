"""Links that are not straight lines: springs that harden or soften, and play."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss

MODULE = ss.Robot(0.06259, 0.00948, ss.Harmonic(6e-4, omega=65.4 * math.pi), ss.Coulomb(0.15, 0.21))
LINKS = {
    "hardening": ss.Spring(stiffness=1200.0, damping=0.4, cubic=4e9),
    "softening": ss.Spring(stiffness=1200.0, damping=0.4, cubic=-5e8),
    "play": ss.Spring(stiffness=3000.0, damping=0.4, clearance=2e-4),
    "play and hardening": ss.Spring(stiffness=1200.0, damping=0.4, cubic=4e9, clearance=1e-4),
}


def pair(link, **more):
    return ss.Chain((MODULE, MODULE.replace(**more)), link=link, phases=(0.0, 2.0))


@pytest.mark.parametrize("link", LINKS.values(), ids=LINKS)
def test_a_chain_with_nonlinear_links_goes_as_the_judge_says(link):
    exact, judged = (ss.solve(pair(link), periods=8, method=method, rtol=1e-11) for method in ("exact", "dop853"))
    assert ss.mean_velocity(exact) == pytest.approx(ss.mean_velocity(judged), rel=1e-8)  # some thousand steps to 1e-11
    assert ss.energy(exact).worst < 1e-11
    stretched = np.ptp(exact.bodies["module 1"].x - exact.bodies["module 2"].x)
    assert stretched > 2e-4  # the link is where it is not a straight line


def test_a_spring_without_a_cubic_part_and_play_is_the_straight_one():
    plain = ss.solve(pair(ss.Spring(1200.0, 0.4)), periods=15)
    bent = ss.solve(pair(ss.Spring(1200.0, 0.4, cubic=0.0, clearance=0.0)), periods=15)
    assert ss.mean_velocity(bent) == pytest.approx(ss.mean_velocity(plain), rel=1e-11)


def test_the_period_of_a_hardening_spring_is_that_of_duffing():
    """m x'' = -k x - c x^3 from x = A: T = 4 K(m)/omega with omega^2 = (k + c A^2)/m, parameter m = c A^2 / (2 (k + c A^2))."""
    from dataclasses import dataclass

    from scipy.special import ellipk

    @dataclass(frozen=True, eq=False)
    class Duffing(ss.Machine):
        mass: float
        stiffness: float
        cubic: float
        period = None
        time_scale = 1.0
        velocity_scale = 1.0

        def bodies(self):
            return {"mass": ss.Body(self.mass)}

        def contacts(self):
            return {}

        def links(self):
            return {("mass", None): ss.Spring(self.stiffness, cubic=self.cubic)}

    A, k, c = 0.3, 4.0, 50.0
    T = 4 * ellipk(c * A**2 / (2 * (k + c * A**2))) / math.sqrt(k + c * A**2)
    run = ss.solve(Duffing(1.0, k, c), duration=3 * T, start={"x": {"mass": A}}, rtol=1e-12)
    assert run.at(3 * T)["x"].item() == pytest.approx(A, rel=1e-9)  # a hundred steps to 1e-12


def test_a_link_with_play_is_kept_by_a_study_file_and_written_as_an_equation():
    chain = pair(LINKS["play and hardening"])
    assert ss.Chain.from_toml(chain.to_toml()) == chain
    assert "cubic" not in pair(ss.Spring(1200.0)).to_toml()
    assert "^{3}" in ss.latex(chain)


def test_a_negative_play_is_refused():
    with pytest.raises(ss.InputError, match=r"clearance = -1\.0; allowed is zero or more"):
        ss.Spring(stiffness=1.0, clearance=-1.0)
