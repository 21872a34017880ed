"""Where functions of a user pass zero in a run: roots on its dense output, to the last digits that it has.

A function is asked at the ends of all pieces and at many instants within them. Between two of these in one piece it is smooth: a change
of its sign is bracketed until nothing is between, and where it turns round before zero its extreme is looked for, beyond which there may be
two roots. At a node it may jump. An extreme that is zero within what the run resolves is a touch: whether it passes there is not resolved.
Its instant has half as many digits as that of a passage.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.models.crossings import Crossing
from stickslip.results.events import Event

KIND = "crossing"  # of an `Event`
_WITHIN = 12  # instants within a piece at least
_STEPS = 4.0  # samples of the columns between two instants
_ASIDE = 1e-3  # of the way to the next instant: from so near comes a slope
_HALVINGS, _SECTIONS = 80, 60
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_ROUNDING = 1e-13  # of a function's largest value: what rounding makes of zero
_RESOLVED = 1e-12  # the same: what a touch is told from, of a run that is exact to rounding


def found_events(run: Any, watched: Mapping[str, Crossing]) -> list[Event]:
    """Every passage of the functions through zero, in order; of a touch, which does not pass, the signs before and after are one.

    An event at the start itself is none. Of a function that stays at zero it is the instant at which it comes there.

    Examples
    --------
    >>> import stickslip as ss
    >>> fall = ss.SwitchingFlow(lambda t, y: (y[1], -10.0), states=("h", "v"))
    >>> run = ss.solve(fall, start={"h": 5.0}, duration=2.0)
    >>> [(event.part, round(event.t, 12)) for event in found_events(run, {"ground": Crossing(lambda t, y: y[0], 0, False)})]
    [('ground', 1.0)]
    """
    t, index = _instants(run)
    events: list[Event] = []
    for name, each in watched.items():
        signal = _Signal(run, name, each)
        events += [Event(at, KIND, a, b, name) for at, a, b in signal.crossings(t, index) if each.takes(a, b)]
    return sorted(events, key=lambda event: event.t)


def _instants(run: Any) -> tuple[Array, Array]:
    """Instants at which functions are asked, with their pieces: the ends of each, and many within."""
    nodes = np.asarray(run.pieces.t)
    lengths = np.diff(nodes)
    parts = np.maximum(_WITHIN, np.ceil(lengths / (_STEPS * run._columns.step)).astype(int))
    index = np.repeat(np.arange(len(lengths)), parts + 1)
    within = np.arange(len(index)) - np.repeat(np.cumsum(parts + 1) - (parts + 1), parts + 1)
    t = nodes[index] + lengths[index] * (within / parts[index])
    t[within == parts[index]] = nodes[1:]
    return t, index


class _Signal:
    """One function along a run."""

    def __init__(self, run: Any, name: str, crossing: Crossing):
        self.run, self.name, self.function = run, name, crossing.function
        self.one_by_one = False

    def values(self, t: Array, index: Array) -> Array:
        """The function at times on the given pieces."""
        if not self.one_by_one:
            try:
                return self._asked(t, index)
            except (ValueError, TypeError):  # it asks `if` of arrays, or knows numbers only
                self.one_by_one = True
        return np.concatenate([self._asked(t[k : k + 1], index[k : k + 1], True) for k in range(len(t))]) if len(t) else np.zeros(0)

    def _asked(self, t: Array, index: Array, one: bool = False) -> Array:
        try:
            values = np.asarray(self.function(*arguments_at(self.run, t, index, one)), float)
        except (ValueError, TypeError) as error:
            if not one:
                raise
            raise InputError("events", [f"events[{self.name!r}] raised {type(error).__name__}: {error}"]) from error
        except Exception as error:
            raise InputError("events", [f"events[{self.name!r}] raised {type(error).__name__}: {error}"]) from error
        if values.shape not in ((), (1,), t.shape):
            raise InputError("events", [f"events[{self.name!r}] gives an array of shape {values.shape}; allowed is one number"])
        values = np.broadcast_to(values, t.shape)
        if not np.all(np.isfinite(values)):
            at = float(t[np.flatnonzero(~np.isfinite(values))[0]])
            raise InputError("events", [f"events[{self.name!r}] is not finite at t = {at:.9g}; allowed are finite numbers"])
        return values

    def crossings(self, t: Array, index: Array) -> list[tuple[float, int, int]]:
        """Instants, and the signs before and after, in order."""
        if not len(t):
            return []
        g = self.values(t, index)
        size = float(abs(g).max())
        band = _ROUNDING * size
        t, index, g = self._with_extremes(t, index, g, size)
        sign = np.where(abs(g) <= band, 0, np.sign(g)).astype(int)
        return self._passed(t, index, g, sign, band, size)

    def _with_extremes(self, t: Array, index: Array, g: Array, size: float) -> tuple[Array, Array, Array]:
        """The samples with those at which the function comes nearest to zero between two of them, where it turns round there."""
        same = np.flatnonzero((np.diff(index) == 0) & (np.diff(t) > 0.0) & (g[:-1] * g[1:] > 0.0))
        side, aside = np.sign(g[same]), _ASIDE * (t[same + 1] - t[same])
        falls = (self.values(t[same] + aside, index[same]) - g[same]) * side < 0.0
        same, side, aside = same[falls], side[falls], aside[falls]
        turns = (g[same + 1] - self.values(t[same + 1] - aside, index[same])) * side > 0.0
        same, side = same[turns], side[turns]
        if not len(same):
            return t, index, g
        low, high = t[same].copy(), t[same + 1].copy()
        for _ in range(_SECTIONS):
            first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            left = self.values(first, index[same]) * side <= self.values(second, index[same]) * side
            low, high = np.where(left, low, first), np.where(left, second, high)
        at = 0.5 * (low + high)
        values = self.values(at, index[same])
        near = abs(values) <= self._resolved * size
        values = np.where(near, 0.0, values)
        kept = near | (values * side < 0.0)
        order = np.lexsort((np.concatenate([t, at[kept]]), np.concatenate([index, index[same][kept]])))
        return tuple(np.concatenate(pair)[order] for pair in ((t, at[kept]), (index, index[same][kept]), (g, values[kept])))  # type: ignore[return-value]

    @property
    def _resolved(self) -> float:
        """The size below which the function counts as touching zero, as a part of the function's largest value."""
        return _RESOLVED if self.run.method in ("exact", "taylor") else max(_RESOLVED, float(self.run.rtol))

    def _passed(self, t: Array, index: Array, g: Array, sign: Array, band: float, size: float) -> list[tuple[float, int, int]]:
        """Passages from samples whose signs are known."""
        known = np.flatnonzero(sign)
        after: list[tuple[int, float, int]] = []  # the sample before, how large a function may be that is zero, and the sign after
        touched: list[tuple[float, int, int]] = []
        first, second = known[:-1], known[1:]
        changes = (sign[first] != sign[second]) | (second > first + 1)
        for a, b in zip(first[changes].tolist(), second[changes].tolist(), strict=True):
            if sign[a] == sign[b] and float(abs(g[a + 1 : b]).min()) > self._resolved * size:
                continue
            if sign[a] == sign[b] and b == a + 2:
                touched.append((float(t[a + 1]), int(sign[a]), int(sign[b])))
            else:
                after.append((a, band if b > a + 1 else 0.0, int(sign[b])))
        if len(known) and known[-1] < len(sign) - 1:  # it comes to zero, and stays there until the end
            after.append((int(known[-1]), band, 0))
        at = self._instants(t, index, sign, after)
        return sorted([*touched, *((instant, int(sign[a]), then) for instant, (a, _, then) in zip(at, after, strict=True))])

    def _instants(self, t: Array, index: Array, sign: Array, after: list[tuple[int, float, int]]) -> list[float]:
        """Where the function leaves its side, between samples and the next ones, until they are neighbours; where it jumps."""
        before = np.array([a for a, _, _ in after], int)
        low, high, side, band = t[before], t[before + 1], sign[before], np.array([band for _, band, _ in after])
        within = np.flatnonzero((index[before + 1] == index[before]) & (high > low))
        if len(within):

            def beyond(at: Array, some: Array) -> Array:
                return self.values(at, index[before[some]]) * side[some] - band[some]

            high[within] = _sign_changes(beyond, low[within], high[within], within)
        return [float(at) for at in high]


