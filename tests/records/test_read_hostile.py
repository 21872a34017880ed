"""Files that are made to harm: their data lie elsewhere, or a few bytes stand for gigabytes. They are refused, and name what to type."""

import io
import itertools
import re
import struct
import subprocess
import sys
import zipfile
import zlib

import h5py
import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics import hdf5
from stickslip.results.dense_output import HarmonicArcs
from stickslip.studies.seals import Damaged, read_sealed

V = np.arange(10.0)
SECRET = "not for a record " * 20


def refused(path, reads=ss.read):
    with pytest.raises(ss.InputError) as caught:
        reads(path)
    return str(caught.value)


# data elsewhere ---------------------------------------------------------------------------------------------------


def external(file, folder):
    (folder / "secret.txt").write_text(SECRET)
    file.create_dataset("v", shape=(len(SECRET),), dtype="u1", external=[(str(folder / "secret.txt"), 0, len(SECRET))])


def virtual(file, folder):
    with h5py.File(folder / "target.h5", "w") as other:
        other["v"] = V
    layout = h5py.VirtualLayout(shape=(10,), dtype="f8")
    layout[:] = h5py.VirtualSource(str(folder / "target.h5"), "v", shape=(10,))
    file.create_virtual_dataset("v", layout)


def virtual_within(file, folder):
    file["w"] = V
    layout = h5py.VirtualLayout(shape=(10,), dtype="f8")
    layout[:] = h5py.VirtualSource(".", "w", shape=(10,))
    file.create_virtual_dataset("v", layout)


def linked(file, folder):
    with h5py.File(folder / "target.h5", "w") as other:
        other["v"] = V
    file["v"] = h5py.ExternalLink(str(folder / "target.h5"), "v")


def linked_group(file, folder):
    with h5py.File(folder / "target.h5", "w") as other:
        other["g/v"] = V
    file["g"] = h5py.ExternalLink(str(folder / "target.h5"), "g")


ELSEWHERE = (external, virtual, virtual_within, linked, linked_group)


@pytest.mark.parametrize("lay", ELSEWHERE)
@each_row("group", ["", "deep/down/"])
def test_numbers_that_lie_elsewhere_are_not_followed(tmp_path, lay, group):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = np.arange(len(SECRET)) * 1e-3
        lay(file.require_group(group) if group else file, tmp_path)
    said = refused(tmp_path / "a.h5")
    assert "not followed" in said and "export the record" in said


@each_row("lay", ELSEWHERE)
def test_a_run_whose_numbers_lie_elsewhere_is_not_loaded(tmp_path, lay):
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    arcs = HarmonicArcs(
        np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77
    )  # fmt: skip
    path = ss.results.Trajectory(robot, arcs, periods=1, settle=0, rtol=1e-6, method="by hand").save(tmp_path / "run.nc")
    assert ss.load(path).model == robot
    with h5py.File(path, "r+") as file:
        lay(file["pieces"], tmp_path)
    assert "not followed" in refused(path, ss.load)


@each_row("lay", ELSEWHERE)
def test_a_grid_and_a_tile_whose_numbers_lie_elsewhere_are_not_opened(tmp_path, lay):
    path = tmp_path / "grid.nc"
    with h5py.File(path, "w") as file:
        file.attrs["stickslip_content"] = "sweep"
        lay(file, tmp_path)
    assert "not followed" in refused(path, ss.open_study)
    with pytest.raises(Damaged, match="not followed"):
        read_sealed(path, None, lambda file: file["v"][...])


