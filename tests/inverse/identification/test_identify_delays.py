"""Delays of load cells beside forces that jump where the motion turns, and steps where data do not determine a number."""

import dataclasses

import numpy as np
import pytest

import stickslip as ss
from stickslip.inverse.identification.covariance import information_of, noise_scale, spread_of, still_promised
from stickslip.inverse.identification.damped_steps import damped_steps
from stickslip.inverse.identification.law_forces import Stepped, law_force
from stickslip.inverse.identification.misfit import misfit_of
from stickslip.inverse.identification.search import SearchEnd
from stickslip.inverse.identification.strokes import Strokes
from stickslip.inverse.identification.uncertainty import faults
from stickslip.models.friction.law_adapter import adapted

LOAD = 40.0


def rig(late: float, rate: float, law: str, noise: float = 0.0) -> ss.Record:
    """Strokes that turn exactly at a sample, under a force of 10 N, and 13 N near rest, that jumps and is shown late."""
    t = np.arange(0.0, 8.0, 1 / rate)
    moved = lambda s: (3.8e-3 * np.sin(np.pi * s), 3.8e-3 * np.pi * np.cos(np.pi * s))  # noqa: E731
    x, v = moved(t)[0], moved(t - late)[1]
    F = np.sign(v) * (10.0 + (3.2 * np.exp(-((v / 8e-4) ** 2)) if law == "Stribeck" else 0.0))
    random = np.random.default_rng(0)
    x = x + random.normal(0.0, 1.0, len(t)) * noise
    return ss.Record.of(t, {"x [m]": x, "F [N]": F + random.normal(0, 0.05, len(t))}, roles={"x": "position", "F": "force"})


@pytest.mark.parametrize(("late", "rate", "noise"), [(0.0, 250.0, 0.0), (5e-3, 250.0, 1e-10), (1e-3, 500.0, 1e-6)])
def test_a_delay_beside_a_force_that_jumps_where_the_motion_turns(late, rate, noise):
    """One or two samples at each reversal, of which nobody knows on which side they are, made a delay of 18 standard errors of nothing."""
    free = {"mu_plus": (0.05, 0.6), "f_plus": (0.05, 0.8), "v_s": (1e-4, 1e-2, "log")}
    tied = {"mu_minus": "mu_plus", "f_minus": "f_plus"}
    fit = ss.identify(rig(late, rate, "Stribeck", noise), ss.Stribeck, free=free, tied=tied, load=LOAD, starts=4)
    value, error = fit.sensor["delay"]
    assert abs(value - late) < 3.5 * error and error < 0.5 / rate
    for name, truth in {"mu_plus": 0.25, "f_plus": 0.33, "v_s": 8e-4}.items():
        assert abs(fit.values[name] - truth) < 3.5 * fit.errors[name]
    if late == 5e-3:
        assert all(abs(shift) < 0.25 for shift in shifts_by_noise(fit, 8e-3, rate))


def shifts_by_noise(fit, late, rate):
    """Means of what 200 draws of noise make of each number at the truth, to first order, in standard deviations over them.

    Values beside the jumps, of which noise alone goes beyond what a contact bears, made static friction 0.8 of them too large.
    """
    truth = {"mu_plus": 0.25, "f_plus": 0.33, "v_s": 8e-4}
    point = np.array(fit.point)
    for k, free in enumerate(fit.problem.parameters.free):
        point[k] = free.inner(truth[free.name])
    for k, number in enumerate(fit.problem.numbers, fit.problem.first):
        point[k] = {"delay": late, "gain": 1.0}.get(number.what, 0.0)
    problem, target = fit.problem.lagging(point), fit.problem.targets[0]
    v = 3.8e-3 * np.pi * np.cos(np.pi * (target.time + 0.5 * (target.t[target.before] + target.t[-1]) - late))
    exact, rng = np.sign(v) * (10.0 + 3.2 * np.exp(-((v / 8e-4) ** 2))), np.random.default_rng(4)
    draws = [problem.with_values(exact + rng.normal(0.0, 0.05, len(exact))) for _ in range(200)]
    inverse = information_of(problem, draws[0].jacobian(point)).inverse
    moved = np.array([-inverse @ each.residuals(point) for each in draws])[:, :3]
    return moved.mean(axis=0) / moved.std(axis=0)


