"""Reading measured records: every format, with what files of the wild do; nothing is guessed, nothing is silently wrong."""

import struct
import sys
from itertools import product

import numpy as np
import pytest

import stickslip as ss
from measured import CYLINDER, CYLINDER_COLUMNS, LDV, LOOPS, MODE, needs_data, path
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_named, unit_of_heading

T = np.arange(400) / 1000
V = np.round(5 * np.sin(2 * np.pi * 20 * T) + 1, 6)


def write(folder, text, name="run.csv"):
    place = folder / name
    place.write_bytes(text if isinstance(text, bytes) else text.encode())
    return place


def rows(separator=",", decimal=".", head="t [s]{}v [mm/s]", end="\n", t=T, v=V):
    lines = [head.format(separator)] if head else []
    lines += [separator.join(f"{x:.6f}".replace(".", decimal) for x in pair) for pair in zip(t, v, strict=True)]
    return end.join(lines) + end


# text -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=repr)
@each_row(("separator", "decimal"), [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), ("  ", "."), (" ", ",")])
def test_separator_and_decimal_mark_are_found_out(tmp_path, separator, decimal, end):
    head = "t_[s]{}v_[mm/s]" if separator.strip() == "" and separator != "\t" else "t [s]{}v [mm/s]"
    rec = ss.read(write(tmp_path, rows(separator, decimal, head, end)))
    (c,) = rec.channels.values()
    assert np.array_equal(c.values, V) and np.allclose(c.t, T) and (c.unit, c.axis_unit) == ("mm/s", "s")
    assert c.rate == pytest.approx(1000, rel=1e-6) and rec["velocity"] is c and c.si == pytest.approx(V / 1000)


def test_a_table_without_headings_has_named_columns_without_units_and_says_so(tmp_path):
    rec = ss.read(write(tmp_path, rows(head="")))
    c = rec["column 2"]
    assert c.unit is None and list(rec.channels) == ["column 2"]
    assert any("column 2" in note and "units=" in note for note in rec.notes)


def test_the_first_step_that_needs_a_unit_shows_what_to_type(tmp_path):
    rec = ss.read(write(tmp_path, rows(head="t{}LDV")))
    with pytest.raises(InputError, match=r'units=\{"LDV": "m/s"\}'):
        rec["LDV"].si  # noqa: B018
    with pytest.raises(InputError, match=r'units=\{"t": "s"\}'):
        rec["LDV"].time  # noqa: B018
    known = ss.read(rec.source["path"], units={"LDV": "m/s", "t": "ms"})
    assert known["velocity"].rate == pytest.approx(1e6)


def test_headings_and_a_row_of_units_and_a_preamble_are_understood(tmp_path):
    text = "Scope 3000\nDate: 2020-04-30\n\nTime;Chan A\nms;mm/s\n" + rows(";", ",", head="")
    rec = ss.read(write(tmp_path, text))
    assert (rec["Chan A"].unit, rec["Chan A"].axis_unit) == ("mm/s", "ms") and "Scope 3000" in rec.source["preamble"]


def test_utf16_and_a_byte_order_mark_are_read(tmp_path):
    for code in ("utf-16", "utf-8-sig"):
        assert np.array_equal(ss.read(write(tmp_path, rows().encode(code)))["v"].values, V)


def test_gaps_jitter_and_missing_values_are_told(tmp_path):
    keep = np.ones(len(T), bool)
    keep[100:150] = False
    v = V.copy()
    v[200:205] = np.nan
    rec = ss.read(write(tmp_path, rows(t=T[keep], v=v[keep])))
    c = rec["v"]
    assert len(c.gaps) == 1 and c.gaps[0].start == pytest.approx(0.099) and c.gaps[0].length == pytest.approx(0.051)
    assert c.rate == pytest.approx(1000) and any("5 values missing" in n for n in rec.notes)


