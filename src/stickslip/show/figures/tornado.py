"""Influence of uncertain numbers: a bar for each, the longest on top."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.inverse.optimisation.propagation import Propagated
from stickslip.show.figures.style import COLOURS, INK, axes, axis_label, drawing, legend_above, name_rows, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@drawing
def tornado(propagated: Propagated, ax: Ax = None) -> Any:
    """A bar for each uncertain number: the result at its 5 % and at its 95 % quantile, with the others fixed.

    The grey band is the joint effect of all of them: the central 90 % of the sample. First and total Sobol indices are shown at the
    right, if they were computed, each with half the width of its 95 % interval in its last digits: 0.58(13) is 0.58 ± 0.13.

    Parameters
    ----------
    propagated : Propagated
        From `stickslip.optimisation.propagate`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> spread = {"friction.mu_plus": (0.15, "3%"), "friction.mu_minus": (0.21, "1%")}
    >>> ax = ss.plot.tornado(ss.optimisation.propagate(robot, uncertain=spread, samples=64))
    >>> [label.get_text() for label in ax.get_yticklabels()]
    ['friction.mu_minus', 'friction.mu_plus']
    """
    swings = propagated.swings
    if not swings:
        raise InputError("plot", ["what was propagated has no swings; give what ss.optimisation.propagate returns"])
    order = sorted(swings, key=lambda name: abs(swings[name][1] - swings[name][0]))
    band = [propagated.quantile(q) for q in (0.05, 0.95)]
    factor, letter = scaled([*band, propagated.nominal, *(v for pair in swings.values() for v in pair)], propagated.unit)
    ax = axes(ax, 0.95 + 0.26 * len(order))
    for i, name in enumerate(order):
        for end, colour, word in zip(swings[name], COLOURS, ("number at 5 %", "at 95 %"), strict=False):
            label = word if i == 0 else None
            ax.barh(
                i, factor * (end - propagated.nominal), left=factor * propagated.nominal, height=0.62, color=colour, label=label, zorder=2
            )
    ax.axvspan(*(factor * end for end in band), color=INK, alpha=0.1, linewidth=0, label="90 % of the sample", zorder=0)
    ax.axvline(factor * propagated.nominal, color=INK, linewidth=0.7, zorder=3)
    name_rows(ax, order)
    ax.set_xlabel(axis_label(propagated.of.replace("_", " "), propagated.unit, letter))
    _indices(ax, propagated, order)
    handles, labels = ax.get_legend_handles_labels()  # the band comes last: it belongs to all numbers
    order_of = sorted(range(len(labels)), key=lambda k: labels[k].startswith("90"))
    legend_above(ax, [handles[k] for k in order_of], [labels[k] for k in order_of], ncols=2, columnspacing=1.0, handlelength=1.2)
    return ax


def _indices(ax: Axes, propagated: Any, order: list[str]) -> None:
    """First and total index at the right end of each row."""
    if propagated.indices is None:
        return
    side = ax.secondary_yaxis("right")
    parts = ((propagated.indices.first, propagated.indices.first_interval), (propagated.indices.total, propagated.indices.total_interval))
    name_rows(side, [" / ".join(f"{value[n]:z.2f}({50 * (ends[n][1] - ends[n][0]):.0f})" for value, ends in parts) for n in order])
    side.spines["right"].set_visible(False)
    side.set_ylabel("first / total index")
