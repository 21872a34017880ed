"""A friction law whose motion is prescribed by a record: what force does it give? Many parameter sets at once."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stickslip.errors import InputError
from stickslip.friction.adapter import LawAdapter, adapted
from stickslip.identifying.clocks import together
from stickslip.identifying.parameters import Parameters
from stickslip.identifying.weighting import weights_at
from stickslip.sealing import sealed

__all__ = ["DrivenProblem", "Motion", "Stepped", "driven_force", "law_force", "motion_of"]

_STEP = 1e-5
_MOST = 50_000  # samples of a force; means of neighbours take the place of more
_NUDGE = 1e-6


@dataclass(frozen=True, eq=False)
class Stepped:
    """Instants [s], and the mean slip velocity over the interval that ends at each [m/s]."""

    t: Any
    v: Any


@sealed
@dataclass(frozen=True, eq=False)
class Motion:
    """A prescribed motion with the force that was measured over it.

    Parameters
    ----------
    t : array (n,)
        [s]
    v : array (n,)
        Mean velocity over the interval that ends at each sample [m/s].
    load : array (n,)
        Normal force [N].
    force : array (n,)
        Measured friction force [N], positive against positive v.
    before : int
        How many of the samples only lead in; they are not compared.
    flipped : bool
        Whether the sign of the measured force was turned, so that friction takes energy.
    label : str
    """

    t: Any
    v: Any
    load: Any
    force: Any
    before: int
    flipped: bool
    label: str
    cut: str | None = None  # which samples were left out, and why
    weights: Any = None  # of all samples, where the user gave them
    given_sigma: bool = False  # whether the user gave the noise

    @property
    def kind(self) -> str:
        """What is fitted."""
        return "force"

    @property
    def y(self) -> Any:
        """The values that are compared."""
        return self.force[self._at]

    @property
    def weight(self) -> Any:
        """Weight of each value."""
        return np.ones(self.count) if self.weights is None else self.weights[self._at]

    @property
    def _at(self) -> Any:
        """Which samples are compared: those behind the lead, of a weight that is not zero."""
        behind = np.arange(self.before, len(self.t))
        return behind if self.weights is None else behind[self.weights[behind] > 0]

    @property
    def count(self) -> int:
        """Number of values."""
        return len(self._at)

    @property
    def time(self) -> Any:
        """Times of the values, counted from the middle of the record [s]."""
        return self._times[self._at]

    @property
    def _times(self) -> Any:
        return self.t - 0.5 * (self.t[self.before] + self.t[-1])

    @property
    def step(self) -> float:
        """Time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    @property
    def acceleration(self) -> Any:
        """Acceleration at the values [m/s^2]."""
        return self._accelerations[self._at]

    @property
    def _accelerations(self) -> Any:
        """From the mean velocities before and after each sample."""
        middle = self.t[1:] - 0.5 * np.diff(self.t)
        return np.gradient(np.interp(self.t, middle, self.v[1:]), self.t)

    def borne(self, reading: dict[str, Any]) -> Any:
        """The measured forces without what the sensor adds: array (n,), or (n, cases) [N]."""
        if not set(reading) & {"offset", "drift", "inertia", "gain"}:
            return self.force
        parts = {"offset": np.ones(len(self.t)), "drift": self._times, "inertia": self._accelerations}
        added = sum(np.multiply.outer(parts[what], reading[what]) for what in parts if what in reading)
        whole = self.force if np.ndim(added) < 2 else self.force[:, None]
        return (whole - added) / reading.get("gain", 1.0)

    def mean_square(self, rest: Any) -> float:
        """Mean square of what is left of all samples."""
        return float(np.average(rest**2, weights=self.weight * np.ones(len(rest))))

    def given(self, law: Any, cases: int, reading: dict[str, Any]) -> Any:
        """Friction forces at the values: array (values, cases) [N]."""
        return driven_force(law, self, cases, reading)[self._at]

    def held(self, given: Any, reading: dict[str, Any]) -> Any:
        """Which values are those of a contact that is held, and so bears whatever is measured."""
        borne = self.borne(reading)[self._at]
        return given == (borne if borne.ndim == 1 else borne[:, 0])

    def every(self, step: int) -> Motion:
        """The same motion, thinned out."""
        last = np.arange(0, len(self.t), step)
        x = np.concatenate([[0.0], np.cumsum(self.v[1:] * np.diff(self.t))])[last]
        t = self.t[last]
        v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
        before = int(np.searchsorted(last, self.before))
        weights = None if self.weights is None else self.weights[last]
        return dataclasses.replace(self, t=t, v=v, load=self.load[last], force=self.force[last], before=before, weights=weights)


