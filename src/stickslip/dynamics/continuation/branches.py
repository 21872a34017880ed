"""Branches of periodic orbits: continuation in a parameter, and the special points on the way."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.arguments import Maker, explains_arguments
from stickslip.dynamics.attractors.bifurcation_diagrams import own_attrs, strobe_attrs
from stickslip.dynamics.continuation.branch_following import SIDE_BY_SIDE, STOPPED, follow
from stickslip.dynamics.continuation.cycle_paths import CyclePath, birth, border_of_rest, vanishing
from stickslip.dynamics.continuation.flow_paths import FlowPath
from stickslip.dynamics.continuation.grazing import grazed, grazing_end, grazing_near
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.continuation.point_accuracy import Special, certain
from stickslip.dynamics.continuation.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.special_points import Located, located
from stickslip.dynamics.periodic.limit_cycles import LimitCycle, clock
from stickslip.dynamics.periodic.periodic_orbits import RTOL, PeriodicOrbit, periodic_orbit
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.errors import InputError, Problems, SolveError
from stickslip.faces import Drawn
from stickslip.flow import is_flow
from stickslip.friction.law_adapter import law_of
from stickslip.machine_adapter import machine_of
from stickslip.sealing import sealed

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Branch", "Special", "continuation"]

Array = Any
_AGAIN = 3.0  # accuracies within which two borders are one
_BESIDE = 1e-5  # of the branch's range: where the cycles are that tell where a rest vanishes
_ASIDE = 0.01  # how far from a flip its doubled branch is looked for, in scales


@sealed
@dataclass(frozen=True, eq=False)
class Branch(Drawn):
    """A branch of periodic orbits along a parameter.

    Parameters
    ----------
    family : Family
        The robots.
    period : int
        Drive periods after which its motions repeat.
    orbits : tuple of PeriodicOrbit, or of LimitCycle
        The points, in order.
    values : array
        The parameter at each.
    special : list of Special
        Folds, flips, Neimark-Sacker points, grazings and borders of motion types, in order, each with its accuracy; ``orbit.notes``
        says more.
    ended : str
        Why it ends where it ends.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4e-4, stop=6e-4, tilt_deg=1.7, law="coulomb")
    >>> [(s.kind, round(s.value * 1e3, 5)) for s in b.special]  # I to III at 0.55297 mm
    [('type-border', 0.55297)]
    """

    family: Family
    period: int
    orbits: tuple[PeriodicOrbit | LimitCycle, ...]
    values: Array
    special: list[Special]
    ended: str

    @property
    def parameter(self) -> str:
        """Name of the parameter."""
        return self.family.parameters[0]

    @cached_property
    def points(self) -> xr.Dataset:
        """The branch as an `xarray.Dataset` over ``point``, with the parameter as a coordinate."""
        import xarray as xr

        flow = is_flow(self.orbits[0].model)
        single = not flow and machine_of(self.orbits[0].model).is_single
        coords: dict[str, Any] = {self.parameter: ("point", self.values, self.family.describe(self.parameter))}
        names = self.orbits[0].names
        told_of = {name: own_attrs(name, "on the strobe") if flow else {} if single else strobe_attrs(name) for name in names}
        columns: dict[str, Any] = {name: ("point", [o.state[i] for o in self.orbits], told_of[name]) for i, name in enumerate(names)}
        known = [name for name in _COLUMNS if (single or flow or name not in _OF_ONE) and hasattr(self.orbits[0], name)]
        columns |= {
            name: ("point", [getattr(o, name) for o in self.orbits], _TOLD.get(name, {})) for name in known if not flow or name != "pattern"
        }
        if flow:
            columns["pattern"] = ("point", [" ".join(map(str, o.pattern)) for o in self.orbits])
        elif single:
            columns["motion_type"] = ("point", [o.type for o in self.orbits])
        else:
            driven: Any = self.orbits  # nothing of several contacts goes without a drive
            coords["contact"] = list(driven[0].patterns)
            columns["patterns"] = (("point", "contact"), [list(o.patterns.values()) for o in driven])
        columns["largest_multiplier"] = ("point", [float(abs(o.multipliers).max()) for o in self.orbits], {"units": "1"})
        multipliers = np.array([np.asarray(o.multipliers, complex) for o in self.orbits])
        columns["multiplier_real"] = (("point", "multiplier"), multipliers.real, {"units": "1"})
        columns["multiplier_imag"] = (("point", "multiplier"), multipliers.imag, {"units": "1"})
        told = [{"kind": s.kind, "value": s.value, "accuracy": s.accuracy, "notes": list(s.orbit.notes)} for s in self.special]
        attrs = {"parameter": self.parameter, "period": self.period, "ended": self.ended, "special": json.dumps(told)}
        return xr.Dataset(columns, coords, attrs)

    @explains_arguments
    def at(self, value: float) -> PeriodicOrbit:
        """The orbit of this branch at a value of the parameter, by Newton's method from its nearest point."""
        nearest = int(np.argmin(abs(self.values - value)))
        return periodic_orbit(self.family.robot(value), self.period, guess=self.orbits[nearest], rtol=self.orbits[nearest].rtol)

    @explains_arguments
    def doubled(self, flip: Special | None = None, stop: float | None = None, step: float = 0.02, points: int = 200) -> Branch:
        """The branch of twice the period that leaves this one at a flip.

        Parameters
        ----------
        flip : Special, optional
            Which; the first if not given.
        stop : float, optional
            Where to end; the ends of this branch if not given.
        step, points
            As for `continuation`.
        """
        if isinstance(self.orbits[0], LimitCycle):
            why = "it is a branch of limit cycles; allowed are branches of driven motions"
            raise InputError("Branch.doubled", [f"{why}; type ss.periodic_orbit(mechanism, period=2, guess=run) beside the flip"])
        flips = [s for s in self.special if s.kind == "flip"]
        flip = flip or (flips[0] if flips else None)
        if flip is None or flip.kind != "flip":
            raise InputError("Branch.doubled", ["there is no flip on this branch; allowed is one of branch.special whose kind is 'flip'"])
        ends = (float(np.min(self.values)), float(np.max(self.values)))
        low, high = ends if stop is None else (min(stop, flip.value), max(stop, flip.value))
        return _doubled(self, flip, low, high, step, points)

    _drawn_by = "continuation"

    def _title(self) -> str:
        return f"Branch of period {self.period}: {self.parameter} from {self.values[0]:.6g} to {self.values[-1]:.6g}"

    def _facts(self) -> dict[str, Any]:
        stable = sum(orbit.stable for orbit in self.orbits)
        return {"orbits": f"{len(self.orbits)}, {stable} of them stable", "ended": self.ended}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [[("special point", self.parameter), *((s.kind, s.told) for s in self.special)]] if self.special else []

    def __repr__(self) -> str:
        told = "; ".join(f"{s.kind} at {s.told}" for s in self.special) or "no special point"
        return (
            f"<Branch: period {self.period}, {len(self.orbits)} points, "
            f"{self.parameter} from {self.values[0]:.6g} to {self.values[-1]:.6g}; {told}; {self.ended}>"
        )


