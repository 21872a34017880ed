"""A sensor that is off widens intervals instead of moving numbers; what a record cannot tell is said, with what it can."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import stickslip as ss
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.information import Information
from stickslip.engine.law_steps import law_steps
from stickslip.engine.symbolic import numbers_of
from stickslip.inverse.identification.covariance import determined_spread
from stickslip.inverse.identification.fit_settings import FitSettings
from stickslip.inverse.identification.friction_effects import EFFECTS
from stickslip.inverse.identification.identify import problem_of
from stickslip.inverse.identification.law_forces import Stepped, _step_by_step, driven_force
from stickslip.inverse.identification.motions import PrescribedMotion, motion_of
from stickslip.inverse.identification.search import polished
from stickslip.inverse.identification.steady_problem import SteadyProblem
from stickslip.inverse.identification.uncertainty import costs, widening
from stickslip.models.friction.law_adapter import adapted

RIG, ONE = ss.presets.piezo_rig, dict(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
MU = {"mu0": (0.05, 0.5)}
BOTH = {"mu_plus": (0.02, 1.0), "mu_minus": (0.02, 1.0)}


def off(offset=0.0, drift=0.0, gain=1.0, noise=1e-3, seed=1):
    """A record of a robot with mu0 = 0.18 by a sensor that is off."""
    clean = ss.virtual_rig(RIG(**ONE), noise=noise, seed=seed)["velocity"]
    middle = 0.5 * (clean.t[0] + clean.t[-1])
    return ss.Record.of(clean.t, {"v [m/s]": gain * clean.values + offset + drift * (clean.t - middle)}, synthetic=True)


def motion(n=1500, load=10.0, speed=1.0):
    t = np.linspace(0, 2, n)
    x = 2e-4 * np.sin(2 * np.pi * speed * t) + 4e-5 * np.sin(2 * np.pi * 5 * speed * t)
    return PrescribedMotion(t, np.concatenate([[0.0], np.diff(x) / np.diff(t)]), np.broadcast_to(load, n) * 1.0, np.zeros(n), 0, False, "")


def forces(law, noise=0.02, zero=0.0, reading=None, load=10.0, seed=0, **more):
    """A record of what a law gives over a motion, as a load cell shows it."""
    m = motion(load=load, **more)
    F = driven_force(law, m, 1, reading)[:, 0] + zero + np.random.default_rng(seed).normal(scale=noise, size=len(m.t))
    x = np.concatenate([[0.0], np.cumsum(m.v[1:] * np.diff(m.t))])
    return ss.Record.of(m.t, {"x [m]": x, "F [N]": F, "N [N]": m.load}, roles={"F": "force", "N": "load"})


# velocity ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("what", "size"), [("offset", 1e-3), ("drift", 5e-3), ("gain", 1.03)])
def test_a_sensor_that_is_off_does_not_move_the_numbers(what, size):
    fit = ss.identify(off(**{what: size}), RIG, free=MU, starts=4, harmonics=0, **ONE)
    value, error = fit.sensor[what]
    low, high = fit.interval("mu0", level=0.999)
    assert low < 0.18 < high and abs(value - size) < 3.3 * error and not fit.quality[0].suspicious
    assert fit.sensor["delay"] == (0.0, np.inf)  # it is in the drive's phase


def test_a_sensor_taken_as_ideal_moves_them():
    fit = ss.identify(off(offset=1e-3), RIG, free=MU, starts=4, sensor={}, harmonics=0, **ONE)
    low, high = fit.interval("mu0", level=0.999)
    alone = fit.errors["mu0"] / widening(fit)["mu0"]  # what the error would be if the law held
    assert abs(fit.values["mu0"] - 0.18) > 4 * alone and "offset" not in fit.sensor
    assert low < 0.18 < high and fit.quality[0].suspicious


@pytest.fixture(scope="module")
def fit():
    return ss.identify(off(), RIG, free=MU, starts=4, harmonics=0, **ONE)


def test_parts_of_an_interval_add_up_in_squares(fit):
    ends = {part: np.array(fit.interval("mu0", part=part)) for part in ("total", "statistical", "systematic")}
    half = {part: abs(end - fit.values["mu0"]) for part, end in ends.items()}
    assert half["statistical"] ** 2 + half["systematic"] ** 2 == pytest.approx(half["total"] ** 2, rel=1e-9)
    assert half["systematic"].min() > half["statistical"].max() > 0
    ideal = ss.identify(off(), RIG, free=MU, starts=4, sensor={}, harmonics=0, **ONE)
    assert ideal.errors["mu0"] == pytest.approx(np.mean(half["statistical"]) / 1.96, rel=0.05)  # at another place of the sensor
    with pytest.raises(InputError, match="part = 'both'"):
        fit.interval("mu0", part="both")


def test_the_report_says_what_a_sensor_costs(fit):
    text, each = fit.report(), costs(fit)
    assert "with the sensor known" in text and "sensor: offset = " in text
    assert each[""]["mu0"] < min(each[what]["mu0"] for what in ("offset", "gain")) < fit.errors["mu0"]


def test_three_ways_to_an_interval_agree_with_a_sensor_beside(fit):
    """The bootstrap resamples what is known of the gain too; 200 repeats know the end of an interval to a tenth of its length."""
    by = {m: np.array(fit.interval("mu0", method=m)) for m in ("covariance", "profile")}
    by["bootstrap"] = np.array(fit.interval("mu0", method="bootstrap", repeats=200, seed=1))
    width = np.ptp(by["covariance"])
    assert abs(by["profile"] - by["covariance"]).max() < 0.1 * width
    assert abs(by["bootstrap"] - by["covariance"]).max() < 0.3 * width


def test_a_speed_measured_otherwise_gives_back_what_a_free_offset_takes(fit):
    speed = ss.analysis.periodic_mean_velocity(RIG(**ONE))
    beside = ss.identify([off(), ("normal", speed, 1e-6)], RIG, free=MU, starts=4, harmonics=0, **ONE)
    zero = ss.identify(off(), RIG, free=MU, starts=4, sensor={"offset": 0.0, "drift": None, "gain": None}, harmonics=0, **ONE)
    assert set(beside.sensor) == {"offset", "drift", "gain", "delay"}
    assert beside.errors["mu0"] < 0.8 * fit.errors["mu0"] and abs(beside.values["mu0"] - 0.18) < 3.3 * beside.errors["mu0"]
    assert zero.errors["mu0"] == pytest.approx(costs(fit)["offset"]["mu0"], rel=0.1) and zero.sensor["offset"] == (0.0, 0.0)
    with pytest.raises(InputError, match=r"does not say how sure it is; type \(\"normal\", 0.002"):
        ss.identify([off(), 0.002], RIG, free=MU, harmonics=0, **ONE)


def test_what_is_known_of_a_number_beforehand_is_a_part_of_its_error():
    """An amplitude read to 2 %: with all else ideal mu0 is then known to what the amplitude leaves."""
    known = {k: v for k, v in ONE.items() if k != "amplitude"}
    fit = ss.identify(off(), RIG, free={**MU, "amplitude": (6.1e-4, "2%")}, starts=8, sensor={}, harmonics=0, **known)
    alone = ss.identify(off(), RIG, free=MU, starts=4, sensor={}, harmonics=0, **ONE)
    low, high = fit.interval("mu0", level=0.999)
    assert low < 0.18 < high and fit.errors["amplitude"] < 1.25e-5
    assert np.ptp(fit.interval("mu0", part="statistical")) == pytest.approx(np.ptp(alone.interval("mu0")), rel=0.1)


def test_everything_wrong_with_a_sensor_is_said_at_once():
    with pytest.raises(InputError) as error:
        ss.identify(off(), RIG, free=MU, sensor={"ofset": 0.0, "inertia": 0.1, "gain": "much", "drift[3]": 0.0}, harmonics=0, **ONE)
    told = "\n".join(error.value.problems)
    assert len(error.value.problems) == 4 and "did you mean 'offset'" in told and "inertia belongs to records of force" in told
    assert "gain = 'much'; allowed is a number that holds it" in told and "drift[3] names record 3" in told
    with pytest.raises(InputError, match="allowed is None, or a dict of offset"):
        ss.identify(off(), RIG, free=MU, sensor="ideal", harmonics=0, **ONE)
    with pytest.raises(InputError, match="offset of record 0 is named twice"):
        ss.identify(off(), RIG, free=MU, sensor={"offset": 0.0, "offset[0]": None}, harmonics=0, **ONE)


# forces -----------------------------------------------------------------------------------------------------------


def test_a_zero_of_a_load_cell_does_not_say_which_way_there_is_more_friction():
    """0.30 forwards and 0.31 backwards under 50 N, and a zero of 1 N: taken as ideal, it is the other way round."""
    record = forces(ss.Coulomb(0.30, 0.31), zero=1.0, load=50.0)
    ideal, fit = (ss.identify(record, ss.Coulomb, free=BOTH, starts=4, sensor=sensor) for sensor in ({}, None))
    assert ideal.values["mu_plus"] > ideal.values["mu_minus"] + 5 * ideal.errors["mu_plus"]
    assert fit.undetermined == ("mu_plus", "mu_minus") and fit.sensor["offset"] == (0.0, np.inf)
    ((formula, value, error),) = fit.combinations
    assert formula == "mu_plus + mu_minus" and abs(value - 0.61) < 4 * error < 0.06
    assert np.isfinite(fit.interval("mu_plus", part="statistical")).all()
    (advice,) = (w for w in fit.warnings if "if the sensor is calibrated" in w)
    typed = advice.partition("type sensor=")[2].partition("}")[0] + "}"
    known = eval(typed) | {"offset": ("normal", 0.0, 0.8)}  # the advice, with what is known of the zero
    again = ss.identify(record, ss.Coulomb, free=BOTH, starts=4, sensor=known)
    for name, truth in (("mu_plus", 0.30), ("mu_minus", 0.31)):
        low, high = again.interval(name)
        assert low < truth < high and 0.01 < again.errors[name] < 0.03  # 0.8 N of 50 N is 0.016


def test_preload_inertia_and_delay_are_found():
    """A load that varies tells a preload, and fast motion an inertia; the delay is three samples."""
    load = 10.0 + 3.0 * np.sin(2 * np.pi * 0.7 * np.linspace(0, 2, 1500))
    law = ss.LuGre(0.3, 0.4, None, None, sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1.0)
    m, step = motion(load=load), 2 / 1499
    clean = driven_force(law, m, 1, {"preload": np.array([2.0])})[:, 0] + 0.5 * m.acceleration
    t, x = m.t, np.concatenate([[0.0], np.cumsum(m.v[1:] * np.diff(m.t))])
    F = np.interp(t - 3 * step, t, clean - 0.5 * m.acceleration) + 0.5 * m.acceleration
    F = F + np.random.default_rng(0).normal(scale=0.01, size=len(t))
    record = ss.Record.of(t, {"x [m]": x, "F [N]": F, "N [N]": load}, roles={"F": "force", "N": "load"})
    free = {**BOTH, "sigma0": (1e4, 1e6, "log")}
    sensor = {"preload": ("uniform", 0.0, 10.0), "inertia": None, "delay": None}
    fit = ss.identify(record, ss.LuGre, free=free, starts=16, sensor=sensor, f_plus=None, f_minus=None, sigma1=0.0, sigma2=0.0, v_s=1.0)
    for name, truth in (("preload", 2.0), ("inertia", 0.5), ("delay", 3 * step)):
        value, error = fit.sensor[name]
        assert abs(value - truth) < 4 * error and error < 0.3 * truth
    assert abs(fit.values["mu_plus"] - 0.3) < 4 * fit.errors["mu_plus"]


@pytest.mark.parametrize(
    "law", [ss.Coulomb.example(), ss.LuGre.example(), ss.friction.ElastoPlastic.example()], ids=lambda law: type(law).__name__
)
def test_derivatives_by_all_numbers_of_a_sensor_are_those_of_differences(law):
    record = forces(law, load=10.0 + np.sin(np.linspace(0, 9, 300)), n=300)
    known = {f.name: getattr(law, f.name) for f in dataclasses.fields(law)}
    sensor = {"offset": None, "drift": None, "gain": None, "delay": None, "preload": None, "inertia": None}
    problem = problem_of([record], type(law), {"mu_plus": (0.1, 0.3)}, None,
                         {k: v for k, v in known.items() if k != "mu_plus"}, FitSettings(sensor=sensor))  # fmt: skip
    place = np.array([0.37, 0.05, -0.02, 1.01, 2e-3, 0.3, 20.0])
    found, held = problem.jacobian(place), np.isclose(problem.predicted(place), problem.y, rtol=0, atol=0)
    steps = np.array([1e-6, 1e-6, 1e-6, 1e-6, 1e-7, 1e-5, 1e-4])
    for k, h in enumerate(steps):
        up, down = place + h * np.eye(7)[k], place - h * np.eye(7)[k]
        wanted = (problem.residuals(up) - problem.residuals(down)) / (2 * h)
        rows = np.append(~held, np.ones(len(found) - len(held), bool))
        away = abs(found[rows, k] - wanted[rows])
        part, close = (0.5, 2e-2) if k == 4 else (0.9, 2e-4)  # a delay moves along straight lines between samples, with kinks at them
        assert np.quantile(away, part) < close * np.sqrt(np.mean(wanted**2)) + 1e-6


def forces_of(record, place, **numbers):
    """What a sensor shows of a law at a place: the fit's problem, and its values."""
    problem = problem_of([record], ss.Coulomb, {"mu_plus": (0.1, 0.2)}, None, {"mu_minus": 0.2}, FitSettings(load=10.0, sensor=numbers))
    return problem, problem.predicted(np.array([0.5, *place]))


