"""The judge in plain Python on machines of several bodies, contacts and stops: closed forms, reference numbers, a second method."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import problems
import stickslip as ss
from rows import each_row
from stickslip.maths import maximum, sin, where, within
from stickslip.solvers.plain.deciding import AtZero, decide
from stickslip.solvers.plain.marching import marched
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings


def plain(machine, periods=None, **arguments):
    return ss.solve(machine, periods, **{"method": "dop853", "rtol": 1e-12, **arguments})


def hits_of(machine, **arguments):
    """A run as the judge keeps it, with the hits on its stops."""
    return marched(request(machine, Settings.of({"rtol": 1e-12, "method": "dop853", **arguments})), machine, 0)


def last_period(run):
    """Mean velocities of the bodies over the last period [m/s]."""
    return (run.strobe_x[-1] - run.strobe_x[-2]) / run.period_time


def phases(run):
    """Phases of the events of the last period, one for each instant, with the modes after it."""
    T, last = run.period_time, run.periods - 1
    times = sorted({event.t for event in run.events if event.t >= last * T})
    modes = [tuple(int(m) for m in run.pieces.mode[np.searchsorted(run.pieces.t, t, side="right") - 1]) for t in times]
    return [(t / T - last, mode) for t, mode in zip(times, modes, strict=True)]


def assert_phases(run, expected):
    found = phases(run)
    assert [mode for _, mode in found] == [mode for _, mode in expected]
    assert [t for t, _ in found] == pytest.approx([t for t, _ in expected], abs=1e-10)


# the decision ---------------------------------------------------------------------------------------------------------


def random_block(rng, sort):
    """G, beta and limits of contacts of one sort; a third has rounded numbers, so that ties and dependent rows are frequent."""
    k = 1 if sort == "single" else int(rng.integers(2, 5))
    rounded = rng.random() < 1 / 3
    g = {"single": np.ones((1, 1)), "diagonal": np.eye(k), "common": np.ones((k, 1))}.get(sort, rng.integers(-1, 2, (k, 3)).astype(float))
    g[~g.any(axis=1), 0] = 1.0
    masses = np.ones(g.shape[1]) if rounded else rng.uniform(0.2, 3.0, g.shape[1])
    push, offsets = rng.uniform(-3, 3, g.shape[1]), rng.uniform(-2, 2, k) * (np.linalg.matrix_rank(g) == k or sort == "common")
    limits = rng.uniform(0, 2, (2, k))
    if rounded:
        push, offsets, limits = np.round(push), np.round(offsets), np.round(limits)
    return (g / masses) @ g.T, g @ (push / masses) + offsets, -limits[0], limits[1]


@each_row("sort", ["single", "diagonal", "common", "box"])
def test_every_decision_satisfies_the_convex_problem(sort):
    """w' > 0 only at the upper limit, w' < 0 only at the lower, R within both: the conditions of the convex problem, whose w' is unique."""
    rng = np.random.default_rng(5)
    for _ in range(400):
        G, beta, lo, hi = random_block(rng, sort)
        found = decide(AtZero(G, beta, lo, hi))
        R = np.array(found.R)
        rates, small = beta - G @ R, 1e-13 * (abs(beta).max() + abs(G).sum() * 2)
        assert np.all(hi + small >= R) and np.all(lo - small <= R)
        assert np.all(abs(R - hi)[rates > small] <= small) and np.all(abs(R - lo)[rates < -small] <= small)
        assert [r != 0 and np.sign(r) != side for r, side in zip(found.rates, found.sides, strict=True)] == [False] * len(R)


def test_decisions_agree_with_descent_on_the_convex_problem():
    """min (R G R)/2 - beta R between the limits, by coordinate descent: another way to the same w'."""
    rng = np.random.default_rng(6)
    for _ in range(40):
        G, beta, lo, hi = random_block(rng, "box")
        R = np.zeros(len(beta))
        for _ in range(3000):
            for i in range(len(R)):
                R[i] = min(max(R[i] + (beta[i] - G[i] @ R) / G[i, i], lo[i]), hi[i])
        assert beta - G @ np.array(decide(AtZero(G, beta, lo, hi)).R) == pytest.approx(beta - G @ R, abs=1e-10)


