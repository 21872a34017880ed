"""Links and stops that see time: closed forms, the judge, and the balance of energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.time_rates import with_rates
from stickslip.maths import asinh, atan, cos, cosh, exp, hypot, log, maximum, pi, sin, sinh, sqrt, tanh, where, within

G = 9.81


@dataclass(frozen=True, eq=False)
class Plate(ss.Machine):
    """A ball on a plate that moves, elastic where it has a stiffness."""

    amplitude: float
    omega: float
    restitution: float | None = 0.5
    stiffness: float | None = None

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"ball": ss.Body(1.0, force=-G, position=0.02)}

    def plate(self, t):
        return self.amplitude * sin(self.omega * t)

    def stops(self):
        given = {"restitution": self.restitution} if self.stiffness is None else {"stiffness": self.stiffness, "damping": 3.0}
        return {("ball", None): ss.Stop(at=self.plate, side=-1, **given)}


@dataclass(frozen=True, eq=False)
class Roof(ss.Machine):
    """A plate that goes up and down at constant speeds."""

    slope: float
    restitution: float = 0.4
    named: bool = True
    period = 0.4

    def bodies(self):
        return {"ball": ss.Body(1.0, force=-G)}

    def stops(self):
        half, breaks = 0.5 * self.period, (0.0, 0.5 * self.period)
        at = lambda t: self.slope * (half - abs(within(t, self.period) - half))  # noqa: E731
        return {("ball", None): ss.Stop(at=at, side=-1, restitution=self.restitution, breaks=breaks if self.named else ())}


@dataclass(frozen=True, eq=False)
class Mesh(ss.Machine):
    """Two wheels; the stiffness between them changes between two values, or as a cosine."""

    low: float
    high: float
    damping: float = 0.0
    rubs: bool = False
    period = 0.5

    def stiffness(self, t):
        if self.rubs:
            return 0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * cos(2 * pi / self.period * t)
        return where(within(t, self.period) < 0.2, self.low, self.high)

    def bodies(self):
        push = 1.0 if self.rubs else 0.0
        return {"a": ss.Body(1.0, force=push), "b": ss.Body(3.0, force=-push)}

    def contacts(self):
        return {"a": ss.Contact("a", ss.Coulomb(0.5, 0.5), load=1.0)} if self.rubs else {}

    def links(self):
        return {("a", "b"): ss.machines.Link(force=lambda t, distance, rate: self.stiffness(t) * distance + self.damping * rate)}


@dataclass(frozen=True, eq=False)
class Leg(ss.Machine):
    """Two feet at a distance that is prescribed."""

    omega: float
    position: float = 0.02

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"front": ss.Body(1.0, position=self.position), "back": ss.Body(2.0)}

    def contacts(self):
        return {name: ss.Contact(name, ss.Coulomb(0.05, 0.1)) for name in ("front", "back")}

    def links(self):
        return {("front", "back"): ss.machines.Link(distance=lambda t: 0.02 + 0.005 * sin(self.omega * t))}


def test_a_ball_bounces_once_a_period_as_the_formula_says():
    """It leaves at g T/2 and comes back with as much, so that the plate has w = (1 - e)/(1 + e) g T/2 there: relative to it -g T/2 - w."""
    omega, e = 60.0, 0.5
    lift = G * np.pi / omega
    w = (1 - e) / (1 + e) * lift
    amplitude = 1.3 * w / omega  # more than is needed: a phase with cos < 1 is stable, that at which the plate brakes
    cycle = ss.periodic_orbit(Plate(amplitude, omega, e), guess=_touching(amplitude, omega, w, lift))
    run = cycle.run
    assert [event.velocity for event in run.events] == pytest.approx([-lift - w] * len(run.events), rel=1e-9) and run.events


def _touching(amplitude, omega, w, lift):
    """Position and velocity at t = 0 of the ball that bounces once a period."""
    hit = np.arccos(w / (amplitude * omega)) / omega
    flown = 2 * np.pi / omega - hit
    at = amplitude * np.sin(omega * hit)
    return {"x": at + lift * flown - 0.5 * G * flown**2, "v": lift - G * flown}


def test_a_stiffness_that_switches_has_the_multipliers_of_the_product_of_two_turns():
    """Meissner's equation of the distance, with the reduced mass 3/4; the centre of mass has the multiplier 1."""
    low, high = 30.0, 60.0
    turn = np.eye(2)
    for k, time in ((low, 0.2), (high, 0.3)):
        w = np.sqrt(k / 0.75)
        turn = np.array([[np.cos(w * time), np.sin(w * time) / w], [-w * np.sin(w * time), np.cos(w * time)]]) @ turn
    multipliers = ss.periodic_orbit(Mesh(low, high)).multipliers
    assert np.poly(multipliers) == pytest.approx(np.convolve(np.poly(turn), [1.0, -1.0]), abs=1e-10)


