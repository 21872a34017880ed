"""Two points of a body on ground that pushes: a rocking block by hand, and falls, slides and tips against a program by hand."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from feet_by_hand import TwoFeet
from rows import each_row
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.fields import leaves
from stickslip.basics.status import Status
from stickslip.engine.tangent import tangent
from stickslip.engine.trace import trace
from stickslip.engine.values import values_of
from stickslip.maths import cos, sin

G, HALF = 9.81, 0.1


@dataclass(frozen=True, eq=False)
class Block(ss.Machine):
    """A block of 1 kg on the corners of its base."""

    half: float
    tall: float
    friction: Any
    restitution: float
    coordinates = ("x", "z", "angle")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, inertia=(self.half**2 + self.tall**2) / 3)}

    def places(self, t, q):
        return {"block": (q["x"], q["z"], q["angle"])}

    def contacts(self):
        ground = {"hold": "push", "restitution": self.restitution}
        places = {"left": (-self.half, -self.tall), "right": (self.half, -self.tall)}
        return {name: ss.Contact("block", self.friction, at=at, **ground) for name, at in places.items()}


def block(mu, e, tall):
    return Block(HALF, tall, ss.Coulomb(mu, mu), e)


def leaning(tilt, tall):
    """A start in which it stands on its right corner."""
    c, s = np.cos(-tilt), np.sin(-tilt)
    return {"x": {"x": HALF - (HALF * c + tall * s), "z": tall * c - HALF * s, "angle": -tilt}, "v": {}}


def test_a_block_rocks_as_housner_says():
    """Each hit leaves 1 - 3/2 sin^2 of the rate, with the corner's angle; between them the block turns about one corner."""
    tall, first, hits = 0.5, 0.1, 6
    run = ss.solve(block(1.0, 0.0, tall), duration=3.0, start=leaning(first, tall))
    corner, pull = np.arctan(HALF / tall), 3 * G / (4 * np.hypot(HALF, tall))
    left, t, lean, rate, times = 1 - 1.5 * np.sin(corner) ** 2, 0.0, first, 0.0, []
    down = lambda t, y: y[0]  # noqa: E731
    down.terminal, down.direction = True, -1
    for _ in range(hits):
        swing = solve_ivp(lambda t, y: [y[1], -pull * np.sin(corner - y[0])], (0.0, 5.0), [lean, rate], "DOP853", events=down,
                          rtol=1e-13, atol=1e-15)  # fmt: skip
        t, lean, rate = t + swing.t[-1], 0.0, -left * swing.y[1, -1]
        times.append(t)
    landings = [event for event in run.events if event.kind == "landing"]
    assert np.allclose([event.t for event in landings], times, rtol=0, atol=1e-11)
    assert [event.part for event in landings] == ["left", "right"] * 3 and run.status == "finished"
    energy = ss.energy(run)
    assert abs(energy.residual).max() < 3e-14 and set(energy.damping_of) == {"left (hits)", "right (hits)"}


def test_rocking_dies_out_and_the_block_stands():
    """Its hits accumulate, and from their limit on it stands on both corners, which bear half of its weight each."""
    tall = 0.5
    run = ss.solve(block(1.0, 0.0, tall), duration=10.0, start=leaning(0.1, tall))
    last = [event.t for event in run.events if event.kind == "landing"][-1]
    assert 8.0 < last < 9.0 and run.status == "finished"
    assert np.allclose(run.load[-1], 0.5 * G, rtol=1e-10) and abs(run.x[-1, 2]) < 1e-12 and np.all(run.contacts["left"].mode[-1:] == 0)


def test_feet_that_rattle_within_a_micrometre_hit_one_by_one():
    """A hit of one corner gives the other nothing where the inertia is m half^2: two balls that bounce, each by itself."""
    tall, e, fall = np.sqrt(2) * HALF, 0.5, {"left": 2e-5, "right": 5e-5 * (1 + 3e-4)}
    height = {name: G * t**2 / 2 for name, t in fall.items()}  # at the left corner's third hit the right one is 7e-12 m up
    by_hand = sorted((t * (1 + 2 * sum(e**k for k in range(1, n + 1))), name) for name, t in fall.items() for n in range(5))[:6]
    start = {"x": {"z": tall + sum(height.values()) / 2, "angle": (height["right"] - height["left"]) / (2 * HALF)}, "v": {}}
    for options in ({}, {"method": "dop853", "rtol": 1e-12}):
        run = ss.solve(block(0.0, e, tall), duration=5.8e-5, start=start, **options)
        landings = [(event.t, event.part) for event in run.events if event.kind == "landing"]
        assert [name for _, name in landings] == [name for _, name in by_hand]
        assert np.allclose([t for t, _ in landings], [t for t, _ in by_hand], rtol=1e-6, atol=0)


