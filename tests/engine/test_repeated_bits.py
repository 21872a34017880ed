"""A motion that has come back to the same bits is not computed again where only its summary is kept; nothing else changes."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import stickslip as ss
from pairs import each_once
from stickslip.engine import lanes
from stickslip.solvers import stepping

RIG = partial(ss.presets.piezo_rig, tilt_deg=1.7)
LUGRE = RIG(amplitude=6e-4).friction
MACHINES = {
    "series": RIG(amplitude=np.linspace(4e-4, 8e-4, 24)),
    "series, near flips": RIG(amplitude=6e-4, mu0=np.linspace(0.04, 0.05, 24)),
    "one case": RIG(amplitude=6e-4),
    "Taylor steps": RIG(amplitude=np.linspace(4e-4, 8e-4, 24)).replace(
        friction=ss.Stribeck(mu_plus=0.18, mu_minus=0.2, f_plus=0.21, f_minus=0.23, v_s=2e-3)
    ),
    "Rosenbrock steps": RIG(amplitude=np.linspace(5e-4, 7e-4, 4)).replace(friction=ss.friction.ElastoPlastic.example()),
    "two bodies": ss.presets.two_modules(),
}
COLUMNS = ("mean_velocity", "v_max", "v_min", "period", "periods_run", "status", "slip_forwards", "friction_power")


def both(model, monkeypatch, **asked):
    """A summary as it comes, and one for which every period is made, each with the steps that it took."""
    found, taken, run = [], [], lanes.run

    def counting(*args, **named):
        taken.append(run(*args, **named))
        return taken[-1]

    for whole in (False, True):
        with monkeypatch.context() as patch:
            patch.setattr(stepping.lanes, "Job", partial(lanes.Job, whole=whole))
            patch.setattr(stepping.lanes, "run", counting)
            found.append(ss.solve(model, keep="summary", **asked))
    return found, [int(np.sum(each.accepted)) for each in taken]


@pytest.mark.parametrize(("kind", "periods"), each_once(MACHINES, [61, 400]))
def test_a_summary_is_that_of_all_periods(kind, periods, monkeypatch):
    """To rounding of the sum of displacements; extremes, types and counts are the same."""
    (quick, slow), (few, many) = both(MACHINES[kind], monkeypatch, periods=periods, settle=40)
    assert few <= many
    for name in COLUMNS:
        if name in slow.columns:
            a, b = np.asarray(quick.columns[name]), np.asarray(slow.columns[name])
            exact = a.dtype.kind not in "f" or name.startswith("v_")
            np.testing.assert_allclose(a, b, rtol=0 if exact else 1e-11, atol=0 if exact else 1e-16, err_msg=name, equal_nan=True)


def test_long_runs_cost_no_more_than_short_ones(monkeypatch):
    """LuGre's rig is back at the same bits after some fifteen periods."""
    (quick, _), (few, many) = both(MACHINES["series"], monkeypatch, periods=400, settle=40)
    assert few < 0.15 * many and np.all(quick.columns["periods_run"] == 400)


def test_a_run_that_is_kept_has_all_its_periods():
    """Every step is there to be drawn."""
    run = ss.solve(MACHINES["one case"], periods=60, settle=40)
    assert run.t[-1] == pytest.approx(60 * run.model.period) and run.counts["steps"] > 60 * 30
