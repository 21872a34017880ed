"""`sweep`: a grid of keywords becomes one labelled dataset, whatever the maker can take."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from stickslip.sweeps import sweep

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


@pytest.mark.parametrize(
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
