"""Robots whose inner mass is driven by force: capsubots, and capsules with stops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from pairs import each_once
from rows import each_row
from stickslip.basics.errors import StickslipError
from stickslip.maths import pi, sin
from stickslip.models.machine_adapter import machine_of

OMEGA = 2 * pi / 0.06


def capsule(alpha, omega, xi, gamma, stops=(), reaction=True, friction=None):
    """The capsule without dimensions: unit inner mass, stiffness and sliding friction."""
    drive = ss.machines.Forced(ss.HarmonicForce(alpha, omega, phase=pi / 2), stiffness=1.0, damping=2 * xi, stops=stops, reaction=reaction)
    one = 1 / (gamma + 1)
    return ss.Robot(body_mass=gamma, inner_mass=1.0, drive=drive, friction=friction or ss.Coulomb(one, one), gravity=1.0)


def capsubot(force, damping=0.0, friction=None, **more):
    drive = ss.machines.Forced(force, stiffness=256.23, damping=damping, **more)
    return ss.Robot(body_mass=0.193, inner_mass=0.074, drive=drive, friction=friction or ss.Coulomb(0.29, 0.29))


GRAZING = 1 / np.hypot(1 - 0.6**2, 2 * 0.05 * 0.6)  # amplitude of the inner mass in a capsule that rests: forced oscillation
C1 = capsule(1.6, 0.95, 0.05, 5.0, (ss.Stop(gap=0.02, stiffness=15.0),), reaction=False)
C3 = capsule(1.6, 0.95, 0.05, 4.0, (ss.Stop(gap=0.5, restitution=0.6),))
C6 = capsule(1.0, 0.6, 0.05, 4.0)
C7 = capsule(1.0, 0.6, 0.05, 4.0, (ss.Stop(gap=GRAZING - 1e-4, restitution=0.6),))
K1 = capsubot(ss.HarmonicForce(1.5, OMEGA) + ss.HarmonicForce(0.75, 2 * OMEGA, phase=pi / 2), damping=0.5)
K3 = capsubot(ss.drives.Pulses(1.25, period=0.06, duty=0.35))
#: Mean velocities, derived twice by independent codes; tolerances are the digits printed there.
TRUTH = {"C1": (C1, 0.165538436583, 1e-10), "C3": (C3, 0.039424641879, 1e-10), "C7": (C7, 0.024995142088, 1e-10),
         "K1": (K1, 0.020420489041022, 1e-11), "K3": (K3, -0.009192935806, 1e-9)}  # fmt: skip
BOTH_SIDES = capsule(1.6, 0.95, 0.05, 4.0, (ss.Stop(gap=0.5, restitution=0.6), ss.Stop(gap=0.8, stiffness=15.0, damping=0.2, side=-1)))


@pytest.fixture(scope="module")
def runs():
    return {name: ss.solve(robot, periods=400, settle=300) for name, (robot, *_) in TRUTH.items()}


@pytest.mark.parametrize("name", TRUTH)
def test_mean_velocities_are_those_of_independent_codes(runs, name):
    _, V, tolerance = TRUTH[name]
    assert runs[name].method == "exact" and ss.mean_velocity(runs[name]) == pytest.approx(V, rel=tolerance)


def _last(run, kinds):
    """Phases and what is asked of the events of the last period."""
    since = run.strobe_times[-2]
    return [((event.t - since) / run.period_time, event) for event in run.events if event.t > since and event.kind in kinds]


def test_impacts_and_reversals_come_when_independent_codes_say(runs):
    hits = _last(runs["C3"], ["hit"])
    assert [t for t, _ in hits] == pytest.approx([0.2239834690, 0.9352746224], abs=1e-10)
    assert [event.velocity for _, event in hits] == pytest.approx([-1.0695823230, -3.3208859451], rel=1e-9)
    turns = _last(runs["K1"], ["reversal"])
    assert [(round(t, 10), event.after) for t, event in turns] == [(0.1362966471, -1), (0.6362966471, 1)]


def test_a_capsule_with_a_small_force_rests_while_its_inner_mass_swings_as_the_formula_says():
    run = ss.solve(C6, periods=400, settle=300)
    apart = run.bodies["inner"].x - run.x
    assert ss.mean_velocity(run) == 0.0 and ss.motion(run).type == "rest"
    # 400 samples in a period miss the peak by (pi/400)^2/2 of it at most
    assert apart[run.t > run.window[0]].max() == pytest.approx(GRAZING, rel=4e-5)
    orbit = ss.periodic_orbit(C6)
    swing = np.hypot(*(orbit.state[i] / scale for i, scale in ((orbit.names.index("l.inner"), 1.0), (orbit.names.index("v.inner"), 0.6))))
    assert swing == pytest.approx(GRAZING, rel=1e-12)  # of a sine of frequency 0.6 from position and velocity at one instant


def test_energy_is_balanced_with_a_loss_for_each_part():
    run = ss.solve(BOTH_SIDES, periods=60)
    balance = ss.energy(run)
    assert balance.worst < 1e-10  # rounding of some hundred exact steps in a period
    assert set(balance.friction_of) == {"contact"} and set(balance.damping_of) == {"inner-body", "inner-body 1", "inner-body 2"}
    assert all(balance.damping_of[name][-1] > 0 for name in balance.damping_of)
    alone = ss.energy(ss.solve(C3, periods=60))
    assert set(alone.damping_of) == {"inner-body", "inner-body (stop)"} and alone.worst < 1e-10


def test_hits_impulses_and_forces_of_each_stop_are_columns():
    """The impulse of a hit is (1 + e) times the velocity of approach times the reduced mass; a stop's force is counted where it presses."""
    grid = ss.sweep(lambda alpha: BOTH_SIDES.replace({"drive.force.amplitude": alpha}), alpha=[1.4, 1.6], periods=400)
    assert grid.hits.dims == ("alpha", "stop") and grid.stop.values.tolist() == ["inner-body 1", "inner-body 2"]
    run = ss.solve(BOTH_SIDES, periods=400, settle=300)
    since = run.pieces.t[-1] - float(grid.period[1]) * run.period_time
    hits = [event for event in run.events if event.kind == "hit" and event.t > since]
    assert {event.part for event in hits} == {"inner-body 1"} and len(hits) == int(grid.hits[1, 0])
    assert float(grid.impulse_max[1, 0]) == pytest.approx(1.6 * 0.8 * max(-event.velocity for event in hits), rel=1e-8)
    assert int(grid.hits[1, 1]) >= 1 and float(grid.stop_force_max[1, 1]) > 0 and np.isnan(grid.stop_force_max[1, 0])