def test_a_soft_link_is_left_out_and_told(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["v"] = V, V
        file["again"], file["nowhere"] = h5py.SoftLink("/v"), h5py.SoftLink("/x")
    rec = ss.read(tmp_path / "a.h5")
    assert list(rec) == ["v"] and sum("it is a link" in note for note in rec.notes) == 2


def test_groups_without_end_have_one(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["v"], group = V, V, file.create_group("g")
        for k in range(30):
            group[f"again{k}"], group[f"up{k}"] = group, file
    rec = ss.read(tmp_path / "a.h5")
    assert "v" in rec.channels and any("no end" in note for note in rec.notes)


# a few bytes for gigabytes ----------------------------------------------------------------------------------------


def never_written(folder):
    with h5py.File(folder / "a", "w") as file:
        for k in range(6):
            file.create_dataset(f"v{k}", shape=(2**28,), dtype="f8", chunks=(2**22,), compression="gzip", fillvalue=0.0)


def small_types(folder):
    with h5py.File(folder / "a", "w") as file:
        file.create_dataset("v", shape=(2**30,), dtype="i1", chunks=(2**22,))


def many_names(folder):
    with h5py.File(folder / "a", "w") as file:
        file.create_dataset("v", data=np.zeros(2**20), chunks=(2**16,), compression="gzip")
        for k in range(2000):
            file[f"v{k}"] = file["v"]


def a_huge_chunk(folder):
    with h5py.File(folder / "a", "w") as file:
        file.create_dataset("v", shape=(10,), maxshape=(None,), dtype="f8", chunks=(2**28,))


def a_chunk_packed_too_well(folder):
    """A chunk that declares 800 bytes and is half a GB of zeros."""
    with h5py.File(folder / "a", "w") as file:
        made = file.create_dataset("v", shape=(100,), dtype="f8", chunks=(100,), compression="gzip")
        made.id.write_direct_chunk((0,), zeros(2**29))


def packed_twice(folder):
    with h5py.File(folder / "a", "w") as file:
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_chunk((100,))
        made.set_deflate(9)
        made.set_scaleoffset(h5py.h5z.SO_INT, 0)
        h5py.h5d.create(file.id, b"v", h5py.h5t.NATIVE_INT64, h5py.h5s.create_simple((100,)), made)


def zeros(size):
    """Zeros, deflated to a thousandth of their size: a piece that refers to nothing before it, again and again."""
    machine = zlib.compressobj(9, wbits=-15)
    piece, end = machine.compress(b"\0" * 2**20) + machine.flush(zlib.Z_FULL_FLUSH), machine.flush()
    return b"\x78\xda" + (size >> 20) * piece + end + struct.pack(">I", size % 65521 << 16 | 1)  # with Adler's sum of zeros


def mat_variable(body):
    packed = zlib.compressobj(9)
    return packed.compress(body) + packed.flush()


def mat(folder, *elements):
    (folder / "a").write_bytes(b"MATLAB 5.0".ljust(124, b" ") + b"\x00\x01IM" + b"".join(elements))


def mat_that_declares(folder):
    packed = mat_variable(struct.pack("<II", 14, 2**32 - 8) + b"\0" * 1000)
    mat(folder, struct.pack("<II", 15, len(packed)) + packed)


def mat_that_hides(folder):
    packed = zeros(2**29)  # a tag of zeros declares nothing
    mat(folder, struct.pack("<II", 15, len(packed)) + packed)


def mat_of_bytes(folder):
    """Six variables of 16 MB of one-byte numbers, each of which becomes one of eight bytes."""
    n = 2**24

    def variable(name):
        head = struct.pack("<IIIIIIii", 6, 8, 6, 0, 5, 8, 1, n) + struct.pack("<HH4s", 1, 1, name) + struct.pack("<II", 2, n)
        machine = zlib.compressobj(1)
        packed = machine.compress(struct.pack("<II", 14, len(head) + n) + head)
        packed += b"".join(machine.compress(b"\1" * 2**20) for _ in range(n >> 20)) + machine.flush()
        return struct.pack("<II", 15, len(packed)) + packed

    mat(folder, *map(variable, (b"u", b"v", b"w", b"x", b"y", b"z")))


CELLS = "<row r='{0}'><c r='A{0}'><v>{0}</v></c><c r='B{0}'><v>1.5</v></c></row>"
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
SHEET = f'<worksheet xmlns="{MAIN}"><dimension ref="{{}}"/><sheetData>{{}}</sheetData></worksheet>'


def xlsx(folder, sheet, **others):
    """A file of Excel, some of whose parts are replaced."""
    openpyxl = pytest.importorskip("openpyxl", reason="the extra [io] is not installed")
    book, whole = openpyxl.Workbook(), io.BytesIO()
    book.active.append([1, 2])
    book.active.append(["text", 2])
    book.save(whole)
    with zipfile.ZipFile(whole) as old, zipfile.ZipFile(folder / "a", "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            part = {"xl/worksheets/sheet1.xml": sheet, **others}.get(name) or old.read(name)
            with new.open(name, "w") as file:
                for piece in [part] if isinstance(part, (bytes, str)) else part:
                    file.write(piece.encode() if isinstance(piece, str) else piece)


def a_row_far_below(folder):
    xlsx(folder, SHEET.format("A1", CELLS.format(1) + CELLS.format(10**9)))


def a_dimension_that_is_not_true(folder):
    xlsx(folder, SHEET.format("A1:XFD1048576", "".join(map(CELLS.format, range(1, 200)))))


def wide_rows(folder):
    xlsx(
        folder,
        SHEET.format("A1", "".join(f"<row r='{r}'><c r='A{r}'><v>1</v></c><c r='XFD{r}'><v>2</v></c></row>" for r in range(1, 4000))),
    )


def many_elements(folder):
    head, _, tail = SHEET.format("A1", CELLS.format(1) + "|").partition("|")
    xlsx(folder, [head, *["<x/>" * 250_000] * 140, tail])


def shared_strings(folder):
    strings = [f'<sst xmlns="{MAIN}">', *["<si><t>x</t></si>" * 60_000] * 140, "</sst>"]
    xlsx(folder, SHEET.format("A1", CELLS.format(1)), **{"xl/sharedStrings.xml": strings, "xl/styles.xml": strings})


def entities(folder, encoding="utf-8"):
    rows = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    text = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE w [<!ENTITY e0 "1">{rows}]>' + SHEET.format(
        "A1", "<row><c><v>&e11;</v></c></row>"
    )
    xlsx(folder, text.encode(encoding))


def entities_in_other_letters(folder):
    entities(folder, "utf-16")


def netcdf3_that_overlaps(folder):
    """A thousand variables that are all the same megabyte."""
    n, names = 2**18, 1000
    head = b"CDF\x01" + struct.pack(">i", 0) + struct.pack(">ii", 10, 1) + struct.pack(">i4si", 1, b"t", n) + struct.pack(">ii", 0, 0)
    head += struct.pack(">ii", 11, names)
    for k in range(names):
        head += (
            struct.pack(">i4s", 4, b"%04d" % k)
            + struct.pack(">ii", 1, 0)
            + struct.pack(">ii", 0, 0)
            + struct.pack(">iii", 4, 4 * n, 40_000)
        )
    (folder / "a").write_bytes(head.ljust(40_000, b"\0") + b"\0" * 4 * n)


def tdms(folder, **properties):
    nptdms = pytest.importorskip("nptdms", reason="the extra [io] is not installed")
    with nptdms.TdmsWriter(folder / "a") as file:
        file.write_segment([nptdms.ChannelObject("g", "v", V, properties=properties)])


def tdms_that_declares(folder):
    tdms(folder)
    data = (folder / "a").read_bytes()
    assert data.count(struct.pack("<IQ", 1, len(V))) == 1  # one dimension, as many numbers
    (folder / "a").write_bytes(data.replace(struct.pack("<IQ", 1, len(V)), struct.pack("<IQ", 1, 2**40)))


def tdms_scaled_without_end(folder):
    tdms(folder, NI_Number_Of_Scales=2**31 - 1)


BOMBS = (
    never_written, small_types, many_names, a_huge_chunk, a_chunk_packed_too_well, packed_twice, mat_that_declares, mat_that_hides,
    mat_of_bytes, a_row_far_below, wide_rows, many_elements, shared_strings, entities, entities_in_other_letters, netcdf3_that_overlaps,
    tdms_scaled_without_end,
)  # fmt: skip
READER = """
import resource, sys, stickslip as ss, stickslip.records, openpyxl, h5py, scipy.io
for path in sys.argv[1:]:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        print("READ", ss.read(path))
    except ss.InputError as error:
        print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) >> 10, " ".join(str(error).split()), flush=True)
"""


def test_what_unpacks_without_end_is_refused_before_it_is_unpacked(tmp_path):
    """They unpack to more than is allowed; a process of its own tells how many MB its peak grew by, and lives to the last of them."""
    for make in BOMBS:
        (tmp_path / make.__name__).mkdir()
        make(tmp_path / make.__name__)
    paths = [str(tmp_path / make.__name__ / "a") for make in BOMBS]
    done = subprocess.run([sys.executable, "-c", READER, *paths], capture_output=True, text=True, timeout=300)
    said = done.stdout.splitlines()
    assert done.returncode == 0 and len(said) == len(BOMBS), (said, done.stderr)
    for make, line in zip(BOMBS, said, strict=True):
        memory, words = line.split(" ", 1)
        assert memory.isdigit() and int(memory) < 250, (make.__name__, line)
        assert words.startswith("read: "), (make.__name__, line)


def test_numbers_that_a_tdms_file_declares_and_has_not_are_not_made(tmp_path):
    tdms_that_declares(tmp_path)
    try:
        assert len(ss.read(tmp_path / "a")["v"]) == len(V)  # as many as there are
    except ss.InputError as error:
        assert str(error)


def test_a_dimension_that_is_not_true_does_no_harm(tmp_path):
    a_dimension_that_is_not_true(tmp_path)
    (rows,) = {len(c.values) for c in ss.read(tmp_path / "a", columns=["t [s]", "v [m/s]"]).channels.values()}
    assert rows == 199


def test_what_a_file_may_unpack_to_is_raised_by_what_the_error_says(tmp_path, monkeypatch):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("v", shape=(2**24,), dtype="f8", chunks=(2**20,), fillvalue=0.0)
    name, value = re.search(r"environment variable (\w+)=(\S+)", refused(tmp_path / "a.h5")).groups()
    monkeypatch.setenv(name, value)
    assert len(ss.read(tmp_path / "a.h5")["v"]) == 2**24
    monkeypatch.setenv(name, "1e3")
    assert "allowed is 1 kB" in refused(tmp_path / "a.h5")
    monkeypatch.setenv(name, "much")
    assert "set it for example to 8e9" in refused(tmp_path / "a.h5")


def test_what_packs_well_is_no_bomb(tmp_path):
    """A million zeros, and the digital trace of a switch, in every packed format."""
    from scipy.io import savemat

    t, v = np.arange(1e6), np.repeat(np.arange(10) % 2, 100_000)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values in (("t", t), ("v", v), ("z", 0 * t)):
            file.create_dataset(name, data=values, compression="gzip", shuffle=True, fletcher32=True)
        file.create_dataset("w", data=v, compression="lzf")
    savemat(tmp_path / "a.mat", {"t": t, "v": v, "z": 0 * t}, do_compression=True)
    for name in ("a.h5", "a.mat"):
        assert np.array_equal(ss.read(tmp_path / name)["v"].values, v)


def test_what_is_no_file_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "nothing", "/dev/zero"):
        assert "give the path of a record" in refused(path)


# where the HDF5 library trusts a file -------------------------------------------------------------------------------


def test_chunks_are_unpacked_as_the_library_does():
    rng = np.random.default_rng(1)
    kinds = itertools.product(["f8", ">f4", "i2", "u1"], [None, "gzip", "lzf"], [False, True], [False, True], [False, True])
    with h5py.File(io.BytesIO(), "w") as file:
        for number, (kind, packed, shuffle, sums, noise) in enumerate(kinds):
            a = (100 * rng.normal(size=(37, 11)) if noise else np.arange(407).reshape(37, 11) % 5).astype(kind)
            b = file.create_dataset(f"{number}", data=a, chunks=(5, 3), compression=packed, shuffle=shuffle, fletcher32=sums)
            assert np.array_equal(hdf5.dataset_values(b), a) and hdf5.dataset_values(b).dtype == a.dtype, (kind, packed, shuffle, sums)
        half = file.create_dataset("half", (100,), "f8", chunks=(30,), fillvalue=7.0)
        half[35:40] = 1.0
        assert np.array_equal(hdf5.dataset_values(half), half[()])


@each_row("chunk", [b"ab", b"abcd", b"x" * 803, zlib.compress(b"\0" * 792), zlib.compress(b"\0" * 900), b"\xff" * 200])
@pytest.mark.parametrize("packing", [{"fletcher32": True}, {"compression": "gzip"}, {"compression": "lzf"}, {"shuffle": True}])
def test_a_chunk_that_is_not_what_it_declares_is_damage(tmp_path, packing, chunk):
    """A checksum over fewer than four bytes ended the process."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        made = file.create_dataset("v", shape=(100,), dtype="f8", chunks=(100,), **packing)
        made.id.write_direct_chunk((0,), chunk)
    assert "damaged" in refused(tmp_path / "a.h5")


@each_row("size", [0, 8, 2**63])
def test_texts_in_a_heap_without_end_are_damage(tmp_path, size):
    """The library goes round in it for ever; a process of its own would not come back."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["v"] = V, V
        file.attrs["note"] = ["a text", "another"]
    data = bytearray((tmp_path / "a.h5").read_bytes())
    heap = data.index(b"GCOL")
    free = next(k for k in range(heap + 16, heap + 4096, 8) if data[k : k + 8] == bytes(8) and data[k + 8 : k + 16] != bytes(8))
    data[free + 8 : free + 16] = struct.pack("<Q", size)
    (tmp_path / "a.h5").write_bytes(data)
    assert "damaged" in refused(tmp_path / "a.h5")


# where SciPy trusts a file ------------------------------------------------------------------------------------------


def test_a_matlab_file_that_crashes_its_library_is_damage(tmp_path):
    """An element of a type that does not exist; the next file is read as if nothing had happened."""
    head = struct.pack("<IIIIIIii", 6, 8, 6, 0, 5, 8, 1, 4) + struct.pack("<HH4s", 1, 1, b"v")
    for kind, said in ((9, ""), (20, "damaged (the process that reads it crashes)"), (9, "")):
        body = head + struct.pack("<II", kind, 32) + bytes(32)
        mat(tmp_path, struct.pack("<II", 14, len(body)) + body)
        if said:
            assert said in refused(tmp_path / "a")
        else:
            assert ss.read(tmp_path / "a")["v"].values.tolist() == [0.0] * 4


def test_a_matlab_file_that_unpacks_to_too_much_says_what_to_type(tmp_path):
    mat_of_bytes(tmp_path)
    assert "STICKSLIP_LARGEST" in refused(tmp_path / "a")
