"""Study folders: the same bits whatever happens on the way."""

from __future__ import annotations

import importlib.util
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from pairs import each_once
from rows import each_row
from stickslip.basics.errors import StickslipError
from stickslip.show.cli import main
from stickslip.studies import folder as folders

RIG = ss.presets.piezo_rig
#: 16 tiles of two laws.
AXES = dict(law=["coulomb", "lugre"], amplitude=np.linspace(1e-4, 8e-4, 8), omega=np.linspace(60.0, 300.0, 10), tilt_deg=1.7, tile=10)
#: The same in a process of its own, slowed down after each tile, so that it can be killed on the way.
SCRIPT = """
import sys, time, numpy as np, stickslip as ss
axes = dict(law=["coulomb", "lugre"], amplitude=np.linspace(1e-4, 8e-4, 8), omega=np.linspace(60.0, 300.0, 10), tilt_deg=1.7, tile=10)
from stickslip.studies import folder
put = folder.put
def slowly(path, content, new=False):
    time.sleep(0.03)
    return put(path, content, new)
folder.put = slowly
ss.sweep(ss.presets.piezo_rig, **axes, out=sys.argv[1], resume=True, workers=int(sys.argv[2]))
"""


def files(folder):
    """Every file of a study as bytes, but its manifest (which has the time it was begun) and the command that began it."""
    own = ("manifest.json", "command.json")
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in Path(folder).rglob("*") if p.is_file() and p.name not in own}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The study in one run."""
    folder = tmp_path_factory.mktemp("whole") / "study"
    ss.sweep(RIG, **AXES, out=folder)
    return folder


def test_a_study_is_the_sweep(whole):
    grid, again = ss.sweep(RIG, **AXES), ss.open_study(whole)
    xr.testing.assert_identical(again.drop_attrs(deep=False), grid.drop_attrs(deep=False))
    for row in (dict(amplitude=3), dict(law=1, omega=slice(2, 9, 3)), dict(amplitude=[5, 2], omega=-1), dict(law=0, amplitude=1, omega=1)):
        xr.testing.assert_identical(ss.open_study(whole).isel(row).drop_attrs(deep=False), grid.isel(row).drop_attrs(deep=False))
    assert again.motion_type.dtype.kind == "U" and len(list((whole / "tiles").iterdir())) == 16


def test_the_manifest_says_what_it_is(whole):
    told = json.loads((whole / "manifest.json").read_text())
    assert told["cases"] == 160 and told["shape"] == [2, 8, 10] and told["dims"] == ["law", "amplitude", "omega"]
    assert told["provenance"]["versions"]["stickslip"] == ss.__version__ and told["identity"]["option rtol"] == "1e-06"
    assert len(told["study"]) == 64


def test_words_are_flags_in_the_files(whole):
    import h5py

    with h5py.File(whole / "tiles" / "0000015.nc") as file:
        kind = file["motion_type"]
        words = str(kind.attrs["flag_meanings"]).split()
        assert kind.dtype == np.int8 and list(kind.attrs["flag_values"]) == list(range(len(words)))
        told = [words[code] for code in kind[...]]
    assert told == ss.open_study(whole).motion_type.values[1, 7].tolist() and "III" in told


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_killed_and_resumed_it_is_the_same(whole, tmp_path, workers):
    """kill -9 a few times on the way, at different moments."""
    study, rng = tmp_path / "study", np.random.default_rng(workers)
    _kill_and_resume(study, workers, rng.uniform(0.05, 0.25, 3))
    ss.sweep(RIG, **AXES, out=study, resume=True)
    assert files(study) == files(whole)


@pytest.mark.slow
def test_killed_at_twenty_random_moments_it_is_the_same(whole, tmp_path):
    study = tmp_path / "study"
    kept = _kill_and_resume(study, 2, np.random.default_rng(7).uniform(0.0, 0.1, 20), at_least=0)
    assert kept == sorted(kept)  # nothing is done twice but tiles in flight
    ss.sweep(RIG, **AXES, out=study, resume=True)
    assert files(study) == files(whole)


def _kill_and_resume(study, workers, moments, at_least=1):
    """Start the sweep in another process and kill it some time after its first new tile; the tiles after each kill, with their times."""
    kept = []
    for moment in moments:
        before = _tiles(study)
        process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(study), str(workers)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        deadline = time.monotonic() + 60
        while len(_tiles(study)) < len(before) + at_least and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        time.sleep(moment if at_least else 12 * moment)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        after = _tiles(study)
        assert before.items() <= after.items()  # what was there was not written again
        kept.append(len(after))
    return kept


def _tiles(study):
    places = (study / "tiles").glob("[0-9]*.nc")
    return {p.name: p.stat().st_mtime_ns for p in places}


def test_half_written_files_are_swept_up(whole, tmp_path):
    study = tmp_path / "study"
    ss.sweep(RIG, **AXES, out=study)
    good = (study / "tiles" / "0000003.nc").read_bytes()
    os.remove(study / "tiles" / "0000007.nc")
    left = ss.open_study(study)
    assert np.flatnonzero(left.status.values.ravel() == 101).tolist() == list(range(70, 80))
    assert json.loads(left.notes) == {"not computed yet; resume=True (--resume) goes on": 10}
    with pytest.raises(ss.InputError, match="holds results of this study already; type resume=True"):
        ss.sweep(RIG, **AXES, out=study)
    (study / "tiles" / "0000003.nc").write_bytes(good[: len(good) // 2])  # a disk that lied about what it kept
    (study / "tiles" / ".0000004.nc.abc.part").write_bytes(b"half")
    with pytest.raises(ss.InputError, match=r"is damaged .* resume the sweep"):
        ss.open_study(study).status.load()
    ss.sweep(RIG, **AXES, out=study, resume=True)
    assert files(study) == files(whole)


def test_a_study_that_was_killed_before_its_manifest_begins_anew(whole, tmp_path):
    (tmp_path / "study" / "tiles").mkdir(parents=True)
    (tmp_path / "study" / "axes.nc").write_bytes(b"")  # or another shard has come this far
    (tmp_path / "study" / ".manifest.json.0a.part").write_bytes(b"{")
    ss.sweep(RIG, **AXES, out=tmp_path / "study", resume=True)
    found = files(tmp_path / "study")
    assert {name: found[name] for name in files(whole)} == files(whole)


def test_shards_together_are_the_study(whole, tmp_path):
    for i in range(1, 6):
        ss.sweep(RIG, **AXES, out=tmp_path / f"part{i}", shard=(i, 5), workers=1 + i % 2)
    parts = [tmp_path / f"part{i}" for i in range(1, 6)]
    with pytest.raises(ss.InputError, match=r"3 of 16 tiles are in none of the folders \(number 4, 9, 14\)"):
        ss.studies.merge(parts[:4], tmp_path / "merged")
    merged = ss.studies.merge(parts, tmp_path / "merged")
    assert files(tmp_path / "merged") == files(whole)
    xr.testing.assert_identical(merged, ss.open_study(whole))
    assert int((ss.studies.merge(parts[:4], tmp_path / "some", partial=True).status == 101).sum()) == 30


def test_shards_may_share_a_folder(whole, tmp_path):
    for i in (2, 1, 3):
        ss.sweep(RIG, **AXES, out=tmp_path / "study", shard=f"{i}/3")
    assert files(tmp_path / "study") == files(whole)


@each_row(
    ("change", "told"),
    [
        (dict(tilt_deg=1.8), "tilt_deg was 1.7, now it is 1.8"),
        (dict(omega=np.linspace(60.0, 301.0, 10)), "the values of omega are others"),
        (dict(rtol=1e-5), "option rtol was 1e-06, now it is 1e-05"),
        (dict(tile=11), "tile was 10, now it is 11"),
        (dict(mu0=0.2), "mu0 was not there, now it is 0.2"),
    ],
)
def test_the_folder_of_another_study_is_refused(whole, change, told):
    with pytest.raises(ss.InputError) as caught:
        ss.sweep(RIG, **{**AXES, **change}, out=whole, resume=True)
    assert told in str(caught.value)


def test_another_version_and_other_models_are_refused(tmp_path, monkeypatch):
    axes = dict(amplitude=[4e-4, 5e-4], tilt_deg=1.7, law="coulomb")

    def maker(amplitude, tilt_deg, law):
        return RIG(amplitude=amplitude, tilt_deg=tilt_deg, law=law)

    ss.sweep(maker, **axes, out=tmp_path / "study")

    def maker(amplitude, tilt_deg, law):
        return RIG(amplitude=1.0 * amplitude, tilt_deg=tilt_deg, law=law)  # other words for the same models

    ss.sweep(maker, **axes, out=tmp_path / "study", resume=True)

    def maker(amplitude, tilt_deg, law):
        return RIG(amplitude=amplitude, tilt_deg=tilt_deg, law=law, mu0=0.2)

    with pytest.raises(ss.InputError, match="the robot has other numbers or another kind"):
        ss.sweep(maker, **axes, out=tmp_path / "study", resume=True)
    ss.sweep(RIG, **axes, out=tmp_path / "other")
    monkeypatch.setattr(ss, "__version__", "9.9")
    with pytest.raises(ss.InputError, match=r"version of stickslip was 0.*, now it is 9.9"):
        ss.sweep(RIG, **axes, out=tmp_path / "other", resume=True)


OWN = """
from dataclasses import dataclass, field

