"""`sweep`: a grid of keywords becomes one labelled dataset, whatever the maker can take."""

from __future__ import annotations

import inspect
import json
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from rows import each_row
from stickslip.studies import sweep

RIG = ss.presets.piezo_rig
AMPLITUDES = np.array([3e-4, 4e-4, 5e-4, 6e-4, 8e-4])


def test_coulomb_row_of_the_paper():
    """TRUTH P6, to the digits printed there."""
    grid = sweep(RIG, amplitude=AMPLITUDES, tilt_deg=1.7, law="coulomb")
    assert grid.mean_velocity.values == pytest.approx([7.88583268e-5, 9.00404579e-4, 1.686424e-3, 2.358779e-3, 4.308808e-3], rel=1e-6)
    assert grid.motion_type.values.tolist() == ["II", "I", "I", "III", "IV"]
    assert (grid.period == 1).all()


def test_a_grid_is_its_single_runs():
    """The periodic value against the window of a run that has settled."""
    grid = sweep(RIG, tilt_deg=[1.7, 2.7], amplitude=[5e-4, 6e-4], mu0=0.18)
    for tilt in (1.7, 2.7):
        for amplitude in (5e-4, 6e-4):
            run = ss.solve(RIG(tilt_deg=tilt, amplitude=amplitude))
            assert float(grid.mean_velocity.sel(tilt_deg=tilt, amplitude=amplitude)) == pytest.approx(ss.mean_velocity(run), rel=3e-6)


def test_dimensions_are_in_the_order_of_the_keywords():
    one, other = sweep(RIG, amplitude=[4e-4, 5e-4, 6e-4], tilt_deg=[0.0, 1.7], law="coulomb"), None
    other = sweep(RIG, tilt_deg=[0.0, 1.7], amplitude=[4e-4, 5e-4, 6e-4], law="coulomb")
    assert one.mean_velocity.dims == ("amplitude", "tilt_deg") and other.mean_velocity.dims == ("tilt_deg", "amplitude")
    assert np.array_equal(one.mean_velocity, other.mean_velocity.T)


def test_everything_says_its_unit_and_single_values_are_kept():
    grid = sweep(RIG, amplitude=[4e-4, 5e-4], tilt_deg=1.7, law="coulomb")
    assert grid.mean_velocity.attrs["units"] == "m/s" and grid.amplitude.attrs["units"] == "m"
    assert float(grid.tilt_deg) == 1.7 and grid.tilt_deg.attrs["units"] == "degrees"
    assert grid.attrs["law"] == "coulomb" and grid.attrs["maker"] == "piezo_rig" and "versions" in grid.attrs["provenance"]


def test_words_are_an_axis_too():
    grid = sweep(RIG, law=["lugre", "coulomb"], amplitude=[8e-4, 4e-4], tilt_deg=[2.7, 1.7])
    assert grid.mean_velocity.dims == ("law", "amplitude", "tilt_deg")
    assert grid.law.values.tolist() == ["lugre", "coulomb"] and grid.amplitude.values.tolist() == [8e-4, 4e-4]
    cell = grid.sel(law="coulomb", amplitude=4e-4, tilt_deg=1.7)
    assert float(cell.mean_velocity) == pytest.approx(9.00404579e-4, rel=1e-6)
    assert grid.status.attrs["flag_meanings"].startswith("0: finished")


