"""Damaged files: an error that says so, or a record with a note; never a crash, a hang, or another exception."""

import contextlib
import importlib.util
import json
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import damage
import robot_files
import stickslip as ss
from measured import FOLDER, needs_data
from records.test_read import T, V, rows, uff
from stickslip.basics.errors import InputError
from stickslip.records.formats import FORMATS, format_of

#: No single file may take longer: the whole ones take 0.3 s at most; a hang takes for ever.
PATIENCE = 20.0


def damaged(data, rng):
    """One of the things that happen to files."""
    d, n = bytearray(data), len(data)
    near = rng.randrange(min(n, 1500) if rng.random() < 0.5 else n)
    kind = rng.choice(["cut", "flip", "insert", "delete", "garbage", "commas", "twice", "swap", "nan"])
    if kind == "cut":
        del d[near:]
    elif kind == "flip":
        for _ in range(rng.randint(1, 20)):
            d[min(near + rng.randrange(400), n - 1)] = rng.randrange(256)
    elif kind == "insert":
        d[near:near] = rng.randbytes(rng.randint(1, 50))
    elif kind == "delete":
        del d[near : near + rng.randint(1, 200)]
    elif kind == "garbage":
        d[near : near + 300] = rng.randbytes(300)
    elif kind == "commas":
        d = d.replace(b".", b",", rng.randint(1, 40))
    elif kind == "twice":
        d[near:near] = d[near : near + rng.randint(1, 300)]
    elif kind == "swap":
        piece = d[near : near + 64]
        d[near : near + 64] = piece[: len(piece) // 2 * 2][::-1] + piece[len(piece) // 2 * 2 :]
    else:
        d[near:near] = b"NaN " * rng.randint(1, 30)
    return bytes(d)


class Whole:
    """A file before anything happened to it, and what it says."""

    def __init__(self, data, place, separator=None, decimal="."):
        self.data, self.separator, self.decimal = data, separator, decimal
        place.write_bytes(data)
        self.rec = ss.read(place)
        self.table = {name: (c.t, c.values) for name, c in self.rec.channels.items()}

    @property
    def is_text(self):
        return self.rec.source["format"] == "text"

    def outcome(self, data, place):
        """What reading the damaged file came to: "error", "told", "unchanged" or "as written"; anything else fails."""
        place.write_bytes(data)
        try:
            rec = ss.read(place)
        except InputError as error:
            assert str(error)
            return "error"
        assert all(len(c.values) == len(c.t) for c in rec.channels.values())
        if set(rec.notes) - set(self.rec.notes):
            return "told"
        if self.same(rec):
            return "unchanged"
        assert self.as_written(rec, data), (self.rec, rec)
        return "as written"

    def same(self, rec):
        pairs = [(self.table.get(name), (c.t, c.values)) for name, c in rec.channels.items()]
        same = all(a and all(np.array_equal(x, y, equal_nan=True) for x, y in zip(a, b, strict=True)) for a, b in pairs)
        units = {n: (c.unit, c.axis_unit) for n, c in rec.channels.items()} == {
            n: (c.unit, c.axis_unit) for n, c in self.rec.channels.items()
        }
        return same and len(pairs) == len(self.table) and units

    def as_written(self, rec, data):
        """Whether a file that says other things, without any sign of it, is read as it is written."""
        return self.rows_as_written(rec, data) if self.is_text else self.few_changed(rec, data)

    def rows_as_written(self, rec, data):
        """Every row is read, with the marks that the file was made with, as Python reads the numbers."""
        text = data.decode("utf-8-sig") if data.isascii() else data.decode("utf-8", "replace")
        lines = [line for line in re.split("\r\n|\n|\r", text) if line.strip()]
        first = next(iter(rec.channels.values()))
        found = np.column_stack([first.t, *(c.values for c in rec.channels.values())])

        def numbers(line):
            return [
                float(cell.strip(' "').replace(self.decimal, ".").replace("D", "E").replace("d", "e"))
                for cell in line.split(self.separator)
            ]

        def row(line):
            with contextlib.suppress(ValueError):
                return numbers(line) if line.isprintable() or "\t" in line else None

        rows, before = lines[len(lines) - len(found) :], lines[: len(lines) - len(found)]
        return not any(len(row(line) or ()) == found.shape[1] for line in before) and found.tolist() == [row(line) for line in rows]

    def few_changed(self, rec, data):
        """No more numbers differ than bytes were touched; a file that has grown or shrunk shows at most where it was mended."""
        a, b = np.frombuffer(self.data, "u1"), np.frombuffer(data, "u1")
        touched = int((a != b).sum()) if len(a) == len(b) else 2
        changed = 0
        for old, new in zip(self.rec.channels.values(), rec.channels.values(), strict=False):
            if len(old) != len(new):
                return False
            changed += int(np.sum(old.values != new.values) - np.sum(np.isnan(old.values) & np.isnan(new.values)))
            stepped = len(new) > 2 and np.allclose(np.diff(new.t), new.t[1] - new.t[0], rtol=1e-6, atol=1e-9 * abs(new.t).max())
            changed += 0 if stepped else int(np.sum(old.t != new.t))  # an even axis is two numbers of the head
        return changed <= touched * len(rec.channels)


def endure(wholes, tmp_path, count, seed):
    rng, place, told = random.Random(seed), tmp_path / "damaged", Counter()
    for number in range(count):
        whole = rng.choice(wholes)
        data = damaged(whole.data, rng)
        began = time.monotonic()
        try:
            told[whole.outcome(data, place)] += 1
        except AssertionError:
            (tmp_path / "silent").write_bytes(data)
            raise
        if number % 50 == 0:
            with contextlib.suppress(InputError):
                str(ss.read(place).summary)
        assert time.monotonic() - began < PATIENCE
    print(dict(sorted(told.items())))
    return told


def made(tmp_path):
    """Small files of all formats that need no extra."""
    from scipy.io import savemat

    savemat(tmp_path / "5.mat", {"t": T, "v": V, "s": {"a": V}, "name": "rig"}, do_compression=False)
    savemat(tmp_path / "5z.mat", {"t": T, "v": V}, do_compression=True)
    savemat(tmp_path / "4.mat", {"t": T, "v": V}, format="4")
    texts = [(rows().encode(), ",", "."), (rows(";", ",").encode(), ";", ","), (rows("\t", head="").encode(), "\t", ".")]
    binary = [uff(V), uff(V, 4, binary="<"), uff(V, 2, even=False, binary=">")]
    binary += [(tmp_path / n).read_bytes() for n in ("5.mat", "5z.mat", "4.mat")]
    return [Whole(data, tmp_path / "whole", *marks) for data, *marks in [*texts, *((data,) for data in binary)]]


def test_damaged_files_are_errors_or_told(tmp_path):
    endure(made(tmp_path), tmp_path, 240, seed=1)


def test_damaged_files_of_other_libraries_are_errors_or_told(tmp_path):
    """HDF5, netCDF, TDMS and XLSX are read by libraries of their own."""
    nptdms = pytest.importorskip("nptdms", reason="the extra [io] is not installed")
    import h5py
    import xarray as xr

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["v"] = T, V
        file.create_dataset("z", data=V, compression="gzip")
    data = xr.Dataset({"v": ("time", V, {"units": "mm/s"})}, {"time": ("time", T, {"units": "s"})})
    data.to_netcdf(tmp_path / "3.nc", engine="scipy")
    data.to_netcdf(tmp_path / "4.nc", engine="h5netcdf")
    with nptdms.TdmsWriter(tmp_path / "a.tdms") as file:
        file.write_segment([nptdms.ChannelObject("g", "v", V, properties={"wf_increment": 1e-3})])
    wholes = [Whole((tmp_path / name).read_bytes(), tmp_path / "whole") for name in ("a.h5", "3.nc", "4.nc", "a.tdms")]
    endure(wholes, tmp_path, 1000, seed=4)


def test_every_format_has_a_file_that_is_damaged(tmp_path):
    pytest.importorskip("nptdms", reason="the extra [io] is not installed")
    there = {format_of(data).names for data in damage.bases(tmp_path).values()}
    without = {name for name, library in robot_files.LIBRARIES.items() if importlib.util.find_spec(library) is None}
    left = [known.names[0] for known in FORMATS if known.names not in there and known.names[0] not in without]
    assert not left, f"{', '.join(left)}: give bases in tests/damage.py a small file, which is then damaged in hundreds of ways"


def unharmed(tmp_path, count, parts, seed):
    """So many damaged files of every format, in processes that each has to live to its end: a record or an error of ours."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else tmp_path) as folder:
        (whole := Path(folder) / "whole").mkdir()
        for name, data in damage.bases(whole).items():
            (whole / name).write_bytes(data)
        told = Counter()
        for k in range(parts):
            command = [sys.executable, damage.__file__, folder, str(seed + k), str(count // parts)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=3000)
            if done.returncode:
                shutil.copy(Path(folder) / f"damaged{seed + k}", tmp_path / "harmful")
            assert done.returncode == 0, (done.returncode, done.stderr[-3000:], tmp_path / "harmful")
            found = json.loads(done.stdout)
            told += found["told"]
    print(f"\n{sum(told.values())} tried: {dict(told)}")
    assert sum(told.values()) == count and min(told.values()) > 0.1 * count


def test_no_damaged_file_of_any_format_does_harm(tmp_path):
    unharmed(tmp_path, 300, parts=1, seed=100)


@pytest.mark.slow
def test_thirty_thousand_damaged_files_of_every_format_do_no_harm(tmp_path):
    unharmed(tmp_path, 30_000, parts=6, seed=1)


@pytest.mark.slow
def test_ten_thousand_damaged_files_are_errors_or_told(tmp_path):
    endure(made(tmp_path), tmp_path, 10_000, seed=2)


@needs_data
@pytest.mark.slow
def test_ten_thousand_damaged_measured_files_are_errors_or_told(tmp_path):
    whole = [p.read_bytes() for p in sorted(Path(FOLDER).iterdir()) if p.suffix in (".csv", ".txt", ".uff", ".mat")]
    marks = {True: ("\t", "."), False: (",", ".")}
    cut = [d[: d.rindex(b"\n", 0, 8000) + 1] if is_table(d) else d for d in whole]
    wholes = [Whole(d, tmp_path / "whole", *(marks[b"\t" in d] if is_table(d) else ())) for d in cut]
    endure(wholes, tmp_path, 10_000, seed=3)


def is_table(data):
    return data[:1].isdigit() or data.startswith((b"Time", b"t,"))


def test_a_changed_digit_changes_that_number_alone(tmp_path):
    """What cannot be seen as damage is at least not spread."""
    rng = random.Random(5)
    lines = rows().splitlines()
    for _ in range(60):
        k = rng.randrange(1, len(lines))
        changed = list(lines)
        at = rng.choice([i for i, c in enumerate(changed[k]) if c.isdigit()])
        changed[k] = changed[k][:at] + str((int(changed[k][at]) + 1) % 10) + changed[k][at + 1 :]
        place = tmp_path / "one.csv"
        place.write_text("\n".join(changed) + "\n")
        c = ss.read(place)["v"]
        assert np.sum((c.values != V) | ~np.isclose(c.t, T, rtol=0.0, atol=1e-9)) == 1