def test_a_contact_at_rest_bears_what_the_sensor_did_not_add():
    """Friction of 1.5 N forwards under a zero of 0.5 N: at rest 2 N are shown at most, and whatever is below is met."""
    t, F = np.arange(40.0), np.concatenate([np.full(20, 2.0), np.tile([1.0, 1.5, 1.9, 3.0], 5)])
    record = ss.Record.of(t, {"x [m]": np.minimum(t, 19.0), "F [N]": F})  # a slide, then a rest
    _, shown = forces_of(record, (), offset=0.5)
    assert shown[20:].tolist() == np.tile([1.0, 1.5, 1.9, 2.0], 5).tolist()


def test_a_delayed_sensor_shows_any_force_between_those_of_a_slide_and_of_a_rest():
    """A slide of 1.5 N, then a rest: half a sample late its first sample shows 0.75 N and half of what is borne, -2 to 1.5 N."""
    t = np.arange(24.0)
    x, F = np.minimum(t, 10.0), np.where(t <= 10, 1.5, 0.0)
    F[11] = 0.4
    problem, shown = forces_of(ss.Record.of(t, {"x [m]": x, "F [N]": F}), (0.5,), delay=("uniform", -1.0, 1.0))
    least, most = problem.ends(np.array([[0.5, 0.5]]))
    assert [least[11, 0], most[11, 0], shown[11]] == pytest.approx([-0.25, 1.5, 0.4])
    assert not problem.jacobian(np.array([0.5, 0.5]))[11].any()  # so that nothing is learned from it


