"""What data do not determine has no error bar: singular directions have infinite variance, whoever asks for it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.signal import lfilter

import stickslip as ss
from rows import each_row
from stickslip.basics.information import Information
from stickslip.inverse.identification.bootstrapping import bootstrap
from stickslip.records.channel import Channel
from stickslip.show.cli import main

MASSES = {"body_mass": (0.02, 0.2), "inner_mass": (0.002, 0.05)}


@pytest.fixture(scope="module")
def rig():
    return ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")


@pytest.fixture(scope="module")
def record(rig):
    return ss.virtual_rig(rig, noise=1e-3, seed=1)


@pytest.fixture(scope="module")
def fit(rig, record):
    """Only m/(M + m) enters the motion under Coulomb friction."""
    return ss.identify(record, rig, free=MASSES, starts=4)


# the information --------------------------------------------------------------------------------------------------


@each_row("seed", range(10))
def test_a_singular_direction_has_infinite_variance_and_the_others_their_own(seed):
    """Columns 0, 1 and 2 move along two combinations only, column 3 is nothing; column 4 is as if the three were two."""
    rng = np.random.default_rng(seed)
    two, own, size = rng.normal(size=(40, 2)), rng.normal(size=(40, 1)), 10 ** rng.uniform(-6, 6, 5)
    mixed = two @ rng.normal(size=(2, 3))
    found = Information(np.concatenate([mixed, np.zeros((40, 1)), own], axis=1) * size)
    reduced = np.concatenate([two, own * size[4]], axis=1)
    assert found.undetermined.tolist() == [True, True, True, True, False]
    assert np.isinf(np.diag(found.covariance())[:4]).all() and np.isnan(found.covariance()[0, 1:]).all()
    assert found.errors(2.0)[4] == pytest.approx(2.0 * np.sqrt(np.linalg.inv(reduced.T @ reduced)[2, 2]), rel=1e-9)
    ((three, directions), (nothing, _)) = found.groups
    assert (three, nothing, len(directions)) == ([0, 1, 2], [3], 1)
    assert (mixed * size[:3]) @ directions[0] == pytest.approx(0, abs=1e-9 * np.linalg.norm(mixed * size[:3] * directions[0]))


def test_information_that_is_only_poor_is_not_called_none():
    """Two columns that differ by 1e-4: a large error, and the textbook's."""
    x, y = np.random.default_rng(1).normal(size=(2, 100))
    J = np.stack([x, x + 1e-4 * y], axis=1)
    found = Information(J)
    assert not found.undetermined.any()
    assert found.covariance() == pytest.approx(np.linalg.inv(J.T @ J), rel=1e-6)


def test_no_noise_does_not_make_what_is_not_there_certain():
    assert Information(np.ones((3, 2))).errors(0.0).tolist() == [np.inf, np.inf]


# fits -------------------------------------------------------------------------------------------------------------


def test_masses_of_which_only_the_ratio_moves_anything_are_not_determined(fit):
    assert fit.undetermined == ("body_mass", "inner_mass")
    assert all(np.isinf(error) for error in fit.errors.values()) and np.isnan(fit.correlations[0, 1])
    (said,) = (w for w in fit.warnings if "not determined" in w)
    assert said.startswith("body_mass and inner_mass are not determined: nothing measured changes while")
    assert said.endswith("body_mass changes by +1 %, inner_mass changes by +1 %; fix one of them")
    ratio = fit.values["inner_mass"] / (fit.values["inner_mass"] + fit.values["body_mass"])
    assert ratio == pytest.approx(9.48 / 72.07, rel=1e-2)


@each_row(("method", "options"), [("covariance", {}), ("bootstrap", {"repeats": 4})])
def test_intervals_of_what_is_not_determined_are_open(fit, method, options):
    """They end where the search did."""
    assert fit.interval("body_mass", method=method, **options) == MASSES["body_mass"]


def test_the_bootstrap_has_no_values_of_what_is_not_determined(fit):
    assert np.isnan(bootstrap(fit, 3, seed=1)).all()


def test_one_number_beside_two_that_are_not_determined_has_its_own_error(rig, record):
    """As if one of the two were known."""
    free = {**MASSES, "friction.mu_plus": (0.05, 0.5)}
    three = ss.identify(record, rig, free=free, starts=4)
    known = {"inner_mass": MASSES["inner_mass"], "friction.mu_plus": (0.05, 0.5)}
    two = ss.identify(record, rig.replace(body_mass=three.values["body_mass"]), free=known, starts=4)
    assert three.undetermined == ("body_mass", "inner_mass") and two.undetermined == ()
    assert three.errors["friction.mu_plus"] == pytest.approx(two.errors["friction.mu_plus"], rel=1e-2)


def test_two_factors_of_a_law_whose_product_acts_are_not_determined_by_forces():
    def law(gain, mu):
        return ss.Coulomb(gain * mu, 1.2 * gain * mu)

    t = np.linspace(0, 1, 400)
    velocity = 0.1 * np.cos(2 * np.pi * t)
    force = np.array([law(1.0, 0.2).sliding(v, 5.0) for v in velocity]) + np.random.default_rng(1).normal(0, 1e-3, len(t))
    record = ss.Record.of(t, {"v [m/s]": velocity, "force [N]": force})
    found = ss.identify(record, law, free={"gain": (0.5, 2.0), "mu": (0.1, 0.4)}, using="force", load=5.0, starts=4)
    assert found.undetermined == ("gain", "mu") and "gain changes by" in found.report()


