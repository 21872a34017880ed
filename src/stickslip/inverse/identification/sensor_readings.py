"""Sensor readings computed from a model's values: gain, delay, offset, drift, and the inertia of a load cell."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.identification.sensors import SensorNumber


def _wide(values: Array, like: Any) -> Any:
    """A number for each value, as a column where there are many cases."""
    return values if like.ndim == 1 else values[:, None]


def _middle(target: Any) -> float:
    """The fixed point of a gain: zero, or the mean of a position, whose origin is arbitrary."""
    return float(np.average(target.y, weights=target.weight * np.ones(target.count))) if target.kind == "position" else 0.0


def _course(target: Any) -> Any:
    """The contribution of a drift of one unit per second."""
    t = target.time
    return t - np.average(t, weights=target.weight * np.ones(target.count)) if target.kind == "position" else t


def _delayed(target: Any, h: Array, delay: Any) -> Any:
    """Values a little later; between samples they change evenly."""
    if delay is None or not np.any(delay) or h.size == 0:
        return h
    if h.ndim == 1 or np.ndim(delay) == 0:
        return target.delayed(h, float(delay))
    shown = np.empty(h.shape)
    for each in np.unique(delay):
        columns = np.flatnonzero(delay == each)
        shown[:, columns] = _delayed(target, h[:, columns], float(each))
    return shown


def change_shown(target: Any, h: Array, reading: dict[str, Any]) -> Any:
    """A change after gain and delay."""
    return reading.get("gain", 1.0) * _delayed(target, h, reading.get("delay"))


def shown_by_sensor(target: Any, h: Array, reading: dict[str, Any]) -> Any:
    """Sensor readings where the model gives h: array (values,) or (values, cases)."""
    if not reading:
        return h
    middle = _middle(target)
    reading_shown = middle + change_shown(target, h - middle, reading) + reading.get("offset", 0.0)
    for what, of in _ADDED.items():
        if what in reading:
            reading_shown = reading_shown + _wide(of(target), reading_shown) * reading[what]
    return reading_shown


_ADDED = {"drift": _course, "inertia": lambda target: target.acceleration}


def of_records(number: SensorNumber, parts: list[Any]) -> Any:
    """Derivative of all values by a number of a sensor, from (target, values of the model, readings)."""
    made = ((i in number.records, *part) for i, part in enumerate(parts))
    return np.concatenate([_column(number.what, t, h, r) if own else np.zeros(t.count) for own, t, h, r in made])


def _column(what: str, target: Any, h: Array, reading: dict[str, Any]) -> Any:
    """Derivative of what a sensor shows by one of its numbers: array (values,)."""
    if what in _ADDED:
        return _ADDED[what](target)
    if what == "offset":
        return np.ones(target.count)
    moved, delay = h - _middle(target), reading.get("delay")
    return _delayed(target, moved, delay) if what == "gain" else -reading.get("gain", 1.0) * target.delay_slope(moved, delay)


def known_rows(numbers: Any, width: int) -> Any:
    """Rows of what is known of the numbers of a sensor, which are the last."""
    first = width - len(numbers)
    rows = [np.where(np.arange(width) == first + k, 1.0 / n.prior.sd, 0.0) for k, n in enumerate(numbers) if n.prior]
    return np.array(rows).reshape(len(rows), width)
