"""Damaged files: an error that says so, or a record with a note; never a crash, a hang, or another exception."""

import random
import time

import numpy as np
import pytest

import stickslip as ss
from measured import FOLDER, needs_data
from stickslip.errors import InputError
from test_read import T, V, rows, uff

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


def endure(sources, tmp_path, count, seed):
    rng, place = random.Random(seed), tmp_path / "damaged"
    for number in range(count):
        data = damaged(rng.choice(sources), rng)
        place.write_bytes(data)
        began = time.monotonic()
        try:
            rec = ss.read(place)
            if number % 10 == 0:
                str(rec.summary)
            assert all(len(c.values) == len(c.t) for c in rec.channels.values())
        except InputError as error:
            assert str(error)
        assert time.monotonic() - began < PATIENCE


def made(tmp_path):
    """Small files of all formats that need no extra."""
    from scipy.io import savemat

    savemat(tmp_path / "5.mat", {"t": T, "v": V, "s": {"a": V}, "name": "rig"}, do_compression=False)
    savemat(tmp_path / "5z.mat", {"t": T, "v": V}, do_compression=True)
    savemat(tmp_path / "4.mat", {"t": T, "v": V}, format="4")
    texts = [rows().encode(), rows(";", ",").encode(), rows("\t", head="").encode()]
    return [
        *texts,
        uff(V),
        uff(V, 4, binary="<"),
        uff(V, 2, even=False, binary=">"),
        *((tmp_path / n).read_bytes() for n in ("5.mat", "5z.mat", "4.mat")),
    ]


def test_damaged_files_are_errors_or_told(tmp_path):
    endure(made(tmp_path), tmp_path, 2000, seed=1)


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
    endure([(tmp_path / name).read_bytes() for name in ("a.h5", "3.nc", "4.nc", "a.tdms")], tmp_path, 1000, seed=4)


@pytest.mark.slow
def test_ten_thousand_damaged_files_are_errors_or_told(tmp_path):
    endure(made(tmp_path), tmp_path, 10_000, seed=2)


@needs_data
@pytest.mark.slow
def test_ten_thousand_damaged_measured_files_are_errors_or_told(tmp_path):
    from pathlib import Path

    whole = [p.read_bytes() for p in sorted(Path(FOLDER).iterdir()) if p.suffix in (".csv", ".txt", ".uff", ".mat")]
    endure([d if not d[:1].isdigit() and not d.startswith((b"Time", b"t,")) else d[:8000] for d in whole], tmp_path, 10_000, seed=3)


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
