"""Points of bodies in the plane that leave the ground, fly and land: by hand, by SciPy's judge, and at all doors."""

from __future__ import annotations

import re
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.status import Status
from stickslip.dynamics.derivatives.tangents import jacobian_of
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map
from stickslip.maths import cos, sin, sqrt
from stickslip.results.events import flights_of

G = 9.81


@dataclass(frozen=True, eq=False)
class Ball(ss.Machine):
    """A particle above the ground."""

    friction: Any
    restitution: float
    coordinates = ("x", "z")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"ball": ss.Body(0.5)}

    def places(self, t, q):
        return {"ball": (q["x"], q["z"])}

    def contacts(self):
        return {"ground": ss.Contact("ball", self.friction, hold="push", restitution=self.restitution)}


@dataclass(frozen=True, eq=False)
class Rod(ss.Machine):
    """A uniform rod of 1 kg by the place of its middle, which has a foot at one end."""

    half: float
    friction: Any
    restitution: float
    coordinates = ("x", "z", "angle")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"rod": ss.Body(1.0, inertia=self.half**2 / 3)}

    def places(self, t, q):
        return {"rod": (q["x"], q["z"], q["angle"])}

    def contacts(self):
        return {"foot": ss.Contact("rod", self.friction, at=(-self.half, 0.0), hold="push", restitution=self.restitution)}


@dataclass(frozen=True, eq=False)
class Hopper(ss.Machine):
    """A box on the ground with a mass on a spring in it."""

    stiffness: float
    friction: Any
    restitution: float
    coordinates = ("x", "z", "stretch")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"box": ss.Body(1.0), "mass": ss.Body(0.5)}

    def places(self, t, q):
        return {"box": (q["x"], q["z"]), "mass": (q["x"], q["z"] + 0.3 + q["stretch"])}

    def forces(self, t, q, u):
        return {"stretch": -self.stiffness * q["stretch"]}

    def contacts(self):
        return {"foot": ss.Contact("box", self.friction, hold="push", restitution=self.restitution)}


HOP = {"x": {"stretch": -0.4}, "v": {"x": 2.0}}


def hopper(restitution, stiffness=200.0):
    return Hopper(stiffness, ss.Coulomb(0.3, 0.3), restitution)