@each_row(
    ("reaction", "track"),
    each_once([True, False], [ss.Level(), ss.Incline(tilt=0.05), ss.tracks.VaryingFriction(ss.Incline(tilt=-0.02), depth=0.3)]),
)
def test_the_equations_are_those_of_the_documentation(reaction, track):
    """Written down here once more, on paper's letters."""
    stops = (ss.Stop(gap=0.002, stiffness=3e3, damping=2.0), ss.Stop(gap=0.003, stiffness=5e3, side=-1))
    robot = capsubot(ss.HarmonicForce(1.5, OMEGA, phase=0.3), damping=0.5, stops=stops, reaction=reaction).replace(track=track)
    M, m, k, c, g = 0.193, 0.074, 256.23, 0.5, 9.81
    mechanics, tilt = machine_of(robot).mechanics, getattr(getattr(track, "track", track), "tilt", 0.0)
    for t, x, s, v, u in ((0.01, 0.001, 0.005, 0.1, -0.3), (0.05, 0.002, -0.004, -0.2, 0.1), (0.02, 0.0, 0.001, 0.0, 0.0)):
        F, r, rate, R = 1.5 * sin(OMEGA * t + 0.3), s - x, u - v, 0.17
        ahead = max(3e3 * (r - 0.002) + 2.0 * rate, 0.0) if r > 0.002 else 0.0
        behind = -max(5e3 * (-r - 0.003), 0.0)
        pull = k * r + c * rate + ahead + behind
        body = (pull - reaction * F - R + M * g * np.sin(tilt)) / M
        inner = (F - pull + m * g * np.sin(tilt)) / m
        assert mechanics.accelerations(t, (x, s), (v, u), (R,)) == pytest.approx((body, inner), rel=1e-13)
        grip = 1 + 0.3 * sin(OMEGA * t) if hasattr(track, "depth") else 1.0
        assert mechanics.loads(t, (x, s)) == pytest.approx(((M + m) * g * np.cos(tilt) * grip,), rel=1e-13)


