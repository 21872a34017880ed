"""Measured micro-sliding loops: which law, with which numbers, and how sure. Force over position, R² of friction over normal force."""

import dataclasses

import numpy as np
import pytest

import stickslip as ss
from measured import CYLINDER, CYLINDER_COLUMNS, LOOPS, needs_data, path

pytestmark = needs_data
BOTH = {"mu_plus": (0.3, 0.8), "mu_minus": (0.3, 0.8)}
STIFF = {"sigma0": (2e3, 5e4, "log")}
STRIBECK = {"rise": (0.0, 0.5), "v_s": (1e-5, 1e-3, "log")}


def loops(start, end):
    """Friction over normal force as a force under a load of 1 N, so that stiffness is per normal force [1/m]."""
    rec = ss.read(path(LOOPS)).between(start, end)
    mu = rec.derived("mu [N]", rec["force"].si / rec["load"].si, like="Friction", role="force")["mu"]
    return ss.Record({"Position": rec["Position"], "mu": dataclasses.replace(mu, role="force")})


def lugre(mu_plus, mu_minus, rise, sigma0, v_s):
    return ss.LuGre(mu_plus, mu_minus, mu_plus * (1 + rise), mu_minus * (1 + rise), sigma0, 0.0, 0.0, v_s)


def elasto_plastic(mu_plus, mu_minus, rise, sigma0, v_s, elastic):
    f = mu_plus * (1 + rise), mu_minus * (1 + rise)
    z = elastic * mu_plus / sigma0, elastic * mu_minus / sigma0
    return ss.friction.ElastoPlastic(mu_plus, mu_minus, *f, sigma0, 0.0, 0.0, v_s, z_ba=z[0], z_ba_minus=z[1])


def gms(mu_plus, mu_minus, sigma0, w1, w2, w3, k1, k2, k3):
    """Four elements; shares are given relative to those of the last."""
    w, k = np.array([w1, w2, w3, 1.0]), np.array([k1, k2, k3, 1.0])
    shares = {"stiffness": tuple((k / k.sum()).tolist()), "weights": tuple((w / w.sum()).tolist())}
    return ss.friction.GMS(mu_plus, mu_minus, None, None, sigma0=sigma0, v_s=1e-4, attraction=100.0, **shares)


LAWS = {
    "Coulomb": (ss.Coulomb, BOTH),
    "Dahl": (ss.Dahl, {**BOTH, **STIFF, "exponent": (0.05, 2.0)}),
    "LuGre": (lugre, {**BOTH, **STIFF, **STRIBECK}),
    "elasto-plastic": (elasto_plastic, {**BOTH, **STIFF, **STRIBECK, "elastic": (0.0, 0.95)}),
    "GMS": (gms, {**BOTH, **STIFF, **{f"{a}{i}": (0.05, 20.0, "log") for a in "wk" for i in (1, 2, 3)}}),
}


def fitted(name, record, **more):
    make, free = LAWS[name]
    return ss.identify(record, make, free=free, load=1.0, **more)


def test_dahl_reaches_what_was_published_on_three_loops():
    """Published for all loops: stiffness 7980 1/m, mu 0.498 and 0.453, exponent 0.12, R² 0.9971. The loops differ by 2 % among them."""
    fit = fitted("Dahl", loops(20, 32), starts=32)
    assert fit.quality[0].r2 > 0.997
    assert fit.values["mu_plus"] == pytest.approx(0.498, rel=0.03) and fit.values["mu_minus"] == pytest.approx(0.453, rel=0.03)
    assert fit.values["sigma0"] == pytest.approx(7980, rel=0.03) and 0.05 < fit.values["exponent"] < 0.2
    assert any("the law or the drive" in w for w in fit.warnings)  # what is left has a shape


