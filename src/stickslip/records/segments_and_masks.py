"""Parts of a record and thinner ones: segments between gaps, samples that are masked, means of neighbours, two records joined."""

from __future__ import annotations

import dataclasses
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import checked_number
from stickslip.basics.quantities import positive

if TYPE_CHECKING:
    from stickslip.records.record import Record


def segments(rec: Record, least: int = 100) -> tuple[Record, ...]:
    """The parts between gaps and between restarts of the time axis, with at least `least` samples each: records to fit jointly."""
    parts, t = [], _longest(rec).t
    for start, end in _stretches(rec, least):
        cut = {}
        for name, c in rec.channels.items():
            own = slice(start, end) if c.t is t or len(c) == len(t) else (c.t >= t[start]) & (c.t <= t[end - 1])
            cut[name] = dataclasses.replace(c, values=c.values[own], t=c.t[own])
        part = f"samples {start} to {end - 1}"
        parts.append(rec.replace(channels=cut, notes=rec._notes_of(cut), source={**rec.source, "segment": part}))
    return tuple(parts)


def _longest(rec: Record) -> Any:
    return max(rec.channels.values(), key=len)


def _stretches(rec: Record, least: int) -> list[tuple[int, int]]:
    c = _longest(rec)
    stretches = [(a, b) for a, b in _whole(c) if b - a >= least]
    if not stretches:
        raise InputError("segments", [f"no part of {c.name!r} between gaps has {least} samples; type a smaller one, for example least=10"])
    return stretches


def _whole(c: Any) -> list[tuple[int, int]]:
    """Where stretches without gaps begin and end."""
    steps = np.diff(c.t)
    return list(pairwise([0, *(np.flatnonzero(~((steps > 0) & (steps <= 1.5 * c.interval))) + 1).tolist(), len(c)]))


def masked(rec: Record, start: float, end: float, channel: str | None = None) -> Record:
    """The record with the samples from `start` to `end` [s] missing (NaN), in all channels or in one, by name or role."""
    names = [rec[channel].name] if channel is not None else list(rec.channels)
    made, count = dict(rec.channels), 0
    for name in names:
        c = made[name]
        hidden = (c.time >= start) & (c.time <= end)
        count += int(hidden.sum())
        made[name] = dataclasses.replace(c, values=np.where(hidden, np.nan, c.values))
    if not count:
        raise InputError("masked", [f"there is no sample from {start:g} to {end:g} s; give a part of the record"])
    shown = f"{', '.join(names)}: masked from {start:g} to {end:g} s"
    return rec.replace(channels=made, notes=(*rec._notes_of(made), shown))


def averaged(rec: Record, rate: float) -> Record:
    """The record with neighbouring samples averaged, at most `rate` values per second [Hz]; a note says so. No mean crosses a gap.

    Examples
    --------
    >>> from stickslip.records import Record
    >>> rec = Record.of(np.arange(1_000_000) / 1e6, {"v [m/s]": np.ones(1_000_000)})
    >>> thin = rec.averaged(rate=1e4)
    >>> len(thin["v"]), thin.notes[-1]
    (10000, 'v: means of 100 samples each, 10000 of 1000000')
    """
    problems = Problems("averaged")
    checked_number("rate", rate, problems, positive, "a positive number [Hz]", "rate=1e4")
    problems.check()
    made, notes = {}, []
    for name, c in rec.channels.items():
        if not c.over_time:
            raise InputError("averaged", [f"{name!r} stands over {c.axis_name} and not over time; take a record over time"])
        count = max(int(np.ceil(c.rate / rate * (1 - 1e-9))), 1)
        made[name] = c if count == 1 else _means(c, count)
        if count > 1:
            notes.append(f"{name}: means of {count} samples each, {len(made[name])} of {len(c)}")
    return rec.replace(channels=made, notes=(*rec._notes_of(made), *notes), source={**rec.source, "averaged": rate})


def _means(c: Any, count: int) -> Any:
    """One channel; what is left of each stretch when no more whole means fit is left out."""
    rows = [np.arange(a, b - count + 1, count) for a, b in _whole(c)]
    at = np.concatenate(rows)[:, None] + np.arange(count)
    if not len(at):
        raise InputError("averaged", [f"{c.name!r} has no {count} samples in a row; type a larger rate"])
    return dataclasses.replace(c, values=c.values[at].mean(axis=1), t=c.t[at].mean(axis=1))


def joined(first: Record, other: Record, delay: float = 0.0) -> Record:
    """The record with the channels of another one added, at their own sampling times, shifted later by `delay` [s]."""
    twice = [name for name in other.channels if name in first.channels]
    if twice:
        raise InputError("joined", [f"both records have {', '.join(map(repr, twice))}; read one of them with columns=[...] of other names"])
    later = {}
    for name, c in other.channels.items():
        factor = c.time[-1] / c.t[-1] if len(c) and c.t[-1] else 1.0
        later[name] = dataclasses.replace(c, t=c.t + delay / factor) if delay else c
    source = {**first.source, "joined with": other.source.get("path", "")}
    notes = tuple(dict.fromkeys((*first.notes, *other.notes)))
    return first.replace(channels={**first.channels, **later}, notes=notes, source=source, synthetic=first.synthetic or other.synthetic)