def shortened(record, kept):
    """A record with some of its samples."""
    columns = {f"{c} [{unit}]": np.array(record[c].values[kept]) for c, unit in (("x", "m"), ("F", "N"), ("N", "N"))}
    return ss.Record.of(record["x"].t[kept], columns, roles={"F": "force", "N": "load"})


def test_after_a_gap_a_record_says_nothing_until_the_contact_has_slid():
    """A bristle that may come from either side: the ends are 2 mu N apart, and together once it has slid for its length several times."""
    law = ss.LuGre(0.3, 0.4, None, None, sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1.0)
    whole = forces(law, noise=0.0)
    kept = (np.arange(1500) < 700) | (np.arange(1500) >= 900)
    record = shortened(whole, kept)
    free, known = {**BOTH, "sigma0": (1e4, 1e6, "log")}, dict(f_plus=None, f_minus=None, sigma1=0.0, sigma2=0.0, v_s=1.0)
    problem = problem_of([record], ss.LuGre, free, None, known, FitSettings(sensor={}))
    unbent = problem.parameters.point({"mu_plus": 0.3, "mu_minus": 0.4, "sigma0": 1e5})
    least, most = (end[:, 0] for end in problem.ends(unbent[None]))
    assert np.array_equal(least[:700], most[:700]) and most[700] - least[700] == pytest.approx(7.0, rel=0.05)
    assert (least <= record["F"].values + 1e-9).all() and (record["F"].values <= most + 1e-9).all() and (most - least)[1200:].max() < 1e-6
    fit = ss.identify(record, ss.LuGre, free=free, starts=8, sensor={}, **known)
    assert [fit.values[n] for n in free] == pytest.approx([0.3, 0.4, 1e5], rel=1e-3)


