"""Periodic orbits, continuation, exponents and basins of robots, against closed formulas, second methods and published runs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import kinds
import stickslip as ss
from kinds import DRIVES, TRACKS
from problems import velocity_unit
from rows import each_row
from stickslip.analysis.closed_form import border_i_iii, border_ii_iii, border_iii_iv, periodic
from stickslip.dynamics.attractors.period_numbers import periods_of
from stickslip.dynamics.derivatives.tangents import jacobian_of
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.dynamics.stroboscopic.phase_shift import shifted_robots
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map, strobe_orbit
from stickslip.maths import where, within
from stickslip.show.cli import main

RIG = dict(tilt_deg=1.7, amplitude=6e-4)


def period_from(robot, state):
    """After how many drive periods the next strobe points repeat; 0 if they do not yet."""
    return int(periods_of(strobe_orbit(robot, state, 96)[0][:, 0], coordinates(robot).scales))


#: w of the Coulomb robot at (alpha+, alpha-), its type, and the fraction of the period: T7 to T10.
COULOMB = {
    "T7": (0.5, 1.2, "II", 0.201452203333669),
    "T8": (0.7, 0.9, "I", 0.0615227380297986),
    "T9": (0.4, 0.8, "III", 0.269172787549942),
    "T10": (0.4, 0.5, "IV", 0.122475359974498),
}
UNIT = 1e-3 * 0.1 * 100.0  # A mu omega of `dimensionless_robot` [m/s]


def dimensionless_robot(alpha_plus, alpha_minus):
    """A Coulomb robot with these two numbers: A = 1 mm, omega = 100 rad/s, mass ratio 0.1."""
    c = UNIT * 100.0 / 10.0
    law = ss.Coulomb(mu_plus=alpha_plus * c, mu_minus=alpha_minus * c)
    return ss.Robot(0.09, 0.01, ss.Harmonic(amplitude=1e-3, omega=100.0), law, gravity=10.0)


def by_ratio(alpha_plus, k):
    return dimensionless_robot(alpha_plus, k * alpha_plus)


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def branch():
    """Period one of the paper's rig at A = 0.6 mm, down in mu0 through the window of doubling."""
    return ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.05, stop=0.0345, **RIG)


@pytest.fixture(scope="module")
def doubled(branch):
    return branch.doubled()


# orbits ------------------------------------------------------------------------------------------------------------


@each_row("row", COULOMB)
def test_coulomb_orbits_are_the_closed_ones(row):
    plus, minus, kind, mean = COULOMB[row]
    orbit = ss.periodic_orbit(dimensionless_robot(plus, minus))
    assert orbit.type == kind
    assert orbit.mean_velocity / UNIT == pytest.approx(mean, abs=1e-10)
    assert orbit.residual < 1e-12 and orbit.names == ("v",)


def test_rest_wipes_out_and_reversals_shrink():
    """Type IV: product over its reversals of (drive - friction)/(drive + friction) at them; with rest exactly 0."""
    for row, (plus, minus, kind, _) in COULOMB.items():
        orbit = ss.periodic_orbit(dimensionless_robot(plus, minus))
        if kind != "IV":
            assert orbit.multipliers.tolist() == [0.0] and orbit.memory == 0.0, row
            continue
        expected = 1.0
        for event in orbit.events:
            s = math.sin(100.0 * event.t)
            before, after = (s - plus, s + minus) if event.before > 0 else (s + minus, s - plus)
            expected *= after / before
        assert float(orbit.multipliers[0]) == pytest.approx(expected, abs=1e-12)
        assert float(orbit.differences[0].real) == pytest.approx(expected, abs=1e-6)


def test_the_slow_method_gives_the_same_multiplier():
    """The same robot as a switching flow, by scipy's integrator and saltation matrices written for any flow."""
    robot = dimensionless_robot(0.4, 0.5)
    orbit = ss.periodic_orbit(robot)
    v = float(orbit.state[0])
    done = ss.dynamics.passage(ss.dynamics.switching_flow(robot), [0.0, v], 1 if v > 0 else -1, robot.period, method="dop853")
    assert done.state[1] == pytest.approx(v, abs=1e-13 * UNIT + 1e-13)
    assert done.monodromy[1, 1] == pytest.approx(float(orbit.multipliers[0]), abs=1e-10)


