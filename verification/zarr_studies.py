"""Would a Zarr store, written by xarray, do what a study folder does? Both hold the same tiles here, and both are killed, filled and read.

``python verification/zarr_studies.py`` needs zarr; it prints one row a question (see notes/decisions). The store is what one would
write today: a template of all columns with one chunk a tile, region writes, checksums (crc32c) in each chunk, and the status as the last
column of a tile.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from zarr.codecs import BytesCodec, Crc32cCodec
from zarr.storage import FsspecStore, LocalStore

import stickslip as ss
from stickslip.basics.executors import HERE
from stickslip.studies.folder import StudyFolder
from stickslip.studies.opening import open_study
from stickslip.studies.planning import SOLVER, Plan, planned
from stickslip.studies.progress import Watch
from stickslip.studies.result_columns import coded, unwritten
from stickslip.studies.running import tiles_of
from stickslip.studies.solving import kept_columns
from stickslip.studies.tiles import TILES

DONE = "status"  # written last: a tile whose chunk of it is there is whole


def plan_of(cases: int, tile: int) -> Plan:
    """A plane of Coulomb robots, which cost least, so that writing is seen."""
    n = max(int(np.sqrt(cases)), 1)
    axes = dict(amplitude=np.linspace(2e-4, 8e-4, n), omega=np.linspace(60.0, 300.0, -(-cases // n)), tilt_deg=1.7, law="coulomb")
    return planned(ss.presets.piezo_rig, (), axes, None, None, tile, **SOLVER)


# ---- the store ----
class ZarrFolder:
    """A study as a Zarr store: a flat dimension of cases, one chunk for each tile."""

    def __init__(self, store: Any, plan: Plan):
        self.store, self.plan = store, plan
        self.names = kept_columns(plan)

    def begin(self) -> None:
        """Write the template, unless it is there: every chunk is missing, and so has the fill value "not computed"."""
        group = zarr.open_group(self.store, mode="a")
        for name in self.names:
            if name in group:
                continue
            like = unwritten(name)
            shape, dims = (self.plan.cases, *like.shape[1:]), ("case", "character")[: like.ndim]
            kind = np.dtype("u1") if like.dtype.kind == "S" else like.dtype
            fill = like.view("u1").ravel()[0] if like.dtype.kind == "S" else like.ravel()[0]
            each = self.plan.bounds(0)[1]
            group.create_array(
                name, shape=shape, chunks=(each, *like.shape[1:]), dtype=kind, fill_value=fill, dimension_names=dims,
                serializer=BytesCodec(), compressors=[Crc32cCodec()], config={"write_empty_chunks": True},
            )  # fmt: skip

    def write(self, k: int, columns: dict[str, Any]) -> None:
        """Store a tile: two region writes, the status after the rest."""
        first, last = self.plan.bounds(k)
        region = {"case": slice(first, last)}
        whole = {name: self._as_kept(name, columns[name]) for name in self.names}
        for part in ({n: v for n, v in whole.items() if n != DONE}, {DONE: whole[DONE]}):
            data = {n: (("case", "character")[: v.ndim], v) for n, v in part.items()}
            xr.Dataset(data).to_zarr(self.store, region=region, mode="r+", consolidated=False, write_empty_chunks=True)

    @staticmethod
    def _as_kept(name: str, values: Any) -> Any:
        kept = coded(name, values)
        return kept.view("u1") if kept.dtype.kind == "S" else kept

    def done(self) -> set[int]:
        """Tiles whose status is there and whose columns all have a chunk of it: a missing chunk reads as fill values, without an error."""
        group = zarr.open_group(self.store, mode="r")
        there = [{int(key.split("/")[1]) for key in _keys(group[name])} for name in self.names]
        return set.intersection(*there) if there else set()

    def run(self, limit: int | None = None) -> int:
        """Compute the tiles that are missing; how many there were."""
        self.begin()
        todo = sorted(set(range(self.plan.tiles)) - self.done())[:limit]
        for k, columns, _, _ in tiles_of(self.plan, todo, HERE, Watch(self.plan.cases, None)):
            self.write(k, columns)
        return len(todo)


def _keys(array: Any) -> list[str]:
    root = Path(array.store.root) / array.path / "c"
    return [f"c/{each.name}" for each in root.iterdir() if each.suffix != ".partial"] if root.exists() else []


def files_of(folder: Path) -> dict[str, bytes]:
    """Chunks and metadata, or tiles, by their names."""
    there = (path for path in folder.rglob("*") if path.is_file() and not path.name.endswith((".part", ".partial")))
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in there if path.name != "manifest.json"}


def today(folder: Path, plan: Plan, limit: int | None = None) -> int:
    """The same with a study folder."""
    study = StudyFolder.begin(folder, plan, resume=True, keep=True)
    todo = list(study.todo)[:limit]
    for k, columns, notes, models in tiles_of(plan, todo, HERE, Watch(plan.cases, None), study.identities):
        study.write(k, columns, notes, models)
    return len(todo)


def zarr_here(folder: Path, plan: Plan, limit: int | None = None) -> int:
    """A Zarr store on this disk."""
    return ZarrFolder(LocalStore(folder), plan).run(limit)


WAYS: dict[str, Any] = {"folder": today, "zarr": zarr_here}


# ---- the questions ----
def kills(way: str, place: Path, times: int) -> str:
    """Kill -9 at random instants, and go on: the same files to the bit?"""
    plan, rng = plan_of(120_000, 200), np.random.default_rng(46)
    WAYS[way](place / "whole", plan)
    whole, target, killed, partial = files_of(place / "whole"), place / "killed", 0, 0
    while True:
        child = os.fork()
        if child == 0:
            WAYS[way](target, plan)
            os._exit(0)
        if killed < times:
            time.sleep(rng.uniform(0.05, 0.6))
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        killed += os.WIFSIGNALED(status)
        partial += len([p for p in target.rglob("*") if p.name.endswith((".part", ".partial"))])
        if not os.WIFSIGNALED(status):
            break
    left = [p for p in target.rglob("*") if p.name.endswith((".part", ".partial"))]
    same = files_of(target) == whole
    return f"{killed} kills, same bits: {same}; {len(left)} temporary files left at the end ({partial} met on the way)"


def two_writers(way: str, place: Path) -> str:
    """Two processes that compute all tiles of one study at the same time."""
    plan = plan_of(20_000, 400)
    WAYS[way](place / "whole", plan)
    children = []
    for _ in range(2):
        child = os.fork()
        if child == 0:
            try:
                WAYS[way](place / "both", plan)
                os._exit(0)
            except BaseException as error:  # said by the parent
                print(type(error).__name__, error, file=sys.stderr)
                os._exit(1)
        children.append(child)
    codes = [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children]
    return f"exit codes {codes}, same bits: {files_of(place / 'both') == files_of(place / 'whole')}"


def full_disk(way: str, place: Path) -> str:
    """A disk (tmpfs) of 2 MB, for a study of more; then it grows, and the study goes on."""
    disk = place / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(disk)], capture_output=True).returncode:
        return "no disk could be mounted"
    plan = plan_of(20_000, 400)
    try:
        try:
            WAYS[way](disk / "study", plan)
            said = "nothing"
        except Exception as error:  # what a user would read
            said = f"{type(error).__name__}: {str(error).splitlines()[0][:150]}"
        subprocess.run(["mount", "-o", "remount,size=64m", str(disk)], check=True)
        more = WAYS[way](disk / "study", plan)
        WAYS[way](place / "whole", plan)
        same = files_of(disk / "study") == files_of(place / "whole")
    finally:
        subprocess.run(["umount", str(disk)], check=False)
    return f"says {said!r}; then {more} of {plan.tiles} tiles are computed, same bits: {same}"


def damage(way: str, place: Path) -> str:
    """A flipped bit, a missing part, two parts exchanged: is each noticed by who reads?"""
    plan, said = plan_of(4_000, 400), []
    for what in ("a flipped bit", "a part is missing", "two parts exchanged"):
        folder = place / what.replace(" ", "-")
        WAYS[way](folder, plan)
        a, b = ((folder / TILES / f"{k:07d}.nc" if way == "folder" else folder / "mean_velocity" / "c" / f"{k}") for k in (3, 4))
        if what == "a flipped bit":
            content = bytearray(a.read_bytes())
            content[len(content) // 2] ^= 4
            a.write_bytes(bytes(content))
        elif what == "a part is missing":
            a.unlink()
        else:
            one, other = a.read_bytes(), b.read_bytes()
            a.write_bytes(other)
            b.write_bytes(one)
        said.append(f"{what}: {_read(way, folder)}")
    return "; ".join(said)


def _read(way: str, folder: Path) -> str:
    try:
        if way == "folder":
            grid = open_study(folder)
            V, status = grid.mean_velocity.values.ravel(), grid.status.values.ravel()
        else:
            kept = xr.open_zarr(folder, consolidated=False, mask_and_scale=False)
            V, status = kept.mean_velocity.values, kept.status.values
    except Exception as error:
        return f"refused ({type(error).__name__})"
    if (status == 101).any():
        return "said as not computed"
    return "NOT NOTICED, NaN beside a good status" if np.isnan(V).any() else "NOT NOTICED"


def speed(way: str, place: Path, cases: int) -> str:
    """CPU seconds of 10^6 cases, of which those that write, and those that read one column of the results; files and bytes."""
    plan, began = plan_of(cases, 16384), time.process_time()
    WAYS[way](place / "study", plan)
    spent = time.process_time() - began
    began = time.process_time()
    for _ in tiles_of(plan, range(plan.tiles), HERE, Watch(plan.cases, None)):
        pass
    alone = time.process_time() - began
    began = time.process_time()
    if way == "folder":
        mean = float(open_study(place / "study").mean_velocity.mean())
    else:
        mean = float(xr.open_zarr(place / "study", consolidated=False).mean_velocity.mean())
    read = time.process_time() - began
    there = [path.stat().st_size for path in (place / "study").rglob("*") if path.is_file()]
    size = f"{len(there)} files, {sum(there) / 1e6:.0f} MB"
    return f"{spent:.2f} s CPU ({alone:.2f} s without writing), {size}; one column read in {read:.2f} s (mean {mean:.6e})"


def while_it_runs(way: str, place: Path) -> str:
    """Another thread opens the results again and again while they are written: what does it see?"""
    plan, stop, seen, errors = plan_of(200_000, 4096), threading.Event(), list[int](), list[str]()

    def look() -> None:
        while not stop.is_set():
            try:
                if way == "folder":
                    status, V = (open_study(place / "study")[n].values.ravel() for n in ("status", "mean_velocity"))
                else:
                    kept = xr.open_zarr(place / "study", consolidated=False, mask_and_scale=False)
                    status, V = kept.status.values, kept.mean_velocity.values
                seen.append(int((status != 101).sum()))
                if np.isnan(V[status == 1]).any():
                    errors.append("a good status beside NaN")
            except Exception as error:
                errors.append(type(error).__name__)
            time.sleep(0.05)

    WAYS[way](place / "study", plan, 1)
    reader = threading.Thread(target=look)
    reader.start()
    WAYS[way](place / "study", plan)
    stop.set()
    reader.join()
    rising = all(a <= b for a, b in pairwise(seen))
    return f"{len(seen)} looks, rising: {rising}, from {seen[0]} to {seen[-1]} cases; errors: {sorted(set(errors)) or 'none'}"


def other_stores(way: str, place: Path) -> str:
    """A store behind fsspec."""
    if way == "folder":
        return "none: a folder needs a file system"
    import fsspec

    plan, files = plan_of(4_000, 400), fsspec.filesystem("memory")
    store = FsspecStore.from_url("memory://study.zarr")
    study = ZarrFolder(store, plan)
    study.begin()
    for k, columns, _, _ in tiles_of(plan, range(plan.tiles), HERE, Watch(plan.cases, None)):
        study.write(k, columns)
    kept = xr.open_zarr(store, consolidated=False, mask_and_scale=False)
    again = place / "again"
    zarr_here(again, plan)
    same = np.array_equal(kept.mean_velocity.values, xr.open_zarr(again, consolidated=False, mask_and_scale=False).mean_velocity.values)
    return f"memory:// holds {len(files.find('/study.zarr'))} objects, same numbers: {same}"


def memory(way: str, place: Path, cases: int) -> str:
    """The largest memory of a process that writes many cases."""
    child = os.fork()
    if child == 0:
        WAYS[way](place / "study", plan_of(cases, 16384))
        os._exit(0)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    most = os.wait4(child, 0)[2].ru_maxrss
    return f"{most / 1024:.0f} MB at most (a process that has done nothing but ask these questions: {before / 1024:.0f} MB)"


def main() -> int:
    """One row a question."""
    asked = argparse.ArgumentParser()
    asked.add_argument("--cases", type=int, default=1_000_000)
    asked.add_argument("--kills", type=int, default=30)
    asked.add_argument("--only", nargs="*", help="questions, by how they begin")
    given = asked.parse_args()
    questions: dict[str, Any] = {
        "kill -9": lambda way, place: kills(way, place, given.kills), "two writers": two_writers, "full disk": full_disk,
        "damage": damage, "speed": lambda way, place: speed(way, place, given.cases), "opened while it runs": while_it_runs,
        "other stores": other_stores, "memory": lambda way, place: memory(way, place, given.cases),
    }  # fmt: skip
    chosen = {name: q for name, q in questions.items() if not given.only or name.startswith(tuple(given.only))}
    for name, question in chosen.items():
        for way in WAYS:
            place = Path(tempfile.mkdtemp(prefix="zarr-studies-"))
            try:
                print(f"{name:22} {way:7} {question(way, place)}", flush=True)
            except Exception as error:  # the other questions are asked nevertheless
                print(f"{name:22} {way:7} ended with {type(error).__name__}: {error}", flush=True)
            finally:
                shutil.rmtree(place, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