# what is shown ----------------------------------------------------------------------------------------------------


def test_reports_say_not_determined_and_never_inf_or_nan(fit, tmp_path):
    page = fit.report(tmp_path / "fit.html").read_text(encoding="utf-8")
    for text in (fit.report(), repr(fit), page):
        assert "not determined" in text
    words = (
        " ".join([fit.report(), repr(fit), *(cell for cell in page.split("<td") if "</td>" in cell)])
        .replace("<", " ")
        .replace(">", " ")
        .split()
    )
    assert not {"inf", "nan", "±inf", "±nan"} & set(words)


def test_the_command_says_not_determined(record, tmp_path, capsys):
    path, study = tmp_path / "rig.csv", tmp_path / "robot.toml"
    record.save(path)
    study.write_text(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb").to_toml(), encoding="utf-8")
    words = ["identify", str(study), "--record", str(path), "--free", "body_mass=0.02..0.2", "--free", "inner_mass=0.002..0.05"]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["errors"]["body_mass"] == told["intervals"]["inner_mass"] == "not determined"
    assert told["correlations"] == [[1.0, None], [None, 1.0]]
    assert main([*words, "--level", "0.9"]) == 0
    assert "inner_mass: not determined" in capsys.readouterr().out


# modes ------------------------------------------------------------------------------------------------------------


@each_row(("lines", "known"), [(3, False), (4, False), (25, True)])
def test_a_peak_of_few_lines_determines_no_mode(lines, known):
    """A mode and what lies beside it are eight numbers: four complex lines are met by many, and leave nothing to tell the noise."""
    f, rng = np.linspace(9.5, 10.5, lines), np.random.default_rng(1)
    response = 1 / (100.0 - f**2 + 2j * 0.01 * 10.0 * f) + 1e-3 * (rng.normal(size=lines) + 1j * rng.normal(size=lines))
    (mode,) = ss.Record({"H": Channel("H", response, None, f, "frequency", "Hz", None)}, (), {}).modes()
    assert np.isfinite([mode.frequency_error, mode.damping_error]).tolist() == [known, known]
    assert not known or abs(mode.frequency - 10.0) < 4 * mode.frequency_error < 0.04


def test_the_flank_of_a_mode_is_not_another_one():
    f, rng, truth = np.arange(0, 500, 0.3125), np.random.default_rng(0), ((1e6, 212.1, 9e-4), (2e4, 60.0, 5e-3))
    response = sum(a / (fn**2 - f**2 + 2j * z * fn * f) for a, fn, z in truth)
    response = response + rng.normal(0, 0.02, (2, len(f))).T @ (1, 1j)
    found = ss.Record({"H": Channel("H", response, None, f, "frequency", "Hz", None)}, (), {}).modes(count=2)
    for mode, (_, frequency, damping) in zip(found, truth, strict=True):
        assert mode.frequency == pytest.approx(frequency, rel=1e-5) and mode.damping == pytest.approx(damping, rel=1e-3)


def test_what_is_flat_from_bound_to_bound_is_not_determined_where_its_best_place_lies_on_an_edge():
    """A body that never rests says nothing of static friction; where there is so much that it would rest, the curvature is large."""
    rig, fixed = ss.presets.piezo_rig, {"tilt_deg": 1.7, "amplitude": 3e-3, "law": "coulomb-static"}
    rec = ss.virtual_rig(rig(**fixed, f0=0.25), noise=1e-4, seed=1)
    fit = ss.identify(rec, rig, free={"mu0": (0.1, 0.3), "f0": (0.2, 0.5)}, starts=4, harmonics=0, **fixed)
    assert fit.undetermined == ("f0",) and "f0  not determined" in fit.report() and fit.interval("f0")[0] == 0.2
    low, high = fit.interval("mu0")
    assert 0.179 < low < high < 0.182


def test_a_number_is_as_open_as_it_would_be_beside_any_value_of_another_that_may_have_every_value():
    """Coulomb's force, fitted as Stribeck's, under coloured noise: the velocity at which a small dip ends may be below all measured ones.

    Static friction is anything then; it had an interval of 1e-3 of itself, which is right where that velocity is as fitted.
    """
    t, noise = np.arange(0, 4, 2e-3) + 1e-3, np.random.default_rng(2).normal(0, 1, 2000)
    x, v = 3.8e-3 * np.sin(np.pi * t), 3.8e-3 * np.pi * np.cos(np.pi * t)
    force = 10 * np.sign(v) + lfilter([0.02], [1, -0.9], noise)
    rec = ss.Record.of(t, {"x [m]": x, "F [N]": force}, roles={"x": "position", "F": "force"})
    free, tied = {"mu_plus": (0.05, 0.6), "f_plus": (0.05, 0.8), "v_s": (2e-5, 1e-2, "log")}, {"mu_minus": "mu_plus", "f_minus": "f_plus"}
    fit = ss.identify(rec, ss.Stribeck, free=free, tied=tied, load=40.0, starts=4, sensor={})
    assert fit.undetermined == ("v_s",) and "f_plus" in fit.bent and np.min(abs(v)) > 1.5 * 2e-5
    low, high = fit.interval("f_plus")
    assert 0.2495 < low < fit.values["f_plus"] < 0.252 and high > 0.29
    assert abs(fit.values["mu_plus"] - 0.25) < 3 * fit.errors["mu_plus"] < 1e-3