def test_pulses_of_different_periods_are_one_force_of_their_common_period():
    """Each is what it is alone at any time, also where its own period is a part of the common one; breaks are where the sum jumps."""
    one, two, smooth = (
        ss.drives.Pulses(1.0, period=0.06, duty=0.35),
        ss.drives.Pulses(0.4, period=0.02, duty=0.7),
        ss.HarmonicForce(0.3, 2 * pi / 0.03),
    )
    both = one + two + smooth
    assert both.repeats == (1, 3, 2) and both.period == pytest.approx(0.06, rel=1e-15)
    t = np.linspace(0.0, 0.18, 5001)
    apart = np.min([abs((t - s + 0.03) % 0.06 - 0.03) for s in (0.0, *both.breaks)], axis=0)
    clear = apart > 1e-9
    assert both.at(t[clear]) == pytest.approx((one.at(t) + two.at(t) + smooth.at(t))[clear], abs=1e-14)
    jumps = [s for s in (0.0, *both.breaks) if abs(both.at(s + 1e-7) - both.at(s + 0.06 - 1e-7)) > 0.1]
    assert sorted({round(s, 9) for s in jumps}) == sorted({round(s, 9) for s in (0.0, *both.breaks)})


def test_a_sum_of_pulses_is_solved_as_the_judge_solves_it():
    robot = capsubot(ss.drives.Pulses(1.0, period=0.06, duty=0.35) + ss.drives.Pulses(0.6, period=0.02, duty=0.7), damping=0.5)
    exact, judged = (ss.solve(robot, periods=6, method=method, rtol=1e-12) for method in ("auto", "dop853"))
    assert exact.method == "exact" and np.allclose(exact.strobe_v, judged.strobe_v, rtol=0, atol=1e-9)


def test_forces_have_the_smallest_period_in_common_or_none():
    assert (ss.HarmonicForce(1.0, 4.0) + ss.HarmonicForce(1.0, 6.0)).repeats == (2, 3)
    three = ss.HarmonicForce(1.0, 4.0) + ss.HarmonicForce(1.0, 6.0) + ss.drives.Pulses(1.0, pi, 0.5)
    assert three.repeats == (2, 3, 1) and len(three.parts) == 3
    with pytest.raises(ss.InputError, match=r"have no common multiple; .* give them the same omega or period"):
        ss.HarmonicForce(1.0, 1.0) + ss.HarmonicForce(1.0, 2**0.5)
    swept = three.replace({"parts.0.omega": 2.0})
    assert swept.repeats == (1, 3, 1)
    cases = ss.HarmonicForce(1.0, np.array([1.0, 2.0])) + ss.HarmonicForce(1.0, np.array([3.0, 6.0]))
    assert cases.repeats == (1, 3)
    with pytest.raises(ss.InputError, match="no common multiple"):
        ss.HarmonicForce(1.0, np.array([1.0, 2.0])) + ss.HarmonicForce(1.0, 3.0)


def test_a_recorded_force_is_that_of_its_samples():
    t = np.arange(1200) * 1e-4
    told = 0.2 + 1.5 * np.sin(OMEGA * t) + 0.75 * np.cos(2 * OMEGA * t)
    force = ss.drives.RecordedForce.from_samples(t, force=told, period=0.06)
    assert force.at(t) == pytest.approx(told, abs=1e-12) and force.mean == pytest.approx(0.2, abs=1e-13)
    K1_recorded = capsubot(ss.drives.RecordedForce.from_samples(t, force=told - 0.2, period=0.06), damping=0.5)
    assert ss.mean_velocity(ss.solve(K1_recorded, periods=400, settle=300)) == pytest.approx(TRUTH["K1"][1], rel=1e-9)
    assert any("force record of 1200 samples" in note for note in K1_recorded.notes)
    with pytest.raises(ss.InputError, match=r"RecordedForce: the record does not repeat with period"):
        ss.drives.RecordedForce.from_samples(t, force=t, period=0.06)


def test_a_force_of_ones_own_needs_a_period_and_its_value():
    @dataclass(frozen=True)
    class Squared:
        size: float
        omega: float

        @property
        def period(self):
            return 2 * pi / self.omega

        def at(self, t):
            return self.size * sin(self.omega * t) ** 2

    own = capsubot(Squared(2.0, OMEGA), damping=0.5)
    same = capsubot(ss.drives.RecordedForce(0.06, 1.0, (0.0, -1.0), (0.0, 0.0)), damping=0.5)
    assert np.allclose(ss.solve(own, periods=10).strobe_v, ss.solve(same, periods=10).strobe_v, rtol=0, atol=1e-13)
    assert (Squared(2.0, OMEGA).__class__.__name__ in repr(ss.HarmonicForce(1.0, OMEGA) + Squared(1.0, OMEGA))) is True


