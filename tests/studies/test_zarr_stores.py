"""Results as Zarr stores: the numbers and words of the study, on a disk and behind a URL, and what is refused."""

import numpy as np
import pytest
import xarray as xr

import stickslip as ss

zarr = pytest.importorskip("zarr", reason="zarr is not installed; type pip install zarr")
AXES = {"tilt_deg": [1.7, 2.7, np.nan], "amplitude": np.linspace(3e-4, 6e-4, 3), "law": "coulomb"}


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies") / "study"
    ss.sweep(ss.presets.piezo_rig, **AXES, out=folder)
    return folder


def test_a_store_holds_the_study_and_a_second_one_takes_its_place(study, tmp_path):
    for _ in range(2):
        assert ss.studies.export(study, tmp_path / "grid.zarr") == tmp_path / "grid.zarr"
    ss.studies.export(study, tmp_path / "grid.nc")
    grid = ss.open_study(tmp_path / "grid.zarr")
    xr.testing.assert_identical(grid, ss.open_study(tmp_path / "grid.nc"))
    xr.testing.assert_equal(grid, ss.open_study(study).load())
    assert {each.name for each in tmp_path.iterdir()} == {"grid.nc", "grid.zarr"}


def test_xarray_opens_it_lazily_with_codes_units_and_what_was_not_solved(study, tmp_path):
    ss.studies.export(study, tmp_path / "grid.zarr")
    grid, kept = xr.open_zarr(tmp_path / "grid.zarr"), ss.open_study(study)
    assert grid.status.dtype == np.int8 and grid.mean_velocity.attrs["units"] == "m/s" and not grid.mean_velocity._in_memory
    assert "III" in grid.motion_type.attrs["flag_meanings"] and int(grid.status[2, 0]) == int(kept.status[2, 0]) != 0
    assert np.array_equal(grid.mean_velocity.values, kept.mean_velocity.values, equal_nan=True)


def test_a_store_of_many_cases_has_a_chunk_for_each_block(tmp_path):
    shape = (3, 50_000)
    V = np.arange(150_000.0).reshape(shape)
    grid = xr.Dataset({"mean_velocity": (("a", "b"), V), "status": (("a", "b"), np.zeros(shape, "i1"))}, attrs={"maker": "mine"})
    ss.studies.export(grid, tmp_path / "grid.zarr")
    kept = zarr.open_group(tmp_path / "grid.zarr", mode="r")["mean_velocity"]
    assert kept.chunks == (3, 21845) and np.array_equal(kept[...], V)


def test_other_datasets_and_urls_are_stores_too(study):
    cycle = ss.bifurcation(
        ss.presets.piezo_rig, parameter="amplitude", values=[3e-4, 4e-4], follow=False, settle=40, tilt_deg=1.7, law="coulomb"
    )
    ss.studies.export(cycle, "memory://diagram.zarr")
    ss.studies.export(study, "memory://grid.zarr")
    kept = xr.open_zarr(zarr.storage.FsspecStore.from_url("memory://diagram.zarr"))
    assert kept.motion.values.tolist() == cycle.motion.values.tolist()
    xr.testing.assert_equal(ss.open_study("memory://grid.zarr"), ss.open_study(study).load())


def test_what_is_no_store_stays_and_says_what_to_type(study, tmp_path):
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr" / "thesis.tex").write_text("all of it")
    for said, call in {
        "is there and is no Zarr store": lambda: ss.studies.export(study, tmp_path / "mine.zarr"),
        "allowed there is a Zarr store; type for example s3://bucket/grid.zarr": lambda: ss.studies.export(study, "s3://bucket/grid.nc"),
        "allowed are .nc, .mat, .csv, .xlsx, .parquet, .zarr": lambda: ss.studies.export(study, tmp_path / "grid.zip"),
    }.items():
        with pytest.raises(ss.InputError, match=said):
            call()
    assert (tmp_path / "mine.zarr" / "thesis.tex").read_text() == "all of it"


def test_a_damaged_chunk_is_refused_and_a_lost_one_has_no_numbers(study, tmp_path):
    ss.studies.export(study, tmp_path / "grid.zarr")
    (chunk,) = (path for path in (tmp_path / "grid.zarr" / "mean_velocity" / "c").rglob("*") if path.is_file())
    whole = chunk.read_bytes()
    for damaged in (whole[:-9], whole[:20] + bytes([whole[20] ^ 4]) + whole[21:]):
        chunk.write_bytes(damaged)
        with pytest.raises(ss.InputError, match="cannot be read"):
            ss.open_study(tmp_path / "grid.zarr")
    chunk.unlink()
    assert np.isnan(ss.open_study(tmp_path / "grid.zarr").mean_velocity).all()
