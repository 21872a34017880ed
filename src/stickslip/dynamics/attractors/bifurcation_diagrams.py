"""Brute-force bifurcation diagrams: the attractor after transients for each value of a parameter, upwards and downwards."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Maker, Numbers, explains_arguments
from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.executors import Workers
from stickslip.basics.fields import floats
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.dynamics.attractors.kinds_of_motion import NOT_COMPUTED, UNDONE, of_motions
from stickslip.dynamics.attractors.motion_features import features_of
from stickslip.dynamics.attractors.period_numbers import POINTS
from stickslip.dynamics.attractors.settled_motions import Settling, checked_limit, motion_times, settled_motions
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report, Tell, over_chunks
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, strobe_map
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.model_adapter import adapter_of
from stickslip.models.naming import in_its_unit
from stickslip.studies.progress import Watch

if TYPE_CHECKING:
    import xarray as xr

DIRECTIONS = ("up", "down")


@explains_arguments
@interruptible
def bifurcation(
    make: Maker,
    *,
    parameter: str,
    values: Numbers,
    settle: int = 200,
    limit: int | None = None,
    points: int = 64,
    follow: bool = True,
    start: Any = None,
    rtol: float = 1e-7,
    section: Any = None,
    turns: int = 1,
    workers: int = 1,
    executor: Executes = None,
    progress: Report | None = None,
    **fixed: Any,
) -> xr.Dataset:
    """A bifurcation diagram by brute force: the strobe points after settling, for every value of a parameter.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names.
    parameter : str
        The keyword that varies.
    values : array
        Its values, ascending.
    settle, points : int
        Drive periods that are discarded at least, and that are recorded.
    limit : int, optional
        Drive periods up to which a motion is run on that has not settled, eight times `settle` if not given; what has no period then is
        looked at over 600 more and is quasi-periodic, chaotic (a positive exponent) or not settled, as `stickslip.basins` says.
    follow : bool
        True: sweep up through the values and down again, each case starting where the previous one ended, which reveals hysteresis. False:
        every case starts at `start` and all run in one batch, which is much faster.
    start : dict, array or orbit, optional
        Initial state; rest if not given.
    rtol : float
        Tolerance for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    workers : int
        Threads, where `follow` is False (following goes from value to value). The results do not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. Cases not computed are then NaN,
        with the period -1.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    xarray.Dataset
        Over direction ("up", "down"), the parameter and point: the strobe state (v, z, ...), displacement in each period [m]; over
        direction and parameter: mean_velocity [m/s], motion ("periodic", "quasi-periodic", "chaotic", "not settled", "runs away",
        "not solved", "not computed"), period (0: none, -1: not computed), exponent with its error per drive period (of what has no
        period), run (drive periods until it was recognised, or given up), v_max, v_min [m/s] of the last period (of one body).

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=[0.04, 0.05], settle=100, points=32, follow=False,
    ...                    amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist(), d.motion.values.tolist()
    ([[2, 1]], [['periodic', 'periodic']])
    """
    robots = family("bifurcation", make, (parameter,), fixed)
    problems = Problems("bifurcation")
    problems.whole("settle", settle, 1, example=200)
    problems.whole("points", points, 2, example=64)
    crew = Workers(workers, executor)
    crew.note(problems)
    limit = checked_limit(problems, settle, limit)
    values = checked_values(problems, values, robots)
    needs_model("bifurcation", robots.robot(values[0]), flows=True, sections=True)
    model = robots.robots(values)
    first = states_of(start, model)
    at = on_section(model, section=section, turns=turns, states=first, what="bifurcation")
    first = at.section.starts(first) if start is None and at.section is not None else first
    how = _Look(robots, at, settle, limit, points, rtol)
    diagram = how.blank(DIRECTIONS if follow else ("from start",), len(values), first.shape[1])
    with partial_result() as ending:
        if follow:
            _hysteresis(diagram, how, values, first, progress)
        else:

            def numbers(part: slice) -> _Numbers:
                return how.of(part), values[part], first[part]

            for part, columns in over_chunks(len(values), numbers, _columns_at, crew, progress):
                for name, column in columns.items():
                    diagram[name][0, part] = column
    grid = _dataset(how, parameter, values, diagram, DIRECTIONS if follow else ("from start",))
    if not ending.interrupted:
        return grid
    done = np.count_nonzero(diagram["motion"] != NOT_COMPUTED)
    return grid.assign_attrs(note=ending.note(f"{done} of {grid.period.size} motions are computed"))


@dataclass(frozen=True, eq=False)
class _Look:
    """How the motion at each value is looked at."""

    robots: Family
    at: Coordinates
    settle: int
    limit: int
    points: int
    rtol: float

    def blank(self, directions: tuple[str, ...], values: int, d: int) -> dict[str, Array]:
        """Columns over direction and value of what is not computed yet."""
        flat, numbers = (len(directions), values), ("mean_velocity", "exponent", "error", "v_max", "v_min", "duration")
        return {
            "points": np.full((*flat, self.points, d), np.nan), "displacement": np.full((*flat, self.points), np.nan),
            "motion": np.full(flat, NOT_COMPUTED, dtype="<U16"), "period": np.full(flat, UNDONE), "run": np.zeros(flat, int),
            **{name: np.full(flat, np.nan) for name in numbers},
        }  # fmt: skip

    def of(self, which: Any) -> _Look:
        """The same for some of the values."""
        return replace(self, at=self.at.of(which))

    def columns_at(self, values: Array, states: Array) -> dict[str, Array]:
        """Columns of the cases of its values, each with its own start."""
        model, at, n = self.robots.robots(values), self.at, len(states)
        how = Settling(self.settle, self.limit, self.rtol, max(self.points, POINTS))
        settled = settled_motions(model, states, at, how, groups=np.arange(n))
        V = features_of(model.period, settled, at).mean_velocity
        ends, known = settled.points[:, -1], np.flatnonzero(np.isfinite(settled.points[:, -1]).all(axis=1))
        extremes = np.full((2, n), np.nan)
        if len(known):
            last = strobe_map(some_of(model, known), ends[known], 1, self.rtol, at.of(known))
            extremes[:, known] = last.v_max, last.v_min
        return {
            "points": settled.points[:, -self.points :], "displacement": settled.ways[:, -self.points :], "mean_velocity": V,
            "motion": settled.kind, "period": settled.period, "exponent": settled.exponent, "error": settled.error, "run": settled.run,
            "v_max": extremes[0], "v_min": extremes[1], "duration": motion_times(settled),
        }  # fmt: skip


#: How some values are looked at, the values, and their starts.
_Numbers = tuple[_Look, Array, Array]


def _columns_at(numbers: _Numbers, tell: Tell) -> dict[str, Array]:
    how, values, states = numbers
    return how.columns_at(values, states)


def checked_values(problems: Problems, values: Array, robots: Family) -> Array:
    """The values of a parameter, rising; `InputError` if they are not, or anything else is wrong."""
    values = in_its_unit(robots.parameters[0], values, robots.make, problems, "values")
    array = floats(values)
    if array.ndim != 1 or len(array) < 2 or not np.all(np.isfinite(array)) or not np.all(np.diff(array) > 0):
        problems.add(f"values = {values!r}; allowed are two or more rising finite numbers; type values=np.linspace(0.03, 0.06, 300)")
    problems.check()
    return array


def _hysteresis(diagram: dict[str, Array], how: _Look, values: Array, first: Array, progress: Report | None) -> None:
    """Upwards and downwards side by side, each value from the end of the one before, into the columns."""
    n, states, watch = len(values), first[[0, -1]], Watch(len(values), progress)
    for k in range(n):
        look()
        columns = how.of([k, n - 1 - k]).columns_at(values[[k, n - 1 - k]], states)
        last = columns["points"][:, -1]
        states = np.where(np.isfinite(last), last, first[[k, n - 1 - k]])
        for name, column in columns.items():
            diagram[name][0, k], diagram[name][1, n - 1 - k] = column
        watch.finished(k, np.zeros(1, int))


def _dataset(how: _Look, parameter: str, values: Array, diagram: dict[str, Array], directions: tuple[str, ...]) -> Any:
    import xarray as xr

    whole, flat = ("direction", parameter, "point"), ("direction", parameter)
    at, model = how.at, how.robots.robot(values[0])
    known = adapter_of(model).has_units
    columns: dict[str, Any] = {
        n: (whole, diagram["points"][..., i], state_attrs(n, "on the strobe" if at.section is None else "on the section", model))
        for i, n in enumerate(at.names)
    }
    if adapter_of(model).has_displacement:
        way = {"units": unit_of_part("x", model, "") if known else "1", "long_name": "displacement in a drive period"}
        columns["displacement"] = (whole, diagram["displacement"], way)
        columns["mean_velocity"] = (flat, diagram["mean_velocity"], velocity_attrs(model))
    columns["period"] = (flat, diagram["period"], {"units": "1", "long_name": "drive periods until it repeats (0: none, -1: not computed)"})
    columns |= {name: (flat, diagram[name], attributes) for name, attributes in of_motions(at.section is not None).items()}
    if at.mechanics is not None and not at.named:
        columns["v_max"] = (flat, diagram["v_max"], {"units": unit_of_part("v", model, ""), "long_name": "largest velocity"})
        columns["v_min"] = (flat, diagram["v_min"], {"units": unit_of_part("v", model, ""), "long_name": "smallest velocity"})
    if at.section is not None:
        columns["duration"] = (flat, diagram["duration"], {"units": "s", "long_name": "time until the motion repeats"})
    coords = {parameter: (parameter, values, how.robots.describe(parameter)), "direction": list(directions)}
    return xr.Dataset(columns, coords, {"parameter": parameter, "settle": how.settle, "limit": how.limit})


def velocity_attrs(model: Any) -> dict[str, str]:
    """Unit and name of a mean velocity; nobody knows the units of a flow's states."""
    return {"units": unit_of_part("v", model, "") if adapter_of(model).has_units else "1", "long_name": "mean velocity"}


def state_attrs(name: str, when: str, model: Any = None) -> dict[str, str]:
    """Unit and name of a coordinate of a strobe state at some time; nobody knows the units of a flow's states.

    Examples
    --------
    >>> state_attrs("v.head", "at the start"), state_attrs("z0", "on the strobe")["units"], state_attrs("memory", "on the strobe")["units"]
    ({'units': 'm/s', 'long_name': 'velocity of head at the start'}, 'm', '1')
    """
    letter, _, part = name.partition(".")
    if model is not None and not adapter_of(model).has_units:
        return {"units": "1", "long_name": f"{name} {when}"}
    if letter.startswith("memory"):
        return {"units": "1", "long_name": f"what the law remembers {when}, {name}"}
    known = {"v": "velocity", "x": "position", "l": "position, less that of the first body,"}
    whose = f" of {part}" if part and letter in known else ""
    unit = unit_of_part({"v": "v", "z": "z"}.get(letter[:1], "x"), model, part)
    return {"units": unit, "long_name": f"{known.get(letter, f'inner state {name}')}{whose} {when}"}