@each_row("name", [*TRUTH, "both"])
def test_robots_come_back_from_their_files_and_from_the_mirror(name, runs):
    robot = TRUTH[name][0] if name in TRUTH else BOTH_SIDES
    assert ss.Robot.from_toml(robot.to_toml()) == robot
    image = ss.dynamics.mirrored(robot)
    assert ss.dynamics.mirrored(image) == robot and all(
        a.side == -b.side for a, b in zip(image.drive.stops, robot.drive.stops, strict=True)
    )
    there, here = (ss.solve(each, periods=10) for each in (image, robot))
    assert np.allclose(there.strobe_x, -here.strobe_x, rtol=0, atol=1e-13) and there.bodies["inner"].strobe_v == pytest.approx(-here.bodies["inner"].strobe_v, abs=1e-13)  # fmt: skip  # noqa: E501


def test_without_reaction_the_body_feels_the_spring_alone():
    """A force from outside on a free inner mass moves nothing else."""
    drive = ss.machines.Forced(ss.HarmonicForce(0.1, 60.0), reaction=False)
    run = ss.solve(ss.Robot(0.2, 0.1, drive, ss.Coulomb(1e-9, 1e-9)), periods=10)
    assert np.all(run.x == 0.0)
    x = 0.1 / (0.1 * 60.0**2) * (60.0 * run.t - np.sin(60.0 * run.t))  # two integrals of F/m
    assert run.bodies["inner"].x == pytest.approx(x, abs=1e-12)


def resting_start():
    """The state on the strobe with which the inner mass swings in a capsule at rest."""
    orbit = ss.periodic_orbit(C6)
    return orbit, {"x": {"inner": float(orbit.state[2])}, "v": {"inner": float(orbit.state[1])}}


def test_past_grazing_the_capsule_jumps_to_another_motion():
    """It rests up to the grazing gap, and from just below that it moves at once: there is no small motion between."""
    _, start = resting_start()
    at = lambda away: ss.solve(C7.replace({"drive.stops.0.gap": GRAZING + away}), periods=400, settle=300, start=start)  # noqa: E731
    above, below = ss.mean_velocity(at(1e-9)), ss.mean_velocity(at(-1e-9))
    assert above == 0.0 and below == pytest.approx(TRUTH["C7"][1], rel=1e-4)  # that of a gap smaller by 1e-4
    assert ss.mean_velocity(ss.solve(C7.replace({"drive.stops.0.gap": GRAZING + 1e-4}), periods=400, settle=300)) > 0.02  # both coexist


def test_a_branch_that_ends_where_a_stop_is_grazed_says_so():
    orbit, _ = resting_start()
    gaps = {"parameter": "drive.stops.0.gap", "start": GRAZING + 0.05, "stop": GRAZING - 0.05}
    branch = ss.continuation(C7.replace({"drive.stops.0.gap": GRAZING + 0.05}), guess=orbit.state, **gaps)
    assert branch.values[-1] == pytest.approx(GRAZING, abs=1e-6)
    assert branch.ended.startswith("the stop inner-body is grazed at drive.stops.0.gap = 1.5556") and "jump" in branch.ended


def test_a_batch_of_capsules_has_one_kernel_and_the_columns_of_the_body():
    gaps = np.array([0.4, 0.5, 0.6])
    many = ss.solve(C3.replace({"drive.stops.0.gap": gaps}), periods=400, settle=300)
    assert many.mean_velocity[1] == pytest.approx(TRUTH["C3"][1], rel=1e-10) and many.pattern.shape == (3,)
    assert many.hits[1].tolist() == [2] and many.to_xarray().hits.dims == ("case", "stop")


