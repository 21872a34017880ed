"""Many cases at once: the same numbers for any number of threads, progress, stopping, study files, and periods that are none yet."""

from __future__ import annotations

import json
import math
import threading

import matplotlib

from rows import each_row

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from stickslip.analysis.closed_form import border_iii_iv
from stickslip.dynamics.attractors.period_numbers import periods_of
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_orbit
from stickslip.inverse.identification.parameters import parameters
from stickslip.show.cli import main

RIG = dict(tilt_deg=1.7, amplitude=6e-4)
FLIP = 0.0468108467  # mu0 of the upper flip at 0.6 mm


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def by_ratio(alpha_plus, k):
    """A Coulomb robot with alpha_minus = k alpha_plus."""
    return ss.presets.coulomb_robot(alpha_plus, k * alpha_plus)


# threads and progress ----------------------------------------------------------------------------------------------

VALUES = np.linspace(0.045, 0.06, 300)  # more cases than one part, so that threads have something to share


def diagram(**more):
    return ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=VALUES, settle=4, points=4, follow=False, rtol=1e-6, **RIG, **more)


def basins(**more):
    return ss.basins(ss.presets.piezo_rig(law="coulomb", **RIG), v=np.linspace(-0.02, 0.02, 300), settle=3, **more).map


def exponents(**more):
    robot = ss.presets.piezo_rig(law="coulomb", tilt_deg=1.7, amplitude=np.linspace(7e-4, 9e-4, 300))
    found = ss.dynamics.largest_exponents(robot, periods=20, settle=4, **more)
    return xr.Dataset({"exponent": ("case", found[0]), "error": ("case", found[1])})


def chaos(**more):
    grid = dict(mu0=np.linspace(0.1, 0.2, 15), amplitude=np.linspace(6e-4, 9e-4, 20))
    return ss.dynamics.chaos_map(ss.presets.piezo_rig, **grid, tilt_deg=1.7, law="coulomb", settle=6, periods=20, **more)


@pytest.mark.parametrize("many", [diagram, basins, exponents, chaos])
def test_threads_change_nothing_and_progress_counts_cases(many):
    told = []
    alone, shared = many(), many(workers=3, progress=told.append)
    assert alone.identical(shared), "not one bit differs"
    assert told and all(isinstance(now, ss.studies.Progress) and now.cases == 300 for now in told)
    assert told[-1].done == 300 and [now.done for now in told] == sorted(now.done for now in told)


@pytest.mark.parametrize("workers", [1, 2])
def test_stopping_leaves_the_rest_undone_and_says_so(workers, every_report):
    done = diagram(workers=workers, progress=lambda now: now.done < 100)
    undone = done.period.values[0] == -1
    assert undone.any() and np.isnan(done.v.values[0][undone]).all() and np.isnan(done.mean_velocity.values[0][undone]).all()
    mapped = chaos(workers=workers, progress=lambda now: False)
    assert (mapped.period == -1).all() and np.isnan(mapped.exponent).all()
    (mesh,) = ss.plot.chaos_map(mapped).collections
    assert mesh.get_array().shape == mapped.period.shape and mesh.get_array().mask.all(), "nothing was computed, so no colour is shown"
    shared_out = basins(workers=workers, progress=lambda now: False)
    assert (shared_out.attractor == -1).all() and (shared_out.period == -1).all()


def test_an_average_that_is_stopped_is_the_average_until_then(every_report):
    told = []
    robot = ss.presets.piezo_rig(law="coulomb", tilt_deg=1.7, amplitude=8e-4)
    found = ss.lyapunov(robot, periods=500, settle=20, progress=lambda now: told.append(now) or False)
    assert found.steps == 50 and told[0].cases == 500
    assert found.largest == pytest.approx(ss.lyapunov(robot, periods=50, settle=20).largest, rel=1e-12)


def test_going_up_and_down_stops_too(every_report):
    found = ss.bifurcation(
        ss.presets.piezo_rig, parameter="mu0", values=VALUES[:5], settle=2, points=2, progress=lambda now: False, law="coulomb", **RIG
    )
    assert found.period.sel(direction="up").values.tolist()[1:] == [-1] * 4
    assert found.period.sel(direction="down").values.tolist()[:4] == [-1] * 4


