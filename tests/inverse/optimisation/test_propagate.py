"""`ss.optimisation.propagate`: bands, Sobol indices and swings against closed forms, from distributions and from fits."""

import math

import numpy as np
import pytest
from scipy.stats import sobol_indices

import stickslip as ss
from rows import each_row
from stickslip.inverse.optimisation.propagation import _designed, _estimated, _indices

G, MU, U, L = 9.81, 0.1315, 0.1, 0.01
ROBOT = ss.Robot(1.0 - MU, MU, ss.drives.TwoPhase(stroke=L, u1=U, u2=U), ss.Coulomb(0.15, 0.25))
UP, DOWN = (0.13, 0.17), (0.22, 0.28)
SPREAD = {"friction.mu_plus": ("uniform", *UP), "friction.mu_minus": ("uniform", *DOWN)}


def speed(up, down):
    """Both phases end at rest: V = J^2 (1/mu_plus - 1/mu_minus) / (2 g T)."""
    return (2 * MU * U) ** 2 * (1 / up - 1 / down) / (2 * G * 2 * L / U)


def moments(a, b):
    """Mean and variance of 1/x for x uniform from a to b."""
    mean = math.log(b / a) / (b - a)
    return mean, 1 / (a * b) - mean**2


@pytest.fixture(scope="module")
def found():
    return ss.optimisation.propagate(ROBOT, SPREAD, samples=512, seed=3, indices=True)


def test_indices_of_a_sum_are_those_of_the_closed_form(found):
    variance = [moments(*ends)[1] for ends in (UP, DOWN)]
    for name, part in zip(SPREAD, np.array(variance) / sum(variance), strict=True):
        # 1/mu_plus and 1/mu_minus do not act together, so that both indices are the part; 1024 points of a Sobol sequence err by
        # less than 1/sqrt(1024) = 0.03, the error of as many random ones
        assert found.indices.first[name] == pytest.approx(part, abs=0.03)
        assert found.indices.total[name] == pytest.approx(part, abs=0.03)
        low, high = found.indices.total_interval[name]
        assert low < found.indices.total[name] < high


def test_indices_are_told_with_their_intervals(found):
    """In words, in the table of a notebook, and beside the bars of a tornado."""
    text, page, side = repr(found.indices), found.indices._repr_html_(), found._repr_html_()
    labels = ss.plot.tornado(found).child_axes[0].get_yticklabels()
    for name in SPREAD:
        for value, ends in ((found.indices.first, found.indices.first_interval), (found.indices.total, found.indices.total_interval)):
            low, high = ends[name]
            span = f"{low:z.2f} to {high:z.2f}"
            assert low < value[name] < high and span in text and span in page and span in side
            assert any(f"{value[name]:.2f}({50 * (high - low):.0f})" in label.get_text() for label in labels)


def test_intervals_of_indices_hold_the_true_ones():
    """Sobol's g-function of three numbers, whose indices are known: 95 % intervals of 60 samples hold them as often, or more often."""
    a = np.array([0.0, 1.0, 9.0])
    parts = 1 / (3 * (1 + a) ** 2)
    variance = np.prod(1 + parts) - 1
    first, total = parts / variance, parts * np.prod(1 + parts) / (1 + parts) / variance
    held = []
    for seed in range(60):
        u = _designed(3, 256, seed, indices=True)
        g = np.prod((abs(4 * u - 2) + a[:, None, None]) / (1 + a[:, None, None]), axis=0)
        indices, _ = _indices(("a", "b", "c"), g, seed)
        for true, ends in ((first, indices.first_interval), (total, indices.total_interval)):
            held += [low <= t <= high for t, (low, high) in zip(true, ends.values(), strict=True)]
    assert np.mean(held) > 0.93


def test_indices_are_those_of_scipy():
    rng = np.random.default_rng(0)
    values = 5.0 + rng.normal(size=(5, 256))
    first, total = _estimated(values)
    shifted = values - values[:2].mean()
    told = sobol_indices(func={"f_A": shifted[:1], "f_B": shifted[1:2], "f_AB": shifted[2:][:, None]}, n=256)
    assert first == pytest.approx(np.ravel(told.first_order), rel=1e-9)
    assert total == pytest.approx(np.ravel(told.total_order), rel=1e-9)


def test_bands_and_swings_are_those_of_the_closed_form(found):
    means, variances = zip(*(moments(*ends) for ends in (UP, DOWN)), strict=True)
    scale = speed(1.0, np.inf)
    assert len(found.values) == 1024
    assert found.values == pytest.approx(speed(*found.inputs.values()), rel=1e-8)
    assert found.mean == pytest.approx(scale * (means[0] - means[1]), rel=2e-3)
    assert found.std == pytest.approx(scale * math.sqrt(sum(variances)), rel=2e-2)
    assert found.nominal == pytest.approx(speed(0.15, 0.25), rel=1e-8)
    ends = [[a + (b - a) * u for u in (0.05, 0.95)] for a, b in (UP, DOWN)]
    assert found.swings["friction.mu_plus"] == pytest.approx([speed(up, 0.25) for up in ends[0]], rel=1e-8)
    assert found.swings["friction.mu_minus"] == pytest.approx([speed(0.15, down) for down in ends[1]], rel=1e-8)


