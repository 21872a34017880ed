"""Derivatives as columns of sweeps: for all machines of a batch at once, a lane for each machine and direction."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.batch import shape_of, some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.dynamics.derivatives.sensitivity import direction_parts, directions_of
from stickslip.dynamics.derivatives.tangents import not_followed
from stickslip.dynamics.periodic.steady_motions import Closing, SteadyMotions, motions_from_rest
from stickslip.dynamics.stroboscopic.chunked_runs import chunks_of
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates
from stickslip.inverse.optimisation.exact_derivatives import Exact, exactly
from stickslip.inverse.optimisation.gradients import AGREE, RTOL_OF_SLOPES, check_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.observables import Derived, Observable

_PART = 512  # machines that are followed together


@explains_arguments
def derivative(of: Any, by: str, unit: str | None = None) -> Derived:
    """A derivative as a column of a sweep: ``observe={"dV_dmu": ss.optimisation.derivative("mean_velocity", "friction.mu_plus")}``.

    It is exact, from the tangent equations along the steady motion that each machine reaches from rest, as in `gradient`. It is NaN if the
    motion does not repeat or touches a switch. Next to a change of the mode sequence it is the derivative on the machine's side; `gradient`
    of that machine gives both.

    Parameters
    ----------
    of : str or Observable
        "mean_velocity", "drive_power", "cost_of_transport", "friction_power", a state on the strobe such as "state.v", or the mean or the
        integral of an observable of your own.
    by : str
        A number, or numbers of all parts that vary together, as for `gradient`.
    unit : str, optional
        Unit of the result. If not given it is the unit of `of` over that of the number: "m/s/m" for a mean velocity with respect to an
        amplitude.

    Returns
    -------
    Derived

    Raises
    ------
    InputError
        When it is used: for an unknown name, and for a quantity that cannot be differentiated over a grid.

    Examples
    --------
    >>> import stickslip as ss
    >>> slopes = {"dV_dmu": ss.optimisation.derivative("mean_velocity", "friction.mu_plus")}
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[6e-4, 8e-4], tilt_deg=1.7, law="coulomb", observe=slopes)
    >>> grid.dV_dmu.values.round(6).tolist(), grid.dV_dmu.attrs["units"]
    ([-0.054983, -0.089796], 'm/s')
    """
    problems = Problems("derivative")
    if not isinstance(of, str | Observable):
        problems.add(f'of = {of!r}; allowed is the name of a result or an observable; type "mean_velocity"')
    if not isinstance(by, str):
        problems.add(f'by = {by!r}; allowed is the name of one number; type for example by="friction.mu_plus"')
    if not (unit is None or isinstance(unit, str)):
        problems.add(f'unit = {unit!r}; allowed is text; type for example unit="m/s"')
    problems.check()
    return Derived(of, by, unit, values)


def values(model: Model, cases: int, asked: dict[str, Derived], periods: int) -> dict[str, Array]:
    """The derivatives of a batch, a column for each that is asked for; of no cases it checks them only."""
    first = _first_of(model)
    at = coordinates(model)
    quantities = _checked(first, at, asked)
    if not cases:
        return {}
    model = model if shape_of(model) else replace_leaf(model, {name: np.full(cases, float(own)) for name, own in leaves(model)})
    derivatives = {name: np.full(cases, np.nan) for name in asked}
    for part in chunks_of(cases, _PART):
        machines = some_of(model, part)
        motions = motions_from_rest(machines, at, part.stop - part.start, periods)
        for period in np.unique(motions.period[motions.period > 0]):
            which = np.flatnonzero((motions.period == period) & np.isfinite(motions.state).all(axis=1))
            for names in quantities:
                columns = _slopes(some_of(machines, which), at, {name: asked[name] for name in names}, first, motions, which)
                for name, slopes in columns.items():
                    derivatives[name][part.start + which] = slopes
    return derivatives


def _first_of(model: Model) -> Any:
    """The first machine of a batch, with plain numbers."""
    one = some_of(model, [0]) if shape_of(model) else model
    return replace_leaf(one, {name: float(np.ravel(value)[0]) for name, value in leaves(one)})


def _checked(first: Any, at: Coordinates, asked: dict[str, Derived]) -> list[list[str]]:
    """The names of columns, those of one quantity together; `InputError` for what has no derivative."""
    if why := not_followed(first):
        raise InputError("derivative", [f"perturbations are not propagated along the motion of this {type(first).__name__}, as {why}"])
    if first.period is None:
        raise InputError("derivative", [f"{type(first).__name__} has no period; allowed are machines with a drive, such as a Robot"])
    together: dict[Any, list[str]] = {}
    for name, each in asked.items():
        check_of("derivative", each.of, first)
        moved = directions_of("derivative", first, each.by)
        if exactly(each.of, first, at, direction_parts(moved), 1) is None:
            reason = (
                f"{getattr(each.of, 'says', each.of)} is not derived over a grid; type ss.optimisation.gradient(robot, ...) for one machine"
            )
            raise InputError("derivative", [f"{name}: {reason}"])
        together.setdefault(each.of, []).append(name)
    return list(together.values())


def _slopes(
    machines: Any, at: Coordinates, asked: dict[str, Derived], first: Any, motions: SteadyMotions, which: Array
) -> dict[str, Array]:
    """Derivatives of one quantity of machines whose motions have one period."""
    moved = directions_of("derivative", first, [each.by for each in asked.values()])
    seeds, count, period = direction_parts(moved), len(moved), int(motions.period[which[0]])
    exact = exactly(next(iter(asked.values())).of, machines, at, seeds, count)
    assert isinstance(exact, Exact)
    along = Closing(machines, at, seeds, count, RTOL_OF_SLOPES, len(which), exact.means, exact.observe)
    closed = along.near(motions.state[which], period)
    free = np.broadcast_to(np.asarray(machine_of(machines).free_velocity, float), (len(which),))
    good = along.is_good(closed) & (abs(closed.mean_velocity - motions.mean_velocity[which]) <= AGREE * free)
    slopes = np.where(good[:, None], exact.of(closed)[1], np.nan)
    return {name: slopes[:, list(moved).index(each.by)] for name, each in asked.items()}
