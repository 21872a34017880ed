"""Random machines in the plane with contacts that hold on both sides, against SciPy in plain Python: no silent disagreement.

A machine is one of five forms, under one of the laws that may rest exactly, with random numbers and a random start. A run either ends as
the judge's does, event by event, or says by its status that it did not finish.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from models.machines.test_any_coordinates import CartPole as LoadedPole, DoublePole, arm
from models.machines.test_landings import Ball, Hopper, Particle, Rod, Rotor
from stickslip.machines import BlockOnWedge, CartPole
from stickslip.maths import cos, sin

FAR = 1e-7  # of a motion: what may lie between two right answers after some events


@dataclass(frozen=True, eq=False)
class Crank(ss.Machine):
    """A disc whose bob turns about a pivot that rubs; a body on a slope is pulled by it through a spring."""

    bob: float
    block: float
    slope: float
    stiffness: float
    friction: Any
    coordinates = ("angle", "down")
    time_scale = 1.0

    def bodies(self):
        return {"disc": ss.Body(self.bob, inertia=0.02), "block": ss.Body(self.block)}

    def places(self, t, q):
        disc = (0.3 * sin(q["angle"]), -0.3 * cos(q["angle"]), q["angle"])
        return {"disc": disc, "block": (0.8 + q["down"] * cos(self.slope), -q["down"] * sin(self.slope))}

    def links(self):
        return {("disc", "block"): ss.Spring(self.stiffness, length=0.6)}

    def contacts(self):
        return {"pivot": ss.Contact("angle", self.friction, load=0.5), "slope": ss.Contact("block", self.friction, load=self.block * 9.0)}


def laws(rng):
    """One of each law that may rest exactly, with random numbers."""
    mu, other = rng.uniform(0.02, 0.35, 2)
    return {
        "Coulomb": ss.Coulomb(mu, other),
        "CoulombViscous": ss.CoulombViscous(mu, other, mu, other, viscous=0.3 * rng.random(), quadratic=0.1),
        "Tabulated": ss.friction.Tabulated.example(),
        "static above kinetic": ss.Coulomb(mu, other, f_plus=mu * (1 + rng.random()), f_minus=other * (1 + rng.random())),
        "Stribeck": ss.Stribeck(mu, other, f_plus=mu * (1 + rng.random()), f_minus=other * (1 + rng.random()), v_s=rng.uniform(0.05, 0.5)),
    }


FORMS = {
    "cart and pole on a rail": lambda rng, law: CartPole(*rng.uniform(0.3, 2.0, 2), rng.uniform(0.3, 1.0), law),
    "pushed cart and pole": lambda rng, law: LoadedPole(
        *rng.uniform(0.3, 2.0, 2), rng.uniform(0.3, 1.0), law, *rng.uniform([2.0, 2.0], [12.0, 9.0])
    ),
    "block on a wedge": lambda rng, law: BlockOnWedge(*rng.uniform(0.3, 2.0, 2), rng.uniform(0.1, 1.2), law),
    "arm": lambda rng, law: arm(law, *rng.uniform(2.0, 8.0, 2)),
    "two pendulums on a rail": lambda rng, law: DoublePole(law),
    "crank": lambda rng, law: Crank(*rng.uniform([0.3, 0.3, 0.1, 2.0], [2.0, 2.0, 1.0, 40.0]), law),
}


def drawn(form, law, seed):
    """A machine, and where it begins."""
    rng = np.random.default_rng(seed)
    machine = FORMS[form](rng, laws(rng)[law])
    names = machine.coordinates
    return machine, {"x": dict(zip(names, rng.uniform(-1.2, 1.2, len(names)), strict=True)), "v": {names[0]: rng.normal() * 0.5}}


def compared(form, law, seed, most=2.0):
    """ "agrees", what it says, or how far it lies from the judge."""
    try:
        machine, start = drawn(form, law, seed)
        run = ss.solve(machine, duration=most, start=start)
    except ss.InputError as refused:
        return f"refused: {str(refused)[:90]}"
    if run.status != "finished":
        return f"says {run.status}"
    judge = ss.solve(machine, duration=most, start=start, method="dop853", rtol=1e-12)
    if judge.status != "finished" or len(run.events) != len(judge.events):
        return f"DIFFERS: {len(run.events)} events and {len(judge.events)} of the judge, which {judge.status}"
    late = max((abs(a.t - b.t) for a, b in zip(run.events, judge.events, strict=True)), default=0.0)
    off = np.max(abs(np.r_[run.x[-1] - judge.x[-1], run.v[-1] - judge.v[-1]]))
    return "agrees" if max(late, off) < FAR else f"DIFFERS: by {late:.1e} s and {off:.1e}"


@pytest.mark.parametrize("form", ["cart and pole on a rail", "block on a wedge", "arm"])
def test_random_machines_in_the_plane_are_those_of_the_judge(form):
    assert compared(form, "Coulomb", 0, 1.0) == "agrees"


@pytest.mark.slow
@pytest.mark.parametrize("law", laws(np.random.default_rng(0)))
def test_no_random_machine_in_the_plane_disagrees_silently(law):
    """Four of each form; at most 2 % of those that are accepted say that they did not finish."""
    said = {(form, seed): compared(form, law, seed) for form in FORMS for seed in range(4)}
    said = {which: what for which, what in said.items() if not what.startswith("refused")}
    assert not {which: what for which, what in said.items() if what.startswith("DIFFERS")}
    assert sum(what != "agrees" for what in said.values()) <= 0.02 * len(said)


class Bowl(Particle):
    """A particle on ground that is a parabola."""

    def ground(self, x):
        return self.steep * x + self.radius * x**2 / 2


def landing(form, rng):
    """A machine with a point that may fly, and where it begins."""
    law, e = ss.Coulomb(*rng.uniform(0.02, 0.8, 2)), rng.choice([0.0, rng.uniform(0.0, 0.9)])
    if form == "ball":
        return Ball(law, e), {"x": {"z": rng.uniform(0, 1)}, "v": {"x": rng.normal(), "z": rng.uniform(0, 2)}}
    if form == "rod":
        half, angle = rng.uniform(0.1, 1.0), rng.uniform(-3, 3)
        start = {"z": abs(half * np.sin(angle)) + rng.uniform(0, 0.5), "angle": angle}
        return Rod(half, law, e), {"x": start, "v": {"x": rng.normal() * 2, "angle": rng.normal() * 3, "z": rng.normal() * 0.5}}
    if form == "hopper":
        return Hopper(rng.uniform(50, 500), law, e), {"x": {"stretch": rng.uniform(-0.6, 0.3)}, "v": {"x": rng.normal() * 2}}
    if form == "rotor":
        return Rotor(rng.uniform(0.3, 4), law, e), {"x": {"z": rng.uniform(0, 0.01)}, "v": {}}
    steep, bend, x = rng.uniform(-0.6, 0.6), rng.uniform(-1, 2), rng.normal()
    height = steep * x + bend * x**2 / 2 + rng.uniform(0, 0.5)
    return Bowl(law, e, steep, bend), {"x": {"x": x, "z": height}, "v": {"x": rng.normal(), "z": rng.uniform(0, 1)}}


@pytest.mark.slow
@pytest.mark.parametrize("form", ["ball", "rod", "hopper", "rotor", "bowl"])
def test_no_random_machine_lands_otherwise_than_the_judge(form):
    """Ten of each form: take-offs, landings and rebounds to their end, event by event."""
    for seed in range(10):
        rng = np.random.default_rng([seed, len(form)])
        machine, start = landing(form, rng)
        end = rng.uniform(0.3, 1.2)
        span = {"duration": end} if machine.period is None else {"periods": int(end * 10) + 1}
        run, judge = (ss.solve(machine, start=start, **span, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
        assert run.status == judge.status and [e.kind for e in run.events] == [e.kind for e in judge.events], seed
        late = [abs(a.t - b.t) for a, b in zip(run.events, judge.events, strict=True)]
        assert max(late, default=0.0) < FAR and np.max(abs(np.r_[run.x[-1] - judge.x[-1], run.v[-1] - judge.v[-1]])) < FAR, seed
