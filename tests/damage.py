"""Records of every format, what happens to files, and a process that reads the outcome: ``python damage.py FOLDER SEED COUNT``.

It is a process of its own because a file may end it, and it has 4 GB of memory because a file may ask for more: an HDF5 text may, whose
length (a number of 32 bits) the library believes until it has looked for the text.
"""

import contextlib
import json
import random
import resource
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import robot_files
import stickslip as ss
from stickslip.basics.errors import StickslipError

#: Memory [bytes], and seconds of a processor for one file: whole ones take a tenth of one; a loop without end takes for ever.
MEMORY, PATIENCE = 4 << 30, 60.0
NUMBERS = [0, 1, 2, 7, 255, 256, 65535, 2**20, 2**27, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**63 - 1, 2**63, 2**64 - 1]


def bases(folder):
    """A small record in every format that is read, by name."""
    import h5py
    import xarray as xr
    from scipy.io import savemat

    from records.test_read import T, V, rows, uff

    short, comma, bare = ("".join(text.splitlines(True)[:60]) for text in (rows(), rows(";", ","), rows("\t", head="")))
    made = {"a.csv": short.encode(), "b.csv": comma.encode(), "a.txt": bare.encode(), "utf16.csv": short.encode("utf-16")}
    made["quoted.csv"] = b'"t [s]","v [mm/s]"\n' + b'"0.1","2"\n' * 40
    made |= {
        "a.uff": uff(V),
        "b.uff": uff(V, 4, binary="<"),
        "c.uff": uff(V, 2, even=False, binary=">"),
        "d.uff": uff(V) + uff(V, 4, binary=">"),
    }
    savemat(folder / "5.mat", {"t": T, "v": V, "s": {"a": V, "b": {"c": V[:5]}}, "name": "rig", "z": V + 1j}, do_compression=False)
    savemat(folder / "5z.mat", {"t": T, "v": V, "s": {"a": V}}, do_compression=True)
    savemat(folder / "4.mat", {"t": T, "v": V, "z": V + 1j}, format="4")
    for name, head in (("a.h5", b""), ("73.mat", b"MATLAB 7.3 MAT-file".ljust(512))):
        with h5py.File(folder / name, "w", userblock_size=len(head)) as file:
            file["t"], file["g/v"], file["s"] = T, V, "text"
            file.attrs["note"], file["t"].attrs["units"], file["g/v"].attrs["scale_factor"] = ["a", "b"], "s", 2.0
            file.create_dataset("z", data=V, compression="gzip", shuffle=True, fletcher32=True, chunks=(16,))
            file.create_dataset("w", data=V, compression="lzf")
        with (folder / name).open("r+b") as file:
            file.write(head)
    with h5py.File(folder / "new.h5", "w", libver="latest") as file:
        file["t"], file["v"] = T, V
        file.create_dataset("z", data=V, maxshape=(None,), chunks=(16,), compression="gzip")
        file.attrs.update({f"a{k}": k for k in range(12)})
    data = xr.Dataset({"v": ("time", V, {"units": "mm/s", "_FillValue": -1.0})}, {"time": ("time", T, {"units": "s"})})
    data.to_netcdf(folder / "3.nc", engine="scipy")
    data.to_netcdf(folder / "4.nc", engine="h5netcdf")
    ss.Record.of(T[:60], {"v [m/s]": V[:60]}).save(folder / "own.csv")
    _run(folder / "own.nc")
    with contextlib.suppress(ImportError):
        _extras(folder, T, V)
    made["bam.json"] = robot_files.bam(60)
    for name, write in robot_files.WRITERS.items():
        with contextlib.suppress(ImportError):
            write(folder / name)
    return made | {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def _run(path):
    from stickslip.results.dense_output import HarmonicArcs

    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    still = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    ss.results.Trajectory(robot, still, periods=1, settle=0, rtol=1e-6, method="by hand").save(path)


def _extras(folder, t, v):
    import nptdms
    import openpyxl

    with nptdms.TdmsWriter(folder / "a.tdms") as file:
        file.write_segment([nptdms.ChannelObject("g", "v", v, properties={"wf_increment": 1e-3, "unit_string": "m/s"})])
        file.write_segment([nptdms.ChannelObject("g", "v", v), nptdms.ChannelObject("g", "n", v.astype("i2"))])
    book = openpyxl.Workbook()
    for row in [["t [s]", "v [mm/s]"], *zip(t.tolist(), v.tolist(), strict=True), ["text", None]]:
        book.active.append(row)
    book.create_sheet("second")
    book.save(folder / "a.xlsx")


def hurt(data, others, rng):
    """One or a few of the things that happen to files, or are made to happen."""
    d = bytearray(data)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        n = max(len(d), 1)
        at = rng.randrange(min(n, rng.choice([64, 600, 3000, n])))
        match rng.choice(["cut", "flip", "bit", "length", "length", "insert", "delete", "splice", "twice", "zero", "full"]):
            case "cut":
                del d[at:]
            case "flip":
                for _ in range(rng.randint(1, 20)):
                    d[min(at + rng.randrange(100), n - 1) : at] = b""
                    if d:
                        d[rng.randrange(len(d))] = rng.randrange(256)
            case "bit":
                if d:
                    d[min(at, len(d) - 1)] ^= 1 << rng.randrange(8)
            case "length":  # a number of four or eight bytes, as a size would be
                size = rng.choice([2, 4, 8])
                number = rng.choice([rng.choice(NUMBERS), max(int.from_bytes(d[at : at + size], "little") + rng.randint(-9, 9), 0)])
                d[at : at + size] = (number % 256**size).to_bytes(size, rng.choice(["little", "big"]))
            case "insert":
                d[at:at] = rng.randbytes(rng.randint(1, 50))
            case "delete":
                del d[at : at + rng.randint(1, 200)]
            case "splice":
                other = rng.choice(others)
                d[at:] = other[rng.randrange(len(other)) :]
            case "twice":
                d[at:at] = d[at : at + rng.randint(1, 300)] * rng.randint(1, 5)
            case "zero":
                d[at : at + 40] = bytes(40)
            case "full":
                d[at : at + 16] = b"\xff" * 16
    return bytes(d)


def main(folder, seed, count):
    """Read so many damaged files; the last line of the output says what came of them."""
    rng, told, slowest = random.Random(seed), Counter(), 0.0
    whole = {path.name: path.read_bytes() for path in sorted((folder / "whole").iterdir())}
    others, place = [*whole.values()], folder / f"damaged{seed}"
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("error")
    for number in range(count):
        name = rng.choice([*whole])
        place.write_bytes(hurt(whole[name], others, rng))  # stays there if this process ends
        began = time.process_time()
        try:
            rec = (ss.load if name == "own.nc" and rng.random() < 0.5 else ss.read)(place)
            assert rec.model if name == "own.nc" and not isinstance(rec, ss.Record) else number % 20 or str(rec.summary)
            told["read"] += 1
        except StickslipError as error:
            assert str(error)
            told["refused"] += 1
        slowest = max(slowest, time.process_time() - began)
        assert slowest < PATIENCE, name
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
    print(json.dumps({"told": told, "slowest": slowest, "peak": peak}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
