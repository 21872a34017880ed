"""A fit as text that can be read aloud."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["parameter_rows", "told"]


def parameter_rows(fit: Any, level: float = 0.95) -> list[tuple[str, float, float, float, float]]:
    """For each free parameter: name, value, standard error, and the ends of its interval."""
    return [(name, value, fit.errors[name], *fit.interval(name, level)) for name, value in fit.values.items()]


def told(fit: Any) -> str:
    """The fit as text."""
    rows = [f"{fit.law} fitted to {len(fit.problem.targets)} records, {fit.count} values; {len(fit.names)} parameters free"]
    width = max(len(name) for name in fit.names)
    for name, value, error, low, high in parameter_rows(fit):
        rows.append(f"  {name:<{width}} = {value:.6g} ± {error:.2g}   95 % {low:.6g} to {high:.6g}")
    for q in fit.quality:
        noise = f", noise {q.noise:.3g}" if np.isfinite(q.noise) else ""
        explained = f", R² {q.r2:.5f}" if np.isfinite(q.r2) else ""
        rows.append(f"  {q.label}, {q.kind}: rms {q.rms:.3g}{noise}{explained}, neighbours correlated {q.correlation:.2f}")
    rows.append(f"  search: {fit.starts} places tried, {fit.agree} of those polished ended here")
    return "\n".join([*rows, *(f"note: {sentence}" for sentence in fit.warnings)])
