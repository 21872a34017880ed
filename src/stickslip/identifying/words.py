"""A fit as text that can be read aloud."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.sweeps.naming import AXES

__all__ = ["counted", "parameter_rows", "rounded", "told", "unit_of_kind", "unit_of_parameter"]


def parameter_rows(fit: Any, level: float = 0.95) -> list[tuple[str, float, float, float, float]]:
    """For each free parameter: name, value, standard error, and the ends of its interval."""
    return [(name, value, fit.errors[name], *fit.interval(name, level)) for name, value in fit.values.items()]


def rounded(value: float, error: float) -> str:
    """A value with as many digits as its standard error leaves: two of the error; two of its own where it is smaller than that.

    Examples
    --------
    >>> rounded(0.1797921, 0.00112), rounded(7961.23, 7.2), rounded(0.05, float("inf")), rounded(1.5, 7.7e3)
    ('0.1798', '7961.2', '0.05', '1.5')
    """
    if not (np.isfinite(value) and np.isfinite(error) and error > 0):
        return f"{value:.6g}"
    if abs(value) < error / 100:
        return f"{value:.2g}"
    places = 1 - int(np.floor(np.log10(error)))
    text = f"{value:.{places}f}" if 0 <= places <= 6 else f"{value:.{max(int(np.floor(np.log10(max(abs(value), error)))) + places, 0)}e}"
    return f"{round(value, places):.0f}" if places < 0 and abs(value) < 1e6 else text


def unit_of_kind(kind: str) -> str:
    """The SI unit of what is compared."""
    return {"velocity": "m/s", "position": "m", "mean": "m/s", "force": "N"}.get(kind, "")


def unit_of_parameter(fit: Any, name: str) -> str:
    """The unit of a free parameter of a preset, robot or law of ours; empty where it is a bare number, or the maker is the user's own."""
    make = fit.problem.parameters.make
    ours = getattr(make, "__module__", "").split(".")[0] == "stickslip"
    unit = AXES.get(name.partition("[")[0].rpartition(".")[2], ("", ""))[1] if ours else ""
    return "" if unit == "1" else unit


def counted(number: int, what: str) -> str:
    """A number of things."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def told(fit: Any) -> str:
    """The fit as text."""
    records, parameters = counted(len(fit.problem.targets), "record"), counted(len(fit.names), "parameter")
    rows = [f"{fit.law} fitted to {records}, {counted(fit.count, 'value')}; {parameters} free"]
    width = max(len(name) for name in fit.names)
    for name, value, error, low, high in parameter_rows(fit):
        sure = f"± {error:.2g} {unit_of_parameter(fit, name)}".rstrip()
        rows.append(f"  {name:<{width}} = {rounded(value, error)} {sure}   95 % {rounded(low, error)} to {rounded(high, error)}")
    for q in fit.quality:
        noise = f", noise {q.noise:.3g} {unit_of_kind(q.kind)}" if np.isfinite(q.noise) else ""
        explained = f", R² {q.r2:.5f}" if np.isfinite(q.r2) else ""
        rows.append(
            f"  {q.label}, {q.kind}: rms {q.rms:.3g} {unit_of_kind(q.kind)}{noise}{explained}, neighbours correlated {q.correlation:.2f}"
        )
    rows.append(f"  search: {fit.starts} places tried, {fit.agree} of those polished ended here")
    return "\n".join([*rows, *(f"note: {sentence}" for sentence in fit.warnings)])
