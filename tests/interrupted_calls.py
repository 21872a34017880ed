"""Long calls that are interrupted by a real SIGINT at several instants, in a process of their own: what each returns, and what follows.

``python tests/interrupted_calls.py NAME 0.1 0.5`` prints a line of JSON for each instant, given as a share of the call's own time; a line
before them of the call that nobody interrupts, and one after them of the same call again. Without instants it says what there is.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import stickslip as ss
from stickslip.dynamics.periodic.limit_cycles import limit_cycle

RIG = ss.presets.piezo_rig
COULOMB = {"tilt_deg": 1.7, "law": "coulomb"}
AMPLITUDES = np.linspace(3e-4, 8e-4, 40)


class Call(NamedTuple):
    """A long call, and how its result says that it is a part."""

    work: Callable[[], Any]
    says: Callable[[Any], str] | None  # the words of a partial result, "" of a complete one; None: all or nothing
    value: Callable[[Any], Any]  # numbers by which two complete results are compared


def _in_folder(work: Callable[[str], Any]) -> Callable[[], Any]:
    """A call that writes to a folder of its own."""

    def done() -> Any:
        with tempfile.TemporaryDirectory() as folder:
            found = work(str(Path(folder) / "study"))
            return found.load() if hasattr(found, "load") else found

    return done


def _of_grid(grid: Any) -> str:
    lost = int((grid.status.values == 101).sum())
    return f"{lost} not computed; {grid.attrs['notes']}" if lost else ""


def _of_attrs(found: Any) -> str:
    return str((found if hasattr(found, "attrs") else found.map).attrs.get("note", ""))


def _of_notes(found: Any) -> str:
    return "; ".join(note for note in found.notes if note.startswith(("interrupted", "the run was interrupted")))


def _records() -> list[Any]:
    return [ss.virtual_rig(RIG(amplitude=A, **COULOMB), noise=1e-3, seed=1) for A in (5e-4, 8e-4)]


def _fit(**options: Any) -> Any:
    given = {"tilt_deg": 1.7, "amplitude": [5e-4, 8e-4], "law": "coulomb"}
    return ss.identify(_records(), RIG, free={"mu0": (0.05, 0.5)}, **given, **options)


def _fit_alone() -> Callable[[], Any]:
    records = _records()
    given = {"tilt_deg": 1.7, "amplitude": [5e-4, 8e-4], "law": "coulomb"}
    return lambda: ss.identify(records, RIG, free={"mu0": (0.05, 0.5)}, starts=64, **given)


def _calls() -> dict[str, Callable[[], Call]]:
    """The calls by name, each with what it needs made when it is asked for."""
    lugre, coulomb = RIG(tilt_deg=1.7, amplitude=5.525e-4), RIG(amplitude=5.525e-4, **COULOMB)
    flow = ss.SwitchingFlow(
        {0: lambda t, y, n: (y[1], y[0] - y[0] ** 3 - n.d * y[1] + n.F * ss.maths.cos(t))},
        {},
        2 * ss.maths.pi,
        {"d": 0.2, "F": 0.3},
        ("x", "v"),
    )
    mean = "mean_velocity"
    over = {"drive.amplitude": (2e-4, 8e-4), "drive.omega": (60.0, 300.0)}
    return {
        "solve, one run": lambda: Call(lambda: ss.solve(lugre, periods=2000, samples=4), _of_notes, lambda r: r.strobe_v),
        "solve, one run without its curve": lambda: Call(
            lambda: ss.solve(RIG(mu0=0.05, amplitude=4e-4, tilt_deg=1.7), periods=20_000, keep="summary"),
            _of_notes,
            lambda r: r.mean_velocity,
        ),
        "solve, one exact run": lambda: Call(lambda: ss.solve(coulomb, periods=100_000, samples=4), _of_notes, lambda r: r.strobe_v[-9:]),
        "solve, Taylor steps": lambda: Call(
            lambda: ss.solve(coulomb.replace(friction=ss.Stribeck.example()), periods=1500, samples=4), _of_notes, lambda r: r.strobe_v
        ),
        "solve, batch": lambda: Call(
            lambda: ss.solve(RIG(tilt_deg=1.7, amplitude=np.linspace(3e-4, 8e-4, 3000)), periods=200),
            lambda r: _of_notes(r),
            lambda r: r.mean_velocity,
        ),
        "solve, exact batch": lambda: Call(
            lambda: ss.solve(RIG(amplitude=np.linspace(3e-4, 8e-4, 20000), **COULOMB), periods=400, workers=2),
            lambda r: _of_notes(r),
            lambda r: r.mean_velocity,
        ),
        "solve, the judge": lambda: Call(lambda: ss.solve(lugre, periods=3, method="radau"), _of_notes, lambda r: r.strobe_v),
        "solve, batch of the judge": lambda: Call(
            lambda: ss.solve(RIG(tilt_deg=1.7, amplitude=AMPLITUDES[:6]), periods=1, method="radau"), _of_notes, lambda r: r.mean_velocity
        ),
        "solve, Runge-Kutta": lambda: Call(
            lambda: ss.solve(lugre, periods=300, method="rk4", steps=10_000, samples=4), _of_notes, lambda r: r.strobe_v
        ),
        "solve, a flow": lambda: Call(lambda: ss.solve(flow, periods=3000, samples=4), _of_notes, lambda r: r.state),
        "sweep, in memory": lambda: Call(
            lambda: ss.sweep(RIG, amplitude=np.linspace(3e-4, 8e-4, 40), mu0=np.linspace(0.1, 0.2, 40), tilt_deg=1.7, settle=100),
            _of_grid,
            lambda g: g.mean_velocity.values,
        ),
        "sweep, in two threads": lambda: Call(
            lambda: ss.sweep(
                RIG, amplitude=np.linspace(3e-4, 8e-4, 60), mu0=np.linspace(0.1, 0.2, 40), tilt_deg=1.7, settle=100, workers=2
            ),
            _of_grid,
            lambda g: g.mean_velocity.values,
        ),
        "sweep, in a folder": lambda: Call(
            _in_folder(
                lambda out: ss.sweep(
                    RIG, amplitude=np.linspace(3e-4, 8e-4, 40), mu0=np.linspace(0.1, 0.2, 30), tilt_deg=1.7, settle=100, out=out, tile=50
                )
            ),
            _of_grid,
            lambda g: g.mean_velocity.values,
        ),
        "sweep, continue_along": lambda: Call(
            lambda: ss.sweep(RIG, amplitude=AMPLITUDES, mu0=np.linspace(0.1, 0.2, 8), tilt_deg=1.7, continue_along="amplitude"),
            _of_grid,
            lambda g: g.mean_velocity.values,
        ),
        "sweep, of a flow": lambda: Call(
            lambda: ss.sweep(flow, F=np.linspace(0.1, 0.4, 60), periods=300), _of_grid, lambda g: g.mean_x.values
        ),
        "map, refined": lambda: Call(
            lambda: ss.map(
                RIG, refine=True, coarse=5, amplitude=np.linspace(3e-4, 9e-4, 65), omega=np.linspace(120, 300, 65), tilt_deg=1.7
            ),
            _of_grid,
            lambda g: g.status.values,
        ),
        "continuation": lambda: Call(
            lambda: ss.continuation(RIG, parameter="amplitude", start=8e-4, stop=3e-4, tilt_deg=1.7, step=0.02, points=25),
            lambda b: b.ended if "interrupted" in b.ended else "",
            lambda b: b.values,
        ),
        "special_curve": lambda: _curve(),
        "attractors": lambda: Call(
            lambda: ss.attractors(
                RIG,
                parameter="mu0",
                values=np.linspace(0.1, 0.2, 30),
                starts={"v": np.linspace(-0.05, 0.05, 20)},
                settle=100,
                amplitude=6e-4,
                tilt_deg=1.7,
            ),
            _of_attrs,
            lambda d: d.period.values,
        ),
        "basins": lambda: Call(
            lambda: ss.basins(lugre, v=np.linspace(-0.05, 0.05, 1500), settle=200), _of_attrs, lambda b: b.map.attractor.values
        ),
        "bifurcation": lambda: Call(
            lambda: ss.bifurcation(RIG, parameter="mu0", values=np.linspace(0.03, 0.2, 60), amplitude=6e-4, tilt_deg=1.7),
            _of_attrs,
            lambda d: d.period.values,
        ),
        "bifurcation, from one start": lambda: Call(
            lambda: ss.bifurcation(RIG, parameter="mu0", values=np.linspace(0.03, 0.2, 1500), follow=False, amplitude=6e-4, tilt_deg=1.7),
            _of_attrs,
            lambda d: d.period.values,
        ),
        "atlas": lambda: Call(
            lambda: ss.atlas(RIG, over={"amplitude": np.linspace(3.3e-4, 3.9e-4, 8), "mu0": np.linspace(0.16, 0.2, 8)}, **COULOMB),
            _of_notes,
            lambda a: [len(a.borders)],
        ),
        "chaos_map": lambda: Call(
            lambda: ss.dynamics.chaos_map(
                RIG, mu0=np.linspace(0.03, 0.2, 24), amplitude=np.linspace(3e-4, 9e-4, 24), tilt_deg=1.7, periods=40
            ),
            _of_attrs,
            lambda d: d.period.values,
        ),
        "lyapunov": lambda: Call(
            lambda: ss.lyapunov(lugre, periods=3000), lambda f: f.note if "interrupted" in f.note else "", lambda f: f.spectrum
        ),
        "verdict": lambda: Call(
            lambda: ss.verdict(lugre, periods=2000), lambda f: f.why if "interrupted" in f.why else "", lambda f: f.exponents.spectrum
        ),
        "edge_state": lambda: _edge(),
        "periodic_orbit": lambda: Call(
            lambda: [ss.periodic_orbit(RIG(tilt_deg=1.7, amplitude=5e-4), 1) for _ in range(30)][-1], None, lambda o: o.strobe_state
        ),
        "limit_cycle": lambda: Call(lambda: [limit_cycle(_belt()) for _ in range(12)][-1], None, lambda c: [c.duration]),
        "certify": lambda: Call(
            lambda: [ss.dynamics.certify(ss.periodic_orbit(RIG(amplitude=6e-4, **COULOMB), 1), digits=400) for _ in range(4)][-1],
            None,
            lambda c: [c.multiplier is not None],
        ),
        "check": lambda: Call(
            lambda: ss.check(lugre, periods=40, rk4_steps=(2000, 10_000, 50_000)), _of_notes, lambda c: [c.mean_velocity]
        ),
        "bench": lambda: Call(
            lambda: ss.bench("lugre", experiments=["steady", "hysteresis", "lag", "breakaway"]), _of_notes, lambda b: [len(b.numbers)]
        ),
        "identify": lambda: Call(
            _fit_alone(), lambda f: "; ".join(n for n in f.notes if "interrupted" in n), lambda f: list(f.values.values())
        ),
        "interval, by profile": lambda: _of_fit("profile"),
        "interval, by bootstrap": lambda: _of_fit("bootstrap", repeats=400),
        "Fit.sample": lambda: _sample(),
        "compare": lambda: _compare(),
        "optimise": lambda: Call(lambda: ss.optimise(coulomb, over=over), _of_notes, lambda b: [b[mean]]),
        "pareto": lambda: Call(
            lambda: ss.optimisation.pareto(
                coulomb, over={"drive.amplitude": (3e-4, 8e-4)}, maximise=mean, minimise="drive_power", points=6
            ),
            _of_attrs,
            lambda f: f.mean_velocity.values,
        ),
        "propagate": lambda: Call(
            lambda: ss.optimisation.propagate(
                lugre,
                {"friction.mu_k_plus": ("normal", 0.15, 0.005)}
                if hasattr(lugre.friction, "mu_k_plus")
                else {"drive.amplitude": (5e-4, "1%")},
                samples=2**14,
            ),
            _of_notes,
            lambda p: p.values,
        ),
        "gradient": lambda: Call(lambda: [ss.optimisation.gradient(lugre) for _ in range(40)][-1], None, lambda g: list(dict(g).values())),
        "paper": lambda: Call(_in_folder(lambda out: ss.paper.reproduce(out, fast=True)), None, lambda r: [len(r.claims)]),
    }


def names() -> list[str]:
    """The names of all calls."""
    return list(_calls())


def _belt() -> Any:
    return ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))


def _curve() -> Call:
    branch = ss.continuation(RIG, parameter="amplitude", start=5e-4, stop=6e-4, mu0=0.18, **COULOMB)
    return Call(
        lambda: ss.dynamics.special_curve(branch, branch.special[0], "mu0", stop=0.2, step=0.001, points=400),
        lambda c: c.ended if "interrupted" in c.ended else "",
        lambda c: c.values,
    )


def _edge() -> Call:
    duffing = ss.SwitchingFlow(
        {0: lambda t, y, n: (y[1], y[0] - y[0] ** 3 - n.d * y[1] + n.F * ss.maths.cos(t))},
        {},
        2 * ss.maths.pi,
        {"d": 0.5, "F": 0.1},
        ("x", "v"),
    )
    return Call(lambda: ss.dynamics.edge_state(duffing, {"x": -1.0}, {"x": 1.0}, periods=60), _of_notes, lambda e: e.state)


def _of_fit(method: str, **options: Any) -> Call:
    fit = _fit()
    return Call(lambda: fit.interval("mu0", method=method, **options), None, list)


def _said(samples: Any) -> str:
    """The note of an interrupted chain; one that is only short says so too."""
    note = str(samples.attrs["note"])
    return note if note.startswith("interrupted") else ""


def _sample() -> Call:
    fit = _fit()
    return Call(lambda: fit.sample(draws=40, burn=10), _said, lambda d: d.mu0.values)


def _compare() -> Call:
    robot = RIG(tilt_deg=4.7, amplitude=4.564e-4)
    record = ss.virtual_rig(robot, noise=1e-5, seed=1)
    laws = {f"law {k}": RIG(tilt_deg=4.7, amplitude=4.564e-4, mu0=0.16 + 5e-4 * k) for k in range(60)}
    return Call(lambda: ss.compare(record, robot, laws=laws), _of_notes, lambda c: [c.best.rms])


def _same(one: Any, other: Any) -> bool:
    return bool(np.array_equal(np.asarray(one, float), np.asarray(other, float), equal_nan=True))


def interrupted(call: Call, seconds: float) -> dict[str, Any]:
    """What a call gives that SIGINT meets after some time, what a short one gives then, and which threads are left."""
    sent: list[float] = []
    time.sleep(0.6)  # three of Ctrl-C at once would end the program

    def press() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, press)
    timer.start()
    try:
        found = call.work()
        timer.cancel()
        told = call.says(found) if call.says else ""
        ended = "part" if told else "complete"
    except KeyboardInterrupt:
        ended, told = "KeyboardInterrupt", ""
    answered = time.perf_counter()
    timer.join()
    short = ss.mean_velocity(ss.solve(RIG(amplitude=5.525e-4, **COULOMB), periods=20))
    left = [t.name for t in threading.enumerate() if t is not threading.main_thread()]
    return {"ended": ended, "told": told, "waited": answered - sent[0] if sent else None, "threads": left, "next": f"{short:.9f}"}


def main(name: str, shares: list[float]) -> None:
    """One call, at several instants."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # it is ignored in what a shell runs in the background
    call = _calls()[name]()
    call.work()  # compiles, where it has to
    begun = time.perf_counter()
    whole = call.work()
    seconds = time.perf_counter() - begun
    print(json.dumps({"call": name, "seconds": seconds, "parts": call.says is not None}), flush=True)
    for share in shares:
        print(json.dumps({"share": share, **interrupted(call, share * seconds)}), flush=True)
    print(json.dumps({"again": _same(call.value(call.work()), call.value(whole))}), flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        print("\n".join(names()))
    else:
        main(sys.argv[1], [float(share) for share in sys.argv[2:]])
