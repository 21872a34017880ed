"""The influence of each number of a machine: relative derivatives, and fractions of a variance."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.dynamics.derivatives.sensitivity import Sensitivity
from stickslip.inverse.optimisation.propagation import Indices
from stickslip.show.figures.style import COLOURS, INK, axes, drawing, legend_above, name_rows


@drawing
def sensitivity(sensitivity: Sensitivity, ax: Ax = None) -> Any:
    """A bar for each number of a machine: the relative change of the mean velocity per relative change of the number.

    Numbers without a relative derivative, such as those that are zero, are left out.

    Parameters
    ----------
    sensitivity : Sensitivity
        From `stickslip.dynamics.sensitivity`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        If no number has a relative derivative, as for a body at rest.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> ax = ss.plot.sensitivity(ss.dynamics.sensitivity(robot, wrt=["drive.amplitude", "friction.mu_plus"]))
    >>> [label.get_text() for label in ax.get_yticklabels()]
    ['drive.amplitude', 'friction.mu_plus']
    """
    relative = dict(zip(sensitivity.names, np.asarray(sensitivity.relative, float), strict=True))
    known = sorted((name for name, value in relative.items() if np.isfinite(value)), key=lambda name: abs(relative[name]))
    if not known:
        raise InputError(
            "plot", ["no number has a relative derivative (the mean velocity may be 0); print(sensitivity) shows the derivatives"]
        )
    ax = axes(ax, 0.7 + 0.2 * len(known))
    for sign, colour, word in ((1.0, COLOURS[0], "faster"), (-1.0, COLOURS[1], "slower")):
        places = [i for i, name in enumerate(known) if sign * relative[name] >= 0]
        if places:
            ax.barh(places, [relative[known[i]] for i in places], 0.62, color=colour, label=word, zorder=2)
    ax.axvline(0.0, color=INK, linewidth=0.7, zorder=3)
    name_rows(ax, known)
    ax.set_xlabel("change of the mean velocity (% for 1 %)")
    legend_above(ax, ncols=2, handlelength=1.2)
    return ax


@drawing
def indices(indices: Indices, ax: Ax = None) -> Any:
    """First and total Sobol index of each uncertain number, with the 95 % intervals of the sample.

    Parameters
    ----------
    indices : Indices
        The `indices` of a result of `stickslip.optimisation.propagate` with ``indices=True``.
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
    >>> ss.plot.indices(ss.optimisation.propagate(robot, uncertain=spread, samples=64, indices=True).indices).get_xlabel()
    'fraction of the variance'
    """
    order = sorted(indices.total, key=lambda name: indices.total[name])
    kinds = (("first: alone", indices.first, indices.first_interval), ("total: with the others", indices.total, indices.total_interval))
    ax = axes(ax, 0.8 + 0.28 * len(order))
    for (word, values, ends), colour, marker, aside in zip(kinds, COLOURS, "os", (0.14, -0.14), strict=False):
        x, span = np.array([values[n] for n in order]), np.array([ends[n] for n in order])
        errors = np.maximum([x - span[:, 0], span[:, 1] - x], 0.0)
        style: Any = {"fmt": marker, "color": colour, "markersize": 4, "elinewidth": 1.0, "capsize": 2}
        ax.errorbar(x, np.arange(len(order)) + aside, xerr=errors, label=word, zorder=3, **style)
    for end in (0.0, 1.0):
        ax.axvline(end, color=INK, linewidth=0.5, zorder=1)
    name_rows(ax, order, 0.6)
    ax.set_xlabel("fraction of the variance")
    legend_above(ax, ncols=2)
    return ax
