"""Pictures of optima show what runs of the same machines say."""

import numpy as np
import pytest

import stickslip as ss

RIG = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
OMEGA = float(RIG.drive.omega)


@pytest.fixture(scope="module")
def best():
    limits = {"relative_acceleration": (None, 6e-4 * OMEGA**2)}
    return ss.optimise(RIG, over={"drive.amplitude": ("0.2 mm", "0.8 mm")}, maximise="mean_velocity", subject_to=limits)


def test_a_cut_has_the_speeds_of_other_runs_and_ends_at_the_limit(best):
    way, amplitude, V, kept = best.cuts["drive.amplitude"]
    assert (way[0], way[-1], amplitude[0], amplitude[-1]) == (0.0, 1.0, 2e-4, 8e-4)
    again = ss.sweep(ss.presets.piezo_rig, amplitude=amplitude[::8], tilt_deg=1.7, law="coulomb").mean_velocity.values
    assert V[::8] == pytest.approx(again, rel=1e-9)
    assert (kept == (amplitude <= 6e-4 * (1 + 1e-9))).all()
    assert V[kept > 0].max() == pytest.approx(best["mean_velocity"], rel=1e-9)


def test_the_picture_of_one_number_has_its_unit_and_shades_what_is_beyond_the_limit(best):
    ax = best.plot()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("amplitude of the inner mass $A$ (µm)", "mean velocity (mm/s)")
    star = ax.lines[-1]
    assert (star.get_xdata()[0], star.get_ydata()[0]) == pytest.approx((600.0, 1e3 * best["mean_velocity"]), rel=1e-6)
    (shade,) = ax.collections
    x = shade.get_paths()[0].vertices[:, 0]
    assert (x.min(), x.max()) == pytest.approx((600.0, 800.0), rel=1e-6)


def test_the_drive_is_drawn_beside_the_one_that_was_given(best):
    ax = best.plot(of="drive")
    for line, A in zip(ax.lines, (5e-4, 6e-4), strict=False):
        assert max(line.get_ydata()) == pytest.approx(A * OMEGA**2, rel=1e-5)  # a quarter of a thousandth of the period off the peak
    assert {t.get_text() for t in ax.get_legend().get_texts()} == {"as given", "best", "beyond the limit"}


def test_a_waveform_is_drawn_as_a_drive_and_several_numbers_as_lines():
    stopped = {"maximise": "mean_velocity", "progress": lambda tried, most: tried < 100}
    limits = {"stroke": (None, 0.002), "relative_acceleration": (None, 60.0)}
    wave = ss.optimise(RIG, over={"drive": ss.optimisation.waveform(pieces=3)}, subject_to=limits, **stopped)
    assert wave.plot().get_ylabel() == "relative acceleration (m/s²)"
    assert not wave.cuts
    with pytest.raises(ss.InputError, match='type of="drive"'):
        wave.plot(of="numbers")
    with pytest.raises(ss.InputError, match='"numbers" or "drive"'):
        wave.plot(of="power")
    two = ss.optimise(RIG, over={"drive.amplitude": (2e-4, 8e-4), "drive.omega": (60.0, 300.0)}, **stopped).plot()
    told = [t.get_text() for t in two.get_legend().get_texts()]
    assert [text.split(" = ")[0] for text in told] == ["drive.amplitude", "drive.omega"]
    assert told[1].endswith("rad/s  (60 to 300)")


def test_a_front_has_the_units_of_its_quantities():
    columns = {"drive_power": ("point", np.array([1e-4, 2e-4]), {"units": "W"}), "mean_velocity": ("point", [1e-3, 2e-3], {"units": "m/s"})}
    import xarray as xr

    made = xr.Dataset(columns, attrs={"minimise": "drive_power", "maximise": "mean_velocity"})
    ax = ss.plot.front(made)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("drive power (µW)", "mean velocity (mm/s)")
    assert ax.lines[0].get_xydata().tolist() == [[100.0, 1.0], [200.0, 2.0]]
    with pytest.raises(ss.InputError, match=r"ss\.optimisation\.pareto"):
        ss.plot.front(made.drop_attrs())