def test_a_block_without_friction_stands_and_is_pushed_to_and_fro():
    """What does not rub is held by nothing; at rest it slips with no speed, and no load is without an answer."""
    run = ss.solve(block(0.0, 0.5, 0.3), duration=0.1, start={"x": {"z": 0.3}, "v": {}})
    assert run.status == "finished" and not run.events and np.allclose(run.load[-1], 0.5 * G, rtol=1e-12) and not run.x[-1, 0]


@each_row(
    "mu, e, x, v, end",
    [
        (0.2, 0.0, [0, 0.3, 0], [1.0, 0, 0], 0.6),  # it slides and stops
        (0.5, 0.0, [0, 0.3, 0], [1.0, 0, 0], 0.6),  # it tips over its front corner
        (0.5, 0.0, [0, 0.5, 0], [0.3, 0, 0], 0.35),  # both corners land at once
        (0.2, 0.3, [0, 0.5, 0], [0.3, 0, 0], 0.35),
        (0.5, 0.0, [0, 0.4, -0.3], [-0.5, 0, 1.0], 0.6),  # one after the other
        (0.2, 0.3, [0, 0.6, -1.0], [-2.5, 0, 4.0], 0.4),
        (0.2, 0.7, [0, 0.4, 0.2], [0.5, 0, 0], 0.28),
    ],
)
def test_a_block_falls_slides_and_tips_as_a_program_by_hand_says(mu, e, x, v, end):
    names = ("x", "z", "angle")
    start = {"x": dict(zip(names, x, strict=True)), "v": dict(zip(names, v, strict=True))}
    run = ss.solve(block(mu, e, 0.3), duration=end, start=start)
    events, last = TwoFeet([(-HALF, -0.3), (HALF, -0.3)], (HALF**2 + 0.3**2) / 3, mu, e).run(np.r_[x, v].astype(float), end)
    landings = [(event.t, ["left", "right"].index(event.part)) for event in run.events if event.kind == "landing"]
    by_hand = sorted((t, i) for t, what, i in events if what == "landing")
    assert run.method == "exact" and [i for _, i in landings] == [i for _, i in by_hand]
    assert np.allclose([t for t, _ in landings], [t for t, _ in by_hand], rtol=0, atol=1e-12)
    assert np.allclose(np.r_[run.x[-1], run.v[-1]], last, rtol=0, atol=1e-11)
    assert abs(ss.energy(run).residual).max() < 1e-13
    if e:
        judge = ss.solve(block(mu, e, 0.3), duration=end, start=start, method="dop853", rtol=1e-12)
        assert [(a.kind, a.part) for a in judge.events] == [(b.kind, b.part) for b in run.events]
        for what in ("x", "v", "load"):
            assert np.allclose(getattr(run, what)[-1], getattr(judge, what)[-1], rtol=0, atol=1e-11)


