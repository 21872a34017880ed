"""Intervals where a sum of squares has shoulders, records whose noise differs, and derivatives beside kinks."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_states
from stickslip.inverse.identification.covariance import information_of, noise_sizes
from stickslip.inverse.identification.fit_settings import FitSettings
from stickslip.inverse.identification.identify import problem_of
from stickslip.inverse.identification.law_forces import driven_force
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.inverse.identification.steady_curves import periods_to_settle, steady_curve
from stickslip.inverse.identification.weak_directions import sharpened

RIG = ss.presets.piezo_rig


# shoulders --------------------------------------------------------------------------------------------------------


def late(a):
    """A law that a number changes only beyond 0.3."""
    mu = 0.2 + max(a - 0.3, 0.0)
    return ss.Coulomb(mu, mu)


def fitted_late(mu):
    """A fit of that number to forces over strokes with noise, whose best coefficient is this one."""
    t = np.linspace(0.0, 2.0, 800)
    x = 2e-4 * np.sin(2 * np.pi * t)
    motion = PrescribedMotion(t, np.concatenate([[0.0], np.diff(x) / np.diff(t)]), np.full(len(t), 10.0), np.zeros(len(t)), 0, False, "")
    shape = driven_force(ss.Coulomb(1.0, 1.0), motion)[:, 0]
    noise = np.random.default_rng(1).normal(scale=0.05, size=len(t))
    noise = noise - shape * (noise @ shape) / (shape @ shape)
    record = ss.Record.of(t, {"x [m]": x, "F [N]": mu * shape + noise}, roles={"F": "force"})
    return ss.identify(record, late, free={"a": (0.285, 0.31)}, load=10.0, starts=32, sensor={})


@pytest.fixture(scope="module")
def error():
    """Standard error of the coefficient."""
    return fitted_late(0.205).errors["a"]


@each_row("away", [1.5, 1.7, 1.9])
def test_an_interval_goes_on_over_a_shoulder_that_is_lower_than_the_level_allows(error, away):
    """The sum of squares rises by less than 1.96² standard errors up to where the number does nothing, and no more from there on."""
    fit = fitted_late(0.2 + away * error)
    low, high = fit.interval("a")
    assert fit.bent == ("a",) and low == 0.285
    assert high == pytest.approx(0.3 + (away + 1.96) * error, abs=0.1 * error)


def test_an_interval_ends_before_a_shoulder_that_is_higher(error):
    low, high = fitted_late(0.2 + 2.5 * error).interval("a")
    assert [low, high] == pytest.approx([0.3 + (2.5 - 1.96) * error, 0.3 + (2.5 + 1.96) * error], abs=0.1 * error)


def test_a_number_that_does_nothing_near_its_value_has_an_end_where_it_does(error):
    fit = fitted_late(0.2 - 0.5 * error)
    assert fit.values["a"] < 0.3 and fit.flat == ("a",) and fit.undetermined == () and np.isinf(fit.errors["a"])
    low, high = fit.interval("a")
    assert low == 0.285 and 0.3 + error < high < 0.3 + 2 * error  # it was half an error below what the law allows
    assert "a changes nothing measured near its fitted value" in str(fit.report()) and "not determined" not in str(fit.report())


# noise ------------------------------------------------------------------------------------------------------------


def coloured(level, rho, n, rng):
    """First-order autoregressive noise."""
    found = rng.normal(size=n)
    for k in range(1, n):
        found[k] = rho * found[k - 1] + np.sqrt(1 - rho**2) * found[k]
    return level * found


@pytest.fixture(scope="module")
def unlike():
    """Two records, the second with three times the noise, coloured, so that neighbouring samples do not show how much it is."""
    rng, records, amplitudes = np.random.default_rng(4), [], [5e-4, 8e-4]
    for amplitude, level, rho in zip(amplitudes, (1e-3, 3e-3), (0.0, 0.9), strict=True):
        clean = ss.virtual_rig(RIG(tilt_deg=1.7, amplitude=amplitude, law="coulomb"), periods=30)["velocity"]
        records.append(ss.Record.of(clean.t, {"v [m/s]": clean.values + coloured(level, rho, len(clean.t), rng)}))
    return ss.identify(records, RIG, free={"mu0": (0.05, 0.5)}, tilt_deg=1.7, amplitude=amplitudes, law="coulomb", starts=8)


def test_each_record_counts_by_the_noise_of_its_own_residuals(unlike):
    counts = [t.count for t in unlike.problem.targets]
    noise = [float(part[0]) for part in unlike.problem.parts(unlike.scale * unlike.problem.sigma)]
    assert noise == pytest.approx([q.rms for q in unlike.quality], rel=0.02)  # of some 1500 values each, less what was fitted
    assert noise[1] / noise[0] == pytest.approx(3.0, rel=0.15)
    assert np.average(np.log(unlike.problem.sizes), weights=counts) == pytest.approx(0.0, abs=1e-12)
    assert noise_sizes(unlike.problem, unlike) == pytest.approx(unlike.problem.sizes, rel=0.01)


def test_sums_of_squares_of_records_with_noise_of_their_own_say_which_law_is_likelier(unlike):
    """n exp(mean of ln s²), with s² of each record and the noise that its target supposes."""
    parts = unlike.problem.parts(unlike.residuals * unlike.problem.sigma / unlike.problem.model.sigma)
    counts = np.array([len(part) for part in parts])
    likely = counts.sum() * np.exp(np.average([np.log(np.mean(part**2)) for part in parts], weights=counts))
    assert unlike.cost - unlike.penalty == pytest.approx(likely, rel=1e-3)


# derivatives ------------------------------------------------------------------------------------------------------


def test_a_sample_beside_a_kink_does_not_determine_what_only_a_ratio_acts_on():
    """Differences by one number at a time carry a kink past the sample by other parts of their steps."""
    robot = RIG(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    record = ss.virtual_rig(robot, noise=1e-3, seed=1)
    fit = ss.identify(record, robot, free={"body_mass": (0.02, 0.2), "inner_mass": (0.002, 0.05)}, starts=4)
    problem, run = fit.problem, steady_curve(fit.model()).run
    kink = next((e.t - run.strobe_times[-2]) / run.period_time for e in run.events if e.t > run.strobe_times[-2])
    for beside in (2e-6, 1e-5, -2e-6):
        place = np.array(fit.point)
        place[2] = kink + beside - problem.targets[0].phase[0] - place[3] * problem.targets[0].course[0]
        assert information_of(problem, problem.jacobian(place)).undetermined[:2].all()


def test_derivatives_that_are_right_stay_as_they_are():
    """Two columns nearly alike: a weak direction, whose derivative along itself says the same."""
    rng = np.random.default_rng(0)
    J = rng.normal(size=(50, 3)) * [1.0, 1e3, 1e-3]
    J[:, 1] = 1e3 * J[:, 0] + 1e-3 * J[:, 1]
    assert sharpened(J, lambda direction: J @ direction, 1e-9) == pytest.approx(J, rel=1e-9)
    assert sharpened(J, lambda direction: None, 1e-9) == pytest.approx(J, rel=1e-12)


def test_a_capsule_that_rests_at_every_strobe_has_its_two_periods_and_settles_slowly():
    """Against 600 periods of `solve`, in which it settles by the rate that is said: its velocity at strobe times is zero each time.

    One body on a spring goes on from where it is, too, and has one period.
    """
    swinging = ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, ss.Coulomb(0.2, 0.3), damping=0.01)
    settled = steady_curve(swinging)
    assert settled.period == 1 and settled.run.strobe_x[-1] == pytest.approx(ss.periodic_orbit(swinging).state[0], rel=3e-8)
    capsule = ss.presets.capsule(omega=1.0794, gap=0.082, force_ratio=0.98, damping_ratio=0.051)
    curve, run = steady_curve(capsule, body=0), ss.solve(capsule, periods=602, keep="trajectory")
    t = np.arange(50) / 50
    late = [run.at((600 + k + t) * run.period_time)["v"] for k in (0, 1)]
    assert curve.period == 2 and min(abs(curve.v(t + k) - late[0]).max() for k in (0, 1)) < 1e-4 < 0.1 * abs(late[1] - late[0]).max()
    far = [abs(run.at((k + t) * run.period_time)["v"] - late[0]).max() for k in (300, 400)]
    assert periods_to_settle(curve) == pytest.approx(100 / np.log10(far[0] / far[1]), rel=0.1)
    # from which of its two periods a run counts makes no other values, and so no other derivatives
    at = np.arange(20 * 50) / 50
    rec = ss.Record.of(at * run.period_time, {"velocity [m/s]": run.at((580 + at) * run.period_time)["v"]}, synthetic=True)
    known = {"omega": 1.0794, "gap": 0.082, "damping_ratio": 0.051}
    problem = problem_of([rec], ss.presets.capsule, {"force_ratio": (0.4, 3.0)}, None, known, FitSettings(sensor={}, harmonics=0))
    place = problem.aligned(np.array([(0.98 - 0.4) / 2.6]))
    begun = problem.model._warm[0]
    for start in (begun, later_by_one(capsule, begun)):
        problem.model._warm[0] = start
        problem.model._curves.clear()
        problem._memory.clear()
        rest = float(np.std(problem.residuals(place) * problem.sigma))
        assert rest < 0.02 * np.std(problem.y), (rest, np.std(problem.y))


def later_by_one(model, start):
    """The strobe point a drive period later, as a start."""
    run = ss.solve(model, periods=1, keep="trajectory", start=start)
    return coordinates(model).start(strobe_states(run)[-1])
