"""Contacts that hold a body on both sides, whose loads follow from the motion."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.status import Status
from stickslip.machines import BlockOnWedge

M, BOB, LENGTH, G, MU = 1.0, 0.8, 0.5, 9.81, 0.1
START = {"x": {"angle": 1.5}, "v": {}}


class CartPole(ss.machines.CartPole):
    """One that nothing pushes, so that nothing repeats."""

    period = None


class SlidingRod(ss.machines.SlidingRod):
    """The same of a rod."""

    period, time_scale, velocity_scale = None, 0.5, 1.0


POLE = CartPole(M, BOB, LENGTH, ss.Coulomb(MU, MU))


def by_hand(end):
    """Events and end of the cart with pendulum: accelerations and load as three linear equations, rest and break-away by hand."""
    ml = BOB * LENGTH

    def sliding(y, side):
        c, s = np.cos(y[1]), np.sin(y[1])
        A = [[M + BOB, ml * c, side * MU], [ml * c, ml * LENGTH, 0.0], [0.0, -ml * s, 1.0]]
        return np.linalg.solve(A, [ml * s * y[3] ** 2, -ml * G * s, (M + BOB) * G + ml * c * y[3] ** 2])

    def resting(y):
        c, s = np.cos(y[1]), np.sin(y[1])
        a = -G * s / LENGTH
        return ml * s * y[3] ** 2 - ml * c * a, (M + BOB) * G + ml * (s * a + c * y[3] ** 2)

    def side_of(y):
        R, N = resting(y)
        return 0 if abs(R) < MU * N else int(np.sign(R))

    t, y, events = 0.0, np.array([0.0, 1.5, 0.0, 0.0]), []
    side = side_of(y)
    while t < end:
        if side:
            rates, guards = (lambda t, y, side=side: [y[2], y[3], *sliding(y, side)[:2]]), [lambda t, y, side=side: side * y[2]]
        else:
            rates = lambda t, y: [0.0, y[3], 0.0, -G * np.sin(y[1]) / LENGTH]  # noqa: E731
            guards = [lambda t, y, way=way: MU * resting(y)[1] - way * resting(y)[0] for way in (1, -1)]
        for guard in guards:
            guard.terminal, guard.direction = True, -1
        done = solve_ivp(rates, (t, end), y, "DOP853", rtol=1e-12, atol=1e-13, events=guards)
        t, y = done.t[-1], done.y[:, -1].copy()
        if done.status == 1:
            events.append(t)
            side = side_of(y) if side else 1 if len(done.t_events[0]) else -1
            y[2] = side * 1e-15
    return events, y


def test_a_cart_on_a_rail_is_that_of_a_program_by_hand():
    """Slip, rest and break-away under a load that friction itself changes, to 1e-10; of the judge too."""
    run, judge = (ss.solve(POLE, duration=4.0, start=START, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
    assert run.method == "exact" and {e.kind for e in run.events} >= {"stick", "slip", "reversal"}
    for times, last in (by_hand(4.0), ([e.t for e in judge.events], np.r_[judge.x[-1], judge.v[-1]])):
        assert len(times) == len(run.events) > 1
        assert np.max(abs(np.array(times) - [e.t for e in run.events])) < 1e-10
        assert np.allclose(np.r_[run.x[-1], run.v[-1]], last, rtol=0, atol=1e-10)


def test_the_load_is_what_the_motion_asks_for_and_energy_is_balanced():
    """Weight of both, and mass times the upward acceleration of the bob, while it slips and while it rests; no work is missing."""
    run = ss.solve(POLE, duration=4.0, start=START)
    at = run.at(np.linspace(0.01, 3.99, 500))
    (angle, rate), a = (at[name].T[1] for name in ("x", "v")), at["acceleration"]
    up = LENGTH * (np.sin(angle) * a[:, 1] + np.cos(angle) * rate**2)
    assert np.allclose(at["load"][:, 0], (M + BOB) * G + BOB * up, rtol=0, atol=1e-11)
    rests, friction = at["mode"][:, 0] == 0, at["friction_force"][:, 0]
    assert rests.any() and np.all(abs(friction[rests]) <= MU * at["load"][rests, 0] * (1 + 1e-12))
    assert np.allclose(abs(friction[~rests]), MU * at["load"][~rests, 0], rtol=1e-12)
    assert np.array_equal(run.contacts["rail"].load, run.load[:, 0])
    assert np.max(abs(ss.energy(run).residual)) < 1e-13


def test_gradients_on_a_rail_are_those_of_runs_beside():
    """Central differences with Richardson's extrapolation; the run begins where it was asked to, through slip, stick and break-away."""
    pole = CartPole(M, BOB, LENGTH, ss.Coulomb(MU, 1.2 * MU))
    run = ss.solve(pole, duration=2.0, start=START)
    found = ss.dynamics.sensitivity(run, wrt=["cart", "length", "friction.mu_plus"])
    assert len(run.events) > 2 and found.velocity == pytest.approx(run.mean_velocity, rel=1e-13)
    for i, name in enumerate(found.names):

        def end(h, name=name, value=found.values[i]):
            moved = ss.solve(pole.replace({name: value + h}), duration=2.0, start=START)
            return np.r_[moved.mean_velocity, moved.v[-1], moved.x[-1, 1]]

        one, half = ((end(h) - end(-h)) / (2 * h) for h in (1e-4 * found.values[i], 5e-5 * found.values[i]))
        exact = np.r_[found.mean_velocity[i], found.state[i]]
        assert np.max(abs(exact - (4 * half - one) / 3)) < 1e-9 * np.max(abs(exact))