def test_jumps_alone_tell_a_delay_to_a_sample_or_two():
    for late in (0.0, 2e-2):
        fit = ss.identify(rig(late, 250.0, "Coulomb"), ss.Coulomb, free={"mu_plus": (0.05, 0.6)}, tied={"mu_minus": "mu_plus"}, load=LOAD,
                          starts=4)  # fmt: skip
        value, error = fit.sensor["delay"]
        assert abs(value - late) < 2.5 * error and 2e-3 < error < 1.6e-2
        assert abs(fit.values["mu_plus"] - 0.25) < 2 * fit.errors["mu_plus"] and fit.sensor["gain"][0] == pytest.approx(1.0, abs=1e-3)

    whole = rig(0.0, 250.0, "Coulomb", noise=1e-6)
    part = (whole["x"].t > 0.55) & (whole["x"].t < 1.45)  # of one stroke: nothing jumps, and each delay leaves other values out
    once = ss.Record.of(whole["x"].t[part], {"x [m]": whole["x"].values[part], "F [N]": whole["F"].values[part]},
                        roles={"x": "position", "F": "force"})  # fmt: skip
    fit = ss.identify(once, ss.Coulomb, free={"mu_plus": (0.05, 0.6)}, tied={"mu_minus": "mu_plus"}, load=LOAD, starts=4)
    assert fit.sensor["delay"][1] == np.inf

    made = Strokes(np.arange(14.0), np.array([1, 1, 1, *[0] * 8, -1, -1, -1]), -9.0, 1.0)  # far from a reversal a value is held
    h, sooner = np.arange(14.0) ** 2, 1e-6
    changes = (made.delayed(h, 0.3 - sooner) - made.delayed(h, 0.3 + sooner)) / (2 * sooner)
    assert made.slope(h, 0.3) == pytest.approx(changes, abs=1e-6) and (changes[2:12] == 0).any()
    t = np.cumsum(np.random.default_rng(1).uniform(0.8, 1.2, 40))
    made = Strokes(t, np.where(np.arange(40) < 20, 1, -1), 1.3, 1.0)
    shown, within = made.delayed(t**2, 1.3), made.open < 0  # a parabola from the first to the last value of a stroke, within it a cubic
    assert shown[within][2:] == pytest.approx((t[within][2:] - 1.3) ** 2, rel=1e-12) and np.sum(~within) == 3
    v = np.linspace(-1.0, 1.0, 100)  # noise leaves the direction open for 40 samples: of a motion that passes rest, and of one that rests
    sides = np.where(abs(v) < 0.4, 0.0, np.sign(v))
    for speeds, passes in ((abs(v), True), (np.where(abs(v) < 0.4, 0.02, abs(v)), False)):
        whole = Strokes(np.arange(100.0), sides, 0.0, 1.0, speeds)
        assert np.any(whole.passing) == passes and np.sum(whole.open >= 0) == 44
    assert made.delayed(t**3, 1.3)[[5, 10, 15, 30, 35]] == pytest.approx((t[[5, 10, 15, 30, 35]] - 1.3) ** 3, rel=1e-12)


def test_steps_go_on_where_a_number_has_no_effect():
    """Of y = a b, with b known to be 1 +- 0.02, and a number without effect; SciPy's steps stop at once with a column of zeros."""
    y, until = np.full(2000, 3.0) + np.random.default_rng(0).normal(0, 0.01, 2000), (1e-12, 1e-12, 60, 1e-6)
    residuals = lambda p: np.append((p[0] * p[1] - y) / 0.01, (p[1] - 1) / 0.02)  # noqa: E731
    columns = lambda p: np.stack([np.full(2000, p[1]), np.full(2000, p[0]), np.zeros(2000)], axis=1) / 0.01  # noqa: E731
    jacobian = lambda p: np.concatenate([columns(p), [[0.0, 50.0, 0.0]]])  # noqa: E731
    start, high = np.array([3.1, 0.97, 0.3]), np.full(3, 9.0)
    end = damped_steps(residuals, jacobian, start, (np.zeros(3), high), until)
    assert end.x == pytest.approx([y.mean(), 1.0, 0.3], abs=1e-5) and end.promised < 1e-6
    at_a_bound = damped_steps(residuals, jacobian, start, (np.array([3.05, 0, 0]), high), until)
    assert at_a_bound.x[0] == 3.05 and at_a_bound.x[1] == pytest.approx(y.mean() / 3.05, rel=1e-4)