@each_row("mu0", [0.03, 0.04, 0.18])
def test_the_tangent_is_the_derivative_of_the_map(mu0):
    """Away from any orbit too, at two step sizes: differences of step h are good to h^2 times the curvature plus 1e-13/h."""
    robot = ss.presets.piezo_rig(mu0=mu0, **RIG)
    state = strobe_map(robot, [[0.0, 0.0]], 7).state[0]
    M = jacobian_of(robot, state)
    scale = coordinates(robot).scales
    inward = lambda J: J / scale[:, None] * scale  # noqa: E731
    for step in (1e-6, 3e-6):
        np.testing.assert_allclose(inward(M), inward(difference_jacobian(robot, state, 1, step=step)), atol=1e-6)


def test_an_unstable_orbit_is_found_between_the_points_of_its_doubling():
    orbit = ss.periodic_orbit(ss.presets.piezo_rig(mu0=0.04, **RIG))
    assert not orbit.stable and float(orbit.multipliers[0]) < -1 and orbit.residual < 1e-11
    assert orbit.memory < 0, "disturbances grow"
    # one more period from the orbit: what Newton left over grows by the multiplier only
    end = strobe_map(orbit.model, orbit.state[None, :], 3).state[0]
    assert np.max(abs(end - orbit.state) / coordinates(orbit.model).scales) < 1e-9


def test_an_orbit_under_another_law_gives_what_both_states_have():
    """Its velocity is no deflection of a bristle: that begins as at rest. With no number in common it is refused."""
    dry, elastic = (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law=law) for law in ("coulomb", "lugre"))
    orbit = ss.periodic_orbit(dry)
    assert states_of(orbit, elastic).tolist() == [[orbit.state[0], 0.0]]
    with pytest.raises(ss.InputError, match=r"the orbit's state is v; allowed is an orbit with v\.module 1"):
        ss.periodic_orbit(ss.Chain.example(), guess=orbit)


def test_every_kind_of_guess_leads_to_the_same_orbit():
    robot = ss.presets.piezo_rig(**RIG)
    orbit = ss.periodic_orbit(robot)
    for guess in (orbit, orbit.state, orbit.start, ss.solve(robot, periods=30)):
        np.testing.assert_allclose(ss.periodic_orbit(robot, guess=guess).state, orbit.state, rtol=1e-9)


def test_a_motion_of_half_the_period_is_not_sold_as_one_of_the_whole():
    with pytest.raises(ss.SolveError, match="repeats earlier"):
        ss.periodic_orbit(ss.presets.piezo_rig(**RIG), period=2)


def test_wrong_orders_are_told_what_to_type():
    robot = ss.presets.piezo_rig(**RIG)
    for act, words in (
        (lambda: ss.periodic_orbit(robot, period=0), "whole number"),
        (lambda: ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[1e-4, 2e-4])), "batch"),
        (lambda: ss.periodic_orbit("robot"), "not a model"),
        (lambda: ss.periodic_orbit(robot, guess=[1.0, 2.0, 3.0]), "v, z"),
        (lambda: ss.continuation(ss.presets.piezo_rig, parameter="mu", start=0.1, stop=0.2, **RIG), "mu0"),
        (lambda: ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.1, stop=0.1, **RIG), "two different"),
        (lambda: ss.continuation(robot, parameter="drive.amplitud", start=1e-4, stop=2e-4), "drive.amplitude"),
        (lambda: ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=[0.2, 0.1], **RIG), "rising"),
        (lambda: ss.basins(robot, w=[0.0]), "phase"),
        (lambda: ss.lyapunov(robot, periods=3), "from 20"),
    ):
        with pytest.raises(ss.InputError, match=words):
            act()


# continuation ------------------------------------------------------------------------------------------------------


def test_both_ends_of_the_window_of_doubling(branch):
    """The flips at mu0 = .0468 and .0352: one multiplier is -1 there, by the tangent and by differences."""
    flips = [s for s in branch.special if s.kind == "flip"]
    assert [round(s.value, 4) for s in flips] == [0.0468, 0.0352]
    for kind, value, orbit in flips:
        assert kind == "flip" and float(orbit.multipliers[0]) == pytest.approx(-1.0, abs=1e-9)
        assert float(orbit.differences[0].real) == pytest.approx(-1.0, abs=1e-6)
        aside = [ss.periodic_orbit(ss.presets.piezo_rig(mu0=value + d, **RIG), guess=orbit).stable for d in (-1e-6, 1e-6)]
        assert aside[0] != aside[1], "1e-6 to both sides the stability differs"


