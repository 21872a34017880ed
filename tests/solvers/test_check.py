"""`check`: its verdict is right, and it says what it knows."""

from __future__ import annotations

import json

import numpy as np
import pytest

import kinds
import stickslip as ss
from rows import each_row
from stickslip.analysis import checking
from stickslip.analysis.checking import check


@pytest.fixture(scope="module")
def lugre():
    return check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4), rk4_steps=(2000, 10_000))


@pytest.fixture(scope="module")
def coulomb():
    return check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), rk4_steps=(2000,))


def test_the_certain_digits_are_right(lugre, coulomb):
    """TRUTH P1, to the digits printed there."""
    assert lugre.digits >= 6 and f"{lugre.mean_velocity:.5e}" == f"{0.001741322:.5e}"
    assert coulomb.digits >= 9 and coulomb.mean_velocity == pytest.approx(0.002014682, abs=5e-10)


def test_uncertainty_covers_the_true_error(lugre):
    assert abs(lugre.mean_velocity - lugre.best) <= lugre.uncertainty < 1e-6 * lugre.best


def test_every_judge_is_asked(lugre, coulomb):
    assert [j.name for j in lugre.judges] == ["Taylor12"] * 4 + ["scipy lsoda"] + ["RK4"] * 2
    assert [j.name for j in coulomb.judges] == ["exact arcs", "closed formula", "scipy dop853", "RK4"]
    assert all(np.isfinite(j.mean_velocity) and j.seconds >= 0 for j in lugre.judges + coulomb.judges)


def test_fixed_steps_are_shown_but_do_not_count(coulomb):
    rk4 = coulomb.judges[-1]
    assert not rk4.counts and abs(rk4.difference) > 1e3 * coulomb.uncertainty


def test_a_naive_script_that_errs_is_named():
    told = check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.03), periods=60, rk4_steps=(2000,), scipy=False)
    assert "Runge-Kutta with 2000 steps per period would have given -" in told.verdict


def test_a_robot_at_rest_has_no_digits():
    told = check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-6, law="coulomb"), periods=10, rk4_steps=())
    assert told.mean_velocity == 0.0 and told.digits == 0 and "no net motion" in told.verdict and "exactly zero" in told.verdict


def test_the_judges_that_count_are_named(lugre, coulomb):
    assert "certain: our ladder and scipy agree to" in lugre.verdict
    assert "certain: our exact arcs, the closed formula and scipy agree to" in coulomb.verdict
    assert str(lugre).count("The RK4 rows show what fixed steps give; they do not count.") == 1
    assert lugre.rows()[0][4] == "difference [m/s]"
    assert [j.remark for j in lugre.judges if j.name == "scipy lsoda"] == ["against the reference over the same 6 periods"]


def test_a_run_without_a_period_promises_no_certain_digits():
    told = check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4), periods=2, rk4_steps=(), scipy=False)
    assert told.period is None and told.digits > 0 and "certain" not in told.verdict and "RK4" not in str(told)
    assert "No motion period was found" in told.verdict and "for a run of this length only" in told.verdict
    assert "the rungs of our ladder agree" in told.verdict


def test_digits_of_a_transient_mean_are_said_to_be_that_first():
    """alpha = 1e-3 takes thousands of periods to settle: the judges agree on a mean that is not that of the steady motion."""
    slow, steady = (check(ss.presets.coulomb_robot(a, 2 * a), rk4_steps=(), scipy=False) for a in (1e-3, 0.3))
    assert (
        slow.digits > 8 and abs(slow.mean_velocity - float(ss.analysis.periodic_mean_velocity(ss.presets.coulomb_robot(1e-3, 2e-3)))) > 0.1
    )
    assert "mean velocity of a transient" in slow.verdict[:60] and "transient" in str(slow).splitlines()[0]
    assert steady.transient == "" and "transient" not in str(steady)


def test_what_is_left_of_a_transient_is_said_of_a_mean_with_more_digits():
    """To 1e-6 the mean is steady; the judges agree on more digits than that, which are those of a run of this length."""
    robot = ss.presets.coulomb_robot(0.03, 0.08)
    true = float(ss.analysis.periodic_mean_velocity(robot))
    checked = [check(robot, periods=n, rk4_steps=(), scipy=False) for n in (40, 80, 160, 320, 640)]
    for told in checked:
        far = abs(told.mean_velocity - true) > 0.5 * 10.0 ** -min(told.digits, 12) * abs(true)
        assert bool(told.transient) == far, (told.mean_velocity, true, told.digits, told.transient)
    assert checked[0].transient and not checked[-1].transient


