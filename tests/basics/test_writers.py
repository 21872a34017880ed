"""Every file that the package writes: whole or not at all, whatever fails meanwhile."""

import ast
import contextlib
import errno
import gc
import io
import os
import random
import resource
import subprocess
import sys
import tempfile
from argparse import Namespace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from house import ROOT
from rows import each_row
from stickslip.basics.errors import StickslipError
from stickslip.basics.whole_files import Deferred

SOURCES = sorted((ROOT / "src" / "stickslip").rglob("*.py"))
DOOR = "whole_files.py"

# the door ---------------------------------------------------------------------------------------------------------

#: Calls that write whatever they are given, and those that write to their first argument.
_WRITE = {"write_text", "write_bytes", "touch", "to_netcdf", "to_parquet", "to_pickle", "tofile", "mkstemp", "NamedTemporaryFile"}
_WRITE_TO = {"savefig", "savemat", "savetxt", "savez", "savez_compressed", "ParquetWriter", "dump", "print_figure", "imsave"}
_MOVE = {"replace", "rename", "renames", "link", "symlink", "copy", "copy2", "copyfile", "copytree", "move"}
_OPEN_TO = {"File", "ZipFile", "TarFile"}  # of h5py, h5netcdf and archives


def _name(node):
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _mode(call, place):
    """The mode of a call that opens a file, as text; "r" by default."""
    given = next((k.value for k in call.keywords if k.arg == "mode"), call.args[place] if len(call.args) > place else None)
    return "r" if given is None else given.value if isinstance(given, ast.Constant) and isinstance(given.value, str) else "?"


def _handed(function):
    """Names of a function that stand for a file in memory, or for one that the door has opened."""
    made = {"BytesIO", "StringIO", "TextIOWrapper", "whole_file", "for_hdf5", "moved_into_place"}
    names = {
        a.arg
        for a in [*function.args.args, *function.args.kwonlyargs]
        if a.annotation and ast.unparse(a.annotation) in ("BinaryIO", "TextIO")
    }
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and _name(node.value.func) in made:
            names |= {n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)}
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple):
            pairs = [pair for t in node.targets if isinstance(t, ast.Tuple) for pair in zip(t.elts, node.value.elts, strict=False)]
            names |= {t.id for t, v in pairs if isinstance(v, ast.Call) and _name(v.func) in made}
        if isinstance(node, ast.withitem) and isinstance(node.context_expr, ast.Call) and _name(node.context_expr.func) in made:
            names |= {node.optional_vars.id} if isinstance(node.optional_vars, ast.Name) else set()
    return names


def writers_past_the_door(text):
    """Lines of a module that write a file by themselves."""
    tree, found = ast.parse(text), []
    functions = [n for n in ast.walk(tree) if isinstance(n, (ast.FunctionDef, ast.AsyncFunctionDef))]
    for call in (n for n in ast.walk(tree) if isinstance(n, ast.Call)):
        if _name(call.func) not in {"open", "fdopen", *_WRITE, *_WRITE_TO, *_MOVE, *_OPEN_TO}:
            continue
        inside = [f for f in functions if f.lineno <= call.lineno <= f.end_lineno]
        handed = {name for f in inside for name in _handed(f)}
        first = call.args[0] if call.args else None
        to = {_name(first)} if first is not None else set()
        name, owner = _name(call.func), _name(call.func.value) if isinstance(call.func, ast.Attribute) else ""
        if name in _WRITE:
            wrong = owner not in handed
        elif name in _WRITE_TO:
            wrong = not (to | {_name(a) for a in call.args[1:2] if name == "dump"}) & handed
        elif name in _MOVE:
            wrong = owner in ("os", "shutil")
        elif name in _OPEN_TO:
            wrong = _mode(call, 1) != "r" and not to & handed
        else:
            place = 0 if isinstance(call.func, ast.Attribute) and owner not in ("os", "io", "gzip") else 1
            words = ast.unparse(call)
            wrong = "devnull" not in words and (
                any(flag in words for flag in ("O_WRONLY", "O_RDWR", "O_CREAT"))
                or bool(set(_mode(call, place)) & set("wax+?") and owner not in ("os", "webbrowser", "archive"))
            )
        if wrong:
            found.append(f"line {call.lineno}: {ast.unparse(call)[:80]}")
    return found


def test_every_file_is_written_through_one_door():
    found = {p.relative_to(ROOT).as_posix(): writers_past_the_door(p.read_text(encoding="utf-8")) for p in SOURCES if p.name != DOOR}
    found = {name: lines for name, lines in found.items() if lines}
    assert not found, f"write it through stickslip.basics.whole_files: {found}"