def test_batches_simulations_and_formulas_know_two_feet():
    tall, mu = 0.3, np.array([0.2, 0.5])
    start = {"x": {"z": 0.4, "angle": 0.2}, "v": {"x": 0.5}}
    batch = ss.solve(block(mu, 0.0, tall), duration=0.5, start=start)
    singles = [ss.solve(block(one, 0.0, tall), duration=0.5, start=start) for one in mu]
    assert np.allclose(batch.body_displacement, [run.x[-1] - run.x[0] for run in singles], rtol=0, atol=1e-13)
    simulation = ss.simulation(block(0.2, 0.0, tall), start=start)
    for _ in range(5):
        simulation.step(0.1)
    assert np.allclose(simulation.state["x"], singles[0].x[-1], rtol=0, atol=1e-13)
    thrown = [ss.solve(block(0.2, e, tall), duration=0.4, start={"x": {"z": 0.4}, "v": {"x": 0.5}}) for e in (0.0, 0.3)]
    notes = [ss.dynamics.sensitivity(run, wrt=["half"]).notes for run in thrown]  # both corners hit at one instant, and stay, or do not
    assert notes[0] == () and "left and right land at one instant and are thrown up" in notes[1][0]
    tex = ss.latex(block(1.0, 0.0, 0.5))
    assert r"\ddot z &= N_{\mathrm{left}} + N_{\mathrm{right}} - 9.81 \\" in tex
    assert r"h_{\mathrm{left}} &= z - \mathrm{half} \, \sin{\left(\mathrm{angle} \right)} - \mathrm{tall} \, \cos{\left(" in tex
    assert r"0 \le h_{\mathrm{right}} &\perp N_{\mathrm{right}} \ge 0" in tex


def test_what_does_not_know_several_feet_says_so():
    rocks = block(1.0, 0.0, 0.5)
    on_a_slope = {name: contact.replace(on=lambda x: 0.1 * x) for name, contact in rocks.contacts().items()}
    with pytest.raises(InputError, match="points of one body on a curve"):
        type("Sloping", (Block,), {"contacts": lambda self: on_a_slope})(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)
    upright = {"coordinates": ("x", "z"), "places": lambda self, t, q: {"block": (q["x"], q["z"])}}
    with pytest.raises(InputError, match="no coordinates decide what each of them bears"):
        type("Upright", (Block,), upright)(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)

    def three(self):
        return {**Block.contacts(self), "middle": ss.Contact("block", self.friction, hold="push", restitution=0.0)}

    with pytest.raises(InputError, match="statically indeterminate"):
        type("Three", (Block,), {"contacts": three})(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)


@dataclass(frozen=True, eq=False)
class Leg(ss.Machine):
    """A hip on a leg whose joint rubs, and whose foot is on the ground or off it."""

    friction: Any
    load: float
    restitution: float
    coordinates = ("x", "z", "angle")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"hip": ss.Body(0.5), "leg": ss.Body(0.4, inertia=0.003)}

    def places(self, t, q):
        leg = q["x"] + 0.15 * sin(q["angle"]), q["z"] - 0.15 * cos(q["angle"]), q["angle"]
        return {"hip": (q["x"], q["z"]), "leg": leg}

    def forces(self, t, q, u):
        return {"angle": 0.9 * sin(9.0 * t) - 2.0 * q["angle"], "x": -3.0 * q["x"]}

    def contacts(self):
        foot = ss.Contact("leg", self.friction, at=(0.0, -0.15), hold="push", restitution=self.restitution)
        return {"foot": foot, "joint": ss.Contact("angle", ss.CoulombViscous(1.0, 0.8, viscous=0.01), load=self.load)}


STEEP = ss.Stribeck(0.62, 0.26, 0.95, 0.31, v_s=0.085)  # forwards it presses back on the foot where that slips slowly


def on_its_foot(v):
    return {"x": {"z": 0.3 * np.cos(0.4), "angle": 0.4}, "v": {"x": v}}