import stickslip as ss
from stickslip.maths import cos, sin


class Base:
    def sliding(self, v, load):
        return SLIDING


@dataclass(frozen=True)
class Mine(Base):
    mu: float

    def breakaway(self, load):
        return -self.mu * load, self.mu * load


@dataclass(frozen=True)
class Shaken:
    amplitude: float
    omega: float
    period = property(lambda self: 6.283185307179586 / self.omega)
    velocity_scale = property(lambda self: self.amplitude * self.omega)

    def position(self, t):
        return self.amplitude * sin(self.omega * t)

    def velocity(self, t):
        return self.amplitude * self.omega * cos(self.omega * t)

    def acceleration(self, t):
        return DRIVEN


@dataclass(frozen=True)
class Slope:
    def across(self, gravity):
        return PRESSED

    def along(self, gravity):
        return 0.0 * gravity
"""
WRITTEN = {"SLIDING": "self.mu * load", "DRIVEN": "-self.amplitude * self.omega**2 * sin(self.omega * t)", "PRESSED": "gravity"}


@each_row(("changed", "inside"), each_once(WRITTEN, [False, True]))
def test_other_equations_of_a_part_of_ones_own_are_another_study(tmp_path, changed, inside):
    """Of a law, a drive or a track, alone or inside one of ours, and of what a class inherits; other words for them are not."""
    from stickslip.studies.model_identity import ModelIdentities
    from stickslip.studies.planning import SOLVER, planned

    def told(name, formulas):
        path = tmp_path / f"{name}.py"
        text = OWN.replace("self.mu * load, self", "2 * self.mu * load, 2 * self")
        for place, formula in formulas.items():
            text = text.replace(place, formula)
        path.write_text(text)
        spec = importlib.util.spec_from_file_location("own_parts", path)
        own = importlib.util.module_from_spec(spec)
        sys.modules["own_parts"] = own
        spec.loader.exec_module(own)
        law, drive, track = own.Mine(0.2), own.Shaken(5e-4, 200.0), own.Slope()
        if inside:
            law, drive, track = (
                ss.friction.Sum(law, ss.Viscous(0.1, 0.1)),
                ss.drives.Reversed(drive),
                ss.tracks.VaryingFriction(track, depth=0.2),
            )
        robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=drive, friction=law, track=track)
        return ModelIdentities(planned(robot, (), {"gravity": [9.8, 9.81]}, None, None, None, **SOLVER)).of_tiles([0])

    try:
        first = told("first", WRITTEN)
        assert told("again", WRITTEN) == first
        assert told("same", WRITTEN | {changed: f"1.0 * {WRITTEN[changed]}"}) == first
        assert told("other", WRITTEN | {changed: f"1.5 * {WRITTEN[changed]}"}) != first
    finally:
        sys.modules.pop("own_parts", None)


def test_what_cannot_be_written_is_told(whole, tmp_path, monkeypatch):
    with pytest.raises(ss.InputError, match="resume=True"):
        ss.sweep(RIG, **AXES, out=whole)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    with pytest.raises(ss.InputError, match="is not a study folder; give a new or an empty folder"):
        ss.sweep(RIG, **AXES, out=tmp_path / "mine")
    with pytest.raises(ss.InputError, match="is not a study folder"):
        ss.open_study(tmp_path / "mine")
    with pytest.raises(ss.InputError, match="give one with out="):
        ss.sweep(RIG, **AXES, resume=True)
    with pytest.raises(ss.InputError, match=r"allowed is i/n with i from 1 to n"):
        ss.sweep(RIG, **AXES, out=tmp_path / "new", shard="8/7")


def test_a_full_disk_is_told_and_can_be_resumed(whole, tmp_path, monkeypatch):
    study = tmp_path / "study"
    real = os.fsync

    def full(handle):
        if len(_tiles(study)) == 5:
            raise OSError(28, "No space left on device")
        real(handle)

    monkeypatch.setattr(folders.os, "fsync", full)
    with pytest.raises(StickslipError, match=r"the disk is full, .*resume=True"):
        ss.sweep(RIG, **AXES, out=study)
    monkeypatch.undo()
    assert len(files(study)) == 6  # five tiles and the axes: nothing half written
    ss.sweep(RIG, **AXES, out=study, resume=True)
    assert files(study) == files(whole)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_is_told(tmp_path):
    (tmp_path / "locked").mkdir(mode=0o500)
    with pytest.raises(ss.InputError, match="cannot be written to"):
        ss.sweep(RIG, **AXES, out=tmp_path / "locked" / "study")


def test_stopping_keeps_what_is_finished(whole, tmp_path, every_report):
    part = ss.sweep(RIG, **AXES, out=tmp_path / "study", progress=lambda now: not now.statuses)  # one tile is finished
    assert 0 < int((part.status != 101).sum()) < 160
    ss.sweep(RIG, **AXES, out=tmp_path / "study", resume=True)
    assert files(tmp_path / "study") == files(whole)


def test_rows_and_words_of_any_design_survive_the_folder(tmp_path):
    rows = ss.designs.table({"amplitude": [4e-4, np.nan, 6e-4], "law": ["coulomb", "lugre", "coulomb"], "tilt_deg": [1.7, 1.7, 2.0]})
    grid = ss.sweep(RIG, rows, incline=["folded", "gravity"])
    kept = ss.sweep(RIG, rows, incline=["folded", "gravity"], out=tmp_path / "study")
    xr.testing.assert_identical(kept.drop_attrs(deep=False), grid.drop_attrs(deep=False))
    assert json.loads(kept.attrs["notes"]) == {"not a finite number": 2}


def test_followed_axes_are_kept_line_by_line(tmp_path):
    axes = dict(
        amplitude=np.linspace(4e-4, 8e-4, 5), tilt_deg=[1.0, 1.7, 2.4], law=["coulomb", "lugre"], continue_along="amplitude", tile=2
    )
    kept = ss.sweep(RIG, **axes, out=tmp_path / "study")
    xr.testing.assert_identical(kept.drop_attrs(deep=False), ss.sweep(RIG, **axes).drop_attrs(deep=False))
    assert kept.mean_velocity.dims == ("tilt_deg", "law", "way", "amplitude")


# one file ------------------------------------------------------------------------------------------------------------


def test_export_to_each_format(whole, tmp_path):
    from scipy.io import loadmat

    grid = ss.open_study(whole)
    for suffix in (".nc", ".mat", ".csv"):
        assert ss.studies.export(whole, tmp_path / f"grid{suffix}").exists()
    again = ss.open_study(tmp_path / "grid.nc")
    xr.testing.assert_identical(again.drop_attrs(deep=False), grid.drop_attrs(deep=False))
    mat = loadmat(tmp_path / "grid.mat", squeeze_me=True)
    assert np.array_equal(mat["mean_velocity"], grid.mean_velocity) and mat["dimensions"].tolist() == ["law", "amplitude", "omega"]
    assert mat["motion_types"][mat["motion_type"][1, 7, 9]] == grid.motion_type.values[1, 7, 9]
    lines = (tmp_path / "grid.csv").read_text().splitlines()
    assert len(lines) == 161 and lines[0].startswith("law,amplitude [m],omega [rad/s]") and lines[-1].startswith("lugre,0.0008,300.0")
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]
    with pytest.raises(ss.InputError, match=r"allowed are \.nc"):
        ss.studies.export(whole, tmp_path / "grid.ods")


def test_what_is_exported_comes_back_as_it_was(tmp_path):
    """Words of any alphabet, values that are not words, columns of one's own, a part of the columns."""

    def maker(amplitude, oil, wet):
        return RIG(amplitude=amplitude, tilt_deg=1.7 if wet else 1.0, law="coulomb")

    grid = ss.sweep(maker, amplitude=[4e-4, 6e-4], oil=["Öl", "масло"], wet=[None, True])
    grid = grid.assign(
        twice=2 * grid.mean_velocity, best=grid.mean_velocity.max("amplitude"), fast=grid.mean_velocity > 1e-3, named=("oil", ["µ", ""])
    )
    grid = grid.assign_coords(lubricated=("oil", [True, False]))
    back = ss.open_study(ss.studies.export(grid, tmp_path / "grid.nc"))
    xr.testing.assert_identical(back.drop_attrs(deep=False), grid.drop_attrs(deep=False))
    assert back.wet.values.tolist() == [None, True] and back.oil.values.tolist() == ["Öl", "масло"] and back.fast.dtype == bool
    some = grid[["mean_velocity", "status"]].isel(amplitude=0)
    xr.testing.assert_identical(
        ss.open_study(ss.studies.export(some, tmp_path / "some.nc")).drop_attrs(deep=False), some.drop_attrs(deep=False)
    )
    kept = ss.sweep(maker, amplitude=[4e-4, 6e-4], oil=["Öl", "масло"], wet=[None, True], out=tmp_path / "study")
    assert kept.wet.values.tolist() == [None, True] and kept.oil.values.tolist() == ["Öl", "масло"]