def motion_of(rec: Any, load: float | None, label: str) -> Motion:
    """The motion of a record with a position (or velocity) and a force.

    If it is periodic from its first sample on, its first period leads in, so that the law is in its cycle; otherwise the law begins unbent.
    """
    rec, notes = _fewer(rec)
    thinned = bool(notes)
    c, moved = rec["force"], rec["position" if "position" in rec else "velocity"]
    t, x, F = c.time, moved.si, c.si
    if len(moved) != len(c) or not np.array_equal(moved.time, t):
        t, x, F, _ = together(rec, moved, c, notes)
    x = x if "position" in rec else _integrated(t, x)
    if load is None and "load" not in rec:
        raise InputError("identify", ['the record has no normal force; type load=... [N], or roles={"...": "load"} when reading'])
    N = _loads(rec["load"], t) if load is None else np.full(len(t), float(load))
    known, pressed = np.isfinite(t) & np.isfinite(x) & np.isfinite(F) & np.isfinite(N), ~(N <= 0)
    good = known & pressed & np.concatenate([[True], np.diff(t) > 0])
    why = {"miss a value": ~known, "have no positive load": known & ~pressed, "come at times that do not rise": known & pressed & ~good}
    reasons = " and ".join(f"{int(which.sum())} {what}" for what, which in why.items() if which.any())
    told = [note for note in notes if "left out" not in note] + ([f"of {len(t)} samples {reasons}; they are left out"] if reasons else [])
    cut = "; ".join(told) or None
    t, x, F, N = t[good], x[good], F[good], N[good]
    own = weights_at(rec, t)
    if len(t) < 16:
        raise InputError("identify", [f"{label} has {len(t)} samples with position, force and a positive load; allowed are 16 or more"])
    flipped = float(np.sum(0.5 * (F[1:] + F[:-1]) * np.diff(x))) < 0
    F = -F if flipped else F
    lead = _first_period(rec, t, F)
    if lead:
        shift = t[lead] - t[0]
        t = np.concatenate([t[:lead] - shift, t])
        x, F, N = (np.concatenate([a[:lead], a]) for a in (x, F, N))
        own = None if own is None else np.concatenate([own[:lead], own])
    v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
    if thinned:  # a mean over a reversal is that of neither side
        side = np.sign(v)
        same = np.concatenate([[True], side[1:] == side[:-1]]) & np.concatenate([side[1:] == side[:-1], [True]])
        own = same * (1.0 if own is None else own)
    return Motion(t, v, N, F, lead, flipped, label, cut, own)


def _loads(c: Any, t: Any) -> Any:
    """Normal forces at some times."""
    return c.si if len(c) == len(t) else np.interp(t, c.time, c.si)


def _fewer(rec: Any) -> tuple[Any, list[str]]:
    """A record of very many samples with means of neighbours in their place, and what to say of that."""
    count = len(rec["force"])
    if count <= _MOST:
        return rec, []
    thin = rec.averaged(rec["force"].rate * _MOST / count)
    return thin, [*(note for note in thin.notes if note not in rec.notes), "means about reversals are not compared"]


def _integrated(t: Any, v: Any) -> Any:
    return np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])


