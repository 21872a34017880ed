"""Page on one run: its motion with an animation, the numbers, and how to repeat it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from stickslip.analysis.steady import is_run
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import field_description, leaves
from stickslip.basics.quantities import axis_in, pretty_unit
from stickslip.models.machine_adapter import machine_of
from stickslip.show.reports.charts import Figure, chart_library
from stickslip.show.reports.drawn import svg
from stickslip.show.reports.facts import facts, tables
from stickslip.show.reports.html import page
from stickslip.show.reports.moving import moments

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


#: The remark on a page about dimensionless robots.
UNITLESS = "the robot has no dimensions: its units of mass, length and time are 1, and mm, ms or µJ on this page are parts of these units"


def run_page(run: Trajectory, title: str, command: str = "", dimensionless: bool = False, search: dict[str, Any] | None = None) -> str:
    """The page on a run of any machine.

    Parameters
    ----------
    run : Trajectory
    title : str
        Title of the page.
    command : str
        The command that makes the page, if it was made by one.
    dimensionless : bool
        Whether all units of the robot are 1, which adds a remark.
    search : dict, optional
        Content on the search that found the machine (`of_optimum`).

    Returns
    -------
    str

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=20)
    >>> text = run_page(run, "The rig on 1.7 degrees")
    >>> "<h1>The rig on 1.7 degrees</h1>" in text, "https:" in text.split("<main")[0]
    (True, False)
    """
    is_run("run_page", run, bodies=False)
    bodies = bool(run.pieces.layout.bodies)
    is_robot = bodies and machine_of(run.model).drive is not None
    return page(
        "run.html",
        title=title,
        what="robot" if is_robot else "mechanism" if run.pieces.layout.single else "machine" if bodies else "flow",
        driven=run.model.period is not None,
        rows=facts(run),
        tables=tables(run),
        search=search,
        figures=[*_figures(run), *(search["figures"] if search else [])],
        library=chart_library(),
        moments=moments(run) if bodies else None,
        units=bodies,
        tex=_equations(run.model),
        numbers=numbers_of(run.model),
        notes=[*run.notes, *([UNITLESS] if dimensionless else [])],
        toml=_toml(run),
        command=command,
        provenance=_provenance(run),
        sources=sources(run.model),
    )


def _figures(run: Trajectory) -> list[Figure]:
    """Velocity, contacts of a machine with several bodies, forces, phase portrait; of a flow its states and what its contacts do."""
    from stickslip.show import figures as plot
    from stickslip.show.reports import run_charts

    if not run.pieces.layout.bodies:
        return _figures_of_flow(run)

    driven, several = run.model.period is not None, not run.pieces.layout.single
    over = "three drive periods" if driven else "the run"
    shaded = "" if several else "; shaded where the contact sticks"
    kind = "Drive force and friction" if machine_of(run.model).drive is not None else "Friction"
    figures = [Figure(f"Velocity over {over}{shaded}.", svg(lambda ax: plot.velocity(run, ax=ax)), run_charts.velocity(run))]
    if several and run.contacts:
        rows = len(run.contacts) + len(machine_of(run.model).mechanics.stops)
        bars = svg(lambda ax: plot.contacts(run, ax=ax), height=max(2.6, 0.9 + 0.27 * rows))
        figures.append(Figure(f"State of each contact over {over}.", bars))
        figures.append(Figure("Friction force of each contact.", svg(lambda ax: plot.forces(run, ax=ax)), run_charts.forces(run)))
    elif not several:
        figures.append(
            Figure(f"{kind} force, with the forces of break-away.", svg(lambda ax: plot.forces(run, ax=ax)), run_charts.forces(run))
        )
    phase = "Phase portrait without the drift; a circle at the start of each drive period." if driven else "Phase portrait."
    return [*figures, Figure(phase, svg(lambda ax: plot.phase(run, ax=ax)))]


def _figures_of_flow(run: Any) -> list[Figure]:
    """States over time, modes and forces of the contacts, and one state against another."""
    from stickslip.show import figures as plot

    driven = run.model.period is not None
    span, over = (3 * run.period_time, "three periods of the forcing") if driven else (None, "the run")
    figures = [Figure(f"States over {over}; thin lines are switches.", svg(lambda ax: plot.states(run, duration=span, ax=ax)))]
    if run.contacts:
        bars = svg(lambda ax: plot.contacts(run, ax=ax), height=max(2.6, 0.9 + 0.27 * len(run.contacts)))
        figures.append(Figure(f"State of each contact over {over}.", bars))
        figures.append(Figure("Friction force of each contact.", svg(lambda ax: plot.forces(run, ax=ax))))
    if len(run.names) > 1:
        circle = "; a circle at the start of each period" if driven else ""
        figures.append(Figure(f"One state against another{circle}.", svg(lambda ax: plot.phase(run, ax=ax))))
    return figures


def _equations(model: Model) -> str:
    """The equations as LaTeX; empty if a part of the machine is not a formula, such as a record."""
    from stickslip.engine.latex import latex

    try:
        return latex(model)
    except InputError:
        return ""


def numbers(named: Iterable[tuple[str, Any, tuple[str, str] | None]], units: bool = True) -> list[tuple[str, str, str]]:
    """Name, value with its unit, and meaning of numbers, given with (meaning, unit) or None."""
    rows = []
    for name, value, axis in named:
        meaning, unit = axis or ("", "")
        shown = pretty_unit(unit) if units and unit != "1" else ""
        rows.append((name, f"{float(value):.10g} {shown}".rstrip(), meaning))
    return rows


def numbers_of(model: Model) -> list[tuple[str, str, str]]:
    """`numbers` for any machine, as described by its fields."""
    return numbers((name, value, axis_in(field_description(model, name))) for name, value in leaves(model))


def _toml(run: Trajectory) -> str:
    """The robot as a study file; empty if a part of it is a user-defined class."""
    length = float(run.pieces.t[-1] - run.pieces.t[0])
    how = f"duration = {length!r}" if run.model.period is None else f"periods = {run.periods}\nsettle = {run.settle}"
    try:
        return f"{run.model.to_toml()}\n[solve]\n{how}\n"
    except InputError:
        return ""


def _provenance(run: Trajectory) -> list[tuple[str, str]]:
    made = run.provenance
    settings = [*made.get("versions", {}).items(), *made.get("settings", {}).items()]
    return [(name, "-" if value is None else str(value)) for name, value in settings]


def sources(model: Model) -> list[str]:
    """The references in the docstrings of a machine and its parts, without repetition."""
    import inspect
    import re

    references: dict[str, None] = {}
    for cls in dict.fromkeys(value for name, value in leaves(model, kinds=True) if name.endswith("__class__")):
        text = re.search(r"^References\n-+\n(.*?)(?=\n\n\w|\Z)", inspect.getdoc(cls) or "", re.M | re.S)
        references |= {" ".join(text[1].split()): None} if text else {}
    return list(references)