def test_export_takes_any_dataset(tmp_path):
    """Columns over different dimensions, without one that is ours, and no dimension at all."""
    from scipy.io import loadmat

    diagram = xr.Dataset(
        {"mean_velocity": ("A", [0.1, 0.2]), "v": (("A", "point"), [[1.0, np.nan], [3.0, 4.0]], {"units": "m/s"})},
        {"A": [3e-4, 4e-4], "oil": ("A", ["", "Öl"]), "wet": ("A", np.array([None, True], object))},
    )
    for data in (diagram, diagram[["v"]]):
        lines = ss.studies.export(data, tmp_path / "diagram.csv").read_text(encoding="utf-8").splitlines()
        assert lines[0].startswith("A,point,oil,wet,") and lines[0].endswith("v [m/s]") and len(lines) == 5
        assert lines[4].startswith("0.0004,1,Öl,True,") and lines[4].endswith("4.0") and lines[2].endswith("nan")
    mat = loadmat(ss.studies.export(diagram, tmp_path / "diagram.mat"), squeeze_me=True)
    assert mat["v"].shape == (2, 2) and mat["oil"][1] == "Öl" and mat["wet"][0].size == 0 and mat["wet"][1]
    plain = diagram.drop_vars("wet")
    xr.testing.assert_equal(xr.load_dataset(ss.studies.export(plain, tmp_path / "plain.nc")), plain)
    with pytest.raises(ss.InputError, match="cannot be kept in a netCDF file"):
        ss.studies.export(diagram.assign(odd=("A", np.array([{}, []], object))), tmp_path / "diagram.nc")
    one = xr.Dataset({"exponent": ((), -0.5)})
    assert ss.studies.export(one, tmp_path / "one.csv").read_text().splitlines() == ["exponent", "-0.5"]
    for bad, told in (
        (diagram.v, "a DataArray is given; allowed is a study folder"),
        (xr.Dataset(), "no columns"),
        (None, "None is given"),
    ):
        with pytest.raises(ss.InputError, match=told):
            ss.studies.export(bad, tmp_path / "bad.csv")
    with pytest.raises(ss.InputError, match=r"export: cannot write .*that folder does not exist; make it first"):
        ss.studies.export(one, tmp_path / "nowhere" / "one.csv")


