"""Whole maps: cases per second, threads, cost per case, memory; and what others take for a sample of the same cases.

    python benchmarks/sweep.py [--quick] [--big] [--json FILE]         # 3 minutes; --big: 10^7 cases for the memory, 3 more

Coulomb map: the robot over (alpha_plus, alpha_minus), each in (0, 1.6], periodic states. LuGre map: the paper's rig over A = 0.1 to
0.8 mm and omega = 60 to 300 rad/s. "CPU" is user + system time of the process with its threads; it says more than the wall clock on a
machine that others use too. A rival gets a line of the map, the paper's frequency and evenly spread amplitudes, in a pool of as many
processes as there are cores; it runs 30 periods and averages the last ten, we stop where the strobe point repeats. Errors are the worst
of the sample, against our own runs at rtol 1e-10 (which benchmarks/reference.py holds against heyoka at 1e-15).
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
RIG = {"tilt_deg": 1.7, "law": "lugre"}


def cpu() -> float:
    """CPU seconds of this process and its threads."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def timed(work: Callable[[], Any]) -> tuple[Any, float, float]:
    """What it returns, wall seconds, CPU seconds."""
    began, used = time.perf_counter(), cpu()
    result = work()
    return result, time.perf_counter() - began, cpu() - used


def coulomb(size: int, **more: Any) -> Any:
    """The Coulomb map."""
    import stickslip as ss

    a = np.linspace(1.6 / size, 1.6, size)
    return ss.map(ss.presets.coulomb_robot, alpha_plus=a, alpha_minus=a, **more)


def lugre(size: int, **more: Any) -> Any:
    """The LuGre map."""
    import stickslip as ss

    axes = {"amplitude": np.linspace(0.1e-3, 0.8e-3, size), "omega": np.linspace(60.0, 300.0, size)}
    return ss.map(ss.presets.piezo_rig, **axes, **RIG, **more)


MAPS = {"coulomb": coulomb, "lugre": lugre}


def ours(sizes: dict[str, list[int]]) -> list[dict[str, Any]]:
    """Each map at each size, with one thread and with all cores."""
    rows = []
    for name, make in MAPS.items():
        make(2)  # compiles
        for size in sizes[name]:
            for workers in sorted({1, CORES}):
                work = partial(make, size, workers=workers)
                _, wall, used = min((timed(work) for _ in range(3 if size <= 100 else 1)), key=lambda r: r[1])
                rows.append({"map": name, "cases": size**2, "threads": workers, "wall": wall, "cpu": used})
    return rows


def interactive() -> float:
    """Wall seconds of a 64 x 64 LuGre map on all cores, best of five."""
    return min(timed(lambda: lugre(64, workers=CORES))[1] for _ in range(5))