def test_a_search_that_ends_before_a_minimum_says_so_and_its_intervals_hold_the_minimum():
    free, tied = {"mu_plus": (0.05, 0.6)}, {"mu_minus": "mu_plus"}
    fit = ss.identify(rig(0.0, 250.0, "Coulomb"), ss.Coulomb, free=free, tied=tied, load=LOAD, starts=2, sensor={"offset": None})
    problem, ended = fit.problem, fit.point + np.array([30 * np.sqrt(fit.spread[0, 0]), 0.0])
    r, J = problem.residuals(ended), problem.jacobian(ended)
    early = SearchEnd(ended, r, J, 3, promised=float(r @ r) - fit.cost)
    assert still_promised(problem, SearchEnd(fit.point, problem.residuals(fit.point), problem.jacobian(fit.point), 9)) == 0.0
    assert still_promised(problem, early) == pytest.approx(early.promised / noise_scale(problem, early) ** 2)
    misfit = misfit_of(problem, early, None)
    spread = spread_of(problem, J, r[: fit.count], noise_scale(problem, early), None, misfit)
    assert np.sqrt(spread[0, 0]) > 0.9 * (ended - fit.point)[0] and not misfit.is_none
    said = dataclasses.replace(fit, misfit=misfit)
    assert all(any("ended before a minimum" in text for text in texts) for texts in (faults(said), said.warnings))
    near = dataclasses.replace(fit, misfit=dataclasses.replace(misfit, promised=0.5, said=("",)))  # said, and no fault of the law
    assert not faults(near) and any("ended before a minimum" in text for text in near.warnings)


def test_a_law_near_rest_is_followed_by_shorter_steps_than_those_between_samples():
    """At 50 Hz the velocity changes by more than v_s between two samples at a reversal: the truth is made by forty steps between them."""
    t, fine = np.arange(0.0, 6.0, 0.02), np.arange(-1.0, 6.0, 0.0005)
    x, v = 3e-3 * np.sin(2.3 * fine), 6.9e-3 * np.cos(2.3 * fine)
    law = ss.LuGre(0.2, 0.2, 0.3, 0.3, sigma0=4e5, sigma1=0.0, sigma2=100.0, v_s=3e-4)
    motion = Stepped(fine, np.diff(x, prepend=x[0]) / 0.0005, v)
    F = law_force(adapted(law), motion, np.full((len(fine), 1), LOAD), np.zeros((len(fine), 1)), 1)[:, 0][np.searchsorted(fine, t - 1e-9)]
    rec = ss.Record.of(t, {"x [m]": 3e-3 * np.sin(2.3 * t), "F [N]": F + np.random.default_rng(0).normal(0, 0.01, len(t))},
                       roles={"x": "position", "F": "force"})  # fmt: skip
    free, fixed = {"mu_plus": (0.05, 0.6), "v_s": (1e-4, 1e-2, "log")}, dict(f_plus=0.3, f_minus=0.3, sigma0=4e5, sigma1=0.0, sigma2=100.0)
    fit = ss.identify(rec, ss.LuGre, free=free, tied={"mu_minus": "mu_plus"}, load=LOAD, starts=2, sensor={}, **fixed)
    assert faults(fit) == [] and len(fit.problem.targets[0].t) > len(t) and fit.errors["v_s"] < 1e-4
    assert all(abs(fit.values[name] - true) < 2 * fit.errors[name] for name, true in {"mu_plus": 0.2, "v_s": 3e-4}.items())
