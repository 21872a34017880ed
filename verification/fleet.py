"""A fleet: a study over processes of this computer that are killed at random. Nothing lost, nothing twice, memory flat, and what it costs.

``python verification/fleet.py`` computes 10^6 LuGre robots over eight processes, of which one is killed (kill -9) every some seconds, and
compares tiles that are chosen at random with those of this process, bit for bit. ``--cases 40000 --processes 2`` is a short trial.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.studies.folder import StudyFolder, read_manifest
from stickslip.studies.planning import SOLVER, planned
from stickslip.studies.progress import Progress
from stickslip.studies.solving import solved
from stickslip.studies.tiles import read_tile, tile_is_good

SAMPLED = 20  # tiles that are computed again


def axes(cases: int) -> dict[str, Any]:
    """A plane of so many robots."""
    n = round(cases**0.5)
    return dict(amplitude=np.linspace(3e-4, 8e-4, n), omega=np.linspace(120.0, 260.0, -(-cases // n)), tilt_deg=1.7, law="lugre")


def spent() -> float:
    """CPU seconds of this process, of its processes that have ended, and of the one of which they are copies."""
    each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    ticks = sum(int(word) for words in _begun_by(os.getpid(), b"forkserver").values() for word in words[11:15])
    return sum(usage.ru_utime + usage.ru_stime for usage in each) + ticks / os.sysconf("SC_CLK_TCK")


def _begun_by(parent: int, what: bytes) -> dict[int, list[str]]:
    """Processes that another has begun, and what the system says of each from its state on."""
    begun = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = path.read_text().rpartition(")")[2].split()
            line = (path.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if int(words[1]) == parent and what in line:
            begun[int(path.parent.name)] = words
    return begun


def children() -> list[int]:
    """Processes that compute."""
    return [*_begun_by(os.getpid(), b"spawn_main"), *(pid for one in _begun_by(os.getpid(), b"forkserver") for pid in _begun_by(one, b""))]


def memory() -> float:
    """What this process holds [MB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


class Killer(threading.Thread):
    """Kills a process of the fleet at random instants, `pause` seconds apart on average."""

    def __init__(self, pause: float):
        super().__init__(daemon=True)
        self.pause, self.killed, self.over = pause, 0, threading.Event()
        self._rng = np.random.default_rng(46)

    def run(self) -> None:
        """Kill until the study is over."""
        while not self.over.wait(self._rng.exponential(self.pause)):
            there = children()
            if there:
                os.kill(int(self._rng.choice(there)), signal.SIGKILL)
                self.killed += 1


def fleet(given: argparse.Namespace, out: Path) -> None:
    """The study by the fleet, and what became of it."""
    written, held, lines, write, killer = Counter[int](), list[float](), list[str](), StudyFolder.write, Killer(given.pause)

    def counted(study: StudyFolder, k: int, *tile: Any) -> None:
        written[k] += 1
        write(study, k, *tile)

    def look(now: Progress) -> None:
        held.append(memory())
        lines.append(now.line())
        if given.lines:
            print(f"\r{now.line()}", end="", file=sys.stderr)

    StudyFolder.write = counted  # type: ignore[method-assign]
    begun, before = time.monotonic(), spent()
    if given.pause > 0:
        killer.start()
    how: dict[str, Any] = dict(tile=given.tile, out=out, executor=f"processes:{given.processes}", progress=look, retries=20)
    ss.sweep(ss.presets.piezo_rig, **axes(given.cases), **how)
    killer.over.set()
    cpu, wall, manifest = spent() - before, time.monotonic() - begun, read_manifest(out)
    StudyFolder.write = write  # type: ignore[method-assign]
    tiles, cases = manifest["tiles"], manifest["cases"]
    lost = [k for k in range(tiles) if not tile_is_good(out, k, manifest)]
    twice = [k for k, n in written.items() if n > 1]
    print(f"{cases} cases in {tiles} tiles, {given.processes} processes, {killer.killed} of them killed: {wall:.0f} s, {cpu:.0f} CPU s")
    files, left = (len(list(out.rglob(ending))) for ending in ("tiles/*.nc", "*.part"))
    print(f"tiles lost: {len(lost)}, written twice: {len(twice)}, files of tiles: {files}, temporary files left: {left}")
    quarter = max(len(held) // 4, 1)
    print(f"memory of the caller: {np.mean(held[:quarter]):.0f} MB in the first quarter, {np.mean(held[-quarter:]):.0f} MB in the last")
    print(f"the last of {len(lines)} lines: {lines[-1]}")
    print(f"cost per case: {1e6 * cpu / cases:.1f} us CPU")
    print(f"tiles that this process computes with the same bits: {same(given, out, manifest)} of {SAMPLED}")


def same(given: argparse.Namespace, out: Path, manifest: dict[str, Any]) -> int:
    """How many of some tiles are those that this process computes."""
    plan = planned(ss.presets.piezo_rig, (), axes(given.cases), None, None, given.tile, **SOLVER)
    chosen = np.random.default_rng(1).choice(plan.tiles, SAMPLED, replace=plan.tiles < SAMPLED)
    count = 0
    for k in chosen.tolist():
        mine, kept = solved(plan, k)[0], read_tile(out, manifest, k, list(manifest["columns"]))
        count += all(mine[name].astype(kept[name].dtype).tobytes() == kept[name].tobytes() for name in kept)
    return count


def alone(given: argparse.Namespace, out: Path) -> None:
    """The same cases, fewer of them, in this process."""
    few = axes(given.cases)
    few["omega"] = few["omega"][:: max(len(few["omega"]) // max(given.alone // len(few["amplitude"]), 1), 1)]
    cases, before = len(few["amplitude"]) * len(few["omega"]), spent()
    ss.sweep(ss.presets.piezo_rig, **few, tile=given.tile, out=out)
    print(f"one process: {cases} cases, {1e6 * (spent() - before) / cases:.1f} us CPU for each", flush=True)


def main() -> int:
    """Both."""
    asked = argparse.ArgumentParser()
    asked.add_argument("--cases", type=int, default=1_000_000)
    asked.add_argument("--alone", type=int, default=50_000, help="cases that one process computes")
    asked.add_argument("--processes", type=int, default=8)
    asked.add_argument("--tile", type=int, default=2048)
    asked.add_argument("--pause", type=float, default=30.0, help="seconds between kills on average; 0 for none")
    asked.add_argument("--lines", action="store_true", help="show the line of progress")
    given, place = asked.parse_args(), Path(tempfile.mkdtemp(prefix="fleet-"))
    try:
        ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 5e-4], tilt_deg=1.7, law="lugre")  # compiles
        if given.alone:
            alone(given, place / "alone")
        fleet(given, place / "fleet")
    finally:
        shutil.rmtree(place)
    return 0


if __name__ == "__main__":
    sys.exit(main())
