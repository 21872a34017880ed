"""Special points of a branch in two parameters: curves of folds, flips, Neimark-Sacker points, grazings, borders and events."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.progress import Reported, reporting
from stickslip.dynamics.continuation.branches import Branch
from stickslip.dynamics.continuation.curves.branch_points import crossing_problem
from stickslip.dynamics.continuation.curves.following import followed_curve, two_parameters_of
from stickslip.dynamics.continuation.curves.multipliers import CONDITIONS, multiplier_problem
from stickslip.dynamics.continuation.curves.of_a_number import event_problem, touch_problem
from stickslip.dynamics.continuation.curves.problems import CurveProblem
from stickslip.dynamics.continuation.curves.type_borders import type_border_problem
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.special_points.accuracy import Meeting, Special
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.naming import in_its_unit

if TYPE_CHECKING:
    import xarray as xr


@sealed
class Curve(Drawn):
    """A curve of special points in two parameters; `plot` draws it.

    Parameters
    ----------
    kind : str
        Kind of its points: "fold", "flip", "neimark-sacker", "branch-point", "grazing", "type-border", or the name of an event.
    parameters : (str, str)
        Their names.
    values : array (points, 2)
        The parameters along the curve.
    accuracy : array (points, 2)
        Estimated error of the parameters across the curve: from the residuals, and from differences with twice the step.
    orbits : tuple of PeriodicOrbit
        The motions. Of a grazing or a border that can be told from one side only they are motions just beside it, on that side.
    special : list of Meeting
        Special points on the curve, with their accuracy: "cusp"; "R1", "R2", "R3", "R4" (resonances 1:1 to 1:4);
        "fold-flip", "fold-neimark-sacker" and "flip-neimark-sacker"; "triple-point", where two borders of types meet; "grazing-fold" and
        the like, and "NAME-fold" for an event of that name. ``orbit.notes`` gives details.
    ended : str
        The reason why it ends.

    Examples
    --------
    >>> import stickslip as ss
    >>> rig = dict(tilt_deg=1.7, mu0=0.18, law="coulomb")
    >>> branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.6e-4, stop=3.8e-4, step=0.2, **rig)
    >>> curve = ss.dynamics.special_curve(branch, branch.special[0], "mu0", stop=0.19, step=0.2)  # alpha_minus = 1: A grows as mu_minus
    >>> curve.parameters, round(float(curve.values[-1, 0] / curve.values[0, 0]), 4)
    (('amplitude', 'mu0'), 1.0...)
    """

    kind: str
    parameters: tuple[str, str]
    family: Family
    values: Array
    accuracy: Array
    orbits: tuple[PeriodicOrbit, ...]
    special: list[Meeting]
    ended: str

    _drawn_by, _inches = "special_curve", (4.0, 2.6)

    @property
    def points(self) -> xr.Dataset:
        """The curve as an `xarray.Dataset` over ``point``."""
        import xarray as xr

        columns: dict[str, Any] = {name: ("point", self.values[:, i], self.family.describe(name)) for i, name in enumerate(self.parameters)}
        columns |= {f"{name}_accuracy": ("point", self.accuracy[:, i]) for i, name in enumerate(self.parameters)}
        columns |= {name: ("point", [o.state[i] for o in self.orbits]) for i, name in enumerate(self.orbits[0].names)}
        return xr.Dataset(columns, attrs={"kind": self.kind, "ended": self.ended})

    def _facts(self) -> dict[str, Any]:
        across, up = self.parameters
        ends = [f"{across} = {x:.6g}, {up} = {y:.6g}" for x, y in self.values[[0, -1]].tolist()]
        return {"kind": self.kind, "from": ends[0], "to": ends[1], "points": len(self.values), "ended": self.ended}

    def __repr__(self) -> str:
        special = "".join(f"; {m.kind} at {m.rounded}" for m in self.special)
        return f"<Curve: {self.kind} in ({', '.join(self.parameters)}), {len(self.values)} points{special}; {self.ended}>"


@explains_arguments
@interruptible
def special_curve(
    branch: Branch,
    special: Special,
    parameter: str,
    stop: float,
    *,
    step: float = 0.02,
    points: int = 200,
    progress: Reported | bool | None = None,
) -> Curve:
    """The curve of a special point of a branch in two parameters.

    Parameters
    ----------
    branch : Branch
        The branch; its parameter is the first of the curve.
    special : Special
        A fold, flip, Neimark-Sacker or branch point, grazing or event of one's own (of any machine, law or flow), or a border of
        motion types where rest is exact: under a dynamic law types depend on thresholds.
    parameter : str
        The second parameter: a keyword of the branch's maker that was fixed.
    stop : float
        Its last value. The curve may turn back; it also ends when the first parameter has moved by five times the range of the branch.
    step : float
        First step, in the scaled plane.
    points : int
        Largest number of points.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (the kind of the point, points so far, points at most); return False
        to stop.

    Returns
    -------
    Curve
        `points`, and `special`: cusps, resonances and intersections with other borders, such as the triple point of types I, II and III.

    Raises
    ------
    InputError
        Of a special point that has no curve, and of a grazing or a border at which nothing was found that is touched.
    SolveError
        Where the special point is not found again in two parameters.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=5e-4, stop=6e-4, tilt_deg=1.7, mu0=0.18, law="coulomb")
    >>> curve = ss.dynamics.special_curve(b, b.special[0], "mu0", stop=0.2)
    >>> curve.kind, bool(curve.values[-1, 0] > curve.values[0, 0])  # more friction, more amplitude
    ('type-border', True)

    The folds of x to p + q x - x^3 meet in a cusp at p = 0, q = 1:

    >>> cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.p + n.q * y[0] - y[0] ** 3,), {"p": -0.5, "q": 1.3}, ("x",))
    >>> b = ss.continuation(cubic, parameter="p", start=-0.5, stop=0.3, guess={"x": -0.9})
    >>> [(met.kind, met.rounded) for met in ss.dynamics.special_curve(b, b.special[1], "q", stop=0.5).special]
    [('cusp', '(0, 1)')]

    Where a bristle just does not slip back, in amplitude and friction:

    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4.16e-4, stop=4.22e-4, tilt_deg=1.7, step=0.5)
    >>> curve = ss.dynamics.special_curve(b, b.special[0], "mu0", stop=0.182, step=0.5)
    >>> curve.kind, bool(curve.values[-1, 0] > curve.values[0, 0]), bool(curve.accuracy[:, 0].max() < 1e-10)
    ('grazing', True, True)
    """
    fixed = dict(branch.family.fixed)
    if parameter not in fixed:
        fixed |= _default(branch.family.make, parameter)
    begin = float(fixed.pop(parameter))
    problems = Problems("special_curve")
    stop = in_its_unit(parameter, stop, branch.family.make, problems, "stop")
    problems.check()
    if stop == begin:
        raise InputError("special_curve", [f"stop = {stop!r} is where the curve begins; give another last value of {parameter}"])
    both = Family(branch.family.make, (branch.parameter, parameter), fixed, "special_curve")
    origin, span = np.array([special.value, begin]), np.array([np.ptp(branch.values) or 1.0, abs(stop - begin)])
    if special.kind in CONDITIONS:
        problem, u = multiplier_problem(both, special, origin, span)
    elif special.kind == "branch-point":
        problem, u = crossing_problem(both, special, origin, span)
    elif special.kind in branch.events:
        problem, u = event_problem(both, branch, special, origin, span)
    elif _is_of_arcs(special):
        problem, u = type_border_problem(both, branch, special, origin, span)
    else:
        _check_border(special)
        problem, u = touch_problem(both, branch, special, origin, span)
    report = reporting(progress, "special_curve")
    followed = followed_curve(problem, u, special.kind, float(np.sign(stop - begin)), step, points, report)
    report(followed.ended, len(followed.points), len(followed.points))
    orbits, missing = _orbits(problem, [f.at for f in followed.points])
    placed = [two_parameters_of(problem, f) for f in followed.points[: len(orbits)]]
    values, accuracy = (np.array(column) for column in zip(*placed, strict=True))
    return Curve(special.kind, (branch.parameter, parameter), both, values, accuracy, orbits, followed.special, followed.ended + missing)


def _orbits(problem: CurveProblem, states: list[Array]) -> tuple[tuple[Any, ...], str]:
    """The motions along a curve, up to the first that Newton's method does not find again: at the edge of what is admissible."""
    orbits: list[Any] = []
    for u in states:
        try:
            orbits.append(problem.orbit(u))
        except (SolveError, InputError):
            if not orbits:
                raise
            return tuple(orbits), f"; the motions of its last {len(states) - len(orbits)} points were not found again, and are left out"
    return tuple(orbits), ""