def test_export_to_parquet_says_what_to_install(whole, tmp_path, monkeypatch):
    try:
        import pyarrow.parquet as pq
    except ImportError:
        pass
    else:
        table = pq.read_table(ss.studies.export(whole, tmp_path / "grid.parquet"))
        assert table.num_rows == 160 and set(table["law"].to_pylist()) == {"coulomb", "lugre"}
        assert table["mean_velocity"].to_pylist() == ss.open_study(whole).mean_velocity.values.ravel().tolist()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ss.InputError, match=r'pip install "stickslip\[parquet\]"'):
        ss.studies.export(whole, tmp_path / "other.parquet")


# the command line ----------------------------------------------------------------------------------------------------


def test_the_commands(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "piezo_rig", "law=coulomb", "tilt_deg=1.7", "amplitude=1e-4..8e-4:6", "omega=60..300:4", "--tile", "5"]
    assert main([*words, "--out", "whole"]) == 0 and "24 cases" in capsys.readouterr().out
    assert main([*words, "--out", "whole"]) == 2 and "--resume" in capsys.readouterr().err
    assert main([*words, "--out", "whole", "--resume"]) == 0
    for i in (1, 2):
        assert main([*words, "--out", f"part{i}", "--shard", f"{i}/2"]) == 0
    assert main(["merge", "part1", "part2", "--out", "merged"]) == 0
    assert files(tmp_path / "merged") == files(tmp_path / "whole")
    assert main(["export", "merged", "grid.csv"]) == 0 and len(Path("grid.csv").read_text().splitlines()) == 25
    capsys.readouterr()
    assert main(["map", "merged", "--figure", "types.png", "--velocity", "speed.png", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["found"]
    assert found["cases"] == 24 and Path("types.png").stat().st_size > 5000 and found["fastest"]["amplitude"] == 8e-4
    assert main(["sweep", "piezo_rig", "law=coulomb", "tilt_deg=1..3", "amplitude=1e-4..8e-4", "--sobol", "8", "--out", "design.csv"]) == 0
    assert len(Path("design.csv").read_text().splitlines()) == 9
    Path("rows.csv").write_text("amplitude,tilt_deg\n4e-4,1.7\n6e-4,1.7\n")
    capsys.readouterr()
    assert main(["sweep", "piezo_rig", "law=coulomb", "--table", "rows.csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["columns"]["motion_type"] == ["I", "III"]


def test_a_function_of_ones_own_on_the_command_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("own_maker_here.py").write_text(
        "import stickslip as ss\ndef rig(amplitude):\n    return ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, law='coulomb')\n"
    )
    assert main(["sweep", "own_maker_here.py:rig", "amplitude=4e-4,6e-4", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["columns"]["motion_type"] == ["I", "III"]
    assert main(["sweep", "own_maker_here.py:rag", "amplitude=4e-4"]) == 2


# a cluster -----------------------------------------------------------------------------------------------------------

CLUSTER = """
import os, signal, sys, numpy as np, stickslip as ss
from dask.distributed import Client, LocalCluster

if __name__ == "__main__":
    axes = dict(law=["coulomb", "lugre"], amplitude=np.linspace(1e-4, 8e-4, 8), omega=np.linspace(60.0, 300.0, 10), tilt_deg=1.7, tile=10)
    killed = []

    def watch(now):
        if not killed and now.done > 20:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        ss.sweep(ss.presets.piezo_rig, **axes, out=sys.argv[1], client=client, progress=watch)
    assert killed
"""


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_gives_the_same(whole, tmp_path):
    pytest.importorskip("distributed")
    script = tmp_path / "cluster.py"
    script.write_text(CLUSTER)
    done = subprocess.run([sys.executable, str(script), str(tmp_path / "study")], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert files(tmp_path / "study") == files(whole)


def test_a_tile_travels_with_its_own_numbers():
    """What a worker is sent is short, and gives the tile again."""
    from stickslip.studies.planning import SOLVER, planned
    from stickslip.studies.solving import solved

    axes = {name: value for name, value in AXES.items() if name != "tile"}
    for along in (None, "amplitude"):
        plan = planned(RIG, (), axes, None, along, 7, **SOLVER)
        sent = pickle.dumps(plan.alone(plan.points(2)))
        there = solved(pickle.loads(sent), 0)[0]
        for name, values in solved(plan, 2)[0].items():
            np.testing.assert_array_equal(there[name], values)
    finer = planned(RIG, (), axes | {"amplitude": np.linspace(1e-4, 8e-4, 20_000)}, None, None, 7, **SOLVER)
    assert len(pickle.dumps(finer.alone(finer.points(2)))) < 12_000
    robot = planned(RIG(tilt_deg=1.7, amplitude=4e-4), (), {"drive.amplitude": [4e-4, 5e-4]}, None, None, 7, **SOLVER)
    there = solved(pickle.loads(pickle.dumps(robot.alone(robot.points(0)))), 0)
    assert there[0]["motion_type"].tolist() == solved(robot, 0)[0]["motion_type"].tolist()


def test_a_mechanism_travels_too():
    from stickslip.studies.planning import SOLVER, planned
    from stickslip.studies.solving import solved

    law = ss.Coulomb(0.3, 0.3)
    benches = [
        (ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, law, damping=0.01), {}),
        (ss.PulledMass(1.0, 2.0, 0.1, law), {"duration": 3.0}),
        (ss.BlockOnBelt(1.0, 2.0, 0.1, law), {"duration": 3.0}),
    ]
    for bench, span in benches:
        plan = planned(bench, (), {"damping": [0.01, 0.05]}, None, None, 7, **(SOLVER | span))
        there = solved(pickle.loads(pickle.dumps(plan.alone(plan.points(0)))), 0)[0]
        np.testing.assert_array_equal(there["displacement"], solved(plan, 0)[0]["displacement"])


@pytest.mark.slow
def test_a_study_over_processes_that_are_killed_loses_nothing_and_keeps_nothing_twice(tmp_path, monkeypatch):
    from stickslip.studies.folder import StudyFolder

    written, write, axes = [], StudyFolder.write, dict(amplitude=np.linspace(3e-4, 8e-4, 60), omega=np.linspace(120.0, 260.0, 40), tile=60)

    def killing(study, k, *tile):
        written.append(k)
        write(study, k, *tile)
        if len(written) in (5, 20):
            os.kill(multiprocessing.active_children()[0].pid, signal.SIGKILL)

    rig = dict(tilt_deg=1.7, law="lugre")
    ss.sweep(ss.presets.piezo_rig, **axes, **rig, out=tmp_path / "alone")
    monkeypatch.setattr(StudyFolder, "write", killing)
    ss.sweep(ss.presets.piezo_rig, **axes, **rig, out=tmp_path / "fleet", executor="processes:2")
    assert sorted(written) == list(range(40))
    for tile in (tmp_path / "alone" / "tiles").iterdir():
        assert (tmp_path / "fleet" / "tiles" / tile.name).read_bytes() == tile.read_bytes()