@each_row("workers", [1, 2])
def test_an_interrupt_ends_the_threads(workers):
    def interrupt(now):
        raise KeyboardInterrupt

    before = threading.active_count()
    found = diagram(workers=workers, progress=interrupt)
    assert "interrupted" in found.note and (found.period == -1).any()
    assert threading.active_count() == before


def test_wrong_orders_of_exponents_are_told_what_to_type():
    robot = ss.presets.piezo_rig(law="coulomb", **RIG)
    with pytest.raises(ss.InputError) as told:
        ss.dynamics.largest_exponents(robot, periods=0, settle="x", workers=0)
    assert len(told.value.problems) == 3 and "periods = 0; allowed is a whole number from 1" in str(told.value)
    with pytest.raises(ss.InputError, match="'x' is not a model"):
        ss.dynamics.largest_exponents("x")


def test_wrong_numbers_of_threads_are_told_what_to_type():
    for many in (diagram, basins, exponents, chaos):
        with pytest.raises(ss.InputError, match="workers = 0; allowed is a whole number from 1"):
            many(workers=0)


# makers ----------------------------------------------------------------------------------------------------------


def two_laws(amplitude):
    """A maker that changes the law along its parameter."""
    law = ss.friction.TanhCoulomb.example() if amplitude < 5e-4 else ss.friction.DeadBand.example()
    return ss.presets.piezo_rig(tilt_deg=0.0, amplitude=amplitude).replace(friction=law)


def two_tracks(amplitude):
    """A maker that changes a whole number along its parameter."""
    track = ss.tracks.VaryingFriction(ss.Level(), depth=0.3, harmonic=1 if amplitude < 5e-4 else 2)
    return ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude).replace(track=track)


@each_row(
    ("make", "told"),
    [(two_laws, "friction is TanhCoulomb for one and DeadBand for another"), (two_tracks, "track.harmonic is 1 for one and 2 for another")],
    ids=["law", "harmonic"],
)
def test_a_maker_of_several_kinds_is_refused_and_the_kinds_are_named(make, told):
    """Else all are computed with the equations of the first."""
    values = [4e-4, 6e-4]
    for act in (
        lambda: ss.bifurcation(make, parameter="amplitude", values=values, settle=2, points=2, follow=False),
        lambda: ss.sweep(make, amplitude=values, periods=2),
        lambda: parameters(make, {"amplitude": (4e-4, 6e-4)}, None, {}, 1).batches(np.array([[0.0], [1.0]])),
    ):
        with pytest.raises(ss.InputError, match=f"{told}; allowed is one kind; give each kind by itself"):
            act()


# maps --------------------------------------------------------------------------------------------------------------


def test_exponents_of_a_map_are_those_of_multipliers_and_of_the_tangent():
    found = ss.dynamics.chaos_map(ss.presets.piezo_rig, mu0=[0.04, 0.05], amplitude=[4e-4, 6e-4], tilt_deg=1.7, settle=200, periods=100)
    for mu0, period in ((0.04, 2), (0.05, 1)):
        here = found.sel(mu0=mu0, amplitude=6e-4)
        orbit = ss.periodic_orbit(ss.presets.piezo_rig(mu0=mu0, **RIG), period=period)
        assert int(here.period) == period
        assert float(here.exponent) == pytest.approx(math.log(abs(orbit.multipliers[0])) / period, abs=3 * float(here.error) + 1e-4)
    wild = found.sel(mu0=0.05, amplitude=4e-4)
    assert int(wild.period) == 0
    assert abs(float(wild.exponent) - 0.446) < 3 * float(wild.error), "0.453 ± 0.008 and 0.438 ± 0.006 by two other methods"


def test_rest_has_exponent_minus_infinity_on_a_map():
    found = ss.dynamics.chaos_map(ss.presets.piezo_rig, amplitude=[3e-4, 5e-4, 8e-4], tilt_deg=1.7, law="coulomb", settle=20, periods=20)
    assert found.exponent.values[:2].tolist() == [-math.inf, -math.inf] and found.period.values.tolist() == [1, 1, 1]
    assert float(found.exponent[2]) == pytest.approx(-2.418858, abs=1e-5)  # type IV: the logarithm of its multiplier
    ax = ss.plot.chaos_map(found)
    assert "amplitude" in ax.get_xlabel() and "exponent" in ax.get_ylabel()


