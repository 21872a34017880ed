"""Branches of periodic orbits: continuation in a parameter, and the special points on the way."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.section_choice import asked_for
from stickslip.basics.arguments import Maker, described_as, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.progress import Reported, reporting
from stickslip.dynamics.attractors.bifurcation_diagrams import state_attrs
from stickslip.dynamics.continuation.following.other_branches import across, doubled, range_of, special_point_of
from stickslip.dynamics.continuation.following.path_kinds import path_of
from stickslip.dynamics.continuation.following.steps import SIDE_BY_SIDE
from stickslip.dynamics.continuation.following.traced_branch import BranchTrace, trace_branch
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.continuation.special_points.own_events import Event, checked_events
from stickslip.dynamics.periodic.closed_orbits import RTOL, PeriodicOrbit
from stickslip.dynamics.periodic.limit_cycles import at_its_switch
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.model_adapter import adapter_of
from stickslip.models.naming import in_its_unit

if TYPE_CHECKING:
    import xarray as xr


@described_as("a Branch, as ss.continuation returns")
@sealed
class Branch(Drawn):
    """A branch of periodic orbits along a parameter.

    Parameters
    ----------
    family : Family
        The robots.
    period : int
        Drive periods after which its motions repeat.
    orbits : tuple of PeriodicOrbit
        The points, in order.
    values : array
        The parameter at each.
    special : list of Special
        Folds, flips, Neimark-Sacker points, branch points, grazings, borders of motion types and user-defined events, in order, each with
        its accuracy; ``orbit.notes`` gives details.
    ended : str
        The reason why it ends.
    events : dict
        User-defined events by name: functions of an orbit, whose zeros are special points of that name.
    switch : str, optional
        The switch at which its cycles are shown, such as "stick of block", where that was asked for.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4e-4, stop=6e-4, tilt_deg=1.7, law="coulomb")
    >>> [(s.kind, round(s.value * 1e3, 5)) for s in b.special]  # I to III at 0.55297 mm
    [('type-border', 0.55297)]
    """

    family: Family
    period: int
    orbits: tuple[PeriodicOrbit, ...]
    values: Array
    special: list[Special]
    ended: str
    events: Mapping[str, Event] = field(default_factory=dict)
    switch: str | None = None

    @property
    def parameter(self) -> str:
        """Name of the parameter."""
        return self.family.parameters[0]

    @cached_property
    def points(self) -> xr.Dataset:
        """The branch as an `xarray.Dataset` over ``point``, with the parameter as a coordinate."""
        import xarray as xr

        of, words = adapter_of(self.orbits[0].model), self.orbits[0].words
        coords: dict[str, Any] = {self.parameter: ("point", self.values, self.family.describe(self.parameter))}
        names, when = self.orbits[0].names, "on the strobe" if self.orbits[0].model.period is not None else "at the start of the cycle"
        columns: dict[str, Any] = {
            n: ("point", [o.state[i] for o in self.orbits], state_attrs(n, when, self.orbits[0].model)) for i, n in enumerate(names)
        }
        known = self.orbits[0].numbers
        of_motion = {name: {"units": unit_of_part(what, self.orbits[0].model, "")} for name, what in _OF_MOTION.items() if of.has_units}
        columns |= {name: ("point", [getattr(o, name) for o in self.orbits], _COLUMNS[name] | of_motion.get(name, {})) for name in known}
        for name, said in words.items():
            if isinstance(said, str):
                columns[name] = ("point", [o.words[name] for o in self.orbits])
            else:
                coords["contact"] = list(said)
                columns[name] = (("point", "contact"), [list(o.words[name].values()) for o in self.orbits])
        multipliers = np.array([np.asarray(o.multipliers, complex) for o in self.orbits])
        columns["largest_multiplier"] = ("point", abs(multipliers).max(axis=1), _multiplier("largest size of a multiplier"))
        columns["multiplier_real"] = (("point", "multiplier"), multipliers.real, _multiplier("real part of a multiplier"))
        columns["multiplier_imag"] = (("point", "multiplier"), multipliers.imag, _multiplier("imaginary part of a multiplier"))
        special = [{"kind": s.kind, "value": s.value, "accuracy": s.accuracy, "notes": list(s.orbit.notes)} for s in self.special]
        attrs = {"parameter": self.parameter, "period": self.period, "ended": self.ended, "special": json.dumps(special)}
        return xr.Dataset(columns, coords, attrs)

    @explains_arguments
    def at(self, value: float) -> PeriodicOrbit:
        """The orbit of this branch at a value of the parameter, by Newton's method from its nearest point."""
        nearest = int(np.argmin(abs(self.values - value)))
        near, period = self.orbits[nearest], self.period if self.switch is None else None
        return periodic_orbit(self.family.robot(value), period, guess=near, section=self.switch, rtol=near.rtol)

    @explains_arguments
    @interruptible
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
        if self.orbits[0].is_cycle:
            why = "it is a branch of limit cycles; allowed are branches of driven motions"
            raise InputError("Branch.doubled", [f"{why}; type ss.periodic_orbit(mechanism, period=2, guess=run) beside the flip"])
        flip = special_point_of(self, flip, "flip", "doubled")
        return _branch(self.family, 2 * self.period, doubled(self, flip, *range_of(self, flip, stop), step, points), self.events)

    @explains_arguments
    @interruptible
    def switched(self, special: Special | None = None, stop: float | None = None, step: float = 0.02, points: int = 200) -> Branch:
        """The other branch through a branch point, on both sides of it: one branch, whose points are in order.

        Parameters
        ----------
        special : Special, optional
            Which branch point; the first if not given.
        stop : float, optional
            Where to end; the ends of this branch if not given. A side that lies beyond the range is left out.
        step, points
            As for `continuation`, on each side.

        Returns
        -------
        Branch
            Where a symmetry breaks, its two sides are images of one another.

        Examples
        --------
        A pitchfork, x to (1 + p) x - x^3, whose other branch is p = x^2:

        >>> import stickslip as ss
        >>> pitchfork = ss.SwitchingFlow.of_map(lambda y, n: ((1 + n.p) * y[0] - y[0] ** 3,), {"p": -0.1}, ("x",))
        >>> b = ss.continuation(pitchfork, parameter="p", start=-0.1, stop=0.3, guess={"x": 0.0})
        >>> [(s.kind, s.rounded) for s in b.special]
        [('branch-point', '0')]
        >>> other = b.switched()
        >>> bool(abs(other.values - [orbit.state[0] ** 2 for orbit in other.orbits]).max() < 1e-9)
        True
        """
        special = special_point_of(self, special, "branch-point", "switched")
        return _branch(self.family, self.period, across(self, special, *range_of(self, special, stop), step, points), self.events)

    _drawn_by = "continuation"

    def _title(self) -> str:
        return f"Branch of period {self.period}: {self.parameter} from {self.values[0]:.6g} to {self.values[-1]:.6g}"

    def _facts(self) -> dict[str, Any]:
        stable = sum(orbit.stable for orbit in self.orbits)
        return {"orbits": f"{len(self.orbits)}, {stable} of them stable", "ended": self.ended}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [[("special point", self.parameter), *((s.kind, s.rounded) for s in self.special)]] if self.special else []

    def __repr__(self) -> str:
        special = "; ".join(f"{s.kind} at {s.rounded}" for s in self.special) or "no special point"
        return (
            f"<Branch: period {self.period}, {len(self.orbits)} points, "
            f"{self.parameter} from {self.values[0]:.6g} to {self.values[-1]:.6g}; {special}; {self.ended}>"
        )


