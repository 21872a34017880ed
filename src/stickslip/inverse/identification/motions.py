"""The motion that a record prescribes to a contact, with the force that was measured over it."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array, Law
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.inverse.identification import strokes
from stickslip.inverse.identification.censored import sides_of
from stickslip.inverse.identification.clocks import together
from stickslip.inverse.identification.law_forces import driven_force, slide
from stickslip.inverse.identification.measured_motion import motion_behind, noise_of_velocity
from stickslip.inverse.identification.smoothing import Smooth, noise_of_differences
from stickslip.inverse.identification.targets import Compared
from stickslip.inverse.identification.weighting import weights_at
from stickslip.records.overview import noise

if TYPE_CHECKING:
    from stickslip.records.record import Record


_MOST = 50_000  # samples of a force; means of neighbours take the place of more
_PUSH = 1e9  # of the load: no contact is held against as much
_GAP, _AROUND = 3.0, 11  # how many times the median of so many steps around it a step is longer in a gap
_REST = 4.0  # standard errors of the velocity within which its sign is open
_LOOKED = 6  # repetitions that tell the noise of a position
_BLURRED = 3.0  # standard errors of the position within which a flank of a play is reached
_SMEARED = 0.03  # of the range of a motion, over which a play closes in a search
_LONGEST, _OF_A_STROKE = 0.02, 0.125  # delay that is looked for, where steps are short: that [s], and no more than so much of a stroke
_SPARED = 3.0  # standard deviations: noise is beyond them once in 700 times
_ENDS = 0.5  # by how many times itself a delay may be longer for what it brings from an end
_COARSE = 0.1  # of a velocity, by which it changes over a step that is halved
_REPEATS = 0.1  # by which part of its own spread the motion may differ from one period to the next


@sealed
@dataclass(frozen=True, eq=False)
class PrescribedMotion(Compared):
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
        Measured friction force [N], positive against positive v; NaN where it is not known, while the motion is.
    before : int
        How many of the samples only lead in; they are not compared.
    flipped : bool
        Whether the sign of the measured force was turned, so that friction takes energy.
    label : str
    """

    kind: ClassVar[str] = "force"

    t: Any
    v: Any
    load: Any
    force: Any
    before: int
    flipped: bool
    label: str
    cut: str | None = None  # which samples were left out, and why
    weights: Any = 1.0  # of all samples
    given_sigma: bool = False  # whether the user gave the noise
    any_start: bool = False  # whether inner states may be bent in any way at the first sample
    at: Any = None  # velocity at each sample, where that is known better than by the means over the intervals on either side
    still: Any = False  # where the noise of the motion leaves its direction open
    measured: Smooth | None = None  # the motion behind noisy sensors
    load_noise: float = 0.0
    in_play: bool = False  # whether the contact is moved through a play
    blur: float = 0.0  # how far positions may be off where a flank of it is reached
    smear: float = 0.0  # way over which it closes, in a search
    timeless: bool = False  # a table of constant speeds: v is that of each row
    rigid: bool = False  # whether the force jumps where the motion turns, because the law has no inner states
    holes: Any = None  # before which samples the record has a gap, where steps between them were halved; else their lengths say that
    lag: float = 0.0  # delay of the force about which such jumps, and the values at an end that it brings from elsewhere, are left open [s]

    def __post_init__(self) -> None:
        object.__setattr__(self, "weights", np.broadcast_to(self.weights, np.shape(self.t)))
        object.__setattr__(self, "still", np.broadcast_to(self.still, np.shape(self.t)))
        object.__setattr__(self, "at", _between(self.t, self.v) if self.at is None else self.at)

    @property
    def has_noise(self) -> bool:
        """Whether other noise of the sensors would have shown another motion, or another load."""
        return self.measured is not None or self.load_noise > 0

    def redrawn(self, k: int) -> PrescribedMotion:
        """The motion and the load as other noise of their sensors, the k-th, would have shown them."""
        load = self.load + self.load_noise * np.random.default_rng([11, k]).normal(size=len(self.t))
        if self.measured is None:
            return dataclasses.replace(self, load=load)
        return dataclasses.replace(self, load=load, **_driven(self.measured.again(k), self.t, self.before))

    @cached_property
    def y(self) -> Any:
        """The values that are compared."""
        return self.force[self.compared]

    @cached_property
    def compared(self) -> Any:
        """Which samples are compared: array (n,) of bool."""
        valid = np.isfinite(self.force) & (np.arange(len(self.force)) >= self.before)
        return valid & (self.weights > 0)

    @cached_property
    def clipped(self) -> Any:
        """Which values sit on an end of the range of the load cell."""
        sides = sides_of(self.force)
        return sides if np.ndim(sides) == 0 else sides[self.compared]

    @cached_property
    def weight(self) -> Any:
        """Weight of each value."""
        return self.weights[self.compared]

    @cached_property
    def time(self) -> Any:
        """Times of the values, counted from the middle of the record [s]."""
        return self.t[self.compared] - 0.5 * (self.t[self.before] + self.t[-1])

    def moved(self, met: Any = None) -> tuple[Any, Any, Any]:
        """Times, positions (from the first sample) and velocities of the values."""
        x = np.cumsum(self.v * np.diff(self.t, prepend=self.t[0]))
        return self.t[self.compared], x[self.compared], self.at[self.compared]

    @cached_property
    def step(self) -> float:
        """Time between samples [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def longest_delay(self) -> float:
        """The longest delay that is looked for where nothing is typed [s]."""
        turns = np.flatnonzero(np.diff(np.sign(self.at[self.at != 0])))
        stroke = float(self.t[-1] - self.t[0]) / (len(turns) + 1)
        return max(super().longest_delay, min(_LONGEST, _OF_A_STROKE * stroke))

    @cached_property
    def turning(self) -> Any:
        """Samples between which the motion turns, and those between them of which the direction is open: array (n,) of bool."""
        return strokes.turning(np.where(self.still, 0.0, np.sign(self.at)))

    @cached_property
    def _strokes(self) -> strokes.Strokes:
        """The strokes of the values, with what is open between them where the force is late by `lag`."""
        sides = np.where(self.still, 0.0, np.sign(self.at))[self.compared]
        return strokes.Strokes(self.time, sides, self.lag, self.step, abs(self.at[self.compared]))

    @property
    def left_open(self) -> int:
        """How many values beside jumps of the force are left open."""
        return int(np.sum(self._strokes.open >= 0)) if self.rigid else 0

    def late(self, lag: float) -> PrescribedMotion:
        """The same where the force is late by about so much."""
        return dataclasses.replace(self, lag=lag)

    @cached_property
    def known(self) -> Any:
        """1, or 0 for values that a delay brings from before the motion was recorded, or from after that: array (values,)."""
        t, least = self.time, _ENDS * abs(self.lag)
        return np.where((t - t[0] < self.lag + least) | (t - t[-1] > self.lag - least), 0.0, 1.0) if self.lag else 1.0

    @cached_property
    def spared(self) -> Any:
        """Standard deviations by which values may be off before they count, where a late force jumps and is open: array (values,).

        The force is at its largest there, so that noise alone is beyond it every other time: static friction would be too large by it.
        """
        return np.where(self._strokes.passing, _SPARED, 0.0) if self.rigid and (self.lag or self.still.any()) else 0.0

    def delayed(self, h: Array, delay: float) -> Any:
        """Values a little later: of a force that jumps where the motion turns those within the strokes, and what is open between them."""
        return self._strokes.delayed(h, delay) if self.rigid else strokes.later(self.time, h, delay, smooth=not self.in_play)

    def delay_slope(self, h: Array, delay: float) -> Any:
        """The change of delayed values with time, of a force that jumps within strokes [1/s]."""
        if self.rigid:
            return self._strokes.slope(h, delay)
        return super().delay_slope(h, delay) if self.in_play else strokes.later_slope(self.time, h, delay)

    @property
    def acceleration(self) -> Any:
        """Acceleration at the values, from the mean velocities before and after each [m/s^2]."""
        middle = self.t[1:] - 0.5 * np.diff(self.t)
        return np.gradient(np.interp(self.t, middle, self.v[1:]), self.t)[self.compared]

    @cached_property
    def gaps(self) -> Any:
        """Before which samples the record has a gap, longer than three of the steps around it: array (n,) of bool."""
        from scipy.ndimage import median_filter

        if self.holes is not None:
            return self.holes
        steps = np.diff(self.t)
        return np.concatenate([[False], steps > _GAP * median_filter(steps, _AROUND, mode="nearest")])

    @property
    def open(self) -> bool:
        """Whether the motion leaves anything open, so that forces may be less or greater."""
        return bool(self.gaps.any())

    def given(self, law: Law, cases: int, reading: dict[str, Any], sides: tuple[float, ...]) -> list[Any]:
        """Friction forces at the values, the least (side -1) or the greatest (1) that may be: an array (values, cases) for each side [N].

        A contact that is held is pushed to the side, and after each gap it comes from where that force is least or greatest.
        """
        each = [(side * _PUSH * float(np.max(self.load)), *self._bridges(side)) for side in sides]
        return [driven_force(law, bridged, cases, reading, push)[own] for push, bridged, own in each]

    def _bridges(self, side: float) -> tuple[PrescribedMotion, Any]:
        """The same as `bridged`, made once."""
        if side not in self._bridged:
            self._bridged[side] = self.bridged(side)
        return self._bridged[side]

    @cached_property
    def _bridged(self) -> dict[float, tuple[PrescribedMotion, Any]]:
        return {}

    def bridged(self, side: float) -> tuple[PrescribedMotion, Any]:
        """The motion with a slow slide to a side (-1 or 1) in each gap, longer than any stroke, and which of its samples are compared.

        That brings inner states to where they give the least, or the greatest, force, whatever the contact did in the gap.
        """
        at, (durations, speed) = np.flatnonzero(self.gaps), slide(self.t, self.v)
        if side == 0.0 or not len(at) or not len(durations):
            return self, self.compared
        places = np.repeat(at, len(durations))
        v, steps = np.array(self.v), np.diff(self.t, prepend=self.t[0])
        v[at], steps[at] = self.v[np.minimum(at + 1, len(v) - 1)], 0.0  # the mean velocity over a gap is not that after it
        made = {
            "t": self.t[0] + np.cumsum(np.insert(steps, places, np.tile(durations, len(at)))),
            "v": np.insert(v, places, side * speed),
            "at": np.insert(self.at, places, side * speed),
            "still": np.insert(self.still, places, False),
            "load": np.insert(self.load, places, self.load[places]),
            "force": np.insert(self.force, places, np.nan),
            "weights": np.insert(self.weights, places, 0.0),
        }
        return dataclasses.replace(self, **made), np.insert(self.compared, places, False)

    def finer(self) -> PrescribedMotion:
        """The same with two steps in place of each over which the velocity changes much beside itself, as it does where the motion turns.

        Between two samples the position is the cubic that has their places and velocities.
        """
        ahead, behind = self.at, np.concatenate([self.at[:1], self.at[:-1]])
        steps = np.diff(self.t, prepend=self.t[0])
        coarse = (abs(ahead - behind) > _COARSE * np.maximum(abs(ahead), abs(behind))) & ~self.gaps & (steps > 0)
        if self.timeless or self.rigid or self.in_play or not coarse.any():
            return self
        k = np.flatnonzero(coarse)
        half, (v0, v1, mean) = 0.5 * steps[k], (each[k] for each in (behind, ahead, self.v))
        turned = 0.25 * (v0 - v1)  # by which the mean velocity of the first half is above that of the whole, and of the second below
        v = np.array(self.v)
        v[k] = mean - turned
        made: dict[str, Any] = {
            "t": np.insert(self.t, k, self.t[k] - half),
            "v": np.insert(v, k, mean + turned),
            "at": np.insert(self.at, k, 1.5 * mean - 0.25 * (v0 + v1)),
            "still": np.insert(self.still, k, False),
            "load": np.insert(self.load, k, 0.5 * (self.load[k] + self.load[k - 1])),
            "force": np.insert(self.force, k, np.nan),
            "weights": np.insert(self.weights, k, 0.0),
            "before": self.before + int(np.sum(k <= self.before)),
            "holes": np.insert(self.gaps, k, False),
        }
        return dataclasses.replace(self, **made)

    def every(self, step: int) -> PrescribedMotion:
        """The same motion, thinned out."""
        last = np.arange(0, len(self.t), step)
        if self.timeless:
            return dataclasses.replace(
                self, **{name: getattr(self, name)[last] for name in ("t", "v", "at", "load", "force", "weights", "still")}
            )
        x = np.concatenate([[0.0], np.cumsum(self.v[1:] * np.diff(self.t))])[last]
        t = self.t[last]
        v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
        before = int(np.searchsorted(last, self.before))
        kept = {name: getattr(self, name)[last] for name in ("load", "force", "weights", "still")}
        kept["at"] = None if self.measured is None else self.at[last]
        return dataclasses.replace(self, t=t, v=v, before=before, **kept)

    def rough(self, step: int) -> PrescribedMotion:
        """The same for a search: thinned out, and with a slope where a play closes."""
        thinned = self.every(step) if step > 1 else self
        if not self.in_play:
            return thinned
        x = np.cumsum(thinned.v * np.diff(thinned.t, prepend=thinned.t[0]))
        return dataclasses.replace(thinned, smear=_SMEARED * float(np.ptp(x)))

    def through_play(self) -> PrescribedMotion:
        """The same of an actuator that moves the contact through a play."""
        blur = 0.0
        if self.measured is not None:
            own, again = self.measured.at(self.t), (self.measured.again(k).at(self.t) for k in range(_LOOKED))
            blur = _BLURRED * float(np.sqrt(np.mean([np.mean((x - own) ** 2) for x in again])))
        return dataclasses.replace(self, in_play=True, blur=blur)


def motion_of(rec: Record, load: float | None, label: str, any_start: bool = False, leads: bool = True) -> PrescribedMotion:
    """The motion of a record with a position (or velocity) and a force.

    If it is periodic from its first sample on and `leads`, its first period leads in, so that the law is in its cycle; otherwise the law
    begins unbent, or with `any_start` in a state that is fitted.
    """
    rec, notes = _fewer(rec)
    thinned = bool(notes)
    c, moved = rec["force"], rec["position" if "position" in rec else "velocity"]
    t, x, F = c.time, moved.si, c.si
    if len(moved) != len(c) or not np.array_equal(moved.time, t, equal_nan=True):
        t, x, F, _ = together(rec, moved, c, notes)
    x = x if "position" in rec else _integrated(t, x)
    if load is None and "load" not in rec:
        raise InputError("identify", ['the record has no normal force; type load=... [N], or roles={"...": "load"} when reading'])
    if load is not None:
        N = np.full(len(t), float(load))
    else:
        N = rec["load"].si if len(rec["load"]) == len(t) else np.interp(t, rec["load"].time, rec["load"].si)
    known, pressed = np.isfinite(t) & np.isfinite(x) & np.isfinite(N), ~(N <= 0)
    good = known & pressed & np.concatenate([[True], np.diff(t) > 0])
    whole = known & np.isfinite(F)
    why = {"miss a value": ~whole, "have no positive load": whole & ~pressed, "come at times that do not rise": whole & pressed & ~good}
    reasons = " and ".join(f"{int(which.sum())} {what}" for what, which in why.items() if which.any())
    remarks = [note for note in notes if "left out" not in note] + (
        [f"of {len(t)} samples {reasons}; they are left out"] if reasons else []
    )
    t, x, F, N = t[good], x[good], F[good], N[good]
    smooth, said = motion_behind(rec)
    remarks += said
    x = x if smooth is None else smooth.at(t)
    own = weights_at(rec, t) * (1.0 if smooth is None else smooth.inside(t))
    if (count := int(np.isfinite(F).sum())) < 16:
        raise InputError("identify", [f"{label} has {count} samples with position, force and a positive load; allowed are 16 or more"])
    flipped = float(np.nansum(0.5 * (F[1:] + F[:-1]) * np.diff(x))) < 0
    F = -F if flipped else F
    lead, period = _first_period(rec, t, x, F) if leads else (0, 0.0)
    if lead:
        t = np.concatenate([t[:lead] - period, t])
        x, F, N, own = (np.concatenate([a[:lead], a]) for a in (x, F, N, own))
    v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
    if thinned:  # a mean over a reversal is that of neither side
        side = np.sign(v)
        same = np.concatenate([[True], side[1:] == side[:-1]]) & np.concatenate([side[1:] == side[:-1], [True]])
        own = same * own
    level = noise(rec["load"].si) if load is None else 0.0
    made = PrescribedMotion(t, v, N, F, lead, flipped, label, "; ".join(remarks) or None, own, any_start=any_start and not lead,
                  load_noise=level if np.isfinite(level) else 0.0)  # fmt: skip
    if smooth is None:
        return dataclasses.replace(made, still=abs(made.at) <= _REST * noise_of_differences(x) / made.step)
    driven = _driven(smooth, t, lead)
    still = abs(driven["at"]) <= _REST * noise_of_velocity(smooth, t)
    return dataclasses.replace(made, **driven, still=still, measured=smooth)


def _between(t: Any, v: Any) -> Any:
    """Velocities at the samples from the means over the intervals on either side, of which the shorter one counts more."""
    steps = np.diff(t)
    if len(steps) < 2:
        return np.concatenate([v[1:2], v[1:]]) if len(v) > 1 else v
    before, after = steps[:-1], steps[1:]
    whole = before + after
    inner = (v[1:-1] * after + v[2:] * before) / np.where(whole > 0, whole, 1.0)
    return np.concatenate([v[1:2], inner, v[-1:]])


def _driven(smooth: Smooth, t: Any, before: int) -> dict[str, Any]:
    """Mean velocities between samples of a smoothed motion, and the velocities at them; the first period stands there twice."""
    later = t[before:]
    x, at = smooth.at(later), smooth.at(later, 1)
    x, at = (np.concatenate([a[:before], a]) for a in (x, at))
    return {"v": np.concatenate([[0.0], np.diff(x) / np.diff(t)]), "at": at}


def _fewer(rec: Record) -> tuple[Any, list[str]]:
    """A record of very many samples with means of neighbours in their place, and what to say of that."""
    count = len(rec["force"])
    if count <= _MOST:
        return rec, []
    thin = rec.averaged(rec["force"].rate * _MOST / count)
    return thin, [*(note for note in thin.notes if note not in rec.notes), "means about reversals are not compared"]


def _integrated(t: Array, v: Array) -> Any:
    """The position; NaN where the velocity, or the time, is missing."""
    position, known = np.full(len(v), np.nan), np.isfinite(t) & np.isfinite(v)
    t, v = t[known], v[known]
    position[known] = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])[: len(v)]
    return position


def _first_period(rec: Any, t: Array, x: Array, F: Any) -> tuple[int, float]:
    """Samples of the first period and how long it is [s], if the second repeats its motion and begins with the force that it began with.

    A period is no whole number of samples: it ends half a step or more before the sample that begins the next.
    """
    try:
        period = 1 / rec.drive_frequency().value
    except InputError:
        return 0, 0.0
    if (t[-1] - t[0]) < 2 * period:
        return 0, 0.0
    lead = int(np.searchsorted(t, t[0] + period - 0.5 * float(np.median(np.diff(t)))))
    if np.std(np.interp(t[:lead] + period, t, x) - x[:lead]) > _REPEATS * np.std(x[:lead]):
        return 0, 0.0
    start, end = F[:8], F[lead : lead + 8]
    both = start[np.isfinite(start)], end[np.isfinite(end)]
    alike = all(map(len, both)) and abs(both[0].mean() - both[1].mean()) < 0.1 * (np.nanmax(F) - np.nanmin(F))
    return (lead, period) if alike else (0, 0.0)