@each_row(
    "friction, load, start, duration, kinds",
    [
        (ss.Coulomb(0.4, 0.3), 0.2, {"x": {"z": 0.32, "angle": 0.3}, "v": {"x": 0.5}}, 0.6, {"landing", "stick", "slip"}),
        (STEEP, 0.1, on_its_foot(2.2), 0.2, {"take-off", "landing"}),  # at a start friction is that of the slip there
    ],
)
def test_a_joint_that_rubs_above_a_foot_is_decided_with_it(friction, load, start, duration, kinds):
    """A hit takes the joint's rest away, and the joint's friction changes what the foot bears: against the judge."""
    machine = Leg(friction, load, 0.3)
    run, judge = (ss.solve(machine, duration=duration, start=start, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
    assert [(a.kind, a.part) for a in run.events] == [(b.kind, b.part) for b in judge.events] and len(run.events) >= len(kinds)
    assert kinds <= {event.kind for event in run.events} and run.method == "exact"
    assert max(abs(a.t - b.t) for a, b in zip(run.events, judge.events, strict=True)) < 1e-11
    for what in ("x", "v", "load", "friction_force"):
        assert np.allclose(getattr(run, what)[-1], getattr(judge, what)[-1], rtol=0, atol=1e-10)
    assert abs(ss.energy(run).residual).max() < 1e-13
    if friction is STEEP:
        for method in ("auto", "dop853"):  # no combination agrees: a point that would fall does not fly
            with pytest.raises(SolveError, match="ended at its start, t = 0 s: friction presses back"):
                ss.solve(machine, duration=duration, start=on_its_foot(0.03), method=method)
        slower = ss.solve(machine, duration=duration, start=on_its_foot(0.4))  # forces grow beyond all bounds within 1e-13 s
        assert slower.status == Status.PAINLEVE.sentence and 0.0 < slower.t[-1] < 0.01


@dataclass(frozen=True, eq=False)
class Shaken(Block):
    """The block, from its base on, shaken along and across."""

    push: float
    lift: float
    omega: float

    @property
    def period(self):
        return 2 * np.pi / self.omega

    def bodies(self):
        shaken = lambda t, x, v: (self.push * sin(self.omega * t), self.lift * cos(self.omega * t), 0.0)  # noqa: E731
        return {"block": ss.Body(1.0, inertia=(self.half**2 + self.tall**2) / 3, force=shaken)}

    def places(self, t, q):
        return {"block": (q["x"], q["z"] + self.tall, q["angle"])}


def test_small_changes_of_a_start_stay_on_the_ground():
    """On both corners, of which one or both rest: any change is taken to one that lifts none of what touches and slips with none of it."""
    system = trace(block(0.5, 0.0, 0.3))
    settled, (names, angle) = tangent(system, ()).settled, ([y.name for y in system.y], 0.3)
    rng = np.random.default_rng(1)
    a, d = HALF * np.array([-1.0, 1.0]), -0.3
    x, z = a * np.cos(angle) - d * np.sin(angle), a * np.sin(angle) + d * np.cos(angle)
    v, S = rng.normal(size=3), dict(zip(names, rng.normal(size=len(names)), strict=True))
    known = {y.name: 0.0 for y in system.y} | {
        "half": HALF,
        "tall": 0.3,
        "restitution": 0.0,
        "friction.mu_plus": 0.5,
        "friction.mu_minus": 0.5,
    }
    known |= dict(zip([names[k] for k in (*range(3), *system.positions)], [*v, 0.0, 0.4, angle], strict=True)) | {
        f"d {n}": S[n] for n in names
    }
    for flies, rests in itertools.product([(0, 0), (0, 1), (1, 0)], [(1, 1), (0, 1)]):
        modes = dict.fromkeys([mode.name for mode in system.modes], 0.0)
        for k, contact in enumerate(system.contacts):
            modes |= {contact.flight.aloft.name: flies[k], system.modes[contact.modes[0]].name: float(rests[k])}
        values = values_of(system.graph, known | modes, settled.values())
        new = S | {names[k - system.states]: values[of.number] for k, of in settled.items()}
        dv, dq = (np.array([new[names[k]] for k in of]) for of in (range(3), system.positions))
        for k in range(2):
            height, rate = np.array([0.0, 1.0, x[k]]) @ dq, np.array([0.0, 1.0, x[k]]) @ dv - z[k] * v[2] * dq[2]
            slip = np.array([1.0, 0.0, -z[k]]) @ dv - x[k] * v[2] * dq[2]
            gap, gains = (new[names[i]] for i in system.contacts[k].flight.inner)
            assert abs(height - gap) < 1e-12 and abs(rate - gains) < 1e-12 and (flies[k] or gap == gains == 0.0)
            assert flies[k] or rests[k] or abs(slip) < 1e-12


@pytest.mark.slow
def test_gradients_and_multipliers_of_two_feet():
    """Through hits, rests and take-offs: derivatives as differences, multipliers as those of a program by hand."""
    for seed in range(6):
        rng = np.random.default_rng(seed)
        mu, tilt, wrt = rng.uniform(0.1, 1.0), rng.choice([0.0, 0.2]), ["push", "half", "tall", "friction.mu_plus", "omega"]
        machine = Shaken(
            HALF, rng.uniform(0.05, 0.3), ss.Coulomb(mu, mu), rng.choice([0.0, 0.3]), rng.uniform(2, 9), rng.uniform(0, 14), 20.0
        )
        low = HALF * np.sin(tilt) - machine.tall * (1 - np.cos(tilt))
        start = {"x": {"angle": tilt, "z": low + 0.05 * (tilt > 0)}, "v": {"x": rng.normal() * (tilt == 0)}}
        found = ss.dynamics.sensitivity(ss.solve(machine, periods=2, start=start), wrt=wrt)
        for name, slopes in zip(wrt, found.state, strict=True):
            value = dict(leaves(machine))[name]
            near = [ss.solve(machine.replace({name: value * (1 + h)}), periods=2, start=start) for h in (1e-6, -1e-6)]
            far = np.subtract(*[np.r_[run.v[-1], run.x[-1, 1:]] for run in near]) / (2e-6 * value)
            assert np.allclose(slopes, far, rtol=1e-5, atol=1e-5), (seed, name)

    push, lift, omega, tall, mu = 8.0, 3.0, 25.0, 0.2, 0.9
    orbit = ss.periodic_orbit(
        Shaken(HALF, tall, ss.Coulomb(mu, mu), 0.0, push, lift, omega), guess=[-0.25, 0.11, 1.22, 0.2 + 0.0034, 0.035]
    )
    side = 1 if orbit.state[4] < 0 else -1
    hand = TwoFeet(
        [(-HALF, -tall), (HALF, -tall)],
        (HALF**2 + tall**2) / 3,
        mu,
        0.0,
        lambda t, q, v: (push * np.sin(omega * t), lift * np.cos(omega * t), 0.0),
    )

    def returned(u):
        along, rate, tilt = u
        x, z = side * HALF * np.cos(tilt) + tall * np.sin(tilt), side * HALF * np.sin(tilt) - tall * np.cos(tilt)
        _, y = hand.run(np.array([0.0, -z, tilt, along, -x * rate, rate]), 2 * np.pi / omega)
        return y[[3, 5, 2]]

    here = np.array([orbit.state[0], orbit.state[2], orbit.state[4]])
    slopes = np.array([(returned(here + h) - returned(here - h)) / 2e-6 for h in 1e-6 * np.eye(3)]).T
    assert np.allclose(returned(here), here, rtol=0, atol=1e-10)
    assert np.allclose(np.sort(abs(np.linalg.eigvals(slopes)))[1:], np.sort(abs(orbit.multipliers))[-2:], rtol=1e-6)


@pytest.mark.slow
def test_no_random_block_falls_otherwise_than_by_hand():
    """400 of them, each until its rebounds are small; all run to their ends."""
    far = {}
    for seed in range(400):
        rng = np.random.default_rng(seed)
        half, tall = rng.uniform(0.05, 0.5, 2)
        mu, e = rng.uniform(0.02, 1.2), rng.choice([0.0, rng.uniform(0.2, 0.9)])
        angle = rng.choice([0.0, rng.uniform(-1.2, 1.2)])
        low = min(side * half * np.sin(angle) - tall * np.cos(angle) for side in (1, -1))
        x = [0.0, -low + rng.choice([0.0, rng.uniform(0.01, 0.4)]), angle]
        v = [rng.normal(), 0.0, 0.0 if x[1] + low < 1e-9 else rng.normal() * 2]
        start = {what: dict(zip(("x", "z", "angle"), values, strict=True)) for what, values in (("x", x), ("v", v))}
        machine, end = Block(half, tall, ss.Coulomb(mu, mu), e), rng.uniform(0.1, 0.5)
        run = ss.solve(machine, duration=end, start=start)
        small = [event.t for event in run.events if event.kind == "landing" and -event.velocity < 2e-2]
        end = min([end, *(t - 1e-6 for t in small)])
        run = ss.solve(machine, duration=end, start=start)
        _, last = TwoFeet([(-half, -tall), (half, -tall)], (half**2 + tall**2) / 3, mu, e).run(np.r_[x, v].astype(float), end)
        off = np.max(abs(np.r_[run.x[-1], run.v[-1]] - last))
        far |= {seed: off} if run.status != "finished" or off > 1e-8 else {}
    assert not far