def test_a_tolerance_in_per_cent_is_a_normal_distribution():
    told, short = (
        ss.optimisation.propagate(ROBOT, {"friction.mu_plus": said}, samples=16) for said in (("normal", 0.15, 0.0015), (0.15, "1%"))
    )
    assert np.array_equal(told.values, short.values)
    assert told.notes == ()
    assert told.indices is None


def test_where_nothing_moves_there_are_no_indices():
    still = ROBOT.replace({"friction.mu_plus": 0.9, "friction.mu_minus": 0.9, "drive": ss.Harmonic(amplitude=1e-5, omega=10.0)})
    found = ss.optimisation.propagate(still, {"friction.mu_plus": (0.9, "1%")}, samples=16, indices=True)
    assert found.indices is None
    assert "all values are the same" in found.notes[0]


@pytest.fixture(scope="module")
def fit():
    asked = dict(tilt_deg=1.7, amplitude=[5e-4, 8e-4], law="coulomb")
    return ss.identify([0.00161, 0.00431], ss.presets.piezo_rig, free={"mu0": (0.05, 0.5)}, noise=5e-5, **asked)


def test_a_fit_is_propagated_by_its_covariance(fit):
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb", mu0=fit.values["mu0"])
    found = ss.optimisation.propagate(robot, uncertain=fit, samples=256, indices=True)
    mu0, h = fit.values["mu0"], 1e-5
    V = [ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb", mu0=mu0 + s)).mean_velocity for s in (-h, h)]
    slope = (V[1] - V[0]) / (2 * h)
    # linear propagation of errors; V is curved by a few per cent over the standard error, 0.0017 of 0.18
    assert found.std == pytest.approx(abs(slope) * fit.errors["mu0"], rel=0.05)
    assert np.std(found.inputs["mu0"]) == pytest.approx(fit.errors["mu0"], rel=0.02)
    assert found.nominal == pytest.approx(found.quantile(0.5), rel=1e-3)
    assert found.indices.total["mu0"] == pytest.approx(1.0, abs=0.05)


def test_what_a_machine_does_not_have_is_told(fit):
    with pytest.raises(ss.InputError, match="does not have"):
        ss.optimisation.propagate(ROBOT.replace(friction=ss.Viscous.example()), uncertain=fit)
    with pytest.raises(ss.InputError, match="of = 'impulse_max'; allowed is a number of a run"):
        ss.optimisation.propagate(ROBOT, uncertain=fit, of="impulse_max")


def test_what_a_fit_does_not_know_is_told():
    asked = dict(tilt_deg=1.7, amplitude=[8e-4], law="coulomb")
    lost = ss.identify([0.00431], ss.presets.piezo_rig, free={"mu0": (0.05, 0.5), "body_mass": (0.05, 0.07)}, **asked)
    assert lost.undetermined
    with pytest.raises(ss.InputError, match="do not determine"):
        ss.optimisation.propagate(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), uncertain=lost)


def test_correlated_parameters_have_no_indices():
    asked = dict(tilt_deg=1.7, amplitude=[5e-4, 6e-4, 8e-4], law="coulomb")
    free = {"mu0": (0.05, 0.5), "body_mass": (0.05, 0.08)}
    true = ss.solve(ss.presets.piezo_rig(**asked, mu0=0.18, body_mass=0.065), periods=60, settle=30, keep="summary").mean_velocity
    both = ss.identify([round(float(v), 5) for v in true], ss.presets.piezo_rig, free=free, noise=5e-6, **asked)
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    found = ss.optimisation.propagate(robot, uncertain=both, samples=256)
    # the sample has the fit's covariance; 256 Sobol points err by less than 1/sqrt(256)
    drawn = np.corrcoef([found.inputs[name] for name in both.names])[0, 1]
    assert drawn == pytest.approx(both.correlations[0, 1], abs=0.06)
    with pytest.raises(ss.InputError, match="depend on one another"):
        ss.optimisation.propagate(robot, uncertain=both, indices=True)


def test_a_tornado_has_the_longest_bar_on_top(found):
    ax = ss.plot.tornado(found)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["friction.mu_minus", "friction.mu_plus"]
    assert ax.get_xlabel().endswith("(µm/s)")
    width = abs(np.subtract(*found.swings["friction.mu_plus"])) * 1e6
    bars = [bar for bar in ax.patches if abs(bar.get_y() + 0.5 * bar.get_height() - 1.0) < 0.1 and bar.get_height() < 0.7]
    assert sum(abs(bar.get_width()) for bar in bars) == pytest.approx(width, rel=1e-6)


@each_row("said", [("uniform", 0.2, 0.1), (0.15, "1"), ("normal", 0.15, 0.0), "wide", (0.0, "1%")])
def test_bad_distributions_say_what_to_type(said):
    with pytest.raises(ss.InputError, match=r"friction.mu_plus.*type for example"):
        ss.optimisation.propagate(ROBOT, {"friction.mu_plus": said})