def test_a_branch_is_a_labelled_dataset(branch):
    points = branch.points
    assert points.mu0.dims == ("point",) and points.mu0.attrs["units"] == "1"
    assert float(points.mu0[0]) == 0.05 and float(points.mu0[-1]) == pytest.approx(0.0345, abs=1e-12)
    assert not bool(points.stable[int(np.argmin(abs(points.mu0.values - 0.04)))]) and bool(points.stable[0])
    assert (points.residual < 1e-9).all() and "end of the range" in branch.ended
    orbit = branch.at(0.04)
    assert orbit.mean_velocity == pytest.approx(ss.periodic_orbit(ss.presets.piezo_rig(mu0=0.04, **RIG)).mean_velocity, rel=1e-10)


def test_the_doubled_branch_closes_the_window_and_loses_stability_inside(branch, doubled):
    first, last = (s.value for s in branch.special if s.kind == "flip")
    assert doubled.period == 2 and doubled.values[0] == pytest.approx(first, abs=2e-5)
    assert "half the period" in doubled.ended and doubled.values[-1] == pytest.approx(last, abs=1e-10)
    again = [s.value for s in doubled.special if s.kind == "flip"]
    assert [round(v, 5) for v in again] == [0.03841, 0.03606], "where period four takes over, and gives back"
    at = doubled.at(0.04)
    assert at.stable and at.mean_velocity == pytest.approx(0.011746793, rel=1e-6)


def test_period_four_where_the_doubled_branch_is_unstable():
    robot = ss.presets.piezo_rig(mu0=0.038, **RIG)
    assert period_from(robot, strobe_map(robot, [[0, 0]], 600, 1e-9).state) == 4


def test_a_fold_is_passed():
    """Two motions at A = 0.8 mm, f0 = 0.5: one of them ends in a fold when f0 falls, and the branch comes back unstable."""
    start = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, f0=0.5), guess=dict(v=1.5e-4, z=-4.6e-8))
    b = ss.continuation(ss.presets.piezo_rig, parameter="f0", start=0.5, stop=0.497, guess=start, tilt_deg=1.7, amplitude=8e-4, points=30)
    folds = [s for s in b.special if s.kind == "fold"]
    assert folds
    assert float(abs(folds[0].orbit.multipliers - 1.0).min()) < 1e-5, "a multiplier is 1 at a fold"


ABSOLUTE = ss.SwitchingFlow({0: lambda t, y, n: (abs(y[0]) - n.mu,)}, {}, 1.0, {"mu": 1.0}, ("y",))

BORDERS = [
    (dimensionless_robot, "alpha_minus", 0.97, 1.2, dict(alpha_plus=0.3), lambda: 1.0),  # T5
    (by_ratio, "alpha_plus", 0.45, 0.35, dict(k=2.0), lambda: float(border_i_iii(2.0))),  # T4
    (by_ratio, "alpha_plus", 0.32, 0.25, dict(k=2.0), lambda: float(border_iii_iv(2.0))),  # T3
    (by_ratio, "alpha_plus", 0.6, 0.5, dict(k=1.0), lambda: float(border_iii_iv(1.0))),
    (dimensionless_robot, "alpha_plus", 0.15, 0.08, dict(alpha_minus=0.9), lambda: float(border_ii_iii(0.9))),  # T6
]


@pytest.mark.parametrize("case", BORDERS, ids=["II-I", "I-III", "III-IV k=2", "III-IV k=1", "II-III"])
def test_type_borders_are_the_closed_ones(case):
    make, parameter, start, stop, fixed, expected = case
    b = ss.continuation(make, parameter=parameter, start=start, stop=stop, step=0.1, **fixed)
    assert [s.kind for s in b.special] == ["type-border"]
    assert b.special[0].value == pytest.approx(expected(), abs=1e-10)


def test_three_borders_meet_in_one_point():
    """Types I, II and III: (0.217233628211222, 1), found from each of the three borders."""
    down = ss.continuation(dimensionless_robot, parameter="alpha_minus", start=0.9, stop=1.1, step=0.1, alpha_plus=0.3)
    across = ss.continuation(dimensionless_robot, parameter="alpha_plus", start=0.15, stop=0.08, step=0.1, alpha_minus=0.9)
    curves = [ss.dynamics.special_curve(down, s, "alpha_plus", 0.1, step=0.05) for s in down.special]
    curves.append(ss.dynamics.special_curve(across, across.special[0], "alpha_minus", 1.1, step=0.05))
    assert len(curves) == 3
    for curve in curves:
        assert [m.kind for m in curve.special] == ["triple-point"]
        found = dict(zip(curve.parameters, curve.special[0].values, strict=True))
        assert found["alpha_plus"] == pytest.approx(0.217233628211222, abs=1e-10)
        assert found["alpha_minus"] == pytest.approx(1.0, abs=1e-10)
    for minus, plus in curves[2].values[:, ::-1][:-1]:
        assert plus == pytest.approx(float(border_ii_iii(minus)), abs=1e-10)


