"""The machines of the presets beside SciPy and beside Moreau's time stepping: what a run costs at the same error.

    python benchmarks/machines.py [--rounds 5] [--budget 20] [--only conveyor] [--json FILE]

Asked for is how far the machine goes in so many periods from rest, for three values of its main number within 5 % of the
preset's. The error is the worst relative one of the three, against the judge in plain Python (SciPy's DOP853 from event to event at
rtol 1e-12), which shares no line with the solver that it judges. Costs are CPU microseconds per period and case on one core, the
least of the rounds.

- *stickslip, one run at a time*: `ss.solve` of each case with its whole record, and a batch of 512 cases. It has no tolerance here.
- *SciPy with events*: the judge itself, at two tolerances.
- *SciPy, regularised*: LSODA on equations in which friction is a steep tanh, restarted where the drive jumps; both are refined together.
- *Moreau*: `rivals/moreau.py`, compiled by Numba, any number of contacts and stops.
"""

from __future__ import annotations

import pin  # isort: skip  # before NumPy

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import pairwise
from time import process_time
from typing import Any

import numpy as np

import plain_machines
import stickslip as ss
import table
from measure import Curve, again, curve
from plain_machines import Plain
from rivals import moreau
from rivals.base import Outcome, Rival

TARGETS = (1e-3, 1e-5, 1e-8)
BATCH = 512
#: Each preset with its main number.
MAIN = {
    "two_modules": "amplitude",
    "worm": "amplitude",
    "capsubot": "pulse",
    "capsule": "force_ratio",
    "stick_slip_stage": "stroke",
    "conveyor": "throw_index",
    "servo": "target",
}
PRESET = {"two_modules": 6e-4, "worm": 2e-3, "capsubot": 1.25, "capsule": 1.6, "stick_slip_stage": 5e-6, "conveyor": 2.5, "servo": 0.5}


@dataclass(frozen=True)
class Machines:
    """Some cases of one preset: a `Problem` as `measure` takes it."""

    name: str
    amplitude: np.ndarray  # values of the main number
    mu0: float = 1.0  # what tells stiff problems apart there

    @property
    def periods(self) -> int:
        """How many each case runs."""
        return self.plain(float(self.amplitude[0])).periods

    def some(self, count: int) -> Machines:
        """At most so many of the cases."""
        return replace(self, amplitude=self.amplitude[:count])

    def plain(self, value: float) -> Plain:
        """One of them as matrices."""
        made: Plain = getattr(plain_machines, self.name)(value)
        return made

    def ours(self, value: Any) -> Any:
        """One of them, or all as a batch."""
        return getattr(ss.presets, self.name)(**{MAIN[self.name]: value})

    def length(self) -> dict[str, Any]:
        """How long it runs."""
        periodic = self.ours(float(self.amplitude[0])).period is not None
        return {"periods": self.periods, "settle": 0} if periodic else {"duration": float(self.periods)}


def cases(name: str) -> Machines:
    """Three of one preset."""
    return Machines(name, PRESET[name] * np.linspace(0.95, 1.05, 3))


def _each(problem: Machines, one: Callable[[float], float]) -> Outcome:
    """One case after the other."""
    begin = process_time()
    found = np.array([one(value) for value in problem.amplitude.tolist()])
    return found, process_time() - begin


def _alone(problem: Machines, setting: Any) -> Outcome:
    """A run of each case, with its whole record; machines with several bodies here have equal ones, whose mean is their centre."""
    length = problem.length()

    def one(value: float) -> float:
        run = ss.solve(problem.ours(value), **length, **(setting or {}))
        return float(np.mean(run.x[-1] - run.x[0]))

    if setting is None:  # compiled before the clock
        one(float(problem.amplitude[0]))
    return _each(problem, one)


def _batch(problem: Machines, _setting: None) -> Outcome:
    """The cases again and again, until there are as many as a batch has."""
    many = problem.ours(np.resize(problem.amplitude, BATCH))
    options = {**problem.length(), "keep": "summary", "workers": 1}
    ss.solve(many, **options)
    begin = process_time()
    found = ss.solve(many, **options)
    seconds = process_time() - begin
    return np.asarray(found.displacement[: len(problem.amplitude)], dtype=float), seconds * len(problem.amplitude) / BATCH


def _moreau(problem: Machines, steps: int) -> Outcome:
    """Moreau's time stepping, with so many steps in a period."""
    moreau.displacement(problem.plain(float(problem.amplitude[0])), 20)
    return _each(problem, lambda value: moreau.displacement(problem.plain(value), steps))


def _scipy(problem: Machines, width: float) -> Outcome:
    """LSODA on smooth equations."""
    return _each(problem, lambda value: _smooth(problem.plain(value), width))