def _sign_changes(function: Callable[[Array, Array], Array], low: Array, high: Array, which: Array) -> Array:
    """Where functions that are positive at `low`, and not at `high`, become so: the later of two neighbouring numbers.

    By Chandrupatla's method: inverse quadratic interpolation where that converges, else halves (Advances in Engineering Software 28,
    1997, 145-149).

    Parameters
    ----------
    function : callable
        Of instants, one for each of some functions, whose numbers follow.
    low, high : array (functions,)
    which : array (functions,)
        Their numbers.
    """
    new, old, ends = low.copy(), high.copy(), high.copy()
    f_new, f_old = function(low, which), function(high, which)
    left, share = np.arange(len(low)), np.full(len(low), 0.5)
    for _ in range(_HALVINGS):
        least, most = np.minimum(new, old), np.maximum(new, old)
        apart = np.nextafter(least, np.inf) < most
        ends[left[~apart]] = most[~apart]
        if not apart.any():
            break
        left, share, least, most = left[apart], share[apart], least[apart], most[apart]
        new, old, f_new, f_old = new[apart], old[apart], f_new[apart], f_old[apart]
        at = np.clip(new + share * (old - new), np.nextafter(least, np.inf), np.nextafter(most, -np.inf))
        value = function(at, which[left])
        same = (value > 0.0) == (f_new > 0.0)
        third, f_third = np.where(same, new, old), np.where(same, f_new, f_old)
        old, f_old = np.where(same, old, new), np.where(same, f_old, f_new)
        new, f_new = at, value
        ends[left] = np.maximum(new, old)
        with np.errstate(all="ignore"):
            xi, phi = (new - old) / (third - old), (f_new - f_old) / (f_third - f_old)
            inverse = f_new / (f_old - f_new) * f_third / (f_old - f_third)
            inverse += (third - new) / (old - new) * f_new / (f_third - f_new) * f_old / (f_third - f_old)
            smooth = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi) & np.isfinite(inverse)
            shortest = np.spacing(abs(new)) / abs(old - new)
        share = np.clip(np.where(smooth, inverse, 0.5), shortest, 1.0 - shortest)
    return ends


