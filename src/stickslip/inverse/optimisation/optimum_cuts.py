"""The quantity along one number at a time, from bound to bound, with the other numbers at the optimum."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.optimisation.candidates import Candidates

_POINTS = 41  # from bound to bound, beside the best machine itself


def cuts_of(worth: Candidates) -> dict[str, Array]:
    """Cuts by the names of the numbers that vary: array (4, points).

    Its rows are the part of the way between the bounds, the number, the quantity, and 1 where every limit is kept, else 0.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.inverse.optimisation.unknowns import Unknowns, Varied
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> worth = Candidates(Unknowns(robot, [Varied("drive.amplitude", ("drive.amplitude",), 2e-4, 8e-4)], None), "mean_velocity", -1.0, [])
    >>> worth.best = np.array([1.0])
    >>> cuts_of(worth)["drive.amplitude"][:, -1].round(9).tolist()
    [1.0, 0.0008, 0.004308808, 1.0]
    """
    space = worth.space
    asked = [(each, part_of.start) for each, part_of in zip(space.varied, space.slices, strict=True) if each.form is None]
    if not asked:
        return {}
    parts = [np.unique(np.append(np.linspace(0.0, 1.0, _POINTS), worth.best[k])) for _, k in asked]
    rows = np.repeat(worth.best[None], sum(map(len, parts)), axis=0)
    ends = np.cumsum([len(part) for part in parts])
    for (_, k), part, end in zip(asked, parts, ends, strict=True):
        rows[end - len(part) : end, k] = part
    values, over, _ = worth.judged(rows)
    split = (np.split(column, ends[:-1]) for column in (worth.sign * values, (over == 0.0) & np.isfinite(values)))
    each = zip(asked, parts, *split, strict=True)
    return {one.name: np.array([part, one.value(part), results, kept]) for (one, _), part, results, kept in each}