def agrees(model, start, duration, within=1e-11):
    """The exact run, held against the judge: events, last state and load, and the energy balance of both to rounding."""
    run, judge = (ss.solve(model, duration=duration, start=start, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
    assert run.method == "exact" and run.status == judge.status
    assert [(e.kind, e.part) for e in run.events] == [(e.kind, e.part) for e in judge.events]
    for of in ("t", "velocity"):
        pairs = [(getattr(a, of), getattr(b, of)) for a, b in zip(run.events, judge.events, strict=True) if getattr(a, of) is not None]
        assert np.max(abs(np.diff(pairs)), initial=0.0) < within
    for name in ("x", "v", "load"):
        assert np.allclose(getattr(run, name)[-1], getattr(judge, name)[-1], rtol=0, atol=10 * within)
    assert np.max(abs(ss.energy(run).residual)) < 1e-14 and np.max(abs(ss.energy(judge).residual)) < 1e-11
    return run


def test_a_ball_bounces_slides_and_stops_by_hand():
    """Hits at t1 (1 + 2 e + 2 e^2 ...), each takes mu (1 + e) of its speed along; after their limit it slides on with mu g."""
    mu, e, height, first = 0.1, 0.5, 1.0, 2.0
    run = agrees(Ball(ss.Coulomb(mu, mu), e), {"x": {"z": height}, "v": {"x": first}}, 2.1)
    fall, speed = np.sqrt(2 * height / G), np.sqrt(2 * G * height)
    landings = [event for event in run.events if event.kind == "landing"]
    n = np.arange(len(landings))
    assert len(n) > 20 and run.events[-1].kind == "stick"
    assert np.allclose([event.t for event in landings], fall * (1 + 2 * e * (1 - e**n) / (1 - e)), rtol=0, atol=1e-13)
    assert np.allclose([event.velocity for event in landings], -speed * e**n, rtol=0, atol=1e-14)
    limit, along = fall * (1 + e) / (1 - e), first - mu * (1 + e) * speed / (1 - e)
    assert 0.0 < limit - landings[-1].t < 1e-8 * 0.5 * 4  # rebounds that are over within 1e-8 of the time scale are over at once
    end = limit + along / (mu * G)
    assert run.events[-1].t == pytest.approx(end, abs=1e-8) and run.t[-1] == pytest.approx(2.1)
    energy = ss.energy(run)
    assert energy.damping_of["ground (hits)"].sum() == pytest.approx(0.5 * G * height, rel=1e-8)
    assert energy.friction.sum() == pytest.approx(0.25 * first**2, rel=1e-12)


def hit_by_hand(half, angle, v, mu, e):
    """Rates of the rod after a hit of its foot: impulses P across and Q along, with the lever arms of the foot."""
    inertia, (ahead, up) = half**2 / 3, (-half * np.cos(angle), -half * np.sin(angle))
    n, g = np.array([0.0, 1.0, ahead]), np.array([1.0, 0.0, -up])
    W = np.diag([1.0, 1.0, 1 / inertia])
    A, B, C = n @ W @ n, n @ W @ g, g @ W @ g
    r, w = n @ v, g @ v
    P, Q = np.linalg.solve([[A, -B], [-B, C]], [-(1 + e) * r, w])
    if abs(Q) > mu * P:
        side = np.sign(Q)
        P = -(1 + e) * r / (A - side * mu * B)
        Q = side * mu * P
    return v + W @ (n * P - g * Q), abs(Q) < mu * P


@each_row(
    "mu, e, angle, along, rate, sticks",
    [
        (0.3, 0.0, 0.9, 0.4, 0.0, False), (0.3, 0.6, 0.9, -3.0, 0.5, False),
        (0.1, 0.6, 2.0, 2.5, 1.0, False), (0.9, 0.3, 1.2, 0.1, -0.7, True),
    ],
)  # fmt: skip
def test_a_rod_hits_the_ground_with_its_foot_by_hand(mu, e, angle, along, rate, sticks):
    """Newton's restitution and Coulomb's friction at a point whose impulses along and across feel one another."""
    half = 0.5
    rod, fall = Rod(half, ss.Coulomb(mu, mu), e), 0.3
    start = {"x": {"z": 1.0, "angle": angle}, "v": {"x": along, "angle": rate}}
    run = ss.solve(rod, duration=fall + 0.3, start=start)
    landing = run.events[0]
    before = np.array([along, -G * landing.t, rate])
    after, rests = hit_by_hand(half, angle + rate * landing.t, before, mu, e)
    node = np.flatnonzero(run.pieces.t == landing.t)[0]
    found = run._states_at(np.array([landing.t]), np.array([node]))[1][0]
    assert landing.kind == "landing" and rests == sticks and np.allclose(found, after, rtol=0, atol=1e-11)
    agrees(rod, start, fall + 0.3)


def test_a_box_hops_lands_and_stays_as_the_judge_says():
    """Without restitution it stays on the ground where it lands; with one rebounds die out, again and again."""
    run = agrees(hopper(0.0), HOP, 0.9)
    assert [event.kind for event in run.events] == ["take-off", "landing", "stick", "take-off", "landing"]
    assert run.bodies["box"].z[-1] == pytest.approx(0.0, abs=1e-14) and run.contacts["foot"].mode[-1] == 0
    whole, (up, down) = ss.hops(run), (run.events[0].t, run.events[1].t)
    assert whole.landings == 2 and whole.speed == -run.events[1].velocity and whole.height == pytest.approx(run.x[:, 1].max(), rel=1e-3)
    assert whole.fraction == pytest.approx((down - up + run.events[4].t - run.events[3].t) / 0.9, rel=1e-12)
    table = ss.friction.Tabulated((0.0, 0.5, 2.0), (0.35, 0.3, 0.25), (0.35, 0.3, 0.25))  # whose conditions are asked at hits too
    many = agrees(Hopper(200.0, table, 0.4), HOP, 1.3)
    assert len(many.events) == 23 and sum(event.kind == "take-off" for event in many.events) == 2
    aloft = many.at([0.3])
    assert aloft["load"][0, 0] == aloft["friction_force"][0, 0] == 0.0
    assert aloft["acceleration"][0, 0] == 0.0 and np.dot([1.5, 0.5], aloft["acceleration"][0, 1:]) == pytest.approx(-1.5 * G, abs=1e-12)
    # a rebound is an event too where its piece begins an instant after it, as a rounding of time has it
    contact = SimpleNamespace(inner=(0, 1), name="foot")
    flight = lambda first, last: [[first, last - first], [1.0, -2.0]]  # noqa: E731
    for gap, kinds in ((6e-21, ["landing"]), (0.02, [])):
        coefficients = np.array([flight(0.03, gap), flight(gap, 0.01)])
        pieces = SimpleNamespace(
            layout=SimpleNamespace(contacts=[contact]), mode=np.ones((2, 1)), coefficients=coefficients, t=np.arange(3.0)
        )
        assert [event.kind for _, event in flights_of(pieces, np.ones((2, 1), bool))] == kinds


def test_batches_gradients_and_simulations_know_flights():
    batch = ss.solve(hopper(np.array([0.0, 0.4, 0.7])), duration=2.0, start=HOP)
    singles = [ss.solve(hopper(e), duration=2.0, start=HOP) for e in (0.0, 0.4, 0.7)]
    ways = np.array([run.x[-1] - run.x[0] for run in singles])
    assert batch.status.tolist() == [0, 0, 0] and np.allclose(batch.body_displacement, ways, rtol=0, atol=1e-12)
    found = ss.dynamics.sensitivity(singles[1], wrt=["stiffness", "restitution"])
    for i, name in enumerate(found.names):

        def end(h, name=name, value=found.values[i]):
            moved = ss.solve(hopper(0.4).replace({name: value + h}), duration=2.0, start=HOP)
            return np.r_[moved.mean_velocity, moved.v[-1]]

        one, half = ((end(h) - end(-h)) / (2 * h) for h in (1e-4 * found.values[i], 5e-5 * found.values[i]))
        assert np.allclose(np.r_[found.mean_velocity[i], found.state[i, :3]], (4 * half - one) / 3, rtol=1e-8, atol=1e-9)
    simulation = ss.simulation(hopper(0.4), start=HOP)
    for _ in range(20):
        simulation.step(0.1)
    assert [*simulation.state["x"]] == pytest.approx(singles[1].x[-1].tolist(), abs=1e-11)


def test_gradients_pass_through_hits_of_a_foot_whose_gap_depends_on_the_numbers():
    start, rod = {"x": {"z": 1.0, "angle": 0.9}, "v": {"x": 0.2}}, Rod(0.5, ss.Coulomb(0.3, 0.3), 0.5)
    run = ss.solve(rod, duration=0.8, start=start)
    found = ss.dynamics.sensitivity(run, wrt=["half"])
    ends = [ss.solve(rod.replace({"half": 0.5 + h}), duration=0.8, start=start) for h in (1e-4, -1e-4, 5e-5, -5e-5)]
    v = [of.v[-1] for of in ends]
    assert len(run.events) == 2
    assert np.allclose(found.state[0, :3], (4 * (v[2] - v[3]) / 1e-4 - (v[0] - v[1]) / 2e-4) / 3, rtol=1e-7, atol=1e-8)


def test_where_a_foot_lands_or_begins_and_no_one_load_follows_the_run_ends():
    start, slips = ({"x": {"z": z, "angle": 2.0}, "v": {"x": 3.0}} for z in (1.0, 0.5 * np.sin(2.0)))
    pulled = type("Pulled", (Rod,), {"gravity": -5.0})
    stays = type("Stays", (Rod,), {"contacts": lambda self: {"foot": Rod.contacts(self)["foot"].replace(restitution=None)}})
    for method in ("auto", "dop853"):
        for kind in (stays, pulled):  # no load follows; one does, or it could fly
            with pytest.raises(SolveError, match="ended at its start, t = 0 s: friction presses back"):
                ss.solve(kind(0.5, ss.Coulomb(1.5, 1.5), 0.0), duration=0.1, start=slips, method=method)
        assert ss.solve(pulled(0.5, ss.Coulomb(0.3, 0.3), 0.0), duration=0.1, start=slips, method=method).x[-1, 1] > 0.02
        run = ss.solve(Rod(0.5, ss.Coulomb(1.5, 1.5), 0.0), duration=0.6, start=start, method=method)
        assert run.status == Status.PAINLEVE.sentence
        assert run.t[-1] == pytest.approx(np.sqrt(2 * (1.0 - 0.5 * np.sin(2.0)) / G), abs=1e-12)
    jams = {"x": {"z": 0.38 * np.sin(1.1), "angle": 1.1}, "v": {"x": -0.3}}  # static friction would press it on without end
    assert [event.kind for event in agrees(Rod(0.38, ss.Coulomb(0.2, 0.95, 0.25, 1.39), 0.0), jams, 0.15).events] == ["stick"]


def test_the_equations_have_the_flight_and_the_rebound():
    text = ss.latex(hopper(0.4))
    assert r"N &= R = 0, && h > 0" in text and r"\dot h^+ &= - \mathrm{restitution} \, \dot h^-" in text and "&= N - " in text


@each_row(
    "x, v, words",
    [
        ({"z": 0.1, "angle": 0.5}, {}, "m below what it rubs on at the start; allowed is on it or above"),
        ({"z": 0.5 * np.sin(0.5), "angle": 0.5}, {"z": -1.0}, "moves into it at 1 m/s"),
    ],
)
def test_a_flying_point_begins_on_the_ground_or_above(x, v, words):
    with pytest.raises(InputError, match=re.escape(words)):
        ss.solve(Rod(0.5, ss.Coulomb(0.3, 0.3), 0.3), duration=1.0, start={"x": x, "v": v})


@each_row("restitution, hold, words", [(1.0, "push", "from 0 to below 1"), (0.3, "both", 'type hold="push"')])
def test_a_restitution_is_that_of_ground_that_pushes(restitution, hold, words):
    def contacts(self):
        return {"ground": ss.Contact("ball", self.friction, hold=hold, restitution=self.restitution)}

    with pytest.raises(InputError, match=re.escape(words)):
        type("Other", (Ball,), {"contacts": contacts})(ss.Coulomb(0.1, 0.1), restitution)


@dataclass(frozen=True, eq=False)
class Rotor(ss.Machine):
    """A box with an unbalanced rotor, whose force is `ratio` of its weight."""

    ratio: float
    friction: Any
    restitution: float
    coordinates = ("x", "z")
    period = 0.1

    def bodies(self):
        return {"box": ss.Body(0.2, force=lambda t, x, v: (self.ratio * 0.2 * G * cos(w * t), self.ratio * 0.2 * G * sin(w * t)))}

    def places(self, t, q):
        return {"box": (q["x"], q["z"])}

    def contacts(self):
        return {"foot": ss.Contact("box", self.friction, hold="push", restitution=self.restitution)}


w = 2 * np.pi / Rotor.period


def test_a_hopping_robot_has_orbits_in_the_coordinates_of_its_bodies():
    """Its strobe state has the height and no gap. A hit leaves e^2 of an area of heights and rates; on the ground both are forgotten."""
    robot = Rotor(1.9, ss.Coulomb(0.2, 0.2), 0.3)
    at, flies = coordinates(robot), np.array([0.1, 0.1, 0.004])
    assert at.names == ("v.x", "v.z", "x.z")
    jacobian = jacobian_of(robot, flies)
    assert np.linalg.det(jacobian[1:, 1:]) == pytest.approx(0.3**2, rel=1e-12)
    beside = [strobe_map(robot, [flies + 1e-6 * side * np.eye(3)[k] for side in (1, -1)]).state for k in (1, 2)]
    assert np.allclose(jacobian[:, 1:], np.array([(a - b) / 2e-6 for a, b in beside]).T, rtol=1e-7, atol=1e-7)
    stays = robot.replace({"ratio": 1.5, "restitution": 0.0})
    orbit, run = ss.periodic_orbit(stays), ss.solve(stays, periods=40)
    assert np.max(abs(orbit.multipliers)) < 1e-10 and orbit.mean_velocity == pytest.approx(run.mean_velocity, rel=1e-10)
    hops = ss.hops(run)
    assert hops.landings == 1 and hops.speed == pytest.approx(-[e.velocity for e in run.events if e.kind == "landing"][-1], rel=1e-9)
    speed = ss.dynamics.sensitivity(orbit, wrt=["ratio"])["ratio"]
    ends = [ss.periodic_orbit(stays.replace({"ratio": 1.5 + h}), guess=orbit).mean_velocity for h in (1e-4, -1e-4)]
    assert speed == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-6)
    assert ss.solve(ss.mirrored(stays), periods=40).mean_velocity == pytest.approx(-run.mean_velocity, rel=1e-13)


@dataclass(frozen=True, eq=False)
class Particle(Ball):
    """The same particle on ground that is a curve."""

    steep: float
    radius: float
    hold = "push"

    def contacts(self):
        ground = ss.Contact("ball", self.friction, hold=self.hold, restitution=self.restitution, on=self.ground)
        return {"ground": ground}

    def ground(self, x):
        return self.steep * x


class OnCircle(Particle):
    """On top of a circle."""

    def ground(self, x):
        return sqrt(self.radius**2 - x**2)


class OnWire(Particle):
    """Held on both sides on the wire z = x^2/2, which may be drawn into it by a number that is 0 at first."""

    hold = "both"

    def contacts(self):
        return {"wire": ss.Contact("ball", self.friction, hold=self.hold, on=lambda x: self.steep * x**2 / 2)}


def test_a_particle_slides_and_bounces_down_an_incline_by_hand():
    """a = g (sin - mu cos) and N = m g cos; thrown onto it, hits come after 2 e^n v/(g cos) with the speed v of the first across it."""
    mu, tilt, e = 0.2, np.arctan(0.5), 0.4
    still = agrees(Particle(ss.Coulomb(mu, mu), 0.0, -0.5, 1.0), {"x": {}, "v": {}}, 1.0)
    way = 0.5 * G * (np.sin(tilt) - mu * np.cos(tilt))
    assert np.allclose(still.x[-1], [way * np.cos(tilt), -way * np.sin(tilt)], rtol=0, atol=1e-13)
    assert np.allclose(still.load, 0.5 * G * np.cos(tilt), rtol=1e-14)
    run = agrees(Particle(ss.Coulomb(mu, mu), e, -0.5, 1.0), {"x": {"z": 0.5}, "v": {}}, 1.0)
    fall = np.sqrt(2 * 0.5 / G)
    times, n = [event.t for event in run.events], np.arange(len(run.events))
    assert len(n) > 15 and np.allclose(times, fall * (1 + 2 * e * (1 - e**n) / (1 - e)), rtol=0, atol=1e-13)


def test_a_particle_leaves_a_circle_where_the_textbook_says():
    """From the top with a speed v: at cos a = 2/3 + v^2/(3 g R), without friction."""
    first, radius = 1.0, 0.8
    ball = OnCircle(ss.Coulomb(0.0, 0.0), 0.0, 0.0, radius)
    run = agrees(ball, {"x": {"z": radius}, "v": {"x": first}}, 0.5)
    (off,) = run.events
    place = run.at([off.t])["x"][0]
    assert off.kind == "take-off" and place[1] / radius == pytest.approx(2 / 3 + first**2 / (3 * G * radius), abs=1e-12)
    assert np.hypot(*place) == pytest.approx(radius, abs=1e-14) and run.load[-1, 0] == 0.0 and np.hypot(*run.x[-1]) > radius


def test_a_particle_that_is_held_on_a_curve_is_the_bead_of_one_coordinate():
    """Numbers decide whether a row varies: one that is zero in the first machine of a kind says nothing of the next."""
    law, start = ss.Coulomb(0.2, 0.2), {"x": {"x": -1.0, "z": 0.5}, "v": {}}
    flat = ss.solve(OnWire(law, 0.0, 0.0, 1.0), duration=0.5, start={"x": {}, "v": {"x": 1.5}})
    assert flat.x[-1, 0] == pytest.approx(1.5 * 0.5 - 0.1 * G * 0.25, abs=1e-14)
    run = agrees(OnWire(law, 0.0, 1.0, 1.0), start, 2.5)
    assert [event.kind for event in run.events] == ["reversal", "stick"]
    assert np.max(abs(run.x[:, 1] - run.x[:, 0] ** 2 / 2)) < 1e-14


@dataclass(frozen=True, eq=False)
class OffAxis(Rod):
    """A rod on a rail by a point that may lie in its middle."""

    def contacts(self):
        return {"foot": ss.Contact("rod", self.friction, at=(-self.restitution, 0.0), hold="both")}


def test_a_point_in_the_middle_of_one_machine_is_beside_it_in_the_next():
    """Whether its row varies with the angle belongs to the kind: the second machine had the equations of the first."""
    law, at = ss.Coulomb(0.2, 0.2), 0.5
    ss.solve(OffAxis(0.5, law, 0.0), duration=0.1, start={"x": {"angle": 1.0}, "v": {"x": 1.0}})
    agrees(OffAxis(0.5, law, at), {"x": {"z": at * np.sin(1.0), "angle": 1.0}, "v": {"x": 1.0}}, 0.3)


@each_row(
    "changed",
    [
        {"contacts": lambda self: {"g": ss.Contact("ball", self.friction, load=1.0, on=self.ground)}},
        {"coordinates": ("x",), "places": lambda self, t, q: {"ball": (q["x"], 0.0)}},
    ],
)
def test_a_curve_is_ground_of_a_point_that_can_leave_it(changed):
    with pytest.raises(InputError, match=r"a curve z\(x\) is the ground of a point"):
        type("Other", (Particle,), changed)(ss.Coulomb(0.1, 0.1), 0.0, 0.1, 1.0)


def test_a_small_hop_before_a_large_one_is_not_missed():
    """A rebound of 3 ms that begins and ends in the first part of a step, at whose end the box has been thrown up: its landing counts."""
    box = Hopper(90.12101178708386, ss.Coulomb(0.16746738949842832, 0.327167400266902), 0.7329469686598773)
    agrees(box, {"x": {"stretch": 0.18094226713485173}, "v": {"x": -0.7570648332354118}}, 1.06, within=1e-9)