@each_row(
    ("make", "said"),
    [
        (lambda: ss.machines.Forced(3.0), r"force = 3.0; allowed is a force, an object with period, at; type for example ss.HarmonicForce"),
        (lambda: ss.machines.Forced(ss.Harmonic(1e-3, 200.0)), "allowed is a force"),
        (lambda: ss.drives.Pulses(1.0, 0.06, 1.0), r"duty = 1.0; allowed is between 0 and 1, .*; type for example duty=0.35"),
        (lambda: ss.drives.Pulses(1.0, 0.06, 0.0), r"duty = 0.0; allowed is between 0 and 1"),
        (lambda: ss.drives.Pulses(1.0, -0.06, 0.5), "period = -0.06; allowed is a positive period"),
        (lambda: ss.HarmonicForce(1.0), "give exactly one of omega .* got neither"),
        (lambda: ss.HarmonicForce(1.0, OMEGA) + 2.0, "a [+] b = 2.0; allowed is a force"),
        (lambda: capsule(1.0, 0.6, 0.05, 4.0, (ss.Stop(gap=-0.1, restitution=0.5),)), r"stops\[0\].gap = -0.1: .*; type side=-1"),
        (
            lambda: capsule(1.0, 0.6, 0.05, 4.0, [ss.Stop(gap=0.1, restitution=0.5)]),
            "this is a list, and several stops are given as a tuple",
        ),
        (lambda: capsule(1.0, 0.6, 0.05, 4.0, ("wall",)), r"type stops=\(ss.Stop\(gap=0.01, restitution=0.5\),\)"),
        (
            lambda: capsule(1.0, 0.6, 0.05, 4.0, (ss.Stop(gap=0.0, stiffness=1.0), ss.Stop(gap=0.0, stiffness=1.0, side=-1))),
            "leave no room between them; allowed is a gap of more than zero",
        ),
        (
            lambda: capsule(1.0, 0.6, 0.05, 4.0, (ss.Stop(gap=0.1, restitution=0.5), ss.Stop(gap=0.2, stiffness=1.0))),
            "the one behind a stop with restitution is never met; leave it out",
        ),
        (lambda: C3.replace(inner_mass=0.0), "inner_mass = 0.0; allowed is a positive mass"),
        (
            lambda: ss.Robot(1.0, 1.0, ss.HarmonicForce(1.0, 2.0), ss.Coulomb(0.1, 0.1)),
            r"type for example drive=ss.machines.Forced\(HarmonicForce",
        ),
        (lambda: C3.drive.acceleration(0.0), "the inner mass moves freely, and the robot has two bodies"),
        (lambda: ss.Chain((C3, C3), ss.Spring(1.0)), "allowed is a Robot whose drive prescribes the motion of its inner mass"),
    ],
)
def test_what_is_wrong_is_said_with_what_to_type(make, said):
    with pytest.raises(ss.InputError, match=said):
        make()


def test_a_start_beyond_a_stop_is_refused():
    with pytest.raises(StickslipError, match="inner-body"):
        ss.solve(C3, periods=2, start={"x": {"inner": 0.6}})


@each_row("name", ["capsule", "capsubot"])
def test_a_study_file_begins_with_a_preset(name, tmp_path, capsys):
    """`stickslip init` writes stops and forces as tables of their own, and `stickslip run` reads them."""
    from stickslip.show.cli import main

    path = tmp_path / "rig.toml"
    assert main(["init", str(path), "--preset", name]) == 0
    assert ss.Robot.from_toml(path.read_text(encoding="utf-8")) == getattr(ss.presets, name)()
    assert main(["run", str(path), "periods=20"]) == 0
    told = capsys.readouterr().out
    assert "inner" in told and "mean velocity" in told


def test_presets_give_the_numbers_that_they_name():
    assert ss.presets.capsubot() == K3 and ss.presets.capsule() == C1
    many = ss.solve(ss.presets.capsule(mass_ratio=[2.0, 5.0]), periods=400, settle=300)
    assert many.mean_velocity[0] < 0 < many.mean_velocity[1]


LUGRE = ss.LuGre(mu_plus=0.2, mu_minus=0.25, f_plus=0.3, f_minus=0.3, sigma0=200.0, sigma1=3.0, sigma2=0.05, v_s=0.1)


@pytest.mark.slow  # the judge's steps, not ours
@pytest.mark.parametrize("name", ["C1", "C3"])
def test_bristles_under_a_capsule_are_solved_as_the_judge_solves_them(name):
    """Lanes, one run, and SciPy's Radau at a tolerance of its own; both are held to 1e-9 in each step, of which there are some hundred."""
    robot = TRUTH[name][0].replace(friction=LUGRE)
    run = ss.solve(robot, periods=6, rtol=1e-9)
    judged = ss.solve(robot, periods=6, rtol=1e-10, method="radau")
    lanes = ss.solve(robot.replace({"drive.damping": np.array([0.1, 0.11])}), periods=6, settle=0, rtol=1e-9)
    assert np.allclose(run.strobe_v, judged.strobe_v, rtol=0, atol=1e-6) and np.allclose(run.strobe_x, judged.strobe_x, rtol=0, atol=1e-6)
    assert lanes.mean_velocity[0] == pytest.approx(ss.mean_velocity(ss.solve(robot, periods=6, settle=0, rtol=1e-9)), abs=1e-8)
    assert ss.energy(run).worst < 1e-6 and run.z.shape == run.t.shape


