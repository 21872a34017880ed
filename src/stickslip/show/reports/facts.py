"""Facts about a run with their units: on the machine, and on each body, contact, link and stop."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.variables import unit_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.show.reports.charts import Table, tables_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


Row = tuple[str, ...]


def facts(run: Trajectory) -> list[tuple[str, str]]:
    """Names and values for the page of a run."""
    if not run.pieces.layout.bodies:
        return _of_flow(run)
    if not run.pieces.layout.single:
        return _of_machine(run)
    return _of_robot(run) if run.model.period is not None else _of_bench(run)


def millimetres(*velocities: float, model: Any = None, part: str = "") -> str:
    """Velocities [m/s] in mm/s ([rad/s] in rad/s for what turns); two are written as a range."""
    unit = unit_of_part("v", model, part)
    factor, letter = (1.0, "") if unit == "rad/s" else (1e3, "m")
    return " to ".join(f"{factor * v:.6g}" for v in velocities).replace("-", "−") + f" {letter}{unit}"


def joules(work: float) -> str:
    """A work [J] with an SI prefix."""
    from stickslip.show.figures.style import prefix

    factor, unit = prefix(work)
    return f"{factor * work:.6g} {unit}J".replace("-", "−")


def mean_of(run: Trajectory, body: str | None = None) -> float:
    """Mean velocity of the machine or of a body [m/s]; values within rounding count as 0."""
    from stickslip.analysis.steady import mean_velocity

    return _rounded(run, float(mean_velocity(run, body=body)))


def _rounded(run: Trajectory, v: float) -> float:
    """A velocity; 0 if it is rounding."""
    return v if abs(v) > 1e-11 * float(machine_of(run.model).velocity_scale) else 0.0


def _of_robot(run: Trajectory) -> list[tuple[str, str]]:
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity, velocity_range

    m, balance = motion(run), energy(run)
    work = float(balance.drive[balance.settle :].mean())
    shares = ", ".join(f"{name} {100 * getattr(m, f'{name}_fraction'):.1f} %" for name in ("forward", "backward", "stick"))
    return [
        ("mean velocity", millimetres(mean_velocity(run))),
        ("motion type", f"{m.type} (pattern {m.pattern}, margin {m.margin:.3g})")
        if machine_of(run.model).drive is not None
        else ("motion", f"pattern {m.pattern}"),
        ("repeats after [drive periods]", _repeats(m.period)),
        ("parts of a period", shares),
        ("velocity", millimetres(*velocity_range(run))),
        ("drive period", f"{1e3 * run.period_time:.6g} ms"),
        ("work of the drive in a period", f"{1e6 * work:.6g} µJ"),
        ("worst residual of the energy balance", f"{balance.worst:.2g}"),
        ("status", _status(run)),
    ]


def _repeats(period: int | None) -> str:
    return "not found: the mean velocity still depends on the length of the run" if period is None else f"{period}"


def _status(run: Trajectory) -> str:
    if run.model.period is None:
        return f"{run.status}, {float(run.pieces.t[-1] - run.pieces.t[0]):.6g} s"
    return f"{run.status}, {run.periods} drive periods, {run.settle} of them to settle"


def _of_bench(run: Trajectory) -> list[tuple[str, str]]:
    """The facts on an autonomous mechanism."""
    from stickslip.analysis.energy import energy
    from stickslip.analysis.run_segments import shares
    from stickslip.analysis.steady import mean_velocity

    balance, counts = energy(run), Counter(e.kind for e in run.events)
    return [
        ("mechanism", f"{type(run.model).__name__} with {machine_of(run.model).law_names} friction"),
        ("mean velocity", millimetres(mean_velocity(run))),
        ("parts of the time", ", ".join(f"{name} {100 * share:.1f} %" for name, share in shares(run).items())),
        ("events", ", ".join(f"{name} {n}" for name, n in counts.items()) or "none"),
        ("velocity", millimetres(run.v.min(), run.v.max())),
        ("work that came in, work of friction", f"{balance.drive.sum():.6g} J, {balance.friction.sum():.6g} J"),
        ("residual of the energy balance", f"{balance.worst:.2g}"),
        ("status", _status(run)),
    ]


# ---- flows ----
def _of_flow(run: Any) -> list[tuple[str, str]]:
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion

    m: Any = motion(run)
    turns = "periods of the forcing" if run.model.period is not None else "turns"
    repeats = f"{m.period} {turns}, {m.duration:.6g}" if m.period else "-"
    rows = [
        ("flow", f"{len(run.names)} states and {len(run.model.modes)} modes"),
        ("motion", m.type),
        ("repeats after", repeats),
        *((name, f"{low:.6g} to {high:.6g}".replace("-", "−")) for name, (low, high) in m.ranges.items()),
        ("modes", ", ".join(f"{mode} {100 * share:.1f} %" for mode, share in m.modes.items())),
    ]
    for name, work in energy(run).friction_of.items() if run.contacts else ():
        rows.append((f"work of friction at {name}{' in a period' if run.model.period else ''}", f"{_mean(work, run.settle):.6g}"))
    return [*rows, ("status", f"{run.status}, {float(run.nodes[-1] - run.nodes[0]):.6g}, {len(run.events)} switches")]


# ---- several bodies ----
def _of_machine(run: Trajectory) -> list[tuple[str, str]]:
    from stickslip.analysis.motion import motion

    law = machine_of(run.model).law_names
    facts = [
        ("machine", f"{type(run.model).__name__} with {run.pieces.layout.description}" + (f", {law} friction" if law else "")),
        (f"mean velocity of {_whose(run.model)}", millimetres(mean_of(run), model=run.model)),
    ]
    if run.model.period is not None:
        m: Any = motion(run)
        facts += [
            ("repeats after [drive periods]", _repeats(m.period)),
            ("contacts that never move", ", ".join(m.anchored) or "none"),
            ("drive period", f"{1e3 * run.period_time:.6g} ms"),
        ]
    return [*facts, *_balance(run), ("status", _status(run))]


def _whose(model: Model) -> str:
    """The body to which the mean velocity of a machine refers, or "the centre of mass"."""
    return machine_of(model).principal or "the centre of mass"


def _balance(run: Trajectory) -> list[tuple[str, str]]:
    from stickslip.analysis.energy import energy

    try:
        balance = energy(run)
    except InputError as error:
        return [("energy balance", "none: " + error.problems[0].partition("; type ")[0])]
    when = "in a period" if run.model.period is not None else "in the run"
    works = [("work put in", balance.drive), ("work of friction", balance.friction), ("work of dampers and hits", balance.damping)]
    rows = [(f"{name} {when}", joules(_mean(work, balance.settle))) for name, work in works]
    return [*rows, ("worst residual of the energy balance", f"{balance.worst:.2g}")]


def _mean(works: Any, settle: int) -> float:
    """Mean work per period after the transient, or the work of a run without a period."""
    return float(works[min(settle, len(works) - 1) :].mean())


def tables(run: Trajectory) -> list[dict[str, Any]]:
    """Tables of the bodies, contacts, links and stops of a machine of several bodies; empty for a single body."""
    if run.pieces.layout.single or not run.pieces.layout.bodies:
        return []
    return tables_of((_bodies(run), _contacts(run), _links(run)))


def _bodies(run: Trajectory) -> Table:
    from stickslip.show.reports.moving import shown_span

    start, parts = shown_span(run)[0], machine_of(run.model).mechanics.parts  # type: ignore[attr-defined]
    rows, turns = [], unit_of("x", run.model) == "rad"
    for name, body in run.body_columns.items():
        v = body.v[run.t >= start]
        mass = f"{float(parts[name].mass):.6g} {'kg m²' if turns else 'kg'}"
        own: dict[str, Any] = {"model": run.model, "part": name}
        ends = (_rounded(run, float(end)) for end in (v.min(), v.max()))
        rows.append((name, mass, millimetres(mean_of(run, name), **own), millimetres(*ends, **own)))
    return "The bodies.", ("body", "inertia" if turns else "mass", "mean velocity", "velocity"), rows


def _contacts(run: Trajectory) -> Table:
    """Motion of each contact and its friction loss."""
    from stickslip.analysis.contact_modes import FLIGHT, contact_modes
    from stickslip.show.reports.moving import shown_span

    start, end = shown_span(run)
    words, losses = _motions(run), _losses(run, "friction_of")
    rows, flies = [], any(law.flies for law in machine_of(run.model).laws)
    for name, stretches in contact_modes(run, start, end).items():
        signs = (1, -1, 0, FLIGHT)[: 3 + flies]
        shares = (sum(b - a for a, b, sign in stretches if sign == wanted) / (end - start) for wanted in signs)
        rows.append((name, *words.get(name, ()), *(f"{100 * share:.1f} %" for share in shares), losses.get(name, "–")))
    states = ("forwards", "backwards", "sticks", *(("in flight",) if flies else ()))
    head = ("contact", *(("motion", "pattern") if words else ()), *states, "friction takes")
    return f"The contacts, over the {'last motion period' if words else 'whole run'}.", head, rows


def _motions(run: Trajectory) -> dict[str, Row]:
    from stickslip.analysis.motion import motion

    if run.model.period is None:
        return {}
    motions: Any = motion(run)
    return {name: (m.type, m.pattern.replace("-", "−")) for name, m in motions.contacts.items()}


def _losses(run: Trajectory, which: str) -> dict[str, str]:
    """Losses of the parts per period, or in the run, with units; empty if energy is not balanced."""
    from stickslip.analysis.energy import energy

    try:
        balance = energy(run)
    except InputError:
        return {}
    return {name: joules(_mean(works, balance.settle)) for name, works in getattr(balance, which).items()}


def _links(run: Trajectory) -> Table:
    """Losses of links and stops, and the number of hits on stops."""
    from stickslip.analysis.contact_modes import hits
    from stickslip.models.powers import label_of_stop
    from stickslip.show.reports.moving import shown_span

    mechanics = machine_of(run.model).mechanics
    struck = {label_of_stop(mechanics, name): of for name, of in hits(run, *shown_span(run)).items()}
    rows = []
    losses = _losses(run, "damping_of")
    for name in dict.fromkeys([*losses, *struck]):
        fastest = max((-rate for _, rate in struck.get(name, [])), default=None)
        struck_here = (str(len(struck.get(name, []))), "–" if fastest is None else millimetres(fastest, model=run.model)) if struck else ()
        rows.append((name, losses.get(name, "–"), *struck_here))
    head = ("between", "takes", *(("hits", "fastest hit") if struck else ()))
    return "Links and stops, by the bodies that they join.", head, rows
