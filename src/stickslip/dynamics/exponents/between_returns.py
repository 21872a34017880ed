"""Lyapunov exponents of a motion without a period, from return to return to its section.

One direction is known: that along the motion, the rates f of the states, which the derivative M of the flow carries from one return to the
next, M f = f there. Its exponent is 0, and so it is measured: by how much M stretches the direction that came from the return before,
against the rates that it should have become. Divided by what the rates are, this does not depend on where a motion begins and ends, as
the mean growth of a length does, which is 0 only after long. The others are the growth of what is left beside that direction. Of a
motion that dies out the rates do too, and then it is the growth of the length that counts.

References
----------
G. Benettin, L. Galgani, A. Giorgilli and J.-M. Strelcyn, Meccanica 15 (1980) 9; H. Haken, Physics Letters A 94 (1983) 71 (the zero).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.interruption import look, partial_result
from stickslip.dynamics.derivatives.growth import growth_in_stretches, rates_at
from stickslip.dynamics.exponents.general_exponents import Lyapunov
from stickslip.dynamics.exponents.lost_directions import summary, with_lost
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.chosen_sections import LONGEST_RETURN
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map, strobe_points
from stickslip.models.model_adapter import adapter_of
from stickslip.studies.progress import Watch

if TYPE_CHECKING:
    from stickslip.dynamics.stroboscopic.chunked_runs import Report
    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates

CHUNK = 50  # returns that are followed at a time
LEAST = 20  # that give an average and an error
ALIGN = 20  # in which directions turn into place
_JUST_AFTER = 1e-12  # of a return to a switch: rounding must not leave out what the switch does to small changes
_STILL = 1e-9  # in scales and that time: what moves by less stands still, and has no direction of its own
_FALLS, _LASTS = 1e-6, 0.25  # from one quarter of the returns to the next: logarithms of rates; part of the first fall that is left


def between_returns(
    model: Model, periods: int, settle: int, start: Any, rtol: float, progress: Report | None, at: Coordinates
) -> tuple[Lyapunov, bool]:
    """All exponents, and whether they are averages over fewer returns, as it was interrupted; the one along the motion is among them."""
    state = states_of(start, model)
    state = strobe_map(model, state, settle, rtol, at).state if settle else state
    frame, parts, watch = Frame(at.smooth - len(at.drifts.free)), -ALIGN, Watch(periods, progress)
    after = 1.0 + _JUST_AFTER if at.section.is_switch else 1.0
    logs, lengths, times = list[Array](), list[float](), list[float]()
    with partial_result() as ending:
        while parts < periods:
            look()
            count = ALIGN if parts < 0 else min(CHUNK, periods - parts)
            points, _, took = strobe_points(model, state, count, rtol, at)
            begins, state = np.vstack([state, points[:-1, 0]]), points[-1]
            growth, rates = growth_in_stretches(at, model, begins, rtol, took[:, 0] * after), rates_at(at, model, begins, _time_of(at))
            for M, volume, f in zip(growth.matrices, growth.volumes, rates, strict=True):
                logs.append(with_lost(frame.carried(M, f), volume, 0))
                lengths.append(frame.longer)
            times += took[:, 0].tolist()
            parts += count
            watch.finished(0, np.zeros(max(count if parts > 0 else 0, 0), int))
    ending.needs(parts >= LEAST)
    grown, longer = np.array(logs[ALIGN:]), np.array(lengths[ALIGN:])
    if _dies_out(longer):
        grown[:, 0] += np.nan_to_num(longer)
    exponents = summary(grown, float(np.mean(times[ALIGN:])), adapter_of(model).unit_of_time)
    notes = ending.note(f"averages over {parts} of {periods} returns"), exponents.note
    return replace(exponents, note="; ".join(filter(None, notes))), ending.interrupted


def _dies_out(longer: Array) -> bool:
    """Whether rates become less and less, or more and more, or nothing moves: by logarithms of what each return makes of them."""
    largest = [part.max() for part in np.array_split(np.cumsum(longer), 4)]
    falls = -np.diff(largest)
    steadily = falls.min() > _FALLS or falls.max() < -_FALLS
    return bool(np.isnan(longer).any() or (steadily and abs(falls[-1]) > _LASTS * abs(falls[0])))


class Frame:
    """Directions that grow along a motion: first that along it, then the others, each beside those before it.

    Examples
    --------
    On a circle that shrinks by half, gone around once in each stretch, as fast as its radius is large:

    >>> frame, M = Frame(2), np.diag([1.0, 0.5])
    >>> [frame.carried(M, np.array([2.0, 0.0])).round(6).tolist() for _ in range(2)]
    [[0.0, -0.693147], [0.0, -0.693147]]
    """

    def __init__(self, count: int):
        self.Q, self.along = np.eye(count), np.full(count, np.nan)
        self.longer = np.nan  # logarithm of the rates after the last stretch in terms of those before it; NaN where nothing moves

    def carried(self, M: Array, f: Array) -> Array:
        """The logarithms of the growth in a stretch with the derivative M, at whose beginning the rates are f."""
        ahead, began = M @ f, np.isfinite(self.along).all()
        size = float(np.linalg.norm(ahead))
        if not (np.max(abs(f), initial=0.0) > _STILL and 0.0 < size < np.inf):
            self.along, self.longer, (self.Q, R) = np.full(len(f), np.nan), np.nan, np.linalg.qr(M @ self.Q)
            return _logs(np.diag(R))
        if not began:
            self.along, self.Q = f, np.linalg.qr(np.column_stack([f, self.Q]))[0]
        stretched, before = M @ self.Q, float(np.linalg.norm(self.along))
        first, self.longer = np.linalg.norm(stretched[:, 0]) * before / size, float(np.log(size / before))
        self.along, (self.Q, R) = ahead, np.linalg.qr(np.column_stack([ahead, stretched[:, 1:]]))
        return np.append(_logs(first), _logs(np.diag(R)[1:]))


def _logs(growth: Any) -> Array:
    with np.errstate(divide="ignore"):
        return np.log(abs(np.asarray(growth)))


def _time_of(at: Coordinates) -> float:
    """A typical time of the motion: the longest of a return is some of these."""
    return float(np.max(at.section.longest)) / LONGEST_RETURN
