"""On which section a motion without a period is looked at: chosen from a run in one place, for motions, return maps, cycles and branches.

A section is a coordinate of the state that passes a value in one direction. Of one body on a spring it is a turning point: the body moves
as fast as the spring's far end, and slows down, in the middle of a slide, where the motion is smooth. Of anything else it is the position
that moves most, or, where no position is a state, the velocity; of a flow the state that moves most in its scale. It is cut in the middle
of its range, in the direction in which it passes faster. A state that jumps over the middle of its range is not chosen.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.analysis.state_order import order_of, states_of_run
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.maths import bisected
from stickslip.models.friction.law_adapter import SWITCHES
from stickslip.models.model_adapter import adapter_of

_SLIGHT = 1e-9  # of a range: what passes a value by less is rounding
_EVEN = 1e-6  # directions in which a state passes equally fast, but for so much
_HALVINGS = 60
_TYPE = "type section='v' for the middle of its range, section=('v', 0.0), or section=('v', 0.0, 1) for where it rises"


@sealed
class Cut:
    """A coordinate of the state, the value that it passes, and whether it rises (+1) or falls (-1) through it.

    Examples
    --------
    >>> Cut("v", 0.0, -1.0)
    Cut(name='v', value=0.0, direction=-1.0)
    """

    name: str
    value: float
    direction: float

    @property
    def asked(self) -> tuple[str, float, float]:
        """As `section=` takes it."""
        return self.name, float(self.value), self.direction

    def __str__(self) -> str:
        return f"{self.name} {'rises' if self.direction > 0 else 'falls'} through {self.value:.6g}"


@sealed
class Asked:
    """A section as it was asked for: a name alone, or with a value, or with a direction too; all None: the choice is free.

    A switch is a name alone, of a contact "stick of block", of a flow "free to hunted", and `switch` says so.
    """

    name: str | None = None
    value: float | None = None
    direction: float | None = None
    switch: bool = False


def asked_of(what: str, section: Any, names: tuple[str, ...], switches: tuple[str, ...] = ()) -> Asked:
    """A section as users type it: a name of a state, (name, value) or (name, value, direction); or a switch of a contact or a flow.

    Examples
    --------
    >>> asked_of("basins", ("v", 0.1), ("x", "v"))
    Asked(name='v', value=0.1, direction=None, switch=False)
    """
    if section is None:
        return Asked()
    name, *rest = section if isinstance(section, (tuple, list)) and len(section) in (1, 2, 3) else (section,)
    if not isinstance(name, str):
        raise InputError(what, [f"section = {section!r}; allowed is a name of the state, alone or with a value and a direction; {_TYPE}"])
    if name in switches:
        if rest:
            raise InputError(what, [f"section = {section!r}: a switch has neither value nor direction; type section={name!r}"])
        return Asked(name, switch=True)
    if name not in names:
        hint = did_you_mean(name, [*names, *switches])
        if name.partition(" of ")[0] in SWITCHES and not switches:
            why = "none of its contacts rests exactly: under a law with a rate they never stick"
            raise InputError(what, [f"section = {section!r}: {why}; name a state; {did_you_mean(name, names)}; {_TYPE}"])
        neither = " is not a name of the state" + ", and no switch" * bool(switches)
        raise InputError(what, [f"section = {section!r}: {name!r}{neither}; {hint}"])
    numbers = floats(rest) if rest else np.zeros(0)
    if not np.all(np.isfinite(numbers)) or (len(numbers) > 1 and numbers[1] not in (-1.0, 1.0)):
        raise InputError(what, [f"section = {section!r}; allowed are a finite value, and as a direction 1 (rises) or -1 (falls); {_TYPE}"])
    return Asked(name, *numbers.tolist())


def asked_for(what: str, section: Any, model: Any) -> Asked:
    """A section of a model as users type it; refused is a position that goes on with the far end of the spring that pulls it."""
    asked = asked_of(what, section, tuple(order_of(model).sections), adapter_of(model).switch_names)
    far = adapter_of(model).turning_velocity
    if asked.switch or asked.name in (None, "v") or far is None or not np.any(far):
        return asked
    mistake = f"section = {asked.name!r}, which goes on with the spring's far end"
    raise InputError(what, [f"{mistake}; allowed is the velocity; type section=('v', 0.0)"])


def states_in(run: Any, t: Array) -> dict[str, Array]:
    """The states of a run by which a section may be cut, at some instants, by name."""
    known = order_of(run.model).sections
    return {name: column for name, column in states_of_run(run, t).items() if name in known}


def cut_of(run: Any, asked: Asked | None = None) -> Cut:
    """The section on which the motion at the end of a run is looked at.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> print(cut_of(ss.solve(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law), duration=60)))
    v falls through 0
    """
    asked = Asked() if asked is None else asked
    free = asked.name in (None, "v") and asked.value is None
    far = adapter_of(run.model).turning_velocity
    if free and far is not None:
        return Cut("v", float(np.max(far)), -1.0)
    t = np.unique(run.t)
    late = t[t >= 0.5 * (t[0] + t[-1])]
    columns = states_in(run, late)
    name = _widest(run, columns) if asked.name is None else asked.name
    middle = float(0.5 * (columns[name].min() + columns[name].max())) if asked.value is None else asked.value
    return Cut(name, middle, _faster(late, columns[name], middle) if asked.direction is None else asked.direction)


def _widest(run: Any, columns: dict[str, Array]) -> str:
    """The state that moves most in its scale: a position where there is one, and none that jumps over the middle of its range."""
    order = order_of(run.model)
    names = order.names[order.places] or tuple(order.sections)
    smooth = [name for name in names if not _jumps(run, name, columns[name])] or names
    return max(smooth, key=lambda name: float(np.ptp(columns[name])) / order.sections[name])


def _jumps(run: Any, name: str, column: Array) -> bool:
    """Whether a state jumps over the middle of its range at a switch."""
    middle = 0.5 * (column.min() + column.max())
    before, after = run._columns.beside_switches(name)
    return bool(np.any((before - middle) * (after - middle) < 0.0))


def _faster(t: Array, column: Array, value: float) -> float:
    """The direction in which a column passes a value faster: in a slide, not where it rides along."""
    passes = np.diff(column > value)
    rates = np.diff(column)[passes] / np.diff(t)[passes]
    return -1.0 if len(rates) and -rates.min() > (1.0 + _EVEN) * rates.max() else 1.0


def passages(run: Any, cut: Cut) -> Array:
    """The instants at which a run passes its section."""
    t = np.unique(run.t)
    beyond = (states_in(run, t)[cut.name] - cut.value) * cut.direction
    size = _SLIGHT * max(float(abs(beyond).max()), 1e-300)
    where = np.flatnonzero((beyond[:-1] < 0) & (beyond[1:] >= 0) & (np.maximum(abs(beyond[:-1]), abs(beyond[1:])) > size))
    if not len(where):
        return np.zeros(0)

    def before(s: Array) -> Array:
        return (states_in(run, s)[cut.name] - cut.value) * cut.direction <= 0

    return np.asarray(bisected(before, t[where], t[where + 1], _HALVINGS)[1])
