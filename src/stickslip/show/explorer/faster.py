"""The "make it faster" button: a search for the best values of some sliders within their ranges, with its gains and costs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.interruption import Interrupted
from stickslip.basics.variables import VARIABLES
from stickslip.inverse.optimisation.best_candidate import values_of
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.inverse.optimisation.constraints import Limit
from stickslip.inverse.optimisation.peaks import LIMITS
from stickslip.inverse.optimisation.searching import search
from stickslip.inverse.optimisation.unknowns import Unknowns, Varied
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.machines import OF_A_ROBOT, Shown
from stickslip.show.explorer.requests import IsCancelled, Message, Stopped
from stickslip.show.explorer.sliders import PARAMETERS, Parameter
from stickslip.show.explorer.surroundings import PATIENCE

#: As for maps: loose enough for the fast method, tight enough for four digits.
_RTOL = 1e-4
_POPULATION, _GENERATIONS = 32, 40
_GAIN = 1e-4  # relative to the speed: the smallest gain that a reader would notice
_END = 1e-3  # relative to the range of a slider: values this close to an end count as being there
_COMPARED = ("mean_velocity", "drive_power", "cost_of_transport", *LIMITS)


@dataclass(frozen=True)
class _Page:
    """The contents of a page: machine, sliders with their values, a function that makes a variant, and the message during compilation."""

    model: Any
    sliders: dict[str, Parameter]
    values: dict[str, float]
    make: Callable[[dict[str, Any]], Any]
    is_ready: bool
    waits: str


def faster_of(asked: Message, kernels: Kernels, stop: IsCancelled, shown: Shown | None = None) -> dict[str, Any]:
    """The best values of the selected sliders, with the numbers of the motion before and after."""
    assert asked.wish is not None
    page = _of_robot(asked, kernels) if asked.machine is None else _of_machine(asked, kernels, shown)
    _check(page, asked.wish.sliders)
    if not page.is_ready:
        return {"kind": "waits", "waits": page.waits}
    before = values_of(page.model, _RTOL)
    space = Unknowns(page.model, [_varied(page, name) for name in asked.wish.sliders], None, page.make)
    forwards = not before["mean_velocity"] < 0.0  # keep the direction of motion; a machine at rest should move forwards
    limits = [Limit(name, -np.inf, before[name]) for name in asked.wish.kept if math.isfinite(before.get(name, math.nan))]
    here = np.array([each.unknown(page.values[each.name]) for each in space.varied])
    worth, notes = _searched(space, here, -1.0 if forwards else 1.0, limits, stop)
    best = here if worth.best is None else worth.best
    after = values_of(page.make(space.changes(best)), _RTOL)
    if not abs(after["mean_velocity"]) > (1.0 + _GAIN) * abs(before["mean_velocity"]):
        best, after = here, before
        notes.append("no faster setting was found within the ranges of these sliders")
    ends = [each.name for each, u in zip(space.varied, best, strict=True) if min(u, 1.0 - u) < _END]
    rows = [{"name": name, "unit": _unit(name), "before": before[name], "after": after[name]} for name in _COMPARED if name in before]
    return {"kind": "faster", "values": space.changes(best), "rows": rows, "ends": ends, "tried": worth.tried, "notes": notes}


def _unit(name: str) -> str:
    unit = LIMITS.get(name) or VARIABLES[name].unit
    return "" if unit == "1" else unit.replace("^2", "²")


# ---- pages ----
def _of_robot(asked: Message, kernels: Kernels) -> _Page:
    state = asked.state
    sliders = {name: PARAMETERS[name] for name in state.active}
    model = state.robot()
    is_ready = kernels.ready(state, state.law, model, True)
    values = {name: float(state.values[name]) for name in sliders}
    return _Page(model, sliders, values, lambda changes: state.robot(None, **changes), is_ready, compiling(state, state.law))


def _of_machine(asked: Message, kernels: Kernels, shown: Shown | None) -> _Page:
    if shown is None or asked.machine is None:
        raise InputError("machine", [OF_A_ROBOT])
    given = dict(asked.machine)
    model = shown.with_values(given)
    values = {name: given.get(name, p.default) for name, p in shown.numbers.items()}
    waits = f"preparing {shown.title}: compiled once, which takes some seconds, and kept for later"

    def make(changes: dict[str, Any]) -> Any:
        return shown.with_values({**given, **changes})

    return _Page(model, shown.numbers, values, make, kernels.ready(shown, "", model, True), waits)


def _check(page: _Page, sliders: tuple[str, ...]) -> None:
    """Report sliders or machines that the search cannot handle."""
    unknown = [f"{name[:40]!r} has no effect here; {did_you_mean(name[:40], page.sliders)}" for name in sliders if name not in page.sliders]
    if page.model.period is None:
        unknown.append(f"{type(page.model).__name__} has no drive period, and a mean velocity is that of periods")
    if unknown:
        raise InputError("faster", unknown)


def _varied(page: _Page, name: str) -> Varied:
    """A slider with its range, which is extended to a value that was typed beyond it."""
    p, value = page.sliders[name], page.values[name]
    low, high = min(p.low, value), max(p.high, value)
    if not low < high:
        raise InputError("faster", [f"the slider of {p.label} has no room to move; leave it out"])
    return Varied(name, (name,), low, high)


# ---- the search ----
def _searched(space: Unknowns, here: Any, sign: float, limits: list[Limit], stop: IsCancelled) -> tuple[Candidates, list[str]]:
    """The population of a search that ends at the time limit, or when it is superseded."""
    end = time.monotonic() + PATIENCE

    def watch(*_: int) -> None:
        if stop() or time.monotonic() > end:
            raise Interrupted

    def tell(tried: int) -> None:
        if stop() or time.monotonic() > end:
            raise Interrupted

    worth = Candidates(space, "mean_velocity", sign, limits, tell=tell, rtol=_RTOL, watch=watch)
    try:
        search(worth, here[None], 0, _GENERATIONS, _POPULATION, climbing=False)
    except Interrupted:
        if stop():
            raise Stopped from None
        return worth, [f"the search was ended after {PATIENCE:g} s: the best so far"]
    return worth, []
