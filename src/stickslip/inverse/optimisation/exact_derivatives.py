"""Quantities with exact derivatives: computed from the tangent along a steady motion and from means over it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of, numbers_by_name, some_of
from stickslip.basics.contracts import Array, Model
from stickslip.dynamics.derivatives.slopes import number_slopes
from stickslip.dynamics.derivatives.tangents import means_named
from stickslip.dynamics.periodic.steady_motions import ClosedMotions
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates
from stickslip.engine.closed_arc_conditions import steady_force
from stickslip.models.machine_adapter import machine_of
from stickslip.models.observables import Observable

#: What a user's observable is called among the means, and what the names of coordinates on the strobe begin with.
OWN, STATE = "own", "state."
Value = Callable[[ClosedMotions], tuple[Array, Array]]  # values (motions,) and derivatives (motions, directions)


@dataclass(frozen=True, eq=False)
class Exact:
    """A quantity of motions: how many means it needs, and what it is."""

    of: Value
    means: int = 0
    observe: tuple[tuple[str, Observable], ...] = ()


def exactly(of: Any, model: Model, at: Coordinates, seeds: dict[str, Array], count: int) -> Exact | None:
    """A quantity by its name, or a user's observable; None where its derivatives are not known exactly.

    Parameters
    ----------
    of : str or Observable
    model : Robot or machine
    at : Coordinates
        Of its strobe state.
    seeds : dict of arrays (count,)
        Parts of the directions in the numbers.
    count : int
        How many directions there are.
    """
    if of == "mean_velocity":
        return Exact(lambda motion: (motion.mean_velocity, motion.slopes))
    if isinstance(of, Observable):
        return _observed(of, model)
    if of.startswith(STATE):
        i = at.names[: at.smooth].index(of.removeprefix(STATE))
        return Exact(lambda motion: (motion.nearer[:, i], motion.changes[:, :, i]))
    name = _mean_of(of, model)
    if name is None:
        return None
    names = means_named(model)
    if name not in names:
        return None
    mean = _mean(names.index(name))
    return Exact(mean if of != "cost_of_transport" else _cost(mean, model, seeds, count), len(names))


def _mean_of(of: str, model: Model) -> str | None:
    """The mean that a column is, or is made of."""
    machine = machine_of(model)
    name, _, number = of.partition(".")
    if name in ("drive_power", "cost_of_transport"):
        return "D" if steady_force(model, numbers_by_name(model)) is not None else None
    own = machine.own.get("contact")
    if name != "friction_power" or (number == "") == (own is None):
        return None
    return f"P.{machine.mechanics.contacts[int(number) if number else own]}"  # type: ignore[index]


def _mean(i: int) -> Value:
    return lambda motion: (motion.means[:, i], motion.mean_slopes[:, :, i])


def _integral(mean: Value) -> Value:
    """Over the motion period."""

    def integral(motion: ClosedMotions) -> tuple[Array, Array]:
        value, slopes = mean(motion)
        return value * motion.time, slopes * motion.time[:, None] + value[:, None] * motion.time_slopes

    return integral


def _cost(power: Value, model: Any, seeds: dict[str, Array], count: int) -> Value:
    """Power over weight and speed."""
    weight = np.atleast_1d(np.asarray(model.total_mass * model.gravity, float))
    cases = labels_of(model).cases
    each, along = some_of(model, np.repeat(np.arange(cases), count)), {name: np.tile(parts, cases) for name, parts in seeds.items()}
    (slopes,) = number_slopes(each, along, _weight_of, cases * count)
    heavier = slopes.reshape(cases, count)

    def cost(motion: ClosedMotions) -> tuple[Array, Array]:
        (P, dP), V = power(motion), motion.mean_velocity
        with np.errstate(invalid="ignore", divide="ignore"):
            value = P / (weight * abs(V))
            relative = motion.slopes / V[:, None] + heavier / weight[:, None]
            return value, dP / (weight * abs(V))[:, None] - value[:, None] * relative

    return cost


def _weight_of(machine: Any) -> list[Any]:
    return [machine.model.total_mass * machine.model.gravity]


def _observed(of: Observable, model: Model) -> Exact | None:
    """The mean or the integral of a user's observable."""
    observe = ((OWN, of),)
    names = means_named(model, observe)
    if of.reduce not in ("mean", "integral") or f"u.{OWN}" not in names:
        return None
    mean = _mean(names.index(f"u.{OWN}"))
    return Exact(mean if of.reduce == "mean" else _integral(mean), len(names), observe)