_OF_MOTION = {"mean_velocity": "v", "amplitude": "x"}  # whose units are those of the machine's motion
_COLUMNS = {
    "mean_velocity": {"units": "m/s", "long_name": "mean velocity"},
    "stable": {"units": "1", "long_name": "whether the motion is stable"},
    "pattern": {"units": "1", "long_name": "signs of the velocity over one motion period"},
    "margin": {"units": "1", "long_name": "margin of the motion type"},
    "residual": {"units": "1", "long_name": "residual of the strobe point"},
    "amplitude": {"units": "m", "long_name": "amplitude of the cycle"},
    "duration": {"units": "s", "long_name": "duration of the cycle"},
}


@explains_arguments
@interruptible
def continuation(
    make: Maker,
    *,
    parameter: str,
    start: float,
    stop: float,
    period: int | None = None,
    guess: Any = None,
    section: Any = None,
    turns: int | None = None,
    step: float = 0.02,
    points: int = 400,
    rtol: float = RTOL,
    events: Mapping[str, Event] | None = None,
    progress: Reported | bool | None = None,
    **fixed: Any,
) -> Branch:
    """A branch of periodic orbits, continued in a parameter through folds and flips, stable or unstable.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, such as a preset; or a robot, whose numbers then have dotted names
        (``parameter="drive.amplitude"``).
    parameter : str
        The keyword that varies.
    start, stop : float
        First and last value of the parameter; text with a unit, such as "0.4 mm", is allowed.
    period : int, optional
        Drive periods after which the motions repeat, 1 if not given; without a period turns, as many as the run shows.
    guess : optional
        As for `periodic_orbit`, at `start`.
    section, turns : optional
        As for `periodic_orbit`, of models without a period.
    step : float
        First step, in the scaled space of state and parameter where start to stop is 1; it is adapted.
    points : int
        Largest number of points.
    rtol : float
        Tolerance of the strobe map for dynamic laws.
    events : dict, optional
        Functions of an orbit by name. Where one of them is zero along the branch is a special point whose kind is that name, and
        `special_curve` follows it in two parameters: ``events={"slow": lambda orbit: orbit.mean_velocity - 1e-3}``.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (the value reached, points so far, points at most); return False to
        stop.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    Branch
        `points` (labelled Dataset), `special` (list of kind, value, orbit), `ended`.

    Raises
    ------
    InputError
        Of arguments that are not allowed, and of an event that gives no number.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.05, stop=0.044, amplitude=6e-4, tilt_deg=1.7)
    >>> [(s.kind, round(s.value, 4)) for s in b.special if s.kind == "flip"]
    [('flip', 0.0468)]

    Where the robot is as fast as 1 mm/s:

    >>> fast = {"1 mm/s": lambda orbit: orbit.mean_velocity - 1e-3}
    >>> rig = dict(tilt_deg=1.7, law="coulomb")
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4e-4, stop=4.2e-4, events=fast, **rig)
    >>> [(s.kind, round(s.value * 1e3, 6)) for s in b.special]
    [('1 mm/s', 0.411006)]
    """
    robots, own = family("continuation", make, (parameter,), fixed), checked_events("continuation", events)
    start, stop = _check(robots, start, stop, step, points)
    report = reporting(progress, "continuation")
    first = periodic_orbit(robots.robot(start), period, guess, section=section, turns=turns, rtol=rtol)
    branch = _followed(robots, first, start, stop, step, points, own, report)
    asked = asked_for("continuation", section, first.model)
    return _at_switches(branch, str(asked.name)) if asked.switch else branch


