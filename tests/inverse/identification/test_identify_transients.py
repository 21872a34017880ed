"""Records that do not begin with steady motion; and the bootstrap."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.inverse.identification.bootstrapping import _resampled_problem, bootstrap
from stickslip.inverse.identification.search import polished
from stickslip.records.settling import settled, settling_periods

rig = ss.presets.piezo_rig
ARGUMENTS = dict(tilt_deg=1.7, amplitude=1.2e-3)


def from_rest(law="coulomb", phase=0.0, **more):
    """A robot with little friction (0.06) that starts from rest and takes about ten drive periods to settle."""
    return ss.virtual_rig(rig(mu0=0.06, law=law, **ARGUMENTS), noise=1e-4, seed=1, settle=0, phase=phase, **more)


@pytest.mark.parametrize(("law", "phase"), [("coulomb", 0.0), ("coulomb", 0.3), ("lugre", 0.0)])
def test_a_start_from_rest_is_fitted_too(law, phase):
    rec = from_rest(law, phase, periods=8)
    fit = ss.identify(rec, rig, free={"mu0": (0.03, 0.15)}, transient=True, law=law, **ARGUMENTS)
    low, high = fit.interval("mu0", level=0.9999)
    assert low < 0.06 < high and high - low < 0.002
    assert fit.quality[0].rms == pytest.approx(1e-4, rel=0.1) and not fit.quality[0].suspicious  # 800 samples know it to 2.5 %


def test_a_start_taken_as_steady_is_wrong_and_the_default_leaves_it_out_and_says_so():
    rec = from_rest(periods=40)
    fits = {s: ss.identify(rec, rig, free={"mu0": (0.03, 0.15)}, settle=s, law="coulomb", sensor={}, **ARGUMENTS) for s in (0, "auto", 25)}
    off = {s: abs(fit.values["mu0"] - 0.06) / fits["auto"].errors["mu0"] for s, fit in fits.items()}
    assert off[0] > 4.5 and off["auto"] < 4.5 and off[25] < 4.5
    assert any("drive periods differ from the later ones" in note and "transient=True" in note for note in fits["auto"].notes)
    assert any("first 25 drive periods were to be left out" in note for note in fits[25].notes)
    assert not any("drive periods" in note for note in fits[0].notes)


def test_a_steady_record_is_left_whole():
    rec = ss.virtual_rig(rig(law="coulomb", **ARGUMENTS), noise=1e-3, seed=2)
    assert settling_periods(rec, 32.7) == 0 and settling_periods(from_rest(periods=40), 32.7) > 3
    with pytest.raises(InputError, match="settle=10"):
        ss.compare(rec, rig(law="coulomb", **ARGUMENTS), laws=["coulomb"], settle="some")


def test_compare_leaves_a_start_out_and_says_so():
    robot = rig(mu0=0.06, law="coulomb", **ARGUMENTS)
    found = ss.compare(from_rest(periods=40), robot, laws=["coulomb"])
    assert found["Coulomb"].rms == pytest.approx(1e-4, rel=0.1) and any("differ from the later ones" in note for note in found.notes)
    assert ss.compare(from_rest(periods=40), robot, laws=["coulomb"], settle=0)["Coulomb"].rms > 5e-4


# bootstrap --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fit():
    truth = rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    free = {"friction.mu_plus": (0.1, 0.3), "friction.mu_minus": (0.1, 0.3)}
    return ss.identify(ss.virtual_rig(truth, noise=1e-3, seed=3), truth, free=free)


def test_the_bootstrap_is_the_same_for_any_number_of_workers(fit):
    one, three = (bootstrap(fit, 12, seed=5, workers=w) for w in (1, 3))
    assert np.array_equal(one, three) and not np.array_equal(one, bootstrap(fit, 12, seed=6))
    assert np.array_equal(bootstrap(fit, 6, seed=5), one[:6])  # and a replicate does not depend on how many there are


def test_common_steps_end_where_each_replicates_own_search_ends(fit):
    """To a third of what one standard error costs in the sum of squares: their derivatives are those at the fit."""
    table = bootstrap(fit, 3, seed=1)
    for r in range(3):
        problem = _resampled_problem(fit, np.random.default_rng([1, r]))
        own = polished(problem, fit.point)
        held = problem.only(dict(zip(fit.names, table[r].tolist(), strict=True)))  # phase and frequency are free in both
        common = polished(held, fit.point[len(fit.names) :])
        assert common.cost < own.cost + 0.33 * fit.scale**2


def test_the_spread_of_the_bootstrap_is_the_standard_error(fit):
    spread, errors = bootstrap(fit, 60, seed=2).std(axis=0, ddof=1), np.array(list(fit.errors.values()))
    assert spread == pytest.approx(errors, rel=0.35)  # 60 replicates know a spread to 9 %; the covariance is a parabola's


def test_the_bootstrap_of_a_force_is_one_batch():
    t = np.linspace(0, 3, 600)
    x = 2e-4 * np.sin(2 * np.pi * t)
    F = 3.0 * np.sign(np.gradient(x, t)) + np.random.default_rng(0).normal(scale=0.1, size=len(t))
    rec = ss.Record.of(t, {"x [m]": x, "F [N]": F}, roles={"F": "force"})
    fit = ss.identify(rec, ss.Coulomb, free={"mu_plus": (0.1, 1.0), "mu_minus": (0.1, 1.0)}, load=10.0, sensor={})
    before = fit.problem.solves
    spread = bootstrap(fit, 200, seed=0).std(axis=0, ddof=1)
    assert spread == pytest.approx(list(fit.errors.values()), rel=0.25) and fit.problem.solves == before
    low, high = fit.interval("mu_plus", method="bootstrap", repeats=50, workers=2)
    assert low < 0.3 < high


@each_row("missing", [slice(500, 1700), slice(700, 1900)])
def test_missing_samples_are_no_transient(missing):
    whole = ss.virtual_rig(rig(law="coulomb", tilt_deg=1.7, amplitude=5e-4), noise=1e-4, seed=1)
    v = whole["velocity"].values.copy()
    v[missing] = np.nan
    rec = ss.Record.of(whole["velocity"].t, {"v [m/s]": v})
    assert settled(rec)[1:] == (0, None)
