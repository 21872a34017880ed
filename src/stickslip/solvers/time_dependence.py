"""Whether the equations of a model come back after its period: the compiled methods begin their time anew with each one."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.engine.kinds import edition_of
from stickslip.engine.remembered import OfFrozen
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.mechanics import Mechanics

_INSTANTS = (0.5 * (3 - 5**0.5), 0.7236067977499789)  # of a period, at which no drive is likely to jump
_SAME = 1e-9  # of the largest value
_WHOLE = 1e-9  # of a number of samples

#: Of frozen models the editions of their functions with which they come back; an empty set for another model each time.
_recurring: OfFrozen[set[int | None]] = OfFrozen(lambda model: set())


def check_period(model: Model, machine: MachineAdapter | None = None) -> None:
    """Raise `InputError` where the load or the acceleration of a model is another one a period later; its adapter may be given.

    Examples
    --------
    >>> import stickslip as ss
    >>> check_period(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4))
    """
    if model.period is None:
        return
    edition, known = edition_of(model), _recurring(model)
    if edition is None or edition not in known:
        _check(model, machine)
        known.add(edition)


def _check(model: Model, machine: MachineAdapter | None) -> None:
    mechanics = (machine or machine_of(model)).mechanics
    _check_samples(model, mechanics)
    try:
        start, still, free = mechanics.start, (0.0,) * mechanics.coordinates, (0.0,) * len(mechanics.contacts)
        asked = {"load": lambda t: mechanics.loads(t, start), "acceleration": lambda t: mechanics.accelerations(t, start, still, free)}
        if mechanics.stops:
            asked["distance of a stop"] = lambda t: tuple(stop.gap(t, start) for stop in mechanics.stops)
        differences = {name: _missed(f, mechanics.period) for name, f in asked.items()}
    except Exception:  # what is not written for these numbers is told where it is traced
        return
    for name, (missed, largest) in differences.items():
        if np.any(missed > _SAME * largest):
            kind = type(model).__name__
            raise InputError(
                kind,
                [f"its {name} is another one a period later, by up to {np.max(missed):.4g}; allowed is a period after which all parts of "
                 f"the equations come back; write the property period of {kind} so, or, if there is none, take a method whose time goes "
                 'on: method="dop853" or method="radau"'],
            )  # fmt: skip


def _check_samples(model: Model, mechanics: Mechanics) -> None:
    """Note a period that is no whole number of the time between samples."""
    between = mechanics.controllers.sample
    if between is None:
        return
    ratio = np.asarray(model.period / between, float)
    if np.any(abs(ratio - np.rint(ratio)) > _WHOLE * ratio):
        kind = type(model).__name__
        raise InputError(
            kind,
            [f"its controller samples every {between!r} s, and its period of {model.period!r} s is not a multiple of that; allowed is a "
             f"period that is; make {kind} anew with these numbers"],
        )  # fmt: skip


def _missed(f: Callable[[Any], Any], T: Any) -> tuple[Any, Any]:
    """How far a function of time is from itself a period later, and its largest value, for each case."""
    rows = [[value for s in _INSTANTS for value in f((s + k) * T)] for k in (0, 1)]
    if all(type(value) is float and isfinite(value) for row in rows for value in row):
        return max(abs(b - a) for a, b in zip(*rows, strict=True)), max(abs(value) for row in rows for value in row)
    now, later = (np.array(np.broadcast_arrays(*values), float) for values in rows)
    return np.max(abs(later - now), axis=0), np.max(np.maximum(abs(now), abs(later)), axis=0)