def test_maps_are_told_what_to_type():
    rig = ss.presets.piezo_rig
    for act, words in (
        (lambda: ss.dynamics.chaos_map(rig, tilt_deg=1.7, amplitude=6e-4), "0 arguments have several values"),
        (lambda: ss.dynamics.chaos_map(rig, tilt_deg=[1.7, 1.8], amplitude=[5e-4, 6e-4], mu0=[0.1, 0.2]), "3 arguments"),
        (lambda: ss.dynamics.chaos_map(rig, tilt_deg=1.7, amplitude=[5e-4, math.nan]), "finite"),
        (lambda: ss.dynamics.chaos_map(rig, tilt_deg=1.7, amplitude=[5e-4, 6e-4], periods=3), "from 20"),
        (lambda: ss.plot.chaos_map(chaos(), quantity="speed"), "motion or exponent"),
        (lambda: ss.plot.chaos_map(chaos(), curves=[1]), "special_curve"),
    ):
        with pytest.raises(ss.InputError, match=words):
            act()


# periods that are none yet -----------------------------------------------------------------------------------------


def swinging(shrinks, periods=64):
    """Strobe points that alternate around 0, each time nearer by a factor: (1, points, 1)."""
    return (1e-5 * (-shrinks) ** np.arange(periods))[None, :, None]


def test_points_that_swing_nearer_have_no_period_two():
    assert periods_of(swinging(0.98), np.ones(1), 1e-6).tolist() == [0], "period 2 by the distance alone"
    assert periods_of(swinging(1.0), np.ones(1), 1e-6).tolist() == [2]
    assert periods_of(swinging(0.1), np.ones(1), 1e-6).tolist() == [0], "it swings at first"
    assert periods_of(swinging(0.1)[:, 8:], np.ones(1), 1e-6).tolist() == [1]


@each_row("aside", [2e-5, 2e-7, 1e-9])
def test_a_transient_beside_a_flip_has_not_period_two_however_small(aside):
    robot = ss.presets.piezo_rig(mu0=FLIP + 3e-5, **RIG)
    orbit = ss.periodic_orbit(robot, guess=[-2.577e-3, -1.8513e-7])
    points = strobe_orbit(robot, [orbit.state + np.array([aside, 0.0]), orbit.state], 96)[0]
    transient, settled = periods_of(np.moveaxis(points, 1, 0), coordinates(robot).scales).tolist()
    assert transient in (0, 1) and settled == 1


def test_no_point_of_a_map_outside_the_window_of_doubling_has_period_two():
    found = ss.dynamics.chaos_map(
        ss.presets.piezo_rig, mu0=FLIP + np.array([1e-5, 3e-5, 1e-4, 3e-4]), **RIG, settle=200, periods=20, rtol=1e-7
    )
    assert set(found.period.values.tolist()) <= {0, 1} and int(found.period[-1]) == 1


# why something ended -----------------------------------------------------------------------------------------------


def test_newton_says_why_it_failed_and_what_to_try():
    robot = ss.presets.piezo_rig(mu0=0.04, **RIG)
    with pytest.raises(ss.SolveError) as failed:
        ss.periodic_orbit(robot, period=4, guess=[5.0, 1e-3])
    assert "residual" in str(failed.value) and "iterations" in str(failed.value), "why"
    assert "guess=orbit of a robot nearby" in str(failed.value) and "ss.continuation" in str(failed.value), "what to try"
    with pytest.raises(ss.InputError, match="not finite; allowed are finite v, z"):
        ss.periodic_orbit(robot, guess=[math.nan, 0.0])


def test_a_branch_that_leaves_the_admissible_region_says_which_condition_failed():
    """Folded friction needs mu0 > tan(1.7 degrees) = 0.029680; kinetic friction may not exceed static friction, 0.21."""
    up = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.205, stop=0.25, step=0.2, **RIG)
    assert "left the admissible region beyond mu0 = 0.2" in up.ended and "allowed is f0 >= mu0" in up.ended
    assert up.values[-1] == pytest.approx(0.21, abs=1e-6) and "array" not in up.ended, "said of one robot"
    down = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.06, stop=0.02, step=0.2, law="coulomb", **RIG)
    assert "friction angle" in down.ended and down.values[-1] == pytest.approx(math.tan(math.radians(1.7)), abs=1e-6)


