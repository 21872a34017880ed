"""The energy balance of a run: stacked bars for each drive period."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.energy import Energy, energy as energy_of
from stickslip.analysis.flow_contacts import FrictionWork
from stickslip.basics.arguments import Ax
from stickslip.results.trajectory import Trajectory
from stickslip.show.figures.style import COLOURS, INK, SHADE, axes, drawing, legend_above, prefix

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_COLOUR = {"drive": COLOURS[0], "gravity": COLOURS[4], "friction": COLOURS[1], "damping": COLOURS[5]}
_NONE = 1e-12  # relative to the largest work: smaller ones are not drawn


@drawing
def energy(energy: Energy | FrictionWork | Trajectory, ax: Ax = None) -> Any:
    """The energy balance of a run for each drive period: work supplied upwards, work dissipated downwards.

    The bars of a period add up to the change of kinetic and potential energy, which is drawn as a line; transient periods, left out of
    the mean velocity, are shaded.

    Parameters
    ----------
    energy : Energy, FrictionWork or Trajectory
        From `stickslip.energy`; of a run it is computed.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> balance = ss.energy(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=12))
    >>> ss.plot.energy(balance).get_ylabel()
    'work in a drive period (µJ)'
    """
    if isinstance(energy, Trajectory):
        energy = energy_of(energy)
    works, stored = _works(energy.works), energy.stored
    count = len(energy.friction)
    factor, letter = prefix(*works.values(), *([] if stored is None else [stored])) if energy.unit else (1.0, "")
    number = np.arange(1, count + 1)
    ax = axes(ax)
    if energy.settle and count > 1:
        ax.axvspan(0.5, energy.settle + 0.5, color=SHADE, linewidth=0, zorder=0, label="left out of the mean")
    above, below = np.zeros(count), np.zeros(count)
    for i, (name, work) in enumerate(works.items()):
        up = work >= 0
        colour = _COLOUR.get(name, COLOURS[(1 + i) % 7])
        ax.bar(number, factor * work, 0.8, np.where(up, above, below), color=colour, label=name, linewidth=0, zorder=2)
        above, below = above + np.where(up, factor * work, 0.0), below + np.where(up, 0.0, factor * work)
    if stored is not None:
        ax.plot(number, factor * stored, ".-", color="black", markersize=3, linewidth=0.8, label="change of energy", zorder=4)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=3)
    _axes(ax, count, letter, energy.unit)
    legend_above(ax, ncols=3, columnspacing=1.2, handlelength=1.2)
    return ax


def _works(works: dict[str, Any]) -> dict[str, Any]:
    """The works that are large enough to be drawn."""
    largest = max((np.max(abs(work), initial=0.0) for work in works.values()), default=0.0)
    return {name: work for name, work in works.items() if np.max(abs(work), initial=0.0) > _NONE * largest}


def _axes(ax: Axes, count: int, letter: str, joules: str) -> None:
    from matplotlib.ticker import MaxNLocator

    unit = f" ({letter}{joules})" if joules else ""
    ax.set_xlim(0.5, count + 0.5)
    if count == 1:
        ax.set_xticks([1], ["whole run"])
        ax.set_ylabel(f"work{unit}")
        return
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    ax.set(xlabel="drive period", ylabel=f"work in a drive period{unit}")