def test_sixteen_feet_on_one_body_are_a_weighted_median():
    rng = np.random.default_rng(7)
    for _ in range(50):
        beta, hi = rng.uniform(-3, 3, 16), rng.uniform(0, 0.3, 16)
        R = np.array(decide(AtZero(np.ones((16, 16)), beta, -hi, hi)).R)
        x = brentq(lambda x: x - np.sum(hi * np.sign(beta - x)), -6, 6, xtol=1e-15)  # noqa: B023
        assert R.sum() == pytest.approx(x, abs=1e-12)


def test_of_two_feet_that_rest_together_the_friction_is_shared_in_proportion_to_the_limits():
    assert pytest.approx([0.5, 1.0], rel=1e-15) == decide(AtZero(np.ones((2, 2)), [1.5, 1.5], [-1.0, -1.0], [1.0, 2.0])).R


def test_a_dependent_resting_set_that_cannot_be_held_is_not_taken():
    """Two feet of one body with different prescribed accelerations cannot both rest, whatever least squares says."""
    found = decide(AtZero(np.ones((2, 2)), [0.5, -0.5], [-5.0, -5.0], [1.0, 1.0]))
    assert found.sides in ([0, -1], [1, 0]) and min(abs(r) for r in found.rates) == 0.0 and max(abs(r) for r in found.rates) == 1.0


def test_of_several_answers_under_static_above_kinetic_friction_the_one_that_rested_is_taken():
    """beta 1.1 on two coupled contacts of static 1 and kinetic 0: resting forces (.733, .733), but sliding both is consistent too."""
    G = [[1.0, 0.5], [0.5, 1.0]]
    arguments = dict(lo=[-1.0, -1.0], hi=[1.0, 1.0], slide=([0.0, 0.0], [0.0, 0.0]))
    assert decide(AtZero(G, [1.1, 1.1], **arguments)).sides == [0, 0]
    assert decide(AtZero(G, [1.1, 1.1], **arguments, forced={0: 1})).sides == [1, 1]  # 1.1 is too much for the second alone
    assert decide(AtZero(G, [1.0, 0.9], **arguments, forced={0: 1})).sides == [1, 0]


def test_a_row_of_more_than_six_contacts_may_rest_but_not_change_all_at_once():
    G = 2.0 * np.eye(8) - np.eye(8, k=1) - np.eye(8, k=-1)
    limits = {"lo": [-1.0] * 8, "hi": [1.0] * 8}
    assert decide(AtZero(G, [0.05] * 8, **limits)).sides == [0] * 8
    assert decide(AtZero(G, G @ ([1.0] + [0.2] * 7), **limits, forced={0: 1})).sides == [1] + [0] * 7
    with pytest.raises(ss.SolveError, match="8 contacts that push one another"):
        decide(AtZero(G, [3.0] * 8, **limits))


# modules in a row -----------------------------------------------------------------------------------------------------


def test_identical_modules_in_phase_move_as_one():
    """M2a: two contacts start and stop at one instant."""
    run = plain(problems.chain(0.0, 0.0), 6)
    assert last_period(run) == pytest.approx([0.002383491055471] * 2, rel=1e-11)
    assert_phases(run, [(0.0500366358, (0, 0)), (0.0728072666, (1, 1)), (0.6347786446, (-1, -1))])
    assert {event.part for event in run.events} == {"module 1", "module 2"}