def test_borders_of_the_paper_in_its_amplitude():
    """P9: .37027, .55297 and .64711 mm at 1.7 degrees."""
    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3e-4, stop=7e-4, tilt_deg=1.7, law="coulomb")
    assert [round(s.value * 1e3, 5) for s in b.special] == [0.37027, 0.55297, 0.64711]
    assert [o.type for o in (b.orbits[0], b.orbits[-1])] == ["II", "IV"]


def test_a_curve_of_flips_stays_on_the_flip(branch):
    flip = next(s for s in branch.special if s.kind == "flip")
    curve = ss.dynamics.special_curve(branch, flip, "amplitude", 6.2e-4, step=0.1)
    for (mu0, amplitude), orbit in zip(curve.values, curve.orbits, strict=True):
        again = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, mu0=mu0, amplitude=amplitude), guess=orbit)
        assert float(again.multipliers[0]) == pytest.approx(-1.0, abs=1e-6)
    assert curve.values[-1, 1] >= 6.2e-4


def test_leaving_the_admissible_region_is_said():
    """Folded friction needs mu0 > tan(tilt) = 0.0297."""
    b = ss.continuation(dimensionless_robot, parameter="alpha_plus", start=0.2, stop=-0.1, alpha_minus=0.5)
    assert "admissible" in b.ended and b.values[-1] >= 0


# mechanisms --------------------------------------------------------------------------------------------------------


def den_hartog(F):
    """Den Hartog's oscillator at 0.7 of its own frequency; everything else is 1."""
    return ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, force=1.0, omega=0.7, friction=ss.Coulomb(F, F))


def test_den_hartogs_orbit_with_the_position_as_a_coordinate():
    """O1: amplitude, and the product of the multipliers: each reversal shrinks areas by (q - F)/(q + F) with q = X R^2."""
    orbit = ss.periodic_orbit(den_hartog(0.3), guess=dict(x=1.0, v=-1.0))
    X = 1.88569985041425
    assert orbit.names == ("x", "v") and orbit.residual < 1e-10
    assert np.max(abs(orbit.run.x)) == pytest.approx(X, abs=1e-10)
    expected = ((X * 0.49 - 0.3) / (X * 0.49 + 0.3)) ** 2
    assert float(np.prod(orbit.multipliers).real) == pytest.approx(expected, abs=1e-8)
    np.testing.assert_allclose(orbit.multipliers, orbit.differences, atol=1e-6)


def test_an_adding_sliding_border_is_where_den_hartog_says():
    """Rest begins at F = V / sqrt(1/R^4 + U^2); beyond it one multiplier is exactly 0."""
    V, U = 1 / (1 - 0.49), math.tan(math.pi / 1.4) / 0.7
    b = ss.continuation(den_hartog, parameter="F", start=0.7, stop=0.75, step=0.1)
    assert [s.kind for s in b.special] == ["type-border"]
    assert b.special[0].value == pytest.approx(V / math.sqrt(1 / 0.49**2 + U**2), abs=1e-10)
    assert float(b.orbits[-1].multipliers[-1]) == 0.0 and 0.0 not in b.orbits[0].multipliers


def test_any_set_valued_law_has_orbits():
    law = ss.Stribeck(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, v_s=2e-3)
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=law)
    orbit = ss.periodic_orbit(robot)
    assert orbit.multipliers.tolist() == [0.0] and orbit.residual < 1e-10
    run = ss.solve(robot, periods=40)
    assert orbit.mean_velocity == pytest.approx(ss.mean_velocity(run), rel=1e-9)


def test_an_impulse_at_a_known_instant_is_no_switch():
    """D1: the two-phase drive, closed V = 0.000470057764 m/s; the strobe state is the state after the impulse."""
    robot = ss.Robot(1 - 0.1315, 0.1315, ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1), ss.Coulomb(0.15, 0.25))
    orbit = ss.periodic_orbit(robot)
    assert orbit.mean_velocity == pytest.approx(0.000470057764, abs=5e-13)
    assert float(orbit.state[0]) == pytest.approx(-0.1315 * 0.2, rel=1e-12), "the jump J = mu (u1 + u2)"
    assert orbit.multipliers.tolist() == [0.0] and "impulse" in [e.kind for e in orbit.events]