def arguments_at(run: Any, t: Array, index: Array, one: bool = False) -> tuple[Any, ...]:
    """What a function of the state is given at times on the given pieces: numbers if there is `one`."""

    def plain(value: Any) -> Any:
        return value[0] if one and np.ndim(value) else value

    if not run.pieces.layout.bodies:  # of a flow as a guard is
        y = [plain(column) for column in run.pieces.states(t, index).T]
        return (plain(t), y, run.model.given) if run.model.numbers else (plain(t), y)
    return (_StateAt(run, t, index, plain),)


class _StateAt:
    """The state of a machine at some times, with the columns of `observable`: numbers of one body and contact, tuples of several."""

    def __init__(self, run: Any, t: Array, index: Array, plain: Any):
        self._run, self._index, self._times, self._plain = run, index, t, plain
        self.t, self.model = plain(t), run.model
        self._states = run._states_at(t, index)

    def _column(self, name: str) -> Any:
        """A column with axes for all parts."""
        if name in ("x", "v", "z"):
            x, v, z = self._states
            return {"x": x, "v": v, "z": self._run._columns.of_laws(z)}[name]
        if "_columns" not in self.__dict__:
            self._columns = self._run._columns.forces_at(self._times, self._index, *self._states)
        if name not in self._columns:
            raise AttributeError(f"s has no {name!r}; it has t, model, x, v, z, bodies, contacts, {', '.join(self._columns)}")
        return self._columns[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in ("bodies", "contacts"):
            return self._parts(name)
        column = self._column(name)
        if column.ndim == 1:
            return self._plain(column)
        own = self._run.pieces.layout.own
        number = own.get("body" if name in _OF_BODIES else "contact")
        return tuple(self._of(column[:, i]) for i in range(column.shape[1])) if number is None else self._of(column[:, number])

    def _of(self, column: Array) -> Any:
        """The values of one part; of several inner states a tuple."""
        if column.ndim == 1:
            return self._plain(column)
        several = tuple(self._plain(each) for each in column.T)
        if not several:
            raise AttributeError("the law has no inner state z")
        return several[0] if len(several) == 1 else several

    def _parts(self, kind: str) -> dict[str, Any]:
        layout = self._run.pieces.layout
        names = [part.name for part in (layout.bodies if kind == "bodies" else layout.contacts)]
        return {name: _PartAt(self, i, _OF_BODIES if kind == "bodies" else _OF_CONTACTS) for i, name in enumerate(names)}


_OF_BODIES, _OF_CONTACTS = ("x", "v", "acceleration"), ("slip", "load", "friction_force", "z")


class _PartAt(SimpleNamespace):
    """The columns of one body or contact."""

    def __init__(self, state: _StateAt, number: int, names: tuple[str, ...]):
        super().__init__(_state=state, _number=number, _names=names)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._names:
            raise AttributeError(f"it has no {name!r}; it has {', '.join(self._names)}" if not name.startswith("_") else name)
        return self._state._of(self._state._column(name)[:, self._number])