_OF_ONE = ("pattern", "margin")  # known of one body on one contact
_COLUMNS = ("mean_velocity", "stable", "pattern", "margin", "residual", "duration")
_TOLD = {
    "duration": {"units": "s", "long_name": "duration of the cycle"},
    "mean_velocity": {"units": "m/s", "long_name": "mean velocity"},
    "residual": {"units": "1", "long_name": "miss of the strobe point"},
}


@explains_arguments
def continuation(
    make: Maker,
    *,
    parameter: str,
    start: float,
    stop: float,
    period: int = 1,
    guess: Any = None,
    step: float = 0.02,
    points: int = 400,
    rtol: float = RTOL,
    **fixed: Any,
) -> Branch:
    """A branch of periodic orbits, followed in a parameter through folds and flips, stable or not.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, such as a preset; or a robot, whose numbers then have dotted names
        (``parameter="drive.amplitude"``).
    parameter : str
        The keyword that varies.
    start, stop : float
        First and last value of the parameter.
    period : int
        Drive periods after which the motions repeat.
    guess : optional
        As for `periodic_orbit`, at `start`.
    step : float
        First step, in the scaled space of state and parameter where start to stop is 1; it is adapted.
    points : int
        Most points.
    rtol : float
        Tolerance of the strobe map for dynamic laws.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    Branch
        `points` (labelled Dataset), `special` (list of kind, value, orbit), `ended`.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.05, stop=0.044, amplitude=6e-4, tilt_deg=1.7)
    >>> [(s.kind, round(s.value, 4)) for s in b.special if s.kind == "flip"]
    [('flip', 0.0468)]
    """
    robots = family("continuation", make, (parameter,), fixed)
    _check(start, stop, step, points)
    first = periodic_orbit(robots.robot(start), period, guess, rtol=rtol)
    same = (robots, period, coordinates(first.model), float(start), abs(float(stop) - float(start)), rtol, 1e-12)
    if is_flow(first.model):
        path: Path = FlowPath(*same)
    else:
        path = CyclePath(*same, clock(first.model)) if isinstance(first, LimitCycle) else Path(*same)
    found = path.at_value(path.scaled(first, start), start, path.remembered(first))
    if not found.good:
        raise SolveError(
            f"the motion at {parameter} = {start:.9g} could not be kept fixed while following it: {found.why}; try another start"
        )
    towards = np.eye(len(found.at))[-1] * np.sign(stop - start)
    begun = path.point(found, towards)
    if not begun.alone:
        raise SolveError(f"at {parameter} = {start:.9g} {SIDE_BY_SIDE}; give the machine what tells them apart, such as damping")
    return _followed(path, begun, min(start, stop), max(start, stop), step, points)


