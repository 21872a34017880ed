"""Which unknowns a motion is followed in: of a driven machine, of a flow, or of a limit cycle."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.dynamics.continuation.following.cycle_paths import CyclePath
from stickslip.dynamics.continuation.following.pseudo_arclength import Path
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, largest_size

_TOLERANCE = 1e-12


def path_of(family: Family, orbit: Any, origin: Any, span: Numeric, period: int | None = None) -> Path:
    """The path of motions like this one.

    Parameters
    ----------
    family : Family
    orbit : PeriodicOrbit
    origin, span
        Where the parameter is zero in its scale, and the size of that; arrays of several parameters.
    period : int, optional
        Drive periods after which the motions repeat; those of the orbit if not given.
    """
    at = coordinates(orbit.model)
    same = (family, orbit.period if period is None else period, at, origin, span, orbit.rtol, _TOLERANCE)
    if orbit.model.period is not None:
        return Path(*same)
    time = at.time_of(orbit.model)
    return CyclePath(*same, orbit.duration if time is None else largest_size(time), orbit.section)