def test_the_motion_counts_where_a_force_is_missing():
    """The same samples without their forces: the motion goes on, so that the rest is as before, to the last digit."""
    law = ss.LuGre(0.3, 0.4, None, None, sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1.0)
    whole = forces(law, noise=0.0)
    some = dataclasses.replace(whole["F"], values=np.where(abs(np.arange(1500) - 800) < 100, np.nan, whole["F"].values))
    seen = motion_of(ss.Record({**whole.channels, "F": some}), None, "record")
    assert seen.count == 1301 and not seen.gaps.any() and "199 miss a value" in seen.cut
    assert np.array_equal(driven_force(law, seen), driven_force(law, motion_of(whole, None, "record")))


@pytest.mark.parametrize(
    "name", [name for name, law in ss.friction.LAWS.items() if adapted(law.example()).dynamic and not adapted(law.example()).random]
)
def test_compiled_steps_are_those_in_plain_python(name):
    """Of three cases at once, with loads of their own; the plain ones take the slopes of rates from differences."""
    m, law = motion(400), adapted(ss.friction.LAWS[name].example())
    gains = np.array([1.0, 0.7, 1.3])
    law = adapted(replace_leaf(law.law, {key: value * gains for key, value in leaves(law.law) if key in numbers_of(law.law)[:1]}))
    load, given, steps = m.load[:, None] * gains, m.force[:, None], np.diff(m.t, prepend=m.t[0])
    start = np.array([np.broadcast_to(part, 3) for part in law.start(load[0])], float).reshape(law.states, 3)
    plain, end = _step_by_step(law, Stepped(m.t, m.v, m.v), load, given, start, steps)
    reached = start.copy()
    compiled = law_steps(law)(law, steps, m.v, m.v, load, given, reached)
    assert abs(compiled - plain).max() < 1e-6 * abs(plain).max() and np.allclose(reached, end, rtol=1e-6, atol=1e-12)


def test_a_law_of_chance_is_not_fitted():
    law = dict(mu_minus=0.3, sigma0=1e5)
    with pytest.raises(InputError, match="Bristle cannot be fitted"):
        ss.identify(forces(ss.Dahl(0.3, 0.4, 1e5)), ss.friction.Bristle, free={"mu_plus": (0.1, 1.0)}, load=10.0, **law)