def _check(start: Any, stop: Any, step: Any, points: Any) -> None:
    problems = Problems("continuation")
    for name, value in (("start", start), ("stop", stop), ("step", step)):
        if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not abs(float(value)) < 1e100:
            problems.add(f"{name} = {value!r}; allowed is a finite number, below 1e100 in size")
    problems.check()
    if start == stop:
        problems.add(f"start and stop are both {start!r}; allowed are two different values of the parameter")
    if not step > 0:
        problems.add(f"step = {step!r}; allowed is a positive number; type step=0.02")
    problems.whole("points", points, 2, example=400)
    problems.check()


def _followed(path: Path, first: Point, low: float, high: float, step: float, most: int) -> Branch:
    """The branch from its first point until it leaves the range, with what lies between the points."""
    slack = 1e-12 * (high - low)
    found, ended = [first], ""
    special: list[Special] = []
    for item in follow(path, first, step, most, lambda value: low - slack <= value <= high + slack):
        if isinstance(item, str):
            ended = item
            break
        last = found[-1]
        if path.period % 2 == 0 and not isinstance(path, CyclePath) and item.half * last.half < 0:
            end = _returned(path, last, item)
            found += [end] if end is not None else []
            ended = f"it returned to a motion of half the period at {path.family.parameters[0]} = {found[-1].value:.9g}"
            break
        born = birth(path, found, item) if isinstance(path, CyclePath) else None
        if born is not None:
            ended = f"the cycle shrinks to a steady motion at {path.family.parameters[0]} = {certain(*born)}"
            special.append(Special("hopf", born[0], replace(last.orbit, notes=(ended,)), born[1]))
            break
        if not low <= item.value <= high:
            item = _clipped(path, last, item, low if item.value < low else high)
        for s in located(path, last, item):
            there = _special(path, found, item, s)
            special += [] if isinstance(path, CyclePath) and _known(special, there) else [there]
        found.append(item)
    if ended.startswith(STOPPED):
        ended, border = _ended(path, found, ended)
        special += [] if border is None or _known(special, border) else [border]
    return Branch(path.family, path.period, tuple(p.orbit for p in found), np.array([p.value for p in found]), special, ended)


def _ended(path: Path, found: list[Point], why: str) -> tuple[str, Special | None]:
    """Why the motions of a branch end where no further point was found, and the special point there; what was told if neither is known."""
    name, last = path.family.parameters[0], found[-1]
    critical = vanishing(path, found)
    if critical is not None:
        told = f"the rest of the cycle vanishes at {name} = {certain(*critical)}, and no such cycle exists beyond"
        note = f"{told}; the cycle shown is at {name} = {last.value:.9g}"
        return told, Special("type-border", critical[0], replace(last.orbit, notes=(note,)), critical[1])
    end = grazing_end(path, last)
    what = end[0] if end else grazed(last.orbit)
    if not what:
        return why, None
    told = f"{what} is grazed at {name} = {certain(*end[1:]) if end else f'{last.value:.9g}'}"
    why = f"{told}, where hits begin or end, and how this motion goes on was not found: it may jump to another one; "
    return f"{why}ss.solve from its state shows to which", Special(
        "grazing", end[1], replace(last.orbit, notes=(told,)), end[2]
    ) if end else None


