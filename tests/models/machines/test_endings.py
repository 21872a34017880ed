"""How runs of machines end: rebounds that die out, stops that jam, loads that are gone, bodies that drift apart, forces that nobody knows.

Each is a status or a note with a sentence, in single runs and in what a sweep stores.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.fields import leaves
from stickslip.basics.status import Status

MASS, PUSH, LOAD, WIDTH, MU = 0.1, 0.3, 1.0, 0.02, 0.5


@dataclass(frozen=True, eq=False)
class Pushed(ss.Machine):
    """A mass that a constant force pushes against a stop in front of it, which is another body that rubs."""

    push: float
    restitution: float
    friction: Any
    rubs: Any = None  # what the pushed mass rubs with itself
    on: Any = None  # and on what

    def bodies(self):
        return {"inner": ss.Body(MASS, force=self.push), "body": ss.Body(MASS)}

    def contacts(self):
        own = {} if self.rubs is None else {"inner": ss.Contact("inner", self.rubs, on=self.on, load=LOAD)}
        return {"body": ss.Contact("body", self.friction, load=LOAD)} | own

    def stops(self):
        return {("inner", "body"): ss.Stop(gap=1e-3, restitution=self.restitution)}


def notes_of(grid):
    return json.loads(grid.attrs.get("notes", "{}"))


def test_rebounds_that_die_out_leave_two_bodies_that_move_as_one():
    """Under mu N tanh(v/w) both go on at w artanh(F/(mu N)), whatever the restitution: the stop stays closed, and the gap with it."""
    grid = ss.sweep(
        Pushed(PUSH, 0.0, ss.friction.TanhCoulomb(mu_plus=MU, mu_minus=MU, width=WIDTH)),
        restitution=[0.0, 0.3, 0.7],
        push=[PUSH, 0.2],
        duration=2.0,
    )
    assert (grid.status == Status.FINISHED).all()
    run = ss.solve(Pushed(PUSH, 0.7, ss.friction.TanhCoulomb(mu_plus=MU, mu_minus=MU, width=WIDTH)), duration=2.0, rtol=1e-9)
    speed = WIDTH * np.arctanh(PUSH / (MU * LOAD))
    assert run.v[-1] == pytest.approx(speed, rel=1e-8)  # the transient is over: exp(-t mu N/(2 m w)) < 1e-20
    assert run.bodies["inner"].x[-1] - run.bodies["body"].x[-1] == pytest.approx(1e-3, abs=1e-12)
    hits = [event.t for event in run.events if event.kind == "hit"]
    assert 5 < len(hits) < 60 and hits[-1] < 0.5  # a geometric series until it is over at once, and no more


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_two_bodies_that_both_rub_go_on_together(restitution):
    """m a = F - 2 mu N of both; impulses of hits are inside, so that the momentum is that of a body which begins to rub when hit."""
    law = ss.Coulomb(0.02, 0.02)
    both = Pushed(PUSH, restitution, law, rubs=law)
    run = ss.solve(both, duration=1.0)
    assert run.status == "finished" and run.v[-1, 0] == pytest.approx(run.v[-1, 1], abs=1e-14)
    last = run.at([0.7, 0.9])
    together = (PUSH - 2 * 0.02 * LOAD) / (2 * MASS)
    assert np.diff(last["v"][:, 0])[0] == pytest.approx(0.2 * together, rel=1e-12)
    assert last["friction_force"] == pytest.approx(0.02, rel=1e-12)
    hit = next(event.t for event in run.events if event.kind == "hit")
    alone = (PUSH - 0.02 * LOAD) / MASS
    assert hit == pytest.approx(np.sqrt(2e-3 / alone), rel=1e-12)
    assert 2 * run.v[-1, 0] == pytest.approx(alone * hit + 2 * together * (1.0 - hit), rel=1e-9)


@each_row("push, ends", [(0.9, 0.0), (1.1, (1.1 - 2 * 0.5) / (2 * MASS))])
def test_one_body_helps_another_to_rest(push, ends):
    """Each holds mu N = 0.5 N: 0.9 N against both rest, and the stop bears what the pushed one cannot; 1.1 N move both."""
    law = ss.Coulomb(MU, MU)
    run = ss.solve(Pushed(push, 0.0, law, rubs=law), duration=1.0)
    assert np.diff(run.at([0.8, 0.9])["v"], axis=0) == pytest.approx(0.1 * ends, abs=1e-13)
    inner, body = run.at([0.9])["friction_force"][0]
    assert inner + body == pytest.approx(min(push, 1.0)) and max(inner, body) <= MU * (1 + 1e-12)


def test_rebounds_on_a_body_that_the_other_one_rubs_on_end_with_a_status():
    law = ss.Coulomb(0.02, 0.02)
    rider = Pushed(PUSH, 0.5, law, rubs=law, on="body")
    grid = ss.sweep(rider, push=[PUSH, 0.0], duration=1.0)
    assert grid.status.values.tolist() == [Status.CHATTERS, Status.FINISHED]
    with pytest.raises(ss.SolveError, match=r'it chatters, or comes to rest in ever shorter jumps.*type method="dop853"'):
        ss.solve(rider, duration=1.0)
    run = ss.solve(rider, duration=1.0, method="dop853", rtol=1e-10)
    assert run.v[-1, 0] == pytest.approx(run.v[-1, 1], abs=1e-12)


@pytest.mark.parametrize("law", [ss.Coulomb(0.2, 0.2), ss.friction.TanhCoulomb(mu_plus=0.2, mu_minus=0.2, width=1e-3)])
def test_a_load_that_jumps_below_zero_is_lost_at_that_instant(law):
    """The track falls away with 2 g in the middle third of a period; with half of it as much load is left, and the run goes on."""
    T, size = 0.03, 9.81
    down = ss.drives.Pieces(durations=(T / 3, T / 3, T / 3), accelerations=(size, -2 * size, size))
    along = ss.Harmonic(amplitude=1e-4, omega=2 * np.pi / T)
    track = ss.MovingTrack(mass=0.02, along=along, across=down, friction=law, restitution=None)
    run = ss.solve(track, periods=4)
    assert run.status == Status.LOST.sentence and run.t[-1] == pytest.approx(T / 3, rel=1e-12)
    half = ss.drives.Pieces(durations=down.durations, accelerations=tuple(a / 4 for a in down.accelerations))
    first = ss.drives.Pieces(durations=down.durations, accelerations=(-2 * size, size, size))
    ends = [ss.sweep(replace(track, across=each), mass=[0.02, 0.05], periods=4, settle=2).status.values.tolist() for each in (down, half)]
    assert ends == [[Status.LOST] * 2, [Status.FINISHED] * 2]
    with pytest.raises(ss.InputError, match=r"the load of the contact 'mass' is -0.1962 N at the start"):
        ss.solve(replace(track, across=first), periods=4)


def test_friction_that_two_feet_share_at_rest_is_noted():
    """Two feet of one rigid body: only the sum follows. Feet whose distance changes never rest at once."""
    robot = ss.Robot(0.0626, 0.0095, ss.Harmonic(amplitude=3e-4, omega=205.0), ss.Coulomb(0.15, 0.21))
    pair = ss.Chain((robot, robot), link=ss.machines.Rigid())
    sentence = "module 1, module 2 rest at once on one body: only the sum of their friction forces"
    assert any(note.startswith(sentence) for note in ss.solve(pair, periods=12).notes)
    noted = [count for note, count in notes_of(ss.sweep(pair, periods=12, **{"modules.0.drive.amplitude": [2e-4, 3e-4]})).items()
             if note.startswith(sentence)]  # fmt: skip
    assert noted == [2]
    many = ss.solve(pair.replace({"modules.0.drive.amplitude": np.array([2e-4, 3e-4])}), periods=12)
    assert any(note.startswith(f"2 of 2 cases: {sentence}") for note in many.notes)
    worm = ss.presets.worm()
    assert not any("rest at once" in note for note in ss.solve(worm, periods=12).notes)


def test_bodies_that_drift_apart_are_noted_by_sweeps():
    robot = ss.Robot(0.0626, 0.0095, ss.Harmonic(amplitude=6e-4, omega=205.0), ss.Coulomb(0.15, 0.21))
    loose = ss.Chain((robot, robot.replace(body_mass=3.0)), ss.Spring(0.0))
    grid = ss.sweep(loose, periods=60, **{"link.stiffness": [0.0, 1200.0]})
    ((sentence, count),) = notes_of(grid).items()
    assert sentence.startswith("bodies moved apart over the window of the mean") and count == 1
    assert np.ptp(grid.body_velocity.values, axis=-1)[0] > 1e-3 and (grid.status <= Status.REPEATS).all()


def test_feet_with_more_static_than_kinetic_friction_do_not_chatter():
    """Where the wave turns, two of three feet are at rest at once, and static friction of neither holds the body: one of them slides."""
    rng = np.random.default_rng(3)
    mu, a = rng.uniform(0.002, 0.01, 40), rng.uniform(0.003, 0.02, 40)
    gait = ss.machines.Gait(ss.drives.Pieces(durations=(0.55, 0.75), accelerations=(a, -a * 0.55 / 0.75)), lag=2 * np.pi / 5)
    worms = ss.Chain(ss.machines.Bodies(mass=0.033, count=3, friction=ss.Coulomb(mu, 1.9 * mu, f_plus=None, f_minus=2.6 * mu)), link=gait)
    many = ss.solve(worms, periods=4, settle=0)
    assert many.status_counts == {"finished": 40}
    for i in (0, 7):
        one = replace_numbers(worms, i)
        judge = ss.solve(one, periods=4, settle=0, method="dop853", rtol=1e-11)
        assert ss.mean_velocity(judge) == pytest.approx(many.mean_velocity[i], abs=1e-8 * float(one.velocity_scale))


def replace_numbers(many, i):
    """One case of a batch."""
    return many.replace({name: float(value[i]) for name, value in leaves(many) if np.ndim(value)})


def test_hits_that_turn_a_slip_round_end_a_step_once():
    """The body comes back, is hit, and friction stops it within a step; both tolerances tell the same way."""
    rng = np.random.default_rng(0)
    law = ss.LuGre(0.3, 0.3, 0.4, 0.4, sigma0=1e3, sigma1=1.0, sigma2=0.1, v_s=0.01)
    start = {"v": {"inner": rng.uniform(0.0, 0.2, 100), "body": rng.uniform(-0.1, 0.0, 100)}}
    many = Pushed(PUSH, rng.uniform(0.3, 0.9, 100), law)
    coarse, fine = (ss.solve(many, duration=0.2, rtol=rtol, start=start, keep="summary") for rtol in (1e-6, 1e-7))
    assert coarse.status_counts == fine.status_counts == {"finished": 100}
    assert np.median(abs(coarse.displacement - fine.displacement)) < 1e-6 * 0.2 * 0.2  # of the way at the largest velocity


def test_several_contacts_that_are_lost_at_one_instant_are_all_told():
    """Both inner masses lift at once: N = (M + m) g - m B w^2 sin(w t) is zero at arcsin((M + m) g/(m B w^2))/w."""
    M, m, B, omega = 0.06, 0.01, 3e-3, 200.0
    drive = ss.drives.VerticalVibration(ss.Harmonic(amplitude=5e-4, omega=omega), amplitude=B)
    module = ss.Robot(body_mass=M, inner_mass=m, drive=drive, friction=ss.Coulomb(0.15, 0.25))
    pair = ss.Chain((module, module), link=ss.Spring(stiffness=100.0))
    run = ss.solve(pair, periods=20)
    lost = [event.t for event in run.events if event.kind == "contact lost"]
    assert lost == pytest.approx([np.arcsin((M + m) * 9.81 / (m * B * omega**2)) / omega] * 2, rel=1e-12)
    assert "contact lost" in str(run.status)
    held = module.replace({"drive.amplitude": np.array([B, 1e-4])})
    many = ss.solve(ss.Chain((held, held), link=ss.Spring(stiffness=100.0)), periods=20, keep="summary")
    assert many.status_counts == {"contact lost: the load fell to zero": 1, "finished": 1}
