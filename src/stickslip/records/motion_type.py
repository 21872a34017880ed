"""The motion type that a record shows, with what its noise leaves open."""

from __future__ import annotations

import html
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.frozen_arrays import sealed
from stickslip.records.measures import cycle, frequency_of, period
from stickslip.records.rests import Rest, rest_at
from stickslip.results.segments import intervals_of, type_of

if TYPE_CHECKING:
    from stickslip.records.record import Record


#: A place counts as slow below this many standard errors of the mean cycle, and below this part of its range.
ERRORS, RANGE = 4.0, 0.01
#: A slip that is less sure than this many standard errors may be none; one of this part of the range may hide in a rest.
SURE, HIDDEN = 6.0, 0.05
#: What a curve of third degree may be off, as part of the range.
FLOOR = 5e-4
_MOST_OPEN = 4  # places that are told apart as open; more are one "other"
_WINDOW = 0.07, 0.12  # drive periods on either side of a place: in a clean record, and in a noisy one


@sealed
@dataclass(frozen=True)
class MeasuredMotion:
    """The motion in a record, in the terms of `stickslip.motion`, with the threshold used.

    Parameters
    ----------
    type : str
        Motion type. Where the noise leaves it open, the types between which it is open: "I or IV".
    pattern : str
        Signs of the motion period; of the likeliest where it is open.
    period : int or None
    direction : int
    stick_fraction, forward_fraction, backward_fraction : float
    intervals : tuple of (start, length, sign)
        In drive periods.
    threshold : float
        Slower than this counts as rest [m/s].
    noise : float
        Standard deviation of one sample [m/s].
    candidates : tuple of str
        The types that the record allows; one if it is decided.
    rests : tuple of Rest
        Each place where the velocity is near zero: how long it rests there, with its 95 % interval.
    dwell : float
        Shorter rests do not count [drive periods].
    """

    type: str
    pattern: str
    period: int | None
    direction: int
    stick_fraction: float
    forward_fraction: float
    backward_fraction: float
    intervals: tuple[tuple[float, float, int], ...]
    threshold: float
    noise: float = float("nan")
    candidates: tuple[str, ...] = ()
    rests: tuple[Rest, ...] = ()
    dwell: float = 0.03

    def __str__(self) -> str:
        return self.verdict

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(self.verdict)}</p>"

    @property
    def decided(self) -> bool:
        """Whether the record allows one type only."""
        return len(self.candidates) < 2

    @property
    def verdict(self) -> str:
        """The type as a sentence, with the threshold, and with what is open and why."""
        rule = f"slower than {self.threshold:.3g} m/s counts as rest, shorter than {self.dwell:g} drive periods does not"
        if self.decided:
            return f"{self.type} (pattern {self.pattern}; {rule})"
        open_ones = [r for r in self.rests if r.lasts(self.dwell) is None]
        lengths = ", ".join(f"{r.least:.2g} to {r.most:.2g}" for r in open_ones)
        why = [f"where the velocity passes zero the body may rest for {lengths} drive periods"] if open_ones else []
        if not why or {"II", "rest"} & set(self.candidates):
            why.append("a slow slip may hide in a rest")
        return f"undecided between {' and '.join(self.candidates)}: the noise is {self.noise:.2g} m/s; {' and '.join(why)} ({rule})"


def motion(rec: Record, frequency: float | None = None, threshold: float | None = None, dwell: float = 0.03) -> MeasuredMotion:
    """Motion type and intervals of the mean cycle, and what the noise leaves open.

    Where the mean cycle passes zero, a curve with a plateau is fitted. The body rests there if the plateau lasts at least `dwell` with
    95 % confidence, and does not if it is shorter with that confidence; else the type is open.

    Parameters
    ----------
    frequency : float, optional
        Of the drive [Hz]; found in the record otherwise.
    threshold : float, optional
        Slower than this counts as rest [m/s]; otherwise four standard errors of the mean cycle, at least 1 % of its range.
    dwell : float
        Shorter rests do not count [drive periods].

    Returns
    -------
    MeasuredMotion

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=4.2e-4, law="coulomb")
    >>> ss.virtual_rig(robot, noise=1e-5).motion.type
    'I'
    """
    f = frequency_of(rec, frequency)
    number = period(rec, f)
    periods = number or 1
    rough = cycle(rec, f, period=periods)
    limit = float(max(ERRORS * np.median(rough.error), RANGE * np.ptp(rough.v))) if threshold is None else float(threshold)
    least = max(int(dwell * len(rough.v) / periods), 1)
    signs = _without_flicker(np.where(abs(rough.v) <= limit, 0, np.sign(rough.v)).astype(int), least)
    fine = cycle(rec, f, bins=_bins(rec, periods), period=periods)
    motions, rests = [], None
    for reading in _readings(signs, rough, threshold is None):
        rests_here = _rests(fine, reading, periods)
        rests = rests_here if rests is None else rests
        choices = [(r.lasts(dwell),) if r.lasts(dwell) is not None else (r.length >= dwell, r.length < dwell) for r in rests_here]
        motions += [_motion_with(rests_here, choice, reading, number, fine, dwell) for choice in list(product(*choices))[: 2**_MOST_OPEN]]
    candidates = tuple(sorted({t["motion_type"] for t in motions}))
    first = motions[0]
    words = {name: first[name] for name in ("stick_fraction", "forward_fraction", "backward_fraction", "pattern", "direction", "intervals")}
    return MeasuredMotion(
        " or ".join(candidates),
        period=number,
        threshold=limit,
        noise=fine.noise,
        candidates=candidates,
        rests=rests or (),
        dwell=dwell,
        **words,
    )


