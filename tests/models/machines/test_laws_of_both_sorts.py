"""Machines in which some laws rest exactly and others have inner states: Rosenbrock steps whose contacts rest, and go in lanes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.maths import cos, pi, sin

MU, MASSES, STIFFNESS, LOAD = 0.2, (0.07, 0.05), 300.0, 1.0
SIGMA0, SIGMA1, SIGMA2 = 2e4, 20.0, 0.1
DRY, BRISTLES = ss.Coulomb(MU, MU), ss.LuGre(MU, MU, MU, MU, sigma0=SIGMA0, sigma1=SIGMA1, sigma2=SIGMA2, v_s=1e-2)


@dataclass(frozen=True, eq=False)
class Tip(ss.Machine):
    """A tip under Coulomb friction and its guide under LuGre friction; the tip may rub on the guide's carriage too, or have a stop."""

    push: float
    friction: Any
    guide: Any
    shape: str = "plain"
    omega: float = 60.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        tip = ss.Body(MASSES[0], force=lambda t, x, v: self.push * sin(self.omega * t))
        return {"tip": tip, "slide": ss.Body(MASSES[1], force=lambda t, x, v: 0.3 * cos(self.omega * t))}

    def contacts(self):
        plain = {"tip": ss.Contact("tip", self.friction, load=LOAD), "guide": ss.Contact("slide", self.guide, load=LOAD)}
        more = {
            "two feet": {"other": ss.Contact("tip", self.friction, load=0.3, on=0.05), "side": ss.Contact("tip", self.guide, load=0.2)},
            "on the carriage": {"over": ss.Contact("tip", self.friction, on="slide", load=0.1)},
        }
        return plain | more.get(self.shape, {})

    def links(self):
        return {("tip", "slide"): ss.Spring(STIFFNESS, damping=0.2)}

    def stops(self):
        return {("tip", None): ss.Stop(gap=0.01, restitution=0.5)} if self.shape == "stop" else {}


def by_scipy(push, omega, end):
    """Positions at the end, mode by mode: the tip rests until what pushes it is more than it bears."""

    def rates(t, y, side):
        x, v, s, w, z = y
        pull = STIFFNESS * (x - s) + 0.2 * (v - w)
        bent = w - SIGMA0 * abs(w) * z / (LOAD * MU)
        slide = (0.3 * np.cos(omega * t) + pull - SIGMA0 * z - SIGMA1 * bent - SIGMA2 * w) / MASSES[1]
        tip = 0.0 if side == 0 else (push * np.sin(omega * t) - pull - side * MU * LOAD) / MASSES[0]
        return [v if side else 0.0, tip, w, slide, bent]

    def offered(t, y):
        return push * np.sin(omega * t) - STIFFNESS * (y[0] - y[2]) - 0.2 * (y[1] - y[3])

    def limit(way):
        at = lambda t, y, side: MU * LOAD - way * offered(t, y)  # noqa: E731
        at.terminal, at.direction = True, -1.0
        return at

    def stopped(t, y, side):
        return side * y[1]

    stopped.terminal, stopped.direction = True, -1.0
    t, y, side = 0.0, np.zeros(5), 0
    while t < end:
        events = [limit(1), limit(-1)] if side == 0 else [stopped]
        found = solve_ivp(rates, (t, end), y, "Radau", rtol=1e-9, atol=1e-13, args=(side,), events=events)
        t, y = found.t[-1], found.y[:, -1].copy()
        if found.status == 1:
            if side:
                y[1] = 0.0
                side = 0 if abs(offered(t, y)) < MU * LOAD else int(np.sign(offered(t, y)))
            else:
                side = int(np.sign(offered(t, y)))
    return y[[0, 2]]


def test_a_run_is_that_of_scipy_by_hand():
    machine = Tip(0.5, DRY, BRISTLES)
    run = ss.solve(machine, periods=2, rtol=1e-9)
    assert run.method in ("Rodas5P", "Rodas4")
    assert run.at(2 * run.period_time)["x"] == pytest.approx(by_scipy(0.5, 60.0, 2 * run.period_time), abs=1e-8)
    resting = run.contacts["tip"].mode == 0
    assert resting.any() and not run.bodies["tip"].v[resting].any()  # a set-valued law rests exactly, to a tolerance or not


@each_row("shape", ["two feet", "on the carriage"])
def test_it_agrees_with_the_judge_and_its_energy_balances(shape):
    machine = Tip(0.5, DRY, BRISTLES, shape)
    half = 0.5 * machine.period
    run, judged = (ss.solve(machine, duration=half, rtol=1e-7, method=method) for method in ("auto", "radau"))
    t = np.linspace(0.0, half, 51)
    assert np.max(abs(run.at(t)["x"] - judged.at(t)["x"])) < 1e-6 and ss.energy(run).worst < 1e-5
    events, wanted = ([(e.kind, e.part) for e in each.events] for each in (run, judged))
    assert events == wanted and np.allclose([e.t for e in run.events], [e.t for e in judged.events], rtol=0, atol=1e-5)


def test_a_batch_has_the_numbers_of_its_runs_and_an_orbit_the_multipliers_of_its_differences():
    machine, pushes = Tip(0.5, DRY, BRISTLES), np.array([0.4, 0.5, 0.6])
    many = ss.solve(machine.replace(push=pushes), periods=12, keep="summary")
    runs = [ss.solve(machine.replace(push=push), periods=12) for push in pushes.tolist()]
    assert many.mean_velocity == pytest.approx([ss.mean_velocity(run) for run in runs], rel=1e-6, abs=1e-9)
    fractions = [[each.stick_fraction for each in ss.motion(run).contacts.values()] for run in runs]
    assert many.stick_fraction == pytest.approx(np.array(fractions), abs=1e-6)
    orbit = ss.periodic_orbit(machine)
    wanted = np.poly(difference_jacobian(machine, orbit.state, rtol=1e-11))
    assert np.poly(orbit.multipliers) == pytest.approx(wanted, abs=1e-5)


def test_what_is_not_compiled_says_why():
    with pytest.raises(ss.InputError, match="others have inner states, and it has a stop with restitution"):
        ss.solve(Tip(0.5, DRY, BRISTLES, "stop"), periods=1, method="rodas5p")