def test_a_law_for_plain_numbers_is_followed_in_plain_python():
    class Plain(ss.Dahl):
        scalar_only = True

    plain, law = Plain(0.3, 0.4, 1e5), ss.Dahl(0.3, 0.4, 1e5)
    assert law_steps(adapted(plain)) is None and law_steps(adapted(law)) is not None
    assert np.allclose(driven_force(plain, motion(60)), driven_force(law, motion(60)), rtol=1e-6)


def test_a_preload_leaves_a_normal_force():
    """A force that no friction can give, beside a position that only rises: a fit, and no overflow where the load would be gone."""
    t = np.arange(0, 6, 0.005)
    record = ss.Record.of(t, {"x [mm]": t, "F [mN]": 0.25 * np.sin(np.pi * t) + 0.02 * np.sin(3.4 * np.pi * t)})
    law = dict(f_plus=None, f_minus=None, sigma1=0.0, sigma2=0.0, v_s=2e-4)
    sensor = {"offset": None, "preload": ("normal", 1.5, 0.1)}
    fit = ss.identify(record, ss.LuGre, free={**BOTH, "sigma0": (1e4, 1e6, "log")}, load=5.0, starts=4, sensor=sensor, **law)
    assert fit.sensor["preload"][0] > -5.0 and np.isfinite(fit.cost)


def begun_sliding(law, seed=1):
    """Forces over a motion that does not repeat, of a contact that slides where the record begins."""
    t, rng = np.linspace(0, 4, 1600), np.random.default_rng(seed)
    x = 2e-4 * (np.sin(2 * np.pi * t) + 0.2 * np.sin(2 * np.pi * 2.7 * t))
    v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
    F = driven_force(law, PrescribedMotion(t, v, np.full(len(t), 10.0), np.zeros(len(t)), 0, False, ""))[:, 0] + rng.normal(0, 0.02, len(t))
    return ss.Record.of(t[410:] - t[410], {"x [m]": x[410:], "F [N]": F[410:]})


def test_a_motion_that_does_not_repeat_is_not_led_in_and_its_start_is_fitted():
    """With the first period as a lead, or unbent, what is left was fifteen times the noise."""
    rest = {"f_plus": 0.35, "f_minus": 0.3, "sigma1": 0.0, "sigma2": 0.0, "v_s": 1e-3}
    law = ss.LuGre(0.3, 0.25, sigma0=6e4, **rest)
    record = begun_sliding(law)
    assert motion_of(record, 10.0, "record 0").before == 0
    known = {"sensor": {"gain": 1.0, "offset": 0.0}, "free": {**BOTH, "sigma0": (1e4, 1e6, "log")}, **rest}
    fit = ss.identify(record, ss.LuGre, load=10.0, starts=8, transient=True, **known)
    assert all(abs(fit.values[name] - getattr(law, name)) < 4.5 * fit.errors[name] for name in fit.names)
    assert fit.quality[0].rms == pytest.approx(0.02, rel=0.1) and 0.5 < fit.sensor["start[0]"][0] < 1.2


def test_a_load_cell_does_not_make_up_for_what_a_law_lacks():
    """A Dahl law of the wrong shape: the numbers are those of an ideal sensor, with intervals that count that it may not be."""
    record = forces(ss.LuGre(0.3, 0.4, None, None, sigma0=3e4, sigma1=0.0, sigma2=0.0, v_s=1.0))
    free, fixed = {**BOTH, "sigma0": (1e4, 1e6, "log")}, {"exponent": 2.0}
    fit, ideal = (ss.identify(record, ss.Dahl, free=free, starts=8, sensor=sensor, transient=True, **fixed) for sensor in (None, {}))
    assert fit.values == pytest.approx(ideal.values, rel=1e-2) and any(
        "cannot be distinguished from defects of the law" in note for note in fit.notes
    )
    assert fit.errors["mu_plus"] > 1.3 * ideal.errors["mu_plus"]


@pytest.mark.parametrize("law", [ss.Coulomb(0.3, 0.4), ss.LuGre(0.3, 0.4, None, None, sigma0=3e5, sigma1=0.0, sigma2=0.0, v_s=1.0)],
                         ids=["Coulomb", "another law"])  # fmt: skip
def test_a_zero_far_beyond_what_friction_can_make_up_for_is_found(law):
    """50 N beside a friction of 3 and 4 N, of which bounds allow 10: no ideal sensor would do, of whatever law the record is."""
    fit = ss.identify(forces(law, zero=50.0), ss.Coulomb, free=BOTH, starts=8)
    ideal = ss.identify(forces(law), ss.Coulomb, free=BOTH, starts=8, sensor={})
    assert fit.undetermined == ("mu_plus", "mu_minus") and fit.sensor["offset"][1] == np.inf
    assert sum(fit.values.values()) == pytest.approx(sum(ideal.values.values()), rel=0.05) and fit.cost < 1.001 * ideal.cost
    assert fit.sensor["offset"][0] + 10 * fit.values["mu_plus"] == pytest.approx(50 + 10 * ideal.values["mu_plus"], abs=0.1)