def _readings(signs: Any, c: Any, by_noise: bool) -> list[Any]:
    """The signs of the mean cycle; then those that its noise allows too: a faint slip that is none, and a slip that hides in a rest."""
    readings = [signs]
    if not by_noise:
        return readings
    weight = 1 / c.error**2
    for run in _runs(signs):
        part, sure = c.v[run] * weight[run], weight[run]
        if signs[run[0]] != 0 and abs(part.sum()) < SURE * np.sqrt(sure.sum()):
            readings += [_with(old, run, 0) for old in readings]
        elif signs[run[0]] == 0 and len(run) >= 3:
            thirds = np.array_split(run, 3)
            means = np.array([(c.v[t] * weight[t]).sum() / weight[t].sum() for t in thirds])
            errors = np.array([weight[t].sum() ** -0.5 for t in thirds])
            k = int(np.argmax(abs(means) / errors))
            loud = abs(means[k]) > max(ERRORS * errors[k], RANGE * np.ptp(c.v))
            around = signs[run[0] - 1], signs[(run[-1] + 1) % len(signs)]
            if loud:
                readings += [_with(old, thirds[k], int(np.sign(means[k]))) for old in readings]
            elif around[0] == around[1] and (errors > HIDDEN / 3 * np.ptp(c.v)).any():
                readings += [_with(old, thirds[1], -int(around[0]) or s) for old in readings for s in ((1,) if around[0] else (1, -1))]
        if len(readings) > _MOST_OPEN:
            break
    return readings


def _runs(signs: Any) -> list[Any]:
    """Indices of each run of equal signs, round the period."""
    n = len(signs)
    begins = [i for i in range(n) if signs[i] != signs[i - 1]]
    if not begins:
        return [np.arange(n)]
    return [np.arange(a, b) % n for a, b in zip(begins, [*begins[1:], begins[0] + n], strict=True)]


def _with(signs: Any, run: Any, sign: int) -> Any:
    changed = signs.copy()
    changed[run] = sign
    return changed


def _bins(rec: Record, periods: int) -> int:
    """Bins of the fine cycle: eight samples or more in each."""
    count = len(rec["velocity"] if "velocity" in rec or "position" not in rec else rec["position"])
    return int(np.clip(count / 8, 48 * periods, 400 * periods))


def _rests(c: Any, signs: Any, periods: int) -> tuple[Rest, ...]:
    """Every place where the sign of the rough cycle changes or its velocity is near zero."""
    n = len(signs)
    if (signs == signs[0]).all():
        return ()
    width = periods / n
    error = np.maximum(c.error, FLOOR * np.ptp(c.v))
    phase = np.concatenate([c.phase - periods, c.phase, c.phase + periods])
    v, error = np.tile(c.v, 3), np.tile(error, 3)
    noisy = ERRORS * np.median(c.error) > 2 * RANGE * np.ptp(c.v)
    window = max(_WINDOW[int(noisy)], 4 * float(np.diff(c.phase[:2])[0]))
    rests = []
    for run in _runs(signs):
        start, end = int(run[0]), int(run[0]) + len(run)
        if signs[start] == 0:
            before, after, a, b = int(signs[start - 1]), int(signs[end % n]), start * width, end * width
        elif signs[start - 1] != 0:
            before, after, a, b = int(signs[start - 1]), int(signs[start]), start * width, start * width
        else:
            continue
        rests.append(rest_at(phase, v, error, a, b, window, (before, after)))
    return tuple(rests)


def _motion_with(
    rests: tuple[Rest, ...], choice: tuple[bool | None, ...], signs: Any, number: int | None, c: Any, dwell: float
) -> dict[str, Any]:
    """Type and intervals if the body rests at the places chosen."""
    spans = _spans(rests, choice, signs, number or 1, dwell)
    rows = (np.array([len(spans)]), np.array([[t for t, _ in spans]]), np.array([[2 * s for _, s in spans]]))
    types = type_of(*rows, [number or 0], [np.inf], [float(c.v.mean())], dwell, moving=[False])
    merged = intervals_of(*rows, dwell)
    intervals = zip(merged.start[0], merged.length[0], merged.sign[0], strict=True)
    shift = rests[0].start if rests else 0.0
    shares = {name: float(types[name][0]) for name in ("stick_fraction", "forward_fraction", "backward_fraction")}
    return shares | {
        "motion_type": str(types["motion_type"][0]), "pattern": str(types["pattern"][0]), "direction": int(types["direction"][0]),
        "intervals": tuple(((float(a) + shift) % (number or 1), float(b), int(s)) for a, b, s in intervals if b > 0),
    }  # fmt: skip


def _spans(rests: tuple[Rest, ...], choice: tuple[bool | None, ...], signs: Any, periods: int, dwell: float) -> list[tuple[float, int]]:
    """Durations and signs over one motion period, from the first place on."""
    if not rests:
        return [(float(periods), int(signs[0]))]
    spans = []
    for i, (rest, lasts) in enumerate(zip(rests, choice, strict=True)):
        following = rests[(i + 1) % len(rests)]
        length = _length(rest, dwell) if lasts else 0.0
        until = following.start + (periods if i + 1 == len(rests) else 0.0)
        spans += [(length, 0), (max(until - rest.start - length, 0.0), rest.after)]
    return [(t, s) for t, s in spans if t > 0]


def _length(rest: Rest, dwell: float) -> float:
    """The length of a rest that is taken to last: the best, or one within its interval."""
    return rest.length if rest.length >= dwell else min(rest.most, max(1.5 * dwell, 0.5 * (rest.least + rest.most)))


def _without_flicker(signs: Any, least: int) -> Any:
    """Runs shorter than `least` bins, which noise makes where v passes zero, are given to the run before them."""
    for run in _runs(signs):
        if len(run) < least:
            signs[run] = signs[run[0] - 1]
    return signs
