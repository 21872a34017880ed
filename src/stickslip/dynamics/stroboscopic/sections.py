"""Sections of a run and its spectrum: strobe points at a phase, Poincaré points on v = 0, lines at the drive's harmonics."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.motion import motion
from stickslip.analysis.steady import is_run, period_number
from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_whole
from stickslip.basics.variables import VARIABLES, unit_of
from stickslip.results.steadiness import way_of_machine

if TYPE_CHECKING:
    import xarray as xr

    from stickslip.results.trajectory import Trajectory

_WAY = "displacement of the centre of mass since the previous point"
_OF_BODIES, _OF_CONTACTS = ("x", "v", "acceleration"), ("mode", "slip", "load", "friction_force")


@explains_arguments
def strobe(run: Trajectory, phase: float = 0.0, settle: int | None = None) -> xr.Dataset:
    """The states of a run at a given phase of every drive period.

    Parameters
    ----------
    run : Trajectory
    phase : float
        In drive periods, from 0 to 1.
    settle : int, optional
        Drive periods to leave out; those of the run if not given.

    Returns
    -------
    xarray.Dataset
        Over ``point``: time [s], v [m/s], z, and the displacement since the point before [m] (the position itself drifts). For a machine of
        several bodies v also has the dimension ``body`` and z ``contact``, and the displacement is that of the centre of mass. Of a
        flow time, its states by their names and mode.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.04), periods=100)
    >>> (strobe(run, phase=0.25).v[-2:] * 1e3).round(3).values.tolist()
    [11.296, 12.645]
    """
    is_run("strobe", run, bodies=False)
    if run.model.period is None:
        section = "v" if run.pieces.layout.own else _columns(run)[0]
        why = f"{type(run.model).__name__} has no period, and so no phase at which it could be looked at"
        raise InputError("strobe", [f"{why}; type ss.dynamics.poincare(run, on={section!r}) for its states on a section"])
    problems = Problems("strobe")
    if not (isinstance(phase, Real) and 0 <= phase <= 1):
        problems.add(f"phase = {phase!r}; allowed is 0 to 1, in drive periods; type phase=0.25")
    _check_settle(problems, run, settle)
    problems.check()
    first = run.settle if settle is None else settle
    t = run.strobe_times[:-1][first:] + phase * run.period_time
    return _dataset(run, np.minimum(t, run.strobe_times[-1]))


@explains_arguments
def poincare(run: Trajectory, on: str = "v", value: float = 0.0, direction: int = 0, settle: int | None = None) -> xr.Dataset:
    """The states of a run at which a column passes a value, such as v = 0.

    Parameters
    ----------
    run : Trajectory
    on : str
        The column: "v", "z", "acceleration" or any other that `Trajectory.at` gives; for a machine of several bodies with the name of the
        body or contact: "v.head", "slip.tail", "z.tail.0".
    value : float
        The value that is passed.
    direction : int
        +1 only where it rises, -1 only where it falls, 0 both. A body that comes to rest passes v = 0 when it starts again.
    settle : int, optional
        Drive periods to leave out; those of the run if not given. A model without a period has none, and all of its run is looked at.

    Returns
    -------
    xarray.Dataset
        As from `strobe`, and the phase of the drive where there is one.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=100)
    >>> poincare(run, direction=1).phase[-2:].round(6).values.tolist()  # it starts forwards at one phase
    [0.100694, 0.100694]
    """
    is_run("poincare", run, bodies=False)
    problems = Problems("poincare")
    _check_column(problems, run, "on", on)
    if not (isinstance(value, Real) and np.isfinite(value)):
        problems.add(f"value = {value!r}; allowed is a finite number; type for example value=0.0")
    if direction not in (-1, 0, 1):
        problems.add(f"direction = {direction!r}; allowed is -1, 0 or 1")
    _check_settle(problems, run, settle)
    problems.check()
    begin = float(run.pieces.t[0]) if run.model.period is None else (run.settle if settle is None else settle) * run.period_time
    t = run.t[run.t >= begin]
    t = np.unique(t)
    level = read(run, on, t) - value
    rising, falling = (level[:-1] <= 0) & (level[1:] > 0), (level[:-1] >= 0) & (level[1:] < 0)
    where = np.flatnonzero({1: rising, -1: falling, 0: rising | falling}[direction])
    return _dataset(run, halved(run, on, value, t[where], t[where + 1], np.where(rising[where], 1.0, -1.0)))


def _check_column(problems: Problems, run: Trajectory, name: str, column: Any) -> None:
    columns = _columns(run)
    if column not in columns:
        problems.add(f"{name} = {column!r} is not a column with one number at each instant; {did_you_mean(str(column), columns)}")


def _check_settle(problems: Problems, run: Trajectory, settle: Any) -> None:
    if run.model.period is None:
        if settle is not None:
            problems.add(f"settle = {settle!r} is a number of drive periods, and this run has none; leave it out")
        return
    periods = len(run.strobe_times) - 1
    if settle is not None and (not is_whole(settle) or not 0 <= settle < max(periods, 1)):
        allowed = f"a whole number from 0 below the {periods} drive periods of the run, or None"
        problems.add(f"settle = {settle!r}; allowed is {allowed}; type for example settle={periods // 2}")


def _columns(run: Trajectory) -> list[str]:
    """Names of the columns with one number at each instant; of several bodies and contacts with theirs."""
    columns = {n: values for n, values in run.at(run.pieces.t[:1]).items() if n != "t" and values is not None}
    if not run.pieces.layout.bodies:
        return [n for n in columns if n != "mode"]
    flat = [n for n, values in columns.items() if np.ndim(values) == 1] if run.pieces.layout.own else []
    if run.pieces.layout.single:
        return flat
    named = [*flat, *(f"{n}.{body}" for n in _OF_BODIES if n in columns for body in run.body_columns)]
    named += [f"{n}.{contact}" for n in _OF_CONTACTS if n in columns for contact in run.contacts]
    return named + [f"z.{c.name}.{k}" for c in run.pieces.layout.contacts for k in range(len(c.inner))]


def _states(run: Any) -> tuple[str, ...]:
    """The names of the states of a flow."""
    return tuple(run.names)


def read(run: Trajectory, column: str, t: Array) -> Array:
    """One column at some times: array (time,)."""
    kind, _, part = column.partition(".")
    if not part or not run.pieces.layout.bodies:
        return run.at(t)[column]
    values = run.with_axes.at(t)[kind]
    if kind == "z":
        part, _, state = part.rpartition(".")
        values = values[..., int(state)]
    return values[:, list(run.body_columns if kind in _OF_BODIES else run.contacts).index(part)]


def halved(run: Trajectory, on: str, value: float, low: Array, high: Array, sign: Array) -> Array:
    """The instants between low and high at which the column leaves the value, to the last bit."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        beyond = sign * (read(run, on, middle) - value) > 0 if len(middle) else np.zeros(0, bool)
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high


