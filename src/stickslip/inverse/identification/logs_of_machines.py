"""A machine whose motion was measured: what torque, current or force does that motion take? Many parameter sets at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.units import quantity_of
from stickslip.inverse.identification import strokes
from stickslip.inverse.identification.clocks import Clock, clock_of
from stickslip.inverse.identification.law_forces import Stepped, law_force
from stickslip.inverse.identification.measured_motion import motion_behind, noise_of_velocity
from stickslip.inverse.identification.smoothing import Smooth
from stickslip.inverse.identification.targets import Compared
from stickslip.models.friction.law_adapter import LawAdapter
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.records.record import Record


#: What may be applied to a machine: kind of the values -> role of the channel, and the quantity that its unit measures.
APPLIED = {"current": ("current", "current"), "torque": ("force", "torque"), "applied force": ("force", "force")}
_SMALL = 0.1  # part of the acceleration that the noise of the motion may be: an inertia is too small by its square, which its error has
_TOLD = 0.15  # ... and above which it is said
_LOOKED = 6  # repetitions that tell the noise of an acceleration
_REST = 4.0  # standard errors of the velocity within which a body is at rest
_APART = 1.5  # times the usual distance between windows beyond which something is left out between them
_STROKE, _LATE = 12, 5  # parts of the time between reversals, and samples at most, that are left out beside one
_LONGEST = 64  # samples from the middle to the end of a window, at most

_FEWEST, _ENOUGH = 16, 60  # values of a log, and those that bear the numbers of its sensor too
_PUSH = 1e9  # of what is applied: no contact is held against as much


@sealed
@dataclass(frozen=True, eq=False)
class MachineLog(Compared):
    r"""The motion of a machine with what was applied to it, averaged over windows.

    A window is a triangle of W samples on either side: the mean acceleration over it is exactly
    :math:`(x_{j+W} - 2x_j + x_{j-W})/(Wh)^2`, so that averages over the same windows of what was applied obey the equation of motion
    without the bias of a smoothed derivative. W is the smallest for which the noise of the motion, once that is smoothed, is a tenth of
    the acceleration.

    Parameters
    ----------
    kind : {"torque", "current", "applied force"}
    t, v : array (n,)
        Instants of the samples, evenly spaced [s], and velocity there.
    x : array (n,)
    at : array (m,)
        Samples in the middle of the windows that are compared.
    acceleration : array (m,)
        Means over the windows.
    y : array (m,)
        Means of what was applied.
    weight : array (m,)
    still : array (m,)
        Windows in which the body rests.
    half : int
        W.
    label : str
    """

    open: ClassVar[bool] = False  # no window reaches over a gap
    any_start: ClassVar[bool] = True  # a log begins when it begins

    kind: str
    t: Any
    x: Any
    v: Any
    at: Any
    acceleration: Any
    y: Any
    weight: Any
    still: Any
    half: int
    label: str
    cut: str | None = None
    given_sigma: bool = False
    measured: Smooth | None = None  # the motion behind noisy sensors

    @property
    def has_noise(self) -> bool:
        """Whether other noise of the sensors would have shown another motion."""
        return self.measured is not None

    def redrawn(self, k: int) -> MachineLog:
        """The same windows over the motion that other noise of its sensors, the k-th, would have shown."""
        if self.measured is None:
            return self
        again = self.measured.again(k)
        x, v = again.at(self.t), np.where(self.v == 0, 0.0, again.at(self.t, 1))
        return dataclasses.replace(self, x=x, v=v, acceleration=_accelerations(x, self.at, self.half, self.step))

    @cached_property
    def time(self) -> Any:
        """Times of the values, counted from the middle of the record [s]."""
        return self.t[self.at] - 0.5 * (self.t[0] + self.t[-1])

    def moved(self, met: Any = None) -> tuple[Any, Any, Any]:
        """Times, positions and velocities of the values."""
        return self.t[self.at], self.x[self.at], self.v[self.at]

    @cached_property
    def step(self) -> float:
        """Time between samples [s]."""
        return float(self.t[1] - self.t[0])

    def delayed(self, h: Array, delay: float) -> Any:
        """Values a little later: between windows, and beyond the last one before a reversal or a gap, they change evenly."""
        if len(h) < 3:
            return h
        left, right, apart = self._around(delay)
        return strokes.on_a_line(h, left, right, (self.time - delay - self.time[left]) / apart)

    def delay_slope(self, h: Array, delay: float) -> Any:
        """The change of delayed values with time, exactly that of these lines: steps of a search lead nowhere by another one [1/s]."""
        if len(h) < 3:
            return np.zeros(len(h))
        left, right, apart = self._around(delay)
        return (h[right] - h[left]) / apart

    def _around(self, delay: float) -> tuple[Any, Any, Any]:
        """Windows about each delayed instant, between the same reversals, and the time between the two, 1 for one alone."""
        t, (first, last) = self.time, self._joined
        left = np.clip(np.searchsorted(t, t - delay) - 1, first, np.maximum(last - 1, first))
        right = np.minimum(left + 1, last)
        return left, right, np.where(right > left, t[right] - t[left], 1.0)

    @cached_property
    def _joined(self) -> tuple[Any, Any]:
        """The first and the last window between the same reversals and gaps, for each: arrays (m,) of int."""
        count = len(self.at)
        apart = np.concatenate([[True], np.diff(self.at) > _APART * np.median(np.diff(self.at)), [True]])
        first = np.maximum.accumulate(np.where(apart[:-1], np.arange(count), 0))
        return first, np.minimum.accumulate(np.where(apart[1:], np.arange(count), count - 1)[::-1])[::-1]

    def every(self, step: int) -> MachineLog:
        """Every so many-th window."""
        names = ("at", "acceleration", "y", "weight", "still")
        return dataclasses.replace(self, **{name: getattr(self, name)[::step] for name in names})

    def rough(self, step: int) -> MachineLog:
        """The same for a search: thinned out."""
        return self.every(step) if step > 1 else self

    def given(self, model: Model, cases: int, reading: dict[str, Any], sides: tuple[float, ...]) -> list[Any]:
        """The input required for this motion, at rest its least (side -1) or greatest (1) possible value: an array (m, cases) for each."""
        bare, per = _input(model)
        m, factor = machine_of(bare).mechanics, per[self.kind]
        t, x, v = self._within
        free = m.accelerations(t, (x,), (v,), tuple(0.0 for _ in m.contacts))[0]
        inertial = np.broadcast_to(m.masses[0] * (self.acceleration[:, None] - self._mean(free, cases)), (self.count, cases))
        if not m.contacts:
            return [inertial / factor] * len(sides)
        push = np.sign(factor) * _PUSH * (np.max(abs(self.y)) * abs(factor) + np.max(abs(inertial)))
        borne = [np.broadcast_to(side * push, inertial.shape) for side in sides]
        return [(inertial + force) / factor for force in self._friction(m, factor, borne, cases, reading.get("start"))]

    @cached_property
    def _inside(self) -> Any:
        """Samples in each window: array (m, 2 W - 1)."""
        return self.at[:, None] + np.arange(1 - self.half, self.half)

    @cached_property
    def _within(self) -> tuple[Any, Any, Any]:
        """Times, positions and velocities there: arrays (m, 2 W - 1, 1)."""
        t, x, v = (values[self._inside][..., None] for values in (self.t, self.x, self.v))
        return t, x, v

    def _mean(self, values: Any, cases: int) -> Any:
        """Means over the windows of values at all their samples: array (m, cases)."""
        whole = np.broadcast_to(values, (*self._inside.shape, cases))
        return np.einsum("mwc,w->mc", whole, _triangle(self.half))

    def _load(self, m: Any, factor: Any, t: Any, x: Any, v: Any) -> Any:
        """The load of the contact; one that follows from forces takes what was recorded for the motor's, `factor` for each unit of it."""
        if not any(m.of_motion):
            return m.loads(t, (x,))[0]
        return m.load_under(0, t, (x,), (v,), m.bodies[0], factor * np.interp(t, self.t[self.at], self.y))

    def _friction(self, m: Any, factor: Any, borne: list[Any], cases: int, start: Any) -> list[Any]:
        """Friction forces over the windows where the contact bears so much at rest: an array (m, cases) for each."""
        law: LawAdapter = m.laws[0]
        if law.dynamic:
            return [self._remembered(m, law, factor, each, cases, start) for each in borne]
        t, x, v = self._within
        load, slip = self._load(m, factor, t, x, v), m.slips(t, (v,))[0]
        backward, forward = (self._mean(limit, cases) for limit in law.breakaway(load))
        sliding = self._mean(law.sliding(np.where(slip != 0, slip, 1.0), load), cases)
        return [np.where(self.still[:, None], np.clip(each, backward, forward), sliding) for each in borne]

    def _remembered(self, m: Any, law: LawAdapter, factor: Any, borne: Any, cases: int, start: Any) -> Any:
        """The same of a law with inner states, which follow all samples."""
        t, x, v = (values[:, None] for values in (self.t, self.x, self.v))
        load = self._load(m, factor, t, x, v) + np.zeros((len(self.t), 1))
        every = np.stack([np.interp(self.t, self.t[self.at], column) for column in borne.T], axis=1)
        slip = (m.slips(t, (v,))[0] + np.zeros((len(self.t), 1)))[:, 0]
        mean = np.concatenate([slip[:1], 0.5 * (slip[1:] + slip[:-1])])
        forces = law_force(law, Stepped(self.t, mean, slip), load, every, cases, start)
        return self._mean(forces[self._inside], cases)