@each_row(
    "line",
    [
        "path.write_text('a')", "Path(p).write_bytes(b'')", "open(p, 'w')", "open(p, mode='ab')", "path.open('x')", "io.open(p, 'r+')",
        "figure.savefig(path)", "savemat(path, {})", "np.savetxt(path, a)", "h5py.File(p, 'a')", "h5netcdf.File(p, 'w')", "json.dump(a, p)",
        "data.to_netcdf(path)",
        "os.replace(a, b)", "shutil.copy(a, b)", "os.open(p, os.O_WRONLY)", "ZipFile(p, 'w')", "frame.to_parquet(p)",
        "path.touch()", "open(p, m)",
    ],
)  # fmt: skip
def test_a_writer_past_the_door_is_seen(line):
    assert writers_past_the_door(f"def f(path, p, m):\n    {line}\n")


# what fails ---------------------------------------------------------------------------------------------------------


@cache
def a_run():
    return ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=3, samples=40)


@cache
def a_flow_run():
    return ss.solve(ss.SwitchingFlow({"on": lambda t, y: (y[1], -y[0])}, states=("x", "v")), duration=5.0, start={"x": 1.0, "v": 0.0})


@cache
def a_grid():
    return ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=1.7, law="coulomb")


def _picture(path):
    from matplotlib.figure import Figure

    from stickslip.show.cli.show import draw_to

    figure = Figure()
    figure.subplots().plot(np.random.default_rng(1).normal(size=300))
    draw_to(path, figure)


def _init(path):
    from stickslip.show.cli.commands.init import act

    act(Namespace(file=str(path), force=True, law=None, drive=None, preset="piezo_rig", set=["tilt_deg=1.7", "amplitude=5e-4"]))


def _command(path):
    from stickslip.show.cli.commands.resume import _write

    path.unlink()
    _write(path, "sweep", ["piezo_rig"] * 200)


def _optimum(path):
    from stickslip.show.reports import write

    write(path, "<html>" * 3000)


WRITERS = {
    **{f"run{end}": lambda path: a_run().save(path) for end in (".nc", ".csv", ".mat", ".xlsx")},
    **{f"flow{end}": lambda path: a_flow_run().save(path) for end in (".nc", ".csv", ".mat", ".xlsx")},
    **{f"grid{end}": lambda path: ss.studies.export(a_grid(), path) for end in (".nc", ".csv", ".mat", ".xlsx")},
    **{f"data{end}": lambda path: ss.studies.export(a_run().to_xarray()[["x"]].rename(x="z"), path) for end in (".nc", ".csv", ".mat")},
    **{f"figure{end}": _picture for end in (".png", ".svg", ".pdf")},
    "record.csv": lambda path: ss.Record.of(np.linspace(0, 1, 300), {"v [m/s]": np.linspace(0, 1, 300) ** 2}).save(path),
    "law.h": lambda path: ss.export_law(ss.Coulomb(mu_plus=0.1, mu_minus=0.2), "c", name="law").save(path),
    "study.toml": _init,
    "page.html": _optimum,
    "manifest.json": lambda path: _put(path),
    "command.json": _command,
}


def _paper(path):
    from stickslip.show.paper.drawing import render

    render(
        path.parent,
        path.stem,
        [lambda axes: axes.plot(np.random.default_rng(1).normal(size=300))],
        text="evidence-step-size",
        ladder=[],
        best=0.0,
    )


def _put(path):
    from stickslip.studies.folder import put_file

    put_file(path, b"{}" * 3000)


@contextlib.contextmanager
def room_for(count):
    """No file may be larger than so many bytes; the system itself refuses the write."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def _litter():
    return {p for p in os.listdir(tempfile.gettempdir()) if p.startswith("openpyxl")}


def fill_up(name, folder):
    """Write where a file may have so many bytes and no more: one sentence, the old file, and nothing beside it."""
    writer, path = WRITERS[name], folder / name
    path.write_text("old")
    writer(path)
    size, kept = path.stat().st_size, b"old" if name == "command.json" else path.read_bytes()
    assert size > 500
    temporary = _litter()
    nearly = size - (100 if name.endswith(".xlsx") else 1)  # a workbook holds its time, and packs it into some bytes more or less
    for room in sorted({0, 1, 100, size // 3, size // 2, nearly}):
        if name == "command.json" and not path.exists():
            path.write_bytes(kept)
        with room_for(room), pytest.raises(StickslipError, match=r"cannot write|not be written") as refused:
            writer(path)
        assert len(str(refused.value).splitlines()) == 1 and "free some space" in str(refused.value)
        assert name == "command.json" or path.read_bytes() == kept
        assert [p.name for p in folder.iterdir()] in ([name], [])
    gc.collect()  # what a failed write left says so, if at all, when it goes
    assert _litter() <= temporary


@each_row("name", [name for name in WRITERS if not name.endswith(".nc")])
def test_a_disk_that_fills_up_leaves_the_old_file(name, tmp_path, tmp_path_factory, monkeypatch, capfd):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path_factory.mktemp("temporary")))  # other tests write beside this one
    fill_up(name, tmp_path)
    assert "Traceback" not in capfd.readouterr().err


FILL_UP = """
import pathlib, sys
from basics.test_writers import fill_up