# how sure ---------------------------------------------------------------------------------------------------------


AMPLITUDES = [5e-4, 8e-4]
TRUTH = {"mu0": 0.18, "f0": 0.21, "v_s": 2e-3, "sigma2": 0.04}


@pytest.fixture(scope="module")
def hidden():
    """The fit of what another place of its parameters fits as well, to a per cent: mu0 is off by ten standard errors there."""
    records = [ss.virtual_rig(RIG(tilt_deg=1.7, amplitude=A), noise=1e-3, seed=i) for i, A in enumerate(AMPLITUDES)]
    free = {"mu0": (0.05, 0.5), "f0": (0.05, 0.6), "v_s": (2e-4, 2e-2, "log"), "sigma2": (0.0, 1.0)}
    return ss.identify(records, RIG, free=free, tilt_deg=1.7, amplitude=AMPLITUDES)


@pytest.mark.slow
def test_a_search_goes_on_where_nothing_but_noise_is_left(hidden):
    near = polished(hidden.problem, hidden.problem.aligned(hidden.problem.parameters.point(TRUTH)))
    assert hidden.cost < near.cost + 0.1 * hidden.scale**2


@pytest.mark.slow
def test_intervals_hold_the_truth_where_nothing_but_noise_is_left(hidden):
    for name in ("mu0", "f0", "v_s"):
        low, high = hidden.interval(name, 0.999)
        assert low < TRUTH[name] < high


def squared(a):
    return ss.Coulomb(a**2, a**2)


def test_an_interval_is_by_profile_where_the_sum_of_squares_is_no_parabola():
    """A coefficient that is the square of the number: near zero its interval is that of its square, not symmetric."""
    record, free = forces(ss.Coulomb(2e-4, 2e-4), n=400, noise=0.05, seed=1), {"a": (0.0, 0.3)}
    fit = ss.identify(record, squared, free=free, using="force", starts=8, sensor={}, load=10.0)
    plain = ss.identify(record, lambda mu: ss.Coulomb(mu, mu), free={"mu": (0.0, 0.09)}, using="force", starts=8, sensor={}, load=10.0)
    low, high = fit.interval("a")
    assert fit.bent == ("a",) and plain.bent == () and fit.interval("a") != fit.interval("a", method="covariance")
    assert [low**2, high**2] == pytest.approx(plain.interval("mu"), rel=0.02, abs=2e-6)
    assert plain.interval("mu") == plain.interval("mu", method="covariance")
    # a friction times an unknown gain is known a hundred times better than either: the other follows, along no straight line
    record, free = forces(ss.Coulomb(0.2, 0.2), n=400, noise=1e-3, seed=1), {"mu": (0.0, 0.5)}
    known = {"gain": ("normal", 1.0, 0.02)}
    gained = ss.identify(record, lambda mu: ss.Coulomb(mu, mu), free=free, using="force", starts=8, sensor=known, load=10.0)
    assert gained.errors["mu"] == pytest.approx(0.02 * gained.values["mu"], rel=0.02) and gained.bent == ()


class _Linear:
    """A problem of straight lines."""

    resolution, parameters, nuisances = 1e-9, type("P", (), {"free": ()})(), 0

    def __init__(self, count):
        self.targets = [type("T", (), {"count": count, "weight": 1.0, "given_sigma": False, "within": 0.0})()]
        self.y, self.sigma, self.parts = np.zeros(count), np.ones(count), lambda each: [each]


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8])
def test_coloured_noise_widens_intervals_by_its_own_covariance(rho):
    """Beside the exact covariance of least squares, P Omega P', for a record of 4000 values: a realisation tells it to some per cent."""
    rng, n = np.random.default_rng(3), 4000
    t = np.linspace(-1, 1, n)
    J = np.stack([np.ones(n), t, np.sin(9 * t)], axis=1)
    rest = np.empty(n)
    rest[0] = rng.normal()
    for k in range(1, n):
        rest[k] = rho * rest[k - 1] + np.sqrt(1 - rho**2) * rng.normal()
    P, omega = np.linalg.pinv(J), rho ** abs(np.subtract.outer(np.arange(n), np.arange(n)))
    rest = rest - J @ (P @ rest)
    found = determined_spread(_Linear(n), J, rest, float(np.std(rest)))
    assert np.sqrt(np.diag(found)) == pytest.approx(np.sqrt(np.diag(P @ omega @ P.T)), rel=0.2 if rho else 0.05)


def test_what_is_known_beforehand_determines_what_data_leave_open():
    """Two numbers of which the data know the sum, to 1; one is known to 0.1 besides: the other is then known to 1.005."""
    found = Information(np.array([[1.0, 1.0]]), prior=np.array([[10.0, 0.0]]))
    assert found.errors().tolist() == pytest.approx([0.1, np.hypot(1.0, 0.1)], rel=1e-12)
    tiny = Information(1e9 * np.array([[1.0, 1.0]]), prior=np.array([[1e-3, 0.0]]))  # however small it is beside the data
    assert tiny.errors()[0] == pytest.approx(1e3, rel=1e-6)
    assert Information(np.array([[1.0, 1.0]]), prior=np.zeros((0, 2))).undetermined.all()