@pytest.mark.slow
def test_a_law_with_a_rounded_top_beats_dahl_on_ten_loops_and_on_held_out_ones():
    train, test = loops(20, 60), loops(60, 100)
    fits = {name: fitted(name, train) for name in LAWS}
    r2 = {name: fit.quality[0].r2 for name, fit in fits.items()}
    outside = {name: ss.identification.prediction_errors(fit, test, load=1.0) for name, fit in fits.items()}
    found = ss.identification.rank(fits, held_out=outside)
    print(r2, outside, found, *(fit.report() for fit in fits.values()), sep="\n")
    assert r2["Dahl"] >= 0.997 and r2["Coulomb"] < 0.7
    assert max(r2["elasto-plastic"], r2["GMS"]) > r2["Dahl"] > r2["LuGre"]
    assert found.best.label in ("elasto-plastic", "GMS")


@pytest.mark.slow
@pytest.mark.parametrize("which", CYLINDER)
def test_friction_of_the_cylinder_is_the_published_one_without_a_mask(which):
    """Published from the middle of the strokes: half the loop is 7.17 and 12.39 N. Over whole strokes, ends included, it is up to 7 % less.

    The zero of the cell is 53 and 369 N, which is the pressure on the piston.
    """
    name, half = CYLINDER[which]
    read = ss.read(path(name), columns=CYLINDER_COLUMNS)
    record = ss.Record({"laser": read["laser"], "force": read.channels["force"]})
    free = {"mu_plus": (0.1, 60.0), "mu_minus": (0.1, 60.0), "sigma0": (1e2, 1e6, "log")}
    fit = ss.identify(record, ss.Dahl, free=free, load=1.0, exponent=1.0)
    assert 0.93 * half < 0.5 * (fit.values["mu_plus"] + fit.values["mu_minus"]) < 1.02 * half
    assert fit.quality[0].r2 > 0.97 and any("cannot be distinguished from defects of the law" in note for note in fit.notes)


@pytest.mark.slow
@pytest.mark.parametrize("which", CYLINDER)
def test_a_law_without_bristles_tells_the_sum_of_the_cylinders_frictions_and_no_gain_makes_up_for_it(which):
    """The gain, known to 2 %, came out as 0.73 and the friction as 8.96 N; the sum was told as a product of powers.

    Half the sum is below what is published from the middle of the strokes: at their ends the force only rises to it.
    """
    name, half = CYLINDER[which]
    read = ss.read(path(name), columns=CYLINDER_COLUMNS)
    record = ss.Record({"laser": read["laser"], "force": read.channels["force"]})
    fit = ss.identify(record, ss.Coulomb, free={"mu_plus": (0.1, 60.0), "mu_minus": (0.1, 60.0)}, load=1.0, starts=16)
    ((formula, value, _),) = fit.combinations
    assert formula == "mu_plus + mu_minus" and fit.determined[0].holds
    assert 0.85 * half < value / 2 < 1.02 * half
    gain, given_up = fit.sensor["gain"][0], any("cannot be distinguished from defects of the law" in note for note in fit.notes)
    assert gain == 1.0 if given_up else abs(gain - 1.0) < 0.002  # a tenth of what is known of it beforehand


def test_one_coefficient_of_a_fit_is_that_of_both_directions():
    """As many numbers as are free, each in newtons where no load is known."""
    t = np.linspace(0.0, 4.0, 1200)
    F = 2.0 * np.sign(np.cos(np.pi * t)) + np.random.default_rng(3).normal(0, 0.05, len(t))
    rec = ss.Record.of(t, {"x [m]": 1e-3 * np.sin(np.pi * t), "F [N]": F}, roles={"F": "force"})
    both = ss.identify(rec, ss.Coulomb, free={"mu": (0.1, 10.0)}, load=1.0, sensor={}, starts=2)
    forwards = ss.identify(rec, ss.Coulomb(0.3), free={"mu": (0.1, 10.0)}, load=1.0, sensor={}, starts=2)
    assert both.values == forwards.values and both.model() == ss.Coulomb(both.values["mu"])
    low, high = both.interval("mu")
    assert low < 2.0 < high and "mu = 2.0" in both.report() and " N   95 %" in both.report() and "mu_minus" not in forwards.report()