def _first_period(rec: Any, t: Any, F: Any) -> int:
    """Samples of the first period, if there are at least two and the force is at its end what it was at its start."""
    try:
        frequency = rec.drive_frequency().value
    except InputError:
        return 0
    if (t[-1] - t[0]) * frequency < 2:
        return 0
    lead = int(np.searchsorted(t, t[0] + 1 / frequency))
    return lead if abs(F[:8].mean() - F[lead : lead + 8].mean()) < 0.1 * np.ptp(F) else 0


def driven_force(law: Any, motion: Motion, cases: int = 1, reading: dict[str, Any] | None = None) -> Any:
    """Friction force of a law at every sample of a motion: array (samples, cases) [N].

    Between samples the velocity is constant. Inner states follow by exponential steps, which are exact where their rate is linear in
    them; a law's discrete memory is switched at the end of a step. A law that holds a body (a set-valued one at rest, Karnopp's in its
    band) gives there whatever was measured, within its break-away; `reading` has what the sensor adds to that, and a preload.
    """
    known, reading = adapted(law), reading or {}
    load = np.add.outer(motion.load, reading.get("preload", np.zeros(1)))
    measured = motion.borne(reading)
    return law_force(known, motion, load, measured if measured.ndim == 2 else measured[:, None], cases)


def law_force(known: LawAdapter, motion: Motion | Stepped, load: Any, measured: Any, cases: int) -> Any:
    """The same from loads and from what would be borne at rest: columns [N]."""
    if not known.dynamic:
        return _set_valued(known, motion.v[:, None], load, measured, cases)
    found = None if known.modes or known.random else _at_once(known, motion, load, measured, cases)
    return _step_by_step(known, motion, load, measured, cases) if found is None else found


def _step_by_step(known: LawAdapter, motion: Motion | Stepped, load: Any, measured: Any, cases: int) -> Any:
    out = np.empty((len(motion.t), cases))
    z = _wide(known.start(load[0]), cases)
    mode = tuple(np.zeros(cases) for _ in range(known.modes))
    nudge = _nudges(known, load.mean(axis=0), cases)
    steps, side = np.diff(motion.t, prepend=motion.t[0]), 0.0
    one = load.shape[1] == 1
    columns = motion.v.tolist(), load[:, 0].tolist() if one else load, steps.tolist(), measured
    for k, (v, N, h, given) in enumerate(zip(*columns, strict=True)):
        if mode and v * side < 0:
            z, mode = _switched(known, 0.0, N, z, mode, came=side)
        side = v or side
        z, mode = _stepped(known, v, N, h, z, mode, nudge)
        out[k] = known.response(v, tuple(z), N, mode, given)[0]
    return out


def _at_once(known: LawAdapter, motion: Motion | Stepped, load: Any, measured: Any, cases: int) -> Any:
    """The same for a law whose inner states have rates linear in them, each in its own, all samples together; None where they have not."""
    v, h = motion.v[:, None], np.diff(motion.t, prepend=motion.t[0])[:, None]
    states, count = known.states, len(motion.t)
    try:
        typical = _nudges(known, load.mean(axis=0), cases) / _NUDGE
        rates = [_rates(known, v, part[:, None] * typical, load, (count, cases)) for part in _PARTS[:, :1] * np.ones(states)]
        slope = (rates[1] - rates[0]) / (_PARTS[1, 0] * typical[:, None])
        uneven = _PARTS[2, np.arange(states) % _PARTS.shape[1]][:, None] * typical
        there = _rates(known, v, uneven, load, (count, cases))
    except (ValueError, TypeError):  # a law that takes one velocity at a time
        return None
    told = rates[0] + slope * uneven[:, None]
    if not (abs(there - told) <= 1e-9 * (abs(rates[0]) + abs(slope * uneven[:, None]))).all():
        return None
    return _recurrent(known, v, h, rates[0], slope, load, measured)


