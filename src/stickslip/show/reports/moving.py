"""The animation of a run as plain numbers: positions and sizes of bodies, their motion, and the modes of contacts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Array, Model
from stickslip.models.angular_coordinates import angles_of, unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.show.reports.plane import plane_of
from stickslip.show.reports.servo_traces import targets_at, traces, turns

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_MOMENTS = 480  # frames of the animation
_LONGEST = 4  # largest number of drive periods shown
_DIGITS = 6


def moments(run: Trajectory, span: tuple[float, float] | None = None) -> dict[str, Any]:
    """All moving parts over the last motion period, or over the whole run of an autonomous system.

    Parameters
    ----------
    run : Trajectory
    span : (float, float), optional
        Start and end [s].

    Returns
    -------
    dict
        t from the start of the span in `unit` (ms, or s without a drive); bodies with name, mass [kg], place (position on the track from
        left to right, level above it), displacement x [mm] and velocity v [mm/s] (None for an inner mass), and lift, the height of the
        body above its track [mm] (None if it cannot leave it); rows with the name of a contact or stop, its stretches (from, to, sign;
        sign 2 is a stop in contact, 3 flight) and hits, or landings; links, pairs of bodies with a flag for elastic ones; lengths and
        speeds, the units of x and v. A machine that turns about an axis has x as an angle [rad] and v in rad/s, the
        angles that its controllers want by body (targets), and traces with name, unit and curves: angle, error, torque. Of bodies in the
        plane also `plane` (`stickslip.show.reports.plane`), else None.
    """
    import numpy as np

    start, end = shown_span(run) if span is None else span
    factor, unit = (1e3, "ms") if run.model.period is not None else (1.0, "s")
    at = run.with_axes.at(np.linspace(start, end, _MOMENTS))
    lifts, milli = _lifts(run, at), 1.0 if angles_of(run.model) else 1e3
    return {
        "t": _plain(factor * (at["t"] - start)),
        "unit": unit,
        "lengths": _units(run, "x"),
        "speeds": _units(run, "v"),
        "turns": turns(run),
        "targets": {name: _plain(x) for name, x in targets_at(run, at["t"]).items()} if turns(run) else {},
        "traces": [trace | {"curves": [[name, _plain(y)] for name, y in trace["curves"]]} for trace in traces(run, at["t"])],
        "bodies": [_body(part, x, v, at, turns(run), milli) | {"lift": lifts.get(part["name"])} for part, x, v in _columns(run, at)],
        "rows": _rows(run, start, end, factor),
        "links": _links(run.model),
        "plane": plane_of(run, at),
    }


def shown_span(run: Trajectory) -> tuple[float, float]:
    """The last motion period of a run, or its last drive periods if it does not repeat soon; the whole run without a drive."""
    from stickslip.analysis.steady import period_number

    if run.model.period is None or not len(run.strobe_times) > 1:
        return float(run.pieces.t[0]), float(run.pieces.t[-1])
    count = min(period_number(run) or _LONGEST, _LONGEST, len(run.strobe_times) - 1)
    end = float(run.strobe_times[-1])
    return end - count * run.period_time, end


def _plain(values: Any) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in values]


# ---- bodies ----
def stage(model: Model) -> list[dict[str, Any]]:
    """Name, mass [kg] and place of each body: (position on the track from left to right, level above it).

    Bodies in contact with the track stand on it, ordered by initial position, the head in front; others are placed above the body to
    which they are linked or on which they slide.

    Examples
    --------
    >>> import stickslip as ss
    >>> [(body["name"], body["place"]) for body in stage(ss.Chain.example())]
    [('module 1', [1, 0]), ('module 2', [0, 0])]
    """
    machine = machine_of(model)
    mechanics: Any = machine.mechanics
    if not machine.names_parts:
        masses = [float(mass) for mass, _ in machine.inner_masses]
        bodies = [{"name": "body", "mass": float(mechanics.masses[0]) - sum(masses), "place": [0, 0]}]
        names = ["inner mass"] if len(masses) == 1 else [f"inner mass {j + 1}" for j in range(len(masses))]
        return bodies + [
            {"name": name, "mass": mass, "place": [0, j + 1]} for j, (name, mass) in enumerate(zip(names, masses, strict=True))
        ]
    under = _standing_on(mechanics)
    order = sorted((name for name in mechanics.bodies if under[name] is None), key=lambda n: _start(mechanics, n))
    storeys: dict[str, int] = {}
    stage_bodies = []
    for name in mechanics.bodies:
        base = under[name] or name
        storeys[base] = storeys.get(base, 0) + (base != name)
        position = [order.index(base), storeys[base] if base != name else 0]
        stage_bodies.append({"name": name, "mass": float(mechanics.parts[name].mass), "place": position})
    return stage_bodies


def _start(mechanics: Any, name: str) -> tuple[float, int]:
    """Sort key of a body: its initial position; of several at one position the first is in front."""
    return float(mechanics.parts[name].position), -mechanics.bodies.index(name)


def _standing_on(mechanics: Any) -> dict[str, str | None]:
    """For each body, the one on the track above which it is drawn; None for those on the track."""
    on_track = {name for c in mechanics.joints.values() if not isinstance(c.on, str) for name in c.coefficients} or set(mechanics.bodies)
    joined = [ends for ends, _ in [*mechanics.elastic, *mechanics.prescribed]] + [stop.ends for stop in mechanics.stops]
    joined += [(c.body, c.on) for c in mechanics.joints.values() if isinstance(c.on, str)]
    bases: dict[str, str | None] = dict.fromkeys(on_track)
    for _ in mechanics.bodies:
        for a, b in joined:
            for upper, lower in ((a, b), (b, a)):
                if upper is not None and upper not in bases and lower in bases:
                    bases[upper] = bases[lower] or lower
    return {name: bases.get(name) for name in mechanics.bodies}


def _columns(run: Trajectory, at: dict[str, Any]) -> Iterator[tuple[dict[str, Any], Any, Any]]:
    """Each body with its position and velocity; for a robot also its inner masses, without velocities."""
    parts = stage(run.model)
    for i, part in enumerate(parts[: len(run.body_columns)]):
        yield part, at["x"][:, i], at["v"][:, i]
    for part, (_, drive) in zip(parts[len(run.body_columns) :], machine_of(run.model).inner_masses, strict=True):
        yield part, at["x"][:, 0] + drive.position(at["t"]), None


def _units(run: Trajectory, column: str) -> str:
    """Units of positions or velocities: milli-, but where something turns; of lengths beside angles both."""
    units = sorted({unit_of_part(column, run.model, part) for part in run.body_columns})
    return ", ".join(units) if turns(run) or angles_of(run.model) else f"m{units[0]}"


def _body(part: dict[str, Any], x: Array, v: Any, at: dict[str, Any], is_angle: bool, factor: float) -> dict[str, Any]:
    if is_angle:
        return {**part, "x": _plain(x), "v": _plain(v)}
    first = at["x"][0, 0] if v is None else x[0]
    return {**part, "x": _plain(factor * (x - first)), "v": None if v is None else _plain(factor * v)}


def _lifts(run: Trajectory, at: dict[str, Any]) -> dict[str, list[float]]:
    """Height of each body that can leave its track above it [mm]."""
    from stickslip.analysis.moving_tracks import gaps

    mechanics: Any = machine_of(run.model).mechanics
    return {mechanics.joints[name].body: _plain(1e3 * gap) for name, gap in gaps(run, at).items()}


def _links(model: Model) -> list[list[int]]:
    """Pairs of linked bodies by index, with 1 for elastic links and 0 for others; the ground is -1."""
    mechanics: Any = machine_of(model).mechanics
    number = {None: -1, **{name: i for i, name in enumerate(mechanics.bodies)}}
    joined = [(ends, 1) for ends, _ in mechanics.elastic] + [(ends, 0) for ends, _ in mechanics.prescribed]
    return [[number[a], number[b], gives] for (a, b), gives in joined if (a, b) in mechanics.model.links()]


# ---- contacts ----
def _rows(run: Trajectory, start: float, end: float, factor: float) -> list[dict[str, Any]]:
    """A row for each contact, and one for each stop."""
    from stickslip.analysis.contact_modes import contact_modes, landings, stop_rows

    modes, landed = contact_modes(run, start, end), landings(run, start, end)
    rows: dict[str, tuple[list[Any], list[float]]] = {name: (of, landed.get(name, [])) for name, of in modes.items()}
    rows |= stop_rows(run, start, end)
    return [
        {
            "name": name,
            "stretches": [[*_plain((factor * (a - start), factor * (b - start))), sign] for a, b, sign in stretches],
            "hits": _plain(factor * (t - start) for t in struck),
        }
        for name, (stretches, struck) in rows.items()
    ]
