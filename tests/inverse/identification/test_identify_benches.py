"""Joints on a bench: logs of torque, current and angle as one fit of all that turns; weights, outliers and many speeds beside it.

Truth is a motion that is written down, and the torque of the textbook's equation for it, so that no solver of ours is in between.
"""

from __future__ import annotations

import sys

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics import interruption
from stickslip.inverse.identification import sampling
from stickslip.inverse.identification.clocks import clock_of

INERTIA, GRAVITY, RATIO, CONSTANT, GAIN = 0.012, 0.3, 10.0, 0.06, 0.8
LAW = {"mu_plus": 0.03, "mu_minus": 0.036, "viscous": 0.01}
START = ss.Joint(
    inertia=0.02, friction=ss.CoulombViscous(0.05, 0.05, viscous=0.02), torque=0.0, gravity_torque=GRAVITY, gear_ratio=RATIO, load_gain=1.0
)
FREE = {
    "inertia": (1e-3, 0.1), "friction.mu_plus": (0.0, 0.2), "friction.mu_minus": (0.0, 0.2), "friction.viscous": (0.0, 0.1),
    "load_gain": (0.0, 5.0),
}  # fmt: skip
TRUTH = {"inertia": INERTIA, "load_gain": GAIN, **{f"friction.{name}": value for name, value in LAW.items()}}


def motion(t):
    """Angle, velocity and acceleration: two sines that no multiple of one another repeats."""
    parts = ((1.1, 2.0, 0.3), (0.35, 5.3, 1.0))
    return (
        sum(a * np.sin(w * t + p) for a, w, p in parts), sum(a * w * np.cos(w * t + p) for a, w, p in parts),
        -sum(a * w * w * np.sin(w * t + p) for a, w, p in parts),
    )  # fmt: skip


def torque(t):
    """J a + G sin q + R (1 + gain |G sin q|), at the motor."""
    q, v, a = motion(t)
    own = np.where(v > 0, LAW["mu_plus"], -LAW["mu_minus"]) * (1 + GAIN * abs(GRAVITY * np.sin(q))) + LAW["viscous"] * v
    return (INERTIA * a + GRAVITY * np.sin(q) + own) / RATIO


def log(end=10.0, step=0.004, noise=2e-4, seed=1, angle=lambda q: q, unit="N m", factor=1.0):
    t = np.arange(0.0, end, step)
    measured = factor * torque(t) + factor * noise * np.random.default_rng(seed).normal(size=len(t))
    return ss.Record.of(
        t, {"angle [rad]": angle(motion(t)[0]), f"drive [{unit}]": measured}, roles={"drive": "current" if unit == "A" else "force"}
    )


def within(fit, truth, errors=4.5):
    """All numbers within so many standard errors: 4.5 are left by chance in one of 1e5."""
    return {
        name: (fit.values[name] - value) / fit.errors[name]
        for name, value in truth.items()
        if not abs(fit.values[name] - value) < errors * fit.errors[name]
    }


def test_a_torque_log_gives_inertia_load_dependent_friction_and_damping_together():
    fit = ss.identify(log(), START, free={**FREE, "gravity_torque": (0.1, 1.0)}, sensor={}, starts=8)
    assert within(fit, {**TRUTH, "gravity_torque": GRAVITY}) == {} and fit.undetermined == ()
    assert fit.errors["inertia"] < 0.01 * INERTIA and fit.quality[0].r2 > 0.999
    assert "N m" in fit.report() and not fit.quality[0].suspicious
    assert "about reversals are left out" in fit.report()