def _triangle(half: int) -> Any:
    weights = half - abs(np.arange(1 - half, half))
    return weights / half**2


def _averaged(values: Array, at: Any, half: int) -> Any:
    """Means over windows around some samples; of columns too."""
    return sum(w * values[at + k] for k, w in zip(range(1 - half, half), _triangle(half), strict=True))


def takes_records(model: Model, records: list[Any]) -> bool:
    """Whether all records have what is applied to a machine, and its motion, and no drive of it shakes an inner mass."""
    if machine_of(model).drive is not None or machine_of(model).input is None:
        return False
    return all(hasattr(rec, "channels") and _role(model, rec) and ("position" in rec or "velocity" in rec) for rec in records)


def _input(model: Model) -> tuple[Any, dict[str, Any]]:
    """The quantity that a record of a machine's input stands for; None for a machine whose inner mass is shaken."""
    quantity = machine_of(model).input
    return (model, {}) if quantity is None else quantity


def _role(model: Model, rec: Record) -> str | None:
    """The kind of input in a record of a machine; None if there is none."""
    for kind in _input(model)[1]:
        role, quantity = APPLIED[kind]
        if role in rec and quantity_of(rec[role].unit) in (quantity, None):
            return kind
    return None


def bench_of(model: Model, rec: Record, label: str) -> MachineLog:
    """The windows of a record for a machine of one body; `InputError` for one of several, or where something is missing."""
    kind = _role(model, rec)
    if kind is None:
        raise InputError("identify", [f'{label} has no {_wanted(model)}; type roles={{"...": "force"}} or units={{...}} when reading'])
    _check_machine(model, label)
    clock = clock_of(rec, APPLIED[kind][0], label)
    smooth, notes = motion_behind(rec)
    tried = _halves(clock, smooth)
    best = min(tried, key=lambda pair: pair[1])
    rate = _velocities(clock, smooth)
    half, noisy = _with_values(tried, best, lambda half: len(_windows(clock, rate, half, smooth)[0]))
    return _made(kind, clock, smooth, rate, half, noisy, label, notes)


