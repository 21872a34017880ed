"""The curves of a run as interactive charts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.variables import unit_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.show.figures.runs import limits, samples_over, span, sticking_intervals
from stickslip.show.reports.charts import chart, curve

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


def velocity(run: Trajectory) -> dict[str, Any]:
    """Velocity over three drive periods [mm/s over ms], shaded where the only contact sticks; over the whole run [s] without a drive.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=20)
    >>> abs(max(velocity(run)["curves"][0]["y"]) - 1e3 * float(run.v.max())) < 1e-3
    True
    """
    t, (v,), shade, across = _columns(run, 3, ("v",))
    shown = "over three drive periods" if run.model.period is not None else "over the run"
    factors, units = _factors(run)
    scaled = v * (factors[0] if v.ndim == 1 else factors)
    mixed = len(set(units)) > 1
    names = [f"{name} ({unit})" for name, unit in zip(run.body_columns, units, strict=True)] if mixed else run.body_columns
    curves = _by_part(names, scaled) or [curve("velocity", scaled)]
    up = ("velocity v", "" if mixed else units[0])
    return chart(f"velocity of {'the body' if v.ndim == 1 else 'each body'} {shown}", t, across, up, curves, shade)


def _factors(run: Trajectory) -> tuple[list[float], list[str]]:
    """Of each body the factor of its velocity, and the unit: mm/s, or rad/s of what turns."""
    units = [unit_of_part("v", run.model, part) for part in run.body_columns]
    return [1.0 if unit == "rad/s" else 1e3 for unit in units], [unit if unit == "rad/s" else f"m{unit}" for unit in units]


def _by_part(names: Any, columns: Any) -> list[Any]:
    """A curve for each body or contact if there are several; otherwise empty."""
    return [] if columns.ndim == 1 else [curve(name, y, number=i) for i, (name, y) in enumerate(zip(names, columns.T, strict=True))]


def forces(run: Trajectory) -> dict[str, Any]:
    """Drive force, if any, and friction force over two drive periods [mN over ms]; over the whole run [s] without a drive."""
    names = ("friction_force", "drive_force") if machine_of(run.model).drive is not None else ("friction_force",)
    t, columns, shade, across = _columns(run, 2, names)
    shown = "over two drive periods" if run.model.period is not None else "over the run"
    parts = _by_part(run.contacts, 1e3 * columns[0])
    if parts:
        return chart(f"friction force of each contact {shown}", t, across, ("force", f"m{unit_of('load', run.model)}"), parts)
    words = ("friction force R", "drive force −m d²ξ/dt²")
    curves = [curve(word, 1e3 * y, number=i) for i, (word, y) in enumerate(zip(words, columns, strict=False))]
    borders = limits(run, _shown(run, 2)[0] + t / _clock(run)[0])
    curves += [curve(f"break-away {side}", 1e3 * y, number=2, emphasis=True) for side, y in zip(("−", "+"), borders, strict=False)]
    return chart(f"{'drive force and ' * (len(names) - 1)}friction force {shown}", t, across, ("force", "mN"), curves, shade)


def _clock(run: Trajectory) -> tuple[float, str]:
    """The unit of the time axis: milliseconds of drive periods, seconds without a drive."""
    return (1e3, "ms") if run.model.period is not None else (1.0, "s")


def _shown(run: Trajectory, periods: float) -> tuple[float, float]:
    return span(run, periods if run.model.period is not None else None)


def _columns(run: Trajectory, periods: float, names: tuple[str, ...]) -> tuple[Any, list[Any], list[tuple[float, float]], tuple[str, str]]:
    """Times from the start of the span, columns, intervals of sticking, and the label of the time axis."""
    (start, end), (factor, unit) = _shown(run, periods), _clock(run)
    alone = run.pieces.layout.single
    columns = [samples_over(run if alone else run.with_axes, start, end, name) for name in names]
    rested = sticking_intervals(run, start, end) if alone else []
    shade = [(factor * (a - start), factor * (b - start)) for a, b in rested]
    return factor * (columns[0][0] - start), [y for _, y in columns], shade, ("time t", unit)
