"""Ready-made machines in the plane: against the judge, formulas by hand, and the expansion of a bristle-bot in its force."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from rows import each_row
from stickslip.show.reports.moving import moments

BOT = ss.presets.bristle_bot(unbalance=4e-7)
#: Machines, where they begin, and how long they take for 20 events and for a few.
RUNS = {
    "bristle-bot": (ss.presets.bristle_bot(), {}, 11, 1),
    "bristle-bot under Coulomb friction": (ss.presets.bristle_bot(law="coulomb", unbalance=5e-6), {}, 9, 2),
    "cart and pole": (ss.presets.cart_pole(), {"angle": 0.5}, 10, 1),
    "block on a wedge": (ss.presets.block_on_wedge(), {}, 11, 1),
    "rod": (ss.presets.sliding_rod(mu=0.3, push=8.0), {"angle": -1.0}, 18, 1),
    "two links": (ss.presets.two_link_arm(), {}, 4, 1),
    "brake": (ss.presets.mode_coupling(), {}, 25, 4),
    "hopping robot": (ss.presets.hopping_robot(), {}, 6, 1),
    "gear joint": (ss.presets.gear_joint(), {}, 5, 0),
}


def speed(omega, force):
    """Mean velocity of its orbit, for a force of 1 N."""
    return ss.periodic_orbit(BOT.replace({"omega": omega, "unbalance": force / omega**2})).mean_velocity / force**2


@each_row("omega", [30.0, 60.0, 120.0])
def test_a_bristle_bot_goes_as_the_expansion_in_its_force_says(omega):
    """Cicconofri and DeSimone's model: the next order is smaller by the square of the force, so two forces give the limit."""
    one, half = (speed(omega, force) for force in (4e-3, 2e-3))
    bot, whole = BOT.replace({"omega": omega}), abs(speed(120.0, 2e-3))
    assert abs((4 * half - one) / 3 - bot.expanded / bot.force**2) < 1e-6 * whole
    assert abs(one - half) < 1e-3 * whole


def test_a_bristle_bot_turns_round_at_a_frequency():
    """Backwards below it, forwards above: the orbit's mean velocity is zero there, up to the square of the force."""
    ends = [brentq(lambda omega, force=force: speed(omega, force), 58.0, 62.0, xtol=1e-9) for force in (4e-3, 2e-3)]
    assert (4 * ends[1] - ends[0]) / 3 == pytest.approx(BOT.reversal, rel=1e-6)
    assert ss.solve(BOT.replace({"omega": 30.0}), periods=30).mean_velocity < 0.0 < ss.solve(BOT, periods=30).mean_velocity
    with pytest.raises(ValueError, match="the expansion is for lubricated friction, and friction is Coulomb"):
        _ = ss.presets.bristle_bot(law="coulomb").reversal
    for given, other in (({"law": "coulomb", "drag": 2.0}, "lubricated"), ({"mu": 0.2}, "coulomb")):
        with pytest.raises(ss.InputError, match=f'is of other friction than law=.*type law="{other}"'):
            ss.presets.bristle_bot(**given)


def test_a_cart_with_a_pendulum_swings_as_by_hand():
    """Small swings without friction: angle a cos wt with w^2 = (g/l)(1 + m/M), and the cart the other way by m l/(m + M) of it."""
    cart, bob, length, first = 1.0, 0.8, 0.5, 1e-5
    free = ss.machines.CartPole(cart, bob, length, ss.Coulomb(0.0, 0.0))
    run = ss.solve(free, duration=3.0, start={"x": {"angle": first}, "v": {}})
    swing = first * np.cos(np.sqrt(9.81 / length * (1 + bob / cart)) * run.t)
    assert np.max(abs(run.coordinates["angle"] - swing)) < 1e-9 * first
    assert np.allclose(run.coordinates["x"], bob * length / (bob + cart) * (first - swing), rtol=0, atol=1e-9 * first)
    ((hinge, end),) = np.array(moments(run)["plane"]["outlines"])  # its picture has the rod [mm]
    assert np.allclose(np.hypot(*(end - hinge)), 1e3 * length, rtol=1e-5) and not hinge[1].any()


@pytest.mark.parametrize("long", [False, pytest.param(True, marks=pytest.mark.slow)])
@each_row("name", RUNS)
def test_ready_made_machines_in_the_plane_are_those_of_the_judge(name, long):
    """The same events at the same instants to 1e-10, energy to rounding, and the file; over 20 events with the slow tests."""
    machine, x, many, few = RUNS[name]
    length = {"duration" if machine.period is None else "periods": many if long else few or 1}
    run = ss.solve(machine, start={"x": x}, **length)
    assert run.method == "exact" and run.status == "finished"
    assert np.max(abs(ss.energy(run).residual)) < 1e-13
    assert type(machine).from_toml(machine.to_toml()) == machine
    if not (long or few):
        return
    judge = ss.solve(machine, start={"x": x}, method="dop853", rtol=1e-12, **length)
    assert [(e.kind, e.part) for e in run.events] == [(e.kind, e.part) for e in judge.events]
    assert len(run.events) >= (20 if long else 1)
    assert max(abs(a.t - b.t) for a, b in zip(run.events, judge.events, strict=True)) < 1e-10
    assert np.allclose(np.r_[run.x[-1], run.v[-1]], np.r_[judge.x[-1], judge.v[-1]], rtol=0, atol=1e-10)
