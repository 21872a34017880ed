"""The curves of a run as charts that can be asked for their values."""

from __future__ import annotations

from typing import Any

from stickslip.plot.runs import limits, rests, sampled, span
from stickslip.report.charts import chart, curve

__all__ = ["forces", "velocity"]

_TIME = ("time t", "ms")


def velocity(run: Any) -> dict[str, Any]:
    """Velocity over three drive periods [mm/s over ms], shaded where the body rests.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20)
    >>> abs(max(velocity(run)["curves"][0]["y"]) - 1e3 * float(run.v.max())) < 1e-3
    True
    """
    t, (v,), shade = _columns(run, 3, ("v",))
    return chart("velocity of the body over three drive periods", t, _TIME, ("velocity v", "mm/s"), [curve("velocity", 1e3 * v)], shade)


def forces(run: Any) -> dict[str, Any]:
    """Drive force and friction force over two drive periods [mN over ms]."""
    t, (drive, friction), shade = _columns(run, 2, ("drive_force", "friction_force"))
    curves = [curve("friction force R", 1e3 * friction), curve("drive force −m d²ξ/dt²", 1e3 * drive, number=1)]
    borders = limits(run, span(run, 2)[0] + 1e-3 * t)
    curves += [curve(f"break-away {side}", 1e3 * y, number=2, emphasis=True) for side, y in zip(("−", "+"), borders, strict=False)]
    return chart("drive force and friction force over two drive periods", t, _TIME, ("force", "mN"), curves, shade)


def _columns(run: Any, periods: float, names: tuple[str, ...]) -> tuple[Any, list[Any], list[tuple[float, float]]]:
    """Times [ms] from the beginning of the span, columns, and where the body rests [ms]."""
    start, end = span(run, periods)
    found = [sampled(run, start, end, name) for name in names]
    return 1e3 * (found[0][0] - start), [y for _, y in found], [(1e3 * (a - start), 1e3 * (b - start)) for a, b in rests(run, start, end)]