def test_a_stop_that_is_pressed_stays_closed_and_opens_again():
    """A force that grows pulls an inner mass of unit weight off its stop at the moment when it turns, by hand; before it, both rest."""
    drive = ss.machines.Forced(ss.HarmonicForce(-1.0, 1.0), stops=(ss.Stop(gap=0.0, restitution=0.3, side=-1),))
    robot = ss.Robot(3.0, 1.0, drive, ss.Coulomb(5.0, 5.0), gravity=1.0)
    run = ss.solve(robot, periods=1)
    before, after = (run.t > 1e-9) & (run.t < np.pi), run.t > np.pi  # nothing presses at t = 0
    inner = run.bodies["inner"]
    assert abs(run.v).max() < 1e-15 and abs(inner.x[before]).max() < 1e-12  # -sin t presses up to pi
    s = run.t[after] - np.pi  # x'' = sin s from rest, until it is back
    assert inner.x[after] == pytest.approx(s - np.sin(s), abs=1e-9)
    assert run.friction_force[before] == pytest.approx(0.0, abs=1e-12)  # force on the mass and reaction on the body cancel at the stop
    assert inner.acceleration[before] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TRUTH, "both"])
def test_the_judge_finds_the_same_motions(name):
    """SciPy's DOP853 on plain Python, from the state on the strobe of the exact run: one period returns to it."""
    robot = TRUTH[name][0] if name in TRUTH else BOTH_SIDES
    exact, judged = (ss.solve(robot, periods=8, method=method, rtol=1e-12) for method in ("auto", "dop853"))
    for body in ("body", "inner"):
        assert np.allclose(exact.bodies[body].strobe_x, judged.bodies[body].strobe_x, rtol=0, atol=1e-9)
        assert np.allclose(exact.bodies[body].strobe_v, judged.bodies[body].strobe_v, rtol=0, atol=1e-9)


def drawn(rng, cases, restitution=True):
    """Capsules with a stop on each side, many at once."""
    u = lambda low, high: rng.uniform(low, high, cases)  # noqa: E731
    stops = (
        ss.Stop(gap=u(0.02, 1.0), **({"restitution": u(0.0, 0.9)} if restitution else {"stiffness": u(5.0, 50.0)})),
        ss.Stop(gap=u(0.02, 1.0), restitution=u(0.0, 0.9), side=-1),
    )
    gamma = u(1.5, 8.0)
    drive = ss.machines.Forced(
        ss.HarmonicForce(u(0.3, 2.5), u(0.3, 1.6), phase=u(0.0, 6.0)), stiffness=u(0.3, 2.0), damping=u(0.02, 0.4), stops=stops
    )
    law = ss.Coulomb(*(u(0.5, 1.5) / (gamma + 1) for _ in range(2)))
    return ss.Robot(gamma, 1.0, drive, law, gravity=1.0, track=ss.Incline(u(-0.05, 0.05)))


@pytest.mark.slow
def test_a_thousand_drawn_capsules_are_finished():
    many = ss.solve(drawn(np.random.default_rng(5), 1000), periods=60, keep="summary")
    assert np.isin(many.status, (0, 1)).mean() >= 0.99


@pytest.mark.slow
def test_drawn_capsules_move_as_the_judge_says():
    """Rebounds that end, stops that stay closed and bodies that slide on an incline; DOP853 keeps 1e-10 in each step, of some hundred."""
    from stickslip.basics.batch import some_of

    many = drawn(np.random.default_rng(6), 12)
    for i in range(12):
        robot = some_of(many, [i])
        robot = robot.replace({name: float(value[0]) for name, value in _numbers(robot)})
        exact, judged = (ss.solve(robot, periods=3, method=method, rtol=1e-10) for method in ("auto", "dop853"))
        for body in ("body", "inner"):
            assert np.allclose(exact.bodies[body].strobe_v, judged.bodies[body].strobe_v, rtol=0, atol=1e-7)
        assert ss.energy(exact).worst < 1e-8


def _numbers(robot):
    from stickslip.basics.fields import leaves

    return [(name, np.atleast_1d(value)) for name, value in leaves(robot)]