# brute force, exponents, verdicts ----------------------------------------------------------------------------------


def test_brute_force_and_continuation_agree(doubled):
    values = np.linspace(0.0395, 0.046, 6)
    d = ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=values, settle=300, points=32, follow=False, **RIG)
    assert d.v.dims == ("direction", "mu0", "point") and (d.period == 2).all()
    for mu0 in values:
        orbit = doubled.at(mu0)
        assert abs(d.v.sel(mu0=mu0, direction="from start").values - orbit.state[0]).min() < 1e-5 * velocity_unit(orbit.model)
        assert float(d.mean_velocity.sel(mu0=mu0)[0]) == pytest.approx(orbit.mean_velocity, rel=1e-5)


def test_going_up_and_down_shows_hysteresis():
    """At A = 0.8 mm two motions coexist at f0 = 0.5; going down in f0 and up again the robot stays on what it was on."""
    d = ss.bifurcation(
        ss.presets.piezo_rig, parameter="f0", values=np.linspace(0.25, 0.6, 15), settle=80, points=16, tilt_deg=1.7, amplitude=8e-4
    )
    apart = abs(d.mean_velocity.sel(direction="up") - d.mean_velocity.sel(direction="down"))
    assert float(apart.max()) > 5e-4


@pytest.mark.parametrize(("amplitude", "mu0", "published"), [(4e-4, 0.05, 0.44), (5e-4, 0.04, 0.21)])
def test_chaos_by_two_methods(amplitude, mu0, published):
    """Three standard errors of each method; they share no code but the engine's steps."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, mu0=mu0)
    found = ss.verdict(robot, periods=500, settle=200)
    assert found.kind == "chaotic" and found.period is None
    starts = np.column_stack([np.linspace(-2e-3, 2e-3, 16), np.zeros(16)])
    each, _ = ss.dynamics.largest_exponents(
        robot.replace({"drive.amplitude": np.full(16, amplitude)}), periods=60, settle=100, start=starts
    )
    other, scatter = each.mean(), each.std(ddof=1) / 4
    l = found.exponents  # noqa: E741
    assert abs(l.largest - other) < 3 * math.hypot(l.error, scatter)
    assert abs(l.largest - published) < 3 * l.error + 0.005
    assert l.record[-1, 1] == l.largest and l.spectrum[1] < -100


def test_exponents_of_a_periodic_motion_are_logarithms_of_its_multipliers():
    robot = ss.presets.piezo_rig(**RIG)
    orbit = ss.periodic_orbit(robot)
    found = ss.lyapunov(robot, periods=40, settle=50)
    assert found.largest == pytest.approx(math.log(abs(orbit.multipliers[0])), abs=1e-5)
    assert ss.verdict(robot, periods=40, settle=60).kind == "periodic"


def test_rest_has_exponent_minus_infinity_and_says_so():
    found = ss.lyapunov(dimensionless_robot(0.7, 0.9), periods=20)
    assert found.largest == -math.inf and "rest" in found.note and found.error == 0.0


def test_a_slow_transient_is_not_called_a_period(branch):
    """Just beside the flip disturbances shrink by less than one per cent a period."""
    flip = branch.special[0].value
    robot = ss.presets.piezo_rig(mu0=flip + 3e-5, **RIG)
    orbit = ss.periodic_orbit(robot)
    assert orbit.stable and orbit.memory > 50
    aside = orbit.state + np.array([2e-5, 0.0])
    assert period_from(robot, aside) == 0
    told = ss.verdict(robot, periods=20, settle=0, start=aside)
    assert (told.kind, told.period) == ("periodic", 1) and told.orbit.state == pytest.approx(orbit.state, rel=1e-9)


# basins, sections, spectra -----------------------------------------------------------------------------------------


def test_two_motions_coexist_and_every_start_is_shared_out():
    """A = 0.8 mm, f0 = 0.5: V near .0020 and .0036."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, f0=0.5)
    found = ss.basins(robot, v=np.linspace(-0.1, 0.1, 9), z=np.linspace(-2e-6, 2e-6, 3), settle=100)
    assert sorted(round(a.mean_velocity, 4) for a in found.attractors) == [0.002, 0.0036]
    assert sum(found.fractions) == pytest.approx(1.0) and found.map.attractor.dims == ("v", "z")
    for a in found.attractors:
        assert a.interval[0] < a.share < a.interval[1] and a.orbit.stable
        assert a.orbit.mean_velocity == pytest.approx(a.mean_velocity, rel=1e-5)
    # one start, run by itself
    V = ss.mean_velocity(ss.solve(robot, periods=200, start=dict(v=0.1, z=2e-6)))
    assert float(found.map.mean_velocity[-1, -1]) == pytest.approx(V, rel=1e-4)
    ax = ss.plot.basins(found)
    assert "mm/s" in ax.get_xlabel() and len(ax.get_legend().get_texts()) == len(found.attractors) + 1