# what a record cannot tell ----------------------------------------------------------------------------------------

FORMULAS = {
    "a*b": (lambda a, b: a * b, {"a": 0.4, "b": 0.6}),
    "a + b": (lambda a, b: a + b, {"a": 0.1, "b": 0.15}),
    "a/b": (lambda a, b: a / b, {"a": 0.5, "b": 1.6}),
    "a/(a + b)": (lambda a, b: a / (a + b), {"a": 0.5, "b": 1.6}),
    "a - b": (lambda a, b: a - b, {"a": 0.6, "b": 0.25}),
    "(a + b)*c": (lambda a, b, c: (a + b) * c, {"a": 0.3, "b": 0.5, "c": 0.4}),
    "a*b + c": (lambda a, b, c: a * b + c, {"a": 0.3, "b": 0.5, "c": 0.1}),
    "a + 0.37*b": (lambda a, b: a + 0.37 * b, {"a": 0.2, "b": 0.3}),
    "a**(-1) + b**(-1)": (lambda a, b: 1 / (1 / a + 1 / b), {"a": 0.6, "b": 0.9}),
}


@pytest.mark.parametrize("formula", FORMULAS)
def test_the_combination_that_data_determine_is_named(formula):
    """Friction of a law whose coefficient is a formula of the numbers: it, or one that says the same, has the truth within its error."""
    function, truth = FORMULAS[formula]
    law = lambda **numbers: ss.Coulomb(function(**numbers), 1.3 * function(**numbers))  # noqa: E731
    free = {name: (0.2 * value, 3 * value) for name, value in truth.items()}
    fit = ss.identify(forces(law(**truth), n=300), _named(law, truth), free=free, starts=8, using="force")
    assert fit.undetermined == tuple(truth)
    found = {text: (value, error) for text, value, error in fit.combinations}
    scale = [(eval(text, {}, truth), value, error) for text, (value, error) in found.items()]
    assert scale and all(abs(true - value) < 4 * error for true, value, error in scale), found
    assert any(text in warning for text in found for warning in fit.warnings)
    assert all(each.holds for each in fit.determined)
    if formula not in ("a/b", "a/(a + b)", "a + 0.37*b", "a**(-1) + b**(-1)"):  # a function of another, or with rounded weights
        assert list(found) == [formula]


def test_a_formula_that_holds_near_the_fitted_values_only_is_told_so():
    """No sum, product or ratio of a and b is constant where a exp(4 b) is."""
    law = lambda a, b: ss.Coulomb(a * np.exp(4 * b), 1.3 * a * np.exp(4 * b))  # noqa: E731
    fit = ss.identify(forces(law(0.1, 0.3), n=300, noise=1e-3), law, free={"a": (0.02, 0.5), "b": (0.05, 0.9)}, starts=8, using="force")
    ((formula, value, error),) = fit.combinations
    assert not fit.determined[0].holds and any("near the fitted values" in w and formula in w for w in fit.warnings)
    assert eval(formula, {}, fit.values) == pytest.approx(value, rel=1e-3) and error < 0.05 * value  # weights have four digits


def _named(law, truth):
    names = ", ".join(truth)
    return eval(f"lambda {names}: law({', '.join(f'{n}={n}' for n in truth)})", {"law": law})


def test_fixing_one_of_them_as_advised_determines_the_other():
    robot = RIG(**ONE)
    free = {"body_mass": (0.02, 0.2), "inner_mass": (0.002, 0.05)}
    lost = ss.identify(off(), robot, free=free, starts=4)
    ((formula, value, error),) = lost.combinations
    assert formula == "inner_mass/(body_mass + inner_mass)" and abs(value - 0.00948 / 0.07207) < 4 * error
    assert any("fix one of them" in w for w in lost.warnings) and any(formula in w for w in lost.warnings)
    found = ss.identify(off(), robot, free={"inner_mass": free["inner_mass"]}, starts=4)
    assert found.undetermined == () and found.combinations == []
    slope = robot.body_mass / (robot.body_mass + found.values["inner_mass"]) ** 2
    assert found.errors["inner_mass"] * slope == pytest.approx(error, rel=0.05)


# ranking ----------------------------------------------------------------------------------------------------------