def test_times_that_fall_are_told(tmp_path):
    t = T.copy()
    t[50] = 0.3
    assert any("does not rise at 1 places" in n for n in ss.read(write(tmp_path, rows(t=t))).notes)


def test_a_damaged_line_is_left_out_and_told(tmp_path):
    lines = rows().splitlines()
    lines[10], lines[20] = "0.009,1.0,7", "0.019,#?x"
    rec = ss.read(write(tmp_path, "\n".join(lines) + "\n"))
    assert len(rec["v"]) == len(T) - 1 and np.isnan(rec["v"].values[18])
    assert any("line 11" in n for n in rec.notes) and any("line 21" in n for n in rec.notes)


def test_mixed_decimal_marks_are_an_error_or_told(tmp_path):
    half = rows(";", ",").splitlines()[:200] + rows(";", ".", head="").splitlines()[200:]
    with pytest.raises(InputError, match="decimal"):
        ss.read(write(tmp_path, "\n".join(half)))
    few = rows(";", ",").splitlines()
    few[77] = few[77].replace(",", ".")
    rec = ss.read(write(tmp_path, "\n".join(few) + "\n"))
    assert any("decimal mark" in n for n in rec.notes) and np.isnan(rec["v"].values[76])


def test_a_file_cut_short_is_told(tmp_path):
    text = rows()
    assert any("line break" in n for n in ss.read(write(tmp_path, text[:-3])).notes)
    assert any("left out" in n or "line break" in n for n in ss.read(write(tmp_path, text[: text.rindex(",")])).notes)


@each_row("data", [b"", b"   \n", b"hello world, this is not a table\n" * 30, bytes(range(256)) * 40, b"\x00" * 5000])
def test_what_is_no_record_is_an_error_that_says_so(tmp_path, data):
    with pytest.raises(InputError):
        ss.read(write(tmp_path, data))


def test_options_are_checked_together(tmp_path):
    with pytest.raises(InputError) as error:
        ss.read(write(tmp_path, rows()), units={"w": "m/s", "v": "furlong"}, roles={"v": "pet"}, rate=-1.0)
    assert len(error.value.problems) == 4
    with pytest.raises(InputError, match="names 3 columns"):
        ss.read(write(tmp_path, rows()), columns=["a", "b", "c"])
    with pytest.raises(InputError, match="cannot be read"):
        ss.read(tmp_path / "nowhere.csv")


@each_row(
    ("text", "factor", "quantity"),
    [("mm/s", 1e-3, "velocity"), ("µm", 1e-6, "position"), ("m/s²", 1.0, "acceleration"), ("m/s^2", 1.0, "acceleration"),
     ("uN", 1e-6, "force"), ("kPa", 1e3, "pressure"), ("bar", 1e5, "pressure"), ("ms", 1e-3, "time"), ("m s^-1", 1.0, "velocity"),
     ("min", 60.0, "time"), ("kOhm", 1e3, None), ("N/m", 1.0, None), ("Nm", 1.0, "torque"), ("mNm", 1e-3, "torque"), ("N·m", 1.0, "torque"),
     ("N-m", 1.0, "torque"), ("Nmm", 1e-3, "torque"), ("ft-lb", 1.3558179483314, "torque"),
     ("oz-in", 0.45359237 * 9.80665 * 0.0254 / 16, "torque"),
     ("in lbf", 0.112984829028, "torque"), ("kip", 4448.2216152605, "force"), ("lbf", 4.4482216152605, "force"), ("kgf", 9.80665, "force"),
     ("g0", 9.80665, "acceleration"), ("mm per s", 1e-3, "velocity"), ("in/s", 0.0254, "velocity"), ("RPM", np.pi / 30, "angular velocity"),
     ("rpm", np.pi / 30, "angular velocity"), ("deg/s", np.pi / 180, "angular velocity"), ("microns", 1e-6, "position"),
     ("in", 0.0254, "position"), ("Inches", 0.0254, "position"), ("mil", 2.54e-5, "position"), ("PSI", 6894.757293168, "pressure"),
     ("rad", 1.0, "angle"), ("mA", 1e-3, "current"), ("Volts", 1.0, "voltage"), ("Newton", 1.0, "force"), ("nm", 1e-9, "position")],
)  # fmt: skip
def test_units_are_those_of_the_si(text, factor, quantity):
    found = unit_named(text)
    assert found.factor == pytest.approx(factor, rel=1e-12) and found.quantity == quantity