@each_row(
    ("machine", "far"),
    [
        (Plate(0.02, 30.0), 1e-8),
        (Plate(0.02, 30.0, None, 2000.0), 1e-8),
        (Roof(0.3), 1e-11),
        (Roof(2.0), 1e-11),
        (Mesh(300.0, 500.0, 0.5, rubs=True), 1e-10),
        (Leg(30.0), 1e-10),
    ],
)
def test_a_run_is_that_of_the_judge_and_its_energy_balances(machine, far):
    run, judged = (ss.solve(machine, periods=3, **how) for how in ({}, {"method": "dop853", "rtol": 1e-10}))
    t = np.linspace(0.0, 3 * run.period_time, 301)
    assert run.method == "exact" and np.max(abs(run.at(t)["x"] - judged.at(t)["x"])) < far
    assert ss.energy(run).worst < 1e-10 and ss.energy(run).drive.sum() > 0


def test_a_stop_that_moves_is_turned_round_in_the_mirror():
    run, image = (ss.solve(made, periods=8) for made in (Plate(0.02, 30.0), ss.dynamics.mirrored(Plate(0.02, 30.0))))
    t = np.linspace(0.0, 8 * run.period_time, 801)
    assert np.array_equal(image.at(t)["x"], -run.at(t)["x"])


def test_rates_of_a_function_of_time_are_its_derivatives():
    """Against differences, for every function that may stand in one."""
    functions = [
        exp, lambda t: log(1.5 + t), lambda t: sqrt(1.5 + t), sin, cos, atan, sinh, cosh, tanh, asinh, lambda t: hypot(t, 2.0),
        lambda t: maximum(t * t, 0.1), lambda t: where((t > 0.1) & (t < 3.0), t**3, -t), lambda t: 2.0 / (3.0 + t), lambda t: 2.0**t,
        lambda t: abs(t - 5.0) ** 1.5, lambda t: within(t + 0.3, 0.4), lambda t: t**t, lambda t: 1.0 - t,
    ]  # fmt: skip
    t, h = np.array([0.45, 0.7]), 1e-4
    for function in functions:
        value, rate, second = with_rates(function, t)
        before, after = (np.array([function(float(s)) for s in t + d]) for d in (-h, h))
        assert value == pytest.approx([function(float(s)) for s in t], rel=1e-15)
        assert rate + 0 * t == pytest.approx((after - before) / (2 * h), rel=1e-6, abs=1e-7)
        assert second + 0 * t == pytest.approx((after - 2 * value + before) / h**2, rel=1e-5, abs=1e-6)


@each_row(
    ("make", "said"),
    [
        (lambda: ss.Stop(restitution=0.5), "gap = None and at = None; allowed is one of the two; type gap=0.01"),
        (lambda: ss.Stop(gap=0.1, at=sin, restitution=0.5), "allowed is one of the two"),
        (lambda: ss.Stop(at=0.1, restitution=0.5), "at = 0.1 has no position and no velocity and no acceleration"),
        (lambda: ss.machines.Link(), "allowed is force or distance"),
        (lambda: ss.machines.Link(force=lambda x, v: x), "allowed is a function of t, distance, rate"),
        (lambda: ss.machines.Link(force=lambda t, x, v: x, distance=sin), "allowed is one of force and distance"),
        (lambda: Leg(30.0, position=0.01), r"prescribes a distance of 0.02 m at t = 0, .* 0.01 m apart; type position=0.02"),
        (lambda: ss.solve(Roof(0.3, named=False), periods=2), r"does not name their instants; type breaks=\(...\)"),
    ],
)
def test_what_is_wrong_with_a_link_or_a_stop_is_said(make, said):
    with pytest.raises(ss.InputError, match=said):
        make()