#: Inner states at which rates are looked at, in typical sizes: none, all alike, each its own.
_PARTS = np.array([[0.0, 0.0, 0.0, 0.0, 0.0], [0.7, 0.7, 0.7, 0.7, 0.7], [-0.41, 0.63, 0.29, -0.83, 0.57]])


def _rates(known: LawAdapter, v: Any, z: Any, load: Any, shape: tuple[int, ...]) -> Any:
    """Rates of the inner states at all samples: array (states, samples, cases)."""
    parts = known.rate(v, tuple(np.broadcast_to(each, shape) for each in z), load)
    return np.array([np.broadcast_to(part, shape) for part in parts], float).reshape(known.states, *shape)


def _recurrent(known: LawAdapter, v: Any, h: Any, rate: Any, slope: Any, load: Any, measured: Any) -> Any:
    """Forces where z after a step is A z + B."""
    moves = (v != 0) & (h > 0)
    a = np.minimum(slope * h, 30.0)
    part = h * np.where(abs(a) < 1e-8, 1.0, np.expm1(a) / np.where(abs(a) < 1e-8, 1.0, a))
    A, B = np.where(moves, 1.0 + part * slope, 1.0), np.where(moves, part * rate, 0.0)
    states, count, cases = rate.shape
    z, path = _wide(known.start(load[0]), cases), np.empty_like(rate)
    for k in range(count if states else 0):
        z = A[:, k] * z + B[:, k]
        path[:, k] = z
    return np.broadcast_to(known.response(v, tuple(path), load, (), measured)[0], (count, cases)) + 0.0


def _nudges(law: LawAdapter, load: Any, cases: int) -> Any:
    """Small steps of the inner states: array (states, cases)."""
    typical = law.scale(load)
    return _NUDGE * abs(_wide((1e-6,) * law.states if typical is None else typical, cases))


def _wide(parts: tuple[Any, ...], cases: int) -> Any:
    """A number, or one for each case, of each inner state: array (states, cases)."""
    return np.array([np.broadcast_to(part, cases) for part in parts], float).reshape(len(parts), cases)


def _stepped(law: LawAdapter, v: float, N: Any, h: float, z: Any, mode: Any, nudge: Any) -> tuple[Any, Any]:
    """Inner states and memory after a step of length h at constant velocity."""
    if v != 0 and h > 0 and z.size:
        f, ahead = (_wide(law.rate(v, tuple(at), N, mode), z.shape[1]) for at in (z, z + nudge))
        slope = (ahead - f) / nudge
        a = np.minimum(slope * h, 30.0)
        small = abs(a) < 1e-8
        z = z + h * f * np.where(small, 1.0, np.expm1(a) / np.where(small, 1.0, a))
    return _switched(law, v, N, z, mode) if mode else (z, mode)


def _switched(law: LawAdapter, v: float, N: Any, z: Any, mode: Any, came: float | None = None) -> tuple[Any, Any]:
    """The memory after every switch whose guard has fallen; where v passes zero, every one that falls only there."""
    before = None if came is None else [guard for guard, _, _ in law.switches(came, tuple(z), N, mode)]
    for i, (guard, new_mode, new_z) in enumerate(law.switches(v, tuple(z), N, mode)):
        fallen = np.asarray(guard) <= 0
        if before is not None:
            fallen = fallen & (np.asarray(before[i]) > 0)
        mode = tuple(np.where(fallen, new, old) for new, old in zip(new_mode, mode, strict=True))
        if new_z is not None:
            z = np.where(fallen, _wide(new_z, z.shape[1]), z)
    return z, mode


def _set_valued(law: LawAdapter, v: Any, N: Any, F: Any, cases: int) -> Any:
    moving = v != 0
    sliding = np.broadcast_to(law.sliding(np.where(moving, v, 1.0), N), (len(v), cases))
    backward, forward = law.breakaway(N)
    return np.where(moving, sliding, np.clip(F, backward, forward))