def test_a_current_tells_all_but_one_factor_and_following_the_advice_gives_all():
    """Current times constant: everything may be larger together. With the gravity torque known nothing is left open."""
    rec = log(unit="A", factor=1 / CONSTANT)
    start = START.replace(motor_constant=0.1)
    free = {**FREE, "motor_constant": (0.01, 0.5), "gravity_torque": (0.1, 1.0)}
    del free["load_gain"]
    known = start.replace(load_gain=GAIN / 1.0)
    # the load's gain times the gravity torque is a pure number: hold it instead of the gain
    tied = {"load_gain": lambda p: GAIN * GRAVITY / p["gravity_torque"]}
    free_all = ss.identify(rec, known, free=free, tied=tied, sensor={}, starts=8)
    assert set(free_all.undetermined) == set(free)
    said = next(w for w in free_all.warnings if "fix one of them" in w)
    assert "motor_constant" in said
    formulas = [formula for formula, _, _ in free_all.combinations]
    assert len(formulas) == len(free) - 1
    del free["gravity_torque"]
    fixed = ss.identify(rec, known.replace(load_gain=GAIN), free=free, sensor={}, starts=8)
    truth = {name: value for name, value in TRUTH.items() if name != "load_gain"} | {"motor_constant": CONSTANT}
    assert fixed.undetermined == () and within(fixed, truth) == {}
    assert all(np.diff(fixed.interval(name, part="statistical"))[0] > 0 for name in truth)


def test_counts_of_an_encoder_do_not_make_the_inertia_small():
    """The noise of a second difference of counts of 1.5 mrad at 4 ms is nine times the acceleration: the motion is smoothed."""
    count = 2 * np.pi / 4096
    fit = ss.identify(log(angle=lambda q: count * np.round(q / count)), START, free=FREE, sensor={}, starts=8)
    assert within(fit, TRUTH) == {} and abs(fit.values["inertia"] / INERTIA - 1) < 0.02
    assert "the motion is smoothed to a bandwidth" in fit.report()


def test_torque_and_angle_may_have_clocks_of_their_own():
    """Torque at 1 kHz, angle at 200 Hz."""
    fast, slow = log(step=0.001), log(step=0.005)
    rec = ss.Record({"angle": slow["angle"], "drive": fast["drive"]})
    fit = ss.identify(rec, START, free=FREE, sensor={}, starts=8)
    assert within(fit, TRUTH) == {} and "drive is averaged over 5 samples" in fit.report()


def test_uneven_times_are_made_even_and_said():
    rec = log()
    t = rec["angle"].time + 1e-3 * np.random.default_rng(0).uniform(-1, 1, len(rec["angle"]))
    rng = np.random.default_rng(3)
    uneven = ss.Record.of(t, {"angle [rad]": motion(t)[0], "torque [N m]": torque(t) + 2e-4 * rng.normal(size=len(t))})
    fit = ss.identify(uneven, START, free=FREE, sensor={}, starts=2)
    assert "the times are uneven" in fit.report() and clock_of(rec, "force", "record 0").notes == ()
    kept = np.flatnonzero(abs(rec["angle"].time - 2.0) > 0.5)
    columns = {"angle [rad]": rec["angle"].si[kept], "torque [N m]": rec["force"].si[kept]}
    missing = ss.Record.of(rec["angle"].time[kept], columns)
    assert clock_of(missing, "force", "record 0").notes == ("the times have 1 gap longer than 3 steps; nothing is compared there",)
    assert within(fit, TRUTH, errors=6.0) == {}  # splines between samples smooth the noise, so that errors are too small by a fifth


def test_a_machine_of_two_bodies_is_refused_with_what_to_do():
    with pytest.raises(ss.InputError, match="gear_stiffness, backlash"):
        ss.identify(log(), START.replace(backlash=0.01), free={"inertia": (1e-3, 0.1)}, sensor={})


def test_a_log_without_torque_is_refused_with_what_to_type():
    t = np.arange(0, 4, 0.01)
    rec = ss.Record.of(t, {"angle [rad]": motion(t)[0]})
    with pytest.raises(ss.InputError, match="torque"):
        ss.identify(rec, START, free={"inertia": (1e-3, 0.1)}, using="force")


# weights and outliers ---------------------------------------------------------------------------------------------