def _with_values(tried: list[tuple[int, float]], best: tuple[int, float], count: Callable[[int], int]) -> tuple[int, float]:
    """The window of least noise, or where it leaves too few values the longest that leaves enough; else that which leaves most.

    The noise of shorter windows is in the intervals, as any noise of the motion.
    """
    if count(best[0]) >= _FEWEST:
        return best
    shorter = [(count(half), half, noisy) for half, noisy in tried if half < best[0]]
    enough = [(half, noisy) for values, half, noisy in shorter if values >= _ENOUGH]
    if enough:
        return max(enough)
    most = max(shorter, default=(0, *best))
    return most[1:] if most[0] >= _FEWEST else best


def _wanted(model: Model) -> str:
    return " or ".join(_input(model)[1]) or "input, because a drive shakes an inner mass"


def _check_machine(model: Model, label: str) -> None:
    bare, _ = _input(model)
    m = machine_of(bare).mechanics
    if m.coordinates == 1 and len(m.contacts) <= 1 and not m.stops:
        return
    parts = f"{m.coordinates} bodies and {len(m.contacts)} contacts"
    raise InputError(
        "identify",
        [f"{label}: an applied force is fitted for one body with one contact; the machine has {parts}; "
         'remove what makes it several (gear_stiffness, backlash), fit its steady motion with using="velocity", '
         "or, if it moves slowly, its law behind the play: ss.machines.ForceRig(friction=..., backlash=...)"],
    )  # fmt: skip