def test_a_closed_formula_that_does_not_apply_is_skipped():
    """On 20 degrees gravity wins: there is no periodic motion, and the other judges still speak."""
    slides = ss.presets.piezo_rig(tilt_deg=20, amplitude=5.525e-4, law="coulomb", incline="gravity")
    told = check(slides, periods=20, rk4_steps=(2000,))
    formula = told.judges[1]
    assert formula.remark == "skipped: a body that slides down by itself has no period" and not formula.counts
    assert [j.name for j in told.judges if np.isfinite(j.difference)] == ["exact arcs", "scipy dop853", "RK4"]
    assert told.period is None and "our exact arcs and scipy agree" in told.verdict and "certain" not in told.verdict


def test_one_judge_alone_is_sure_of_nothing():
    slides = ss.presets.piezo_rig(tilt_deg=20, amplitude=5.525e-4, law="coulomb", incline="gravity")
    told = check(slides, periods=20, rk4_steps=(), scipy=False)
    assert told.digits == 0 and np.isnan(told.uncertainty) and "no other method could confirm it" in told.verdict


def test_a_part_of_a_study_file_without_a_kind_is_told_what_to_type():
    text = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4).to_toml().replace('kind = "harmonic"\n', "")
    with pytest.raises(ss.InputError, match=r'robot\.drive\.kind is missing; type kind = "harmonic"'):
        ss.Robot.from_toml(text)


def test_it_reads_well_and_as_data(lugre, coulomb):
    text = str(lugre)
    assert "digits of the mean velocity" in text and "energy balance" in text and "note: LuGre is not passive" in text
    assert all(len(line) < 200 for line in text.splitlines())
    assert json.loads(json.dumps(coulomb.to_dict()))["digits"] == coulomb.digits
    assert "<table>" in lugre._repr_html_() and "certain" in lugre._repr_html_()
    assert coulomb.notes == ()


def test_a_batch_is_refused():
    with pytest.raises(ss.InputError, match=r"batch of shape \(2,\)"):
        check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([4e-4, 5e-4])))
    with pytest.raises(ss.InputError, match="not a robot"):
        check(3)


def test_a_forced_oscillator_is_checked_and_judges_that_cannot_are_skipped():
    bench = ss.ForcedOscillator(mass=1.0, stiffness=0.0, damping=0.0, force=1.0, omega=0.7, friction=ss.Coulomb(0.3, 0.5))
    told = check(bench, periods=20, rk4_steps=(2000,))
    assert [j.name for j in told.judges] == ["exact arcs", "closed formula", "scipy dop853", "RK4"]
    assert [j.remark.partition(":")[0] for j in told.judges if not j.counts] == ["skipped", "skipped"]
    assert told.digits >= 9 and told.period == 1 and "our exact arcs and scipy agree" in told.verdict and "do not count" not in str(told)


def test_a_robot_with_impulses_is_checked():
    told = check(kinds.robot("coulomb", "twophase"), periods=6, rk4_steps=(2000,))
    assert told.digits >= 6 and "'rk4' does not solve this Robot; Runge-Kutta steps: it knows robots without" in told.judges[-1].remark


def test_what_has_no_period_is_judged_over_a_duration():
    bench = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    with pytest.raises(ss.InputError, match=r"BlockOnBelt has no period, .*; type duration=60\.0"):
        check(bench)
    with pytest.raises(ss.InputError, match=r"duration = 3\.0, and Robot has a period; type periods=200"):
        check(kinds.robot("coulomb", "harmonic"), duration=3.0)
    told = check(bench, duration=20.0, rk4_steps=(2000,))
    assert told.mean_velocity == ss.mean_velocity(ss.solve(bench, duration=20.0))
    assert told.digits >= 8  # dop853 at 1e-11, some hundred steps
    assert {judge.name for judge in told.judges if judge.counts} == {"exact arcs", "scipy dop853"}
    assert "hold for a run of this length only" in told.verdict and "largest energy exchanged in the run" in str(told)


@each_row(("steps", "typed"), [(2000, "(2000,)"), (None, "(2000, 10000)"), ((2000, 2.5), "(2000, 10000)"), ("many", "(2000, 10000)")])
def test_steps_that_are_none_are_told_at_the_door_with_the_rest(steps, typed):
    with pytest.raises(ss.InputError) as told:
        check(3, rk4_steps=steps)
    assert len(told.value.problems) == 2 and f"type for example rk4_steps={typed}" in told.value.problems[1]


def test_the_judged_run_is_solved_once(monkeypatch):
    asked = []
    monkeypatch.setattr(checking, "solve", lambda robot, **options: asked.append(options) or ss.solve(robot, **options))
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4)
    check(robot, periods=10, rk4_steps=(), scipy=False)
    whole = [options["rtol"] for options in asked if options["periods"] == 10]
    assert whole == pytest.approx([1e-6, 1e-7, 1e-8, 1e-10], rel=1e-12)


def test_the_closed_formula_is_asked_only_where_there_is_one():
    """On a track whose friction varies a run until it repeats is not a formula."""
    told = check(kinds.robot("coulomb", "harmonic", "varying"), periods=6, rk4_steps=(), scipy=False)
    assert told.judges[1].name == "closed formula" and told.judges[1].remark.startswith("skipped")