def loop(outliers=0.0, seed=0, samples=600, load=10.0, offset=0.0):
    """A force loop of known friction, some samples of which are far off."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 3, samples)
    v = 2e-3 * np.cos(2 * np.pi * t + 0.1)
    F = np.where(v > 0, 0.3, -0.35) * load + 200 * v + offset + rng.normal(0, 0.05, samples)
    bad = rng.random(samples) < outliers
    F[bad] += rng.normal(2, 3, bad.sum())
    x = 2e-3 / (2 * np.pi) * np.sin(2 * np.pi * t + 0.1)
    return ss.Record.of(t, {"x [m]": x, "F [N]": F}, roles={"F": "force"}), bad


LOOP = {"mu_plus": (0.1, 1.0), "mu_minus": (0.1, 1.0), "viscous": (0.0, 1e3)}
LOOP_TRUTH = {"mu_plus": 0.3, "mu_minus": 0.35, "viscous": 200.0}


def test_weights_count_as_repeats_and_zero_leaves_a_sample_out():
    rec, bad = loop(0.1)
    kept = {"load": 10.0, "free": LOOP, "sensor": {}, "starts": 4}
    plain, double = ss.identify(rec, ss.CoulombViscous, **kept), ss.identify(rec, ss.CoulombViscous, weights=np.full(600, 2.0), **kept)
    assert double.values == pytest.approx(plain.values, rel=1e-6) and double.errors == pytest.approx(plain.errors, rel=1e-6)
    without = ss.identify(rec, ss.CoulombViscous, weights=1.0 - bad, **kept)
    assert within(without, LOOP_TRUTH) == {} and without.count < 600
    assert set(within(plain, LOOP_TRUTH, errors=3.0)) or plain.errors["mu_plus"] > 5 * without.errors["mu_plus"]


@each_row("loss", ["huber", "bisquare"])
def test_outliers_do_not_move_a_robust_fit(loss):
    rec, bad = loop(0.1)
    fit = ss.identify(rec, ss.CoulombViscous, load=10.0, free=LOOP, sensor={}, starts=4, loss=loss)
    away = within(fit, LOOP_TRUTH)
    assert away == {} if loss == "bisquare" else all(abs(e) < 8 for e in away.values())  # Huber's loss keeps a bias of one-sided outliers
    (note,) = (n for n in fit.notes if "as outliers" in n)
    assert abs(int(note.split(": ")[1].split(" of ")[0]) - bad.sum()) < 0.3 * bad.sum()


def test_wrong_weights_are_said_all_at_once():
    rec, _ = loop()
    with pytest.raises(ss.InputError) as error:
        ss.identify([rec, rec], ss.CoulombViscous, load=10.0, free=LOOP, weights=[np.ones(3), -np.ones(600)])
    assert len(error.value.problems) == 2 and "shape (600,)" in str(error.value)
    with pytest.raises(ss.InputError, match="did you mean 'huber'"):
        ss.identify(rec, ss.CoulombViscous, load=10.0, free=LOOP, loss="hubert")


# the next experiment ----------------------------------------------------------------------------------------------


def test_the_experiment_that_is_recommended_makes_the_interval_finite():
    """A load cell whose zero is off: forwards and backwards are not told apart, until the load is another one and the zero the same."""
    law, known = ss.CoulombViscous, {"free": LOOP, "starts": 4}
    zero = {"offset": None}
    first, _ = loop(load=10.0, offset=0.4, seed=1)
    fit = ss.identify(first, law, load=10.0, sensor=zero, **known)
    assert set(fit.undetermined) == {"mu_plus", "mu_minus"}
    plan = fit.next_experiment([{"load": 10.0, "sensor": "same"}, {"load": 25.0}, {"load": 25.0, "sensor": "same"}], samples=600)
    assert plan.best.settings == ({"load": 25.0, "sensor": "same"},)
    assert all(np.isinf(e.errors["mu_plus"]) for e in plan.experiments[1:])
    assert str(plan).endswith("load = 25 N, sensor = same determines mu_plus and mu_minus")
    second, _ = loop(load=25.0, offset=0.4, seed=2)
    both = _both(first, second, law, zero)
    assert both.undetermined == () and within(both, LOOP_TRUTH) == {}
    assert both.errors["mu_plus"] == pytest.approx(plan.best.errors["mu_plus"], rel=0.35)  # other noise, other samples


def _both(first, second, law, zero):
    """Two loops, each with its load as a channel."""
    loaded = [rec.derived("load [N]", np.full(len(rec["F"]), N), like="F", role="load") for rec, N in ((first, 10.0), (second, 25.0))]
    return ss.identify(loaded, law, free=LOOP, starts=4, sensor=zero)


# the posterior ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def certain():
    rec, _ = loop(samples=300)
    return ss.identify(rec, ss.CoulombViscous, load=10.0, free=LOOP, sensor={"offset": ("normal", 0.0, 0.02)}, starts=4)


def test_samples_of_a_linear_fit_have_its_mean_and_covariance(certain):
    """The model is linear but for reversals, so that the posterior is Student's, near the normal one: means to 4 Monte Carlo errors."""
    pytest.importorskip("emcee")
    found = certain.sample(300, burn=100, seed=1)
    independent = found.attrs["independent_draws"]
    assert independent > 100 and 0.2 < found.attrs["acceptance"] < 0.9
    for name, error in certain.errors.items():
        mean, sd = float(found[name].mean()), float(found[name].std())
        assert abs(mean - certain.values[name]) < (4 / np.sqrt(independent) + 0.1) * error  # 0.1: half a sample more or less at a reversal
        assert sd == pytest.approx(error, rel=4 / np.sqrt(2 * independent) + 0.05)
    assert {"sensor offset"} < set(found.data_vars) and found["viscous"].attrs["units"] == "N s/m"
    assert bool((certain.sample(20, burn=10, seed=5)["mu_plus"] == certain.sample(20, burn=10, seed=5)["mu_plus"]).all())