def _known(special: list[Special], seen: Special) -> bool:
    """Whether a border was found already: the branch has a corner where a cycle loses its rest, and may pass it and come back."""
    return any(s.kind == seen.kind and abs(s.value - seen.value) <= _AGAIN * (s.accuracy + seen.accuracy) for s in special)


def _special(path: Path, found: list[Point], b: Point, s: Located) -> Special:
    """A special point between the last point and another, as well as it is known from the motions beside it."""
    known: tuple[float, float] | None = None
    if s.kind == "type-border" and isinstance(path, CyclePath) and not law_of(s.point.orbit.model).dynamic:
        known = _rest_begins(path, found, b, s)
    elif s.kind == "grazing":
        known = _touch_begins(path, found[-1], b, s)
    value, accuracy = known or (s.point.value, s.accuracy)
    return Special(s.kind, value, replace(s.point.orbit, notes=s.notes), accuracy)


def _rest_begins(path: CyclePath, found: list[Point], b: Point, s: Located) -> tuple[float, float] | None:
    """Where a cycle loses its rest is better known from cycles that have some."""
    resting = [p for p in (found[-1], b) if "0" in p.orbit.pattern]
    spread = max(_BESIDE * path.span, 10 * s.accuracy)
    known = border_of_rest(path, resting[0], s.point.value, spread) if len(resting) == 1 else None
    return known or (vanishing(path, found) if resting == [found[-1]] else None)


def _touch_begins(path: Path, a: Point, b: Point, s: Located) -> tuple[float, float] | None:
    """Where a stop or a guard is grazed is better known from motions that miss it, on one side or the other."""
    for point, ahead in ((a, s.point.value - a.value), (b, s.point.value - b.value)):
        known = grazing_near(path, point, s.point.value, float(np.sign(ahead)), s.accuracy) if ahead else None
        if known and known[2] < s.accuracy:
            return known[1:]
    return None


def _returned(path: Path, a: Point, b: Point) -> Point | None:
    """Where a doubled motion falls together with its halves: there the motion of half the period has a multiplier of -1."""
    from scipy.optimize import brentq

    shorter, part = replace(path, period=path.period // 2), a.half / (a.half - b.half)
    near = a.u + part * (b.u - a.u)
    kept: dict[float, Point] = {}

    def flip(value: float) -> float:
        found = shorter.at_value(near, value, path.remembered(a.orbit))
        if not found.good:
            return float("nan")
        kept[value] = shorter.point(found, a.tangent)
        return kept[value].flip

    middle = float(path.value(near))
    for width in (1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
        low, high = middle - width * path.span, middle + width * path.span
        if flip(low) * flip(high) < 0:
            where = brentq(flip, low, high, xtol=1e-14 * path.span, rtol=1e-14)
            last = kept.get(where) or min(kept.values(), key=lambda p: abs(p.flip))
            return replace(last, orbit=replace(last.orbit, period=path.period))
    return None


def _clipped(path: Path, last: Point, beyond: Point, end: float) -> Point:
    """The point of the branch at the end of the range."""
    part = (end - last.value) / (beyond.value - last.value) if beyond.value != last.value else 1.0
    found = path.at_value(last.u + part * (beyond.u - last.u), end, path.remembered(last.orbit))
    return path.point(found, last.tangent) if found.good else beyond


def _doubled(branch: Branch, flip: Special, low: float, high: float, step: float, points: int) -> Branch:
    orbit = flip.orbit
    at = coordinates(orbit.model)
    kind = FlowPath if is_flow(orbit.model) else Path
    path = kind(branch.family, 2 * branch.period, at, flip.value, max(high - low, 1e-300), orbit.rtol, 1e-12)
    values, vectors = np.linalg.eig(orbit.monodromy / path.scales[:, None] * path.scales)
    aside = vectors[:, int(np.argmin(abs(values + 1)))].real
    direction = np.append(aside / np.linalg.norm(aside), 0.0)
    origin = path.scaled(orbit, flip.value)
    for distance in (_ASIDE, _ASIDE / 4, _ASIDE / 16, _ASIDE / 64):
        found = path.corrected(origin + distance * direction, direction, path.remembered(orbit))
        if found.good and np.linalg.norm(found.at - origin) < 4 * distance:
            first = path.point(found, direction)
            return _followed(path, first, low, high, min(step, distance), points)
    raise SolveError(f"no motion of period {2 * branch.period} was found beside the flip at {branch.parameter} = {flip.told}: {found.why}")