@each_row("wedge, block, slope, mu", [(2.0, 0.5, 0.5, 0.2), (0.4, 1.3, 0.9, 0.35), (5.0, 0.1, 0.3, 0.0)])
def test_a_block_on_a_wedge_goes_as_in_closed_form(wedge, block, slope, mu):
    """N = m g cos a / (1 + (m/M) sin a (sin a - mu cos a)), and both accelerations by it."""
    run = ss.solve(BlockOnWedge(wedge, block, slope, ss.Coulomb(mu, mu)), duration=1.0)
    c, s = np.cos(slope), np.sin(slope)
    N = block * G * c / (1 + block / wedge * s * (s - mu * c))
    back, down = -N * (s - mu * c) / wedge, (block * G - N * (c + mu * s)) / (block * s)
    assert np.allclose(run.load[1:, 0], N, rtol=1e-12)
    assert np.allclose(run.x[-1], [0.5 * back, 0.5 * down], rtol=0, atol=1e-11)
    assert run.bodies["block"].z[-1] == pytest.approx(-0.5 * down * s, abs=1e-11)
    if mu == 0.0:
        return
    gentle = np.arctan(mu) - 0.05  # it stays on a slope that is not steep
    run = ss.solve(BlockOnWedge(wedge, block, gentle, ss.Coulomb(mu, mu)), duration=1.0)
    assert np.all(run.contacts["face"].mode == 0) and np.allclose(run.x, 0.0, rtol=0, atol=1e-15)
    assert np.allclose(run.contacts["face"].load, block * G * np.cos(gentle), rtol=1e-13)