def test_an_interrupted_chain_prints_nothing_and_is_the_beginning_of_the_whole_one(certain, monkeypatch, capfd):
    """Ctrl-C that is answered within the posterior was printed by emcee, with the places of all walkers."""
    pytest.importorskip("emcee")
    inside, calls = sampling._Posterior._inside, iter(range(1000))

    def interrupted(posterior, places):
        if next(calls) == 70:
            interruption.stop_call(interruption.CTRL_C)
            interruption.look()
        return inside(posterior, places)

    monkeypatch.setattr(sampling._Posterior, "_inside", interrupted)
    part = certain.sample(40, burn=10, seed=5)
    said = capfd.readouterr()
    assert "emcee: Exception" not in said.out + said.err and "Traceback" not in said.err
    assert part.attrs["note"].startswith("interrupted: ") and 10 <= part.sizes["draw"] < 40
    whole = certain.sample(40, burn=10, seed=5)
    assert bool((part["mu_plus"] == whole["mu_plus"][: part.sizes["draw"]]).all())


def test_bands_hold_the_curve_and_as_many_measurements_as_they_say(certain):
    band = certain.bands(draws=100)
    assert bool((band.low <= band.fitted + 1e-12).mean() > 0.99) and bool((band.high >= band.fitted - 1e-12).mean() > 0.99)
    inside = float(((band.measured > band.predicted_low) & (band.measured < band.predicted_high)).mean())
    assert inside > 0.9  # 300 values: 95 % to 4 standard errors of 1.3 %
    with pytest.raises(ss.InputError, match="type record=0"):
        certain.bands(record=3)