def _halves(clock: Clock, smooth: Smooth | None) -> list[tuple[int, float]]:
    """Samples from the middle to the end of windows up to one without noise, and the noise of their mean accelerations over its size."""
    tried, h = [(1, np.inf)], clock.step
    x = clock.x if smooth is None else smooth.at(clock.t)
    off = [] if smooth is None else [smooth.again(k).at(clock.t) - x for k in range(_LOOKED)]
    for half in sorted({*range(1, 9), *np.unique((8 * 2 ** (np.arange(1, 13) / 4)).astype(int)).tolist()}):
        if half > min(_LONGEST, len(x) // 20):
            break
        at = np.arange(half, len(x) - half)
        a = _accelerations(x, at, half, h)
        sigma = float(np.sqrt(np.mean([np.mean(_accelerations(e, at, half, h) ** 2) for e in off]))) if off else 0.0
        size = float(np.sqrt(max(np.mean(a**2) - sigma**2, 1e-300)))
        tried.append((half, sigma / size))
        if tried[-1][1] <= _SMALL:
            break
    return tried


def _accelerations(x: Array, at: Any, half: int, h: float) -> Any:
    """Mean accelerations over windows."""
    return (x[at + half] - 2 * x[at] + x[at - half]) / (half * h) ** 2


def _velocities(clock: Clock, smooth: Smooth | None) -> Any:
    """Velocities; zero where the body rests, or seems to within the noise."""
    rate = np.gradient(clock.x, clock.step) if smooth is None else smooth.at(clock.t, 1)
    sigma = 0.0 if smooth is None else noise_of_velocity(smooth, clock.t)
    return np.where(abs(rate) <= max(_REST * sigma, 1e-9 * float(abs(rate).max())), 0.0, rate)


def _windows(clock: Clock, rate: Array, half: int, smooth: Smooth | None) -> tuple[Any, int]:
    """Samples in the middle of windows that are compared, and how many are left out about reversals; none at smoothed ends."""
    count, apart = len(clock.t), 2 * half + 1 if half > 1 else 1
    at = np.arange(half, count - half, apart)
    turns = np.concatenate([[0], np.cumsum(np.diff(np.sign(rate)) != 0)])
    margin = half + int(np.clip(count / (_STROKE * (turns[-1] + 1)), 0, _LATE))  # a delay brings the friction before a reversal after it
    whole = clock.joined(at, half) & (True if smooth is None else smooth.inside(clock.t[at]))
    even = turns[np.minimum(at + margin, count - 1)] == turns[np.maximum(at - margin, 0)]
    return at[whole & even], int((whole & ~even).sum())


def _made(kind: str, clock: Clock, smooth: Smooth | None, rate: Array, half: int, noisy: float, label: str, notes: list[str]) -> MachineLog:
    t, h = clock.t, clock.step
    x = clock.x if smooth is None else smooth.at(t)
    at, turned = _windows(clock, rate, half, smooth)
    if len(at) < _FEWEST:
        raise InputError("identify", [_few(label, len(at), len(t), kind, half, smooth)])
    weight = 1.0 / _averaged(1.0 / np.where(clock.weight > 0, clock.weight, np.inf), at, half)
    still = rate[at] == 0
    a = _accelerations(x, at, half, h)
    cut = "; ".join([*clock.notes, *notes, *_said(half, noisy, turned)]) or None
    return MachineLog(kind, t, x, rate, at, a, _averaged(clock.y, at, half), weight, still, half, label, cut, measured=smooth)


def _few(label: str, count: int, samples: int, kind: str, half: int, smooth: Smooth | None) -> str:
    """Why so few values are left of a record, and what helps."""
    sentence = f"{label} has {count} values between reversals with motion and {kind}, of {samples} samples; allowed are {_FEWEST} or more"
    if half == 1:
        sentence += "; a longer log, or longer strokes beside the time between samples, give more"
    if half > 1:
        sentence += f"; the noise of the motion asks for averages over {2 * half - 1} samples: "
        sentence += "a longer log, faster or longer strokes, or a finer encoder"
        sentence += " gives more" if smooth is None else f" than one of {max(smooth.noise.values()):.2g} gives more"
    return sentence


def _said(half: int, noisy: float, turned: int) -> list[str]:
    """Sentences on windows."""
    sentences = [f"averages over windows of {2 * half - 1} samples are compared"] if half > 1 else []
    if noisy > _TOLD:
        sentences.append(f"the noise of the motion is {noisy:.2g} of the acceleration, from which an inertia is determined")
    return sentences + ([f"{turned} values about reversals are left out"] if turned else [])