def test_starts_in_any_of_three_periods_of_a_motion_are_attracted_by_one():
    """A mean over 64 strobe points of period 3 holds one of them once too often: it depends on which."""
    found = ss.basins(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=3.92e-4, mu0=0.05), v=np.linspace(-0.02, 0.02, 5), settle=400)
    assert [(a.period, a.share) for a in found.attractors] == [(3, 1.0)]


@each_row("drive", DRIVES)
@pytest.mark.parametrize("track", TRACKS)
def test_a_robot_at_another_phase_has_its_equations_of_that_time(drive, track):
    robot = kinds.robot("coulomb", drive, track)
    later, t = shifted_robots("basins", robot, 0.3), np.linspace(0, 1, 7) * robot.period
    for of in (lambda r, t: r.acceleration(t, 0.0, 0.1, 0.2), lambda r, t: r.load(t, 0.0)):
        np.testing.assert_allclose(of(later, t), of(robot, t + 0.3 * robot.period), rtol=1e-12)


def test_one_robot_goes_one_way_from_every_phase():
    """Its load and its friction vary with the drive, so they start at that phase too."""
    drive = ss.drives.VerticalVibration(ss.Harmonic(amplitude=8e-4, omega=205.0), amplitude=5e-5, phase=1.0)
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    robot = robot.replace(drive=drive, track=ss.tracks.VaryingFriction(ss.Level(), depth=0.3, phase=1.5))
    V = ss.mean_velocity(ss.solve(robot, periods=20, method="dop853", rtol=1e-8))
    found = ss.basins(robot, phase=[0.0, 0.25, 0.5], settle=20)
    assert len(found.attractors) == 1
    np.testing.assert_allclose(found.map.mean_velocity, V, rtol=1e-6)


@dataclass(frozen=True)
class Sawtooth:
    """Parabolas, one in each period; it names no breaks."""

    amplitude: float
    period: float

    def position(self, t):
        s = within(t, self.period) / self.period
        return self.amplitude * s * (1 - s)

    def velocity(self, t):
        return self.amplitude * (1 - 2 * within(t, self.period) / self.period) / self.period

    def acceleration(self, t):
        return where(within(t, self.period) < 0.5 * self.period, 1.0, -2.0) * self.amplitude / self.period**2