def test_modules_on_a_rigid_link_are_one_robot_with_a_smaller_drive():
    """M2h: phases 0 and 2 are one drive of amplitude A cos 1, and the two feet of one body rest and break away together."""
    run = plain(problems.chain(0.0, 2.0, link=ss.machines.Rigid()), 8)
    alone = plain(problems.module(amplitude=6e-4 * math.cos(1.0)), 8)
    assert last_period(run) == pytest.approx([0.000217301001732] * 2, rel=1e-11)
    assert np.diff(alone.strobe_x)[-1] / alone.period_time == pytest.approx(0.000217301001732, rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("row", problems.COUPLED)
def test_modules_in_a_row_have_the_reference_numbers(row):
    machine, periods, velocity, tolerance, events = problems.COUPLED[row]
    run = plain(machine, periods)
    assert last_period(run) == pytest.approx([velocity] * len(run.bodies), abs=tolerance)
    if events:
        assert_phases(run, events)
    if row == "M3a":
        assert phases(run)[:2] == [
            (pytest.approx(0.1156272253, abs=1e-10), (-1, 1, 0)),
            (pytest.approx(0.1207076059, abs=1e-10), (1, 1, 0)),
        ]
        assert len(phases(run)) == 8
    if row == "M3c":
        late = run.t > 130 * run.period_time  # by then the first module is anchored, and the others go to and fro
        assert np.all(run.contacts["module 1"].mode[late] == 0) and np.ptp(run.bodies["module 2"].x[late]) > 1e-5


# prescribed distances -------------------------------------------------------------------------------------------------


def test_a_worm_of_which_one_mass_always_holds():
    """P3a: V = 3 a f exactly, and the foot that holds changes at 1/12, 5/12 and 9/12 of the period."""
    run = plain(problems.Worm(0.1, 0.3, frequency=2.0), 3)
    assert last_period(run) == pytest.approx([0.012] * 3, rel=1e-13)
    assert_phases(run, [(1 / 12, (1, 1, 0)), (5 / 12, (0, 1, 1)), (9 / 12, (1, 0, 1))])
    assert abs(run.slip[run.mode == 0]).max() < 1e-14  # of velocities of .03, as polynomials of degree 7


def test_prescribed_distances_are_kept():
    machine = problems.Worm(0.1, 0.3, frequency=2.0)
    run = plain(machine, 1)
    first, last = machine.links().values()
    assert run.x[:, 0] - run.x[:, 1] == pytest.approx(first.position(run.t), abs=1e-15)
    assert run.v[:, 1] - run.v[:, 2] == pytest.approx(last.velocity(run.t), abs=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("row", problems.WORMS)
def test_worms_have_the_reference_numbers(row):
    machine, velocity, tolerance = problems.WORMS[row]
    assert last_period(plain(machine, 20)) == pytest.approx([velocity] * 3, abs=tolerance)


# capsules and forced masses -------------------------------------------------------------------------------------------


def test_a_capsule_whose_inner_mass_grazes_the_stop_is_hit_or_not():
    """C6: on its steady orbit the inner mass comes to 1.5556784782; the capsule rests. A gap 1e-9 wider or narrower decides."""
    omega, xi = 0.6, 0.05
    amplitude = 1 / complex(1 - omega**2, 2 * xi * omega)
    start = {"x": {"inner": amplitude.real}, "v": {"inner": -omega * amplitude.imag}}
    assert abs(amplitude) == pytest.approx(1.555678478217645, rel=1e-15) == problems.GRAZING
    for part, hit in ((1 + 1e-9, False), (1 - 1e-9, True)):
        machine = problems.Capsule(alpha=1.0, omega=omega, gap=problems.GRAZING * part, mass=4.0, restitution=0.6)
        run = hits_of(machine, periods=2, start=start)
        assert bool(run.hits) == hit and (hit or all(part.mode == (0,) for part in run.parts))
        if hit:  # the gap is narrower by d: the mass meets it with the velocity omega sqrt(2 A d)
            assert run.hits[0].velocity == pytest.approx(-omega * problems.GRAZING * math.sqrt(2e-9), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("row", problems.MASSES)
def test_capsules_and_forced_masses_have_the_reference_numbers(row):
    machine, periods, velocity, tolerance, events = problems.MASSES[row]
    run = plain(machine, periods)
    assert last_period(run) == pytest.approx([velocity] * 2, abs=tolerance)
    if events:
        assert_phases(run, events)


@pytest.mark.slow
def test_a_capsule_is_hit_twice_a_period_when_and_as_hard_as_it_should_be():
    """C3."""
    run, T = hits_of(problems.CAPSULE_3, periods=120), float(problems.CAPSULE_3.period)
    last = [(hit.t / T - 119, hit.velocity) for hit in run.hits if hit.t > 119 * T]
    assert [t for t, _ in last] == pytest.approx([0.2239834690, 0.9352746224], abs=1e-10)
    assert [v for _, v in last] == pytest.approx([-1.0695823230, -3.3208859451], abs=1e-9)


# a second method ------------------------------------------------------------------------------------------------------


def test_three_blocks_in_a_row_follow_matrix_exponentials_from_event_to_event():
    """Between events the equations are linear: y' = A y with cos, sin and 1 among the states. Each event is a zero of its guard."""
    start = {"x": [-1.0, 1.0, -1.0], "v": [-1.0, 1.0, 1.0]}
    run = plain(problems.ThreeBlocks(), duration=5.0, start=start)
    stiffness = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    y, t = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 0.0, 1.0]), 0.0
    times = sorted({event.t for event in run.events})
    assert len(times) >= 11 and any(0 in run.pieces.mode[:, i] for i in range(3))
    for number, end in enumerate([*times, 5.0]):
        mode = run.pieces.mode[np.searchsorted(run.pieces.t, t, side="right") - 1].astype(int)
        force = np.zeros((3, 9))
        force[:, :3], force[:, 3:6], force[:, 8], force[2, 6] = -stiffness, -np.eye(3), -0.3 * mode, 10.0
        held, force = force.copy(), np.where((mode == 0)[:, None], 0.0, force)
        A = np.zeros((9, 9))
        A[:3, 3:6], A[3:6], A[6, 7], A[7, 6] = np.eye(3), force, -math.pi, math.pi
        for theta in np.linspace(0.01, 0.99, 25):
            ahead = expm(A * theta * (end - t)) @ y
            assert np.all((mode * ahead[3:6])[mode != 0] > 0) and np.all(abs(held @ ahead)[mode == 0] < 0.3)
        y, t = expm(A * (end - t)) @ y, end
        rates = A @ y
        if number < len(times):
            speeds = [abs(y[3 + i] / rates[3 + i]) for i in range(3) if mode[i]]
            limits = [(0.3 - abs(held[i] @ y)) / abs(held[i] @ rates) for i in range(3) if not mode[i]]
            assert min(speeds + limits) < 1e-10  # how far the zero of the guard is from the event [s]
    assert run.x[-1] == pytest.approx(y[:3], abs=1e-9) and run.v[-1] == pytest.approx(y[3:6], abs=1e-9)


def test_four_inertias_with_three_clutches_hold_and_slip_as_derived_by_hand():
    machine = problems.Clutches()
    run = plain(machine, 2)
    J, T = (
        np.array(machine.inertias),
        np.array([np.broadcast_to(torque, run.t.shape) for torque in map(np.asarray, machine.torques(run.t))]),
    )
    limit = np.array([machine.mu * machine.load(k, run.t) for k in range(3)])
    inner = np.ones(len(run.t), bool)
    inner[1:-1] = (np.diff(run.t)[:-1] > 0) & (np.diff(run.t)[1:] > 0)
    together = np.all(run.mode == 0, axis=1) & inner
    bears = np.cumsum(T - J[:, None] * (T.sum(axis=0) / J.sum()), axis=0)[:3]
    assert together.sum() > 50 and np.all(abs(bears[:, together]) <= limit[:, together] * (1 + 1e-12))
    assert run.friction_force.T[:, together] == pytest.approx(bears[:, together], abs=1e-12)
    middle = np.all(run.mode == [0, 1, 0], axis=1) & inner
    assert middle.sum() > 20
    first, last = ((T[0] + T[1] - limit[1]) / (J[0] + J[1]))[middle], ((T[2] + T[3] + limit[1]) / (J[2] + J[3]))[middle]
    assert run.acceleration[middle] == pytest.approx(np.array([first, first, last, last]).T, abs=1e-12)
    broken = next(event for event in run.events if event.kind == "slip")
    at = brentq(lambda t: abs(_bears(machine, t)[1]) - machine.mu * machine.load(1, t), 0.8 * broken.t, 1.2 * broken.t, xtol=1e-15)
    assert (broken.part, broken.t) == ("clutch 1", pytest.approx(at, abs=1e-12))
    assert len({tuple(mode) for mode in run.mode.tolist()}) >= 4


def _bears(machine, t):
    J, T = np.array(machine.inertias), np.array(machine.torques(t))
    return np.cumsum(T - J * T.sum() / J.sum())


# stops ----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Balls(ss.Machine):
    """Balls above one another, with stops between neighbours and to the ground, pulled down by 9.81 and by a push up from t = lift on."""

    restitution: float = 0.5
    other: float = 0.5
    count: int = 1
    rise: float = 0.0
    weight: float = 9.81
    upper: float = 1.0
    stiffness: float | None = None

    time_scale = 1.0

    def bodies(self):
        def force(t, x, v):
            return -self.weight + self.rise * t

        return {f"ball {i}": ss.Body(1.0 if i == 0 else self.upper, force=force, position=1.0 + 2.0 * i) for i in range(self.count)}

    def stops(self):
        ground = ss.Stop(0.0, restitution=None if self.stiffness else self.restitution, stiffness=self.stiffness, side=-1)
        between = {(f"ball {i}", f"ball {i - 1}"): ss.Stop(0.0, restitution=self.other, side=-1) for i in range(1, self.count)}
        return {("ball 0", None): ground, **between}


def test_a_bouncing_ball_comes_to_rest_in_a_geometric_series_and_lifts_off_when_its_weight_is_gone():
    """Hits at t1 (1 + 2 e + 2 e^2 + ...), all over at t1 (1 + e)/(1 - e); held while 9.81 > rise t."""
    e, first = 0.5, math.sqrt(2 / 9.81)
    run = hits_of(Balls(e), duration=3.0)
    closed = [hit for hit in run.hits if hit.velocity == 0.0]
    assert [hit.t for hit in closed] == pytest.approx([first * (1 + e) / (1 - e)], rel=1e-12)
    expected = [first * (1 + 2 * sum(e**n for n in range(1, k + 1))) for k in range(8)]
    assert [hit.t for hit in run.hits[:8]] == pytest.approx(expected, rel=1e-12)
    assert [hit.velocity for hit in run.hits[:8]] == pytest.approx([-9.81 * first * e**k for k in range(8)], rel=1e-10)
    assert abs(run.y[0]) < 1e-15 and run.y[1] == 0.0
    rising = hits_of(Balls(e, rise=4.0), duration=3.0, start={"x": [0.0]})
    lifts = 9.81 / 4.0
    assert rising.y[0] == pytest.approx(4.0 * (3.0 - lifts) ** 3 / 6, rel=1e-11)  # x'' = rise (t - lifts)


def test_equal_balls_hand_a_hit_on_and_unequal_restitutions_at_one_instant_are_refused():
    """e = 1, no weight: the ground returns the first ball, which hands its velocity to the second."""
    run = hits_of(Balls(1.0, other=1.0, count=2, weight=0.0), duration=4.0, start={"x": [1.0, 2.0], "v": [-1.0, 0.0]})
    assert [(hit.part, hit.velocity) for hit in run.hits] == [("ball 0", -1.0), ("ball 1-ball 0", pytest.approx(-1.0))]
    assert [hit.t for hit in run.hits] == pytest.approx([1.0, 3.0], rel=1e-15) and run.y[2:] == pytest.approx([0.0, 1.0], abs=1e-15)
    with pytest.raises(ss.SolveError, match="hit at one instant"):
        hits_of(Balls(0.5, other=0.4, count=2, weight=0.0), duration=2.0, start={"x": [0.0, 0.0], "v": [-1.0, -2.0]})
    both = hits_of(Balls(0.5, other=0.5, count=2, weight=0.0), duration=2.0, start={"x": [0.0, 0.0], "v": [-1.0, -2.0]})
    assert both.y[2:] == pytest.approx([0.5, 1.0], rel=1e-15)  # every rate of parting is half the rate of approach


def test_a_start_beyond_a_stop_is_said():
    with pytest.raises(ss.InputError, match="begins beyond the stop ball 0"):
        hits_of(Balls(), duration=1.0, start={"x": [-0.1]})


def test_an_elastic_stop_without_damping_returns_all_energy_after_half_its_period():
    """No weight: in touch for pi sqrt(m/k), and the integrator never steps across the kink."""
    run = plain(Balls(stiffness=400.0, weight=0.0), duration=3.0, start={"x": [1.0], "v": [-2.0]})
    assert run.v[-1, 0] == pytest.approx(2.0, rel=1e-11)
    assert run.x[-1, 0] == pytest.approx(2.0 * (3.0 - 0.5 - math.pi / 20), rel=1e-11)


@dataclass(frozen=True, eq=False)
class Kinked(ss.Machine):
    """A mass on a spring that is stiffer to one side: written with where, with maximum, or with a plain if."""

    way: str

    time_scale = 1.0

    def bodies(self):
        def force(t, x, v):
            if self.way == "if":
                return -9.0 * x if x > 0 else -x
            return -where(x > 0, 9.0 * x, x) if self.way == "where" else -x - 8.0 * maximum(x, 0.0)

        return {"mass": ss.Body(1.0, force=force)}


@pytest.mark.parametrize("way", ["where", "maximum", "if"])
def test_kinks_of_a_users_own_force_are_events(way):
    """Half a period of the stiff spring and half one of the soft: pi/3 + pi in all, then it is back."""
    period = math.pi / 3 + math.pi
    run = plain(Kinked(way), duration=3 * period, start={"v": [1.0]})
    assert run.v[-1, 0] == pytest.approx(1.0, rel=1e-11) and abs(run.x[-1, 0]) < 1e-11


def test_the_work_of_the_drive_is_what_friction_hits_and_springs_take():
    """A capsule from rest over 3 periods: kinetic energy + spring energy = work of the force pair - friction work - loss in hits."""
    machine, run = problems.CAPSULE_3, hits_of(problems.CAPSULE_3, periods=3)
    e, losses = run.equations, sum(0.5 * (1 - 0.36) * hit.velocity**2 * (1 * 4 / 5) for hit in run.hits)  # reduced mass 4/5
    nodes, weights = np.polynomial.legendre.leggauss(12)
    ends = [*(part.t for part in run.parts[1:]), run.t]
    total = 0.0
    for part, end in zip(run.parts, ends, strict=True):
        h = end - part.t
        for node, weight in zip(nodes, weights, strict=True):
            v1, v2, x1, x2 = part.coefficients @ ((0.5 + 0.5 * node) ** np.arange(part.coefficients.shape[1]))
            t = part.t + h * (0.5 + 0.5 * node)
            power = machine.alpha * math.cos(machine.omega * t) * (v1 - v2) - 0.1 * (v1 - v2) ** 2 - part.mode[0] * v2
            total += 0.5 * h * weight * power
    x1, x2, v1, v2 = run.y
    energy = 0.5 * v1**2 + 2.0 * v2**2 + 0.5 * (x1 - x2) ** 2
    assert len(run.hits) > 3 and energy == pytest.approx(total - losses, abs=1e-9)
    assert e.mechanics.bodies == ("inner", "capsule")


# other things that contacts may do ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Mixed(ss.Machine):
    """A shaken mass on a belt, under Coulomb friction, that carries another under a law with an inner state."""

    upper: Any
    speed: float = 0.1

    period = 0.5

    def bodies(self):
        return {"lower": ss.Body(2.0, force=lambda t, x, v: 20.0 * sin(4 * math.pi * t)), "upper": ss.Body(1.0)}

    def contacts(self):
        return {
            "belt": ss.Contact("lower", ss.Coulomb(0.2, 0.2), on=self.speed, load=29.43),
            "between": ss.Contact("upper", self.upper, on="lower"),
        }


@pytest.mark.parametrize("law", [ss.LuGre(0.1, 0.1, 0.15, 0.15, 300.0, 10.0, 0.1, 0.05), ss.Coulomb(0.1, 0.1), ss.Viscous(0.3, 0.3)])
def test_two_integrators_agree_on_laws_of_different_kinds_in_one_machine(law):
    one, other = (plain(Mixed(law), 2, method=method, rtol=1e-9) for method in ("dop853", "radau"))
    assert one.x[-1] == pytest.approx(other.x[-1], abs=1e-8) and one.v[-1] == pytest.approx(other.v[-1], abs=1e-7)
    assert [(e.part, e.after) for e in one.events] == [(e.part, e.after) for e in other.events]
    assert [e.t for e in one.events] == pytest.approx([e.t for e in other.events], abs=1e-7)
    momentum = 2.0 * one.acceleration[:, 0] + one.acceleration[:, 1]
    outside = 20.0 * np.sin(4 * math.pi * one.t) - one.friction_force[:, 0]
    assert momentum == pytest.approx(outside, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("phase", "periods", "velocity"), [(0.0, 8, 0.002344920142738), (math.pi / 2, 42, 0.002560519884429)])
def test_modules_under_lugre_friction_have_the_reference_numbers(phase, periods, velocity):
    """M2o: LuGre at each contact of a pair, by an implicit method."""
    module = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    run = plain(problems.chain(0.0, phase, modules=(module, module)), periods, method="radau", rtol=1e-9)
    assert last_period(run) == pytest.approx([velocity] * 2, rel=2e-9)


@dataclass(frozen=True)
class Sawtooth:
    """A track that goes forwards for half a second and back for the other half."""

    speed: float
    breaks = (0.5,)

    def position(self, t):
        return self.speed * where(within(t, 1.0) < 0.5, within(t, 1.0), 1.0 - within(t, 1.0))

    def velocity(self, t):
        return where(within(t, 1.0) < 0.5, self.speed, -self.speed)

    def acceleration(self, t):
        return 0.0


@dataclass(frozen=True, eq=False)
class Carried(ss.Machine):
    """A mass of 1 kg on something that moves, or on a track whose load depends on the place; thrown at .3 s."""

    mu: float
    on: Any = None
    load: Any = 10.0
    jump: float = 0.0

    period = 1.0

    def bodies(self):
        return {"mass": ss.Body(1.0, jumps=((0.3, self.jump),) if self.jump else ())}

    def contacts(self):
        return {"pad": ss.Contact("mass", ss.Coulomb(self.mu, self.mu), on=self.on, load=self.load)}


def test_a_prescribed_velocity_that_jumps_frees_what_rests_on_it():
    """Friction 1 m/s^2, track .1 m/s: it follows from .1 s on, is free at .5, and rests on the track again .2 s later."""
    run = plain(Carried(0.1, on=Sawtooth(0.1)), 1)
    assert [(event.kind, event.after) for event in run.events] == [("stick", 0), ("slip", 1), ("stick", 0)]
    assert [event.t for event in run.events] == pytest.approx([0.1, 0.5, 0.7], rel=1e-12)
    assert run.v[-1, 0] == -0.1 and run.x[-1, 0] == pytest.approx(0.005 + 0.04 + 0.0 - 0.03, abs=1e-14)


def test_a_known_jump_of_a_body_throws_it():
    """At rest until .3 s, then thrown with .2 m/s against a friction of 1 m/s^2."""
    run = plain(Carried(0.1, jump=0.2), 1)
    assert [(event.kind, event.t) for event in run.events] == [("impulse", 0.3), ("stick", pytest.approx(0.5, rel=1e-12))]
    assert run.x[-1, 0] == pytest.approx(0.02, rel=1e-12)


def test_a_load_that_changes_with_the_place_is_met_where_it_changes():
    """Load 10 before x = .1 m and 40 after it, friction coefficient .1, start 1 m/s: there v^2 = 1 - .2, and it stops .8/8 m later."""
    run = plain(Carried(0.1, load=lambda t, x: where(x < 0.1, 10.0, 40.0)), 1, start={"v": [1.0]})
    assert run.x[-1, 0] == pytest.approx(0.1 + 0.8 / 8, rel=1e-12) and run.events[-1].kind == "stick"
    assert run.events[-1].t == pytest.approx((1 - math.sqrt(0.8)) + math.sqrt(0.8) / 4, rel=1e-12)


def test_identical_blocks_whose_static_friction_is_higher_break_away_one_by_one_as_derived():
    """A force t on the first of two blocks with a spring between: the first goes at t = .5, with kinetic friction .2 from then on.

    While the second rests, x1'' = t - .2 - k x1 from x1 = x1' = 0 at .5: k x1 = .3 + s - .3 cos w s - sin(w s)/w, w^2 = k, s = t - .5.
    """
    law, k = ss.Coulomb(0.2, 0.2, f_plus=0.5, f_minus=0.5), 25.0

    @dataclass(frozen=True, eq=False)
    class Two(ss.Machine):
        stiffness: float
        time_scale = 1.0

        def bodies(self):
            return {"first": ss.Body(1.0, force=lambda t, x, v: t), "second": ss.Body(1.0)}

        def contacts(self):
            return {name: ss.Contact(name, law, load=1.0) for name in ("first", "second")}

        def links(self):
            return {("first", "second"): ss.Spring(self.stiffness)}

    run = plain(Two(k), duration=1.2)
    w = math.sqrt(k)
    second = brentq(lambda s: 0.3 + s - 0.3 * math.cos(w * s) - math.sin(w * s) / w - 0.5, 0.05, 0.6, xtol=1e-15)
    assert [(event.part, event.kind) for event in run.events[:2]] == [("first", "slip"), ("second", "slip")]
    assert [event.t for event in run.events[:2]] == pytest.approx([0.5, 0.5 + second], rel=1e-12)