# ---- rivals ----
def rivals(count: int) -> list[dict[str, Any]]:
    """Others on a line of the LuGre map and on one of the Coulomb map, in a pool of processes."""
    amplitude = np.linspace(0.25e-3, 0.8e-3, count)
    jobs = [("lugre", name, count if "heyoka" in name else max(count // 8, 2 * CORES)) for name in ("scipy LSODA", "heyoka batch")]
    jobs += [("coulomb", name, n) for name, n in (("scipy DOP853 and events", 2 * CORES), ("arcs with brentq", max(count // 4, 2 * CORES)))]
    return [_rival(law, name, amplitude[np.linspace(0, count - 1, n).astype(int)]) for law, name, n in jobs]


def _rival(law: str, name: str, amplitude: np.ndarray) -> dict[str, Any]:
    import stickslip as ss
    from problem import OMEGA

    right = ss.sweep(ss.presets.piezo_rig, amplitude=amplitude, omega=OMEGA, tilt_deg=1.7, law=law, rtol=1e-10, periods=2000)
    row: dict[str, Any] = {"map": law, "name": name, "cases": len(amplitude)}
    parts = [amplitude[i::CORES] for i in range(CORES)]
    try:
        with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
            list(pool.map(_part, [law] * CORES, [name] * CORES, [p[:1] for p in parts]))  # imports and compiles
            began = time.perf_counter()
            found = list(pool.map(_part, [law] * CORES, [name] * CORES, parts))
            row["wall"] = time.perf_counter() - began
    except Exception as error:  # not installed, or failed in a way of its own
        return {**row, "missing": f"{type(error).__name__}: {error}"}
    V = np.empty(len(amplitude))
    for i, (velocities, _) in enumerate(found):
        V[i::CORES] = velocities
    unit = float(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1.0).mass_ratio) * amplitude * OMEGA
    reference = right.mean_velocity.values
    return {**row, "cpu": sum(s for _, s in found), "error": float(np.max(abs(V - reference) / np.maximum(abs(reference), 0.01 * unit)))}


def _part(law: str, name: str, amplitude: np.ndarray) -> tuple[np.ndarray, float]:
    """One process's share: mean velocities and CPU seconds."""
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from problem import Problem

    problem = Problem(0.18, amplitude)
    began = cpu()
    if name == "scipy LSODA":
        from rivals.scipy_ode import RIVALS

        velocities = RIVALS[0].run(problem, 1e-6)[0]
    elif name == "heyoka batch":
        from rivals.taylor_heyoka import run_batch

        velocities = run_batch(problem, (1e-6, 8))[0]
    else:
        import exact_coulomb
        import pin

        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, range(os.cpu_count() or 1))  # what `pin` did is undone: each process its own core
        assert pin.WHERE
        if name == "arcs with brentq":
            velocities = exact_coulomb._run(exact_coulomb.closed_form, problem, 1e-10)[0]
        else:
            velocities = exact_coulomb._run(exact_coulomb.by_scipy, problem, (1e-8, 0.2))[0]
    return velocities, cpu() - began


# ---- memory ----
MEMORY = """
import resource, sys
sys.path.insert(0, sys.argv[1])
import sweep
rows, columns, folder = int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
import numpy as np, stickslip as ss
a, b = np.linspace(1.6 / rows, 1.6, rows), np.linspace(1.6 / columns, 1.6, columns)
ss.map(ss.presets.coulomb_robot, alpha_plus=a, alpha_minus=b, out=folder, tile=16384)
try:  # the peak of this program alone: what getrusage says begins with the program that started it
    print([int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("VmHWM")][0])
except OSError:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024))
"""


def memory(shapes: list[tuple[int, int]]) -> list[dict[str, Any]]:
    """Peak memory of processes that write the Coulomb map to a folder."""
    rows = []
    for shape in shapes:
        with tempfile.TemporaryDirectory() as folder:
            here = str(Path(__file__).resolve().parent)
            command = [sys.executable, "-c", MEMORY, here, *map(str, shape), str(Path(folder) / "study")]
            began = time.perf_counter()
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            wall = time.perf_counter() - began
            size = sum(p.stat().st_size for p in Path(folder).rglob("*") if p.is_file())
        rows.append({"cases": shape[0] * shape[1], "peak": int(done.stdout.split()[-1]), "disk": size, "wall": wall})
    return rows


# ---- what is told ----
def told(record: dict[str, Any]) -> str:
    """The record as text."""
    lines = [f"{CORES} cores", "", "map       cases     threads   wall [s]   CPU [s]   CPU µs/case   cases/s"]
    for r in record["ours"]:
        per = f"{1e6 * r['cpu'] / r['cases']:11.2f}   {r['cases'] / r['wall']:9.3g}"
        lines.append(f"{r['map']:<8}  {r['cases']:<8}  {r['threads']:<7}  {r['wall']:9.2f}  {r['cpu']:8.2f}   {per}")
    for name in MAPS:
        rows = {(r["cases"], r["threads"]): r for r in record["ours"] if r["map"] == name}
        most = max(cases for cases, _ in rows)
        one, all_ = rows[most, 1], rows[most, max(t for _, t in rows)]
        ratio, more = one["wall"] / all_["wall"], all_["cpu"] / one["cpu"]
        lines.append(f"{name}: {all_['threads']} threads are {ratio:.2f} times as fast as one; they use {more:.2f} times its CPU")
    lines.append(f"interactive: a 64 x 64 LuGre map takes {record['interactive']:.3f} s")
    lines += ["", "rival                     map       cases   wall [s]   CPU µs/case   worst error   CPU, times ours"]
    for r in record["rivals"]:
        if "missing" in r:
            lines.append(f"{r['name']:<24}  {r['map']:<8}  {r['missing']}")
            continue
        mine = min(o["cpu"] / o["cases"] for o in record["ours"] if o["map"] == r["map"] and o["threads"] == 1)
        each = r["cpu"] / r["cases"]
        what = f"{1e6 * each:12.0f}  {r['error']:12.1e}  {each / mine:12.0f}"
        lines.append(f"{r['name']:<24}  {r['map']:<8}  {r['cases']:<5}  {r['wall']:9.2f}  {what}")
    lines += [
        "",
        *(
            f"out=: {r['cases']} cases: peak memory {r['peak'] / 1e6:.0f} MB, {r['disk'] / 1e6:.0f} MB on disk, {r['wall']:.0f} s"
            for r in record["memory"]
        ),
    ]
    return "\n".join(lines)


def main() -> None:
    """Measure and tell."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--quick", action="store_true", help="small maps")
    ask.add_argument("--big", action="store_true", help="10^7 cases for the memory")
    ask.add_argument("--json", metavar="FILE")
    asked = ask.parse_args()
    sizes = {"coulomb": [100, 316], "lugre": [32, 64]} if asked.quick else {"coulomb": [100, 316, 1000], "lugre": [100, 256, 512]}
    shapes = [(1000, 100)] if asked.quick else [(1000, 1000), *([(1000, 10_000)] if asked.big else [])]
    record = {"ours": ours(sizes), "interactive": interactive(), "rivals": rivals(32 if asked.quick else 128), "memory": memory(shapes)}
    print(told(record))
    if asked.json:
        Path(asked.json).write_text(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