def _smooth(m: Plain, width: float) -> float:
    """The way by `solve_ivp`, from one jump of the drive to the next."""
    from scipy.integrate import solve_ivp

    count = len(m.mass)
    borders = [m.period * (n + part) for n in range(m.periods) for part in (0.0, *m.breaks)] + [m.period * m.periods]
    y = np.concatenate([np.zeros(count), m.rates])
    scale = np.concatenate([np.full(count, m.speed * m.period), np.full(count, m.speed)])
    for start, end in pairwise(borders):
        inside = start + 1e-9 * (end - start), end - 1e-9 * (end - start)  # on this side of what jumps
        most = {"rtol": 1e-3 * width, "atol": 1e-3 * width * scale, "max_step": m.period / 50}  # longer steps pass over landings
        done = solve_ivp(partial(_flow, m, width), inside, y, method="LSODA", **most)
        y = done.y[:, -1]
    return float(m.weights @ y[:count])


def _flow(m: Plain, part: float, t: float, y: np.ndarray) -> np.ndarray:
    """Rates of positions and velocities.

    Friction reverses over a part of the typical velocity, and rises to that of rest over the root of it. Stops are stiff springs that do
    not pull, so strongly damped that a landing hardly rebounds: the velocity of parting is 1/(2 zeta)^2 of that of approach.
    """
    q, u = np.split(y, 2)
    swing, zeta = 2 * math.pi / (m.period * part), 0.5 / math.sqrt(part)
    pressed = np.array([max(-(h @ q) * swing**2 - 2 * zeta * swing * (h @ u), 0.0) if h @ q < 0 else 0.0 for h in m.stops]) * m.mass[-1]
    w = (m.rows @ u + m.offset(t, m.numbers)[: len(m.rows)]) / (part * m.speed)
    N = np.array([m.load(t, m.numbers)[i] if stop < 0 else pressed[stop] for i, stop in enumerate(m.pressing)])
    R = np.where(w > 0, m.mu[:, 0], m.mu[:, 1]) * (1 + (m.static - 1) * np.exp(-part * w**2)) * N * np.tanh(w)
    push = m.force(t, q, u, m.numbers) - m.rows.T @ R + (m.stops.T @ pressed if len(m.stops) else 0.0)
    return np.concatenate([u, push / m.mass])


@cache
def _judged(name: str) -> dict[float, float]:
    problem = cases(name)
    return dict(zip(problem.amplitude.tolist(), _alone(problem, {"method": "dop853", "rtol": 1e-12})[0].tolist(), strict=True))


def answers(problem: Machines) -> np.ndarray:
    """The judge's."""
    return np.array([_judged(problem.name)[value] for value in problem.amplitude.tolist()])


STEPS = (40, 200, 1000, 5000, 20_000, 100_000, 500_000)
SOLVERS = (
    Rival("stickslip, one run at a time", "stickslip", (None,), _alone),
    Rival(f"stickslip, batch of {BATCH}", "stickslip", (None,), _batch),
    Rival("SciPy DOP853 with events", "scipy", tuple({"method": "dop853", "rtol": tol} for tol in (1e-5, 1e-9)), _alone),
    Rival("SciPy LSODA, regularised", "scipy", (1e-1, 1e-2, 1e-3, 1e-4, 1e-5), _scipy),
    Rival("Moreau, Numba", "numba", STEPS, _moreau),
)


def least(found: Curve) -> Curve:
    """With the least of its times instead of the median."""
    return replace(found, points=tuple(replace(point, times=(min(point.times),)) for point in found.points))


def text(name: str, row: list[Curve]) -> str:
    """The table of one machine: costs at each error, in brackets over those of one run of ours."""
    lines = [f"{name:32}{'error':>9}" + "".join(f"{f'at {target:.0e}':>26}" for target in TARGETS)]
    for found in row:
        error = f"{min(p.error for p in found.points):9.0e}" if found.points else f"{found.missing:>9}"
        lines.append(f"  {found.name:30}{error}" + "".join(f"{table.cell(found, t, row[0]):>26}" for t in TARGETS))
        lines += [f"    * {found.stopped}"] if found.stopped else []
    return "\n".join(lines)


def measured(name: str, rounds: int, budget: float) -> list[Curve]:
    """All solvers on one machine; what is fast in several rounds, of which the least counts."""
    problem: Any = cases(name)
    row = [curve(solver, problem, budget, answers) for solver in SOLVERS]
    for _ in range(1, rounds):
        row = [again(found, solver, problem) for found, solver in zip(row, SOLVERS, strict=True)]
    return [least(found) for found in row]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5, help="in which what is fast is measured again; the least counts")
    parser.add_argument("--budget", type=float, default=20, help="CPU seconds for a row on one machine")
    parser.add_argument("--only", default="", help="machines with this in their name")
    parser.add_argument("--json", metavar="FILE")
    asked = parser.parse_args()
    print(f"# {pin.WHERE}; " + ", ".join(f"{k} {v}" for k, v in table.versions().items()))
    print("# CPU microseconds per period and case at a worst relative error of the way made; in brackets over one run of ours", flush=True)
    rows = {}
    for name in (name for name in MAIN if asked.only in name):
        rows[name] = measured(name, asked.rounds, asked.budget)
        print(text(name, rows[name]), flush=True)
    if asked.json:
        table.write_json(asked.json, {name: [row] for name, row in rows.items()}, pinned=pin.WHERE)


if __name__ == "__main__":
    main()