@each_row("text", ["", "volts per fortnight", "xy", "m/", "mmm", "s/q", "Nq", "gg", "m0", "kkip", "lbfin"])
def test_what_is_no_unit_is_not_taken_for_one(text):
    assert unit_named(text) is None


def test_a_word_in_brackets_that_is_no_unit_stays_part_of_the_name():
    assert unit_of_heading("signal (filtered)") == ("signal (filtered)", None)


# MATLAB, HDF5, netCDF ---------------------------------------------------------------------------------------------


def test_our_own_matlab_and_netcdf_files_are_records_too(tmp_path):
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=10)
    for place in (run.to_mat(tmp_path / "run.mat"), run.save(tmp_path / "run.nc")):
        rec = ss.read(place)
        assert np.array_equal(rec["v"].values, run.v) and rec["velocity"].unit == "m/s" and rec["v"].axis_unit == "s"


@each_row("version", ["4", "5"])
def test_matlab_versions_4_and_5_are_read(tmp_path, version):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"t": T, "v": V, "fs": 1000.0}, format=version, oned_as="column")
    rec = ss.read(tmp_path / "a.mat")
    assert np.array_equal(rec["v"].values, V) and np.array_equal(rec["v"].t, T) and rec.source["fs"] == 1000.0


def test_matlab_7_3_is_read(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        for name, value in (("time", T), ("v", V)):
            made = file.create_dataset(name, data=value[None, :])
            made.attrs["MATLAB_class"] = np.bytes_("double")
        pair = np.zeros((1, 400), [("real", "f8"), ("imag", "f8")])
        pair["imag"] = V
        file.create_dataset("H", data=pair)
    data = (tmp_path / "a.mat").read_bytes()
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<H", 0x0200) + b"IM"
    rec = ss.read(write(tmp_path, head.ljust(512, b"\0") + data[512:], "b.mat"))
    assert rec.source["format"] == "MATLAB 7.3" and np.array_equal(rec["v"].values, V) and np.array_equal(rec["H"].values.imag, V)


def test_netcdf_3_and_4_are_read_with_units_and_fill_values(tmp_path):
    import xarray as xr

    v = V.copy()
    v[7] = np.nan
    data = xr.Dataset({"v": ("time", v, {"units": "mm/s"})}, {"time": ("time", T, {"units": "s"})})
    data.to_netcdf(tmp_path / "3.nc", engine="scipy", format="NETCDF3_64BIT", encoding={"v": {"_FillValue": -999.0}})
    data.to_netcdf(tmp_path / "4.nc", engine="h5netcdf", encoding={"v": {"_FillValue": -999.0}})
    for name, kind in (("3.nc", "netCDF3"), ("4.nc", "netCDF4")):
        rec = ss.read(tmp_path / name)
        assert rec.source["format"] == kind and np.array_equal(rec["v"].values, v, equal_nan=True) and rec["v"].unit == "mm/s"


# UFF58 ------------------------------------------------------------------------------------------------------------


def uff(values, kind=2, even=True, x=None, binary=None, unit="m/s", count=None):
    """A universal file with one function, ASCII or binary (binary="<" or ">")."""
    count = len(values) if count is None else count
    size, parts = {2: (4, 1), 4: (8, 1), 5: (4, 2), 6: (8, 2)}[kind]
    rows = [
        [*([] if even else [xi]), *([v] if parts == 1 else [v.real, v.imag])] for xi, v in zip(T if x is None else x, values, strict=False)
    ]
    head = ["NONE"] * 5 + ["    1         0    0         0 velocity           0   0 NONE               0   0"]
    head += [f"{kind:10d}{count:10d}{int(even):10d}  {0.0:11.5E}  {1e-3:11.5E}  {0.0:11.5E}"]
    head += [f"{17:10d}    0    0    0 {'Time':<20} {'s':<20}", f"{11:10d}    0    0    0 {'velocity':<20} {unit:<20}"]
    head += [f"{0:10d}    0    0    0 {'NONE':<20} {'NONE':<20}"] * 2
    if binary is None:
        numbers = [n for row in rows for n in row]
        wide = 4 if size == 8 else 6
        body = "\n".join(
            "".join(f"{n:{20 if size == 8 else 13}.{12 if size == 8 else 5}E}" for n in numbers[i : i + wide])
            for i in range(0, len(numbers), wide)
        )
        return ("    -1\n    58\n" + "\n".join(head) + "\n" + body + "\n    -1\n").encode()
    body = b"".join(struct.pack(f"{binary}{'' if even else 'f'}{'fd'[size == 8] * parts}", *row) for row in rows)
    first = f"    58b{1 if binary == '<' else 2:6d}{2:6d}{11:12d}{len(body):12d}     0     0           0           0"
    return ("    -1\n" + first + "\n" + "\n".join(head) + "\n").encode() + body + b"\n    -1\n"


@each_row(("even", "binary"), product([True, False], [None, "<", ">"]))
@pytest.mark.parametrize("kind", [2, 4, 5, 6])
def test_every_kind_of_universal_function_is_read(tmp_path, kind, even, binary):
    values = V.astype(complex) * (1 + 0.5j) if kind > 4 else V
    rec = ss.read(write(tmp_path, uff(values, kind, even, binary=binary)))
    c = rec["velocity"]
    accuracy = 1e-10 if kind in (4, 6) else 2e-5  # E13.5 and single precision hold six digits
    assert (
        np.allclose(c.values, values, rtol=accuracy, atol=accuracy)
        and np.allclose(c.t, T, atol=2e-6)
        and (c.unit, c.axis_unit) == ("m/s", "s")
    )


def test_a_universal_file_with_the_wrong_byte_order_is_an_error_that_says_what_to_type(tmp_path):
    data = uff(V, 4, binary="<").replace(b"    58b     1", b"    58b     2")
    with pytest.raises(InputError, match='byte_order="little"'):
        ss.read(write(tmp_path, data))
    assert np.allclose(ss.read(tmp_path / "run.csv", byte_order="little")["velocity"].values, V)


def test_a_universal_file_cut_short_is_told(tmp_path):
    for data in (uff(V), uff(V, 4, binary="<")):
        rec = ss.read(write(tmp_path, data[: len(data) // 2]))
        assert any("cut short" in n for n in rec.notes) and len(rec["velocity"]) < len(V)
    rec = ss.read(write(tmp_path, uff(V, count=500)))
    assert any("says 500 values and holds 400" in n for n in rec.notes)


# TDMS, XLSX -------------------------------------------------------------------------------------------------------


def test_tdms_is_read_with_its_waveform_times(tmp_path):
    nptdms = pytest.importorskip("nptdms", reason="the extra [io] is not installed")
    with nptdms.TdmsWriter(tmp_path / "a.tdms") as file:
        file.write_segment([nptdms.ChannelObject("g", "v", V, properties={"wf_increment": 1e-3, "unit_string": "mm/s"})])
    rec = ss.read(tmp_path / "a.tdms")
    assert np.array_equal(rec["v"].values, V) and rec["v"].rate == pytest.approx(1000) and rec["velocity"].unit == "mm/s"


def test_xlsx_is_read(tmp_path):
    openpyxl = pytest.importorskip("openpyxl", reason="the extra [io] is not installed")
    book = openpyxl.Workbook()
    for row in [["rig 3"], ["t [s]", "v [mm/s]"], *zip(T.tolist(), V.tolist(), strict=True)]:
        book.active.append(row)
    book.save(tmp_path / "a.xlsx")
    rec = ss.read(tmp_path / "a.xlsx")
    assert np.array_equal(rec["v"].values, V) and rec["v"].rate == pytest.approx(1000)


def test_without_the_library_the_error_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(InputError, match=r"stickslip\[io\]"):
        ss.read(write(tmp_path, b"TDSm" + bytes(100)))


# measured files ---------------------------------------------------------------------------------------------------


@needs_data
def test_the_friction_loops_have_units_and_gaps():
    rec = ss.read(path(LOOPS))
    assert {n: c.unit for n, c in rec.channels.items()} == {"Normal": "uN", "Position": "mm", "Friction": "uN"}
    assert [rec[role].name for role in ("load", "position", "force")] == ["Normal", "Position", "Friction"]
    c = rec["Friction"]
    # 42579 rows at 5 ms; 178 steps of 10 ms and one of 9 ms (counted by numpy.unique of the differences)
    assert len(c) == 42579 and c.rate == pytest.approx(200) and len(c.gaps) == 179 and c.axis_unit == "s"


@needs_data
def test_the_vibrometer_file_has_no_units_and_says_so():
    rec = ss.read(path(LDV))
    c = rec["LDV"]
    assert c.unit is None and len(c) == 15360 and c.rate == pytest.approx(1e7, rel=1e-6) and not c.gaps
    assert any("'LDV'" in n for n in rec.notes)


@needs_data
@each_row("which", CYLINDER)
def test_the_cylinder_files_have_no_headings(which):
    rec = ss.read(path(CYLINDER[which][0]))
    assert list(rec.channels) == [f"column {i}" for i in range(2, 8)] and all(c.unit is None for c in rec.channels.values())
    assert rec["column 7"].rate == pytest.approx(0.1)  # a sample every 10 of the first column's unit, which the file does not name
    named = ss.read(path(CYLINDER[which][0]), columns=CYLINDER_COLUMNS)
    assert named["force"].unit == "N" and named["force"].rate == pytest.approx(100) and len(named["force"].gaps) > 0


@needs_data
@each_row(
    ("name", "channel", "unit", "count", "rate"),
    [("pyuff_Sample_UFF58b_bin.uff", "Mic 01", "Pa", 79292, 65536), ("pyuff_binary8byte.uff", "sine 5 Hz", "g", 250, 100),
     ("pyuff_hbm_time-history-not-all-columns-filled.uff", "1x", "m/s²", 13, 20000)],
)  # fmt: skip
def test_the_universal_files_are_read(name, channel, unit, count, rate):
    c = ss.read(path(name))[channel]
    assert (c.unit, len(c)) == (unit, count) and c.rate == pytest.approx(rate, rel=1e-5)


@needs_data
def test_the_universal_files_hold_the_numbers_that_their_text_shows():
    c = ss.read(path("pyuff_hbm_time-history-not-all-columns-filled.uff"))["1x"]
    assert c.values[[0, 5, 12]].tolist() == [-3.81956, -3.63712, -5.84096]
    sine = ss.read(path("pyuff_binary8byte.uff"))["sine 5 Hz"]
    # Its name says what it is. It was computed in single precision: two roundings of a phase of up to 78 rad, 3.8e-6 each.
    assert np.allclose(sine.values, np.sin(2 * np.pi * 5 * sine.t), rtol=0.0, atol=8e-6)


@needs_data
def test_the_documented_mode_is_found():
    """212.0925 Hz is documented with the file; the damping ratio .00086 is from another fit to it."""
    (mode,) = ss.read(path(MODE)).modes()
    assert mode.frequency == pytest.approx(212.0925, abs=0.005) and mode.damping == pytest.approx(0.00086, rel=0.02)
    assert ss.read(path(MODE))["Time_chan_1"].rate == pytest.approx(1280, rel=1e-4)