def test_a_curve_that_leaves_the_admissible_region_says_so():
    """The border of types III and IV where backward friction goes to zero: k = 0, below which there is no law."""
    b = ss.continuation(by_ratio, parameter="alpha_plus", start=0.7, stop=0.4, step=0.3, k=1.0)
    curve = ss.dynamics.special_curve(b, b.special[0], "k", stop=-0.5, step=0.2)
    assert "left the admissible region" in curve.ended and "mu_minus" in curve.ended
    for alpha_plus, k in curve.values:
        assert k * alpha_plus == pytest.approx(float(border_iii_iv(1 / k)), abs=1e-9), "the smaller of both, by the ratio from 1"
    assert 0 < curve.values[-1, 1] < 0.05


# commands ----------------------------------------------------------------------------------------------------------

STUDY = """\
make = "piezo_rig"

[arguments]
tilt_deg = 1.7
amplitude = 8e-4
law = "coulomb"
{arguments}
[solve]
workers = 2
samples = 500
"""


def study(folder, arguments):
    path = folder / "study.toml"
    path.write_text(STUDY.format(arguments=arguments))
    return str(path)


@pytest.mark.parametrize(
    ("command", "arguments", "words", "dims"),
    [
        ("bifurcation", 'mu0 = "0.15..0.2:3"', ["settle=5", "--batch"], {"direction": 1, "mu0": 3, "point": 64}),
        ("basins", 'v = "-0.01..0.01:3"\n', ["settle=5"], {"v": 3}),
        ("lyapunov", "mu0 = [0.15, 0.18]\n", ["settle=5", "periods=20"], {"mu0": 2}),
        ("lyapunov", "", ["settle=5", "periods=20"], {"exponent": 1, "periods": 20}),
    ],
    ids=["bifurcation", "basins", "map", "one"],
)
def test_study_files_drive_the_commands_and_results_go_to_files(capsys, tmp_path, command, arguments, words, dims):
    """What [solve] says for other commands (samples) is not an error here."""
    path = study(tmp_path, arguments)
    for ending in (".nc", ".csv", ".mat"):
        out = tmp_path / f"found{ending}"
        assert main([command, path, *words, "--out", str(out)]) == 0, capsys.readouterr().err
        assert f"written to {out}" in capsys.readouterr().out and out.stat().st_size > 100
    found = xr.load_dataset(tmp_path / "found.nc", engine="h5netcdf")
    assert dict(found.sizes) == dims
    head, *rows = (tmp_path / "found.csv").read_text().splitlines()
    assert len(rows) == math.prod(dims.values())
    assert command == "lyapunov" or "mean_velocity [m/s]" in head


def test_the_command_line_overrules_the_study_file_and_json_has_everything(capsys, tmp_path):
    path = study(tmp_path, 'mu0 = "0.15..0.2:3"\n')
    assert main(["lyapunov", path, "mu0=0.03..0.12:3:log", "settle=5", "periods=20", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["axes"]["mu0"] == pytest.approx([0.03, 0.06, 0.12]) and set(record["columns"]) >= {"period", "exponent", "error"}


def test_ranges_by_a_factor_need_numbers_of_one_sign(capsys):
    assert main(["lyapunov", "piezo_rig", "tilt_deg=1.7", "amplitude=0..1e-3:3:log"]) == 2
    assert "not a range by a factor" in capsys.readouterr().err


def test_commands_tell_how_far_they_are(capsys, monkeypatch):
    """A line now and then where nobody watches; a bar on a terminal."""
    from stickslip.basics.progress import ProgressLine

    shown = []
    monkeypatch.setattr(ProgressLine, "__call__", lambda self, now: shown.append(now.line()))
    robot = ["piezo_rig", "law=coulomb", "tilt_deg=1.7", "amplitude=8e-4"]
    assert main(["bifurcation", *robot, "mu0=0.15..0.2:3", "settle=5"]) == 0
    assert main(["basins", *robot, "v=-0.01,0.01", "settle=5"]) == 0
    assert main(["lyapunov", *robot, "settle=5", "periods=20"]) == 0
    assert [line.partition(",")[0] for line in shown].count("100 %") == 3
