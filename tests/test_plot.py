"""Pictures of runs: what is drawn, not how it looks."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from runs import coulomb_run, lugre_run


@pytest.fixture(scope="module")
def run():
    """Type I: two rests in each period."""
    return coulomb_run(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), 20)


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_velocity_shows_the_last_periods_with_prefixes_and_rests(run):
    ax = ss.plot.velocity(run, periods=3)
    assert ax.get_ylabel() == "velocity $v$ (mm/s)" and "(ms)" in ax.get_xlabel()
    line = ax.lines[-1]
    assert line.get_xdata()[-1] == pytest.approx(3e3 * run.period_time)
    # two grids of 400 points per period miss a maximum by at most (2 pi / 400)^2 / 8 = 3e-5 of the amplitude
    assert line.get_ydata().max() == pytest.approx(1e3 * run.v[run.t > run.window[0]].max(), rel=1e-4)
    rests = sum(p.get_width() for p in ax.patches)
    assert rests == pytest.approx(3e3 * run.period_time * ss.motion(run).stick_fraction, rel=1e-9)


def test_phase_takes_the_drift_out_and_closes(run):
    ax = ss.plot.phase(run)
    s, v = ax.lines[1].get_data()
    assert s[-1] == pytest.approx(s[0], abs=1e-9 * np.ptp(s)) and v[-1] == pytest.approx(v[0], abs=1e-9 * np.ptp(v))
    assert len(ax.lines[2].get_xdata()) == 2  # the strobe point, at both ends of the period


def test_several_runs_share_the_axes_and_get_a_legend(run):
    ax = ss.plot.velocity([run, run], labels=["one", "two"])
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["one", "two"]
    with pytest.raises(ss.InputError, match="one for each run"):
        ss.plot.phase([run, run], labels=["one"])


def test_forces_show_friction_between_its_limits(run):
    ax = ss.plot.forces(run)
    limits = [line.get_ydata()[0] for line in ax.lines[:2]]
    R = ax.lines[-1].get_ydata()
    assert limits[0] * (1 + 1e-9) <= R.min() and R.max() <= limits[1] * (1 + 1e-9)


def test_a_dynamic_law_is_shaded_by_the_rule_of_motion():
    run = lugre_run(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4), 8, rtol=1e-5)
    for ax in (ss.plot.velocity(run), ss.plot.forces(run), ss.plot.phase(run)):
        ax.figure.canvas.draw()
    fraction = sum(p.get_width() for p in ss.plot.velocity(run, periods=2).patches) / (2e3 * run.period_time)
    assert fraction == pytest.approx(ss.motion(run).stick_fraction, rel=1e-6)


def test_the_caller_keeps_axes_and_settings(run):
    before = dict(matplotlib.rcParams)
    ax = plt.subplots()[1]
    assert ss.plot.velocity(run, ax=ax) is ax
    assert dict(matplotlib.rcParams) == before


def test_what_is_no_run_is_refused():
    with pytest.raises(ss.InputError, match="Trajectory"):
        ss.plot.velocity(3.0)
