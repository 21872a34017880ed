"""What we write ourselves is read back and compared without options."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.show.cli import main

ROBOT = ["piezo_rig", "tilt_deg=1.7", "amplitude=5.525e-4", "law=coulomb"]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The files of `stickslip run --data` in every format."""
    place = tmp_path_factory.mktemp("ours")
    for kind in ("csv", "nc", "mat"):
        assert main(["run", *ROBOT, "periods=40", "--data", str(place / f"run.{kind}")]) == 0
    return place


@each_row("kind", ["csv", "nc", "mat"])
def test_a_run_that_we_wrote_is_read_back_with_its_numbers_units_and_roles(files, kind):
    run = ss.load(files / "run.nc")
    rec = ss.read(files / f"run.{kind}")
    for name in ("x", "v", "acceleration", "xi", "xi_rate", "friction_force"):
        assert np.array_equal(rec[name].values, getattr(run, name)) and rec[name].unit and rec[name].axis_unit == "s", name
    assert np.array_equal(rec["v"].t, run.t)
    for role, name in (("velocity", "v"), ("position", "x"), ("drive", "xi_rate"), ("force", "friction_force")):
        assert rec[role].name == name
    assert rec.synthetic and any("computed, not measured" in note for note in rec.notes)


@pytest.mark.parametrize("kind", ["csv", "nc", "mat"])
def test_a_run_that_we_wrote_is_compared_without_options(files, kind):
    """P1: the record is the exact Coulomb run, so Coulomb fits it to the accuracy of the frequency, and its mean is that of the table."""
    rec, robot = ss.read(files / f"run.{kind}"), ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4)
    found = ss.compare(rec, robot)
    assert found.best.label == "Coulomb" and found["Coulomb"].rms < 0.002 * np.ptp(rec["v"].values)
    assert found.record.mean_velocity == pytest.approx(0.002014682, abs=2e-6)


def test_the_commands_take_our_own_files(files, capsys):
    for kind in ("csv", "nc", "mat"):
        assert main(["read", str(files / f"run.{kind}")]) == 0
        assert main(["compare", *ROBOT[:3], "--record", str(files / f"run.{kind}")]) == 0
        assert "over the cycle Coulomb is closest" in capsys.readouterr().out


def test_the_explorers_file_is_a_record_too(tmp_path):
    from stickslip.show.explorer.exports import export
    from stickslip.show.explorer.requests import State

    (tmp_path / "run.csv").write_bytes(export("run.csv", State(law="coulomb")))
    rec = ss.read(tmp_path / "run.csv")
    assert rec.synthetic and rec["drive"].name == "xi_rate" and rec["velocity"].unit == "m/s"


def test_a_name_says_more_than_a_unit_and_what_is_typed_most():
    t = np.arange(20.0)
    rec = ss.Record.of(t, {"v [m/s]": t, "reference [m/s]": t})
    assert rec["velocity"].name == "v" and rec["reference"].role is None
    typed = ss.Record.of(t, {"v [m/s]": t, "reference [m/s]": t}, roles={"reference": "velocity"})
    assert typed["velocity"].name == "reference"
    with pytest.raises(InputError, match=r"--role a=velocity"):
        ss.Record.of(t, {"a [m/s]": t, "b [m/s]": t})["velocity"]


@each_row("channels", [("velocity",), ("velocity", "drive", "force"), ("position", "absolute velocity", "acceleration")])
def test_a_record_that_is_saved_comes_back(tmp_path, channels):
    rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), noise=1e-4, seed=2, channels=channels)
    again = ss.read(rec.save(tmp_path / "rig.csv"))
    assert list(again) == list(rec) and again.synthetic
    for name in rec:
        assert np.array_equal(again[name].values, rec[name].values) and np.array_equal(again[name].t, rec[name].t)
        assert (again[name].unit, again[name].axis_unit, again[name].role) == (rec[name].unit, "s", rec[name].role)
    assert sum("computed, not measured" in note for note in again.notes) == 1


def test_a_measured_record_is_not_called_synthetic_when_it_is_saved(tmp_path):
    t = np.arange(50) / 100
    rec = ss.read(ss.Record.of(t, {"v, left [mm/s]": np.sin(t), 'the "raw" one': np.cos(t)}).save(tmp_path / "a.csv"))
    assert not rec.synthetic and list(rec) == ["v, left", 'the "raw" one']
    assert rec["v, left"].unit == "mm/s" and rec['the "raw" one'].unit is None


def test_roles_that_no_name_tells_come_back(tmp_path):
    t = np.arange(50) / 100
    columns = {"F1 [N]": t, "F2, raw [N]": 2 * t, "v [m/s]": t, 'the "other" [m/s]': t, "x [m]": t}
    roles = {"F1": "load", "F2, raw": "force", 'the "other"': "velocity"}
    rec = ss.Record.of(t, columns, roles=roles)
    path = rec.save(tmp_path / "a.csv")
    again = ss.read(path)
    assert {n: again[n].role for n in again} == {n: rec[n].role for n in rec} and again["load"].name == "F1" and again["v"].role is None
    assert all(np.array_equal(again[n].values, rec[n].values) for n in rec)
    typed = ss.read(path, roles={"F1": "force"})
    assert typed["force"].name == "F1" and "load" not in typed  # what is typed says most
    assert not ss.Record.of(t, {"v [m/s]": t}).save(tmp_path / "b.csv").read_text().startswith("#")  # where names tell, nothing is added


def test_what_cannot_be_saved_is_said(tmp_path):
    t = np.arange(50) / 100
    rec = ss.Record.of(t, {"v [m/s]": np.sin(t)})
    with pytest.raises(InputError, match=r"ends in '\.xlsx'; allowed is \.csv"):
        rec.save(tmp_path / "a.xlsx")
    other = ss.Record.of(t[:20], {"F [N]": t[:20]})["F"]
    with pytest.raises(InputError, match="F and v are not sampled at the same times"):
        rec.replace(channels={**rec.channels, "F": other}).save(tmp_path / "a.csv")
    with pytest.raises(InputError, match="that folder does not exist"):
        rec.save(tmp_path / "nowhere" / "a.csv")


def test_no_column_is_lost_where_names_stand_twice(tmp_path):
    """The third is not called after the second, which a column of the file has as its name."""
    rows = np.arange(40.0).reshape(10, 4)
    (tmp_path / "a.csv").write_text("t [s],x [mm],x (2) [mm],x [mm]\n" + "\n".join(",".join(map(str, row)) for row in rows))
    rec = ss.read(tmp_path / "a.csv")
    assert [rec[name].values[0] for name in ("x", "x (2)", "x (3)")] == [1.0, 2.0, 3.0]
    assert any("names stand over several columns: the later ones are called 'x (3)'" in note for note in rec.notes)
    with pytest.raises(InputError, match=r"columns names 'x' twice, the second time as 'x \[m\]'"):
        ss.Record.of(rows[0], {"x [mm]": rows[0], "x [m]": rows[0]})