def _dataset(run: Trajectory, t: Array) -> Any:
    """The states at some times; of several bodies and contacts with theirs."""
    import xarray as xr

    phase = {}
    if run.model.period is not None:
        phase["phase"] = ("point", np.mod(t / run.period_time, 1.0), {"units": "1", "long_name": "phase of the drive"})
    if not run.pieces.layout.bodies:
        columns_at = run.at(t)
        states = {name: ("point", columns_at[name]) for name in _states(run)}
        modes = np.array([str(mode) for mode in np.atleast_1d(columns_at["mode"])]) if len(t) else np.empty(0, str)
        return xr.Dataset({"time": ("point", t), **states, "mode": ("point", modes), **phase})
    parts = {} if run.pieces.layout.own else {"body": list(run.body_columns), "contact": list(run.contacts)}
    if parts:
        x, v, z = run._states_at(t, run._index(t))
        way, since = way_of_machine(run.model, x), _WAY
    else:
        columns_at = run.at(t) if len(t) else {"x": t, "v": t, "z": None}
        way, v, z, since = columns_at["x"], columns_at["v"], columns_at["z"], "displacement since the previous point"
    columns: dict[str, Any] = {
        "time": ("point", t, {"units": "s"}),
        "v": (("point", *list(parts)[:1]), v, {"units": "m/s", "long_name": "velocity"}),
        "displacement": ("point", np.diff(way, prepend=np.nan), {"units": "m", "long_name": since}),
        **phase,
    }
    if z is not None and z.shape[-1]:
        columns["z"] = (("point", *list(parts)[1:], "inner_state")[: z.ndim], z, {"long_name": "inner state"})
    return xr.Dataset(columns, parts)


