"""Weights of samples: those that a user types, and those by which a robust loss holds outliers back."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.records import Record
from stickslip.records.channel import Channel

#: Weights by size of a residual in standard deviations of the bulk (least squares, Huber 1964, Beaton and Tukey 1974), with their constants
#: of 95 % efficiency under normal noise.
LOSSES = {
    "squares": lambda r: np.ones_like(r),
    "huber": lambda r: np.minimum(1.0, 1.345 / np.maximum(abs(r), 1e-300)),
    "bisquare": lambda r: np.maximum(1.0 - (r / 4.685) ** 2, 1e-6) ** 2,
}
_NORMAL = 0.6744897501960817  # median of the size of a standard normal number
_NUDGE = 1e-5


def loss_of(given: str, what: str = "identify") -> Any:
    """The weights of a loss by its name."""
    if not isinstance(given, str) or given not in LOSSES:
        raise InputError(what, [f"loss = {given!r}; {did_you_mean(str(given), LOSSES)}"])
    return LOSSES[given]


def weighted(records: list[Any], weights: Array, what: str = "identify") -> list[Any]:
    """Records with their weights as a channel of role "weight"; everything wrong with the weights at once."""
    if weights is None:
        return records
    own = [weights] if len(records) == 1 and not _is_list_for(weights, 1) else weights
    problems = Problems(what)
    if not isinstance(own, (list, tuple)) or len(own) != len(records):
        count = f"{len(own)} records" if isinstance(own, (list, tuple)) else "one record"
        problems.add(f"weights are for {count} and there are {len(records)} records; type weights=[w0, w1], an array or None for each")
        problems.check()
    with_weights = [_with(rec, w, i, problems) for i, (rec, w) in enumerate(zip(records, own, strict=True))]
    problems.check()
    return with_weights


def _is_list_for(weights: ArrayLike, count: int) -> bool:
    return isinstance(weights, (list, tuple)) and len(weights) == count and (weights[0] is None or np.ndim(weights[0]) == 1)


def _with(rec: Record, given: Any, i: int, problems: Problems) -> Any:
    if given is None:
        return rec
    if not isinstance(rec, Record):
        problems.add(f'weights[{i}] are for a mean velocity, which has none; type its error instead: ("normal", mean, sd)')
        return rec
    try:
        w = np.asarray(given, float)
    except (TypeError, ValueError):
        w = np.array(np.nan)
    like = next((c for c in rec.channels.values() if w.shape == (len(c),)), None)
    if like is None:
        sizes = " or ".join(str(n) for n in dict.fromkeys(len(c) for c in rec.channels.values()))
        problems.add(f"weights[{i}] has shape {w.shape}; allowed is a weight for each sample, shape ({sizes},)")
        return rec
    if not (np.isfinite(w) & (w >= 0)).all() or not (w > 0).any():
        problems.add(f"weights[{i}] has values from {np.min(w):.4g} to {np.max(w):.4g}; allowed are 0 and more, and not all 0")
        return rec
    others = {name: c for name, c in rec.channels.items() if c.role != "weight"}
    made = Channel("weight", w, "1", like.t, like.axis_name, like.axis_unit, "weight")
    return rec.replace(channels={**others, "weight": made})


def weights_at(rec: Any, t: Array) -> Any:
    """Weights of samples at some times; 1 where a record has none."""
    if "weight" not in rec:
        return np.ones(len(t))
    times, first = np.unique(rec["weight"].time, return_index=True)
    return np.interp(t, times, rec["weight"].values[first])


def robust_weights(weigh: Any, parts: list[Any]) -> Any:
    """Weights of the residuals of each record; the bulk of each has a size of its own."""
    sizes = [float(np.median(abs(own))) / _NORMAL for own in parts]
    return np.concatenate([weigh(own / s) if s > 0 and len(own) > 8 else np.ones(len(own)) for own, s in zip(parts, sizes, strict=True)])


def robust_scale(weigh: Any, rest: Array, weights: Array, scale: float) -> float:
    r"""The factor on the noise with which weighted squares give Huber's covariance.

    With :math:`\psi = w r` the covariance of an M-estimate is :math:`\overline{\psi^2}/\overline{\psi'}^2\,(X^TX)^{-1}`
    (Huber and Ronchetti, Robust Statistics, 2009, Sec. 7.6); that of weighted squares is :math:`\overline{w r^2}/\bar w\,(X^TX)^{-1}`.
    """
    size = float(np.median(abs(rest))) / _NORMAL
    if not size > 0:
        return scale
    r = rest / size
    psi = weigh(r) * r
    slope = ((weigh(r + _NUDGE) * (r + _NUDGE)) - (weigh(r - _NUDGE) * (r - _NUDGE))) / (2 * _NUDGE)
    robust = float(np.mean(psi**2)) / max(float(np.mean(slope)), 0.1) ** 2
    plain = float(np.mean(weights * r**2)) / float(np.mean(weights))
    return scale * float(np.sqrt(robust / plain))


def outlier_notes(problem: Any) -> list[str]:
    """How many samples a robust loss holds back."""
    if not np.ndim(problem.rows):
        return []
    low = [(t.label, int((part < 0.5).sum()), t.count) for t, part in zip(problem.targets, problem.parts(problem.rows), strict=True)]
    return [f"{label}: {few} of {count} values count less than half, as outliers" for label, few, count in low if few]