def test_a_missing_sampler_is_told_with_what_to_install(certain, monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(ss.InputError, match=r"stickslip\[bayes\]"):
        certain.sample(10)


# laws with inner states, and starts -------------------------------------------------------------------------------

BRISTLES = {
    "inertia": 0.012, "gravity_torque": 0.3, "friction.mu_plus": 0.06, "friction.mu_minus": 0.075, "friction.f_plus": 0.09,
    "friction.f_minus": 0.1, "friction.sigma0": 2.0, "friction.sigma2": 0.01,
}  # fmt: skip
SEEN = {
    "inertia": (1e-3, 0.1), "gravity_torque": (0.05, 1.0), **{f"friction.{name}": (0.01, 0.3) for name in ("mu_plus", "mu_minus")},
    **{f"friction.{name}": (0.01, 0.3) for name in ("f_plus", "f_minus")}, "friction.sigma0": (0.2, 20.0, "log"),
    "friction.sigma2": (0.0, 0.1),
}  # fmt: skip
BENT = ss.Joint(
    inertia=0.02, friction=ss.LuGre(0.05, 0.05, 0.08, 0.08, sigma0=4.0, sigma1=0.0, sigma2=0.02, v_s=0.3), torque=0.0, gravity_torque=0.2
)


def bristle_log(begin=0.0, seed=1, end=8.0, step=0.004, noise=2e-3, parts=20):
    """A log of a joint under LuGre friction that is switched on at zero, from a later instant on; twenty exact steps in each of its own."""
    mu_plus, mu_minus, f_plus, f_minus, sigma0, sigma2 = (v for name, v in BRISTLES.items() if name.startswith("friction"))
    t = np.arange(0.0, begin + end, step / parts)
    q, v, a = motion(t)
    mu, f = np.where(v > 0, mu_plus, mu_minus), np.where(v > 0, f_plus, f_minus)
    bent, z = (mu + (f - mu) * np.exp(-((v / 0.3) ** 2))) / sigma0, np.zeros(len(t))
    for k, way in enumerate(np.diff(q), 1):
        limit = np.sign(way) * bent[k]
        z[k] = limit + (z[k - 1] - limit) * np.exp(-abs(way) / bent[k])
    measured = BRISTLES["inertia"] * a + BRISTLES["gravity_torque"] * np.sin(q) + sigma0 * z + sigma2 * v
    kept = np.arange(round(begin / step) * parts, len(t), parts)
    measured = measured[kept] + np.random.default_rng(seed).normal(0, noise, len(kept))
    return ss.Record.of(t[kept] - t[kept[0]], {"angle [rad]": q[kept], "torque [N m]": measured})


def test_bristles_of_a_joint_are_found_from_a_log_that_begins_while_it_slides():
    """Stepped by velocities at the samples sigma0 was 4 % off, 7 standard errors; from unbent ones, friction 3, the rms 1.6 times."""
    fit = ss.identify(bristle_log(begin=1.3), BENT, free=SEEN, sensor={"offset": None}, starts=4)
    assert within(fit, BRISTLES) == {} and fit.quality[0].rms == pytest.approx(2e-3, rel=0.1) and not fit.quality[0].suspicious
    assert -0.9 < fit.sensor["start[0]"][0] < -0.5


def swing(mu=0.05, inertia=0.012, damping=0.01, law=ss.CoulombViscous):
    rubs = {ss.CoulombViscous: lambda: law(mu, mu, viscous=damping),
            ss.LuGre: lambda: law(mu, mu, 1.3 * mu, 1.3 * mu, sigma0=20.0, sigma1=0.05, sigma2=damping, v_s=0.1)}  # fmt: skip
    return ss.Joint(inertia=inertia, friction=rubs[law](), torque=ss.HarmonicForce(amplitude=0.4, frequency=2.0), gravity_torque=0.3)


def swung(law, what, place=0.5):
    """Seven seconds of a swing that begins at rest at an angle."""
    t = np.linspace(0, 6.75, 2700)
    at = ss.solve(swing(law=law), periods=14, keep="trajectory", start={"x": place, "v": 0.0}).at(t)
    name, column, noise = {"angle": ("angle [rad]", "x", 1e-3), "velocity": ("rate [rad/s]", "v", 0.02)}[what]
    return ss.Record.of(t, {name: at[column] + np.random.default_rng(1).normal(0, noise, len(t))})


@pytest.mark.parametrize(("law", "what"), [
    (ss.CoulombViscous, "angle"), *(pytest.param(*case, marks=pytest.mark.slow) for case in (
        (ss.CoulombViscous, "velocity"), (ss.LuGre, "angle"), (ss.LuGre, "velocity")))])  # fmt: skip
def test_a_swing_that_begins_at_an_angle_is_fitted_from_there(law, what):
    """From the lowest place what was left was 22 to 80 times the noise."""
    free = {"mu": (0.01, 0.2), "inertia": (5e-3, 0.03), "damping": (0.0, 0.05)}
    make = lambda mu, inertia, damping: swing(mu, inertia, damping, law)  # noqa: E731
    fit = ss.identify(swung(law, what), make, free=free, transient=True, starts=4, sensor={}, frequency=2.0)
    assert within(fit, {"mu": 0.05, "inertia": 0.012, "damping": 0.01}) == {} and not fit.quality[0].suspicious


# long ones --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_backlash_inertia_friction_and_gravity_of_a_geared_joint_come_from_its_swing():
    law = ss.CoulombViscous(0.03, 0.03, viscous=0.05)
    swing = {"torque": ss.HarmonicForce(amplitude=0.5, frequency=1.0), "gravity_torque": 0.3}
    joint = ss.Joint(0.01, law, **swing, backlash=0.05, gear_stiffness=100.0, gear_damping=0.5, motor_inertia=0.005)
    run, t = ss.solve(joint, periods=40), np.arange(0, 5, 0.002)
    x = run.at(run.t[-1] - 5 + t)["x"] + np.random.default_rng(0).normal(0, 2e-4, len(t))
    rec = ss.Record.of(t, {"angle [rad]": x})
    free = {"backlash": (0.0, 0.2), "inertia": (5e-3, 0.02), "friction.mu_plus": (0.0, 0.1), "gravity_torque": (0.1, 0.5)}
    fit = ss.identify(rec, joint, free=free, starts=8, sensor={})
    assert within(fit, {"backlash": 0.05, "inertia": 0.01, "friction.mu_plus": 0.03, "gravity_torque": 0.3}) == {}
    assert fit.errors["backlash"] < 1e-3 and "rad" in fit.report()


@pytest.mark.slow
def test_speeds_of_a_capsubot_against_period_and_duty_are_one_problem():
    T, d = np.repeat([0.02, 0.03, 0.04, 0.06], 5), np.tile([0.2, 0.3, 0.4, 0.6, 0.7], 4)
    make, noise = ss.presets.capsubot, 2e-4
    run = ss.solve(make(pulse=1.25, pulse_period=T, duty=d), periods=200, settle="auto", keep="summary")
    seen = run.mean_velocity + np.random.default_rng(1).normal(0, noise, len(T))
    free = {"mu": (0.1, 0.5), "pulse": (0.8, 2.0)}
    fit = ss.identify(list(seen), make, free=free, pulse_period=list(T), duty=list(d), noise=noise, starts=16)
    assert within(fit, {"mu": 0.29, "pulse": 1.25}) == {} and fit.cost < 2.5 * len(T)  # chi² of 18: beyond 50 in one of 1e4


@pytest.mark.slow
def test_intervals_of_joints_hold_the_truth_as_often_as_they_say():
    """60 logs, half of them with counts of an encoder: 95 % of 300 numbers to 3.5 standard errors of 1.3 %."""
    hits = count = 0
    for seed in range(60):
        angle = (lambda q: 2e-3 * np.round(q / 2e-3)) if seed % 2 else (lambda q: q)
        fit = ss.identify(log(seed=seed, angle=angle, end=8.0 + 0.05 * seed), START, free=FREE, sensor={"offset": None}, starts=4)
        for name, value in TRUTH.items():
            low, high = fit.interval(name)
            hits, count = hits + (low <= value <= high), count + 1
    print(hits, count)
    assert 0.90 < hits / count < 0.99


@pytest.mark.slow
def test_intervals_of_bristles_hold_the_truth_as_often_as_they_say():
    """Ten logs that begin anywhere: of 80 intervals 95 % to 3.5 standard errors of 2.4 %."""
    hits = 0
    for seed in range(10):
        fit = ss.identify(bristle_log(begin=0.37 * seed, seed=seed), BENT, free=SEEN, sensor={"offset": None}, starts=4)
        hits += sum(low <= BRISTLES[name] <= high for name in BRISTLES for low, high in [fit.interval(name)])
    assert hits >= 0.865 * 80
