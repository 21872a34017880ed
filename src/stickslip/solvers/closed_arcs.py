"""A model whose motion is made of closed arcs, in the numbers of its arcs.

Whether a motion is so is asked of the traced equations (`engine/closed_arc_conditions.py`), never of classes; so are the numbers. The
motion is v' = a sin(omega t) - r, with r = r_plus forwards and -r_minus backwards, at rest while -s_minus <= a sin(omega t) <= s_plus.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.batch import numbers_by_name
from stickslip.basics.contracts import Array, Model
from stickslip.basics.fields import are_single, is_array
from stickslip.basics.frozen_arrays import seal
from stickslip.engine.closed_arc_conditions import ArcNumbers, closed_of
from stickslip.engine.kinds import edition_of, known_kind
from stickslip.engine.remembered import OfFrozen, Remembered
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.position_dependence import knows_position

_ROUNDING = 1e-14  # of the friction: by how much less the limits of rest may be than what slides


@dataclass(frozen=True, eq=False)
class Arcs:
    """A model in the numbers of its arcs; each is an array (cases,), accelerations in m/s^2.

    Parameters
    ----------
    drive : array
        a, the amplitude of the acceleration that the drive gives to a free body.
    omega, period : array
        Angular frequency [rad/s] and period [s] of the drive.
    resist_plus, resist_minus : array
        Deceleration while sliding forwards, and backwards (with gravity along the track).
    hold_plus, hold_minus : array
        Drive acceleration at which the body breaks away forwards, and backwards.
    along : array
        Acceleration of gravity along the track.
    """

    drive: Array
    omega: Array
    period: Array
    resist_plus: Array
    resist_minus: Array
    hold_plus: Array
    hold_minus: Array
    along: Array


class _Rows:
    """The equations' numbers of all cases of a model, and what follows from them."""

    def __init__(self, numbers: ArcNumbers, count: int):
        self._numbers, self.count = numbers, count

    @cached_property
    def arcs(self) -> Arcs:
        """Each number as a column."""
        return Arcs(**seal({name: value + np.zeros(self.count) for name, value in self._numbers.numbers.items()}))

    @cached_property
    def flaw(self) -> str | None:
        """The condition that they violate; None if there is none."""
        return _unfit(self._numbers)


_kept: Remembered[_Rows] = Remembered(most=64)
#: Of frozen batches the same by the edition of their functions: whether it has closed arcs is asked of a batch before its arcs are.
_of_batches: OfFrozen[dict[int, _Rows]] = OfFrozen(lambda model: {})
_MOST_KEPT = 1 << 16  # cases of a batch
_places: Remembered[bool] = Remembered()


def dimensionless_arcs(model: Model, numbers: dict[str, Any] | None = None) -> Arcs:
    """The arcs' numbers of every case of a model that `handles` accepts, from its own equations; its `numbers_by_name` may be given.

    Examples
    --------
    >>> import stickslip as ss
    >>> arcs = dimensionless_arcs(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"))
    >>> round(float(arcs.resist_plus[0] / arcs.drive[0]), 6)  # alpha_plus
    0.477433
    """
    return _rows(model, numbers_by_name(model) if numbers is None else numbers).arcs


def _rows(model: Model, numbers: dict[str, Any]) -> _Rows:
    """The equations' numbers: columns where the model's are arrays, single floats elsewhere; they are kept a while."""

    def evaluated() -> _Rows:
        count = next((len(value) for value in numbers.values() if is_array(value)), 1)
        return _Rows(closed_of(model).rows_with(numbers), count)

    if are_single(numbers.values()):
        return _kept((known_kind(model), array("d", numbers.values()).tobytes()), evaluated)
    edition, kept = edition_of(model), _of_batches(model)
    if edition is None:
        return evaluated()
    rows = kept.get(edition) or evaluated()
    if rows.count <= _MOST_KEPT:
        kept[edition] = rows
    return rows


def handles(model: Model) -> str | None:
    """None if the motion of a model, or of all of a batch, is made of closed arcs; else why not.

    Examples
    --------
    >>> import stickslip as ss
    >>> handles(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"))
    >>> handles(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4))
    'LuGre is a dynamic law (rate and force); exact arcs need a set-valued law (sliding and breakaway)'
    """
    kind = type(model).__name__
    if machine_of(model).one_body is None:
        return f"{kind} has several bodies or contacts; exact arcs are closed formulas for one"
    rubs = law_of(model)
    law = rubs.name
    if rubs.dynamic:
        return f"{law} is a dynamic law (rate and force); exact arcs need a set-valued law (sliding and breakaway)"
    if model.period is None:
        return f"{kind} has no period; exact arcs are closed formulas for a harmonic drive"
    if not rubs.compiles:
        return f"{law} is written for plain numbers only; exact arcs need its equations"
    if _places(known_kind(model), lambda: knows_position(model)):
        return f"position appears in the equations of {kind}; exact arcs have no place for it"
    try:
        rows = _rows(model, numbers_by_name(model))
    except Exception as error:  # equations that the engine cannot trace, which it says itself where it must
        return f"the equations of {kind} cannot be looked through: {error}"
    return None if rows.flaw is None else rows.flaw.format(kind=kind, law=law)


def _unfit(rows: ArcNumbers) -> str | None:
    """The condition that the equations of some rows violate, for `str.format` with a kind and a law; None if there is none."""
    if rows.broken:
        why = ", ".join(rows.broken)
        return "the acceleration of {kind} under {law} depends on " + f"{why}; exact arcs are closed formulas for {_FORM} only"
    ahead, back, up, down, along = (rows.numbers[name] for name in ("resist_plus", "resist_minus", "hold_plus", "hold_minus", "along"))
    bound = _ROUNDING * np.maximum(np.max(abs(ahead + along)), np.max(abs(back - along)))
    if np.any(ahead + back < 0):
        return "the sliding friction of {law} feeds the motion; exact arcs need sliding(+v) >= sliding(-v)"
    if np.any(up < ahead - bound) or np.any(down < back - bound):
        return "{law} breaks away below its sliding friction; exact arcs need breakaway() at or beyond sliding()"
    return None


_FORM = "one sine of the drive's period that begins at 0, and a constant in each direction (as Coulomb friction makes it)"
