"""Noise of the motion in fits of forces and joints: smoothed, part of the intervals, or the reason why a number is not determined."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.inverse.identification.covariance import information_of
from stickslip.inverse.identification.measured_motion import motion_behind
from stickslip.inverse.identification.smoothing import channel, smoothed
from stickslip.inverse.identification.uncertainty import faults

AMPLITUDE, OMEGA, LOAD = 3.8e-3, 2 * np.pi * 0.25, 40.0
T = np.arange(0.0, 8.0, 2e-3)
X, V = AMPLITUDE * np.sin(OMEGA * T), AMPLITUDE * OMEGA * np.cos(OMEGA * T)
LAW = ss.Stribeck(mu_plus=0.25, mu_minus=0.25, f_plus=0.33, f_minus=0.33, v_s=8e-4)
FREE = {"mu_plus": (0.05, 0.6), "f_plus": (0.05, 0.8), "v_s": (1e-4, 1e-2, "log")}
BOTH = {"mu_minus": "mu_plus", "f_minus": "f_plus"}
TRUTH = {"mu_plus": 0.25, "f_plus": 0.33, "v_s": 8e-4}


def record(position, seed=0, **more):
    """Friction over the motion that is known, beside what a sensor of the position shows of it."""
    force = LOAD * np.sign(V) * LAW.coefficient(abs(V)) + np.random.default_rng([1, seed]).normal(0, 0.02, len(T))
    return ss.Record.of(T, {"x [m]": position, "F [N]": force, **more}, roles={"x": "position", "F": "force"})


def noisy(size, seed=0):
    return X + np.random.default_rng([2, seed]).normal(0, size, len(T))


def fitted(rec):
    return ss.identify(rec, ss.Stribeck, free=FREE, tied=BOTH, load=LOAD, starts=8, sensor={"offset": None})


def off(fit):
    return {name: (fit.values[name] - value) / fit.errors[name] for name, value in TRUTH.items()}


def test_noise_of_the_position_does_not_move_static_friction_out_of_its_interval():
    """0.2 micrometres of noise made 0.69 of 0.33, with 95 % from 0.60 to 0.80."""
    fits = [fitted(record(noisy(size))) for size in (2e-7, 5e-6)]
    for fit in fits:
        assert all(abs(z) < 4 for z in off(fit).values()) and fit.errors["f_plus"] < 0.03
        assert "the motion is smoothed to a bandwidth" in fit.report() and fit.lost == ()
        low, high = fit.interval("v_s", part="input")
        assert 0 < high - low <= 1.01 * np.diff(fit.interval("v_s"))[0]
    assert 2 * fits[0].input_errors["v_s"] < fits[1].input_errors["v_s"]


def test_what_noise_of_the_motion_leaves_about_the_turns_is_no_shape_of_a_wrong_law():
    """Neighbours correlated by 0.99, so that the offset of the load cell was held at zero, and the law blamed for it."""
    stiffness, most, way, force = 2e5, 10.0, np.where(V >= 0, 1.0, -1.0), np.empty(len(T))
    begin, place = 0.0, 0.0
    for k in range(len(T)):
        if k and way[k] != way[k - 1]:  # between turns the force of Dahl's bristles is an exponential
            turn, end = AMPLITUDE * way[k - 1], most * way[k - 1]
            begin, place = end + (begin - end) * np.exp(-stiffness * abs(turn - place) / most), turn
        force[k] = most * way[k] + (begin - most * way[k]) * np.exp(-stiffness * abs(X[k] - place) / most)
    shown = force + 0.1 + np.random.default_rng([5, 2]).normal(0, 0.02, len(T))
    columns = {"x [m]": noisy(1e-4, 2)[:2500], "F [N]": shown[:2500]}
    rec = ss.Record.of(T[:2500], columns, roles={"x": "position", "F": "force"})
    free = {"mu_plus": (0.05, 0.6), "sigma0": (1e4, 1e7, "log")}
    fit = ss.identify(rec, ss.Dahl, free=free, tied={"mu_minus": "mu_plus"}, load=LOAD, exponent=1.0, starts=1)
    assert fit.quality[0].correlation > 0.9 and not faults(fit)
    assert abs(fit.values["sigma0"] - stiffness) < 3 * fit.errors["sigma0"] and fit.sensor["offset"][0] != 0
    wrong = ss.identify(rec, ss.Coulomb, free={"mu": (0.05, 0.6)}, load=LOAD, starts=1)
    assert "after reversals" in " ".join(faults(wrong))


def test_counts_of_a_coarse_encoder_are_read_by_their_edges():
    """Strokes of 76 counts: what is smoothed differs from the motion by a hundredth of a count, where rounding is off by 0.29 of one."""
    count = 1e-4
    motion = smoothed((channel(0, T, count * np.round(X / count)),))
    assert np.std(motion.at(T) - X) < 0.03 * count and np.std(motion.at(T, 1) - V) < 0.01 * np.std(V)
    assert all(abs(z) < 4 for z in off(fitted(record(count * np.round(X / count)))).values())
    # about one count in a sample: edges and values are the same roundings, which were counted twice and taken for a motion of 250 Hz
    count = 2e-3 * np.max(abs(V)) / 1.03
    motion = smoothed((channel(0, T, count * np.round(X / count)),))
    error = float(np.std((motion.at(T, 1) - V)[motion.inside(T)]))
    repeated = float(np.std([(motion.again(k).at(T, 1) - motion.at(T, 1))[motion.inside(T)] for k in range(4)]))
    assert motion.bandwidth < 10 and error < 2e-3 * np.std(V) and error < 2 * repeated


@each_row("size", [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("counts", [20, 316, 1500])
def test_counts_that_flicker_are_no_edges_of_the_motion(size, counts):
    """Noise of a tenth of a count or more was taken for crossings of edges: velocities were a hundred times as far off as without it."""
    rng, t = np.random.default_rng(1), np.arange(0.0, 6.2, 1e-3)
    x, v = np.sin(2.2 * t), 2.2 * np.cos(2.2 * t)
    count = np.ptp(x) / counts
    motion = smoothed((channel(0, t, count * np.round((x + rng.normal(0.0, size * count, len(t))) / count)),))
    error, whole = np.std(motion.at(t, 1) - v), np.hypot(size, 12**-0.5) * count
    assert error < 12 * whole and motion.noise[0] == pytest.approx(whole, rel=0.3)


def test_what_other_noise_would_have_shown_is_as_far_off_as_the_motion_is():
    motion = smoothed((channel(0, T, noisy(2e-6)),))
    away = np.std([motion.again(k).at(T, 1) - motion.at(T, 1) for k in range(8)])
    assert 0.4 < np.std(motion.at(T, 1) - V) / away < 2.5
    t, rng = np.arange(0.0, 8.0, 5e-3), np.random.default_rng(2)  # an acceleration, of which the ends are left out
    swing = smoothed((channel(0, t, np.sin(2 * t) + 0.2 * np.sin(6 * t) + rng.normal(0, 1e-3, len(t))),))
    off = swing.at(t, 2) + 4 * np.sin(2 * t) + 7.2 * np.sin(6 * t)
    again, inside = np.std([swing.again(k).at(t, 2) - swing.at(t, 2) for k in range(8)], axis=0), swing.inside(t)
    ratio = [float(np.std(off[which]) / np.sqrt(np.mean(again[which] ** 2))) for which in (inside, ~inside)]
    assert ratio[0] < 1.5 < 2.0 < ratio[1] and 0.75 < np.mean(inside) < 0.98, ratio
    # viscous friction over a noisy position, whose fit over other noise is a quotient: attenuation is in what the noise changes
    t, rng = np.arange(0.0, 4.0, 4e-3), np.random.default_rng(3)
    x, v = 1e-3 * np.sin(9.0 * t), 9e-3 * np.cos(9.0 * t)
    seen = x + rng.normal(0.0, 3e-4, len(t))
    rec = ss.Record.of(t, {"x [m]": seen, "F [N]": 50.0 * v + rng.normal(0.0, 1e-3, len(t))}, roles={"x": "position", "F": "force"})
    fit = ss.identify(rec, ss.friction.Viscous, free={"viscous": (1.0, 400.0)}, load=1.0, starts=1, sensor={})
    problem = fit.problem.model
    own, again = (np.where(m.still, 0.0, m.at)[m.compared] for m in (each.targets[0] for each in (problem, problem.redrawn(5))))
    moved = information_of(fit.problem, fit.jacobian).inverse[:, : fit.count] @ fit.changes[:, 5]
    there = (again @ own) / (again @ again)  # of the slope over the other motion, in that over this one
    attenuated = 1 - float(moved[0] * fit.slopes[0]) / fit.values["viscous"]
    # values of open direction count from three standard deviations on, some in a thousand of them: a thousandth of what is off
    assert attenuated == pytest.approx(there, rel=1e-4) and abs(there - 1) > 2e-3


def test_a_measured_velocity_is_used_where_it_agrees_with_the_position_and_named_where_not():
    rng = np.random.default_rng(3)
    rate = 1.1 * V + 2e-4 + rng.normal(0, 1e-5, len(T))
    alone = motion_behind(record(noisy(2e-5)))[0]
    both, said = motion_behind(record(noisy(2e-5), **{"v [m/s]": rate}))
    assert np.std(both.at(T, 1) - V) < 0.7 * np.std(alone.at(T, 1) - V) and "with the v" in " ".join(said)
    _, said = motion_behind(record(noisy(2e-5), **{"v [m/s]": np.roll(rate, 60)}))
    assert any("does not agree" in note for note in said)


def test_a_number_that_the_noise_of_the_motion_hides_is_not_determined_and_the_sensor_is_named():
    """Bristles that bend by some ten micrometres under a position that is known to two millimetres."""
    free = {"mu_plus": (0.05, 0.6), "sigma0": (1e5, 1e8, "log")}
    force = LOAD * 0.25 * np.sign(V) + np.random.default_rng(1).normal(0, 0.02, len(T))
    rec = ss.Record.of(T, {"x [m]": noisy(2e-3), "F [N]": force}, roles={"x": "position", "F": "force"})
    fit = ss.identify(rec, ss.Dahl, free=free, tied={"mu_minus": "mu_plus"}, load=LOAD, exponent=1.0, starts=8, sensor={})
    assert "sigma0" in fit.undetermined or any("sigma0 ends at its bound" in w or "sigma0 is hardly" in w for w in fit.warnings)
    for name in fit.lost:
        assert fit.interval(name) == free[name][:2]
        assert any(name in w and "sensor of the position" in w for w in fit.warnings)


def test_a_position_without_noise_is_taken_as_it_is():
    assert motion_behind(record(X)) == (None, [])


def test_a_joint_with_an_encoder_of_few_counts_is_fitted_from_all_its_samples():
    """1170 samples of 128 counts a turn left nine windows between reversals, and were refused."""
    t = np.arange(0.0, 11.7, 0.01)
    q = 1.1 * np.sin(2 * t + 0.3) + 0.35 * np.sin(5.3 * t + 1)
    v, a = 2.2 * np.cos(2 * t + 0.3) + 1.855 * np.cos(5.3 * t + 1), -4.4 * np.sin(2 * t + 0.3) - 9.8315 * np.sin(5.3 * t + 1)
    torque = 0.012 * a + 0.3 * np.sin(q) + 0.03 * np.sign(v) + 0.01 * v + np.random.default_rng(0).normal(0, 2e-3, len(t))
    count = 2 * np.pi / 128
    rec = ss.Record.of(t, {"angle [rad]": count * np.round(q / count), "torque [N m]": torque})
    joint = ss.Joint(inertia=0.02, friction=ss.CoulombViscous(0.05, 0.05, viscous=0.02), torque=0.0, gravity_torque=0.2)
    free = {"inertia": (1e-3, 0.1), "gravity_torque": (0.05, 1.0), "friction.mu_plus": (0.0, 0.2), "friction.viscous": (0.0, 0.1)}
    fit = ss.identify(rec, joint, free=free, tied={"friction.mu_minus": "friction.mu_plus"}, sensor={}, starts=4)
    truth = {"inertia": 0.012, "gravity_torque": 0.3, "friction.mu_plus": 0.03, "friction.viscous": 0.01}
    assert fit.count > 800 and all(abs(fit.values[n] - w) < 4 * fit.errors[n] and fit.errors[n] < 0.3 * w for n, w in truth.items())


def few_counts(counts, samples, seed=0):
    """A log of a joint by an encoder of so many counts a turn, every 4 ms; and its truth."""
    t, rng = np.arange(samples) * 0.004, np.random.default_rng(seed)
    q = 1.1 * np.sin(2 * t + 0.3) + 0.35 * np.sin(5.3 * t + 1)
    v, a = 2.2 * np.cos(2 * t + 0.3) + 1.855 * np.cos(5.3 * t + 1), -4.4 * np.sin(2 * t + 0.3) - 9.8315 * np.sin(5.3 * t + 1)
    torque = 0.012 * a + 0.3 * np.sin(q) + 0.03 * np.sign(v) + 0.01 * v + rng.normal(0, 2e-3, samples)
    return ss.Record.of(t, {"angle [rad]": 2 * np.pi / counts * np.round(q / (2 * np.pi / counts)), "torque [N m]": torque})


def by_few_counts(rec):
    joint = ss.Joint(inertia=0.02, friction=ss.CoulombViscous(0.05, 0.05, viscous=0.02), torque=0.0, gravity_torque=0.2)
    free = {"inertia": (1e-3, 0.1), "gravity_torque": (0.05, 1.0), "friction.mu_plus": (0.0, 0.2), "friction.viscous": (0.0, 0.1)}
    return ss.identify(rec, joint, free=free, tied={"friction.mu_minus": "friction.mu_plus"}, starts=4)


@pytest.mark.parametrize("counts", [64, 32])
def test_a_short_log_by_an_encoder_of_few_counts_is_fitted_over_shorter_windows(counts):
    """1170 samples were refused as 15 and 9 values between reversals."""
    fit = by_few_counts(few_counts(counts, 1170))
    truth = {"inertia": 0.012, "gravity_torque": 0.3, "friction.mu_plus": 0.03, "friction.viscous": 0.01}
    assert fit.count >= 60 and all(abs(fit.values[n] - w) < 4 * fit.errors[n] for n, w in truth.items())
    assert fit.errors["inertia"] < 0.1 * 0.012 and fit.errors["gravity_torque"] < 0.1 * 0.3
    delay, late = [n.name for n in fit.problem.numbers].index("delay") + 4, np.array(fit.point)  # by which steps lead to a minimum
    late[delay] = 0.3 * fit.problem.targets[0].step
    ahead, behind = (fit.problem.residuals(late + h * np.eye(len(late))[delay]) for h in (1e-7, -1e-7))
    assert fit.problem.jacobian(late)[:, delay] == pytest.approx((ahead - behind) / 2e-7, rel=1e-4, abs=1e-3)


@each_row(("counts", "samples"), [(12, 200), (64, 50)])
def test_a_log_with_too_few_edges_says_what_would_do(counts, samples):
    """Between them the joint was taken to rest: its friction came out five times too large, with a narrow interval."""
    with pytest.raises(ss.InputError, match=r"angle changes \d+ times in \d+ samples.* a longer record, longer strokes or a finer encoder"):
        by_few_counts(few_counts(counts, samples))
    with pytest.raises(ss.InputError, match="angle does not change in 120 samples; allowed is a motion"):
        by_few_counts(few_counts(8, 120))


# a law that the record contradicts --------------------------------------------------------------------------------


def rig(harmonic, seed, **known):
    robot = ss.presets.piezo_rig(tilt_deg=2.0, amplitude=6e-4, law="coulomb", mu0=0.18)
    rec = ss.virtual_rig(robot, noise=1e-3, seed=seed, harmonics=(harmonic, 0.0))
    return ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.4)}, tilt_deg=2.0, amplitude=6e-4, law="coulomb", starts=4, **known)


def test_a_harmonic_of_a_drive_that_is_said_to_be_exact_is_named():
    """The number is six standard errors off, and the law was said to be supported."""
    clean, wrong = rig(0.0, 1, harmonics=0), rig(0.015, 1, harmonics=0)
    assert not clean.quality[0].suspicious and wrong.quality[0].suspicious
    assert "drive" in wrong.quality[0].structure and any(wrong.quality[0].structure in w for w in wrong.warnings)


def test_mean_velocities_beyond_their_noise_are_said_and_their_intervals_are_wider():
    """21 speeds with 1 mm/s of noise, that are 2.7 times as far off, passed in silence."""
    tilts = np.linspace(1.0, 4.0, 8)
    make = lambda mu0, tilt: ss.presets.piezo_rig(tilt_deg=tilt, amplitude=6e-4, law="coulomb", mu0=mu0)  # noqa: E731
    speeds = [ss.mean_velocity(ss.solve(make(0.18, tilt), periods=100)) for tilt in tilts]
    away = np.resize([1.0, -1.0], len(tilts)) * 1e-4
    fits = [ss.identify([s + k * d for s, d in zip(speeds, away, strict=True)], make, free={"mu0": (0.1, 0.3)}, tilt=list(tilts),
                        noise=1e-4, starts=4) for k in (1.0, 5.0)]  # fmt: skip
    assert fits[0].scale == 1.0 and fits[1].scale == pytest.approx(5 * np.sqrt(8 / 7), rel=0.1)
    assert any("as far from the model" in w for w in fits[1].warnings) and not any("as far from" in w for w in fits[0].warnings)


def test_a_chain_is_fitted_by_the_motion_of_the_body_that_is_named():
    chain = ss.presets.two_modules()
    run = ss.solve(chain, periods=40)
    t = np.linspace(0.0, 0.4, 500)
    v = run.at(run.t[-1] - 0.5 + t)["v"][:, 1] + np.random.default_rng(0).normal(0, 1e-3, len(t))
    rec, free = ss.Record.of(t, {"velocity [m/s]": v}), {"modules.1.friction.mu_plus": (0.02, 0.5)}
    with pytest.raises(ss.InputError, match=r"2 bodies and no principal one; allowed are .* type body="):
        ss.identify(rec, chain, free=free)
    fit = ss.identify(rec, chain, free=free, body="module 2", starts=4, sensor={})
    truth = chain.modules[1].friction.mu_plus
    assert abs(fit.values["modules.1.friction.mu_plus"] - truth) < 4 * fit.errors["modules.1.friction.mu_plus"]