@each_row(
    "mu, angle, rate, which",
    [(1.5, 1.5, -1.0, 1), (1.5, 0.8, 9.0, -1), (1.34, 1.5, -1.0, 1), (3.0, 0.3, 9.0, -1)],
)  # fmt: skip
def test_a_rod_that_slides_is_inconsistent_from_the_angle_of_painleve_on(mu, angle, rate, which):
    """Where 1 + 3 cos^2 a = 3 mu sin a cos a, whichever way it slips: beyond, no load follows, or two."""
    border = np.arctan((3 * mu + which * np.sqrt(9 * mu**2 - 16)) / 2)
    assert SlidingRod.borders(mu)[(1 + which) // 2] == pytest.approx(border, rel=1e-14)
    for slip in (3.0, -3.0):
        start = {"x": {"angle": angle}, "v": {"x": slip, "angle": rate}}
        run = ss.solve(SlidingRod(1.0, 1.0, ss.Coulomb(mu, mu)), duration=0.5, start=start)
        last = run.coordinates["angle"][-1] % np.pi
        assert run.status == Status.PAINLEVE.sentence and "Painlevé" in run.status and run.t[-1] < 0.5
        assert min(abs(last - border), abs(np.pi - last - border)) < 1e-9
    judge = ss.solve(SlidingRod(1.0, 1.0, ss.Coulomb(mu, mu)), duration=0.5, start=start, method="dop853", rtol=1e-12)
    assert judge.status == run.status and judge.t[-1] == pytest.approx(run.t[-1], abs=1e-10)


def test_below_four_thirds_a_rod_slides_at_any_angle_and_beyond_it_a_run_begins_nowhere():
    """The border is 63.4349 degrees there, where tan a = 2; a batch has a status for each case."""
    start = {"x": {"angle": 1.5}, "v": {"x": 3.0, "angle": -1.0}}
    mu = np.array([4 / 3 - 1e-6, 4 / 3 + 1e-6])
    both = ss.solve(SlidingRod(1.0, 1.0, ss.Coulomb(mu, mu)), duration=0.3, start=start)
    assert both.status.tolist() == [Status.FINISHED, Status.PAINLEVE]
    with pytest.raises(ValueError, match=r"from 4/3 on"):
        SlidingRod.borders(1.3)
    start["x"]["angle"] = np.arctan(2.0)
    for method in ("auto", "dop853"):
        with pytest.raises(SolveError, match=r"at its start.*Painlevé.*smaller friction coefficient"):
            ss.solve(SlidingRod(1.0, 1.0, ss.Coulomb(1.34, 1.34)), duration=0.3, start=start, method=method)
    # a cart whose rail presses on either side: N = N0 + mu N b with b = m sin a cos a / (M + m sin^2 a), to both sides from mu b = 1 on
    start, sine, cosine = {"x": {"angle": 1.0}, "v": {"x": 2.0}}, np.sin(1.0), np.cos(1.0)
    border = (M + BOB * sine**2) / (BOB * sine * cosine)
    below, beyond = (CartPole(M, BOB, LENGTH, ss.Coulomb(mu, mu)) for mu in (border * (1 - 1e-6), border * (1 + 1e-6)))
    assert ss.solve(below, duration=0.3, start=start).t[-1] > 0
    for method in ("auto", "dop853"):
        with pytest.raises(SolveError, match=r"at its start.*Painlevé"):
            ss.solve(beyond, duration=0.3, start=start, method=method)


def both(self, law=None):
    return {"rail": ss.Contact("cart", self.friction, hold="both"), "pivot": ss.Contact("angle", law or self.friction, load=0.1)}


def rail(self, body, **given):
    return {"rail": ss.Contact(body, self.friction, hold="both", **given)}


@dataclass(frozen=True, eq=False)
class FreeRod(SlidingRod):
    """The same rod by the place of its middle: what keeps its foot on the rail is the contact."""

    coordinates = ("x", "z", "angle")

    def places(self, t, q):
        return {"rod": (q["x"], q["z"], q["angle"])}


def agrees(model, start, duration, end):
    """The exact run, held against the judge to 1e-10: events, last state and load, and the energy balance to rounding."""
    run, judge = (ss.solve(model, duration=duration, start=start, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
    assert run.method == "exact" and run.status == judge.status == end
    assert [(e.kind, e.part) for e in run.events] == [(e.kind, e.part) for e in judge.events]
    assert np.max(abs(np.array([a.t - b.t for a, b in zip(run.events, judge.events, strict=True)])), initial=0.0) < 1e-10
    ended = end == Status.PAINLEVE.sentence  # a part of 1e-10 of the border before it, where loads are infinite
    for name in ("x", "v", "load")[: 1 if ended else 3]:
        assert np.allclose(getattr(run, name)[-1], getattr(judge, name)[-1], rtol=0, atol=1e-10)
    assert np.max(abs(ss.energy(run).residual)) < 1e-13
    return run


def test_a_point_of_a_body_on_the_ground_slips_by_what_its_place_says():
    """Its row varies with the angle, and the contact keeps its height: the same motion as by coordinates that do."""
    law, angle = ss.Coulomb(0.2, 0.2), 1.2
    free = FreeRod(1.0, 1.0, law)
    start = {"x": {"x": 0.5 * np.cos(angle), "z": 0.5 * np.sin(angle), "angle": angle}, "v": {"x": 1.0}}
    run = agrees(free, start, 2.0, "finished")
    held = ss.solve(SlidingRod(1.0, 1.0, law), duration=2.0, start={"x": {"angle": angle}, "v": {"x": 1.0}})
    assert len(run.events) == 5 and np.max(abs(np.array([a.t - b.t for a, b in zip(run.events, held.events, strict=True)]))) < 1e-12
    for name in ("x", "z"):
        assert np.allclose(getattr(run.bodies["rod"], name), getattr(held.bodies["rod"], name), rtol=0, atol=1e-12)
    assert np.allclose(run.load, held.load, rtol=0, atol=1e-11)
    assert np.allclose(run.bodies["rod"].z, 0.5 * np.sin(run.coordinates["angle"]), rtol=0, atol=1e-13)


@each_row("x, v, words", [({"z": 0.1}, {}, "is 0.1 m above"), ({"z": 0.0}, {"z": 0.3}, "moves at 0.3 m/s away from")])
def test_a_point_that_is_kept_on_the_ground_begins_there(x, v, words):
    with pytest.raises(InputError, match=words):
        ss.solve(FreeRod(1.0, 1.0, ss.Coulomb(0.2, 0.2)), duration=1.0, start={"x": x, "v": v})


@dataclass(frozen=True, eq=False)
class PushedRod(FreeRod):
    """The same rod on ground that only pushes its foot."""

    def contacts(self):
        return {"foot": ss.Contact("rod", self.friction, at=(-0.5 * self.length, 0.0), hold="push")}


def test_the_ground_under_a_rod_has_a_load_up_to_painleves_border_on_one_side():
    """A foot that is dragged away from its lean passes the angle of a rail's border; one that leans the other way ends at 1 + mu C = 0."""
    mu, angle, rate, half = 1.5, 1.5, -1.0, 0.5
    border = np.arctan((3 * mu + np.sqrt(9 * mu**2 - 16)) / 2)
    for slip, duration, end in ((3.0, 0.1, Status.FINISHED), (-3.0, 0.2, Status.PAINLEVE)):
        x = {"x": half * np.cos(angle), "z": half * np.sin(angle), "angle": angle}
        v = {"x": slip - half * np.sin(angle) * rate, "z": half * np.cos(angle) * rate, "angle": rate}
        run = agrees(PushedRod(1.0, 2 * half, ss.Coulomb(mu, mu)), {"x": x, "v": v}, duration, end.sentence)
        last = run.coordinates["angle"][-1]
        assert last < border - 0.05 if end == Status.FINISHED else abs(np.pi - last - border) < 1e-9


@dataclass(frozen=True, eq=False)
class Hopper(ss.Machine):
    """A box on the ground with a mass on a spring in it."""

    box: float
    inner: float
    stiffness: float
    friction: Any
    coordinates = ("x", "z", "stretch")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"box": ss.Body(self.box), "mass": ss.Body(self.inner)}

    def places(self, t, q):
        return {"box": (q["x"], q["z"]), "mass": (q["x"], q["z"] + 0.3 + q["stretch"])}

    def forces(self, t, q, u):
        return {"stretch": -self.stiffness * q["stretch"]}

    def contacts(self):
        return {"foot": ss.Contact("box", self.friction, hold="push")}


def test_a_box_lifts_off_when_the_mass_in_it_pulls_with_its_weight():
    """N = (M + m) g + k A cos wt while the spring swings about its weight: zero where cos wt = -(M + m) g/(k A); v' = -mu N/(M + m)."""
    M, m, k, mu, first = 1.0, 0.5, 200.0, 0.3, -0.2
    box, start = Hopper(M, m, k, ss.Coulomb(mu, mu)), {"x": {"stretch": first}, "v": {"x": 5.0}}
    swing, omega = -first - m * G / k, np.sqrt(k / m)
    run = agrees(box, start, 1.0, Status.LOST.sentence)
    end = np.arccos(-(M + m) * G / (k * swing)) / omega
    assert run.t[-1] == pytest.approx(end, abs=1e-12) and run.events[-1].kind == "contact lost"
    assert np.allclose(run.load[:, 0], (M + m) * G + k * swing * np.cos(omega * run.t), rtol=0, atol=1e-11)
    lost = mu * (G * end + k * swing * np.sin(omega * end) / (M + m) / omega)
    assert run.v[-1, 0] == pytest.approx(5.0 - lost, abs=1e-12)
    rests = ss.solve(box, duration=1.0, start={"x": {"stretch": first}})
    assert rests.lost_contact and rests.t[-1] == pytest.approx(end, abs=1e-12) and rests.v[-1, 0] == 0.0
    assert np.allclose(run.bodies["box"].z, 0.0, rtol=0, atol=1e-14)


@dataclass(frozen=True, eq=False)
class Bead(ss.Machine):
    """A bead on the wire z = x^2/2."""

    friction: Any
    coordinates = ("x",)
    time_scale, velocity_scale = 1.0, 1.0

    def bodies(self):
        return {"bead": ss.Body(0.7)}

    def places(self, t, q):
        return {"bead": (q["x"], 0.5 * q["x"] ** 2)}

    def contacts(self):
        return {"wire": ss.Contact("bead", self.friction, hold="both")}


def test_a_bead_on_a_curved_wire_turns_where_the_integral_says():
    """With the angle a of the wire d(v^2 e^(2 mu a))/da = -2 g e^(2 mu a) (sin a + mu cos a)/cos^3 a, if it goes forwards."""
    mu, first = 0.2, -np.pi / 4

    def gained(last):
        return quad(lambda a: np.exp(2 * mu * a) * (np.sin(a) + mu * np.cos(a)) / np.cos(a) ** 3, first, last, epsabs=1e-13, epsrel=1e-13)[
            0
        ]

    run = agrees(Bead(ss.Coulomb(mu, mu)), {"x": {"x": -1.0}, "v": {}}, 2.5, "finished")
    turn = brentq(gained, 0.1, 1.2, xtol=1e-15)
    assert [e.kind for e in run.events] == ["reversal", "stick"]
    assert run.at(run.events[0].t)["x"][0] == pytest.approx(np.tan(turn), abs=1e-11)


def test_static_friction_above_kinetic_with_a_load_that_follows():
    """At rest it bears what the load of rest allows, and once it slips what the load of sliding makes."""
    law = ss.Stribeck(0.08, 0.1, f_plus=0.15, f_minus=0.14, v_s=0.1)
    run = agrees(CartPole(1.5, 0.5, 0.5, law), {"x": {"angle": 0.8}, "v": {}}, 1.0, "finished")
    assert {"stick", "slip"} <= {event.kind for event in run.events}
    for angle in (0.2, -0.2):  # whichever way it is pulled, what rests at the start does so from there on
        run = ss.solve(CartPole(1.5, 0.5, 0.5, law), duration=0.1, start={"x": {"angle": angle}, "v": {}})
        assert len(run.events) == 0 and np.all(run.v[:, 0] == 0.0) and run.contacts["rail"].mode[0] == 0


@dataclass(frozen=True, eq=False)
class Hinged(CartPole):
    """The same with a hinge that rubs."""

    hinge: float = 0.2

    def contacts(self):
        return {**super().contacts(), "hinge": ss.Contact("angle", ss.Coulomb(1.0, 1.0), load=self.hinge)}


def test_a_rail_and_a_hinge_that_rubs_are_decided_together():
    """Both rest, one breaks away and takes the other along; derivatives are differences; formulas say what the rail bears."""
    machine, start = Hinged(1.5, 0.5, 0.5, ss.Coulomb(0.1, 0.08, 0.12, 0.1)), {"x": {"angle": 0.8}, "v": {"angle": 2.0}}
    run = agrees(machine, start, 2.0, "finished")
    assert len(run.events) > 5 and {event.part for event in run.events} == {"rail", "hinge"}
    run = ss.solve(machine, duration=0.5, start=start)
    near = [ss.solve(machine.replace({"hinge": 0.2 + h}), duration=0.5, start=start) for h in (1e-6, -1e-6)]
    far = np.subtract(*[np.r_[each.v[-1], each.x[-1, 1:]] for each in near]) / 2e-6
    assert np.allclose(ss.dynamics.sensitivity(run, wrt=["hinge"]).state[0], far, rtol=1e-6, atol=1e-7)
    assert r"N_{\mathrm{rail}} &= \left|" in ss.latex(machine) and r"N_{\mathrm{hinge}} &= " in ss.latex(machine)


@each_row(
    "changed, law, words",
    [
        ({}, ss.friction.LuGre.example(), "has inner states"),
        ({"contacts": lambda self: both(self, ss.friction.LuGre.example())}, ss.Coulomb(0.1, 0.1), "give all loads"),
        ({"contacts": lambda self: {**both(self), "other": both(self)["rail"]}}, ss.Coulomb(0.1, 0.1), "3 points, one rail"),
        ({"contacts": lambda self: {"foot": ss.Contact("cart", self.friction, hold="push")}}, ss.Coulomb(0.1, 0.1), "never leaves it"),
        ({"contacts": lambda self: rail(self, "bob", on=0.1)}, ss.Coulomb(0.1, 0.1), "do not move"),
        ({"contacts": lambda self: rail(self, "cart", on=0.1)}, ss.Coulomb(0.1, 0.1), "do not move"),
    ],
)  # fmt: skip
def test_a_load_that_cannot_be_solved_for_is_said_with_what_to_type(changed, law, words):
    with pytest.raises(InputError, match=re.escape(words)):
        type("Other", (CartPole,), changed)(M, BOB, LENGTH, law)