@pytest.mark.parametrize("drive", [Sawtooth(1e-3, 0.03), ss.drives.TwoPhase(stroke=1e-3, u1=0.05, u2=0.2)], ids=lambda d: type(d).__name__)
def test_a_drive_in_pieces_may_start_at_any_phase(drive):
    """The starts all lead to one motion, and a shifted run is the run itself from there."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb").replace(drive=drive)
    found = ss.basins(robot, phase=[0.0, 0.3, 0.8], settle=60)
    V = ss.mean_velocity(ss.solve(robot, periods=60))
    np.testing.assert_allclose(found.map.mean_velocity, V, rtol=1e-6)
    later = shifted_robots("basins", robot, 0.3)
    ours, judge = ss.solve(later, periods=4), ss.solve(later, periods=4, method="dop853", rtol=1e-12)
    assert ours.method == "exact" and len(ours.events) == len(judge.events)
    assert ours.v[-1] == pytest.approx(judge.v[-1], abs=1e-11)


def test_a_phase_where_there_is_no_drive_is_refused():
    with pytest.raises(ss.InputError, match="ForcedOscillator has none; leave phase out"):
        ss.basins(ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, ss.Coulomb(0.3, 0.3)), phase=[0.2])


def test_a_start_at_another_phase_is_a_start_of_the_shifted_drive():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, f0=0.5)
    found = ss.basins(robot, phase=[0.0, 0.25], settle=60)
    plain = ss.basins(robot, v=[0.0], settle=60)
    assert float(found.map.mean_velocity[0]) == pytest.approx(float(plain.map.mean_velocity[0]), rel=1e-5)
    assert round(float(found.map.mean_velocity[1]), 4) in (0.002, 0.0036)


def test_sections_of_a_periodic_motion_are_points():
    run = ss.solve(ss.presets.piezo_rig(mu0=0.04, **RIG), periods=200, rtol=1e-9)
    for phase in (0.0, 0.3):
        v = ss.dynamics.strobe(run, phase).v.values
        assert abs(v[2:] - v[:-2]).max() < 1e-6 * velocity_unit(run.model) and abs(v[1:] - v[:-1]).max() > 1e-4
    section = ss.dynamics.poincare(run, direction=-1)
    assert abs(section.v).max() < 1e-12
    assert len(np.unique(section.phase.values.round(6))) == 2, "one fall through v = 0 in each period, two of them different"


@each_row(
    ("act", "words", "count"),
    [
        (lambda run: ss.dynamics.strobe(run, "x", settle=-3), "settle = -3; allowed is a whole number from 0 below the 4 drive periods", 2),
        (lambda run: ss.dynamics.strobe(run, settle=4), "settle = 4; .* type for example settle=2", 1),
        (lambda run: ss.dynamics.poincare(run, on="w", value="x", direction=2, settle=0.5), "on = 'w' is not a column", 4),
        (lambda run: ss.dynamics.spectrum(run, "foo", harmonics=0, periods=5), "periods = 5; allowed is a whole number from 1 to the 4", 3),
    ],
)
def test_wrong_orders_of_sections_are_told_what_to_type(act, words, count):
    run = ss.solve(ss.presets.piezo_rig(law="coulomb", **RIG), periods=4)
    with pytest.raises(ss.InputError, match=words) as told:
        act(run)
    assert len(told.value.problems) == count


def test_lines_of_a_spectrum_add_up_to_the_power():
    """Parseval: the mean of v^2 is the sum of the lines; what lies beyond the 40th harmonic is below 1e-5 of it."""
    run = ss.solve(ss.presets.piezo_rig(mu0=0.04, **RIG), periods=200, rtol=1e-9)
    lines = ss.dynamics.spectrum(run)
    assert lines.attrs["period"] == 2 and lines.attrs["window"] == "none"
    mean = float(lines.amplitude[0])
    assert mean == pytest.approx(abs(ss.mean_velocity(run)), rel=1e-5)
    t = run.strobe_times[-1] - (np.arange(20_000) + 0.5) / 20_000 * 2 * run.period_time
    power = float((run.at(t)["v"] ** 2).mean())
    assert mean**2 + 0.5 * float((lines.amplitude[1:] ** 2).sum()) == pytest.approx(power, rel=1e-5)
    assert float(lines.amplitude.sel(order=0.5)) > 1e-4, "period two has a line at half the frequency"


# pictures and commands ---------------------------------------------------------------------------------------------


def test_a_branch_is_drawn_full_and_dashed(branch, doubled):
    ax = ss.plot.continuation([branch, doubled])
    styles = {str(line.get_linestyle()) for line in ax.lines if len(line.get_xdata()) > 10}
    assert "-" in styles and len(styles) > 1, "stable full, unstable dashed"
    assert any(line.get_marker() == "s" for line in ax.lines), "flips are marked"
    assert "friction coefficient" in ax.get_xlabel() and "mm/s" in ax.get_ylabel()
    with pytest.raises(ss.InputError, match="observable"):
        ss.plot.continuation(branch, "w")


def test_commands_tell_what_the_functions_tell(capsys, tmp_path):
    robot = ["piezo_rig", "tilt_deg=1.7", "amplitude=6e-4"]
    assert main(["lyapunov", *robot, "law=coulomb", "periods=20", "settle=30"]) == 0
    out = capsys.readouterr().out
    assert "periodic, period 1" in out and "-inf" in out
    figure, data = tmp_path / "d.png", tmp_path / "d.nc"
    assert main(["bifurcation", *robot, "mu0=0.045..0.049:5", "settle=100", "--batch", "--figure", str(figure), "--out", str(data)]) == 0
    assert figure.stat().st_size > 5000 and data.exists() and "period 2 from 0.045" in capsys.readouterr().out
    assert main(["basins", *robot, "v=-0.01,0.01", "settle=60", "--json"]) == 0
    assert '"attractors"' in capsys.readouterr().out
    assert main(["bifurcation", *robot]) == 2 and "exactly one" in capsys.readouterr().err


def test_closed_mean_along_a_branch():
    b = ss.continuation(by_ratio, parameter="alpha_plus", start=0.2, stop=0.45, step=0.1, k=2.0)
    for alpha, orbit in zip(b.values, b.orbits, strict=True):
        assert orbit.mean_velocity / UNIT == pytest.approx(float(periodic(alpha, 2 * alpha).mean), abs=1e-10)


def test_a_doubled_branch_away_from_borders_has_one_word_and_its_runs_have_it_too():
    branch = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.0394, stop=0.0389, period=2, tilt_deg=1.7, amplitude=6e-4)
    assert {orbit.pattern for orbit in branch.orbits} == {"+0-0+0-0"} and branch.special == []
    orbit = branch.orbits[0]
    assert (ss.motion(orbit.run).type, ss.motion(orbit.run).period) == (orbit.type, 2) == ("other", 2)
    assert ss.mean_velocity(orbit.run) == orbit.mean_velocity


WEAKENED = dict(tilt_deg=1.7, f0=0.5)  # breakaway far above sliding friction: multipliers of 1500


def test_a_branch_goes_on_where_multipliers_are_large():
    """At A = .802357 mm the multiplier is 72 and grows, and steps of a branch that takes differences shrink to nothing there."""
    start = ss.periodic_orbit(ss.presets.piezo_rig(amplitude=8.0236e-4, **WEAKENED), guess=dict(v=1.667e-4, z=-6.6e-8))
    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=8.0236e-4, stop=8.02e-4, guess=start, **WEAKENED)
    assert b.values[-1] == 8.02e-4 and len(b.orbits) < 40 and b.orbits[-1].multipliers[0] > 120
    assert max(o.residual for o in b.orbits) < 1e-9
    last = b.orbits[-1]
    assert last.differences[0] == pytest.approx(last.multipliers[0], rel=1e-2), "differences bend: the map curves within 1e-5"


@pytest.mark.slow
def test_a_branch_goes_from_the_slow_to_the_fast_motion_through_its_folds():
    """f0 = .5: runs that are followed up jump off the slow motion, and down off the fast one, where the branch loses its stability."""
    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=7e-4, stop=9e-4, points=500, **WEAKENED)
    assert b.values[-1] == 9e-4 and b.ended == "it reached the end of the range"
    stable = np.array([o.stable for o in b.orbits])
    folds, flips = ([s.value for s in b.special if s.kind == kind] for kind in ("fold", "flip"))
    assert flips[0] == pytest.approx(8.0235653e-4, abs=1e-11) and folds[-1] == pytest.approx(7.424e-4, abs=1e-7)
    slow, fast = b.values < flips[0], np.arange(len(stable)) > int(np.argmin(abs(b.values - folds[-1])))
    assert stable[: int(np.argmin(slow))].all() and stable[fast].all() and b.orbits[-1].stable
    for amplitude, start, ends in ((8.0e-4, 0, 0), (8.0e-4, -1, -1), (7.43e-4, -1, -1), (8.04e-4, 0, -1), (7.41e-4, -1, 0)):
        rig = ss.presets.piezo_rig(amplitude=amplitude, **WEAKENED)
        sides = [np.flatnonzero(slow)[: int(np.argmin(slow))], np.flatnonzero(fast)]
        nearest = [b.orbits[side[int(np.argmin(abs(b.values[side] - amplitude)))]] for side in sides]
        run = ss.solve(rig, periods=600, settle=599, start=nearest[start].start, rtol=1e-9)
        orbit = ss.periodic_orbit(rig, guess=nearest[ends])
        assert orbit.stable and ss.mean_velocity(run) == pytest.approx(orbit.mean_velocity, rel=1e-5), amplitude


def test_a_branch_turns_back_at_a_corner_by_itself():
    """Rest of y' = |y| - mu is at y = -mu and y = mu, multipliers exp(-1) and exp(1), down to mu = 0, where both meet without a tangent."""
    b = ss.continuation(ABSOLUTE, parameter="mu", start=1.0, stop=-1.0, guess={"y": -1.0})
    y = np.array([float(o.state[0]) for o in b.orbits])
    turn = int(np.argmin(b.values))
    np.testing.assert_allclose(y, np.where(np.arange(len(y)) <= turn, -b.values, b.values), atol=1e-9)
    assert y[-1] == pytest.approx(1.0, abs=1e-9) and b.orbits[-1].multipliers[0] == pytest.approx(math.e, rel=1e-9)
    (fold,) = b.special
    assert fold.kind == "fold" and abs(fold.value) <= fold.accuracy <= 1e-3