@dataclass(eq=False)
class DrivenProblem:
    """Fit of a law's force over prescribed motions, or of what a machine must be given for them.

    All derivatives, and all places of a multistart, are one batch.

    Parameters
    ----------
    parameters : Parameters
    targets : tuple of Motion or Bench
    level : float
        Standard deviation of the force, the same for all samples [N].
    thin : int
        The multistart looks at every so many-th sample.
    holds : bool
        Whether a contact may be held and then bears what is measured.
    """

    resolution: ClassVar[float] = 1e-4  # singular values of the derivatives, which are of first order, below this are zero
    batched: ClassVar[bool] = True
    nuisances: ClassVar[int] = 0
    timing: ClassVar[int] = 0
    quiet: ClassVar[float] = -np.inf  # the noise of a force is not known beforehand

    parameters: Parameters
    targets: tuple[Motion, ...]
    level: float
    thin: int = 1
    holds: bool = False
    solves: int = 0
    values: Any = None  # measured values that replace those of the targets (bootstrap)

    @property
    def y(self) -> Any:
        """All measured values."""
        return np.concatenate([m.y for m in self.targets]) if self.values is None else self.values

    @property
    def sigma(self) -> Any:
        """Standard deviation of each value."""
        return np.concatenate([self.level / np.sqrt(m.weight * np.ones(m.count)) for m in self.targets])

    def with_values(self, y: Any) -> DrivenProblem:
        """The same fit for other measured values."""
        return dataclasses.replace(self, values=y)

    def only(self, fixed: dict[str, float]) -> DrivenProblem:
        """The same fit with some parameters held."""
        return dataclasses.replace(self, parameters=self.parameters.only(fixed))

    def leaving_out(self, effects: Any) -> DrivenProblem:
        """The same fit of a law without some effects."""
        return dataclasses.replace(self, parameters=self.parameters.leaving_out(effects))

    def rough(self) -> DrivenProblem:
        """The same fit with fewer samples, for the search."""
        if self.thin <= 1 or self.values is not None:
            return self
        return dataclasses.replace(self, targets=tuple(m.every(self.thin) for m in self.targets), thin=1)

    def batch(self, places: Any, readings: Any) -> Any:
        """Forces for many places (cases, parameters) and readings of the sensors: array (values, cases); NaN where a place makes no law."""
        places = np.asarray(places, float)
        good, batches = self.parameters.batches(places)
        found = np.full((len(self.y), len(places)), np.nan)
        if good.any():
            cases = int(good.sum())
            self.solves += cases * len(self.targets)
            own = [{what: np.broadcast_to(value, len(places))[good] for what, value in r.items()} for r in readings]
            with np.errstate(all="ignore"):
                parts = [m.given(law, cases, r) for law, m, r in zip(batches, self.targets, own, strict=True)]
            found[:, good] = np.concatenate(parts)
        return found

    def held(self, h: Any, readings: Any) -> Any:
        """Which values are those of a contact that is held, and so bears whatever is measured."""
        if not self.holds:
            return np.zeros(len(h), bool)
        edges = np.cumsum([0, *(m.count for m in self.targets)])
        parts = zip(self.targets, edges[:-1], edges[1:], readings, strict=True)
        return np.concatenate([m.held(h[a:b], r) for m, a, b, r in parts])

    def slopes(self, place: Any, readings: Any) -> Any:
        """Derivatives of the values by differences, all parameters in one batch."""
        place = np.asarray(place, float)
        sign = np.where(place + _STEP <= 1.0, 1.0, -1.0)
        moved = self.batch(np.concatenate([place[None, :], place + np.diag(sign * _STEP)]), readings)
        return np.nan_to_num((moved[:, 1:] - moved[:, :1]) / (sign * _STEP))

    def aligned(self, place: Any) -> Any:
        """Nothing is aligned: force and motion have one clock."""
        return np.asarray(place, float)

    def bounds(self) -> tuple[Any, Any]:
        """Bounds of a place."""
        n = len(self.parameters.free)
        return np.zeros(n), np.ones(n)