@explains_arguments
def spectrum(
    run: Trajectory,
    column: str | None = None,
    harmonics: int = 40,
    periods: int | None = None,
    body: int | str | None = None,
    contact: int | str | None = None,
) -> xr.Dataset:
    """The line spectrum of a steady motion: amplitude and phase at harmonics and, for longer motion periods, subharmonics of the drive.

    A model without a period has the harmonics of the cycle that its run ends in (`ss.motion`).

    The window covers complete motion periods without a taper, so a periodic motion gives exact lines without leakage. If no period is
    found, a Hann window is applied to the last `periods` drive periods.

    Parameters
    ----------
    run : Trajectory
    column : str
        Which column of the run: "v", "x", "friction_force", ...; of a flow a state, or a force as "friction_force_belt". If not given,
        "v", and the first state of a flow.
    harmonics : int
        Highest multiple of the drive frequency, or of that of the cycle.
    periods : int, optional
        Drive periods of the window; by default one motion period, or the settled part of a motion that does not repeat.
    body, contact : int or str, optional
        For a machine of several, the number (from 0) or name of the body or contact; all of them if not given.

    Returns
    -------
    xarray.Dataset
        Over ``order`` (frequency over the drive's, or the cycle's): amplitude, phase [rad], frequency [Hz], and `harmonic` (whether
        order is whole). For all bodies or contacts of a machine, amplitude and phase also have the dimension "body" or "contact".

    Examples
    --------
    >>> import stickslip as ss
    >>> lines = spectrum(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.04), periods=100))
    >>> lines.order[:3].values.tolist(), (lines.amplitude[:3] * 1e3).round(2).values.tolist()  # period two: lines at halves
    ([0.0, 0.5, 1.0], [11.75, 0.86, 15.04])
    """
    import xarray as xr

    is_run("spectrum", run, bodies=False)
    problems, base = Problems("spectrum"), _base(run)
    most, column = base.most, ("v" if run.pieces.layout.bodies else _states(run)[0]) if column is None else column
    dim, names, asked = _asked(run, column, {"body": body, "contact": contact}, problems)
    problems.whole("harmonics", harmonics, 1, example=40)
    if periods is not None and run.model.period is None:
        problems.add(f"periods = {periods!r}, and this run has no drive periods; leave it out: the window is one cycle")
    elif periods is not None and (not is_whole(periods) or not 1 <= periods <= most):
        problems.add(f"periods = {periods!r}; allowed is a whole number from 1 to the {most} drive periods of the run, or None")
    problems.check()
    repeat, end, T = base.repeat, base.end, base.period
    count = periods or repeat or max(most - run.settle, 1)
    per = max(64 * harmonics, 1024)
    t = end - count * T + (np.arange(count * per) + 0.5) * (T / per)
    signal = np.array([read(run, each, np.clip(t, 0.0, end)) for each in asked], float)
    taper = np.ones(len(t)) if repeat and count % repeat == 0 else np.hanning(len(t))
    lines = np.fft.rfft(signal * taper)[..., : harmonics * count + 1] / taper.sum()
    order = np.arange(lines.shape[-1]) / count
    amplitude = np.where(order > 0, 2.0, 1.0) * abs(lines)
    dims = (dim, "order") if names else ("order",)
    lines, amplitude = (lines, amplitude) if names else (lines[0], amplitude[0])
    unit = unit_of(column, run.model) if column in VARIABLES else "1"
    columns = {
        "amplitude": (dims, amplitude, {"long_name": f"amplitude of {column}", "units": unit}),
        "phase": (dims, np.angle(lines * np.exp(-1j * np.pi * order / per)), {"units": "rad"}),
        "frequency": ("order", order / T, {"units": "Hz"}),
        "harmonic": ("order", np.arange(len(order)) % count == 0),
    }
    attrs = {"column": column, "of": base.of, "period": repeat or 0, "window": "none" if taper[0] == 1 else "Hann", "periods": count}
    axis = ("order", order, {"long_name": f"frequency over the {base.of}'s", "units": "1"})
    return xr.Dataset(columns, {"order": axis, **({dim: names} if names else {})}, attrs)


