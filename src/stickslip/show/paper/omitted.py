"""The parameters that the paper leaves out for lack of space: mean velocity and motion type along each, at 1.7 degrees."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.show.figures.style import INK
from stickslip.show.paper.cases import EXPERIMENTS
from stickslip.show.paper.drawing import Picture, render
from stickslip.show.paper.readings import STATED
from stickslip.show.paper.solved_runs import batch
from stickslip.show.paper.words import plain

__all__ = ["Omitted", "OmittedParameter", "draw", "omitted"]

#: Argument of the preset, its symbol and unit, the factor to that unit, first and last value, and whether they are spaced by a ratio.
PARAMETERS = (
    ("sigma0", "σ₀", "N/m", 1.0, 4e3, 4e6, True),
    ("sigma1", "σ₁", "N s/m", 1.0, 0.1, 1e3, True),
    ("sigma2", "σ₂", "N s/m", 1.0, 0.0, 4.0, False),
    ("v_s", "v_s", "mm/s", 1e3, 1e-4, 2e-2, True),
    ("body_mass", "M", "g", 1e3, 0.02, 0.2, True),
    ("inner_mass", "m", "g", 1e3, 3e-3, 3e-2, True),
    ("tilt_deg", "θ", "°", 1.0, 0.0, 9.0, False),
)
COLOURS = {"II": "#56B4E9", "I": "#0072B2", "III": "#B08A00", "IV": "#D55E00"}


@dataclass(frozen=True, eq=False)
class OmittedParameter:
    """One parameter.

    Parameters
    ----------
    name, symbol, unit : str
    factor : float
        From SI to `unit`.
    own : float
        The paper's value [SI, or degrees].
    values : array
    lugre, coulomb : array
        Mean velocities [m/s]; LuGre, and exact Coulomb friction with break-away at f0.
    labels, types : array
        LuGre labels at the default thresholds, and exact types.
    """

    name: str
    symbol: str
    unit: str
    factor: float
    own: float
    values: Any
    lugre: Any
    coulomb: Any
    labels: Any
    types: Any

    def borders(self, words: Any) -> str:
        """The words in order, with the middle of the two values between which each ends."""
        runs = [(word, len(list(group))) for word, group in groupby(words.tolist())]
        ends = np.cumsum([n for _, n in runs])[:-1]
        middle = [
            math.sqrt(a * b) if a > 0 and self.spaced else 0.5 * (a + b)
            for a, b in zip(self.values[ends - 1], self.values[ends], strict=True)
        ]
        parts = [f"{word} to {plain(float(f'{self.factor * end:.2g}'), 2)}" for (word, _), end in zip(runs, middle, strict=False)]
        return ", ".join([*parts, runs[-1][0] + (" beyond" if parts else " throughout")])

    @property
    def spaced(self) -> bool:
        """Whether the values are spaced by a ratio."""
        return bool(self.values[0] > 0)

    def as_data(self) -> dict[str, Any]:
        """The numbers as plain data, SI units."""
        return {k: v for k, v in vars(self).items() if k not in ("symbol", "unit", "factor")}


@dataclass(frozen=True, eq=False)
class Omitted:
    """All of them."""

    along: tuple[OmittedParameter, ...]


def omitted(fast: bool) -> Omitted:
    """Solve the first experiment along each parameter, all others as printed."""
    return Omitted(tuple(_along(*row, points=13 if fast else 61) for row in PARAMETERS))


def _along(name: str, symbol: str, unit: str, factor: float, low: float, high: float, spaced: bool, points: int) -> OmittedParameter:
    e = EXPERIMENTS[0]
    own = {
        "sigma0": 4e5,
        "sigma1": 100.0,
        "sigma2": 0.04,
        "v_s": 2e-3,
        "body_mass": 62.59e-3,
        "inner_mass": 9.48e-3,
        "tilt_deg": e.tilt_deg,
    }
    values = np.geomspace(low, high, points) if spaced else np.linspace(low, high, points)
    bristles = batch(STATED.lugre(e, **{name: values}), periods=120, settle=100)
    exact = batch(
        STATED.coulomb(e, **({name: values} if name in ("body_mass", "inner_mass", "tilt_deg") else {})), settle="auto", periods=400
    )
    types, speeds = (np.broadcast_to(x, values.shape) for x in (exact.motion_type, exact.mean_velocity))
    return OmittedParameter(name, symbol, unit, factor, own[name], values, bristles.mean_velocity, speeds, bristles.motion_type, types)


def draw(omitted: Omitted, folder: Path) -> Picture:
    """A panel for each parameter."""
    each = [{"a": a} for a in omitted.along]
    return render(folder, "omitted-parameters", [partial(_panel, a) for a in omitted.along], height=2.1, each=each, omitted=omitted)


def _panel(a: OmittedParameter, ax: Any) -> None:
    x = a.factor * a.values
    ax.axvline(a.factor * a.own, color=INK, linewidth=0.7)
    ax.plot(x, 1e3 * a.coulomb, color="#777777", linewidth=1.0, linestyle=(0, (1, 1.1)), label="Coulomb")
    ax.plot(x, 1e3 * a.lugre, color="#AAAAAA", linewidth=0.7, zorder=2)
    for label in ("presliding", "II", "I", "III", "IV", "other"):
        here = a.labels == label
        if here.any():
            ax.plot(
                x[here],
                1e3 * a.lugre[here],
                "o",
                markersize=2.8,
                markeredgewidth=0,
                color=COLOURS.get(label, "#999999"),
                label=label,
                zorder=3,
            )
    if a.spaced:
        ax.set_xscale("log")
    ax.set(xlabel=f"{a.symbol.replace('v_s', '$v_s$')} ({a.unit})", ylabel="mean velocity (mm/s)")
    ax.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=6,
        fontsize=6.5,
        borderaxespad=0.1,
        columnspacing=0.6,
        handletextpad=0.3,
        handlelength=1.1,
    )
