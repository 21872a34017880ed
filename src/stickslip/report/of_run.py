"""A page about one run: how it moves, moving pictures, the numbers, and how to make it again."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from stickslip.layout import of_one_contact
from stickslip.machine import machine_of
from stickslip.report.charts import Figure, chart_library
from stickslip.report.drawn import svg
from stickslip.report.html import page

__all__ = ["UNITLESS", "moments", "numbers", "run_page", "sources"]

#: The remark on a page about robots whose units are all 1.
UNITLESS = "the robot has no dimensions: its units of mass, length and time are 1, and mm, ms or µJ on this page are parts of these units"
_MOMENTS = 480  # instants of the moving picture
_LONGEST = 4  # drive periods that it shows at most
#: Numbers of mechanisms whose names mean something else in a robot.
_OF_MECHANISMS = {
    "damping": ("damping c", "N s/m"), "load": ("normal force", "N"), "force": ("amplitude of the force F", "N"),
    "bias": ("constant part of the force F_0", "N"),
}  # fmt: skip


def run_page(run: Any, title: str, command: str = "", dimensionless: bool = False) -> str:
    """The page about a run of a robot or of a mechanism.

    Parameters
    ----------
    run : Trajectory
    title : str
        What stands at its top.
    command : str
        What to type for the same page, if it was made by a command.
    dimensionless : bool
        Whether all units of the robot are 1; a remark says so.

    Returns
    -------
    str

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20)
    >>> text = run_page(run, "The rig on 1.7 degrees")
    >>> "<h1>The rig on 1.7 degrees</h1>" in text, "https:" in text.split("<main")[0]
    (True, False)
    """
    from stickslip.fields import leaves

    run = of_one_contact("report", run, "its page shows one body")
    return page(
        "run.html",
        title=title,
        driven=run.model.period is not None,
        rows=_facts(run) if run.model.period is not None else _facts_of_mechanism(run),
        figures=_figures(run),
        library=chart_library(),
        moments=moments(run) if machine_of(run.model).drive is not None else None,
        numbers=numbers(leaves(run.model), mechanism=machine_of(run.model).drive is None),
        notes=[*run.notes, *([UNITLESS] if dimensionless else [])],
        toml=_toml(run),
        command=command,
        provenance=_provenance(run),
        sources=sources(run.model),
    )


def _figures(run: Any) -> list[Figure]:
    """Velocity, phase portrait and forces."""
    from stickslip import plot
    from stickslip.report import run_charts

    driven = run.model.period is not None
    speed = f"Velocity over {'three drive periods' if driven else 'the run'}; shaded where the contact sticks."
    force = f"{'Drive force and friction' if machine_of(run.model).drive is not None else 'Friction'} force, with the forces of break-away."
    phase = "Phase portrait without the drift; a circle at the start of each drive period." if driven else "Phase portrait."
    return [
        Figure(speed, svg(lambda ax: plot.velocity(run, ax=ax)), run_charts.velocity(run)),
        Figure(force, svg(lambda ax: plot.forces(run, ax=ax)), run_charts.forces(run)),
        Figure(phase, svg(lambda ax: plot.phase(run, ax=ax))),
    ]


def _facts(run: Any) -> list[tuple[str, str]]:
    """What there is to say, each with its unit."""
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity, velocity_range

    m, balance = motion(run), energy(run)
    slowest, fastest = (1e3 * v for v in velocity_range(run))
    work = float(balance.drive[balance.settle :].mean())
    period = "not found: the mean velocity still depends on the length of the run" if m.period is None else f"{m.period}"
    shares = ", ".join(f"{name} {100 * getattr(m, f'{name}_fraction'):.1f} %" for name in ("forward", "backward", "stick"))
    return [
        ("mean velocity", f"{1e3 * mean_velocity(run):.6g} mm/s".replace("-", "−")),
        ("motion type", f"{m.type} (pattern {m.pattern}, margin {m.margin:.3g})")
        if machine_of(run.model).drive is not None
        else ("motion", f"pattern {m.pattern}"),
        ("repeats after [drive periods]", period),
        ("parts of a period", shares),
        ("velocity", f"{slowest:.6g} to {fastest:.6g} mm/s".replace("-", "−")),
        ("drive period", f"{1e3 * run.period_time:.6g} ms"),
        ("work of the drive in a period", f"{1e6 * work:.6g} µJ"),
        ("worst residual of the energy balance", f"{balance.worst:.1e}"),
        ("status", f"{run.status}, {run.periods} drive periods, {run.settle} of them to settle"),
    ]


def _facts_of_mechanism(run: Any) -> list[tuple[str, str]]:
    """The same of a mechanism that nothing drives."""
    from collections import Counter

    from stickslip.analysis.energy import energy
    from stickslip.analysis.segments import shares
    from stickslip.analysis.steady import mean_velocity

    balance, counts = energy(run), Counter(e.kind for e in run.events)
    return [
        ("mechanism", f"{type(run.model).__name__} with {type(run.model.friction).__name__} friction"),
        ("mean velocity", f"{1e3 * mean_velocity(run):.6g} mm/s".replace("-", "−")),
        ("parts of the time", ", ".join(f"{name} {100 * share:.1f} %" for name, share in shares(run).items())),
        ("events", ", ".join(f"{name} {n}" for name, n in counts.items()) or "none"),
        ("velocity", f"{1e3 * run.v.min():.6g} to {1e3 * run.v.max():.6g} mm/s".replace("-", "−")),
        ("work that came in, work of friction", f"{balance.drive.sum():.6g} J, {balance.friction.sum():.6g} J"),
        ("residual of the energy balance", f"{balance.worst:.1e}"),
        ("status", f"{run.status}, {float(run.pieces.t[-1] - run.pieces.t[0]):.6g} s"),
    ]


def moments(run: Any) -> dict[str, Any]:
    """The last motion period as plain numbers for the moving picture: times [ms], lengths [mm], velocities [mm/s], force [N]."""
    import numpy as np

    from stickslip.analysis.steady import period_number

    span = min(period_number(run) or _LONGEST, _LONGEST, max(run.periods, 1)) * run.period_time
    end = float(run.strobe_times[-1])
    at = run.at(np.linspace(end - span, end, _MOMENTS))
    digits = {"t": (1e3, at["t"] - at["t"][0]), "x": (1e3, at["x"] - at["x"][0]), "v": (1e3, at["v"]), "R": (1.0, at["friction_force"])}
    digits["xi"] = (1e3, at["xi"])
    return {name: [float(f"{factor * value:.6g}") for value in column] for name, (factor, column) in digits.items()}


def numbers(named: Iterable[tuple[str, Any]], units: bool = True, mechanism: bool = False) -> list[tuple[str, str, str]]:
    """Name, value with its unit, and meaning of the numbers of a robot or mechanism; the unit is that of the docs' page on notation."""
    from stickslip.sweeps.naming import AXES

    known = _OF_MECHANISMS if mechanism else {}
    found = []
    for name, value in named:
        meaning, unit = known.get(name) or AXES.get(name.rpartition(".")[2], ("", ""))
        found.append((name, f"{float(value):.10g} {unit if units and unit != '1' else ''}".rstrip(), meaning))
    return found


def _toml(run: Any) -> str:
    """The robot as a study file; empty if a part of it is the user's own class."""
    from stickslip.errors import InputError

    length = float(run.pieces.t[-1] - run.pieces.t[0])
    how = f"duration = {length!r}" if run.model.period is None else f"periods = {run.periods}\nsettle = {run.settle}"
    try:
        return f"{run.model.to_toml()}\n[solve]\n{how}\n"
    except InputError:
        return ""


def _provenance(run: Any) -> list[tuple[str, str]]:
    made = run.provenance
    told = [*made.get("versions", {}).items(), *made.get("settings", {}).items()]
    return [(name, "-" if value is None else str(value)) for name, value in told]


def sources(model: Any) -> list[str]:
    """The references that the docstrings of law and drive name."""
    import inspect
    import re

    found = []
    for part in (model.friction, machine_of(model).drive):
        text = re.search(r"^References\n-+\n(.*?)(?=\n\n\w|\Z)", inspect.getdoc(type(part)) or "", re.M | re.S)
        found += [" ".join(text[1].split())] if text else []
    return found