def test_a_robot_is_swept_by_dotted_names():
    robot = RIG(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    grid = sweep(robot, **{"drive.amplitude": AMPLITUDES, "gravity": 9.81})
    assert grid.mean_velocity.dims == ("drive.amplitude",) and grid["drive.amplitude"].attrs["units"] == "m"
    assert grid.mean_velocity.values[1] == pytest.approx(9.00404579e-4, rel=1e-6)


def test_a_maker_that_takes_no_arrays_is_called_point_by_point():
    def maker(amplitude, tilt, double=False):
        if amplitude > 5.5e-4:
            tilt = 2 * tilt / 2
        return RIG(tilt_deg=math.degrees(math.atan(tilt)), amplitude=amplitude, law="coulomb")

    grid = sweep(maker, amplitude=[4e-4, 6e-4], tilt=[0.0, math.tan(math.radians(1.7))])
    assert grid.mean_velocity.dims == ("amplitude", "tilt")
    assert grid.mean_velocity.values[:, 1] == pytest.approx([9.00404579e-4, 2.358779e-3], rel=1e-6)
    assert abs(grid.mean_velocity.values[:, 0]).max() < 1e-12


def test_labelled_arrays_keep_their_own_dimensions():
    case = xr.DataArray([4e-4, 6e-4], dims="case", coords={"case": ["small", "large"]})
    tilt = xr.DataArray([1.7, 1.7], dims="case", coords={"case": ["small", "large"]})
    grid = sweep(RIG, amplitude=case, tilt_deg=tilt, law="coulomb")
    assert grid.mean_velocity.dims == ("case",)
    assert float(grid.mean_velocity.sel(case="large")) == pytest.approx(2.358779e-3, rel=1e-6)


def test_an_axis_that_changes_nothing_is_still_an_axis():
    grid = sweep(RIG, amplitude=[4e-4, 5e-4], f0=[0.19, 0.21, 0.25], tilt_deg=1.7, law="coulomb")  # "coulomb" does not use f0
    assert dict(grid.sizes) == {"amplitude": 2, "f0": 3}
    assert (grid.mean_velocity.std("f0") == 0).all()


def test_arguments_of_the_solver_pass_through():
    grid = sweep(RIG, amplitude=[4e-4, 5e-4], tilt_deg=1.7, law="coulomb", periods=30, settle=10, workers=2)
    assert (grid.periods_run == 30).all() and (grid.status == 0).all()


def test_a_single_point_is_a_dataset_without_dimensions():
    grid = sweep(RIG, amplitude=4e-4, tilt_deg=1.7, law="coulomb")
    assert grid.mean_velocity.shape == () and float(grid.mean_velocity) == pytest.approx(9.00404579e-4, rel=1e-6)


def test_a_sweep_survives_a_file(tmp_path):
    grid = sweep(RIG, law=["coulomb", "coulomb-static"], amplitude=[4e-4, 6e-4], tilt_deg=1.7)
    grid.to_netcdf(tmp_path / "grid.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "grid.nc", engine="h5netcdf") as again:
        xr.testing.assert_allclose(again.mean_velocity, grid.mean_velocity)


def test_all_that_is_wrong_is_reported():
    with pytest.raises(ss.InputError) as caught:
        sweep(RIG, amplitud=[1e-4], tilt_deg=[[1, 2], [3, 4]], period=3)
    told = str(caught.value)
    assert len(caught.value.problems) == 4  # amplitude is missing, too
    assert "did you mean 'amplitude'" in told and "did you mean 'periods'" in told and "(2, 2)" in told and "amplitude is missing" in told


@each_row(
    ("make", "axes", "told"),
    [
        (3, {"a": 1}, "allowed is a Robot or a function"),
        (RIG, {"amplitude": [1e-4, -1e-4], "tilt_deg": 1.7}, "amplitude[1] = "),
        (RIG, {"amplitude": [], "tilt_deg": 1.7}, "allowed is a single value"),
        (RIG, {"amplitude": [1e-4], "tilt_deg": 1.7, "law": ["lugre", "colomb"]}, "did you mean 'coulomb'"),
        (RIG(tilt_deg=1.7, amplitude=1e-4), {"drive.amplitud": [1e-4]}, "did you mean 'drive.amplitude'"),
    ],
)
def test_bad_axes_are_told(make, axes, told):
    with pytest.raises(ss.InputError) as caught:
        sweep(make, **axes)
    assert told in str(caught.value)


# cells that cannot be solved ------------------------------------------------------------------------------------------


def test_nan_marks_its_own_cell_and_the_sweep_goes_on():
    grid = sweep(RIG, amplitude=[4e-4, np.nan, 6e-4], tilt_deg=[1.7, 2.7], law="coulomb")
    assert grid.status.values.tolist() == [[1, 1], [5, 5], [1, 1]]
    assert np.isnan(grid.mean_velocity.values[1]).all() and (grid.motion_type.values[1] == "unsolved").all()
    assert float(grid.mean_velocity[0, 0]) == pytest.approx(9.00404579e-4, rel=1e-6)
    assert json.loads(grid.attrs["notes"]) == {"not a finite number": 2}


def test_a_combination_that_the_maker_refuses_marks_its_own_cell():
    grid = sweep(RIG, tilt_deg=[1.7, 8.0], mu0=[0.1, 0.18], amplitude=6e-4, law="coulomb")  # atan(.1) = 5.7 degrees
    assert grid.status.values.tolist() == [[1, 1], [5, 1]]
    assert "friction angle" in grid.attrs["notes"]


@dataclass(frozen=True)
class Touchy:
    """A dynamic law that raises for one of its numbers, and gives no number for another."""

    mu: float
    scalar_only: ClassVar[bool] = False

    def rate(self, v, z, load):
        if isinstance(self.mu, float) and self.mu == 0.5:
            raise RuntimeError("cannot be 0.5")
        return v - 1e5 * abs(v) * z / (load * self.mu * (self.mu - 0.3) / (self.mu - 0.3))

    def force(self, v, z, zdot, load):
        return 1e5 * z + 100.0 * zdot


@dataclass(frozen=True)
class Broken:
    """A law that never gives a number."""

    mu: float

    def rate(self, v, z, load):
        return v

    def force(self, v, z, zdot, load):
        raise RuntimeError("not today")


def test_a_failing_law_marks_its_own_cell():
    def maker(mu):
        return RIG(tilt_deg=0.0, amplitude=6e-4).replace(friction=Touchy(mu=mu))

    grid = sweep(maker, mu=[0.2, 0.3, 0.25], periods=20)
    assert (grid.status.values[[0, 2]] <= 1).all() and grid.status.values[1] > 1
    assert np.isfinite(grid.mean_velocity.values).tolist() == [True, False, True]
    some = sweep(maker, mu=[0.2, 0.5], periods=4, method="lsoda")
    assert some.status.values.tolist()[1] == 100 and "cannot be 0.5" in some.attrs["notes"] and some.status.values[0] <= 1
    with pytest.raises(ss.InputError, match=r"cannot be 0.5"):
        sweep(maker, mu=[0.5], periods=20, method="lsoda")


# designs --------------------------------------------------------------------------------------------------------------


def test_zipped_axes_are_the_diagonal_of_the_grid():
    amplitude, tilt = [4e-4, 5e-4, 6e-4], [1.7, 2.7, 3.7]
    line = sweep(RIG, ss.designs.zipped("row", amplitude=amplitude, tilt_deg=tilt), law=["coulomb", "lugre"])
    grid = sweep(RIG, amplitude=amplitude, tilt_deg=tilt, law=["coulomb", "lugre"])
    assert line.mean_velocity.dims == ("row", "law") and line.amplitude.dims == ("row",)
    for i in range(3):
        assert np.array_equal(line.mean_velocity.values[i], grid.mean_velocity.values[i, i])


@each_row("make", [ss.designs.sobol, ss.designs.latin_hypercube], ids=["sobol", "latin"])
def test_a_random_design_is_made_again_by_its_seed(make):
    design = make(16, seed=3, amplitude=(1e-4, 8e-4), mu0=(0.05, 0.5, "log"))
    grid = sweep(RIG, design, tilt_deg=1.0, law="coulomb")
    again, other = (make(16, seed=s, amplitude=(1e-4, 8e-4), mu0=(0.05, 0.5, "log")) for s in (3, 4))
    assert json.loads(grid.attrs["provenance"])["seed"] == 3
    assert np.array_equal(grid.amplitude, again.columns["amplitude"]) and not np.array_equal(grid.amplitude, other.columns["amplitude"])
    for name, low, high in (("amplitude", 1e-4, 8e-4), ("mu0", 0.05, 0.5)):
        assert low <= grid[name].min() and grid[name].max() <= high
    strips = np.floor(16 * np.log(grid.mu0.values / 0.05) / np.log(10)).astype(int)
    assert sorted(strips) == list(range(16))  # one point in each of 16 strips of the logarithm: both designs have it


def test_a_table_of_arbitrary_rows():
    rows = {"amplitude": [4e-4, 6e-4, 5e-4], "law": ["coulomb", "lugre", "coulomb"], "tilt_deg": [1.7, 2.7, 0.0]}
    grid = sweep(RIG, ss.designs.table(rows))
    for i in range(3):
        row = {name: values[i] for name, values in rows.items()}
        assert float(grid.mean_velocity[i]) == pytest.approx(ss.sweep(RIG, **row).mean_velocity.item(), rel=1e-12, abs=1e-15)
    assert grid.law.values.tolist() == rows["law"]


def test_what_is_wrong_with_a_design_is_told():
    for bad, told in (
        (lambda: ss.designs.zipped(a=[1, 2], b=[1, 2, 3]), "same length"),
        (lambda: ss.designs.sobol(0, amplitude=(2.0, 1.0)), "2 problems"),
        (lambda: ss.designs.table("/nowhere/rows.csv"), "cannot be read"),
        (lambda: sweep(RIG, ss.designs.zipped(amplitude=[1e-4]), amplitude=[1e-4], tilt_deg=1.0), "given twice"),
        (lambda: sweep(RIG, {"amplitude": [1e-4]}, tilt_deg=1.0), r"type \*\* before the dictionary"),
        (lambda: sweep(RIG, np.zeros(1000), tilt_deg=1.0), "is not a design"),
        (lambda: sweep(lambda period: RIG(tilt_deg=period, amplitude=1e-4), period=[1.0]), "name of a result"),
    ):
        with pytest.raises(ss.InputError, match=told):
            bad()


@each_row("shard", [None, "2/2"])
def test_an_error_of_every_case_is_raised_with_a_folder_too(tmp_path, shard):
    def maker(mu):
        return RIG(tilt_deg=0.0, amplitude=6e-4).replace(friction=Broken(mu=mu))

    with pytest.raises(ss.InputError, match="not today"):
        sweep(maker, mu=[0.2, 0.3])
    for resume in (False, True):
        with pytest.raises(ss.InputError, match=r"not today(.|\n)*the folder .* is complete"):
            sweep(maker, mu=[0.2, 0.3], out=tmp_path / "study", tile=1, shard=shard, resume=resume)
    kept = ss.open_study(tmp_path / "study")
    assert kept.status.values.tolist() == [101 if shard else 100, 100] and "not today" in kept.attrs["notes"]


def test_a_map_that_is_stopped_has_right_numbers_and_says_where_it_has_none(every_report):
    axes = dict(amplitude=np.linspace(1e-4, 8e-4, 9), omega=np.linspace(60.0, 300.0, 9), tilt_deg=1.7)
    grid = ss.map(RIG, refine=True, coarse=3, progress=lambda now: False, **axes)
    whole = ss.map(RIG, refine=True, coarse=3, **axes)
    there, missing = grid.status <= 1, grid.status == 101
    assert missing.any() and there.any() and (grid.mean_velocity == whole.mean_velocity).where(there, True).all()
    assert grid.mean_velocity.where(missing).isnull().all() and "stopped by progress: not computed" in grid.notes


# starts, neighbours, results ------------------------------------------------------------------------------------------


def test_start_values_may_be_an_axis():
    grid = sweep(RIG, **{"start.v": [0.0, 0.05, -0.05]}, amplitude=[4e-4, 6e-4], tilt_deg=1.7, law="coulomb")
    assert grid.mean_velocity.dims == ("start.v", "amplitude")
    assert abs(grid.mean_velocity - grid.mean_velocity[0]).max() < 1e-12  # one periodic motion, whatever the start (it contracts)
    short = sweep(RIG, **{"start.v": [0.0, 0.05]}, amplitude=4e-4, tilt_deg=1.7, periods=2, settle=0)
    assert float(short.mean_velocity[1] - short.mean_velocity[0]) > 1e-3


def test_following_an_axis_shows_hysteresis():
    """Break-away far above sliding friction: the robot creeps until it is let go, and then does not fall back at once. A start in
    motion finds the upper branch too."""
    robot = dict(tilt_deg=1.7, mu0=0.12, f0=0.6)
    both = sweep(RIG, **robot, amplitude=np.linspace(4e-4, 1.2e-3, 17), continue_along="amplitude")
    up, down = (both.mean_velocity.sel(way=way).values for way in ("up", "down"))
    assert both.mean_velocity.dims == ("way", "amplitude")
    apart = abs(up - down) > 1e-3 * abs(down).max()
    assert 3 <= apart.sum() <= 6 and not apart[:5].any() and not apart[12:].any() and (down[apart] > 50 * up[apart]).all()
    at = int(np.flatnonzero(apart)[1])
    moving = sweep(RIG, **robot, amplitude=both.amplitude.values[at], **{"start.v": [0.0, -0.02]})
    assert moving.mean_velocity.values == pytest.approx([up[at], down[at]], rel=1e-4)


def test_following_shortens_transients():
    axes = dict(amplitude=np.linspace(5e-4, 8e-4, 16), tilt_deg=1.7)
    followed, alone = sweep(RIG, **axes, continue_along="amplitude"), sweep(RIG, **axes)
    assert followed.sel(way="up").mean_velocity.values == pytest.approx(alone.mean_velocity.values, rel=3e-6)
    assert "amplitude" in followed.dims and (followed.period == 1).all()


STICTION, BRISTLES = ss.Coulomb(0.3, 0.3, 0.45, 0.45), ss.LuGre(0.3, 0.3, 0.45, 0.45, sigma0=100.0, sigma1=1.0, sigma2=0.1, v_s=0.05)
SPRUNG = {
    "forced_oscillator": (ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, STICTION, damping=0.01), {"omega": [0.6, 0.7, 0.8]}, {"periods": 3}),
    "block_on_belt": (ss.BlockOnBelt(1.0, 2.0, 0.1, STICTION), {"speed": [0.1, 0.15, 0.2]}, {"duration": 4.0}),
    "pulled_mass": (ss.PulledMass(1.0, 2.0, 0.1, STICTION), {"speed": [0.1, 0.15, 0.2]}, {"duration": 7.0}),
}


@pytest.mark.parametrize(("kind", "law"), [*((kind, STICTION) for kind in SPRUNG), ("pulled_mass", BRISTLES)])
def test_each_case_starts_where_its_neighbour_ended(kind, law):
    """Position too, where there is a spring: as runs that hand their last instant on, with the spring as far stretched as it was."""
    bench, axis, span = SPRUNG[kind]
    bench, ((name, values),) = bench.replace(friction=law), axis.items()
    both = sweep(bench, **axis, **span, settle=0, rtol=1e-8, continue_along=name)
    start = {}
    for way, value in [("up", v) for v in values] + [("down", v) for v in values[::-1]]:
        run = ss.solve(bench.replace({name: value}), **span, settle=0, rtol=1e-8, start=start)
        assert float(both.displacement.sel({"way": way, name: value})) == pytest.approx(run.x[-1] - run.x[0], rel=1e-6, abs=1e-9)
        end = run.at(run.t[-1])
        start = {"x": end["x"] - getattr(run.model, "far_end_velocity", 0.0) * run.t[-1], "v": end["v"]}
        start |= {} if end["z"] is None else {"z": end["z"]}


@each_row("law", ["coulomb", "coulomb-static", "lugre"])
def test_power_is_told_whatever_the_start_and_the_window(law):
    axes = dict(amplitude=[4e-4, 7.7e-4], tilt_deg=1.7, law=law)
    followed, alone = sweep(RIG, **axes, continue_along="amplitude"), sweep(RIG, **axes)
    waited = [sweep(RIG, **axes, start={"v": 0.05}), sweep(RIG, **axes, settle=150)]
    for name in ("drive_power", "cost_of_transport"):
        for grid in (followed.sel(way="up"), *waited):
            assert grid[name].values == pytest.approx(alone[name].values, rel=1e-4)


def test_following_goes_on_beside_a_law_that_fails():
    def maker(law, amplitude):
        robot = RIG(tilt_deg=0.0, amplitude=amplitude)
        return robot if law == "lugre" else robot.replace(friction=Broken(mu=0.5))

    axes = dict(law=["lugre", "broken"], amplitude=[6e-4, 7e-4], periods=20)
    grid = sweep(maker, **axes, continue_along="amplitude")
    assert (grid.status.sel(law="broken") == 100).all() and "not today" in grid.attrs["notes"]
    assert (grid.status.sel(law="lugre") <= 1).all() and np.isfinite(grid.drive_power.sel(law="lugre")).all()
    with pytest.raises(ss.InputError, match="continue_along needs the end states"):
        sweep(RIG, amplitude=[6e-4, 7e-4], tilt_deg=1.7, method="lsoda", continue_along="amplitude")


def test_drive_power_is_that_of_the_curve():
    """The actuator's power from the ways of a map against the work of its force over the last period of a run."""
    grid = sweep(RIG, amplitude=[4e-4, 6e-4, 8e-4], incline=["folded", "gravity"], tilt_deg=1.7, law=["coulomb", "coulomb-static"])
    assert np.isfinite(grid.drive_power).all()
    for point in grid.stack(case=("amplitude", "incline", "law")).case.values:
        words = dict(zip(("amplitude", "incline", "law"), point, strict=True))
        run = ss.solve(RIG(tilt_deg=1.7, **words), periods=60, settle=59)
        mean, cell = ss.energy(run).actuator[-1] / run.period_time, grid.sel(**words)  # the periodic motion is reached to 1e-12 by then
        assert float(cell.drive_power) == pytest.approx(mean, rel=1e-9)
        assert float(cell.cost_of_transport) == pytest.approx(
            mean / (run.model.total_mass * 9.81 * abs(float(cell.mean_velocity))), rel=1e-9
        )


def test_results_do_not_depend_on_tiles_and_threads():
    axes = dict(amplitude=np.linspace(1e-4, 8e-4, 23), omega=np.linspace(60, 300, 17), law=["lugre", "coulomb"], tilt_deg=1.7)
    one = sweep(RIG, **axes)
    for more in (dict(workers=2), dict(tile=50), dict(tile=7, workers=3)):
        xr.testing.assert_identical(sweep(RIG, **axes, **more).drop_attrs(), one.drop_attrs())


def test_progress_counts_and_may_stop(every_report):
    told = []

    def watch(now):
        told.append(now)
        return len(told) < 3

    grid = sweep(RIG, amplitude=np.linspace(1e-4, 8e-4, 400), omega=np.linspace(60, 300, 40), tilt_deg=1.7, tile=400, progress=watch)
    assert len(told) == 3 and told[-1].cases == 16000 and 0 < told[-1].done < 16000
    assert (grid.status == 101).any() and grid.status.attrs["flag_meanings"].find("101: not computed") > 0
    whole = []
    sweep(RIG, amplitude=[4e-4, 5e-4, np.nan], tilt_deg=1.7, law="coulomb", progress=whole.append)
    assert whole[-1].done == whole[-1].cases == 3 and whole[-1].statuses["bad input for this case"] == 1
    assert "1 bad input" in whole[-1].line()


def test_every_number_of_every_preset_can_be_an_axis():
    """None has the name of a result or of an option, under which a dataset could not hold both."""
    from stickslip.presets import PRESETS
    from stickslip.studies.planning import _ARGUMENTS
    from stickslip.studies.result_columns import COLUMNS

    taken = {*COLUMNS, *_ARGUMENTS} - {"alpha_plus", "alpha_minus"}  # of the dimensionless robot axis and result are the same number
    assert not {(name, each) for name, preset in PRESETS.items() for each in inspect.signature(preset).parameters if each in taken}


def test_a_wrong_argument_is_told_although_the_first_points_make_no_robot():
    amplitudes = np.append(np.full(30, np.nan), [3e-4, 6e-4])
    with pytest.raises(ss.InputError, match="method = 'rk5' is not known"):
        ss.sweep(ss.presets.piezo_rig, amplitude=amplitudes, tilt_deg=1.7, method="rk5")


# ---- machines without a period ----
BELT = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))