for folder in map(pathlib.Path, sys.argv[1:]):
    print(folder.name, file=sys.stderr)
    fill_up(folder.name, folder)
"""


def test_a_disk_that_fills_up_leaves_the_old_file_of_hdf5(tmp_path):
    """In a process of their own: the limit holds for whatever HDF5 has open in this one."""
    folders = [tmp_path / name for name in WRITERS if name.endswith(".nc")]
    for folder in folders:
        folder.mkdir()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-c", FILL_UP, *map(str, folders)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, env=environment)
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
    assert [line for line in done.stderr.splitlines() if line.endswith(".nc")] == [folder.name for folder in folders]


@each_row("name", [name for name in WRITERS if name != "command.json"])  # which is written only where there is none
@pytest.mark.parametrize("step", ["open", "fsync", "replace"])
def test_a_failing_step_leaves_the_old_file(name, step, tmp_path, monkeypatch):
    writer, path = WRITERS[name], tmp_path / name
    writer(path)  # whatever is compiled for it is compiled before nothing can be opened
    path.write_text("old")

    def full(*arguments, **more):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, step, full)
        with pytest.raises(StickslipError, match="free some space"):
            writer(path)
    assert path.read_text() == "old" and [p.name for p in tmp_path.iterdir()] == [name]


# one write fails -----------------------------------------------------------------------------------------------------


class OneFails(io.FileIO):
    """A file of which one write fails, and those before and after it succeed; `left` is shared by all files of a test."""

    left = 0

    def write(self, data):
        OneFails.left -= 1
        if OneFails.left == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return super().write(data)


@pytest.fixture
def failing_disk(monkeypatch):
    """Files are opened for writing as `OneFails`."""
    really = Path.open

    def opened(path, mode="r", *more, **options):
        return io.BufferedRandom(OneFails(path, "w+")) if mode == "w+b" else really(path, mode, *more, **options)

    monkeypatch.setattr(Path, "open", opened)


@each_row("name", [*WRITERS, "grid.parquet", "paper.png"])
def test_a_write_that_fails_leaves_the_old_file_whichever_it_is(name, tmp_path, failing_disk, capfd):
    if name.endswith(".parquet"):
        pytest.importorskip("pyarrow")
    writer, path = (
        {**WRITERS, "grid.parquet": lambda path: ss.studies.export(a_grid(), path), "paper.png": _paper}[name],
        tmp_path / name,
    )
    path.write_text("old")
    OneFails.left = 0
    writer(path)  # whatever is compiled for it is kept now
    capfd.readouterr()
    OneFails.left = 0
    writer(path)
    count, kept = -OneFails.left, {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    assert count > 0 and kept[name] != b"old"
    for k in sorted({1, count // 2, count} & set(range(1, count + 1))):
        OneFails.left = k
        with pytest.raises(StickslipError, match="free some space") as refused:
            writer(path)
        assert len(str(refused.value).splitlines()) == 1
        assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == ({} if name == "command.json" else kept)
        if name == "command.json":
            path.write_bytes(kept[name])
        gc.collect()
    assert not capfd.readouterr().err


@each_row("fails", [0, 1, 5, 20])
def test_what_is_read_after_a_failed_write_is_what_was_written(fails, tmp_path):
    """As HDF5 needs it: against a file in memory, for writes, holes and cuts at random places."""
    rng, memory = random.Random(fails), io.BytesIO()
    OneFails.left = fails
    with io.BufferedRandom(OneFails(tmp_path / "x", "w+")) as file:
        deferred = Deferred(file)
        for _ in range(300):
            place, data = rng.randrange(300_000), rng.randbytes(rng.choice([1, 50, 90_000]))
            for each in (memory, deferred):
                each.seek(place)
                each.write(data)
            place = rng.randrange(300_000)
            for each in (memory, deferred):
                each.seek(place)
            assert deferred.read(70_000) == memory.read(70_000) and deferred.tell() == memory.tell()
        if fails:
            with pytest.raises(OSError, match="No space"):
                deferred.check()
        else:
            assert (tmp_path / "x").read_bytes() == memory.getvalue()
