"""Every result of a motion answers to the same words: mean velocity, motion, figure, tables and files."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from rows import each_row

RIG = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
BELT = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
MAKERS = {
    "run": lambda: ss.solve(RIG, periods=40),
    "machine": lambda: ss.solve(ss.presets.two_modules(), periods=10),
    "self-excited": lambda: ss.solve(BELT, duration=60),
    "batch": lambda: ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[4e-4, 5e-4], law="coulomb"), periods=40),
    "record": lambda: ss.virtual_rig(RIG, noise=1e-5, seed=1),
    "orbit": lambda: ss.periodic_orbit(RIG),
    "cycle": lambda: ss.periodic_orbit(BELT),
}


@each_row("name", list(MAKERS))
def test_every_result_answers_to_the_same_words(name, tmp_path):
    result = MAKERS[name]()
    assert np.array_equal(result.mean_velocity, ss.mean_velocity(result))
    if name != "batch":
        own, of_function = result.motion, ss.motion(result)
        assert own == of_function or str(own) == str(of_function)
    axes = plt.subplots()[1]
    assert result.plot(ax=axes) is axes and axes.has_data()
    plt.close("all")
    data, frame = result.to_xarray(), result.to_dataframe()
    assert len(frame) and "units" in next(iter(data.data_vars.values())).attrs
    path = result.save(tmp_path / "kept.csv")
    assert len(path.read_text().splitlines()) > len(frame)


def test_a_cycle_moves_as_a_run_that_ends_on_it():
    of_cycle, of_run = ss.periodic_orbit(BELT).motion, ss.solve(BELT, duration=60).motion
    assert (of_cycle.type, of_cycle.pattern, of_cycle.period) == (of_run.type, of_run.pattern, of_run.period) == ("stick-slip", "0-", 1)
    assert of_cycle.duration == pytest.approx(of_run.duration, rel=1e-9)
    assert (of_cycle.amplitude, of_cycle.stick_fraction) == pytest.approx((of_run.amplitude, of_run.stick_fraction), rel=1e-6)


def test_a_printed_run_says_how_fast_it_is_and_how_it_moves():
    run = ss.solve(RIG, periods=40)
    assert f"mean velocity {ss.mean_velocity(run):.6g} m/s, type {ss.motion(run).type}, steady" in repr(run)
    ride = ss.solve(BELT, duration=60)
    assert f"mean velocity {ride.mean_velocity:.6g} m/s over the run" in repr(ride)  # the mean of its cycle is zero
    assert "not settled" in repr(ss.solve(ss.presets.two_modules(), periods=10))
    long = ss.solve(RIG, periods=1000)
    assert "mean velocity" in repr(long) and "type" not in repr(long)  # which would take as long as solving it
    assert "motion" not in vars(long)
    short = ss.solve(RIG, periods=100_000, progress=lambda done, periods: done < 100)  # stopped early
    assert "mean velocity" not in repr(short) and "interrupted" in repr(short)


@each_row(
    "result, name, hint",
    [
        (MAKERS["run"], "motion_type", r"type run\.motion\.type"),
        (MAKERS["batch"], "motion", r"type many\.motion_type"),
        (
            lambda: ss.solve(ss.SwitchingFlow({0: lambda t, y: (-y[0],)}), duration=1.0, start=[1.0]),
            "mean_velocity",
            r"no bodies; type run\[name\]",
        ),
    ],
    ids=["run", "batch", "flow"],
)
def test_a_word_that_makes_no_sense_says_what_to_type(result, name, hint):
    with pytest.raises(AttributeError, match=hint):
        getattr(result(), name)


def test_options_of_records_are_refused_of_runs():
    run = ss.solve(RIG, periods=5)
    for function, option in ((ss.mean_velocity, {"frequency": 1.0}), (ss.motion, {"threshold": 1e-3})):
        with pytest.raises(ss.InputError, match=r"is for a Record, and Trajectory given"):
            function(run, **option)


@each_row("suffix", [".nc", ".xlsx", ".mat", ".csv"])
def test_a_batch_is_saved_in_every_format(suffix, tmp_path):
    many = MAKERS["batch"]()
    path = many.save(tmp_path / f"many{suffix}")
    V = {".nc": _netcdf, ".xlsx": _excel, ".mat": _matlab, ".csv": _csv}[suffix](path)
    assert np.array_equal(np.ravel(V), many.mean_velocity)
    with pytest.raises(ss.InputError, match=r"\.csv, \.xlsx and \.mat; type for example many.save\('many.nc'\)"):
        many.save(tmp_path / "many.zip")
    with pytest.raises(ss.InputError, match="cannot write '/nonexistent/"):
        many.save(f"/nonexistent/many{suffix}")


def _netcdf(path):
    import xarray as xr

    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data["drive.amplitude"].attrs["units"] == "m" and data.motion_type.values.tolist() == ["I", "I"]
        return data.mean_velocity.values


def _excel(path):
    import pandas as pd

    return pd.read_excel(path)["mean_velocity [m/s]"].to_numpy()


def _matlab(path):
    from scipy.io import loadmat

    return loadmat(path)["mean_velocity"]


def _csv(path):
    import pandas as pd

    return pd.read_csv(path)["mean_velocity [m/s]"].to_numpy()


def test_channels_with_times_of_their_own_have_a_dimension_of_their_own():
    fast, slow = np.arange(100) / 100, np.arange(10) / 10
    rec = ss.read({"t [s]": fast, "v [mm/s]": np.sin(fast)}).joined(ss.read({"t [s]": slow, "F [N]": np.cos(slow)}))
    data = rec.to_xarray()
    assert sorted(data.sizes.values()) == [10, 100]
    with pytest.raises(ss.InputError, match=r"not sampled at the same times.*type rec\.to_xarray\(\)"):
        rec.to_dataframe()
    assert rec.plot("F").get_ylabel() == "F (N)" and rec.plot().get_ylabel().startswith("v (")
    plt.close("all")


def test_a_batch_of_more_axes_says_what_to_type():
    mu = np.full((2, 2, 2), 0.2)
    many = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, mu0=mu, law="coulomb"), periods=5)
    with pytest.raises(ss.InputError, match=r"the shape \(2, 2, 2\)"):
        many.plot()
