"""Runs on disk."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from runs import coulomb_run, unit_robot
from stickslip.results.dense_output import PolynomialPieces
from stickslip.results.trajectory import Trajectory


@pytest.fixture(scope="module")
def run():
    return coulomb_run(unit_robot(0.7, 0.9), 6)


@dataclass(frozen=True)
class Bristles:
    """A user's own law."""

    stiffness: float
    orders: tuple[float, ...] = (1.0, 2.0)

    def rate(self, v, z, load):
        return v - abs(v) * z * self.stiffness / load

    def force(self, v, z, zdot, load):
        return self.stiffness * z


def own_law_run():
    robot = unit_robot(0.7, 0.9).replace(friction=Bristles(stiffness=3.0))
    pieces = PolynomialPieces(np.array([0.0, robot.period]), np.array([1]), np.zeros(1), np.ones((1, 2, 3)))
    return Trajectory(robot, pieces, 1, 0, 1e-6, "by hand", start={"v": 1.0, "z": np.float64(1.0)}, counts={"steps": np.int64(3)})


@each_row("make", [lambda: coulomb_run(unit_robot(0.7, 0.9), 6), own_law_run])
def test_a_run_comes_back_bit_by_bit(make, tmp_path):
    run = make()
    same = ss.load(run.save(tmp_path / "run.nc"), laws=[Bristles])
    assert same.model == run.model
    for name in ("t", "x", "v", "friction_force", "actuator_power", "strobe_v"):
        assert np.array_equal(getattr(same, name), getattr(run, name))
    for name in ("status", "method", "periods", "settle", "samples", "rtol", "start", "counts", "provenance"):
        assert getattr(same, name) == getattr(run, name)


def test_other_readers_find_the_columns(run, tmp_path):
    import h5py
    import xarray as xr

    path = run.save(tmp_path / "run.nc")
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data.v.attrs["units"] == "m/s" and np.array_equal(data.v, run.v) and np.array_equal(data.time, run.t)
    with h5py.File(path) as file:
        assert np.array_equal(file["x"][:], run.x)


def test_without_its_class_an_own_law_still_gives_the_motion(tmp_path):
    run = own_law_run()
    same = ss.load(run.save(tmp_path / "run.nc"))
    assert np.array_equal(same.v, run.v) and np.array_equal(same.z, run.z) and same.period_time == run.period_time
    with pytest.raises(ss.InputError, match=r"ss\.load\(path, laws=\[Bristles\]\)"):
        same.friction_force  # noqa: B018


def test_a_drive_of_ones_own_cannot_be_kept(run, tmp_path):
    @dataclass(frozen=True)
    class Own:
        period: float = 1.0

        def position(self, t):
            return t

        velocity = acceleration = position

    model = run.model.replace(drive=Own())
    with pytest.raises(ss.InputError, match="to_xarray"):
        Trajectory(model, run.pieces, 6, 3, 1e-6, "by hand").save(tmp_path / "run.nc")
    assert list(tmp_path.iterdir()) == []


@each_row(
    ("attribute", "value", "message"),
    [
        ("stickslip_format", 99, "format 99, this stickslip reads up to 2"),
        ("stickslip_content", "study", "holds a study"),
        ("stickslip_format", None, "not written by stickslip"),
    ],
)
def test_other_files_are_refused_with_the_reason(run, tmp_path, attribute, value, message):
    import h5py

    path = run.save(tmp_path / "run.nc")
    with h5py.File(path, "r+") as file:
        del file.attrs[attribute]
        if value is not None:
            file.attrs[attribute] = value
    with pytest.raises(ss.InputError, match=message):
        ss.load(path)


def test_what_is_no_file_is_refused_with_the_reason(tmp_path):
    text = tmp_path / "text.nc"
    text.write_text("no netCDF")
    for path, message in [(text, "is not a netCDF4 file"), (tmp_path / "none.nc", "there is no file"), (tmp_path, "there is no file")]:
        with pytest.raises(ss.InputError, match=message):
            ss.load(path)


def test_an_unwritable_place_is_named(run, tmp_path):
    for save in (run.save, run.to_mat):
        with pytest.raises(ss.InputError, match="that folder does not exist"):
            save(tmp_path / "none" / "run.nc")
    if os.name == "posix" and os.geteuid() != 0:
        tmp_path.chmod(0o500)
        with pytest.raises(ss.InputError, match="cannot write"):
            run.save(tmp_path / "run.nc")
        tmp_path.chmod(0o700)


def test_a_failed_write_leaves_the_old_file_and_nothing_else(run, tmp_path, monkeypatch):
    path = run.save(tmp_path / "run.nc")
    before = path.read_bytes()

    def full(*arguments, **more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ss.InputError, match="No space left"):
        run.save(path)
    assert path.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_every_file_is_moved_into_place_when_it_is_whole(run, tmp_path, monkeypatch):
    """Runs, datasets, pages and figures: where the last step fails the old file is there as it was."""
    from matplotlib.figure import Figure

    from stickslip.results.storage import to_csv
    from stickslip.show.cli.show import draw_to
    from stickslip.show.reports import write

    data = run.to_xarray()
    writers = {
        "run.nc": run.save,
        "run.mat": run.to_mat,
        "run.csv": lambda path: to_csv(run, path),
        "page.html": lambda path: write(path, ""),
    }
    writers |= {f"figure{suffix}": lambda path: draw_to(path, Figure()) for suffix in (".png", ".svg", ".pdf")}
    writers |= {f"data{suffix}": lambda path: ss.studies.export(data, path) for suffix in (".nc", ".mat", ".csv")}

    def full(*arguments, **more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    for name, writer in writers.items():
        (tmp_path / name).write_text("old")
        with pytest.raises(ss.InputError, match=r"cannot write .*No space left"):
            writer(tmp_path / name)
        assert (tmp_path / name).read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(writers)


def test_the_columns_of_a_run_as_text(run, tmp_path):
    from stickslip.results.storage import to_csv

    lines = to_csv(run, tmp_path / "run.csv").read_text().splitlines()
    assert lines[0].startswith("t [s],x [m],v [m/s]") and len(lines) == len(run.t) + 1
    assert [float(word) for word in lines[-1].split(",")][:3] == [run.t[-1], run.x[-1], run.v[-1]]


def test_matlab_files_hold_the_columns(run, tmp_path):
    from scipy.io import loadmat

    back = loadmat(run.to_mat(tmp_path / "run.mat"), simplify_cells=True)
    assert np.array_equal(back["v"], run.v) and back["units"]["v"] == "m/s" and back["run"]["status"] == "finished"


def test_the_run_of_an_orbit_keeps_its_period_in_a_file(tmp_path):
    orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"))
    again = ss.load(orbit.save(tmp_path / "orbit.nc"))
    assert again.known_period == orbit.run.known_period == 1 and again.mean_velocity == orbit.mean_velocity
