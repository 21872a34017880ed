"""What a second method says of a run: SciPy on the same machine in plain Python, for as long as two runs can be compared.

Two starts that are 1e-12 of the velocity scale apart say how long that is: until they are 1e-6 apart. Where the methods differ by more than
the tolerance of the less exact one, SciPy is asked once more, by another method: if it differs from itself by a third as much, the case
is open. Where plain Python takes too long, SciPy runs on the traced equations (`traced_judge.py`), once these are seen to be the same.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from traced_judge import TracedRun, trace_differs

import stickslip as ss
from stickslip.models.machine_adapter import machine_of

__all__ = ["judged", "span", "unit_of_way"]

PERIODS = 4  # that are compared; of a machine without a period as many of its own times
OFF, GROWN = 1e-12, 1e-6  # of the velocity scale: how far off the second start is, and where the comparison ends
#: Largest difference of ways in parts of the velocity scale times the time: of two exact methods, and of steps that are held to 1e-9.
EXACT, STEPS = 1e-7, 1e-5
PATIENCE = 12.0  # seconds of processor time for one run of the judge
TRACED = 1e-8  # tolerance of Radau steps on the traced equations
SAME_EQUATIONS = 1e-6  # of the largest acceleration: what the median of those by tracing differs by from those of plain Python


class TooLong(Exception):
    """The judge takes longer than its patience."""


def span(machine: Any, periods: int) -> dict[str, Any]:
    """How long to run a machine."""
    return {"periods": periods} if machine.period is not None else {"duration": periods * _time(machine)}


def _time(machine: Any) -> float:
    """Its period, or the time in which something happens [s]."""
    found = machine_of(machine).time_scale
    return float(np.max(np.asarray(1.0 if found is None else found)))


def unit_of_way(machine: Any) -> float:
    """The way that the velocity scale makes in that time [m]."""
    return float(machine_of(machine).velocity_scale) * _time(machine)


def judged(machine: Any) -> tuple[str, float, str]:
    """A verdict on a run from rest, the largest difference, and how it came about."""
    stiff = machine_of(machine).has_inner_states
    exact, how = {"rtol": 1e-9} if stiff else {}, span(machine, PERIODS)
    try:
        run = ss.solve(machine, **how, **exact)
    except ss.SolveError as error:
        return "unsolved", np.nan, _sentence(error)
    except ss.InputError as error:  # of its load, see `random_machines._beside`
        return "refused", np.nan, _sentence(error)
    compared = _Compared(machine, run, stiff)
    try:
        compared.until(ss.solve(machine, start=_off(machine), **how, **exact))
        return compared.verdict(*((("radau", 1e-9), ("bdf", 1e-9)) if stiff else (("dop853", 1e-12), ("radau", 1e-10))), how)
    except TooLong:
        return _traced(compared) if stiff else ("no judge", np.nan, f"SciPy takes longer than {PATIENCE:g} s")
    except ss.SolveError as error:
        return "no judge", np.nan, _sentence(error)


def _traced(compared: _Compared) -> tuple[str, float, str]:
    """The verdict of SciPy on the traced equations, which are those of plain Python where both say the same accelerations."""
    try:
        with _patience():
            judge = TracedRun(compared.machine, compared.run, TRACED)
            apart = trace_differs(compared.run, judge)
            if np.isnan(apart):
                return "no judge", np.nan, "nothing shows that the traced equations are those of plain Python"
            judge.run(1 if compared.machine.period is None else PERIODS)
            if judge.status.startswith(("failed", "too many")):
                return "no judge", np.nan, judge.status
            if apart > SAME_EQUATIONS:
                return "SILENT", apart, "the traced equations are not those of plain Python"
            error = compared.difference(judge)
            if error <= compared.tolerance:
                return "agrees", error, ""
            looser = TracedRun(compared.machine, compared.run, 100 * TRACED).run(1 if compared.machine.period is None else PERIODS)
            by_itself = compared.apart(judge, looser)
    except TooLong:
        return "no judge", np.nan, f"SciPy takes longer than {PATIENCE:g} s, on the traced equations too"
    return ("open" if by_itself > error / 3 else "SILENT"), error, f"differs by {error:.2g}, SciPy from itself by {by_itself:.2g}"


def _sentence(error: Exception) -> str:
    return str(error).partition(": ")[2].partition(";")[0][:120]


def _off(machine: Any) -> dict[str, Any]:
    """A start from which all bodies move a little."""
    if machine_of(machine).is_single:
        return {"v": OFF * float(machine_of(machine).velocity_scale)}
    mechanics = machine_of(machine).mechanics
    still = mechanics.velocities(0.0, (0.0,) * mechanics.coordinates)
    return {"v": np.array(still, float) + OFF * float(mechanics.velocity_scale)}


class _Compared:
    """A run of ours, and what of it can be compared."""

    def __init__(self, machine: Any, run: Any, stiff: bool):
        self.machine, self.run, self.tolerance = machine, run, STEPS if stiff else EXACT
        self.t = np.linspace(0.0, float(run.t[-1]) * (1 - 1e-9), 200)
        self.unit = unit_of_way(machine)

    def until(self, near: Any) -> None:
        """Keep the time in which a run from a start close by stays close."""
        t = self.t[self.t <= float(near.t[-1])]
        apart = np.max(abs(_ways(self.run, t) - _ways(near, t)), axis=1) / self.unit
        self.t = t[: int(np.argmax(apart > GROWN)) or len(t)]

    def verdict(self, first: tuple[str, float], second: tuple[str, float], how: dict[str, Any]) -> tuple[str, float, str]:
        """That of the judge, who is asked again by another method where it differs."""
        other = _asked(self.machine, first, how)
        error = self.difference(other)
        if error <= self.tolerance:
            return "agrees", error, ""
        again = _asked(self.machine, second, how)
        by_itself = self.apart(other, again)
        note = f"differs by {error:.2g}, SciPy from itself by {by_itself:.2g}; ends {self._ends(self.run)}, {self._ends(other)}"
        return ("open" if by_itself > min(error, self.difference(again)) / 3 else "SILENT"), error, note

    def _ends(self, run: Any) -> str:
        return f"{float(run.t[-1]):.9g} s ({run.status})"

    def apart(self, one: Any, other: Any) -> float:
        """Largest difference of the ways of two runs of judges."""
        return float(np.max(abs(_held(one, self.t) - _held(other, self.t)))) / self.unit

    def difference(self, other: Any) -> float:
        """Largest of ways; a contact that is lost in one alone, or elsewhere than in the other, is a difference too."""
        lost = float(abs(other.t[-1] - self.run.t[-1])) / _time(self.machine) if self._whole else 0.0
        return max(float(np.max(abs(_ways(self.run, self.t) - _held(other, self.t)))) / self.unit, lost)

    @property
    def _whole(self) -> bool:
        return bool(len(self.t) and self.t[-1] >= float(self.run.t[-1]) * (1 - 1e-6))


def _ways(run: Any, t: Any) -> Any:
    """Positions of all bodies (time, body) [m]."""
    x = run.parted.at(t)["x"]
    return x if x.ndim > 1 else x[:, None]


def _held(run: Any, t: Any) -> Any:
    """The same, where a run has ended those at its end."""
    return _ways(run, np.minimum(t, float(run.t[-1])))


def _asked(machine: Any, method: tuple[str, float], how: dict[str, Any]) -> Any:
    """The run of the judge; `TooLong` where that takes too much time."""
    with _patience():
        return ss.solve(machine, method=method[0], rtol=method[1], **how)


@contextmanager
def _patience() -> Iterator[None]:
    """Not longer than `PATIENCE`."""
    signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _stop(*_: Any) -> None:
    raise TooLong