def test_no_law_is_supported_whose_residuals_have_a_shape_or_whose_numbers_sit_at_bounds():
    record = forces(ss.Stribeck(0.2, 0.25, 0.4, 0.45, v_s=5e-4))
    wrong = {
        "Coulomb": ss.identify(record, ss.Coulomb, free=BOTH, starts=4),
        "viscous": ss.identify(record, ss.CoulombViscous, free={**BOTH, "viscous": (0.0, 500.0)}, starts=4),
    }
    found = ss.identification.rank(wrong)
    assert found.supported == () and not found.decided and "no law fits" in found.verdict and "correlated" in found.reason
    free = {**BOTH, "f_plus": (0.02, 1.0), "f_minus": (0.02, 1.0), "v_s": (1e-5, 1e-2, "log")}
    right = ss.identify(record, ss.Stribeck, free=free, starts=16)
    assert ss.identification.rank({**wrong, "Stribeck": right}).supported == ("Stribeck",)
    narrow = ss.identify(record, ss.Stribeck, free={**free, "v_s": (6e-4, 1e-2, "log")}, starts=16)
    bound = ss.identification.rank({**wrong, "Stribeck": narrow})
    assert bound.supported == () and "v_s ends at its bound 0.0006" in bound.reason


@pytest.mark.parametrize("part", [0.25, 0.6, 0.95])  # while places are judged, and while steps are taken
def test_who_interrupts_a_search_gets_the_best_place_so_far(monkeypatch, part):
    calls, predicted = [0, np.inf], SteadyProblem.predicted

    def interrupted(self, place, readings=None):
        calls[0] += 1
        if calls[0] == calls[1]:
            raise KeyboardInterrupt
        return predicted(self, place, readings)

    monkeypatch.setattr(SteadyProblem, "predicted", interrupted)
    ss.identify(off(), RIG, free=MU, **ONE)
    calls[:] = [0, int(part * calls[0])]
    fit = ss.identify(off(), RIG, free=MU, **ONE)
    assert fit.stopped and any("interrupted" in note for note in fit.notes) and abs(fit.values["mu0"] - 0.18) < 0.05
    assert ss.identification.rank({"a": fit, "b": fit}).supported == ()


# nesting ----------------------------------------------------------------------------------------------------------

STATIC = {"f_plus": (0.02, 1.0), "f_minus": (0.02, 1.0)}
BRISTLE = {"sigma0": (1e4, 1e6, "log")}
FREE = {  # law -> all that may be free, and what is fixed
    ss.Coulomb: ({**BOTH, **STATIC}, {}),
    ss.CoulombViscous: ({**BOTH, **STATIC, "viscous": (0.0, 500.0), "quadratic": (0.0, 1e5)}, {}),
    ss.Stribeck: ({**BOTH, **STATIC, "viscous": (0.0, 500.0)}, {"v_s": 1e-3}),
    ss.Dahl: ({**BOTH, **BRISTLE, "exponent": (0.3, 2.0)}, {}),
    ss.LuGre: ({**BOTH, **STATIC, **BRISTLE, "sigma1": (0.0, 50.0), "sigma2": (0.0, 500.0)}, {"v_s": 1e-3}),
}
NEUTRAL = {"f_plus": None, "f_minus": None, "viscous": 0.0, "quadratic": 0.0, "exponent": 1.0, "sigma1": 0.0, "sigma2": 0.0}


def nested(law):
    """Pairs of sets of free numbers of a law, the first inside the second, by the effects that are left out."""
    free, _ = FREE[law]
    groups = [names for effect in EFFECTS.values() if (names := tuple(n for n in free if n in effect))]
    sets = [frozenset(n for k, group in enumerate(groups) if bits >> k & 1 for n in group) for bits in range(2 ** len(groups))]
    return [(a, b) for a in sets for b in sets if a < b]


def cost(law, names, record):
    free, fixed = FREE[law]
    base = {n: v for n, v in free.items() if n not in NEUTRAL}
    held = {n: NEUTRAL[n] for n in free if n in NEUTRAL and n not in names}
    return ss.identify(
        record, law, free={**base, **{n: free[n] for n in free if n in names}}, starts=8, sensor={}, load=10.0, **fixed, **held
    ).cost


@pytest.mark.parametrize("law", [ss.Stribeck, pytest.param(ss.Coulomb, marks=pytest.mark.slow),
                                 *(pytest.param(law, marks=pytest.mark.slow) for law in (ss.CoulombViscous, ss.Dahl, ss.LuGre))],
                         ids=lambda law: law.__name__)  # fmt: skip
def test_a_larger_law_never_fits_worse_than_one_inside_it(law):
    """Over all pairs, to records of the law itself and of another; equal where the larger one has nothing to add."""
    truths = [ss.LuGre(0.3, 0.4, 0.4, 0.5, sigma0=1e5, sigma1=5.0, sigma2=100.0, v_s=5e-4), law.example()]
    for truth in truths:
        record = forces(truth, n=400, noise=0.05)
        found = {names: cost(law, names, record) for names in {names for pair in nested(law) for names in pair}}
        worse = [(sorted(a), sorted(b), found[b] / found[a]) for a, b in nested(law) if found[b] > found[a] * (1 + 1e-6)]
        assert not worse