@dataclass(frozen=True)
class _Base:
    """What a spectrum is taken of: the length of the period, how many periods there are, after how many it repeats, and the end."""

    period: float
    most: int
    repeat: int | None
    end: float
    of: str = "drive"


def _base(run: Trajectory) -> _Base:
    """Drive periods, or, without a drive, the cycle that the run ends in; `InputError` where it does not repeat."""
    if run.model.period is not None:
        repeat = period_number(run) if run.pieces.layout.bodies else motion(run).period
        return _Base(run.period_time, len(run.strobe_times) - 1, repeat, float(run.strobe_times[-1]))
    cycle: Any = motion(run)
    if cycle.period is None:
        does = "is steady" if cycle.settled else "does not repeat within the run"
        why = f"{type(run.model).__name__} has no period, and its motion {does}, so it has no lines"
        raise InputError("spectrum", [f"{why}; type ss.solve(..., duration=...) with a longer one, and ss.motion(run) for what it does"])
    return _Base(cycle.duration, 1, 1, float(run.pieces.t[-1]), "cycle")


def _asked(run: Trajectory, column: str, parts: dict[str, Any], problems: Problems) -> tuple[str, list[str], list[str]]:
    """The dimension of the bodies or contacts that are asked for, their names if there are several, and the columns to read."""
    if not run.pieces.layout.bodies:
        for name, part in parts.items():
            if part is not None:
                known = ", ".join(c for c in _columns(run) if c not in _states(run)) or "none, as there are no contacts"
                problems.add(f"{name} = {part!r}, and a flow's columns have no axes; leave it out: the columns of contacts are {known}")
        _check_column(problems, run, "column", column)
        return "", [], [column]
    dim = "body" if column in _OF_BODIES else "contact"
    own = list(run.body_columns if dim == "body" else run.contacts)
    others = [name for name, part in parts.items() if part is not None and name != dim]
    layout = run.pieces.layout
    several = not layout.single and (parts[dim] is not None or not layout.own) and column in (*_OF_BODIES, *_OF_CONTACTS)
    if others and column in (*_OF_BODIES, *_OF_CONTACTS):
        problems.add(f"{others[0]} = {parts[others[0]]!r}, but {column} is a column of each {dim}; type {dim}={own[0]!r}")
    number = _number(dim, parts[dim], own, problems) if parts[dim] is not None else None
    if several:
        return dim, own if number is None else [], [f"{column}.{name}" for name in (own if number is None else own[number : number + 1])]
    _check_column(problems, run, "column", column)
    return dim, [], [column]


def _number(dim: str, part: Any, names: list[str], problems: Problems) -> int:
    """The number of a body or contact, by its number or name."""
    if part in names:
        return names.index(part)
    if is_whole(part) and 0 <= part < len(names):
        return int(part)
    problems.add(f"{dim} = {part!r}; allowed are {', '.join(map(repr, names))} or 0 to {len(names) - 1}")
    return 0