def test_a_belt_that_is_left_time_to_settle_has_the_columns_of_the_formula(tmp_path):
    """T = 2 (F - f) / (k u) + (2 pi - 2 atan((F - f) omega / (k u))) / omega, and the slide is a part of a circle."""
    u, omega = np.array([0.1, 0.15]), np.sqrt(2.0)
    slides, rests, size = (2 * np.pi - 2 * np.arctan(0.25 * omega / u)) / omega, 0.5 / u, np.hypot(0.25, u / omega)
    grid = ss.sweep(BELT, speed=[*u, np.nan], duration=100, settle=50, out=tmp_path / "study")
    assert grid.motion_type.values.tolist() == ["stick-slip", "stick-slip", "unsolved"] and grid.period.values.tolist() == [1, 1, 0]
    for name, formula in {
        "duration": slides + rests, "body_amplitude": size, "stick_fraction": rests / (slides + rests), "velocity_max": u,
        "velocity_min": -size * omega,
    }.items():  # fmt: skip
        np.testing.assert_allclose(grid[name].values, [*formula, np.nan], rtol=1e-9, err_msg=name)
    np.testing.assert_allclose(grid.mean_velocity.values[:2], 0.0, atol=1e-12)
    assert "duration" not in ss.sweep(BELT, speed=u, duration=100)


def test_a_flow_that_is_left_time_to_settle_has_the_numbers_of_its_cycle():
    hit = ss.Switch(lambda t, y, n: y[0], 0, lambda t, y, n: (0.0, n.u))
    ball = ss.SwitchingFlow({0: lambda t, y, n: (y[1], -10.0)}, {0: (hit,)}, None, {"u": 2.0}, states=("height", "v"))
    grid = ss.sweep(ball, u=[1.0, 2.0], start={"height": 1.0}, duration=20.0, settle=5.0)
    np.testing.assert_allclose(grid.duration, [0.2, 0.4], rtol=1e-9)
    np.testing.assert_allclose(grid.amplitude_height, [0.025, 0.1], rtol=1e-9)
    assert grid.motion_type.values.tolist() == ["periodic"] * 2 and grid.fraction_0.values == pytest.approx([1.0, 1.0])


def test_settling_of_a_machine_without_a_period_is_a_time_below_the_duration():
    for settle in (100.0, -1.0, "long"):
        with pytest.raises(ss.InputError, match="settle"):
            ss.sweep(BELT, speed=[0.1, 0.2], duration=100, settle=settle)