def _is_of_arcs(special: Special) -> bool:
    """Whether it is a border of types of a motion made of arcs whose times are the only unknowns."""
    orbit = special.orbit
    if orbit.is_cycle or not orbit.patterns or special.kind != "type-border":
        return False
    machine = machine_of(orbit.model)
    return not machine.mechanics.knows_place and not machine.has_inner_states


def _check_border(special: Special) -> None:
    """`InputError` for a special point that is none of multipliers, unless it is one where something is touched."""
    allowed = f"allowed are {', '.join(CONDITIONS)}, branch-point, grazing, and type-border where rest is exact"
    if special.kind not in ("grazing", "type-border"):
        raise InputError("special_curve", [f"it is a {special.kind}; {allowed}; type ss.continuation at each value"])
    if special.kind == "type-border" and adapter_of(special.orbit.model).has_tolerance:
        names = " and ".join(dict.fromkeys(law.name for law in machine_of(special.orbit.model).laws))
        why = f"it is a type-border under {names}, where types depend on thresholds"
        raise InputError("special_curve", [f"{why}; {allowed}; type ss.continuation at each value"])


def _default(make: Model | Callable[..., Any], parameter: str) -> dict[str, float]:
    """The value of a parameter that was not given: the maker's own."""
    import inspect

    if not callable(make):
        from stickslip.basics.fields import leaves

        known = dict(leaves(make))
    else:
        known = {p.name: p.default for p in inspect.signature(make).parameters.values() if isinstance(p.default, (int, float))}
    if parameter not in known:
        raise InputError("special_curve", [f"parameter = {parameter!r} is not a number of the branch's maker; known: {', '.join(known)}"])
    return {parameter: float(known[parameter])}