def stable_branch(
    make: Maker, parameter: str, start: float, stop: float, *, period: int | None = None, guess: Any = None,
    step: float = 0.02, points: int = 400, rtol: float = RTOL, **fixed: Any,
) -> Branch:  # fmt: skip
    """As `continuation`, to the first point where the stability changes; borders of types, which take most of the time, are left out."""
    robots = family("continuation", make, (parameter,), fixed)
    first = periodic_orbit(robots.robot(start), period, guess, rtol=rtol)
    return _followed(robots, first, start, stop, step, points, while_stable=True)


def _followed(
    robots: Family, first: PeriodicOrbit, start: float, stop: float, step: float, points: int,
    events: Mapping[str, Event] | None = None, report: Reported = lambda *state: None, while_stable: bool = False,
) -> Branch:  # fmt: skip
    """The branch of an orbit at the start of a range."""
    (parameter,) = robots.parameters
    path = path_of(robots, first, float(start), abs(float(stop) - float(start)), first.period)
    root = path.at_value(path.scaled(first, start), start, path.remembered(first))
    if not root.good:
        raise SolveError(
            f"the motion at {parameter} = {start:.9g} could not be kept fixed while following it: {root.why}; try another start"
        )
    towards = np.eye(len(root.at))[-1] * np.sign(stop - start)
    begun = path.point(root, towards)
    if not begun.alone:
        raise SolveError(
            f"at {parameter} = {start:.9g} {SIDE_BY_SIDE}; give the machine a property that distinguishes them, such as damping"
        )
    whole = trace_branch(path, begun, min(start, stop), max(start, stop), step, points, events, report, while_stable)
    report(whole.ended, len(whole.points), len(whole.points))
    return _branch(robots, first.period, whole, events or {})


def _at_switches(branch: Branch, name: str) -> Branch:
    """A branch of cycles as they begin at a switch; a cycle in which it does not happen is as it was, and says so."""

    def shown(cycle: Any) -> Any:
        try:
            return at_its_switch(cycle, name)
        except SolveError as error:
            return replace(cycle, notes=(*cycle.notes, str(error)))

    special = [replace(each, orbit=shown(each.orbit)) for each in branch.special]
    return replace(branch, orbits=tuple(map(shown, branch.orbits)), special=special, switch=name)


def _multiplier(meaning: str) -> dict[str, str]:
    return {"units": "1", "long_name": meaning}


def _branch(family: Family, period: int, followed: BranchTrace, events: Mapping[str, Event]) -> Branch:
    orbits, values = tuple(p.orbit for p in followed.points), np.array([p.value for p in followed.points])
    return Branch(family, period, orbits, values, followed.special, followed.ended, events)


def _check(robots: Family, start: Any, stop: Any, step: Any, points: Any) -> tuple[float, float]:
    """First and last value as numbers; what is wrong with them is an error."""
    problems = Problems("continuation")
    ends = {"start": start, "stop": stop}
    start, stop = (in_its_unit(robots.parameters[0], value, robots.make, problems, name) for name, value in ends.items())
    problems.check()
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
    return start, stop
